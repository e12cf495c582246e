//! The five faces of a hemicube and the share of light that passes each of their cells.

use crate::error::RadiosityError;
use core::f64::consts::PI;
use core::ops::Range;
use glam::{Vec3, Vec4};
use hemicube_raster::triangle::Viewport;

/// A face of the hemicube.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CubeFace {
    /// Opposite the patch.
    Top,
    /// One of the four halves of sides, numbered in the sense of rotation around the normal.
    Side(u8),
}

impl CubeFace {
    /// All five.
    pub const ALL: [Self; 5] = [
        Self::Top,
        Self::Side(0),
        Self::Side(1),
        Self::Side(2),
        Self::Side(3),
    ];

    /// Its place in [`Self::ALL`].
    pub(super) fn number(self) -> usize {
        match self {
            Self::Top => 0,
            Self::Side(side) => 1 + usize::from(side),
        }
    }

    /// Its cells, for so many along an edge of the top.
    pub fn viewport(self, resolution: usize) -> Viewport {
        match self {
            Self::Top => Viewport::new(resolution, resolution),
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
            Self::Side(0) => (-p.y, p.z, p.x),
            Self::Side(1) => (p.x, p.z, p.y),
            Self::Side(2) => (p.y, p.z, -p.x),
            Self::Side(_) => (-p.x, p.z, -p.y),
        };
        let up = if self == Self::Top {
            up
        } else {
            2.0 * up - forward
        };
        Vec4::new(right, up, forward - near, forward)
    }
}

/// Delta form factors of all cells of a hemicube: the share of the light of a diffuse point that passes through each.
///
/// By symmetry a quarter of the top and half of a side stand for all.
#[derive(Debug, Clone, PartialEq)]
pub struct DeltaFactors {
    half: usize,
    /// Of a quarter, row by row from the centre outwards: sums over the cells before each column and over all of them.
    /// Sums, because most cells see what their neighbours see: a run of them costs what one does.
    top: Vec<f64>,
    /// Of half a side, row by row upwards from the patch's plane, from the middle outwards: the same.
    side: Vec<f64>,
}

/// A row of cells.
#[derive(Debug, Clone, Copy)]
pub(super) struct DeltaRow<'a> {
    /// Sums over the right half; the left half mirrors it.
    sums: &'a [f64],
}

impl DeltaRow<'_> {
    /// Sum of the factors in some columns, counted from the left.
    pub(super) fn of(self, columns: Range<usize>) -> f64 {
        self.left_of(columns.end) - self.left_of(columns.start)
    }

    /// From the middle to the left border of a column, negative on the left.
    fn left_of(self, column: usize) -> f64 {
        let half = self.sums.len() - 1;
        if column < half {
            -self.sums[half - column]
        } else {
            self.sums[column - half]
        }
    }
}

impl DeltaFactors {
    /// The factors for so many cells along an edge.
    ///
    /// # Errors
    /// A resolution that is odd or not from 16 to 4096.
    pub fn new(resolution: u32) -> Result<Self, RadiosityError> {
        if !(16..=4096).contains(&resolution) || resolution % 2 == 1 {
            return Err(RadiosityError::Option(format!(
                "hemicube resolution {resolution} is not an even number from 16 to 4096"
            )));
        }
        let half = resolution as usize / 2;
        let at = |i: usize| i as f64 / half as f64;
        // ∫∫ over a cell from the antiderivative at its four corners.
        let table = |antiderivative: fn(f64, f64) -> f64| -> Vec<f64> {
            let row = |j: usize| (0..=half).map(move |i| antiderivative(at(i), at(j)));
            (0..half)
                .flat_map(|j| {
                    let (low, high): (Vec<f64>, Vec<f64>) =
                        (row(j).collect(), row(j + 1).collect());
                    (0..half)
                        .map(|i| (high[i + 1] - high[i]) - (low[i + 1] - low[i]))
                        .collect::<Vec<_>>()
                })
                .collect()
        };
        let (mut top, mut side) = (table(above), table(beside));
        // The closed forms sum to 1 but for rounding, which grows with the number of cells.
        let sum = 4.0 * by_rows(&top, half) + 8.0 * by_rows(&side, half);
        let cells = top.iter_mut().chain(&mut side);
        cells.for_each(|delta| *delta /= sum);
        Ok(Self {
            half,
            top: running_sums(&top, half),
            side: running_sums(&side, half),
        })
    }

    /// The factor of one cell; columns count from the left and rows from above.
    pub fn at(&self, face: CubeFace, column: usize, row: usize) -> f64 {
        self.row(face, row).of(column..column + 1)
    }

    /// Sum over all cells of the five faces: 1.
    pub fn sum(&self) -> f64 {
        let total =
            |table: &[f64]| -> f64 { table.chunks(self.half + 1).map(|row| row[self.half]).sum() };
        4.0 * total(&self.top) + 8.0 * total(&self.side)
    }

    /// A row of cells, counted from above.
    pub(super) fn row(&self, face: CubeFace, row: usize) -> DeltaRow<'_> {
        let (table, from_centre) = match face {
            CubeFace::Top if row >= self.half => (&self.top, row - self.half),
            CubeFace::Top => (&self.top, self.half - 1 - row),
            CubeFace::Side(_) => (&self.side, self.half - 1 - row),
        };
        let len = self.half + 1;
        DeltaRow {
            sums: &table[from_centre * len..(from_centre + 1) * len],
        }
    }
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
