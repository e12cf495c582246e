// Normals turned by normal maps and heights, and light on them; twins of render/src/relief.rs, render/src/tilt.rs and
// raster/src/bump/surface_gradient.rs.

// What was gathered at a vertex, in a frame of its own.
struct TiltFit {
    right: vec3<f32>,
    padding_0: u32,
    up: vec3<f32>,
    padding_1: u32,
    // `E / (E(flat) cos θ) - 1` for three rings of eight directions.
    changes: array<vec4<f32>, 24>,
}

@group(2) @binding(0) var<storage, read> fits: array<TiltFit>;
// For each triangle with a relief the fits of its corners.
@group(2) @binding(1) var<storage, read> relief_triangles: array<vec4<u32>>;
// Irradiance of vertices.
@group(2) @binding(2) var<storage, read> vertex_light: array<vec4<f32>>;

// What the material's relief is, RELIEF_*.
override RELIEF: u32 = 1u;

const RELIEF_NONE: u32 = 0u;
const RELIEF_NORMALS: u32 = 1u;
const RELIEF_HEIGHTS: u32 = 2u;

const RELIEF_AROUND: u32 = 8u;
// Bits of a vertex's corner from which on the number of its triangle stands.
const CORNER_TRIANGLE_SHIFT: u32 = 3u;

struct Bumped {
    normal: vec3<f32>,
    // Of slopes that are smaller than the pixel, along one direction.
    variance: f32,
}

// The normal between vertices.
fn flat_normal(in: Fragment) -> vec3<f32> {
    let square = dot(in.normal, in.normal);
    return select(in.normal, in.normal * inverseSqrt(square), square > 0.0);
}

// A number in [-1, 1] of one in [0, 1] that was kept in 8 bits; the two codes beside the middle both mean 0.
fn signed(code: f32) -> f32 {
    let half_step = 1.0 / 255.0;
    let value = code * 2.0 - 1.0;
    // The sampler's weights have 8 bits: what they let through must be no bump.
    let outside = abs(value) - half_step * 1.001;
    return select(0.0, sign(value) * outside / (1.0 - half_step), outside > 0.0);
}

// The mean of the normals under the footprint, in the texture's space.
fn normal_of_texel(footprint: Footprint) -> vec3<f32> {
    let texel = read_slot(relief_texture, relief_sampler, material.slots[SLOT_RELIEF], footprint);
    return vec3(signed(texel.x) * material.relief, signed(texel.y) * material.relief, texel.z * 2.0 - 1.0);
}

fn height_at(slot: Slot, footprint: Footprint, offset: vec2<f32>) -> f32 {
    let ddx = turned(slot, of_set(slot, footprint.dx));
    let ddy = turned(slot, of_set(slot, footprint.dy));
    let texel = filtered(relief_texture, relief_sampler, slot, coordinates(slot, footprint) + offset, ddx, ddy);
    return (texel.x + texel.y + texel.z) / 3.0;
}

// The normal of `(-dh/dx, -dh/dy, 1)`, by central differences over a texel or the footprint, whichever is larger.
fn normal_of_heights(footprint: Footprint) -> vec3<f32> {
    let slot = material.slots[SLOT_RELIEF];
    let ddx = turned(slot, of_set(slot, footprint.dx));
    let ddy = turned(slot, of_set(slot, footprint.dy));
    let half = 0.5 * max(max(abs(ddx), abs(ddy)), 1.0 / texels_of(slot));
    if !(max(half.x, half.y) < 1e30) {
        return vec3(0.0, 0.0, 1.0);
    }
    let along_u = vec2(half.x, 0.0);
    let along_v = vec2(0.0, half.y);
    let du = (height_at(slot, footprint, along_u) - height_at(slot, footprint, -along_u)) / (2.0 * half.x);
    let dv = (height_at(slot, footprint, along_v) - height_at(slot, footprint, -along_v)) / (2.0 * half.y);
    return normalize(vec3(-material.relief * du, material.relief * dv, 1.0));
}

// The surface gradient of a normal in the texture's space.
fn gradient_of(m: vec3<f32>, along: vec3<f32>, bitangent: vec3<f32>) -> vec3<f32> {
    let z = max(abs(m.z), max(abs(m.x), abs(m.y)) / 128.0);
    return select(vec3(0.0), (along * m.x + bitangent * m.y) / -z, z > 0.0);
}

