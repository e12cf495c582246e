//! The solvent-accessible surface of a molecule: where the centre of a water molecule can be (Lee and Richards 1971).
//!
//! It is the surface of a union of balls, `R_i = r_i + 1.4 Å` around each atom. With `f(p) = min_i |p - c_i| - R_i` it
//! is `f = 0`: a grid of f finds the cells that it crosses, each of them gets one corner of the mesh, at the mean of
//! where it crosses the cell's edges (surface nets; Gibson 1998). The corner is moved onto the balls to which these
//! places belong: in a groove between balls onto all of them, so that the mesh follows the groove (as in dual
//! contouring; Ju et al. 2002).

use super::pqr::Atom;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Radius of a water molecule, Å.
pub const PROBE: f64 = 1.4;

/// Balls, sorted into cells so that those near a point are found at once.
#[derive(Debug, Clone)]
pub struct Balls {
    balls: Vec<Ball>,
    low: DVec3,
    high: DVec3,
    /// Side of a cell: a ball that reaches a point near the surface has its centre in one of the 27 cells around it.
    cell: f64,
    counts: [usize; 3],
    /// First ball of each cell, and one more.
    starts: Vec<u32>,
}

/// Where the centre of the probe cannot be.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ball {
    centre: DVec3,
    radius: f64,
}

impl Ball {
    /// Distance from its surface, negative inside.
    fn off(&self, point: DVec3) -> f64 {
        point.distance(self.centre) - self.radius
    }

    /// The nearest point of its surface.
    fn projected(&self, point: DVec3) -> DVec3 {
        self.centre + (point - self.centre).normalize_or(DVec3::X) * self.radius
    }
}

/// How near to the surface corners lie, Å.
const PRECISION: f64 = 1e-5;

/// Steps after which a corner stays where it is.
const STEPS: usize = 32;

/// A point moved onto all of some balls in turns, until it lies on each: into the groove between them.
fn onto_all(start: DVec3, balls: &[&Ball]) -> DVec3 {
    let mut point = start;
    for _ in 0..STEPS {
        point = balls.iter().fold(point, |p, ball| ball.projected(p));
    }
    point
}

/// A mesh, corners in Å.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
}

/// The most cells of either grid.
const MOST_CELLS: f64 = 8e6;

/// More atoms than any matter has in a cell: each of them would be compared with all the others.
const CROWD: u32 = 1000;

/// The coarsest mesh that shows atoms, Å.
const COARSEST: f64 = 1.0;

impl Balls {
    /// Around all atoms that have a radius. An error, in one line, if they lie so far apart that no grid can hold
    /// them.
    pub fn new(atoms: &[Atom]) -> Result<Self, String> {
        let with_radius = atoms.iter().filter(|a| a.radius > 0.0);
        let balls: Vec<Ball> = with_radius
            .map(|a| Ball {
                centre: a.centre,
                radius: a.radius + PROBE,
            })
            .collect();
        let bounds = |reach: fn(&Ball) -> f64| {
            let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            balls.iter().fold(start, |(low, high), b| {
                (low.min(b.centre - reach(b)), high.max(b.centre + reach(b)))
            })
        };
        let (low, high) = bounds(|b| b.radius);
        let size = high - low;
        if size.element_product() > MOST_CELLS * COARSEST.powi(3) {
            return Err(format!(
                "a box of {:.0} x {:.0} x {:.0} Å around the atoms; give a smaller part of the molecule",
                size.x, size.y, size.z
            ));
        }
        let largest = balls.iter().map(|b| b.radius).fold(0.0, f64::max);
        let sorted = Self::sorted(balls, [low, high], largest + COARSEST);
        let counts = sorted.starts.windows(2).map(|pair| pair[1] - pair[0]);
        match counts.max() {
            Some(count @ CROWD..) => Err(format!(
                "{count} atoms in a cube of {:.1} Å; this is no molecule",
                sorted.cell
            )),
            _ => Ok(sorted),
        }
    }

    fn sorted(mut balls: Vec<Ball>, [low, high]: [DVec3; 2], cell: f64) -> Self {
        let counts = ((high - low) / cell).to_array().map(|n| floor(n) + 1);
        let mut sorted = Self {
            balls: Vec::new(),
            low,
            high,
            cell,
            counts,
            starts: vec![0; counts.iter().product::<usize>() + 1],
        };
        let measures = |b: &Ball| [b.centre.x, b.centre.y, b.centre.z, b.radius];
        let by_measures = |a: &Ball, b: &Ball| {
            let pairs = measures(a).into_iter().zip(measures(b));
            pairs.map(|(a, b)| a.total_cmp(&b)).find(|o| o.is_ne())
        };
        balls.sort_by(|a, b| {
            let by_cell = sorted.cell_of(a.centre).cmp(&sorted.cell_of(b.centre));
            by_cell.then(by_measures(a, b).unwrap_or(core::cmp::Ordering::Equal))
        });
        // Of atoms on each other one has a surface.
        balls.dedup();
        for ball in &balls {
            let cell = sorted.cell_of(ball.centre);
            sorted.starts[cell + 1] += 1;
        }
        for i in 1..sorted.starts.len() {
            sorted.starts[i] += sorted.starts[i - 1];
        }
        sorted.balls = balls;
        sorted
    }

