//! A floor under a square lamp and a square blocker, with its light in closed form and as meshes interpolate it.

use glam::{DVec2, DVec3, Vec3};
use hemicube_radiosity::form_factor::polygon::{FlatPolygon, common_part, point_to_polygon};
use hemicube_radiosity::patch::face::Side;
use hemicube_radiosity::{PatchMesh, PatchOptions, RadiosityError};
use hemicube_raster::Rgb;
use hemicube_scene::builtin::SceneBuilder;
use hemicube_scene::{Material, Scene, Units};
use std::sync::Arc;

/// The floor's edge.
pub(super) const FLOOR: f32 = 4.0;

/// What stands in the light.
#[derive(Debug, Clone, Copy)]
pub(super) struct Penumbra {
    lamp: [Vec3; 4],
    blocker: [Vec3; 4],
}

/// A horizontal square around the vertical axis whose front looks down.
fn square(height: f32, half: f32, turn: f32) -> [Vec3; 4] {
    [0, 1, 2, 3].map(|i| {
        let angle = turn + core::f32::consts::FRAC_PI_4 + i as f32 * core::f32::consts::FRAC_PI_2;
        Vec3::new(angle.cos(), 0.0, angle.sin()) * half * core::f32::consts::SQRT_2
            + Vec3::Y * height
    })
}

impl Penumbra {
    /// With a blocker that is turned against the lamp.
    pub(super) fn turned(turn: f32) -> Self {
        Self {
            lamp: square(2.0, 0.1, 0.0),
            blocker: square(0.7, 0.4, turn),
        }
    }

    fn scene(&self) -> Scene {
        let mut builder = SceneBuilder::new("penumbra", Units::Radiometric);
        let grey = builder.diffuse("floor", 0.5, 0.5, 0.5);
        let glow = builder.material(Material {
            emission: Rgb::WHITE,
            ..Material::diffuse("lamp", Rgb::BLACK)
        });
        let black = builder.material(Material {
            double_sided: true,
            ..Material::diffuse("blocker", Rgb::BLACK)
        });
        let at = |x: f32, z: f32| Vec3::new(x, 0.0, z) * (0.5 * FLOOR);
        builder.node("floor");
        builder.quad(
            grey,
            [at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0)],
        );
        builder.node("lamp");
        builder.quad(glow, self.lamp);
        builder.node("blocker");
        builder.quad(black, self.blocker);
        builder.finish()
    }

    /// A mesh of the scene.
    pub(super) fn mesh(&self, options: PatchOptions) -> Result<PatchMesh, RadiosityError> {
        PatchMesh::build(Arc::new(self.scene()), options)
    }

    /// Form factor from a point of the floor to what it sees of the lamp, and to all of it.
    pub(super) fn factors(&self, point: DVec3) -> [f64; 2] {
        let lamp = self.lamp.map(|p| p.as_dvec3());
        let shadow = self.blocker.map(|corner| {
            let offset = corner.as_dvec3() - point;
            point + offset * (lamp[0].y / offset.y)
        });
        let hidden = common_part(&lamp, &shadow, DVec3::NEG_Y);
        let to = |polygon: &[DVec3]| -> f64 {
            let triangles = (2..polygon.len()).map(|i| [polygon[0], polygon[i - 1], polygon[i]]);
            let factor = |corners: [DVec3; 3]| {
                point_to_polygon(point, DVec3::Y, &FlatPolygon::from_corners(&corners))
            };
            triangles.map(factor).sum()
        };
        let all = to(&lamp);
        [all - to(&hidden), all]
    }
}

/// The floor of a mesh with exact light at its vertices.
pub(super) struct LitFloor<'a> {
    mesh: &'a PatchMesh,
    /// Of each vertex of the mesh; only those of the floor are looked up.
    light: Vec<f64>,
}

impl<'a> LitFloor<'a> {
    pub(super) fn new(penumbra: &Penumbra, mesh: &'a PatchMesh) -> Self {
        let light = |p: &Vec3| {
            if p.y == 0.0 {
                penumbra.factors(p.as_dvec3())[0]
            } else {
                0.0
            }
        };
        Self {
            light: mesh.vertices().iter().map(light).collect(),
            mesh,
        }
    }

    /// Its elements.
    pub(super) fn elements(&self) -> impl Iterator<Item = usize> + '_ {
        let ids = self.mesh.elements();
        (0..ids.len()).filter(|&e| self.mesh.node(ids[e]).centroid.y == 0.0)
    }

    /// Light at a point, linear between the corners of the triangles as which its element is drawn.
    pub(super) fn light(&self, point: Vec3) -> f64 {
        let Some(element) = self.mesh.element_at(0, Side::Front, point) else {
            return 0.0;
        };
        let corners = self.mesh.corners(self.mesh.elements()[element]);
        let at = |i: usize| self.mesh.vertices()[corners[i] as usize].as_dvec3();
        let flat = |p: DVec3| DVec2::new(p.x, p.z);
        let point = point.as_dvec3();
        let weights = |i: usize| {
            let [a, b, c] = [0, i, i + 1].map(|k| flat(at(k) - point));
            let area = (b - a).perp_dot(c - a);
            (
                [0, i, i + 1],
                [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)].map(|w| w / area),
            )
        };
        let least = |w: &[f64; 3]| w[0].min(w[1]).min(w[2]);
        let triangles = (1..corners.len() - 1).map(weights);
        let inside = triangles.max_by(|a, b| least(&a.1).total_cmp(&least(&b.1)));
        inside.map_or(0.0, |(which, weights)| {
            (0..3)
                .map(|k| self.light[corners[which[k]] as usize] * weights[k])
                .sum()
        })
    }

    /// The edges of its elements.
    pub(super) fn edges(&self) -> Vec<[Vec3; 2]> {
        let edges = self.elements().flat_map(|e| {
            let polygon = self.mesh.polygon(self.mesh.elements()[e]);
            (0..polygon.len()).map(move |i| [polygon[i], polygon[(i + 1) % polygon.len()]])
        });
        edges.collect()
    }
}
