//! Circles and ellipses against their definitions, and what is clipped against the whole.

use glam::IVec2;
use hemicube_raster::circle::{Octant, draw_circle, fill_circle};
use hemicube_raster::ellipse::{draw_ellipse, fill_ellipse};
use hemicube_raster::target::{Target, Window};
use proptest::prelude::*;
use std::collections::BTreeSet;

type Pixels = BTreeSet<[i32; 2]>;

/// The pixels that something sets; panics if it sets one twice or outside of the window.
fn drawn<D: FnOnce(&mut Recorder)>(window: Window, draw: D) -> Pixels {
    let mut recorder = Recorder(window, Pixels::new());
    draw(&mut recorder);
    recorder.1
}

struct Recorder(Window, Pixels);

impl Target for Recorder {
    fn window(&self) -> Window {
        self.0
    }

    fn span(&mut self, y: i32, columns: core::ops::Range<i32>) {
        assert!(!columns.is_empty(), "an empty span in row {y}");
        for x in columns {
            assert!(
                self.0.contains(IVec2::new(x, y)),
                "({x}, {y}) is not in {:?}",
                self.0
            );
            assert!(self.1.insert([x, y]), "({x}, {y}) is drawn twice");
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "small radii")]
fn rounded(number: f64) -> i32 {
    number.round() as i32
}

/// By definition: between the diagonals the pixel nearest to the true height in each column, or width in each row.
fn circle(radius: i32) -> Pixels {
    let mut pixels = Pixels::new();
    let r = f64::from(radius);
    for x in 0..=radius {
        let y = rounded((r * r - f64::from(x).powi(2)).sqrt());
        if x <= y {
            for (x, y) in [(x, y), (y, x)] {
                pixels.extend([[x, y], [-x, y], [x, -y], [-x, -y]]);
            }
        }
    }
    pixels
}

/// By definition: one pixel for each column up to where the slope is -1, from there on one for each row; without those
/// that may link the two.
fn ellipse(a: i32, b: i32) -> Pixels {
    let mut pixels = Pixels::new();
    let [a_, b_] = [f64::from(a), f64::from(b)];
    let corner = a_.hypot(b_);
    let mut four = |x: i32, y: i32| pixels.extend([[x, y], [-x, y], [x, -y], [-x, -y]]);
    for x in (0..=a).filter(|&x| f64::from(x) <= a_ * a_ / corner) {
        four(x, rounded(b_ * (1.0 - (f64::from(x) / a_).powi(2)).sqrt()));
    }
    for y in (0..=b).filter(|&y| f64::from(y) <= b_ * b_ / corner) {
        four(rounded(a_ * (1.0 - (f64::from(y) / b_).powi(2)).sqrt()), y);
    }
    pixels
}

fn moved(pixels: &Pixels, center: IVec2, window: Window) -> Pixels {
    let moved = pixels.iter().map(|p| [p[0] + center.x, p[1] + center.y]);
    moved
        .filter(|&[x, y]| window.contains(IVec2::new(x, y)))
        .collect()
}

/// Everything between the outermost pixels of each row.
fn filled(pixels: &Pixels) -> Pixels {
    let mut full = Pixels::new();
    for &[x, y] in pixels {
        full.extend((-x.abs()..=x.abs()).map(|x| [x, y]));
    }
    full
}

const EVERYWHERE: Window = Window::new(-3000..3000, -3000..3000);

#[test]
fn circles_are_those_of_rounding() {
    for radius in (0..70).chain([500, 1000, 2999]) {
        let whole = drawn(EVERYWHERE, |t| draw_circle(t, IVec2::ZERO, radius));
        assert_eq!(whole, circle(radius), "radius {radius}");
        if radius < 600 {
            let full = drawn(EVERYWHERE, |t| fill_circle(t, IVec2::ZERO, radius));
            assert_eq!(full, filled(&whole), "filled, radius {radius}");
        }
    }
}

#[test]
fn ellipses_are_those_of_rounding_and_linked() {
    for a in 1..40 {
        for b in 1..40 {
            let radii = IVec2::new(a, b);
            let whole = drawn(EVERYWHERE, |t| draw_ellipse(t, IVec2::ZERO, radii));
            let expected = ellipse(a, b);
            assert!(whole.is_superset(&expected), "{radii}");
            assert!(whole.len() <= expected.len() + 4, "{radii}");
            assert_eq!(neighbours_missing(&whole), 0, "{radii} has gaps");
            let full = drawn(EVERYWHERE, |t| fill_ellipse(t, IVec2::ZERO, radii));
            assert_eq!(full, filled(&whole), "{radii} filled");
        }
        let round = drawn(EVERYWHERE, |t| {
            draw_ellipse(t, IVec2::ZERO, IVec2::splat(a));
        });
        let more: Vec<[i32; 2]> = circle(a).difference(&round).copied().collect();
        assert!(circle(a).is_superset(&round), "of equal radii {a}");
        assert!(
            more.iter().all(|p| p[0].abs() == p[1].abs()),
            "radius {a}: {more:?}"
        );
    }
}

/// Pixels without a neighbour on both sides; tips have one where both sides are the same pixel.
fn neighbours_missing(pixels: &Pixels) -> usize {
    let has_both = |&[x, y]: &[i32; 2]| {
        let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy]));
        let with_itself = around.filter(|p| pixels.contains(p)).count();
        with_itself >= if x == 0 || y == 0 { 2 } else { 3 }
    };
    pixels.iter().filter(|p| !has_both(p)).count()
}

