//! Form factors by hemicubes (Cohen, Greenberg 1985, *The hemi-cube: a radiosity solution for complex environments*).
//!
//! Half a cube stands on a point of the patch. The scene is projected onto its five faces with a z-buffer that keeps
//! the number of the nearest element in each cell (an item buffer), and every cell hands its *delta form factor*, the
//! share of the point's light that passes through it, to the element it sees:
//!
//! ```text
//! for each point of the patch, for each face of its hemicube
//!     draw all elements above the patch's plane; nearest element of each cell wins
//!     for each cell: fraction[element of the cell] += weight of the point × delta form factor of the cell
//! ```
//!
//! 1. Delta form factors are integrated over each cell in closed form, so that all of them sum to 1 and a row closes
//!    without correction.
//! 2. One hemicube takes the patch for a point. Two unit squares at distance 1 then get 0.239 for 0.200 at any
//!    resolution, the *proximity error*. It falls with the square of size over distance, so near patches get 2 × 2 or
//!    4 × 4 hemicubes at the points of Gauss quadrature; see [`HemicubeOptions::max_points`].
//! 3. Each hemicube is turned around the normal by another angle. In rooms, edges of walls would otherwise run along
//!    rows of cells, which are all right or all wrong at once.
//! 4. A receiver whose unoccluded projection covers fewer than ten cells would be seen by chance. Where it is also far
//!    from the patch, measured by the size of both, it gets its integrated factor, times the share of rays that reach
//!    it. The row is then divided by its new sum, which differs from 1 by the chance that was taken out.
//! 5. Panes and alpha masks let the mean transmittance of the element through: the layers behind are drawn again, without
//!    what lies in front (depth peeling; Everitt 2001), up to eight deep. What passes the eighth counts as absorbed.
//!
//! [`Projection`] has two others to compare with: three triangles or one square in place of the five faces.
//!
//! # Limits
//! Rows of clusters panic. Where elements of different size meet, a cell may look through the seam. A patch wider than 16 hemicubes do justice to keeps an error towards what touches it
//! inside its outline, such as furniture on a floor; smaller patches end it.

use crate::error::RadiosityError;
use crate::form_factor::analytic::unoccluded::Rules;
use crate::form_factor::arrivals::{Arrivals, add};
pub use crate::form_factor::delta_factors::{CubeFace, DeltaFactors, Projection};
use crate::form_factor::polygon::FlatPolygon;
use crate::form_factor::viewpoints::{Viewpoint, Viewpoints};
use crate::form_factor::{FormFactors, Row};
use crate::patch::face::Side;
use crate::patch::{NodeId, NodeKind, PatchMesh};
use crate::sampling::{hash, point2};
use core::f64::consts::PI;
use glam::{Vec3, Vec4};
use hemicube_raster::Rgb;
use hemicube_raster::triangle::{ClipVertex, Cull, DepthBuffer, Viewport, draw_ids, draw_triangle};
use rayon::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};

/// Cells below which a receiver's factor is integrated instead of counted.
const FEW_CELLS: f64 = 10.0;
/// Rays that tell which share of such a receiver is seen.
const FEW_CELLS_RAYS: u32 = 8;
/// Layers of panes that are looked through.
const MAX_LAYERS: usize = 8;
/// Hemicubes that are transformed before they are drawn: bounds the memory of large scenes.
const VIEWS_AT_ONCE: usize = 4;
/// Share of their distance by which backs are drawn farther away than they are: where two one-sided faces make a plate,
/// the front is seen.
const LAG: f32 = 5e-4;
/// A cell that sees nothing.
const EMPTY: u32 = u32::MAX;

