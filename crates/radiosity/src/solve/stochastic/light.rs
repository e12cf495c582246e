//! What irradiance is made of: direct light and reflected light, each with what is known of its error.

use super::estimates::{Brought, Estimates};
use super::gather::Found;
use super::interpolate::Interpolation;
use super::receivers::Receivers;
use super::shoot::Arrived;
use super::shrinkage::{Known, Shrinkage};
use crate::patch::PatchMesh;

/// Direct light of the elements.
pub(super) struct DirectLight {
    /// From emitters that nearly touch, `[element][channel]`; empty before the first round.
    pub(super) near: Vec<f32>,
    /// From the others.
    pub(super) far: Estimates,
    /// Factor by channel, which makes it account for all that is emitted.
    pub(super) scale: Vec<f64>,
}

impl DirectLight {
    /// Nothing is known yet.
    pub(super) fn new(elements: usize, channels: usize) -> Self {
        Self {
            near: Vec::new(),
            far: Estimates::new(elements, channels),
            scale: vec![1.0; channels],
        }
    }

    /// Irradiance of an element in a channel.
    pub(super) fn irradiance(&self, element: usize, channel: usize) -> f64 {
        let near = self.near.get(element * self.scale.len() + channel);
        let near = f64::from(near.copied().unwrap_or(0.0));
        // Less than nothing is found where more was expected than there is.
        (self.far.irradiance(element, channel).max(0.0) + near) * self.scale[channel]
    }

    /// Squared standard error of the irradiance summed over channels.
    pub(super) fn square(&self, element: usize) -> f64 {
        self.far.square(element)
    }
}

/// Reflected light: by shots to receivers, and better by what elements gather.
pub(super) struct Reflected {
    receivers: Receivers,
    /// Their exposed areas.
    pub(super) areas: Vec<f64>,
    /// By shots, `[channel][receiver]`.
    shot: Vec<f64>,
    /// By gathering; none before the first round.
    pub(super) gathered: Option<Gathered>,
    /// Irradiance of the elements by what is known, `[channel][element]`.
    pub(super) light: Vec<f32>,
    /// Factor by channel on that, which makes it account for all that is reflected.
    pub(super) scale: Vec<f64>,
}

/// What elements gathered: the two kinds of rays see different light.
pub(super) struct Gathered {
    pub(super) highlights: Estimates,
    pub(super) rest: Estimates,
    /// Whether it is light that patches counted, which tells how many rays are wanted and is replaced by what those find.
    pub(super) is_draft: bool,
    /// How both are joined with what is around them.
    shrinkages: [Shrinkage; 2],
    /// Sums of the inverse distances of what the rays to the rest met.
    nearness: Vec<f32>,
}

impl Reflected {
    /// Nothing is known yet.
    pub(super) fn new(mesh: &PatchMesh, receivers: Receivers, channels: usize) -> Self {
        let areas = receivers.areas(mesh);
        Self {
            receivers,
            shot: vec![0.0; channels * areas.len()],
            gathered: None,
            light: vec![0.0; channels * mesh.elements().len()],
            scale: vec![1.0; channels],
            areas,
        }
    }

    /// Adds what shots brought.
    pub(super) fn add_shots(
        &mut self,
        mesh: &PatchMesh,
        arrived: &Arrived,
        interpolation: &Interpolation,
    ) {
        let received = self.shot.iter_mut().zip(&arrived.received);
        for ((old, new), area) in received.zip(self.areas.iter().cycle()) {
            *old += if *area > 0.0 { new / area } else { 0.0 };
        }
        let light: Vec<f32> = self
            .shot
            .iter()
            .map(|&light| super::to_f32(light))
            .collect();
        if self.receivers == Receivers::Elements {
            self.light = light;
            return;
        }
        let elements = self.light.len() / self.scale.len();
        let channels = self.light.chunks_exact_mut(elements);
        for (elements, patches) in channels.zip(light.chunks_exact(self.areas.len())) {
            interpolation.to_elements(mesh, patches, elements);
        }
    }

