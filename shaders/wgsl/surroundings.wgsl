// A picture of the surroundings behind everything; twin of render/src/behind.rs.

struct Surroundings {
    // Columns of the frame that turns places in the picture into directions: right and up with half the picture's sides,
    // forward; for parallel projections right and up are 0.
    right: vec3<f32>,
    // PROJECTION_* of the map.
    projection: u32,
    up: vec3<f32>,
    // Radiance of a stored 1, exposed.
    scale: f32,
    forward: vec3<f32>,
    padding_0: u32,
    // Width and height of the target, and of the map's finest level.
    size: vec2<f32>,
    map_size: vec2<f32>,
    // What of the picture's plane the target sees: the target's point `p` is at `(p - offset) / scale`.
    window_scale: vec2<f32>,
    window_offset: vec2<f32>,
}

@group(0) @binding(0) var<uniform> around: Surroundings;
@group(0) @binding(1) var around_cube: texture_cube<f32>;
@group(0) @binding(2) var around_map: texture_2d_array<f32>;
@group(0) @binding(3) var around_sampler: sampler;

const PI: f32 = 3.14159265;

@vertex
fn screen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    // As far away as depth goes.
    return vec4(f32(index / 2u) * 4.0 - 1.0, f32(index % 2u) * 4.0 - 1.0, 0.0, 1.0);
}

fn direction_through(at: vec2<f32>) -> vec3<f32> {
    let clip = vec2(2.0 * at.x / around.size.x - 1.0, 1.0 - 2.0 * at.y / around.size.y);
    let place = (clip - around.window_offset) / around.window_scale;
    return normalize(around.forward + around.right * place.x + around.up * place.y);
}

// Texels of the finest level that a step between two directions crosses.
fn texels_between(a: vec3<f32>, b: vec3<f32>) -> f32 {
    if around.projection == PROJECTION_CUBE {
        // Along the larger component, where a face spans two units.
        let size = max(abs(a.x), max(abs(a.y), abs(a.z)));
        return length(b - a) / size * 0.5 * around.map_size.x;
    }
    let from_place = place_of(around.projection, a);
    let to_place = place_of(around.projection, b);
    var way = abs(to_place.at - from_place.at);
    // The seam of a panorama is no distance.
    way.x = select(way.x, min(way.x, 1.0 - way.x), around.projection == PROJECTION_LATLONG);
    return select(1.0, length(way * around.map_size), from_place.face == to_place.face);
}

@fragment
fn surroundings(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let direction = direction_through(at.xy);
    let right = texels_between(direction, direction_through(at.xy + vec2(1.0, 0.0)));
    let down = texels_between(direction, direction_through(at.xy + vec2(0.0, 1.0)));
    let lod = log2(max(max(right, down), 1e-6));
    let stored = environment_radiance(around_cube, around_map, around_sampler, around.projection, direction, lod);
    return vec4(min(stored * around.scale, vec3(65504.0)), 1.0);
}
