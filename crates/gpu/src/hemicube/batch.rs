//! Memory for the hemicubes of one submission.

use super::geometry::{ALL, Geometry};
use super::pass::{DEPTH, HemicubePass, ITEMS};
use crate::buffer::{bind, empty, filled, read};
use crate::context::Context;
use crate::error::GpuError;
use hemicube_radiosity::form_factor::hemicube::Sums;
use hemicube_shaders::hemicube as twins;
use hemicube_shaders::memory::{DRAW_BYTES, HemicubeSize, STRIDE};
use wgpu::{
    BindGroup, BindingResource, Buffer, BufferUsages, CommandEncoder, SubmissionIndex, Texture,
    TextureUsages, TextureView, TextureViewDimension,
};

/// Most memory of the pictures of a submission, in bytes.
const MOST_PICTURES: u64 = 64 << 20;

/// Memory for the hemicubes of one submission.
#[derive(Debug)]
pub(crate) struct Batch {
    /// Hemicubes that it holds.
    pub(crate) views: usize,
    elements: usize,
    bands: usize,
    bytes: u64,
    pub(crate) viewpoints: Buffer,
    pub(crate) sums: Buffer,
    /// Where the CPU reads the sums.
    read: Buffer,
    items: Texture,
    /// One picture for each hemicube.
    pub(super) pictures: Vec<TextureView>,
    /// One for all hemicubes, or one for each where it is looked at afterwards.
    depths: Vec<TextureView>,
    /// Arguments of draw calls.
    pub(super) draws: Buffer,
    pub(super) place: BindGroup,
    pub(super) arrange: BindGroup,
    pub(super) draw: BindGroup,
    pub(super) view: BindGroup,
    pub(super) sum: BindGroup,
    /// Where panes let light through.
    pub(super) peeled: Option<Peeled>,
}

/// What waits behind panes.
#[derive(Debug)]
pub(super) struct Peeled {
    /// Whether anything waits for a layer.
    pub(super) waits: Buffer,
    pub(super) through_bindings: BindGroup,
    pub(super) peel: BindGroup,
    pub(super) layer: BindGroup,
    pub(super) gate: BindGroup,
    /// Of what it made itself.
    bytes: u64,
}

/// The largest part of a hemicube that is bound at once, and what it is.
fn largest(sizes: &HemicubeSize) -> (&'static str, u64) {
    [
        ("vertices", sizes.placed),
        ("lists of elements", sizes.lists),
        ("sums", sizes.sums),
        ("cells behind panes", sizes.through),
    ]
    .into_iter()
    .fold(("", 1), |most, one| if one.1 > most.1 { one } else { most })
}

