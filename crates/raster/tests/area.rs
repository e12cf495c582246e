//! Exact area coverage against two oracles: clipping against pixels, and scan lines a thousandth of a pixel apart.
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "coordinates of small pictures"
)]

use core::f64::consts::PI;
use glam::{DVec2, dvec2};
use hemicube_raster::antialias::area::{
    Area, FillRule, Outline, Rasterizer, Spans, mask, mask8, paint,
};
use hemicube_raster::{Image, Rgb};
use proptest::prelude::*;

const RULES: [FillRule; 2] = [FillRule::NonZero, FillRule::EvenOdd];

/// Random numbers in [0, 1): a linear congruential generator (Knuth's MMIX) with its high bits.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn point(&mut self, low: f64, high: f64) -> DVec2 {
        dvec2(self.unit(), self.unit()) * (high - low) + low
    }

    fn points(&mut self, count: usize, low: f64, high: f64) -> Vec<DVec2> {
        (0..count).map(|_| self.point(low, high)).collect()
    }
}

fn area(points: &[DVec2]) -> f64 {
    let next = points.iter().cycle().skip(1);
    points
        .iter()
        .zip(next)
        .map(|(a, b)| a.perp_dot(*b) / 2.0)
        .sum()
}

/// The part of a polygon where `dot(normal, p) <= limit` (Sutherland and Hodgman 1974).
fn clip(points: &[DVec2], normal: DVec2, limit: f64) -> Vec<DVec2> {
    let mut kept = Vec::new();
    for (i, &b) in points.iter().enumerate() {
        let a = points[(i + points.len() - 1) % points.len()];
        let (da, db) = (normal.dot(a) - limit, normal.dot(b) - limit);
        if (da < 0.0) != (db < 0.0) {
            kept.push(a + (b - a) * (da / (da - db)));
        }
        if db <= 0.0 {
            kept.push(b);
        }
    }
    kept
}

/// Area of a simple polygon in the pixel of a column and a row.
fn clipped_area(points: &[DVec2], x: usize, y: usize) -> f64 {
    let (x, y) = (x as f64, y as f64);
    let inside = clip(points, DVec2::NEG_X, -x);
    let inside = clip(&inside, DVec2::X, x + 1.0);
    let inside = clip(&inside, DVec2::NEG_Y, -y);
    area(&clip(&inside, DVec2::Y, y + 1.0)).abs()
}

/// Coverage by scan lines: exact along x, the mean of `lines` of them along y.
fn scanned(
    contours: &[Vec<DVec2>],
    rule: FillRule,
    width: usize,
    height: usize,
    lines: usize,
) -> Vec<f64> {
    let mut coverage = vec![0.0; width * height];
    for line in 0..height * lines {
        let y = (line as f64 + 0.5) / lines as f64;
        let mut crossings: Vec<(f64, i32)> = Vec::new();
        for contour in contours {
            for (i, &b) in contour.iter().enumerate() {
                let a = contour[(i + contour.len() - 1) % contour.len()];
                if (a.y <= y) != (b.y <= y) {
                    let x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
                    crossings.push((x, if a.y < b.y { 1 } else { -1 }));
                }
            }
        }
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut winding = 0;
        for pair in crossings.windows(2) {
            winding += pair[0].1;
            let inside = match rule {
                FillRule::NonZero => winding != 0,
                FillRule::EvenOdd => winding % 2 != 0,
            };
            let (from, to) = (pair[0].0.max(0.0), pair[1].0.min(width as f64));
            if inside && from < to {
                let row = &mut coverage[line / lines * width..][..width];
                for (x, pixel) in row.iter_mut().enumerate().skip(from as usize) {
                    let part = to.min(x as f64 + 1.0) - from.max(x as f64);
                    if part <= 0.0 {
                        break;
                    }
                    *pixel += part / lines as f64;
                }
            }
        }
    }
    coverage
}

