// Environment maps of all projections; twin of raster/src/environment. Cubes are looked up by the sampler, which is seamless;
// all others by four texels with exact weights, across the edges of their pictures.
// The world is right-handed and looks ahead along -z; a cube's space is left-handed.

const PROJECTION_CUBE: u32 = 0u;
const PROJECTION_LATLONG: u32 = 1u;
const PROJECTION_SPHERE: u32 = 2u;
const PROJECTION_PARABOLOID: u32 = 3u;
const PROJECTION_OCTAHEDRAL: u32 = 4u;
const PROJECTION_ANGULAR: u32 = 5u;
const PROJECTION_FISHEYE: u32 = 6u;
const PROJECTION_HEMISPHERICAL: u32 = 7u;

// A place in a face of a map.
struct Place {
    face: u32,
    at: vec2<f32>,
    is_shown: bool,
}

fn signed_as(size: f32, other: f32) -> f32 {
    return select(size, -size, other < 0.0);
}

fn octahedral_place(direction: vec3<f32>) -> vec2<f32> {
    let d = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    var p = d.xz;
    if d.y < 0.0 {
        p = vec2(signed_as(1.0 - abs(d.z), d.x), signed_as(1.0 - abs(d.x), d.z));
    }
    return vec2(1.0 + p.x, 1.0 - p.y) / 2.0;
}

fn latlong_place(d: vec3<f32>) -> vec2<f32> {
    return vec2(0.5 + atan2(d.x, -d.z) / (2.0 * PI), atan2(length(d.xz), d.y) / PI);
}

// Signs of a disc's right and of its middle.
fn disc_frame(projection: u32, face: u32) -> vec2<f32> {
    if projection == PROJECTION_SPHERE {
        return vec2(1.0, 1.0);
    }
    return select(vec2(1.0, -1.0), vec2(-1.0, 1.0), projection == PROJECTION_PARABOLOID && face == 1u);
}

// Distance from the middle over the sine of the angle to the axis, by cosine and sine.
fn disc_stretch(projection: u32, z: f32, rho: f32) -> f32 {
    let angle = atan2(rho, z) / max(rho, 1e-12);
    switch projection {
        case PROJECTION_SPHERE: {
            return select(inverseSqrt(2.0 * (1.0 + z)), sqrt((1.0 - z) / 2.0) / max(rho, 1e-12), z < 0.0);
        }
        case PROJECTION_ANGULAR: { return select(angle / PI, 1.0 / PI, rho < 1e-6 && z > 0.0); }
        case PROJECTION_PARABOLOID: { return 1.0 / (1.0 + z); }
        case PROJECTION_FISHEYE: { return select(angle * 2.0 / PI, 2.0 / PI, rho < 1e-6); }
        default: { return 1.0; }
    }
}

fn disc_place(projection: u32, d: vec3<f32>) -> Place {
    let face = select(0u, 1u, projection == PROJECTION_PARABOLOID && d.z > 0.0);
    let frame = disc_frame(projection, face);
    let z = d.z * frame.y;
    let rho = length(d.xy);
    var p = vec2(1.0, 0.0);
    if rho >= 1e-12 || z >= 0.0 {
        p = disc_stretch(projection, z, rho) * vec2(frame.x * d.x, -d.y);
    }
    let is_whole = projection == PROJECTION_SPHERE || projection == PROJECTION_ANGULAR;
    return Place(face, clamp((p + 1.0) / 2.0, vec2(0.0), vec2(1.0)), is_whole || z >= 0.0);
}

fn place_of(projection: u32, d: vec3<f32>) -> Place {
    switch projection {
        case PROJECTION_LATLONG: { return Place(0u, latlong_place(d), true); }
        case PROJECTION_OCTAHEDRAL: { return Place(0u, octahedral_place(d), true); }
        default: { return disc_place(projection, d); }
    }
}

// Middle of a texel, with the disc as unit circle.
fn disc_middle(size: vec2<i32>, at: vec2<i32>) -> vec2<f32> {
    return vec2<f32>(2 * at + 1 - size) / vec2<f32>(size);
}

