//! Light that arrives straight from emitters: shadow rays from every element.
//!
//! Direct light has sharp shadows and comes from few places, so it is worth [rays of its own](super::shadow_rays) at
//! every element; what is reflected is smooth and comes from everywhere. Emitters that nearly touch a patch are taken by
//! exact factors times what rays see of them.

use super::estimates::{Brought, Round};
use super::receivers::by_patch;
use super::shadow_rays::ShadowRays;
use crate::form_factor::raycast::{RayCast, Shooter};
use crate::form_factor::{FormFactors, RayCastOptions};
use crate::patch::PatchMesh;
use crate::solution::BANDS;
use rayon::prelude::*;
use std::sync::Arc;

/// Rays over the hemisphere, of which pairs take their share.
const PAIR_RAYS: u32 = 4096;

/// Emitting patches, and what they shoot.
pub(super) struct Direct {
    mesh: Arc<PatchMesh>,
    /// `[channel][element]`.
    exitance: Vec<f32>,
    channels: usize,
    shadow_rays: ShadowRays,
    raycast: RayCast,
}

impl Direct {
    /// Emitters by their exitance, `[channel][element]`.
    pub(super) fn new(mesh: Arc<PatchMesh>, exitance: Vec<f32>, seed: u64) -> Self {
        let options = RayCastOptions {
            rays: PAIR_RAYS,
            seed,
            ..RayCastOptions::default()
        };
        Self {
            channels: exitance.len() / mesh.elements().len(),
            raycast: RayCast::new(mesh.clone(), options),
            shadow_rays: ShadowRays::new(mesh.clone(), &exitance, seed),
            exitance,
            mesh,
        }
    }

    /// Whether there is anything to do.
    pub(super) fn is_dark(&self) -> bool {
        self.shadow_rays.is_dark()
    }

    /// What is emitted, `[channel][element]`.
    pub(super) fn exitance(&self) -> &[f32] {
        &self.exitance
    }

    /// Irradiance from emitters that nearly touch, `[element][channel]`, and the rays it took.
    pub(super) fn near(&self) -> (Vec<f32>, u64) {
        let before = self.raycast.rays();
        let mut irradiance = vec![0.0; self.mesh.elements().len() * self.channels];
        by_patch(&self.mesh, &mut irradiance, self.channels)
            .into_par_iter()
            .enumerate()
            .for_each(|(patch, slot)| self.near_patch(patch, slot));
        (irradiance, self.raycast.rays() - before)
    }

    fn near_patch(&self, patch: usize, irradiance: &mut [f32]) {
        for emitter in self.shadow_rays.left_out(patch) {
            let from = Shooter::new(&self.mesh, emitter.id);
            let slots = irradiance.chunks_exact_mut(self.channels);
            for (slot, e) in slots.zip(self.mesh.elements_of_patch(patch)) {
                let area = f64::from(self.mesh.exposed_area(e));
                if area <= 0.0 {
                    continue;
                }
                let factor = self.raycast.pair(&from, e, self.mesh.elements()[e], 1.0);
                for (channel, (out, flux)) in slot.iter_mut().zip(&emitter.flux).enumerate() {
                    let visible = f64::from(factor.visible[channel % BANDS]);
                    *out += super::to_f32(flux * factor.unoccluded * visible / area);
                }
            }
        }
    }

    /// Irradiance from the others, by one more round of rays.
    pub(super) fn round(&mut self, round: Round<'_>) -> Brought {
        self.shadow_rays.round(round)
    }
}
