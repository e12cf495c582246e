//! Filled polygons against exact winding numbers and triangles; strokes against distances.

use glam::{DVec2, IVec2, Vec4};
use hemicube_raster::line::Dashes;
use hemicube_raster::polygon::{FillRule, fill_polygon};
use hemicube_raster::stroke::{Cap, Join, Path, Stroke, draw_stroke};
use hemicube_raster::target::{Target, Window};
use hemicube_raster::triangle::{ClipVertex, Cull, DepthBuffer, Viewport, draw_triangle};
use proptest::prelude::*;

const SIDE: i32 = 32;

/// How often each pixel of a window is drawn; panics if that is more than once in a call, or out of order.
struct Counts {
    window: Window,
    counts: Vec<u32>,
    last: (i32, i32),
}

impl Counts {
    fn new() -> Self {
        Self {
            window: Window::new(0..SIDE, 0..SIDE),
            counts: vec![0; (SIDE * SIDE) as usize],
            last: (i32::MIN, 0),
        }
    }

    fn draw(&mut self, draw: impl FnOnce(&mut Self)) {
        self.last = (i32::MIN, 0);
        draw(self);
    }

    fn is_set(&self, x: i32, y: i32) -> bool {
        self.counts[(y * SIDE + x) as usize] > 0
    }
}

impl Target for Counts {
    fn window(&self) -> Window {
        self.window
    }

    fn span(&mut self, y: i32, columns: core::ops::Range<i32>) {
        assert!(
            (y, columns.start) >= self.last,
            "spans are out of order or overlap"
        );
        self.last = (y, columns.end);
        for x in columns {
            assert!(self.window.contains(IVec2::new(x, y)), "({x}, {y})");
            self.counts[(y * SIDE + x) as usize] += 1;
        }
    }
}

/// Corners in 1/256 of a pixel, some of them on pixel centres.
fn corner(range: core::ops::Range<i64>) -> impl Strategy<Value = [i64; 2]> {
    let coordinate = prop_oneof![range.clone(), range.prop_map(|c| c.div_euclid(128) * 128)];
    (coordinate.clone(), coordinate).prop_map(|(x, y)| [x, y])
}

fn pixels([x, y]: [i64; 2]) -> DVec2 {
    DVec2::new(x as f64, y as f64) / 256.0
}