    fn place(&self, point: DVec3) -> [usize; 3] {
        let place = ((point - self.low) / self.cell).to_array();
        [0, 1, 2].map(|axis| floor(place[axis]).min(self.counts[axis] - 1))
    }

    fn cell_of(&self, point: DVec3) -> usize {
        let [i, j, k] = self.place(point);
        (i * self.counts[1] + j) * self.counts[2] + k
    }

    /// The balls with their centres in the 27 cells around a point, in an order that is always the same.
    fn near(&self, point: DVec3) -> impl Iterator<Item = &Ball> {
        let [i, j, k] = self.place(point);
        let around = |at: usize, n: usize| at.saturating_sub(1)..(at + 2).min(n);
        let [_, ny, nz] = self.counts;
        around(i, self.counts[0])
            .flat_map(move |i| around(j, ny).map(move |j| (i * ny + j) * nz))
            .flat_map(move |row| {
                let cells = around(k, nz);
                let (first, last) = (self.starts[row + cells.start], self.starts[row + cells.end]);
                &self.balls[first as usize..last as usize]
            })
    }

    /// The ball whose surface is nearest to a point near the surface of all, inside of it or outside.
    fn nearest(&self, point: DVec3) -> Option<&Ball> {
        self.near(point)
            .min_by(|a, b| a.off(point).total_cmp(&b.off(point)))
    }

    /// Outward normal at a point of the surface, exact; 0 far from it.
    pub fn normal(&self, point: DVec3) -> DVec3 {
        self.nearest(point)
            .map_or(DVec3::ZERO, |b| (point - b.centre).normalize_or_zero())
    }

    /// A point moved onto the surface: into the groove between some balls if there is one within `reach`, else onto
    /// the nearest ball.
    fn projected(&self, start: DVec3, owners: &[&Ball], reach: f64) -> DVec3 {
        let groove = onto_all(start, owners);
        let off = |p: DVec3| self.nearest(p).map_or(0.0, |b| b.off(p));
        if start.distance(groove) <= reach && off(groove).abs() < PRECISION {
            return groove;
        }
        let mut point = start;
        for _ in 0..STEPS {
            match self.nearest(point) {
                Some(ball) if ball.off(point).abs() >= PRECISION => point = ball.projected(point),
                _ => break,
            }
        }
        point
    }

    /// Area in Å² by counting: of so many points on each ball, spread evenly, those that no other ball contains
    /// (Shrake and Rupley 1973).
    pub fn counted_area(&self, points: u32) -> f64 {
        let area = |ball: &Ball| {
            let is_free = |i: &u32| {
                let p = ball.centre + spread(*i, points) * ball.radius;
                self.near(p).all(|other| {
                    other == ball || p.distance_squared(other.centre) >= other.radius.powi(2)
                })
            };
            let free = (0..points).filter(is_free).count() as f64;
            4.0 * core::f64::consts::PI * ball.radius.powi(2) * free / f64::from(points)
        };
        // Collected before it is summed, so that the sum does not depend on threads.
        let areas: Vec<f64> = self.balls.par_iter().map(area).collect();
        areas.iter().sum()
    }

    /// The surface as a mesh with edges of about `spacing` Å, or longer ones for a large molecule.
    pub fn mesh(&self, spacing: f64) -> Mesh {
        let volume = (self.high - self.low).element_product();
        let spacing = spacing.max((volume / MOST_CELLS).cbrt());
        Field::new(self, spacing).mesh()
    }
}

/// Point `i` of `n` on the unit sphere: a spiral of equal areas, turned by the golden angle at each step.
fn spread(i: u32, n: u32) -> DVec3 {
    let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(n);
    let angle = f64::from(i) * core::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let rho = (1.0 - z * z).sqrt();
    DVec3::new(rho * angle.cos(), rho * angle.sin(), z)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "grids have few million cells"
)]
fn floor(x: f64) -> usize {
    x.max(0.0) as usize
}

/// f at the points of a grid around the balls.
struct Field<'a> {
    balls: &'a Balls,
    origin: DVec3,
    spacing: f64,
    counts: [usize; 3],
    values: Vec<f32>,
}

/// A cell without a corner of the mesh.
const NONE: u32 = u32::MAX;

impl<'a> Field<'a> {
    /// Each ball enters its own neighbourhood: near the surface f is exact, elsewhere it has the right sign.
    fn new(balls: &'a Balls, spacing: f64) -> Self {
        let origin = balls.low - 1.5 * spacing;
        let size = (balls.high - balls.low) / spacing + 3.0;
        let counts = size.to_array().map(|n| floor(n.ceil()) + 1);
        let mut field = Self {
            balls,
            origin,
            spacing,
            counts,
            values: vec![f32::INFINITY; counts.iter().product()],
        };
        for ball in &balls.balls {
            field.enter(ball);
        }
        field
    }

