// A picture that is drawn already goes into its place in a window. The viewport is that place.

/// Whether the window wants linear colours, which its own format encodes.
override decodes: bool = false;

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var between: sampler;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) place: vec2<f32>,
}

/// A triangle that covers the viewport.
@vertex
fn cover(@builtin(vertex_index) i: u32) -> Corner {
    let place = 2.0 * vec2<f32>(f32(i & 1u), f32(i >> 1u));
    return Corner(vec4<f32>(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y, 0.0, 1.0), place);
}

/// Pixel by pixel: what lies under this one. No sampler, which software draws ten times as slowly.
@fragment
fn exact(at: Corner) -> @location(0) vec4<f32> {
    let size = vec2<f32>(textureDimensions(picture));
    return in_format(textureLoad(picture, vec2<i32>(at.place * size), 0));
}

/// Another size than the window's: the mean of what is around.
@fragment
fn stretched(at: Corner) -> @location(0) vec4<f32> {
    return in_format(textureSampleLevel(picture, between, at.place, 0.0));
}

fn in_format(encoded: vec4<f32>) -> vec4<f32> {
    if !decodes {
        return vec4<f32>(encoded.rgb, 1.0);
    }
    let low = encoded.rgb / 12.92;
    let high = pow((encoded.rgb + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(high, low, encoded.rgb <= vec3<f32>(0.04045)), 1.0);
}
