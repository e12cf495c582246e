//! Spherical harmonics: light from all directions as a few numbers, and the irradiance that follows from them.

use super::EnvironmentMap;
use crate::Rgb;
use core::f64::consts::PI;
use glam::Vec3;
use rayon::prelude::*;
use wide::f32x8;

/// Light as a sum of real, orthonormal spherical harmonics `Y_lm` up to a degree, with y as the axis.
///
/// A uniform radiance `L` has the one coefficient `L √(4π)`.
#[derive(Debug, Clone, PartialEq)]
pub struct SphericalHarmonics {
    degree: usize,
    /// `l² + l + m`-th: degree l, order m.
    coefficients: Vec<[f64; 3]>,
}

impl SphericalHarmonics {
    /// Highest degree.
    pub const MAX_DEGREE: usize = 16;

    /// Light of a map, up to a degree (clamped to [`Self::MAX_DEGREE`]): sums over texels with exact solid angles, each
    /// cut into parts where the map is small, so that uniform light has no other coefficients than the first, to 1e-3.
    pub fn of_map(map: &EnvironmentMap, degree: usize) -> Self {
        let degree = degree.min(Self::MAX_DEGREE);
        let angles = map.solid_angles();
        // Rows are summed in parallel and then in their order, so the sum does not depend on threads.
        let rows = (0..map.projection().faces() * map.height()).into_par_iter();
        let sums: Vec<Vec<[f64; 3]>> = rows
            .map(|row| {
                let mut sum = vec![[0.0; 3]; (degree + 1).pow(2)];
                map.parts_of_row(row, &angles, |direction, light, weight| {
                    accumulate(&mut sum, direction, light, weight);
                });
                sum
            })
            .collect();
        let mut coefficients = vec![[0.0; 3]; (degree + 1).pow(2)];
        for row in sums {
            add(&mut coefficients, &row);
        }
        Self {
            degree,
            coefficients,
        }
    }

    /// Highest degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Coefficients of red, green and blue; degree l, order m at `l² + l + m`.
    pub fn coefficients(&self) -> &[[f64; 3]] {
        &self.coefficients
    }

    /// The sum in a direction of unit length: light with its detail left out. May be negative beside something bright.
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        self.weighted(direction, |_| 1.0)
    }

    /// Irradiance of a surface with this unit normal (Ramamoorthi and Hanrahan 2001): `E = Σ A_l L_lm Y_lm(n)`, with
    /// `A_0 = π`, `A_1 = 2π/3`, `A_2 = π/4`, then 0 for odd degrees and little for even ones.
    ///
    /// Measured against [`IrradianceSum`], root of the mean square over all normals by the mean: degree 2 is off by 0.25 %
    /// for a soft sky over a tiled ground, by 1.3 % with a low sun and two lamps, by 14 % where one small lamp is all there is;
    /// degree 4 by 0.1 %, 0.5 % and 7 %.
    pub fn irradiance(&self, normal: Vec3) -> Rgb {
        self.weighted(normal, cosine_lobe)
    }

    fn weighted(&self, direction: Vec3, weight: impl Fn(usize) -> f64) -> Rgb {
        let mut values = [0.0; (Self::MAX_DEGREE + 1).pow(2)];
        let values = &mut values[..self.coefficients.len()];
        evaluate(direction, values);
        let mut sum = [0.0; 3];
        for l in 0..=self.degree {
            let factor = weight(l);
            let of_degree = l * l..(l + 1) * (l + 1);
            let pairs = self.coefficients[of_degree.clone()]
                .iter()
                .zip(&values[of_degree]);
            for (coefficient, value) in pairs {
                for (band, sum) in sum.iter_mut().enumerate() {
                    *sum += factor * coefficient[band] * value;
                }
            }
        }
        #[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
        let light = sum.map(|x| x as f32);
        Rgb::from(light)
    }
}

fn add(to: &mut [[f64; 3]], from: &[[f64; 3]]) {
    for (to, from) in to.iter_mut().zip(from) {
        for (to, from) in to.iter_mut().zip(from) {
            *to += from;
        }
    }
}

fn accumulate(sum: &mut [[f64; 3]], direction: Vec3, light: Rgb, weight: f64) {
    let mut values = [0.0; (SphericalHarmonics::MAX_DEGREE + 1).pow(2)];
    let values = &mut values[..sum.len()];
    evaluate(direction, values);
    for (sum, value) in sum.iter_mut().zip(values) {
        for (band, sum) in sum.iter_mut().enumerate() {
            *sum += f64::from(light[band]) * weight * *value;
        }
    }
}

