//! Thick lines: the outline of a stroke along a path, with joins, caps and dashes.
//!
//! A stroke is the union of simple convex pieces: a rectangle for each segment (for each dash of it), a triangle, kite or
//! wedge for each join, half a disc for each round cap. All pieces are oriented alike, so that the non-zero rule of
//! [`fill_polygon`] makes their union: no pixel is drawn twice where they overlap. This is exact for any path and needs
//! none of the case distinctions of an outline that is offset to both sides and then goes round inner corners.
//!
//! Distances for dashes are those from the path's beginning. Of a segment far longer than the window only those dashes
//! are made that can be seen, with the phase of the whole.
//!
//! # Current state
//! Round joins and caps are polygons within 0.02 pixels of the true arc, up to widths of 500 000. Dashes with caps
//! become a solid stroke where it is more than 100 times wider than their pattern is long. A path with a coordinate that is not finite, or beyond 1e150, is not drawn. Nothing
//! here panics.

use crate::line::Dashes;
use crate::polygon::{FillRule, fill_polygon};
use crate::target::{Target, Window};
use core::f64::consts::PI;
use core::ops::Range;
use glam::DVec2;

/// How the ends of a stroke or of a dash look.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Cap {
    /// Cut off at the end.
    #[default]
    Butt,
    /// Half a disc around the end.
    Round,
    /// Cut off half a width beyond the end.
    Square,
}

/// How a stroke goes round a corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Join {
    /// The outer sides go on until they meet; beyond [`Stroke::miter_limit`] it is a bevel.
    #[default]
    Miter,
    /// A disc around the corner.
    Round,
    /// The outer corners are joined by a straight line.
    Bevel,
}

/// How a path is stroked.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// Width in pixels; nothing is drawn unless it is finite and above 0. Default value: 1.
    pub width: f64,
    /// Ends of the path and of its dashes. Default value: [`Cap::Butt`].
    pub cap: Cap,
    /// Corners. Default value: [`Join::Miter`].
    pub join: Join,
    /// The longest a mitre may be, in widths, from the inner to the outer corner. Default value: 4, as in SVG.
    pub miter_limit: f64,
    /// Dashes along the path. Default value: none, the stroke is solid.
    pub dashes: Option<Dashes>,
}

impl Default for Stroke {
    fn default() -> Self {
        Self {
            width: 1.0,
            cap: Cap::default(),
            join: Join::default(),
            miter_limit: 4.0,
            dashes: None,
        }
    }
}

impl Stroke {
    /// A solid stroke of a width.
    pub fn new(width: f64) -> Self {
        Self {
            width,
            ..Self::default()
        }
    }

    /// Sets [`Self::cap`].
    #[must_use]
    pub fn with_cap(mut self, cap: Cap) -> Self {
        self.cap = cap;
        self
    }

    /// Sets [`Self::join`].
    #[must_use]
    pub fn with_join(mut self, join: Join) -> Self {
        self.join = join;
        self
    }

    /// Sets [`Self::miter_limit`].
    #[must_use]
    pub fn with_miter_limit(mut self, miter_limit: f64) -> Self {
        self.miter_limit = miter_limit;
        self
    }

    /// Sets [`Self::dashes`].
    #[must_use]
    pub fn with_dashes(mut self, dashes: Dashes) -> Self {
        self.dashes = Some(dashes);
        self
    }
}

/// Points joined by straight segments; pixel `(x, y)` is the square from there to `(x + 1, y + 1)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    points: Vec<DVec2>,
    is_closed: bool,
}

impl Path {
    /// From the first point to the last.
    pub fn open(points: impl IntoIterator<Item: Into<DVec2>>) -> Self {
        Self::new(points, false)
    }

    /// From the first point to the last and back to the first.
    pub fn closed(points: impl IntoIterator<Item: Into<DVec2>>) -> Self {
        Self::new(points, true)
    }

    /// Points that repeat the one before them have no direction and are left out.
    fn new(points: impl IntoIterator<Item: Into<DVec2>>, is_closed: bool) -> Self {
        let mut points: Vec<DVec2> = points.into_iter().map(Into::into).collect();
        points.dedup();
        while is_closed && points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        Self { points, is_closed }
    }

