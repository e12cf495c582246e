//! The ambient term: a guess of the light still to come (Cohen, Chen, Wallace, Greenberg 1988).

use crate::patch::PatchMesh;
use crate::solution::{BANDS, EnergyBalance, Solution};
use crate::solve::shot::to_f32;
use hemicube_raster::Rgb;

/// Irradiance that the unshot light would bring if it were spread evenly and reflected for ever:
/// `κ Σ ΔB_i A_i / Σ A_i · 1 / (1 - κ ρ̄)` with the area-weighted mean reflectance `ρ̄` and the share `κ` of what is shot
/// that meets a surface. The textbook has κ = 1; here it is what absorbed and escaped light tell so far.
///
/// It is for pictures of unfinished solutions and never enters the energy. In open scenes it overestimates before the
/// first shot, when nothing has escaped yet.
pub fn ambient_irradiance(solution: &Solution) -> Rgb {
    let unshot = [0, 1, 2].map(|band| solution.unshot_flux(band));
    let balance = [0, 1, 2].map(|band| solution.total_balance(band));
    AmbientTerm::new(solution).irradiance(unshot, balance)
}

/// The ambient term of a scene whose light is kept elsewhere: sums over its elements are enough.
#[derive(Clone)]
pub struct AmbientTerm {
    interior: Interior,
    /// Flux of all emitters that have an area.
    exitance: [f64; BANDS],
}

impl core::fmt::Debug for AmbientTerm {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("AmbientTerm").finish_non_exhaustive()
    }
}

impl AmbientTerm {
    /// For the mesh and the emitters of a solution.
    pub fn new(solution: &Solution) -> Self {
        let mesh = solution.mesh();
        let flux = |group: usize, band: usize| -> f64 {
            let elements = solution.exitance(group, band).iter().enumerate();
            elements
                .map(|(e, &b)| f64::from(b) * f64::from(mesh.exposed_area(e)))
                .sum()
        };
        let groups = solution.groups().len();
        Self {
            interior: Interior::new(mesh),
            exitance: [0, 1, 2].map(|band| (0..groups).map(|group| flux(group, band)).sum()),
        }
    }

    /// The term of [`ambient_irradiance`], of the unshot flux and the energy balance in each band.
    pub fn irradiance(&self, unshot: [f64; BANDS], balance: [EnergyBalance; BANDS]) -> Rgb {
        let of_band = |band: usize| {
            let kept = self.interior.kept(band, balance[band], self.exitance[band]);
            to_f32(self.interior.ambient(band, unshot[band], kept))
        };
        Rgb::new(of_band(0), of_band(1), of_band(2))
    }

    /// Area of all surfaces.
    pub fn area(&self) -> f64 {
        self.interior.area
    }
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
    fn kept(&self, band: usize, balance: EnergyBalance, exitance: f64) -> f64 {
        let lost = 1.0 - self.reflectance[band];
        let absorbed = balance.absorbed - lost * (balance.emitted - exitance);
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
