//! Mip levels of environment maps.

use super::{EnvironmentMap, Projection};
use crate::Rgb;
use glam::Vec3;

/// An environment map and its halves, down to a single texel a face; each texel is the mean of those below it, by solid
/// angle, so all levels have the same flux where sides are even.
///
/// Lookups are trilinear. Levels of a cube stay seamless, since [`EnvironmentMap::radiance`] filters across edges; those
/// of the octahedral projection do too, and longitudes wrap around at every level.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentPyramid {
    levels: Vec<EnvironmentMap>,
}

impl EnvironmentPyramid {
    /// All levels of a map.
    pub fn new(map: EnvironmentMap) -> Self {
        let mut levels = vec![map];
        while let Some(last) = levels.last() {
            if last.width().min(last.height()) == 1 {
                break;
            }
            let half = halved(last);
            levels.push(half);
        }
        Self { levels }
    }

    /// The levels, the finest first.
    pub fn levels(&self) -> &[EnvironmentMap] {
        &self.levels
    }

    /// The finest level.
    pub fn base(&self) -> &EnvironmentMap {
        &self.levels[0]
    }

    /// Radiance from a direction, between the two levels beside `lod`; 0 is the finest, what is below or NaN is taken for
    /// it, what is above the last for that.
    #[inline]
    pub fn radiance(&self, direction: Vec3, lod: f32) -> Rgb {
        let last = self.levels.len() - 1;
        let lod = lod.max(0.0).min(last as f32);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a level"
        )]
        let low = lod as usize;
        let share = lod - low as f32;
        let fine = self.levels[low].radiance(direction);
        if share == 0.0 {
            return fine;
        }
        fine.lerp(self.levels[low + 1].radiance(direction), share)
    }

    /// Radiance from a cone of this solid angle around a direction: of the level whose texel there is as large.
    pub fn radiance_of_cone(&self, direction: Vec3, solid_angle: f32) -> Rgb {
        self.radiance(direction, self.lod_of(direction, solid_angle))
    }

    /// `1/2 log2(solid angle / solid angle of the finest texel there)`, which may be negative or above the last level.
    #[inline]
    pub fn lod_of(&self, direction: Vec3, solid_angle: f32) -> f32 {
        let base = self.base();
        let Some((_, at)) = base.projection().coordinates(direction) else {
            return 0.0;
        };
        let texels = (base.width() * base.height()) as f32;
        let texel = base.projection().density(at) / texels;
        0.5 * (solid_angle / texel).log2()
    }

    /// Radiance for a pixel whose reflected direction changes by `dx` to the next column and by `dy` to the next row:
    /// of the level whose texels are as large as the longer step, as graphics interfaces choose it.
    pub fn radiance_by_derivatives(&self, direction: Vec3, dx: Vec3, dy: Vec3) -> Rgb {
        let base = self.base();
        let Some(unit) = direction.try_normalize() else {
            return Rgb::BLACK;
        };
        let [s, t] = base.projection().gradient(unit);
        let size = (base.width() as f32, base.height() as f32);
        let length = |d: Vec3| {
            let d = d.reject_from_normalized(unit) / direction.length();
            (s.dot(d) * size.0).hypot(t.dot(d) * size.1)
        };
        self.radiance(unit, length(dx).max(length(dy)).log2())
    }
}

/// The next level: means by solid angle over the texels that a larger one covers; sides that are odd are cut within texels.
fn halved(map: &EnvironmentMap) -> EnvironmentMap {
    let half = |n: usize| (n / 2).max(1);
    let (width, height) = (half(map.width()), half(map.height()));
    let angles = map.solid_angles();
    let columns: Vec<Vec<(usize, f64)>> =
        (0..width).map(|x| parts(x, width, map.width())).collect();
    EnvironmentMap::of_rows(map.projection(), width, height, |face, x, y| {
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        let (mut plain, mut count) = (Rgb::BLACK, 0.0);
        for (row, of_row) in parts(y, height, map.height()) {
            for &(column, of_column) in &columns[x] {
                let light = map.texel(face, column, row);
                let weight = of_row * of_column * angles[row * map.width() + column];
                weights += weight;
                for (band, sum) in sum.iter_mut().enumerate() {
                    *sum += f64::from(light[band]) * weight;
                }
                plain += light;
                count += 1.0;
            }
        }
        // Outside a disc nothing has a solid angle.
        if weights <= 0.0 {
            return plain / count;
        }
        #[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
        let mean = sum.map(|band| (band / weights) as f32);
        Rgb::from(mean)
    })
}

/// The texels of a row of `of` that the `i`-th of `n` larger ones covers, and their shares.
fn parts(i: usize, n: usize, of: usize) -> Vec<(usize, f64)> {
    let (start, end) = ((i * of) as f64 / n as f64, ((i + 1) * of) as f64 / n as f64);
    let all = i * of / n..((i + 1) * of).div_ceil(n);
    let share = |k: usize| (k as f64 + 1.0).min(end) - (k as f64).max(start);
    all.map(|k| (k, share(k))).collect()
}

impl From<EnvironmentMap> for EnvironmentPyramid {
    fn from(map: EnvironmentMap) -> Self {
        Self::new(map)
    }
}

impl EnvironmentPyramid {
    /// How directions become places.
    pub fn projection(&self) -> Projection {
        self.base().projection()
    }
}
