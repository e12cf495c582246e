// What all passes over surfaces share: the view, materials, the vertex stage, and what a material does with light.
// Structs have twins in src/surface.rs. Twin of `surface_with` in scene/src/surface.rs and of `Shader::surface_radiance` in
// render/src/shade.rs.

struct View {
    // Depth is reversed: 1 at the near plane, 0 infinitely far away.
    clip_from_world: mat4x4<f32>,
    // A point (w = 1), or for parallel projections the direction towards the eye (w = 0).
    eye: vec4<f32>,
    // Radiance where nothing is drawn, not yet exposed.
    background: vec3<f32>,
    // Factor on all light, so that it fits into 16 bits.
    exposure: f32,
    // Width and height of the target in pixels.
    size: vec2<f32>,
    // VIEW_* bits.
    flags: u32,
    // Largest diffuse reflectance.
    max_reflectance: f32,
    // How much longer than wide a footprint may be.
    max_anisotropy: f32,
    // Radius of the Gaussian around a pixel's middle.
    ewa_radius: f32,
    padding_0: u32,
    padding_1: u32,
}

// Metals reflect like everything else.
const VIEW_METALS_DIFFUSE: u32 = 1u;

// Where a texture of a material is read.
struct Slot {
    // Columns of the matrix that makes the texture's coordinates of the mesh's,
    matrix: vec4<f32>,
    // and what is added.
    offset: vec2<f32>,
    // SLOT_* bits.
    flags: u32,
    // Texels of the picture across, and down in the upper 16 bits.
    size: u32,
}

// The second set of coordinates,
const SLOT_SECOND: u32 = 2u;
// or a set that the mesh does not have.
const SLOT_NOWHERE: u32 = 4u;
// Single texels close up.
const SLOT_BLOCKS: u32 = 8u;
// Colours were multiplied by alpha.
const SLOT_PREMULTIPLIED: u32 = 16u;
// Two bits each for the rules along u and v: 0 repeats, 1 mirrors, 2 clamps.
const SLOT_WRAP_U_SHIFT: u32 = 8u;
const SLOT_WRAP_V_SHIFT: u32 = 10u;

struct Material {
    base_color: vec3<f32>,
    alpha: f32,
    emission: vec3<f32>,
    metallic: f32,
    roughness: f32,
    transmission: f32,
    // Smallest alpha that is still surface.
    cutoff: f32,
    // Factor of a normal map, or depth of heights.
    relief: f32,
    padding: vec4<u32>,
    slots: array<Slot, 6>,
}

// What shaders of a run are made for: what it does not have costs nothing, and software adapters execute both sides of
// every branch.

// What alpha means, ALPHA_*.
override ALPHA: u32 = 0u;
// Whether the material emits.
override EMITS: bool = true;
// Whether vertices have colours.
override COLORS: bool = true;
// The element's own light instead of that between vertices.
override FLAT: bool = false;

const ALPHA_OPAQUE: u32 = 0u;
// Below the cutoff it is a hole.
const ALPHA_MASK: u32 = 1u;
// It is coverage.
const ALPHA_BLEND: u32 = 2u;

const SLOT_BASE: u32 = 0u;
const SLOT_METALLIC: u32 = 1u;
const SLOT_ROUGHNESS: u32 = 2u;
const SLOT_EMISSION: u32 = 3u;
const SLOT_TRANSMISSION: u32 = 4u;
const SLOT_RELIEF: u32 = 5u;

const PI: f32 = 3.14159265;
// Brightest number of 16 bits.
const BRIGHTEST: f32 = 65504.0;

@group(0) @binding(0) var<uniform> view: View;
// That of the run which is drawn.
@group(0) @binding(1) var<uniform> material: Material;
// Irradiance of each element, from all groups as dimmed.
@group(0) @binding(2) var<storage, read> element_light: array<vec4<f32>>;
// What dimming makes of each element's emission.
@group(0) @binding(3) var<storage, read> element_dims: array<vec4<f32>>;

struct Vertex {
    @location(0) position: vec3<f32>,
    // Of the triangles that begin with this vertex.
    @location(1) element: u32,
    @location(2) normal: vec3<f32>,
    // CORNER_* bits.
    @location(3) corner: u32,
    @location(4) texcoords: vec4<f32>,
    @location(5) color: vec4<f32>,
    // Along u, and the sign of the bitangent.
    @location(6) tangent: vec4<f32>,
    // Irradiance.
    @location(7) light: vec4<f32>,
}

