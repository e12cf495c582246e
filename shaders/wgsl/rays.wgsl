// Form factors by casting rays: cosine-distributed rays leave a patch, and each element counts those that arrive.
// Counts are whole numbers, so that every run gives the same bits. Twin of the shots of
// radiosity/src/form_factor/raycast.rs. `bin_of` is that of raycast.wgsl or ray_query.wgsl.

struct RayParams {
    // Rays of the patch.
    rays: u32,
    // Polygons that the patch consists of.
    parts: u32,
    elements: u32,
    // Number of the first ray of this dispatch.
    first_ray: u32,
    // Beginning of the sequences, in 2^-32.
    shift: vec4<u32>,
    tangent: vec3<f32>,
    // Distance by which rays begin off the surface.
    offset: f32,
    bitangent: vec3<f32>,
    // Distance beyond which nothing is.
    farthest: f32,
    normal: vec3<f32>,
    // Distance by which sides that only absorb lag behind.
    lag: f32,
}

// A part of the patch.
struct RayPart {
    corners: array<vec4<f32>, 4>,
    // Share of the patch up to the end of this part.
    share: f32,
    // 3 or 4.
    count: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(0) @binding(0) var<uniform> params: RayParams;
@group(0) @binding(1) var<storage, read> parts: array<RayPart>;
// Arrived at each element; absorbed; escaped.
@group(0) @binding(4) var<storage, read_write> counts: array<atomic<u32>>;

const PI: f32 = 3.14159265;

// Point of the four-dimensional additive sequence (Roberts 2018), in [0, 1)⁴.
fn sequence(index: u32) -> vec4<f32> {
    let steps = vec4(3679390609u, 3152041523u, 2700274806u, 2313257605u);
    return vec4<f32>((params.shift + index * steps) >> vec4(8u)) / 16777216.0;
}

fn triangle_point(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, u: f32, v: f32) -> vec3<f32> {
    let root = sqrt(u);
    return a + (b - a) * (root * (1.0 - v)) + (c - a) * (root * v);
}

// A point of a polygon, evenly distributed.
fn polygon_point(part_index: u32, u: f32, v: f32) -> vec3<f32> {
    let a = parts[part_index].corners[0].xyz;
    let b = parts[part_index].corners[1].xyz;
    let c = parts[part_index].corners[2].xyz;
    if parts[part_index].count == 3u {
        return triangle_point(a, b, c, u, v);
    }
    let d = parts[part_index].corners[3].xyz;
    let first = length(cross(b - a, c - a));
    let share = first / max(first + length(cross(c - a, d - a)), 1e-30);
    if u < share {
        return triangle_point(a, b, c, u / share, v);
    }
    return triangle_point(a, c, d, (u - share) / (1.0 - share), v);
}

// A point of the patch.
fn patch_point(u: f32, v: f32) -> vec3<f32> {
    var index = 0u;
    var start = 0.0;
    while index + 1u < params.parts && parts[index].share <= u {
        start = parts[index].share;
        index++;
    }
    let within = (u - start) / max(parts[index].share - start, 1e-30);
    return polygon_point(index, clamp(within, 0.0, 0.9999999), v);
}

// Cosine-distributed direction by Malley's method over the concentric map of Shirley and Chiu (1997).
fn cosine_direction(u: f32, v: f32) -> vec3<f32> {
    let a = 2.0 * u - 1.0;
    let b = 2.0 * v - 1.0;
    var radius = 0.0;
    var angle = 0.0;
    if abs(a) > abs(b) {
        radius = a;
        angle = PI / 4.0 * (b / a);
    } else if b != 0.0 {
        radius = b;
        angle = PI / 2.0 - PI / 4.0 * (a / b);
    }
    let x = radius * cos(angle);
    let y = radius * sin(angle);
    let z = sqrt(max(1.0 - x * x - y * y, 0.0));
    return params.tangent * x + params.bitangent * y + params.normal * z;
}

@compute @workgroup_size(64)
fn shoot(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = params.first_ray + id.x;
    if index >= params.rays {
        return;
    }
    let point = sequence(index);
    let origin = patch_point(point.x, point.y) + params.normal * params.offset;
    let bin = bin_of(origin, cosine_direction(point.z, point.w));
    atomicAdd(&counts[bin], 1u);
}
