//! Surfaces that lie in one place and face the same way: both are seen there, so rows sum to more than 1.
//!
//! ```text
//! sort all lit sides by their planes, rounded: what may lie in one plane is together
//! for each plane: sweep over the boxes around the sides; for each pair whose boxes overlap
//!     clip one polygon by the other (Sutherland, Hodgman 1974); the area of what is left counts
//! ```
//!
//! 1. A side whose plane is near the border of its rounding cell is kept in both cells.
//! 2. The sweep goes along the axis in which boxes are shorter, so that of `n` tiles some `√n` are looked at together.
//!
//! # Limits
//! Planes are one if normals agree to 1e-5 and places to some 1e-5 of the scene's size, which is what rays start off
//! their surfaces: faces so small and far from the origin that rounding tilts them by more are passed over. Overlaps of
//! less than a thousandth of the smaller side are rounding. Beyond [`MOST_PAIRS`] pairs the search ends.

use super::Surfaces;
use crate::patch::PatchMesh;
use crate::patch::face::Side;
use glam::{DVec2, DVec3};

/// Share of the smaller side below which an overlap is rounding.
const ROUNDING: f64 = 1e-3;
/// Agreement of normals that lie in one plane, per component, and the cells in which they are sorted.
const SAME_NORMAL: f64 = 1e-5;
const NORMAL_CELL: f64 = 1e-2;
/// As those, of the planes' places, as shares of the scene's size.
const SAME_PLACE: f64 = 3e-5;
const PLACE_CELL: f64 = 1e-2;
/// Pairs of boxes that are looked at: a second or two.
const MOST_PAIRS: usize = 1 << 28;

/// Two surfaces that lie in one place over some area and face the same way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// Rows of both; the same one twice if it overlaps itself.
    pub surfaces: [usize; 2],
    /// Area over which they overlap, in square scene units.
    pub area: f64,
}

/// A lit side of a face.
struct LitSide {
    surface: usize,
    corners: Vec<DVec3>,
    /// Points to where it radiates.
    normal: DVec3,
    area: f64,
}

/// All overlaps, the largest first.
pub(super) fn find(mesh: &PatchMesh, surfaces: &Surfaces) -> Vec<Overlap> {
    let sides = lit_sides(mesh, surfaces);
    let size = sides.iter().flat_map(|side| &side.corners);
    let size = size.fold(0.0_f64, |most, corner| most.max(corner.abs().max_element()));
    let mut found: Vec<(usize, usize, f64)> = Vec::new();
    let mut pairs = 0;
    let planes = sorted_by_planes(&sides, size);
    for plane in planes.chunk_by(|a, b| a.0 == b.0) {
        let members: Vec<usize> = plane.iter().map(|&(_, side)| side).collect();
        sweep(&sides, &members, size, &mut pairs, &mut found);
    }
    // A pair that shares two cells is found twice.
    found.sort_by_key(|&(a, b, _)| (a, b));
    found.dedup_by_key(|&mut (a, b, _)| (a, b));
    summed(&sides, &found)
}

/// Sums over the pairs of each two surfaces.
fn summed(sides: &[LitSide], found: &[(usize, usize, f64)]) -> Vec<Overlap> {
    let of_surfaces = |&(a, b, area): &(usize, usize, f64)| {
        let mut surfaces = [sides[a].surface, sides[b].surface];
        surfaces.sort_unstable();
        Overlap { surfaces, area }
    };
    let mut overlaps: Vec<Overlap> = found.iter().map(of_surfaces).collect();
    overlaps.sort_by_key(|overlap| overlap.surfaces);
    overlaps.dedup_by(|later, kept| {
        let same = later.surfaces == kept.surfaces;
        if same {
            kept.area += later.area;
        }
        same
    });
    overlaps.sort_by(|a, b| b.area.total_cmp(&a.area));
    overlaps
}

