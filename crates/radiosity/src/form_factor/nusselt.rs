//! Nusselt's analog: a form factor of a point is an area in the unit circle.
//!
//! Project the polygon on the hemisphere around the point, then straight down to the base circle: the share of the
//! circle that the picture covers is the form factor (Nusselt 1928). [`element_to_polygon`] computes the area by its
//! contour, exactly; [`counted`] counts cells of the circle, as in the lecture; [`projected_outline`] is the drawing.

use super::analytic::{in_front, vector_area};
use core::f64::consts::PI;
use glam::{DVec2, DVec3};

/// Form factor from a differential element at `point` with unit `normal` to the front of a simple planar polygon,
/// convex or not, in [0, 1].
///
/// `F = 1/2π Σ θ_i n·Γ_i` over the edges of the part above the horizon, θ the angle that an edge subtends and Γ the unit
/// normal of its plane through the point (Lambert 1760). Error below 1e-12. The front is where corners run
/// counter-clockwise; 0 from behind and in the polygon's plane.
pub fn element_to_polygon(point: DVec3, normal: DVec3, polygon: &[DVec3]) -> f64 {
    visible_part(point, normal, polygon).map_or(0.0, |part| {
        contour_factor(point, normal, &part).clamp(0.0, 1.0)
    })
}

/// The part of a polygon above the horizon; `None` if there is none or the point is not in front of the polygon.
fn visible_part(point: DVec3, normal: DVec3, polygon: &[DVec3]) -> Option<Vec<DVec3>> {
    let front = (point - *polygon.first()?).dot(vector_area(polygon));
    let part = in_front(polygon, point, normal, 0.0);
    (front > 0.0 && part.len() >= 3).then_some(part)
}

/// Lambert's sum for a polygon that is above the horizon; negative from behind.
pub(crate) fn contour_factor(point: DVec3, normal: DVec3, polygon: &[DVec3]) -> f64 {
    let mut sum = 0.0;
    for (i, &corner) in polygon.iter().enumerate() {
        let next = polygon[(i + 1) % polygon.len()];
        let (a, b) = (corner - point, next - point);
        // a × b, from the edge itself: no cancellation for short edges far away.
        let cross = a.cross(next - corner);
        let sine = cross.length();
        // An edge through the point subtends no angle that counts: its plane holds the point.
        if sine > 0.0 {
            sum += sine.atan2(a.dot(b)) / sine * cross.dot(normal);
        }
    }
    // From its front a polygon runs clockwise around the direction towards it.
    -sum / (2.0 * PI)
}

/// The outline of the polygon's picture in the unit circle, `steps` points to an edge (at least 1).
///
/// The axes are those of [`DVec3::any_orthonormal_pair`] of the normal. Straight edges become arcs of ellipses, the
/// horizon the circle itself. Empty if nothing is visible; a polygon that is not convex and crosses the horizon has
/// bridges along the circle that run forth and back.
pub fn projected_outline(point: DVec3, normal: DVec3, polygon: &[DVec3], steps: u32) -> Vec<DVec2> {
    let part = visible_part(point, normal, polygon).unwrap_or_default();
    let (x_axis, y_axis) = normal.any_orthonormal_pair();
    let mut outline = Vec::new();
    for (i, &corner) in part.iter().enumerate() {
        let (from, to) = (corner - point, part[(i + 1) % part.len()] - point);
        let angle = from.angle_between(to);
        for step in 0..steps.max(1) {
            let t = f64::from(step) / f64::from(steps.max(1));
            // Equal angles along the great circle; for short edges that is the edge itself.
            let (weight_a, weight_b) = if angle > 1e-6 {
                (((1.0 - t) * angle).sin(), (t * angle).sin())
            } else {
                (1.0 - t, t)
            };
            let on_sphere = (from.normalize_or_zero() * weight_a
                + to.normalize_or_zero() * weight_b)
                .normalize_or_zero();
            outline.push(DVec2::new(on_sphere.dot(x_axis), on_sphere.dot(y_axis)));
        }
    }
    outline
}

/// [`element_to_polygon`] by counting: of the cells of a `resolution`² grid over the circle, those whose middle is in the
/// picture, by those whose middle is in the circle.
///
/// Only cells that an outline crosses can count wrongly. An outline of length ℓ crosses at most about `√2 ℓ / h` cells of
/// width `h = 2 / resolution`, the circle's own is 2π: the error is below `√2 h (ℓ + 2π) / π`, O(1/resolution): for a
/// convex polygon at most `12 / resolution`, and mostly much less because errors of both signs meet.
///
/// ```
/// use glam::DVec3;
/// use hemicube_radiosity::form_factor::nusselt::{counted, element_to_polygon};
///
/// let ceiling = [DVec3::Z, DVec3::new(0.0, 1.0, 1.0), DVec3::ONE, DVec3::new(1.0, 0.0, 1.0)];
/// let exact = element_to_polygon(DVec3::ZERO, DVec3::Z, &ceiling);
/// let coarse = counted(DVec3::ZERO, DVec3::Z, &ceiling, 64);
/// assert!((exact - 0.138_531).abs() < 1e-6 && (coarse - exact).abs() < 12.0 / 64.0, "{exact}, {coarse}");
/// ```
pub fn counted(point: DVec3, normal: DVec3, polygon: &[DVec3], resolution: u32) -> f64 {
    let resolution = resolution.max(1);
    // Chords about as long as a cell: they leave the arc by about its square.
    let outline = projected_outline(point, normal, polygon, resolution.min(4096));
    let (mut inside, mut circle) = (0_u64, 0_u64);
    let mut crossings = Vec::new();
    for row in 0..resolution {
        let y = middle(row, resolution);
        row_crossings(&outline, y, &mut crossings);
        for column in 0..resolution {
            let x = middle(column, resolution);
            if x * x + y * y < 1.0 {
                circle += 1;
                let left = crossings.partition_point(|&crossing| crossing < x);
                inside += u64::from(left % 2 == 1);
            }
        }
    }
    inside as f64 / circle as f64
}

