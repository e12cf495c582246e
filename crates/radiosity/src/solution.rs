//! What a solver works on and what it leaves behind.

use crate::patch::PatchMesh;
use crate::solve::Stages;
use hemicube_raster::Rgb;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::Arc;

/// Bands of a channel block: red, green, blue.
pub const BANDS: usize = 3;

/// Light on a patch mesh: irradiance, exitance, reflectance and what has not been shot yet.
///
/// Arrays are flat, `[group][band][element]`; light is linear, so groups of luminaires are kept apart and dimmed
/// without solving again. Radiosity is derived: `B = E + ρ H`.
#[derive(Debug, Clone)]
pub struct Solution {
    mesh: Arc<PatchMesh>,
    groups: Vec<LightGroup>,
    irradiance: Vec<f32>,
    exitance: Vec<f32>,
    unshot: Vec<f32>,
    balance: Vec<[EnergyBalance; BANDS]>,
    /// How it was obtained.
    pub provenance: Provenance,
}

/// Luminaires that are dimmed together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LightGroup {
    /// Name of the group.
    pub name: String,
    /// Factor on everything that comes from it; 1 as solved.
    pub dim: Rgb,
}

/// How a solution was obtained.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Provenance {
    /// Solver's name as on the command line.
    pub solver: String,
    /// Name of the form-factor method as on the command line.
    pub form_factors: String,
    /// Rays for each hemisphere.
    pub rays_per_hemisphere: u32,
    /// Rays for each shot, where their number was fixed.
    pub shot_rays: Option<u32>,
    /// Cells along an edge of hemicubes, where they are the way to the form factors.
    pub hemicube_resolution: u32,
    /// Seed of the sampling sequences.
    pub seed: u64,
    /// Steps so far: shots, or steps of a matrix method.
    pub steps: u64,
    /// Rays cast so far.
    pub rays: u64,
    /// Wall-clock seconds spent so far.
    pub seconds: f64,
    /// Relative standard error of the irradiance, where the solver draws lots and knows it
    /// ([`Stochastic::noise`](crate::solve::Stochastic::noise)).
    pub noise: Option<f64>,
    /// What the stages of solving by rays alone cost since the scene was opened; files do not keep it.
    #[serde(skip)]
    pub stages: Option<Stages>,
}

/// Where the light is, in lm or W (of scene units): `emitted = absorbed + unshot + escaped`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct EnergyBalance {
    /// Flux of the emitters; of points, sun and sky the flux of first hits.
    pub emitted: f64,
    /// Flux that surfaces turned into heat.
    pub absorbed: f64,
    /// Flux that left the scene.
    pub escaped: f64,
}

impl EnergyBalance {
    /// `|emitted - absorbed - unshot - escaped| / emitted`; 0 if nothing is emitted.
    pub fn relative_error(&self, unshot: f64) -> f64 {
        if self.emitted == 0.0 {
            return 0.0;
        }
        ((self.emitted - self.absorbed - unshot - self.escaped) / self.emitted).abs()
    }
}

/// The arrays of a solution as they are stored: everything but the mesh. They are lent for writing.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SolutionData<'a> {
    groups: Cow<'a, [LightGroup]>,
    pub(crate) irradiance: Cow<'a, [f32]>,
    exitance: Cow<'a, [f32]>,
    unshot: Cow<'a, [f32]>,
    balance: Cow<'a, [[EnergyBalance; BANDS]]>,
    provenance: Cow<'a, Provenance>,
}

/// Which emitters share a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Grouping {
    /// All light together.
    #[default]
    Together,
    /// Each emitting material on its own, then the lights without an area and the sky as one.
    ByMaterial,
}

impl Grouping {
    /// Names of the groups of a mesh, and the group of each element's own emission. Lights without an area and the sky
    /// are in the last one.
    pub fn groups(self, mesh: &PatchMesh) -> (Vec<String>, Vec<usize>) {
        groups(mesh, self)
    }
}

