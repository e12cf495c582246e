//! Discontinuity meshing against the closed form of a penumbra: a floor under a square lamp and a square blocker.
//!
//! What is compared is what a mesh can do: light is exact at the vertices, from the lamp's polygon clipped against the
//! blocker's projection, and is interpolated linearly in between, as it is drawn. The error is the root mean square over
//! the points of the floor that see a part of the lamp.

use glam::{DVec2, DVec3, Vec3};
use hemicube::radiosity::form_factor::polygon::common_part;
use hemicube::radiosity::patch::face::Side;
use hemicube::radiosity::{PatchMesh, PatchOptions};
use hemicube::raster::Rgb;
use hemicube::scene::builtin::SceneBuilder;
use hemicube::scene::{Material, Scene, Units};
use std::sync::Arc;

/// Half the floor's edge.
const FLOOR: f32 = 2.0;

/// A lamp, a blocker and a floor.
struct Stage {
    lamp: [Vec3; 4],
    blocker: [Vec3; 4],
}

/// A horizontal square, seen from above clockwise, so that its front looks down.
fn square(height: f32, half: f32, turn: f32) -> [Vec3; 4] {
    [0, 1, 2, 3].map(|i| {
        let angle = turn + core::f32::consts::FRAC_PI_4 + i as f32 * core::f32::consts::FRAC_PI_2;
        let reach = half * core::f32::consts::SQRT_2;
        Vec3::new(angle.cos() * reach, height, angle.sin() * reach)
    })
}

impl Stage {
    /// The blocker is turned by an angle against the lamp.
    fn turned(turn: f32) -> Self {
        Self {
            lamp: square(2.0, 0.1, 0.0),
            blocker: square(0.7, 0.4, turn),
        }
    }

    fn scene(&self) -> Scene {
        let mut builder = SceneBuilder::new("penumbra", Units::Radiometric);
        let grey = builder.diffuse("grey", 0.5, 0.5, 0.5);
        let glow = builder.material(Material {
            emission: Rgb::splat(1.0 / core::f32::consts::PI),
            ..Material::diffuse("glow", Rgb::BLACK)
        });
        let both = builder.material(Material {
            double_sided: true,
            ..Material::diffuse("black", Rgb::BLACK)
        });
        builder.node("floor");
        let at = |x: f32, z: f32| Vec3::new(x * FLOOR, 0.0, z * FLOOR);
        builder.quad(
            grey,
            [at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0)],
        );
        builder.node("lamp");
        builder.quad(glow, self.lamp);
        builder.node("blocker");
        builder.quad(both, self.blocker);
        builder.finish()
    }

    /// Irradiance of a point of the floor, and what it would be without the blocker.
    fn irradiance(&self, point: DVec3) -> (f64, f64) {
        let lamp = self.lamp.map(|p| p.as_dvec3());
        let height = lamp[0].y;
        let shadow = self.blocker.map(|corner| {
            let offset = corner.as_dvec3() - point;
            point + offset * ((height - point.y) / offset.y)
        });
        let all = factor(&lamp, point);
        (
            all - factor(&common_part(&lamp, &shadow, DVec3::NEG_Y), point),
            all,
        )
    }
}

/// Form factor from a point of the floor to a polygon above it that looks down: Lambert's contour sum.
fn factor(polygon: &[DVec3], point: DVec3) -> f64 {
    let n = polygon.len();
    let terms = (0..n).map(|i| {
        let (a, b) = (polygon[i] - point, polygon[(i + 1) % n] - point);
        let across = a.cross(b);
        let length = across.length();
        if length < 1e-14 {
            0.0
        } else {
            length.atan2(a.dot(b)) * across.y / length
        }
    });
    (terms.sum::<f64>() / core::f64::consts::TAU).abs()
}

/// A mesh's elements on the floor and its error in the penumbra.
#[derive(Debug, Clone, Copy)]
struct Quality {
    elements: usize,
    error: f64,
}

fn quality(stage: &Stage, options: PatchOptions) -> Quality {
    let mesh = PatchMesh::build(Arc::new(stage.scene()), options).expect("it can be cut");
    let floor = |e: &usize| mesh.node(mesh.elements()[*e]).centroid.y < 0.5;
    const ACROSS: usize = 160;
    let (mut sum, mut count) = (0.0, 0);
    for i in 0..ACROSS * ACROSS {
        let along = |k: usize| ((k as f32 + 0.5) / ACROSS as f32 * 2.0 - 1.0) * FLOOR;
        let point = Vec3::new(along(i % ACROSS), 0.0, along(i / ACROSS));
        let (exact, free) = stage.irradiance(point.as_dvec3());
        if exact > 1e-9 && exact < free - 1e-9 {
            sum += (interpolated(stage, &mesh, point) - exact).powi(2);
            count += 1;
        }
    }
    Quality {
        elements: (0..mesh.elements().len()).filter(floor).count(),
        error: (sum / f64::from(count)).sqrt(),
    }
}

