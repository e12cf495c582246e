// Edges of elements over the picture: each is a strip of two triangles as wide as asked for in pixels, with smooth sides.
// Edges of which no element turns its lit side to the eye are left out.

struct LineParams {
    // Linear, exposed; the fourth is opacity.
    color: vec4<f32>,
    // Pixels.
    width: f32,
    // Share of its distance by which a line comes nearer, so that it is not hidden by its own element.
    lift: f32,
    padding_0: u32,
    padding_1: u32,
}

@group(1) @binding(0) var<uniform> line: LineParams;

struct Edge {
    @location(0) start: vec3<f32>,
    // Normals of the two elements that meet here; twice the same at borders.
    @location(1) first_normal: vec3<f32>,
    @location(2) end: vec3<f32>,
    @location(3) second_normal: vec3<f32>,
}

struct LineFragment {
    @builtin(position) position: vec4<f32>,
    // Pixels from the line's middle.
    @location(0) @interpolate(linear) across: f32,
}

@vertex
fn line_vertex(edge: Edge, @builtin(vertex_index) index: u32) -> LineFragment {
    var out: LineFragment;
    // Nowhere, if it is not seen.
    out.position = vec4(0.0, 0.0, -1.0, 1.0);
    let to_eye = view.eye.xyz - view.eye.w * edge.start;
    if dot(edge.first_normal, to_eye) <= 0.0 && dot(edge.second_normal, to_eye) <= 0.0 {
        return out;
    }
    var a = view.clip_from_world * vec4(edge.start, 1.0);
    var b = view.clip_from_world * vec4(edge.end, 1.0);
    // Cut at the near plane, where z reaches w.
    let before_a = a.w - a.z;
    let before_b = b.w - b.z;
    if before_a < 0.0 && before_b < 0.0 {
        return out;
    }
    if before_a < 0.0 {
        a = mix(a, b, before_a / (before_a - before_b));
    } else if before_b < 0.0 {
        b = mix(b, a, before_b / (before_b - before_a));
    }
    let half_size = 0.5 * view.size;
    let way = (b.xy / b.w - a.xy / a.w) * half_size;
    let along = select(vec2(1.0, 0.0), normalize(way), dot(way, way) > 0.0);
    let side = select(-1.0, 1.0, (index & 1u) != 0u);
    let reach = 0.5 * line.width + 0.5;
    let end = select(a, b, index >= 2u);
    let offset = vec2(-along.y, along.x) * (side * reach) / half_size;
    out.position = vec4(end.xy + offset * end.w, end.z + line.lift * end.z, end.w);
    out.across = side * reach;
    return out;
}

@fragment
fn line_fragment(in: LineFragment) -> @location(0) vec4<f32> {
    let coverage = saturate(0.5 * line.width + 0.5 - abs(in.across)) * line.color.a;
    return vec4(line.color.rgb * coverage, coverage);
}
