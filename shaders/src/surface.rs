//! Pictures of lit surfaces: vertices, materials, light at vertices, lines over them, tones.

use crate::{Shader, shader};
use bytemuck::{Pod, Zeroable};

/// Surfaces without textures.
pub const LIT: Shader = shader!("lit", "surface");
/// Surfaces with textures.
pub const TEXTURED: Shader = shader!("textured", "surface", "texture_filter", "texels");
/// Surfaces with textures and relief.
pub const BUMP: Shader = shader!("bump", "surface", "texture_filter", "texels", "relief");
/// Surfaces that mirror what is around them.
pub const ENVIRONMENT: Shader = shader!(
    "environment",
    "surface",
    "texture_filter",
    "texels",
    "relief",
    "environment_map"
);
/// Pictures behind everything.
pub const SURROUNDINGS: Shader = shader!("surroundings", "environment_map");
/// Cube maps and their levels.
pub const PREFILTER: Shader = shader!("prefilter");
/// Light of elements at vertices.
pub const VERTEX_LIGHT: Shader = shader!("vertex_light");
/// How bright a lit scene is.
pub const METERING: Shader = shader!("metering");
/// Edges of elements.
pub const MESH_LINES: Shader = shader!("mesh_lines", "surface");
/// Which element is where.
pub const PICK: Shader = shader!("pick", "surface");
/// From light to what a display shows.
pub const TONEMAP: Shader = shader!("tonemap", "tones");
/// From a fine grid of samples to what a display shows.
pub const ANTIALIAS: Shader = shader!("antialias", "tones");
/// Illuminance as colours.
pub const FALSECOLOUR: Shader = shader!("falsecolour", "surface");

pub(crate) const SHADERS: [Shader; 13] = [
    LIT,
    TEXTURED,
    BUMP,
    ENVIRONMENT,
    SURROUNDINGS,
    PREFILTER,
    VERTEX_LIGHT,
    METERING,
    MESH_LINES,
    PICK,
    TONEMAP,
    ANTIALIAS,
    FALSECOLOUR,
];

/// A camera and how its picture is made.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct View {
    /// Columns; depth is reversed.
    pub clip_from_world: [[f32; 4]; 4],
    /// A point (w = 1), or the direction towards the eye (w = 0).
    pub eye: [f32; 4],
    /// Radiance where nothing is drawn.
    pub background: [f32; 3],
    /// Factor on all light.
    pub exposure: f32,
    /// Pixels.
    pub size: [f32; 2],
    /// `VIEW_*` bits.
    pub flags: u32,
    /// Largest diffuse reflectance.
    pub max_reflectance: f32,
    /// How much longer than wide a footprint may be.
    pub max_anisotropy: f32,
    /// Radius of EWA's Gaussian around a pixel's middle, in pixels.
    pub ewa_radius: f32,
    /// Unused.
    pub padding_0: u32,
    /// Unused.
    pub padding_1: u32,
}

/// Metals reflect like everything else.
pub const VIEW_METALS_DIFFUSE: u32 = 1;

/// By the sampler.
pub const MAGNIFY_SAMPLER: u32 = 0;
/// Catmull and Rom.
pub const MAGNIFY_CATMULL_ROM: u32 = 1;
/// Cubic B-spline.
pub const MAGNIFY_B_SPLINE: u32 = 2;
/// Mitchell and Netravali.
pub const MAGNIFY_MITCHELL: u32 = 3;

/// Where a texture of a material is read.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Slot {
    /// Columns of the matrix that makes the texture's coordinates of the mesh's.
    pub matrix: [f32; 4],
    /// What is added.
    pub offset: [f32; 2],
    /// `SLOT_*` bits.
    pub flags: u32,
    /// Texels of the picture across, and down in the upper 16 bits.
    pub size: u32,
}

/// It uses the second set of coordinates.
pub const SLOT_SECOND: u32 = 2;
/// It uses a set that the mesh does not have.
pub const SLOT_NOWHERE: u32 = 4;
/// Close up it shows single texels.
pub const SLOT_BLOCKS: u32 = 8;
/// Its colours were multiplied by alpha.
pub const SLOT_PREMULTIPLIED: u32 = 16;
/// Where the rule along u stands, two bits: 0 repeats, 1 mirrors, 2 clamps.
pub const SLOT_WRAP_U_SHIFT: u32 = 8;
/// Where the rule along v stands.
pub const SLOT_WRAP_V_SHIFT: u32 = 10;