    fn enter(&mut self, ball: &Ball) {
        let reach = ball.radius + 2.0 * self.spacing;
        let low = ((ball.centre - reach - self.origin) / self.spacing).to_array();
        let high = ((ball.centre + reach - self.origin) / self.spacing).to_array();
        let range = |axis: usize| floor(low[axis])..(floor(high[axis]) + 1).min(self.counts[axis]);
        for i in range(0) {
            for j in range(1) {
                for k in range(2) {
                    let off = self.point([i, j, k]).distance(ball.centre) - ball.radius;
                    let index = self.index([i, j, k]);
                    #[expect(
                        clippy::cast_possible_truncation,
                        reason = "only its sign must be exact"
                    )]
                    let off = off as f32;
                    self.values[index] = self.values[index].min(off);
                }
            }
        }
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (i * self.counts[1] + j) * self.counts[2] + k
    }

    fn point(&self, [i, j, k]: [usize; 3]) -> DVec3 {
        self.origin + DVec3::new(i as f64, j as f64, k as f64) * self.spacing
    }

    fn mesh(&self) -> Mesh {
        let mut corner_of_cell = vec![NONE; self.values.len()];
        let mut starts = Vec::new();
        let cells = self.counts.map(|n| n - 1);
        for cell in places(cells) {
            let crossings = self.crossings(cell);
            if !crossings.is_empty() {
                corner_of_cell[self.index(cell)] =
                    u32::try_from(starts.len()).expect("few million cells");
                starts.push(crossings);
            }
        }
        let project = |crossings: Vec<DVec3>| self.corner(&crossings).as_vec3();
        let positions: Vec<Vec3> = starts.into_par_iter().map(project).collect();
        let triangles = self.triangles(&corner_of_cell, &positions);
        Mesh {
            positions,
            triangles,
        }
    }

    /// Where the surface crosses the edges of a cell; nowhere in most.
    fn crossings(&self, cell: [usize; 3]) -> Vec<DVec3> {
        let corner = |bits: usize| [0, 1, 2].map(|axis| cell[axis] + (bits >> axis & 1));
        let value = |bits: usize| f64::from(self.values[self.index(corner(bits))]);
        let mut crossings = Vec::new();
        for from in 0..8 {
            for axis in 0..3 {
                let to = from | 1 << axis;
                let (a, b) = (value(from), value(to));
                if to != from && (a < 0.0) != (b < 0.0) {
                    // Infinite values lie far from the surface, and never beside a negative one.
                    let t = a / (a - b);
                    crossings.push(self.point(corner(from)).lerp(self.point(corner(to)), t));
                }
            }
        }
        crossings
    }

    /// The corner of the mesh in a cell with these crossings.
    fn corner(&self, crossings: &[DVec3]) -> DVec3 {
        let mean = crossings.iter().sum::<DVec3>() / crossings.len() as f64;
        let mut owners: Vec<&Ball> = Vec::new();
        for ball in crossings.iter().filter_map(|&p| self.balls.nearest(p)) {
            if !owners.contains(&ball) {
                owners.push(ball);
            }
        }
        self.balls.projected(mean, &owners, self.spacing)
    }

    /// Two triangles for each edge of the grid that is crossed, between the corners of the four cells around it,
    /// anticlockwise seen from outside.
    fn triangles(&self, corner_of_cell: &[u32], positions: &[Vec3]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        for place in places(self.counts.map(|n| n - 1)) {
            for axis in 0..3 {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut next = place;
                next[axis] += 1;
                let is_inside = |p| self.values[self.index(p)] < 0.0;
                if is_inside(place) == is_inside(next) || place[u] == 0 || place[v] == 0 {
                    continue;
                }
                let cell = |du: usize, dv: usize| {
                    let mut cell = place;
                    cell[u] -= du;
                    cell[v] -= dv;
                    corner_of_cell[self.index(cell)]
                };
                let mut quad = [cell(1, 1), cell(0, 1), cell(0, 0), cell(1, 0)];
                if !is_inside(place) {
                    quad.reverse();
                }
                triangles.extend(split(quad, positions));
            }
        }
        triangles
    }
}

/// A quadrilateral cut along its shorter diagonal.
fn split([a, b, c, d]: [u32; 4], positions: &[Vec3]) -> [[u32; 3]; 2] {
    let length = |i: u32, j: u32| positions[i as usize].distance_squared(positions[j as usize]);
    if length(a, c) <= length(b, d) {
        [[a, b, c], [a, c, d]]
    } else {
        [[a, b, d], [b, c, d]]
    }
}

/// All places of a grid, the last index fastest.
fn places([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..nx).flat_map(move |i| (0..ny).flat_map(move |j| (0..nz).map(move |k| [i, j, k])))
}

impl Mesh {
    /// Sum of the areas of its triangles, Å².
    pub fn area(&self) -> f64 {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| self.positions[i as usize].as_dvec3());
            0.5 * (b - a).cross(c - a).length()
        };
        self.triangles.iter().map(area).sum()
    }
}

#[cfg(test)]
mod tests;
