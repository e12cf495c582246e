// Second stage: the item buffer of one hemicube, all five faces in one picture.
//
// The picture is two resolutions wide and one and a half high, without a cell to spare: the top upper left, sides 0 and
// 1 right of it, sides 2 and 3 below. Each face is a draw call with its own viewport, which clips it.
// Twin of `CubeFace::clip` in radiosity/src/form_factor/delta_factors.rs.

struct DrawParams {
    // Which of the batch's hemicubes.
    viewpoint: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(0) @binding(0) var<uniform> params: HemicubeParams;
@group(0) @binding(1) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(2) var<storage, read> viewpoints: array<Viewpoint>;
@group(0) @binding(3) var<storage, read> placed: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> seen: array<u32>;
@group(0) @binding(5) var<storage, read> nearest: array<u32>;
@group(1) @binding(0) var<uniform> draw: DrawParams;

struct Corner {
    @builtin(position) position: vec4<f32>,
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

// Four vertices for each receiver, one instance for each face.
@vertex
fn vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) face: u32) -> Corner {
    let receiver = vertex / 4u;
    let bits = seen[draw.viewpoint * params.receivers + receiver];
    var corner: Corner;
    // Beyond the far plane, all four: clipped.
    corner.position = vec4(0.0, 0.0, 2.0, 1.0);
    corner.item = ITEM_EMPTY;
    if (bits & (1u << face)) == 0u {
        return corner;
    }
    let near = max(LEAST_DEPTH * bitcast<f32>(nearest[draw.viewpoint]), viewpoints[draw.viewpoint].least_near);
    let index = receivers[receiver].corners[vertex % 4u];
    corner.position = clip(face, placed[draw.viewpoint * params.vertices + index].xyz, near);
    let is_back = (bits & SEEN_BACK) != 0u;
    corner.position.z += select(0.0, LAG * near, is_back);
    corner.item = min(receiver, params.elements) << 1u | select(0u, 1u, is_back);
    return corner;
}

@fragment
fn fragment(corner: Corner) -> @location(0) u32 {
    return corner.item;
}
