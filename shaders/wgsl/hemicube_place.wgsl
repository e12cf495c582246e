// First stage: vertices into the frames of a batch of hemicubes, and what each receiver may be seen as.
// Twin of `Seen::new` in radiosity/src/form_factor/hemicube/seen.rs.

@group(0) @binding(0) var<uniform> params: HemicubeParams;
@group(0) @binding(1) var<storage, read> vertices: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> receivers: array<Receiver>;
@group(0) @binding(3) var<storage, read> viewpoints: array<Viewpoint>;
// [viewpoint][vertex]: position in the frame, and the planes beyond which it lies.
@group(0) @binding(4) var<storage, read_write> placed: array<vec4<f32>>;
// [viewpoint][receiver]: SEEN_* bits; 0 where it is not seen at all.
@group(0) @binding(5) var<storage, read_write> seen: array<u32>;
// Of each viewpoint: bits of the distance to the nearest receiver; positive numbers are ordered as their bits are.
@group(0) @binding(6) var<storage, read_write> nearest: array<atomic<u32>>;

const NOT_ABOVE: u32 = 4096u;

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

@compute @workgroup_size(64)
fn classify(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = id.x + id.z * groups.x * 64u;
    if index >= params.receivers {
        return;
    }
    let view = viewpoints[id.y];
    let receiver = receivers[index];
    let first = id.y * params.vertices;
    var corners: array<vec3<f32>, 4>;
    var beyond_all = 0xffffffffu;
    for (var k = 0u; k < 4u; k++) {
        let corner = placed[first + receiver.corners[k]];
        corners[k] = corner.xyz;
        beyond_all &= bitcast<u32>(corner.w);
    }
    let is_obstruction = (receiver.flags & RECEIVER_OBSTRUCTION) != 0u;
    let from_behind = dot(view.origin - receiver.centroid, receiver.normal) <= 0.0;
    let has_other = from_behind && (receiver.flags & RECEIVER_BOTH_SIDES) != 0u;
    var bits = 0u;
    if (beyond_all & NOT_ABOVE) == 0u && !has_other {
        bits = faces_within(beyond_all);
        if is_obstruction || from_behind || (receiver.flags & RECEIVER_EXPOSED) == 0u {
            bits |= SEEN_BACK;
        }
        let n = receiver.normal;
        let normal = vec3(dot(n, view.tangent), dot(n, view.bitangent), dot(n, view.normal));
        let count = select(4u, 3u, receiver.corners.w == receiver.corners.z);
        let best = bitcast<f32>(atomicLoad(&nearest[id.y]));
        let reach = best + receiver.radius;
        let offset = view.origin - receiver.centroid;
        if dot(offset, offset) < reach * reach && abs(dot(offset, receiver.normal)) < best {
            atomicMin(&nearest[id.y], bitcast<u32>(distance_to_polygon(corners, count, normal)));
        }
    }
    seen[id.y * params.receivers + index] = bits;
}
