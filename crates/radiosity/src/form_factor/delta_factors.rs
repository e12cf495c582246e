//! The faces onto which hemicubes and their like project, and the share of light that passes each of their cells.

use crate::error::RadiosityError;
use crate::form_factor::nusselt::contour_factor;
use core::f64::consts::PI;
use core::ops::Range;
use glam::{DVec3, Vec3, Vec4};
use hemicube_raster::triangle::Viewport;

/// What the hemisphere over a point is projected onto.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Projection {
    /// Half a cube: five faces, all light (Cohen, Greenberg 1985).
    #[default]
    Hemicube,
    /// The corner of a cube that stands on its tip: three triangles, all light (Beran-Koehn, Pavicic 1991, *A cubic
    /// tetrahedral adaptation of the hemi-cube algorithm*). Half as many cells as a hemicube of the same resolution, the
    /// largest factor 3.0 times the mean one; of the hemicube it is 3.8 times.
    CubicTetrahedron,
    /// One square that is 16 times as wide as it is high above the patch: 98.7 % of all light; the rest, near the patch's
    /// plane, counts as if it went where that goes (Sillion, Puech 1989). A third of the hemicube's cells, wide ones in the
    /// middle.
    SinglePlane,
}

impl Projection {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Hemicube, Self::CubicTetrahedron, Self::SinglePlane];

    /// Its faces.
    pub fn faces(self) -> &'static [CubeFace] {
        match self {
            Self::Hemicube => &CubeFace::ALL,
            Self::CubicTetrahedron => &[
                CubeFace::Corner(0),
                CubeFace::Corner(1),
                CubeFace::Corner(2),
            ],
            Self::SinglePlane => &[CubeFace::Plane],
        }
    }

    /// Cells that light passes, for so many along an edge.
    pub fn cells(self, resolution: u32) -> f64 {
        let square = f64::from(resolution) * f64::from(resolution);
        match self {
            Self::Hemicube => 3.0 * square,
            Self::CubicTetrahedron => 1.5 * square,
            Self::SinglePlane => square,
        }
    }

    /// How far a point at distance 1 that can be seen is at least before the plane of the eye of one of the faces.
    pub(super) fn least_depth(self) -> f32 {
        match self {
            // 1/√3, towards a corner.
            Self::Hemicube => 0.57,
            // 1/√6, towards a corner.
            Self::CubicTetrahedron => 0.4,
            // 1/√(1 + 2 · 8²), towards a corner.
            Self::SinglePlane => 0.088,
        }
    }
}

/// Half the width of the single plane over its height.
const REACH: f32 = 8.0;

/// A face of a hemicube or of what takes its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CubeFace {
    /// Opposite the patch.
    Top,
    /// One of the four halves of sides, numbered in the sense of rotation around the normal.
    Side(u8),
    /// One of the three faces of the cubic tetrahedron: the upper right half of a square.
    Corner(u8),
    /// The single plane.
    Plane,
}

impl CubeFace {
    /// The five of a hemicube.
    pub const ALL: [Self; 5] = [
        Self::Top,
        Self::Side(0),
        Self::Side(1),
        Self::Side(2),
        Self::Side(3),
    ];

    /// Its place among the faces of its projection.
    pub(super) fn number(self) -> usize {
        match self {
            Self::Top | Self::Plane => 0,
            Self::Side(side) => 1 + usize::from(side),
            Self::Corner(number) => usize::from(number),
        }
    }

    /// Its cells, for so many along an edge of the top.
    pub fn viewport(self, resolution: usize) -> Viewport {
        match self {
            Self::Top | Self::Corner(_) | Self::Plane => Viewport::new(resolution, resolution),
            Self::Side(_) => Viewport::new(resolution, resolution / 2),
        }
    }

    /// Clip-space position of a point in the frame of the hemicube (x, y in the patch's plane, z along its normal).
    ///
    /// Of the sides only the upper half is in the picture, which is where the patch's plane clips.
    pub(super) fn clip(self, p: Vec3, near: f32) -> Vec4 {
        // Pictures are seen from inside, so right = forward × up.
        let (right, up, forward) = match self {
            Self::Top => (-p.x, p.y, p.z),
            Self::Plane => (-p.x / REACH, p.y / REACH, p.z),
            Self::Side(0) => (-p.y, p.z, p.x),
            Self::Side(1) => (p.x, p.z, p.y),
            Self::Side(2) => (p.y, p.z, -p.x),
            Self::Side(_) => (-p.x, p.z, -p.y),
            Self::Corner(number) => return corner_clip(number, p, near),
        };
        let up = if matches!(self, Self::Side(_)) {
            2.0 * up - forward
        } else {
            up
        };
        Vec4::new(right, up, forward - near, forward)
    }
}

