//! What is under the pointer.

use crate::light::Light;
use glam::Vec3;
use hemicube_radiosity::PatchMesh;
use hemicube_radiosity::patch::face::Side;
use hemicube_raster::Rgb;

/// A point of a surface and its light; the light is no number as long as it is not known, because a device keeps it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Where, in world units.
    pub point: Vec3,
    /// Unit normal of the side that is seen.
    pub normal: Vec3,
    /// Index of the mesh's face, and its side.
    pub face: usize,
    /// Which side is seen.
    pub side: Side,
    /// The element there; `None` where that side only absorbs.
    pub element: Option<usize>,
    /// Index of the scene's material.
    pub material: usize,
    /// Index of the scene's instance.
    pub instance: usize,
    /// Irradiance: lx or W/m².
    pub irradiance: Rgb,
    /// Radiosity: lm/m² or W/m².
    pub radiosity: Rgb,
    /// Illuminance in lx.
    pub illuminance: f32,
}

/// The first surface along a ray, as a picture shows it: sides that do not receive are looked through.
pub fn read_along(
    mesh: &PatchMesh,
    light: &Light,
    origin: Vec3,
    direction: Vec3,
) -> Option<Reading> {
    let visibility = mesh.visibility();
    let mut start = origin;
    // A picture leaves out sides seen from behind; so does the pointer, through as many as a building has.
    for _ in 0..16 {
        let hit = visibility.first_hit(start, direction, f32::INFINITY)?;
        let along = visibility.normal(hit.face);
        if visibility.receives(hit.face, hit.side) {
            let face = &mesh.faces()[hit.face];
            let element = mesh.element_at(hit.face, hit.side, hit.point);
            let irradiance = element.map_or(Rgb::BLACK, |e| light.irradiance[e]);
            return Some(Reading {
                point: hit.point,
                normal: if hit.side == Side::Front {
                    along
                } else {
                    -along
                },
                face: hit.face,
                side: hit.side,
                element,
                material: face.material as usize,
                instance: face.instance as usize,
                irradiance,
                radiosity: element.map_or(Rgb::BLACK, |e| light.radiosity(mesh, e)),
                illuminance: mesh.scene().units.illuminance(irradiance),
            });
        }
        start = visibility.off_surface(hit.point, along * along.dot(direction).signum());
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use hemicube_radiosity::{Quality, solve};
    use hemicube_scene::builtin;
    use std::sync::Arc;

    #[test]
    fn the_furnace_reads_its_closed_form() {
        let scene = Arc::new(builtin::furnace_with(0.5, 1.0));
        let solution = solve(scene, &Quality::Draft.into(), |_, _| true).expect("it can be solved");
        let light = Light::new(&solution, &[Rgb::WHITE]);
        let mesh = solution.mesh();
        let (low, high) = mesh.scene().bounds().expect("it has faces");
        let reading = read_along(
            mesh,
            &light,
            0.5 * (low + high),
            Vec3::new(0.3, -1.0, 0.2).normalize(),
        );
        let reading = reading.expect("it is closed");
        assert!(
            (reading.irradiance.g - 2.0).abs() < 0.05,
            "H = E / (1 - ρ): {reading:?}"
        );
        assert!(
            (reading.radiosity.g - 2.0).abs() < 0.05,
            "B = E + ρ H: {reading:?}"
        );
        assert_eq!(
            reading.illuminance,
            179.0 * reading.irradiance.luminance(),
            "radiometric"
        );
        assert!(
            (reading.point.y - low.y).abs() < 1e-3 && reading.normal.y > 0.99,
            "{reading:?}"
        );
    }

    #[test]
    fn walls_seen_from_behind_are_looked_through() {
        let scene = Arc::new(builtin::furnace_with(0.5, 1.0));
        let solution =
            solve(scene, &Quality::Draft.into(), |_, _| false).expect("it can be meshed");
        let light = Light::new(&solution, &[Rgb::WHITE]);
        let mesh = solution.mesh();
        let (low, high) = mesh.scene().bounds().expect("it has faces");
        let outside = 0.5 * (low + high) + Vec3::Z * 5.0 * (high - low).length();
        let reading = read_along(mesh, &light, outside, Vec3::NEG_Z).expect("the far wall");
        assert!(
            (reading.point.z - low.z).abs() < 1e-3,
            "not the near one: {reading:?}"
        );
        assert!(
            read_along(mesh, &light, outside, Vec3::Z).is_none(),
            "nothing there"
        );
    }
}