fn disc_texel(size: vec2<i32>, p: vec2<f32>) -> vec2<i32> {
    return vec2<i32>(clamp((p + 1.0) / 2.0 * vec2<f32>(size), vec2(0.0), vec2<f32>(size - 1)));
}

// Column, row and face of the texel that a column and a row mean which may lie outside.
fn neighbour(projection: u32, size: vec2<i32>, face: u32, at: vec2<i32>) -> vec3<i32> {
    let own = i32(face);
    switch projection {
        case PROJECTION_LATLONG: {
            var p = at;
            if p.y < 0 {
                p = vec2(p.x + size.x / 2, -1 - p.y);
            } else if p.y >= size.y {
                p = vec2(p.x + size.x / 2, 2 * size.y - 1 - p.y);
            }
            return vec3((p.x + 2 * size.x) % size.x, clamp(p.y, 0, size.y - 1), own);
        }
        case PROJECTION_OCTAHEDRAL: {
            var p = at;
            let last = size.x - 1;
            if p.x < 0 || p.x > last {
                p = vec2(clamp(p.x, 0, last), last - p.y);
            }
            if p.y < 0 || p.y > last {
                p = vec2(last - p.x, clamp(p.y, 0, last));
            }
            return vec3(p, own);
        }
        default: {
            let p = disc_middle(size, at);
            let square = dot(p, p);
            if square <= 1.0 {
                return vec3(at, own);
            }
            if projection == PROJECTION_PARABOLOID {
                // The formula goes on over the rim, into the other half.
                let frame = disc_frame(projection, face);
                let d = vec3(frame.x * 2.0 * p.x, -2.0 * p.y, frame.y * (1.0 - square)) / (1.0 + square);
                let beyond = disc_place(projection, d);
                let texel = vec2<i32>(clamp(beyond.at * vec2<f32>(size), vec2(0.0), vec2<f32>(size - 1)));
                return vec3(texel, 1 - own);
            }
            let reach = max(1.0 - 1.42 / f32(min(size.x, size.y)), 0.0);
            return vec3(disc_texel(size, p * min(reach * inverseSqrt(square), 1.0)), own);
        }
    }
}

// Radiance in a level of a map that is no cube; 0 where it shows nothing.
fn radiance_in(map: texture_2d_array<f32>, projection: u32, direction: vec3<f32>, level: i32) -> vec3<f32> {
    let place = place_of(projection, direction);
    if !place.is_shown {
        return vec3(0.0);
    }
    let size = vec2<i32>(max(textureDimensions(map, 0) >> vec2(u32(level)), vec2(1u)));
    let at = place.at * vec2<f32>(size) - 0.5;
    let low = vec2<i32>(floor(at));
    let share = at - floor(at);
    var sum = vec3(0.0);
    for (var i = 0; i < 4; i++) {
        let corner = vec2(i & 1, i >> 1u);
        let weights = select(1.0 - share, share, corner == vec2(1));
        let texel = neighbour(projection, size, place.face, low + corner);
        sum += textureLoad(map, texel.xy, texel.z, level).rgb * (weights.x * weights.y);
    }
    return sum;
}

// Radiance from a direction of unit length, between the two levels beside `lod`.
fn environment_radiance(
    cube: texture_cube<f32>,
    map: texture_2d_array<f32>,
    how: sampler,
    projection: u32,
    direction: vec3<f32>,
    lod: f32,
) -> vec3<f32> {
    if projection == PROJECTION_CUBE {
        return textureSampleLevel(cube, how, vec3(direction.xy, -direction.z), lod).rgb;
    }
    let last = i32(textureNumLevels(map)) - 1;
    let within = clamp(lod, 0.0, f32(last));
    let low = i32(floor(within));
    let fine = radiance_in(map, projection, direction, low);
    let share = within - floor(within);
    if share == 0.0 {
        return fine;
    }
    return mix(fine, radiance_in(map, projection, direction, low + 1), share);
}
