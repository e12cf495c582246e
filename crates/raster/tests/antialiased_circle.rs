//! Antialiased discs and rings against areas found another way.

use glam::DVec2;
use hemicube_raster::Image;
use hemicube_raster::circle::antialiased::{draw_circle, fill_circle};
use hemicube_raster::target::Window;
use proptest::prelude::*;
use std::f64::consts::PI;

/// What rounding may make of a pixel's coverage.
const ROUNDING: f64 = 1e-6;

fn coverage(draw: impl FnOnce(&mut (Window, &mut dyn FnMut(i32, i32, &[f32])))) -> Image<f32> {
    let mut image = Image::filled(30, 25, 0.0_f32);
    let window = Window::of(&image);
    let mut cover = |y: i32, left: i32, shares: &[f32]| {
        for (x, &share) in (left..).zip(shares) {
            assert!((0.0..=1.0).contains(&share), "a share of {share}");
            assert!(window.contains(glam::IVec2::new(x, y)), "({x}, {y})");
            *image.pixel_mut(x as usize, y as usize) += share;
        }
    };
    draw(&mut (window, &mut cover));
    image
}

/// The area of a disc in the pixel at `low`, by the areas of the triangles and sectors between the centre and each of
/// the pixel's sides.
fn area_in_pixel(center: DVec2, radius: f64, low: DVec2) -> f64 {
    let corners =
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|c| low + DVec2::from(c) - center);
    let mut area = 0.0;
    for k in 0..4 {
        let (from, to) = (corners[k], corners[(k + 1) % 4]);
        // Where the side meets the circle: |from + t (to - from)| = r.
        let d = to - from;
        let (b, c) = (from.dot(d), from.length_squared() - radius * radius);
        let root = (b * b - c).max(0.0).sqrt();
        let mut cuts = vec![0.0, 1.0];
        cuts.extend(
            [-b - root, -b + root]
                .into_iter()
                .filter(|t| (0.0..1.0).contains(t)),
        );
        cuts.sort_by(f64::total_cmp);
        for pair in cuts.windows(2) {
            let (p, q) = (from + d * pair[0], from + d * pair[1]);
            let is_inside = p.lerp(q, 0.5).length() <= radius;
            area += if is_inside {
                0.5 * p.perp_dot(q)
            } else {
                0.5 * radius * radius * p.perp_dot(q).atan2(p.dot(q))
            };
        }
    }
    area
}

fn center(range: core::ops::Range<f64>) -> impl Strategy<Value = DVec2> {
    let coordinate =
        prop_oneof![3 => range.clone(), 1 => range.prop_map(|c| (2.0 * c).round() / 2.0)];
    (coordinate.clone(), coordinate).prop_map(|(x, y)| DVec2::new(x, y))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn every_pixel_is_covered_by_the_exact_area(
        center in center(-10.0..40.0),
        radius in prop_oneof![0.01..2.0_f64, 0.5..30.0_f64, Just(3.0), Just(0.5)],
        width in prop_oneof![0.05..3.0_f64, 0.5..60.0_f64],
    ) {
        let disc = coverage(|t| fill_circle(t, center, radius));
        let ring = coverage(|t| draw_circle(t, center, radius, width));
        for (k, (&found, &in_ring)) in disc.pixels().iter().zip(ring.pixels()).enumerate() {
            let low = DVec2::new((k % 30) as f64, (k / 30) as f64);
            let expected = area_in_pixel(center, radius, low);
            prop_assert!((f64::from(found) - expected).abs() < ROUNDING, "disc, {}: {} for {}", low, found, expected);
            let inner = (radius - 0.5 * width).max(0.0);
            let hole = if inner > 0.0 { area_in_pixel(center, inner, low) } else { 0.0 };
            let expected = area_in_pixel(center, radius + 0.5 * width, low) - hole;
            prop_assert!((f64::from(in_ring) - expected).abs() < ROUNDING, "ring, {}: {} for {}", low, in_ring, expected);
        }
    }

    #[test]
    fn an_arc_of_a_huge_circle_is_a_straight_edge(angle in 0.0..2.0 * PI, off in -10.0..10.0_f64) {
        // The sagitta of 40 pixels is 2e-4 for this radius.
        let radius = f64::from(1 << 20);
        let direction = DVec2::from_angle(angle);
        let middle = DVec2::new(15.0, 12.0);
        let center = middle - direction * (radius + off);
        let disc = coverage(|t| fill_circle(t, center, radius));
        for (k, &found) in disc.pixels().iter().enumerate() {
            let pixel = DVec2::new((k % 30) as f64, (k / 30) as f64) + 0.5;
            let outside = (pixel - middle).dot(direction) + off;
            if outside.abs() > 0.72 {
                prop_assert_eq!(found, if outside < 0.0 { 1.0 } else { 0.0 }, "{} is {} outside", pixel, outside);
            }
        }
        let exact: f64 = (0..750).map(|k| {
            let low = DVec2::new(f64::from(k % 30), f64::from(k / 30));
            // In coordinates of the centre f64 has 2^-32 pixels left; the sum over both is a looser check.
            area_in_pixel(center, radius, low)
        }).sum();
        let sum: f64 = disc.pixels().iter().map(|&c| f64::from(c)).sum();
        prop_assert!((sum - exact).abs() < 0.2, "{} for {}", sum, exact);
    }

    #[test]
    fn no_input_panics(x in prop::num::f64::ANY, y in -40.0..40.0_f64, radius in prop::num::f64::ANY, width in prop::num::f64::ANY) {
        coverage(|t| fill_circle(t, DVec2::new(x, y), radius));
        coverage(|t| draw_circle(t, DVec2::new(y, x), radius, width));
    }
}

#[test]
fn areas_are_those_of_discs_and_rings() {
    let sum = |image: Image<f32>| image.pixels().iter().map(|&c| f64::from(c)).sum::<f64>();
    let center = DVec2::new(14.37, 12.21);
    for radius in [0.2, 1.0, 3.3, 10.0] {
        let disc = sum(coverage(|t| fill_circle(t, center, radius)));
        assert!(
            (disc / (PI * radius * radius) - 1.0).abs() < 1e-6,
            "radius {radius}: {disc}"
        );
        let ring = sum(coverage(|t| draw_circle(t, center, radius, 0.3)));
        assert!(
            (ring / (2.0 * PI * radius * 0.3) - 1.0).abs() < 2e-6,
            "radius {radius}: {ring}"
        );
    }
}

#[test]
fn a_wide_window_is_covered_as_its_parts_are() {
    // Wider than the columns that are worked on at a time; the parts are cut elsewhere.
    let shares = |windows: &[Window]| {
        let mut row = vec![0.0_f32; 3 * 13_000];
        for &window in windows {
            let cover = |y: i32, left: i32, shares: &[f32]| {
                for (x, &share) in (left..).zip(shares) {
                    row[(y * 13_000 + x) as usize] += share;
                }
            };
            draw_circle(
                &mut (window, cover),
                DVec2::new(6500.3, 6001.2),
                6000.0,
                3.0,
            );
        }
        row
    };
    let whole = shares(&[Window::new(0..13_000, 0..3)]);
    let parts = shares(&[Window::new(0..5001, 0..3), Window::new(5001..13_000, 0..3)]);
    assert!(whole.iter().sum::<f32>() > 100.0, "nothing is drawn");
    for (x, (a, b)) in whole.iter().zip(&parts).enumerate() {
        assert!((a - b).abs() < 1e-6, "pixel {x}: {a} and {b}");
    }
}
