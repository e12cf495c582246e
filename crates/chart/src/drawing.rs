//! A drawing of lines and text, and its vector form.

use super::paint::Canvas;
use hemicube_raster::image::ImageError;
use std::fmt::Write as _;

/// Which part of a text is at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Its left end.
    Start,
    /// Its middle.
    Middle,
    /// Its right end.
    End,
}

/// What a drawing is made of; coordinates in pixels, y down.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A line through points.
    Path {
        points: Vec<[f64; 2]>,
        color: [u8; 3],
        width: f64,
        dashed: bool,
    },
    /// Text whose upper edge is at `at`, `size` pixels high.
    Text {
        at: [f64; 2],
        text: String,
        anchor: Anchor,
        size: u32,
        color: [u8; 3],
    },
}

/// Lines and text on white.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    pub(super) shapes: Vec<Shape>,
}

/// Length of a dash and of the gap behind it.
pub(super) const DASH: f64 = 6.0;

/// Width of a character of a text so many pixels high.
pub(super) fn advance(size: u32) -> f64 {
    super::paint::glyph_width(size) as f64
}

impl Drawing {
    /// An empty one.
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            shapes: Vec::new(),
        }
    }

    /// Adds a straight line.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], color: [u8; 3], width: f64) {
        self.path(vec![from, to], color, width);
    }

    /// Adds a line through points.
    pub fn path(&mut self, points: Vec<[f64; 2]>, color: [u8; 3], width: f64) {
        self.shapes.push(Shape::Path {
            points,
            color,
            width,
            dashed: false,
        });
    }

    /// Adds a text.
    pub fn text(&mut self, at: [f64; 2], text: &str, anchor: Anchor, size: u32, color: [u8; 3]) {
        self.shapes.push(Shape::Text {
            at,
            text: text.to_owned(),
            anchor,
            size,
            color,
        });
    }

    /// As pixels, in a PNG file.
    pub fn png(&self) -> Result<Vec<u8>, ImageError> {
        let mut canvas = Canvas::new(self.width, self.height);
        canvas.draw(self, 0, 0);
        canvas.png()
    }

    /// As an SVG file.
    pub fn svg(&self) -> String {
        let (width, height) = (self.width, self.height);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        for shape in &self.shapes {
            svg_shape(&mut svg, shape);
        }
        svg + "</svg>\n"
    }
}

fn svg_shape(svg: &mut String, shape: &Shape) {
    match shape {
        Shape::Path {
            points,
            color,
            width,
            dashed,
        } => {
            let points: Vec<String> = points
                .iter()
                .map(|[x, y]| format!("{x:.1},{y:.1}"))
                .collect();
            let dashes = if *dashed {
                format!(" stroke-dasharray=\"{DASH} {DASH}\"")
            } else {
                String::new()
            };
            let _ = writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"{dashes}/>",
                points.join(" "),
                hex(*color)
            );
        }
        Shape::Text {
            at: [x, y],
            text,
            anchor,
            size,
            color,
        } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            // Letters are lower than their line: as the painted ones are.
            let (size, y) = (0.8 * f64::from(*size), y + 0.8 * f64::from(*size));
            let _ = writeln!(
                svg,
                "<text x=\"{x:.1}\" y=\"{y:.1}\" font-family=\"monospace\" font-size=\"{size:.1}\" text-anchor=\"{anchor}\" fill=\"{}\">{}</text>",
                hex(*color),
                escaped(text)
            );
        }
    }
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn escaped(text: &str) -> String {
    let text: String = text
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
