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
//! # Limits
//! Rows of clusters panic. Where elements of different size meet, a cell may look through the seam. A patch wider than 16 hemicubes do justice to keeps an error towards what touches it
//! inside its outline, such as furniture on a floor; smaller patches end it.

mod seen;

use self::seen::{Corners, Receiver, Seen};
use crate::error::RadiosityError;
pub use crate::form_factor::delta_factors::{CubeFace, DeltaFactors};
use crate::form_factor::polygon::{FlatPolygon, exchange_area};
use crate::form_factor::{FormFactors, Row};
use crate::patch::{NodeId, PatchMesh};
use crate::sampling::{hash, point2};
use core::f64::consts::PI;
use core::ops::Range;
use glam::Vec3;
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
const MAX_LAYERS: usize = 8;
/// Hemicubes that are transformed before they are drawn: bounds the memory of large scenes.
const VIEWS_AT_ONCE: usize = 4;
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
}

impl Default for HemicubeOptions {
    fn default() -> Self {
        Self {
            resolution: 256,
            max_points: 16,
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
}

/// What the five faces of one hemicube see, to be shown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ItemBuffers {
    /// Cells along an edge of the top.
    pub resolution: usize,
    /// Elements seen, row by row from above, in the order of [`CubeFace::ALL`]; panes count as opaque.
    pub faces: [Vec<u32>; 5],
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
        if ![1, 4, 16].contains(&options.max_points) {
            return Err(RadiosityError::Option(format!(
                "{} hemicubes for a patch are not 1, 4 or 16",
                options.max_points
            )));
        }
        Ok(Self {
            deltas: DeltaFactors::new(options.resolution)?,
            bands: if mesh.visibility().is_tinted() { 3 } else { 1 },
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
        self.views(source).len()
    }

    /// The item buffers of a node's first hemicube.
    pub fn item_buffers(&self, source: NodeId) -> ItemBuffers {
        let seen = self.see(&self.views(source)[0]);
        let public = |item: &u32| match Item::unpack(*item) {
            None => ItemBuffers::NOTHING,
            Some(Item { is_back: true, .. }) => ItemBuffers::ABSORBED,
            Some(Item { element, .. }) => crate::index32(element),
        };
        ItemBuffers {
            resolution: self.options.resolution as usize,
            faces: CubeFace::ALL.map(|face| {
                let mut buffers = self.buffers();
                self.draw(&seen, face, &mut buffers);
                let items = buffers.items.iter().map(public).collect();
                self.give_back(buffers);
                items
            }),
        }
    }

    /// Draws the hemicubes of a node on this thread, for nothing but to know where the time goes.
    pub fn stage_times(&self, source: NodeId) -> StageTimes {
        let mut times = StageTimes::default();
        let mut buffers = self.buffers();
        for view in self.views(source) {
            let start = Instant::now();
            let seen = self.see(&view);
            times.transform += start.elapsed();
            for face in CubeFace::ALL {
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

    /// The points at which hemicubes stand on a node.
    fn views(&self, source: NodeId) -> Vec<View> {
        let mesh = &*self.mesh;
        let node = mesh.node(source);
        let polygon = mesh.polygon(source);
        let side = self.points_per_side(source);
        let parts = exposed_parts(mesh, source);
        let points = match (parts.last(), side) {
            (Some(&(total, _)), _) => {
                // Points that happen to lie close to the solid see it too large; more of them even that out.
                let count = 4 * (side * side).max(4).min(self.options.max_points);
                let stratum = |i: u32| {
                    let wanted = total * (i as f32 + 0.5) / count as f32;
                    let part = parts.partition_point(|&(sum, _)| sum <= wanted);
                    let (_, element) = parts[part.min(parts.len() - 1)];
                    let point = mesh.exposed(element).point(point2(i, u64::from(source.0)));
                    (point, 1.0 / f64::from(count))
                };
                (0..count).map(stratum).collect()
            }
            (None, 1) => vec![(node.centroid, 1.0)],
            (None, 2) => gauss_points(&polygon, &GAUSS_2),
            (None, _) => gauss_points(&polygon, &GAUSS_4),
        };
        let frame = |(i, (point, weight)): (u64, (Vec3, f64))| {
            let turn = hash(u64::from(source.0), i) >> 40;
            let angle = turn as f32 / (1 << 24) as f32 * core::f32::consts::TAU;
            let (t, b) = node.normal.any_orthonormal_pair();
            let tangent = (t * angle.cos() + b * angle.sin()).normalize();
            View {
                origin: mesh.visibility().off_surface(point, node.normal),
                axes: [tangent, node.normal.cross(tangent), node.normal],
                weight,
            }
        };
        (0..).zip(points).map(frame).collect()
    }

    /// 1, 2 or 4, by the distance from the centre to the nearest surface above the node's plane.
    fn points_per_side(&self, source: NodeId) -> u32 {
        let mesh = &*self.mesh;
        let node = mesh.node(source);
        let polygon = mesh.polygon(source);
        let edge = (0..polygon.len())
            .map(|i| polygon[i].distance(polygon[(i + 1) % polygon.len()]))
            .fold(0.0, f32::max);
        let most = match self.options.max_points {
            1 => return 1,
            4 => 2,
            _ => 4,
        };
        let floor = 2.0 * mesh.visibility().offset(node.centroid);
        let nearest = (0..)
            .zip(&self.receivers)
            .filter(|(_, receiver)| receiver.is_exposed)
            .filter(|&(e, _): &(usize, _)| {
                let corners = mesh.polygon(mesh.elements()[e]);
                corners
                    .iter()
                    .any(|&c| (c - node.centroid).dot(node.normal) > floor)
            })
            .fold(3.0 * edge, |best, (e, receiver)| {
                receiver.nearer(mesh, mesh.elements()[e], node.centroid, best)
            });
        if nearest >= 3.0 * edge {
            1
        } else if nearest >= 1.25 * edge {
            most.min(2)
        } else {
            most
        }
    }

    fn see(&self, view: &View) -> Seen {
        Seen::new(&self.mesh, &self.receivers, view)
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
                let passing = self.mesh.transmittance()[element];
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
    fn small_receivers(&self, source: NodeId, views: &[View]) -> Vec<(usize, Rgb)> {
        let mesh = &*self.mesh;
        let node = mesh.node(source);
        let polygon = mesh.polygon(source);
        let radius = polygon
            .iter()
            .map(|c| c.distance(node.centroid))
            .fold(0.0, f32::max);
        let resolution = f64::from(self.options.resolution);
        // The mean delta factor is 1 / (3 N²).
        let smallest = FEW_CELLS / (3.0 * resolution * resolution);
        let flat = FlatPolygon::new(&polygon, node.normal);
        let visibility = mesh.visibility();
        let factor = |(e, &id): (usize, &NodeId)| {
            let to = mesh.node(id);
            let offset = to.centroid - node.centroid;
            let distance2 = offset.length_squared();
            let reach = 2.0 * (radius + self.receivers[e].radius);
            let cosines = offset.dot(node.normal) * -offset.dot(to.normal) / distance2;
            if distance2 < reach * reach || cosines < 1e-6 || mesh.exposed_area(e) == 0.0 {
                return None;
            }
            let estimate = f64::from(cosines * to.area) / (PI * f64::from(distance2));
            if estimate >= smallest {
                return None;
            }
            let unoccluded = exchange_area(&flat, &FlatPolygon::new(&mesh.polygon(id), to.normal))
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
        row.clear(self.bands);
        let views = self.views(source);
        let mut received = vec![[0.0; 3]; self.mesh.elements().len()];
        let (mut absorbed, mut escaped) = ([0.0; 3], [0.0; 3]);
        for views in views.chunks(VIEWS_AT_ONCE) {
            let seen: Vec<Seen> = views.par_iter().map(|view| self.see(view)).collect();
            let tallies: Vec<Tally> = (0..5 * views.len())
                .into_par_iter()
                .map(|i| self.face_tally(&seen[i / 5], CubeFace::ALL[i % 5]))
                .collect();
            // In this order on any number of threads.
            for (i, tally) in tallies.iter().enumerate() {
                let weighted = |share: [f64; 3]| share.map(|s| s * views[i / 5].weight);
                add(&mut absorbed, weighted(tally.absorbed));
                add(&mut escaped, weighted(tally.escaped));
                for &(element, share) in &tally.received {
                    add(&mut received[element], weighted(share));
                }
            }
        }
        for (element, factor) in self.small_receivers(source, &views) {
            received[element] = [0, 1, 2].map(|band| f64::from(factor[band]));
        }
        self.close(&received, absorbed, escaped, row);
    }
}

impl Hemicube {
    /// Writes a row, divided by its sum.
    fn close(&self, received: &[[f64; 3]], absorbed: [f64; 3], escaped: [f64; 3], row: &mut Row) {
        let transmittance = self.mesh.transmittance();
        let scale = [0, 1, 2].map(|band| {
            let kept = received.iter().zip(transmittance);
            let kept: f64 = kept
                .map(|(share, through)| share[band] * f64::from(1.0 - through[band]))
                .sum();
            1.0 / (kept + absorbed[band] + escaped[band]).max(1e-30)
        });
        let found = |(_, share): &(u32, &[f64; 3])| share.iter().any(|&s| s > 0.0);
        let found: Vec<(u32, &[f64; 3])> = (0..).zip(received).filter(found).collect();
        row.receivers.extend(found.iter().map(|&(e, _)| e));
        for band in 0..self.bands {
            let factor = |(_, share): &(u32, &[f64; 3])| to_f32(share[band] * scale[band]);
            row.fractions.extend(found.iter().map(factor));
        }
        row.absorbed = [0, 1, 2].map(|band| to_f32(absorbed[band] * scale[band]));
        row.escaped = [0, 1, 2].map(|band| to_f32(escaped[band] * scale[band]));
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

/// Where a hemicube stands.
#[derive(Debug, Clone, Copy)]
struct View {
    origin: Vec3,
    /// Two axes in the patch's plane and its normal.
    axes: [Vec3; 3],
    weight: f64,
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

/// Nodes in [0, 1] and weights of Gauss-Legendre quadrature.
const GAUSS_2: [(f32, f64); 2] = [(0.211_324_87, 0.5), (0.788_675_1, 0.5)];
const GAUSS_4: [(f32, f64); 4] = [
    (0.069_431_84, 0.173_927_422_568_726_93),
    (0.330_009_5, 0.326_072_577_431_273_07),
    (0.669_990_5, 0.326_072_577_431_273_07),
    (0.930_568_16, 0.173_927_422_568_726_93),
];

/// Points of a product rule on a polygon, a triangle being a quad whose last corner meets the first. Weights sum to 1.
fn gauss_points(polygon: &[Vec3], rule: &[(f32, f64)]) -> Vec<(Vec3, f64)> {
    let (a, b, c) = (polygon[0], polygon[1], polygon[2]);
    let d = polygon.get(3).copied().unwrap_or(a);
    let mut points = Vec::with_capacity(rule.len() * rule.len());
    for &(u, wu) in rule {
        for &(v, wv) in rule {
            let point = a.lerp(b, u).lerp(d.lerp(c, u), v);
            let (along_u, along_v) = ((b - a).lerp(c - d, v), (d - a).lerp(c - b, u));
            let jacobian = f64::from(along_u.cross(along_v).length());
            points.push((point, wu * wv * jacobian));
        }
    }
    let sum: f64 = points.iter().map(|&(_, weight)| weight).sum();
    points.iter_mut().for_each(|(_, weight)| *weight /= sum);
    points
}

/// Elements of a patch with running sums of their exposed areas; empty if all of it is exposed, or none.
fn exposed_parts(mesh: &PatchMesh, id: NodeId) -> Vec<(f32, usize)> {
    let Some(patch) = mesh.patch_of_node(id) else {
        return Vec::new();
    };
    let elements = mesh.elements_of_patch(patch);
    let is_whole = |e: usize| mesh.exposed_area(e) == mesh.node(mesh.elements()[e]).area;
    if elements.clone().all(is_whole) {
        return Vec::new();
    }
    let mut sum = 0.0;
    elements
        .filter(|&e| mesh.exposed_area(e) > 0.0)
        .map(|e| {
            sum += mesh.exposed_area(e);
            (sum, e)
        })
        .collect()
}

/// Distance from a point to a planar convex polygon.
fn distance_to_polygon(point: Vec3, polygon: &[Vec3], normal: Vec3) -> f32 {
    let mut is_over = true;
    let mut nearest2 = f32::INFINITY;
    for (i, &a) in polygon.iter().enumerate() {
        let edge = polygon[(i + 1) % polygon.len()] - a;
        let offset = point - a;
        is_over &= edge.cross(offset).dot(normal) >= 0.0;
        let along = (offset.dot(edge) / edge.length_squared().max(1e-30)).clamp(0.0, 1.0);
        nearest2 = nearest2.min((offset - edge * along).length_squared());
    }
    if is_over {
        (point - polygon[0]).dot(normal).abs()
    } else {
        nearest2.sqrt()
    }
}

fn add(sum: &mut [f64; 3], share: [f64; 3]) {
    for (sum, share) in sum.iter_mut().zip(share) {
        *sum += share;
    }
}

#[expect(clippy::cast_possible_truncation, reason = "factors are kept in f32")]
fn to_f32(x: f64) -> f32 {
    x as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_a_row_are_those_of_a_plain_walk() {
        for width in [1, 2, 7, 8, 9, 16, 17, 64, 500] {
            for density in [1, 2, 30] {
                let item = |i: u64| {
                    u32::try_from(hash(density, i) % 7 / (1 + i % density)).expect("small")
                };
                let items: Vec<u32> = (0..width).map(item).collect();
                let mut expected: Vec<(u32, Range<usize>)> = Vec::new();
                for (cell, &item) in items.iter().enumerate() {
                    match expected.last_mut() {
                        Some((last, cells)) if *last == item => cells.end = cell + 1,
                        _ => expected.push((item, cell..cell + 1)),
                    }
                }
                let mut runs = Vec::new();
                for_each_run(&items, |item, cells| runs.push((item, cells)));
                assert_eq!(runs, expected, "{width} cells, density {density}");
            }
        }
    }

    #[test]
    fn distances_to_a_square() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let distance = |x, y, z| distance_to_polygon(Vec3::new(x, y, z), &square, Vec3::Z);
        assert_eq!(distance(0.5, 0.5, 2.0), 2.0, "over the square");
        assert_eq!(distance(0.5, 0.5, -2.0), 2.0, "below the square");
        assert_eq!(distance(4.0, 0.5, 4.0), 5.0, "beside an edge");
    }
}
