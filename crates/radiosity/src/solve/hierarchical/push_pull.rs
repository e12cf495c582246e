//! Light on the hierarchy: radiosity is pulled up, gathered over links, and irradiance pushed down.
//!
//! A cell holds its mean radiosity and receives irradiance that is linear over it, so that what comes over one link from
//! afar is smooth on all elements below. A cluster holds and receives nine [`harmonics`](super::harmonics) for each
//! channel. The centre of a cell is the mean of those of its elements, so pushing keeps the flux.

use super::cluster::{Hierarchy, Node, Shape};
use super::harmonics::{HARMONICS, MEAN, cosine_lobe, harmonics, overlap};
use super::link::Link;
use super::transport::{Transport, tangents};
use crate::patch::PatchMesh;
use crate::solution::BANDS;
use rayon::prelude::*;

/// Irradiance of a cell in one channel: its mean, and its change along the tangents.
const LINEAR: usize = 3;

/// Radiosity of the nodes.
#[derive(Debug, Clone)]
pub(super) struct Radiosity {
    channels: usize,
    /// Mean over the area, `[node][channel]`.
    means: Vec<f32>,
    /// By direction, `[cluster][channel][harmonic]`.
    lobes: Vec<f32>,
    /// Magnitude over all channels, mean and standard deviation over the elements.
    magnitudes: Vec<[f32; 2]>,
}

/// Irradiance of the nodes.
#[derive(Debug)]
struct Irradiance {
    /// `[node][channel][LINEAR]`.
    cells: Vec<f32>,
    /// `[cluster][channel][harmonic]`.
    clusters: Vec<f32>,
}

impl Radiosity {
    /// Pulls the radiosity of elements up, `[channel][element]`.
    pub(super) fn pull(tree: &Hierarchy, radiosity: &[f32], channels: usize) -> Self {
        let elements = radiosity.len() / channels;
        let nodes = tree.len();
        let mut pulled = Self {
            channels,
            means: vec![0.0; nodes * channels],
            lobes: vec![0.0; tree.clusters() * channels * HARMONICS],
            magnitudes: vec![[0.0; 2]; nodes],
        };
        for id in (0..crate::index32(nodes)).rev() {
            let node = tree.node(id);
            if let Some(element) = node.element {
                let value = |channel: usize| radiosity[channel * elements + element as usize];
                let means = &mut pulled.means[id as usize * channels..][..channels];
                means
                    .iter_mut()
                    .enumerate()
                    .for_each(|(c, m)| *m = value(c));
                let sum: f32 = means.iter().map(|m| m.abs()).sum();
                pulled.magnitudes[id as usize] = [sum / BANDS as f32, 0.0];
            } else {
                pulled.pull_from_children(tree, id, node);
            }
        }
        pulled
    }

    fn pull_from_children(&mut self, tree: &Hierarchy, id: u32, node: &Node) {
        let channels = self.channels;
        let at = id as usize;
        let (mut mean, mut square) = (0.0, 0.0);
        for child in tree.children(id) {
            let below = tree.node(child);
            let share = below.area / node.area;
            for channel in 0..channels {
                let value = self.means[child as usize * channels + channel];
                self.means[at * channels + channel] += share * value;
            }
            let [m, d] = self.magnitudes[child as usize];
            mean += share * m;
            square += share * (m * m + d * d);
            if let Shape::Cluster(cluster) = node.shape {
                self.add_lobes(cluster, child, below);
            }
        }
        self.magnitudes[at] = [mean, (square - mean * mean).max(0.0).sqrt()];
    }

    /// Adds what a child sends by direction.
    fn add_lobes(&mut self, cluster: u32, child: u32, below: &Node) {
        let size = self.channels * HARMONICS;
        let start = cluster as usize * size;
        // Clusters below come later.
        let (lobes, later) = self.lobes[start..].split_at_mut(size);
        match below.shape {
            Shape::Cluster(other) => {
                let other = &later[(other - cluster - 1) as usize * size..][..size];
                lobes
                    .iter_mut()
                    .zip(other)
                    .for_each(|(to, from)| *to += from);
            }
            Shape::Cell(_) => {
                let lobe = cosine_lobe(below.normal);
                let means = &self.means[child as usize * self.channels..];
                for (to, mean) in lobes.chunks_exact_mut(HARMONICS).zip(means) {
                    let flux = mean * below.area;
                    to.iter_mut().zip(lobe).for_each(|(to, l)| *to += flux * l);
                }
            }
        }
    }

    /// Mean magnitude of a node over all channels, and how it deviates over its elements.
    pub(super) fn magnitude(&self, node: u32) -> [f32; 2] {
        self.magnitudes[node as usize]
    }

    /// Irradiance of the elements over all links, `[channel][element]`.
    pub(super) fn gather(
        &self,
        transport: &Transport,
        mesh: &PatchMesh,
        links: &[Vec<Link>],
    ) -> Vec<f32> {
        let tree = transport.tree();
        let channels = self.channels;
        let mut received = Irradiance {
            cells: vec![0.0; tree.len() * channels * LINEAR],
            clusters: vec![0.0; tree.clusters() * channels * HARMONICS],
        };
        let cells = received.cells.par_chunks_exact_mut(channels * LINEAR);
        cells
            .zip(links)
            .enumerate()
            .with_min_len(64)
            .for_each(|(id, (out, links))| {
                if !tree.nodes()[id].is_cluster() {
                    let receiver = crate::index32(id);
                    links
                        .iter()
                        .for_each(|link| self.to_cell(transport, receiver, link, out));
                }
            });
        let of_clusters: Vec<u32> = (0..crate::index32(tree.len()))
            .filter(|&id| tree.node(id).is_cluster())
            .collect();
        let clusters = received.clusters.par_chunks_exact_mut(channels * HARMONICS);
        clusters.zip(of_clusters).for_each(|(out, receiver)| {
            let links = links[receiver as usize].iter();
            links.for_each(|link| self.to_cluster(transport, receiver, link, out));
        });
        received.push(tree, mesh, channels)
    }

