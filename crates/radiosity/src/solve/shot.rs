//! One shot: what leaves a patch goes where its row says.

pub(super) use crate::cast::to_f32;
use crate::form_factor::Row;
use crate::patch::PatchMesh;
use crate::solution::{BANDS, EnergyBalance};
use hemicube_raster::Rgb;

/// What a shot needs to know of the elements, each array on its own so that a row runs through them in order.
pub(crate) struct Surfaces {
    inverse_area: Vec<f32>,
    pub(super) reflectance: [Vec<f32>; BANDS],
    /// Share of arriving light that is not let straight through.
    kept: [Vec<f32>; BANDS],
}

impl Surfaces {
    pub(crate) fn new(mesh: &PatchMesh) -> Self {
        let areas = (0..mesh.elements().len()).map(|e| mesh.exposed_area(e));
        let bands = |values: &[Rgb], of: fn(f32) -> f32| {
            [0, 1, 2].map(|band| values.iter().map(|v| of(v[band])).collect())
        };
        Self {
            inverse_area: areas.map(|a| if a > 0.0 { 1.0 / a } else { 0.0 }).collect(),
            reflectance: bands(mesh.reflectance(), |r| r),
            kept: bands(mesh.transmittance(), |t| 1.0 - t),
        }
    }

    /// Spreads a flux of one channel by a row and books it. `reflect` hears of each receiver what share of the flux
    /// it reflects, and the radiosity that this adds to it.
    #[inline]
    pub(crate) fn spread(
        &self,
        row: &Row,
        band: usize,
        flux: f64,
        irradiance: &mut [f32],
        balance: &mut EnergyBalance,
        mut reflect: impl FnMut(usize, f64, f32),
    ) {
        let factor = to_f32(flux);
        let (reflectance, kept) = (&self.reflectance[band], &self.kept[band]);
        let (mut received, mut reflected) = (0.0, 0.0);
        for (&e, &fraction) in row.receivers.iter().zip(row.band(band)) {
            let e = e as usize;
            let gain = fraction * factor * self.inverse_area[e];
            irradiance[e] += gain;
            let share = f64::from(fraction) * f64::from(reflectance[e]);
            reflect(e, share, reflectance[e] * gain);
            received += f64::from(fraction) * f64::from(kept[e]);
            reflected += share;
        }
        let backs = f64::from(row.absorbed[band]);
        balance.absorbed += flux * (received - reflected + backs);
        balance.escaped += flux * f64::from(row.escaped[band]);
    }
}
