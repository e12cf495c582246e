//! What cannot be is refused, in one line that says what, where and how to mend it.

use glam::{DAffine3, DMat3, DVec3};
use hemicube_csg::{CsgError, Light, Pattern, Sky, Solid};
use hemicube_raster::Rgb;

fn refused<T: core::fmt::Debug>(result: Result<T, CsgError>, word: &str) {
    let line = result.expect_err(word).to_string();
    assert!(
        line.contains(word) && line.contains("give") && !line.contains('\n'),
        "{line}"
    );
}

#[test]
fn measures_that_cannot_be_are_refused() {
    let (o, y) = (DVec3::ZERO, DVec3::Y);
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-7, 1e10] {
        refused(Solid::sphere(o, bad), "sphere: radius");
        refused(Solid::cylinder(o, y, bad), "cylinder: radius");
        refused(Solid::cone(o, bad, y), "cone: radius");
        refused(Solid::torus(o, y, bad, 0.1), "torus: ring radius");
        refused(Solid::torus(o, y, 1.0, bad), "torus: tube radius");
    }
    refused(Solid::frustum(o, 0.0, y, 0.0), "frustum: radius");
    refused(Solid::frustum(o, f64::NAN, y, 1.0), "frustum: radius");
    refused(Solid::frustum(o, 1.0, y, f64::NAN), "frustum: radius");
    refused(Solid::frustum(o, 1.0, y, -1.0), "frustum: radius");
    refused(Solid::cylinder(y, y, 1.0), "cylinder: height");
    refused(
        Solid::cuboid(o, DVec3::new(1.0, 0.0, 1.0)),
        "cuboid: height",
    );
    refused(Solid::torus(o, o, 1.0, 0.1), "torus: axis");
    refused(
        Solid::torus(o, y, 1e9, 1e-6),
        "torus: tube radius / ring radius",
    );
    refused(Solid::half_space(o, DVec3::NAN), "half-space: normal");
    refused(Solid::sphere(DVec3::NAN, 1.0), "sphere: centre");
    refused(Solid::cone(o, 1.0, DVec3::INFINITY), "cone: end");
}

#[test]
fn transforms_that_flatten_are_refused() {
    let ball = || Solid::sphere(DVec3::ZERO, 1.0).expect("a ball");
    refused(ball().scaled(DVec3::new(1.0, 0.0, 1.0)), "transform");
    refused(ball().scaled(DVec3::NAN), "transform");
    refused(ball().scaled(DVec3::splat(1e200)), "transform");
    refused(ball().moved(DVec3::INFINITY), "transform");
    refused(ball().turned(DVec3::ZERO, 1.0), "turn: axis");
    refused(ball().turned(DVec3::Y, f64::NAN), "transform");
    let flat = DMat3::from_cols_array(&[1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 0.0, 1.0]);
    refused(ball().transformed(DAffine3::from_mat3(flat)), "transform");
    // Harmless one by one, out of reach together.
    let mut solid = Ok(ball());
    for _ in 0..10 {
        solid = solid.and_then(|s| s.scaled(DVec3::splat(1e3)));
    }
    refused(solid, "transform");
}

#[test]
fn light_that_cannot_be_is_refused() {
    refused(
        Light::point(DVec3::ZERO, Rgb::splat(-1.0)),
        "point light: intensity",
    );
    refused(
        Light::distant(DVec3::ZERO, Rgb::WHITE),
        "distant light: direction",
    );
    refused(
        Light::distant(DVec3::X, Rgb::splat(f32::NAN)),
        "distant light: irradiance",
    );
    refused(Sky::even(Rgb::splat(f32::INFINITY)), "sky: radiance");
    refused(Pattern::plain(Rgb::splat(1.5)), "red");
    refused(Pattern::wood(Rgb::WHITE, Rgb::BLACK, 0.0), "wood: ring");
}