/// A material: factors, and its six textures in the order of the `SLOT_*` numbers.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Material {
    /// Linear.
    pub base_color: [f32; 3],
    /// Opacity.
    pub alpha: f32,
    /// Radiance.
    pub emission: [f32; 3],
    /// 1 for metals.
    pub metallic: f32,
    /// As perceived.
    pub roughness: f32,
    /// Share of light that passes straight through.
    pub transmission: f32,
    /// Smallest alpha that is still surface.
    pub cutoff: f32,
    /// Factor of a normal map, or depth of heights.
    pub relief: f32,
    /// Unused.
    pub padding: [u32; 4],
    /// Base colour, metallic share, roughness, emission, transmission, relief.
    pub slots: [Slot; 6],
}

/// Bytes from one material to the next: a multiple of what every adapter allows as the offset of a uniform.
pub const MATERIAL_STRIDE: u32 = 256;
const _: () = assert!(
    size_of::<Material>() == MATERIAL_STRIDE as usize,
    "materials lie where offsets may point"
);

/// Alpha means nothing.
pub const ALPHA_OPAQUE: u32 = 0;
/// Alpha below the cutoff is a hole.
pub const ALPHA_MASK: u32 = 1;
/// Alpha is coverage.
pub const ALPHA_BLEND: u32 = 2;
/// Number of the base colour's slot.
pub const SLOT_BASE: u32 = 0;
/// Of the metallic share's.
pub const SLOT_METALLIC: u32 = 1;
/// Of the roughness's.
pub const SLOT_ROUGHNESS: u32 = 2;
/// Of the emission's.
pub const SLOT_EMISSION: u32 = 3;
/// Of the transmission's.
pub const SLOT_TRANSMISSION: u32 = 4;
/// Of the relief's.
pub const SLOT_RELIEF: u32 = 5;

/// A vertex, without its light. In the shader its fields are attributes in this order.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct SurfaceVertex {
    /// In the world.
    pub position: [f32; 3],
    /// Of the triangles that begin with this vertex.
    pub element: u32,
    /// Of the side that is seen.
    pub normal: [f32; 3],
    /// `CORNER_*` bits.
    pub corner: u32,
    /// Both sets.
    pub texcoords: [[f32; 2]; 2],
    /// The scene's vertex colour.
    pub color: [f32; 4],
    /// Along u, and the sign of the bitangent.
    pub tangent: [f32; 4],
}

/// Two bits: which corner of its triangle a vertex is that no other triangle uses.
pub const CORNER_NUMBER: u32 = 3;
/// Its triangle shows the side that its relief was not made for.
pub const CORNER_TURNED: u32 = 4;

/// Bits of a vertex's corner from which on the number of its triangle stands, among those with a relief.
pub const CORNER_TRIANGLE_SHIFT: u32 = 3;
/// There is no relief.
pub const RELIEF_NONE: u32 = 0;
/// It is a normal map.
pub const RELIEF_NORMALS: u32 = 1;
/// It is a picture of heights.
pub const RELIEF_HEIGHTS: u32 = 2;
/// Directions on each of three rings.
pub const RELIEF_AROUND: u32 = 8;

/// What was gathered at a vertex, in a frame of its own.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct TiltFit {
    /// First axis along the surface.
    pub right: [f32; 3],
    /// Unused.
    pub padding_0: u32,
    /// Second axis along the surface.
    pub up: [f32; 3],
    /// Unused.
    pub padding_1: u32,
    /// Ring by ring; the fourth number of each is unused.
    pub changes: [[f32; 4]; 24],
}

/// What mirrors show.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Mirror {
    /// Where the map was taken.
    pub position: [f32; 3],
    /// Radiance of a stored 1.
    pub scale: f32,
    /// Lower corner of the box that the map shows.
    pub low: [f32; 3],
    /// 1 if it shows one.
    pub has_room: u32,
    /// Upper corner.
    pub high: [f32; 3],
    /// `PROJECTION_*`.
    pub projection: u32,
    /// Levels of the map.
    pub levels: u32,
    /// 1 if the map is looked up by the normal.
    pub by_normal: u32,
    /// Unused.
    pub padding_0: u32,
    /// Unused.
    pub padding_1: u32,
}

/// A picture behind everything.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Surroundings {
    /// Half the picture's width at distance 1, to the right.
    pub right: [f32; 3],
    /// `PROJECTION_*`.
    pub projection: u32,
    /// Half its height, upwards.
    pub up: [f32; 3],
    /// Radiance of a stored 1, exposed.
    pub scale: f32,
    /// Ahead.
    pub forward: [f32; 3],
    /// Unused.
    pub padding_0: u32,
    /// Of the target in pixels.
    pub size: [f32; 2],
    /// Of the map's finest level in texels.
    pub map_size: [f32; 2],
    /// Scale of what the target sees.
    pub window_scale: [f32; 2],
    /// Offset of what the target sees.
    pub window_offset: [f32; 2],
}

