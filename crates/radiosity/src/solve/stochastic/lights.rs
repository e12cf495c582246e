//! A tree over the emitters (Walter and others 2005; Conty Estevez and Kulla 2018): many lights at the cost of few.
//!
//! A node knows where its emitters are, in which directions they shine and how much, so it bounds what they bring to a
//! place. A group of receivers gets *cuts*: nodes that hold all emitters, split where they bring much and appear large. A
//! coarse one for what hides them, a fine one for what they bring: mostly of single emitters.

use glam::Vec3;
use std::collections::BinaryHeap;

/// Nodes of the coarse cut. More of them tell better what is hidden, and learn it more slowly.
const PARTS: usize = 32;
/// Lamps up to which each is in the fine cut; beyond, its nodes if none must be split further.
const LAMPS: usize = 8192;
const ITEMS: usize = 1024;

/// What the tree is built over.
#[derive(Debug, Clone)]
pub(super) struct Lamp {
    pub(super) centroid: Vec3,
    pub(super) normal: Vec3,
    pub(super) radius: f32,
    /// By channel.
    pub(super) flux: Vec<f32>,
}

/// A place that is lit, a disc or a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) centroid: Vec3,
    pub(super) normal: Vec3,
    pub(super) radius: f32,
    /// Cosine and sine of the largest angle between its normals and the mean one.
    spread: [f32; 2],
}

impl Place {
    /// A point.
    #[cfg(test)]
    pub(super) fn point(centroid: Vec3, normal: Vec3) -> Self {
        Self::disc(centroid, normal, 0.0)
    }

    /// What is flat and within a radius.
    pub(super) fn disc(centroid: Vec3, normal: Vec3, radius: f32) -> Self {
        Self {
            centroid,
            normal,
            radius,
            spread: [1.0, 0.0],
        }
    }

    /// What holds several places.
    pub(super) fn around<'a>(places: impl Iterator<Item = &'a Self> + Clone) -> Self {
        let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (low, high) = places.clone().fold(nothing, |(low, high), place| {
            (low.min(place.centroid), high.max(place.centroid))
        });
        let centroid = 0.5 * (low + high);
        let reaches = places
            .clone()
            .map(|p| p.centroid.distance(centroid) + p.radius);
        let (normal, spread) = cone(places.map(|place| (place.normal, 1.0)));
        Self {
            centroid,
            normal,
            radius: reaches.fold(0.0, f32::max),
            spread,
        }
    }
}

/// Mean direction of weighted unit vectors, with cosine and sine of the largest angle from it.
fn cone(vectors: impl Iterator<Item = (Vec3, f32)> + Clone) -> (Vec3, [f32; 2]) {
    let axis = vectors.clone().map(|(v, weight)| v * weight).sum::<Vec3>();
    let axis = axis.normalize_or(Vec3::Y);
    // A little wider than they are, for rounding.
    let cosine = vectors.map(|(v, _)| v.dot(axis) - 1e-5).fold(1.0, f32::min);
    let cosine = cosine.max(-1.0);
    (axis, [cosine, (1.0 - cosine * cosine).max(0.0).sqrt()])
}

/// The tree.
pub(super) struct Lights {
    /// Children follow each other; the root is the last.
    nodes: Vec<Node>,
    /// The lamps, those of a node side by side.
    order: Vec<u32>,
    /// Positions of the lamps in that order.
    positions: Vec<u32>,
    /// Running sums of the flux in that order.
    sums: Vec<f64>,
    /// Flux of the nodes, `[node][channel]`.
    fluxes: Vec<f32>,
    channels: usize,
}

/// A node of the tree.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub(super) centre: Vec3,
    pub(super) radius: f32,
    /// Mean direction of the normals, and cosine and sine of the largest angle from it.
    pub(super) axis: Vec3,
    pub(super) spread: [f32; 2],
    /// Summed over channels.
    pub(super) flux: f32,
    /// Largest radius of a lamp.
    lamp_radius: f32,
    /// Position of its first lamp in the order, and how many it has.
    pub(super) first: u32,
    count: u32,
    below: Below,
}

