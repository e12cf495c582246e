//! The picture, or several side by side.

/// Pictures in a rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tiling {
    /// Columns.
    pub columns: usize,
    /// Rows.
    pub rows: usize,
}

impl Tiling {
    /// Columns and rows for so many pictures in a rectangle of that aspect, so that they are as near as can be to 3 by 2.
    pub fn new(count: usize, aspect: f32) -> Self {
        let count = count.max(1);
        let misfit = |columns: usize| {
            let rows = count.div_ceil(columns);
            let tile = aspect * rows as f32 / columns as f32;
            let empty = (columns * rows - count) as f32;
            (tile / 1.5).ln().abs() + 0.5 * empty
        };
        let columns = (1..=count)
            .min_by(|&a, &b| misfit(a).total_cmp(&misfit(b)))
            .unwrap_or(1);
        Self {
            columns,
            rows: count.div_ceil(columns),
        }
    }

    /// Left, top, width and height of a tile, as shares of the rectangle.
    pub fn tile(&self, i: usize) -> [f32; 4] {
        let (width, height) = (1.0 / self.columns as f32, 1.0 / self.rows as f32);
        let (column, row) = (i % self.columns, i / self.columns);
        [column as f32 * width, row as f32 * height, width, height]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_pictures_are_two_by_two() {
        let tiling = |count, aspect| {
            let Tiling { columns, rows } = Tiling::new(count, aspect);
            [columns, rows]
        };
        assert_eq!(tiling(1, 1.6), [1, 1], "one fills all");
        assert_eq!(tiling(4, 1.6), [2, 2], "the figure of the textbook");
        assert_eq!(tiling(2, 2.4), [2, 1], "wide");
        assert_eq!(tiling(2, 0.7), [1, 2], "high");
        assert_eq!(tiling(0, 1.0), [1, 1], "degenerate");
        assert_eq!(
            Tiling::new(4, 1.6).tile(3),
            [0.5, 0.5, 0.5, 0.5],
            "the last one"
        );
    }
}