/// Middle of a cell of [-1, 1].
fn middle(cell: u32, resolution: u32) -> f64 {
    (2.0 * f64::from(cell) + 1.0) / f64::from(resolution) - 1.0
}

/// Where the outline crosses a row, ascending: between the first and the second is inside.
fn row_crossings(outline: &[DVec2], y: f64, crossings: &mut Vec<f64>) {
    crossings.clear();
    for (i, &a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % outline.len()];
        if (a.y <= y) != (b.y <= y) {
            crossings.push(a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y));
        }
    }
    crossings.sort_unstable_by(f64::total_cmp);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(corners: &[(f64, f64)], height: f64) -> Vec<DVec3> {
        // Looks down: clockwise from above.
        let up = corners.iter().map(|&(x, y)| DVec3::new(x, y, height));
        let mut corners: Vec<DVec3> = up.collect();
        corners.reverse();
        corners
    }

    const U: [(f64, f64); 8] = [
        (-1.0, -1.0),
        (2.0, -1.0),
        (2.0, 2.0),
        (1.0, 2.0),
        (1.0, 0.5),
        (0.0, 0.5),
        (0.0, 2.0),
        (-1.0, 2.0),
    ];

    #[test]
    fn a_polygon_that_is_not_convex_is_a_square_without_its_notch() {
        let square = flat(&[(-1.0, -1.0), (2.0, -1.0), (2.0, 2.0), (-1.0, 2.0)], 1.0);
        let notch = flat(&[(0.0, 0.5), (1.0, 0.5), (1.0, 2.0), (0.0, 2.0)], 1.0);
        // Upright, and tilted so far that the horizon cuts both arms off their foot.
        for normal in [
            DVec3::Z,
            DVec3::new(0.0, 1.0, 0.3),
            DVec3::new(0.3, 1.0, -1.0),
        ] {
            let n = normal.normalize();
            let factor = |polygon: &[DVec3]| element_to_polygon(DVec3::ZERO, n, polygon);
            let (found, exact) = (factor(&flat(&U, 1.0)), factor(&square) - factor(&notch));
            assert!(exact > 1e-3, "normal {normal} sees it: {exact}");
            assert!(
                (found - exact).abs() < 1e-14,
                "normal {normal}: {found} is not {exact}"
            );
        }
    }

    #[test]
    fn counting_converges_to_the_contour() {
        for normal in [DVec3::Z, DVec3::new(0.3, 1.0, 0.2), DVec3::X] {
            let n = normal.normalize();
            let exact = element_to_polygon(DVec3::ZERO, n, &flat(&U, 1.0));
            for resolution in [16, 64, 256, 1024] {
                let found = counted(DVec3::ZERO, n, &flat(&U, 1.0), resolution);
                // The U's outline is at most twice as long as the circle's.
                assert!(
                    (found - exact).abs() < 18.0 / f64::from(resolution),
                    "normal {normal}, {resolution} cells: {found} is not {exact}"
                );
            }
        }
    }

    #[test]
    fn the_outline_stays_in_the_circle_and_has_the_factors_area() {
        let n = DVec3::new(0.3, 1.0, 0.2).normalize();
        let polygon = flat(&U, 1.0);
        let outline = projected_outline(DVec3::ZERO, n, &polygon, 2000);
        let mut doubled = 0.0;
        for (i, &a) in outline.iter().enumerate() {
            assert!(a.length() < 1.0 + 1e-12, "{a} is in the circle");
            doubled += a.perp_dot(outline[(i + 1) % outline.len()]);
        }
        let exact = element_to_polygon(DVec3::ZERO, n, &polygon);
        // The chords of 2,000 steps to an edge.
        assert!(
            (0.5 * doubled.abs() / PI - exact).abs() < 1e-6,
            "area {doubled} for {exact}"
        );
    }

    #[test]
    fn nothing_is_seen_from_behind_or_below() {
        let polygon = flat(&U, 1.0);
        for (point, normal) in [
            (DVec3::Z * 2.0, -DVec3::Z),
            (DVec3::ZERO, -DVec3::Z),
            (DVec3::new(5.0, 5.0, 1.0), -DVec3::X),
        ] {
            assert_eq!(
                element_to_polygon(point, normal, &polygon),
                0.0,
                "from {point}"
            );
            assert_eq!(counted(point, normal, &polygon, 32), 0.0, "from {point}");
        }
        assert_eq!(
            element_to_polygon(DVec3::ZERO, DVec3::Z, &[]),
            0.0,
            "no corners"
        );
    }
}