// Two bits: which corner of its triangle a vertex is that no other triangle uses.
const CORNER_NUMBER: u32 = 3u;
// Its triangle shows the side that its relief was not made for.
const CORNER_TURNED: u32 = 4u;

struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) light: vec3<f32>,
    @location(3) color: vec4<f32>,
    @location(4) texcoords: vec4<f32>,
    @location(5) tangent: vec3<f32>,
    @location(6) barycentric: vec3<f32>,
    @location(7) @interpolate(flat) element: u32,
    // First vertex of a triangle that has vertices of its own, its bitangent's sign, and CORNER_TURNED.
    @location(8) @interpolate(flat) first: u32,
    @location(9) @interpolate(flat) sign: f32,
    @location(10) @interpolate(flat) corner: u32,
}

@vertex
fn vertex(in: Vertex, @builtin(vertex_index) index: u32) -> Fragment {
    var out: Fragment;
    out.position = view.clip_from_world * vec4(in.position, 1.0);
    out.world = in.position;
    out.normal = in.normal;
    out.light = in.light.rgb;
    out.color = in.color;
    out.texcoords = in.texcoords;
    out.tangent = in.tangent.xyz;
    let number = in.corner & CORNER_NUMBER;
    out.barycentric = vec3(f32(number == 0u), f32(number == 1u), f32(number == 2u));
    out.element = in.element;
    out.first = index - number;
    out.sign = in.tangent.w;
    out.corner = in.corner;
    return out;
}

// Irradiance of the flat surface.
fn solved_light(in: Fragment) -> vec3<f32> {
    if FLAT {
        return element_light[in.element].rgb;
    }
    // Samples beside the triangle's middle lie outside of it, where light goes on below 0.
    return max(in.light, vec3(0.0));
}

// Factors of a material's textures at a point.
struct Texels {
    base: vec4<f32>,
    metallic: f32,
    roughness: f32,
    emission: vec3<f32>,
    transmission: f32,
}

const NO_TEXELS = Texels(vec4(1.0), 1.0, 1.0, vec3(1.0), 1.0);

// What a point of a surface does with light.
struct Surface {
    reflectance: vec3<f32>,
    coverage: f32,
    emission: vec3<f32>,
    // Metallic share and roughness, for what mirrors.
    metallic: f32,
    transmittance: vec3<f32>,
    roughness: f32,
    // Base colour in [0, 1].
    tint: vec3<f32>,
    is_hole: bool,
}

fn surface_at(in: Fragment, texels: Texels) -> Surface {
    var surface: Surface;
    var color = vec4(1.0);
    if COLORS {
        color = in.color;
    }
    surface.coverage = 1.0;
    if ALPHA != ALPHA_OPAQUE {
        let alpha = saturate(material.alpha * texels.base.a * color.a);
        surface.is_hole = ALPHA == ALPHA_MASK && alpha < material.cutoff;
        surface.coverage = select(1.0, alpha, ALPHA == ALPHA_BLEND);
    }
    surface.tint = saturate(material.base_color * texels.base.rgb * color.rgb);
    let lowered = min(surface.tint, vec3(view.max_reflectance));
    surface.metallic = saturate(material.metallic * texels.metallic);
    surface.roughness = saturate(material.roughness * texels.roughness);
    let is_diffuse = (view.flags & VIEW_METALS_DIFFUSE) != 0u;
    let transmission = saturate(material.transmission * texels.transmission) * (1.0 - surface.metallic);
    let diffuse = select(1.0 - surface.metallic, 1.0, is_diffuse) - transmission;
    surface.reflectance = lowered * (surface.coverage * diffuse);
    surface.transmittance = vec3(1.0 - surface.coverage) + surface.tint * (surface.coverage * transmission);
    if EMITS {
        surface.emission = material.emission * texels.emission * surface.coverage * element_dims[in.element].rgb;
    }
    return surface;
}

// A radiance as targets of 16 bits keep it.
fn exposed(radiance: vec3<f32>) -> vec4<f32> {
    return vec4(min(radiance * view.exposure, vec3(BRIGHTEST)), 1.0);
}

// Direction from a point to the eye, of unit length.
fn towards_eye(point: vec3<f32>) -> vec3<f32> {
    return normalize(view.eye.xyz - view.eye.w * point);
}