    /// Adds what elements gathered, of highlights and of all else.
    pub(super) fn add_gathered(
        &mut self,
        mesh: &PatchMesh,
        brought: (&Brought, &Found),
        wanted: &[Vec<u32>; 2],
        interpolation: &Interpolation,
    ) {
        let Some(gathered) = &mut self.gathered else {
            return;
        };
        gathered.add(brought, wanted);
        gathered.shrink(mesh, interpolation);
        let elements = self.light.len() / self.scale.len();
        for (channel, light) in self.light.chunks_exact_mut(elements).enumerate() {
            gathered.light(mesh, channel, interpolation, light);
        }
    }

    /// What was gathered so far, to be added to: nothing the first time, and nothing after a draft.
    pub(super) fn gathered(&mut self) -> &mut Gathered {
        let (elements, channels) = (self.light.len() / self.scale.len(), self.scale.len());
        // What patches counted is too coarse to be gathered for more than a draft.
        let is_draft = self.gathered.is_none() && self.receivers == Receivers::Patches;
        self.gathered.take_if(|gathered| gathered.is_draft);
        self.gathered
            .get_or_insert_with(|| Gathered::new(elements, channels, is_draft))
    }

    /// Whether what was gathered is a draft.
    pub(super) fn is_draft(&self) -> bool {
        self.gathered
            .as_ref()
            .is_some_and(|gathered| gathered.is_draft)
    }

    /// Irradiance of an element in a channel.
    pub(super) fn irradiance(&self, element: usize, channel: usize) -> f64 {
        let elements = self.light.len() / self.scale.len();
        f64::from(self.light[channel * elements + element]) * self.scale[channel]
    }

    /// Squared standard error of the irradiance summed over channels; infinite before the first gathering.
    pub(super) fn square(&self, element: usize) -> f64 {
        let of = |gathered: &Gathered| gathered.square(element);
        self.gathered.as_ref().map_or(f64::INFINITY, of)
    }
}

impl Gathered {
    fn new(elements: usize, channels: usize, is_draft: bool) -> Self {
        Self {
            is_draft,
            highlights: Estimates::new(elements, channels),
            rest: Estimates::new(elements, channels),
            shrinkages: Default::default(),
            nearness: vec![0.0; elements],
        }
    }

    /// Both kinds, each with how it is joined with what is around.
    pub(super) fn parts(&self) -> [(&Estimates, &Shrinkage); 2] {
        let [highlights, rest] = &self.shrinkages;
        [(&self.highlights, highlights), (&self.rest, rest)]
    }

    fn add(&mut self, (highlights, rest): (&Brought, &Found), wanted: &[Vec<u32>; 2]) {
        self.highlights.add(highlights, &wanted[0]);
        self.rest.add(&rest.light, &wanted[1]);
        let pairs = self.nearness.iter_mut().zip(&rest.nearness);
        pairs.for_each(|(sum, new)| *sum += new);
    }

    fn shrink(&mut self, mesh: &PatchMesh, interpolation: &Interpolation) {
        self.shrinkages = [&self.highlights, &self.rest].map(|estimates| {
            let known = Known {
                estimates,
                light: &estimates.sums(),
                nearness: (&self.nearness, self.rest.rays()),
            };
            Shrinkage::new(mesh, interpolation, known)
        });
    }

    /// Irradiance of the elements in a channel.
    fn light(
        &self,
        mesh: &PatchMesh,
        channel: usize,
        interpolation: &Interpolation,
        light: &mut [f32],
    ) {
        light.fill(0.0);
        for (estimates, shrinkage) in self.parts() {
            let elements = 0..light.len();
            let mut part: Vec<f32> = elements
                .map(|e| super::to_f32(estimates.irradiance(e, channel)))
                .collect();
            let mut said = vec![0.0; part.len()];
            let patches = shrinkage.of_patches(mesh, &part);
            interpolation.to_elements(mesh, &patches, &mut said);
            shrinkage.pull(&mut part, &said);
            light
                .iter_mut()
                .zip(part)
                .for_each(|(sum, part)| *sum += part);
        }
        // What was taken for highlights at first may be more than what is there by now.
        light.iter_mut().for_each(|value| *value = value.max(0.0));
    }

    fn square(&self, element: usize) -> f64 {
        let square = |(light, shrinkage): (&Estimates, &Shrinkage)| {
            light.square(element) * shrinkage.left(element)
        };
        self.parts().map(square).iter().sum()
    }
}