/// The sides that radiate and are no solid's inside, each once.
fn lit_sides(mesh: &PatchMesh, surfaces: &Surfaces) -> Vec<LitSide> {
    let mut sides = Vec::new();
    let mut last = None;
    for patch in 0..mesh.patches().len() {
        let (face, side) = super::face_of_patch(mesh, patch);
        // Patches of one side are consecutive.
        if last.replace((face, side)) == Some((face, side)) {
            continue;
        }
        let Some(surface) = surfaces.of_patch(patch) else {
            continue;
        };
        let face = &mesh.faces()[face];
        let mut corners: Vec<DVec3> = face.polygon().iter().map(|c| c.as_dvec3()).collect();
        if side == Side::Back {
            corners.reverse();
        }
        let doubled = super::contacts::doubled_area(&corners);
        sides.push(LitSide {
            surface,
            corners,
            normal: doubled.normalize_or_zero(),
            area: 0.5 * doubled.length(),
        });
    }
    sides
}

/// Rounded planes, and the sides in each.
fn sorted_by_planes(sides: &[LitSide], size: f64) -> Vec<([i64; 4], usize)> {
    let mut planes = Vec::with_capacity(sides.len());
    for (i, side) in sides.iter().enumerate() {
        let place = side.normal.dot(side.corners[0]) / size.max(f64::MIN_POSITIVE);
        let normal = side
            .normal
            .to_array()
            .map(|x| cells(x, NORMAL_CELL, SAME_NORMAL));
        let place = cells(place, PLACE_CELL, SAME_PLACE);
        for k in 0..16_usize {
            let coordinate = |axis: usize, cells: [i64; 2]| cells[k >> axis & 1];
            let key = [
                coordinate(0, normal[0]),
                coordinate(1, normal[1]),
                coordinate(2, normal[2]),
                coordinate(3, place),
            ];
            planes.push((key, i));
        }
    }
    planes.sort_unstable();
    planes.dedup();
    planes
}

/// The cell of a number, and the neighbour if it is near to that; else the same twice.
#[expect(clippy::cast_possible_truncation, reason = "a few hundred cells")]
fn cells(x: f64, cell: f64, same: f64) -> [i64; 2] {
    [x - same, x + same].map(|x| (x / cell).floor() as i64)
}

/// A side in the plane's coordinates.
struct Flat {
    side: usize,
    corners: Vec<DVec2>,
    low: DVec2,
    high: DVec2,
}

/// Finds the overlaps among the sides of about one plane.
fn sweep(
    sides: &[LitSide],
    members: &[usize],
    size: f64,
    pairs: &mut usize,
    found: &mut Vec<(usize, usize, f64)>,
) {
    if members.len() < 2 {
        return;
    }
    let mut flats = in_the_plane(sides, members);
    flats.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
    let mut open: Vec<usize> = Vec::new();
    for i in 0..flats.len() {
        open.retain(|&j| flats[j].high.x > flats[i].low.x);
        *pairs += open.len();
        if *pairs > MOST_PAIRS {
            return;
        }
        for &j in &open {
            let (a, b) = (&flats[i], &flats[j]);
            let common = a.high.min(b.high) - a.low.max(b.low);
            let least = ROUNDING * sides[a.side].area.min(sides[b.side].area);
            if common.min_element() <= 0.0
                || common.x * common.y <= least
                || !in_one_plane(&sides[a.side], &sides[b.side], size)
            {
                continue;
            }
            let area = common_area(&a.corners, &b.corners);
            if area > least {
                found.push((a.side.min(b.side), a.side.max(b.side), area));
            }
        }
        open.push(i);
    }
}