/// How fine hemicubes are, and how many a patch may get.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HemicubeOptions {
    /// Cells along an edge of the top face, even, from 16 to 4096; sides are half as high. Default value: 256.
    pub resolution: u32,
    /// Most hemicubes of one patch: 1, 4 or 16. A patch gets 1 if the nearest surface is three times its longest edge
    /// away from its centre (the factor to a square that faces it is then 2 % too large), 4 if it is 1.25 edges away
    /// (0.3 %), else 16. Of a patch that is partly buried, four times as many stand on its exposed part.
    /// Default value: 16.
    pub max_points: u32,
    /// What stands on the points. Default value: a hemicube.
    pub projection: Projection,
}

impl Default for HemicubeOptions {
    fn default() -> Self {
        Self {
            resolution: 256,
            max_points: 16,
            projection: Projection::Hemicube,
        }
    }
}

impl HemicubeOptions {
    /// Another number of cells along an edge.
    pub fn with_resolution(self, resolution: u32) -> Self {
        Self { resolution, ..self }
    }

    /// Another bound on the hemicubes of a patch.
    pub fn with_max_points(self, max_points: u32) -> Self {
        Self { max_points, ..self }
    }

    /// Another projection.
    pub fn with_projection(self, projection: Projection) -> Self {
        Self { projection, ..self }
    }
}

/// What the five faces of one hemicube see, to be shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ItemBuffers {
    /// Cells along an edge of the top.
    pub resolution: usize,
    /// Elements seen, row by row from above, in the order of [`Projection::faces`]; panes count as opaque.
    pub faces: Vec<Vec<u32>>,
}

impl ItemBuffers {
    /// Item of a cell that sees no surface.
    pub const NOTHING: u32 = EMPTY;
    /// Item of a cell that sees a side that does not receive.
    pub const ABSORBED: u32 = EMPTY - 1;
}

/// Form factors by hemicubes on the CPU.
#[derive(Debug)]
pub struct Hemicube {
    mesh: Arc<PatchMesh>,
    options: HemicubeOptions,
    deltas: DeltaFactors,
    bands: usize,
    viewpoints: Viewpoints,
    /// Whether light passes through an element.
    layered: bool,
    /// Buffers that are not in use.
    spare: Mutex<Vec<Buffers>>,
}

impl Hemicube {
    /// Factors between the nodes of a mesh.
    ///
    /// # Errors
    /// Options out of their range.
    pub fn new(mesh: Arc<PatchMesh>, options: HemicubeOptions) -> Result<Self, RadiosityError> {
        Ok(Self {
            deltas: DeltaFactors::of(options.projection, options.resolution)?,
            bands: if mesh.visibility().is_tinted() { 3 } else { 1 },
            viewpoints: Viewpoints::new(mesh.clone(), options.max_points, "hemicubes")?,
            layered: mesh.transmittance().iter().any(|t| !t.is_black()),
            spare: Mutex::new(Vec::new()),
            options,
            mesh,
        })
    }

    /// The options it was made with.
    pub fn options(&self) -> HemicubeOptions {
        self.options
    }

    /// The delta form factors of its cells.
    pub fn delta_factors(&self) -> &DeltaFactors {
        &self.deltas
    }

    /// Number of hemicubes over which the row of a node is averaged.
    pub fn points(&self, source: NodeId) -> usize {
        self.viewpoints.of(source).len()
    }

    /// The item buffers of a node's first hemicube.
    pub fn item_buffers(&self, source: NodeId) -> ItemBuffers {
        let seen = self.transform(&self.viewpoints.of(source)[0]);
        let public = |item: &u32| match Item::unpack(*item) {
            None => ItemBuffers::NOTHING,
            Some(Item { is_back: true, .. }) => ItemBuffers::ABSORBED,
            Some(Item { element, .. }) => crate::index32(element),
        };
        ItemBuffers {
            resolution: self.options.resolution as usize,
            faces: self
                .faces()
                .iter()
                .map(|&face| {
                    let mut buffers = self.buffers();
                    self.draw(&seen, face, &mut buffers);
                    let items = buffers.items.iter().map(public).collect();
                    self.give_back(buffers);
                    items
                })
                .collect(),
        }
    }