    /// Adds what a link brings to a cell.
    fn to_cell(&self, transport: &Transport, receiver: u32, link: &Link, out: &mut [f32]) {
        let slope = link.slope();
        let sent = Sent::new(self, transport, receiver, link);
        for (channel, out) in out.chunks_exact_mut(LINEAR).enumerate() {
            let irradiance = sent.flux(channel) * link.factor * link.tint(channel % BANDS);
            out[0] += irradiance;
            out[1] += irradiance * slope[0];
            out[2] += irradiance * slope[1];
        }
    }

    /// Adds what a link brings to a cluster.
    fn to_cluster(&self, transport: &Transport, receiver: u32, link: &Link, out: &mut [f32]) {
        let sent = Sent::new(self, transport, receiver, link);
        // It comes from the source.
        let from = if transport.is_near(receiver, link.source) {
            MEAN
        } else {
            let tree = transport.tree();
            let offset = tree.node(link.source).centre - tree.node(receiver).centre;
            harmonics(offset.normalize_or_zero())
        };
        for (channel, out) in out.chunks_exact_mut(HARMONICS).enumerate() {
            let irradiance = sent.flux(channel) * link.factor * link.tint(channel % BANDS);
            out.iter_mut()
                .zip(from)
                .for_each(|(out, harmonic)| *out += irradiance * harmonic);
        }
    }
}

/// What a source sends over a link, by channel.
enum Sent<'a> {
    /// Mean radiosities of a cell; area and cosine are in the factor.
    Cell(&'a [f32]),
    /// Harmonics of a cluster, and those of the direction.
    Cluster(&'a [f32], [f32; HARMONICS]),
}

impl<'a> Sent<'a> {
    fn new(radiosity: &'a Radiosity, transport: &Transport, receiver: u32, link: &Link) -> Self {
        let tree = transport.tree();
        let source = tree.node(link.source);
        let channels = radiosity.channels;
        match source.shape {
            Shape::Cell(_) => {
                Self::Cell(&radiosity.means[link.source as usize * channels..][..channels])
            }
            Shape::Cluster(cluster) => {
                let size = channels * HARMONICS;
                let lobes = &radiosity.lobes[cluster as usize * size..][..size];
                let towards = if transport.is_near(receiver, link.source) {
                    MEAN
                } else {
                    let offset = tree.node(receiver).centre - source.centre;
                    harmonics(offset.normalize_or_zero())
                };
                Self::Cluster(lobes, towards)
            }
        }
    }

    fn flux(&self, channel: usize) -> f32 {
        match self {
            Self::Cell(means) => means[channel],
            Self::Cluster(lobes, towards) => {
                overlap(&lobes[channel * HARMONICS..][..HARMONICS], towards)
            }
        }
    }
}

impl Irradiance {
    /// Pushes everything down to the elements, `[channel][element]`.
    fn push(mut self, tree: &Hierarchy, mesh: &PatchMesh, channels: usize) -> Vec<f32> {
        let elements = mesh.elements().len();
        let mut irradiance = vec![0.0; channels * elements];
        for id in 0..crate::index32(tree.len()) {
            let node = tree.node(id);
            if let Some(element) = node.element {
                let cell = &self.cells[id as usize * channels * LINEAR..];
                for channel in 0..channels {
                    irradiance[channel * elements + element as usize] = cell[channel * LINEAR];
                }
                continue;
            }
            for child in tree.children(id) {
                match node.shape {
                    Shape::Cell(_) => self.push_to_part(tree, id, child, channels),
                    Shape::Cluster(cluster) => {
                        self.push_to_member(tree, cluster, child, channels);
                    }
                }
            }
        }
        irradiance
    }

    /// From a cell to a part of it.
    fn push_to_part(&mut self, tree: &Hierarchy, cell: u32, part: u32, channels: usize) {
        let (node, below) = (tree.node(cell), tree.node(part));
        let offset = below.centre - node.centre;
        let place = tangents(node.normal).map(|t| t.dot(offset));
        let size = channels * LINEAR;
        let (above, later) = self.cells[cell as usize * size..].split_at_mut(size);
        let out = &mut later[(part - cell - 1) as usize * size..][..size];
        for (out, above) in out.chunks_exact_mut(LINEAR).zip(above.chunks_exact(LINEAR)) {
            out[0] += above[0] + above[1] * place[0] + above[2] * place[1];
            out[1] += above[1];
            out[2] += above[2];
        }
    }

    /// From a cluster to what is in it.
    fn push_to_member(&mut self, tree: &Hierarchy, cluster: u32, member: u32, channels: usize) {
        let below = tree.node(member);
        let size = channels * HARMONICS;
        let (above, later) = self.clusters[cluster as usize * size..].split_at_mut(size);
        match below.shape {
            Shape::Cluster(other) => {
                let out = &mut later[(other - cluster - 1) as usize * size..][..size];
                out.iter_mut()
                    .zip(above)
                    .for_each(|(out, above)| *out += *above);
            }
            Shape::Cell(_) => {
                let lobe = cosine_lobe(below.normal);
                let out = &mut self.cells[member as usize * channels * LINEAR..];
                let above = above.chunks_exact(HARMONICS);
                for (out, above) in out.chunks_exact_mut(LINEAR).zip(above) {
                    out[0] += overlap(above, &lobe);
                }
            }
        }
    }
}
