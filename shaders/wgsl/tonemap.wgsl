// From exposed light to what a display shows. Of a picture with several samples a pixel each
// sample goes through the curve before they are averaged, so the edges of lamps are smooth.

@group(0) @binding(1) var source: texture_2d<f32>;
@group(0) @binding(2) var source_samples: texture_multisampled_2d<f32>;

@fragment
fn tone_mapped(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return stored(shown(textureLoad(source, vec2<u32>(at.xy), 0).rgb));
}

@fragment
fn tone_mapped_samples(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    var sum = vec3(0.0);
    for (var i = 0u; i < tone.samples; i++) {
        sum += shown(textureLoad(source_samples, vec2<u32>(at.xy), i).rgb);
    }
    return stored(sum / f32(tone.samples));
}