    /// Its points, none equal to the one before it.
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// Whether it leads back to its first point.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Its segments, with the distances at which they begin.
    fn segments(&self) -> Vec<Segment> {
        let next = self.points.iter().skip(1);
        let back = self.points.first().filter(|_| self.is_closed);
        let ends = self.points.iter().zip(next.chain(back));
        let segments = ends.scan(0.0, |gone, (&from, &to)| {
            let length = from.distance(to);
            let start = *gone;
            *gone += length;
            Some(Segment {
                from,
                direction: (to - from) / length,
                distances: start..*gone,
            })
        });
        segments.collect()
    }
}

/// Strokes a path: the pixels whose centres are in its outline, each once.
///
/// ```
/// use glam::DVec2;
/// use hemicube_raster::Image;
/// use hemicube_raster::stroke::{Path, Stroke, draw_stroke};
///
/// let mut image = Image::filled(6, 4, '.');
/// let path = Path::open([DVec2::new(1.0, 2.0), DVec2::new(5.0, 2.0)]);
/// draw_stroke(&mut image.pen('#'), &path, &Stroke::new(2.0));
/// let rows: Vec<String> = image.pixels().chunks(6).map(|row| row.iter().collect()).collect();
/// assert_eq!(rows, ["......", ".####.", ".####.", "......"]);
/// ```
pub fn draw_stroke(target: &mut impl Target, path: &Path, stroke: &Stroke) {
    let outline = outline(path, stroke, &target.window());
    fill_polygon(target, outline, FillRule::NonZero);
}

/// The outline of a stroke as closed contours for [`FillRule::NonZero`], all clockwise on the screen (y down); pieces
/// that a window does not show are left out.
pub fn outline(path: &Path, stroke: &Stroke, window: &Window) -> Vec<Vec<DVec2>> {
    let pieces = pieces(path, stroke, window).into_iter();
    pieces
        .map(|piece| match piece {
            Piece::Bar(bar) => bar.corners().to_vec(),
            Piece::Polygon(corners) => corners,
        })
        .collect()
}

/// A convex piece of a stroke, clockwise on the screen.
#[derive(Debug, Clone)]
pub(crate) enum Piece {
    Bar(Bar),
    /// A join or a cap. Cut as its trims say, a bar does not overlap it.
    Polygon(Vec<DVec2>),
}

/// The rectangle of a straight piece.
#[derive(Debug, Clone)]
pub(crate) struct Bar {
    pub from: DVec2,
    pub to: DVec2,
    /// Of length 1.
    pub direction: DVec2,
    /// Half the width.
    pub half: f64,
    /// At both ends, where a corner follows: a normal of its bisector that points to the other segment. Bars that are
    /// cut along the bisectors through their ends do not overlap.
    pub trims: [Option<DVec2>; 2],
}

impl Bar {
    /// `None` if it has no area, or if a number's square is not finite.
    pub fn new(from: DVec2, to: DVec2, width: f64) -> Option<Self> {
        let is_drawn = is_width(width) && is_near(from) && is_near(to);
        let direction = (to - from).try_normalize().filter(|_| is_drawn)?;
        Some(Self {
            from,
            to,
            direction,
            half: 0.5 * width,
            trims: [None; 2],
        })
    }

    pub fn corners(&self) -> [DVec2; 4] {
        let side = self.direction.perp() * self.half;
        [
            self.from - side,
            self.to - side,
            self.to + side,
            self.from + side,
        ]
    }
}

/// The pieces of a stroke that a window shows.
pub(crate) fn pieces(path: &Path, stroke: &Stroke, window: &Window) -> Vec<Piece> {
    let is_drawn = is_width(stroke.width) && path.points.iter().all(|&p| is_near(p));
    if !is_drawn || window.is_empty() {
        return Vec::new();
    }
    let mut outline = Outline {
        stroke,
        half: 0.5 * stroke.width,
        window,
        pieces: Vec::new(),
    };
    match path.points.as_slice() {
        &[point] => outline.dot(point),
        _ => outline.path(path),
    }
    outline.pieces
}

/// The largest numbers whose squares are finite.
const LARGEST: f64 = 1e150;

