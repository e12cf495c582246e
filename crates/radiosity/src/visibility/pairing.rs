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

/// The faces as quads. Triangles find their partners greedily in the order of the faces: of the neighbours across
/// their sides the one with which they fit the smallest box, if that is not more surface than two boxes have.
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
    let neighbours = neighbours(singles);
    let mut is_taken = vec![false; singles.len()];
    for (number, single) in singles.iter().enumerate() {
        if is_taken[number] {
            continue;
        }
        is_taken[number] = true;
        let [a, b, c] = single.corners;
        let alone = Quad {
            corners: [a, b, c, c],
            faces: [single.face; 2],
        };
        let partner = (0..3)
            .filter_map(|apex| {
                let (other, other_apex) = neighbours[number][apex]?;
                let other = other as usize;
                if is_taken[other] {
                    return None;
                }
                // The side opposite the apex becomes the diagonal from corner 0 to corner 2.
                let turned = [1, 0, 2].map(|k| single.corners[(apex + k) % 3]);
                let quad = Quad {
                    corners: [
                        turned[0],
                        turned[1],
                        turned[2],
                        singles[other].corners[usize::from(other_apex)],
                    ],
                    faces: [single.face, singles[other].face],
                };
                let apart = surface(&single.corners) + surface(&singles[other].corners);
                let together = surface(&quad.corners);
                (together <= apart).then_some((together, other, quad))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, other, quad)) = partner {
            is_taken[other] = true;
            quads.push(quad);
        } else {
            quads.push(alone);
        }
    }
}

/// For each triangle and each of its corners the triangle across the opposite side and that one's opposite corner.
fn neighbours(singles: &[Single]) -> Vec<[Option<(u32, u8)>; 3]> {
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
    let mut across = vec![[None; 3]; singles.len()];
    for pair in sides.windows(2).filter(|pair| pair[0].ends == pair[1].ends) {
        for (one, other) in [(pair[0], pair[1]), (pair[1], pair[0])] {
            if one.triangle != other.triangle {
                across[one.triangle as usize][usize::from(one.apex)] =
                    Some((other.triangle, other.apex));
            }
        }
    }
    across
}

/// Half the surface of the box around some points.
fn surface(points: &[Vec3]) -> f32 {
    let low = points.iter().fold(points[0], |low, &p| low.min(p));
    let high = points.iter().fold(points[0], |high, &p| high.max(p));
    let size = high - low;
    size.x * size.y + size.y * size.z + size.z * size.x
}
