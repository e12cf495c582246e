//! Light on a refined mesh, from the light of its patches (Cohen, Greenberg, Immel, Brock 1986).

use super::receive::{EMITTER_BOOST, Effort, received};
use super::to_f32;
use crate::form_factor::matrix::patch_area;
use crate::form_factor::{FormFactors, RayCast, Row};
use crate::job::SolveOptions;
use crate::patch::{NodeId, PatchMesh};
use crate::solution::{BANDS, Solution};
use crate::solve::shot::Surfaces;
use crate::stop::Stop;
use hemicube_raster::Rgb;

/// Rows that are filled at the same time.
const ROWS: usize = 64;

/// Rays of a hemisphere for each patch that a new element asks, and how many are asked at least.
const RAYS_PER_PAIR: f32 = 2.0;
const LEAST_PAIRS: f32 = 32.0;

/// Contrast from which on fewer rays will do: noise is to stay below what is cut.
const FINE_CONTRAST: f32 = 0.1;

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
    let shot = shot_fluxes(old);
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

/// What all patches have shot so far arrives at the new elements of a refined mesh; those that the mesh had before keep
/// their light. `None` if it was stopped.
///
/// `primary` is what lights and sky bring to the elements, `before` what they brought to those of the old mesh. New elements
/// [receive](received) light by pairs; all of it is then scaled by one factor for each channel, near 1, so that as much
/// arrives as did where they were cut. Energy is kept; what is unshot changes as in [`transferred`].
pub(super) fn received_by_new(
    old: &Solution,
    [before, primary]: [&[Rgb]; 2],
    rays: &RayCast,
    options: &SolveOptions,
    stop: Stop<'_>,
) -> Option<Solution> {
    let mesh = rays.mesh().clone();
    let was_unlit = old.unlit_on(old.mesh().clone(), before);
    let mut solution = old.unlit_on(mesh.clone(), primary);
    let shot = shot_fluxes(old);
    let change = Change::new(old.mesh(), &mesh);
    let light = received(
        rays,
        &change.new,
        &shot,
        effort(options),
        options.seed,
        stop,
    )?;
    let elements = mesh.elements().len();
    for channel in 0..solution.groups().len() * BANDS {
        let (group, band) = (channel / BANDS, channel % BANDS);
        let lit = old.irradiance(group, band).iter();
        let gained: Vec<f64> = lit
            .zip(was_unlit.irradiance(group, band))
            .map(|(&lit, &unlit)| f64::from(lit) - f64::from(unlit))
            .collect();
        let gains = change.gains(band, &gained, light.iter().map(|light| light[channel]));
        let (was, begun) = (old.balance(group, band), was_unlit.balance(group, band));
        let to_backs = was.absorbed - begun.absorbed - absorbed_flux(old.mesh(), band, &gained);
        let absorbed = absorbed_flux(&mesh, band, &gains) + to_backs;
        let (irradiance, _, balance) = solution.channels_mut();
        let irradiance = &mut irradiance[channel * elements..(channel + 1) * elements];
        for (irradiance, gain) in irradiance.iter_mut().zip(gains) {
            *irradiance += to_f32(gain);
        }
        balance[group][band].absorbed += absorbed;
        balance[group][band].escaped += was.escaped - begun.escaped;
    }
    leave(&mut solution, &shot);
    solution.provenance.steps = old.provenance.steps;
    Some(solution)
}

/// What the light of a new element is worth: with the contrast that is wanted, less.
fn effort(options: &SolveOptions) -> Effort {
    let contrast = options.adaptive.unwrap_or_default().contrast;
    let share = (FINE_CONTRAST / contrast).min(1.0);
    Effort {
        pairs: (options.rays as f32 / RAYS_PER_PAIR * share).max(LEAST_PAIRS),
        // Rays of a pair are spread evenly: their error falls faster than the root of their number.
        emitter_boost: f64::from(EMITTER_BOOST * share.powf(4.0 / 3.0)).max(1.0),
    }
}

/// What a refinement changed.
struct Change<'a> {
    meshes: [&'a PatchMesh; 2],
    /// Of each element of the new mesh, the one that it was.
    kept: Vec<Option<u32>>,
    /// Whether an element of the old mesh is still there.
    stays: Vec<bool>,
    /// Elements of the new mesh that were not there and that light can reach.
    new: Vec<u32>,
}

impl<'a> Change<'a> {
    fn new(old: &'a PatchMesh, mesh: &'a PatchMesh) -> Self {
        let kept = mesh.elements_kept_of(old);
        let mut stays = vec![false; old.elements().len()];
        kept.iter()
            .flatten()
            .for_each(|&e| stays[e as usize] = true);
        let is_new = |&e: &usize| kept[e].is_none() && mesh.exposed_area(e) > 0.0;
        Self {
            new: (0..kept.len()).filter(is_new).map(crate::index32).collect(),
            meshes: [old, mesh],
            kept,
            stays,
        }
    }

    /// What elements of the new mesh have gained in a band: as before, or `light` of new ones, scaled.
    fn gains(&self, band: usize, gained: &[f64], light: impl Iterator<Item = f64>) -> Vec<f64> {
        let kept = self.kept.iter();
        let mut gains: Vec<f64> = kept
            .map(|kept| kept.map_or(0.0, |e| gained[e as usize]))
            .collect();
        for (&e, light) in self.new.iter().zip(light) {
            gains[e as usize] = light;
        }
        let [old, mesh] = self.meshes;
        let cut = (0..gained.len()).filter(|&e| !self.stays[e]);
        let wanted: f64 = cut.map(|e| catch(old, band, e) * gained[e]).sum();
        scale(mesh, band, &self.new, &mut gains, wanted);
        gains
    }
}

/// Scales the light of some elements so that so much flux arrives there; where they have none it is spread evenly.
fn scale(mesh: &PatchMesh, band: usize, elements: &[u32], gains: &mut [f64], wanted: f64) {
    let elements = || elements.iter().map(|&e| e as usize);
    let flux: f64 = elements().map(|e| catch(mesh, band, e) * gains[e]).sum();
    if flux > 0.0 {
        elements().for_each(|e| gains[e] *= wanted / flux);
    } else {
        let area: f64 = elements().map(|e| catch(mesh, band, e)).sum();
        elements().for_each(|e| gains[e] = wanted / area.max(f64::MIN_POSITIVE));
    }
}

/// Area of an element that does not let light through.
fn catch(mesh: &PatchMesh, band: usize, e: usize) -> f64 {
    f64::from(mesh.exposed_area(e)) * (1.0 - f64::from(mesh.transmittance()[e][band]))
}

/// Flux that elements turn into heat.
fn absorbed_flux(mesh: &PatchMesh, band: usize, irradiance: &[f64]) -> f64 {
    let reflected =
        |e: usize| f64::from(mesh.exposed_area(e)) * f64::from(mesh.reflectance()[e][band]);
    let flux = |(e, h): (usize, &f64)| (catch(mesh, band, e) - reflected(e)) * h;
    irradiance.iter().enumerate().map(flux).sum()
}

/// Flux that each patch has shot in each channel.
fn shot_fluxes(solution: &Solution) -> Vec<Vec<f64>> {
    let channels = solution.groups().len() * BANDS;
    let of_patch = |patch| {
        (0..channels)
            .map(|channel| shot_flux(solution, patch, channel))
            .collect()
    };
    (0..solution.mesh().patches().len()).map(of_patch).collect()
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
