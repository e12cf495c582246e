//! A bounding volume hierarchy with eight children a node, tested at once.
//!
//! `obvhs` builds a binary tree (PLOC with reinsertion); its nodes are merged by eights, and the quads of a leaf are
//! stored side by side. Measured against its own eight-wide tree (`CwBvh`) on 100 000 triangles, incoherent segments
//! take a little more than half the time: boxes in full precision save the unpacking, eight quads cost what one
//! triangle costs, and there are less than half as many of them.

use super::quads::{Hits, LANES, Quad, QuadPack};
use super::ray::Ray;
use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use std::time::Duration;
use wide::f32x8;

/// Entries of a traversal's stack, a power of two so that a masked index needs no check. The tree is built so that
/// 7 × 31 + 8 of them are used at most, see [`MAX_DEPTH`].
const STACK: usize = 256;

/// Levels down to which the tree follows the binary one. Below, what is left is cut into eighths by count: that is 11
/// more levels for 2^32 quads.
const MAX_DEPTH: usize = 20;

/// Boxes of up to eight children.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct Node {
    /// `[axis][low, high]`; of a child that is not there the low side lies above the high one.
    planes: [[f32x8; 2]; 3],
    children: [Child; 8],
}

/// Index of a node, or of a pack of quads with the uppermost bit set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Child(u32);

impl Child {
    const PACK: u32 = 1 << 31;
    const ROOT: Self = Self(0);

    fn pack(self) -> Option<usize> {
        (self.0 & Self::PACK != 0).then_some((self.0 & !Self::PACK) as usize)
    }
}

/// What a ray meets first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Met {
    pub(super) face: u32,
    pub(super) distance: f32,
}

/// The hierarchy over the quads of a scene.
#[derive(Debug, Clone)]
pub(super) struct WideBvh {
    nodes: Vec<Node>,
    packs: Vec<QuadPack>,
    /// Of each lane of each pack the faces of its two triangles. Not in the pack: only closest hits ask for it.
    faces: Vec<[[u32; 2]; LANES]>,
    /// Largest absolute coordinates.
    extent: Vec3,
}

impl WideBvh {
    pub(super) fn new(quads: &[Quad]) -> Self {
        let boxes: Vec<Aabb> = quads.iter().map(around).collect();
        // Leaves of up to eight for the price of ten boxes: they are tested at once. A higher price or more
        // reinsertion changed less than the noise, spatial splits made incoherent rays slower.
        let parameters = BvhBuildParams {
            max_prims_per_leaf: 8,
            collapse_traversal_cost: 10.0,
            ..BvhBuildParams::medium_build()
        };
        let mut tree = Self {
            nodes: Vec::new(),
            packs: Vec::new(),
            faces: Vec::new(),
            extent: boxes.iter().fold(Vec3::ZERO, |extent, b| {
                extent.max(b.min.abs().max(b.max.abs()).into())
            }),
        };
        if quads.is_empty() {
            tree.push_node(&[]);
            return tree;
        }
        let binary = build_bvh2(&boxes, parameters, &mut Duration::default());
        let source = Source {
            binary: &binary,
            quads,
            boxes: &boxes,
        };
        tree.add(&source, &Part::Tree(0), 0);
        tree
    }

    pub(super) fn extent(&self) -> Vec3 {
        self.extent
    }

    /// Adds the node of a part and all below it.
    fn add(&mut self, source: &Source, part: &Part, depth: usize) -> Child {
        let parts = source.cut(part, depth);
        let boxes: Vec<Aabb> = parts.iter().map(|part| source.bounds(part)).collect();
        let node = self.push_node(&boxes);
        for (number, part) in parts.iter().enumerate() {
            let child = match source.leaf(part) {
                Some(indices) => self.add_pack(source, indices),
                None => self.add(source, part, depth + 1),
            };
            self.nodes[node.0 as usize].children[number] = child;
        }
        node
    }

