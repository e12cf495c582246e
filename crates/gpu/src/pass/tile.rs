//! Pictures in parts that the adapter can draw.

use crate::pass::view::Window;
use glam::DVec2;

/// Samples of a tile's side at most: a few hundred megabytes for all that a picture needs on its way.
const MOST_SAMPLES: u32 = 4096;
/// Pixels of a tile's side at most.
const MOST_PIXELS: u32 = 2048;

/// A rectangle of a picture's pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Tile {
    /// Width and height of the picture.
    pub(crate) whole: [u32; 2],
    /// The tile's upper left pixel.
    pub(crate) at: [u32; 2],
    /// Its width and height.
    pub(crate) size: [u32; 2],
}

impl Tile {
    /// All of a picture.
    pub(crate) fn all(whole: [u32; 2]) -> Self {
        Self {
            whole,
            at: [0, 0],
            size: whole,
        }
    }

    /// One pixel.
    pub(crate) fn pixel(whole: [u32; 2], at: [u32; 2]) -> Self {
        Self {
            whole,
            at,
            size: [1, 1],
        }
    }

    /// Tiles that cover a picture, row by row, where a target may have sides of so many samples, a pixel takes `factor` of
    /// them, and a row `taps - factor` more.
    pub(crate) fn cover(whole: [u32; 2], limit: u32, [factor, taps]: [u32; 2]) -> Vec<Self> {
        let beside = taps.saturating_sub(factor);
        let samples = limit.min(MOST_SAMPLES).saturating_sub(beside);
        let side = (samples / factor.max(1)).clamp(1, MOST_PIXELS);
        let starts = |axis: usize| (0..whole[axis]).step_by(side as usize);
        let tile = |x: u32, y: u32| Self {
            whole,
            at: [x, y],
            size: [side.min(whole[0] - x), side.min(whole[1] - y)],
        };
        let row = |y: u32| starts(0).map(move |x| tile(x, y));
        starts(1).flat_map(row).collect()
    }

    /// What of the picture's plane it sees.
    pub(crate) fn window(&self) -> Window {
        let vector = |[x, y]: [u32; 2]| DVec2::new(x.into(), y.into());
        let (whole, at, size) = (vector(self.whole), vector(self.at), vector(self.size));
        let offset = (whole - 2.0 * at - size) / size;
        Window {
            scale: whole / size,
            offset: DVec2::new(offset.x, -offset.y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_each_pixel_once_and_fit_with_their_samples() {
        for (whole, limit, samples) in [
            ([5000, 3], 16_384, [1, 1]),
            ([700, 300], 256, [2, 4]),
            ([1, 1], 8, [16, 48]),
            ([4096, 4097], 4096, [1, 1]),
        ] {
            let mut covered = vec![0_u8; (whole[0] * whole[1]) as usize];
            for tile in Tile::cover(whole, limit, samples) {
                for y in tile.at[1]..tile.at[1] + tile.size[1] {
                    for x in tile.at[0]..tile.at[0] + tile.size[0] {
                        covered[(y * whole[0] + x) as usize] += 1;
                    }
                }
                let side = samples[0] * (tile.size[0].max(tile.size[1]) - 1) + samples[1];
                assert!(side <= limit.max(samples[1]), "{side} samples of {limit}");
            }
            assert!(covered.iter().all(|&n| n == 1), "{whole:?} within {limit}");
        }
    }

    #[test]
    fn windows_put_a_tiles_corners_onto_those_of_the_target() {
        let tile = Tile {
            whole: [700, 300],
            at: [600, 100],
            size: [100, 50],
        };
        let Window { scale, offset } = tile.window();
        // Of the picture's plane: 600 of 700 pixels to the right, 100 of 300 down.
        let upper_left = DVec2::new(2.0 * 600.0 / 700.0 - 1.0, 1.0 - 2.0 * 100.0 / 300.0);
        let found = scale * upper_left + offset;
        assert!((found - DVec2::new(-1.0, 1.0)).length() < 1e-12, "{found}");
        let lower_right = DVec2::new(1.0, 1.0 - 2.0 * 150.0 / 300.0);
        let found = scale * lower_right + offset;
        assert!((found - DVec2::new(1.0, -1.0)).length() < 1e-12, "{found}");
    }
}
