//! Antialiased lines against exact areas, and the laws that follow from them.

use glam::DVec2;
use hemicube_raster::Image;
use hemicube_raster::line::Dashes;
use hemicube_raster::line::antialiased::{Line, draw_line, draw_lines, draw_stroke};
use hemicube_raster::stroke::{Cap, Join, Path, Stroke};
use hemicube_raster::target::Window;
use proptest::prelude::*;

/// What rounding may make of a pixel's coverage.
const ROUNDING: f64 = 2e-6;

fn coverage(width: usize, height: usize, path: &Path, stroke: &Stroke) -> Image<f32> {
    let mut image = Image::filled(width, height, 0.0_f32);
    let mut target = (Window::of(&image), adding(&mut image));
    draw_stroke(&mut target, path, stroke);
    drop(target);
    image
}

/// The same of a line, which has a way of its own.
fn line_coverage(
    (width, height): (usize, usize),
    [from, to]: [DVec2; 2],
    line_width: f64,
) -> Image<f32> {
    let mut image = Image::filled(width, height, 0.0_f32);
    let mut target = (Window::of(&image), adding(&mut image));
    draw_line(&mut target, from, to, line_width);
    drop(target);
    image
}

fn adding(image: &mut Image<f32>) -> impl FnMut(i32, i32, &[f32]) + '_ {
    |y, left, shares| {
        for (x, &share) in (left..).zip(shares) {
            assert!((0.0..=1.0).contains(&share), "a share of {share}");
            *image.pixel_mut(x as usize, y as usize) += share;
        }
    }
}

fn sum(image: &Image<f32>) -> f64 {
    image.pixels().iter().map(|&c| f64::from(c)).sum()
}

/// The area of a convex polygon in a pixel: cut at its four sides, then by the shoelace formula.
fn area_in_pixel(corners: &[DVec2], x: usize, y: usize) -> f64 {
    let low = DVec2::new(x as f64, y as f64);
    let mut polygon = corners.to_vec();
    for (normal, offset) in [
        (DVec2::X, low.x),
        (-DVec2::X, -low.x - 1.0),
        (DVec2::Y, low.y),
        (-DVec2::Y, -low.y - 1.0),
    ] {
        let distance = |p: DVec2| p.dot(normal) - offset;
        let mut kept = Vec::new();
        for k in 0..polygon.len() {
            let (from, to) = (polygon[k], polygon[(k + 1) % polygon.len()]);
            let (a, b) = (distance(from), distance(to));
            if a >= 0.0 {
                kept.push(from);
            }
            if (a >= 0.0) != (b >= 0.0) {
                kept.push(from + (to - from) * (a / (a - b)));
            }
        }
        polygon = kept;
    }
    let relative: Vec<DVec2> = polygon.iter().map(|&p| p - low).collect();
    let doubled: f64 = (0..relative.len())
        .map(|k| relative[k].perp_dot(relative[(k + 1) % relative.len()]))
        .sum();
    0.5 * doubled.abs()
}

fn rectangle(from: DVec2, to: DVec2, width: f64) -> [DVec2; 4] {
    let side = (to - from).normalize().perp() * (0.5 * width);
    [from - side, to - side, to + side, from + side]
}

