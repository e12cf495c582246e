//! How bright a lit scene is, for exposures and scales, without its light coming to the CPU: 8 KiB of histograms come in its
//! place, whatever the size of the scene.

use crate::buffer::{bind, compute, empty, filled, groups, layout, module, storage, uniform};
use crate::context::Context;
use crate::hemicube::{compute_pass, count};
use crate::pass::light::SurfaceLight;
use crate::pass::walkthrough::{Walkthrough, locked};
use core::fmt;
use hemicube_radiosity::PatchMesh;
use hemicube_raster::Rgb;
use hemicube_scene::Units;
use hemicube_shaders::surface as twins;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use wgpu::{
    BindGroupLayout, Buffer, BufferUsages, CommandEncoder, ComputePipeline, Device, ShaderStages,
};

/// Bytes of both histograms.
const BYTES: u64 = 2 * 4 * twins::METER_BINS as u64;

/// Counts elements by how bright they are.
#[derive(Debug)]
pub(crate) struct MeterPass {
    layout: BindGroupLayout,
    meter: ComputePipeline,
}

impl MeterPass {
    pub(crate) fn new(context: &Context) -> Self {
        let (device, reads) = (&context.device, storage(true));
        let types = [uniform(false), reads, reads, reads, storage(false)];
        let layout = layout(device, "metering", ShaderStages::COMPUTE, &types);
        let shader = module(device, &twins::METERING);
        Self {
            meter: compute(device, &shader, "meter", &[&layout]),
            layout,
        }
    }

    /// Counts into a buffer that the CPU can read.
    fn encode(
        &self,
        device: &Device,
        encoder: &mut CommandEncoder,
        light: &SurfaceLight,
        surfaces: &MeteredSurfaces,
    ) -> Buffer {
        let counted = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let counts = empty(device, "histograms", BYTES, counted);
        let read = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let read = empty(device, "histograms to read", BYTES, read);
        let all = [
            &surfaces.params,
            &light.element_light,
            &light.element_dims,
            &surfaces.surfaces,
            &counts,
        ];
        let bindings = all.map(Buffer::as_entire_binding);
        let bindings = bind(device, "metering", &self.layout, &bindings);
        let (x, z) = groups(surfaces.elements, 64);
        let mut pass = compute_pass(encoder, "metering");
        pass.set_pipeline(&self.meter);
        pass.set_bind_group(0, &bindings, &[]);
        pass.dispatch_workgroups(x, 1, z);
        drop(pass);
        encoder.copy_buffer_to_buffer(&counts, 0, &read, 0, BYTES);
        read
    }
}

/// What metering has to know of a mesh.
#[derive(Debug)]
pub(crate) struct MeteredSurfaces {
    params: Buffer,
    surfaces: Buffer,
    elements: u32,
}

impl MeteredSurfaces {
    pub(crate) fn new(context: &Context, mesh: &PatchMesh) -> Self {
        let device = &context.device;
        let elements = count(mesh.elements().len());
        let params = twins::MeterParams {
            weights: weights(mesh.scene().units),
            elements,
        };
        let surface = |(reflectance, emission): (&Rgb, &Rgb)| {
            let bits = [1.0, 2.0, 4.0].into_iter().zip(emission.to_array());
            let bands: f32 = bits.map(|(bit, e)| if e > 0.0 { bit } else { 0.0 }).sum();
            let [r, g, b] = reflectance.to_array();
            [r, g, b, bands]
        };
        let all = mesh.reflectance().iter().zip(mesh.emission());
        let surfaces: Vec<[f32; 4]> = all.map(surface).collect();
        Self {
            params: filled(device, "metering", &[params], BufferUsages::UNIFORM),
            surfaces: filled(device, "metered surfaces", &surfaces, BufferUsages::STORAGE),
            elements,
        }
    }
}

/// What illuminance is of irradiance in each band.
fn weights(units: Units) -> [f32; 3] {
    [
        Rgb::new(1.0, 0.0, 0.0),
        Rgb::new(0.0, 1.0, 0.0),
        Rgb::new(0.0, 0.0, 1.0),
    ]
    .map(|band| units.illuminance(band))
}

