//! Environment maps' projections: round trips, exact solid angles, gradients, seams.

use core::f64::consts::PI;
use glam::{Vec2, Vec3};
use hemicube_raster::environment::{
    EnvironmentMap, Layout, Projection, projection_of_size, reflected,
};
use hemicube_raster::{Image, Rgb};
use proptest::prelude::*;

/// Directions spread evenly (Fibonacci lattice).
fn directions(n: u32) -> impl Iterator<Item = Vec3> {
    (0..n).map(move |i| {
        let y = 1.0 - (2 * i + 1) as f32 / n as f32;
        let turn = (i as f32 * 2.399_963_2) % (2.0 * core::f32::consts::PI);
        let rho = (1.0 - y * y).sqrt();
        Vec3::new(rho * turn.cos(), y, rho * turn.sin())
    })
}

#[test]
fn directions_go_there_and_back() {
    for projection in Projection::ALL {
        for d in directions(20_000) {
            let Some((face, at)) = projection.coordinates(d) else {
                assert!(
                    !projection.covers_sphere() && d.z > 0.0,
                    "{projection}: {d}"
                );
                continue;
            };
            assert!(face < projection.faces(), "{projection}: face {face}");
            assert!(
                at.min_element() >= 0.0 && at.max_element() <= 1.0,
                "{projection}: {at}"
            );
            let back = projection.direction(face, at);
            assert!((back.length() - 1.0).abs() < 1e-5, "{projection}: {back}");
            // Towards the rim of these many directions share few digits.
            let digits = match projection {
                Projection::Sphere | Projection::Hemispherical => 3e-4,
                _ => 3e-6,
            };
            assert!(
                back.distance(d) < digits,
                "{projection}: {d} came back as {back}"
            );
        }
    }
}

#[test]
fn axes_are_where_the_documentation_says() {
    let (ahead, right, up) = (Vec3::NEG_Z, Vec3::X, Vec3::Y);
    let middle = Vec2::splat(0.5);
    let at = |projection: Projection, d: Vec3| projection.coordinates(d).expect("a place");
    let close = |a: (usize, Vec2), b: (usize, Vec2)| {
        assert!(a.0 == b.0 && a.1.distance(b.1) < 1e-6, "{a:?} is not {b:?}");
    };
    use Projection as P;
    close(at(P::Cube, ahead), (4, middle));
    close(at(P::Cube, -ahead), (5, middle));
    close(at(P::Cube, right), (0, middle));
    close(at(P::Cube, up), (2, middle));
    close(at(P::LatLong, ahead), (0, middle));
    close(at(P::LatLong, right), (0, Vec2::new(0.75, 0.5)));
    assert!(at(P::LatLong, up).1.y < 1e-6, "zenith above");
    close(at(P::Sphere, -ahead), (0, middle));
    let rim = 0.5 + 0.5 * 0.5_f32.sqrt();
    close(at(P::Sphere, right), (0, Vec2::new(rim, 0.5)));
    close(at(P::Sphere, up), (0, Vec2::new(0.5, 1.0 - rim)));
    close(at(P::Angular, ahead), (0, middle));
    close(at(P::Angular, right), (0, Vec2::new(0.75, 0.5)));
    close(at(P::Angular, up), (0, Vec2::new(0.5, 0.25)));
    close(at(P::Fisheye, up), (0, Vec2::new(0.5, 0.0)));
    close(at(P::Hemispherical, right), (0, Vec2::new(1.0, 0.5)));
    close(at(P::Paraboloid, ahead), (0, middle));
    close(at(P::Paraboloid, -ahead), (1, middle));
    close(at(P::Octahedral, up), (0, middle));
    close(at(P::Octahedral, right), (0, Vec2::new(1.0, 0.5)));
    close(at(P::Octahedral, ahead), (0, Vec2::new(0.5, 1.0)));
    // An eye that looks at any face sees what is at its right at the right of the picture.
    for (projection, face) in [
        (P::Cube, 0),
        (P::Cube, 2),
        (P::Cube, 5),
        (P::Paraboloid, 1),
        (P::LatLong, 0),
    ] {
        let [s, t] = projection.gradient(projection.direction(face, Vec2::new(0.45, 0.55)));
        let forward = projection.direction(face, Vec2::new(0.45, 0.55));
        assert!(
            s.cross(-t).dot(-forward) > 0.0,
            "{projection} {face} is mirrored"
        );
    }
}

