//! Ripmaps: copies of a picture that are smaller in one direction, in the other, or in both.

use super::chain::{Texture, TextureOptions};
use super::lod::linear_levels;
use super::mipmap::{AxisFilter, halved, resampled};
use super::sampler::{Sampler, finite};
use super::texel::{Level, Reader};
use glam::{Vec2, Vec4};

/// A grid of prefiltered copies, halved `i` times in width and `j` times in height.
///
/// Anisotropic where the footprint of a pixel lies along u or v; across, it is no better than trilinear. Takes four times
/// the memory of the picture in floats, 64 bytes for each of its texels.
#[derive(Debug, Clone)]
pub struct Ripmap {
    /// Copies of equal height one after the other, `columns` of them.
    levels: Vec<Level<Vec4>>,
    columns: usize,
}

impl Ripmap {
    /// From the largest level of a texture, by the filter and the wrapping of `options`.
    pub fn new(texture: &Texture, options: &TextureOptions) -> Self {
        let base = texture.base();
        let (columns, rows) = (
            1 + base.width.ilog2() as usize,
            1 + base.height.ilog2() as usize,
        );
        let filter =
            |axis: usize, from, to| AxisFilter::new(options.filter, options.wrap[axis], from, to);
        let mut levels = Vec::with_capacity(columns * rows);
        levels.push(base);
        for i in 1..columns * rows {
            let source: &Level<Vec4> = if i % columns == 0 {
                &levels[i - columns]
            } else {
                &levels[i - 1]
            };
            let (width, height) = if i % columns == 0 {
                (source.width, halved(source.height))
            } else {
                (halved(source.width), source.height)
            };
            let (across, down) = (
                filter(0, source.width, width),
                filter(1, source.height, height),
            );
            levels.push(resampled(source, (), &across, &down));
        }
        Self { levels, columns }
    }

    /// The texture as a pixel sees it: its wrapping and border are the sampler's, and its level of detail along u is that
    /// of the larger of the two changes of u, along v likewise; four copies are blended.
    pub fn sample_grad(&self, sampler: &Sampler, uv: Vec2, ddx: Vec2, ddy: Vec2) -> Vec4 {
        let uv = finite(uv);
        let size = Vec2::new(self.levels[0].width as f32, self.levels[0].height as f32);
        let extent = ddx.abs().max(ddy.abs()) * size;
        let rows = self.levels.len() / self.columns;
        let axis = |extent: f32, count: usize| {
            let lod = if extent.is_finite() {
                extent.log2()
            } else {
                f32::INFINITY
            };
            linear_levels(lod.clamp(0.0, (count - 1) as f32), count - 1)
        };
        let ((left, right, fx), (upper, lower, fy)) =
            (axis(extent.x, self.columns), axis(extent.y, rows));
        let read = |column: usize, row: usize| {
            let reader = Reader {
                level: &self.levels[row * self.columns + column],
                codec: (),
                wrap: sampler.wrap,
                border: sampler.border,
            };
            reader.bilinear(uv)
        };
        let row = |row| read(left, row).lerp(read(right, row), fx);
        row(upper).lerp(row(lower), fy)
    }
}
