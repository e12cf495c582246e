//! Form factors by subdividing the hemisphere into cells of equal form factor.
//!
//! The hemicube's cells differ: one in the middle of the top passes nine times as much light as one in its corner, and those
//! near the patch's plane next to none. Over the hemisphere cells can be equal. By Nusselt's analog a cell's form factor
//! is its area in the unit circle below, so the circle is cut into cells of equal *area*, as square as can be, and a ray
//! goes up from each (Malley's method, Shirley and Wang 1992, says that such rays are distributed as diffuse light):
//!
//! ```text
//! for each point of the patch, for each cell of the circle
//!     lift a point of the cell onto the hemisphere: direction (x, y, √(1 - x² - y²))
//!     fraction[element that the ray meets] += weight of the point / number of cells
//! ```
//!
//! 1. Rings and sectors as Beckers and Beckers (2012) choose them: a ring around which `N` cells lie in all and `n` inside
//!    of it is as wide as its sectors are long if `√N - √n = √π`. Any number of cells can be had.
//! 2. The point of a cell is drawn at random. In its middle, outlines of walls that run along rings or radii would be
//!    all right or all wrong at once; drawn, every factor is right on average.
//! 3. Points of large near patches are those of the [hemicube](super::hemicube), for the same reason.
//!
//! # Error
//! Of one point's factor `F` to what has a convex outline, with `N` cells, the standard deviation is at most
//! `1.2 N^(-3/4)` ([`bound`]), and at most `√(F/N)` as for independent rays. At the default that is 0.2 %. To it comes
//! the error of taking the patch for its points, see [`HemisphereOptions::max_points`].
//!
//! # Limits
//! Rows of clusters panic. Receivers smaller than a cell are met by chance.

use crate::error::RadiosityError;
use crate::form_factor::arrivals::{Arrivals, add};
use crate::form_factor::viewpoints::{Viewpoint, Viewpoints};
use crate::form_factor::{FormFactors, Row};
use crate::patch::{NodeId, PatchMesh};
use crate::sampling::hash;
use core::f32::consts::TAU;
use core::f64::consts::PI;
use core::ops::Range;
use glam::Vec3;
use hemicube_raster::Rgb;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Cells whose rays one thread casts before the next piece of work is handed out.
const CHUNK: u32 = 512;
/// Pieces of work that are handed out together.
const CHUNKS_AT_ONCE: u32 = 512;

/// How fine hemispheres are, and how many a patch may get.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HemisphereOptions {
    /// Cells of a hemisphere, from 16 to 16,777,216; one ray goes through each. Default value: 4096, which takes about
    /// as long as a hemicube of 256 cells an edge in a room of some thousand elements.
    pub cells: u32,
    /// Most points of one patch: 1, 4 or 16, chosen as for the hemicube, see
    /// [`HemicubeOptions::max_points`](super::hemicube::HemicubeOptions::max_points). Default value: 16.
    pub max_points: u32,
    /// Of the random numbers. Default value: 0.
    pub seed: u64,
}

impl Default for HemisphereOptions {
    fn default() -> Self {
        Self {
            cells: 4096,
            max_points: 16,
            seed: 0,
        }
    }
}

impl HemisphereOptions {
    /// Another number of cells.
    pub fn with_cells(self, cells: u32) -> Self {
        Self { cells, ..self }
    }

    /// Another bound on the points of a patch.
    pub fn with_max_points(self, max_points: u32) -> Self {
        Self { max_points, ..self }
    }

    /// Other random numbers.
    pub fn with_seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }
}

/// Upper bound of the standard deviation of a point's factor to something with a convex outline.
///
/// A cell is uncertain only if the outline crosses it, and then its share `1/N` is a coin's throw at worst. On the
/// hemisphere a convex outline is at most as long as a great circle, 2π, and seen from above it is shorter. The cells are
/// about squares of width `h = √(π/N)`, of which a curve of length ℓ crosses `4ℓ / πh`, averaged over all directions: at most
/// `8 √(N/π)`. So the deviation is below `1/2 √(8 √(N/π)) / N = 1.06 N^(-3/4)`; cells are not quite squares, for which the
/// rest allows.
pub fn bound(cells: u32) -> f64 {
    1.2 * f64::from(cells).powf(-0.75)
}

/// A ring of [`EqualAreaDisk`].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ring {
    /// Cells inside of it; its inner radius is the root of their share.
    inside: u32,
    sectors: u32,
    /// By how many sectors it is turned, so that the edges of sectors do not line up.
    turn: f32,
}

/// The unit circle in cells of equal area, as square as can be.
#[derive(Debug, Clone, PartialEq)]
pub struct EqualAreaDisk {
    cells: u32,
    /// From the centre outwards.
    rings: Vec<Ring>,
}

