// Numbers as colours: illuminance through a table, with lines of equal value; or all surfaces in one colour, the ground of a
// wireframe. Twin of raster/src/colormap.

struct FieldParams {
    // Colour of lines.
    line_color: vec4<f32>,
    // Colour where there is no number; for `plain` that of surfaces.
    missing: vec4<f32>,
    // Illuminance of irradiance 1, band by band.
    weights: vec4<f32>,
    // Values of the first and the last colour.
    low: f32,
    high: f32,
    // From one line to the next; 0 without lines.
    spacing: f32,
    // A value that has a line.
    start: f32,
    // Of lines, in pixels of the target.
    width: f32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(1) @binding(0) var<uniform> field: FieldParams;
@group(1) @binding(1) var<storage, read> colors: array<vec4<f32>>;

fn table_color(value: f32) -> vec3<f32> {
    var share = (value - field.low) / (field.high - field.low);
    if field.low == field.high {
        share = 0.5;
    }
    let steps = arrayLength(&colors) - 1u;
    let place = clamp(share, 0.0, 1.0) * f32(steps);
    let before = min(u32(place), steps - 1u);
    return mix(colors[before].rgb, colors[before + 1u].rgb, place - f32(before));
}

// How much line there is from 0 to x, in periods.
fn covered_up_to(x: f32, half_width: f32) -> f32 {
    let whole = round(x);
    return 2.0 * half_width * whole + clamp(x - whole, -half_width, half_width);
}

// The share of a pixel that lines cover, where the value changes by `change` over it.
fn line_coverage(value: f32, change: f32) -> f32 {
    let step = change / field.spacing;
    let phase = (value - field.start) / field.spacing;
    if !(field.spacing > 0.0) || !(step > 1e-12) || !(step < 1e30) {
        return 0.0;
    }
    let half_width = min(0.5 * field.width * step, 0.25);
    let place = phase - round(phase);
    let share = covered_up_to(place + 0.5 * step, half_width) - covered_up_to(place - 0.5 * step, half_width);
    return saturate(share / step);
}

@fragment
fn falsecolour(in: Fragment) -> @location(0) vec4<f32> {
    let between = dot(in.light, field.weights.rgb);
    let change = length(vec2(dpdx(between), dpdy(between)));
    let value = dot(solved_light(in), field.weights.rgb);
    var color = table_color(value);
    if !FLAT {
        color = mix(color, field.line_color.rgb, line_coverage(value, change));
    }
    return vec4(color, 1.0);
}

@fragment
fn plain(in: Fragment) -> @location(0) vec4<f32> {
    return vec4(field.missing.rgb, 1.0);
}