    fn faces(&self) -> &'static [CubeFace] {
        self.options.projection.faces()
    }

    /// Everything above a hemicube's plane in its own frame.
    fn transform(&self, view: &Viewpoint) -> Seen<'_> {
        let mesh = &*self.mesh;
        let [t, b, n] = view.axes;
        let vertices: Vec<Vec3> = mesh
            .vertices()
            .iter()
            .map(|&v| {
                let d = v - view.origin;
                Vec3::new(d.dot(t), d.dot(b), d.dot(n))
            })
            .collect();
        // Of equal depths the first drawn stays: fronts come before backs.
        let (mut items, mut backs) = (Vec::new(), Vec::new());
        let mut nearest = mesh.visibility().diameter();
        for (element, &id) in mesh.elements().iter().enumerate() {
            let is_above = |&c: &u32| vertices[c as usize].z > 0.0;
            if !mesh.corners(id).iter().any(is_above) {
                continue;
            }
            let node = mesh.node(id);
            let NodeKind::Surface { face, side } = node.kind else {
                unreachable!("elements are surfaces")
            };
            let from_behind = (view.origin - node.centroid).dot(node.normal) <= 0.0;
            // The other side of a double-sided face is an element of its own.
            let both_receive = mesh.visibility().receives(face as usize, Side::Back);
            debug_assert!(
                both_receive || side == Side::Front,
                "backs of one-sided faces are no elements"
            );
            if from_behind && both_receive {
                continue;
            }
            nearest = self.viewpoints.nearer(view.origin, element, nearest);
            let item = Item {
                element,
                is_back: from_behind || mesh.exposed_area(element) == 0.0,
            };
            let list = if item.is_back { &mut backs } else { &mut items };
            list.push((mesh.corners(id), item.pack()));
        }
        for (_, cell) in mesh.obstructions() {
            if cell.corners().iter().any(|&c| vertices[c as usize].z > 0.0) {
                backs.push((cell.corners(), self.obstruction()));
            }
        }
        items.append(&mut backs);
        let nearest = self
            .viewpoints
            .nearer_obstruction(view.origin, None, nearest);
        // The depth buffer is the finer the farther its near plane.
        let near = (self.options.projection.least_depth() * nearest)
            .max(mesh.visibility().offset(view.origin));
        Seen {
            vertices,
            items,
            near,
        }
    }

    /// The item of all obstructions: the back of an element that there is not.
    fn obstruction(&self) -> u32 {
        let item = Item {
            element: self.mesh.elements().len(),
            is_back: true,
        };
        item.pack()
    }

    /// Calls `draw` with each triangle that may be in the picture of a face.
    fn for_each_triangle(
        &self,
        seen: &Seen<'_>,
        face: CubeFace,
        mut draw: impl FnMut(&[Vec4; 3], u32),
    ) {
        for &(indices, item) in &seen.items {
            let mut corners = [Vec4::ZERO; 4];
            let is_back = Item::unpack(item).is_some_and(|item| item.is_back);
            let lag = if is_back { LAG * seen.near } else { 0.0 };
            for (corner, &i) in corners.iter_mut().zip(indices) {
                *corner = face.clip(seen.vertices[i as usize], seen.near);
                corner.z += lag;
            }
            let corners = &corners[..indices.len()];
            let is_outside = corners.iter().all(|c| c.z < 0.0)
                || corners.iter().all(|c| c.x > c.w)
                || corners.iter().all(|c| c.x < -c.w)
                || corners.iter().all(|c| c.y > c.w)
                || corners.iter().all(|c| c.y < -c.w);
            if is_outside {
                continue;
            }
            draw(&[corners[0], corners[1], corners[2]], item);
            if let Some(&last) = corners.get(3) {
                draw(&[corners[0], corners[2], last], item);
            }
        }
    }

    /// The item buffer of one face.
    fn draw(&self, seen: &Seen<'_>, face: CubeFace, buffers: &mut Buffers) {
        let viewport = face.viewport(self.options.resolution as usize);
        buffers.clear(viewport);
        let (depth, items) = (&mut buffers.depth, &mut buffers.items);
        self.for_each_triangle(seen, face, |triangle, item| {
            let rows = 0..viewport.height;
            draw_ids(rows, viewport, Cull::None, triangle, item, depth, items);
        });
    }

    /// The item buffer of what lies behind `buffers.before`.
    fn draw_behind(&self, seen: &Seen<'_>, face: CubeFace, buffers: &mut Buffers) {
        let viewport = face.viewport(self.options.resolution as usize);
        buffers.clear(viewport);
        let Buffers {
            depth,
            items,
            before,
            ..
        } = buffers;
        self.for_each_triangle(seen, face, |triangle, item| {
            let vertices = triangle.map(|position| ClipVertex::new(position, []));
            let rows = 0..viewport.height;
            draw_triangle(
                rows,
                viewport,
                Cull::None,
                &vertices,
                depth,
                |x, y, z, _| {
                    let cell = y * viewport.width + x;
                    let is_behind = z > before[cell];
                    if is_behind {
                        items[cell] = item;
                    }
                    is_behind
                },
            );
        });
    }

    /// What one face of one hemicube sees.
    fn face_tally(&self, seen: &Seen<'_>, face: CubeFace) -> Tally {
        let mut buffers = self.buffers();
        self.draw(seen, face, &mut buffers);
        let tally = if self.layered {
            self.peel(seen, face, &mut buffers)
        } else {
            self.sum(face, &mut buffers)
        };
        self.give_back(buffers);
        tally
    }

    /// Sums the delta factors of an item buffer without transparency.
    fn sum(&self, face: CubeFace, buffers: &mut Buffers) -> Tally {
        let mut tally = Tally::default();
        let width = self.options.resolution as usize;
        let (arrived, touched) = (&mut buffers.arrived, &mut buffers.touched);
        let mut add = |item: u32, share: f64| match Item::unpack(item) {
            None => tally.escaped[0] += share,
            Some(Item { is_back: true, .. }) => tally.absorbed[0] += share,
            Some(Item { element, .. }) => {
                if arrived[element][0] == 0.0 {
                    touched.push(element);
                }
                arrived[element][0] += share;
            }
        };
        for (row, items) in buffers.items.chunks(width).enumerate() {
            if matches!(face, CubeFace::Corner(_)) {
                add_runs(items, self.deltas.corner_row(row).iter(), &mut add);
            } else {
                let half_row = self.deltas.half_row(face, row);
                add_runs(items, half_row.iter().rev().chain(half_row), &mut add);
            }
        }
        tally.escaped = [tally.escaped[0]; 3];
        tally.absorbed = [tally.absorbed[0]; 3];
        tally.collect(buffers);
        for (_, share) in &mut tally.received {
            *share = [share[0]; 3];
        }
        tally
    }

    /// Sums the delta factors of an item buffer and of those behind it, as far as elements let light through.
    fn peel(&self, seen: &Seen<'_>, face: CubeFace, buffers: &mut Buffers) -> Tally {
        let mut tally = Tally::default();
        let width = self.options.resolution as usize;
        let cells = buffers.items.len();
        buffers.before.clear();
        buffers.before.resize(cells, 0.0);
        let mut through = vec![Rgb::WHITE; cells];
        for layer in 0..MAX_LAYERS {
            if layer > 0 {
                self.draw_behind(seen, face, buffers);
            }
            let mut goes_on = false;
            for (cell, through) in through.iter_mut().enumerate() {
                if through.is_black() {
                    continue;
                }
                let delta = self.deltas.at(face, cell % width, cell / width);
                let arriving = [0, 1, 2].map(|band| delta * f64::from(through[band]));
                let Some(Item { element, is_back }) = Item::unpack(buffers.items[cell]) else {
                    add(&mut tally.escaped, arriving);
                    *through = Rgb::BLACK;
                    buffers.before[cell] = f32::INFINITY;
                    continue;
                };
                let passing = self.mesh.transmittance().get(element);
                let passing = passing.copied().unwrap_or(Rgb::BLACK);
                let rest = Rgb::from([0, 1, 2].map(|band| through[band] * passing[band]));
                if is_back {
                    let kept = [0, 1, 2].map(|b| delta * f64::from(through[b] - rest[b]));
                    add(&mut tally.absorbed, kept);
                } else {
                    if buffers.arrived[element] == [0.0; 3] {
                        buffers.touched.push(element);
                    }
                    add(&mut buffers.arrived[element], arriving);
                }
                *through = rest;
                let is_over = through.is_black();
                buffers.before[cell] = if is_over {
                    f32::INFINITY
                } else {
                    buffers.depth[cell]
                };
                goes_on |= !is_over;
            }
            if !goes_on {
                break;
            }
        }
        for (cell, through) in through.iter().enumerate().filter(|(_, t)| !t.is_black()) {
            let delta = self.deltas.at(face, cell % width, cell / width);
            add(
                &mut tally.absorbed,
                [0, 1, 2].map(|b| delta * f64::from(through[b])),
            );
        }
        tally.collect(buffers);
        tally
    }

    /// Factors of the receivers that are too small and far to be counted in cells, in each band.
    fn small_receivers(&self, source: NodeId, views: &[Viewpoint]) -> Vec<(usize, Rgb)> {
        let mesh = &*self.mesh;
        let node = mesh.node(source);
        let polygon = mesh.polygon(source);
        let radius = polygon
            .iter()
            .map(|c| c.distance(node.centroid))
            .fold(0.0, f32::max);
        let smallest = FEW_CELLS / self.options.projection.cells(self.options.resolution);
        let flat = FlatPolygon::new(&polygon, node.normal);
        let rules = Rules::default();
        let visibility = mesh.visibility();
        let factor = |(e, &id): (usize, &NodeId)| {
            let to = mesh.node(id);
            let offset = to.centroid - node.centroid;
            let distance2 = offset.length_squared();
            let reach = 2.0 * (radius + self.viewpoints.radius(e));
            let cosines = offset.dot(node.normal) * -offset.dot(to.normal) / distance2;
            if distance2 < reach * reach || cosines < 1e-6 || mesh.exposed_area(e) == 0.0 {
                return None;
            }
            let estimate = f64::from(cosines * to.area) / (PI * f64::from(distance2));
            if estimate >= smallest {
                return None;
            }
            let unoccluded = rules
                .exchange_of_polygons(&flat, &FlatPolygon::new(&mesh.polygon(id), to.normal))
                / flat.area().max(1e-30);
            let exposed = mesh.exposed(e);
            let seed = hash(u64::from(source.0), u64::from(id.0));
            let rays = FEW_CELLS_RAYS;
            let seen: Rgb = (0..rays)
                .map(|i| {
                    let from = views[i as usize * views.len() / rays as usize].origin;
                    let point = visibility.off_surface(exposed.point(point2(i, seed)), to.normal);
                    visibility.transmittance(from, point)
                })
                .fold(Rgb::BLACK, |sum, seen| sum + seen);
            let scale = unoccluded * f64::from(exposed.area() / to.area) / f64::from(rays);
            Some((e, seen * to_f32(scale)))
        };
        mesh.elements()
            .par_iter()
            .enumerate()
            .with_min_len(256)
            .filter_map(factor)
            .collect()
    }

    fn buffers(&self) -> Buffers {
        let mut spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
        let mut buffers = spare.pop().unwrap_or_default();
        buffers.arrived.resize(self.mesh.elements().len(), [0.0; 3]);
        buffers
    }

    fn give_back(&self, buffers: Buffers) {
        let mut spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
        spare.push(buffers);
    }
}

