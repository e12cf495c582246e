//! What others leave of a pair: exact from a point, adaptive over an area.
//!
//! From a point x, an occluder hides a pyramid behind it. The target is cut along the planes of the pyramid into parts
//! beside it, which stay visible, and the part within and behind, which goes; what is left goes to the next occluder,
//! and Lambert's contour sum over what remains is the exact visible factor:
//!
//! ```text
//! visible(part, occluders)
//!     if no occluder is left: return factor of the part
//!     for each plane of the first occluder's pyramid
//!         cut the part along it; sum += visible(what lies outside, the other occluders); keep what lies inside
//!     return sum
//! ```
//!
//! Over the area of the other polygon the hidden part is integrated by adaptive cubature. Shadow edges make it bend but
//! not jump; the cell with the largest estimated error is split first.

use super::exchange::{Exchange, exchange};
use super::shaft::{Blocks, Occluder};
use super::site::{Nodes, Site};
use crate::form_factor::polygon::{FlatPolygon, contour_sum, facing_parts, point_to_polygon};
use core::f64::consts::PI;
use glam::DVec3;
use std::collections::BinaryHeap;

/// Corners that a part may have.
const MAX_CORNERS: usize = 14;
/// Above it a part is cut in two before it is cut along planes, which may bring one corner each.
const MANY_CORNERS: usize = 7;
/// Cells after which the cubature ends anyhow.
const MAX_CELLS: usize = 4096;
/// Heights below this share of the distance are rounding.
const ROUNDING: f64 = 1e-12;

/// A convex part of the target, seen from the origin.
#[derive(Clone, Copy)]
struct Part {
    corners: [DVec3; MAX_CORNERS],
    count: usize,
}

impl Part {
    const EMPTY: Self = Self {
        corners: [DVec3::ZERO; MAX_CORNERS],
        count: 0,
    };

    fn seen_from(x: DVec3, polygon: &FlatPolygon) -> Self {
        let mut part = Self::EMPTY;
        for &corner in polygon.corners() {
            part.push(corner - x);
        }
        part
    }

    fn push(&mut self, corner: DVec3) {
        // There is room for convex parts; an outline that rounding bent loses a corner.
        if self.count < MAX_CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// The parts above and below a plane.
    fn split(&self, plane: &Plane) -> (Self, Self) {
        let mut heights = [0.0; MAX_CORNERS];
        for (height, &corner) in heights.iter_mut().zip(self.corners()) {
            *height = plane.height(corner);
        }
        let (mut above, mut below) = (Self::EMPTY, Self::EMPTY);
        for i in 0..self.count {
            let next = if i + 1 < self.count { i + 1 } else { 0 };
            let (a, b) = (self.corners[i], self.corners[next]);
            let (ha, hb) = (heights[i], heights[next]);
            if ha >= 0.0 {
                above.push(a);
            }
            if ha <= 0.0 {
                below.push(a);
            }
            if (ha > 0.0 && hb < 0.0) || (ha < 0.0 && hb > 0.0) {
                let cut = a + (b - a) * (ha / (ha - hb));
                above.push(cut);
                below.push(cut);
            }
        }
        (above, below)
    }

    /// Two parts of fewer corners.
    fn halves(&self) -> [Self; 2] {
        let middle = self.count / 2;
        let (mut first, mut second) = (Self::EMPTY, Self::EMPTY);
        self.corners[..=middle].iter().for_each(|&c| first.push(c));
        self.corners[middle..self.count]
            .iter()
            .for_each(|&c| second.push(c));
        second.push(self.corners[0]);
        [first, second]
    }
}

/// A plane; what is above it is hidden, as far as it is above the others.
#[derive(Clone, Copy)]
struct Plane {
    normal: DVec3,
    offset: f64,
    tolerance: f64,
}

impl Plane {
    /// Height of a point, 0 within rounding.
    fn height(&self, point: DVec3) -> f64 {
        let height = point.dot(self.normal) - self.offset;
        if height.abs() <= self.tolerance {
            0.0
        } else {
            height
        }
    }
}

/// The pyramid that an occluder hides from a point: above all of its planes.
#[derive(Clone, Copy)]
pub struct Shadow {
    planes: [Plane; 7],
    count: usize,
}

impl Shadow {
    /// `None` where the occluder is seen edge-on.
    fn of(x: DVec3, occluder: &Occluder) -> Option<Self> {
        let occluder = &occluder.polygon;
        let corners = occluder.corners();
        let height = (corners[0] - x).dot(occluder.normal);
        let reach = corners
            .iter()
            .map(|c| c.distance_squared(x))
            .fold(0.0, f64::max)
            .sqrt();
        let tolerance = ROUNDING * reach;
        if height.abs() <= tolerance {
            return None;
        }
        // Seen against its normal the corners run counter-clockwise, and the planes' normals point outwards.
        let inwards = height.signum();
        let behind = Plane {
            normal: occluder.normal * inwards,
            offset: height.abs(),
            tolerance,
        };
        let mut shadow = Self {
            planes: [behind; 7],
            count: corners.len() + 1,
        };
        for (i, &corner) in corners.iter().enumerate() {
            let next = corners[(i + 1) % corners.len()];
            let normal = (corner - x).cross(next - corner) * inwards;
            shadow.planes[i] = Plane {
                normal: normal.normalize_or_zero(),
                offset: 0.0,
                tolerance,
            };
        }
        Some(shadow)
    }

