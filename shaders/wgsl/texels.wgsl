// The textures of a material at a fragment; twin of render/src/filtering.rs.

@group(1) @binding(0) var base_texture: texture_2d<f32>;
@group(1) @binding(1) var metallic_texture: texture_2d<f32>;
@group(1) @binding(2) var roughness_texture: texture_2d<f32>;
@group(1) @binding(3) var emission_texture: texture_2d<f32>;
@group(1) @binding(4) var transmission_texture: texture_2d<f32>;
@group(1) @binding(5) var relief_texture: texture_2d<f32>;
@group(1) @binding(6) var base_sampler: sampler;
@group(1) @binding(7) var metallic_sampler: sampler;
@group(1) @binding(8) var roughness_sampler: sampler;
@group(1) @binding(9) var emission_sampler: sampler;
@group(1) @binding(10) var transmission_sampler: sampler;
@group(1) @binding(11) var relief_sampler: sampler;

// Which slots of the material have textures, a bit for each: what is not there costs nothing.
override SLOTS: u32 = 63u;

// Texture coordinates of both sets, and how they change to the neighbours of a pixel.
struct Footprint {
    at: vec4<f32>,
    dx: vec4<f32>,
    dy: vec4<f32>,
}

// A fragment's footprint; asked for before anything branches, because it looks at neighbours. Coarse differences are the
// same for a block of 2 x 2 pixels, and so is the level that they read: some drivers take the level of one for all four.
fn footprint_of(in: Fragment) -> Footprint {
    return Footprint(in.texcoords, dpdxCoarse(in.texcoords), dpdyCoarse(in.texcoords));
}

fn of_set(slot: Slot, sets: vec4<f32>) -> vec2<f32> {
    if (slot.flags & SLOT_NOWHERE) != 0u {
        return vec2(0.0);
    }
    return select(sets.xy, sets.zw, (slot.flags & SLOT_SECOND) != 0u);
}

fn turned(slot: Slot, way: vec2<f32>) -> vec2<f32> {
    return slot.matrix.xy * way.x + slot.matrix.zw * way.y;
}

fn coordinates(slot: Slot, footprint: Footprint) -> vec2<f32> {
    return turned(slot, of_set(slot, footprint.at)) + slot.offset;
}

fn has(slot: u32) -> bool {
    return (SLOTS & (1u << slot)) != 0u;
}

fn read_slot(picture: texture_2d<f32>, how: sampler, slot: Slot, footprint: Footprint) -> vec4<f32> {
    let ddx = turned(slot, of_set(slot, footprint.dx));
    let ddy = turned(slot, of_set(slot, footprint.dy));
    return filtered(picture, how, slot, coordinates(slot, footprint), ddx, ddy);
}

// The base colour, not multiplied by alpha. Under a mask alpha is that of the finest level, as shadows have it.
fn base_texel(footprint: Footprint) -> vec4<f32> {
    let slot = material.slots[SLOT_BASE];
    var base = read_slot(base_texture, base_sampler, slot, footprint);
    if (slot.flags & SLOT_PREMULTIPLIED) == 0u {
        return base;
    }
    base = select(vec4(0.0), vec4(base.rgb / base.a, base.a), base.a > 0.0);
    if ALPHA == ALPHA_MASK {
        base.a = bilinear(base_texture, 0, coordinates(slot, footprint), rules_of(slot)).a;
    }
    return base;
}

fn texels_at(footprint: Footprint) -> Texels {
    var texels = NO_TEXELS;
    if has(SLOT_BASE) {
        texels.base = base_texel(footprint);
    }
    if has(SLOT_METALLIC) {
        let slot = material.slots[SLOT_METALLIC];
        texels.metallic = read_slot(metallic_texture, metallic_sampler, slot, footprint).b;
    }
    if has(SLOT_ROUGHNESS) {
        let slot = material.slots[SLOT_ROUGHNESS];
        texels.roughness = read_slot(roughness_texture, roughness_sampler, slot, footprint).g;
    }
    if has(SLOT_EMISSION) {
        let slot = material.slots[SLOT_EMISSION];
        texels.emission = read_slot(emission_texture, emission_sampler, slot, footprint).rgb;
    }
    if has(SLOT_TRANSMISSION) {
        let slot = material.slots[SLOT_TRANSMISSION];
        texels.transmission = read_slot(transmission_texture, transmission_sampler, slot, footprint).r;
    }
    return texels;
}