/// Ties go z before y before x, as interfaces demand.
#[test]
fn ties_of_a_cube_go_to_z_then_y() {
    let face = |x: f32, y: f32, z: f32| {
        Projection::Cube
            .coordinates(Vec3::new(x, y, z))
            .expect("a face")
            .0
    };
    assert_eq!(face(1.0, 1.0, 1.0), 5, "corner");
    assert_eq!(face(1.0, -1.0, -1.0), 4, "corner");
    assert_eq!(face(1.0, 1.0, 0.5), 2, "edge of x and y");
    assert_eq!(face(-1.0, 0.5, 1.0), 5, "edge of x and z");
}

#[test]
fn nothing_is_no_direction() {
    for projection in Projection::ALL {
        for d in [Vec3::ZERO, Vec3::NAN, Vec3::splat(f32::INFINITY)] {
            assert_eq!(projection.coordinates(d), None, "{projection}: {d}");
        }
    }
}

#[test]
fn singular_directions_have_a_place() {
    for projection in Projection::ALL.into_iter().filter(|p| p.covers_sphere()) {
        for d in [Vec3::Z, Vec3::NEG_Z, Vec3::Y, Vec3::NEG_Y] {
            let (face, at) = projection.coordinates(d).expect("a place");
            let back = projection.direction(face, at);
            assert!(
                back.distance(d) < 1e-3,
                "{projection}: {d} came back as {back}"
            );
            let gradient = projection.gradient(d);
            assert!(
                gradient.iter().all(|g| g.is_finite()),
                "{projection}: {gradient:?}"
            );
        }
    }
}

#[test]
fn solid_angles_sum_to_what_is_covered() {
    for projection in Projection::ALL {
        for rows in [1, 2, 3, 5, 16, 33, 64] {
            let map = EnvironmentMap::from_fn(projection, rows, 1, |_| Rgb::WHITE);
            let faces = projection.faces() as f64;
            let sum: f64 = faces * map.solid_angles().iter().sum::<f64>();
            let error = sum / projection.covered() - 1.0;
            assert!(error.abs() < 1e-12, "{projection} of {rows} rows: {error}");
        }
    }
}

#[test]
fn texels_of_a_sphere_map_are_equally_large() {
    let size = (64, 64);
    let texel = |x, y| Projection::Sphere.texel_solid_angle(size, x, y);
    let wanted = 4.0 * (2.0_f64 / 64.0).powi(2);
    for (x, y) in [(32, 32), (10, 20), (40, 5), (2, 30)] {
        assert!(
            (texel(x, y) / wanted - 1.0).abs() < 1e-12,
            "texel ({x}, {y})"
        );
    }
    assert_eq!(texel(0, 0), 0.0, "outside the disc");
}

#[test]
fn texels_of_a_cube_differ_by_4_51() {
    let texel = |x, y| Projection::Cube.texel_solid_angle((16, 16), x, y);
    let ratio = texel(7, 7) / texel(0, 0);
    assert!((ratio - 4.51).abs() < 0.005, "middle by corner: {ratio}");
}

/// Against the density, integrated over fine rectangles.
#[test]
fn solid_angles_are_integrals_of_the_density() {
    for projection in Projection::ALL {
        for [x, y] in [[3, 4], [7, 2], [9, 9], [4, 12], [0, 8]] {
            let exact = projection.texel_solid_angle((16, 16), x, y);
            let n = 64;
            let mut sum = 0.0;
            for i in 0..n * n {
                let share = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
                let at = (Vec2::new(x as f32, y as f32) + share) / 16.0;
                let is_outside = |p: Projection| {
                    let disc = !matches!(
                        p,
                        Projection::Cube | Projection::LatLong | Projection::Octahedral
                    );
                    disc && (2.0 * at - 1.0).length() > 1.0
                };
                if !is_outside(projection) {
                    sum += f64::from(projection.density(at)) / (256 * n * n) as f64;
                }
            }
            // The rim is found to a 64th of a texel; the density of a hemispherical one is infinite there.
            let tolerance = if x == 0 { 0.03 } else { 2e-3 };
            assert!(
                (sum - exact).abs() <= tolerance * exact.max(1e-3),
                "{projection} ({x}, {y}): {sum} is not {exact}"
            );
        }
    }
}

