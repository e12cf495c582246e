//! A tree over the emitters (Walter and others 2005; Conty Estevez and Kulla 2018): many lights at the cost of few.
//!
//! A node knows where its emitters are, in which directions they shine and how much, so it bounds what they bring to a
//! place. A group of receivers gets a *cut*: nodes that hold all emitters, split where they bring much and appear large. A
//! ray that has chosen a node of the cut finds one of its emitters in a [table](Table) of what each brings to the group.

use glam::Vec3;
use std::collections::BinaryHeap;

/// Nodes of a cut, if none must be split further.
const CUT: usize = 64;

/// What the tree is built over.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lamp {
    pub(super) centroid: Vec3,
    pub(super) normal: Vec3,
    pub(super) radius: f32,
    /// Summed over channels.
    pub(super) flux: f32,
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
    /// Each lamp as a node.
    lamps: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    centre: Vec3,
    radius: f32,
    /// Mean direction of the normals, and cosine and sine of the largest angle from it.
    axis: Vec3,
    spread: [f32; 2],
    flux: f32,
    /// Largest radius of a lamp.
    lamp_radius: f32,
    /// Position of its first lamp in the order, and how many it has.
    first: u32,
    count: u32,
    below: Below,
}

#[derive(Debug, Clone, Copy)]
enum Below {
    Lamp(u32),
    /// Position of the first of two.
    Nodes(u32),
}

/// A node of a cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Part(u32);

impl Lights {
    pub(super) fn new(lamps: &[Lamp]) -> Self {
        let mut order: Vec<u32> = (0..crate::index32(lamps.len())).collect();
        let mut nodes = Vec::new();
        if !lamps.is_empty() {
            let root = build(lamps, (&mut order, 0), &mut nodes);
            nodes.push(root);
        }
        let alone = (0..).zip(lamps).map(|(i, lamp)| Node::of_lamp(i, lamp, i));
        Self {
            nodes,
            order,
            lamps: alone.collect(),
        }
    }

    /// Nodes that hold all lamps that may light a place, neighbours side by side. Lamps nearer than `near` times both
    /// radii are in nodes of their own.
    pub(super) fn cut(&self, place: &Place, near: f32) -> Vec<Part> {
        let mut cut = Vec::new();
        // Positive numbers: their bits are in their order.
        let mut open = BinaryHeap::new();
        let enter = |open: &mut BinaryHeap<(u32, u32)>, index: usize| {
            let node = &self.nodes[index];
            let doubt = node.bound(place) * node.angle(place);
            if doubt > 0.0 {
                open.push((doubt.to_bits(), crate::index32(index)));
            }
        };
        if let Some(root) = self.nodes.len().checked_sub(1) {
            enter(&mut open, root);
        }
        while let Some((_, index)) = open.pop() {
            let node = &self.nodes[index as usize];
            let is_full = cut.len() + open.len() + 1 >= CUT;
            match node.below {
                Below::Nodes(first) if !is_full || node.may_be_near(place, near) => {
                    enter(&mut open, first as usize);
                    enter(&mut open, first as usize + 1);
                }
                _ => cut.push(Part(index)),
            }
        }
        cut.sort_unstable_by_key(|part| self.nodes[part.0 as usize].first);
        cut
    }

    /// What a part of a cut brings to a place at most, about.
    pub(super) fn bound(&self, part: Part, place: &Place) -> f32 {
        self.nodes[part.0 as usize].bound(place)
    }

    /// The lamp of a part that has but one.
    pub(super) fn lamp(&self, part: Part) -> Option<usize> {
        match self.nodes[part.0 as usize].below {
            Below::Lamp(lamp) => Some(lamp as usize),
            Below::Nodes(_) => None,
        }
    }

    /// Calls `visit` for each lamp that may be nearer to a place than `near` times both radii.
    pub(super) fn visit_near(&self, place: &Place, near: f32, mut visit: impl FnMut(usize)) {
        let mut open: Vec<usize> = self.nodes.len().checked_sub(1).into_iter().collect();
        while let Some(index) = open.pop() {
            let node = &self.nodes[index];
            if !node.may_be_near(place, near) {
                continue;
            }
            match node.below {
                Below::Lamp(lamp) => visit(lamp as usize),
                Below::Nodes(first) => open.extend([first as usize + 1, first as usize]),
            }
        }
    }

