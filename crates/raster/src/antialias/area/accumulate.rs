//! A row of differences whose running sum is coverage.

/// A straight piece of an edge within one row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// y of its upper and of its lower end.
    pub top: f64,
    pub bottom: f64,
    /// x of its upper and of its lower end.
    pub x_top: f64,
    pub x_bottom: f64,
}

impl Piece {
    /// x at a y between top and bottom.
    pub fn x_at(&self, y: f64) -> f64 {
        let t = (y - self.top) / (self.bottom - self.top);
        self.x_top + (self.x_bottom - self.x_top) * t
    }
}

/// Differences of coverage from pixel to pixel of one row.
#[derive(Debug, Clone)]
pub(super) struct Differences {
    /// All zero between rows; two more than there are columns, for what lies on the right edge.
    values: Vec<f32>,
    /// Columns that may not be zero, in order of their starts when a row is done.
    touched: Vec<[usize; 2]>,
}

impl Differences {
    /// A row of so many columns.
    pub fn new(width: usize) -> Self {
        Self {
            values: vec![0.0; width + 2],
            touched: Vec::new(),
        }
    }

    /// Adds `sign` times the area to the right of a piece.
    ///
    /// Of a piece of height h from x = l to r, l < r, the area to its right and left of a column's right side x is
    /// P(x) = h (x - l)^2 / (2 (r - l)) up to r, and grows by h per pixel from there on. A column's coverage is the
    /// difference of two P; the difference of two columns' coverage, constant in the middle, is what is stored.
    #[inline]
    pub fn add(&mut self, piece: &Piece, sign: f64) {
        #[expect(clippy::cast_possible_truncation, reason = "at most 1")]
        let height = ((piece.bottom - piece.top) * sign) as f32;
        let (left, right) = match piece.x_top < piece.x_bottom {
            true => (piece.x_top, piece.x_bottom),
            false => (piece.x_bottom, piece.x_top),
        };
        let (first, last) = (column(left), column(right));
        #[expect(clippy::cast_possible_truncation, reason = "at most 1")]
        let (from, to) = ((left - first as f64) as f32, (right - last as f64) as f32);
        if first == last {
            let beyond = height * (0.5 * (from + to));
            self.values[first] += height - beyond;
            self.values[first + 1] += beyond;
            return;
        }
        let cells = &mut self.values[first..last + 2];
        #[expect(clippy::cast_possible_truncation, reason = "a number of pixels")]
        let step = height / (right - left) as f32;
        let start = 0.5 * step * (1.0 - from) * (1.0 - from);
        let end = 0.5 * step * to * to;
        // From the left: P(1), then two pixels' P and so on; from the right the same, as what is missing to h.
        let middle = cells.len() - 3;
        cells[0] += start;
        cells[1] -= start;
        cells[middle + 1] -= end;
        cells[middle + 2] += end;
        if middle == 0 {
            cells[1] += height;
            return;
        }
        cells[1] += step * (1.5 - from);
        for cell in &mut cells[2..middle + 1] {
            *cell += step;
        }
        cells[middle + 1] += step * (0.5 + to);
    }

    /// Notes that pieces between two x were added.
    #[inline]
    pub fn touch(&mut self, left: f64, right: f64) {
        self.touched.push([column(left), column(right) + 2]);
    }

    /// Takes the row apart: coverage by columns where pieces were added, and one value for all columns between.
    #[inline]
    pub fn take(
        &mut self,
        width: usize,
        fold: impl Fn(f32) -> f32,
        mut cells: impl FnMut(usize, &[f32]),
        mut run: impl FnMut(usize, usize, f32),
    ) {
        sort_by_start(&mut self.touched);
        let mut sum = 0.0;
        let mut at = 0;
        let mut touched = self.touched.iter().peekable();
        while let Some(&[start, mut end]) = touched.next() {
            while let Some([_, further]) = touched.next_if(|next| next[0] <= end) {
                end = end.max(*further);
            }
            if at < start.min(width) {
                run(at, start.min(width), settled(fold(sum)));
            }
            let values = &mut self.values[start..end];
            for value in values.iter_mut() {
                sum += *value;
                *value = fold(sum);
            }
            let shown = end.min(width).saturating_sub(start);
            if shown > 0 {
                cells(start, &values[..shown]);
            }
            values.fill(0.0);
            at = end;
        }
        self.touched.clear();
        if at < width {
            run(at, width, settled(fold(sum)));
        }
    }
}

/// Full and empty runs are exactly so: what rounding left of a sum is less than this.
fn settled(coverage: f32) -> f32 {
    const ROUNDING: f32 = 4e-6;
    match coverage {
        c if c < ROUNDING => 0.0,
        c if c > 1.0 - ROUNDING => 1.0,
        c => c,
    }
}

/// The column in which an x lies.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "x lies in the picture, but for rounding; the cast saturates"
)]
#[inline]
fn column(x: f64) -> usize {
    x as usize
}

/// Chains come in order already, most of the time.
#[inline]
fn sort_by_start(touched: &mut [[usize; 2]]) {
    if !touched.is_sorted_by_key(|range| range[0]) {
        touched.sort_unstable();
    }
}
