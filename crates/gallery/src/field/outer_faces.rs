//! What is seen of a mesh of volumes: the faces that belong to one cell only.

use super::vtk::Cells;

/// A face: three or four corners, in order around it, and the cell that it belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Face {
    corners: [u32; 4],
    is_quad: bool,
    pub cell: usize,
}

impl Face {
    fn new(corners: &[u32], cell: usize) -> Self {
        let last = corners[corners.len() - 1];
        Self {
            corners: [corners[0], corners[1], corners[2], last],
            is_quad: corners.len() == 4,
            cell,
        }
    }

    /// Three or four.
    pub fn corners(&self) -> &[u32] {
        &self.corners[..3 + usize::from(self.is_quad)]
    }

    /// The same for all faces of the same corners.
    fn key(&self) -> [u32; 4] {
        let mut key = self.corners;
        key.sort_unstable();
        key
    }
}

/// Corners of the faces of a kind of cell, by the numbers of VTK, and how many corners the cell has.
fn faces_of(kind: u8) -> Option<(usize, &'static [&'static [usize]])> {
    Some(match kind {
        5 => (3, &[&[0, 1, 2]]),
        8 => (4, &[&[0, 1, 3, 2]]),
        9 => (4, &[&[0, 1, 2, 3]]),
        10 => (4, &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]]),
        11 => (
            8,
            &[
                &[0, 2, 3, 1],
                &[4, 5, 7, 6],
                &[0, 1, 5, 4],
                &[2, 6, 7, 3],
                &[0, 4, 6, 2],
                &[1, 3, 7, 5],
            ],
        ),
        12 => (
            8,
            &[
                &[0, 3, 2, 1],
                &[4, 5, 6, 7],
                &[0, 1, 5, 4],
                &[1, 2, 6, 5],
                &[2, 3, 7, 6],
                &[3, 0, 4, 7],
            ],
        ),
        13 => (
            6,
            &[
                &[0, 1, 2],
                &[3, 5, 4],
                &[0, 3, 4, 1],
                &[1, 4, 5, 2],
                &[2, 5, 3, 0],
            ],
        ),
        14 => (
            5,
            &[
                &[0, 3, 2, 1],
                &[0, 1, 4],
                &[1, 2, 4],
                &[2, 3, 4],
                &[3, 0, 4],
            ],
        ),
        _ => return None,
    })
}

/// All outer faces, in the order of their cells. An error, in one line, for kinds of cells that are not known.
pub fn outer_faces(cells: &Cells) -> Result<Vec<Face>, String> {
    match cells {
        Cells::Unstructured(cells) => unstructured(cells),
        Cells::Structured(counts) => Ok(structured(*counts)),
    }
}

fn unstructured(cells: &[(u8, Vec<u32>)]) -> Result<Vec<Face>, String> {
    let mut faces = Vec::new();
    for (i, (kind, corners)) in cells.iter().enumerate() {
        let Some((count, sides)) = faces_of(*kind) else {
            return Err(format!(
                "cell {i} is of type {kind}; triangles, quads, tetrahedra, hexahedra, wedges, pyramids and voxels can be drawn"
            ));
        };
        if corners.len() != count {
            return Err(format!(
                "cell {i} of type {kind} has {} corners, not {count}",
                corners.len()
            ));
        }
        faces.extend(sides.iter().map(|side| {
            let corners: Vec<u32> = side.iter().map(|&c| corners[c]).collect();
            Face::new(&corners, i)
        }));
    }
    faces.sort_by_key(|face| (face.key(), face.cell));
    let mut outer: Vec<Face> = faces
        .chunk_by(|a, b| a.key() == b.key())
        .filter(|same| same.len() == 1)
        .map(|same| same[0])
        .collect();
    outer.sort_by_key(|face| face.cell);
    Ok(outer)
}

/// The six sides of a box of cells; one if it has a single layer of points.
fn structured(counts: [usize; 3]) -> Vec<Face> {
    let [nx, ny, _] = counts;
    let point =
        |[i, j, k]: [usize; 3]| u32::try_from((k * ny + j) * nx + i).expect("few million points");
    let cells = counts.map(|n| n.saturating_sub(1).max(1));
    let mut faces = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let last = counts[axis].saturating_sub(1);
        let layers = if last == 0 { vec![0] } else { vec![0, last] };
        for layer in layers {
            for i in 0..counts[u].saturating_sub(1) {
                for j in 0..counts[v].saturating_sub(1) {
                    let place = |du: usize, dv: usize| {
                        let mut place = [0; 3];
                        (place[axis], place[u], place[v]) = (layer, i + du, j + dv);
                        place
                    };
                    let corners = [place(0, 0), place(1, 0), place(1, 1), place(0, 1)].map(point);
                    let cell = place(0, 0);
                    let at = |k: usize| cell[k].min(cells[k] - 1);
                    faces.push(Face::new(
                        &corners,
                        (at(2) * cells[1] + at(1)) * cells[0] + at(0),
                    ));
                }
            }
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_shows_its_sides_however_it_is_given() {
        let faces = outer_faces(&Cells::Structured([3, 4, 5])).expect("a box");
        assert_eq!(faces.len(), 2 * (2 * 3 + 3 * 4 + 2 * 4), "structured");
        let point = |i: u32, j: u32, k: u32| (k * 4 + j) * 3 + i;
        let mut cells = Vec::new();
        for k in 0..4 {
            for j in 0..3 {
                for i in 0..2 {
                    let corner = |c: u32| point(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
                    cells.push((11, (0..8).map(corner).collect()));
                }
            }
        }
        let same = outer_faces(&Cells::Unstructured(cells)).expect("voxels");
        let keys = |faces: &[Face]| {
            let mut keys: Vec<_> = faces.iter().map(|f| (f.key(), f.cell)).collect();
            keys.sort_unstable();
            keys
        };
        assert_eq!(
            keys(&faces),
            keys(&same),
            "the same faces of the same cells"
        );
        assert_eq!(
            outer_faces(&Cells::Structured([3, 3, 1]))
                .expect("a sheet")
                .len(),
            4,
            "a sheet"
        );
        assert!(
            outer_faces(&Cells::Structured([1, 1, 7]))
                .expect("a line")
                .is_empty(),
            "a line"
        );
    }

    #[test]
    fn every_kind_is_closed() {
        for kind in [10, 11, 12, 13, 14] {
            let (count, sides) = faces_of(kind).expect("a volume");
            let mut edges = Vec::new();
            for side in sides {
                let next = |i: usize| side[(i + 1) % side.len()];
                edges.extend((0..side.len()).map(|i| [side[i], next(i)]));
                assert!(side.iter().all(|&c| c < count), "kind {kind}");
            }
            let mut back: Vec<[usize; 2]> = edges.iter().map(|&[a, b]| [b, a]).collect();
            edges.sort_unstable();
            back.sort_unstable();
            assert_eq!(edges, back, "kind {kind}: each edge has its opposite");
        }
    }

    #[test]
    fn unknown_and_broken_cells_are_refused() {
        for (cell, word) in [
            ((25, vec![0; 20]), "type 25"),
            ((12, vec![0; 7]), "7 corners, not 8"),
        ] {
            let line = outer_faces(&Cells::Unstructured(vec![cell])).expect_err(word);
            assert!(line.contains(word) && !line.contains('\n'), "{line}");
        }
    }
}