#[derive(Debug, Clone, Copy)]
enum Below {
    Lamp(u32),
    /// Position of the first of two.
    Nodes(u32),
}

impl Lights {
    /// Lamps of as many channels each.
    pub(super) fn new(lamps: &[Lamp]) -> Self {
        let mut order: Vec<u32> = (0..crate::index32(lamps.len())).collect();
        let mut nodes = Vec::new();
        if !lamps.is_empty() {
            let root = build(lamps, (&mut order, 0), &mut nodes);
            nodes.push(root);
        }
        let mut positions = vec![0; lamps.len()];
        let mut sum = 0.0;
        let mut sums = Vec::with_capacity(lamps.len());
        for (position, &lamp) in (0..).zip(&order) {
            positions[lamp as usize] = position;
            sum += f64::from(lamps[lamp as usize].total());
            sums.push(sum);
        }
        Self {
            channels: lamps.first().map_or(0, |lamp| lamp.flux.len()),
            fluxes: fluxes(&nodes, lamps),
            positions,
            sums,
            nodes,
            order,
        }
    }

    /// A node of the tree.
    pub(super) fn node(&self, index: u32) -> &Node {
        &self.nodes[index as usize]
    }

    /// Whether a node is a lamp by itself.
    pub(super) fn is_lamp(&self, index: u32) -> bool {
        matches!(self.node(index).below, Below::Lamp(_))
    }

    /// Flux of a node by channel.
    pub(super) fn flux(&self, index: u32) -> &[f32] {
        &self.fluxes[index as usize * self.channels..][..self.channels]
    }

    /// Where a lamp is in the order of the nodes' lamps.
    pub(super) fn position(&self, lamp: usize) -> u32 {
        self.positions[lamp]
    }

    /// Few nodes that hold all lamps that may light a place, neighbours side by side.
    pub(super) fn parts(&self, place: &Place) -> Vec<u32> {
        self.cut(place, PARTS, 0.0)
    }

    /// Many nodes that hold all lamps that may light a place, neighbours side by side. Lamps nearer than `near` times both
    /// radii are in nodes of their own, and so are all where there are not too many.
    pub(super) fn items(&self, place: &Place, near: f32) -> Vec<u32> {
        if self.order.len() > LAMPS {
            return self.cut(place, ITEMS, near);
        }
        let mut items = Vec::new();
        self.visit(|node| node.bound(place) > 0.0, |index, _| items.push(index));
        items
    }

    fn cut(&self, place: &Place, most: usize, near: f32) -> Vec<u32> {
        let mut cut = Vec::new();
        // Positive numbers: their bits are in their order.
        let mut open = BinaryHeap::new();
        let enter = |open: &mut BinaryHeap<(u32, u32)>, index: u32| {
            let node = self.node(index);
            let doubt = node.bound(place) * node.angle(place);
            if doubt > 0.0 {
                open.push((doubt.to_bits(), index));
            }
        };
        if let Some(root) = self.nodes.len().checked_sub(1) {
            enter(&mut open, crate::index32(root));
        }
        while let Some((_, index)) = open.pop() {
            let node = self.node(index);
            let is_full = cut.len() + open.len() + 1 >= most;
            match node.below {
                Below::Nodes(first) if !is_full || node.may_be_near(place, near) => {
                    enter(&mut open, first);
                    enter(&mut open, first + 1);
                }
                _ => cut.push(index),
            }
        }
        cut.sort_unstable_by_key(|&index| self.node(index).first);
        cut
    }

    /// Calls `visit` for each lamp that may be nearer to a place than `near` times both radii.
    pub(super) fn visit_near(&self, place: &Place, near: f32, mut visit: impl FnMut(usize)) {
        self.visit(|node| node.may_be_near(place, near), |_, lamp| visit(lamp));
    }