fn outline(contours: &[Vec<DVec2>]) -> Outline {
    let mut outline = Outline::new();
    for contour in contours {
        outline.add_polygon(contour.iter().copied());
    }
    outline
}

/// Largest and RMS difference from scan lines.
///
/// Where an edge lies nearly along scan lines, the nearest one decides for half its distance to the next: 1 / (2 lines)
/// for each such edge in a pixel. Everywhere else the rule of midpoints is off by less than 1 / lines^2.
fn error(contours: &[Vec<DVec2>], rule: FillRule, lines: usize) -> (f64, f64) {
    let coverage = mask(&outline(contours), rule, (24, 24));
    let expected = scanned(contours, rule, 24, 24, lines);
    let errors = coverage.pixels().iter().zip(&expected);
    let errors: Vec<f64> = errors.map(|(&c, e)| (f64::from(c) - e).abs()).collect();
    let squares: f64 = errors.iter().map(|e| e * e).sum();
    let largest = errors.iter().copied().fold(0.0, f64::max);
    (largest, (squares / errors.len() as f64).sqrt())
}

#[test]
fn triangles_have_their_exact_area_in_each_pixel() {
    let mut random = Random(1);
    for _ in 0..1000 {
        let points = random.points(3, -10.0, 42.0);
        let coverage = mask(
            &Outline::polygon(points.clone()),
            FillRule::NonZero,
            (32, 32),
        );
        for (i, &c) in coverage.pixels().iter().enumerate() {
            let exact = clipped_area(&points, i % 32, i / 32);
            assert!(
                (f64::from(c) - exact).abs() < 2e-6,
                "{points:?}, pixel {i}: {c}, exact {exact}"
            );
        }
    }
}

#[test]
fn stars_that_cross_themselves_are_filled_by_the_rule() {
    let mut random = Random(2);
    for corners in [4, 5, 7, 12] {
        for rule in RULES {
            let contours = [random.points(corners, -2.0, 26.0)];
            let (largest, rms) = error(&contours, rule, 512);
            assert!(
                largest < 1e-3 && rms < 5e-5,
                "{corners} corners, {rule:?}: {largest}, {rms}"
            );
        }
    }
}

#[test]
fn contours_that_overlap_are_filled_by_the_rule() {
    let mut random = Random(3);
    for rule in RULES {
        for _ in 0..3 {
            let contours: Vec<Vec<DVec2>> = (0..5).map(|_| random.points(3, 0.0, 24.0)).collect();
            let (largest, rms) = error(&contours, rule, 512);
            assert!(largest < 1e-3 && rms < 5e-5, "{rule:?}: {largest}, {rms}");
        }
    }
}

#[test]
fn ring_twice_around_is_whole_by_one_rule_and_empty_by_the_other() {
    let square = [
        dvec2(2.25, 2.5),
        dvec2(9.5, 2.5),
        dvec2(9.5, 8.75),
        dvec2(2.25, 8.75),
    ];
    let twice: Vec<DVec2> = square.iter().chain(&square).copied().collect();
    let sum = |rule| -> f32 {
        let image = mask(&Outline::polygon(twice.clone()), rule, (12, 12));
        image.pixels().iter().sum()
    };
    assert!((sum(FillRule::NonZero) - 7.25 * 6.25).abs() < 1e-5, "whole");
    assert_eq!(sum(FillRule::EvenOdd), 0.0, "empty");
}

#[test]
fn hole_is_left_out_and_bow_tie_has_both_wings() {
    let square = |low: f64, high: f64| {
        [
            dvec2(low, low),
            dvec2(high, low),
            dvec2(high, high),
            dvec2(low, high),
        ]
    };
    let mut holed = Outline::polygon(square(1.5, 10.5));
    holed.add_polygon(square(3.25, 7.25).into_iter().rev());
    let sum =
        |outline: &Outline, rule| -> f32 { mask(outline, rule, (12, 12)).pixels().iter().sum() };
    for rule in RULES {
        assert!((sum(&holed, rule) - (81.0 - 16.0)).abs() < 1e-5, "{rule:?}");
        let tie = [
            dvec2(1.0, 1.0),
            dvec2(11.0, 9.0),
            dvec2(11.0, 1.0),
            dvec2(1.0, 9.0),
        ];
        assert!(
            (sum(&Outline::polygon(tie), rule) - 40.0).abs() < 1e-4,
            "{rule:?}"
        );
    }
}

