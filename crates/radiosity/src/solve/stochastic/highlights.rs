//! The brightest of what is reflected, which rays that gather would rarely meet: it is taken for emitted, and
//! [shadow rays](super::shadow_rays) go where it is.
//!
//! Of a radiosity beyond [`BRIGHT`] times the mean, that beyond is a highlight. In a theatre, 3 % of the surfaces near
//! the lamps send out a quarter of all reflected light, and without it the variance of what a ray meets is a tenth.

use super::estimates::{Brought, Round};
use super::lights::Place;
use super::shadow_rays::ShadowRays;
use crate::patch::PatchMesh;
use std::sync::Arc;

/// Highlights are what is beyond so many times the mean radiosity.
const BRIGHT: f32 = 4.0;

/// What is taken out of the reflected radiosity.
pub(super) struct Highlights {
    channels: usize,
    /// `[element][channel]`.
    radiosity: Vec<f32>,
    shadow_rays: ShadowRays,
}

impl Highlights {
    /// Of a reflected radiosity, `[element][channel]`.
    pub(super) fn new(
        mesh: &Arc<PatchMesh>,
        radiosity: &[f32],
        channels: usize,
        seed: u64,
    ) -> Self {
        let sums: Vec<f32> = radiosity
            .chunks_exact(channels)
            .map(|of_element| of_element.iter().sum())
            .collect();
        let most = BRIGHT * super::mean(mesh, &sums);
        let mut highlights = vec![0.0; radiosity.len()];
        let mut by_channel = vec![0.0; radiosity.len()];
        for (e, &sum) in sums.iter().enumerate().filter(|&(_, &sum)| sum > most) {
            for channel in 0..channels {
                let b = radiosity[e * channels + channel] * (1.0 - most / sum);
                highlights[e * channels + channel] = b;
                by_channel[channel * sums.len() + e] = b;
            }
        }
        Self {
            channels,
            shadow_rays: ShadowRays::new(mesh.clone(), &by_channel, seed),
            radiosity: highlights,
        }
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.shadow_rays.is_dark()
    }

    /// What they bring to receivers that they do not nearly touch, by one more round of rays.
    pub(super) fn round(&mut self, round: Round<'_>) -> Brought {
        self.shadow_rays.round(round)
    }

    /// What of an element's radiosity, by channel, comes to a receiver by [`Self::round`]; empty if nothing does.
    pub(super) fn of_element(&self, mesh: &PatchMesh, element: usize, receiver: &Place) -> &[f32] {
        let patch = mesh.patch_of_element(element);
        if self.shadow_rays.is_far(patch, receiver) {
            &self.radiosity[element * self.channels..(element + 1) * self.channels]
        } else {
            &[]
        }
    }
}
