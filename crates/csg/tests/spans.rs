//! Spans against the inside function, which knows nothing of rays.

mod common;

use common::{Numbers, primitive, tree};
use glam::{DAffine3, DMat3, DVec3};
use hemicube_csg::{Ray, Solid};

/// Distance from an end at which its two sides are looked at. Ends are less than a tenth of it off, unless the ray
/// grazes; a span shorter than it has no inside to be looked at.
const STEP: f64 = 1e-6;

/// Counts the ends at which the inside function does not change as it should, and says how many there are.
fn wrong_ends(solid: &Solid, ray: &Ray) -> (usize, usize) {
    let spans = solid.spans(ray);
    let ends: Vec<(f64, bool)> = spans
        .iter()
        .flat_map(|s| [(s.start, true), (s.end, false)])
        .collect();
    let is_apart = |i: usize| {
        let near = |j: usize| (ends[j].0 - ends[i].0).abs() < 3.0 * STEP;
        (i == 0 || !near(i - 1)) && (i + 1 == ends.len() || !near(i + 1))
    };
    let checked: Vec<usize> = (0..ends.len())
        .filter(|&i| ends[i].0.is_finite() && is_apart(i))
        .collect();
    let toggles = |&i: &usize| {
        let (t, enters) = ends[i];
        solid.contains(ray.at(t - STEP)) != enters && solid.contains(ray.at(t + STEP)) == enters
    };
    let right = checked.iter().filter(|i| toggles(i)).count();
    (checked.len() - right, checked.len())
}

/// Points of the line where the inside function and the spans disagree, away from the ends.
fn disagreements(solid: &Solid, ray: &Ray, numbers: &mut Numbers) -> usize {
    let spans = solid.spans(ray);
    let samples = (0..60).map(|_| numbers.between(-6.0, 6.0));
    samples
        .filter(|t| {
            let is_near_an_end = spans
                .iter()
                .any(|s| (s.start - t).abs() < STEP || (s.end - t).abs() < STEP);
            let is_inside = spans.iter().any(|s| s.contains(t));
            !is_near_an_end && is_inside != solid.contains(ray.at(*t))
        })
        .count()
}

#[test]
fn every_end_toggles_the_inside_and_nothing_else_does() {
    let mut numbers = Numbers::new(1);
    let mut all = 0;
    for i in 0..3000 {
        let solid = if i % 3 == 0 {
            tree(&mut numbers, 1 + i % 4)
        } else {
            primitive(&mut numbers)
        };
        for _ in 0..10 {
            let ray = numbers.ray();
            let (wrong, checked) = wrong_ends(&solid, &ray);
            assert_eq!(
                wrong,
                0,
                "solid {i}, {ray:?}: spans {:?}",
                solid.spans(&ray)
            );
            let off = disagreements(&solid, &ray, &mut numbers);
            assert_eq!(off, 0, "solid {i}, {ray:?}: spans {:?}", solid.spans(&ray));
            all += checked;
        }
    }
    assert!(all > 8000, "{all} ends");
}

#[test]
fn spans_are_ascending_and_apart() {
    let mut numbers = Numbers::new(2);
    for _ in 0..1000 {
        let solid = tree(&mut numbers, 4);
        let spans = solid.spans(&numbers.ray());
        assert!(spans.iter().all(|s| s.start < s.end), "{spans:?}");
        assert!(
            spans.windows(2).all(|pair| pair[0].end < pair[1].start),
            "{spans:?}"
        );
    }
}

fn close(a: &[core::ops::Range<f64>], b: &[core::ops::Range<f64>]) -> bool {
    let near = |x: f64, y: f64| x == y || (x - y).abs() < 1e-8;
    a.len() == b.len()
        && a.iter()
            .zip(b)
            .all(|(a, b)| near(a.start, b.start) && near(a.end, b.end))
}