#[test]
fn parts_that_share_edges_fill_each_pixel_once() {
    // A fan of triangles around a point: coverage of the parts adds up to that of the whole.
    let mut random = Random(4);
    let corners: Vec<DVec2> = (0..17)
        .map(|i| {
            DVec2::from_angle(f64::from(i) / 17.0 * 2.0 * PI) * (9.0 + 5.0 * random.unit()) + 15.0
        })
        .collect();
    let whole = mask(
        &Outline::polygon(corners.clone()),
        FillRule::NonZero,
        (30, 30),
    );
    let mut sum = vec![0.0; 900];
    for i in 0..17 {
        let part = [corners[i], corners[(i + 1) % 17], dvec2(14.3, 15.2)];
        let part = mask(&Outline::polygon(part), FillRule::NonZero, (30, 30));
        for (sum, &c) in sum.iter_mut().zip(part.pixels()) {
            *sum += c;
        }
    }
    for (i, (&c, &sum)) in whole.pixels().iter().zip(&sum).enumerate() {
        assert!((c - sum).abs() < 5e-6, "pixel {i}: {c} and {sum}");
    }
}

#[test]
fn circles_have_their_exact_area_in_each_pixel() {
    // Along x each scan line of a circle is exact; the error of the rule of midpoints shrinks with 4096 of them.
    for radius in [0.02, 0.3, 1.0, 4.7, 11.0, 300.0] {
        let center = if radius < 12.0 {
            dvec2(12.3, 11.9)
        } else {
            dvec2(12.0 - radius, 3.0)
        };
        let coverage = mask(
            &Outline::circle(center, radius),
            FillRule::NonZero,
            (24, 24),
        );
        for (i, &c) in coverage.pixels().iter().enumerate() {
            let (x, y) = ((i % 24) as f64, (i / 24) as f64);
            let line = |k: i32| {
                let dy = y + (f64::from(k) + 0.5) / 4096.0 - center.y;
                let half = (radius * radius - dy * dy).max(0.0).sqrt();
                let (from, to) = ((center.x - half).max(x), (center.x + half).min(x + 1.0));
                (to - from).max(0.0)
            };
            let exact = (0..4096).map(line).sum::<f64>() / 4096.0;
            assert!(
                (f64::from(c) - exact).abs() < 5.2e-5,
                "radius {radius}, pixel {i}: {c}, {exact}"
            );
        }
    }
}

#[test]
fn lines_cover_length_times_width_at_all_angles() {
    for degrees in 0..180 {
        let along = DVec2::from_angle(f64::from(degrees).to_radians()) * 20.0;
        let line = Outline::line(dvec2(32.2, 31.7) - along, dvec2(32.2, 31.7) + along, 1.5);
        let sum: f64 = mask(&line, FillRule::NonZero, (64, 64))
            .pixels()
            .iter()
            .map(|&c| f64::from(c))
            .sum();
        assert!((sum - 60.0).abs() < 2e-4, "{degrees} degrees: {sum}");
    }
}