/// Winding number of the centre of a pixel, moved by a hair to the right and a hair of a hair down, in integers.
fn winding(contours: &[Vec<[i64; 2]>], x: i32, y: i32) -> i32 {
    const HAIR: i128 = 1 << 30;
    let px = (i128::from(x) * 256 + 128) * HAIR * HAIR + HAIR;
    let py = (i128::from(y) * 256 + 128) * HAIR * HAIR + 1;
    let mut winding = 0;
    for contour in contours {
        for (k, from) in contour.iter().enumerate() {
            let to = contour[(k + 1) % contour.len()];
            let [ax, ay, bx, by] =
                [from[0], from[1], to[0], to[1]].map(|c| i128::from(c) * HAIR * HAIR);
            if (ay <= py) == (by <= py) {
                continue;
            }
            // Is the edge left of the point? Differences of corners are divided by the scale, which loses nothing.
            let [dx, dy] = [i128::from(to[0] - from[0]), i128::from(to[1] - from[1])];
            let side = (px - ax) * dy - (py - ay) * dx;
            if (side > 0) == (dy > 0) {
                winding += if dy > 0 { 1 } else { -1 };
            }
            assert_ne!(side, 0, "a hair off everything; {bx} {by}");
        }
    }
    winding
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn pixels_are_those_of_the_winding_number(
        contours in prop::collection::vec(prop::collection::vec(corner(-4000..12_000), 0..9), 1..4),
        is_even_odd in any::<bool>(),
    ) {
        let rule = if is_even_odd { FillRule::EvenOdd } else { FillRule::NonZero };
        let mut counts = Counts::new();
        counts.draw(|t| fill_polygon(t, contours.iter().map(|c| c.iter().map(|&p| pixels(p))), rule));
        for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
            let winding = winding(&contours, x, y);
            let expected = if is_even_odd { winding % 2 != 0 } else { winding != 0 };
            prop_assert_eq!(counts.is_set(x, y), expected, "pixel ({}, {})", x, y);
        }
    }

    #[test]
    fn triangles_cover_the_pixels_of_the_triangle_rasteriser(corners in prop::array::uniform3(corner(-2000..10_000))) {
        let mut counts = Counts::new();
        counts.draw(|t| fill_polygon(t, [corners.map(pixels)], FillRule::EvenOdd));
        let viewport = Viewport::new(32, 32);
        let mut depth = DepthBuffer::new(viewport);
        let vertices = corners.map(|[x, y]| {
            let (x, y) = (x as f32 / 4096.0 - 1.0, 1.0 - y as f32 / 4096.0);
            ClipVertex::new(Vec4::new(x, y, 0.5, 1.0), [])
        });
        let mut expected = vec![0; 32 * 32];
        draw_triangle(0..32, viewport, Cull::None, &vertices, depth.values_mut(), |x, y, _, _| {
            expected[y * 32 + x] = 1;
            true
        });
        prop_assert_eq!(counts.counts, expected);
    }

    #[test]
    fn parts_of_the_plane_cover_every_pixel_once(
        centre in (2.0_f64..30.0, 2.0_f64..30.0),
        mut angles in prop::collection::vec(0.0..std::f64::consts::TAU, 3..20),
    ) {
        angles.sort_by(f64::total_cmp);
        let centre = DVec2::from(centre);
        let rim: Vec<DVec2> = angles.iter().map(|&a| centre + DVec2::from_angle(a) * 1e4).collect();
        prop_assume!((0..rim.len()).all(|k| {
            let next = if k + 1 < angles.len() { angles[k + 1] } else { angles[0] + std::f64::consts::TAU };
            next - angles[k] < 2.5
        }));
        let mut counts = Counts::new();
        for k in 0..rim.len() {
            let wedge = [centre, rim[k], rim[(k + 1) % rim.len()]];
            counts.draw(|t| fill_polygon(t, [wedge], FillRule::NonZero));
        }
        prop_assert!(counts.counts.iter().all(|&c| c == 1), "{:?}", counts.counts);
    }

    #[test]
    fn no_input_panics(
        points in prop::collection::vec((prop::num::f64::ANY, prop::num::f64::ANY), 0..8),
        near in prop::collection::vec((-1e300_f64..1e300, -40.0_f64..40.0), 0..8),
    ) {
        let is_finite = points.iter().all(|p| p.0.is_finite() && p.1.is_finite());
        let mut counts = Counts::new();
        counts.draw(|t| fill_polygon(t, [points, near].map(|c| c.into_iter().map(DVec2::from)), FillRule::EvenOdd));
        prop_assert!(is_finite || counts.counts.iter().all(|&c| c == 0), "drawn with a number that is not finite");
    }

    #[test]
    fn a_stroke_is_what_is_near_the_path(
        points in prop::collection::vec((-5.0_f64..37.0, -5.0_f64..37.0), 2..6),
        width in 0.5_f64..9.0,
        is_closed in any::<bool>(),
    ) {
        let points: Vec<DVec2> = points.into_iter().map(DVec2::from).collect();
        let path = if is_closed { Path::closed(points.clone()) } else { Path::open(points.clone()) };
        let stroke = Stroke::new(width).with_cap(Cap::Round).with_join(Join::Round);
        let mut counts = Counts::new();
        counts.draw(|t| draw_stroke(t, &path, &stroke));
        let mut ends: Vec<[DVec2; 2]> = points.windows(2).map(|p| [p[0], p[1]]).collect();
        if is_closed {
            ends.push([points[points.len() - 1], points[0]]);
        }
        for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
            let centre = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
            let off = ends.iter().map(|&[a, b]| {
                let t = ((centre - a).dot(b - a) / (b - a).length_squared().max(1e-300)).clamp(0.0, 1.0);
                centre.distance(a.lerp(b, t))
            }).fold(f64::INFINITY, f64::min);
            if off < 0.5 * width - 0.02 {
                prop_assert!(counts.is_set(x, y), "({}, {}) is {} off", x, y, off);
            } else if off > 0.5 * width + 1e-9 {
                prop_assert!(!counts.is_set(x, y), "({}, {}) is {} off", x, y, off);
            }
        }
    }

    #[test]
    fn thick_dashes_keep_their_phase_when_clipped(from in (-1e6_f64..0.0, -1e6_f64..0.0), to in (10.0_f64..1e6, 10.0_f64..1e6), phase in 0.0_f64..9.0) {
        let (from, to) = (DVec2::from(from), DVec2::from(to));
        let stroke = Stroke::new(3.0).with_dashes(Dashes::new(&[5.0, 4.0], phase).expect("good dashes"));
        let mut counts = Counts::new();
        counts.draw(|t| draw_stroke(t, &Path::open([from, to]), &stroke));
        let direction = (to - from).normalize();
        for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
            let gone = DVec2::new(f64::from(x), f64::from(y)) + 0.5 - from;
            let (along, across) = ((gone.dot(direction) + phase).rem_euclid(9.0), gone.perp_dot(direction).abs());
            let is_sure = [along, (along - 5.0).abs(), 9.0 - along, (across - 1.5).abs()].iter().all(|&d| d > 1e-6);
            if is_sure {
                prop_assert_eq!(counts.is_set(x, y), along < 5.0 && across < 1.5, "({}, {})", x, y);
            }
        }
    }
}

