//! Two-part mapping against inverse maps, marched rays, differences and closed forms.

use core::f32::consts::{FRAC_PI_2, PI};
use glam::{Quat, Vec2, Vec3};
use hemicube_raster::two_part::{
    BoxLayout, Distortion, DistortionSummary, OMap, SMap, SphereLayout, SurfacePoint, TwoPart,
    surface_frame,
};
use proptest::prelude::*;

const HALF: Vec3 = Vec3::new(1.5, 1.0, 2.0);

/// Every S map in every layout.
const S_MAPS: [SMap; 8] = [
    SMap::Plane {
        distance: 1.75,
        width: 3.0,
        height: 2.0,
    },
    SMap::cylinder(1.5, 3.0),
    SMap::Cylinder {
        radius: 1.5,
        height: 3.0,
        caps: false,
    },
    SMap::sphere(2.0),
    SMap::Sphere {
        radius: 2.0,
        layout: SphereLayout::HEMISPHERE,
    },
    SMap::Sphere {
        radius: 2.0,
        layout: SphereLayout::Stereographic { edge: 2.5 },
    },
    SMap::Box {
        half: HALF,
        layout: BoxLayout::EachFace,
    },
    SMap::Box {
        half: HALF,
        layout: BoxLayout::Cross,
    },
];

const O_MAPS: [OMap; 4] = [
    OMap::ReflectedRay,
    OMap::ObjectNormal,
    OMap::Centroid(Vec3::new(0.1, -0.05, 0.02)),
    OMap::IntermediateNormal,
];

fn all_pairs() -> impl Iterator<Item = TwoPart> {
    S_MAPS
        .into_iter()
        .flat_map(|s| O_MAPS.map(|o| TwoPart::new(s, o)))
}

/// Whether a point is inside of the closed surface; `None` for a plane.
fn is_inside(s: SMap, p: Vec3) -> Option<bool> {
    match s {
        SMap::Plane { .. } => None,
        SMap::Cylinder {
            radius,
            height,
            caps,
        } => Some(p.x.hypot(p.z) < radius && (!caps || p.y.abs() < 0.5 * height)),
        SMap::Sphere { radius, .. } => Some(p.length() < radius),
        SMap::Box { half, .. } => Some(p.abs().cmplt(half).all()),
    }
}

fn unit() -> impl Strategy<Value = Vec3> {
    (-1.0_f32..1.0, 0.0_f32..core::f32::consts::TAU).prop_map(|(y, angle)| {
        let r = (1.0 - y * y).sqrt();
        Vec3::new(r * angle.cos(), y, r * angle.sin())
    })
}

/// A point inside of all closed surfaces.
fn inner() -> impl Strategy<Value = Vec3> {
    (unit(), 0.05_f32..0.95).prop_map(|(direction, r)| direction * r)
}

