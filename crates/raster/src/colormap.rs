//! Numbers as colours: one-dimensional colour tables, isolines, element edges.
//!
//! A scalar field on a surface is shown through a texture: the *value* is what is interpolated over a triangle, as a
//! texture coordinate, and each pixel looks its colour up in a table of one dimension. Interpolated colours of corners
//! instead run straight through the space of colours, past all that the table has between them. In the table's place
//! there may be any function of the value: here lines of equal value, of a width in pixels wherever the surface is
//! steep or flat.
//!
//! ```
//! use hemicube_raster::colormap::{Colormap, FieldPaint, Isolines};
//!
//! // Volts from 0 to 5, a line at each volt.
//! let paint = FieldPaint::new(Colormap::sequential(), [0.0, 5.0])
//!     .with_isolines(Isolines { spacing: 1.0, ..Isolines::default() });
//! // 2.5 V in a place where the field changes by 0.02 V from pixel to pixel: no line is near.
//! assert_eq!(paint.color(2.5, 0.02), Colormap::sequential().color(0.5));
//! ```

mod lines;
mod oklab;
mod table;

pub use lines::{Isolines, Wireframe};
pub use oklab::Oklab;
pub use table::Colormap;

use crate::Rgb;

/// Everything that a value becomes a colour by.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldPaint {
    /// The colours.
    pub colormap: Colormap,
    /// The values of the first and the last colour.
    pub range: [f32; 2],
    /// Lines of equal value. Default value: none.
    pub isolines: Option<Isolines>,
    /// Colour where there is no value. Default value: a light grey.
    pub missing: Rgb,
}

impl FieldPaint {
    /// Colours for the values between two.
    pub fn new(colormap: Colormap, range: [f32; 2]) -> Self {
        Self {
            colormap,
            range,
            isolines: None,
            missing: Rgb::splat(0.55),
        }
    }

    /// With lines of equal value.
    #[must_use]
    pub fn with_isolines(mut self, isolines: Isolines) -> Self {
        self.isolines = Some(isolines);
        self
    }

    /// Where a value lies between the two ends: below 0 and above 1 outside, 1/2 if both ends are the same.
    pub fn share(&self, value: f32) -> f32 {
        let [low, high] = self.range;
        if low == high && value.is_finite() {
            return 0.5;
        }
        (value - low) / (high - low)
    }

    /// The colour of a value in a pixel over which it changes by `change`, the length of its gradient on the screen. A
    /// value of NaN is missing.
    pub fn color(&self, value: f32, change: f32) -> Rgb {
        if value.is_nan() {
            return self.missing;
        }
        let ground = self.colormap.color(self.share(value));
        match &self.isolines {
            Some(lines) => ground.lerp(lines.color, lines.coverage(value, change)),
            None => ground,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_outside_show_the_ends_and_missing_ones_their_own_colour() {
        let paint = FieldPaint::new(Colormap::grey(), [-2.0, 2.0]);
        assert_eq!(paint.color(-9.0, 0.1), Colormap::grey().color(0.0), "below");
        assert_eq!(
            paint.color(f32::INFINITY, 0.1),
            Colormap::grey().color(1.0),
            "above"
        );
        assert_eq!(paint.color(f32::NAN, 0.1), paint.missing, "missing");
        let flat = FieldPaint::new(Colormap::grey(), [3.0, 3.0]);
        assert_eq!(
            flat.color(3.0, 0.0),
            Colormap::grey().color(0.5),
            "one value"
        );
    }

    #[test]
    fn a_line_lies_on_its_value() {
        let lines = Isolines {
            spacing: 1.0,
            ..Isolines::default()
        };
        let paint = FieldPaint::new(Colormap::grey(), [0.0, 4.0]).with_isolines(lines);
        let off = (paint.color(2.0, 0.01) - lines.color).map(f32::abs);
        assert!(off.max_band() < 1e-6, "on the line");
        assert_eq!(
            paint.color(2.5, 0.01),
            Colormap::grey().color(0.625),
            "between"
        );
    }
}
