//! Refinement: down the receivers, each with the links that its parent could not keep.
//!
//! A receiver decides on its links alone, and the rays of a link follow from its two nodes, so the result is the same in
//! whatever order subtrees are done. They are shared out among threads.

use super::cluster::Hierarchy;
use super::link::{Link, Seen};
use super::oracle::{Oracle, Verdict};
use rayon::prelude::*;

/// Subtrees of fewer nodes are not worth a thread of their own.
const ALONE: usize = 256;
/// Rays grow by this factor where more are wanted.
const MORE_RAYS: u32 = 4;

/// A link to be made from a receiver's parent's.
#[derive(Debug, Clone, Copy)]
struct Inherited {
    source: u32,
    known: (Seen, u32),
}

/// Refines all links, those of each node in `links`.
pub(super) fn refine(oracle: &Oracle<'_>, links: &mut [Vec<Link>]) {
    below(oracle, 0, links, &[]);
}

/// Refines the links of a node and of all below it.
fn below(oracle: &Oracle<'_>, receiver: u32, links: &mut [Vec<Link>], inherited: &[Inherited]) {
    let Some((own, rest)) = links.split_first_mut() else {
        return;
    };
    let passed_on = receiver_links(oracle, receiver, own, inherited);
    let tree = oracle.transport.tree();
    let children = split(tree, receiver, rest);
    let go_on = |(child, links): (u32, &mut [Vec<Link>])| below(oracle, child, links, &passed_on);
    if tree.subtree(receiver).len() < ALONE {
        children.into_iter().for_each(go_on);
    } else {
        children.into_par_iter().for_each(go_on);
    }
}

/// The links of each child's subtree.
fn split<'a>(
    tree: &Hierarchy,
    node: u32,
    mut links: &'a mut [Vec<Link>],
) -> Vec<(u32, &'a mut [Vec<Link>])> {
    let mut parts = Vec::new();
    for child in tree.children(node) {
        let (part, rest) = links.split_at_mut(tree.subtree(child).len());
        parts.push((child, part));
        links = rest;
    }
    parts
}

/// Refines the links of one receiver; what its children have to look at is returned.
fn receiver_links(
    oracle: &Oracle<'_>,
    receiver: u32,
    own: &mut Vec<Link>,
    inherited: &[Inherited],
) -> Vec<Inherited> {
    let transport = oracle.transport;
    let mut waiting = core::mem::take(own);
    waiting.extend(
        inherited
            .iter()
            .filter_map(|link| transport.link(receiver, link.source, Some(link.known), 0)),
    );
    // The last comes first.
    waiting.reverse();
    let mut passed_on = Vec::new();
    while let Some(link) = waiting.pop() {
        let (seen, rays) = link.seen();
        match oracle.verdict(receiver, &link) {
            Verdict::Keep => own.push(link),
            Verdict::SplitReceiver => passed_on.push(Inherited {
                source: link.source,
                known: (seen, rays),
            }),
            Verdict::SplitSource => {
                let children = transport.tree().children(link.source);
                let made = children
                    .filter_map(|child| transport.link(receiver, child, Some((seen, rays)), 0));
                waiting.extend(made);
            }
            Verdict::Look => {
                let more = rays.saturating_mul(MORE_RAYS).min(transport.most_rays());
                waiting.extend(transport.link(receiver, link.source, None, more));
            }
        }
    }
    own.shrink_to_fit();
    passed_on
}
