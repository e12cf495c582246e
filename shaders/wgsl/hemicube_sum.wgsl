// Third stage: the delta form factors of a batch of item buffers, added up by item.
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

// Cells of a row that one invocation walks along.
const SEGMENT: u32 = 32u;

// A face's place in the picture.
fn corner_of(face: u32) -> vec2<u32> {
    let r = params.resolution;
    switch face {
        case 0u: { return vec2(0u, 0u); }
        case 1u: { return vec2(r, 0u); }
        case 2u: { return vec2(r, r / 2u); }
        case 3u: { return vec2(0u, r); }
        default: { return vec2(r, r); }
    }
}

// Share of the light between the middle of a row and a border of cells, negative on its left.
fn up_to(row: u32, border: u32) -> u32 {
    let half = params.resolution / 2u;
    if border < half {
        return 0u - deltas[row + half - border];
    }
    return deltas[row + border - half];
}

fn add(first: u32, item: u32, share: u32) {
    var bin = item >> 1u;
    if (item & 1u) != 0u {
        bin = params.elements;
    }
    if item == ITEM_EMPTY {
        bin = params.elements + 1u;
    }
    atomicAdd(&sums[first + bin], share);
}

// x: segments of a row, y: rows of all faces (the top's, then those of the sides), z: viewpoints.
@compute @workgroup_size(8, 8)
fn sum(@builtin(global_invocation_id) id: vec3<u32>) {
    let r = params.resolution;
    let half = r / 2u;
    let start = id.x * SEGMENT;
    if start >= r || id.y >= 3u * r {
        return;
    }
    var face = 0u;
    var row = id.y;
    var table = select(half - 1u - row, row - half, row >= half);
    if id.y >= r {
        face = 1u + (id.y - r) / half;
        row = (id.y - r) % half;
        table = half + half - 1u - row;
    }
    let sums_of_row = table * (half + 1u);
    let corner = corner_of(face) + vec2(0u, row);
    let first = id.z * (params.elements + 2u);
    let end = min(start + SEGMENT, r);
    var item = textureLoad(items, corner + vec2(start, 0u), id.z, 0).x;
    var from_share = up_to(sums_of_row, start);
    for (var cell = start + 1u; cell < end; cell++) {
        let next = textureLoad(items, corner + vec2(cell, 0u), id.z, 0).x;
        if next != item {
            let to_share = up_to(sums_of_row, cell);
            add(first, item, to_share - from_share);
            item = next;
            from_share = to_share;
        }
    }
    add(first, item, up_to(sums_of_row, end) - from_share);
}
