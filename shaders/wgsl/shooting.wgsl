// Progressive refinement by sorted shooting, all state kept on the device. One round for each hemicube:
// `choose` the patch with most unshot flux and take its light, or the next hemicube of the patch that shoots;
// the stages of the hemicube; `spread` what its sums say; `measure` what each patch has left.
// Twin of radiosity/src/solve/shooting.rs.

struct ShootingParams {
    elements: u32,
    patches: u32,
    // Groups of luminaires times bands.
    channels: u32,
    // Sums of each hemicube: 3 where panes let light of each band through by its own share, else 1.
    bands: u32,
    // Distance beyond which nothing is.
    farthest: f32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

struct ElementLight {
    area: f32,
    // 0 where nothing of it is exposed.
    inverse_area: f32,
    padding_0: u32,
    padding_1: u32,
    reflectance: vec3<f32>,
    padding_2: u32,
}

struct ShootingPatch {
    first_element: u32,
    elements: u32,
    // Where its hemicubes stand.
    first_view: u32,
    views: u32,
    normal: vec3<f32>,
    padding: u32,
}

// Where a hemicube stands; the rest of its frame follows from its patch.
struct ShotView {
    origin: vec3<f32>,
    // Share of the patch that it stands for.
    weight: f32,
    // First axis in the patch's plane.
    tangent: vec3<f32>,
    // Least distance of the near planes.
    least_near: f32,
}

struct ShotState {
    // The patch that shoots.
    shooter: u32,
    // Which of its hemicubes is drawn, and how many it has; 0 if nobody has anything to shoot.
    view: u32,
    views: u32,
    // Patches that have begun to shoot.
    shots: u32,
    // Share of the patch that the hemicube stands for.
    weight: f32,
    // Unshot flux over all patches, absolute, and the most that one has; when they were last looked at. What a patch that
    // shoots has not yet spread is unshot.
    unshot: f32,
    largest: f32,
    // No patch begins to shoot after so many.
    most_shots: u32,
}

@group(0) @binding(0) var<uniform> params: ShootingParams;
@group(0) @binding(1) var<storage, read> elements: array<ElementLight>;
@group(0) @binding(2) var<storage, read> patches: array<ShootingPatch>;
@group(0) @binding(3) var<storage, read> views: array<ShotView>;
@group(0) @binding(4) var<storage, read_write> state: ShotState;
// Absolute unshot flux of each patch, over channels.
@group(0) @binding(5) var<storage, read_write> unshot_of_patch: array<f32>;
// [irradiance, unshot radiosity][channel][element], then for each channel: flux that the patch shoots; flux absorbed by
// backs and what its sum has lost to rounding; flux escaped and what its sum has lost; flux that elements have received,
// and what is unshot of it, when they were last tallied.
@group(0) @binding(6) var<storage, read_write> light: array<f32>;

@group(1) @binding(0) var<storage, read_write> viewpoints: array<Viewpoint>;
@group(1) @binding(1) var<storage, read_write> sums: array<u32>;

const CHANNEL_WORDS: u32 = 7u;
const SHARE: f32 = 1.0 / 2147483648.0;
const CHOOSERS: u32 = 256u;

var<workgroup> best: array<f32, CHOOSERS>;
var<workgroup> best_patch: array<u32, CHOOSERS>;
var<workgroup> total: array<f32, CHOOSERS>;

fn unshot_at(channel: u32, element: u32) -> u32 {
    return (params.channels + channel) * params.elements + element;
}

fn channel_at(channel: u32) -> u32 {
    return 2u * params.channels * params.elements + channel * CHANNEL_WORDS;
}

// The patch with most unshot flux, the first of several, into best_patch[0]; the sum into total[0].
fn survey_patches(thread: u32) {
    var largest = -1.0;
    var found = 0u;
    var sum = 0.0;
    for (var p = thread; p < params.patches; p += CHOOSERS) {
        let flux = unshot_of_patch[p];
        sum += flux;
        if flux > largest {
            largest = flux;
            found = p;
        }
    }
    best[thread] = largest;
    best_patch[thread] = found;
    total[thread] = sum;
    workgroupBarrier();
    for (var half = CHOOSERS / 2u; half > 0u; half /= 2u) {
        if thread < half {
            let other = thread + half;
            total[thread] += total[other];
            let is_first = best[other] == best[thread] && best_patch[other] < best_patch[thread];
            if best[other] > best[thread] || is_first {
                best[thread] = best[other];
                best_patch[thread] = best_patch[other];
            }
        }
        workgroupBarrier();
    }
}

// Share of the patch that shoots whose light is not yet spread.
fn share_in_flight() -> f32 {
    var weight = 0.0;
    for (var view = state.view + 1u; view < state.views; view++) {
        weight += views[patches[state.shooter].first_view + view].weight;
    }
    return weight;
}

// Absolute flux that the patch that shoots has not yet spread.
fn in_flight() -> f32 {
    let weight = share_in_flight();
    var flux = 0.0;
    if weight > 0.0 {
        for (var channel = 0u; channel < params.channels; channel++) {
            flux += abs(light[channel_at(channel)]);
        }
    }
    return flux * weight;
}

@compute @workgroup_size(256)
fn survey(@builtin(local_invocation_index) thread: u32) {
    survey_patches(thread);
    if thread == 0u {
        let flux = in_flight();
        state.unshot = total[0] + flux;
        state.largest = max(max(best[0], flux), 0.0);
    }
}

@compute @workgroup_size(256)
fn choose(@builtin(local_invocation_index) thread: u32) {
    survey_patches(thread);
    let goes_on = state.view + 1u < state.views;
    let may_begin = best[0] > 0.0 && state.shots < state.most_shots;
    // All have read the state before it is written.
    storageBarrier();
    workgroupBarrier();
    let shooter = select(best_patch[0], state.shooter, goes_on);
    let patch_of = patches[shooter];
    if !goes_on {
        // Take the patch's light.
        for (var channel = thread; channel < params.channels; channel += CHOOSERS) {
            var flux = 0.0;
            if may_begin {
                for (var i = 0u; i < patch_of.elements; i++) {
                    let element = patch_of.first_element + i;
                    let at = unshot_at(channel, element);
                    flux += elements[element].area * light[at];
                    light[at] = 0.0;
                }
            }
            light[channel_at(channel)] = flux;
        }
    }
    storageBarrier();
    workgroupBarrier();
    if thread == 0u {
        let view = select(0u, state.view + 1u, goes_on);
        state.shooter = shooter;
        state.view = view;
        if !goes_on {
            state.views = select(0u, patch_of.views, may_begin);
            state.shots += select(0u, 1u, may_begin);
        }
        let stand = views[patch_of.first_view + view];
        state.weight = stand.weight;
        let bitangent = cross(patch_of.normal, stand.tangent);
        viewpoints[0] = Viewpoint(
            stand.origin, stand.least_near, stand.tangent, params.farthest, bitangent, 0u, patch_of.normal, 0u,
        );
    }
}

// What arrived in a bin of a channel's sums.
fn arrived(channel: u32, bin: u32) -> f32 {
    let band = select(0u, channel % 3u, params.bands == 3u);
    return f32(sums[band * (params.elements + 2u) + bin]);
}

// Adds to a sum and to what it has lost to rounding (Kahan 1965).
fn add(at: u32, value: f32) {
    let sum = light[at];
    let wanted = value - light[at + 1u];
    let next = sum + wanted;
    light[at + 1u] = (next - sum) - wanted;
    light[at] = next;
}

@compute @workgroup_size(64)
fn spread(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let element = id.x + id.z * groups.x * 64u;
    let scale = state.weight * SHARE;
    if element < params.channels && state.views > 0u {
        let at = channel_at(element);
        let flux = light[at] * scale;
        add(at + 1u, flux * arrived(element, params.elements));
        add(at + 3u, flux * arrived(element, params.elements + 1u));
    }
    if element >= params.elements || state.views == 0u {
        return;
    }
    let share = scale * elements[element].inverse_area;
    for (var channel = 0u; channel < params.channels; channel++) {
        let gain = arrived(channel, element) * share * light[channel_at(channel)];
        if gain == 0.0 {
            continue;
        }
        light[channel * params.elements + element] += gain;
        light[unshot_at(channel, element)] += gain * elements[element].reflectance[channel % 3u];
    }
}

@compute @workgroup_size(64)
fn measure(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let p = id.x + id.z * groups.x * 64u;
    if p >= params.patches {
        return;
    }
    let patch_of = patches[p];
    var magnitude = 0.0;
    for (var channel = 0u; channel < params.channels; channel++) {
        var flux = 0.0;
        for (var i = 0u; i < patch_of.elements; i++) {
            let element = patch_of.first_element + i;
            flux += elements[element].area * light[unshot_at(channel, element)];
        }
        magnitude += abs(flux);
    }
    unshot_of_patch[p] = magnitude;
}

// Signed fluxes of a channel for each workgroup: received by all elements, and unshot.
@compute @workgroup_size(256)
fn tally(
    @builtin(local_invocation_index) thread: u32,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let channel = group.x + group.z * groups.x;
    var received = 0.0;
    var unshot = 0.0;
    if channel < params.channels {
        for (var element = thread; element < params.elements; element += CHOOSERS) {
            let area = elements[element].area;
            received += area * light[channel * params.elements + element];
            unshot += area * light[unshot_at(channel, element)];
        }
    }
    best[thread] = received;
    total[thread] = unshot;
    workgroupBarrier();
    for (var half = CHOOSERS / 2u; half > 0u; half /= 2u) {
        if thread < half {
            best[thread] += best[thread + half];
            total[thread] += total[thread + half];
        }
        workgroupBarrier();
    }
    if thread == 0u && channel < params.channels {
        let at = channel_at(channel);
        light[at + 5u] = best[0];
        light[at + 6u] = total[0] + light[at] * share_in_flight();
    }
}
