// How bright a lit scene is, as two histograms over its elements: luminance of the light that they reflect, without those
// that emit, and illuminance. Counts are whole numbers, so that every run gives the same.
// Twin of what raster/src/tonemap.rs sorts.

struct MeterParams {
    // What illuminance is of irradiance in each band.
    weights: vec3<f32>,
    elements: u32,
}

@group(0) @binding(0) var<uniform> params: MeterParams;
// As pictures show it.
@group(0) @binding(1) var<storage, read> element_light: array<vec4<f32>>;
// Dimmed by undimmed exitance.
@group(0) @binding(2) var<storage, read> element_dims: array<vec4<f32>>;
// Reflectance, and in bits of a whole number the bands in which it emits.
@group(0) @binding(3) var<storage, read> surfaces: array<vec4<f32>>;
// Luminances, then illuminances.
@group(0) @binding(4) var<storage, read_write> counts: array<atomic<u32>>;

const METER_BINS: u32 = 1024u;
// Bins of a stop, and the stop at which they begin, below 1.
const METER_BINS_PER_STOP: u32 = 16u;
const METER_STOPS_BELOW_ONE: u32 = 32u;
const PI: f32 = 3.14159265;

fn add(histogram: u32, value: f32) {
    if !(value > 0.0) {
        return;
    }
    let stops = log2(value) + f32(METER_STOPS_BELOW_ONE);
    let bin = u32(clamp(stops * f32(METER_BINS_PER_STOP), 0.0, f32(METER_BINS - 1u)));
    atomicAdd(&counts[histogram * METER_BINS + bin], 1u);
}

fn emits(e: u32, bands: u32) -> bool {
    let shines = element_dims[e].rgb != vec3(0.0);
    return any(shines & vec3((bands & 1u) != 0u, (bands & 2u) != 0u, (bands & 4u) != 0u));
}

@compute @workgroup_size(64)
fn meter(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let e = id.x + id.z * groups.x * 64u;
    if e >= params.elements {
        return;
    }
    let irradiance = element_light[e].rgb;
    if !emits(e, u32(surfaces[e].w)) {
        add(0u, dot(surfaces[e].rgb * irradiance, vec3(0.2126, 0.7152, 0.0722)) / PI);
    }
    add(1u, dot(irradiance, params.weights));
}