    /// Calls `visit` with the node and the number of each lamp whose nodes all are `wanted`, in their order.
    fn visit(&self, wanted: impl Fn(&Node) -> bool, mut visit: impl FnMut(u32, usize)) {
        let root = self.nodes.len().checked_sub(1).map(crate::index32);
        let mut open: Vec<u32> = root.into_iter().collect();
        while let Some(index) = open.pop() {
            let node = self.node(index);
            if !wanted(node) {
                continue;
            }
            match node.below {
                Below::Lamp(lamp) => visit(index, lamp as usize),
                Below::Nodes(first) => open.extend([first + 1, first]),
            }
        }
    }

    /// A lamp of a node for a number in [0, 1), by their fluxes, and its probability.
    pub(super) fn choose(&self, index: u32, sample: f32) -> (usize, f32) {
        let node = self.node(index);
        if let Below::Lamp(lamp) = node.below {
            return (lamp as usize, 1.0);
        }
        let range = node.first as usize..(node.first + node.count) as usize;
        let start = range.start.checked_sub(1).map_or(0.0, |i| self.sums[i]);
        let total = self.sums[range.end - 1] - start;
        let wanted = start + f64::from(sample) * total;
        let found = self.sums[range.clone()].partition_point(|&sum| sum <= wanted);
        let position = range.start + found.min(range.len() - 1);
        let before = position.checked_sub(1).map_or(0.0, |i| self.sums[i]);
        let share = (self.sums[position] - before) / total;
        (self.order[position] as usize, super::to_f32(share))
    }
}

/// Fluxes of nodes, children before their parents, `[node][channel]`.
fn fluxes(nodes: &[Node], lamps: &[Lamp]) -> Vec<f32> {
    let channels = lamps.first().map_or(0, |lamp| lamp.flux.len());
    let mut fluxes: Vec<f32> = Vec::with_capacity(nodes.len() * channels);
    for node in nodes {
        match node.below {
            Below::Lamp(lamp) => fluxes.extend(&lamps[lamp as usize].flux),
            Below::Nodes(first) => {
                let first = first as usize * channels;
                for channel in first..first + channels {
                    fluxes.push(fluxes[channel] + fluxes[channel + channels]);
                }
            }
        }
    }
    fluxes
}

impl Lamp {
    /// Summed over channels.
    fn total(&self) -> f32 {
        self.flux.iter().sum()
    }
}

impl Node {
    /// What its lamps bring at most, about: their flux, the largest cosines, the mean distance.
    pub(super) fn bound(&self, place: &Place) -> f32 {
        let offset = place.centroid - self.centre;
        let squared = offset.length_squared();
        let reach = self.radius + place.radius;
        if squared <= reach * reach {
            return self.flux / (reach * reach).max(f32::MIN_POSITIVE);
        }
        let inverse = 1.0 / squared.sqrt();
        let direction = offset * inverse;
        let sine = reach * inverse;
        let around = [(1.0 - sine * sine).max(0.0).sqrt(), sine];
        let leaving = within(direction.dot(self.axis), self.spread);
        let leaving = within(leaving, around);
        let arriving = within(-direction.dot(place.normal), place.spread);
        let arriving = within(arriving, around);
        if leaving <= 0.0 || arriving <= 0.0 {
            return 0.0;
        }
        self.flux * leaving * arriving / squared
    }

    /// Sine of the angle under which it and a place appear to each other: what is in the way of some of it may leave the
    /// rest visible the more, the larger it appears.
    fn angle(&self, place: &Place) -> f32 {
        let distance = place.centroid.distance(self.centre);
        let reach = self.radius + place.radius;
        reach.max(f32::MIN_POSITIVE) / distance.max(reach).max(f32::MIN_POSITIVE)
    }

    /// Whether one of its lamps may be nearer than `near` times both radii.
    fn may_be_near(&self, place: &Place, near: f32) -> bool {
        let reach = near * (self.lamp_radius + place.radius) + self.radius;
        self.centre.distance_squared(place.centroid) < reach * reach
    }