#[test]
fn curves_enclose_their_area() {
    // Below a parabola lie two thirds of its box; a cubic with all control points on one side of a chord of length L
    // and height h encloses 3/5 of L h when they lie above its ends.
    let mut parabola = Outline::new();
    parabola.move_to(dvec2(2.0, 20.0));
    parabola.quad_to(dvec2(12.0, -12.0), dvec2(22.0, 20.0));
    let mut cubic = Outline::new();
    cubic.move_to(dvec2(2.0, 20.0));
    cubic.cubic_to(dvec2(2.0, 4.0), dvec2(22.0, 4.0), dvec2(22.0, 20.0));
    for (outline, area) in [
        (parabola, 20.0 * 16.0 * 2.0 / 3.0),
        (cubic, 20.0 * 16.0 * 0.6),
    ] {
        let sum: f64 = mask(&outline, FillRule::NonZero, (24, 24))
            .pixels()
            .iter()
            .map(|&c| f64::from(c))
            .sum();
        // The chords lie inside by 2/3 of the tolerance in the mean, over some 40 pixels of length.
        assert!((sum - area).abs() < 0.03, "{sum}, exact {area}");
    }
}

#[test]
fn eight_bits_are_rounded_and_nothing_more() {
    let mut random = Random(5);
    let (mut squares, mut count, mut worst) = (0.0, 0, 0.0_f64);
    for _ in 0..300 {
        let points = random.points(3, 7.0, 57.0);
        let coverage = mask8(
            &Outline::polygon(points.clone()),
            FillRule::NonZero,
            (64, 64),
        );
        for (i, &c) in coverage.pixels().iter().enumerate() {
            let exact = clipped_area(&points, i % 64, i / 64);
            if exact > 1e-9 && exact < 1.0 - 1e-9 {
                let error = f64::from(c) - 255.0 * exact;
                (squares, count, worst) =
                    (squares + error * error, count + 1, worst.max(error.abs()));
            }
        }
    }
    let rms = (squares / f64::from(count)).sqrt();
    assert!(
        rms < 0.295 && worst < 0.501,
        "RMS {rms} / 255, largest {worst} / 255, of {count} pixels"
    );
}

#[test]
fn blending_is_linear_and_half_covered_white_is_188() {
    use hemicube_raster::color::srgb8_from_linear;
    let mut image = Image::filled(2, 1, Rgb::BLACK);
    let half = Outline::polygon([
        dvec2(0.0, 0.0),
        dvec2(0.5, 0.0),
        dvec2(0.5, 1.0),
        dvec2(0.0, 1.0),
    ]);
    let mut rasterizer = Rasterizer::new(2, 1);
    rasterizer.fill(&half, FillRule::NonZero, &mut image, Rgb::WHITE, 1.0);
    assert_eq!(srgb8_from_linear(image.pixel(0, 0).r), 188, "half covered");
    assert_eq!(*image.pixel(1, 0), Rgb::BLACK, "not covered");
    for (opacity, expected) in [(0.5, 0.625), (f32::NAN, 0.625), (7.0, 0.8125)] {
        rasterizer.fill(&half, FillRule::NonZero, &mut image, Rgb::WHITE, opacity);
        assert!(
            (image.pixel(0, 0).r - expected).abs() < 1e-6,
            "opacity {opacity}"
        );
    }
}

