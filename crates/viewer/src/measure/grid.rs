//! A calculation grid on a surface: irradiance gathered at points in rows and columns.

use crate::measure::Reading;
use crate::session::background_pool;
use core::fmt::Write;
use glam::Vec3;
use hemicube_radiosity::patch::face::Side;
use hemicube_radiosity::{GatherOptions, Gatherer, PatchMesh, Solution};
use hemicube_raster::Rgb;
use hemicube_scene::Units;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

/// How fine a grid is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridOptions {
    /// Points along the longer side of the surface, from 2 to 200. Default value: 15.
    pub points: usize,
    /// Share of the shorter side that is left out along all borders, below one half. Default value: 0.
    pub margin: f32,
    /// Rays of each point. Default value: 1024.
    pub rays: u32,
}

impl Default for GridOptions {
    fn default() -> Self {
        Self {
            points: 15,
            margin: 0.0,
            rays: 1024,
        }
    }
}

/// A point of a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridPoint {
    /// Column and row.
    pub cell: [usize; 2],
    /// Where, in world units.
    pub point: Vec3,
    /// lx or W/m².
    pub irradiance: Rgb,
    /// lx.
    pub illuminance: f32,
}

/// Irradiance at points of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Name of the node that it lies on.
    pub surface: String,
    /// Unit normal of the side that is measured.
    pub normal: Vec3,
    /// Columns and rows of the rectangle around the surface.
    pub size: [usize; 2],
    /// What the numbers mean.
    pub units: Units,
    /// Points that lie on the surface.
    pub points: Vec<GridPoint>,
}

/// What lighting reports say of a grid, in lx.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    /// Least illuminance.
    pub minimum: f32,
    /// Mean illuminance.
    pub average: f32,
    /// Most illuminance.
    pub maximum: f32,
}

impl Statistics {
    /// `U0 = minimum / average` (EN 12464-1); 0 where nothing falls.
    pub fn uniformity(&self) -> f32 {
        if self.average > 0.0 {
            self.minimum / self.average
        } else {
            0.0
        }
    }

    /// `Ud = minimum / maximum`; 0 where nothing falls.
    pub fn diversity(&self) -> f32 {
        if self.maximum > 0.0 {
            self.minimum / self.maximum
        } else {
            0.0
        }
    }
}

impl Grid {
    /// Minimum, average and maximum; `None` without points.
    pub fn statistics(&self) -> Option<Statistics> {
        let values = || self.points.iter().map(|point| point.illuminance);
        let sum: f64 = values().map(f64::from).sum();
        (!self.points.is_empty()).then(|| Statistics {
            minimum: values().fold(f32::INFINITY, f32::min),
            #[expect(clippy::cast_possible_truncation, reason = "a mean of f32")]
            average: (sum / self.points.len() as f64) as f32,
            maximum: values().fold(0.0, f32::max),
        })
    }

    /// A table of all points, with the columns that `hemicube measure` reads and writes, and column and row before them.
    pub fn csv(&self) -> String {
        let mut text = String::from(
            "column,row,x,y,z,nx,ny,nz,irradiance_r,irradiance_g,irradiance_b,illuminance\n",
        );
        for p in &self.points {
            let ([column, row], at, n, h) = (p.cell, p.point, self.normal, p.irradiance);
            writeln!(
                text,
                "{column},{row},{},{},{},{},{},{},{},{},{},{}",
                at.x, at.y, at.z, n.x, n.y, n.z, h.r, h.g, h.b, p.illuminance
            )
            .expect("text grows");
        }
        text
    }
}

/// A grid that is being measured on threads of its own.
pub struct GridJob {
    done: Arc<AtomicUsize>,
    count: usize,
    is_cancelled: Arc<AtomicBool>,
    result: Arc<Mutex<Option<Grid>>>,
}

impl GridJob {
    /// Starts on the flat surface under a reading: all faces of that node in that plane.
    pub fn start(
        solution: Arc<Solution>,
        reading: &Reading,
        options: GridOptions,
        wake: impl Fn() + Send + 'static,
    ) -> Self {
        let layout = Layout::new(solution.mesh(), reading, options);
        let job = Self {
            done: Arc::default(),
            count: layout.places.len(),
            is_cancelled: Arc::default(),
            result: Arc::default(),
        };
        let (done, cancelled, result) = (
            job.done.clone(),
            job.is_cancelled.clone(),
            job.result.clone(),
        );
        std::thread::spawn(move || {
            let grid =
                background_pool().install(|| layout.measure(&solution, options, &done, &cancelled));
            *crate::session::lock(&result) = grid;
            wake();
        });
        job
    }

