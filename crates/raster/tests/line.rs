//! Lines against exact rounding, and what is clipped against the whole.

use glam::IVec2;
use hemicube_raster::line::{
    Bresenham, DashError, Dashes, Dda, Equation, draw_dashed_line, draw_line,
};
use hemicube_raster::target::Window;
use hemicube_raster::{Image, Rgb};
use proptest::prelude::*;
use std::collections::BTreeSet;

type Pixels = Vec<[i32; 2]>;

/// The pixels that something sets, sorted; panics if it sets one twice or outside of the window.
fn drawn(
    window: Window,
    draw: impl FnOnce(&mut (Window, &mut dyn FnMut(i32, core::ops::Range<i32>))),
) -> Pixels {
    let mut pixels = Vec::new();
    let mut span = |y: i32, x: core::ops::Range<i32>| {
        assert!(!x.is_empty(), "an empty span in row {y}");
        pixels.extend(x.map(|x| [x, y]));
    };
    draw(&mut (window, &mut span));
    let set: BTreeSet<[i32; 2]> = pixels.iter().copied().collect();
    assert_eq!(set.len(), pixels.len(), "a pixel is drawn twice");
    for &[x, y] in &set {
        assert!(
            window.contains(IVec2::new(x, y)),
            "({x}, {y}) is not in {window:?}"
        );
    }
    set.into_iter().collect()
}

/// The pixels of a line in a window by definition: in each column (row, if steep) `floor(y + 1/2)` of the true line.
fn expected(from: IVec2, to: IVec2, window: Window) -> Pixels {
    let [dx, dy] = [
        i128::from(to.x) - i128::from(from.x),
        i128::from(to.y) - i128::from(from.y),
    ];
    let is_steep = dy.abs() > dx.abs();
    let swap = |[x, y]: [i128; 2]| if is_steep { [y, x] } else { [x, y] };
    let [length, rise] = swap([dx, dy]);
    let [x0, y0] = swap(from.to_array().map(i128::from));
    let columns = if is_steep {
        window.top..window.bottom
    } else {
        window.left..window.right
    };
    let mut pixels: Pixels = columns
        .map(i128::from)
        .filter(|x| (x0.min(x0 + length)..=x0.max(x0 + length)).contains(x))
        .map(|x| {
            let y = if length == 0 {
                y0
            } else {
                y0 + (2 * (x - x0) * rise * length.signum() + length.abs())
                    .div_euclid(2 * length.abs())
            };
            swap([x, y]).map(|c| i32::try_from(c).expect("between the ends"))
        })
        .filter(|&[x, y]| window.contains(IVec2::new(x, y)))
        .collect();
    pixels.sort_unstable();
    pixels
}

fn sorted(pixels: impl Iterator<Item = IVec2>) -> Pixels {
    let mut pixels: Pixels = pixels.map(|p| p.to_array()).collect();
    pixels.sort_unstable();
    pixels
}

/// Near the window, far away, and at the ends of what there is.
fn coordinate() -> impl Strategy<Value = i32> {
    prop_oneof![
        6 => -40..60_i32,
        2 => -3000..3000_i32,
        2 => any::<i32>(),
        1 => prop::sample::select(vec![i32::MIN, i32::MIN + 1, i32::MAX, i32::MAX - 1, 0]),
    ]
}

fn point() -> impl Strategy<Value = IVec2> {
    (coordinate(), coordinate()).prop_map(|(x, y)| IVec2::new(x, y))
}