fn bumped_at(in: Fragment, footprint: Footprint, flat_side: vec3<f32>) -> Bumped {
    if RELIEF == RELIEF_NONE {
        return Bumped(flat_side, 0.0);
    }
    var m: vec3<f32>;
    if RELIEF == RELIEF_NORMALS {
        m = normal_of_texel(footprint);
    } else {
        m = normal_of_heights(footprint);
    }
    let side = select(1.0, -1.0, (in.corner & CORNER_TURNED) != 0u);
    let bitangent = cross(flat_side * side, in.tangent) * in.sign;
    let gradient = gradient_of(m, in.tangent, bitangent) * side;
    let steep = flat_side - gradient;
    let square = dot(steep, steep);
    var bumped: Bumped;
    bumped.normal = flat_side;
    if any(gradient != vec3(0.0)) && square > 0.0 {
        bumped.normal = steep * inverseSqrt(square);
    }
    // Eight bits a coordinate make a unit normal shorter by up to this, which is no roughness.
    let rounding = 1.732 / 255.0;
    bumped.variance = 1.0 / clamp(length(m) + rounding, 0.05, 1.0) - 1.0;
    return bumped;
}

fn ring_of(number: u32) -> f32 {
    return array(0.3639702, 0.8390996, 1.7320508)[number];
}

fn direction_of(number: u32) -> vec2<f32> {
    let angle = f32(number) * (0.25 * PI);
    return vec2(cos(angle), sin(angle));
}

// Between the values on the rings and 0 in the middle: linear along chords, and linear between them.
fn change_at(fit: u32, slope: vec2<f32>) -> vec3<f32> {
    let turn = atan2(slope.y, slope.x) / (0.25 * PI);
    let sector = u32(floor(turn) + 8.0) % RELIEF_AROUND;
    let first = direction_of(sector);
    let second = direction_of(sector + 1u);
    let area = first.x * second.y - first.y * second.x;
    let a = (slope.x * second.y - slope.y * second.x) / area;
    let b = (first.x * slope.y - first.y * slope.x) / area;
    let radius = max(a + b, 1e-30);
    let along = saturate(b / radius);
    let next = (sector + 1u) % RELIEF_AROUND;
    var rings: array<vec3<f32>, 3>;
    for (var ring = 0u; ring < 3u; ring++) {
        let at = ring * RELIEF_AROUND;
        rings[ring] = mix(fits[fit].changes[at + sector].rgb, fits[fit].changes[at + next].rgb, along);
    }
    if radius <= ring_of(0u) {
        return rings[0] * (radius / ring_of(0u));
    }
    let outer = select(2u, 1u, radius <= ring_of(1u));
    let low = ring_of(outer - 1u);
    return mix(rings[outer - 1u], rings[outer], min((radius - low) / (ring_of(outer) - low), 1.0));
}

// `E(tilted) / E(flat)` at a vertex, for the part of a normal along the surface.
fn tilt_factor(fit: u32, tilt: vec3<f32>) -> vec3<f32> {
    var along = vec2(dot(tilt, fits[fit].right), dot(tilt, fits[fit].up));
    // Of the steepest normal, 60°.
    let most = 0.8660254;
    let size = length(along);
    along *= select(1.0, most / size, size > most);
    let cosine = sqrt(1.0 - dot(along, along));
    return max((vec3(1.0) + change_at(fit, along / cosine)) * cosine, vec3(0.0));
}

// Irradiance of a normal that a relief has turned.
fn tilted_light(in: Fragment, flat_side: vec3<f32>, bumped: vec3<f32>) -> vec3<f32> {
    if RELIEF == RELIEF_NONE || all(bumped == flat_side) {
        return solved_light(in);
    }
    let tilt = bumped - flat_side * dot(flat_side, bumped);
    let corners = relief_triangles[in.corner >> CORNER_TRIANGLE_SHIFT];
    var sum = vec3(0.0);
    for (var i = 0u; i < 3u; i++) {
        var solved = vertex_light[in.first + i].rgb;
        if FLAT {
            solved = element_light[in.element].rgb;
        }
        sum += solved * tilt_factor(corners[i], tilt) * in.barycentric[i];
    }
    return max(sum, vec3(0.0));
}
