enable wgpu_ray_query;

// Where rays go, by queries of the adapter's own tree. All triangles are opaque and what counts is found by which way they
// turn, so that hardware needs no help on the way: the nearest front that a ray meets, then whether something that only
// absorbs is nearer.

// Instance 1 of the tree: elements, to be met in front. Instance 2: what only absorbs, to be met behind; obstructions are
// there twice, once for each side.
@group(0) @binding(2) var tree: acceleration_structure;
// Elements of the triangles of instance 1.
@group(0) @binding(3) var<storage, read> element_of: array<u32>;

const RECEIVES: u32 = 1u;
const ABSORBS: u32 = 2u;
const FORCE_OPAQUE: u32 = 0x1u;
const TERMINATE_ON_FIRST_HIT: u32 = 0x4u;
const CULL_BACK_FACING: u32 = 0x10u;
const CULL_FRONT_FACING: u32 = 0x20u;

// The bin of what a ray meets first; what absorbs lags behind.
fn bin_of(origin: vec3<f32>, direction: vec3<f32>) -> u32 {
    var query: ray_query;
    let front = RayDesc(FORCE_OPAQUE | CULL_BACK_FACING, RECEIVES, 0.0, params.farthest, origin, direction);
    rayQueryInitialize(&query, tree, front);
    while rayQueryProceed(&query) {}
    let met = rayQueryGetCommittedIntersection(&query);
    var nearest = params.farthest;
    var bin = params.elements + 1u;
    if met.kind != RAY_QUERY_INTERSECTION_NONE {
        nearest = met.t;
        bin = element_of[met.primitive_index];
    }
    let before = nearest - params.lag;
    if before <= 0.0 {
        return bin;
    }
    let flags = FORCE_OPAQUE | TERMINATE_ON_FIRST_HIT | CULL_FRONT_FACING;
    rayQueryInitialize(&query, tree, RayDesc(flags, ABSORBS, 0.0, before, origin, direction));
    while rayQueryProceed(&query) {}
    let absorbed = rayQueryGetCommittedIntersection(&query).kind != RAY_QUERY_INTERSECTION_NONE;
    return select(bin, params.elements, absorbed);
}
