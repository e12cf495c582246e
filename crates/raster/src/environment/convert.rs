//! From one projection to another, keeping the light.
//!
//! Each texel of the target is the mean over its part of the sphere: samples on a grid in it, weighted by solid angle and
//! so close that they are at most half a texel of the source apart, read the source bilinearly. A mean of samples keeps a
//! uniform light exactly, but not the flux of a single bright texel: the sun counts as often as samples happen to fall
//! near it. So the weights are balanced first (Sinkhorn and Knopp 1967): a source texel of solid angle `Ω` that received
//! the weight `W` counts `Ω / W` times, and the means are taken with these counts. More rounds of that bring both sums, of
//! source and of target texels, together; the matrix of weights is never stored, only its sums. A texel that no sample met,
//! such as those thinner than a hair at a pole, hands its light to the target texels that it covers.
//!
//! Texels wholly outside the disc of a sphere, angular or fisheye map are black, as in photographs; those that the rim
//! crosses have the light of their part inside. Around the halves of a paraboloid lies what the other half shows there, for
//! filters that reach over the rim.
//!
//! What is still out of balance then is spread evenly ([`Conversion::spread`]). Measured: of a photographed sunset, 1024 x
//! 512 to six projections of 96 and 256 rows, 3e-6 to 4e-4 of the flux after one round; of a sun in a single texel of a map
//! of 16 rows up to 3 %, and more in the long, thin texels at the rim of an angular or sphere map.

use super::{EnvironmentMap, Projection};
use crate::Rgb;
use core::sync::atomic::{AtomicU64, Ordering};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// How maps are converted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ConvertOptions {
    /// Rows of a face of the target, 1 to 8192; 0 for as many as keep the finest detail of the source in the middle of a
    /// face. Default value: 0.
    pub rows: usize,
    /// Samples by texel of the source in each direction, 1 to 8. Default value: 2.
    pub density: u32,
    /// Rounds of balancing, see the module; each takes about as long as the conversion itself. They are left out where one
    /// of the projections does not show the whole sphere. Default value: 1.
    pub rounds: u32,
}

impl Default for ConvertOptions {
    fn default() -> Self {
        Self {
            rows: 0,
            density: 2,
            rounds: 1,
        }
    }
}

impl ConvertOptions {
    /// Another size of the target's faces.
    pub fn with_rows(self, rows: usize) -> Self {
        Self { rows, ..self }
    }

    /// More samples, or fewer.
    pub fn with_density(self, density: u32) -> Self {
        Self { density, ..self }
    }

    /// More rounds of balancing, or none.
    pub fn with_rounds(self, rounds: u32) -> Self {
        Self { rounds, ..self }
    }
}

/// Most rows of a target.
const MAX_ROWS: usize = 8192;

/// Most samples along a side of a target texel.
const MAX_SAMPLES: f32 = 128.0;

/// Parts along a side of a texel that no sample met.
const PARTS: usize = 8;

/// What a conversion did to the light, to be checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    /// Sum of the solid angles of the target's texels by what its projection covers, less 1.
    pub solid_angle_error: f64,
    /// `∫ L dω` of the source.
    pub flux_before: [f64; 3],
    /// `∫ L dω` of the target before what was still missing, or too much, was spread evenly.
    pub flux_balanced: [f64; 3],
    /// `∫ L dω` of the target. Less than before where it covers less of the sphere.
    pub flux_after: [f64; 3],
    /// Source texels that no sample met.
    pub unmet: usize,
}

impl Conversion {
    fn of_nothing(map: &EnvironmentMap) -> Self {
        let total: f64 = map.projection().faces() as f64 * map.solid_angles().iter().sum::<f64>();
        let flux = map.flux();
        Self {
            solid_angle_error: total / map.projection().covered() - 1.0,
            flux_before: flux,
            flux_balanced: flux,
            flux_after: flux,
            unmet: 0,
        }
    }

    /// The largest relative change of the flux of a band; 0 where there was none.
    pub fn flux_error(&self) -> f64 {
        largest_change(self.flux_before, self.flux_after)
    }

    /// As [`Self::flux_error`], before the rest was spread evenly: how much light is not quite where it was.
    pub fn spread(&self) -> f64 {
        largest_change(self.flux_before, self.flux_balanced)
    }
}

fn largest_change(before: [f64; 3], after: [f64; 3]) -> f64 {
    let change = |band: usize| {
        if before[band] == 0.0 {
            after[band].abs()
        } else {
            (after[band] / before[band] - 1.0).abs()
        }
    };
    (0..3).map(change).fold(0.0, f64::max)
}