    fn planes(&self) -> &[Plane] {
        &self.planes[..self.count]
    }

    /// Whether a part lies outside one of the planes, so that nothing of it is hidden.
    fn misses(&self, part: &Part) -> bool {
        let is_outside = |plane: &Plane| part.corners().iter().all(|&c| plane.height(c) <= 0.0);
        self.planes().iter().any(is_outside)
    }
}

/// `Σ θ n·Γ` of what the shadows leave of a part; negative, as the contour sum of what faces the point is.
fn visible(part: &Part, shadows: &[Shadow], normal: DVec3) -> f64 {
    let hit = shadows.iter().position(|shadow| !shadow.misses(part));
    let Some(hit) = hit else {
        return contour_sum(part.corners(), normal);
    };
    if part.count > MANY_CORNERS {
        let halves = part.halves();
        return halves
            .iter()
            .map(|half| visible(half, &shadows[hit..], normal))
            .sum();
    }
    let (mut inside, mut sum) = (*part, 0.0);
    for plane in shadows[hit].planes() {
        let (above, below) = inside.split(plane);
        if below.count >= 3 {
            sum += visible(&below, &shadows[hit + 1..], normal);
        }
        if above.count < 3 {
            break;
        }
        inside = above;
    }
    sum
}

/// Memory for [`visible_factor`], used again and again.
pub type Shadows = Vec<Shadow>;

/// Factor from a point with unit normal to what convex occluders leave of a convex polygon that is wholly above the
/// point's horizon, in [0, 1].
pub fn visible_factor<'a>(
    x: DVec3,
    normal: DVec3,
    target: &FlatPolygon,
    occluders: impl Iterator<Item = &'a Occluder>,
    shadows: &mut Shadows,
) -> f64 {
    shadows.clear();
    shadows.extend(occluders.filter_map(|occluder| Shadow::of(x, occluder)));
    let sum = visible(&Part::seen_from(x, target), shadows, normal);
    (-sum / (2.0 * PI)).clamp(0.0, 1.0)
}

/// What adaptive cubature found of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cubature {
    /// `A F` that is hidden and that is left, square of the unit of length.
    pub hidden: f64,
    /// See `hidden`; their sum is off by the cubature's error for what is not hidden.
    pub visible: f64,
    /// Estimate of the error of the smaller of both.
    pub error: f64,
}

impl Cubature {
    /// `A F` of the pair when `whole` is what it is without occluders, exactly.
    ///
    /// Where polygons touch, the factor without occluders varies strongly, and only the hidden or the visible part,
    /// whichever is smaller, is known well.
    pub fn of_whole(&self, whole: f64) -> f64 {
        if self.hidden < self.visible {
            (whole - self.hidden).max(0.0)
        } else {
            self.visible.min(whole)
        }
    }
}

