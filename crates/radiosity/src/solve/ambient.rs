//! The ambient term: a guess of the light still to come (Cohen, Chen, Wallace, Greenberg 1988).

use crate::patch::PatchMesh;
use crate::solution::{BANDS, Solution};
use crate::solve::shot::to_f32;
use hemicube_raster::Rgb;

/// Irradiance that the unshot light would bring if it were spread evenly and reflected for ever:
/// `κ Σ ΔB_i A_i / Σ A_i · 1 / (1 - κ ρ̄)` with the area-weighted mean reflectance `ρ̄` and the share `κ` of what is shot
/// that meets a surface. The textbook has κ = 1; here it is what absorbed and escaped light tell so far.
///
/// It is for pictures of unfinished solutions and never enters the energy. In open scenes it overestimates before the
/// first shot, when nothing has escaped yet.
pub fn ambient_irradiance(solution: &Solution) -> Rgb {
    let interior = Interior::new(solution.mesh());
    let of_band = |band| {
        let kept = interior.kept(solution, band);
        to_f32(interior.ambient(band, solution.unshot_flux(band), kept))
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
        // Nothing is lit where all is buried.
        let area = area.max(f64::MIN_POSITIVE);
        Self {
            area,
            reflectance: reflecting.map(|sum| (sum / area).min(0.999)),
        }
    }

    /// The share κ of light that meets a surface when it is shot.
    ///
    /// Of what is shot, `1 - κ` escapes and `κ (1 - ρ̄)` is absorbed, so the two that are known give κ. What first hits
    /// of sun, sky and points left in surfaces was never shot and does not count.
    fn kept(&self, solution: &Solution, band: usize) -> f64 {
        let mesh = solution.mesh();
        let exitance = |group: usize| -> f64 {
            let elements = solution.exitance(group, band).iter().enumerate();
            elements
                .map(|(e, &b)| f64::from(b) * f64::from(mesh.exposed_area(e)))
                .sum()
        };
        let balance = solution.total_balance(band);
        let emitted: f64 = (0..solution.groups().len()).map(exitance).sum();
        let lost = 1.0 - self.reflectance[band];
        let absorbed = balance.absorbed - lost * (balance.emitted - emitted);
        if balance.escaped > 0.0 {
            absorbed.max(0.0) / (absorbed.max(0.0) + lost * balance.escaped)
        } else {
            1.0
        }
    }

    /// Irradiance that an unshot flux would bring in the end if the share `kept` of it meets a surface at each shot.
    pub(super) fn ambient(&self, band: usize, unshot: f64, kept: f64) -> f64 {
        unshot * kept / self.area / (1.0 - self.reflectance[band] * kept)
    }
}
