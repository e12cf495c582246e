//! The torus, by a quartic equation.
//!
//! With `p = o + t d`, `|d| = 1` and `o · d = 0` the surface `(|p|² + 1 - k²)² = 4 (x² + z²)` of tube radius k is
//! `t⁴ + 2 (m - 2 a) t² - 8 b t + m² - 4 c = 0` with `m = |o|² + 1 - k²`, `a = dx² + dz²`, `b = ox dx + oz dz`,
//! `c = ox² + oz²`: moving the origin to the nearest point has removed the cubic term.
//!
//! Closed formulas lose half of the digits near double roots, where rays graze the surface. Instead the line is cut
//! where the derivative vanishes, a depressed cubic that is cut by its own two extrema; between the cuts a function is
//! monotone and has a root where its sign changes, which bisected Newton steps find to the last digits. Yuksel,
//! *High-performance polynomial root finding for graphics* (2022), shows how well this does. Signs are taken as
//! positive on both ends of the line, so roots always come in pairs.

use super::{CentredLine, Ends};
use crate::root::monotone_root;
use glam::DVec3;

/// The spans between the roots of the quartic.
pub(super) fn ends(tube: f64, line: &CentredLine) -> Ends {
    let Some([low, high]) = within_reach(tube, line) else {
        return Ends::NONE;
    };
    let (o, d) = (line.origin, line.direction);
    // The squared distance from the axis is a t² + 2 b t + c.
    let a = d.x * d.x + d.z * d.z;
    let b = o.x * d.x + o.z * d.z;
    let c = o.x * o.x + o.z * o.z;
    let off_axis = |t: f64| (a * t + 2.0 * b) * t + c;
    let is_in_the_hole = tube < 1.0 && off_axis(low).max(off_axis(high)) < (1.0 - tube).powi(2);
    if is_in_the_hole || off_axis((-b / a).clamp(low, high)) > (1.0 + tube).powi(2) {
        return Ends::NONE;
    }
    let m = o.length_squared() + 1.0 - tube * tube;
    let p = m - 2.0 * a;
    let quartic = |t: f64| {
        let value = ((t * t + 2.0 * p) * t - 8.0 * b) * t + m * m - 4.0 * c;
        (value, 4.0 * ((t * t + p) * t - 2.0 * b))
    };
    let (cuts, count) = extrema(p, b, [low, high]);
    let mut ends = Ends::NONE;
    let (mut from, mut is_inside) = (low, false);
    for &to in &cuts[..count] {
        let will_be_inside = to < high && quartic(to).0 < 0.0;
        if will_be_inside != is_inside {
            // Where a parabola through the lowest point between the roots is 0.
            let lowest = if is_inside { from } else { to };
            let depth = -quartic(lowest).0 / (6.0 * lowest * lowest + 2.0 * p);
            let start = lowest + depth.sqrt().copysign(if is_inside { 1.0 } else { -1.0 });
            let root = monotone_root([from, to], start, is_inside, 0.0, quartic);
            if tube <= 1.0 || is_outer(tube, line.at(root)) {
                ends.push(root);
            }
        }
        (from, is_inside) = (to, will_be_inside);
    }
    // A line through one of the two points where the surface meets itself may lose one of a pair to rounding.
    ends.len -= ends.len % 2;
    ends
}

/// The part of the line within the ball around the torus and between the planes that touch it, if there is any.
fn within_reach(tube: f64, line: &CentredLine) -> Option<[f64; 2]> {
    let half_squared = (1.0 + tube).powi(2) - line.origin.length_squared();
    if half_squared <= 0.0 {
        return None;
    }
    let half = half_squared.sqrt();
    let (height, slope) = (line.origin.y, line.direction.y);
    let (a, b) = ((-tube - height) / slope, (tube - height) / slope);
    // Along the planes both are infinite, and of the same sign if the line is not between them.
    let (low, high) = (a.min(b).max(-half), a.max(b).min(half));
    (low < high).then_some([low, high])
}

/// How well an extremum has to be known: the value there is off by the square of it, which is rounding.
const FLAT: f64 = 1e-8;

/// Where the quartic may turn between two places, ascending, and the upper place itself; and how many these are.
fn extrema(p: f64, b: f64, [low, high]: [f64; 2]) -> ([f64; 4], usize) {
    let cubic = |t: f64| ((t * t + p) * t - 2.0 * b, 3.0 * t * t + p);
    let turn = (-p / 3.0).max(0.0).sqrt();
    let places = [low, (-turn).clamp(low, high), turn.clamp(low, high), high];
    let mut cuts = [0.0; 4];
    let mut count = 0;
    for pair in places.windows(2) {
        let rises = cubic(pair[0]).0 < 0.0;
        if rises != (cubic(pair[1]).0 < 0.0) {
            cuts[count] = monotone_root([pair[0], pair[1]], f64::NAN, rises, FLAT, cubic);
            count += 1;
        }
    }
    cuts[count] = high;
    (cuts, count + 1)
}

/// Whether a point of the surface of a torus that meets itself is on its outer part, not on the lemon inside.
fn is_outer(tube: f64, p: DVec3) -> bool {
    let rho = p.x.hypot(p.z);
    let off = |centre: f64| (rho - centre).powi(2) + p.y * p.y - tube * tube;
    off(1.0).abs() < off(-1.0).abs()
}

/// Away from the ring within the tube; along the axis at the apple's two dimples, where the ring has no nearest point.
pub(super) fn normal(p: DVec3) -> DVec3 {
    let rho = p.x.hypot(p.z);
    if rho > 0.0 {
        let outwards = 1.0 - 1.0 / rho;
        DVec3::new(p.x * outwards, p.y, p.z * outwards)
    } else {
        DVec3::Y * p.y
    }
}

pub(super) fn contains(tube: f64, p: DVec3) -> bool {
    (p.x.hypot(p.z) - 1.0).powi(2) + p.y * p.y <= tube * tube
}
