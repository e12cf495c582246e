// How textures are read; twins of raster/src/texture: footprints (lod.rs), addressing (wrap.rs), bicubic magnification
// (cubic.rs), elliptical weighted averages (ewa.rs). Point, bilinear, trilinear and anisotropic filters are the sampler's.

// Whether EWA is read from afar; else it is the sampler's filter.
override EWA: bool = true;
// Whether the sampler's own filter looks at both axes of a footprint.
override ANISOTROPIC: bool = false;
// MAGNIFY_*, what is read close up.
override MAGNIFY: u32 = 0u;

const MAGNIFY_SAMPLER: u32 = 0u;
const MAGNIFY_CATMULL_ROM: u32 = 1u;
const MAGNIFY_B_SPLINE: u32 = 2u;
const MAGNIFY_MITCHELL: u32 = 3u;

// Squares of footprints from here on count as infinite: fourth powers fit into floats.
const LARGEST_SQUARE: f32 = 1e18;
// Widest minor axis that an ellipse is read with, in texels.
const WIDEST: f32 = 8.0;

// Two perpendicular derivatives of the place in texels, the longer one first.
struct Axes {
    along: vec2<f32>,
    across: vec2<f32>,
}

// The axes of the ellipse that a parallelogram's circle becomes (Heckbert 1989).
fn axes_of(ddx: vec2<f32>, ddy: vec2<f32>) -> Axes {
    // Scaled to 1: fourth powers fit into floats.
    let largest = max(max(abs(ddx.x), abs(ddx.y)), max(abs(ddy.x), abs(ddy.y)));
    let scale = select(1.0, largest, largest > 0.0);
    let dx = ddx / scale;
    let dy = ddy / scale;
    let a = dx.x * dx.x + dy.x * dy.x;
    let b = dx.x * dx.y + dy.x * dy.y;
    let c = dx.y * dx.y + dy.y * dy.y;
    let mean = 0.5 * (a + c);
    let radius = length(vec2(0.5 * (a - c), b));
    var direction = vec2(1.0, 0.0);
    if radius > 0.0 && a >= c {
        direction = normalize(vec2(0.5 * (a - c) + radius, b));
    } else if radius > 0.0 {
        direction = normalize(vec2(b, 0.5 * (c - a) + radius));
    }
    let major = sqrt(mean + radius);
    let area = abs(dx.x * dy.y - dx.y * dy.x);
    let minor = select(0.0, area / major, major > 0.0);
    return Axes(direction * major * scale, vec2(-direction.y, direction.x) * minor * scale);
}

// The square of the longer axis alone, which is all that samplers need to know.
fn longest_square(dx: vec2<f32>, dy: vec2<f32>) -> f32 {
    let xx = dot(dx, dx);
    let yy = dot(dy, dy);
    return 0.5 * (xx + yy) + length(vec2(0.5 * (xx - yy), dot(dx, dy)));
}

// The texel that an index along an axis of so many reads.
fn wrapped(index: i32, size: i32, rule: u32) -> i32 {
    switch rule {
        case 0u: {
            let rest = index % size;
            return select(rest, rest + size, rest < 0);
        }
        case 1u: {
            let period = 2 * size;
            let rest = index % period;
            let place = select(rest, rest + period, rest < 0);
            return select(place, period - 1 - place, place >= size);
        }
        default: {
            return clamp(index, 0, size - 1);
        }
    }
}

// A coordinate that reads the same texels, small enough for integers.
fn reduced(u: f32, rule: u32) -> f32 {
    switch rule {
        case 0u: { return u - floor(u); }
        case 1u: { return u - 2.0 * floor(0.5 * u); }
        default: { return clamp(u, -8.0, 8.0); }
    }
}

// Texels of a slot's picture across and down.
fn texels_of(slot: Slot) -> vec2<f32> {
    return vec2(f32(slot.size & 0xffffu), f32(slot.size >> 16u));
}

struct Rules {
    u: u32,
    v: u32,
}

fn rules_of(slot: Slot) -> Rules {
    return Rules((slot.flags >> SLOT_WRAP_U_SHIFT) & 3u, (slot.flags >> SLOT_WRAP_V_SHIFT) & 3u);
}

// Texels of a level across and down. Not asked of the driver: some take the level of one pixel for all that they draw at once.
fn size_of(picture: texture_2d<f32>, level: i32) -> vec2<u32> {
    return max(textureDimensions(picture, 0) >> vec2(u32(level)), vec2(1u));
}