proptest! {
    #[test]
    fn s_map_and_its_inverse_agree(u in 0.02_f32..0.98, v in 0.02_f32..0.98, face in 0_usize..6) {
        for s in S_MAPS {
            let face = face % s.faces();
            let mut texcoord = Vec2::new(u, v);
            if matches!(s, SMap::Cylinder { .. }) && face > 0 {
                // The corners of a cap's texture lie outside of the disc.
                texcoord = Vec2::splat(0.5) + (texcoord - 0.5) * 0.7;
            }
            if matches!(s, SMap::Box { layout: BoxLayout::Cross, .. }) {
                let corner = [[2, 1], [0, 1], [1, 0], [1, 2], [1, 1], [3, 1]][face].map(f32::from as fn(u8) -> f32);
                texcoord = (texcoord + Vec2::from(corner)) / Vec2::new(4.0, 3.0);
            }
            let point = s.point(texcoord, face).expect("a point of the texture");
            let centroid = TwoPart::new(s, OMap::Centroid(Vec3::ZERO));
            let (found, found_face) = centroid.texcoord(point * 0.3, Vec3::ZERO, Vec3::ZERO).expect("from the centre");
            prop_assert_eq!(found_face, face, "{:?}", s);
            prop_assert!((found - texcoord).length() < 2e-5, "{:?}: {} for {}", s, found, texcoord);
            if matches!(s, SMap::Cylinder { .. }) && face > 0 {
                continue;
            }
            let foot = TwoPart::new(s, OMap::IntermediateNormal);
            let (found, found_face) = foot.texcoord(point, Vec3::ZERO, Vec3::ZERO).expect("its own normal");
            prop_assert_eq!(found_face, face, "{:?}", s);
            prop_assert!((found - texcoord).length() < 2e-5, "{:?}: {} for {}", s, found, texcoord);
        }
    }

    #[test]
    fn rays_leave_where_marching_says(point in inner(), direction in unit()) {
        for s in S_MAPS {
            let Some(true) = is_inside(s, point) else { continue };
            let mapping = TwoPart::new(s, OMap::ObjectNormal);
            let surface = SurfacePoint::new(point, direction, Vec3::ZERO);
            let inside = |t: f64| is_inside(s, (point.as_dvec3() + direction.as_dvec3() * t).as_vec3()) == Some(true);
            let step = 0.01;
            let Some(i) = (1_u16..2000).find(|&i| !inside(step * f64::from(i))) else { continue };
            let (mut near, mut far) = (step * f64::from(i - 1), step * f64::from(i));
            for _ in 0..30 {
                let middle = 0.5 * (near + far);
                if inside(middle) { near = middle } else { far = middle }
            }
            let expected = (point.as_dvec3() + direction.as_dvec3() * (0.5 * (near + far))).as_vec3();
            let trace = mapping.trace(&surface).expect("rays from inside leave");
            // A grazing ray moves far along the surface for a rounded inside test.
            prop_assert!((trace.to - expected).length() < 1e-3, "{:?}: {} for {}", s, trace.to, expected);
        }
    }

    #[test]
    fn derivatives_are_those_of_small_steps(
        point in inner(), normal in unit(), view in unit(), a in unit(), b in unit(), c in unit(),
    ) {
        // Away from grazing rays, poles and axes, where second derivatives have no bound.
        prop_assume!(point.x.hypot(point.z) > 0.2 && normal.x.hypot(normal.z) > 0.2 && normal.dot(view) > 0.2);
        prop_assume!((point - Vec3::new(0.1, -0.05, 0.02)).length() > 0.2);
        let surface = SurfacePoint {
            point, normal, view, d_point: [a, b], d_normal: [b, c], d_view: [c, a],
        };
        for mapping in all_pairs() {
            let Some(here) = mapping.map(&surface) else { continue };
            for k in 0..2 {
                let at = |h: f32| mapping.texcoord(
                    point + surface.d_point[k] * h, normal + surface.d_normal[k] * h, view + surface.d_view[k] * h);
                let h = 2e-3;
                let (Some((after, f1)), Some((before, f0))) = (at(h), at(-h)) else { continue };
                if f0 != here.face || f1 != here.face { continue }
                let mut step = after - before;
                if matches!(mapping.s, SMap::Cylinder { .. } | SMap::Sphere { layout: SphereLayout::LatLong, .. }) {
                    step.x -= step.x.round();
                }
                let difference = step / (2.0 * h);
                let scale = 1.0 + here.d_texcoord[k].length().powi(3) + here.texcoord.length().powi(3);
                prop_assert!((difference - here.d_texcoord[k]).length() < 0.02 * scale,
                    "{:?} {}: {} for {}", mapping, k, here.d_texcoord[k], difference);
            }
        }
    }

    #[test]
    fn coordinates_go_on_smoothly_except_at_seams(point in inner(), normal in unit(), view in unit(), a in unit()) {
        let moved = |v: Vec3| v + a * 1e-4;
        for mapping in all_pairs() {
            let here = mapping.map(&SurfacePoint::new(point, normal, view));
            let there = mapping.map(&SurfacePoint::new(moved(point), moved(normal), moved(view)));
            let (Some(here), Some(there)) = (here, there) else { continue };
            let step = there.texcoord - here.texcoord;
            let is_seam = here.face != there.face || step.x.abs() > 0.9;
            let is_far = here.texcoord.length() > 3.0 || point.x.hypot(point.z) < 0.1
                || (point - Vec3::new(0.1, -0.05, 0.02)).length() < 0.1
                || normal.x.hypot(normal.z) < 0.1
                || mapping.trace(&SurfacePoint::new(point, normal, view)).is_some_and(|t| t.to.x.hypot(t.to.z) < 0.1)
                || matches!(mapping.s, SMap::Plane { .. }) && here.texcoord.length() > 2.0;
            prop_assert!(is_seam || is_far || step.length() < 0.02, "{:?}: {} at {}", mapping, step, here.texcoord);
        }
    }

    #[test]
    fn turning_everything_changes_nothing(
        point in inner(), normal in unit(), view in unit(), axis in unit(), angle in 0.0_f32..6.0, center in inner(),
    ) {
        let turn = Quat::from_axis_angle(axis, angle);
        for mapping in all_pairs() {
            let Some((before, face)) = mapping.texcoord(point, normal, view) else { continue };
            let o = match mapping.o {
                OMap::Centroid(c) => OMap::Centroid(turn * c + center),
                other => other,
            };
            let moved = TwoPart::new(mapping.s, o).with_center(center).with_rotation(turn);
            let after = moved.texcoord(turn * point + center, turn * normal, turn * view);
            let Some((after, after_face)) = after else {
                prop_assert!(before.length() > 100.0, "{mapping:?} has lost its texture");
                continue;
            };
            let mut step = after - before;
            step.x -= if step.x.abs() > 0.9 { step.x.round() } else { 0.0 };
            let scale = 1.0 + before.length_squared() * 10.0;
            prop_assert!(face != after_face || step.length() < 2e-3 * scale, "{mapping:?}: {after} for {before}");
        }
    }

    #[test]
    fn any_numbers_give_finite_coordinates_or_none(
        numbers in prop::collection::vec(prop_oneof![any::<f32>(), -2.0_f32..2.0, Just(0.0)], 30),
        sizes in prop::array::uniform3(prop_oneof![any::<f32>(), 0.0_f32..2.0]),
    ) {
        let vector = |i: usize| Vec3::new(numbers[i], numbers[i + 1], numbers[i + 2]);
        let surface = SurfacePoint {
            point: vector(0), normal: vector(3), view: vector(6),
            d_point: [vector(9), vector(12)], d_normal: [vector(15), vector(18)], d_view: [vector(21), vector(24)],
        };
        let [a, b, c] = sizes;
        let odd = [
            SMap::Plane { distance: a, width: b, height: c },
            SMap::Cylinder { radius: a, height: b, caps: c > 0.5 },
            SMap::Sphere { radius: a, layout: SphereLayout::Stereographic { edge: b } },
            SMap::Box { half: Vec3::new(a, b, c), layout: BoxLayout::Cross },
        ];
        for s in S_MAPS.into_iter().chain(odd) {
            for o in O_MAPS.into_iter().chain([OMap::Centroid(vector(27))]) {
                if let Some(mapped) = TwoPart::new(s, o).map(&surface) {
                    prop_assert!(mapped.texcoord.is_finite() && mapped.face < s.faces());
                    prop_assert!(mapped.d_texcoord[0].is_finite() && mapped.d_texcoord[1].is_finite());
                }
            }
            let point = s.point(Vec2::new(numbers[0], numbers[1]), 0);
            prop_assert!(point.is_none_or(Vec3::is_finite));
        }
    }

    #[test]
    fn distortion_is_that_of_singular_values(
        a in unit(), b in unit(), sigma in prop::array::uniform2(0.1_f32..4.0), angle in 0.0_f32..6.0, shear in -1.0_f32..1.0,
    ) {
        // A texture map of known singular values, seen through parameters that are neither unit nor at right angles.
        let frame = surface_frame(a);
        let (x, y) = (Vec2::from_angle(angle), Vec2::from_angle(shear));
        let map = |s: Vec2| {
            let turned = x.conjugate_rotate(s) * Vec2::from(sigma);
            y.rotate(turned)
        };
        let coordinates = [Vec2::new(1.0, shear), Vec2::new(0.3, 1.7 + b.x)];
        prop_assume!(coordinates[0].perp_dot(coordinates[1]).abs() > 0.1);
        let d_point = coordinates.map(|s| frame[0] * s.x + frame[1] * s.y);
        let found = Distortion::of(d_point, coordinates.map(map)).expect("a plane");
        let [low, high] = [sigma[0].min(sigma[1]), sigma[0].max(sigma[1])].map(f64::from);
        prop_assert!((found.major - high).abs() < 1e-4 * high, "{found:?} for {high}");
        prop_assert!((found.minor - low).abs() < 1e-3 * high, "{found:?} for {low}");
    }
}

