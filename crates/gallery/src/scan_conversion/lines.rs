//! Lines three ways, and antialiased.

use super::figure::{INK, Sheet, TRUE, rgb};
use crate::{Exhibit, GalleryError, Piece, Request};
use glam::{DVec2, IVec2};
use hemicube_chart::{Chart, Curve, Scale};
use hemicube_raster::line::{Bresenham, Dda, Equation, Step, antialiased, draw_line};
use hemicube_raster::{Image, Rgb};

pub const LINES: Exhibit = Exhibit {
    name: "lines",
    about: "a line by its equation, by the DDA and by Bresenham; the gaps of a DDA along x; error terms",
    needs: &[],
    draw: draw_lines,
};

pub const ANTIALIASED_LINES: Exhibit = Exhibit {
    name: "antialiased-lines",
    about: "a fan of lines of exact coverage beside whole pixels, and how their light varies with the angle",
    needs: &[],
    draw: draw_antialiased,
};

const PIXEL: [u8; 3] = [120, 160, 205];
const STEEP: [IVec2; 2] = [IVec2::new(2, 17), IVec2::new(7, 2)];
const FLAT: [IVec2; 2] = [IVec2::new(1, 18), IVec2::new(16, 13)];

/// Pixels and the true line's points in them.
type Steps = Vec<(IVec2, DVec2)>;

fn steps<E>(line: impl Iterator<Item = Step<E>>) -> Steps {
    line.map(|step| (step.pixel, step.ideal)).collect()
}

/// Consecutive pixels that do not touch.
fn gaps(steps: &Steps) -> usize {
    let is_gap = |pair: &&[(IVec2, DVec2)]| (pair[1].0 - pair[0].0).abs().max_element() > 1;
    steps.windows(2).filter(is_gap).count()
}

fn draw_lines(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let mut sheet = Sheet::new(request, (1600, 520), 4, [18, 20])?;
    type Way = fn(IVec2, IVec2) -> Steps;
    let ways: [(&str, Way); 4] = [
        ("DDA along x only: gaps", |a, b| steps(Dda::along_x(a, b))),
        ("Equation y = m x + b", |a, b| steps(Equation::new(a, b))),
        ("DDA, roles swapped", |a, b| steps(Dda::new(a, b))),
        ("Bresenham", |a, b| steps(Bresenham::new(a, b))),
    ];
    for (panel, (title, way)) in ways.into_iter().enumerate() {
        let lines = [STEEP, FLAT].map(|[from, to]| way(from, to));
        let mut pixels = Image::filled(18, 20, Rgb::WHITE);
        for (pixel, _) in lines.iter().flatten() {
            *pixels.pixel_mut(pixel.x as usize, pixel.y as usize) = rgb(PIXEL);
        }
        sheet.pixels(panel, &pixels);
        for (steps, ends) in lines.iter().zip([STEEP, FLAT]) {
            sheet.line(panel, ends.map(|p| p.as_dvec2() + 0.5), TRUE, 2.0);
            for (_, ideal) in steps {
                sheet.cross(panel, *ideal + 0.5, INK);
            }
        }
        let count: usize = lines.iter().map(Vec::len).sum();
        let gaps: usize = lines.iter().map(gaps).sum();
        let captions = [
            format!("{count} pixels, {gaps} gaps"),
            about(panel).to_owned(),
        ];
        sheet.label(panel, title, &captions);
    }
    Ok(vec![
        Piece::sheet("", &sheet.finish())?,
        Piece::chart("-error", &error_chart(), (900, 480)),
    ])
}

fn about(panel: usize) -> &'static str {
    [
        "one pixel in each column",
        "a multiplication a pixel",
        "an addition a pixel",
        "integers only",
    ][panel]
}

/// What Bresenham decides by along the flat line, scaled to pixels, and how far its pixels are off.
fn error_chart() -> Chart {
    let [from, to] = FLAT;
    let doubled = 2.0 * f64::from((to - from).abs().max_element());
    let line: Vec<Step<i64>> = Bresenham::new(from, to).collect();
    let curve = |name: &str, value: &dyn Fn(&Step<i64>) -> f64| {
        let points = line.iter().enumerate();
        Curve::new(name, points.map(|(i, s)| (i as f64, value(s))).collect())
    };
    Chart {
        title: String::from("Bresenham: at an error term of 0 or more the next step goes across"),
        x_label: String::from("step"),
        y_label: String::from("pixels across"),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        curves: vec![
            curve("error term / 2 dx", &|s| s.error as f64 / doubled),
            curve("true line - pixel", &|s| s.pixel.as_dvec2().y - s.ideal.y),
            curve("0", &|_| 0.0),
        ],
    }
}

