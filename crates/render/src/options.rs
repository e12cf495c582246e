//! What a picture is made with.

use crate::error::RenderError;
use core::fmt;
use core::str::FromStr;
use hemicube_raster::Rgb;
use hemicube_raster::antialias::{Antialiasing, Factor, Supersampler};
use hemicube_raster::triangle::Viewport;

/// Longest side of a picture in pixels.
pub(crate) const MAX_SIDE: usize = 16_384;

/// Three samples in each direction of a pixel.
const DEFAULT_FACTOR: Factor = match Factor::new(3) {
    Some(factor) => factor,
    None => Factor::ONE,
};

/// What a picture is made with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderOptions {
    /// Pixels in a row, at most 16,384. Default value: 900.
    pub width: usize,
    /// Rows, at most 16,384, and [`Self::MAX_PIXELS`] in all. Default value: 600.
    pub height: usize,
    /// Where the irradiance of a point comes from. Default value: Gouraud.
    pub shading: Shading,
    /// Where the samples of a pixel lie and how they are weighted. Default value: 3 x 3 on a regular grid, averaged
    /// (`3x3`).
    pub antialias: Antialiasing,
    /// How textures are read from afar. Default value: EWA.
    pub texture_filter: TextureFilter,
    /// Whether the estimate of light still to come is added to solutions that were made with it (`ambient-shooting`).
    /// Gathered pictures never add it. Default value: true.
    pub ambient: bool,
    /// Rays over the hemisphere for each gathered irradiance of a pixel. Default value: 256.
    pub gather_rays: u32,
    /// Radiance where nothing is drawn and the scene has no sky. Default value: none, which is black.
    pub background: Option<Rgb>,
    /// Edges of the mesh over pictures for displays; radiance has none. Default value: none.
    pub mesh: Option<MeshOverlay>,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            width: 900,
            height: 600,
            shading: Shading::default(),
            antialias: Antialiasing::regular(DEFAULT_FACTOR),
            texture_filter: TextureFilter::default(),
            ambient: true,
            gather_rays: 256,
            background: None,
            mesh: None,
        }
    }
}

impl RenderOptions {
    /// Most pixels of a picture, 2^25: one of 8K fits. They are kept in memory, 12 bytes each.
    pub const MAX_PIXELS: usize = 1 << 25;

    /// A picture of `width` by `height` pixels.
    pub fn with_size(self, width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            ..self
        }
    }

    /// Another shading.
    pub fn with_shading(self, shading: Shading) -> Self {
        Self { shading, ..self }
    }

    /// Another antialiasing.
    pub fn with_antialias(self, antialias: Antialiasing) -> Self {
        Self { antialias, ..self }
    }

    /// `side × side` samples a pixel on a regular grid, averaged; a side beyond 1 to [`Factor::MAX`] counts as that bound.
    pub fn with_samples(self, side: usize) -> Self {
        let factor = Factor::new(side.clamp(1, Factor::MAX)).unwrap_or(Factor::ONE);
        self.with_antialias(Antialiasing::regular(factor))
    }

    /// Another way of reading textures.
    pub fn with_texture_filter(self, texture_filter: TextureFilter) -> Self {
        Self {
            texture_filter,
            ..self
        }
    }

    /// With or without the ambient estimate.
    pub fn with_ambient(self, ambient: bool) -> Self {
        Self { ambient, ..self }
    }

    /// So many rays for each gathered irradiance.
    pub fn with_gather_rays(self, gather_rays: u32) -> Self {
        Self {
            gather_rays,
            ..self
        }
    }

    /// Radiance where nothing is drawn and the scene has no sky.
    pub fn with_background(self, background: Rgb) -> Self {
        Self {
            background: Some(background),
            ..self
        }
    }

    /// Edges of the mesh over the picture.
    pub fn with_mesh(self, mesh: MeshOverlay) -> Self {
        Self {
            mesh: Some(mesh),
            ..self
        }
    }

    /// Samples along a side of so many pixels, with those beyond it that wide filters ask for.
    pub fn samples_of_side(&self, side: usize) -> usize {
        let grid = Supersampler::new(side, 1, self.antialias);
        grid.columns().next_multiple_of(grid.factor())
    }

    /// The door: everything behind it may rely on the ranges.
    pub(crate) fn check(&self) -> Result<(), RenderError> {
        let (width, height) = (self.width, self.height);
        let side = width.max(height);
        if width.min(height) == 0 || side > MAX_SIDE {
            return Err(RenderError::Size { width, height });
        }
        if width * height > Self::MAX_PIXELS {
            return Err(RenderError::Pixels { width, height });
        }
        if self.samples_of_side(side) > Viewport::MAX_SIDE {
            let antialias = self.antialias;
            return Err(RenderError::Samples { side, antialias });
        }
        if self.shading == Shading::Gather && self.gather_rays == 0 {
            return Err(RenderError::GatherRays);
        }
        match self.background.map(Rgb::to_array) {
            Some(bands) if bands.iter().any(|b| !b.is_finite() || *b < 0.0) => {
                Err(RenderError::Background(bands))
            }
            _ => Ok(()),
        }
    }
}

/// Whose edges are drawn over a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MeshOverlay {
    /// Of what receives light.
    Elements,
    /// Of what shoots light.
    Patches,
}

impl MeshOverlay {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Elements, Self::Patches];

    /// Name in options.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Elements => "elements",
            Self::Patches => "patches",
        }
    }
}

/// How textures are read that a sample sees from afar. Close up their file decides between blocks and interpolation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum TextureFilter {
    /// One texel; shimmers and breaks up.
    Point,
    /// Four texels of the whole picture; right as long as samples are about as close as texels.
    Bilinear,
    /// Four texels each of the two mip levels around the footprint's longer side; blurs what is seen at an angle.
    Trilinear,
    /// All texels under the footprint's ellipse, by a Gaussian (elliptical weighted average, Heckbert 1989). On a
    /// checkerboard seen along, with one sample a pixel, the errors of the four are 0.35, 0.11, 0.033 and 0.028 (root of mean
    /// square); the built-in office takes 30 % more time than with trilinear.
    #[default]
    Ewa,
}

impl TextureFilter {
    /// All of them, from quick to good.
    pub const ALL: [Self; 4] = [Self::Point, Self::Bilinear, Self::Trilinear, Self::Ewa];

    /// Name in options and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Bilinear => "bilinear",
            Self::Trilinear => "trilinear",
            Self::Ewa => "ewa",
        }
    }
}

/// Where the irradiance of a point in the picture comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Shading {
    /// The element's own value: shows what was solved, with its edges.
    Flat,
    /// Interpolated over the element's triangles, perspective-correct (Gouraud 1971, applied to irradiance).
    #[default]
    Gouraud,
    /// Gathered from the solution at each point, with visibility: crisp shadows, at the price of many rays.
    Gather,
}

impl Shading {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 3] = [Self::Flat, Self::Gouraud, Self::Gather];

    /// Name in options and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Flat => "flat",
            Self::Gouraud => "gouraud",
            Self::Gather => "gather",
        }
    }
}

impl fmt::Display for Shading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The name of a shading could not be understood.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("shading '{0}' is not known; use flat, gouraud or gather")]
pub struct ParseShadingError(pub String);

impl FromStr for Shading {
    type Err = ParseShadingError;

    fn from_str(name: &str) -> Result<Self, ParseShadingError> {
        Self::ALL
            .into_iter()
            .find(|shading| shading.name() == name)
            .ok_or_else(|| ParseShadingError(name.to_owned()))
    }
}