/// `conjugate_rotate`: by the inverse of a rotation.
trait ConjugateRotate {
    fn conjugate_rotate(self, v: Vec2) -> Vec2;
}

impl ConjugateRotate for Vec2 {
    fn conjugate_rotate(self, v: Vec2) -> Vec2 {
        Vec2::new(self.x, -self.y).rotate(v)
    }
}

/// The distortion of a mapping on a sphere of such a radius, at a direction from its centre.
fn on_sphere(mapping: TwoPart, direction: Vec3, radius: f32) -> Distortion {
    let d = surface_frame(direction);
    let mapped = mapping.map(&SurfacePoint {
        d_point: d,
        d_normal: d.map(|d| d / radius),
        d_view: d.map(|d| -d),
        ..SurfacePoint::new(direction * radius, direction, Vec3::Z)
    });
    Distortion::of(d, mapped.expect("a texture").d_texcoord).expect("finite")
}

#[test]
fn stereographic_map_is_conformal() {
    let s = SMap::Sphere {
        radius: 2.0,
        layout: SphereLayout::HEMISPHERE,
    };
    for o in [OMap::Centroid(Vec3::ZERO), OMap::IntermediateNormal] {
        for i in 1_u8..30 {
            let phi = 0.1 * f32::from(i);
            let direction = Vec3::new(phi.sin() * 0.6, phi.cos(), phi.sin() * 0.8);
            let found = on_sphere(TwoPart::new(s, o), direction, 1.0);
            assert!(
                (found.anisotropy() - 1.0).abs() < 1e-3,
                "{found:?} at {phi}"
            );
            // The plane's distances grow as 1 / cos^2(phi/2), and 1 of the texture is 2 of tan(phi/2).
            let expected = 0.25 / f64::from(0.5 * phi).cos().powi(2);
            assert!(
                (found.major / expected - 1.0).abs() < 1e-4,
                "{found:?} for {expected}"
            );
        }
    }
}