/// The same map with the flux of each band made what it was.
fn scaled(map: &EnvironmentMap, wanted: [f64; 3], is: [f64; 3]) -> EnvironmentMap {
    #[expect(clippy::cast_possible_truncation, reason = "a ratio near 1")]
    let ratio = |band: usize| (wanted[band] / is[band]) as f32;
    let factor = [0, 1, 2].map(|band| {
        let ratio = ratio(band);
        // Bands without light, or where negative values cancel positive ones.
        if ratio.is_finite() && (ratio - 1.0).abs() < 0.25 {
            ratio
        } else {
            1.0
        }
    });
    map.map(|&light| light * Rgb::from(factor))
}

/// Rows of a face for which the coarsest part of a projection is as fine as the source on average; of a panorama, as
/// fine as its horizon, for towards the poles its texels become as thin as hairs, which is no detail.
pub fn matching_rows(source: &EnvironmentMap, to: Projection) -> usize {
    let from = source.projection();
    if from == to {
        return source.height();
    }
    let of_texel = |projection: Projection, at: Vec2| {
        let (width, height) = projection.face_size(1);
        f64::from(projection.density(at)) / (width * height) as f64
    };
    let middle = Vec2::splat(0.5);
    let average = if from == Projection::LatLong {
        of_texel(from, middle)
    } else {
        let used = if from.disc().is_some() {
            core::f64::consts::FRAC_PI_4
        } else {
            1.0
        };
        from.covered() / (used * from.faces() as f64)
    };
    let coarsest = match to {
        Projection::Octahedral => Vec2::splat(0.25),
        _ => middle,
    };
    let rows = source.height() as f64 * (of_texel(to, coarsest) / average).sqrt();
    // Even rows keep the octahedron's folds and the poles between texels.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 1 to 4096"
    )]
    let rows = (rows / 2.0).round().clamp(1.0, MAX_ROWS as f64 / 2.0) as usize;
    2 * rows
}

/// A map in another projection, and what became of the light.
pub fn convert(
    source: &EnvironmentMap,
    to: Projection,
    options: &ConvertOptions,
) -> (EnvironmentMap, Conversion) {
    let rows = match options.rows {
        0 => matching_rows(source, to),
        rows => rows.min(MAX_ROWS),
    };
    let (width, height) = to.face_size(rows);
    if (source.projection(), source.width(), source.height()) == (to, width, height) {
        return (source.clone(), Conversion::of_nothing(source));
    }
    let target = Target {
        projection: to,
        width,
        height,
        density: options.density.clamp(1, 8) as f32,
    };
    let is_whole = to.covers_sphere() && source.projection().covers_sphere();
    let rounds = if is_whole { options.rounds } else { 0 };
    let balance = target.balance(source, rounds);
    let map = EnvironmentMap::of_rows(to, width, height, |face, x, y| {
        target.mean(source, &balance, [face, x, y])
    });
    let flux_before = source.flux();
    let balanced = map.flux();
    let map = if rounds > 0 {
        scaled(&map, flux_before, balanced)
    } else {
        map
    };
    let angles = map.solid_angles();
    let total: f64 = to.faces() as f64 * angles.iter().sum::<f64>();
    let conversion = Conversion {
        solid_angle_error: total / to.covered() - 1.0,
        flux_before,
        flux_balanced: balanced,
        flux_after: map.flux(),
        unmet: balance.unmet,
    };
    (map, conversion)
}

/// The map that is to be.
#[derive(Debug)]
struct Target {
    projection: Projection,
    width: usize,
    height: usize,
    density: f32,
}

/// A source texel that no sample met: where its light goes, and how much.
#[derive(Debug)]
struct Handed {
    texel: usize,
    light: Rgb,
    solid_angle: f64,
}

/// How weights are balanced.
#[derive(Debug)]
struct Balance {
    /// How often each source texel counts.
    counts: Vec<f32>,
    /// Those that no sample met, ordered by where their light goes.
    handed: Vec<Handed>,
    /// How many those are.
    unmet: usize,
}

impl Balance {
    /// What a target texel is handed.
    fn handed_to(&self, texel: usize) -> impl Iterator<Item = &Handed> {
        let first = self.handed.partition_point(|handed| handed.texel < texel);
        let rest = self.handed[first..].iter();
        rest.take_while(move |handed| handed.texel == texel)
    }
}

