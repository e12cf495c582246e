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

mod seen;

use self::seen::{Corners, Receiver, Seen};
use crate::cast::to_f32;
use crate::error::RadiosityError;
use crate::form_factor::analytic::unoccluded::Rules;
use crate::form_factor::arrivals::{Arrivals, add};
pub use crate::form_factor::delta_factors::{CubeFace, DeltaFactors, Projection};
use crate::form_factor::polygon::FlatPolygon;
pub use crate::form_factor::viewpoints::Viewpoint;
use crate::form_factor::viewpoints::Viewpoints;
use crate::form_factor::{FormFactors, Row};
use crate::patch::{NodeId, PatchMesh};
use crate::sampling::{hash, point2};
use core::f64::consts::PI;
use core::ops::Range;
use hemicube_raster::Rgb;
use hemicube_raster::triangle::{
    ClipVertex, Cull, DepthBuffer, Viewport, draw_ids, draw_quad_ids, draw_triangle,
};
use rayon::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use wide::i32x8;

/// Cells below which a receiver's factor is integrated instead of counted.
const FEW_CELLS: f64 = 10.0;
/// Rays that tell which share of such a receiver is seen.
const FEW_CELLS_RAYS: u32 = 8;
/// Layers of panes that are looked through.
pub const MAX_LAYERS: usize = 8;
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

/// What one hemicube sees, summed by a renderer of item buffers elsewhere; 1 in all, in any unit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sums {
    /// Share of each element, `[band][element]` in three bands, or in one if all are alike; what a pane lets through
    /// counts, too, and once more where that arrives.
    pub received: Vec<f64>,
    /// Share of sides that only absorb, by band.
    pub absorbed: [f64; 3],
    /// Share that meets nothing, by band.
    pub escaped: [f64; 3],
}

/// Form factors by hemicubes on the CPU.
#[derive(Debug)]
pub struct Hemicube {
    mesh: Arc<PatchMesh>,
    options: HemicubeOptions,
    deltas: DeltaFactors,
    bands: usize,
    viewpoints: Viewpoints,
    /// One for each element.
    receivers: Vec<Receiver>,
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
            receivers: (0..mesh.elements().len())
                .map(|element| Receiver::new(&mesh, element))
                .collect(),
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
        let seen = self.see(&self.viewpoints.of(source)[0]);
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

    /// Where the hemicubes of a node stand.
    pub fn viewpoints(&self, source: NodeId) -> Vec<Viewpoint> {
        self.viewpoints.of(source)
    }

    /// Radius of an element around its centroid.
    pub fn radius(&self, element: usize) -> f32 {
        self.viewpoints.radius(element)
    }

    /// Whether light passes through elements, so that one item buffer is not enough.
    pub fn is_layered(&self) -> bool {
        self.layered
    }

    /// The row of a node from what its hemicubes see, drawn elsewhere.
    pub fn row_of_sums(&self, source: NodeId, views: &[Viewpoint], sums: &[Sums], row: &mut Row) {
        let elements = self.mesh.elements().len();
        let mut arrivals = Arrivals::new(elements);
        for (view, sums) in views.iter().zip(sums) {
            let weighted = |share: [f64; 3]| share.map(|s| s * view.weight);
            add(&mut arrivals.absorbed, weighted(sums.absorbed));
            add(&mut arrivals.escaped, weighted(sums.escaped));
            let bands = sums.received.len() / elements.max(1);
            let of_band = |band: usize| &sums.received[band % bands * elements..][..elements];
            let [red, green, blue] = [0, 1, 2].map(of_band);
            for (e, arrived) in arrivals.received.iter_mut().enumerate() {
                add(arrived, weighted([red[e], green[e], blue[e]]));
            }
        }
        self.finish_row(source, views, arrivals, row);
    }

    fn finish_row(
        &self,
        source: NodeId,
        views: &[Viewpoint],
        mut arrivals: Arrivals,
        row: &mut Row,
    ) {
        for (element, factor) in self.small_receivers(source, views) {
            arrivals.received[element] = [0, 1, 2].map(|band| f64::from(factor[band]));
        }
        arrivals.write(&self.mesh, self.bands, row);
    }

