//! The torus, by a quartic equation.
//!
//! With `p = o + t d`, `|d| = 1` and `o · d = 0` the surface `(|p|² + 1 - k²)² = 4 (x² + z²)` of tube radius k is
//! `t⁴ + 2 (m - 2 a) t² - 8 b t + m² - 4 c = 0` with `m = |o|² + 1 - k²`, `a = dx² + dz²`, `b = ox dx + oz dz`,
//! `c = ox² + oz²`: moving the origin to the nearest point has removed the cubic term.
//!
//! Closed formulas lose half of the digits near double roots, where rays graze the surface. Instead the line is cut where
//! the derivative vanishes, a depressed cubic that is cut by its own two extrema; between the cuts a function is monotone and
//! has a root where its sign changes, which bisected Newton steps find to the last digits. Yuksel, *High-performance polynomial root
//! finding for graphics* (2022), shows how well this does. Signs are taken as positive on both ends of the line, so roots always come
//! in pairs.

use super::{CentredLine, Ends};
use crate::root::monotone_root;
use glam::DVec3;

/// The spans between the roots of the quartic.
pub(super) fn ends(tube: f64, line: &CentredLine) -> Ends {
    let (o, d) = (line.origin, line.direction);
    let reach = 1.0 + tube;
    let half_squared = reach * reach - o.length_squared();
    if half_squared <= 0.0 || o.y.abs() > tube + half_squared.sqrt() * d.y.abs() {
        return Ends::NONE;
    }
    let half = half_squared.sqrt();
    let m = o.length_squared() + 1.0 - tube * tube;
    let a = d.x * d.x + d.z * d.z;
    let b = o.x * d.x + o.z * d.z;
    let c = o.x * o.x + o.z * o.z;
    let p = m - 2.0 * a;
    let quartic = |t: f64| {
        let value = ((t * t + 2.0 * p) * t - 8.0 * b) * t + m * m - 4.0 * c;
        (value, 4.0 * ((t * t + p) * t - 2.0 * b))
    };
    let (cuts, count) = extrema(p, b, half);
    let mut ends = Ends::NONE;
    let (mut from, mut is_inside) = (-half, false);
    for &to in &cuts[..count] {
        let will_be_inside = to < half && quartic(to).0 < 0.0;
        if will_be_inside != is_inside {
            let root = monotone_root(from, to, quartic);
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

/// Where the quartic may turn within `±half`, ascending, and `half` itself; and how many these are.
fn extrema(p: f64, b: f64, half: f64) -> ([f64; 4], usize) {
    let cubic = |t: f64| ((t * t + p) * t - 2.0 * b, 3.0 * t * t + p);
    let turn = (-p / 3.0).max(0.0).sqrt().min(half);
    let mut cuts = [0.0; 4];
    let mut count = 0;
    for (from, to) in [(-half, -turn), (-turn, turn), (turn, half)] {
        if (cubic(from).0 < 0.0) != (cubic(to).0 < 0.0) {
            cuts[count] = monotone_root(from, to, cubic);
            count += 1;
        }
    }
    cuts[count] = half;
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
