//! Light at vertices by that of the elements around them; twin of `vertex_light.wgsl`.
//!
//! The elements around a vertex are a *fan*. It is cut where light may break: at creases, where neighbours' normals differ
//! by more than 40°, at the mesh's [hard edges](PatchMesh::hard_edges), and along edges on which another surface stands
//! (a wall on a floor). Each part of a fan has a value of its own at the vertex, the mean over its elements weighted by
//! their exposed areas: what is buried has no say. Irradiance is averaged, not radiosity, so textures and neighbouring
//! materials keep their borders.
//!
//! Weights are corrected so that light which is linear over a part comes out exactly, also where elements of different
//! sizes meet: `w = a (1 + λ·d)` with area `a`, offset `d` of the element's centre from the vertex, and `λ` such that
//! `Σ w d = 0`; elements whose weight were negative are left out, so values stay within those around.
//!
//! That needs a vertex amid the centres. On a border (of a face, of a crease, of a shadow's line) all of them lie on one
//! side, and their mean is the light half an element away. There the elements next to the part, as far as light is smooth,
//! are taken as well, and a plane is fitted to all by least squares and read at the vertex: the linear extrapolation of
//! Cohen and Greenberg (1985), on any mesh. Extrapolated light is limited to what lies no farther beyond that of the elements
//! than they differ among themselves, and is not negative. Independent noise of elements grows to at most 1.6 times in the
//! corner of a grid, and shrinks on its sides.

mod fan;
mod weights;

use self::fan::Around;
use crate::patch::PatchMesh;
use core::ops::Range;
use hemicube_raster::Rgb;
use rayon::prelude::*;

/// Vertices, or parts, that are looked at one after the other.
const PIECE: u32 = 4096;

/// The parts of all fans.
#[derive(Debug, Clone, Default)]
pub(crate) struct Fans {
    lists: Lists,
    /// The part at each corner of each element, corners of an element one after the other.
    parts: Vec<u32>,
    /// First corner of each element.
    corners: Vec<u32>,
}

/// Elements of parts, end to end.
#[derive(Debug, Clone, Default)]
struct Lists {
    /// Vertex of each part.
    vertices: Vec<u32>,
    /// Where the list of each part ends in [`Self::elements`].
    ends: Vec<u32>,
    elements: Vec<u32>,
    /// Of each part they sum to 1, or are all 0 where all of it is buried; empty until they are made.
    weights: Vec<f32>,
}

impl Lists {
    /// The parts of the fans of some vertices, without weights.
    fn of_vertices(mesh: &PatchMesh, vertices: Range<u32>, around: &Around) -> Self {
        let mut lists = Self::default();
        for vertex in vertices {
            for elements in fan::parts(mesh, vertex, around.of(vertex)) {
                lists.push(vertex, &elements, &[]);
            }
        }
        lists
    }

    fn push(&mut self, vertex: u32, elements: &[u32], weights: &[f32]) {
        self.vertices.push(vertex);
        self.elements.extend(elements);
        self.weights.extend(weights);
        self.ends.push(crate::index32(self.elements.len()));
    }

    /// Lists that were made piece by piece, end to end.
    fn joined(pieces: &[Self]) -> Self {
        let mut joined = Self::default();
        for piece in pieces {
            let first = crate::index32(joined.elements.len());
            joined.vertices.extend(&piece.vertices);
            joined.ends.extend(piece.ends.iter().map(|end| end + first));
            joined.elements.extend(&piece.elements);
            joined.weights.extend(&piece.weights);
        }
        joined
    }

    fn range(&self, part: usize) -> Range<usize> {
        let start = part.checked_sub(1).map_or(0, |before| self.ends[before]);
        start as usize..self.ends[part] as usize
    }

    fn elements_of(&self, part: usize) -> &[u32] {
        &self.elements[self.range(part)]
    }
}

/// What `make` makes of pieces of a range, in order.
fn in_pieces<T: Send>(count: usize, make: impl Fn(Range<u32>) -> T + Sync) -> Vec<T> {
    let count = crate::index32(count);
    let pieces = (0..count.div_ceil(PIECE)).into_par_iter();
    pieces
        .map(|i| make(i * PIECE..((i + 1) * PIECE).min(count)))
        .collect()
}

impl Fans {
    /// Around all vertices of elements.
    pub(crate) fn new(mesh: &PatchMesh) -> Self {
        let around = Around::new(mesh);
        let vertices = mesh.vertices().len();
        let pieces = in_pieces(vertices, |range| Lists::of_vertices(mesh, range, &around));
        let mut fans = Self::of_parts(mesh, Lists::joined(&pieces));
        let parts = fans.lists.vertices.len();
        let pieces = in_pieces(parts, |range| fans.weighed(mesh, range));
        fans.lists = Lists::joined(&pieces);
        fans
    }