    /// Share of the points that are done.
    pub fn progress(&self) -> f32 {
        self.done.load(Ordering::Relaxed) as f32 / self.count.max(1) as f32
    }

    /// The grid, once, when it is there.
    pub fn take(&self) -> Option<Grid> {
        crate::session::lock(&self.result).take()
    }
}

impl Drop for GridJob {
    fn drop(&mut self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }
}

/// Where points lie.
struct Layout {
    surface: String,
    normal: Vec3,
    size: [usize; 2],
    places: Vec<([usize; 2], Vec3)>,
}

impl Layout {
    fn new(mesh: &PatchMesh, reading: &Reading, options: GridOptions) -> Self {
        let faces = coplanar(mesh, reading);
        let [right, down] = axes(mesh, &faces, reading.normal);
        let corners = || faces.iter().flat_map(|&face| mesh.faces()[face].polygon());
        let span = |axis: Vec3| {
            let along = corners().map(|corner| corner.dot(axis));
            along.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], x| {
                [low.min(x), high.max(x)]
            })
        };
        let spans = [span(right), span(down)];
        let lengths = spans.map(|[low, high]| high - low);
        let margin = options.margin.clamp(0.0, 0.49) * lengths[0].min(lengths[1]);
        let longest = lengths[0].max(lengths[1]) - 2.0 * margin;
        let spacing = longest / options.points.clamp(2, 200) as f32;
        let size = lengths.map(|length| count(((length - 2.0 * margin) / spacing).round()));
        let place = |column: usize, row: usize| {
            let at = |axis: usize, i: usize| {
                let [low, high] = spans[axis];
                let share = (i as f32 + 0.5) / size[axis] as f32;
                low + margin + share * (high - low - 2.0 * margin)
            };
            right * at(0, column)
                + down * at(1, row)
                + reading.normal * reading.point.dot(reading.normal)
        };
        let all = (0..size[1]).flat_map(|row| (0..size[0]).map(move |column| [column, row]));
        let places = all.map(|cell| (cell, place(cell[0], cell[1])));
        Self {
            surface: mesh.scene().instances[reading.instance].node.clone(),
            normal: reading.normal,
            size,
            places: places
                .filter(|(_, at)| lies_on(mesh, &faces, *at))
                .collect(),
        }
    }

    fn measure(
        self,
        solution: &Solution,
        options: GridOptions,
        done: &AtomicUsize,
        cancelled: &AtomicBool,
    ) -> Option<Grid> {
        let gatherer = Gatherer::new(
            solution,
            GatherOptions {
                rays: options.rays,
                ..GatherOptions::default()
            },
        );
        let units = solution.mesh().scene().units;
        let measure = |&(cell, point): &([usize; 2], Vec3)| {
            if cancelled.load(Ordering::Relaxed) {
                return None;
            }
            let irradiance = gatherer.irradiance(point, self.normal);
            done.fetch_add(1, Ordering::Relaxed);
            Some(GridPoint {
                cell,
                point,
                irradiance,
                illuminance: units.illuminance(irradiance),
            })
        };
        let points: Option<Vec<GridPoint>> = self.places.par_iter().map(measure).collect();
        Some(Grid {
            points: points?,
            surface: self.surface,
            normal: self.normal,
            size: self.size,
            units,
        })
    }
}

/// All faces of the reading's node that lie in its plane and look its way.
fn coplanar(mesh: &PatchMesh, reading: &Reading) -> Vec<usize> {
    let front = if reading.side == Side::Front {
        1.0
    } else {
        -1.0
    };
    let height = reading.point.dot(reading.normal);
    let slack = 2.0 * mesh.visibility().offset(reading.point);
    let is_in_plane = |&face: &usize| {
        let other = &mesh.faces()[face];
        other.instance as usize == reading.instance
            && (other.normal * front).dot(reading.normal) > 0.9999
            && other
                .polygon()
                .iter()
                .all(|p| (p.dot(reading.normal) - height).abs() < slack)
    };
    let mut faces: Vec<usize> = (0..mesh.faces().len()).filter(is_in_plane).collect();
    if faces.is_empty() {
        faces.push(reading.face);
    }
    faces
}