impl Batch {
    /// Memory for at most `most` hemicubes at once.
    pub(crate) fn new(
        context: &Context,
        pass: &HemicubePass,
        geometry: &Geometry,
        most: u64,
    ) -> Result<Self, GpuError> {
        let sizes = geometry.size.hemicube();
        let binding = context.limits.max_storage_buffer_binding_size;
        let (what, largest) = largest(&sizes);
        context.allow(what, largest, binding, "bytes")?;
        let views = most
            .min(binding / largest)
            .min((MOST_PICTURES / (sizes.pictures + sizes.through)).max(1))
            .min(u64::from(context.limits.max_texture_array_layers));
        let layers = u32::try_from(views).expect("a few");
        let device = &context.device;
        let (storage, copied) = (
            BufferUsages::STORAGE,
            BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        );
        let to_read = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let each = |label, bytes: u64, usage| empty(device, label, views * bytes, usage);
        let viewpoint_bytes = size_of::<twins::Viewpoint>() as u64;
        let viewpoints = each(
            "viewpoints",
            viewpoint_bytes,
            storage | BufferUsages::COPY_DST,
        );
        let placed = each("placed vertices", sizes.placed, storage);
        let masks = each("seen receivers", sizes.masks, storage);
        let nearest = each("nearest", 4, storage);
        let starts = each("starts of lists", sizes.starts, storage);
        let lists = each("lists of receivers", sizes.lists, storage);
        let draw_bytes = u64::from(twins::FACES) * DRAW_BYTES;
        let draws = each("draw calls", draw_bytes, storage | BufferUsages::INDIRECT);
        let sums = each("sums", sizes.sums, storage | copied);
        let read = each("sums to read", sizes.sums, to_read);
        let faces = faces(device, layers);
        let is_layered = geometry.layers > 1;
        let items = picture_texture(context, "item buffers", geometry, layers, ITEMS);
        let depth_layers = if is_layered { layers } else { 1 };
        let depth = picture_texture(context, "depth", geometry, depth_layers, DEPTH);
        let all_items = all_layers(&items);
        let [parameters, vertices, corners, receivers, deltas] = [
            &geometry.params_buffer,
            &geometry.vertices,
            &geometry.corners,
            &geometry.receivers,
            &geometry.deltas,
        ]
        .map(Buffer::as_entire_binding);
        let [viewpoint, place, mask, near, start, list, call, sum] = [
            &viewpoints,
            &placed,
            &masks,
            &nearest,
            &starts,
            &lists,
            &draws,
            &sums,
        ]
        .map(Buffer::as_entire_binding);
        let mut bytes = [
            &viewpoints,
            &placed,
            &masks,
            &nearest,
            &starts,
            &lists,
            &draws,
            &sums,
            &read,
            &faces,
        ]
        .iter()
        .map(|buffer| buffer.size())
        .sum::<u64>()
            + 4 * geometry.size.cells() * u64::from(layers + depth_layers);
        let peeled = pass.peeling.as_ref().map(|_| {
            let through = each("through panes", sizes.through, storage);
            bytes += through.size();
            let depths = all_layers(&depth);
            Peeled::new(
                context,
                pass,
                geometry,
                layers,
                &through,
                [
                    parameters.clone(),
                    BindingResource::TextureView(&all_items),
                    BindingResource::TextureView(&depths),
                    deltas.clone(),
                    sum.clone(),
                ],
                call.clone(),
            )
        });
        Ok(Self {
            views: layers as usize,
            elements: geometry.params.elements as usize,
            bands: usize::try_from(geometry.size.bands()).expect("one or three"),
            bytes: bytes + peeled.as_ref().map_or(0, |peeled| peeled.bytes),
            place: bind(
                device,
                "place hemicubes",
                &pass.place_layout,
                &[
                    parameters.clone(),
                    vertices,
                    corners.clone(),
                    receivers,
                    viewpoint.clone(),
                    place.clone(),
                    mask.clone(),
                    near.clone(),
                ],
            ),
            arrange: bind(
                device,
                "arrange hemicubes",
                &pass.arrange_layout,
                &[parameters.clone(), mask, start, list.clone(), call],
            ),
            draw: bind(
                device,
                "draw hemicubes",
                &pass.draw_layout,
                &[parameters.clone(), corners, viewpoint, place, list, near],
            ),
            view: bind(
                device,
                "face",
                &pass.view_layout,
                &[slot(&faces, size_of::<twins::DrawParams>())],
            ),
            sum: bind(
                device,
                "sum hemicubes",
                &pass.sum_layout,
                &[
                    parameters,
                    BindingResource::TextureView(&all_items),
                    deltas,
                    sum,
                ],
            ),
            pictures: (0..layers).map(|layer| one_layer(&items, layer)).collect(),
            depths: (0..depth_layers)
                .map(|layer| one_layer(&depth, layer))
                .collect(),
            peeled,
            items,
            viewpoints,
            draws,
            sums,
            read,
        })
    }

    /// Bytes on the device.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The depth picture of a hemicube.
    pub(super) fn depth(&self, view: u32) -> &TextureView {
        &self.depths[view as usize % self.depths.len()]
    }

    /// Bytes of the sums of some hemicubes.
    pub(super) fn sum_bytes(&self, views: usize) -> u64 {
        (views * self.bands * (self.elements + 2) * 4) as u64
    }

    pub(super) fn copy_sums(&self, encoder: &mut CommandEncoder, views: usize) {
        encoder.copy_buffer_to_buffer(&self.sums, 0, &self.read, 0, self.sum_bytes(views));
    }

    pub(super) fn read_sums(
        &self,
        context: &Context,
        views: usize,
        submission: SubmissionIndex,
    ) -> Result<Vec<Sums>, GpuError> {
        let bins = self.elements + 2;
        let words = read(context, &self.read, self.sum_bytes(views), submission)?;
        let share = |word: &u32| f64::from(*word) / ALL;
        let sums = |words: &[u32]| {
            let bands: Vec<&[u32]> = words.chunks(bins).collect();
            let of_band = |band: usize| bands[band % bands.len()];
            Sums {
                received: bands
                    .iter()
                    .flat_map(|words| words[..self.elements].iter().map(share))
                    .collect(),
                absorbed: [0, 1, 2].map(|band| share(&of_band(band)[self.elements])),
                escaped: [0, 1, 2].map(|band| share(&of_band(band)[self.elements + 1])),
            }
        };
        Ok(words.chunks(self.bands * bins).map(sums).collect())
    }