impl FormFactors for Hemicube {
    fn mesh(&self) -> &Arc<PatchMesh> {
        &self.mesh
    }

    fn fill_row(&self, source: NodeId, row: &mut Row) {
        let (views, faces) = (self.viewpoints.of(source), self.faces());
        let mut arrivals = Arrivals::new(self.mesh.elements().len());
        for views in views.chunks(VIEWS_AT_ONCE) {
            let seen: Vec<Seen<'_>> = views.par_iter().map(|v| self.transform(v)).collect();
            let count = faces.len();
            let tallies: Vec<Tally> = (0..count * views.len())
                .into_par_iter()
                .map(|i| self.face_tally(&seen[i / count], faces[i % count]))
                .collect();
            // In this order on any number of threads.
            for (i, tally) in tallies.iter().enumerate() {
                let weighted = |share: [f64; 3]| share.map(|s| s * views[i / count].weight);
                add(&mut arrivals.absorbed, weighted(tally.absorbed));
                add(&mut arrivals.escaped, weighted(tally.escaped));
                for &(element, share) in &tally.received {
                    add(&mut arrivals.received[element], weighted(share));
                }
            }
        }
        for (element, factor) in self.small_receivers(source, &views) {
            arrivals.received[element] = [0, 1, 2].map(|band| f64::from(factor[band]));
        }
        arrivals.write(&self.mesh, self.bands, row);
    }
}

