// Rows of cells of a hemicube's picture, and the share of the light that passes through them.

// Cells of a row that one invocation walks along.
const SEGMENT: u32 = 32u;

// Where a row of cells lies.
struct CellRow {
    // Its first cell in the picture.
    corner: vec2<u32>,
    // Its running sums among the delta form factors.
    sums: u32,
}

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

// A row among those of all faces: the top's, then those of the sides.
fn row_of(number: u32) -> CellRow {
    let r = params.resolution;
    let half = r / 2u;
    var face = 0u;
    var row = number;
    var table = select(half - 1u - row, row - half, row >= half);
    if number >= r {
        face = 1u + (number - r) / half;
        row = (number - r) % half;
        table = half + half - 1u - row;
    }
    return CellRow(corner_of(face) + vec2(0u, row), table * (half + 1u));
}

// Share of the light between the middle of a row and a border of cells, negative on its left.
fn up_to(sums_of_row: u32, border: u32) -> u32 {
    let half = params.resolution / 2u;
    if border < half {
        return 0u - deltas[sums_of_row + half - border];
    }
    return deltas[sums_of_row + border - half];
}

// Where what a cell sees is added up: at an element, behind them what only absorbs, and behind that nothing.
fn bin_of(item: u32) -> u32 {
    if item == ITEM_EMPTY {
        return params.elements + 1u;
    }
    return select(item >> 1u, params.elements, (item & 1u) != 0u);
}
