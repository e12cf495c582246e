// From a fine grid of samples to pixels: each sample goes through the tone curve, then samples are weighted along rows, then
// down. Twin of `Supersampler` in raster/src/antialias/supersample.rs.

struct FilterParams {
    // Samples of a pixel in each direction.
    factor: u32,
    // Weights in each direction.
    taps: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(0) @binding(1) var source: texture_2d<f32>;
@group(0) @binding(2) var<uniform> filtering: FilterParams;
@group(0) @binding(3) var<storage, read> weights: array<f32>;

// Columns of pixels, rows of samples.
@fragment
fn along_rows(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let place = vec2<u32>(at.xy);
    var sum = vec3(0.0);
    for (var tap = 0u; tap < filtering.taps; tap++) {
        let sample = textureLoad(source, vec2(place.x * filtering.factor + tap, place.y), 0).rgb;
        sum += shown(sample) * weights[tap];
    }
    return vec4(sum, 1.0);
}

@fragment
fn down_columns(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let place = vec2<u32>(at.xy);
    var sum = vec3(0.0);
    for (var tap = 0u; tap < filtering.taps; tap++) {
        sum += textureLoad(source, vec2(place.x, place.y * filtering.factor + tap), 0).rgb * weights[tap];
    }
    // Weights may be negative, and so may a sum beside something bright.
    return stored(max(sum, vec3(0.0)));
}