/// Of the cubic tetrahedron the edges at the tip are the axes, the normal is (1, 1, 1)/√3. A face at 1 before the eye takes up
/// the triangle (1, 1), (1, -2), (-2, 1), half of the square from -2 to 1.
fn corner_clip(number: u8, p: Vec3, near: f32) -> Vec4 {
    let edges = [
        Vec3::new(0.816_496_6, 0.0, 0.577_350_26),
        Vec3::new(-0.408_248_3, 0.707_106_77, 0.577_350_26),
        Vec3::new(-0.408_248_3, -0.707_106_77, 0.577_350_26),
    ];
    let along = |k: u8| p.dot(edges[usize::from((number + k) % 3)]);
    let (forward, right, up) = (along(0), along(1), along(2));
    let centred = |x: f32| (2.0 * x + forward) / 3.0;
    Vec4::new(centred(right), centred(up), forward - near, forward)
}

/// Delta form factors of all cells of a hemicube: the share of the light of a diffuse point that passes through each.
///
/// By symmetry a quarter of the top and half of a side stand for all.
#[derive(Debug, Clone, PartialEq)]
pub struct DeltaFactors {
    half: usize,
    /// Of a quarter of the top or of the single plane, row by row from the centre outwards: sums over the cells before
    /// each column and over all of them. Sums, because most cells see what their neighbours see: a run of them costs
    /// what one does.
    top: Vec<f64>,
    /// Of half a side, row by row upwards from the patch's plane, from the middle outwards: the same.
    side: Vec<f64>,
    /// Of a face of the cubic tetrahedron, row by row from above: the same from the left.
    corner: Vec<f64>,
}

/// A row of cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct DeltaRow<'a> {
    /// Sums over the cells before each column and over all of them, of the right half if the left one mirrors it.
    sums: &'a [f64],
    is_mirrored: bool,
}

impl DeltaRow<'_> {
    /// Sum of the factors in some columns, counted from the left.
    pub(super) fn of(self, columns: Range<usize>) -> f64 {
        self.up_to(columns.end) - self.up_to(columns.start)
    }

    /// From the left, or of a mirrored row from the middle, to the left border of a column; negative left of the middle.
    fn up_to(self, column: usize) -> f64 {
        if !self.is_mirrored {
            return self.sums[column];
        }
        let half = self.sums.len() - 1;
        if column < half {
            -self.sums[half - column]
        } else {
            self.sums[column - half]
        }
    }
}

impl DeltaFactors {
    /// The factors of a hemicube for so many cells along an edge.
    ///
    /// # Errors
    /// A resolution that is odd or not from 16 to 4096.
    pub fn new(resolution: u32) -> Result<Self, RadiosityError> {
        Self::of(Projection::Hemicube, resolution)
    }

    /// The factors of a projection for so many cells along an edge.
    ///
    /// # Errors
    /// A resolution that is odd or not from 16 to 4096.
    pub fn of(projection: Projection, resolution: u32) -> Result<Self, RadiosityError> {
        if !(16..=4096).contains(&resolution) || resolution % 2 == 1 {
            return Err(RadiosityError::Option(format!(
                "hemicube resolution {resolution} is not an even number from 16 to 4096"
            )));
        }
        let cells = resolution as usize;
        let half = cells / 2;
        let unit = |i: usize| i as f64 / half as f64;
        let (mut top, mut side, mut corner) = (Vec::new(), Vec::new(), Vec::new());
        match projection {
            Projection::Hemicube => {
                top = table(half, |i, j| above(unit(i), unit(j)));
                side = table(half, |i, j| beside(unit(i), unit(j)));
            }
            Projection::CubicTetrahedron => corner = corner_table(cells),
            Projection::SinglePlane => {
                let reach = f64::from(REACH);
                top = table(half, |i, j| above(reach * unit(i), reach * unit(j)));
            }
        }
        // The closed forms sum to 1 but for rounding, which grows with the number of cells; and for what the plane misses.
        let sum =
            4.0 * by_rows(&top, half) + 8.0 * by_rows(&side, half) + 3.0 * by_rows(&corner, cells);
        let all = top.iter_mut().chain(&mut side).chain(&mut corner);
        all.for_each(|delta| *delta /= sum);
        Ok(Self {
            half,
            top: running_sums(&top, half),
            side: running_sums(&side, half),
            corner: running_sums(&corner, cells),
        })
    }

    /// The factor of one cell; columns count from the left and rows from above.
    pub fn at(&self, face: CubeFace, column: usize, row: usize) -> f64 {
        self.row(face, row).of(column..column + 1)
    }