impl Solution {
    /// Light before the first step: emitters, and what lights and sky bring directly (`primary`, per element).
    pub fn new(mesh: Arc<PatchMesh>, primary: &[Rgb], grouping: Grouping) -> Self {
        let elements = mesh.elements().len();
        assert_eq!(
            primary.len(),
            elements,
            "one primary irradiance for each element"
        );
        let (names, group_of) = grouping.groups(&mesh);
        let mut solution = Self {
            irradiance: vec![0.0; names.len() * BANDS * elements],
            exitance: vec![0.0; names.len() * BANDS * elements],
            unshot: vec![0.0; names.len() * BANDS * elements],
            balance: vec![[EnergyBalance::default(); BANDS]; names.len()],
            groups: names
                .into_iter()
                .map(|name| LightGroup {
                    name,
                    dim: Rgb::WHITE,
                })
                .collect(),
            provenance: Provenance::default(),
            mesh,
        };
        solution.begin(primary, |e| group_of[e]);
        solution
    }

    /// The same groups on a refined mesh, or an unrefined one, before the first step.
    pub(crate) fn unlit_on(&self, mesh: Arc<PatchMesh>, primary: &[Rgb]) -> Self {
        let values = self.groups.len() * BANDS * mesh.elements().len();
        let group_of: Vec<usize> = (0..mesh.patches().len())
            .map(|patch| self.group_of_patch(patch))
            .collect();
        let mut solution = Self {
            irradiance: vec![0.0; values],
            exitance: vec![0.0; values],
            unshot: vec![0.0; values],
            balance: vec![[EnergyBalance::default(); BANDS]; self.groups.len()],
            groups: self.groups.clone(),
            provenance: Provenance {
                steps: 0,
                noise: None,
                stages: None,
                ..self.provenance.clone()
            },
            mesh: mesh.clone(),
        };
        solution.begin(primary, |e| group_of[mesh.patch_of_element(e)]);
        solution
    }

    /// The group in which the emission of a patch counts; the last one of those that emit nothing.
    fn group_of_patch(&self, patch: usize) -> usize {
        let emits = |&group: &usize| {
            let mut bands = (0..BANDS).map(|band| self.exitance(group, band));
            bands.any(|exitance| {
                let mut elements = self.mesh.elements_of_patch(patch);
                elements.any(|e| exitance[e] != 0.0)
            })
        };
        let last = self.groups.len() - 1;
        (0..last).find(emits).unwrap_or(last)
    }

    /// The first light of all elements.
    fn begin(&mut self, primary: &[Rgb], group_of: impl Fn(usize) -> usize) {
        let last = self.groups.len() - 1;
        for (e, &irradiance) in primary.iter().enumerate() {
            self.add_primary(last, e, irradiance);
            self.add_emission(group_of(e), e);
        }
    }

    fn add_primary(&mut self, group: usize, e: usize, irradiance: Rgb) {
        let (area, reflectance) = (self.area(e), self.mesh.reflectance()[e]);
        let kept = Rgb::WHITE - self.mesh.transmittance()[e];
        for band in 0..BANDS {
            let i = self.index(group, band, e);
            self.irradiance[i] += irradiance[band];
            self.unshot[i] += reflectance[band] * irradiance[band];
            let flux = f64::from(irradiance[band]) * area;
            self.balance[group][band].emitted += flux * f64::from(kept[band]);
            self.balance[group][band].absorbed += flux * f64::from(kept[band] - reflectance[band]);
        }
    }

    fn add_emission(&mut self, group: usize, e: usize) {
        let (area, emission) = (self.area(e), self.mesh.emission()[e]);
        for band in 0..BANDS {
            let i = self.index(group, band, e);
            self.exitance[i] += emission[band];
            self.unshot[i] += emission[band];
            self.balance[group][band].emitted += f64::from(emission[band]) * area;
        }
    }

    fn index(&self, group: usize, band: usize, element: usize) -> usize {
        (group * BANDS + band) * self.mesh.elements().len() + element
    }

    fn area(&self, element: usize) -> f64 {
        f64::from(self.mesh.exposed_area(element))
    }

    /// The mesh it lives on.
    pub fn mesh(&self) -> &Arc<PatchMesh> {
        &self.mesh
    }

    /// Groups of luminaires.
    pub fn groups(&self) -> &[LightGroup] {
        &self.groups
    }