/// Six squares.
pub const PROJECTION_CUBE: u32 = 0;
/// Latitude and longitude.
pub const PROJECTION_LATLONG: u32 = 1;
/// A mirror ball.
pub const PROJECTION_SPHERE: u32 = 2;
/// Two discs.
pub const PROJECTION_PARABOLOID: u32 = 3;
/// An octahedron.
pub const PROJECTION_OCTAHEDRAL: u32 = 4;
/// A light probe.
pub const PROJECTION_ANGULAR: u32 = 5;
/// An equidistant fisheye.
pub const PROJECTION_FISHEYE: u32 = 6;
/// An orthographic fisheye.
pub const PROJECTION_HEMISPHERICAL: u32 = 7;
/// Rows and columns of the table of mirrored shares.
pub const SPLIT_SUM_SIDE: u32 = 32;

/// A level of a cube that is made.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct CubeParams {
    /// Texels of a side of the level that is written.
    pub side: u32,
    /// Face, where a single one is written.
    pub face: u32,
    /// Samples of the lobe; 0 for a mirror.
    pub samples: u32,
    /// Texels of a side of the source's finest level.
    pub source_side: u32,
}

/// A direction of a lobe around z.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct LobeSample {
    /// Of unit length.
    pub direction: [f32; 3],
    /// What it stands for.
    pub solid_angle: f32,
    /// How much it counts.
    pub weight: f32,
    /// Unused.
    pub padding_0: u32,
    /// Unused.
    pub padding_1: u32,
    /// Unused.
    pub padding_2: u32,
}

/// How light of elements becomes light of vertices.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct LightParams {
    /// Elements.
    pub elements: u32,
    /// Vertices.
    pub vertices: u32,
    /// Groups of luminaires.
    pub groups: u32,
    /// Unused.
    pub padding: u32,
    /// Irradiance that is added everywhere; the fourth number is unused.
    pub extra: [f32; 4],
}

/// What metering needs to know.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct MeterParams {
    /// What illuminance is of irradiance in each band.
    pub weights: [f32; 3],
    /// Elements.
    pub elements: u32,
}

/// Bins of each of the histograms of metering.
pub const METER_BINS: u32 = 1024;
/// Bins of a stop.
pub const METER_BINS_PER_STOP: u32 = 16;
/// So many stops below 1 the first bin begins.
pub const METER_STOPS_BELOW_ONE: u32 = 32;

/// How edges are drawn.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct LineParams {
    /// Linear, exposed; the fourth is opacity.
    pub color: [f32; 4],
    /// Pixels.
    pub width: f32,
    /// Share of its distance by which a line comes nearer.
    pub lift: f32,
    /// Unused.
    pub padding_0: u32,
    /// Unused.
    pub padding_1: u32,
}

/// An edge of one or two elements. In the shader its fields are attributes in this order.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Edge {
    /// One end.
    pub start: [f32; 3],
    /// Normal of an element.
    pub first_normal: [f32; 3],
    /// The other end.
    pub end: [f32; 3],
    /// Normal of the other element, or the same once more.
    pub second_normal: [f32; 3],
}

/// From exposed light to what the target stores.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct ToneParams {
    /// `CURVE_*`.
    pub curve: u32,
    /// 1 if sRGB has to be encoded.
    pub encodes: u32,
    /// Samples of a pixel.
    pub samples: u32,
    /// Unused.
    pub padding: u32,
}

/// Reinhard's curve.
pub const CURVE_REINHARD: u32 = 0;
/// The fit of ACES.
pub const CURVE_ACES: u32 = 1;
/// Only what is too bright changes.
pub const CURVE_NONE: u32 = 2;
/// Light as it is.
pub const CURVE_LINEAR: u32 = 3;

/// How samples of a fine grid become pixels.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct FilterParams {
    /// Samples of a pixel in each direction.
    pub factor: u32,
    /// Weights in each direction.
    pub taps: u32,
    /// Unused.
    pub padding_0: u32,
    /// Unused.
    pub padding_1: u32,
}

/// How numbers become colours.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct FieldParams {
    /// Colour of lines.
    pub line_color: [f32; 4],
    /// Colour where there is no number; of all surfaces, if they have only one.
    pub missing: [f32; 4],
    /// Illuminance of irradiance 1, band by band.
    pub weights: [f32; 4],
    /// Value of the first colour.
    pub low: f32,
    /// Value of the last colour.
    pub high: f32,
    /// From one line to the next; 0 without lines.
    pub spacing: f32,
    /// A value that has a line.
    pub start: f32,
    /// Of lines, in pixels of the target.
    pub width: f32,
    /// Unused.
    pub padding_0: u32,
    /// Unused.
    pub padding_1: u32,
    /// Unused.
    pub padding_2: u32,
}