/// A cell of the cubature: a part of the outer polygon.
struct Cell {
    corners: [DVec3; 4],
    count: usize,
    depth: i32,
    /// Integrals over it of the factor without occluders and with them.
    whole: f64,
    visible: f64,
    error: f64,
}

impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        self.error == other.error
    }
}

impl Eq for Cell {}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cell {
    fn cmp(&self, other: &Self) -> core::cmp::Ordering {
        self.error.total_cmp(&other.error)
    }
}

impl Cell {
    fn quarters(&self) -> [([DVec3; 4], usize); 4] {
        let [a, b, c, d] = self.corners;
        let (ab, bc) = (a.midpoint(b), b.midpoint(c));
        if self.count == 3 {
            let ca = c.midpoint(a);
            return [
                [a, ab, ca, ca],
                [ab, b, bc, bc],
                [ca, bc, c, c],
                [ab, bc, ca, ca],
            ]
            .map(|q| (q, 3));
        }
        let (cd, da, m) = (c.midpoint(d), d.midpoint(a), 0.5 * (ab + c.midpoint(d)));
        [
            [a, ab, m, da],
            [ab, b, bc, m],
            [m, bc, c, cd],
            [da, m, cd, d],
        ]
        .map(|q| (q, 4))
    }
}

/// What occluders leave between two polygons wholly in front of each other's plane, to an error of `A F` of about
/// `tolerance`; lengths below `rounding` do not count.
///
/// The error of a cell is estimated from how far the hidden factor at its centre is from the mean of its four points,
/// and how much these differ; errors of cells are taken as independent. A cell into whose shaft an occluder reaches
/// but of which all points or none are shaded is taken to be wrong by a share that falls with its area, so that small
/// occluders and small gaps are found.
pub fn cubature(
    a: &FlatPolygon,
    b: &FlatPolygon,
    occluders: &[&Occluder],
    tolerance: f64,
    rounding: f64,
    shadows: &mut Shadows,
) -> Cubature {
    // From afar shadows move little: points are taken where occluders are farthest by the polygon's size.
    let remoteness = |polygon: &FlatPolygon| {
        let (centre, radius) = (polygon.centre(), polygon.radius(polygon.centre()));
        let distances = occluders.iter().map(|o| o.polygon.distance(centre));
        distances.fold(f64::INFINITY, f64::min) / radius
    };
    let (outer, target) = if remoteness(a) >= remoteness(b) {
        (a, b)
    } else {
        (b, a)
    };
    let mut view = View {
        outer,
        target,
        occluders,
        rounding,
        shadows,
        near: Vec::new(),
    };
    let mut cells: BinaryHeap<Cell> = outer
        .pieces()
        .map(|(corners, count)| view.cell(corners, count, 0))
        .collect();
    let mut variance: f64 = cells.iter().map(|c| c.error * c.error).sum();
    while variance > tolerance * tolerance && cells.len() < MAX_CELLS {
        let Some(worst) = cells.pop() else { break };
        variance = (variance - worst.error * worst.error).max(0.0);
        for (corners, count) in worst.quarters() {
            let part = view.cell(corners, count, worst.depth + 1);
            variance += part.error * part.error;
            cells.push(part);
        }
    }
    let (mut hidden, mut visible) = (0.0, 0.0);
    for cell in &cells {
        hidden += cell.whole - cell.visible;
        visible += cell.visible;
    }
    Cubature {
        hidden,
        visible,
        error: variance.max(0.0).sqrt(),
    }
}

/// A pair under cubature.
struct View<'a> {
    outer: &'a FlatPolygon,
    target: &'a FlatPolygon,
    occluders: &'a [&'a Occluder],
    rounding: f64,
    shadows: &'a mut Shadows,
    /// Occluders in the shaft of the cell.
    near: Vec<&'a Occluder>,
}

