// Light of elements, kept by group and band as solvers keep it, into what pictures show: `elements` adds groups up as dimmed,
// `vertices` takes it to vertices, limited where it is extrapolated. Twin of radiosity/src/vertex_light.rs. It reads a
// solver's own buffer, so light that is solved on the device is drawn without leaving it.

struct LightParams {
    elements: u32,
    vertices: u32,
    // Groups of luminaires.
    groups: u32,
    padding: u32,
    // Irradiance that is added everywhere.
    extra: vec4<f32>,
}

@group(0) @binding(0) var<uniform> params: LightParams;
// [group][band][element], then anything.
@group(0) @binding(1) var<storage, read> solved: array<f32>;
// Factor of each group.
@group(0) @binding(2) var<storage, read> dims: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> element_light: array<vec4<f32>>;
// Weights of `sources`.
@group(0) @binding(4) var<storage, read> weights: array<f32>;
// Where the list of each vertex begins in `sources`, and where it ends.
@group(0) @binding(5) var<storage, read> ranges: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read> sources: array<u32>;
@group(0) @binding(7) var<storage, read_write> vertex_light: array<vec4<f32>>;

const GROUP: u32 = 64u;

fn number(id: vec3<u32>, groups: vec3<u32>) -> u32 {
    return id.x + id.z * groups.x * GROUP;
}

@compute @workgroup_size(GROUP)
fn elements(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let e = number(id, groups);
    if e >= params.elements {
        return;
    }
    var sum = vec3(0.0);
    for (var g = 0u; g < params.groups; g++) {
        let at = 3u * g * params.elements + e;
        sum += vec3(solved[at], solved[at + params.elements], solved[at + 2u * params.elements]) * dims[g].rgb;
    }
    element_light[e] = vec4(sum, 0.0) + vec4(params.extra.rgb, 0.0);
}

@compute @workgroup_size(GROUP)
fn vertices(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let v = number(id, groups);
    if v >= params.vertices {
        return;
    }
    var sum = vec3(0.0);
    var least = vec3(3.0e38);
    var most = vec3(0.0);
    var is_extrapolated = false;
    for (var i = ranges[v].x; i < ranges[v].y; i++) {
        let light = element_light[sources[i]].rgb;
        sum += light * weights[i];
        is_extrapolated |= weights[i] < 0.0;
        // Buried elements have no light and no weight.
        if weights[i] != 0.0 {
            least = min(least, light);
            most = max(most, light);
        }
    }
    if is_extrapolated {
        let beyond = most - least;
        // What is added everywhere is in the light of elements already, and is no light to be limited.
        sum = min(max(sum, max(least - beyond, params.extra.rgb)), most + beyond);
    }
    vertex_light[v] = vec4(sum, 0.0);
}
