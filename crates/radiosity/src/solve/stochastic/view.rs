//! What a group of receivers sees of the lamps, eight of them at once.
//!
//! A lamp is taken for a small disc: that gives what it brings if nothing is in the way, and together with the share of
//! rays that got through, what is *expected* of it. Rays only have to find the rest,
//!
//! ```text
//! H = Σ v_i K_i + mean of (V K - v_i K_i) / p_i
//! ```
//!
//! with the kernel `K`, the visibility `V` of each ray, and the guesses `K_i` and `v_i` of lamp `i` (a control variate for
//! each lamp). Whatever the guesses are, the mean is right. A lamp that is all visible or all hidden leaves hardly
//! anything to find, so rays go to those that are in between: `p_i` follows the standard deviation of what is left,
//!
//! ```text
//! p_i ~ √(v (1 - v)) K_i + √v (K⁺_i - K_i) / 2
//! ```
//!
//! where `K⁺` is a bound of the kernel over all points of lamp and receiver.

use super::lights::{Lights, Place};
use super::strata::Stratum;
use core::f32::consts::FRAC_1_PI;
use core::ops::Range;
use wide::f32x8;

/// Lamps that are looked at together.
const LANES: usize = 8;
/// What a kernel differs by over lamp and receiver, as a share of what it may.
const KERNEL_SPREAD: f32 = 0.5;

/// Lamps as small discs; lanes without one have no flux.
#[derive(Debug, Clone, Copy)]
struct Block {
    centre: [f32x8; 3],
    axis: [f32x8; 3],
    radius: f32x8,
    /// 1 - cosine of the largest angle between normals.
    spread: f32x8,
    /// Summed over channels, over π.
    flux: f32x8,
    /// Nodes of the tree.
    nodes: [u32; LANES],
    /// Positions of their first lamps.
    firsts: [u32; LANES],
}

/// All that a group of receivers may see.
pub(super) struct View {
    channels: usize,
    blocks: Vec<Block>,
    /// Share of each channel in the flux, `[block][channel]`.
    colours: Vec<f32x8>,
    /// Blocks of each part of the coarse cut.
    parts: Vec<Range<usize>>,
    /// Lanes whose flux was taken away, with the flux.
    hidden: Vec<(usize, f32)>,
}

impl View {
    /// From a place that holds all receivers, by its coarse cut.
    pub(super) fn new(lights: &Lights, around: &Place, parts: &[u32], near: f32) -> Self {
        let items = lights.items(around, near);
        let channels = lights.flux(items.first().copied().unwrap_or(0)).len();
        let mut view = Self {
            channels,
            blocks: Vec::with_capacity(items.len() / LANES + parts.len()),
            colours: Vec::new(),
            parts: Vec::with_capacity(parts.len()),
            hidden: Vec::new(),
        };
        let mut rest = items.as_slice();
        for after in 1..=parts.len() {
            let end = parts.get(after).map(|&part| lights.node(part).first);
            let end = end.map_or(rest.len(), |end| {
                rest.partition_point(|&item| lights.node(item).first < end)
            });
            let (members, others) = rest.split_at(end);
            let start = view.blocks.len();
            members
                .chunks(LANES)
                .for_each(|lanes| view.add(lights, lanes));
            view.parts.push(start..view.blocks.len());
            rest = others;
        }
        view
    }

    fn add(&mut self, lights: &Lights, lanes: &[u32]) {
        let of = |value: &dyn Fn(u32) -> f32| {
            let mut lane = [0.0; LANES];
            for (slot, &index) in lane.iter_mut().zip(lanes) {
                *slot = value(index);
            }
            f32x8::from(lane)
        };
        let mut block = Block {
            centre: [0, 1, 2].map(|axis| of(&|i| lights.node(i).centre[axis])),
            axis: [0, 1, 2].map(|axis| of(&|i| lights.node(i).axis[axis])),
            radius: of(&|i| lights.node(i).radius),
            spread: of(&|i| 1.0 - lights.node(i).spread[0]),
            flux: of(&|i| lights.node(i).flux * FRAC_1_PI),
            nodes: [0; LANES],
            firsts: [u32::MAX; LANES],
        };
        for (lane, &index) in lanes.iter().enumerate() {
            block.nodes[lane] = index;
            block.firsts[lane] = lights.node(index).first;
        }
        self.blocks.push(block);
        for channel in 0..self.channels {
            let share = |i| lights.flux(i)[channel] / lights.node(i).flux;
            self.colours.push(of(&share));
        }
    }

    /// Parts of the coarse cut.
    pub(super) fn part_count(&self) -> usize {
        self.parts.len()
    }

