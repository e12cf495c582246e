//! A cell with segments in it as triangles and quads: a constrained Delaunay triangulation (Chew 1989), neighbouring
//! triangles in pairs where they make good quads.

use super::arrangement::Arrangement;
use glam::DVec2;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};

/// Corners by their position in [`Arrangement::points`], counter-clockwise.
pub type Corners = Vec<usize>;

/// How far points on edges are pushed into the cell, as a share of the edge's length. A point that rounding puts
/// outside the straight edge would be left out by the triangulation's edge from corner to corner.
const DENT: f64 = 1e-6;
/// Sine of the smallest, and so of the largest, angle that a quad may have.
const LEAST_SINE: f64 = 0.3;

/// The cells of an arrangement; none if rounding kept it from being triangulated.
pub fn cells(cell: &Arrangement) -> Option<Vec<Corners>> {
    let triangles = triangles(cell)?;
    covers_the_cell(cell, &triangles).then(|| paired(cell, &triangles))
}

fn triangles(cell: &Arrangement) -> Option<Vec<[usize; 3]>> {
    let mut delaunay = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let outline = cell.sides.len();
    let mut handles = Vec::with_capacity(cell.points.len());
    for i in 0..cell.points.len() {
        let at = dented(cell, i);
        let handle = delaunay.insert(Point2::new(at.x, at.y)).ok()?;
        if handle.index() != i {
            return None;
        }
        handles.push(handle);
    }
    let edges = (0..outline).map(|i| [i, (i + 1) % outline]);
    for [a, b] in edges.chain(cell.segments.iter().copied()) {
        delaunay.try_add_constraint(handles[a], handles[b]);
    }
    let faces = delaunay.inner_faces();
    let triangles = faces.map(|face| face.vertices().map(|vertex| vertex.fix().index()));
    Some(triangles.filter(|&t| !lies_on_one_side(cell, t)).collect())
}

/// A point where it is triangulated: on an edge it is pushed inwards, most in the middle.
fn dented(cell: &Arrangement, i: usize) -> DVec2 {
    let at = cell.points[i];
    let Some(&[side, other]) = cell.sides.get(i) else {
        return at;
    };
    if side != other {
        return at;
    }
    let corner = |side: usize| {
        let sides = cell.sides.iter().position(|s| s[1] == side && s[0] != side);
        cell.points[sides.expect("an edge begins at a corner")]
    };
    let next = cell
        .sides
        .iter()
        .map(|s| s[1])
        .max()
        .map_or(0, |last| (side + 1) % (last + 1));
    let (from, to) = (corner(side), corner(next));
    let t = at.distance(from) / from.distance(to).max(1e-300);
    at + (to - from).perp() * (DENT * 4.0 * t * (1.0 - t))
}

/// Whether a triangle is what denting left between an edge and its points.
fn lies_on_one_side(cell: &Arrangement, triangle: [usize; 3]) -> bool {
    let sides = triangle.map(|i| cell.sides.get(i));
    let [Some(a), Some(b), Some(c)] = sides else {
        return false;
    };
    a.iter().any(|side| b.contains(side) && c.contains(side))
}

/// Whether the borders of some triangles are exactly the outline.
fn covers_the_cell(cell: &Arrangement, triangles: &[[usize; 3]]) -> bool {
    let outline = cell.sides.len();
    let mut edges: Vec<[usize; 2]> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .collect();
    edges.sort_unstable();
    let is_border = |&&[a, b]: &&[usize; 2]| edges.binary_search(&[b, a]).is_err();
    let borders: Vec<[usize; 2]> = edges.iter().filter(is_border).copied().collect();
    borders.len() == outline
        && borders
            .iter()
            .all(|&[a, b]| a < outline && b == (a + 1) % outline)
}

