//! Antialiased discs and rings: every pixel is covered by exactly the area that the circle has in it.
//!
//! In a row of pixels at distances `a..b` from the centre, with `h(x) = sqrt(r^2 - x^2)`, the disc has in a column the
//! integral of `clamp(h(x), a, b) - a`. Where `h >= b` the pixel is covered in full; between there and where `h` falls
//! below `a` the area under the arc is that of a trapezoid below the chord and of the circular segment above it,
//! ```text
//! r^2 (asin k - k sqrt(1 - k^2)) = r^2 (2/3 k^3 + 1/5 k^5 + 3/28 k^7 + 5/72 k^9 + ..),    k = chord / (2 r)
//! ```
//! The series is used for small `k`, where the difference would lose its digits. A ring is a disc less a smaller one.
//!
//! # Current state
//! Exact but for rounding: no pixel is off by more than 1e-6 for radii of up to 2^20 pixels. Pixels inside of a ring are
//! not looked at. Working memory is one row of the window.

use crate::target::CoverageTarget;
use core::ops::Range;
use glam::DVec2;

/// Fills a disc. Pixel `(x, y)` is the square from there to `(x + 1, y + 1)`. Nothing is drawn unless all numbers are
/// finite and the radius is above 0.
///
/// ```
/// use glam::DVec2;
/// use hemicube_raster::Image;
/// use hemicube_raster::circle::antialiased::fill_circle;
///
/// let mut coverage = Image::filled(20, 20, 0.0);
/// fill_circle(&mut coverage.pen(1.0), DVec2::new(9.7, 10.4), 8.0);
/// let area: f32 = coverage.pixels().iter().sum();
/// assert!((area - 64.0 * std::f32::consts::PI).abs() < 1e-4);
/// ```
pub fn fill_circle(target: &mut impl CoverageTarget, center: DVec2, radius: f64) {
    cover(target, center, [radius, 0.0]);
}

/// Draws a circle as a ring of a width around its radius; one that is wider than the circle is a disc.
pub fn draw_circle(target: &mut impl CoverageTarget, center: DVec2, radius: f64, width: f64) {
    if radius >= 0.0 && width > 0.0 {
        let radii = [radius + 0.5 * width, radius - 0.5 * width];
        cover(target, center, radii.map(|r| r.max(0.0)));
    }
}

/// The largest numbers whose squares are finite.
const LARGEST: f64 = 1e150;

/// A number moved between two others.
#[expect(
    clippy::cast_possible_truncation,
    reason = "between two 32-bit numbers"
)]
fn clamped(number: f64, range: &Range<i32>) -> i32 {
    number.max(f64::from(range.start)).min(f64::from(range.end)) as i32
}

/// Covers what is between two circles.
fn cover(target: &mut impl CoverageTarget, center: DVec2, [outer, inner]: [f64; 2]) {
    let window = target.window();
    let is_drawn = outer > 0.0 && outer <= LARGEST && center.abs().max_element() <= LARGEST;
    if window.is_empty() || !is_drawn || center.is_nan() {
        return;
    }
    let columns = window.left..window.right;
    let rows = window.top..window.bottom;
    let [first, end] = [(center.y - outer).floor(), (center.y + outer).ceil()];
    let mut shares = Vec::new();
    for row in clamped(first, &rows)..clamped(end, &rows) {
        let row_of = |radius| DiscRow::new(radius, f64::from(row) - center.y);
        let discs = [row_of(outer), row_of(inner)];
        let [half, hole] = [discs[0].half_width(), discs[1].full_half_width()];
        let left = clamped((center.x - half).floor(), &columns);
        let right = clamped((center.x + half).ceil(), &columns);
        // Pixels that lie in the hole as a whole.
        let hole_start = clamped((center.x - hole).ceil(), &(left..right));
        let hole_end = clamped((center.x + hole).floor(), &(hole_start..right));
        for part in [left..hole_start, hole_end..right] {
            if !part.is_empty() {
                shares.clear();
                shares.resize(part.len(), 0.0);
                discs[0].add(1.0, part.start, center.x, &mut shares);
                discs[1].add(-1.0, part.start, center.x, &mut shares);
                for share in &mut shares {
                    *share = share.clamp(0.0, 1.0);
                }
                target.cover(row, part.start, &shares);
            }
        }
    }
}

/// What a disc around the origin has in a row of pixels.
struct DiscRow {
    radius: f64,
    /// The parts of the row above and below the centre, by their distances from it; one of them may be empty.
    bands: [Band; 2],
}

