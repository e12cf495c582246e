//! What a picture on the device is made with.

use crate::pass::overlay::MeshLines;
use crate::pass::textured::TextureFiltering;
use hemicube_raster::Rgb;
use hemicube_raster::antialias::Antialiasing;
use hemicube_raster::colormap::FieldPaint;
use hemicube_raster::tonemap::ToneMap;

/// Where the irradiance of a point comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Interpolation {
    /// The element's own value: shows what was solved, with its edges.
    Flat,
    /// Between vertices, perspective-correct.
    #[default]
    Gouraud,
}

/// Samples of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Smoothing {
    /// One in its middle.
    None,
    /// Four for edges, one for light and textures (multisampling).
    #[default]
    Multisample,
    /// A regular grid of them, for everything, weighted by a filter.
    Supersample(Antialiasing),
}

/// What surfaces look like.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Style {
    /// As they are lit.
    #[default]
    Lit,
    /// Illuminance in lx as colours, with or without lines of equal value; what lets light through is left out.
    FalseColour(FieldPaint),
    /// One colour, linear, as the display shows it: the ground of a wireframe. What lets light through is left out.
    Plain(Rgb),
}

/// What a picture on the device is made with.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawOptions {
    /// What surfaces look like. Default value: lit.
    pub style: Style,
    /// Light of elements or between vertices. Default value: Gouraud.
    pub interpolation: Interpolation,
    /// How textures are read. Default value: trilinear from afar, bilinear close up.
    pub filtering: TextureFiltering,
    /// Whether normal maps and heights turn normals. Default value: true.
    pub bumps: bool,
    /// Whether what mirrors does, where maps were taken. Default value: true.
    pub reflections: bool,
    /// Samples of a pixel. Default value: multisampling.
    pub smoothing: Smoothing,
    /// Factor on all light: 1 leaves radiance 1 at display white without a curve. Default value: 1.
    pub exposure: f32,
    /// Tone curve. Default value: Reinhard.
    pub tone_map: ToneMap,
    /// Radiance where nothing is drawn and the scene has no sky. Default value: black.
    pub background: Rgb,
    /// Edges of elements over the picture. Default value: none.
    pub lines: Option<MeshLines>,
}

impl Default for DrawOptions {
    fn default() -> Self {
        Self {
            style: Style::default(),
            interpolation: Interpolation::default(),
            filtering: TextureFiltering::default(),
            bumps: true,
            reflections: true,
            smoothing: Smoothing::default(),
            exposure: 1.0,
            tone_map: ToneMap::default(),
            background: Rgb::BLACK,
            lines: None,
        }
    }
}

impl DrawOptions {
    /// Another style.
    pub fn with_style(self, style: Style) -> Self {
        Self { style, ..self }
    }

    /// Light of elements or between vertices.
    pub fn with_interpolation(self, interpolation: Interpolation) -> Self {
        Self {
            interpolation,
            ..self
        }
    }

    /// Another way of reading textures.
    pub fn with_filtering(self, filtering: TextureFiltering) -> Self {
        Self { filtering, ..self }
    }

    /// With or without bumps.
    pub fn with_bumps(self, bumps: bool) -> Self {
        Self { bumps, ..self }
    }

    /// With or without mirrors.
    pub fn with_reflections(self, reflections: bool) -> Self {
        Self {
            reflections,
            ..self
        }
    }

    /// More or fewer samples of a pixel.
    pub fn with_smoothing(self, smoothing: Smoothing) -> Self {
        Self { smoothing, ..self }
    }

    /// Brighter or darker.
    pub fn with_exposure(self, exposure: f32) -> Self {
        Self { exposure, ..self }
    }

    /// Another tone curve.
    pub fn with_tone_map(self, tone_map: ToneMap) -> Self {
        Self { tone_map, ..self }
    }

    /// Radiance where nothing is drawn and the scene has no sky.
    pub fn with_background(self, background: Rgb) -> Self {
        Self { background, ..self }
    }

    /// With edges of elements.
    pub fn with_lines(self, lines: MeshLines) -> Self {
        Self {
            lines: Some(lines),
            ..self
        }
    }
}
