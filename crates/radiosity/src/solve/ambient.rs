//! The ambient term: a guess of the light still to come (Cohen, Chen, Wallace, Greenberg 1988).

use crate::solution::{BANDS, Solution};
use hemicube_raster::Rgb;

/// Irradiance that the unshot light would bring if it were spread evenly and reflected for ever:
/// `Σ ΔB_i A_i / Σ A_i · 1 / (1 - ρ̄)` with the area-weighted mean reflectance `ρ̄`, less what would escape.
///
/// It is for pictures of unfinished solutions and never enters the energy. In open scenes it overestimates, since the
/// share of light that leaves is taken from what has escaped so far.
pub fn ambient_irradiance(solution: &Solution) -> Rgb {
    let mesh = solution.mesh();
    let mut area = 0.0;
    let mut reflecting = [0.0; BANDS];
    for (e, &reflectance) in mesh.reflectance().iter().enumerate() {
        let a = f64::from(mesh.exposed_area(e));
        area += a;
        for (band, sum) in reflecting.iter_mut().enumerate() {
            *sum += a * f64::from(reflectance[band]);
        }
    }
    let mut ambient = Rgb::BLACK;
    for band in 0..BANDS {
        let balance = solution.total_balance(band);
        let gone = balance.absorbed + balance.escaped;
        let kept = if gone > 0.0 {
            1.0 - balance.escaped / gone
        } else {
            1.0
        };
        let mean = (reflecting[band] / area).min(0.999);
        ambient[band] = to_f32(solution.unshot_flux(band) * kept / area / (1.0 - mean * kept));
    }
    ambient
}

#[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
fn to_f32(x: f64) -> f32 {
    x as f32
}
