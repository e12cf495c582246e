//! Progressive gathering as it looks: one patch a step, light on its elements.

use crate::form_factor::{FormFactors, Row};
use crate::solution::{BANDS, Solution};
use crate::solve::shot::to_f32;
use rayon::prelude::*;

/// Patches that gather one after the other, in the order of the mesh, each with all of its elements (Cohen, Greenberg,
/// Immel, Brock 1986): `H_e = Σ_p F_Pe B_p A_p / A_e`, `B_p` the mean of `E + ρ H` over the patch's elements.
///
/// It is [`Gathering`](super::Gathering) for pictures of what it has reached: patches that had no turn yet show only
/// their own emission and first light. Such a state obeys no balance of energy, so this is no
/// [`Solver`](super::Solver).
#[derive(Debug, Clone)]
pub struct ElementGathering {
    shown: Solution,
    /// Irradiance before the first step, which stays.
    first: Vec<f32>,
    columns: Columns,
    areas: Vec<f64>,
    /// What each patch radiates, beyond what had been shot before the first step: `[channel][patch]`.
    radiosity: Vec<Vec<f64>>,
    next: usize,
}

/// Form factors by receiver.
#[derive(Debug, Clone)]
struct Columns {
    /// Where each element's entries start.
    starts: Vec<usize>,
    sources: Vec<u32>,
    /// Factors from the sources, `[band][entry]`; one band where all agree.
    fractions: Vec<Vec<f32>>,
}

impl Columns {
    fn new(factors: &dyn FormFactors) -> Self {
        let mesh = factors.mesh();
        let fill = |&id| {
            let mut row = Row::default();
            factors.fill_row(id, &mut row);
            row
        };
        let rows: Vec<Row> = mesh.patches().par_iter().map(fill).collect();
        let mut starts = vec![0; mesh.elements().len() + 1];
        for &e in rows.iter().flat_map(|row| &row.receivers) {
            starts[e as usize + 1] += 1;
        }
        for e in 1..starts.len() {
            starts[e] += starts[e - 1];
        }
        let (mut next, total) = (starts.clone(), starts[starts.len() - 1]);
        let bands = rows.iter().map(|row| row.bands).max().unwrap_or(1);
        let mut sources = vec![0; total];
        let mut fractions = vec![vec![0.0; total]; bands];
        for (p, row) in rows.iter().enumerate() {
            for (k, &e) in row.receivers.iter().enumerate() {
                let to = next[e as usize];
                next[e as usize] += 1;
                sources[to] = crate::index32(p);
                for (band, fractions) in fractions.iter_mut().enumerate() {
                    fractions[to] = row.band(band)[k];
                }
            }
        }
        Self {
            starts,
            sources,
            fractions,
        }
    }

    /// `Σ_p F_Pe x_p` of an element.
    fn gather(&self, e: usize, band: usize, x: impl Fn(usize) -> f64) -> f64 {
        let entries = self.starts[e]..self.starts[e + 1];
        let fractions = &self.fractions[band.min(self.fractions.len() - 1)][entries.clone()];
        let sources = self.sources[entries].iter();
        sources
            .zip(fractions)
            .map(|(&p, &f)| f64::from(f) * x(p as usize))
            .sum()
    }
}

impl ElementGathering {
    /// Before the first step; asks for all rows, which it keeps.
    pub fn new(factors: &dyn FormFactors, start: Solution) -> Self {
        let mesh = start.mesh().clone();
        let patches = mesh.patches().len();
        let areas: Vec<f64> = (0..patches)
            .map(|p| crate::form_factor::matrix::patch_area(&mesh, p))
            .collect();
        let of_channel = |channel: usize| -> Vec<f64> {
            let (group, band) = (channel / BANDS, channel % BANDS);
            let fluxes = (0..patches).map(|p| start.unshot_patch_flux(p, group, band));
            let radiosity = |(flux, &area): (f64, &f64)| if area > 0.0 { flux / area } else { 0.0 };
            fluxes.zip(&areas).map(radiosity).collect()
        };
        Self {
            columns: Columns::new(factors),
            radiosity: (0..start.groups().len() * BANDS).map(of_channel).collect(),
            first: start.data().irradiance.into_owned(),
            shown: start,
            areas,
            next: 0,
        }
    }

    /// The next patch gathers.
    pub fn step(&mut self) {
        let patch = self.next;
        self.next = (patch + 1) % self.areas.len();
        for channel in 0..self.radiosity.len() {
            self.gather(patch, channel);
        }
        self.shown.provenance.steps += 1;
    }

    fn gather(&mut self, patch: usize, channel: usize) {
        let (group, band) = (channel / BANDS, channel % BANDS);
        let mesh = self.shown.mesh().clone();
        let own = self.shown.unshot_patch_flux(patch, group, band);
        let (radiosity, areas, columns) = (&self.radiosity[channel], &self.areas, &self.columns);
        let (irradiance, _, _) = self.shown.channels_mut();
        let mut reflected = 0.0;
        for e in mesh.elements_of_patch(patch) {
            let area = f64::from(mesh.exposed_area(e));
            if area <= 0.0 {
                continue;
            }
            let flux = columns.gather(e, band, |p| radiosity[p] * areas[p]);
            let at = channel * mesh.elements().len() + e;
            irradiance[at] = self.first[at] + to_f32(flux / area);
            reflected += flux * f64::from(mesh.reflectance()[e][band]);
        }
        if areas[patch] > 0.0 {
            self.radiosity[channel][patch] = (own + reflected) / areas[patch];
        }
    }

    /// Light as gathered so far.
    pub fn shown(&self) -> &Solution {
        &self.shown
    }

    /// Light as gathered so far, taken out.
    pub fn into_shown(self) -> Solution {
        self.shown
    }
}