impl View<'_> {
    /// Factors from a point, without occluders and with them.
    fn factors(&mut self, x: DVec3) -> (f64, f64) {
        let whole = point_to_polygon(x, self.outer.normal, self.target);
        if self.near.is_empty() {
            return (whole, whole);
        }
        let near = self.near.iter().copied();
        let seen = visible_factor(x, self.outer.normal, self.target, near, self.shadows);
        (whole, seen.min(whole))
    }

    fn cell(&mut self, corners: [DVec3; 4], count: usize, depth: i32) -> Cell {
        let polygon = &corners[..count];
        self.near.clear();
        let mut is_hidden = false;
        for &occluder in self.occluders {
            match occluder.blocks(polygon, self.target.corners(), self.rounding) {
                Blocks::Nothing => {}
                Blocks::Part => self.near.push(occluder),
                Blocks::All => is_hidden = true,
            }
        }
        if is_hidden {
            self.near.clear();
        }
        let nodes = Nodes::<1>::new(polygon, 2);
        let (mut whole, mut visible, mut area) = (0.0, 0.0, 0.0);
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for (x, weight) in nodes.iter() {
            let (all, seen) = self.factors(x);
            whole += weight * all;
            visible += weight * seen;
            area += weight;
            (least, most) = (least.min(all - seen), most.max(all - seen));
        }
        let mut error = 0.0;
        if is_hidden {
            visible = 0.0;
        } else if !self.near.is_empty() {
            let centre = polygon.iter().sum::<DVec3>() / count as f64;
            let (all, seen) = self.factors(centre);
            let bend = (area * (all - seen) - (whole - visible)).abs();
            error = BEND * bend + SPREAD * area * (most - least);
            // Cuts that miss leave rounding.
            let rounding = 1e-9 * whole;
            let nothing_hidden = area * most.max(all - seen) <= rounding;
            let nothing_seen = visible.max(area * seen) <= rounding;
            if nothing_hidden || nothing_seen {
                error = UNSEEN * whole * 0.25_f64.powi(depth);
            }
        }
        Cell {
            corners,
            count,
            depth,
            whole,
            visible,
            error,
        }
    }
}

/// Weights of both signs of an error; see the test that measures them.
const BEND: f64 = 0.3;
const SPREAD: f64 = 1.0 / 64.0;
/// Share of a pair's factor that may be hidden, or seen, where no point of an undivided polygon tells.
const UNSEEN: f64 = 0.1;

