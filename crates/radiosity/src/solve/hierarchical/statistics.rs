//! What links there are: numbers, and lines for a picture.

use super::Hierarchical;
use super::cluster::{Hierarchy, Node};
use super::link::{Link, Seen};
use glam::Vec3;

/// How many links there are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct LinkCounts {
    /// All of them.
    pub all: usize,
    /// Between cells, exact but for what stands between.
    pub between_cells: usize,
    /// With a cluster at one or both ends.
    pub with_clusters: usize,
    /// Of which rays saw nothing get through.
    pub blocked: usize,
    /// Nodes of the hierarchy.
    pub nodes: usize,
}

/// A link as a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnLink {
    /// Where light leaves.
    pub from: Vec3,
    /// Where it arrives.
    pub to: Vec3,
    /// Steps from the root to the receiver.
    pub level: u32,
    /// Flux that it brings, over all channels.
    pub flux: f32,
}

impl Hierarchical {
    /// Numbers of links by kind.
    pub fn links(&self) -> LinkCounts {
        let mut counts = LinkCounts {
            nodes: self.links.len(),
            ..LinkCounts::default()
        };
        let Some(transport) = &self.transport else {
            return counts;
        };
        let tree = transport.tree();
        for (node, links) in tree.nodes().iter().zip(&self.links) {
            for link in links {
                let is_cluster = node.is_cluster() || tree.node(link.source).is_cluster();
                counts.all += 1;
                counts.between_cells += usize::from(!is_cluster);
                counts.with_clusters += usize::from(is_cluster);
                counts.blocked += usize::from(link.seen().0 == Seen::Blocked);
            }
        }
        counts
    }

    /// The links that bring most, at most so many, strongest first.
    pub fn strongest_links(&self, most: usize) -> Vec<DrawnLink> {
        let Some(transport) = &self.transport else {
            return Vec::new();
        };
        let tree = transport.tree();
        let (radiosity, _) = self.light(transport);
        let levels = levels(tree);
        let mut drawn: Vec<DrawnLink> = Vec::new();
        for (id, links) in self.links.iter().enumerate() {
            let node = &tree.nodes()[id];
            drawn.extend(links.iter().map(|link| {
                let source = tree.node(link.source);
                let magnitude = radiosity.magnitude(link.source)[0];
                DrawnLink {
                    from: source.centre,
                    to: node.centre,
                    level: levels[id],
                    flux: magnitude * irradiance(node, source, link) * node.area,
                }
            }));
        }
        drawn.sort_by(|a, b| b.flux.total_cmp(&a.flux));
        drawn.truncate(most);
        drawn
    }
}

/// Irradiance for a radiosity of 1, about.
fn irradiance(receiver: &Node, source: &Node, link: &Link) -> f32 {
    let quarter = |node: &Node| if node.is_cluster() { 0.25 } else { 1.0 };
    let sent = if source.is_cluster() {
        source.area
    } else {
        1.0
    };
    link.factor * quarter(receiver) * quarter(source) * sent
}

/// Steps from the root to each node.
fn levels(tree: &Hierarchy) -> Vec<u32> {
    let mut levels = vec![0; tree.len()];
    for id in 0..crate::index32(tree.len()) {
        for child in tree.children(id) {
            levels[child as usize] = levels[id as usize] + 1;
        }
    }
    levels
}