fn point(range: core::ops::Range<f64>) -> impl Strategy<Value = DVec2> {
    // Whole and half numbers too, where edges run along pixels.
    let coordinate =
        prop_oneof![3 => range.clone(), 1 => range.prop_map(|c| (2.0 * c).round() / 2.0)];
    (coordinate.clone(), coordinate).prop_map(|(x, y)| DVec2::new(x, y))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn every_pixel_is_covered_by_the_exact_area(from in point(-10.0..40.0), to in point(-10.0..40.0), width in prop_oneof![0.05..3.0_f64, 0.05..60.0_f64]) {
        prop_assume!(from != to);
        let image = coverage(30, 25, &Path::open([from, to]), &Stroke::new(width));
        let line = line_coverage((30, 25), [from, to], width);
        let corners = rectangle(from, to, width);
        for (k, &found) in image.pixels().iter().enumerate() {
            let expected = area_in_pixel(&corners, k % 30, k / 30);
            for found in [found, line.pixels()[k]] {
                prop_assert!((f64::from(found) - expected).abs() < ROUNDING, "pixel ({}, {}): {} for {}", k % 30, k / 30, found, expected);
            }
        }
    }

    #[test]
    fn a_line_from_far_away_is_exact(from in point(-3e5..3e5), to in point(-10.0..40.0), width in 0.3..3.0_f64) {
        let image = coverage(30, 25, &Path::open([from, to]), &Stroke::new(width));
        let line = line_coverage((30, 25), [from, to], width);
        let corners = rectangle(from, to, width);
        for (k, &found) in image.pixels().iter().enumerate() {
            let expected = area_in_pixel(&corners, k % 30, k / 30);
            for found in [found, line.pixels()[k]] {
                prop_assert!((f64::from(found) - expected).abs() < ROUNDING, "{} for {}", found, expected);
            }
        }
    }

    #[test]
    fn a_path_on_a_line_is_the_line(from in point(2.0..28.0), to in point(2.0..28.0), share in 0.01..0.99_f64, width in 0.2..3.0_f64) {
        prop_assume!(from.distance(to) > 0.5);
        let whole = coverage(30, 30, &Path::open([from, to]), &Stroke::new(width));
        let parts = coverage(30, 30, &Path::open([from, from.lerp(to, share), to]), &Stroke::new(width));
        for (a, b) in whole.pixels().iter().zip(parts.pixels()) {
            prop_assert!((a - b).abs() < 1e-5, "{} and {}: the joint is seen", a, b);
        }
    }

    #[test]
    fn joined_strokes_have_the_area_of_their_outline(
        angle in 0.6..5.6_f64,
        turn in 0.0..std::f64::consts::TAU,
        width in 0.2..4.0_f64,
        kind in 0..3_usize,
    ) {
        let corner = DVec2::new(40.0, 40.0);
        let [before, after] = [turn, turn + angle].map(|a| DVec2::from_angle(a) * 30.0);
        let join = [Join::Miter, Join::Round, Join::Bevel][kind];
        let stroke = Stroke::new(width).with_join(join).with_miter_limit(9.0);
        let image = coverage(80, 80, &Path::open([corner + before, corner, corner + after]), &stroke);
        // Each side loses w^2 / 8 cot(a / 2) on the inner side, where they would overlap, and the join adds its own.
        let inside = angle.min(2.0 * std::f64::consts::PI - angle);
        let half = 0.5 * width;
        let overlap = half * half / (0.5 * inside).tan();
        let turn = std::f64::consts::PI - inside;
        let added = half * half * match join {
            Join::Miter => (0.5 * turn).tan(),
            Join::Round => 0.5 * turn,
            Join::Bevel => 0.5 * turn.sin(),
        };
        let expected = 60.0 * width - overlap + added;
        // A round join is a polygon within 0.02 pixels.
        let tolerance = 1e-4 + if join == Join::Round { 0.02 * half * turn } else { 0.0 };
        prop_assert!((sum(&image) - expected).abs() < tolerance, "{} for {}", sum(&image), expected);
    }

    #[test]
    fn no_input_panics(
        points in prop::collection::vec((prop::num::f64::ANY, -50.0..50.0_f64), 0..6),
        width in prop_oneof![prop::num::f64::ANY, 0.0..5.0_f64],
        is_closed in any::<bool>(),
        kind in 0..3_usize,
        is_dashed in any::<bool>(),
    ) {
        let points: Vec<DVec2> = points.into_iter().map(|(x, y)| if kind == 0 { DVec2::new(x, y) } else { DVec2::new(y, x) }).collect();
        if let &[from, to, ..] = points.as_slice() {
            line_coverage((30, 20), [from, to], width);
        }
        let path = if is_closed { Path::closed(points) } else { Path::open(points) };
        let mut stroke = Stroke::new(width)
            .with_join([Join::Miter, Join::Round, Join::Bevel][kind])
            .with_cap([Cap::Butt, Cap::Round, Cap::Square][kind]);
        if is_dashed {
            stroke = stroke.with_dashes(Dashes::new(&[3.0, 2.0], 1.0).expect("good dashes"));
        }
        coverage(30, 20, &path, &stroke);
    }
}

#[test]
fn the_sum_is_length_times_width_at_every_angle() {
    for width in [0.1, 1.0, 2.5] {
        for k in 0..720 {
            let direction = DVec2::from_angle(f64::from(k) * std::f64::consts::PI / 360.0);
            let centre = DVec2::new(50.3, 49.8);
            let ends = [centre - direction * 40.0, centre + direction * 40.0];
            let stroke = coverage(100, 100, &Path::open(ends), &Stroke::new(width));
            for image in [stroke, line_coverage((100, 100), ends, width)] {
                let error = sum(&image) / (80.0 * width) - 1.0;
                assert!(
                    error.abs() < 2e-6,
                    "width {width}, {k} half degrees: {error:e}"
                );
            }
        }
    }
}

#[test]
fn intensity_does_not_vary_along_a_line() {
    // Coverage summed across the line, column by column, away from the ends.
    for slope in [0.0, 0.1, 0.37, 0.5, 0.83, 1.0] {
        let ends = [DVec2::new(2.0, 5.2), DVec2::new(98.0, 5.2 + 96.0 * slope)];
        let image = coverage(100, 110, &Path::open(ends), &Stroke::new(1.3));
        let expected = 1.3 * f64::hypot(1.0, slope);
        for x in 10..90 {
            let column: f64 = (0..110).map(|y| f64::from(*image.pixel(x, y))).sum();
            assert!(
                (column - expected).abs() < 4e-6,
                "slope {slope}, column {x}: {column} for {expected}"
            );
        }
    }
}