/// Weights are counted in whole numbers, so that the sum does not depend on the order of threads: 4π is below 16.
const COUNT_SCALE: f64 = (1_u64 << 58) as f64 / 16.0;

impl Target {
    fn size(&self) -> Vec2 {
        Vec2::new(self.width as f32, self.height as f32)
    }

    /// Samples along s and t of a texel that are close enough for the source.
    fn grid(&self, source: &EnvironmentMap, face: usize, middle: Vec2) -> (usize, usize) {
        let half = 0.5 / self.size();
        let to = |offset: Vec2| self.projection.direction(face, middle + offset);
        let along_s = to(Vec2::new(half.x, 0.0)) - to(Vec2::new(-half.x, 0.0));
        let along_t = to(Vec2::new(0.0, half.y)) - to(Vec2::new(0.0, -half.y));
        let [s, t] = source.projection().gradient(to(Vec2::ZERO));
        let (width, height) = (source.width() as f32, source.height() as f32);
        let steps = |d: Vec3| {
            let texels = (s.dot(d).abs() * width).max(t.dot(d).abs() * height);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "clamped"
            )]
            let steps = (self.density * texels).ceil().clamp(1.0, MAX_SAMPLES) as usize;
            steps
        };
        (steps(along_s), steps(along_t))
    }

    /// Source texels and their weights in a texel of the target, which sum to its solid angle; none outside a disc.
    fn taps(
        &self,
        source: &EnvironmentMap,
        [face, x, y]: [usize; 3],
        taps: &mut Vec<(usize, f64)>,
    ) {
        taps.clear();
        let corner = Vec2::new(x as f32, y as f32);
        let (columns, rows) = self.grid(source, face, (corner + 0.5) / self.size());
        let step = self.size().recip() / Vec2::new(columns as f32, rows as f32);
        let is_disc = self.projection.disc().is_some();
        let mut sum = 0.0;
        for row in 0..rows {
            for column in 0..columns {
                let share = Vec2::new(column as f32, row as f32) + 0.5;
                let at = corner / self.size() + share * step;
                if is_disc && (2.0 * at - 1.0).length_squared() > 1.0 {
                    continue;
                }
                let density = f64::from(self.projection.density(at));
                sum += density;
                let direction = self.projection.direction(face, at);
                if let Some((face, place)) = source.projection().coordinates(direction) {
                    let around = source.taps(face, place).into_iter();
                    let used = around.filter(|&(_, weight)| weight > 0.0);
                    taps.extend(used.map(|(index, weight)| (index, density * f64::from(weight))));
                }
            }
        }
        let scale = self.solid_angle([face, x, y]) / sum;
        for (_, weight) in taps {
            *weight *= scale;
        }
    }

    fn solid_angle(&self, [_, x, y]: [usize; 3]) -> f64 {
        self.projection
            .texel_solid_angle((self.width, self.height), x, y)
    }

    /// How often each source texel counts, and what happens to the light of those that do not.
    fn balance(&self, source: &EnvironmentMap, rounds: u32) -> Balance {
        let mut balance = Balance {
            counts: vec![1.0; source.texels().len()],
            handed: vec![],
            unmet: 0,
        };
        let angles = source.solid_angles();
        for round in 0..rounds {
            let received = self.received(source, &balance);
            for (index, (count, received)) in balance.counts.iter_mut().zip(received).enumerate() {
                let wanted = angles[index % angles.len()];
                #[expect(clippy::cast_possible_truncation, reason = "a ratio")]
                let ratio = (wanted / received) as f32;
                *count = if received > 1e-6 * wanted { ratio } else { 0.0 };
            }
            if round == 0 {
                balance.unmet = balance.counts.iter().filter(|&&count| count == 0.0).count();
                balance.handed = self.handed_over(source, &balance.counts);
            }
        }
        balance
    }

    /// The weight that each source texel gets from all means together.
    fn received(&self, source: &EnvironmentMap, balance: &Balance) -> Vec<f64> {
        let received: Vec<AtomicU64> = source.texels().iter().map(|_| AtomicU64::new(0)).collect();
        let rows = self.projection.faces() * self.height;
        (0..rows)
            .into_par_iter()
            .for_each_init(Vec::new, |taps, row| {
                for x in 0..self.width {
                    let texel = [row / self.height, x, row % self.height];
                    let whole = self.solid_angle(texel);
                    self.taps(source, texel, taps);
                    let count =
                        |&(index, weight): &(usize, f64)| weight * f64::from(balance.counts[index]);
                    let mut sum: f64 = taps.iter().map(count).sum();
                    sum += balance
                        .handed_to(self.index(texel))
                        .map(|h| h.solid_angle)
                        .sum::<f64>();
                    for &(index, weight) in &*taps {
                        #[expect(
                            clippy::cast_possible_truncation,
                            clippy::cast_sign_loss,
                            reason = "below 2^58"
                        )]
                        let weight = (weight * whole / sum * COUNT_SCALE) as u64;
                        received[index].fetch_add(weight, Ordering::Relaxed);
                    }
                }
            });
        let sums = received
            .into_iter()
            .map(|sum| sum.into_inner() as f64 / COUNT_SCALE);
        sums.collect()
    }

    fn index(&self, [face, x, y]: [usize; 3]) -> usize {
        (face * self.height + y) * self.width + x
    }

    /// The light of texels that count 0 times, ordered by the texel that gets it.
    fn handed_over(&self, source: &EnvironmentMap, counts: &[f32]) -> Vec<Handed> {
        let angles = source.solid_angles();
        let unmet = (0..counts.len()).filter(|&i| counts[i] == 0.0);
        let unmet = unmet.filter(|i| angles[i % angles.len()] > 0.0);
        let mut handed: Vec<Handed> = unmet
            .flat_map(|i| self.handed_by(source, i, angles[i % angles.len()]))
            .collect();
        handed.sort_by_key(|handed| handed.texel);
        handed
    }

    /// The light of one source texel, spread over where its parts lie in the target.
    fn handed_by(&self, source: &EnvironmentMap, index: usize, solid_angle: f64) -> Vec<Handed> {
        let (width, height) = (source.width(), source.height());
        let (face, rest) = (index / (width * height), index % (width * height));
        let corner = Vec2::new((rest % width) as f32, (rest / width) as f32);
        let is_disc = source.projection().disc().is_some();
        let part = |i: usize| {
            let share = Vec2::new((i % PARTS) as f32, (i / PARTS) as f32) + 0.5;
            let at = (corner + share / PARTS as f32) / Vec2::new(width as f32, height as f32);
            if is_disc && (2.0 * at - 1.0).length_squared() > 1.0 {
                return None;
            }
            let direction = source.projection().direction(face, at);
            let (face, place) = self.projection.coordinates(direction)?;
            let (x, y) = super::azimuthal::nearest([self.width, self.height], place);
            Some(Handed {
                texel: self.index([face, x, y]),
                light: source.texels()[index],
                solid_angle: f64::from(source.projection().density(at)),
            })
        };
        let mut parts: Vec<Handed> = (0..PARTS * PARTS).filter_map(part).collect();
        let total: f64 = parts.iter().map(|part| part.solid_angle).sum();
        for part in &mut parts {
            part.solid_angle *= solid_angle / total;
        }
        parts
    }

    /// Mean light of a texel; black outside a disc.
    fn mean(&self, source: &EnvironmentMap, balance: &Balance, texel: [usize; 3]) -> Rgb {
        let [_, x, y] = texel;
        if !self.projection.shows((self.width, self.height), x, y) {
            return Rgb::BLACK;
        }
        let mut sum = [0.0; 3];
        let mut weights = 0.0;
        let mut add = |light: Rgb, weight: f64| {
            weights += weight;
            for (band, sum) in sum.iter_mut().enumerate() {
                *sum += f64::from(light[band]) * weight;
            }
        };
        let lights = source.texels();
        let mut taps = Vec::new();
        self.taps(source, texel, &mut taps);
        for &(index, weight) in &taps {
            add(lights[index], weight * f64::from(balance.counts[index]));
        }
        for handed in balance.handed_to(self.index(texel)) {
            add(handed.light, handed.solid_angle);
        }
        // What a fisheye does not show is black; the rest of its texel still counts.
        let divisor = if source.projection().covers_sphere() {
            weights
        } else {
            self.solid_angle(texel)
        };
        if weights <= 0.0 || divisor <= 0.0 {
            return self.beside(source, texel);
        }
        #[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
        let mean = sum.map(|band| (band / divisor) as f32);
        Rgb::from(mean)
    }

    /// Light of a texel outside the rim of a paraboloid, or of one that met only texels without weight.
    fn beside(&self, source: &EnvironmentMap, [face, x, y]: [usize; 3]) -> Rgb {
        let middle = (Vec2::new(x as f32, y as f32) + 0.5) / self.size();
        source.radiance(self.projection.direction(face, middle))
    }
}