    /// Leaves out lamps by their positions in the order of the tree, and those of the last call no longer. A lamp within a
    /// node of several stays.
    pub(super) fn leave_out(&mut self, lights: &Lights, positions: impl Iterator<Item = u32>) {
        for (lane, flux) in core::mem::take(&mut self.hidden) {
            self.set_flux(lane, flux);
        }
        for position in positions {
            let block = self
                .blocks
                .partition_point(|block| block.firsts[0] <= position);
            let Some(block) = block.checked_sub(1) else {
                continue;
            };
            let lanes = &self.blocks[block];
            let found = lanes.firsts.iter().position(|&first| first == position);
            if let Some(lane) = found.filter(|&lane| lights.is_lamp(lanes.nodes[lane])) {
                let lane = block * LANES + lane;
                let flux = self.set_flux(lane, 0.0);
                self.hidden.push((lane, flux));
            }
        }
    }

    /// The flux that was there before.
    fn set_flux(&mut self, lane: usize, flux: f32) -> f32 {
        let block = &mut self.blocks[lane / LANES].flux;
        let mut lanes = block.to_array();
        let before = core::mem::replace(&mut lanes[lane % LANES], flux);
        *block = f32x8::from(lanes);
        before
    }

    /// Looks from a receiver, where such shares of the parts are visible.
    pub(super) fn look(&self, receiver: &Place, shares: &[f32], sight: &mut Sight) {
        sight.clear(self.channels);
        for (blocks, &share) in self.parts.iter().zip(shares) {
            let between = f32x8::splat((share * (1.0 - share)).sqrt());
            let around = f32x8::splat(KERNEL_SPREAD * share.sqrt());
            let mut sum = 0.0;
            for index in blocks.clone() {
                let [kernel, bound] = self.blocks[index].kernels(receiver);
                let chances = between * kernel + around * (bound - kernel);
                let expected = f32x8::splat(share) * kernel;
                sum += chances.reduce_add();
                sight.sums.push(sum);
                sight.chances.push(chances);
                sight.expected.push(expected);
                let colours = &self.colours[index * self.channels..];
                for (sum, &colour) in sight.by_channel.iter_mut().zip(colours) {
                    *sum += expected * colour;
                }
            }
            sight.parts.push((blocks.start, blocks.end, sum));
            sight.chance += f64::from(sum);
        }
    }

    /// What is expected of a choice, by channel.
    pub(super) fn expected<'a>(
        &'a self,
        choice: &Choice,
        sight: &Sight,
    ) -> impl Iterator<Item = f32> + use<'a> {
        let Choice { block, lane, .. } = *choice;
        let expected = sight.expected[block].to_array()[lane];
        let colours = &self.colours[block * self.channels..][..self.channels];
        colours
            .iter()
            .map(move |colour| expected * colour.to_array()[lane])
    }

    /// The node of the tree that was chosen.
    pub(super) fn node(&self, choice: &Choice) -> u32 {
        self.blocks[choice.block].nodes[choice.lane]
    }
}

impl Block {
    /// What each lamp brings to a receiver if nothing is in the way, and a bound of that over its points.
    #[inline(always)]
    fn kernels(&self, receiver: &Place) -> [f32x8; 2] {
        let [x, y, z] = self.centre;
        let centroid = receiver.centroid;
        let x = f32x8::splat(centroid.x) - x;
        let y = f32x8::splat(centroid.y) - y;
        let z = f32x8::splat(centroid.z) - z;
        let normal = receiver.normal;
        let leaving = x * self.axis[0] + y * self.axis[1] + z * self.axis[2];
        let arriving =
            x * f32x8::splat(-normal.x) + y * f32x8::splat(-normal.y) + z * f32x8::splat(-normal.z);
        let reach = self.radius + f32x8::splat(receiver.radius);
        let squared = x * x + y * y + z * z;
        let squared = squared.fast_max(reach * reach);
        let falling = self.flux / (squared * squared);
        // The sum of the components is no less than the distance.
        let turned = self.spread * (x.abs() + y.abs() + z.abs());
        let none = f32x8::ZERO;
        let kernel = leaving.fast_max(none) * arriving.fast_max(none) * falling;
        let leaving = (leaving + reach + turned).fast_max(none);
        let arriving = (arriving + reach).fast_max(none);
        [kernel, leaving * arriving * falling]
    }
}

/// What a receiver sees.
#[derive(Debug, Clone, Default)]
pub(super) struct Sight {
    chances: Vec<f32x8>,
    /// Running sums of the chances of blocks, from the first of each part.
    sums: Vec<f32>,
    /// What lamps are expected to bring, summed over channels.
    expected: Vec<f32x8>,
    /// First block, end of the blocks and chance of each part.
    parts: Vec<(usize, usize, f32)>,
    /// Of all parts.
    chance: f64,
    by_channel: Vec<f32x8>,
}