fn texel(picture: texture_2d<f32>, level: i32, at: vec2<i32>, rules: Rules) -> vec4<f32> {
    let size = vec2<i32>(size_of(picture, level));
    return textureLoad(picture, vec2(wrapped(at.x, size.x, rules.u), wrapped(at.y, size.y, rules.v)), level);
}

// A place in texels of a level, from the middle of the first one.
fn place_in(picture: texture_2d<f32>, level: i32, uv: vec2<f32>, rules: Rules) -> vec2<f32> {
    let size = vec2<f32>(size_of(picture, level));
    return vec2(reduced(uv.x, rules.u), reduced(uv.y, rules.v)) * size - 0.5;
}

// Four texels with exact weights.
fn bilinear(picture: texture_2d<f32>, level: i32, uv: vec2<f32>, rules: Rules) -> vec4<f32> {
    let at = place_in(picture, level, uv, rules);
    let low = vec2<i32>(floor(at));
    let share = at - floor(at);
    let upper = mix(texel(picture, level, low, rules), texel(picture, level, low + vec2(1, 0), rules), share.x);
    let lower = mix(
        texel(picture, level, low + vec2(0, 1), rules),
        texel(picture, level, low + vec2(1, 1), rules),
        share.x,
    );
    return mix(upper, lower, share.y);
}

// Weights of four texels, `[1 t t^2 t^3] M` with the matrices of VK_EXT_filter_cubic.
fn cubic_weights(t: f32, kernel: u32) -> vec4<f32> {
    var a = vec4(0.0, 2.0, 0.0, 0.0);
    var b = vec4(-1.0, 0.0, 1.0, 0.0);
    var c = vec4(2.0, -5.0, 4.0, -1.0);
    var d = vec4(-1.0, 3.0, -3.0, 1.0);
    var scale = 0.5;
    if kernel == MAGNIFY_B_SPLINE {
        a = vec4(1.0, 4.0, 1.0, 0.0);
        b = vec4(-3.0, 0.0, 3.0, 0.0);
        c = vec4(3.0, -6.0, 3.0, 0.0);
        scale = 1.0 / 6.0;
    } else if kernel == MAGNIFY_MITCHELL {
        a = vec4(1.0, 16.0, 1.0, 0.0);
        b = vec4(-9.0, 0.0, 9.0, 0.0);
        c = vec4(15.0, -36.0, 27.0, -6.0);
        d = vec4(-7.0, 21.0, -21.0, 7.0);
        scale = 1.0 / 18.0;
    }
    return (((d * t + c) * t + b) * t + a) * scale;
}

// 4 x 4 texels under a cubic kernel.
fn bicubic(picture: texture_2d<f32>, uv: vec2<f32>, rules: Rules, kernel: u32) -> vec4<f32> {
    let at = place_in(picture, 0, uv, rules);
    let first = vec2<i32>(floor(at)) - 1;
    let share = at - floor(at);
    let across = cubic_weights(share.x, kernel);
    let down = cubic_weights(share.y, kernel);
    var sum = vec4(0.0);
    for (var y = 0; y < 4; y++) {
        var row = vec4(0.0);
        for (var x = 0; x < 4; x++) {
            row += texel(picture, 0, first + vec2(x, y), rules) * across[x];
        }
        sum += row * down[y];
    }
    return sum;
}

// `exp(-2 s) - exp(-2)` of a square of distance, 0 from 1 on.
fn gaussian(square: f32) -> f32 {
    let s = min(square, 1.0);
    var q = fma(-0.029487216, s, 0.16070424);
    q = fma(q, s, -0.4509139);
    q = fma(q, s, 0.860711);
    q = fma(q, s, -1.1350077);
    q = fma(q, s, 0.8646603);
    return (1.0 - s) * q;
}