/// A part of a row on one side of the centre.
struct Band {
    /// Distances from the centre.
    near: f64,
    far: f64,
    /// Where the circle is as high as `near` and as `far`; 0 if it is nowhere.
    half_widths: [f64; 2],
}

/// The height of a circle, 0 beyond it.
fn height(radius: f64, x: f64) -> f64 {
    ((radius - x) * (radius + x)).max(0.0).sqrt()
}

impl DiscRow {
    /// The row from `top` to `top + 1`.
    fn new(radius: f64, top: f64) -> Self {
        let bottom = top + 1.0;
        let band = |near: f64, far: f64| {
            let [near, far] = [near.max(0.0), far.max(0.0)];
            let half_widths = [near, far].map(|y| height(radius, y));
            Band {
                near,
                far,
                half_widths,
            }
        };
        Self {
            radius,
            bands: [band(top, bottom), band(-bottom, -top)],
        }
    }

    fn occupied(&self) -> impl Iterator<Item = &Band> {
        self.bands.iter().filter(|band| band.near < band.far)
    }

    /// Half the width of the columns that it touches.
    fn half_width(&self) -> f64 {
        let widths = self.occupied().map(|band| band.half_widths[0]);
        widths.fold(0.0, f64::max)
    }

    /// Half the width of the columns in which it is as high as the row.
    fn full_half_width(&self) -> f64 {
        let widths = self.occupied().map(|band| band.half_widths[1]);
        widths.fold(f64::INFINITY, f64::min)
    }

    /// Adds `weight` times its areas in pixels from column `left` on.
    fn add(&self, weight: f32, left: i32, center: f64, shares: &mut [f32]) {
        if self.radius == 0.0 {
            return;
        }
        let end = left.saturating_add(i32::try_from(shares.len()).unwrap_or(i32::MAX));
        let columns = left..end;
        let full = self.full_half_width();
        let start = clamped((center - full).ceil(), &columns);
        let full = start..clamped((center + full).floor(), &(start..end));
        let index = |column: i32| usize::try_from(column - left).unwrap_or(0);
        for column in (left..full.start).chain(full.end..end) {
            shares[index(column)] += weight * self.area(f64::from(column) - center);
        }
        for share in &mut shares[index(full.start)..index(full.end)] {
            *share += weight;
        }
    }

    /// Its area in the pixel from `x` to `x + 1`.
    #[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
    #[inline]
    fn area(&self, x: f64) -> f32 {
        let of = |side: [f64; 2]| -> f64 {
            let [upper, lower] = &self.bands;
            upper.area(self.radius, side) + lower.area(self.radius, side)
        };
        // Both sides of the centre are alike; a pixel above it has parts on both.
        let area = if x >= 0.0 {
            of([x, x + 1.0])
        } else if x <= -1.0 {
            of([-x - 1.0, -x])
        } else {
            of([0.0, x + 1.0]) + of([0.0, -x])
        };
        area as f32
    }
}

impl Band {
    /// The area between two columns right of the centre.
    #[inline]
    fn area(&self, radius: f64, [start, end]: [f64; 2]) -> f64 {
        if self.near >= self.far {
            return 0.0;
        }
        let [arc_end, arc_start] = self.half_widths;
        let full = (end.min(arc_start) - start).max(0.0) * (self.far - self.near);
        let [start, end] = [start.max(arc_start), end.min(arc_end)];
        if start >= end {
            return full;
        }
        full + area_under_arc(radius, start, end, self.near)
    }
}

/// The area between a circle and the line at height `base`, from `start` to `end`.
fn area_under_arc(radius: f64, start: f64, end: f64, base: f64) -> f64 {
    let [high, low] = [height(radius, start), height(radius, end)];
    let below_chord = (end - start) * (0.5 * (high + low) - base);
    let chord = ((end - start).powi(2) + (high - low).powi(2)).sqrt();
    below_chord + segment(radius, chord)
}

/// The area between a chord and its arc, at most half a disc.
fn segment(radius: f64, chord: f64) -> f64 {
    let k = (chord / (2.0 * radius)).min(1.0);
    let k2 = k * k;
    let of_unit = if k < 0.2 {
        k * k2 * (2.0 / 3.0 + k2 * (1.0 / 5.0 + k2 * (3.0 / 28.0 + k2 * (5.0 / 72.0))))
    } else {
        k.asin() - k * (1.0 - k2).sqrt()
    };
    radius * radius * of_unit
}