#[test]
fn radii_of_zero_and_below() {
    let one: Pixels = [[5, 6]].into();
    let center = IVec2::new(5, 6);
    assert_eq!(drawn(EVERYWHERE, |t| draw_circle(t, center, 0)), one);
    assert_eq!(drawn(EVERYWHERE, |t| fill_circle(t, center, 0)), one);
    assert_eq!(
        drawn(EVERYWHERE, |t| draw_ellipse(t, center, IVec2::ZERO)),
        one
    );
    assert_eq!(
        drawn(EVERYWHERE, |t| fill_ellipse(t, center, IVec2::new(3, 0))).len(),
        7
    );
    assert_eq!(
        drawn(EVERYWHERE, |t| draw_ellipse(t, center, IVec2::new(0, 3))).len(),
        7
    );
    for radius in [-1, i32::MIN] {
        assert!(drawn(EVERYWHERE, |t| draw_circle(t, center, radius)).is_empty());
        assert!(drawn(EVERYWHERE, |t| fill_circle(t, center, radius)).is_empty());
        assert!(
            drawn(EVERYWHERE, |t| draw_ellipse(
                t,
                center,
                IVec2::new(radius, 3)
            ))
            .is_empty()
        );
        assert!(
            drawn(EVERYWHERE, |t| fill_ellipse(
                t,
                center,
                IVec2::new(3, radius)
            ))
            .is_empty()
        );
        assert_eq!(Octant::new(radius).count(), 0);
    }
}

#[test]
fn an_octant_tells_its_terms() {
    for radius in [0, 1, 2, 7, 1000, i32::MAX] {
        let r = i128::from(radius);
        for step in Octant::new(radius).take(2000) {
            let [x, y] = step.point.to_array().map(i128::from);
            let at = |x: i128, y: i128| x * x + y * y - y - r * r;
            assert_eq!(i128::from(step.decision), at(x + 1, y), "{step:?}");
            assert_eq!(
                i128::from(step.east),
                at(x + 2, y) - at(x + 1, y),
                "{step:?}"
            );
            assert_eq!(
                i128::from(step.south_east),
                at(x + 2, y - 1) - at(x + 1, y),
                "{step:?}"
            );
        }
    }
}

fn coordinate() -> impl Strategy<Value = i32> {
    prop_oneof![6 => -40..60_i32, 1 => any::<i32>(), 1 => prop::sample::select(vec![i32::MIN, i32::MAX])]
}

