// Third stage: the item buffer of one hemicube, all five faces in one picture.
//
// The picture is two resolutions wide and one and a half high, without a cell to spare: the top upper left, sides 0 and
// 1 right of it, sides 2 and 3 below. Each face is a draw call with its own viewport, which clips it.
// Twin of `CubeFace::clip` in radiosity/src/form_factor/delta_factors.rs.

struct DrawParams {
    // Which of the batch's hemicubes.
    viewpoint: u32,
    face: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(0) @binding(0) var<uniform> params: HemicubeParams;
// Vertices of each receiver; the fourth repeats the third of a triangle.
@group(0) @binding(1) var<storage, read> corners_of: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> viewpoints: array<Viewpoint>;
@group(0) @binding(3) var<storage, read> placed: array<vec4<f32>>;
// [viewpoint][FACES][receiver]: number times 2, plus 1 for a side that only absorbs.
@group(0) @binding(4) var<storage, read> lists: array<u32>;
@group(0) @binding(5) var<storage, read> nearest: array<u32>;
@group(1) @binding(0) var<uniform> draw: DrawParams;
// [viewpoint][cell]: what the layers before have let through, and bits of the depth behind which the next one lies.
@group(2) @binding(0) var<storage, read> through: array<vec4<u32>>;

struct Corner {
    // The same bits in all layers, so that what is drawn behind itself is nothing.
    @builtin(position) @invariant position: vec4<f32>,
    @location(0) @interpolate(flat) item: u32,
}

// Clip-space position of a point in the frame. Pictures are seen from inside, so right = forward × up.
fn clip(face: u32, p: vec3<f32>, near: f32) -> vec4<f32> {
    var eye: vec3<f32>;
    switch face {
        case 0u: { eye = vec3(-p.x, p.y, p.z); }
        case 1u: { eye = vec3(-p.y, p.z, p.x); }
        case 2u: { eye = vec3(p.x, p.z, p.y); }
        case 3u: { eye = vec3(p.y, p.z, -p.x); }
        default: { eye = vec3(-p.x, p.z, -p.y); }
    }
    // Of the sides only the upper half is in the picture.
    let up = select(2.0 * eye.y - eye.z, eye.y, face == 0u);
    return vec4(eye.x, up, eye.z - near, eye.z);
}

// Four vertices for each receiver on the face's list.
@vertex
fn vertex(@builtin(vertex_index) vertex: u32) -> Corner {
    let list = (draw.viewpoint * FACES + draw.face) * params.receivers;
    let entry = lists[list + vertex / 4u];
    let receiver = entry >> 1u;
    let is_back = entry & 1u;
    let near = max(LEAST_DEPTH * bitcast<f32>(nearest[draw.viewpoint]), viewpoints[draw.viewpoint].least_near);
    let point = placed[draw.viewpoint * params.vertices + corners_of[receiver][vertex % 4u]].xyz;
    var corner: Corner;
    corner.position = clip(draw.face, point, near);
    corner.position.z += select(0.0, LAG * near, is_back != 0u);
    corner.item = min(receiver, params.elements) << 1u | is_back;
    return corner;
}

@fragment
fn fragment(corner: Corner) -> @location(0) u32 {
    return corner.item;
}

// What lies behind the layers that were drawn before (depth peeling; Everitt 2001).
@fragment
fn behind(corner: Corner) -> @location(0) u32 {
    let cell = vec2<u32>(corner.position.xy);
    let width = 2u * params.resolution;
    let cells = 3u * params.resolution * params.resolution;
    let before = bitcast<f32>(through[draw.viewpoint * cells + cell.y * width + cell.x].w);
    if corner.position.z <= before {
        discard;
    }
    return corner.item;
}
