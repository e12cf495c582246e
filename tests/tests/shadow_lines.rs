//! Shadow borders of lights without an area against their closed form: the projected edges of a square blocker.

use glam::{DVec3, Vec3};
use hemicube::radiosity::{PatchMesh, PatchOptions};
use hemicube::raster::Rgb;
use hemicube::scene::builtin::SceneBuilder;
use hemicube::scene::{Light, LightKind, Material, Scene, Units};
use std::sync::Arc;

/// Longest edge of the floor's elements, of 4 m in all.
const SIZE: f32 = 0.25;

/// How far a line may be moved, by which elements take no slivers: a hundredth of the longest edge of a cell, a square here.
const MOVED: f64 = 0.0102 * 0.25;

/// A square blocker, turned against the floor's edges.
fn blocker() -> [Vec3; 4] {
    [0.3_f32, 1.87, 3.44, 5.01].map(|angle| Vec3::new(0.5 * angle.cos(), 0.7, 0.5 * angle.sin()))
}

fn scene(light: LightKind) -> Scene {
    let mut builder = SceneBuilder::new("shadow", Units::Radiometric);
    let grey = builder.diffuse("grey", 0.5, 0.5, 0.5);
    let both = builder.material(Material {
        double_sided: true,
        ..Material::diffuse("black", Rgb::BLACK)
    });
    builder.node("floor");
    let at = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    builder.quad(
        grey,
        [at(-2.0, -2.0), at(-2.0, 2.0), at(2.0, 2.0), at(2.0, -2.0)],
    );
    builder.node("blocker");
    builder.quad(both, blocker());
    let mut scene = builder.finish();
    scene.lights.push(Light {
        name: String::from("light"),
        kind: light,
    });
    scene
}

/// Ends of the edges on the floor along which light may jump.
fn borders(light: LightKind) -> Vec<[DVec3; 2]> {
    let options = PatchOptions::default()
        .with_element_size(SIZE)
        .with_joints(false)
        .with_discontinuities(true);
    let mesh = PatchMesh::build(Arc::new(scene(light)), options).expect("a mesh");
    let at = |v: u32| mesh.vertices()[v as usize].as_dvec3();
    let edges = mesh.hard_edges().iter().map(|&(a, b)| [at(a), at(b)]);
    edges
        .filter(|ends| ends.iter().all(|p| p.y.abs() < 1e-5))
        .collect()
}

fn distance(point: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let along = b - a;
    let share = (point - a).dot(along) / along.length_squared();
    point.distance(a + along * share.clamp(0.0, 1.0))
}

/// That the borders are the outline of a shadow, all of it and nothing else.
fn assert_outline(name: &str, borders: &[[DVec3; 2]], shadow: [DVec3; 4]) {
    let sides: Vec<[DVec3; 2]> = (0..4).map(|i| [shadow[i], shadow[(i + 1) % 4]]).collect();
    let off = |p: DVec3| {
        let distances = sides.iter().map(|&side| distance(p, side));
        distances.fold(f64::INFINITY, f64::min)
    };
    let worst = borders
        .iter()
        .flatten()
        .map(|&p| off(p))
        .fold(0.0, f64::max);
    assert!(
        worst <= MOVED,
        "{name}: an end is {worst:.5} off the outline"
    );
    // However far along a side, a border passes there.
    for (i, &[a, b]) in sides.iter().enumerate() {
        for k in 0..=50 {
            let point = a.lerp(b, f64::from(k) / 50.0);
            let distances = borders.iter().map(|&border| distance(point, border));
            let nearest = distances.fold(f64::INFINITY, f64::min);
            assert!(
                nearest <= MOVED,
                "{name}: side {i} has a gap of {nearest:.4}"
            );
        }
    }
}

/// The blocker's corners, seen from a point, on the floor.
fn projected_from(light: DVec3) -> [DVec3; 4] {
    blocker().map(|corner| {
        let offset = corner.as_dvec3() - light;
        light + offset * (light.y / -offset.y)
    })
}

#[test]
fn of_a_point_the_border_is_a_larger_square() {
    for position in [Vec3::new(0.0, 2.0, 0.0), Vec3::new(0.4, 1.6, -0.3)] {
        let light = LightKind::Point {
            position,
            intensity: Rgb::splat(1.0),
        };
        let shadow = projected_from(position.as_dvec3());
        assert_outline("point", &borders(light), shadow);
    }
}

#[test]
fn of_the_sun_it_is_the_same_square_moved() {
    let direction = Vec3::new(0.3, -1.0, 0.2).normalize();
    let light = LightKind::Directional {
        direction,
        irradiance: Rgb::splat(1.0),
    };
    let way = direction.as_dvec3();
    let shadow = blocker().map(|corner| {
        let corner = corner.as_dvec3();
        corner - way * (corner.y / way.y)
    });
    // Its rays are parallel to a ten-thousandth.
    assert_outline("sun", &borders(light), shadow);
}

#[test]
fn of_a_spot_it_is_that_of_a_point() {
    let position = Vec3::new(-0.3, 1.8, 0.2);
    let light = LightKind::Spot {
        position,
        direction: Vec3::NEG_Y,
        intensity: Rgb::splat(1.0),
        inner_angle: 0.8,
        outer_angle: 1.0,
    };
    let shadow = projected_from(position.as_dvec3());
    assert_outline("spot", &borders(light), shadow);
}
