//! Neighbouring triangles become quads, see [`Quad`].

use super::quads::Quad;
use crate::patch::face::WorldFace;
use glam::Vec3;

/// A triangle on its way to a quad.
#[derive(Debug, Clone, Copy)]
struct Single {
    corners: [Vec3; 3],
    face: u32,
}

/// A side of a triangle, with its ends in an order that does not depend on the triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    ends: [[u32; 3]; 2],
    triangle: u32,
    /// Number of the corner opposite.
    apex: u8,
}

/// The faces as quads. Triangles find their partners greedily: of all neighbours those come first whose common box
/// has the least surface by that of their own two. None is paired where a common box has more.
pub(super) fn quads(faces: &[WorldFace]) -> Vec<Quad> {
    let mut quads = Vec::with_capacity(faces.len());
    let mut singles = Vec::new();
    for (face, number) in faces.iter().zip(0..) {
        let [a, b, c, d] = face.corners.map(|corner| corner + Vec3::ZERO);
        if face.corner_count == 4 {
            quads.push(Quad {
                corners: [a, b, c, d],
                faces: [number; 2],
            });
        } else {
            singles.push(Single {
                corners: [a, b, c],
                face: number,
            });
        }
    }
    pair(&singles, &mut quads);
    quads
}

fn pair(singles: &[Single], quads: &mut Vec<Quad>) {
    let surfaces: Vec<f32> = singles.iter().map(|s| surface(&s.corners)).collect();
    let mut candidates: Vec<(f32, [Side; 2])> = Vec::new();
    for_each_neighbours(singles, |sides| {
        let [one, other] = sides.map(|side| side.triangle as usize);
        let ratio = surface(&join(singles, sides).corners) / (surfaces[one] + surfaces[other]);
        if ratio <= 1.0 {
            candidates.push((ratio, sides));
        }
    });
    // Stable, so that of equal ratios the first in the order of the sides wins.
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut is_taken = vec![false; singles.len()];
    for (_, sides) in candidates {
        let [one, other] = sides.map(|side| side.triangle as usize);
        if !is_taken[one] && !is_taken[other] {
            (is_taken[one], is_taken[other]) = (true, true);
            quads.push(join(singles, sides));
        }
    }
    let alone = singles.iter().zip(is_taken).filter(|(_, taken)| !taken);
    quads.extend(alone.map(|(single, _)| {
        let [a, b, c] = single.corners;
        Quad {
            corners: [a, b, c, c],
            faces: [single.face; 2],
        }
    }));
}

/// The quad of two triangles with a common side, which becomes its diagonal.
fn join(singles: &[Single], [one, other]: [Side; 2]) -> Quad {
    let (single, partner) = (
        &singles[one.triangle as usize],
        &singles[other.triangle as usize],
    );
    let apex = usize::from(one.apex);
    let [before, at, after] = [2, 0, 1].map(|step| single.corners[(apex + step) % 3]);
    Quad {
        corners: [before, at, after, partner.corners[usize::from(other.apex)]],
        faces: [single.face, partner.face],
    }
}

/// Calls `visit` with each two sides in succession that have the same ends.
fn for_each_neighbours(singles: &[Single], mut visit: impl FnMut([Side; 2])) {
    let mut sides = Vec::with_capacity(3 * singles.len());
    for (single, triangle) in singles.iter().zip(0..) {
        for (apex, k) in [(0, 0), (1, 1), (2, 2_usize)] {
            let bits = |corner: Vec3| corner.to_array().map(f32::to_bits);
            let mut ends = [1, 2].map(|step| bits(single.corners[(k + step) % 3]));
            ends.sort_unstable();
            sides.push(Side {
                ends,
                triangle,
                apex,
            });
        }
    }
    sides.sort_unstable();
    for pair in sides.windows(2) {
        if pair[0].ends == pair[1].ends && pair[0].triangle != pair[1].triangle {
            visit([pair[0], pair[1]]);
        }
    }
}

/// Half the surface of the box around some points.
fn surface(points: &[Vec3]) -> f32 {
    let low = points.iter().fold(points[0], |low, &p| low.min(p));
    let high = points.iter().fold(points[0], |high, &p| high.max(p));
    let size = high - low;
    size.x * size.y + size.y * size.z + size.z * size.x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn face(corners: [Vec3; 3]) -> WorldFace {
        let [a, b, c] = corners;
        WorldFace {
            corners: [a, b, c, c],
            mesh_corners: [0; 4],
            corner_count: 3,
            normal: Vec3::Z,
            instance: 0,
            face: 0,
            material: 0,
        }
    }

    #[test]
    fn a_strip_becomes_quads_along_its_diagonals() {
        // Diagonals from (i, 0) to (i + 1, 1); every other pairing has larger boxes.
        let corner = |i: u8, j: u8| Vec3::new(f32::from(i), f32::from(j), 0.0);
        let cell = |i| {
            let [a, b, c, d] = [
                corner(i, 0),
                corner(i + 1, 0),
                corner(i + 1, 1),
                corner(i, 1),
            ];
            [face([a, b, c]), face([c, d, a])]
        };
        let faces: Vec<WorldFace> = (0..10).flat_map(cell).collect();
        let mut pairs: Vec<[u32; 2]> = quads(&faces)
            .iter()
            .map(|quad| {
                let [one, other] = quad.faces;
                [one.min(other), one.max(other)]
            })
            .collect();
        pairs.sort_unstable();
        let expected: Vec<[u32; 2]> = (0..10).map(|i| [2 * i, 2 * i + 1]).collect();
        assert_eq!(pairs, expected, "faces of the quads");
    }

    #[test]
    fn each_triangle_is_in_one_quad_with_its_corners() {
        let number = |i: u64| (crate::sampling::hash(5, i) % 4) as f32;
        let corner = |i: u64| Vec3::new(number(3 * i), number(3 * i + 1), number(3 * i + 2));
        let faces: Vec<WorldFace> = (0..200)
            .map(|i| face([0, 1, 2].map(|k| corner(3 * i + k))))
            .collect();
        let mut seen = vec![0; faces.len()];
        for quad in quads(&faces) {
            let [a, b, c, d] = quad.corners;
            let is_single = quad.faces[0] == quad.faces[1];
            for (number, triangle) in quad
                .faces
                .iter()
                .zip([[a, b, c], [a, c, d]])
                .take(2 - usize::from(is_single))
            {
                seen[*number as usize] += 1;
                let face = &faces[*number as usize];
                assert!(
                    triangle.iter().all(|p| face.corners.contains(p)),
                    "corners of face {number}"
                );
                assert!(
                    face.corners.iter().all(|p| triangle.contains(p)),
                    "face {number}"
                );
            }
        }
        assert!(
            seen.iter().all(|&count| count == 1),
            "how often each is there: {seen:?}"
        );
    }
}
