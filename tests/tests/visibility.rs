//! Visibility against every triangle, against obvhs, and where gaps would be.

use glam::{Vec3, Vec3A};
use hemicube::radiosity::Visibility;
use hemicube_tests::spheres::{
    SIDE, meet, random, random_point, random_segments, spheres_in_a_box, visibility,
};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;
use std::time::Duration;

/// Share of a triangle or of a distance within which f32 may decide otherwise than f64.
const DOUBT: f64 = 1e-4;

/// The nearest triangle along a ray by looking at all of them; `None` where rounding may decide.
fn nearest(
    triangles: &[[Vec3; 3]],
    origin: Vec3,
    direction: Vec3,
    length: f32,
) -> Option<Option<f64>> {
    let length = f64::from(length);
    let mut nearest = None;
    for (t, inside) in triangles
        .iter()
        .filter_map(|triangle| meet(origin, direction, triangle))
    {
        let is_near_end = t.abs() < DOUBT * length || (t - length).abs() < DOUBT * length;
        if inside.abs() < DOUBT || inside > 0.0 && is_near_end {
            return None;
        }
        if inside > 0.0 && t > 0.0 && t < length && nearest.is_none_or(|n| t < n) {
            nearest = Some(t);
        }
    }
    Some(nearest)
}

/// Compares every way to ask with the answer of all triangles; returns how many segments were beyond doubt.
fn check(triangles: &[[Vec3; 3]], segments: &[(Vec3, Vec3)]) -> usize {
    let visibility = visibility(triangles);
    let mut clear = vec![false; segments.len()];
    visibility.clear_segments(segments, &mut clear);
    let mut certain = 0;
    for (&(from, to), &in_batch) in segments.iter().zip(&clear) {
        let alone = visibility.is_clear(from, to);
        assert_eq!(alone, in_batch, "alone and in a batch, {from} to {to}");
        let length = from.distance(to);
        let direction = (to - from) / length;
        let Some(expected) = nearest(triangles, from, direction, length) else {
            continue;
        };
        certain += 1;
        assert_eq!(alone, expected.is_none(), "{from} to {to}");
        let hit = visibility.first_hit(from, direction, length);
        assert_eq!(hit.is_some(), expected.is_some(), "closest, {from} to {to}");
        if let (Some(hit), Some(expected)) = (hit, expected) {
            let error = (f64::from(hit.distance) - expected).abs();
            assert!(error < 1e-4 * expected.max(1.0), "{hit:?} for {expected}");
            let face = meet(from, direction, &triangles[hit.face]).expect("the face was met");
            assert!(
                (face.0 - expected).abs() < 1e-4,
                "another face: {face:?} for {expected}"
            );
        }
    }
    certain
}

#[test]
fn spheres_are_seen_as_all_triangles_say() {
    let segments = random_segments(3000, 5);
    let certain = check(&spheres_in_a_box(12, 8, 12), &segments);
    assert!(certain > 2500, "{certain} of 3000 beyond doubt");
}

#[test]
fn a_soup_is_seen_as_all_triangles_say() {
    for (size, count) in [(2.0, 5), (1.0, 400), (0.05, 3000)] {
        let triangle = |i: u64| {
            let centre = random_point(7, i);
            [0, 1, 2].map(|k| SIDE * (centre + size * (random_point(8, 3 * i + k) - 0.5)))
        };
        let triangles: Vec<[Vec3; 3]> = (0..count).map(triangle).collect();
        let certain = check(&triangles, &random_segments(500, 9));
        assert!(certain > 250, "size {size}: {certain} of 500 beyond doubt");
    }
}

#[test]
fn both_sides_of_folded_sheets_are_met() {
    // Pairs of triangles with a common side, folded by any angle: a ray may cross both.
    let sheets = (0..400).flat_map(|i| {
        let centre = random_point(17, i);
        let [a, b, c, d] =
            [0, 1, 2, 3].map(|k| SIDE * (centre + 0.3 * (random_point(18, 4 * i + k) - 0.5)));
        [[a, b, c], [c, d, a]]
    });
    let triangles: Vec<[Vec3; 3]> = sheets.collect();
    let certain = check(&triangles, &random_segments(2000, 19));
    assert!(certain > 1000, "{certain} of 2000 beyond doubt");
}

#[test]
fn a_hundred_thousand_triangles_are_seen_as_by_obvhs() {
    let triangles = spheres_in_a_box(40, 26, 50);
    assert_eq!(triangles.len(), 100_012, "triangles");
    let visibility = visibility(&triangles);
    let theirs: Vec<Triangle> = triangles
        .iter()
        .map(|t| {
            let [v0, v1, v2] = t.map(Vec3A::from);
            Triangle { v0, v1, v2 }
        })
        .collect();
    let bvh = build_cwbvh_from_tris(
        &theirs,
        BvhBuildParams::medium_build(),
        &mut Duration::default(),
    );
    let mut differences = 0;
    for (from, to) in random_segments(20_000, 6) {
        let length = from.distance(to);
        let direction = (to - from) / length;
        let mut hit = RayHit::none();
        bvh.ray_traverse(
            Ray::new(from.into(), direction.into(), 0.0, length),
            &mut hit,
            |ray, i| theirs[bvh.primitive_indices[i] as usize].intersect(ray),
        );
        let ours = visibility
            .first_hit(from, direction, length)
            .map_or(f32::INFINITY, |h| h.distance);
        assert_eq!(
            visibility.is_clear(from, to),
            ours.is_infinite(),
            "{from} to {to}"
        );
        let same = ours == hit.t || (ours - hit.t).abs() < 1e-3;
        differences += u32::from(!same);
    }
    // Rays along edges, where obvhs may see through.
    assert!(differences <= 2, "{differences} of 20 000 segments differ");
}