fn window() -> impl Strategy<Value = Window> {
    let side = prop_oneof![8 => -5..30_i32, 1 => Just(i32::MAX - 40), 1 => Just(i32::MIN)];
    (side.clone(), side, 0..40_i32, 0..40_i32)
        .prop_map(|(x, y, width, height)| Window::new(x..x + width, y..y + height))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn pixels_are_those_of_exact_rounding(from in point(), to in point(), window in window()) {
        let expected = expected(from, to, window);
        prop_assert_eq!(&drawn(window, |target| draw_line(target, from, to)), &expected, "draw_line");
        prop_assert_eq!(&sorted(Bresenham::within(from, to, &window).map(|s| s.pixel)), &expected, "Bresenham");
        prop_assert_eq!(&drawn(window, |target| draw_line(target, to, from)), &expected, "from the other end");
    }

    #[test]
    fn flat_lines_are_exact_run_by_run(x in -200..500_i32, y in -20..40_i32, dx in -900..900_i32, dy in -60..60_i32) {
        let window = Window::new(0..300, 0..20);
        let (from, to) = (IVec2::new(x, y), IVec2::new(x + dx, y + dy));
        let expected = expected(from, to, window);
        prop_assert_eq!(drawn(window, |target| draw_line(target, from, to)), expected);
    }

    #[test]
    fn a_clipped_walk_is_part_of_the_whole(from in (-60..60_i32, -60..60_i32), to in (-60..60_i32, -60..60_i32), window in window()) {
        let [from, to] = [from, to].map(|(x, y)| IVec2::new(x, y));
        let is_inside = |pixel: IVec2| window.contains(pixel);
        let whole: Vec<_> = Bresenham::new(from, to).filter(|s| is_inside(s.pixel)).collect();
        prop_assert_eq!(Bresenham::within(from, to, &window).collect::<Vec<_>>(), whole, "Bresenham");
        let whole: Vec<_> = Dda::new(from, to).filter(|s| is_inside(s.pixel)).collect();
        prop_assert_eq!(Dda::within(from, to, &window).collect::<Vec<_>>(), whole, "DDA");
        let whole: Vec<_> = Equation::new(from, to).filter(|s| is_inside(s.pixel)).collect();
        prop_assert_eq!(Equation::within(from, to, &window).collect::<Vec<_>>(), whole, "equation");
    }

    #[test]
    fn the_three_ways_differ_at_ties_only(from in point(), to in point(), window in window()) {
        let bresenham: Vec<_> = Bresenham::within(from, to, &window).collect();
        for other in [Dda::within(from, to, &window).collect::<Vec<_>>(), Equation::within(from, to, &window).collect()] {
            for step in other {
                let off = (step.ideal - step.pixel.as_dvec2()).abs().max_element();
                prop_assert!(off < 0.5 + 1e-5, "{:?} is {} off", step, off);
                prop_assert!((-0.5..=0.5).contains(&step.error), "{:?}", step);
                if off < 0.5 - 1e-5 {
                    prop_assert!(bresenham.iter().any(|b| b.pixel == step.pixel), "{:?} is not Bresenham's", step);
                }
            }
        }
    }

    #[test]
    fn error_terms_are_the_distance_from_the_middle(from in (-60..60_i32, -60..60_i32), to in (-60..60_i32, -60..60_i32)) {
        let [from, to] = [from, to].map(|(x, y)| IVec2::new(x, y));
        let d = (to - from).abs();
        let (length, rise) = (i64::from(d.max_element()), i64::from(d.min_element()));
        let falls = if d.y > d.x { to.x < from.x } else { to.y < from.y };
        for step in Bresenham::new(from, to) {
            let off = (step.ideal - step.pixel.as_dvec2()).abs().max_element();
            let signed = if (step.ideal - step.pixel.as_dvec2()).dot((to - from).as_dvec2()) < 0.0 { -off } else { off };
            let expected = 2.0 * length as f64 * (signed - 0.5) + 2.0 * rise as f64 - f64::from(u8::from(falls));
            if off < 0.5 {
                prop_assert!((step.error as f64 - expected).abs() < 1e-9, "{:?}: {}", step, expected);
            }
        }
    }

    #[test]
    fn dashes_keep_their_phase_when_clipped(
        from in point(),
        to in point(),
        window in window(),
        lengths in prop::collection::vec(0.0_f64..9.0, 1..5),
        phase in -1e4_f64..1e4,
    ) {
        let dashes = match Dashes::new(&lengths, phase) {
            Ok(dashes) => dashes,
            Err(error) => {
                prop_assert!(lengths.iter().sum::<f64>() < 0.26, "{}", error);
                return Ok(());
            }
        };
        // By definition: each pixel of the line asks the pattern.
        let d = (to.as_dvec2() - from.as_dvec2()).abs();
        let major = d.max_element().max(1.0);
        let ends: Vec<f64> = lengths.iter().chain(&lengths).scan(0.0, |end, l| { *end += l; Some(*end) }).collect();
        let ends = if lengths.len() % 2 == 0 { &ends[..lengths.len()] } else { &ends };
        let period = *ends.last().expect("not empty");
        let mut maybe = 0;
        let mut on = Vec::new();
        for step in Bresenham::within(from, to, &window) {
            let gone = (step.pixel.as_dvec2() - from.as_dvec2()).abs();
            let steps = if d.y > d.x { gone.y } else { gone.x };
            let at = (steps * d.length() / major + phase).rem_euclid(period);
            let before = ends.iter().position(|&end| at < end).unwrap_or(0);
            let distance = ends.iter().map(|end| (end - at).abs()).fold(at.min(period - at), f64::min);
            if distance < 1e-5 {
                maybe += 1;
            } else if before % 2 == 0 {
                on.push(step.pixel.to_array());
            }
        }
        on.sort_unstable();
        let drawn = drawn(window, |target| draw_dashed_line(target, from, to, &dashes));
        prop_assert!(on.iter().all(|p| drawn.contains(p)), "a pixel of a dash is missing");
        prop_assert!(drawn.len() <= on.len() + maybe, "{} drawn, {} on dashes", drawn.len(), on.len());
    }
}

