//! Pictures on the device: those that are drawn into, and how they come to the CPU.

use crate::buffer::{empty, read};
use crate::context::Context;
use crate::error::GpuError;
use crate::pass::lit::Pixels;
use crate::pass::pipeline::DEPTH;
use wgpu::{
    BufferUsages, Texture, TextureFormat, TextureUsages, TextureView, TextureViewDescriptor,
};

/// Where a picture is drawn to.
#[derive(Debug, Clone, Copy)]
pub struct Target<'a> {
    /// All of it is drawn over.
    pub view: &'a TextureView,
    /// Its format. Those with sRGB and those of floats get linear colours, others sRGB-encoded ones.
    pub format: TextureFormat,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

/// Colour and depth of a size.
#[derive(Debug)]
pub(crate) struct Frame {
    pub(crate) size: [u32; 2],
    pub(crate) pixels: Pixels,
    pub(crate) texture: Texture,
    pub(crate) color: TextureView,
    pub(crate) depth: TextureView,
}

impl Frame {
    /// Not yet drawn.
    ///
    /// # Errors
    /// A side is longer than the adapter allows.
    pub(crate) fn new(context: &Context, size: [u32; 2], pixels: Pixels) -> Result<Self, GpuError> {
        check_size(context, size)?;
        let used = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        let copied = match pixels.samples {
            1 => TextureUsages::COPY_SRC,
            _ => TextureUsages::empty(),
        };
        let texture = texture(context, "picture", size, pixels, used | copied);
        let of_depth = Pixels {
            format: DEPTH,
            ..pixels
        };
        let depth = self::texture(
            context,
            "depth",
            size,
            of_depth,
            TextureUsages::RENDER_ATTACHMENT,
        );
        Ok(Self {
            size,
            pixels,
            color: texture.create_view(&TextureViewDescriptor::default()),
            depth: depth.create_view(&TextureViewDescriptor::default()),
            texture,
        })
    }
}

/// Refuses pictures that the adapter does not draw.
pub(crate) fn check_size(context: &Context, size: [u32; 2]) -> Result<(), GpuError> {
    let largest = u64::from(context.limits.max_texture_dimension_2d);
    if size.contains(&0) {
        return Err(GpuError::Option(format!(
            "picture of {} x {} pixels: each side must be at least 1",
            size[0], size[1]
        )));
    }
    let longest = u64::from(size[0].max(size[1]));
    context.allow(
        "pixels of a side, with its samples,",
        longest,
        largest,
        "pixels",
    )
}

/// A picture of one level.
pub(crate) fn texture(
    context: &Context,
    label: &str,
    size: [u32; 2],
    pixels: Pixels,
    usage: TextureUsages,
) -> Texture {
    context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width: size[0],
            height: size[1],
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: pixels.samples,
        dimension: wgpu::TextureDimension::D2,
        format: pixels.format,
        usage,
        view_formats: &[],
    })
}

/// The texels of a picture's first level, row by row, as 32-bit words.
pub(crate) fn read_texels(context: &Context, texture: &Texture) -> Result<Vec<u32>, GpuError> {
    let size = wgpu::Extent3d {
        depth_or_array_layers: 1,
        ..texture.size()
    };
    let texel = texture.format().block_copy_size(None).unwrap_or(4);
    let row = size.width * texel;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let bytes = u64::from(padded) * u64::from(size.height);
    let usage = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
    let buffer = empty(&context.device, "picture to read", bytes, usage);
    let descriptor = wgpu::CommandEncoderDescriptor {
        label: Some("picture to the CPU"),
    };
    let mut encoder = context.device.create_command_encoder(&descriptor);
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded),
                rows_per_image: None,
            },
        },
        size,
    );
    let submission = context.queue.submit([encoder.finish()]);
    let words = read(context, &buffer, bytes, submission)?;
    let rows = words.chunks(padded as usize / 4);
    Ok(rows
        .flat_map(|words| &words[..row as usize / 4])
        .copied()
        .collect())
}