    fn of_lamp(index: u32, lamp: &Lamp, first: u32) -> Self {
        Self {
            first,
            count: 1,
            centre: lamp.centroid,
            radius: lamp.radius,
            axis: lamp.normal,
            spread: [1.0, 0.0],
            flux: lamp.total(),
            lamp_radius: lamp.radius,
            below: Below::Lamp(index),
        }
    }

    fn over(lamps: &[Lamp], (members, first): (&[u32], u32), children: u32) -> Self {
        let count = crate::index32(members.len());
        let members = || members.iter().map(|&i: &u32| &lamps[i as usize]);
        let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (low, high) = members().fold(nothing, |(low, high), lamp| {
            (low.min(lamp.centroid), high.max(lamp.centroid))
        });
        let centre = 0.5 * (low + high);
        let reaches = members().map(|lamp| lamp.centroid.distance(centre) + lamp.radius);
        let (axis, spread) = cone(members().map(|lamp| (lamp.normal, lamp.total())));
        Self {
            centre,
            radius: reaches.fold(0.0, f32::max),
            axis,
            spread,
            flux: members().map(Lamp::total).sum(),
            lamp_radius: members().map(|lamp| lamp.radius).fold(0.0, f32::max),
            first,
            count,
            below: Below::Nodes(children),
        }
    }
}

/// Builds what is below a node, and the node. Its members are a part of the order that begins at a position.
fn build(lamps: &[Lamp], (members, at): (&mut [u32], u32), nodes: &mut Vec<Node>) -> Node {
    if let [lamp] = *members {
        return Node::of_lamp(lamp, &lamps[lamp as usize], at);
    }
    let centroids = || members.iter().map(|&i| lamps[i as usize].centroid);
    let low = centroids().fold(Vec3::INFINITY, Vec3::min);
    let high = centroids().fold(Vec3::NEG_INFINITY, Vec3::max);
    let axis = (high - low).max_position();
    members.sort_unstable_by(|&a, &b| {
        let along = |i: u32| lamps[i as usize].centroid[axis];
        along(a).total_cmp(&along(b)).then(a.cmp(&b))
    });
    let (left, right) = members.split_at_mut(widest_gap(lamps, members, axis));
    let middle = at + crate::index32(left.len());
    let children = [
        build(lamps, (left, at), nodes),
        build(lamps, (right, middle), nodes),
    ];
    let first = crate::index32(nodes.len());
    nodes.extend(children);
    Node::over(lamps, (members, at), first)
}

/// Where the members, in their order along an axis, are farthest apart, in the middle half of them: what belongs to one
/// luminaire stays together.
fn widest_gap(lamps: &[Lamp], members: &[u32], axis: usize) -> usize {
    let along = |i: usize| lamps[members[i] as usize].centroid[axis];
    let quarter = members.len() / 4;
    let middle = members.len() / 2;
    (quarter.max(1)..members.len() - quarter)
        .max_by(|&i, &j| {
            let gap = |i: usize| along(i) - along(i - 1);
            gap(i)
                .total_cmp(&gap(j))
                .then(j.abs_diff(middle).cmp(&i.abs_diff(middle)))
        })
        .unwrap_or(middle)
}

