// First stage: vertices into the frames of a batch of hemicubes, and what each receiver may be seen as.
// Twin of `Seen::new` in radiosity/src/form_factor/hemicube/seen.rs.

@group(0) @binding(0) var<uniform> params: HemicubeParams;
@group(0) @binding(1) var<storage, read> vertices: array<vec4<f32>>;
// Vertices of each receiver; the fourth repeats the third of a triangle.
@group(0) @binding(2) var<storage, read> corners_of: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(4) var<storage, read> viewpoints: array<Viewpoint>;
// [viewpoint][vertex]: position in the frame, and the planes beyond which it lies.
@group(0) @binding(5) var<storage, read_write> placed: array<vec4<f32>>;
// [viewpoint][MASKS][2 groups]: one bit for each receiver.
@group(0) @binding(6) var<storage, read_write> masks: array<u32>;
// Of each viewpoint: bits of the distance to the nearest receiver; positive numbers are ordered as their bits are.
@group(0) @binding(7) var<storage, read_write> nearest: array<atomic<u32>>;

const NOT_ABOVE: u32 = 4096u;
// Set where a receiver shows a side that only absorbs.
const BACK: u32 = 32u;

// [MASKS][2], of the 64 receivers of a workgroup.
var<workgroup> masks_of_group: array<atomic<u32>, 12>;

// On which sides of the planes between the five pyramids, and of the hemicube's own, a point lies.
fn planes_beyond(p: vec3<f32>) -> u32 {
    return select(0u, 1u, p.x > p.z)
        | select(0u, 2u, -p.x > p.z)
        | select(0u, 4u, p.y > p.z)
        | select(0u, 8u, -p.y > p.z)
        | select(0u, 16u, p.z > p.x)
        | select(0u, 32u, p.z > -p.x)
        | select(0u, 64u, p.z > p.y)
        | select(0u, 128u, p.z > -p.y)
        | select(0u, 256u, p.y > p.x)
        | select(0u, 512u, p.x > p.y)
        | select(0u, 1024u, -p.y > p.x)
        | select(0u, 2048u, p.x > -p.y)
        | select(0u, NOT_ABOVE, p.z <= 0.0);
}

// The faces on which something may be seen, all of whose corners are beyond the planes `beyond_all`.
fn faces_within(beyond_all: u32) -> u32 {
    return select(0u, 1u, (beyond_all & 15u) == 0u)
        | select(0u, 2u, (beyond_all & (16u | 256u | 1024u)) == 0u)
        | select(0u, 4u, (beyond_all & (64u | 512u | 1024u)) == 0u)
        | select(0u, 8u, (beyond_all & (32u | 512u | 2048u)) == 0u)
        | select(0u, 16u, (beyond_all & (128u | 256u | 2048u)) == 0u);
}

@compute @workgroup_size(64)
fn place(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let vertex = id.x + id.z * groups.x * 64u;
    if vertex >= params.vertices {
        return;
    }
    let view = viewpoints[id.y];
    let d = vertices[vertex].xyz - view.origin;
    let p = vec3(dot(d, view.tangent), dot(d, view.bitangent), dot(d, view.normal));
    placed[id.y * params.vertices + vertex] = vec4(p, bitcast<f32>(planes_beyond(p)));
    if vertex == 0u {
        atomicStore(&nearest[id.y], bitcast<u32>(view.farthest));
    }
}

// Distance from the frame's origin to a planar convex polygon given in the frame.
fn distance_to_polygon(corners: array<vec3<f32>, 4>, count: u32, normal: vec3<f32>) -> f32 {
    var polygon = corners;
    var is_over = true;
    var nearest_2 = 3.4e38;
    for (var i = 0u; i < count; i++) {
        let a = polygon[i];
        let edge = polygon[(i + 1u) % count] - a;
        is_over = is_over && dot(cross(edge, -a), normal) >= 0.0;
        let along = clamp(dot(-a, edge) / max(dot(edge, edge), 1e-30), 0.0, 1.0);
        let offset = -a - edge * along;
        nearest_2 = min(nearest_2, dot(offset, offset));
    }
    return select(sqrt(nearest_2), abs(dot(polygon[0], normal)), is_over);
}

// What a receiver may be seen as: bit k for the face k, and BACK; 0 where it is not seen at all.
fn bits_of(index: u32, viewpoint: u32) -> u32 {
    let view = viewpoints[viewpoint];
    let receiver = receivers[index];
    let vertices_of = corners_of[index];
    let first = viewpoint * params.vertices;
    var corners: array<vec3<f32>, 4>;
    var beyond_all = 0xffffffffu;
    for (var k = 0u; k < 4u; k++) {
        let corner = placed[first + vertices_of[k]];
        corners[k] = corner.xyz;
        beyond_all &= bitcast<u32>(corner.w);
    }
    let from_behind = dot(view.origin - receiver.centroid, receiver.normal) <= 0.0;
    let has_other = from_behind && (receiver.flags & RECEIVER_BOTH_SIDES) != 0u;
    if (beyond_all & NOT_ABOVE) != 0u || has_other {
        return 0u;
    }
    let best = bitcast<f32>(atomicLoad(&nearest[viewpoint]));
    let reach = best + receiver.radius;
    let offset = view.origin - receiver.centroid;
    if dot(offset, offset) < reach * reach && abs(dot(offset, receiver.normal)) < best {
        let n = receiver.normal;
        let normal = vec3(dot(n, view.tangent), dot(n, view.bitangent), dot(n, view.normal));
        let count = select(4u, 3u, vertices_of.w == vertices_of.z);
        atomicMin(&nearest[viewpoint], bitcast<u32>(distance_to_polygon(corners, count, normal)));
    }
    let absorbs = from_behind || (receiver.flags & (RECEIVER_OBSTRUCTION | RECEIVER_EXPOSED)) != RECEIVER_EXPOSED;
    return faces_within(beyond_all) | select(0u, BACK, absorbs);
}

@compute @workgroup_size(64)
fn classify(
    @builtin(local_invocation_index) lane: u32,
    @builtin(workgroup_id) workgroup: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let group = workgroup.x + workgroup.z * groups.x;
    let index = group * 64u + lane;
    if index < params.receivers {
        let bits = bits_of(index, workgroup.y);
        for (var mask = 0u; mask < MASKS; mask++) {
            if (bits >> mask & 1u) != 0u {
                atomicOr(&masks_of_group[2u * mask + lane / 32u], 1u << (lane % 32u));
            }
        }
    }
    workgroupBarrier();
    if lane < 2u * MASKS && group < params.groups {
        let first = (workgroup.y * MASKS + lane / 2u) * 2u * params.groups;
        masks[first + 2u * group + lane % 2u] = atomicLoad(&masks_of_group[lane]);
    }
}