#[test]
fn laws_of_sets_hold_along_rays() {
    let mut numbers = Numbers::new(3);
    for i in 0..1500 {
        let [a, b] = [(); 2].map(|()| tree(&mut numbers, 2));
        let ray = numbers.ray();
        let same = |left: Solid, right: Solid, law: &str| {
            let (l, r) = (left.spans(&ray), right.spans(&ray));
            assert!(close(&l, &r), "case {i}, {law}: {l:?} and {r:?}");
        };
        let (p, q) = (|| a.clone(), || b.clone());
        same(p() - q(), p() & !q(), "difference");
        same(!(p() | q()), !p() & !q(), "de Morgan");
        same(p() | q(), q() | p(), "union commutes");
        same(p() & (p() | q()), p(), "absorption");
        same((p() - q()) | (p() & q()), p(), "parts make the whole");
        same(p() - p(), Solid::empty(), "nothing is left");
    }
}

#[test]
fn torus_roots_are_exact_to_1e_9() {
    let mut numbers = Numbers::new(4);
    let (mut worst, mut count) = (0.0_f64, 0);
    for _ in 0..20_000 {
        let tube = 10_f64.powf(numbers.between(-3.0, -0.01));
        let torus = Solid::torus(DVec3::ZERO, DVec3::Y, 1.0, tube).expect("a ring");
        let far = 10_f64.powf(numbers.between(0.0, 4.0));
        let direction = numbers.direction();
        let inside =
            DVec3::new(direction.x, 0.0, direction.z).normalize() + numbers.point() * tube * 0.5;
        let ray = Ray::new(inside - numbers.direction() * far, inside);
        let ray = Ray::new(ray.origin(), inside - ray.origin());
        for span in torus.spans(&ray) {
            for t in [span.start, span.end] {
                let p = ray.at(t);
                let off = ((p.x.hypot(p.z) - 1.0).hypot(p.y) - tube).abs();
                // Distance along the ray, as the surface is met at an angle.
                let slope = {
                    let h = 1e-6;
                    let d = |t: f64| {
                        let p = ray.at(t);
                        (p.x.hypot(p.z) - 1.0).hypot(p.y)
                    };
                    ((d(t + h) - d(t - h)) / (2.0 * h)).abs()
                };
                if slope > 0.1 {
                    worst = worst.max(off / slope / (1.0 + far * 1e-3));
                    count += 1;
                }
            }
        }
    }
    assert!(count > 30_000, "{count} roots");
    assert!(worst < 1e-9, "worst {worst:e}");
}