/// Light at a point from that at the corners of its element, drawn as a fan of triangles.
fn interpolated(stage: &Stage, mesh: &PatchMesh, point: Vec3) -> f64 {
    let element = mesh
        .element_at(0, Side::Front, point)
        .expect("a point of the floor");
    let polygon = mesh.polygon(mesh.elements()[element]);
    let flat = |p: Vec3| DVec2::new(f64::from(p.x), f64::from(p.z));
    let at = flat(point);
    let weights = |i: usize| {
        let [a, b, c] = [0, i, i + 1].map(|k| flat(polygon[k]));
        let area = (b - a).perp_dot(c - a);
        let weight = |p: DVec2, q: DVec2| (p - at).perp_dot(q - at) / area;
        ([0, i, i + 1], [weight(b, c), weight(c, a), weight(a, b)])
    };
    let least = |w: &[f64; 3]| w[0].min(w[1]).min(w[2]);
    let triangles = (1..polygon.len() - 1).map(weights);
    let (corners, weights) = triangles
        .max_by(|a, b| least(&a.1).total_cmp(&least(&b.1)))
        .expect("a triangle");
    let light = |k: usize| stage.irradiance(polygon[k].as_dvec3()).0;
    (0..3).map(|i| light(corners[i]) * weights[i]).sum()
}

/// How many elements a uniform mesh takes for an error, between those that were tried.
fn uniform_elements(curve: &[Quality], error: f64) -> f64 {
    let finer = curve
        .iter()
        .position(|q| q.error <= error)
        .expect("a mesh is fine enough");
    let (coarse, fine) = (curve[finer.max(1) - 1], curve[finer.max(1)]);
    let share = (coarse.error / error).ln() / (coarse.error / fine.error).ln();
    coarse.elements as f64 * (fine.elements as f64 / coarse.elements as f64).powf(share)
}

#[test]
fn the_closed_form_agrees_with_sampling() {
    let stage = Stage::turned(0.3);
    for point in [
        DVec3::new(0.4, 0.0, 0.3),
        DVec3::new(0.9, 0.0, -0.2),
        DVec3::ZERO,
    ] {
        let [a, b, _, d] = stage.lamp.map(|p| p.as_dvec3());
        let [p, q, _, r] = stage.blocker.map(|p| p.as_dvec3());
        const N: usize = 400;
        let mut sum = 0.0;
        for i in 0..N * N {
            let share = |k: usize| (k as f64 + 0.5) / N as f64;
            let offset = a + (b - a) * share(i % N) + (d - a) * share(i / N) - point;
            // Where the ray crosses the blocker's plane, in shares of its edges.
            let at = point + offset * (p.y / offset.y) - p;
            let (u, v) = (
                (q - p) / (q - p).length_squared(),
                (r - p) / (r - p).length_squared(),
            );
            let is_hidden = [at.dot(u), at.dot(v)]
                .iter()
                .all(|s| (0.0..=1.0).contains(s));
            if !is_hidden {
                sum += offset.y * offset.y / offset.length_squared().powi(2);
            }
        }
        let sampled =
            sum * (b - a).cross(d - a).length() / (core::f64::consts::PI * (N * N) as f64);
        let (exact, _) = stage.irradiance(point);
        assert!(
            (sampled - exact).abs() < 1e-4,
            "at {point}: {exact}, sampled {sampled}"
        );
    }
}

#[test]
fn penumbrae_take_a_tenth_of_the_elements() {
    for turn in [0.0, 0.3] {
        let stage = Stage::turned(turn);
        let uniform = |n: f32| {
            let options = PatchOptions::default().with_joints(false);
            quality(&stage, options.with_element_size(2.0 * FLOOR / n))
        };
        let curve: Vec<Quality> = [8.0, 16.0, 32.0, 64.0, 128.0, 256.0].map(uniform).to_vec();
        let size = 2.0 * FLOOR / 8.0;
        let options = PatchOptions::default()
            .with_element_size(size)
            .with_discontinuities(true);
        let cut = quality(&stage, options);
        let times = uniform_elements(&curve, cut.error) / cut.elements as f64;
        println!("turned by {turn}: {curve:?}; cut {cut:?}: {times:.1} x fewer");
        assert!(
            times >= 10.0,
            "turned by {turn}: {times:.1} times fewer elements, {cut:?}"
        );
    }
}