#[test]
fn a_point_is_a_line_of_one_pixel() {
    let p = IVec2::new(3, -4);
    assert_eq!(
        Bresenham::new(p, p).map(|s| s.pixel).collect::<Vec<_>>(),
        [p]
    );
    assert_eq!(Dda::new(p, p).map(|s| s.pixel).collect::<Vec<_>>(), [p]);
    assert_eq!(
        Equation::new(p, p).map(|s| s.pixel).collect::<Vec<_>>(),
        [p]
    );
    let mut image = Image::filled(3, 3, 0_u8);
    draw_line(&mut image.pen(1), IVec2::ONE, IVec2::ONE);
    assert_eq!(image.pixels(), [0, 0, 0, 0, 1, 0, 0, 0, 0]);
    let dashes = Dashes::new(&[1.0, 1.0], 0.0).expect("good dashes");
    draw_dashed_line(&mut image.pen(2), IVec2::ONE, IVec2::ONE, &dashes);
    assert_eq!(image.pixel(1, 1), &2, "the first pixel of a dash");
}

#[test]
fn the_one_slope_dda_leaves_gaps_in_steep_lines() {
    let count = |x, y| Dda::along_x(IVec2::ZERO, IVec2::new(x, y)).count();
    assert_eq!(count(20, 10), 21, "flat");
    assert_eq!(count(5, -20), 6, "steep");
    assert_eq!(count(0, 20), 1, "vertical");
    let rows: Vec<i32> = Dda::along_x(IVec2::ZERO, IVec2::new(3, 9))
        .map(|s| s.pixel.y)
        .collect();
    assert_eq!(rows, [0, 3, 6, 9]);
    assert_eq!(
        Dda::new(IVec2::ZERO, IVec2::new(3, 9)).count(),
        10,
        "with the roles swapped"
    );
}

#[test]
fn the_longest_line_takes_no_time_outside() {
    let mut image = Image::filled(64, 48, Rgb::BLACK);
    let (from, to) = (
        IVec2::new(i32::MIN, i32::MIN),
        IVec2::new(i32::MAX, i32::MAX - 5),
    );
    for _ in 0..10_000 {
        draw_line(&mut image.pen(Rgb::WHITE), from, to);
    }
    let white = image.pixels().iter().filter(|&&p| p == Rgb::WHITE).count();
    assert_eq!(white, expected(from, to, Window::of(&image)).len());
}

#[test]
fn bad_dashes_say_what_is_wrong() {
    let error = |lengths: &[f64], phase| Dashes::new(lengths, phase).expect_err("bad").to_string();
    assert_eq!(
        error(&[1.0, -2.0], 0.0),
        "dash 1 is -2 pixels long; give a length that is finite and not negative"
    );
    assert_eq!(
        error(&[f64::NAN], 0.0),
        "dash 0 is NaN pixels long; give a length that is finite and not negative"
    );
    assert_eq!(
        Dashes::new(&[], 0.0),
        Err(DashError::Period { period: 0.0 })
    );
    assert_eq!(
        Dashes::new(&[1e300], 0.0),
        Err(DashError::Period { period: 2e300 })
    );
    assert_eq!(
        error(&[1.0], f64::INFINITY),
        "a phase of inf pixels; give a finite one"
    );
}

#[test]
fn an_odd_pattern_is_taken_twice() {
    let dashes = Dashes::new(&[3.0], -1.0).expect("good dashes");
    assert_eq!((dashes.period(), dashes.phase()), (6.0, 5.0));
    assert_eq!(
        dashes.intervals(0.0..10.0).collect::<Vec<_>>(),
        [1.0..4.0, 7.0..10.0]
    );
    assert_eq!(dashes.intervals(f64::NAN..10.0).count(), 0);
}