/// Rays from inside of a closed surface to points on its edges and corners.
fn leaks(visibility: &Visibility, triangles: &[[Vec3; 3]], inside: Vec3) -> usize {
    let mut leaks = 0;
    for (number, &[a, b, c]) in (0..).zip(triangles) {
        let along = random(11, number);
        for aim in [a, a.lerp(b, along), b.lerp(c, along), c.lerp(a, along)] {
            let direction = (aim - inside).normalize();
            let beyond = aim + (aim - inside);
            leaks += usize::from(
                visibility
                    .first_hit(inside, direction, f32::INFINITY)
                    .is_none(),
            );
            leaks += usize::from(visibility.is_clear(inside, beyond));
        }
    }
    leaks
}

#[test]
fn closed_surfaces_do_not_leak_along_edges() {
    // Without the box, so that what slips through an edge meets nothing.
    let sphere = spheres_in_a_box(1, 40, 64).split_off(12);
    for (scale, shift) in [(1.0, 0.0), (1000.0, 0.0), (1.0, 300.0), (1e-3, -0.7)] {
        let moved: Vec<[Vec3; 3]> = sphere
            .iter()
            .map(|t| t.map(|p| p * scale + Vec3::new(shift, 0.5 * shift, -shift)))
            .collect();
        let visibility = visibility(&moved);
        let centre = moved.iter().flatten().sum::<Vec3>() / (3 * moved.len()) as f32;
        let radius = centre.distance(moved[0][0]);
        for i in 0..4 {
            let inside = centre + (random_point(12, i) - 0.5) * radius;
            let leaks = leaks(&visibility, &moved, inside);
            assert_eq!(
                leaks, 0,
                "scale {scale}, shift {shift}: rays through the surface"
            );
        }
    }
}

#[test]
fn axis_parallel_rays_meet_the_walls_they_run_to() {
    let triangles = spheres_in_a_box(0, 3, 3);
    let visibility = visibility(&triangles);
    let middle = Vec3::splat(0.5 * SIDE);
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for direction in [axis, -axis] {
            let hit = visibility
                .first_hit(middle, direction, f32::INFINITY)
                .expect("a wall");
            assert_eq!(hit.distance, 0.5 * SIDE, "towards {direction}");
            assert!(
                visibility.is_clear(middle, middle + direction * 4.99),
                "before the wall"
            );
            assert!(
                !visibility.is_clear(middle, middle + direction * 5.01),
                "through the wall"
            );
        }
    }
    assert!(
        visibility.is_clear(middle, middle),
        "a segment without length"
    );
}

#[test]
fn nested_shells_of_all_sizes_are_told_apart() {
    // A binary tree of such a scene is a chain as long as there are shells.
    let shells = 200;
    let shell = |i: i32| {
        let size = 1.2_f32.powi(i - 100);
        [(1.0, 0.0), (-0.5, 0.9), (-0.5, -0.9)].map(|(x, y)| Vec3::new(x, y, 0.5) * size)
    };
    let triangles: Vec<[Vec3; 3]> = (0..shells).map(shell).collect();
    let visibility = visibility(&triangles);
    for (i, &[a, b, c]) in triangles.iter().enumerate().step_by(7) {
        let centre = (a + b + c) / 3.0;
        let [before, behind] = [0.95, 1.05].map(|k| centre * k);
        assert!(!visibility.is_clear(before, behind), "through shell {i}");
        assert!(
            visibility.is_clear(behind, centre * 1.15),
            "behind shell {i}"
        );
        let hit = visibility.first_hit(before, Vec3::Z, f32::INFINITY);
        assert_eq!(hit.map(|h| h.face), Some(i), "first from before shell {i}");
    }
}

#[test]
fn without_faces_all_is_clear() {
    let visibility = visibility(&[]);
    assert!(visibility.is_clear(Vec3::ZERO, Vec3::ONE), "alone");
    let mut clear = [false; 3];
    visibility.clear_segments(&[(Vec3::ZERO, Vec3::ONE); 3], &mut clear);
    assert_eq!(clear, [true; 3], "in a batch");
    visibility.clear_segments(&[], &mut []);
}

#[test]
fn a_batch_of_any_size_says_what_its_segments_say_alone() {
    let visibility = visibility(&spheres_in_a_box(10, 8, 12));
    let segments = random_segments(100, 3);
    for size in [1, 2, 31, 32, 33, 100] {
        let mut clear = vec![false; size];
        visibility.clear_segments(&segments[..size], &mut clear);
        for (&(from, to), clear) in segments.iter().zip(clear) {
            assert_eq!(clear, visibility.is_clear(from, to), "{from} to {to}");
        }
    }
}