/// A lamp that was chosen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Choice {
    block: usize,
    lane: usize,
    /// Within its part.
    pub(super) probability: f32,
    /// What is left of the number that chose it, in [0, 1).
    pub(super) rest: f32,
}

impl Sight {
    fn clear(&mut self, channels: usize) {
        self.chances.clear();
        self.sums.clear();
        self.expected.clear();
        self.parts.clear();
        self.chance = 0.0;
        self.by_channel.clear();
        self.by_channel.resize(channels, f32x8::ZERO);
    }

    /// What all lamps are expected to bring, by channel.
    pub(super) fn total(&self) -> impl Iterator<Item = f64> {
        self.by_channel
            .iter()
            .map(|sum| f64::from(sum.reduce_add()))
    }

    /// Shares rays out among the parts, by a number in [0, 1) (systematic sampling): a part whose share is more than a ray has
    /// as many as that, one more or less, and counts by those it has. Others have their ray with the probability of their
    /// share.
    pub(super) fn strata(&self, rays: u32, sample: f32) -> impl Iterator<Item = Stratum> {
        let scale = f64::from(rays) / self.chance.max(f64::MIN_POSITIVE);
        let mut sum = 0.0;
        let before = move |x: f64| whole((x - f64::from(sample)).ceil().max(0.0)).min(rays);
        self.parts
            .iter()
            .enumerate()
            .filter_map(move |(part, &(_, _, chance))| {
                let first = before(sum * scale);
                sum += f64::from(chance);
                let rays = before(sum * scale) - first;
                let share = super::to_f32(f64::from(chance) * scale);
                (rays > 0).then_some(Stratum {
                    part,
                    rays,
                    expected_rays: if share >= 1.0 { rays as f32 } else { share },
                    deviation: chance,
                })
            })
    }