    /// Adds a node without its children.
    fn push_node(&mut self, boxes: &[Aabb]) -> Child {
        let mut planes = [[[f32::INFINITY; 8], [f32::NEG_INFINITY; 8]]; 3];
        for (number, bounds) in boxes.iter().enumerate() {
            for (axis, [low, high]) in planes.iter_mut().enumerate() {
                (low[number], high[number]) = (bounds.min[axis], bounds.max[axis]);
            }
        }
        self.nodes.push(Node {
            planes: planes.map(|sides| sides.map(f32x8::from)),
            children: [Child::ROOT; 8],
        });
        Child(crate::index32(self.nodes.len() - 1))
    }

    fn add_pack(&mut self, source: &Source, indices: &[u32]) -> Child {
        let quads: Vec<Quad> = indices.iter().map(|&i| source.quads[i as usize]).collect();
        let mut faces = [[0; 2]; LANES];
        for (slot, quad) in faces.iter_mut().zip(&quads) {
            *slot = quad.faces;
        }
        self.packs.push(QuadPack::new(&quads));
        self.faces.push(faces);
        Child(crate::index32(self.packs.len() - 1) | Child::PACK)
    }
}

/// What the tree is made from.
struct Source<'a> {
    binary: &'a Bvh2,
    quads: &'a [Quad],
    boxes: &'a [Aabb],
}

/// What one child of a node holds.
enum Part {
    /// All below a node of the binary tree.
    Tree(u32),
    /// Some quads.
    List(Vec<u32>),
}

impl Source<'_> {
    /// At most eight parts of a part.
    fn cut(&self, part: &Part, depth: usize) -> Vec<Part> {
        match part {
            Part::Tree(node) if depth < MAX_DEPTH => self.widen(*node),
            Part::Tree(node) => {
                let mut quads = Vec::new();
                self.collect(*node, &mut quads);
                self.cut(&Part::List(quads), depth)
            }
            Part::List(quads) if quads.len() <= LANES => vec![Part::List(quads.clone())],
            Part::List(quads) => quads
                .chunks(quads.len().div_ceil(8))
                .map(|eighth| Part::List(eighth.to_vec()))
                .collect(),
        }
    }

    /// The nodes of the binary tree that become children of one wide node: the largest is opened until there are
    /// eight. The smallest comes last, where traversals for any hit begin: what meets a small box more often meets what
    /// is in it.
    fn widen(&self, node: u32) -> Vec<Part> {
        let surface = |node: u32| self.binary.nodes[node as usize].aabb().half_area();
        let children = |node: u32| {
            let first = self.binary.nodes[node as usize].first_index;
            [first, first + 1]
        };
        let is_inner = |node: u32| !self.binary.nodes[node as usize].is_leaf();
        let mut open = vec![node];
        while open.len() < 8 {
            let inner = (0..open.len()).filter(|&i| is_inner(open[i]));
            let Some(largest) =
                inner.max_by(|&i, &j| surface(open[i]).total_cmp(&surface(open[j])))
            else {
                break;
            };
            let [left, right] = children(open[largest]);
            open[largest] = left;
            open.push(right);
        }
        open.sort_by(|&a, &b| surface(b).total_cmp(&surface(a)));
        open.into_iter().map(Part::Tree).collect()
    }

    /// The quads of a part that fit into one pack.
    fn leaf<'a>(&'a self, part: &'a Part) -> Option<&'a [u32]> {
        match part {
            Part::Tree(node) => {
                let node = &self.binary.nodes[*node as usize];
                let first = node.first_index as usize;
                let primitives = first..first + node.prim_count as usize;
                node.is_leaf()
                    .then(|| &self.binary.primitive_indices[primitives])
            }
            Part::List(quads) => (quads.len() <= LANES).then_some(quads),
        }
    }

    /// All quads below a node.
    fn collect(&self, node: u32, quads: &mut Vec<u32>) {
        let mut open = vec![node];
        while let Some(node) = open.pop() {
            if let Some(leaf) = self.leaf(&Part::Tree(node)) {
                quads.extend(leaf);
            } else {
                let first = self.binary.nodes[node as usize].first_index;
                open.extend([first, first + 1]);
            }
        }
    }

    fn bounds(&self, part: &Part) -> Aabb {
        match part {
            Part::Tree(node) => *self.binary.nodes[*node as usize].aabb(),
            Part::List(quads) => quads.iter().fold(Aabb::empty(), |bounds, &quad| {
                bounds.union(&self.boxes[quad as usize])
            }),
        }
    }
}

