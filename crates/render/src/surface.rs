//! Points of surfaces: attributes between vertices, and what the material does with light there.

use crate::sight::SurfaceHit;
use crate::stage::{Stage, StageTriangle};
use core::ops::{Add, Mul, Sub};
use glam::{Vec2, Vec3};
use hemicube_raster::Rgb;
use hemicube_scene::TextureSlot;

/// World position and unit normal of a point.
pub(crate) fn place(stage: &Stage<'_>, hit: &SurfaceHit) -> (Vec3, Vec3) {
    let position = interpolated(stage, hit, &stage.drawn.positions);
    let normal = interpolated(stage, hit, &stage.drawn.normals);
    let element = stage.triangle(hit).element as usize;
    let mesh = stage.solution.mesh();
    let flat = mesh.node(mesh.elements()[element]).normal;
    (position, normal.try_normalize().unwrap_or(flat))
}

/// Whether a point lies in a hole of an alpha mask, which the finest level of its texture decides: shadows of the
/// solution have the same holes.
pub(crate) fn is_hole(stage: &Stage<'_>, hit: &SurfaceHit) -> bool {
    let scene = stage.scene();
    let color = interpolated(stage, hit, &stage.drawn.colors);
    let texel = |slot: TextureSlot, srgb| finest_texel(stage, hit, slot, srgb);
    let surface = scene.surface_with(stage.material_of(hit), color, texel);
    surface.transmittance == Rgb::WHITE
}

/// A texture's factors from its finest level.
pub(crate) fn finest_texel(
    stage: &Stage<'_>,
    hit: &SurfaceHit,
    slot: TextureSlot,
    srgb: bool,
) -> [f32; 4] {
    let scene = stage.scene();
    let texture = &scene.textures[slot.texture];
    let at = slot.coordinates(slot.texcoord(&texcoords(stage, hit)));
    scene.images[texture.image].sample(at, texture.wrap, srgb)
}

/// Both sets of texture coordinates at a point.
pub(crate) fn texcoords(stage: &Stage<'_>, hit: &SurfaceHit) -> [Vec2; 2] {
    [0, 1].map(|set| {
        let corners = corners(stage.triangle(hit)).map(|c| stage.drawn.texcoords[c][set]);
        mixed(corners, hit.weights)
    })
}

/// Vertices of a triangle as indices.
pub(crate) fn corners(triangle: &StageTriangle) -> [usize; 3] {
    triangle.corners.map(|c| c as usize)
}

/// A vertex attribute at a point.
pub(crate) fn interpolated<T>(stage: &Stage<'_>, hit: &SurfaceHit, values: &[T]) -> T
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f32, Output = T>,
{
    mixed(corners(stage.triangle(hit)).map(|c| values[c]), hit.weights)
}

/// `a + v (b - a) + w (c - a)`: three equal values stay what they are, to the bit.
pub(crate) fn mixed<T>([a, b, c]: [T; 3], [v, w]: [f32; 2]) -> T
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f32, Output = T>,
{
    a + (b - a) * v + (c - a) * w
}