    /// Finds the part at each corner.
    fn of_parts(mesh: &PatchMesh, lists: Lists) -> Self {
        let mut corners = vec![0];
        for &id in mesh.elements() {
            let last = corners[corners.len() - 1];
            corners.push(last + crate::index32(mesh.corners(id).len()));
        }
        let mut parts = vec![0; corners[corners.len() - 1] as usize];
        for (part, &vertex) in lists.vertices.iter().enumerate() {
            for &e in lists.elements_of(part) {
                let first = corners[e as usize] as usize;
                let own = mesh.corners(mesh.elements()[e as usize]);
                for i in (0..own.len()).filter(|&i| own[i] == vertex) {
                    parts[first + i] = crate::index32(part);
                }
            }
        }
        Self {
            lists,
            parts,
            corners,
        }
    }

    /// Some parts with weights: of their own elements where the vertex is amid them, else of those next to them as well.
    fn weighed(&self, mesh: &PatchMesh, parts: Range<u32>) -> Lists {
        let mut lists = Lists::default();
        for part in parts {
            let vertex = self.lists.vertices[part as usize];
            let own = self.lists.elements_of(part as usize);
            match weights::amid(mesh, vertex, own) {
                Some(weights) => lists.push(vertex, own, &weights),
                None => {
                    let wide = self.widened(own);
                    lists.push(vertex, &wide, &weights::beside(mesh, vertex, &wide));
                }
            }
        }
        lists
    }

    /// The elements of the parts that a part's elements belong to at any of their corners.
    fn widened(&self, elements: &[u32]) -> Vec<u32> {
        let parts = elements.iter().flat_map(|&e| self.of_element(e as usize));
        let mut wide: Vec<u32> = parts
            .flat_map(|&part| self.lists.elements_of(part as usize))
            .copied()
            .collect();
        wide.sort_unstable();
        wide.dedup();
        wide
    }

    /// The parts at an element's corners.
    pub(crate) fn of_element(&self, element: usize) -> &[u32] {
        &self.parts[self.corners[element] as usize..self.corners[element + 1] as usize]
    }

    /// Elements of a part and their weights.
    pub(crate) fn of_part(&self, part: u32) -> (&[u32], &[f32]) {
        let range = self.lists.range(part as usize);
        (
            &self.lists.elements[range.clone()],
            &self.lists.weights[range],
        )
    }

    /// The value of each part, of one value for each element.
    pub(crate) fn means(&self, values: &[Rgb]) -> Vec<Rgb> {
        let parts = (0..crate::index32(self.lists.ends.len())).into_par_iter();
        parts
            .map(|part| light_at(self.of_part(part), values))
            .collect()
    }
}

/// The value at a vertex: those of some elements by their weights. Where it is extrapolated, it is limited.
fn light_at((elements, weights): (&[u32], &[f32]), values: &[Rgb]) -> Rgb {
    let weighed = || {
        let pairs = elements.iter().zip(weights);
        pairs.map(|(&e, &weight)| (values[e as usize], weight))
    };
    let sum: Rgb = weighed().map(|(value, weight)| value * weight).sum();
    if weights.iter().all(|&weight| weight >= 0.0) {
        return sum;
    }
    let limited = |band: usize| {
        // Buried elements have no light and no weight.
        let values = weighed().filter(|&(_, weight)| weight != 0.0);
        let (least, most) = values.fold((f32::INFINITY, 0.0), |(least, most), (value, _)| {
            (f32::min(least, value[band]), f32::max(most, value[band]))
        });
        let beyond = most - least;
        sum[band].max((least - beyond).max(0.0)).min(most + beyond)
    };
    Rgb::new(limited(0), limited(1), limited(2))
}

/// Where each vertex of a drawn mesh takes its light from.
///
/// It stays the same as long as the patch mesh does, so new light comes to the vertices without a new drawn mesh.
#[derive(Debug, Clone, Default)]
pub struct LightSources {
    starts: Vec<u32>,
    elements: Vec<u32>,
    weights: Vec<f32>,
}

impl LightSources {
    /// Of the parts of fans at some vertices.
    pub(crate) fn new(fans: &Fans, parts: &[u32]) -> Self {
        let mut sources = Self {
            starts: vec![0],
            ..Self::default()
        };
        for &part in parts {
            let (elements, weights) = fans.of_part(part);
            sources.elements.extend(elements);
            sources.weights.extend(weights);
            sources.starts.push(crate::index32(sources.elements.len()));
        }
        sources
    }

    /// Where the list of each vertex begins in [`Self::elements`], and where the last one ends.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// Lists of elements, end to end.
    pub fn elements(&self) -> &[u32] {
        &self.elements
    }

    /// Weights of those elements. They sum to 1 for each vertex, or are 0 where all around it is buried; some are negative
    /// where light is extrapolated to a border.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// The value at each vertex of one value for each element, limited where it is extrapolated.
    ///
    /// # Panics
    /// There are fewer values than elements.
    pub fn means(&self, values: &[Rgb]) -> Vec<Rgb> {
        let mean = |range: &[u32]| {
            let range = range[0] as usize..range[1] as usize;
            light_at(
                (&self.elements[range.clone()], &self.weights[range]),
                values,
            )
        };
        self.starts.par_windows(2).map(mean).collect()
    }
}