/// Triangles, in pairs where they make good quads: the best ones first.
fn paired(cell: &Arrangement, triangles: &[[usize; 3]]) -> Vec<Corners> {
    let mut edges: Vec<([usize; 2], usize)> = Vec::with_capacity(3 * triangles.len());
    for (i, &[a, b, c]) in triangles.iter().enumerate() {
        edges.extend([([a, b], i), ([b, c], i), ([c, a], i)]);
    }
    edges.sort_unstable();
    let mut quads: Vec<(f64, [usize; 4], [usize; 2])> = Vec::new();
    for &([a, b], first) in edges.iter().filter(|([a, b], _)| a < b) {
        let Ok(found) = edges.binary_search_by_key(&[b, a], |(edge, _)| *edge) else {
            continue;
        };
        let second = edges[found].1;
        let is_kept_apart = cell.segments.iter().any(|s| *s == [a, b] || *s == [b, a]);
        let opposite = |t: usize| triangles[t].into_iter().find(|&c| c != a && c != b);
        let (Some(c), Some(d)) = (opposite(first), opposite(second)) else {
            continue;
        };
        // The triangles' common edge stays the diagonal along which the quad is drawn.
        let quad = [a, d, b, c];
        let sine = least_sine(quad.map(|i| cell.points[i]));
        if !is_kept_apart && sine > LEAST_SINE {
            quads.push((sine, quad, [first, second]));
        }
    }
    quads.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
    let mut is_free = vec![true; triangles.len()];
    let mut cells = Vec::with_capacity(triangles.len());
    for (_, quad, [first, second]) in quads {
        if is_free[first] && is_free[second] {
            (is_free[first], is_free[second]) = (false, false);
            cells.push(quad.to_vec());
        }
    }
    let left = triangles
        .iter()
        .zip(is_free)
        .filter(|(_, is_free)| *is_free);
    cells.extend(left.map(|(triangle, _)| triangle.to_vec()));
    cells
}

/// The smallest sine of a quad's angles, negative if one of them is reflex.
fn least_sine(corners: [DVec2; 4]) -> f64 {
    let sine = |i: usize| {
        let before = corners[i] - corners[(i + 3) % 4];
        let after = corners[(i + 1) % 4] - corners[i];
        before.perp_dot(after) / (before.length() * after.length()).max(1e-300)
    };
    (0..4).map(sine).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [DVec2; 4] = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];

    fn area(cell: &Arrangement, corners: &[usize]) -> f64 {
        let n = corners.len();
        let at = |i: usize| cell.points[corners[i % n]];
        0.5 * (0..n).map(|i| at(i).perp_dot(at(i + 1))).sum::<f64>()
    }

    #[test]
    fn points_on_edges_belong_to_cells() {
        let shares = [vec![0.3, 0.31, 0.9], vec![], vec![0.5], vec![]];
        let cell = Arrangement::new(&SQUARE, &shares, 0.01);
        let cells = cells(&cell).expect("it can be triangulated");
        let sum: f64 = cells.iter().map(|c| area(&cell, c)).sum();
        assert!((sum - 1.0).abs() < 1e-12, "they cover the square: {sum}");
        let used: std::collections::HashSet<usize> = cells.iter().flatten().copied().collect();
        assert_eq!(used.len(), 8, "all points are corners: {cells:?}");
    }

    #[test]
    fn segments_are_edges_of_cells() {
        let mut cell = Arrangement::new(&SQUARE, &[vec![], vec![0.7], vec![], vec![0.2]], 0.01);
        let at = DVec2::new;
        cell.add(
            &SQUARE,
            &[[at(0.0, 0.8), at(1.0, 0.7)], [at(0.3, 0.3), at(0.6, 0.2)]],
        );
        let cells = cells(&cell).expect("it can be triangulated");
        for &[a, b] in &cell.segments {
            let has = |c: &Corners| (0..c.len()).any(|i| [c[i], c[(i + 1) % c.len()]] == [a, b]);
            assert_eq!(
                cells.iter().filter(|c| has(c)).count(),
                1,
                "{a} to {b}: {cells:?}"
            );
        }
    }

    #[test]
    fn a_square_cut_across_becomes_two_quads() {
        let mut cell = Arrangement::new(&SQUARE, &[vec![], vec![0.5], vec![], vec![0.5]], 0.01);
        cell.add(&SQUARE, &[[DVec2::new(0.0, 0.5), DVec2::new(1.0, 0.5)]]);
        let cells = cells(&cell).expect("it can be triangulated");
        assert_eq!(cells.len(), 2, "{cells:?}");
    }
}