impl EqualAreaDisk {
    /// So many cells, at least 1.
    pub fn new(cells: u32) -> Self {
        let mut rings = Vec::new();
        let mut outer = cells.max(1);
        while outer > 0 {
            let inside = inner_cells(outer);
            let number = rings.len() as f32;
            rings.push(Ring {
                inside,
                sectors: outer - inside,
                turn: (number * 0.618_034).fract(),
            });
            outer = inside;
        }
        rings.reverse();
        Self {
            cells: cells.max(1),
            rings,
        }
    }

    /// Number of cells.
    pub fn cells(&self) -> u32 {
        self.cells
    }

    /// A point of a cell for one of the unit square, area-uniform. Cells count from the centre outwards.
    pub fn point(&self, cell: u32, [u, v]: [f32; 2]) -> [f32; 2] {
        let ring = self.rings.partition_point(|ring| ring.inside <= cell) - 1;
        let Ring {
            inside,
            sectors,
            turn,
        } = self.rings[ring];
        let area = (inside as f32 + u * sectors as f32) / self.cells as f32;
        let sector = (cell - inside) as f32 + v + turn;
        let (sine, cosine) = (TAU * sector / sectors as f32).sin_cos();
        let radius = area.min(1.0).sqrt();
        [radius * cosine, radius * sine]
    }
}

/// Cells inside the outermost ring of so many: `√outer - √inner = √π`.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and outer - 1"
)]
fn inner_cells(outer: u32) -> u32 {
    let root = f64::from(outer).sqrt() - PI.sqrt();
    (root.max(0.0).powi(2).round() as u32).min(outer - 1)
}

/// Form factors by hemispheres of equal cells.
#[derive(Debug)]
pub struct Hemisphere {
    mesh: Arc<PatchMesh>,
    options: HemisphereOptions,
    disk: EqualAreaDisk,
    viewpoints: Viewpoints,
    bands: usize,
    rays: AtomicU64,
}

/// What an element keeps of a ray; the last element is what only absorbs.
type Arrival = (usize, Rgb);

impl Hemisphere {
    /// Factors between the nodes of a mesh.
    ///
    /// # Errors
    /// Options out of their range.
    pub fn new(mesh: Arc<PatchMesh>, options: HemisphereOptions) -> Result<Self, RadiosityError> {
        if !(16..=1 << 24).contains(&options.cells) {
            return Err(RadiosityError::Option(format!(
                "{} cells of a hemisphere are not from 16 to {}",
                options.cells,
                1 << 24
            )));
        }
        Ok(Self {
            disk: EqualAreaDisk::new(options.cells),
            viewpoints: Viewpoints::new(mesh.clone(), options.max_points, "hemispheres")?,
            bands: if mesh.visibility().is_tinted() { 3 } else { 1 },
            rays: AtomicU64::new(0),
            options,
            mesh,
        })
    }

    /// The options it was made with.
    pub fn options(&self) -> HemisphereOptions {
        self.options
    }

    /// Number of hemispheres over which the row of a node is averaged.
    pub fn points(&self, source: NodeId) -> usize {
        self.viewpoints.of(source).len()
    }

    /// Casts the rays of some cells; returns what surfaces keep of them in order, and the sum of what escapes.
    fn cast(&self, from: &Viewpoint, seed: u64, cells: Range<u32>) -> (Vec<Arrival>, Rgb) {
        let mesh = &*self.mesh;
        let nothing = mesh.elements().len();
        let mut arrivals = Vec::with_capacity(cells.len());
        let mut escaped = Rgb::BLACK;
        for cell in cells {
            let direction = self.direction(from, cell, seed);
            escaped +=
                mesh.visibility()
                    .follow(from.origin, direction, |hit, arriving, passing| {
                        let element = mesh
                            .element_at(hit.face, hit.side, hit.point)
                            .filter(|&e| mesh.exposed_area(e) > 0.0);
                        arrivals.push((
                            element.unwrap_or(nothing),
                            arriving * (Rgb::WHITE - passing),
                        ));
                    });
        }
        (arrivals, escaped)
    }

    /// Direction of the ray through a cell.
    fn direction(&self, from: &Viewpoint, cell: u32, seed: u64) -> Vec3 {
        let bits = hash(seed, u64::from(cell));
        let unit = |bits: u64| (bits & 0xFF_FFFF) as f32 / (1 << 24) as f32;
        let [x, y] = self.disk.point(cell, [unit(bits), unit(bits >> 32)]);
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        let [tangent, bitangent, normal] = from.axes;
        (tangent * x + bitangent * y + normal * z).normalize()
    }
}