fn is_width(width: f64) -> bool {
    width > 0.0 && width <= LARGEST
}

fn is_near(point: DVec2) -> bool {
    point.abs().cmple(DVec2::splat(LARGEST)).all()
}

/// A straight part of a path.
#[derive(Debug, Clone)]
struct Segment {
    from: DVec2,
    /// Of length 1.
    direction: DVec2,
    /// From the path's beginning.
    distances: Range<f64>,
}

impl Segment {
    /// The point at a distance from the path's beginning.
    fn at(&self, distance: f64) -> DVec2 {
        self.from + self.direction * (distance - self.distances.start)
    }

    /// The distances between which it is beside the window, or in front of it by no more than `reach`.
    fn beside(&self, window: &Window, reach: f64) -> Range<f64> {
        let [left, right] = [window.left, window.right].map(f64::from);
        let [top, bottom] = [window.top, window.bottom].map(f64::from);
        let along = [[left, top], [right, top], [left, bottom], [right, bottom]]
            .map(|corner| (DVec2::from(corner) - self.from).dot(self.direction));
        let low = along.into_iter().fold(f64::INFINITY, f64::min) - reach;
        let high = along.into_iter().fold(f64::NEG_INFINITY, f64::max) + reach;
        let Range { start, end } = self.distances;
        (start + low).max(start)..(start + high).min(end)
    }
}

/// A window shows fewer dashes of a segment, unless its ends are so far away that nothing is known about it.
const MOST_DASHES: f64 = 1e6;

/// How many times half the width of a stroke may be longer than the period of dashes with caps. Beyond, the caps run
/// into each other and leave notches of less than a 20 000th of half the width.
const FUSED: f64 = 50.0;

/// Pieces on the way.
struct Outline<'a> {
    stroke: &'a Stroke,
    half: f64,
    window: &'a Window,
    pieces: Vec<Piece>,
}

/// A segment with the directions of its neighbours; none where the path ends.
struct Course<'a> {
    segment: &'a Segment,
    before: Option<DVec2>,
    after: Option<DVec2>,
}

