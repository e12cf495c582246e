// Surfaces that mirror what is around them, with textures and relief; twin of `Shader::mirrored` in render/src/shade.rs, of
// `Mirror::radiance` in render/src/reflections.rs and of render/src/split_sum.rs.

struct Mirror {
    // Where the map was taken.
    position: vec3<f32>,
    // Radiance of a stored 1.
    scale: f32,
    // The box that the map shows,
    low: vec3<f32>,
    // if it shows one.
    has_room: u32,
    high: vec3<f32>,
    // PROJECTION_*.
    projection: u32,
    // Levels of the map, from a mirror's to that of roughness 1.
    levels: u32,
    // 1 if the map is looked up by the normal instead of the mirrored direction.
    by_normal: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(3) @binding(0) var<uniform> mirror: Mirror;
@group(3) @binding(1) var mirror_cube: texture_cube<f32>;
@group(3) @binding(2) var mirror_map: texture_2d_array<f32>;
@group(3) @binding(3) var mirror_sampler: sampler;
// Rows by roughness, columns by the root of the cosine.
@group(3) @binding(4) var<storage, read> split_sums: array<vec2<f32>>;

const SPLIT_SUM_SIDE: u32 = 32u;
// Share of light that surfaces which are no metals mirror straight on.
const DIELECTRIC: f32 = 0.04;

// A and B of the mirrored share `F0 A + B`.
fn split_sum(cosine: f32, roughness: f32) -> vec2<f32> {
    let last = f32(SPLIT_SUM_SIDE - 1u);
    let at = clamp(vec2(sqrt(max(cosine, 0.0)), roughness), vec2(0.0), vec2(1.0)) * last;
    let before = min(vec2<u32>(at), vec2(SPLIT_SUM_SIDE - 2u));
    let share = at - vec2<f32>(before);
    let first = before.y * SPLIT_SUM_SIDE + before.x;
    let upper = mix(split_sums[first], split_sums[first + 1u], share.x);
    let lower = mix(split_sums[first + SPLIT_SUM_SIDE], split_sums[first + SPLIT_SUM_SIDE + 1u], share.x);
    return mix(upper, lower, share.y);
}

fn mirrored_share(f0: vec3<f32>, cosine: f32, roughness: f32) -> vec3<f32> {
    let sums = split_sum(cosine, roughness);
    let missing = 1.0 / max(sums.x + sums.y, 1e-3) - 1.0;
    return saturate((f0 * sums.x + sums.y) * (1.0 + f0 * missing));
}

// Where a ray from inside leaves the room, seen from the map's place; the direction itself elsewhere.
fn seen_from_map(point: vec3<f32>, direction: vec3<f32>) -> vec3<f32> {
    let is_inside = all(point >= mirror.low) && all(point <= mirror.high);
    if mirror.has_room == 0u || !is_inside {
        return direction;
    }
    let ahead = select(mirror.low, mirror.high, direction > vec3(0.0));
    let distances = select(vec3(1e30), (ahead - point) / direction, direction != vec3(0.0));
    let nearest = min(distances.x, min(distances.y, distances.z));
    return normalize(point + direction * nearest - mirror.position);
}

fn light_around(point: vec3<f32>, direction: vec3<f32>, roughness: f32) -> vec3<f32> {
    let seen = seen_from_map(point, direction);
    let lod = saturate(roughness) * f32(mirror.levels - 1u);
    let stored = environment_radiance(mirror_cube, mirror_map, mirror_sampler, mirror.projection, seen, lod);
    return stored * mirror.scale;
}

// The normal nearest to a bumped one that still faces the eye.
fn facing(normal: vec3<f32>, to_eye: vec3<f32>) -> vec3<f32> {
    let away = dot(normal, to_eye);
    if away >= 0.0 {
        return normal;
    }
    let turned_back = normal - to_eye * away;
    let square = dot(turned_back, turned_back);
    return select(to_eye, turned_back * inverseSqrt(square), square > 0.0);
}

struct Mirroring {
    radiance: vec3<f32>,
    transmittance: vec3<f32>,
}

fn mirroring_at(surface: Surface, in: Fragment, footprint: Footprint) -> Mirroring {
    let flat_side = flat_normal(in);
    let bumped = bumped_at(in, footprint, flat_side);
    let to_eye = towards_eye(in.world);
    let normal = facing(bumped.normal, to_eye);
    // Slopes too small to be seen one by one make a surface rougher.
    let square = surface.roughness * surface.roughness;
    let roughness = min(pow(square * square + 2.0 * bumped.variance, 0.25), 1.0);
    let cosine = max(dot(normal, to_eye), 0.0);
    let coat = mirrored_share(vec3(DIELECTRIC), cosine, roughness);
    let share = mix(coat, mirrored_share(surface.tint, cosine, roughness), surface.metallic);
    let way = select(2.0 * dot(normal, to_eye) * normal - to_eye, normal, mirror.by_normal != 0u);
    let mirrored = share * light_around(in.world, way, roughness) * surface.coverage;
    let rest = vec3(1.0) - coat;
    let matt = surface.reflectance * (1.0 - surface.metallic) * rest;
    let beside = vec3(1.0 - surface.coverage);
    var result: Mirroring;
    result.radiance = surface.emission + mirrored + matt * tilted_light(in, flat_side, bumped.normal) / PI;
    result.transmittance = beside + (surface.transmittance - beside) * rest;
    return result;
}

fn mirroring(in: Fragment, is_hole: ptr<function, bool>) -> Mirroring {
    let footprint = footprint_of(in);
    let surface = surface_at(in, texels_at(footprint));
    *is_hole = surface.is_hole;
    return mirroring_at(surface, in, footprint);
}

@fragment
fn masked(in: Fragment) -> @location(0) vec4<f32> {
    var is_hole: bool;
    let result = mirroring(in, &is_hole);
    if is_hole {
        discard;
    }
    return exposed(result.radiance);
}

@fragment
fn own(in: Fragment) -> @location(0) vec4<f32> {
    var is_hole: bool;
    return exposed(mirroring(in, &is_hole).radiance);
}

@fragment
fn through(in: Fragment) -> @location(0) vec4<f32> {
    var is_hole: bool;
    return vec4(mirroring(in, &is_hole).transmittance, 1.0);
}
