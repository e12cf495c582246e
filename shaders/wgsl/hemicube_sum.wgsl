// Fourth stage: the delta form factors of a batch of item buffers, added up by item.
//
// Shares are whole numbers, so the order of additions changes nothing and every run gives the same bits. Delta form
// factors come as running sums along half rows, from the middle outwards: a run of cells that see the same item costs
// two look-ups and one addition, as in `Hemicube::sum` of radiosity/src/form_factor/hemicube.rs.

@group(0) @binding(0) var<uniform> params: HemicubeParams;
@group(0) @binding(1) var items: texture_2d_array<u32>;
// Rows of resolution / 2 + 1 running sums: those of a quarter of the top, from the middle outwards, then those of a side,
// from the patch's plane upwards.
@group(0) @binding(2) var<storage, read> deltas: array<u32>;
// [viewpoint][elements + 2]: arrived at each element; absorbed; escaped.
@group(0) @binding(3) var<storage, read_write> sums: array<atomic<u32>>;

// x: segments of a row, y: rows of all faces, z: viewpoints.
@compute @workgroup_size(8, 8)
fn sum(@builtin(global_invocation_id) id: vec3<u32>) {
    let start = id.x * SEGMENT;
    if start >= params.resolution || id.y >= 3u * params.resolution {
        return;
    }
    let row = row_of(id.y);
    let first = id.z * (params.elements + 2u);
    let end = min(start + SEGMENT, params.resolution);
    var item = textureLoad(items, row.corner + vec2(start, 0u), id.z, 0).x;
    var from_share = up_to(row.sums, start);
    for (var cell = start + 1u; cell < end; cell++) {
        let next = textureLoad(items, row.corner + vec2(cell, 0u), id.z, 0).x;
        if next != item {
            let to_share = up_to(row.sums, cell);
            atomicAdd(&sums[first + bin_of(item)], to_share - from_share);
            item = next;
            from_share = to_share;
        }
    }
    atomicAdd(&sums[first + bin_of(item)], up_to(row.sums, end) - from_share);
}