// The mean of all texels of a level in an ellipse of two axes in its texels, by a Gaussian.
fn elliptical_mean(picture: texture_2d<f32>, level: i32, uv: vec2<f32>, rules: Rules, d0: vec2<f32>, d1: vec2<f32>) -> vec4<f32> {
    let at = place_in(picture, level, uv, rules);
    let whole = vec2<i32>(floor(at));
    let centre = at - floor(at);
    // Widened by a texel, so that it never falls between texels.
    var a = d0.y * d0.y + d1.y * d1.y + 1.0;
    var b = -2.0 * (d0.x * d0.y + d1.x * d1.y);
    var c = d0.x * d0.x + d1.x * d1.x + 1.0;
    let area = d0.x * d1.y - d0.y * d1.x;
    let scale = 1.0 / (area * area + dot(d0, d0) + dot(d1, d1) + 1.0);
    let reach = sqrt(a);
    a *= scale;
    b *= scale;
    c *= scale;
    var sum = vec4(0.0);
    var weights = 0.0;
    let bottom = i32(floor(centre.y + reach));
    for (var row = i32(ceil(centre.y - reach)); row <= bottom; row++) {
        let dy = f32(row) - centre.y;
        let share = dy / reach;
        let middle = centre.x - 0.5 * b / a * dy;
        let half = sqrt(max(1.0 - share * share, 0.0) / a);
        let last = i32(floor(middle + half));
        for (var column = i32(ceil(middle - half)); column <= last; column++) {
            let dx = f32(column) - centre.x;
            let weight = gaussian((a * dx + b * dy) * dx + c * dy * dy);
            sum += texel(picture, level, whole + vec2(column, row), rules) * weight;
            weights += weight;
        }
    }
    return sum / weights;
}

// An ellipse of axes in texels of the largest level, in a smaller one, shortened to what may be read.
fn elliptical_in(picture: texture_2d<f32>, level: i32, uv: vec2<f32>, rules: Rules, d0: vec2<f32>, d1: vec2<f32>) -> vec4<f32> {
    let size = size_of(picture, level);
    if all(size == vec2(1u)) {
        return textureLoad(picture, vec2(0), level);
    }
    let scale = vec2<f32>(size) / vec2<f32>(textureDimensions(picture, 0));
    let across = d1 * scale;
    let shrink = min(WIDEST / length(across), 1.0);
    return elliptical_mean(picture, level, uv, rules, d0 * scale * shrink, across * shrink);
}

// Elliptical weighted average in the two levels where the shorter axis is one to two texels long.
fn elliptical(picture: texture_2d<f32>, uv: vec2<f32>, rules: Rules, axes: Axes) -> vec4<f32> {
    let along = axes.along * view.ewa_radius;
    let major = length(along);
    let minor = max(length(axes.across) * view.ewa_radius, major / view.max_anisotropy);
    let across = vec2(-along.y, along.x) / major * minor;
    let last = i32(textureNumLevels(picture)) - 1;
    let lod = clamp(log2(minor), 0.0, f32(last));
    let upper = min(i32(floor(lod)), last);
    let sharp = elliptical_in(picture, upper, uv, rules, along, across);
    let weight = lod - floor(lod);
    if weight == 0.0 {
        return sharp;
    }
    return mix(sharp, elliptical_in(picture, min(upper + 1, last), uv, rules, along, across), weight);
}

// A texture as a pixel sees it whose coordinates change by these to its neighbours. The sampler is asked once, at the end:
// software adapters execute both sides of every branch.
fn filtered(picture: texture_2d<f32>, how: sampler, slot: Slot, uv: vec2<f32>, ddx: vec2<f32>, ddy: vec2<f32>) -> vec4<f32> {
    let rules = rules_of(slot);
    let size = texels_of(slot);
    let dx = ddx * size;
    let dy = ddy * size;
    // What cannot be counted with reads the coarsest level.
    let is_countable = dot(dx, dx) + dot(dy, dy) < LARGEST_SQUARE;
    let square = select(LARGEST_SQUARE, longest_square(dx, dy), is_countable);
    let is_close = square <= 1.0;
    let is_smooth = (slot.flags & SLOT_BLOCKS) == 0u;
    if MAGNIFY != MAGNIFY_SAMPLER && is_close && is_smooth {
        return bicubic(picture, uv, rules, MAGNIFY);
    }
    if EWA && !is_close && is_countable {
        return elliptical(picture, uv, rules, axes_of(dx, dy));
    }
    if ANISOTROPIC {
        let axes = axes_of(dx, dy);
        let along = select(vec2(1e6, 0.0), axes.along, is_countable);
        let across = select(vec2(0.0, 1e6), axes.across, is_countable);
        return textureSampleGrad(picture, how, uv, along / size, across / size);
    }
    return textureSampleLevel(picture, how, uv, 0.5 * log2(max(square, 1e-30)));
}