    fn faces(&self) -> &'static [CubeFace] {
        self.options.projection.faces()
    }

    /// Draws the hemicubes of a node on this thread, for nothing but to know where the time goes.
    pub fn stage_times(&self, source: NodeId) -> StageTimes {
        let mut times = StageTimes::default();
        let mut buffers = self.buffers();
        for view in self.viewpoints.of(source) {
            let start = Instant::now();
            let seen = self.see(&view);
            times.transform += start.elapsed();
            for &face in self.faces() {
                let start = Instant::now();
                self.draw(&seen, face, &mut buffers);
                let drawn = Instant::now();
                self.tally(&seen, face, &mut buffers);
                times.raster += drawn - start;
                times.sum += drawn.elapsed();
            }
            times.hemicubes += 1;
        }
        self.give_back(buffers);
        times
    }

    fn see(&self, view: &Viewpoint) -> Seen {
        Seen::new(self, view)
    }

    /// The item of all obstructions: the back of an element that there is not.
    fn obstruction(&self) -> u32 {
        let item = Item {
            element: self.mesh.elements().len(),
            is_back: true,
        };
        item.pack()
    }

    /// The item buffer of one face.
    fn draw(&self, seen: &Seen, face: CubeFace, buffers: &mut Buffers) {
        let viewport = face.viewport(self.options.resolution as usize);
        buffers.clear(viewport);
        let (depth, items) = (&mut buffers.depth, &mut buffers.items);
        seen.for_each_element(face, |corners, item| {
            let rows = 0..viewport.height;
            match corners {
                Corners::Triangle(triangle) => {
                    draw_ids(rows, viewport, Cull::None, triangle, item, depth, items);
                }
                Corners::Quad(quad) => {
                    draw_quad_ids(rows, viewport, Cull::None, quad, item, depth, items);
                }
            }
        });
    }

    /// The item buffer of what lies behind `buffers.before`.
    fn draw_behind(&self, seen: &Seen, face: CubeFace, buffers: &mut Buffers) {
        let viewport = face.viewport(self.options.resolution as usize);
        buffers.clear(viewport);
        let Buffers {
            depth,
            items,
            before,
            ..
        } = buffers;
        seen.for_each_element(face, |corners, item| {
            for triangle in corners.triangles() {
                let vertices = triangle.map(|position| ClipVertex::new(position, []));
                draw_triangle(
                    0..viewport.height,
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
            }
        });
    }

    /// What one face of one hemicube sees.
    fn face_tally(&self, seen: &Seen, face: CubeFace) -> Tally {
        let mut buffers = self.buffers();
        self.draw(seen, face, &mut buffers);
        let tally = self.tally(seen, face, &mut buffers);
        self.give_back(buffers);
        tally
    }

    fn tally(&self, seen: &Seen, face: CubeFace, buffers: &mut Buffers) -> Tally {
        if self.layered {
            self.peel(seen, face, buffers)
        } else {
            self.sum(face, buffers)
        }
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
            let shares = self.deltas.row(face, row);
            for_each_run(items, |item, cells| add(item, shares.of(cells)));
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
    fn peel(&self, seen: &Seen, face: CubeFace, buffers: &mut Buffers) -> Tally {
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
            let seen: Vec<Seen> = views.par_iter().map(|view| self.see(view)).collect();
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
        self.finish_row(source, &views, arrivals, row);
    }
}

/// Calls `run` with each item of a row and the columns in which it is seen in succession.
fn for_each_run(items: &[u32], mut run: impl FnMut(u32, Range<usize>)) {
    let mut start = 0;
    let mut end_at = |end: usize| {
        run(items[start], start..end);
        start = end;
    };
    // Most cells see what their neighbour sees: eight are compared at once.
    let pairs = items.len() - 1;
    let groups = pairs / 8 * 8;
    let eight = |from: usize| -> i32x8 {
        let items: [u32; 8] = items[from..from + 8].try_into().expect("eight items");
        bytemuck::cast(items)
    };
    for group in (0..groups).step_by(8) {
        let mut ends = !eight(group).simd_eq(eight(group + 1)).to_bitmask() & 0xff;
        while ends != 0 {
            end_at(group + ends.trailing_zeros() as usize + 1);
            ends &= ends - 1;
        }
    }
    for cell in groups..pairs {
        if items[cell] != items[cell + 1] {
            end_at(cell + 1);
        }
    }
    end_at(items.len());
}

/// How long the hemicubes of a row take on one thread, see [`Hemicube::stage_times`].
#[derive(Debug, Clone, Copy, Default)]
pub struct StageTimes {
    /// Hemicubes drawn.
    pub hemicubes: usize,
    /// Bringing everything into their frames, and finding what may appear on which face.
    pub transform: Duration,
    /// Clearing and drawing item buffers.
    pub raster: Duration,
    /// Summing delta form factors by item, or peeling layers where light passes through elements.
    pub sum: Duration,
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