/// Cosine of what an angle is at least, if it may be less by another one that is given by cosine and sine.
fn within(cosine: f32, [other_cosine, other_sine]: [f32; 2]) -> f32 {
    if cosine >= other_cosine {
        return 1.0;
    }
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    cosine * other_cosine + sine * other_sine
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash;

    fn unit(seed: u64, i: u64) -> f32 {
        (hash(seed, i) >> 40) as f32 / (1 << 24) as f32
    }

    fn point(seed: u64) -> Vec3 {
        Vec3::new(unit(seed, 1), unit(seed, 2), unit(seed, 3)) * 10.0
    }

    fn lamps(count: u64) -> Vec<Lamp> {
        let lamp = |i: u64| Lamp {
            centroid: point(i),
            normal: (point(i + 9999) - Vec3::splat(5.0)).normalize_or(Vec3::Y),
            radius: 0.01 + 0.1 * unit(i, 7),
            flux: vec![0.1 + unit(i, 8)],
        };
        (0..count).map(lamp).collect()
    }

    fn place(i: u64) -> Place {
        let normal = (point(i + 7777) - Vec3::splat(5.0)).normalize_or(Vec3::X);
        Place::point(point(i + 5555), normal)
    }

    #[test]
    fn every_lamp_that_lights_a_place_can_be_chosen_as_often_as_it_is_told() {
        let lamps = lamps(300);
        let tree = Lights::new(&lamps);
        for i in 0..20 {
            let place = place(i);
            let mut found = vec![0.0_f64; lamps.len()];
            let mut told = vec![0.0_f64; lamps.len()];
            const SAMPLES: u16 = 20_000;
            for part in tree.parts(&place) {
                for sample in 0..SAMPLES {
                    let sample = (f32::from(sample) + 0.5) / f32::from(SAMPLES);
                    let (lamp, probability) = tree.choose(part, sample);
                    found[lamp] += 1.0 / f64::from(SAMPLES);
                    told[lamp] = f64::from(probability);
                }
            }
            let items = tree.items(&place, 0.0);
            for (lamp, (found, told)) in found.iter().zip(&told).enumerate() {
                assert!((found - told).abs() < 2e-3, "{lamp}: {found} for {told}");
                let offset = place.centroid - lamps[lamp].centroid;
                let lights = offset.dot(lamps[lamp].normal) > 0.1 * offset.length()
                    && -offset.dot(place.normal) > 0.1 * offset.length();
                let is_item = items.iter().any(|&item| tree.choose(item, 0.5).0 == lamp);
                assert!(!lights || *told > 0.0, "{lamp} lights and is in no part");
                assert!(!lights || is_item, "{lamp} lights and is no item");
            }
        }
    }

    #[test]
    fn what_is_near_is_found_and_in_nodes_of_its_own() {
        let lamps = lamps(300);
        let tree = Lights::new(&lamps);
        for i in 0..50 {
            let place = Place {
                radius: 0.3,
                ..place(i)
            };
            let is_near = |lamp: usize| {
                let reach = 2.0 * (lamps[lamp].radius + place.radius);
                lamps[lamp].centroid.distance(place.centroid) < reach
            };
            let mut found = Vec::new();
            tree.visit_near(&place, 2.0, |lamp| found.push(lamp));
            for lamp in (0..lamps.len()).filter(|&lamp| is_near(lamp)) {
                assert!(found.contains(&lamp), "{lamp} is near");
            }
            for index in tree.cut(&place, 32, 2.0) {
                let node = tree.node(index);
                let members = &tree.order[node.first as usize..(node.first + node.count) as usize];
                let is_apart = members.len() == 1 || !members.iter().any(|&i| is_near(i as usize));
                assert!(is_apart, "a near lamp is among others");
            }
        }
    }

    #[test]
    fn luminaires_stay_together() {
        // Eight globes of ten facets each in a row, too few and too many for cuts in the middle.
        let facet = |globe: u16, i: u16| Lamp {
            centroid: Vec3::new(f32::from(globe), 3.0, 0.0) + 0.1 * point(u64::from(i)).normalize(),
            normal: Vec3::NEG_Y,
            radius: 0.02,
            flux: vec![1.0, 0.5],
        };
        let counts = [10, 10, 7, 12, 10, 10, 10, 11];
        let lamps: Vec<Lamp> = (0..8)
            .flat_map(|globe: u16| (0..counts[usize::from(globe)]).map(move |i| facet(globe, i)))
            .collect();
        let tree = Lights::new(&lamps);
        let cut = tree.cut(&Place::point(Vec3::new(3.5, 0.0, 0.0), Vec3::Y), 8, 0.0);
        let found: Vec<u32> = cut.iter().map(|&index| tree.node(index).count).collect();
        assert_eq!(found, counts.map(u32::from), "a node each");
        let [red, green] = *tree.flux(cut[2]) else {
            panic!("two channels")
        };
        assert!(
            (red - 7.0).abs() < 1e-4 && (green - 3.5).abs() < 1e-4,
            "its flux"
        );
    }
}
