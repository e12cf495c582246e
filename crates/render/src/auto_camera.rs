//! A view of a scene that brings no camera.

use crate::{exterior_view, interior_view};
use glam::Vec3;
use hemicube_radiosity::PatchMesh;
use hemicube_radiosity::visibility::Hit;
use hemicube_scene::Camera;

/// Name of the camera that is found.
const NAME: &str = "auto";

/// A camera for a scene that has none.
///
/// A room is seen from inside: from a place at the height of a standing person's eyes, preferably in a corner, from
/// which most of the room is seen. Everything else is seen from outside, a little from above, from the direction that
/// shows most of its lit surfaces; a box with an open front is looked into. Rays decide; the same mesh gives the same
/// camera.
pub fn choose_camera(mesh: &PatchMesh) -> Camera {
    let room = Bounds::of(mesh);
    interior_view::find(mesh, &room).unwrap_or_else(|| exterior_view::find(mesh, &room))
}

/// A camera of the usual name.
pub(crate) fn looking(eye: Vec3, target: Vec3, vertical_fov_degrees: f32) -> Camera {
    Camera::looking_at(
        NAME,
        eye,
        target,
        Vec3::Y,
        vertical_fov_degrees.to_radians(),
    )
}

/// The box around all faces.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds {
    pub low: Vec3,
    pub high: Vec3,
}

impl Bounds {
    fn of(mesh: &PatchMesh) -> Self {
        let corners = mesh.faces().iter().flat_map(|face| face.polygon());
        let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (low, high) = corners.fold(nothing, |(low, high), &p| (low.min(p), high.max(p)));
        Self { low, high }
    }

    pub fn size(&self) -> Vec3 {
        self.high - self.low
    }

    pub fn centre(&self) -> Vec3 {
        0.5 * (self.low + self.high)
    }

    /// Length of the diagonal.
    pub fn diameter(&self) -> f32 {
        self.size().length()
    }

    /// The point at these shares of the sides.
    pub fn at(&self, shares: Vec3) -> Vec3 {
        self.low + self.size() * shares
    }
}

/// First surface along a ray, and whether it shows its lit side.
pub(crate) fn look(mesh: &PatchMesh, origin: Vec3, direction: Vec3) -> Option<(Hit, bool)> {
    let visibility = mesh.visibility();
    // Adding 0 makes -0 to 0: the BVH misses everything along directions with a component of -0.
    let hit = visibility.first_hit(origin, direction + Vec3::ZERO, f32::INFINITY)?;
    let lit = visibility.receives(hit.face, hit.side);
    Some((hit, lit))
}