#[test]
fn areas_painted_at_once_are_those_painted_one_by_one() {
    // 1500 x 90 pixels are several bands; shapes of all kinds, some outside, one that is no number.
    let mut random = Random(7);
    let mut outlines: Vec<Outline> = (0..60)
        .map(|i| {
            let corner = random.point(-100.0, 1500.0) * dvec2(1.0, 0.07);
            let points = random.points(3 + i % 6, 0.0, 80.0);
            Outline::polygon(points.into_iter().map(|p| p + corner))
        })
        .collect();
    outlines.push(Outline::circle(dvec2(700.0, 45.0), 300.0));
    outlines.push(Outline::polygon([dvec2(f64::NAN, 3.0)]));
    outlines.push(Outline::new());
    let mut color = || {
        Rgb::new(
            random.unit() as f32,
            random.unit() as f32,
            random.unit() as f32,
        )
    };
    let areas: Vec<Area<'_, Rgb>> = outlines
        .iter()
        .enumerate()
        .map(|(i, outline)| {
            Area::new(outline, color())
                .with_opacity([1.0, 0.4][i % 2])
                .with_rule(RULES[i / 2 % 2])
        })
        .collect();
    let mut expected = Image::filled(1500, 90, Rgb::BLACK);
    let mut rasterizer = Rasterizer::new(1500, 90);
    for area in &areas {
        rasterizer.fill(
            area.outline,
            area.rule,
            &mut expected,
            area.value,
            area.opacity,
        );
    }
    let painted = |threads| {
        let mut image = Image::filled(1500, 90, Rgb::BLACK);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads can be started")
            .install(|| paint(&mut image, &areas));
        image
    };
    let one = painted(1);
    assert_eq!(one, painted(8), "threads");
    for (i, (a, b)) in one.pixels().iter().zip(expected.pixels()).enumerate() {
        // Edges that are cut between bands are rounded elsewhere.
        assert!(
            (0..3).all(|band| (a[band] - b[band]).abs() < 1e-5),
            "pixel {i}: {a:?}, {b:?}"
        );
    }
    paint(&mut Image::filled(0, 4, Rgb::BLACK), &areas);
    paint(&mut Image::filled(4, 0, Rgb::BLACK), &areas);
}

#[test]
fn area_outside_changes_nothing_inside() {
    // A band across the picture from far away on both sides, at slopes that leave it in all ways.
    for far in [1e2, 1e5, 1e9] {
        let band = [
            dvec2(-far, 2.5),
            dvec2(far, 2.5),
            dvec2(far, 7.25),
            dvec2(-far, 7.25),
        ];
        let tall = band.map(|p| dvec2(p.y, p.x));
        for points in [band, tall] {
            let sum: f32 = mask(&Outline::polygon(points), FillRule::NonZero, (16, 16))
                .pixels()
                .iter()
                .sum();
            assert!((sum - 76.0).abs() < 1e-4, "{far}: {sum}");
        }
        let slanted = [
            dvec2(-far, -far + 1.0),
            dvec2(far, far + 1.0),
            dvec2(far, far + 3.0),
            dvec2(-far, -far + 3.0),
        ];
        let coverage = mask(&Outline::polygon(slanted), FillRule::NonZero, (16, 16));
        for (i, &c) in coverage.pixels().iter().enumerate() {
            let exact = clipped_area(
                &[
                    dvec2(-40.0, -39.0),
                    dvec2(40.0, 41.0),
                    dvec2(40.0, 43.0),
                    dvec2(-40.0, -37.0),
                ],
                i % 16,
                i / 16,
            );
            assert!(
                (f64::from(c) - exact).abs() < 1e-5,
                "{far}, pixel {i}: {c}, exact {exact}"
            );
        }
    }
}

#[test]
fn what_is_no_number_or_no_area_covers_nothing() {
    let square = [
        dvec2(1.0, 1.0),
        dvec2(5.0, 1.0),
        dvec2(5.0, 5.0),
        dvec2(1.0, 5.0),
    ];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut broken = Outline::polygon(square);
        broken.line_to(dvec2(bad, 3.0));
        assert!(!broken.is_finite(), "{bad}");
        assert!(is_empty(&broken), "{bad}");
        assert!(
            is_empty(&Outline::circle(dvec2(4.0, 4.0), bad)),
            "radius {bad}"
        );
        assert!(
            is_empty(&Outline::line(dvec2(1.0, 1.0), dvec2(4.0, bad), 1.0)),
            "end {bad}"
        );
        assert!(
            is_empty(&Outline::line(dvec2(1.0, 1.0), dvec2(4.0, 4.0), bad)),
            "width {bad}"
        );
    }
    for nothing in [
        Outline::new(),
        Outline::polygon([]),
        Outline::polygon([dvec2(3.0, 3.0)]),
        Outline::polygon([dvec2(3.0, 3.0), dvec2(5.0, 6.0)]),
        Outline::circle(dvec2(4.0, 4.0), 0.0),
        Outline::circle(dvec2(4.0, 4.0), -3.0),
        Outline::line(dvec2(3.0, 3.0), dvec2(3.0, 3.0), 2.0),
        Outline::line(dvec2(3.0, 3.0), dvec2(6.0, 5.0), 0.0),
    ] {
        assert!(is_empty(&nothing), "{nothing:?}");
    }
    for (width, height) in [(0, 0), (0, 9), (9, 0)] {
        assert!(
            mask(
                &Outline::polygon(square),
                FillRule::NonZero,
                (width, height)
            )
            .pixels()
            .is_empty(),
            "{width} x {height}"
        );
    }
}

