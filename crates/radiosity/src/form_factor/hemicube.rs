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

use crate::error::RadiosityError;
pub use crate::form_factor::delta_factors::{CubeFace, DeltaFactors};
use crate::form_factor::polygon::{FlatPolygon, exchange_area};
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
    /// Of each element: radius around its centroid.
    radii: Vec<f32>,
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
        let radius = |&id: &NodeId| {
            let (polygon, centre) = (mesh.polygon(id), mesh.node(id).centroid);
            let distances = polygon.iter().map(|c| c.distance(centre));
            distances.fold(0.0, f32::max)
        };
        Ok(Self {
            deltas: DeltaFactors::new(options.resolution)?,
            bands: if mesh.visibility().is_tinted() { 3 } else { 1 },
            radii: mesh.elements().iter().map(radius).collect(),
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
        let seen = self.transform(&self.views(source)[0]);
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
        let nearest = (0..mesh.elements().len())
            .filter(|&e| mesh.exposed_area(e) > 0.0)
            .filter(|&e| {
                let corners = mesh.polygon(mesh.elements()[e]);
                corners
                    .iter()
                    .any(|&c| (c - node.centroid).dot(node.normal) > floor)
            })
            .fold(3.0 * edge, |best, e| self.nearer(node.centroid, e, best));
        let nearest = self.nearer_obstruction(node.centroid, Some(node.normal), nearest);
        if nearest >= 3.0 * edge {
            1
        } else if nearest >= 1.25 * edge {
            most.min(2)
        } else {
            most
        }
    }

    /// The distance from a point to an element if it is less than `best`, else `best`.
    fn nearer(&self, point: Vec3, element: usize, best: f32) -> f32 {
        let id = self.mesh.elements()[element];
        let node = self.mesh.node(id);
        let offset = point - node.centroid;
        let reach = best + self.radii[element];
        if offset.length_squared() >= reach * reach || offset.dot(node.normal).abs() >= best {
            return best;
        }
        distance_to_polygon(point, &self.mesh.polygon(id), node.normal).min(best)
    }

    /// The distance from a point to the nearest obstruction if it is less than `best`, else `best`; those wholly below
    /// the plane of a normal do not count.
    fn nearer_obstruction(&self, point: Vec3, above: Option<Vec3>, best: f32) -> f32 {
        let floor = 2.0 * self.mesh.visibility().offset(point);
        let faces = self.mesh.obstructions().iter();
        let faces = faces.map(|&(face, _)| &self.mesh.faces()[face as usize]);
        faces
            .filter(|face| {
                let is_above = |n: Vec3| face.polygon().iter().any(|&c| (c - point).dot(n) > floor);
                above.is_none_or(is_above)
            })
            .fold(best, |best, face| {
                distance_to_polygon(point, face.polygon(), face.normal).min(best)
            })
    }

    /// Everything above a hemicube's plane in its own frame.
    fn transform(&self, view: &View) -> Seen<'_> {
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
            nearest = self.nearer(view.origin, element, nearest);
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
        let nearest = self.nearer_obstruction(view.origin, None, nearest);
        // A point at this distance is at least 1/√3 of it before one of the faces; the depth buffer is the finer the
        // farther its near plane.
        let near = (0.57 * nearest).max(mesh.visibility().offset(view.origin));
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
            // Runs of cells with the same item are added up before the item is looked up.
            let (mut run, mut share) = (items[0], 0.0);
            let half_row = self.deltas.half_row(face, row);
            let mirrored = half_row.iter().rev().chain(half_row);
            items.iter().zip(mirrored).for_each(|(&item, &delta)| {
                if item != run {
                    add(run, share);
                    (run, share) = (item, 0.0);
                }
                share += delta;
            });
            add(run, share);
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
            let reach = 2.0 * (radius + self.radii[e]);
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
            let seen: Vec<Seen<'_>> = views.par_iter().map(|v| self.transform(v)).collect();
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

/// Where a hemicube stands.
#[derive(Debug, Clone, Copy)]
struct View {
    origin: Vec3,
    /// Two axes in the patch's plane and its normal.
    axes: [Vec3; 3],
    weight: f64,
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
    fn distances_to_a_square() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let distance = |x, y, z| distance_to_polygon(Vec3::new(x, y, z), &square, Vec3::Z);
        assert_eq!(distance(0.5, 0.5, 2.0), 2.0, "over the square");
        assert_eq!(distance(0.5, 0.5, -2.0), 2.0, "below the square");
        assert_eq!(distance(4.0, 0.5, 4.0), 5.0, "beside an edge");
    }
}
