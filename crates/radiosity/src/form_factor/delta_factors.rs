//! The five faces of a hemicube and the share of light that passes each of their cells.

use crate::error::RadiosityError;
use core::f64::consts::PI;
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
    /// Cells of a quarter, row by row from the centre outwards.
    top: Vec<f64>,
    /// Cells of half a side, row by row upwards from the patch's plane, from the middle outwards.
    side: Vec<f64>,
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
        let mut factors = Self {
            half,
            top: table(above),
            side: table(beside),
        };
        // The closed forms sum to 1 but for rounding, which grows with the number of cells.
        let sum = factors.sum();
        let cells = factors.top.iter_mut().chain(&mut factors.side);
        cells.for_each(|delta| *delta /= sum);
        Ok(factors)
    }

    /// The factor of one cell; columns count from the left and rows from above.
    pub fn at(&self, face: CubeFace, column: usize, row: usize) -> f64 {
        let from_centre = if column < self.half {
            self.half - 1 - column
        } else {
            column - self.half
        };
        self.half_row(face, row)[from_centre]
    }

    /// Sum over all cells of the five faces: 1.
    pub fn sum(&self) -> f64 {
        // By rows first, so that rounding does not add up.
        let total = |table: &[f64]| -> f64 {
            let rows = table.chunks(self.half).map(|row| row.iter().sum::<f64>());
            rows.sum()
        };
        4.0 * total(&self.top) + 8.0 * total(&self.side)
    }

    /// Right half of a row of cells; the left half mirrors it.
    pub(super) fn half_row(&self, face: CubeFace, row: usize) -> &[f64] {
        let (table, from_centre) = match face {
            CubeFace::Top if row >= self.half => (&self.top, row - self.half),
            CubeFace::Top => (&self.top, self.half - 1 - row),
            CubeFace::Side(_) => (&self.side, self.half - 1 - row),
        };
        &table[from_centre * self.half..(from_centre + 1) * self.half]
    }
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
