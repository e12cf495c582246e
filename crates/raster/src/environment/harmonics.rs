//! Spherical harmonics: light from all directions as a few numbers, and the irradiance that follows from them.

use super::EnvironmentMap;
use crate::Rgb;
use core::f64::consts::PI;
use glam::Vec3;
use rayon::prelude::*;

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
    /// cut into parts where the map is small, so that uniform light has no other coefficients than the first, to 1e-4.
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
    /// Degree 2 is within 1 % of the mean on average and 3 % for skies, and up to 9 % where one small light is all.
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

/// Irradiance of a surface with this unit normal as the sum over all texels, with exact solid angles: slow, and the truth
/// for [`SphericalHarmonics::irradiance`].
pub fn irradiance_by_texels(map: &EnvironmentMap, normal: Vec3) -> Rgb {
    let angles = map.solid_angles();
    let rows = (0..map.projection().faces() * map.height()).into_par_iter();
    let sums: Vec<[f64; 3]> = rows
        .map(|row| {
            let mut sum = [0.0; 3];
            map.parts_of_row(row, &angles, |direction, light, solid_angle| {
                let weight = f64::from(direction.dot(normal).max(0.0)) * solid_angle;
                for (band, sum) in sum.iter_mut().enumerate() {
                    *sum += f64::from(light[band]) * weight;
                }
            });
            sum
        })
        .collect();
    let total = |band: usize| sums.iter().map(|sum| sum[band]).sum::<f64>();
    #[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
    let light = [0, 1, 2].map(|band| total(band) as f32);
    Rgb::from(light)
}