/// Pixels set by a stroke along a right angle.
fn corner_of(join: Join, limit: f64) -> Counts {
    let path = Path::open([
        DVec2::new(4.0, 10.0),
        DVec2::new(20.0, 10.0),
        DVec2::new(20.0, 28.0),
    ]);
    let mut counts = Counts::new();
    let stroke = Stroke::new(8.0).with_join(join).with_miter_limit(limit);
    counts.draw(|t| draw_stroke(t, &path, &stroke));
    counts
}

#[test]
fn joins_fill_the_outer_corner() {
    let set = |counts: &Counts| counts.counts.iter().sum::<u32>();
    let (bevel, round, miter) = (
        corner_of(Join::Bevel, 4.0),
        corner_of(Join::Round, 4.0),
        corner_of(Join::Miter, 4.0),
    );
    // Of the outer corner of 4 x 4 pixels a bevel has 6 (4 centres lie on its edge), a quarter of a disc 13.
    assert_eq!(
        (set(&round) - set(&bevel), set(&miter) - set(&bevel)),
        (7, 10),
        "pixels more than a bevel"
    );
    assert!(
        miter.is_set(23, 6) && !bevel.is_set(23, 6),
        "the outermost pixel"
    );
    assert_eq!(
        set(&corner_of(Join::Miter, 1.4)),
        set(&bevel),
        "a mitre of 1.414 widths is above the limit"
    );
}

#[test]
fn a_path_of_one_point_is_a_dot_if_it_has_caps() {
    let dot = |cap| {
        let mut counts = Counts::new();
        let path = Path::open([DVec2::splat(10.0), DVec2::splat(10.0)]);
        counts.draw(|t| draw_stroke(t, &path, &Stroke::new(6.0).with_cap(cap)));
        counts.counts.iter().sum::<u32>()
    };
    assert_eq!(
        (dot(Cap::Butt), dot(Cap::Square), dot(Cap::Round)),
        (0, 36, 32)
    );
}

#[test]
fn a_star_of_lines_and_its_hole() {
    let star: Vec<DVec2> = (0..5)
        .map(|k| DVec2::from_angle(f64::from(2 * k) * std::f64::consts::TAU / 5.0) * 15.0 + 16.0)
        .collect();
    for (rule, is_set) in [(FillRule::EvenOdd, false), (FillRule::NonZero, true)] {
        let mut counts = Counts::new();
        counts.draw(|t| fill_polygon(t, [star.clone()], rule));
        assert_eq!(
            counts.is_set(16, 16),
            is_set,
            "the middle of a pentagram under {rule:?}"
        );
        assert!(counts.is_set(28, 16), "a tip");
    }
}

#[test]
fn dashes_from_far_away_or_of_huge_width_come_to_an_end() {
    let dashes = Dashes::new(&[3.0, 2.0], 1.0).expect("good dashes");
    assert_eq!(
        dashes.intervals(1e140..1e150).count(),
        0,
        "f64 does not tell them apart"
    );
    for cap in [Cap::Butt, Cap::Round, Cap::Square] {
        for (far, width) in [
            (1e149, 3.0),
            (1e16, 3.0),
            (1e16, 1e15),
            (1e3, 1e9),
            (1e9, 6e4),
        ] {
            let path = Path::open([DVec2::new(-far, 3.0), DVec2::new(far, 5.0)]);
            let stroke = Stroke::new(width).with_cap(cap).with_dashes(dashes.clone());
            let mut counts = Counts::new();
            counts.draw(|t| draw_stroke(t, &path, &stroke));
        }
    }
}