    /// Dims or tints a group; nothing is solved again.
    pub fn set_dim(&mut self, group: usize, dim: Rgb) {
        self.groups[group].dim = dim;
    }

    /// Irradiance of each element from one group in one band, undimmed: lx or W/m².
    pub fn irradiance(&self, group: usize, band: usize) -> &[f32] {
        self.channel(&self.irradiance, group, band)
    }

    /// Emitted exitance of each element in one group and band, undimmed: lm/m² or W/m².
    pub fn exitance(&self, group: usize, band: usize) -> &[f32] {
        self.channel(&self.exitance, group, band)
    }

    /// Radiosity that has not been shot yet, of each element in one group and band, undimmed; it may be negative.
    pub fn unshot(&self, group: usize, band: usize) -> &[f32] {
        self.channel(&self.unshot, group, band)
    }

    fn channel<'a>(&self, values: &'a [f32], group: usize, band: usize) -> &'a [f32] {
        let n = self.mesh.elements().len();
        let start = (group * BANDS + band) * n;
        &values[start..start + n]
    }

    /// All channels at once for a solver: irradiance, unshot and balance, `[group][band][element]`.
    pub(crate) fn channels_mut(
        &mut self,
    ) -> (&mut [f32], &mut [f32], &mut [[EnergyBalance; BANDS]]) {
        (&mut self.irradiance, &mut self.unshot, &mut self.balance)
    }

    /// Takes over the light of a solver that keeps it elsewhere: irradiance and unshot radiosity, `[group][band][element]`,
    /// and the flux that backs absorbed and that escaped meanwhile, by channel.
    ///
    /// What elements absorbed follows from their irradiance: it is neither reflected nor let through.
    ///
    /// # Panics
    /// The arrays do not have the solution's sizes.
    pub fn replace_light(
        &mut self,
        irradiance: &[f32],
        unshot: &[f32],
        backs: &[f64],
        escaped: &[f64],
    ) {
        let elements = self.mesh.elements().len();
        let channels = self.groups.len() * BANDS;
        assert!(
            irradiance.len() == self.irradiance.len()
                && unshot.len() == self.unshot.len()
                && [backs.len(), escaped.len()] == [channels; 2],
            "light of {channels} channels and {elements} elements"
        );
        for channel in 0..channels {
            let (group, band) = (channel / BANDS, channel % BANDS);
            let range = channel * elements..(channel + 1) * elements;
            let gained = |(i, e): (usize, usize)| {
                let through = f64::from(self.mesh.transmittance()[e][band]);
                let kept = 1.0 - through - f64::from(self.mesh.reflectance()[e][band]);
                kept * self.area(e) * (f64::from(irradiance[i]) - f64::from(self.irradiance[i]))
            };
            let absorbed: f64 = range.zip(0..elements).map(gained).sum();
            let balance = &mut self.balance[group][band];
            balance.absorbed += absorbed + backs[channel];
            balance.escaped += escaped[channel];
        }
        self.irradiance.copy_from_slice(irradiance);
        self.unshot.copy_from_slice(unshot);
    }

    /// The light under an edited mesh ([`PatchMesh::edited`]), before the difference is shot.
    ///
    /// What was shot has arrived and stays. Radiosity `B = E + ρ H` changes at once, and what changed is unshot:
    /// `U' = U + ΔE + Δρ H`, which may be negative. Any solver goes on from here; where it ends is the solution from
    /// scratch, but for the rounding of f32, which is relative to the brightest light that ever fell. Light is taken back by
    /// the same form factors that brought it, so they should be kept: those made for the edited mesh may differ by their
    /// noise (rays are spent on what emits). `group_of` says in which group the emission of an element counts.
    ///
    /// # Panics
    /// The mesh has another number of elements, or there is no such group.
    pub fn relit(mut self, mesh: Arc<PatchMesh>, group_of: impl Fn(usize) -> usize) -> Self {
        let elements = self.mesh.elements().len();
        assert_eq!(
            mesh.elements().len(),
            elements,
            "an edited mesh has the same elements"
        );
        for e in 0..elements {
            let reflectance = mesh.reflectance()[e] - self.mesh.reflectance()[e];
            if !reflectance.is_black() {
                self.change_reflectance(e, reflectance);
            }
            let emission = mesh.emission()[e] - self.mesh.emission()[e];
            if !emission.is_black() {
                self.change_emission(group_of(e), e, mesh.emission()[e]);
            }
        }
        self.mesh = mesh;
        self
    }

    fn change_reflectance(&mut self, e: usize, change: Rgb) {
        for channel in 0..self.groups.len() * BANDS {
            let (group, band) = (channel / BANDS, channel % BANDS);
            let i = self.index(group, band, e);
            let reflected = change[band] * self.irradiance[i];
            self.unshot[i] += reflected;
            self.balance[group][band].absorbed -= f64::from(reflected) * self.area(e);
        }
    }

    fn change_emission(&mut self, group: usize, e: usize, emission: Rgb) {
        for band in 0..BANDS {
            let i = self.index(group, band, e);
            let change = emission[band] - self.exitance[i];
            self.exitance[i] = emission[band];
            self.unshot[i] += change;
            self.balance[group][band].emitted += f64::from(change) * self.area(e);
        }
    }

    /// The same light with one more group, dark so far, before the last one: what is about to emit may have a group of its
    /// own. Its index is returned beside it.
    pub fn with_dark_group(mut self, name: impl Into<String>) -> (Self, usize) {
        let at = self.groups.len() - 1;
        let values = self.mesh.elements().len() * BANDS;
        let start = at * values;
        for array in [&mut self.irradiance, &mut self.exitance, &mut self.unshot] {
            array.splice(start..start, core::iter::repeat_n(0.0, values));
        }
        self.balance.insert(at, Default::default());
        let (name, dim) = (name.into(), Rgb::WHITE);
        self.groups.insert(at, LightGroup { name, dim });
        (self, at)
    }

    fn sum_over_groups(&self, values: &[f32], element: usize) -> Rgb {
        let n = self.mesh.elements().len();
        let of_group = |(g, group): (usize, &LightGroup)| {
            let at = |band: usize| values[(g * BANDS + band) * n + element];
            Rgb::new(at(0), at(1), at(2)) * group.dim
        };
        self.groups.iter().enumerate().map(of_group).sum()
    }

    /// Irradiance of an element from all groups as dimmed.
    pub fn element_irradiance(&self, element: usize) -> Rgb {
        self.sum_over_groups(&self.irradiance, element)
    }

    /// Emitted exitance of an element as dimmed.
    pub fn element_exitance(&self, element: usize) -> Rgb {
        self.sum_over_groups(&self.exitance, element)
    }

    /// Radiosity `B = E + ρ H` of an element as dimmed.
    pub fn element_radiosity(&self, element: usize) -> Rgb {
        self.element_exitance(element)
            + self.mesh.reflectance()[element] * self.element_irradiance(element)
    }

    /// Energy balance of a group and band, undimmed.
    pub fn balance(&self, group: usize, band: usize) -> EnergyBalance {
        self.balance[group][band]
    }

    /// Energy balance of a band over all groups, undimmed.
    pub fn total_balance(&self, band: usize) -> EnergyBalance {
        self.balance
            .iter()
            .map(|g| g[band])
            .fold(EnergyBalance::default(), |a, b| EnergyBalance {
                emitted: a.emitted + b.emitted,
                absorbed: a.absorbed + b.absorbed,
                escaped: a.escaped + b.escaped,
            })
    }

    /// Flux that has not been shot yet, in one band over all groups.
    pub fn unshot_flux(&self, band: usize) -> f64 {
        let n = self.mesh.elements().len();
        (0..self.groups.len())
            .map(|g| {
                self.unshot(g, band)
                    .iter()
                    .zip(0..n)
                    .map(|(&b, e)| f64::from(b) * self.area(e))
                    .sum::<f64>()
            })
            .sum()
    }

    /// Signed unshot flux of a patch in one group and band.
    pub fn unshot_patch_flux(&self, patch: usize, group: usize, band: usize) -> f64 {
        let values = self.unshot(group, band);
        let flux = |e: usize| f64::from(values[e]) * self.area(e);
        self.mesh.elements_of_patch(patch).map(flux).sum()
    }

    /// The flux over all bands with which unshot light is compared: what is emitted. Where an edit took nearly all of that
    /// away, a thousandth of the light that is still there.
    pub fn reference_flux(&self) -> f64 {
        let of_bands = |flux: fn(EnergyBalance) -> f64| -> f64 {
            (0..BANDS).map(|band| flux(self.total_balance(band))).sum()
        };
        let lost = of_bands(|balance| balance.absorbed + balance.escaped);
        of_bands(|balance| balance.emitted).max(1e-3 * lost)
    }

    /// Unshot share of all emitted flux: absolute values over patches, groups and bands, so that what an edit made
    /// negative does not hide what is positive. 0 if nothing is emitted.
    pub fn unshot_fraction(&self) -> f64 {
        let emitted = self.reference_flux();
        let channels =
            || (0..self.groups.len()).flat_map(|g| (0..BANDS).map(move |band| (g, band)));
        let of_patch = |p| {
            channels()
                .map(|(g, band)| self.unshot_patch_flux(p, g, band).abs())
                .sum::<f64>()
        };
        let unshot: f64 = (0..self.mesh.patches().len()).map(of_patch).sum();
        if emitted > 0.0 { unshot / emitted } else { 0.0 }
    }

    /// Its arrays, for storing.
    pub fn data(&self) -> SolutionData<'_> {
        SolutionData {
            groups: Cow::Borrowed(&self.groups),
            irradiance: Cow::Borrowed(&self.irradiance),
            exitance: Cow::Borrowed(&self.exitance),
            unshot: Cow::Borrowed(&self.unshot),
            balance: Cow::Borrowed(&self.balance),
            provenance: Cow::Borrowed(&self.provenance),
        }
    }

    /// Stored arrays on their mesh; the error says what does not fit.
    pub fn from_data(mesh: Arc<PatchMesh>, data: SolutionData<'_>) -> Result<Self, String> {
        let values = data
            .groups
            .len()
            .saturating_mul(BANDS)
            .saturating_mul(mesh.elements().len());
        if data.groups.is_empty() || data.balance.len() != data.groups.len() {
            return Err(String::from(
                "its light groups do not fit its energy balance",
            ));
        }
        for (name, array) in [
            ("irradiance", &data.irradiance),
            ("exitance", &data.exitance),
            ("unshot", &data.unshot),
        ] {
            if array.len() != values {
                return Err(format!(
                    "{} values of {name} for {values} channels of elements",
                    array.len()
                ));
            }
            if array.iter().any(|x| !x.is_finite()) {
                return Err(format!("a value of {name} is not finite"));
            }
        }
        Ok(Self {
            mesh,
            groups: data.groups.into_owned(),
            irradiance: data.irradiance.into_owned(),
            exitance: data.exitance.into_owned(),
            unshot: data.unshot.into_owned(),
            balance: data.balance.into_owned(),
            provenance: data.provenance.into_owned(),
        })
    }
}

/// Names of the light groups, and the group of each element's own emission.
fn groups(mesh: &PatchMesh, grouping: Grouping) -> (Vec<String>, Vec<usize>) {
    let elements = mesh.elements();
    if grouping == Grouping::Together {
        return (vec![String::from("all")], vec![0; elements.len()]);
    }
    let materials = &mesh.scene().materials;
    let emitting: Vec<usize> = (0..materials.len())
        .filter(|&m| materials[m].emits())
        .collect();
    let mut names: Vec<String> = emitting
        .iter()
        .map(|&m| materials[m].name.clone())
        .collect();
    names.push(String::from("lights and sky"));
    let group_of = |id| match mesh.node(id).kind {
        crate::patch::NodeKind::Surface { face, .. } => {
            let material = mesh.faces()[face as usize].material as usize;
            emitting
                .iter()
                .position(|&m| m == material)
                .unwrap_or(names.len() - 1)
        }
        crate::patch::NodeKind::Cluster { .. } => names.len() - 1,
    };
    let of_elements = elements.iter().map(|&id| group_of(id)).collect();
    (names, of_elements)
}