/// Coefficient of degree l of the clamped cosine by `√(4π/(2l+1))`: `A_l` of Ramamoorthi and Hanrahan, equation 8.
fn cosine_lobe(l: usize) -> f64 {
    match l {
        0 => PI,
        1 => 2.0 * PI / 3.0,
        _ if l % 2 == 1 => 0.0,
        _ => {
            let half = l / 2;
            let sign = if half % 2 == 1 { 1.0 } else { -1.0 };
            // l! / (2^l (l/2)!²) = Π (2k - 1) / 2k
            let ratio: f64 = (1..=half)
                .map(|k| (2 * k - 1) as f64 / (2 * k) as f64)
                .product();
            sign * 2.0 * PI * ratio / ((l + 2) as f64 * (l - 1) as f64)
        }
    }
}

/// All `Y_lm` of a direction of unit length, as many whole degrees as there is room for.
///
/// With the axis y, `P_l^m` by the stable recurrences in l, `sin^m θ cos mφ` as powers of a complex number, and the norms
/// `√((2l+1)/4π · (l-m)!/(l+m)!)`, times √2 for m ≠ 0, folded into them.
fn evaluate(direction: Vec3, values: &mut [f64]) {
    let [x, y, z] = direction.to_array().map(f64::from);
    let degree = values.len().isqrt() - 1;
    // Real and imaginary part of (z + i x)^m
    let (mut cos, mut sin) = (1.0, 0.0);
    let mut diagonal = (1.0 / (4.0 * PI)).sqrt();
    for m in 0..=degree {
        let (mut before, mut now) = (0.0, diagonal);
        for l in m..=degree {
            let scale = if m == 0 {
                1.0
            } else {
                core::f64::consts::SQRT_2
            };
            values[l * l + l + m] = scale * now * cos;
            values[l * l + l - m] = if m == 0 { now } else { scale * now * sin };
            // The next degree, with norms: Y_{l+1} = a (y Y_l - b Y_{l-1})
            let (l, m) = ((l + 1) as f64, m as f64);
            let a = ((4.0 * l * l - 1.0) / (l * l - m * m)).sqrt();
            let b = (((l - 1.0).powi(2) - m * m) / (4.0 * (l - 1.0).powi(2) - 1.0)).sqrt();
            (before, now) = (now, a * (y * now - b * before));
        }
        (cos, sin) = (cos * z - sin * x, sin * z + cos * x);
        let m = (m + 1) as f64;
        diagonal *= ((2.0 * m + 1.0) / (2.0 * m)).sqrt();
    }
}

/// Irradiance of surfaces as the sum over all texels of a map: slow, and the truth for [`SphericalHarmonics::irradiance`].
///
/// Texels of small maps are cut into parts, so that the sum is an integral over what they stand for; solid angles are
/// exact.
#[derive(Debug, Clone)]
pub struct IrradianceSum {
    /// Directions of the parts, and their light by their solid angles.
    parts: Vec<[f32x8; 6]>,
}

/// Groups of eight parts that are summed in f32 before the sum goes on in f64.
const GROUPS: usize = 32;

impl IrradianceSum {
    /// Of the light of a map.
    pub fn new(map: &EnvironmentMap) -> Self {
        let angles = map.solid_angles();
        let rows = (0..map.projection().faces() * map.height()).into_par_iter();
        let of_row = |row: usize| {
            let mut parts = Vec::new();
            map.parts_of_row(row, &angles, |direction, light, solid_angle| {
                #[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
                let light = light * solid_angle as f32;
                let [x, y, z] = direction.to_array();
                parts.push([x, y, z, light.r, light.g, light.b]);
            });
            parts
        };
        let parts: Vec<[f32; 6]> = rows.flat_map_iter(of_row).collect();
        let group = |parts: &[[f32; 6]]| {
            core::array::from_fn(|i| {
                let of_lane = |lane: usize| parts.get(lane).map_or(0.0, |part| part[i]);
                f32x8::new(core::array::from_fn(of_lane))
            })
        };
        Self {
            parts: parts.chunks(8).map(group).collect(),
        }
    }

    /// Of a surface with this unit normal.
    pub fn irradiance(&self, normal: Vec3) -> Rgb {
        let normal = normal.to_array().map(f32x8::splat);
        let mut sum = [0.0_f64; 3];
        for groups in self.parts.chunks(GROUPS) {
            let mut of_groups = [f32x8::ZERO; 3];
            for [x, y, z, light @ ..] in groups {
                let cosine = *x * normal[0] + *y * normal[1] + *z * normal[2];
                let cosine = cosine.max(f32x8::ZERO);
                for (sum, &light) in of_groups.iter_mut().zip(light) {
                    *sum += light * cosine;
                }
            }
            for (sum, of_groups) in sum.iter_mut().zip(of_groups) {
                *sum += of_groups.to_array().map(f64::from).iter().sum::<f64>();
            }
        }
        #[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
        let light = sum.map(|band| band as f32);
        Rgb::from(light)
    }
}