/// Adds up runs of cells with the same item before the item is looked up; cells through which no light passes do not count.
fn add_runs<'a>(
    items: &[u32],
    deltas: impl Iterator<Item = &'a f64>,
    add: &mut impl FnMut(u32, f64),
) {
    let (mut run, mut share) = (items[0], 0.0);
    items.iter().zip(deltas).for_each(|(&item, &delta)| {
        if item != run {
            if share > 0.0 {
                add(run, share);
            }
            (run, share) = (item, 0.0);
        }
        share += delta;
    });
    if share > 0.0 {
        add(run, share);
    }
}

/// What may be seen from a hemicube.
#[derive(Debug)]
struct Seen<'a> {
    /// The mesh's vertices in the hemicube's frame.
    vertices: Vec<Vec3>,
    /// Vertices of the elements and obstructions above the plane, with their packed items.
    items: Vec<(&'a [u32], u32)>,
    /// Distance of the near planes.
    near: f32,
}

/// What a cell sees.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Item {
    element: usize,
    /// Whether it is seen from a side that only absorbs.
    is_back: bool,
}

impl Item {
    fn pack(self) -> u32 {
        crate::index32(self.element) << 1 | u32::from(self.is_back)
    }

    fn unpack(item: u32) -> Option<Self> {
        (item != EMPTY).then_some(Self {
            element: (item >> 1) as usize,
            is_back: item & 1 == 1,
        })
    }
}

