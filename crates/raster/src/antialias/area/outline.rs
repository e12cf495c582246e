//! Outlines of areas: closed contours of straight and curved pieces.

use core::f64::consts::TAU;
use glam::DVec2;

/// Closed contours that bound an area; x to the right, y down, in pixels.
///
/// Curves become straight pieces as they are added, to within a distance of [`Self::TOLERANCE`]; contours close by
/// themselves. An outline with a coordinate that is NaN or infinite covers nothing ([`Self::is_finite`]);
/// coordinates beyond 1e15 pixels are drawn back to there.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outline {
    points: Vec<DVec2>,
    /// Index behind the last point of each contour but the open one.
    ends: Vec<usize>,
    is_broken: bool,
}

impl Outline {
    /// How far straight pieces may lie beside the curve that they stand for, in pixels.
    pub const TOLERANCE: f64 = 5e-4;

    /// Most straight pieces of one curve: a quadratic one that turns within 32 768 pixels keeps the tolerance.
    const MOST_PIECES: f64 = 4096.0;

    /// Most corners of the polygon of a circle; see [`Self::circle`].
    const MOST_CORNERS: f64 = 65_536.0;

    /// Coordinates are drawn back to so many pixels: their differences and products stay far from overflow.
    const FARTHEST: f64 = 1e15;

    /// Nothing yet.
    pub const fn new() -> Self {
        Self {
            points: Vec::new(),
            ends: Vec::new(),
            is_broken: false,
        }
    }

    /// One contour through points.
    pub fn polygon(points: impl IntoIterator<Item = DVec2>) -> Self {
        let mut outline = Self::new();
        outline.add_polygon(points);
        outline
    }

    /// A circle; a radius that is not above 0 covers nothing.
    ///
    /// It is a polygon of the circle's area with so many corners that the coverage of no pixel is wrong by more than 5e-5,
    /// for radii up to 100 000 pixels. Larger ones have 65 536 corners; the error grows with the square of the radius.
    pub fn circle(center: DVec2, radius: f64) -> Self {
        let mut outline = Self::new();
        outline.add_circle(center, radius);
        outline
    }

    /// A straight line of a width with square ends, a rectangle; one of no length or no width covers nothing.
    pub fn line(from: DVec2, to: DVec2, width: f64) -> Self {
        let along = (to - from).normalize_or_zero();
        let side = along.perp() * (width / 2.0);
        Self::polygon([from + side, to + side, to - side, from - side])
    }

    /// Adds a contour through points.
    pub fn add_polygon(&mut self, points: impl IntoIterator<Item = DVec2>) {
        self.close();
        for point in points {
            self.push(point);
        }
        self.close();
    }

    /// Adds a circle, as [`Self::circle`] describes it; it turns from the x axis to the y axis.
    pub fn add_circle(&mut self, center: DVec2, radius: f64) {
        if radius <= 0.0 {
            return;
        }
        // Between the points where a chord of length l leaves the circle's area and enters it again lies an area of at
        // most 0.13 s l, s being the chord's rise; a pixel that cuts two chords is wrong by no more than twice that.
        let step = (1.6e-3 / (radius * radius)).cbrt().min(TAU / 16.0);
        let corners = (TAU / step).ceil().clamp(16.0, Self::MOST_CORNERS);
        let step = TAU / corners;
        // The area of a polygon of n corners is (n / 2) r^2 sin(2 pi / n).
        let radius = radius * (step / step.sin()).sqrt();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 16 and 65 536"
        )]
        let corners = 0..corners as usize;
        self.add_polygon(corners.map(|i| center + radius * DVec2::from_angle(step * i as f64)));
    }

    /// Begins a contour.
    pub fn move_to(&mut self, point: DVec2) {
        self.close();
        self.push(point);
    }

    /// Adds a straight piece.
    pub fn line_to(&mut self, point: DVec2) {
        self.push(point);
    }

    /// Adds a quadratic Bézier curve; without a beginning it begins at its control point.
    pub fn quad_to(&mut self, control: DVec2, end: DVec2) {
        let start = self.current().unwrap_or(control);
        // A parabola's rise over n equal steps of its parameter is |p0 - 2 p1 + p2| / (4 n^2).
        let bend = (start - 2.0 * control + end).length();
        self.flatten((bend / 4.0 / Self::TOLERANCE).sqrt(), |t| {
            let (a, b) = (start.lerp(control, t), control.lerp(end, t));
            a.lerp(b, t)
        });
    }

    /// Adds a cubic Bézier curve; without a beginning it begins at its first control point.
    pub fn cubic_to(&mut self, first: DVec2, second: DVec2, end: DVec2) {
        let start = self.current().unwrap_or(first);
        // |second derivative| <= 6 max |p_i - 2 p_(i+1) + p_(i+2)|, and the rise is at most an eighth of it, over n^2.
        let bend = (start - 2.0 * first + second).length();
        let bend = bend.max((first - 2.0 * second + end).length());
        self.flatten((0.75 * bend / Self::TOLERANCE).sqrt(), |t| {
            let (a, b, c) = (
                start.lerp(first, t),
                first.lerp(second, t),
                second.lerp(end, t),
            );
            a.lerp(b, t).lerp(b.lerp(c, t), t)
        });
    }

    /// Ends a contour; the next piece begins another.
    pub fn close(&mut self) {
        if self.points.len() > self.ends.last().copied().unwrap_or(0) {
            self.ends.push(self.points.len());
        }
    }

    /// Forgets everything, and keeps the memory.
    pub fn clear(&mut self) {
        self.points.clear();
        self.ends.clear();
        self.is_broken = false;
    }

    /// Whether no coordinate is NaN or infinite.
    pub fn is_finite(&self) -> bool {
        !self.is_broken
    }

    /// The points of each contour; the last one is joined with the first one.
    pub fn contours(&self) -> impl Iterator<Item = &[DVec2]> {
        let start = |i: usize| if i == 0 { 0 } else { self.ends[i - 1] };
        let closed = (0..self.ends.len()).map(move |i| &self.points[start(i)..self.ends[i]]);
        let open = &self.points[start(self.ends.len())..];
        closed.chain((!open.is_empty()).then_some(open))
    }

    /// Least and largest y of all points; none if there are none or the outline is not finite.
    pub fn extent_y(&self) -> Option<[f64; 2]> {
        if self.is_broken || self.points.is_empty() {
            return None;
        }
        let wider = |[low, high]: [f64; 2], p: &DVec2| [low.min(p.y), high.max(p.y)];
        let nothing = [f64::INFINITY, f64::NEG_INFINITY];
        Some(self.points.iter().fold(nothing, wider))
    }

    /// The last point of the open contour.
    fn current(&self) -> Option<DVec2> {
        let is_open = self.points.len() > self.ends.last().copied().unwrap_or(0);
        is_open.then(|| self.points[self.points.len() - 1])
    }

    fn push(&mut self, point: DVec2) {
        self.is_broken |= !point.is_finite();
        let farthest = DVec2::splat(Self::FARTHEST);
        self.points.push(point.clamp(-farthest, farthest));
    }

    /// Adds points of a curve over [0, 1] at equal steps of its parameter.
    fn flatten(&mut self, pieces: f64, curve: impl Fn(f64) -> DVec2) {
        let pieces = pieces.ceil().clamp(1.0, Self::MOST_PIECES);
        let mut step = 1.0;
        while step <= pieces {
            self.push(curve(step / pieces));
            step += 1.0;
        }
    }
}