fn around(quad: &Quad) -> Aabb {
    Aabb::from_points(&quad.corners.map(Vec3A::from))
}

/// Nodes and packs that a ray still has to visit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stack {
    entries: [Child; STACK],
    len: usize,
}

impl Stack {
    pub(super) const EMPTY: Self = Self {
        entries: [Child::ROOT; STACK],
        len: 0,
    };

    /// Only the root is left to visit.
    pub(super) fn restart(&mut self) {
        self.entries[0] = Child::ROOT;
        self.len = 1;
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    #[inline(always)]
    fn pop(&mut self) -> Child {
        self.len -= 1;
        self.entries[self.len % STACK]
    }

    /// What comes next; `None` if nothing does.
    #[inline(always)]
    pub(super) fn next_is_pack(&self) -> Option<bool> {
        let next = self.entries[self.len.wrapping_sub(1) % STACK];
        (self.len > 0).then(|| next.pack().is_some())
    }

    /// Adds the children of the mask: all are written and only as many kept, which costs less than a loop of unknown
    /// length.
    #[inline(always)]
    fn push(&mut self, children: &[Child; 8], mask: u32) {
        for (number, &child) in children.iter().enumerate() {
            self.entries[self.len % STACK] = child;
            self.len += (mask >> number & 1) as usize;
        }
    }
}

impl Node {
    /// The children whose boxes a ray meets before a distance, and the distances from which it is in them.
    ///
    /// A box is met where the last of the lower bounds lies before the first of the upper ones (Kay and Kajiya 1986).
    #[inline(always)]
    fn meet(&self, ray: &Ray, length: f32) -> (u32, f32x8) {
        let mut enter = f32x8::ZERO;
        let mut leave = f32x8::splat(length);
        for axis in 0..3 {
            let inverse = f32x8::splat(ray.inverse[axis]);
            let down = usize::from(ray.runs_down[axis] & 1);
            let [first, second] = [self.planes[axis][down], self.planes[axis][down ^ 1]];
            enter = enter.fast_max(first.mul_add(inverse, f32x8::splat(ray.near[axis])));
            leave = leave.fast_min(second.mul_add(inverse, f32x8::splat(ray.far[axis])));
        }
        (enter.simd_le(leave).to_bitmask(), enter)
    }
}

/// Whether a hit at a distance comes before the best so far, each with its lag: that counts only between one that lags
/// and one that does not, so that what is added to both costs no digits.
fn comes_first((distance, lag): (f32, f32), (best, best_lag): (Met, f32)) -> bool {
    match (lag > 0.0, best_lag > 0.0) {
        (true, false) => distance + lag < best.distance,
        (false, true) => distance < best.distance + best_lag,
        _ => distance < best.distance,
    }
}

/// The numbers of the bits that are set, from the uppermost down.
fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        let uppermost = (mask != 0).then(|| mask.ilog2() as usize)?;
        mask ^= 1 << uppermost;
        Some(uppermost % 8)
    })
}

impl WideBvh {
    /// Whether a ray meets nothing.
    pub(super) fn is_clear(&self, ray: &Ray) -> bool {
        let mut stack = Stack::EMPTY;
        stack.restart();
        while stack.len > 0 {
            let node = &self.nodes[stack.pop().0 as usize];
            // Leaves at once: a hit ends all, and few of them are met.
            for number in bits(node.meet(ray, ray.length).0) {
                let child = node.children[number];
                if let Some(pack) = child.pack() {
                    if self.packs[pack].meet(ray, ray.length).any() {
                        return false;
                    }
                } else {
                    stack.entries[stack.len % STACK] = child;
                    stack.len += 1;
                }
            }
        }
        true
    }

