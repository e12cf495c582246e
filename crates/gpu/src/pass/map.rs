//! Environment maps on the device, of any projection and with their levels.

use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::count;
use half::f16;
use hemicube_raster::environment::{EnvironmentMap, Projection};
use hemicube_shaders::surface as twins;
use wgpu::{
    BindingType, Sampler, SamplerBindingType, Texture, TextureFormat, TextureSampleType,
    TextureUsages, TextureView, TextureViewDescriptor, TextureViewDimension,
};

/// Format of maps.
pub(crate) const MAP: TextureFormat = TextureFormat::Rgba16Float;
/// Brightest number that is stored: what is brighter is scaled.
const BRIGHTEST: f32 = 60_000.0;

/// An environment map as shaders look it up.
#[derive(Debug, Clone)]
pub(crate) struct DeviceMap {
    /// Faces of a cube; a single black texel each for other projections.
    pub(crate) cube: TextureView,
    /// Pictures of other projections; a single black texel for a cube.
    pub(crate) flat: TextureView,
    /// Smooth throughout.
    pub(crate) sampler: Sampler,
    /// `PROJECTION_*`.
    pub(crate) projection: u32,
    /// Radiance of a stored 1.
    pub(crate) scale: f32,
    pub(crate) levels: u32,
    /// Width and height of the finest level's faces.
    pub(crate) size: [u32; 2],
}

impl DeviceMap {
    /// Levels of a map, the finest first, each half as large as the one before.
    ///
    /// # Errors
    /// Levels of other sizes; larger than the adapter allows.
    pub(crate) fn new(context: &Context, levels: &[EnvironmentMap]) -> Result<Self, GpuError> {
        let Some(base) = levels.first() else {
            return Err(GpuError::Option(String::from(
                "an environment of no level; give it at least one",
            )));
        };
        check(context, base, levels)?;
        let brightest = levels.iter().flat_map(EnvironmentMap::texels);
        let brightest = brightest.fold(0.0_f32, |most, c| most.max(c.max_band()));
        let scale = (brightest / BRIGHTEST).max(1.0);
        let size = [count(base.width()), count(base.height())];
        let faces = count(base.projection().faces());
        let texture = map_texture(context, size, faces, count(levels.len()), MAP_READ);
        for (level, map) in (0..).zip(levels) {
            write(context, &texture, level, map, 1.0 / scale);
        }
        Ok(Self::of_texture(
            context,
            &texture,
            base.projection(),
            scale,
        ))
    }

    /// A texture that was filled on the device.
    pub(crate) fn of_texture(
        context: &Context,
        texture: &Texture,
        projection: Projection,
        scale: f32,
    ) -> Self {
        let is_cube = projection == Projection::Cube;
        let black = |layers| map_texture(context, [1, 1], layers, 1, MAP_READ);
        let view = |texture: &Texture, dimension| {
            texture.create_view(&TextureViewDescriptor {
                dimension: Some(dimension),
                ..Default::default()
            })
        };
        let (cube, flat) = if is_cube {
            (texture.clone(), black(1))
        } else {
            (black(6), texture.clone())
        };
        Self {
            cube: view(&cube, TextureViewDimension::Cube),
            flat: view(&flat, TextureViewDimension::D2Array),
            sampler: smooth(context),
            projection: number(projection),
            scale,
            levels: texture.mip_level_count(),
            size: [texture.width(), texture.height()],
        }
    }

    /// What a layout says of cube, picture and sampler.
    pub(crate) fn types() -> [BindingType; 3] {
        let of = |view_dimension| BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable: true },
            view_dimension,
            multisampled: false,
        };
        [
            of(TextureViewDimension::Cube),
            of(TextureViewDimension::D2Array),
            BindingType::Sampler(SamplerBindingType::Filtering),
        ]
    }
}

/// How maps are used that the CPU fills.
const MAP_READ: TextureUsages = TextureUsages::TEXTURE_BINDING.union(TextureUsages::COPY_DST);

/// A sampler that is smooth throughout.
pub(crate) fn smooth(context: &Context) -> Sampler {
    context.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("environment"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}

/// A texture for a map.
pub(crate) fn map_texture(
    context: &Context,
    [width, height]: [u32; 2],
    faces: u32,
    levels: u32,
    usage: TextureUsages,
) -> Texture {
    context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("environment"),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: faces,
        },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: MAP,
        usage,
        view_formats: &[],
    })
}

fn check(
    context: &Context,
    base: &EnvironmentMap,
    levels: &[EnvironmentMap],
) -> Result<(), GpuError> {
    let longest = base.width().max(base.height()) as u64;
    let allowed = u64::from(context.limits.max_texture_dimension_2d);
    context.allow(
        "texels of an environment's side",
        longest,
        allowed,
        "texels",
    )?;
    for (level, map) in levels.iter().enumerate() {
        let halved = |side: usize| (side >> level).max(1);
        let wanted = (halved(base.width()), halved(base.height()));
        let found = (map.width(), map.height());
        if found != wanted || map.projection() != base.projection() {
            return Err(GpuError::Option(format!(
                "level {level} of an environment has {} x {} texels, not {} x {}; each level must be half as large as the one before",
                found.0, found.1, wanted.0, wanted.1
            )));
        }
    }
    let most = 1 + longest.max(1).ilog2();
    context.allow(
        "levels of an environment",
        levels.len() as u64,
        most.into(),
        "levels",
    )
}

fn write(context: &Context, texture: &Texture, level: u32, map: &EnvironmentMap, factor: f32) {
    let texel = |c: &hemicube_raster::Rgb| {
        let [r, g, b] = c
            .to_array()
            .map(|band| f16::from_f32(band * factor).to_bits());
        [r, g, b, f16::ONE.to_bits()]
    };
    let texels: Vec<[u16; 4]> = map.texels().iter().map(texel).collect();
    let (width, height) = (count(map.width()), count(map.height()));
    let place = wgpu::TexelCopyTextureInfo {
        texture,
        mip_level: level,
        origin: wgpu::Origin3d::ZERO,
        aspect: wgpu::TextureAspect::All,
    };
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(8 * width),
        rows_per_image: Some(height),
    };
    let size = wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: count(map.projection().faces()),
    };
    let bytes = bytemuck::cast_slice(texels.as_flattened());
    context.queue.write_texture(place, bytes, layout, size);
}

fn number(projection: Projection) -> u32 {
    match projection {
        Projection::Cube => twins::PROJECTION_CUBE,
        Projection::LatLong => twins::PROJECTION_LATLONG,
        Projection::Sphere => twins::PROJECTION_SPHERE,
        Projection::Paraboloid => twins::PROJECTION_PARABOLOID,
        Projection::Octahedral => twins::PROJECTION_OCTAHEDRAL,
        Projection::Angular => twins::PROJECTION_ANGULAR,
        Projection::Fisheye => twins::PROJECTION_FISHEYE,
        Projection::Hemispherical => twins::PROJECTION_HEMISPHERICAL,
    }
}