const CENTRE: DVec2 = DVec2::new(32.5, 32.5);

/// A ray of the fan.
fn ray(angle: f64, radii: [f64; 2]) -> [DVec2; 2] {
    radii.map(|radius| CENTRE + DVec2::from_angle(angle) * radius)
}

fn draw_antialiased(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let mut sheet = Sheet::new(request, (1500, 620), 3, [65, 65])?;
    let white = Image::filled(65, 65, Rgb::WHITE);
    let (mut whole, mut thin, mut wide) = (white.clone(), white.clone(), white);
    for k in 0..36 {
        let angle = f64::from(k) * std::f64::consts::TAU / 36.0;
        let ends = ray(angle, [8.0, 31.0]);
        let [from, to] = ends.map(|p| p.floor().as_ivec2());
        draw_line(&mut whole.pen(rgb(INK)), from, to);
        antialiased::draw_line(&mut thin.pen(rgb(INK)), ends[0], ends[1], 1.0);
        if k % 2 == 0 {
            antialiased::draw_line(&mut wide.pen(rgb(INK)), ends[0], ends[1], 2.2);
        }
    }
    let spread = |light: fn(f64) -> f64| {
        let lights = (0..360).map(|k| light(f64::from(k).to_radians()));
        let start = (f64::INFINITY, 0.0_f64);
        let (low, high) = lights.fold(start, |(low, high), x| (low.min(x), high.max(x)));
        100.0 * (high - low) / high
    };
    let varies = |spread: f64| format!("light per length varies by {spread:.4} %");
    let captions = [
        varies(spread(light_of_whole)),
        varies(spread(light_of_exact)),
        String::from("any width"),
    ];
    let titles = ["Bresenham", "Exact area, width 1", "Exact area, width 2.2"];
    for (panel, image) in [whole, thin, wide].iter().enumerate() {
        sheet.pixels(panel, image);
        sheet.label(panel, titles[panel], &captions[panel..=panel]);
    }
    Ok(vec![
        Piece::sheet("", &sheet.finish())?,
        Piece::chart("-light", &light_chart(), (900, 480)),
    ])
}

/// Pixels of a Bresenham line for each of its length at an angle.
fn light_of_whole(angle: f64) -> f64 {
    let (from, to) = (
        IVec2::ZERO,
        (DVec2::from_angle(angle) * 1000.0).round().as_ivec2(),
    );
    Bresenham::new(from, to).count() as f64 / to.as_dvec2().length()
}

/// Coverage of an antialiased line of width 1 for each of its length at an angle.
fn light_of_exact(angle: f64) -> f64 {
    let mut coverage = Image::filled(65, 65, 0.0_f32);
    let [from, to] = ray(angle, [-30.0, 30.0]);
    antialiased::draw_line(&mut coverage.pen(1.0), from, to, 1.0);
    coverage.pixels().iter().map(|&c| f64::from(c)).sum::<f64>() / 60.0
}

fn light_chart() -> Chart {
    let curve = |name: &str, light: fn(f64) -> f64| {
        let angles = (0..=90).map(f64::from);
        Curve::new(name, angles.map(|a| (a, light(a.to_radians()))).collect())
    };
    Chart {
        title: String::from("Light of a line of width 1 for each pixel of its length"),
        x_label: String::from("degrees"),
        y_label: String::from("covered pixels / length"),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        curves: vec![
            curve("whole pixels", light_of_whole),
            curve("exact area", light_of_exact),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_dda_along_x_has_gaps() {
        let [from, to] = STEEP;
        assert_eq!(gaps(&steps(Dda::along_x(from, to))), 5);
        assert_eq!(gaps(&steps(Dda::new(from, to))), 0);
        assert_eq!(gaps(&steps(Bresenham::new(from, to))), 0);
    }

    #[test]
    fn light_is_the_cosine_of_the_angle_or_constant() {
        for degrees in [0.0_f64, 20.0, 45.0] {
            let angle = degrees.to_radians();
            assert!(
                (light_of_whole(angle) - angle.cos()).abs() < 2e-3,
                "{degrees}"
            );
            assert!((light_of_exact(angle) - 1.0).abs() < 1e-5, "{degrees}");
        }
    }
}