#[test]
fn bytes_are_floats_rounded_to_the_nearest() {
    let ends = [DVec2::new(2.3, 4.1), DVec2::new(37.9, 22.6)];
    let exact = line_coverage((40, 30), ends, 1.7);
    let mut mask = Image::filled(40, 30, 0_u8);
    draw_line(&mut mask.pen(255), ends[0], ends[1], 1.7);
    let mut pixels = Image::filled(40, 30, [0_u8, 100]);
    draw_line(&mut pixels.pen([255, 50]), ends[0], ends[1], 1.7);
    for (k, &share) in exact.pixels().iter().enumerate() {
        let (byte, [first, second]) = (mask.pixels()[k], pixels.pixels()[k]);
        assert_eq!(byte, first, "pixel {k}");
        let off = (f32::from(byte) - 255.0 * share).abs();
        assert!(off < 0.5001, "pixel {k}: {byte} of {share}");
        let off = (f32::from(second) - (100.0 - 50.0 * share)).abs();
        assert!(off < 0.5001, "pixel {k}: {second} of {share}");
    }
}

#[test]
fn lines_drawn_at_once_are_those_drawn_one_by_one() {
    // 1500 pixels of three floats: bands of 14 rows.
    let mut seed = 0_u64;
    let mut random = |low: f64, high: f64| {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut lines: Vec<Line<[f32; 3]>> = (0..300_u16)
        .map(|i| Line {
            from: DVec2::new(random(-50.0, 1550.0), random(-20.0, 110.0)),
            to: DVec2::new(random(-50.0, 1550.0), random(-20.0, 110.0)),
            width: random(0.2, 5.0),
            pixel: [f32::from(i) / 300.0, 0.5, 1.0],
        })
        .collect();
    for (from, to, width) in [
        (DVec2::new(f64::NAN, 3.0), DVec2::ONE, 1.0),
        (DVec2::new(3.0, 50.0), DVec2::new(f64::INFINITY, 80.0), 1.0),
        (DVec2::ZERO, DVec2::new(30.0, 90.0), -7.0),
        (DVec2::ZERO, DVec2::new(30.0, 90.0), f64::NAN),
        (DVec2::new(9.0, -1e300), DVec2::new(9.0, 1e300), 1e300),
    ] {
        let pixel = [1.0; 3];
        lines.push(Line {
            from,
            to,
            width,
            pixel,
        });
    }
    // Ends at a border of bands.
    lines.extend([13.5, 14.0, 28.0].map(|y| Line {
        from: DVec2::new(700.5, y),
        to: DVec2::new(700.5, 28.5),
        width: 1.0,
        pixel: [1.0; 3],
    }));
    let mut expected = Image::filled(1500, 90, [0.0; 3]);
    for line in &lines {
        draw_line(
            &mut expected.pen(line.pixel),
            line.from,
            line.to,
            line.width,
        );
    }
    let drawn = |threads| {
        let mut image = Image::filled(1500, 90, [0.0; 3]);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.expect("threads can be started");
        pool.install(|| draw_lines(&mut image, &lines));
        image
    };
    let one = drawn(1);
    assert_eq!(one, drawn(8), "threads");
    for (k, (a, b)) in one.pixels().iter().zip(expected.pixels()).enumerate() {
        let off = (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f32::max);
        assert!(off < 1e-5, "pixel {k}: {a:?} and {b:?}");
    }
    draw_lines(&mut Image::filled(0, 4, [0.0; 3]), &lines);
    draw_lines(&mut Image::filled(4, 0, [0.0; 3]), &lines);
}

#[test]
fn blending_is_in_linear_light() {
    let mut image = Image::filled(4, 1, hemicube_raster::Rgb::BLACK);
    let (from, to) = (DVec2::new(0.0, 0.25), DVec2::new(4.0, 0.25));
    draw_line(&mut image.pen(hemicube_raster::Rgb::WHITE), from, to, 0.5);
    let code = hemicube_raster::color::srgb8_from_linear(image.pixel(1, 0).g);
    assert_eq!(code, 188, "a pixel half covered by white on black");
}

#[test]
fn dashes_have_their_length_and_their_phase() {
    let dashes = Dashes::new(&[5.0, 3.0], 2.0).expect("good dashes");
    let stroke = Stroke::new(1.5).with_dashes(dashes);
    let ends = [
        DVec2::new(3.0, 4.0),
        DVec2::new(3.0 + 64.0 * 0.8, 4.0 + 64.0 * 0.6),
    ];
    let image = coverage(60, 50, &Path::open(ends), &stroke);
    assert!(
        (sum(&image) - 40.0 * 1.5).abs() < 1e-4,
        "{} of 60",
        sum(&image)
    );
    // A polygon's dashes go round its corners.
    let bend = DVec2::new(30.0, 10.0);
    let path = Path::open([DVec2::new(10.0, 10.0), bend, DVec2::new(30.0, 30.0)]);
    let round = coverage(
        40,
        40,
        &path,
        &Stroke::new(2.0).with_dashes(Dashes::new(&[6.0, 4.0], 3.0).expect("good")),
    );
    assert!(
        (f64::from(*round.pixel(30, 9)) - 1.0).abs() < ROUNDING,
        "the mitre of a dash that goes round"
    );
    assert_eq!(*round.pixel(24, 9), 0.0, "a gap");
}