#[test]
fn longitude_and_latitude_stretch_by_the_sine() {
    let mapping = TwoPart::new(SMap::sphere(3.0), OMap::ObjectNormal);
    let centroid = TwoPart::new(SMap::sphere(3.0), OMap::Centroid(Vec3::ZERO));
    for i in 1_u8..31 {
        let phi = 0.1 * f32::from(i);
        let direction = Vec3::new(-phi.sin() * 0.8, phi.cos(), phi.sin() * 0.6);
        // On a sphere around the centre, normals are lines from the centroid.
        for mapping in [mapping, centroid] {
            let found = on_sphere(mapping, direction, 1.0);
            let along = 1.0 / (2.0 * f64::from(PI) * f64::from(phi).sin());
            let down = 1.0 / f64::from(PI);
            assert!(
                (found.major / along.max(down) - 1.0).abs() < 1e-4,
                "{found:?} at {phi}"
            );
            assert!(
                (found.minor / along.min(down) - 1.0).abs() < 1e-4,
                "{found:?} at {phi}"
            );
        }
    }
}

#[test]
fn footprints_do_not_see_the_seam() {
    // Two neighbouring points on both sides of the seam at -Z, and on both sides of a box's edge.
    let seam = [SMap::cylinder(1.5, 3.0), SMap::sphere(2.0)];
    let points = [Vec3::new(-1e-4, 0.2, -1.0), Vec3::new(1e-4, 0.2, -1.0)];
    for s in seam {
        for o in [
            OMap::IntermediateNormal,
            OMap::Centroid(Vec3::ZERO),
            OMap::ObjectNormal,
        ] {
            let at = |p: Vec3| {
                let surface = SurfacePoint {
                    d_point: [Vec3::X, Vec3::Y],
                    d_normal: [Vec3::X, Vec3::Y],
                    ..SurfacePoint::new(p, p, Vec3::Z)
                };
                TwoPart::new(s, o).map(&surface).expect("a texture")
            };
            let [left, right] = points.map(at);
            assert!((left.texcoord.x - right.texcoord.x).abs() > 0.99, "u jumps");
            for k in 0..2 {
                let step = left.d_texcoord[k] - right.d_texcoord[k];
                assert!(step.length() < 1e-3, "{s:?} {o:?}: {step}");
                let length = left.d_texcoord[k].length();
                assert!(length < 1.0, "{s:?} {o:?}: a footprint of {length}");
            }
        }
    }
}

