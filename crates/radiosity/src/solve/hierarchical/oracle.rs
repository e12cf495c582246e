//! Which links are refined: those that carry too much error.
//!
//! A link may be wrong because light varies over its receiver, because its source is not equally bright, or because few
//! rays told what stands between. Over the area of the receiver, and relative to the light that is there, its share of
//! the mean squared error is
//!
//! ```text
//! q = A_r / A · (B² σ_r² + σ_B² σ_s² + B² σ_v²) / H_r²
//! ```
//!
//! That is the classic bound by energy (*BFA*: radiosity times factor times area; Hanrahan, Salzman, Aupperle 1991) where
//! the factor is its error instead of itself, and squared, because errors of many links do not add up but their variances
//! do: the sum over all links estimates the mean squared relative error of the solution.

use super::cluster::Hierarchy;
use super::link::Link;
use super::push_pull::Radiosity;
use super::transport::Transport;

/// What becomes of a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    /// It is good enough, or as good as it can be.
    Keep,
    /// The children of the receiver get links of their own.
    SplitReceiver,
    /// The children of the source send on their own.
    SplitSource,
    /// It is looked at by more rays.
    Look,
}

/// Judges links.
pub(super) struct Oracle<'a> {
    pub(super) transport: &'a Transport,
    pub(super) radiosity: &'a Radiosity,
    /// `A_r / (A H_r²)` of each node.
    pub(super) weights: &'a [f32],
    /// Largest share of the mean squared error that a link may have.
    pub(super) threshold: f32,
}

impl Oracle<'_> {
    /// Whether to refine a link, and how.
    pub(super) fn verdict(&self, receiver: u32, link: &Link) -> Verdict {
        let parts = self.parts(receiver, link);
        if parts.iter().sum::<f32>() <= self.threshold {
            return Verdict::Keep;
        }
        let tree = self.transport.tree();
        let can_split = [receiver, link.source].map(|node| tree.node(node).element.is_none());
        if self.transport.is_near(receiver, link.source) {
            return larger(tree, receiver, link.source, can_split);
        }
        let [over_receiver, over_source, noise] = parts;
        let can_look = link.seen().1 < self.transport.most_rays();
        if noise > over_receiver && noise > over_source && can_look {
            Verdict::Look
        } else if over_receiver >= over_source && can_split[0] {
            Verdict::SplitReceiver
        } else if over_source > 0.0 && can_split[1] && over_source >= noise {
            Verdict::SplitSource
        } else if can_look && noise > 0.0 {
            Verdict::Look
        } else {
            larger(tree, receiver, link.source, can_split)
        }
    }

    /// Shares of the mean squared error: of variation over the receiver and over the source, and of few rays.
    pub(super) fn parts(&self, receiver: u32, link: &Link) -> [f32; 3] {
        let tree = self.transport.tree();
        let spread = link.spread();
        let [magnitude, deviation] = self.radiosity.magnitude(link.source);
        let is_leaf = tree.node(receiver).element.is_some();
        let over_receiver = if is_leaf {
            0.0
        } else {
            magnitude * spread.over_receiver
        };
        // A cluster is no point, however evenly bright.
        let uneven = if tree.node(link.source).is_cluster() {
            magnitude
        } else {
            deviation
        };
        let parts = [
            over_receiver,
            uneven * spread.over_source,
            magnitude * spread.noise,
        ];
        parts.map(|error| self.weights[receiver as usize] * error * error)
    }
}

/// Splits the larger of two nodes that can be split.
fn larger(tree: &Hierarchy, receiver: u32, source: u32, can_split: [bool; 2]) -> Verdict {
    let [r, s] = [receiver, source].map(|node| tree.node(node).radius);
    match can_split {
        [false, false] => Verdict::Keep,
        [true, false] => Verdict::SplitReceiver,
        [false, true] => Verdict::SplitSource,
        [true, true] if r >= s => Verdict::SplitReceiver,
        [true, true] => Verdict::SplitSource,
    }
}
