//! Charts and labelled sheets of pictures, as PNG and SVG.
//!
//! [`Chart`] draws named curves between two axes, each linear or logarithmic ([`Scale`]). The
//! [`Drawing`] that it makes becomes an SVG file or pixels of a [`Canvas`], on which pictures and labels are pasted too.
//!
//! # Current state
//! One font of two sizes, Latin-1 only; what is too wide is cut. Nothing here panics on the numbers it is given: those
//! that are not finite are left out.
#![forbid(unsafe_code)]

mod axis;
mod drawing;
mod paint;

pub use drawing::{Anchor, Drawing};
pub use paint::Canvas;

use axis::{Axis, LogBase, linear_axis, log_axis, log_number_axis};
use drawing::Shape;

/// Dark enough to read.
const INK: [u8; 3] = [40, 40, 40];
const FRAME: [u8; 3] = [110, 110, 110];
const GRID: [u8; 3] = [225, 225, 225];

/// Colours that people tell apart who see few of them (after Okabe and Ito), and that show on white.
const COLORS: [[u8; 3]; 7] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [190, 80, 150],
    [230, 159, 0],
    [86, 180, 233],
    [0, 0, 0],
];

/// A curve with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    name: String,
    /// x ascending; what the axes cannot show is left out.
    points: Vec<(f64, f64)>,
}

impl Curve {
    /// A curve through points, x ascending.
    pub fn new(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.into(),
            points,
        }
    }

    /// Whether there is a line to be seen between a linear horizontal axis and a vertical one of this scale.
    pub fn is_visible(&self, scale: Scale) -> bool {
        self.shown([Scale::Linear, scale]).count() > 1
    }

    /// Points that a horizontal and a vertical axis can show.
    fn shown(&self, [across, up]: [Scale; 2]) -> impl Iterator<Item = (f64, f64)> + '_ {
        let is_shown = move |&(x, y): &(f64, f64)| across.shows(x) && up.shows(y);
        self.points.iter().copied().filter(is_shown)
    }
}

/// How an axis counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Powers of ten at equal distances; values that are not above 0 are left out. A vertical axis shows whole decades
    /// and is labelled in percent, a horizontal one with the numbers.
    #[default]
    Logarithmic,
    /// As [`Self::Logarithmic`], with powers of two as labels.
    Octaves,
    /// Equal steps at equal distances.
    Linear,
}

impl Scale {
    fn shows(self, number: f64) -> bool {
        number.is_finite() && (self == Self::Linear || number > 0.0)
    }
}

/// Named curves between two axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Above everything.
    pub title: String,
    /// Below the horizontal axis.
    pub x_label: String,
    /// Above the vertical axis.
    pub y_label: String,
    /// How the horizontal axis counts.
    pub x_scale: Scale,
    /// How the vertical axis counts.
    pub y_scale: Scale,
    /// Drawn in this order.
    pub curves: Vec<Curve>,
}

/// Where the curves go, in pixels.
#[derive(Debug, Clone, Copy)]
struct Area {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Chart {
    /// Pixels to the left and to the right of the curves, for a picture that shall share their axis.
    pub fn margins(&self) -> [usize; 2] {
        let names = self.curves.iter().map(|c| c.name.chars().count()).max();
        [78, 56 + paint::glyph_width(16) * names.unwrap_or(0)]
    }