/// Directions of columns and rows: along the longest edge of the surface.
fn axes(mesh: &PatchMesh, faces: &[usize], normal: Vec3) -> [Vec3; 2] {
    let edges = faces.iter().flat_map(|&face| {
        let polygon = mesh.faces()[face].polygon();
        (0..polygon.len()).map(move |i| polygon[(i + 1) % polygon.len()] - polygon[i])
    });
    let longest = edges.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    let right = longest
        .and_then(|edge| edge.reject_from_normalized(normal).try_normalize())
        .unwrap_or_else(|| normal.any_orthonormal_vector());
    [right, normal.cross(right)]
}

/// Whether a point of the plane lies inside one of the faces.
fn lies_on(mesh: &PatchMesh, faces: &[usize], point: Vec3) -> bool {
    let is_inside = |&face: &usize| {
        let face = &mesh.faces()[face];
        let polygon = face.polygon();
        let mut edges = (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]));
        edges.all(|(a, b)| (b - a).cross(point - a).dot(face.normal) >= 0.0)
    };
    faces.iter().any(is_inside)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 1 to 200"
)]
fn count(points: f32) -> usize {
    points.clamp(1.0, 200.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::Light;
    use crate::measure::read_along;
    use hemicube_radiosity::{Quality, solve};
    use hemicube_scene::builtin;
    use std::time::{Duration, Instant};

    fn measured(reading: &Reading, solution: &Arc<Solution>, options: GridOptions) -> Grid {
        let job = GridJob::start(solution.clone(), reading, options, || {});
        let begin = Instant::now();
        loop {
            if let Some(grid) = job.take() {
                assert!((job.progress() - 1.0).abs() < 1e-6, "all points are done");
                return grid;
            }
            assert!(begin.elapsed() < Duration::from_secs(60), "it ends");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn furnace() -> (Arc<Solution>, Reading) {
        let scene = Arc::new(builtin::furnace_with(0.5, 1.0));
        let solution = solve(scene, &Quality::Draft.into(), |_, _| true).expect("it can be solved");
        let light = Light::new(&solution, &[Rgb::WHITE]);
        let (low, high) = solution.mesh().scene().bounds().expect("it has faces");
        let reading = read_along(solution.mesh(), &light, 0.5 * (low + high), Vec3::NEG_Y);
        (Arc::new(solution), reading.expect("it is closed"))
    }

    #[test]
    fn a_furnace_is_uniform() {
        let (solution, reading) = furnace();
        let options = GridOptions {
            points: 6,
            margin: 0.1,
            rays: 256,
        };
        let grid = measured(&reading, &solution, options);
        assert_eq!(grid.size, [6, 6], "its floor is a square");
        assert_eq!(grid.points.len(), 36, "and all points lie on it");
        let statistics = grid.statistics().expect("it has points");
        assert!(
            (statistics.average / 179.0 - 2.0).abs() < 0.05,
            "H = E / (1 - ρ): {statistics:?}"
        );
        assert!(
            statistics.uniformity() > 0.97 && statistics.diversity() > 0.95,
            "{statistics:?}"
        );
        let csv = grid.csv();
        assert_eq!(csv.lines().count(), 37, "a line for each and a head");
        assert!(
            csv.lines()
                .nth(1)
                .is_some_and(|line| line.starts_with("0,0,") && line.split(',').count() == 12),
            "{csv}"
        );
    }

    #[test]
    fn statistics_of_known_numbers() {
        let (solution, reading) = furnace();
        let mut grid = measured(
            &reading,
            &solution,
            GridOptions {
                points: 2,
                rays: 16,
                ..GridOptions::default()
            },
        );
        for (point, lux) in grid.points.iter_mut().zip([100.0, 200.0, 300.0, 400.0]) {
            point.illuminance = lux;
        }
        let statistics = grid.statistics().expect("four points");
        assert_eq!(
            (statistics.minimum, statistics.average, statistics.maximum),
            (100.0, 250.0, 400.0),
            "of four"
        );
        assert_eq!(
            (statistics.uniformity(), statistics.diversity()),
            (0.4, 0.25),
            "EN 12464-1"
        );
        grid.points.clear();
        assert_eq!(grid.statistics(), None, "of none");
    }
}