    /// A lamp of a part for a number in [0, 1). The part must have a chance.
    pub(super) fn choose(&self, part: usize, sample: f32) -> Option<Choice> {
        let (start, end, total) = self.parts[part];
        let wanted = sample * total;
        let sums = &self.sums[start..end];
        let last = sums.partition_point(|&sum| sum < total);
        let block = sums.partition_point(|&sum| sum <= wanted).min(last);
        let before = block.checked_sub(1).map_or(0.0, |before| sums[before]);
        let block = start + block;
        let chances = self.chances[block].to_array();
        let (mut left, mut found) = (wanted - before, None);
        for (lane, &chance) in chances.iter().enumerate().filter(|(_, c)| **c > 0.0) {
            found = Some((lane, chance, left));
            if left < chance {
                break;
            }
            left -= chance;
        }
        // Rounding may lead beyond the last.
        let (lane, chance, left) = found?;
        Some(Choice {
            block,
            lane,
            probability: chance / total,
            rest: (left / chance).clamp(0.0, 0.999_999_94),
        })
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "whole and not negative"
)]
fn whole(x: f64) -> u32 {
    x as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash;
    use crate::solve::stochastic::lights::Lamp;
    use glam::Vec3;

    fn unit(seed: u64, i: u64) -> f32 {
        (hash(seed, i) >> 40) as f32 / (1 << 24) as f32
    }

    fn lamps() -> Vec<Lamp> {
        let lamp = |i: u64| Lamp {
            centroid: Vec3::new(unit(i, 1), 1.0 + unit(i, 2), unit(i, 3)) * 4.0,
            normal: Vec3::new(unit(i, 4) - 0.5, -1.0, unit(i, 5) - 0.5).normalize(),
            radius: 0.05 + 0.1 * unit(i, 6),
            flux: vec![1.0 + unit(i, 7), 0.5],
        };
        (0..90).map(lamp).collect()
    }

    fn receiver() -> Place {
        Place::disc(Vec3::new(2.0, 0.0, 1.0), Vec3::Y, 0.2)
    }

    fn looked(lamps: &[Lamp]) -> (Lights, View, Sight) {
        let lights = Lights::new(lamps);
        let parts = lights.parts(&receiver());
        let view = View::new(&lights, &receiver(), &parts, 2.0);
        let mut sight = Sight::default();
        view.look(&receiver(), &vec![1.0; parts.len()], &mut sight);
        (lights, view, sight)
    }

    /// `F cos θ cos θ' / π d²` between points.
    fn kernel(lamp: &Lamp, from: Vec3, to: Vec3) -> f32 {
        let offset = to - from;
        let cosines = offset.dot(lamp.normal).max(0.0) * offset.dot(-Vec3::Y).max(0.0);
        cosines * FRAC_1_PI / offset.length_squared().powi(2)
    }

    #[test]
    fn all_that_is_visible_brings_the_sum_of_the_kernels() {
        let lamps = lamps();
        let (_, _, sight) = looked(&lamps);
        for (channel, found) in sight.total().enumerate() {
            let bring = |lamp: &Lamp| {
                let kernel = kernel(lamp, lamp.centroid, receiver().centroid);
                f64::from(kernel * lamp.flux[channel])
            };
            let exact: f64 = lamps.iter().map(bring).sum();
            assert!((found / exact - 1.0).abs() < 1e-4, "{found} for {exact}");
        }
    }

    #[test]
    fn bounds_hold_between_all_points() {
        for lamp in lamps() {
            let (_, view, _) = looked(core::slice::from_ref(&lamp));
            let [_, bound] = view.blocks[0].kernels(&receiver());
            let bound = bound.to_array()[0];
            let flux: f32 = lamp.flux.iter().sum();
            for i in 0..40 {
                let angle = |k: u64| (unit(i, k) * core::f32::consts::TAU).sin_cos();
                let ((s, c), (t, d)) = (angle(1), angle(2));
                let (x, y) = lamp.normal.any_orthonormal_pair();
                let from = lamp.centroid + (x * s + y * c) * lamp.radius;
                let to = receiver().centroid + Vec3::new(t, 0.0, d) * receiver().radius;
                // The distance is that of the centres: both may be nearer by their radii.
                let offset = to - from;
                let far = (lamp.centroid - receiver().centroid)
                    .length_squared()
                    .powi(2);
                let found = flux * kernel(&lamp, from, to) * offset.length_squared().powi(2) / far;
                assert!(found <= 1.0001 * bound, "{found} beyond {bound}");
            }
        }
    }

    #[test]
    fn lamps_are_chosen_by_their_chances() {
        let (lights, view, sight) = looked(&lamps());
        for (part, &(start, end, total)) in sight.parts.iter().enumerate() {
            let chances = sight.chances[start..end].iter().flat_map(|c| c.to_array());
            assert!(
                (chances.sum::<f32>() / total - 1.0).abs() < 1e-4,
                "they sum up"
            );
            for sample in 0..200_u16 {
                let sample = f32::from(sample) / 200.0;
                let choice = sight.choose(part, sample).expect("a lamp");
                assert!(lights.is_lamp(view.node(&choice)), "a lamp by itself");
                assert!((0.0..1.0).contains(&choice.rest), "{}", choice.rest);
                assert!(
                    choice.probability > 0.0 && choice.probability <= 1.0,
                    "it may be"
                );
            }
        }
    }

    #[test]
    fn each_part_counts_once_in_the_mean() {
        let (_, _, sight) = looked(&lamps());
        for rays in [1, 16, 64, 1024] {
            const OFFSETS: u16 = 500;
            let mut counts = vec![0.0_f64; sight.parts.len()];
            for offset in 0..OFFSETS {
                let offset = (f32::from(offset) + 0.5) / f32::from(OFFSETS);
                let mut cast = 0;
                for stratum in sight.strata(rays, offset) {
                    counts[stratum.part] += f64::from(stratum.rays)
                        / f64::from(stratum.expected_rays)
                        / f64::from(OFFSETS);
                    cast += stratum.rays;
                }
                assert_eq!(cast, rays, "all are cast");
            }
            for (part, count) in counts.iter().enumerate() {
                let share = f64::from(sight.parts[part].2) / sight.chance * f64::from(rays);
                // As often as the offsets are fine enough to tell.
                let error = 2.0 / f64::from(OFFSETS) / share.min(1.0) + 1e-4;
                assert!((count - 1.0).abs() < error, "{count} of a share of {share}");
            }
        }
    }

    #[test]
    fn what_is_left_out_brings_nothing_until_it_is_let_in_again() {
        let lamps = lamps();
        let (lights, mut view, mut sight) = looked(&lamps);
        let all = sight.chance;
        let shares = vec![1.0; view.part_count()];
        view.leave_out(&lights, (0..lamps.len()).map(|lamp| lights.position(lamp)));
        view.look(&receiver(), &shares, &mut sight);
        assert_eq!(sight.chance, 0.0, "all are left out");
        assert_eq!(sight.strata(16, 0.5).count(), 0, "no rays");
        view.leave_out(&lights, core::iter::empty());
        view.look(&receiver(), &shares, &mut sight);
        assert_eq!(sight.chance, all, "all are back");
    }
}