fn window() -> impl Strategy<Value = Window> {
    (-5..30_i32, -5..30_i32, 0..40_i32, 0..40_i32)
        .prop_map(|(x, y, width, height)| Window::new(x..x + width, y..y + height))
}

/// The pixels of an ellipse in a window, found pixel by pixel: those that exact arithmetic calls nearest in their column
/// or row. Without links.
fn huge(center: IVec2, [a, b]: [i128; 2], window: Window) -> Pixels {
    let mut pixels = Pixels::new();
    let corner = a * a + b * b;
    for y in window.top..window.bottom {
        for x in window.left..window.right {
            let u = (i128::from(x) - i128::from(center.x)).abs();
            let v = (i128::from(y) - i128::from(center.y)).abs();
            if u > a || v > b {
                continue;
            }
            // |a sqrt(1 - v^2 / b^2) - u| < 1/2, squared.
            let near = |a: i128, b: i128, u: i128, v: i128| {
                let square = 4 * a * a * (b * b - v * v);
                (u == 0 || b * b * (2 * u - 1).pow(2) <= square)
                    && square < b * b * (2 * u + 1).pow(2)
            };
            // x <= a^2 / sqrt(a^2 + b^2)
            let is_flat = u * u <= a.pow(4) / corner;
            let is_steep = v * v <= b.pow(4) / corner;
            if is_flat && near(b, a, v, u) || is_steep && near(a, b, u, v) {
                pixels.insert([x, y]);
            }
        }
    }
    pixels
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn clipped_ones_are_part_of_the_whole(x in -40..60_i32, y in -40..60_i32, a in 0..80_i32, b in 0..80_i32, window in window()) {
        let center = IVec2::new(x, y);
        let radii = IVec2::new(a, b);
        let whole = circle(a);
        prop_assert_eq!(drawn(window, |t| draw_circle(t, center, a)), moved(&whole, center, window));
        prop_assert_eq!(drawn(window, |t| fill_circle(t, center, a)), moved(&filled(&whole), center, window));
        let whole = drawn(EVERYWHERE, |t| draw_ellipse(t, IVec2::ZERO, radii));
        prop_assert_eq!(drawn(window, |t| draw_ellipse(t, center, radii)), moved(&whole, center, window));
        prop_assert_eq!(drawn(window, |t| fill_ellipse(t, center, radii)), moved(&filled(&whole), center, window));
    }

    #[test]
    fn huge_ones_are_exact_where_they_cross_the_window(
        [dx, dy] in [-30..60_i32, -30..60_i32],
        side in 0..4,
        a in 1_000..=i32::MAX,
        b in 1_000..=i32::MAX,
        window in window(),
    ) {
        // A tip of the ellipse comes to lie near the window.
        let tip = |radii: IVec2| match side {
            0 => IVec2::new(dx, dy.saturating_sub(radii.y)),
            1 => IVec2::new(dx, dy.saturating_add(radii.y)),
            2 => IVec2::new(dx.saturating_sub(radii.x), dy),
            _ => IVec2::new(dx.saturating_add(radii.x), dy),
        };
        let center = tip(IVec2::splat(a));
        prop_assert_eq!(drawn(window, |t| draw_circle(t, center, a)), huge(center, [a, a].map(i128::from), window));
        let center = tip(IVec2::new(a, b));
        let expected = huge(center, [a, b].map(i128::from), window);
        let found = drawn(window, |t| draw_ellipse(t, center, IVec2::new(a, b)));
        prop_assert!(found.is_superset(&expected) && found.len() <= expected.len() + 1, "{:?} {:?}", found, expected);
    }

    #[test]
    fn nothing_panics(x in coordinate(), y in coordinate(), a in any::<i32>(), b in any::<i32>(), window in window()) {
        let (center, radii) = (IVec2::new(x, y), IVec2::new(a, b));
        drawn(window, |t| draw_circle(t, center, a));
        drawn(window, |t| fill_circle(t, center, a));
        drawn(window, |t| draw_ellipse(t, center, radii));
        drawn(window, |t| fill_ellipse(t, center, radii));
    }
}
