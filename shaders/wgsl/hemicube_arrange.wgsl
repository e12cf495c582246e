// Second stage: for each face of each hemicube the list of the receivers that may appear on it, in their order, and the
// draw call that draws it. Of 10,000 receivers a face of a room shows a fifth: without lists five times as many vertices
// would be looked at.
//
// Lists are compacted with prefix sums over groups of 64 receivers, not with a counter, so that their order, which
// decides between equal depths, is the same in every run.

@group(0) @binding(0) var<uniform> params: HemicubeParams;
// [viewpoint][MASKS][2 groups]: one bit for each receiver.
@group(0) @binding(1) var<storage, read> masks: array<u32>;
// [viewpoint][FACES][group]: where its receivers begin in the list.
@group(0) @binding(2) var<storage, read_write> starts: array<u32>;
// [viewpoint][FACES][receiver]: number times 2, plus 1 for a side that only absorbs.
@group(0) @binding(3) var<storage, read_write> lists: array<u32>;
// [viewpoint][FACES][5]: the arguments of an indexed draw call.
@group(0) @binding(4) var<storage, read_write> draws: array<u32>;

const SCANNERS: u32 = 256u;

var<workgroup> sums: array<u32, SCANNERS>;

fn seen_in_group(first_mask: u32, group: u32) -> u32 {
    return countOneBits(masks[first_mask + 2u * group]) + countOneBits(masks[first_mask + 2u * group + 1u]);
}

// x: faces, y: viewpoints. Each invocation takes some groups in succession (Hillis, Steele 1986 over their sums).
@compute @workgroup_size(256)
fn scan(@builtin(local_invocation_index) thread: u32, @builtin(workgroup_id) workgroup: vec3<u32>) {
    let list = workgroup.y * FACES + workgroup.x;
    let first_mask = (workgroup.y * MASKS + workgroup.x) * 2u * params.groups;
    let share = (params.groups + SCANNERS - 1u) / SCANNERS;
    let begin = min(thread * share, params.groups);
    let end = min(begin + share, params.groups);
    var sum = 0u;
    for (var group = begin; group < end; group++) {
        sum += seen_in_group(first_mask, group);
    }
    sums[thread] = sum;
    workgroupBarrier();
    for (var step = 1u; step < SCANNERS; step *= 2u) {
        let before = select(0u, sums[max(thread, step) - step], thread >= step);
        workgroupBarrier();
        sums[thread] += before;
        workgroupBarrier();
    }
    var start = sums[thread] - sum;
    for (var group = begin; group < end; group++) {
        starts[list * params.groups + group] = start;
        start += seen_in_group(first_mask, group);
    }
    if thread == SCANNERS - 1u {
        let first = 5u * list;
        draws[first] = start * params.indices;
        draws[first + 1u] = 1u;
        draws[first + 2u] = 0u;
        draws[first + 3u] = 0u;
        draws[first + 4u] = 0u;
    }
}

@compute @workgroup_size(64)
fn list(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) workgroups: vec3<u32>) {
    let index = id.x + id.z * workgroups.x * 64u;
    if index >= params.receivers {
        return;
    }
    let words = 2u * params.groups;
    let word = index / 32u;
    let group = index / 64u;
    let bit = index % 32u;
    let first_mask = id.y * MASKS * words;
    let is_back = masks[first_mask + FACES * words + word] >> bit & 1u;
    for (var face = 0u; face < FACES; face++) {
        let mask = masks[first_mask + face * words + word];
        if (mask >> bit & 1u) == 0u {
            continue;
        }
        let list = id.y * FACES + face;
        var slot = starts[list * params.groups + group] + countOneBits(mask & ((1u << bit) - 1u));
        if word % 2u == 1u {
            slot += countOneBits(masks[first_mask + face * words + word - 1u]);
        }
        lists[list * params.receivers + slot] = index << 1u | is_back;
    }
}