/// Sides in coordinates of their common plane, the first of which is that in which they are shorter.
fn in_the_plane(sides: &[LitSide], members: &[usize]) -> Vec<Flat> {
    let normal = sides[members[0]].normal;
    let (mut u, mut v) = normal.any_orthonormal_pair();
    // Rooms have walls along the axes; boxes are tight there.
    if let Some(axis) = DVec3::AXES
        .into_iter()
        .find(|axis| axis.dot(normal).abs() < 1e-9)
    {
        (u, v) = (axis, normal.cross(axis));
    }
    let flat = |&side: &usize| {
        let at = |corner: &DVec3| DVec2::new(corner.dot(u), corner.dot(v));
        let corners: Vec<DVec2> = sides[side].corners.iter().map(at).collect();
        let low = corners.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let high = corners
            .iter()
            .copied()
            .fold(DVec2::NEG_INFINITY, DVec2::max);
        Flat {
            side,
            corners,
            low,
            high,
        }
    };
    let mut flats: Vec<Flat> = members.iter().map(flat).collect();
    let extent: DVec2 = flats.iter().map(|flat| flat.high - flat.low).sum();
    if extent.y < extent.x {
        for flat in &mut flats {
            // A mirrored polygon runs the other way round.
            flat.corners.reverse();
            for point in flat
                .corners
                .iter_mut()
                .chain([&mut flat.low, &mut flat.high])
            {
                *point = DVec2::new(point.y, point.x);
            }
        }
    }
    flats
}

/// Whether all corners of the smaller side lie in the plane of the other.
fn in_one_plane(a: &LitSide, b: &LitSide, size: f64) -> bool {
    let (small, large) = if a.area < b.area { (a, b) } else { (b, a) };
    let away = |corner: &DVec3| (*corner - large.corners[0]).dot(large.normal).abs();
    small.corners.iter().map(away).fold(0.0, f64::max) <= SAME_PLACE * size
}

/// Area that two convex polygons have in common, both counter-clockwise.
fn common_area(a: &[DVec2], b: &[DVec2]) -> f64 {
    let mut inside = a.to_vec();
    for i in 0..b.len() {
        let (from, edge) = (b[i], b[(i + 1) % b.len()] - b[i]);
        let depth = |p: DVec2| edge.perp_dot(p - from);
        let mut kept = Vec::with_capacity(inside.len() + 1);
        for k in 0..inside.len() {
            let (p, q) = (inside[k], inside[(k + 1) % inside.len()]);
            let (before, after) = (depth(p), depth(q));
            if before >= 0.0 {
                kept.push(p);
            }
            if before * after < 0.0 {
                kept.push(p.lerp(q, before / (before - after)));
            }
        }
        inside = kept;
    }
    let pairs = inside.windows(2);
    0.5 * pairs
        .map(|pair| (pair[0] - inside[0]).perp_dot(pair[1] - inside[0]))
        .sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(low: DVec2, size: f64) -> Vec<DVec2> {
        let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        corners.map(|corner| low + size * corner).to_vec()
    }

    #[test]
    fn common_areas_of_convex_polygons() {
        let unit = square(DVec2::ZERO, 1.0);
        for (other, expected) in [
            (square(DVec2::splat(0.5), 1.0), 0.25),
            (square(DVec2::splat(0.25), 0.5), 0.25),
            (square(DVec2::splat(-1.0), 3.0), 1.0),
            (square(DVec2::new(1.0, 0.0), 1.0), 0.0),
            (square(DVec2::new(2.0, 0.0), 1.0), 0.0),
            (
                vec![
                    DVec2::new(0.5, -0.5),
                    DVec2::new(1.5, 0.5),
                    DVec2::new(0.5, 1.5),
                ],
                0.5,
            ),
        ] {
            let area = common_area(&unit, &other);
            assert!((area - expected).abs() < 1e-12, "{other:?}: {area}");
        }
    }

    #[test]
    fn numbers_near_a_border_are_in_both_cells() {
        assert_eq!(cells(0.5, 1.0, 0.1), [0, 0], "in the middle");
        assert_eq!(cells(0.95, 1.0, 0.1), [0, 1], "near the upper one");
        assert_eq!(cells(-0.05, 1.0, 0.1), [-1, 0], "and the lower one");
    }
}
