// What the stages of a hemicube share. Structs have twins in src/hemicube.rs.

// An element or an obstruction. Its vertices are kept apart: drawing needs nothing else of it.
struct Receiver {
    normal: vec3<f32>,
    // RECEIVER_* bits.
    flags: u32,
    centroid: vec3<f32>,
    // Around the centroid.
    radius: f32,
}

// A point of a patch with a frame: two axes in the patch's plane and its normal.
struct Viewpoint {
    origin: vec3<f32>,
    // Least distance of the near planes.
    least_near: f32,
    tangent: vec3<f32>,
    // Distance beyond which nothing is.
    farthest: f32,
    bitangent: vec3<f32>,
    padding_0: u32,
    normal: vec3<f32>,
    padding_1: u32,
}

struct HemicubeParams {
    receivers: u32,
    vertices: u32,
    // Elements that can be seen; what follows them in the list of receivers only absorbs.
    elements: u32,
    // Cells along an edge of the top face.
    resolution: u32,
    // Groups of 64 receivers.
    groups: u32,
    // Indices that draw a receiver: 6, or 3 where all are triangles.
    indices: u32,
    padding_0: u32,
    padding_1: u32,
}

// Both sides of its face are elements.
const RECEIVER_BOTH_SIDES: u32 = 1u;
// Some of it is not covered by other surfaces.
const RECEIVER_EXPOSED: u32 = 2u;
// It only blocks and absorbs, on both sides.
const RECEIVER_OBSTRUCTION: u32 = 4u;

// Faces of a hemicube.
const FACES: u32 = 5u;
// Masks of a hemicube over its receivers: one for each face on which they may appear, and last those that show a side that
// only absorbs.
const MASKS: u32 = 6u;

// A cell that sees nothing.
const ITEM_EMPTY: u32 = 0xffffffffu;

// Share of their distance by which backs are drawn farther away than they are.
const LAG: f32 = 5e-4;
// How far a visible point at distance 1 is at least before the eye's plane of one of the faces.
const LEAST_DEPTH: f32 = 0.57;