#[test]
fn axis_of_a_torus_and_its_tangents() {
    let ring = Solid::torus(DVec3::ZERO, DVec3::Y, 2.0, 0.5).expect("a ring");
    let spans = |origin: [f64; 3], direction: [f64; 3]| {
        ring.spans(&Ray::new(origin.into(), direction.into()))
    };
    assert!(
        spans([0.0, -5.0, 0.0], [0.0, 1.0, 0.0]).is_empty(),
        "through the hole"
    );
    assert!(
        close(
            &spans([-5.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
            &[2.5..3.5, 6.5..7.5]
        ),
        "across: {:?}",
        spans([-5.0, 0.0, 0.0], [1.0, 0.0, 0.0])
    );
    assert!(
        close(&spans([2.0, -5.0, 0.0], [0.0, 1.0, 0.0]), &[4.5..5.5]),
        "along the axis"
    );
    assert!(
        spans([-5.0, 0.5, 0.0], [1.0, 0.0, 0.0]).is_empty(),
        "over the top circle"
    );
    assert!(
        spans([2.5, -5.0, 0.0], [0.0, 1.0, 0.0]).is_empty(),
        "along the rim"
    );
    // The plane that touches the inner side twice (Villarceau): two double roots.
    let slope = DVec3::new((1.0_f64 - 0.0625).sqrt(), 0.25, 0.0);
    let twice = ring.spans(&Ray::new(-5.0 * slope, slope));
    assert!(twice.iter().all(|s| s.end - s.start < 1e-6), "{twice:?}");
}

#[test]
fn an_apple_has_no_lemon_inside() {
    let apple = Solid::torus(DVec3::ZERO, DVec3::Y, 0.4, 0.6).expect("an apple");
    let dimple = 0.2_f64.sqrt();
    let down = apple.spans(&Ray::new(DVec3::new(0.0, 5.0, 0.0), DVec3::NEG_Y));
    let expected = [5.0 - dimple..5.0 + dimple];
    assert!(
        down.is_empty() || close(&down, &expected),
        "through both dimples: {down:?}"
    );
    for tilt in [1e-7, 1e-3, 0.05] {
        let ray = Ray::new(DVec3::new(tilt, 5.0, 0.0), DVec3::NEG_Y);
        let spans = apple.spans(&ray);
        assert_eq!(spans.len(), 1, "{tilt} beside the axis: {spans:?}");
    }
}

#[test]
fn grazing_rays_end_where_they_begin() {
    let ball = Solid::sphere(DVec3::ZERO, 1.0).expect("a ball");
    let rod = Solid::cylinder(DVec3::ZERO, DVec3::Y, 1.0).expect("a rod");
    for offset in [1.0, 1.0 + 1e-15, 1.0 - 1e-16] {
        let ray = Ray::new(DVec3::new(-5.0, 0.5, offset), DVec3::X);
        assert!(
            rod.spans(&ray).iter().all(|s| s.end - s.start < 1e-6),
            "rod at {offset}"
        );
        let ray = Ray::new(DVec3::new(-5.0, 0.0, offset), DVec3::X);
        assert!(
            ball.spans(&ray).iter().all(|s| s.end - s.start < 1e-6),
            "ball at {offset}"
        );
    }
}

#[test]
fn a_far_eye_loses_no_digits_but_those_of_the_distance() {
    let ball = Solid::sphere(DVec3::ZERO, 1.0).expect("a ball");
    let ray = Ray::new(DVec3::new(-1e6, 0.6, 0.0), DVec3::X);
    let spans = ball.spans(&ray);
    assert!((spans[0].start - (1e6 - 0.8)).abs() < 1e-9, "{spans:?}");
    assert!((spans[0].end - (1e6 + 0.8)).abs() < 1e-9, "{spans:?}");
}

#[test]
fn boxes_stacked_on_each_other_are_one() {
    let turn = DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(0.3);
    let boxes = (0..7).map(|i| {
        let low = DVec3::new(f64::from(i) * 0.1, 0.0, 0.0);
        Solid::cuboid(low, low + DVec3::new(0.1, 1.0, 1.0))
            .and_then(|b| b.transformed(DAffine3::from_mat3(turn)))
            .expect("a box")
    });
    let stack = Solid::union(boxes);
    let mut numbers = Numbers::new(9);
    for _ in 0..2000 {
        let inside =
            turn * (DVec3::new(0.35, 0.5, 0.5) + numbers.point() * DVec3::new(0.3, 0.4, 0.4));
        let ray = Ray::new(inside, numbers.direction());
        assert_eq!(
            stack.spans(&ray).len(),
            1,
            "no gap between boxes along {ray:?}"
        );
    }
}

#[test]
fn rays_that_are_none_meet_nothing() {
    let ball = Solid::sphere(DVec3::ZERO, 1.0).expect("a ball");
    let cube = Solid::cuboid(DVec3::ZERO, DVec3::ONE).expect("a box");
    let everything = !Solid::empty();
    for (origin, direction) in [
        (DVec3::ZERO, DVec3::ZERO),
        (DVec3::NAN, DVec3::X),
        (DVec3::ZERO, DVec3::NAN),
        (DVec3::INFINITY, DVec3::X),
    ] {
        let ray = Ray::new(origin, direction);
        for solid in [&ball, &cube, &everything] {
            assert!(solid.spans(&ray).is_empty(), "{ray:?}");
        }
    }
}