    /// The first picture, row by row.
    pub(super) fn read_picture(&self, context: &Context) -> Result<Vec<u32>, GpuError> {
        let size = wgpu::Extent3d {
            depth_or_array_layers: 1,
            ..self.items.size()
        };
        let row = (size.width * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let bytes = u64::from(row) * u64::from(size.height);
        let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let buffer = empty(&context.device, "picture to read", bytes, usage);
        let mut encoder = context
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            self.items.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: None,
                },
            },
            size,
        );
        let submission = context.queue.submit([encoder.finish()]);
        let words = read(context, &buffer, bytes, submission)?;
        let rows = words.chunks(row as usize / 4);
        Ok(rows
            .flat_map(|row| &row[..size.width as usize])
            .copied()
            .collect())
    }
}

impl Peeled {
    /// `common` are the bindings that peeling shares with summing, depths among them.
    fn new(
        context: &Context,
        pass: &HemicubePass,
        geometry: &Geometry,
        views: u32,
        through: &Buffer,
        common: [BindingResource<'_>; 5],
        draws: BindingResource<'_>,
    ) -> Self {
        let peeling = pass.peeling.as_ref().expect("made for meshes with panes");
        let device = &context.device;
        let bytes = 4 * u64::from(views * twins::MAX_LAYERS);
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let waits = empty(device, "waiting hemicubes", bytes, usage);
        let layers: Vec<u32> = (0..geometry.layers)
            .flat_map(|layer| slot_words([layer, u32::from(layer + 1 == geometry.layers)]))
            .collect();
        let layers = filled(device, "layers", &layers, BufferUsages::UNIFORM);
        let mut bindings = common.to_vec();
        bindings.extend([
            through.as_entire_binding(),
            geometry.transmittance.as_entire_binding(),
            waits.as_entire_binding(),
        ]);
        Self {
            through_bindings: bind(
                device,
                "through",
                &peeling.through_layout,
                &[through.as_entire_binding()],
            ),
            peel: bind(device, "peel hemicubes", &peeling.peel_layout, &bindings),
            layer: bind(
                device,
                "layer",
                &peeling.layer_layout,
                &[slot(&layers, size_of::<twins::LayerParams>())],
            ),
            gate: bind(device, "gate", &peeling.gate_layout, &[draws]),
            bytes: waits.size() + layers.size(),
            waits,
        }
    }
}

/// Parameters of all draw calls, each in a slot of its own.
fn faces(device: &wgpu::Device, views: u32) -> Buffer {
    let draws: Vec<u32> = (0..views)
        .flat_map(|view| (0..twins::FACES).map(move |face| [view, face]))
        .flat_map(slot_words)
        .collect();
    filled(device, "draw parameters", &draws, BufferUsages::UNIFORM)
}

/// Two words at the beginning of a slot.
fn slot_words([a, b]: [u32; 2]) -> [u32; STRIDE as usize / 4] {
    let mut words = [0; STRIDE as usize / 4];
    [words[0], words[1]] = [a, b];
    words
}

/// The first slot of a buffer, to be moved by dynamic offsets.
fn slot(buffer: &Buffer, bytes: usize) -> BindingResource<'_> {
    BindingResource::Buffer(wgpu::BufferBinding {
        buffer,
        offset: 0,
        size: wgpu::BufferSize::new(bytes as u64),
    })
}

fn one_layer(texture: &Texture, layer: u32) -> TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2),
        base_array_layer: layer,
        array_layer_count: Some(1),
        ..Default::default()
    })
}

fn all_layers(texture: &Texture) -> TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2Array),
        ..Default::default()
    })
}

/// A texture for pictures of hemicubes.
fn picture_texture(
    context: &Context,
    label: &str,
    geometry: &Geometry,
    layers: u32,
    format: wgpu::TextureFormat,
) -> Texture {
    let resolution = geometry.params.resolution;
    let is_read = format == ITEMS || geometry.layers > 1;
    let mut usage = TextureUsages::RENDER_ATTACHMENT;
    usage.set(TextureUsages::TEXTURE_BINDING, is_read);
    usage.set(TextureUsages::COPY_SRC, format == ITEMS);
    context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width: 2 * resolution,
            height: 3 * resolution / 2,
            depth_or_array_layers: layers,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}