fn is_empty(outline: &Outline) -> bool {
    mask(outline, FillRule::NonZero, (8, 8))
        .pixels()
        .iter()
        .all(|&c| c == 0.0)
}

#[test]
fn very_many_corners_in_a_row_take_no_more_than_a_moment() {
    // 20 000 corners in 4 rows would be 10^8 visits in order; coverage stays in its range.
    let mut random = Random(6);
    let points: Vec<DVec2> = (0..20_000)
        .map(|_| random.point(0.0, 4.0) * dvec2(8.0, 1.0))
        .collect();
    for rule in RULES {
        let coverage = mask(&Outline::polygon(points.clone()), rule, (32, 4));
        assert!(
            coverage.pixels().iter().all(|c| (0.0..=1.0).contains(c)),
            "{rule:?}"
        );
    }
}

/// Checks what is promised about spans.
struct Checked {
    width: usize,
    at: Option<(usize, usize)>,
}

impl Checked {
    fn advance(&mut self, y: usize, start: usize, end: usize) {
        assert!(start < end && end <= self.width, "columns {start} .. {end}");
        assert!(
            self.at.is_none_or(|at| at <= (y, start)),
            "{:?} before {y}, {start}",
            self.at
        );
        self.at = Some((y, end));
    }
}

impl Spans for Checked {
    fn cells(&mut self, y: usize, x: usize, coverage: &[f32]) {
        self.advance(y, x, x + coverage.len());
        assert!(
            coverage.iter().all(|c| (0.0..=1.0).contains(c)),
            "{coverage:?}"
        );
    }

    fn run(&mut self, y: usize, start: usize, end: usize, coverage: f32) {
        self.advance(y, start, end);
        assert!(coverage > 0.0 && coverage <= 1.0, "{coverage}");
    }
}

fn any_coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -3.0..12.0_f64,
        2 => (-3..12).prop_map(f64::from),
        1 => prop_oneof![Just(1e300), Just(-1e300), Just(3e18), Just(-7e9), Just(1e-300), Just(-0.0)],
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_outline_gives_spans_in_order(
        contours in prop::collection::vec(prop::collection::vec((any_coordinate(), any_coordinate()), 0..9), 0..4),
        even_odd: bool,
    ) {
        let rule = RULES[usize::from(even_odd)];
        let contours: Vec<Vec<DVec2>> = contours.into_iter().map(|c| c.into_iter().map(DVec2::from).collect()).collect();
        Rasterizer::new(9, 8).rasterize(&outline(&contours), rule, &mut Checked { width: 9, at: None });
    }

    #[test]
    fn any_outline_of_near_points_has_the_coverage_of_scan_lines(
        points in prop::collection::vec((prop_oneof![(0..24).prop_map(f64::from), 0.0..24.0_f64], prop_oneof![(0..24).prop_map(f64::from), 0.0..24.0_f64]), 3..8),
        even_odd: bool,
    ) {
        let rule = RULES[usize::from(even_odd)];
        let contours = [points.into_iter().map(DVec2::from).collect::<Vec<_>>()];
        let (largest, rms) = error(&contours, rule, 64);
        prop_assert!(largest < 2.0 / 64.0 && rms < 2e-3, "{contours:?}: {largest}, {rms}");
    }
}
