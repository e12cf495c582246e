//! How much of a uniform environment a rough surface mirrors (directional albedo of GGX), for environment mapping.
//!
//! With Schlick's Fresnel term `F = F0 + (1 - F0)(1 - v·h)⁵` the share is `F0 A + B` (the split sum of Karis, *Real shading
//! in Unreal Engine 4*, 2013). `A` and `B` depend on roughness and viewing angle and come from a table. Light that
//! microfacets pass to each other is missing in them; the factor `1 + F0 (1 / (A + B) - 1)` brings it back (Turquin,
//! *Practical multiple scattering compensation for microfacet models*, 2019), so that what reflects all light (`F0 = 1`)
//! reflects all of it at every roughness.

use core::f32::consts::TAU;
use glam::{Vec2, Vec3};
use hemicube_raster::Rgb;
use std::sync::OnceLock;

/// Rows (roughness) and columns (root of the cosine, so that they stand closer at grazing angles) of the table, from 0 to 1.
const SIDE: usize = 32;

/// Samples of each entry: with interpolation the error stays below 0.004, see the tests.
const SAMPLES: u32 = 512;

type Table = [[Vec2; SIDE]; SIDE];

/// The table of `A` and `B`: rows by roughness from 0 to 1, columns by the root of the cosine from 0 to 1.
pub fn split_sum_table() -> &'static [[Vec2; 32]; 32] {
    static TABLE: OnceLock<Box<Table>> = OnceLock::new();
    TABLE.get_or_init(tabulated)
}

/// Share of light that is mirrored, by reflectance straight on `f0`, cosine of the viewing angle, and roughness.
pub(crate) fn mirrored_share(f0: Rgb, cosine: f32, roughness: f32) -> Rgb {
    let [a, b] = split_sum(cosine, roughness).to_array();
    let missing = 1.0 / (a + b).max(1e-3) - 1.0;
    let share = |f0: f32| ((f0 * a + b) * (1.0 + f0 * missing)).clamp(0.0, 1.0);
    f0.map(share)
}

/// `A` and `B`, bilinear between entries.
fn split_sum(cosine: f32, roughness: f32) -> Vec2 {
    let table = split_sum_table();
    let ((x, fx), (y, fy)) = (place(cosine.max(0.0).sqrt()), place(roughness));
    let row = |y: usize| table[y][x].lerp(table[y][x + 1], fx);
    row(y).lerp(row(y + 1), fy)
}

/// The entry before a number in [0, 1], and how far it is to the next.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to the table"
)]
fn place(number: f32) -> (usize, f32) {
    let at = number.clamp(0.0, 1.0) * (SIDE - 1) as f32;
    let before = (at as usize).min(SIDE - 2);
    (before, at - before as f32)
}

fn tabulated() -> Box<Table> {
    let at = |i: usize| i as f32 / (SIDE - 1) as f32;
    Box::new(core::array::from_fn(|y| {
        core::array::from_fn(|x| integral(at(x).powi(2).max(1e-3), at(y), SAMPLES))
    }))
}

/// `A` and `B` by sampling GGX's visible normals through a spherical cap (Dupuy and Benyoub 2023), whose weights
/// `G2 / G1` stay below 1, with the height-correlated masking of Smith (Heitz 2014).
fn integral(cosine: f32, roughness: f32, samples: u32) -> Vec2 {
    let alpha = roughness * roughness;
    let view = Vec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
    let square = alpha * alpha;
    let lambda = |c: f32| (square + (1.0 - square) * c * c).sqrt();
    let mut sum = Vec2::ZERO;
    for i in 0..samples {
        let turn = f64::from(i.reverse_bits()) / f64::from(u32::MAX);
        let u = Vec2::new(narrow(turn), (i as f32 + 0.5) / samples as f32);
        let half = visible_normal(view, alpha, u);
        let along = view.dot(half);
        let light = (half * (2.0 * along) - view).z;
        if light > 0.0 {
            let seen = light * (cosine + lambda(cosine))
                / (light * lambda(cosine) + cosine * lambda(light));
            let fresnel = (1.0 - along).max(0.0).powi(5);
            sum += Vec2::new(1.0 - fresnel, fresnel) * seen;
        }
    }
    sum / samples as f32
}

fn visible_normal(view: Vec3, alpha: f32, u: Vec2) -> Vec3 {
    let stretch = Vec3::new(alpha, alpha, 1.0);
    let on_sphere = (view * stretch).normalize();
    let z = (1.0 - u.y) * (1.0 + on_sphere.z) - on_sphere.z;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * u.x).sin_cos();
    let half = Vec3::new(radius * cos, radius * sin, z) + on_sphere;
    (half * stretch).normalize_or(Vec3::Z)
}

#[expect(clippy::cast_possible_truncation, reason = "a share of a turn")]
fn narrow(x: f64) -> f32 {
    x as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirrors_reflect_what_fresnel_says() {
        for cosine in [0.2, 0.5, 0.9, 1.0] {
            let share = mirrored_share(Rgb::splat(0.04), cosine, 0.0).g;
            let schlick = 0.04 + 0.96 * (1.0 - cosine).powi(5);
            assert!(
                (share - schlick).abs() < 0.01,
                "{cosine}: {share} {schlick}"
            );
        }
    }

    #[test]
    fn whatever_reflects_all_reflects_all_at_every_roughness() {
        for i in 0..=20 {
            for j in 0..=20 {
                let share = mirrored_share(Rgb::WHITE, i as f32 / 20.0, j as f32 / 20.0).g;
                assert!((share - 1.0).abs() < 1e-5, "{i} {j}: {share}");
            }
        }
    }

    #[test]
    fn table_is_near_to_finer_sums() {
        for (cosine, roughness) in [(0.1, 0.3), (0.5, 0.5), (0.8, 1.0), (0.3, 0.8)] {
            let (coarse, fine) = (
                split_sum(cosine, roughness),
                integral(cosine, roughness, 1 << 16),
            );
            let error = (coarse - fine).abs().max_element();
            assert!(error < 4e-3, "{cosine} {roughness}: {coarse} {fine}");
        }
    }
}
