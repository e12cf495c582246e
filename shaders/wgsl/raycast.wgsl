// Where rays go, by walking the eight-wide tree that obvhs builds: for adapters without ray queries.

// Half an element, or an obstruction.
struct RayTriangle {
    a: vec3<f32>,
    // The element; the number of elements for what only absorbs.
    element: u32,
    b: vec3<f32>,
    // 1 if its other side is an element of its own, which is met there.
    both_sides: u32,
    c: vec3<f32>,
    padding: u32,
}

// Nodes of 20 words, as `obvhs::cwbvh::CwBvhNode` lays them out (Ylitie, Karras, Laine 2017).
@group(0) @binding(2) var<storage, read> nodes: array<u32>;
// In the order of the leaves.
@group(0) @binding(3) var<storage, read> triangles: array<RayTriangle>;

const NODE_WORDS: u32 = 20u;
// Levels of the tree, at most: a group waits on each.
const STACK: u32 = 32u;

struct Ray {
    origin: vec3<f32>,
    direction: vec3<f32>,
    inverse: vec3<f32>,
    // Axes permuted so that the direction is longest along z, and what shears it onto z
    // (Woop, Benthin, Wald 2013: neighbouring triangles leave no gap).
    axes: vec3<u32>,
    shear: vec3<f32>,
}

fn ray_of(origin: vec3<f32>, direction: vec3<f32>) -> Ray {
    let size = abs(direction);
    var z = 0u;
    if size.y > size.x { z = 1u; }
    if size.z > size[z] { z = 2u; }
    var x = (z + 1u) % 3u;
    var y = (z + 2u) % 3u;
    if direction[z] < 0.0 {
        let swap = x;
        x = y;
        y = swap;
    }
    // A direction along an axis: a slab that it runs in is never left.
    let safe = select(direction, vec3(1e-30), size < vec3(1e-30));
    let shear = vec3(direction[x], direction[y], 1.0) / direction[z];
    return Ray(origin, direction, 1.0 / safe, vec3(x, y, z), shear);
}

// Distance to a triangle, and whether its front is met; the distance is negative where it is missed.
fn meet(ray: Ray, index: u32) -> vec2<f32> {
    let a = triangles[index].a - ray.origin;
    let b = triangles[index].b - ray.origin;
    let c = triangles[index].c - ray.origin;
    let x = vec3(a[ray.axes.x], b[ray.axes.x], c[ray.axes.x]);
    let y = vec3(a[ray.axes.y], b[ray.axes.y], c[ray.axes.y]);
    let z = vec3(a[ray.axes.z], b[ray.axes.z], c[ray.axes.z]);
    let sx = x - ray.shear.x * z;
    let sy = y - ray.shear.y * z;
    let u = sx.z * sy.y - sy.z * sx.y;
    let v = sx.x * sy.z - sy.x * sx.z;
    let w = sx.y * sy.x - sy.y * sx.x;
    let missed = vec2(-1.0, 0.0);
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return missed;
    }
    let determinant = u + v + w;
    if determinant == 0.0 {
        return missed;
    }
    let distance = (u * z.x + v * z.y + w * z.z) * ray.shear.z / determinant;
    if !(distance > 0.0) {
        return missed;
    }
    // Seen against its normal, a triangle turns counter-clockwise.
    let normal = cross(b - a, c - a);
    return vec2(distance, select(0.0, 1.0, dot(normal, ray.direction) < 0.0));
}

fn byte_of(node: u32, first_word: u32, child: u32) -> u32 {
    return nodes[node + first_word + child / 4u] >> (8u * (child % 4u)) & 255u;
}

// The bin of what a ray meets first.
//
// A stack entry is a group: where the children of a node begin, its mask of inner children, and in the upper eight bits
// those still to be visited, in the order in which the ray's octant meets them.
fn bin_of(origin: vec3<f32>, direction: vec3<f32>) -> u32 {
    let ray = ray_of(origin, direction);
    let octant = select(4u, 0u, ray.direction.x < 0.0)
        | select(2u, 0u, ray.direction.y < 0.0)
        | select(1u, 0u, ray.direction.z < 0.0);
    var stack: array<vec2<u32>, STACK>;
    var depth = 0u;
    var group = vec2(0u, 0x80000000u);
    var nearest = params.farthest;
    var bin = params.elements + 1u;
    loop {
        let bit = firstLeadingBit(group.y);
        group.y &= ~(1u << bit);
        if group.y >> 24u != 0u {
            stack[depth] = group;
            depth++;
        }
        let slot = (bit - 24u) ^ octant;
        let index = group.x + countOneBits(group.y & ~(0xffffffffu << slot) & 255u);
        let node = index * NODE_WORDS;
        let corner = vec3(bitcast<f32>(nodes[node]), bitcast<f32>(nodes[node + 1u]), bitcast<f32>(nodes[node + 2u]));
        let packed = nodes[node + 3u];
        let scale = vec3(
            bitcast<f32>((packed & 255u) << 23u),
            bitcast<f32>((packed >> 8u & 255u) << 23u),
            bitcast<f32>((packed >> 16u & 255u) << 23u),
        );
        group = vec2(nodes[node + 4u], packed >> 24u);
        let near = (corner - ray.origin) * ray.inverse;
        let step = scale * ray.inverse;
        for (var child = 0u; child < 8u; child++) {
            let meta_bits = byte_of(node, 6u, child);
            if meta_bits == 0u {
                continue;
            }
            let low = vec3<f32>(vec3(byte_of(node, 8u, child), byte_of(node, 12u, child), byte_of(node, 16u, child)));
            let high = vec3<f32>(vec3(byte_of(node, 10u, child), byte_of(node, 14u, child), byte_of(node, 18u, child)));
            let one = low * step + near;
            let other = high * step + near;
            let first = min(one, other);
            let last = max(one, other);
            let enter = max(max(first.x, first.y), max(first.z, 0.0));
            // A few roundings wider, so that nothing slips out between box and triangle.
            let leave = min(min(last.x, last.y), min(last.z, nearest)) * 1.0000004;
            if enter > leave {
                continue;
            }
            if (group.y >> child & 1u) != 0u {
                group.y |= 1u << ((meta_bits & 31u) ^ octant);
                continue;
            }
            let start = nodes[node + 5u] + (meta_bits & 31u);
            for (var i = start; i < start + countOneBits(meta_bits >> 5u); i++) {
                let hit = meet(ray, i);
                let is_front = hit.y != 0.0;
                if hit.x < 0.0 || (!is_front && triangles[i].both_sides != 0u) {
                    continue;
                }
                let absorbs = !is_front || triangles[i].element == params.elements;
                let distance = hit.x + select(0.0, params.lag, absorbs);
                if distance < nearest {
                    nearest = distance;
                    bin = select(triangles[i].element, params.elements, absorbs);
                }
            }
        }
        if group.y >> 24u == 0u {
            if depth == 0u {
                break;
            }
            depth--;
            group = stack[depth];
        }
    }
    return bin;
}