/// A measurement that is on its way to the CPU.
pub struct Metering {
    context: Arc<Context>,
    buffer: Buffer,
    mapped: Receiver<bool>,
}

impl fmt::Debug for Metering {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Metering").finish_non_exhaustive()
    }
}

impl Metering {
    /// What was measured, once it is there; black if the device was lost meanwhile.
    pub fn take(&self) -> Option<Meter> {
        // What is there is told while polling.
        let _ = self.context.check();
        let is_mapped = self.mapped.try_recv().ok()?;
        let view = is_mapped.then(|| self.buffer.get_mapped_range(..).ok());
        let words: Option<Vec<u32>> = view.flatten().map(|v| bytemuck::pod_collect_to_vec(&v));
        Some(words.map_or_else(Meter::default, |words| Meter::of_words(&words)))
    }
}

/// How bright a lit scene is: elements counted by the luminance of the light that they reflect, without those that emit, and
/// by their illuminance.
///
/// Brightness is known to a sixteenth of a stop: a value is off by 2.2 % at most, means and percentiles of many by less.
/// Values are between 2⁻³² and 2³²; others count as the nearest of these, black ones not at all.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Meter {
    luminances: Vec<u32>,
    illuminances: Vec<u32>,
}

impl Meter {
    fn of_words(words: &[u32]) -> Self {
        let (luminances, illuminances) = words.split_at(twins::METER_BINS as usize);
        Self {
            luminances: luminances.to_vec(),
            illuminances: illuminances.to_vec(),
        }
    }

    /// Luminances of reflected light in ascending order, one for each element: that of [`automatic_exposure`] and its like.
    ///
    /// [`automatic_exposure`]: hemicube_raster::tonemap::automatic_exposure
    pub fn luminances(&self) -> impl Iterator<Item = f32> + '_ {
        values(&self.luminances)
    }

    /// Illuminances in lx in ascending order, one for each element.
    pub fn illuminances(&self) -> impl Iterator<Item = f32> + '_ {
        values(&self.illuminances)
    }
}

/// The middle of each bin as often as it was counted.
fn values(counts: &[u32]) -> impl Iterator<Item = f32> + '_ {
    let value = |(bin, &times): (usize, &u32)| {
        let stops = (bin as f32 + 0.5) / twins::METER_BINS_PER_STOP as f32;
        let value = (stops - twins::METER_STOPS_BELOW_ONE as f32).exp2();
        core::iter::repeat_n(value, times as usize)
    };
    counts.iter().enumerate().flat_map(value)
}

impl Walkthrough {
    /// Begins to measure how bright the scene is in the light that the next picture would show. `done` is called, from any
    /// thread that polls the device, when the measurement can be taken.
    pub fn meter(&mut self, done: impl FnOnce() + Send + 'static) -> Metering {
        let (context, passes) = (self.context.clone(), self.passes.clone());
        let passes = locked(&passes);
        let descriptor = wgpu::CommandEncoderDescriptor {
            label: Some("metering"),
        };
        let mut encoder = context.device.create_command_encoder(&descriptor);
        let surfaces = &mut self.surfaces;
        surfaces.light.update(&mut encoder, &passes.light);
        let (light, metered) = (&surfaces.light, &surfaces.metered);
        let device = &context.device;
        let buffer = passes.meter.encode(device, &mut encoder, light, metered);
        context.queue.submit([encoder.finish()]);
        let (send, mapped) = channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // Nobody may want to know any more.
            let _ = send.send(result.is_ok());
            done();
        });
        drop(passes);
        Metering {
            context,
            buffer,
            mapped,
        }
    }

    /// Takes over the reflectances and emissions of a mesh that has the same elements, for [`Self::meter`].
    pub fn set_metered(&mut self, mesh: &PatchMesh) {
        self.surfaces.metered = MeteredSurfaces::new(&self.context, mesh);
    }
}