impl Hemisphere {
    /// Adds what rays of one weight met.
    fn add(&self, met: &[Arrival], escaped: Rgb, weight: f64, arrivals: &mut Arrivals) {
        let mesh = &*self.mesh;
        let weighted = |share: Rgb| [0, 1, 2].map(|band| f64::from(share[band]) * weight);
        add(&mut arrivals.escaped, weighted(escaped));
        for &(element, taken) in met {
            if element == mesh.elements().len() {
                add(&mut arrivals.absorbed, weighted(taken));
                continue;
            }
            // A row says what arrives, of which the element keeps all but its mean transmittance.
            let through = mesh.transmittance()[element];
            let arriving = [0, 1, 2].map(|band| {
                let kept = 1.0 - through[band];
                if kept > 1e-6 { taken[band] / kept } else { 0.0 }
            });
            add(&mut arrivals.received[element], weighted(arriving.into()));
        }
    }
}

impl FormFactors for Hemisphere {
    fn mesh(&self) -> &Arc<PatchMesh> {
        &self.mesh
    }

    fn fill_row(&self, source: NodeId, row: &mut Row) {
        let mesh = &*self.mesh;
        let (nothing, cells) = (mesh.elements().len(), self.disk.cells());
        let points = self.viewpoints.of(source);
        let chunks = cells.div_ceil(CHUNK);
        let seed = hash(u64::from(source.0), self.options.seed);
        let mut arrivals = Arrivals::new(nothing);
        // Some chunks at a time, so that arrivals take little memory however many cells there are.
        for (number, point) in (0..).zip(&points) {
            let seed = hash(seed, number);
            let weight = point.weight / f64::from(cells);
            for first in (0..chunks).step_by(CHUNKS_AT_ONCE as usize) {
                let cast: Vec<(Vec<Arrival>, Rgb)> = (first..(first + CHUNKS_AT_ONCE).min(chunks))
                    .into_par_iter()
                    .map(|chunk| {
                        let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(cells);
                        self.cast(point, seed, range)
                    })
                    .collect();
                for (met, escaped) in cast {
                    self.add(&met, escaped, weight, &mut arrivals);
                }
            }
        }
        self.rays
            .fetch_add(points.len() as u64 * u64::from(cells), Ordering::Relaxed);
        arrivals.write(mesh, self.bands, row);
    }

    fn most_receivers(&self, source: NodeId) -> usize {
        // A ray arrives at each pane that it passes; few pass more than one or two.
        self.points(source) * self.options.cells as usize * 2
    }

    fn rays(&self) -> u64 {
        self.rays.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_equal_area_and_cover_the_circle() {
        for cells in [16, 100, 1000, 4096] {
            let disk = EqualAreaDisk::new(cells);
            let sectors: u32 = disk.rings.iter().map(|ring| ring.sectors).sum();
            assert_eq!(sectors, cells, "every cell is in a ring");
            let mut inside = 0;
            for ring in &disk.rings {
                assert_eq!(ring.inside, inside, "{cells}: rings follow each other");
                inside += ring.sectors;
            }
            for cell in 0..cells {
                // Its corners, the area between them: a sector of a ring.
                let [a, b] = [[0.0, 0.0], [1.0, 0.0]].map(|uv| {
                    let [x, y] = disk.point(cell, uv);
                    x * x + y * y
                });
                let ring = disk.rings.partition_point(|ring| ring.inside <= cell) - 1;
                let share = f64::from(b - a) / f64::from(disk.rings[ring].sectors);
                assert!(
                    (share * f64::from(cells) - 1.0).abs() < 1e-2,
                    "{cells}: cell {cell} has {share} of the circle"
                );
            }
        }
    }

    #[test]
    fn cells_are_about_squares() {
        let disk = EqualAreaDisk::new(4096);
        for pair in disk.rings.windows(2) {
            let radius = |cells: u32| (f64::from(cells) / 4096.0).sqrt();
            let (inner, outer) = (radius(pair[0].inside), radius(pair[1].inside));
            let width = PI * (inner + outer) / f64::from(pair[0].sectors);
            let ratio = width / (outer - inner);
            assert!(
                (0.7..1.45).contains(&ratio) || pair[0].inside < 10,
                "sectors are {ratio} as wide as long, {} cells inside",
                pair[0].inside
            );
        }
    }

    #[test]
    fn points_of_cells_follow_the_cosine() {
        let disk = EqualAreaDisk::new(5000);
        let heights = (0..5000).map(|cell| {
            let [x, y] = disk.point(cell, [0.5, 0.5]);
            f64::from(1.0 - x * x - y * y).max(0.0).sqrt()
        });
        let mean = heights.sum::<f64>() / 5000.0;
        assert!(
            (mean - 2.0 / 3.0).abs() < 1e-3,
            "mean cosine {mean} of density cos θ / π is 2/3"
        );
    }
}
