// Cube maps on the device: pictures of faces into a cube, mip levels by solid angle, and levels by roughness; twins of
// raster/src/environment/pyramid.rs and prefilter.rs.

struct CubeParams {
    // Texels of a side of the level that is written.
    side: u32,
    // Face, where a single one is written.
    face: u32,
    // Samples of the lobe; 0 for a mirror.
    samples: u32,
    // Texels of a side of the source's finest level.
    source_side: u32,
}

// A direction around z, what it stands for, and how much it counts.
struct LobeSample {
    direction: vec3<f32>,
    solid_angle: f32,
    weight: f32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(0) @binding(0) var<uniform> params: CubeParams;
@group(0) @binding(1) var written: texture_storage_2d_array<rgba16float, write>;
@group(0) @binding(2) var picture: texture_2d<f32>;
@group(0) @binding(3) var finer: texture_2d_array<f32>;
@group(0) @binding(4) var source: texture_cube<f32>;
@group(0) @binding(5) var source_sampler: sampler;
@group(0) @binding(6) var<storage, read> lobe: array<LobeSample>;

const PI: f32 = 3.14159265;

// A picture of twice the side into a face.
@compute @workgroup_size(8, 8)
fn face(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2(params.side)) {
        return;
    }
    var sum = vec3(0.0);
    for (var i = 0u; i < 4u; i++) {
        sum += textureLoad(picture, 2u * id.xy + vec2(i & 1u, i >> 1u), 0).rgb;
    }
    textureStore(written, id.xy, params.face, vec4(0.25 * sum, 1.0));
}

// Solid angle by area at a place in [-1, 1], up to a factor.
fn density(at: vec2<f32>) -> f32 {
    return pow(1.0 + dot(at, at), -1.5);
}

// The next level: means of four, weighted by solid angle.
@compute @workgroup_size(8, 8)
fn halve(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2(params.side)) {
        return;
    }
    var sum = vec3(0.0);
    var weights = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let texel = 2u * id.xy + vec2(i & 1u, i >> 1u);
        let weight = density((vec2<f32>(texel) + 0.5) / f32(params.side) - 1.0);
        sum += textureLoad(finer, texel, id.z, 0).rgb * weight;
        weights += weight;
    }
    textureStore(written, id.xy, id.z, vec4(sum / weights, 1.0));
}

// Direction of a place of a face in [-1, 1]; the space of cubes is left-handed, that of the world is not.
fn cube_direction(face: u32, at: vec2<f32>) -> vec3<f32> {
    switch face {
        case 0u: { return vec3(1.0, -at.y, at.x); }
        case 1u: { return vec3(-1.0, -at.y, -at.x); }
        case 2u: { return vec3(at.x, 1.0, -at.y); }
        case 3u: { return vec3(at.x, -1.0, at.y); }
        case 4u: { return vec3(at.x, -at.y, -1.0); }
        default: { return vec3(-at.x, -at.y, 1.0); }
    }
}

// Light from a cone around a direction of unit length: of the level whose texel there is as large.
fn radiance_of_cone(direction: vec3<f32>, solid_angle: f32) -> vec3<f32> {
    let size = max(abs(direction.x), max(abs(direction.y), abs(direction.z)));
    let side = f32(params.source_side);
    // At a place whose largest component is 1 a face of four units has the density 1 / |place|^3.
    let texel = 4.0 * size * size * size / (side * side);
    let lod = max(0.5 * log2(solid_angle / texel), 0.0);
    return textureSampleLevel(source, source_sampler, vec3(direction.xy, -direction.z), lod).rgb;
}

// A level of a roughness: means over the lobe around each direction.
@compute @workgroup_size(8, 8)
fn blur(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= vec2(params.side)) {
        return;
    }
    let at = (2.0 * vec2<f32>(id.xy) + 1.0) / f32(params.side) - 1.0;
    let axis = normalize(cube_direction(id.z, at));
    if params.samples == 0u {
        let side = f32(params.side);
        let texel = 4.0 * density(at) / (side * side);
        textureStore(written, id.xy, id.z, vec4(radiance_of_cone(axis, texel), 1.0));
        return;
    }
    // Any frame around the axis (Duff et al. 2017).
    let s = select(-1.0, 1.0, axis.z >= 0.0);
    let a = -1.0 / (s + axis.z);
    let b = axis.x * axis.y * a;
    let right = vec3(1.0 + s * axis.x * axis.x * a, s * b, -s * axis.x);
    let up = vec3(b, s + axis.y * axis.y * a, -axis.y);
    var sum = vec3(0.0);
    var weights = 0.0;
    for (var i = 0u; i < params.samples; i++) {
        let d = lobe[i].direction;
        let direction = normalize(right * d.x + up * d.y + axis * d.z);
        sum += radiance_of_cone(direction, lobe[i].solid_angle) * lobe[i].weight;
        weights += lobe[i].weight;
    }
    textureStore(written, id.xy, id.z, vec4(sum / weights, 1.0));
}
