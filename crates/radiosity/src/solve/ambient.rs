//! The ambient term: a guess of the light still to come (Cohen, Chen, Wallace, Greenberg 1988).

use crate::patch::PatchMesh;
use crate::solution::{BANDS, EnergyBalance, Solution};
use crate::solve::shot::to_f32;
use hemicube_raster::Rgb;

/// Irradiance that the unshot light would bring if it were spread evenly and reflected for ever:
/// `Σ ΔB_i A_i / Σ A_i · 1 / (1 - ρ̄)` with the area-weighted mean reflectance `ρ̄`, less what would escape.
///
/// It is for pictures of unfinished solutions and never enters the energy. In open scenes it overestimates, since the
/// share of light that leaves is taken from what has escaped so far.
pub fn ambient_irradiance(solution: &Solution) -> Rgb {
    let interior = Interior::new(solution.mesh());
    let of_band = |band| {
        let balance = solution.total_balance(band);
        to_f32(interior.ambient(band, solution.unshot_flux(band), &balance))
    };
    Rgb::new(of_band(0), of_band(1), of_band(2))
}

/// A scene as the ambient term sees it: one area with one reflectance.
#[derive(Clone)]
pub(super) struct Interior {
    area: f64,
    /// ρ̄, weighted by area, below 1.
    reflectance: [f64; BANDS],
}

impl Interior {
    pub(super) fn new(mesh: &PatchMesh) -> Self {
        let mut area = 0.0;
        let mut reflecting = [0.0; BANDS];
        for (e, &reflectance) in mesh.reflectance().iter().enumerate() {
            let a = f64::from(mesh.exposed_area(e));
            area += a;
            for (band, sum) in reflecting.iter_mut().enumerate() {
                *sum += a * f64::from(reflectance[band]);
            }
        }
        Self {
            area,
            reflectance: reflecting.map(|sum| (sum / area).min(0.999)),
        }
    }

    /// Irradiance that an unshot flux would bring in the end; `balance` tells the share that escapes.
    pub(super) fn ambient(&self, band: usize, unshot: f64, balance: &EnergyBalance) -> f64 {
        let gone = balance.absorbed + balance.escaped;
        let kept = if gone > 0.0 {
            1.0 - balance.escaped / gone
        } else {
            1.0
        };
        unshot * kept / self.area / (1.0 - self.reflectance[band] * kept)
    }
}