#[test]
fn what_is_not_defined_is_none() {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let plane = SMap::plane(2.0);
    let stereographic = SMap::Sphere {
        radius: 1.0,
        layout: SphereLayout::HEMISPHERE,
    };
    let nothing = Vec3::ZERO;
    let cases = [
        (
            "parallel to the plane",
            plane,
            OMap::ObjectNormal,
            [nothing, x, z],
        ),
        (
            "away from the plane",
            plane,
            OMap::ObjectNormal,
            [nothing, -z, z],
        ),
        (
            "no normal",
            plane,
            OMap::ObjectNormal,
            [nothing, nothing, z],
        ),
        (
            "no normal",
            plane,
            OMap::ReflectedRay,
            [nothing, nothing, z],
        ),
        ("no view", plane, OMap::ReflectedRay, [nothing, z, nothing]),
        (
            "in the centroid",
            SMap::sphere(1.0),
            OMap::Centroid(x),
            [x, x, z],
        ),
        (
            "in the centre",
            SMap::sphere(1.0),
            OMap::IntermediateNormal,
            [nothing, x, z],
        ),
        (
            "in the centre",
            SMap::cube(1.0),
            OMap::IntermediateNormal,
            [nothing, x, z],
        ),
        (
            "on the axis",
            SMap::cylinder(1.0, 1.0),
            OMap::IntermediateNormal,
            [y * 0.2, x, z],
        ),
        (
            "pole of projection",
            stereographic,
            OMap::Centroid(nothing),
            [-y, x, z],
        ),
        (
            "no size",
            SMap::sphere(0.0),
            OMap::ObjectNormal,
            [nothing, x, z],
        ),
        (
            "negative size",
            SMap::cylinder(-1.0, 1.0),
            OMap::ObjectNormal,
            [nothing, x, z],
        ),
        (
            "outside, missing it",
            SMap::cube(1.0),
            OMap::ObjectNormal,
            [x * 3.0, y, z],
        ),
        (
            "outside, leaving it",
            SMap::sphere(1.0),
            OMap::ObjectNormal,
            [x * 3.0, x, z],
        ),
    ];
    for (why, s, o, [point, normal, view]) in cases {
        let found = TwoPart::new(s, o).texcoord(point, normal, view);
        assert_eq!(found, None, "{why}: {s:?} {o:?}");
    }
    let endless = SMap::Cylinder {
        radius: 1.0,
        height: 1.0,
        caps: false,
    };
    let along_axis = TwoPart::new(endless, OMap::ObjectNormal);
    assert_eq!(along_axis.texcoord(nothing, y, z), None, "never leaves");
    assert_eq!(plane.point(Vec2::splat(0.5), 1), None, "no such face");
}

#[test]
fn reflected_ray_turns_with_the_eye_and_others_do_not() {
    let (point, normal) = (Vec3::new(0.2, 0.3, 0.4), Vec3::new(0.3, 0.4, 0.866));
    for s in S_MAPS {
        for o in O_MAPS {
            let mapping = TwoPart::new(s, o);
            let at = |view: Vec3| mapping.texcoord(point, normal, view);
            let [a, b] = [at(Vec3::Z), at(Vec3::new(0.3, 0.1, 1.0))];
            assert_eq!(a == b, o != OMap::ReflectedRay, "{s:?} {o:?}");
        }
        // Looked at along its normal a mirror sends the ray back along it.
        let reflected = TwoPart::new(s, OMap::ReflectedRay).texcoord(point, normal, normal);
        let along = TwoPart::new(s, OMap::ObjectNormal).texcoord(point, normal, normal);
        let (Some((reflected, _)), Some((along, _))) = (reflected, along) else {
            panic!("{s:?} is met");
        };
        assert!(
            (reflected - along).length() < 1e-5,
            "{s:?}: {reflected} {along}"
        );
    }
}

