// Fourth stage where panes let light through: one layer of a batch of item buffers, added up by item and band. What a
// pane lets through waits in its cell for the next layer, which is drawn behind this one.
//
// Shares are whole numbers as in hemicube_sum.wgsl; what passes a pane is rounded to one, and what it keeps is the rest,
// so nothing is lost. Twin of `Hemicube::peel` in radiosity/src/form_factor/hemicube.rs.

struct LayerParams {
    // Layers before this one.
    layer: u32,
    // 1 if what passes this one counts as absorbed.
    is_last: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(0) @binding(0) var<uniform> params: HemicubeParams;
@group(0) @binding(1) var items: texture_2d_array<u32>;
@group(0) @binding(2) var depths: texture_depth_2d_array;
// As in hemicube_sum.wgsl.
@group(0) @binding(3) var<storage, read> deltas: array<u32>;
// [viewpoint][band][elements + 2]: arrived at each element; absorbed; escaped.
@group(0) @binding(4) var<storage, read_write> sums: array<atomic<u32>>;
// [viewpoint][cell]: what waits, and bits of the depth behind which the next layer lies: infinite if there is none.
@group(0) @binding(5) var<storage, read_write> through: array<vec4<u32>>;
// Of each element, by band.
@group(0) @binding(6) var<storage, read> transmittance: array<vec4<f32>>;
// [viewpoint][MAX_LAYERS]: whether anything waits for a layer.
@group(0) @binding(7) var<storage, read_write> waits: array<atomic<u32>>;
@group(1) @binding(0) var<uniform> layer: LayerParams;

const MAX_LAYERS: u32 = 8u;
const INFINITE: u32 = 0x7f800000u;

// What passes on of what arrives at an item.
fn passing(item: u32, arriving: vec3<u32>) -> vec3<u32> {
    let element = item >> 1u;
    if item == ITEM_EMPTY || element >= params.elements {
        return vec3(0u);
    }
    let share = vec3<f32>(arriving) * transmittance[element].xyz;
    return min(vec3<u32>(round(share)), arriving);
}

fn add(viewpoint: u32, bin: u32, share: vec3<u32>) {
    for (var band = 0u; band < 3u; band++) {
        if share[band] != 0u {
            atomicAdd(&sums[(viewpoint * 3u + band) * (params.elements + 2u) + bin], share[band]);
        }
    }
}

// x: segments of a row, y: rows of all faces, z: viewpoints.
@compute @workgroup_size(8, 8)
fn peel(@builtin(global_invocation_id) id: vec3<u32>) {
    let r = params.resolution;
    let start = id.x * SEGMENT;
    if start >= r || id.y >= 3u * r {
        return;
    }
    let waits_at = id.z * MAX_LAYERS + layer.layer;
    if layer.layer > 0u && atomicLoad(&waits[waits_at]) == 0u {
        return;
    }
    let row = row_of(id.y);
    let first_cell = id.z * 3u * r * r + row.corner.y * 2u * r + row.corner.x;
    var item = ITEM_EMPTY;
    var arrived = vec3(0u);
    var kept = vec3(0u);
    var goes_on = false;
    for (var cell = start; cell < min(start + SEGMENT, r); cell++) {
        var arriving = vec3(up_to(row.sums, cell + 1u) - up_to(row.sums, cell));
        if layer.layer > 0u {
            arriving = through[first_cell + cell].xyz;
            if all(arriving == vec3(0u)) {
                continue;
            }
        }
        let place = row.corner + vec2(cell, 0u);
        let next = textureLoad(items, place, id.z, 0).x;
        if next != item {
            add(id.z, bin_of(item), arrived);
            add(id.z, params.elements, kept);
            arrived = vec3(0u);
            kept = vec3(0u);
            item = next;
        }
        var rest = passing(item, arriving);
        if item != ITEM_EMPTY && (item & 1u) != 0u {
            kept += arriving - rest;
        } else {
            arrived += arriving;
        }
        if layer.is_last != 0u {
            kept += rest;
            rest = vec3(0u);
        }
        var behind = INFINITE;
        if any(rest != vec3(0u)) {
            behind = bitcast<u32>(textureLoad(depths, place, id.z, 0));
            goes_on = true;
        }
        through[first_cell + cell] = vec4(rest, behind);
    }
    add(id.z, bin_of(item), arrived);
    add(id.z, params.elements, kept);
    if goes_on {
        atomicStore(&waits[waits_at + 1u], 1u);
    }
}

// [viewpoint][FACES][5]: the arguments of an indexed draw call.
@group(2) @binding(0) var<storage, read_write> draws: array<u32>;

// Nothing is drawn for hemicubes in which nothing waits. One invocation for each draw call.
@compute @workgroup_size(64)
fn gate(@builtin(global_invocation_id) id: vec3<u32>) {
    let draw = id.x;
    if 5u * draw >= arrayLength(&draws) {
        return;
    }
    if atomicLoad(&waits[draw / FACES * MAX_LAYERS + layer.layer]) == 0u {
        draws[5u * draw] = 0u;
    }
}
