//! Triangles with something to look up at each sample: an item buffer says which one is seen, barycentric coordinates and
//! their exact derivatives say where on it.

use core::ops::Range;
use glam::{DVec2, Vec2, Vec3, Vec4};
use hemicube_raster::antialias::{Antialiasing, Supersampler};
use hemicube_raster::texture::TexcoordPlanes;
use hemicube_raster::triangle::{Cull, DepthBuffer, Viewport, draw_ids};
use hemicube_raster::{Image, Rgb};
use rayon::prelude::*;

/// A place on a triangle that a sample sees.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hit {
    /// Which triangle.
    pub triangle: usize,
    /// Where on it. They sum to 1; a sample on the border may lie a hair outside, for corners are snapped when drawn.
    pub barycentric: [f32; 3],
    /// Their gradients on the screen, by the sample's column (to the right) and row (down).
    pub gradients: [Vec2; 3],
}

impl Hit {
    fn new(triangle: usize, planes: &TexcoordPlanes, sample: DVec2) -> Self {
        let found = planes.at(sample);
        let [b, c] = found.uv.to_array();
        let gradient = |i: usize| Vec2::new(found.ddx[i], found.ddy[i]);
        Self {
            triangle,
            barycentric: [1.0 - b - c, b, c],
            gradients: [-gradient(0) - gradient(1), gradient(0), gradient(1)],
        }
    }

    /// With gradients by another unit of length.
    pub fn scaled(self, samples_per_unit: f32) -> Self {
        Self {
            gradients: self.gradients.map(|g| g * samples_per_unit),
            ..self
        }
    }

    /// A number given at the corners, here; and its gradient.
    pub fn interpolate(&self, corners: [f32; 3]) -> (f32, Vec2) {
        let (mut value, mut gradient) = (0.0, Vec2::ZERO);
        for (i, corner) in corners.into_iter().enumerate() {
            value += self.barycentric[i] * corner;
            gradient += self.gradients[i] * corner;
        }
        (value, gradient)
    }

    /// A point given at the corners, here.
    pub fn place(&self, corners: [Vec3; 3]) -> Vec3 {
        let [a, b, c] = self.barycentric;
        corners[0] * a + corners[1] * b + corners[2] * c
    }
}

/// Rows of pixels that a thread draws at a time.
const BAND: usize = 16;

/// Nothing was drawn to it.
const NOTHING: u32 = u32::MAX;

/// Draws triangles in clip space, both sides: `shade` is asked at each sample that sees one, the others are `ground`.
pub(crate) fn draw_hits(
    triangles: &[[Vec4; 3]],
    (width, height): (usize, usize),
    antialiasing: Antialiasing,
    ground: Rgb,
    shade: impl Fn(&Hit) -> Rgb + Sync,
) -> Image<Rgb> {
    let samples = Samples::new(triangles, (width, height), antialiasing);
    let bins = samples.bins();
    let mut image = Image::filled(width, height, ground);
    let bands = image.pixels_mut().par_chunks_mut(BAND * width.max(1));
    bands.enumerate().for_each(|(band, out)| {
        let pixels = BAND * band..(BAND * (band + 1)).min(height);
        let rows = samples.grid.rows(pixels.clone());
        let colors = samples.shaded(rows, &bins[band], ground, &shade);
        samples.grid.resolve(pixels, &colors, out);
    });
    image
}

/// The samples of a picture.
struct Samples<'a> {
    triangles: &'a [[Vec4; 3]],
    grid: Supersampler,
    viewport: Viewport,
}

impl<'a> Samples<'a> {
    fn new(
        triangles: &'a [[Vec4; 3]],
        (width, height): (usize, usize),
        antialiasing: Antialiasing,
    ) -> Self {
        let grid = Supersampler::new(width, height, antialiasing);
        Self {
            triangles,
            viewport: Viewport::new(grid.columns(), grid.rows(0..height).end),
            grid,
        }
    }