    /// The running sums of a quarter of the top, row by row from the middle outwards, then those of half a side, from the
    /// patch's plane upwards: 0 and the sum up to each of the half row's cells, from the middle outwards.
    pub fn running_sums(&self) -> impl Iterator<Item = f64> + '_ {
        self.top.iter().chain(&self.side).copied()
    }

    /// Sum over all cells of all faces: 1.
    pub fn sum(&self) -> f64 {
        let total =
            |table: &[f64], len: usize| -> f64 { table.chunks(len).map(|row| row[len - 1]).sum() };
        let (half, whole) = (self.half + 1, 2 * self.half + 1);
        4.0 * total(&self.top, half)
            + 8.0 * total(&self.side, half)
            + 3.0 * total(&self.corner, whole)
    }

    /// A row of cells, counted from above.
    pub(super) fn row(&self, face: CubeFace, row: usize) -> DeltaRow<'_> {
        if matches!(face, CubeFace::Corner(_)) {
            let len = 2 * self.half + 1;
            return DeltaRow {
                sums: &self.corner[row * len..(row + 1) * len],
                is_mirrored: false,
            };
        }
        let (table, from_centre) = match face {
            CubeFace::Side(_) => (&self.side, self.half - 1 - row),
            _ if row >= self.half => (&self.top, row - self.half),
            _ => (&self.top, self.half - 1 - row),
        };
        let len = self.half + 1;
        DeltaRow {
            sums: &table[from_centre * len..(from_centre + 1) * len],
            is_mirrored: true,
        }
    }
}

/// `∫∫` over each of `cells`² cells from an antiderivative at the corners of the grid, row by row.
fn table(cells: usize, antiderivative: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let row = |j: usize| -> Vec<f64> { (0..=cells).map(|i| antiderivative(i, j)).collect() };
    let mut table = Vec::with_capacity(cells * cells);
    let mut low = row(0);
    for j in 0..cells {
        let high = row(j + 1);
        table.extend((0..cells).map(|i| (high[i + 1] - high[i]) - (low[i + 1] - low[i])));
        low = high;
    }
    table
}

/// Factors of the cells of a face of the cubic tetrahedron: of the upper right half of the square, and of the upper right
/// halves of the cells on the diagonal; 0 in the lower left.
fn corner_table(cells: usize) -> Vec<f64> {
    let at = |i: usize| 3.0 * i as f64 / cells as f64 - 2.0;
    // The cosine at the patch is (x + y + 1) / √3 r.
    let antiderivative =
        |x: f64, y: f64| (above(x, y) + beside(y, x) + beside(x, y)) / 3.0_f64.sqrt();
    let mut table = table(cells, |i, j| antiderivative(at(i), at(cells - j)));
    let normal = DVec3::ONE.normalize();
    for row in 0..cells {
        let bottom = at(cells - 1 - row);
        for (column, delta) in table[row * cells..(row + 1) * cells].iter_mut().enumerate() {
            // Rows count from above, which turns the sign of the differences.
            *delta = match column.cmp(&row) {
                core::cmp::Ordering::Less => 0.0,
                core::cmp::Ordering::Greater => -*delta,
                core::cmp::Ordering::Equal => {
                    let (x0, x1) = (at(column), at(column + 1));
                    let top = at(cells - row);
                    let triangle =
                        [(x1, bottom), (x1, top), (x0, top)].map(|(x, y)| DVec3::new(x, y, 1.0));
                    contour_factor(DVec3::ZERO, normal, &triangle).abs()
                }
            };
        }
    }
    table
}

/// A sum, by rows first so that rounding does not add up.
fn by_rows(table: &[f64], width: usize) -> f64 {
    let rows = table.chunks(width).map(|row| row.iter().sum::<f64>());
    rows.sum()
}

/// 0 and the running sums of each row.
fn running_sums(table: &[f64], width: usize) -> Vec<f64> {
    let mut sums = Vec::with_capacity(table.len() + table.len() / width);
    for row in table.chunks(width) {
        let mut sum = 0.0;
        sums.push(sum);
        sums.extend(row.iter().map(|delta| {
            sum += delta;
            sum
        }));
    }
    sums
}

/// `∫_0^x ∫_0^y 1 / (π (1 + x² + y²)²)`: factor to a rectangle at height 1 parallel to the element, corner above it.
fn above(x: f64, y: f64) -> f64 {
    let part = |x: f64, y: f64| {
        let root = (1.0 + x * x).sqrt();
        x / root * (y / root).atan()
    };
    (part(x, y) + part(y, x)) / (2.0 * PI)
}

/// `∫_0^y ∫^z z / (π (1 + y² + z²)²)`: antiderivative of the factor to a plane at distance 1 that stands on the element's.
fn beside(y: f64, z: f64) -> f64 {
    let root = (1.0 + z * z).sqrt();
    -(y / root).atan() / root / (2.0 * PI)
}