    /// What the lamps of a part bring to a place.
    pub(super) fn table(&self, part: Part, place: &Place) -> Table {
        let node = &self.nodes[part.0 as usize];
        let range = node.first as usize..(node.first + node.count) as usize;
        let mut sum = 0.0;
        let sums = |&lamp: &u32| {
            sum += self.lamps[lamp as usize].bound(place);
            sum
        };
        let lamps = self.order[range].to_vec();
        Table {
            sums: lamps.iter().map(sums).collect(),
            lamps,
        }
    }
}

/// Lamps to choose from by what each brings to a place at most, about.
pub(super) struct Table {
    lamps: Vec<u32>,
    /// Running sums.
    sums: Vec<f32>,
}

impl Table {
    /// All that they bring.
    pub(super) fn total(&self) -> f32 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// A lamp for a number in [0, 1), with its probability. There must be one that brings something.
    pub(super) fn choose(&self, sample: f32) -> (usize, f32) {
        let (index, probability, _) = choose(&self.sums, sample);
        (self.lamps[index] as usize, probability)
    }
}

/// Position in running sums for a number in [0, 1), its probability, and what is left of the number.
pub(super) fn choose(sums: &[f32], sample: f32) -> (usize, f32, f32) {
    let total = sums[sums.len() - 1];
    let wanted = sample * total;
    // Rounding may lead to the total; what was added last is meant, not what added nothing after it.
    let end = sums.partition_point(|&sum| sum < total);
    let index = sums.partition_point(|&sum| sum <= wanted).min(end);
    let start = if index == 0 { 0.0 } else { sums[index - 1] };
    let share = sums[index] - start;
    let rest = ((wanted - start) / share).clamp(0.0, 0.999_999_94);
    (index, share / total, rest)
}

impl Node {
    /// What its lamps bring at most, about: their flux, the largest cosines, the mean distance.
    fn bound(&self, place: &Place) -> f32 {
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
            flux: lamp.flux,
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
        let (axis, spread) = cone(members().map(|lamp| (lamp.normal, lamp.flux)));
        Self {
            centre,
            radius: reaches.fold(0.0, f32::max),
            axis,
            spread,
            flux: members().map(|lamp| lamp.flux).sum(),
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
    let (left, right) = members.split_at_mut(members.len() / 2);
    let middle = at + crate::index32(left.len());
    let children = [
        build(lamps, (left, at), nodes),
        build(lamps, (right, middle), nodes),
    ];
    let first = crate::index32(nodes.len());
    nodes.extend(children);
    Node::over(lamps, (members, at), first)
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
            flux: 0.1 + unit(i, 8),
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
            let cut = tree.cut(&place, 0.0);
            let mut found = vec![0.0_f64; lamps.len()];
            let mut told = vec![0.0_f64; lamps.len()];
            const SAMPLES: u16 = 20_000;
            for &part in &cut {
                let table = tree.table(part, &place);
                if table.total() <= 0.0 {
                    continue;
                }
                for sample in 0..SAMPLES {
                    let sample = (f32::from(sample) + 0.5) / f32::from(SAMPLES);
                    let (lamp, probability) = table.choose(sample);
                    found[lamp] += 1.0 / f64::from(SAMPLES);
                    told[lamp] = f64::from(probability);
                }
            }
            for (lamp, (found, told)) in found.iter().zip(&told).enumerate() {
                assert!((found - told).abs() < 2e-3, "{lamp}: {found} for {told}");
                let offset = place.centroid - lamps[lamp].centroid;
                let lights = offset.dot(lamps[lamp].normal) > 0.1 * offset.length()
                    && -offset.dot(place.normal) > 0.1 * offset.length();
                assert!(!lights || *told > 0.0, "{lamp} lights and is left out");
            }
        }
    }

    #[test]
    fn what_is_near_is_found_and_in_parts_of_its_own() {
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
            for part in tree.cut(&place, 2.0) {
                let table = tree.table(part, &place);
                for &lamp in &table.lamps {
                    let is_alone = !is_near(lamp as usize) || tree.lamp(part).is_some();
                    assert!(is_alone, "a near lamp is among others");
                }
            }
        }
    }
}
