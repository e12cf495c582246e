// What passes that end in a display have in common: exposed light through a curve, sRGB, a triangle over the whole target.
// Twin of raster/src/tonemap.rs.

struct ToneParams {
    // 0 Reinhard, 1 ACES, 2 none, 3 light as it is.
    curve: u32,
    // 1 if the target stores numbers as they are, and sRGB has to be encoded here.
    encodes: u32,
    samples: u32,
    padding: u32,
}

const CURVE_REINHARD: u32 = 0u;
const CURVE_ACES: u32 = 1u;
const CURVE_NONE: u32 = 2u;
const CURVE_LINEAR: u32 = 3u;
const WHITE_POINT: f32 = 4.0;

@group(0) @binding(0) var<uniform> tone: ToneParams;

// One triangle over the whole target.
@vertex
fn screen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(index / 2u) * 4.0 - 1.0, f32(index % 2u) * 4.0 - 1.0, 0.0, 1.0);
}

fn curve(luminance: f32) -> f32 {
    switch tone.curve {
        case CURVE_REINHARD: {
            return min(luminance * (1.0 + luminance / (WHITE_POINT * WHITE_POINT)) / (1.0 + luminance), 1.0);
        }
        case CURVE_ACES: {
            let x = 0.6 * luminance;
            return min(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 1.0);
        }
        default: {
            return min(luminance, 1.0);
        }
    }
}

// What the display shows of exposed light, linear, each band in [0, 1].
fn shown(exposed: vec3<f32>) -> vec3<f32> {
    // NaN and negative bands count as 0.
    let light = select(vec3(0.0), exposed, exposed > vec3(0.0));
    if tone.curve == CURVE_LINEAR {
        return light;
    }
    let luminance = dot(light, vec3(0.2126, 0.7152, 0.0722));
    if luminance <= 0.0 {
        return vec3(0.0);
    }
    let level = curve(luminance);
    let color = light * (level / luminance);
    let largest = max(color.r, max(color.g, color.b));
    // Mixed with grey until the largest band is at most 1.
    let saturation = select(1.0, (1.0 - level) / (largest - level), largest > 1.0);
    return saturate(vec3(level) + (color - vec3(level)) * saturation);
}

fn srgb(linear: vec3<f32>) -> vec3<f32> {
    let low = 12.92 * linear;
    let high = 1.055 * pow(max(linear, vec3(0.0)), vec3(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3(0.0031308));
}

fn stored(linear: vec3<f32>) -> vec4<f32> {
    if tone.encodes != 0u {
        return vec4(srgb(linear), 1.0);
    }
    return vec4(linear, 1.0);
}