    /// Lays it out in so many pixels.
    pub fn draw(&self, width: usize, height: usize) -> Drawing {
        let mut drawing = Drawing::new(width, height);
        let [left, right] = self.margins();
        let area = Area {
            left: left as f64,
            right: width as f64 - right as f64,
            top: 66.0,
            bottom: height as f64 - 56.0,
        };
        let scales = [self.x_scale, self.y_scale];
        let points = || self.curves.iter().flat_map(|c| c.shown(scales));
        let steps = points().map(|(x, _)| x);
        let x = match self.x_scale {
            Scale::Logarithmic => log_number_axis(steps, LogBase::Ten, area.left, area.right),
            Scale::Octaves => log_number_axis(steps, LogBase::Two, area.left, area.right),
            Scale::Linear => linear_axis(steps, area.left, area.right),
        };
        let values = points().map(|(_, y)| y);
        let y = match self.y_scale {
            Scale::Logarithmic => log_axis(values, area.bottom, area.top),
            Scale::Octaves => log_number_axis(values, LogBase::Two, area.bottom, area.top),
            Scale::Linear => linear_axis(values, area.bottom, area.top),
        };
        self.draw_axes(&mut drawing, area, &x, &y);
        let places = |curve: &Curve| -> Vec<[f64; 2]> {
            let shown = curve.shown(scales);
            shown
                .map(|(at, share)| [x.place(at), y.place(share)])
                .collect()
        };
        let all: Vec<Vec<[f64; 2]>> = self.curves.iter().map(places).collect();
        for (i, curve) in self.curves.iter().enumerate() {
            let hides_another = all[..i].iter().any(|before| coincide(before, &all[i]));
            let style = Style {
                color: COLORS[i % COLORS.len()],
                dashed: hides_another || i >= COLORS.len(),
            };
            draw_curve(&mut drawing, area, &all[i], style);
            draw_name(&mut drawing, area, &curve.name, i, style);
        }
        drawing
    }

    fn draw_axes(&self, drawing: &mut Drawing, area: Area, x: &Axis, y: &Axis) {
        let middle = (area.left + area.right) / 2.0;
        drawing.text([area.left, 14.0], &self.title, Anchor::Start, 20, INK);
        drawing.text([area.left, 42.0], &self.y_label, Anchor::Start, 16, INK);
        let below = [middle, area.bottom + 30.0];
        drawing.text(below, &self.x_label, Anchor::Middle, 16, INK);
        for (at, label) in &x.ticks {
            drawing.line([*at, area.top], [*at, area.bottom], GRID, 1.0);
            drawing.text([*at, area.bottom + 8.0], label, Anchor::Middle, 16, INK);
        }
        for (at, label) in &y.ticks {
            drawing.line([area.left, *at], [area.right, *at], GRID, 1.0);
            let place = [area.left - 8.0, at - 8.0];
            drawing.text(place, label, Anchor::End, 16, INK);
        }
        drawing.line([area.left, area.top], [area.left, area.bottom], FRAME, 1.0);
        let (start, end) = ([area.left, area.bottom], [area.right, area.bottom]);
        drawing.line(start, end, FRAME, 1.0);
    }
}

/// Lines of text, the first one larger; what is too long for the width is cut.
pub fn label(lines: &[String], width: usize, height: usize) -> Drawing {
    let mut drawing = Drawing::new(width, height);
    let mut top = 0.0;
    for (i, line) in lines.iter().enumerate() {
        let fits = |size| drawing::advance(size) * line.chars().count() as f64 <= width as f64;
        let size = if i == 0 && fits(20) { 20 } else { 16 };
        let most = (width as f64 / drawing::advance(size)).floor();
        let cut = line
            .chars()
            .zip(1_u32..)
            .take_while(|&(_, n)| f64::from(n) <= most);
        let line: String = cut.map(|(c, _)| c).collect();
        drawing.text([0.0, top], &line, Anchor::Start, size, INK);
        top += f64::from(size) + 4.0;
    }
    drawing
}

/// How a curve is told from the others.
#[derive(Debug, Clone, Copy)]
struct Style {
    color: [u8; 3],
    dashed: bool,
}

fn draw_curve(drawing: &mut Drawing, area: Area, places: &[[f64; 2]], style: Style) {
    drawing.shapes.push(Shape::Path {
        points: thinned(places, area),
        color: style.color,
        width: 2.0,
        dashed: style.dashed,
    });
}

/// The entry of a curve in the legend.
fn draw_name(drawing: &mut Drawing, area: Area, name: &str, i: usize, style: Style) {
    let y = area.top + 10.0 + 24.0 * i as f64;
    let ends = [[area.right + 14.0, y], [area.right + 42.0, y]];
    draw_curve(drawing, area, &ends, style);
    let at = [area.right + 48.0, y - 8.0];
    drawing.text(at, name, Anchor::Start, 16, INK);
}

/// Whether two curves over the same steps lie on each other for the most part, so that one would hide the other.
fn coincide(a: &[[f64; 2]], b: &[[f64; 2]]) -> bool {
    let close =
        |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).abs() < 0.5 && (a[1] - b[1]).abs() < 1.5;
    let together = a.iter().zip(b).filter(|&(a, b)| close((a, b))).count();
    together * 2 > a.len().max(b.len())
}