    /// For each band of pixels the triangles that may be seen there, in their order.
    fn bins(&self) -> Vec<Vec<u32>> {
        let (_, height) = self.grid.size();
        let mut bins = vec![Vec::new(); height.div_ceil(BAND)];
        for (id, corners) in (0..).zip(self.triangles) {
            let bands = self.bands_of(corners, bins.len());
            for bin in &mut bins[bands] {
                bin.push(id);
            }
        }
        bins
    }

    /// The bands of a triangle; all of them if a corner is not in front of the eye.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the number of bands"
    )]
    fn bands_of(&self, corners: &[Vec4; 3], bands: usize) -> Range<usize> {
        if !corners.iter().all(|p| p.w > 0.0) {
            return 0..bands;
        }
        let per_band = (BAND * self.grid.factor()) as f32;
        // Rows of samples that filters share with the band above, and one for corners that are rounded to sub-pixels.
        let shared = (self.grid.weights().len() - self.grid.factor() + 1) as f32;
        let [a, b, c] = corners.map(|p| (1.0 - p.y / p.w) * 0.5 * self.viewport.height as f32);
        let most = bands as f32;
        let first = (a.min(b).min(c) - shared) / per_band;
        let end = (a.max(b).max(c) + 1.0) / per_band;
        let first = first.floor().clamp(0.0, most);
        first as usize..end.ceil().clamp(first, most) as usize
    }

    /// The samples of some rows. `triangles` are those that may be seen there.
    fn shaded(
        &self,
        rows: Range<usize>,
        triangles: &[u32],
        ground: Rgb,
        shade: &impl Fn(&Hit) -> Rgb,
    ) -> Vec<Rgb> {
        let viewport = self.viewport;
        let ids = self.seen(rows.clone(), triangles);
        let mut planes = (NOTHING, None);
        let color = |(i, &id): (usize, &u32)| {
            if id == NOTHING {
                return ground;
            }
            if planes.0 != id {
                let corners = &self.triangles[id as usize];
                let of_corners = [Vec2::ZERO, Vec2::X, Vec2::Y];
                planes = (id, TexcoordPlanes::new(viewport, corners, &of_corners));
            }
            // One that is seen edge-on has no place.
            let Some(planes) = &planes.1 else {
                return ground;
            };
            let (x, y) = (i % viewport.width, rows.start + i / viewport.width);
            let sample = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            shade(&Hit::new(id as usize, planes, sample))
        };
        ids.iter().enumerate().map(color).collect()
    }

    /// The triangle that each sample of some rows sees.
    fn seen(&self, rows: Range<usize>, triangles: &[u32]) -> Vec<u32> {
        let count = rows.len() * self.viewport.width;
        let mut depths = vec![DepthBuffer::EMPTY; count];
        let mut ids = vec![NOTHING; count];
        for &id in triangles {
            draw_ids(
                rows.clone(),
                self.viewport,
                Cull::None,
                &self.triangles[id as usize],
                id,
                &mut depths,
                &mut ids,
            );
        }
        ids
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bands are drawn on their own, and yet triangles across them and filters over them show no seam.
    #[test]
    fn bands_leave_no_seams() {
        let at = |x: f32, y: f32| Vec4::new(x, y, 0.5, 1.0);
        let triangles = [
            [at(-0.9, -0.95), at(0.9, -0.8), at(0.1, 0.9)],
            [at(-0.9, 0.2), at(-0.7, 0.21), at(-0.8, 0.3)],
        ];
        let size = (40, 100);
        for name in ["none", "3x3", "3x3:bartlett", "2x2:lanczos"] {
            let antialiasing: Antialiasing = name.parse().expect("a name");
            let color = |hit: &Hit| Rgb::from(hit.barycentric);
            let image = draw_hits(&triangles, size, antialiasing, Rgb::WHITE, color);
            let samples = Samples::new(&triangles, size, antialiasing);
            let rows = samples.grid.rows(0..size.1);
            let at_once = samples.shaded(rows, &[0, 1], Rgb::WHITE, &color);
            let mut whole = Image::filled(size.0, size.1, Rgb::BLACK);
            let grid = &samples.grid;
            grid.resolve(0..size.1, &at_once, whole.pixels_mut());
            assert_eq!(image, whole, "{name}");
        }
    }
}