#[test]
fn caps_and_faces_are_seen_upright_from_outside() {
    // Right and down in the texture, seen from outside, with the surface's outward direction make a left-handed frame.
    for s in S_MAPS {
        for face in 0..s.faces() {
            let middle = match s {
                SMap::Box {
                    layout: BoxLayout::Cross,
                    ..
                } => {
                    let [column, row]: [u8; 2] =
                        [[2, 1], [0, 1], [1, 0], [1, 2], [1, 1], [3, 1]][face];
                    (Vec2::new(f32::from(column), f32::from(row)) + 0.5) / Vec2::new(4.0, 3.0)
                }
                _ => Vec2::new(0.5, 0.47),
            };
            let at = |d: Vec2| s.point(middle + d, face).expect("a point");
            let (right, down) = (
                at(Vec2::X * 1e-2) - at(Vec2::ZERO),
                at(Vec2::Y * 1e-2) - at(Vec2::ZERO),
            );
            let outward = down.cross(right);
            assert!(outward.dot(at(Vec2::ZERO)) > 0.0, "{s:?}, face {face}");
        }
    }
}

#[test]
fn extents_are_lengths_on_the_surface() {
    for s in S_MAPS {
        for face in 0..s.faces() {
            let middle = match s {
                SMap::Box {
                    layout: BoxLayout::Cross,
                    ..
                } => {
                    Vec2::new(
                        [2.5, 0.5, 1.5, 1.5, 1.5, 3.5][face],
                        [1.5, 1.5, 0.5, 2.5, 1.5, 1.5][face],
                    ) / Vec2::new(4.0, 3.0)
                }
                _ => Vec2::splat(0.5),
            };
            let at = |d: Vec2| s.point(middle + d, face).expect("a point");
            let h = 1e-3;
            let lengths = [Vec2::X, Vec2::Y].map(|d| (at(d * h) - at(-d * h)).length() / (2.0 * h));
            let difference = Vec2::from(lengths) - s.extent(face);
            assert!(
                difference.length() < 1e-2,
                "{s:?}, face {face}: {lengths:?}"
            );
        }
    }
}

#[test]
fn cross_unfolds_without_tearing_the_front() {
    let s = SMap::Box {
        half: HALF,
        layout: BoxLayout::Cross,
    };
    let mapping = TwoPart::new(s, OMap::Centroid(Vec3::ZERO));
    // Over the edges of the front face to each of its four neighbours the texture goes on.
    let edges = [
        Vec3::new(HALF.x, 0.3, HALF.z),
        Vec3::new(-HALF.x, -0.2, HALF.z),
        Vec3::new(0.4, HALF.y, HALF.z),
        Vec3::new(-0.7, -HALF.y, HALF.z),
    ];
    for edge in edges {
        let at = |p: Vec3| mapping.texcoord(p, Vec3::ZERO, Vec3::ZERO).expect("met");
        let (front, face) = at(edge - Vec3::new(edge.x, edge.y, 0.0).normalize() * 1e-4);
        let (side, side_face) = at(edge - Vec3::Z * 1e-4);
        assert_ne!(face, side_face, "two faces meet at {edge}");
        assert!(
            (front - side).length() < 1e-3,
            "{front} and {side} at {edge}"
        );
    }
}

#[test]
fn summary_weighs_by_area() {
    let d = |major, minor| Some(Distortion { major, minor });
    let summary = DistortionSummary::of([(1.0, d(2.0, 1.0)), (3.0, d(4.0, 1.0)), (4.0, None)])
        .expect("some texture");
    assert_eq!(summary.mapped, 0.5);
    assert_eq!(summary.mapped_area, 4.0);
    let mean = 2.0_f64.powf(0.25) * 4.0_f64.powf(0.75);
    for [low, middle, high] in [summary.area, summary.anisotropy] {
        assert_eq!([low, high], [2.0, 4.0]);
        assert!((middle - mean).abs() < 1e-12, "{summary:?}");
    }
    let line = DistortionSummary::of([(1.0, d(1.0, 0.0)), (1.0, d(2.0, 2.0))]).expect("some");
    assert_eq!(line.area, [0.0, 4.0, 4.0]);
    assert_eq!(line.anisotropy, [1.0, 1.0, f64::INFINITY]);
    assert_eq!(DistortionSummary::of([(1.0, None)]), None);
    let squeezed = SphereLayout::Stereographic { edge: FRAC_PI_2 };
    assert_eq!(squeezed, SphereLayout::HEMISPHERE);
}
