//! Clipping against its definition.

use glam::{DVec2, Vec4};
use hemicube_raster::clip::{ClipVertex, clip_triangle};
use proptest::prelude::*;

fn triangle() -> impl Strategy<Value = [ClipVertex<1>; 3]> {
    prop::array::uniform3(
        prop::array::uniform5(-2.0_f32..2.0)
            .prop_map(|[x, y, z, w, a]| ClipVertex::new(Vec4::new(x, y, z, w), [a])),
    )
}

proptest! {
    #[test]
    fn every_corner_lies_within_all_planes(triangle in triangle(), guard in 1.0_f64..4.0) {
        let polygon = clip_triangle(&triangle, DVec2::splat(guard));
        for corner in polygon.corners() {
            let p = corner.position;
            // Later cuts move earlier cut points along their planes, with the rounding of f64.
            let limit = guard * p.w + 1e-12;
            prop_assert!(p.w > 0.0, "w = {}", p.w);
            prop_assert!(p.z >= -1e-12 && p.z <= p.w + 1e-12, "z = {} of w = {}", p.z, p.w);
            prop_assert!(p.x.abs() <= limit && p.y.abs() <= limit, "{} beyond {}", p, limit);
        }
    }

    #[test]
    fn attributes_follow_the_position(mut triangle in triangle(), plane in prop::array::uniform4(-1.0_f32..1.0)) {
        // A linear function of the position stays one.
        let plane = Vec4::from_array(plane);
        for vertex in &mut triangle {
            vertex.attributes = [plane.dot(vertex.position)];
        }
        for corner in clip_triangle(&triangle, DVec2::ONE).corners() {
            let expected = plane.as_dvec4().dot(corner.position);
            // The attributes were rounded to f32.
            prop_assert!((corner.attributes[0] - expected).abs() < 1e-5, "{} instead of {expected}", corner.attributes[0]);
        }
    }
}

#[test]
fn a_triangle_inside_stays_and_one_outside_goes() {
    let at = |x: f32| {
        [(0.0, 0.0), (0.5, 0.0), (0.0, 0.5)]
            .map(|(dx, dy)| ClipVertex::new(Vec4::new(x + dx, dy, 0.5, 1.0), [dx]))
    };
    let inside = clip_triangle(&at(0.0), DVec2::ONE);
    let positions = inside.corners().iter().map(|c| c.position.as_vec4());
    assert!(
        positions.eq(at(0.0).map(|v| v.position)),
        "an inner triangle is changed"
    );
    assert!(
        clip_triangle(&at(2.0), DVec2::splat(9.0))
            .corners()
            .is_empty(),
        "within the guard band but beside the picture"
    );
    let mut broken = at(0.0);
    broken[1].attributes = [f32::NAN];
    assert!(
        clip_triangle(&broken, DVec2::ONE).corners().is_empty(),
        "a NaN attribute"
    );
}

#[test]
fn neighbours_cut_their_common_edge_at_the_same_bits() {
    let [a, b] = [
        Vec4::new(0.3, -0.1, 0.7, 1.1),
        Vec4::new(-0.2, 0.4, -0.9, -0.6),
    ]
    .map(|p| ClipVertex::new(p, []));
    let third = |x, y| ClipVertex::new(Vec4::new(x, y, 0.5, 1.0), []);
    let one = clip_triangle(&[a, b, third(1.0, 0.5)], DVec2::splat(1e3));
    let other = clip_triangle(&[b, a, third(-1.0, 0.5)], DVec2::splat(1e3));
    let shared = one
        .corners()
        .iter()
        .filter(|corner| other.corners().contains(corner))
        .count();
    assert_eq!(shared, 2, "corner a and the cut point of edge ab");
}