impl Outline<'_> {
    fn path(&mut self, path: &Path) {
        let segments = path.segments();
        let is_open = |d: &&Dashes| self.stroke.cap == Cap::Butt || d.period() * FUSED > self.half;
        let dashes = self.stroke.dashes.as_ref().filter(is_open);
        // Dashes do not run from the end of a closed path into its beginning.
        let is_round = path.is_closed && dashes.is_none();
        let direction = |i: usize| segments.get(i).map(|s| s.direction);
        let last = segments.len().wrapping_sub(1);
        for (i, segment) in segments.iter().enumerate() {
            let course = Course {
                segment,
                before: direction(if i == 0 && is_round {
                    last
                } else {
                    i.wrapping_sub(1)
                }),
                after: direction(if i == last && is_round { 0 } else { i + 1 }),
            };
            match dashes {
                None => self.solid(&course),
                Some(dashes) => self.dashes(&course, dashes),
            }
        }
    }

    fn solid(&mut self, course: &Course) {
        self.join(course);
        let distances = course.segment.distances.clone();
        self.bar(course, distances, [course.before, course.after]);
    }

    /// The dashes of a segment. One that goes round its first corner gets a join there.
    fn dashes(&mut self, course: &Course, dashes: &Dashes) {
        let Range { start, end } = course.segment.distances;
        if dashes.intervals(start..start).any(|dash| dash.end > start) {
            self.join(course);
        }
        let reach = if self.stroke.cap == Cap::Butt {
            0.0
        } else {
            self.half
        };
        let visible = course.segment.beside(self.window, reach);
        if visible.end - visible.start > MOST_DASHES * dashes.period() {
            return;
        }
        for dash in dashes.intervals(visible) {
            let begins_here = dash.start >= start;
            if begins_here || dash.end > start {
                let neighbours = [
                    course.before.filter(|_| !begins_here),
                    course.after.filter(|_| dash.end > end),
                ];
                self.bar(course, dash.start.max(start)..dash.end.min(end), neighbours);
            }
        }
    }

    /// A straight piece of a segment between two distances. Ends without a neighbour get caps.
    fn bar(&mut self, course: &Course, distances: Range<f64>, neighbours: [Option<DVec2>; 2]) {
        let direction = course.segment.direction;
        let beyond = |neighbour: Option<DVec2>| {
            let is_square = neighbour.is_none() && self.stroke.cap == Cap::Square;
            if is_square { self.half } else { 0.0 }
        };
        let [from, to] = [distances.start, distances.end].map(|d| course.segment.at(d));
        let bar = Bar {
            from: from - direction * beyond(neighbours[0]),
            to: to + direction * beyond(neighbours[1]),
            direction,
            half: self.half,
            trims: neighbours.map(|neighbour| neighbour.map(|other| direction + other)),
        };
        if self.is_seen(&bar.corners()) {
            self.pieces.push(Piece::Bar(bar));
        }
        if self.stroke.cap == Cap::Round {
            let side = direction.perp() * self.half;
            for (neighbour, at, side) in [(neighbours[0], from, side), (neighbours[1], to, -side)] {
                if neighbour.is_none() {
                    self.wedge(at, side, PI);
                }
            }
        }
    }

    /// The corner at the beginning of a segment, if there is one.
    fn join(&mut self, course: &Course) {
        let Some(before) = course.before else {
            return;
        };
        let (at, after) = (course.segment.from, course.segment.direction);
        let turn = before.perp_dot(after);
        let angle = turn.atan2(before.dot(after));
        if angle == 0.0 {
            return;
        }
        // From the centre to the corners on the outer side, in clockwise order.
        let [first, second] = if angle > 0.0 {
            [-before.perp(), -after.perp()]
        } else {
            [after.perp(), before.perp()]
        };
        let [first, second] = [first, second].map(|normal| normal * self.half);
        if self.stroke.join == Join::Round {
            self.wedge(at, first, angle.abs());
            return;
        }
        let mut contour = vec![at, at + first];
        // 1 / sin(a / 2) of the angle a between the sides, the length of the mitre in widths.
        let ratio = 1.0 / (0.5 * angle).cos().abs();
        if self.stroke.join == Join::Miter && ratio <= self.stroke.miter_limit {
            let middle = (first + second) * 0.5;
            contour.push(at + middle * ratio * ratio);
        }
        contour.push(at + second);
        self.contour(contour);
    }

    /// A wedge of a disc around a point, clockwise from `radius` on.
    fn wedge(&mut self, at: DVec2, radius: DVec2, angle: f64) {
        const TOLERANCE: f64 = 0.02;
        let reach = DVec2::splat(self.half);
        if !self.is_seen(&[at - reach, at + reach]) {
            return;
        }
        let step = 2.0 * (1.0 - TOLERANCE / self.half).max(-0.5).acos();
        let count = (angle / step).ceil().clamp(1.0, 4096.0);
        let mut contour = vec![at];
        let mut k = 0.0;
        while k <= count {
            let turn = DVec2::from_angle(angle * k / count);
            contour.push(at + turn.rotate(radius));
            k += 1.0;
        }
        self.contour(contour);
    }

    /// A path of one point has no direction: a disc, or a square along the axes.
    fn dot(&mut self, point: DVec2) {
        let right = DVec2::X * self.half;
        match self.stroke.cap {
            Cap::Butt => {}
            Cap::Round => self.wedge(point, right, 2.0 * PI),
            Cap::Square => {
                let down = DVec2::Y * self.half;
                let corners = [-right - down, right - down, right + down, down - right];
                self.contour(corners.map(|corner| point + corner).to_vec());
            }
        }
    }

    fn contour(&mut self, contour: Vec<DVec2>) {
        if self.is_seen(&contour) {
            self.pieces.push(Piece::Polygon(contour));
        }
    }

    /// Whether a bounding box meets the window.
    fn is_seen(&self, contour: &[DVec2]) -> bool {
        let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = contour
            .iter()
            .fold(start, |(low, high), &p| (low.min(p), high.max(p)));
        let window = self.window;
        low.x < f64::from(window.right)
            && high.x > f64::from(window.left)
            && low.y < f64::from(window.bottom)
            && high.y > f64::from(window.top)
    }
}
