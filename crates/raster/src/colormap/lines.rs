//! Lines whose width is given in pixels, drawn by a texture: of equal value, and along the edges of elements.

use crate::Rgb;

/// Lines of equal value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Isolines {
    /// From one value to the next. Default value: 0.1.
    pub spacing: f32,
    /// A value that has a line. Default value: 0.
    pub start: f32,
    /// Width in pixels. Default value: 1.
    pub width: f32,
    /// Colour. Default value: nearly black.
    pub color: Rgb,
}

impl Default for Isolines {
    fn default() -> Self {
        Self {
            spacing: 0.1,
            start: 0.0,
            width: 1.0,
            color: Rgb::splat(0.02),
        }
    }
}

impl Isolines {
    /// The share of a pixel that lines cover, where the value changes by `change` over it.
    ///
    /// A pixel sees the values `value ± change / 2`, and a line of width w those within `w change / 2` of its own: the
    /// share is an integral over a pattern that repeats, in closed form, so lines have smooth edges. Where they come
    /// as close as twice their width they get thinner: a steep field is an even tone of half the lines' colour,
    /// without moiré. On a plateau (`change` 0) and for values that are not finite there is no line.
    pub fn coverage(&self, value: f32, change: f32) -> f32 {
        let change = change.abs() / self.spacing;
        let phase = (value - self.start) / self.spacing;
        let is_line = change > 1e-12 && change.is_finite() && phase.is_finite() && self.width > 0.0;
        if !is_line {
            return 0.0;
        }
        let half_width = (0.5 * self.width * change).min(0.25);
        let place = phase - phase.round();
        // How much line there is from 0 to x, in periods: a staircase with slopes around whole numbers.
        let covered = |x: f32| {
            let whole = x.round();
            2.0 * half_width * whole + (x - whole).clamp(-half_width, half_width)
        };
        let share = covered(place + 0.5 * change) - covered(place - 0.5 * change);
        (share / change).clamp(0.0, 1.0)
    }
}

/// Edges of triangles and quadrilaterals, by texture coordinates that are 0 or 1 on them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wireframe {
    /// Width in pixels, half of it on each side of the edge. Default value: 1.
    pub width: f32,
    /// Colour. Default value: black.
    pub color: Rgb,
}

impl Default for Wireframe {
    fn default() -> Self {
        Self {
            width: 1.0,
            color: Rgb::BLACK,
        }
    }
}

impl Wireframe {
    /// The share of a pixel covered by the edges `u = 0`, `u = 1`, `v = 0` and `v = 1` of a quadrilateral, from its
    /// texture coordinates and the lengths of their gradients on the screen.
    pub fn quad_coverage(&self, [u, v]: [f32; 2], [u_change, v_change]: [f32; 2]) -> f32 {
        let along = |t: f32, change: f32| self.edge_coverage(t.min(1.0 - t), change);
        along(u, u_change).max(along(v, v_change))
    }

    /// The share of a pixel covered by the edges of a triangle, from its barycentric coordinates and the lengths of
    /// their gradients on the screen.
    pub fn triangle_coverage(&self, barycentric: [f32; 3], changes: [f32; 3]) -> f32 {
        let edges = barycentric.into_iter().zip(changes);
        edges
            .map(|(b, change)| self.edge_coverage(b, change))
            .fold(0.0, f32::max)
    }

    /// The share of a pixel covered by an edge where a coordinate is 0.
    fn edge_coverage(&self, coordinate: f32, change: f32) -> f32 {
        let pixels = coordinate.abs() / change.abs();
        (0.5 * self.width + 0.5 - pixels).clamp(0.0, 1.0).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(width: f32) -> Isolines {
        Isolines {
            spacing: 2.0,
            start: 0.5,
            width,
            ..Isolines::default()
        }
    }

    #[test]
    fn coverage_is_the_mean_of_many_samples() {
        for (width, change) in [(1.0, 0.1), (1.5, 0.37), (3.0, 0.02), (0.5, 1.9)] {
            let lines = lines(width);
            let half = (0.5 * width * change).min(0.25 * lines.spacing);
            for i in 0..40 {
                let value = i as f32 * 0.171 - 3.0;
                let is_covered = |v: f32| {
                    let phase = (v - 0.5) / 2.0;
                    ((phase - phase.round()) * 2.0).abs() < half
                };
                let samples = 4000;
                let sample = |k: i32| value + change * ((k as f32 + 0.5) / samples as f32 - 0.5);
                let covered = (0..samples).filter(|&k| is_covered(sample(k))).count();
                let expected = covered as f32 / samples as f32;
                let found = lines.coverage(value, change);
                assert!(
                    (found - expected).abs() < 2e-3,
                    "{value}, {change}: {found}, {expected}"
                );
            }
        }
    }

    #[test]
    fn a_line_covers_its_width_wherever_it_lies() {
        let lines = lines(1.5);
        for change in [0.001, 0.01, 0.04] {
            for offset in [0.0, 0.2, 0.77] {
                let pixel = |i: i16| lines.coverage(2.5 + (f32::from(i) + offset) * change, change);
                let covered: f32 = (-20..=20).map(pixel).sum();
                assert!(
                    (covered - 1.5).abs() < 2e-3,
                    "{change}, {offset}: {covered}"
                );
            }
        }
    }

    #[test]
    fn steep_fields_are_an_even_tone_and_plateaus_have_no_line() {
        for change in [2.0, 20.0, 2e3, 1e20] {
            for value in [0.0, 0.5, 1.3] {
                let share = lines(1.0).coverage(value, change);
                assert!(
                    (share - 0.5).abs() < 0.26 / (change / 2.0) + 1e-3,
                    "{value}, {change}: {share}"
                );
            }
        }
        assert_eq!(
            lines(1.0).coverage(0.5, 0.0),
            0.0,
            "a plateau on a line's value"
        );
        for (value, change) in [
            (f32::NAN, 1.0),
            (0.5, f32::NAN),
            (f32::INFINITY, 1.0),
            (0.5, f32::INFINITY),
        ] {
            assert_eq!(lines(1.0).coverage(value, change), 0.0, "{value}, {change}");
        }
        let broken = Isolines {
            spacing: 0.0,
            ..lines(1.0)
        };
        assert_eq!(broken.coverage(0.7, 0.1), 0.0, "no spacing");
    }

    #[test]
    fn edges_are_as_wide_in_pixels_whatever_the_element() {
        let frame = Wireframe {
            width: 2.0,
            ..Wireframe::default()
        };
        for pixels in [10.0_f32, 100.0, 1000.0] {
            let change = 1.0 / pixels;
            let across = |i: u16| {
                frame.quad_coverage([(f32::from(i) + 0.5) * change, 0.5], [change, change])
            };
            let covered: f32 = (0..5).map(across).sum();
            assert!(
                (covered - 1.0).abs() < 1e-4,
                "half of 2 pixels on this side: {covered}"
            );
        }
        assert_eq!(
            frame.triangle_coverage([0.0, 0.5, 0.5], [0.01; 3]),
            1.0,
            "on an edge"
        );
        assert_eq!(
            frame.triangle_coverage([0.3, 0.3, 0.4], [0.01; 3]),
            0.0,
            "in the middle"
        );
        assert_eq!(
            frame.quad_coverage([f32::NAN, 0.5], [0.1; 2]),
            0.0,
            "no number"
        );
    }
}