proptest! {
    #[test]
    fn gradients_are_derivatives(x in -1.0_f32..1.0, y in -1.0_f32..1.0, z in -1.0_f32..1.0, turn in 0.0_f32..6.3) {
        prop_assume!(Vec3::new(x, y, z).length() > 0.1);
        let d = Vec3::new(x, y, z).normalize();
        let (u, v) = d.any_orthonormal_pair();
        let step = (u * turn.cos() + v * turn.sin()) * 2e-3;
        for projection in Projection::ALL {
            let places = [(d - step).normalize(), (d + step).normalize()].map(|d| projection.coordinates(d));
            let [Some((a, from)), Some((b, to))] = places else { continue };
            let change = to - from;
            let [s, t] = projection.gradient(d).map(|g| g.dot(2.0 * step));
            // Seams and folds have no derivative; near singular directions it changes within the step.
            let is_steep = projection.gradient(d).iter().any(|g| g.length() > 1.5);
            let is_folded = projection == Projection::Octahedral && d.abs().min_element() < 5e-3;
            if a == b && !is_steep && !is_folded && change.length() < 0.1 {
                prop_assert!((change - Vec2::new(s, t)).length() < 3e-5, "{projection} at {d}: {change} is not ({s}, {t})");
            }
        }
    }
}

#[test]
fn texel_centres_are_returned_exactly() {
    for projection in Projection::ALL {
        let map = EnvironmentMap::from_fn(projection, 8, 1, |d| Rgb::new(d.x, d.y, d.z));
        for face in 0..projection.faces() {
            for y in 0..map.height() {
                for x in 0..map.width() {
                    let inside =
                        map.projection()
                            .texel_solid_angle((map.width(), map.height()), x, y);
                    let d = map.direction(face, x, y);
                    if inside > 0.7 * projection.covered() / (64.0 * projection.faces() as f64) {
                        let found = map.radiance(d);
                        let wanted = map.texel(face, x, y);
                        let difference = (found - wanted).map(f32::abs).max_band();
                        assert!(
                            difference < 2e-3,
                            "{projection}, texel ({x}, {y}): {found:?} {wanted:?}"
                        );
                    }
                }
            }
        }
    }
}

/// Bilinear light has no jump anywhere, edges and corners of faces and poles included.
#[test]
fn light_has_no_seams() {
    use Projection as P;
    for projection in [P::Cube, P::LatLong, P::Paraboloid, P::Octahedral] {
        let size = 16;
        // Hash of the texel: neighbours differ as much as can be.
        let mut seed = 1_u32;
        let noise = EnvironmentMap::from_fn(projection, size, 1, |_| Rgb::BLACK).map(|_| {
            seed = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            Rgb::splat((seed >> 16) as f32 / 65_536.0)
        });
        let mut worst: f32 = 0.0;
        for d in directions(200_000) {
            for side in [Vec3::X, Vec3::Y, Vec3::Z] {
                let step = 1e-4 * side.cross(d);
                // A seam lies between two directions that fall into different faces, or far apart in one.
                let change = (noise.radiance(d) - noise.radiance((d + step).normalize()))
                    .r
                    .abs();
                let steepest = projection
                    .gradient(d)
                    .iter()
                    .map(|g| g.length())
                    .fold(0.0, f32::max);
                worst = worst.max(change - 2.0 * steepest * 1e-4 * 32.0);
            }
        }
        // Two paraboloids meet with texels that lie a little askew.
        let allowed = if projection == P::Paraboloid {
            0.7
        } else {
            0.004
        };
        assert!(worst < allowed, "{projection}: a jump of {worst}");
    }
}

/// What is missing at a corner of a cube is the mean of the three texels that are there (measured on lavapipe: 7, 37/3, 14).
#[test]
fn corner_of_a_cube_is_the_mean_of_three() {
    let faces = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0].map(|v| Image::filled(1, 1, Rgb::splat(v)));
    let map = EnvironmentMap::new(Projection::Cube, &faces).expect("a cube");
    for (d, wanted) in [
        (Vec3::new(1.0, 1.0, -1.0), 7.0),
        (Vec3::new(1.0, -1.0, 1.0), 41.0 / 3.0),
        (Vec3::new(1.0, 1.0, 1.0), 37.0 / 3.0),
        (Vec3::new(-1.0, -1.0, 1.0), 14.0),
    ] {
        let found = map.radiance(d).r;
        assert!(
            (found - wanted).abs() < 1e-4,
            "{d}: {found} is not {wanted}"
        );
    }
}

