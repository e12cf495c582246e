//! Whether a mesh of elements has cracks: vertices that hang on edges, elements that overlap or leave gaps.

use glam::Vec3;
use hemicube::radiosity::PatchMesh;
use std::collections::HashMap;

/// A vertex that lies on an edge of an element without being one of its corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HangingVertex {
    /// Index into the mesh's vertices.
    pub vertex: u32,
    /// Position among the elements.
    pub element: usize,
    /// The edge, by its vertices.
    pub edge: (u32, u32),
}

/// Vertices of elements that lie within an edge of another one: farther from its ends than `slack` of its length, and
/// nearer to it than that. Of each element at most one is told.
///
/// Places are sorted into a grid of cubes as large as an average element, so that it takes about as long as the mesh is
/// large.
pub fn hanging_vertices(mesh: &PatchMesh, slack: f32) -> Vec<HangingVertex> {
    let grid = Grid::new(mesh);
    let mut found = Vec::new();
    for (element, &id) in mesh.elements().iter().enumerate() {
        let corners = mesh.corners(id);
        let edges = (0..corners.len()).map(|i| (corners[i], corners[(i + 1) % corners.len()]));
        let hanging = edges.filter_map(|edge| {
            let vertex = grid.on_edge(edge, corners, slack)?;
            Some(HangingVertex {
                vertex,
                element,
                edge,
            })
        });
        found.extend(hanging.take(1));
    }
    found
}

/// Largest relative difference between the area of a patch and the sum over its elements.
pub fn area_error(mesh: &PatchMesh) -> f64 {
    let error = |patch: usize| {
        let elements = mesh.elements_of_patch(patch);
        let sum: f64 = elements
            .map(|e| f64::from(mesh.node(mesh.elements()[e]).area))
            .sum();
        let whole = f64::from(mesh.node(mesh.patches()[patch]).area);
        (sum - whole).abs() / whole
    };
    (0..mesh.patches().len()).map(error).fold(0.0, f64::max)
}

/// Vertices of elements by their place.
struct Grid<'a> {
    mesh: &'a PatchMesh,
    width: f32,
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl<'a> Grid<'a> {
    fn new(mesh: &'a PatchMesh) -> Self {
        let mut used: Vec<u32> = mesh
            .elements()
            .iter()
            .flat_map(|&id| mesh.corners(id).to_vec())
            .collect();
        used.sort_unstable();
        used.dedup();
        let count = mesh.elements().len().max(1) as f32;
        let area: f32 = mesh.elements().iter().map(|&id| mesh.node(id).area).sum();
        let mut grid = Self {
            mesh,
            width: (area / count).sqrt().max(f32::MIN_POSITIVE),
            cells: HashMap::new(),
        };
        for vertex in used {
            let cell = grid.cell(mesh.vertices()[vertex as usize]);
            grid.cells.entry(cell).or_default().push(vertex);
        }
        grid
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "a cast of floats stops at the ends of the range"
    )]
    fn cell(&self, place: Vec3) -> [i64; 3] {
        (place / self.width).floor().to_array().map(|x| x as i64)
    }

    /// A vertex on an edge of a polygon that is none of its corners.
    fn on_edge(&self, edge: (u32, u32), corners: &[u32], slack: f32) -> Option<u32> {
        let at = |v: u32| self.mesh.vertices()[v as usize];
        let (a, b) = (at(edge.0), at(edge.1));
        let length = a.distance(b);
        let [low, high] = [
            self.cell(a.min(b) - slack * length),
            self.cell(a.max(b) + slack * length),
        ];
        let is_on = |&vertex: &u32| {
            let share = (at(vertex) - a).dot(b - a) / (length * length);
            let beside = at(vertex).distance(a + (b - a) * share);
            !corners.contains(&vertex)
                && share > slack
                && share < 1.0 - slack
                && beside < slack * length
        };
        let cells = (low[0]..=high[0]).flat_map(|x| {
            (low[1]..=high[1]).flat_map(move |y| (low[2]..=high[2]).map(move |z| [x, y, z]))
        });
        let mut vertices = cells.filter_map(|cell| self.cells.get(&cell)).flatten();
        vertices.find(|&vertex| is_on(vertex)).copied()
    }
}
