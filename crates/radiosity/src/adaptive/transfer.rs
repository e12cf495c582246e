//! Light on a refined mesh, from the light of its patches (Cohen, Greenberg, Immel, Brock 1986).

use super::to_f32;
use crate::form_factor::matrix::patch_area;
use crate::form_factor::{FormFactors, Row};
use crate::patch::NodeId;
use crate::solution::{BANDS, Solution};
use crate::solve::shot::Surfaces;
use crate::stop::Stop;
use hemicube_raster::Rgb;

/// Rows that are filled at the same time.
const ROWS: usize = 64;

/// What all patches have shot so far arrives anew, at the elements of a refined mesh: each patch shoots once, `A (B - U)`
/// with its radiosity `B` and what of it is unshot, `U`. `None` if it was stopped.
///
/// Nothing is interpolated, and energy is kept: what then is unshot is what the new elements reflect and emit less what
/// was shot, some of it negative where light falls otherwise now. Any solver goes on from there. `primary` is what lights
/// and sky bring to the new elements.
pub(super) fn transferred(
    old: &Solution,
    primary: &[Rgb],
    factors: &dyn FormFactors,
    stop: Stop<'_>,
) -> Option<Solution> {
    let mesh = factors.mesh().clone();
    let mut solution = old.unlit_on(mesh.clone(), primary);
    let channels = solution.groups().len() * BANDS;
    let shot: Vec<Vec<f64>> = (0..mesh.patches().len())
        .map(|patch| {
            (0..channels)
                .map(|channel| shot_flux(old, patch, channel))
                .collect()
        })
        .collect();
    let shooters: Vec<usize> = (0..shot.len())
        .filter(|&p| shot[p].iter().any(|&flux| flux != 0.0))
        .collect();
    let surfaces = Surfaces::new(&mesh);
    let mut rows = vec![Row::default(); ROWS.min(shooters.len())];
    for chunk in shooters.chunks(ROWS) {
        if stop() {
            return None;
        }
        let sources: Vec<NodeId> = chunk.iter().map(|&p| mesh.patches()[p]).collect();
        factors.fill_rows(&sources, &mut rows[..chunk.len()]);
        for (&patch, row) in chunk.iter().zip(&rows) {
            arrive(&mut solution, &surfaces, row, &shot[patch]);
        }
    }
    leave(&mut solution, &shot);
    solution.provenance.steps = old.provenance.steps + shooters.len() as u64;
    Some(solution)
}

/// Flux that a patch has shot in a channel.
fn shot_flux(solution: &Solution, patch: usize, channel: usize) -> f64 {
    let (group, band) = (channel / BANDS, channel % BANDS);
    leaving_flux(solution, patch, channel) - solution.unshot_patch_flux(patch, group, band)
}

/// Flux that leaves a patch in a channel, shot or not.
fn leaving_flux(solution: &Solution, patch: usize, channel: usize) -> f64 {
    let (group, band) = (channel / BANDS, channel % BANDS);
    let mesh = solution.mesh();
    let (irradiance, exitance) = (
        solution.irradiance(group, band),
        solution.exitance(group, band),
    );
    let of_element = |e: usize| {
        let reflected = f64::from(mesh.reflectance()[e][band]) * f64::from(irradiance[e]);
        f64::from(mesh.exposed_area(e)) * (f64::from(exitance[e]) + reflected)
    };
    mesh.elements_of_patch(patch).map(of_element).sum()
}

/// Spreads what a patch has shot by its row.
fn arrive(solution: &mut Solution, surfaces: &Surfaces, row: &Row, fluxes: &[f64]) {
    let elements = solution.mesh().elements().len();
    let (irradiance, _, balance) = solution.channels_mut();
    for (channel, &flux) in fluxes.iter().enumerate().filter(|&(_, &flux)| flux != 0.0) {
        let (group, band) = (channel / BANDS, channel % BANDS);
        let irradiance = &mut irradiance[channel * elements..(channel + 1) * elements];
        let balance = &mut balance[group][band];
        surfaces.spread(row, band, flux, irradiance, balance, |_, _, _| ());
    }
}

/// What leaves each patch but was not shot is unshot, spread evenly over it.
fn leave(solution: &mut Solution, shot: &[Vec<f64>]) {
    let mesh = solution.mesh().clone();
    let elements = mesh.elements().len();
    for (patch, fluxes) in shot.iter().enumerate() {
        let area = patch_area(&mesh, patch);
        for (channel, flux) in fluxes.iter().enumerate() {
            let left = leaving_flux(solution, patch, channel) - flux;
            let unshot = if area > 0.0 { to_f32(left / area) } else { 0.0 };
            let (_, all, _) = solution.channels_mut();
            all[channel * elements..(channel + 1) * elements][mesh.elements_of_patch(patch)]
                .fill(unshot);
        }
    }
}