    /// One step of a ray whose next entry is a node.
    #[inline(always)]
    pub(super) fn visit_node(&self, ray: &Ray, stack: &mut Stack) {
        let node = &self.nodes[stack.pop().0 as usize];
        let (mask, _) = node.meet(ray, ray.length);
        stack.push(&node.children, mask);
    }

    /// One step of a ray whose next entry is a pack: whether it meets something there.
    #[inline(always)]
    pub(super) fn visit_pack(&self, ray: &Ray, stack: &mut Stack) -> bool {
        let pack = stack.pop().pack().unwrap_or(0);
        self.packs[pack].meet(ray, ray.length).any()
    }

    /// The first surface along a ray. A face that lags by more than 0 at its hit stands back behind one that does not
    /// and is met that much later at most.
    pub(super) fn closest(&self, ray: &Ray, lag: impl Fn(u32, f32) -> f32) -> Option<Met> {
        let mut best: Option<(Met, f32)> = None;
        let mut length = ray.length;
        let mut stack = [(0.0, Child::ROOT); STACK];
        let mut len = 1;
        while len > 0 {
            len -= 1;
            let (enter, entry) = stack[len % STACK];
            if enter > length {
                continue;
            }
            if let Some(pack) = entry.pack() {
                let hits = self.packs[pack].meet(ray, length);
                if hits.any() {
                    for (which, (mask, distances)) in hits.by_triangle().iter().enumerate() {
                        for lane in bits(*mask) {
                            let (face, distance) = (self.faces[pack][lane][which], distances[lane]);
                            let lag = lag(face, distance);
                            if best.is_none_or(|best| comes_first((distance, lag), best)) {
                                best = Some((Met { face, distance }, lag));
                                length = distance + lag;
                            }
                        }
                    }
                }
                continue;
            }
            let node = &self.nodes[entry.0 as usize];
            let (mask, enter) = node.meet(ray, length);
            let (enter, bottom) = (enter.to_array(), len);
            // Sorted as they are pushed, the nearest last.
            for number in bits(mask) {
                let mut place = len;
                while place > bottom && stack[(place - 1) % STACK].0 < enter[number] {
                    stack[place % STACK] = stack[(place - 1) % STACK];
                    place -= 1;
                }
                stack[place % STACK] = (enter[number], node.children[number]);
                len += 1;
            }
        }
        best.map(|(met, _)| met)
    }

    /// Calls `stops` with what a ray meets, in no order, until that returns true. Whether it never did.
    pub(super) fn passes(&self, ray: &Ray, mut stops: impl FnMut(Met) -> bool) -> bool {
        let mut stack = Stack::EMPTY;
        stack.restart();
        while let Some(is_pack) = stack.next_is_pack() {
            if is_pack {
                let pack = stack.pop().pack().unwrap_or(0);
                let hits = self.packs[pack].meet(ray, ray.length);
                if hits.any() && self.each_met(pack, &hits).any(&mut stops) {
                    return false;
                }
            } else {
                self.visit_node(ray, &mut stack);
            }
        }
        true
    }

    /// What is met in a pack. Where the two triangles belong to one face, a ray along their common side counts once.
    fn each_met(&self, pack: usize, hits: &Hits) -> impl Iterator<Item = Met> {
        let faces = &self.faces[pack];
        let [first, mut second] = hits.by_triangle();
        for lane in bits(first.0 & second.0) {
            let is_one_face = faces[lane][0] == faces[lane][1];
            second.0 &= !(u32::from(is_one_face) << lane);
        }
        [first, second]
            .into_iter()
            .enumerate()
            .flat_map(move |(which, (mask, distances))| {
                bits(mask).map(move |lane| Met {
                    face: faces[lane][which],
                    distance: distances[lane],
                })
            })
    }
}