/// Shares of what leaves a point through one face.
#[derive(Debug, Default)]
struct Tally {
    received: Vec<(usize, [f64; 3])>,
    absorbed: [f64; 3],
    escaped: [f64; 3],
}

impl Tally {
    /// Takes what has arrived out of the buffers.
    fn collect(&mut self, buffers: &mut Buffers) {
        let Buffers {
            touched, arrived, ..
        } = buffers;
        let take = |element| (element, core::mem::take(&mut arrived[element]));
        self.received = touched.drain(..).map(take).collect();
    }
}

/// Memory for one face, used again and again.
#[derive(Debug, Default)]
struct Buffers {
    depth: Vec<f32>,
    items: Vec<u32>,
    /// Depth of the layers that are already counted.
    before: Vec<f32>,
    /// What each element has got so far; zero between faces.
    arrived: Vec<[f64; 3]>,
    /// The elements that got something.
    touched: Vec<usize>,
}

impl Buffers {
    fn clear(&mut self, viewport: Viewport) {
        let cells = viewport.width * viewport.height;
        self.depth.clear();
        self.depth.resize(cells, DepthBuffer::EMPTY);
        self.items.clear();
        self.items.resize(cells, EMPTY);
    }
}

#[expect(clippy::cast_possible_truncation, reason = "factors are kept in f32")]
fn to_f32(x: f64) -> f32 {
    x as f32
}
