// What the stages of a hemicube share. Structs have twins in src/hemicube.rs.

// An element or an obstruction.
struct Receiver {
    // Vertices; the fourth repeats the third of a triangle.
    corners: vec4<u32>,
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
}

// Both sides of its face are elements.
const RECEIVER_BOTH_SIDES: u32 = 1u;
// Some of it is not covered by other surfaces.
const RECEIVER_EXPOSED: u32 = 2u;
// It only blocks and absorbs, on both sides.
const RECEIVER_OBSTRUCTION: u32 = 4u;

// A receiver as one hemicube sees it: bits 0 to 4 for the faces on which it may appear.
const SEEN_FACES: u32 = 31u;
// It shows a side that only absorbs.
const SEEN_BACK: u32 = 32u;

// A cell that sees nothing.
const ITEM_EMPTY: u32 = 0xffffffffu;

// Share of their distance by which backs are drawn farther away than they are.
const LAG: f32 = 5e-4;
// How far a visible point at distance 1 is at least before the eye's plane of one of the faces.
const LEAST_DEPTH: f32 = 0.57;