#[test]
fn a_mirror_shows_what_is_behind_the_eye() {
    assert_eq!(reflected(Vec3::Z, Vec3::Z), Vec3::Z, "straight back");
    let to_eye = Vec3::new(1.0, 1.0, 0.0).normalize();
    let found = reflected(Vec3::Y, to_eye);
    assert!(
        found.distance(Vec3::new(-1.0, 1.0, 0.0).normalize()) < 1e-6,
        "{found}"
    );
}

#[test]
fn doors_refuse_what_is_no_map() {
    let square = Image::filled(4, 4, Rgb::WHITE);
    let of = |projection, faces: &[Image<Rgb>]| EnvironmentMap::new(projection, faces);
    let wide = Image::filled(8, 4, Rgb::WHITE);
    let nan = Image::filled(4, 4, Rgb::splat(f32::NAN));
    for (projection, faces) in [
        (Projection::Cube, vec![square.clone(); 5]),
        (Projection::Cube, vec![wide.clone(); 6]),
        (Projection::Sphere, vec![wide.clone()]),
        (
            Projection::Paraboloid,
            vec![square.clone(), Image::filled(8, 8, Rgb::WHITE)],
        ),
        (Projection::Octahedral, vec![nan]),
        (Projection::LatLong, vec![Image::filled(0, 0, Rgb::WHITE)]),
        (Projection::LatLong, vec![]),
    ] {
        let error = of(projection, &faces).expect_err("no map").to_string();
        assert!(!error.contains('\n') && !error.is_empty(), "{error}");
    }
    assert!(of(Projection::LatLong, &[wide]).is_ok(), "8 x 4");
    let furnace = 4.0 * PI;
    let flux = of(Projection::Octahedral, &[square]).expect("a map").flux();
    assert!((flux[0] - furnace).abs() < 1e-12, "{flux:?}");
}

#[test]
fn layouts_go_there_and_back() {
    for projection in Projection::ALL {
        let map = EnvironmentMap::from_fn(projection, 6, 1, |d| Rgb::new(d.x, d.y, d.z));
        for layout in Layout::ALL.into_iter().filter(|l| l.fits(projection)) {
            let image = map.to_image(layout);
            let back = EnvironmentMap::from_image(projection, &image).expect("its own picture");
            assert_eq!(back, map, "{projection} as {layout}");
            if projection == Projection::Cube {
                let found = projection_of_size(image.width(), image.height());
                assert_eq!(
                    found,
                    Some(projection),
                    "{layout} of {} x {}",
                    image.width(),
                    image.height()
                );
            }
        }
    }
    let odd = Image::filled(30, 7, Rgb::WHITE);
    assert!(
        EnvironmentMap::from_image(Projection::Cube, &odd).is_err(),
        "30 x 7"
    );
}

/// In a cross neighbours on the sheet are neighbours on the sphere, without a jump.
#[test]
fn faces_of_a_cross_join() {
    let n = 32;
    let map = EnvironmentMap::from_fn(Projection::Cube, n, 1, |d| Rgb::new(d.x, d.y, d.z));
    for layout in [Layout::HorizontalCross, Layout::VerticalCross] {
        let image = map.to_image(layout);
        let is_far = |a: Rgb, b: Rgb| {
            a != Rgb::BLACK && b != Rgb::BLACK && (a - b).map(f32::abs).max_band() > 0.1
        };
        for y in 1..image.height() {
            for x in 1..image.width() {
                let here = *image.pixel(x, y);
                assert!(
                    !is_far(here, *image.pixel(x, y - 1)),
                    "{layout}: above ({x}, {y})"
                );
                assert!(
                    !is_far(here, *image.pixel(x - 1, y)),
                    "{layout}: left of ({x}, {y})"
                );
            }
        }
    }
}

#[test]
fn cropped_discs_are_squared() {
    let image = Image::filled(128, 124, Rgb::WHITE);
    let map = EnvironmentMap::from_image(Projection::Fisheye, &image).expect("almost square");
    assert_eq!((map.width(), map.height()), (128, 128), "squared");
    assert_eq!(
        (map.texel(0, 64, 1), map.texel(0, 64, 2)),
        (Rgb::BLACK, Rgb::WHITE),
        "centred"
    );
    let wide = Image::filled(128, 64, Rgb::WHITE);
    assert!(
        EnvironmentMap::from_image(Projection::Fisheye, &wide).is_err(),
        "not square"
    );
}