/// At most two points in each column of pixels, its lowest and its highest, so that files stay small.
fn thinned(points: &[[f64; 2]], area: Area) -> Vec<[f64; 2]> {
    if points.len() as f64 <= 2.0 * (area.right - area.left) {
        return points.to_vec();
    }
    let column = |p: &[f64; 2]| p[0].floor();
    let chunks = points.chunk_by(|a, b| column(a) == column(b));
    let ends = |chunk: &[[f64; 2]]| {
        let by_height = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
        let mut ends: Vec<[f64; 2]> = [
            chunk.iter().min_by(by_height),
            chunk.iter().max_by(by_height),
        ]
        .into_iter()
        .flatten()
        .copied()
        .collect();
        ends.sort_by(|a, b| a[0].total_cmp(&b[0]));
        ends.dedup();
        ends
    };
    chunks.flat_map(ends).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: Vec<(f64, f64)>) -> Chart {
        Chart {
            title: String::from("a < b & \"c\""),
            x_label: String::from("steps"),
            y_label: String::from("share"),
            x_scale: Scale::Linear,
            y_scale: Scale::Logarithmic,
            curves: vec![Curve::new("only", points)],
        }
    }

    #[test]
    fn svg_is_well_formed_and_names_what_it_shows() {
        let svg = chart(vec![(0.0, 1.0), (100.0, 1e-3)]).draw(800, 500).svg();
        for word in ["a &lt; b &amp;", "steps", "share", "only", "100 %", "0.1 %"] {
            assert!(svg.contains(word), "'{word}' in {svg}");
        }
        assert_eq!(svg.matches('<').count(), svg.matches('>').count(), "{svg}");
        assert!(!svg.contains("NaN"), "all numbers are numbers");
    }

    #[test]
    fn nothing_to_show_is_an_empty_frame() {
        for points in [
            vec![],
            vec![(1.0, 0.0)],
            vec![(3.0, f64::NAN)],
            vec![(5.0, 0.1)],
        ] {
            let drawing = chart(points.clone()).draw(800, 500);
            assert!(!drawing.svg().contains("NaN"), "{points:?}");
            assert!(drawing.png().is_ok(), "{points:?}");
        }
    }

    #[test]
    fn linear_scale_shows_values_below_zero() {
        let mut chart = chart(vec![(0.5, -0.25), (1.25, 0.5)]);
        assert!(
            !chart.curves[0].is_visible(chart.y_scale),
            "one point above 0"
        );
        chart.y_scale = Scale::Linear;
        assert!(chart.curves[0].is_visible(chart.y_scale), "both points");
        assert!(
            chart.draw(800, 500).svg().contains(">-0.2<"),
            "a label below 0"
        );
    }

    #[test]
    fn curve_that_lies_on_another_is_dashed() {
        let points: Vec<(f64, f64)> = (0..50).map(|i| (f64::from(i), 0.9_f64.powi(i))).collect();
        let mut chart = chart(points.clone());
        assert!(
            !chart.draw(800, 500).svg().contains("dasharray"),
            "one alone"
        );
        chart.curves.push(Curve::new(
            "other",
            points.iter().map(|&(x, y)| (x, y * y)).collect(),
        ));
        assert!(
            !chart.draw(800, 500).svg().contains("dasharray"),
            "two apart"
        );
        chart.curves.push(Curve::new("same", points));
        let svg = chart.draw(800, 500).svg();
        assert_eq!(
            svg.matches("dasharray").count(),
            2,
            "a curve and its entry in the legend"
        );
    }

    #[test]
    fn long_curves_keep_their_ends() {
        let points: Vec<(f64, f64)> = (0..50_000)
            .map(|i| (f64::from(i), 1.0 / f64::from(1 + i)))
            .collect();
        let drawing = chart(points).draw(800, 500);
        let Some(Shape::Path { points, .. }) = drawing
            .shapes
            .iter()
            .find(|shape| matches!(shape, Shape::Path { width, .. } if *width == 2.0))
        else {
            panic!("there is a curve");
        };
        assert!(points.len() < 2000, "{} points", points.len());
        assert!(
            points[0][0] < 80.0 && points[points.len() - 1][0] > 600.0,
            "from end to end"
        );
    }
}