/// `A_a F_ab` of two convex polygons of three or four corners with convex occluders of three to six between them, to an
/// error of about `tolerance`; both sides of an occluder hide. Panics on other numbers of corners.
///
/// Corners run counter-clockwise seen from the side that radiates. Never more than without occluders.
///
/// ```
/// use glam::DVec3;
/// use hemicube_radiosity::form_factor::analytic::occluded_exchange;
///
/// let square = |z: f64, r: f64| [(-r, -r), (r, -r), (r, r), (-r, r)].map(|(x, y)| DVec3::new(x, y, z));
/// let mut ceiling = square(1.0, 0.5);
/// ceiling.reverse();
/// let blocker = square(0.5, 0.25);
/// let found = occluded_exchange(&square(0.0, 0.5), &ceiling, &[&blocker], 1e-6);
/// assert!((found.area - 0.099_506_294_6).abs() < 1e-6, "half of it is hidden");
/// ```
pub fn occluded_exchange(
    a: &[DVec3],
    b: &[DVec3],
    occluders: &[&[DVec3]],
    tolerance: f64,
) -> Exchange {
    let whole = exchange(a, b);
    let (a, b) = (Site::new(a), Site::new(b));
    let Some((part_a, part_b)) = facing_parts(&a.polygon, &b.polygon) else {
        return Exchange::default();
    };
    let occluders: Vec<Occluder> = occluders
        .iter()
        .map(|o| Occluder::new(FlatPolygon::from_corners(o)))
        .collect();
    let occluders: Vec<&Occluder> = occluders.iter().collect();
    let rounding = ROUNDING * (a.radius + b.radius + a.centre.distance(b.centre));
    let seen = cubature(
        &part_a,
        &part_b,
        &occluders,
        tolerance,
        rounding,
        &mut Shadows::new(),
    );
    Exchange {
        area: seen.of_whole(whole.area),
        error: seen.error + whole.error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(centre: DVec3, half: f64) -> [DVec3; 4] {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| centre + half * DVec3::new(x, y, 0.0))
    }

    /// Looks down.
    fn ceiling(centre: DVec3, half: f64) -> FlatPolygon {
        let mut corners = square(centre, half);
        corners.reverse();
        FlatPolygon::from_corners(&corners)
    }

    fn screen(centre: DVec3, half: f64) -> Occluder {
        Occluder::new(FlatPolygon::from_corners(&square(centre, half)))
    }

    #[test]
    fn a_shadow_is_the_occluder_as_seen_from_the_point() {
        let target = ceiling(DVec3::Z, 1.0);
        let normal = DVec3::Z;
        let whole = point_to_polygon(DVec3::ZERO, normal, &target);
        for half in [0.1, 0.3, 0.49] {
            let blocker = screen(DVec3::Z * 0.5, half);
            let hidden = point_to_polygon(DVec3::ZERO, normal, &ceiling(DVec3::Z * 0.5, half));
            let seen = visible_factor(
                DVec3::ZERO,
                normal,
                &target,
                [blocker].iter(),
                &mut Shadows::new(),
            );
            assert!(
                (whole - seen - hidden).abs() < 1e-14,
                "{seen} and {hidden} of {whole}"
            );
        }
        let all = screen(DVec3::Z * 0.5, 0.5);
        let seen = visible_factor(
            DVec3::ZERO,
            normal,
            &target,
            [all].iter(),
            &mut Shadows::new(),
        );
        assert!(seen < 1e-14, "{seen} past a blocker that covers it");
        let behind = screen(DVec3::Z * 1.5, 5.0);
        let seen = visible_factor(
            DVec3::ZERO,
            normal,
            &target,
            [behind].iter(),
            &mut Shadows::new(),
        );
        assert!((seen - whole).abs() < 1e-15, "what is behind hides nothing");
    }

    #[test]
    fn shadows_that_overlap_count_once_in_any_order() {
        let target = ceiling(DVec3::new(0.2, 0.0, 1.0), 0.8);
        let x = DVec3::new(0.1, -0.2, 0.0);
        let mut screens: Vec<Occluder> = (0..5)
            .map(|i| {
                let t = f64::from(i);
                screen(
                    DVec3::new(0.1 * t - 0.2, 0.15 * t - 0.3, 0.3 + 0.1 * t),
                    0.12 + 0.02 * t,
                )
            })
            .collect();
        let seen = |screens: &[Occluder]| {
            visible_factor(x, DVec3::Z, &target, screens.iter(), &mut Shadows::new())
        };
        let first = seen(&screens);
        screens.reverse();
        assert!(
            (seen(&screens) - first).abs() < 1e-14,
            "{first} and {}",
            seen(&screens)
        );
        screens.swap(0, 2);
        assert!(
            (seen(&screens) - first).abs() < 1e-14,
            "{first} and {}",
            seen(&screens)
        );
        let most = point_to_polygon(x, DVec3::Z, &target);
        assert!(
            first > 0.1 * most && first < 0.9 * most,
            "{first} of {most}"
        );
    }

    #[test]
    fn small_occluders_and_small_gaps_are_found() {
        let floor = square(DVec3::ZERO, 0.5);
        let mut above = square(DVec3::Z, 0.5);
        above.reverse();
        let whole = occluded_exchange(&floor, &above, &[], 1e-7).area;
        // Between the points of the first cell, close above the floor.
        let speck = square(DVec3::new(0.1, 0.07, 0.01), 0.02);
        let found = occluded_exchange(&floor, &above, &[&speck], 1e-6);
        let hidden = whole - found.area;
        // It hides nearly all of what leaves the 4 cm² below: an area of 0.0016 times a factor near 0.24.
        assert!((3e-4..5e-4).contains(&hidden), "{hidden} is hidden");
        // A screen with a gap of 4 cm along one side.
        let screen = [(-1.0, -1.0), (0.11, -1.0), (0.11, 1.0), (-1.0, 1.0)]
            .map(|(x, y)| DVec3::new(x, y, 0.01));
        let other = [(0.15, -1.0), (1.0, -1.0), (1.0, 1.0), (0.15, 1.0)]
            .map(|(x, y)| DVec3::new(x, y, 0.01));
        let through = occluded_exchange(&floor, &above, &[&screen, &other], 1e-6).area;
        assert!(
            (0.004..0.010).contains(&through),
            "{through} gets through the gap"
        );
    }
}
