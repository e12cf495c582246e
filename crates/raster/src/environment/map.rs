//! Pictures of all directions, and looking light up in them.

use super::Projection;
use crate::{Image, Rgb};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Light from all directions around a point: radiance, linear.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentMap {
    projection: Projection,
    width: usize,
    height: usize,
    /// All faces, each row by row.
    texels: Vec<Rgb>,
}

/// An environment map could not be made; one line.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EnvironmentError {
    /// Too few or too many pictures.
    #[error("a {projection} map has {wanted} faces, not {found}")]
    Faces {
        /// What was to be made.
        projection: Projection,
        /// Its faces.
        wanted: usize,
        /// Pictures given.
        found: usize,
    },
    /// Sizes that do not fit.
    #[error(
        "a face of {width} x {height} pixels: those of a {projection} map must all have one size, from 1 to 16384{}",
        if matches!(projection, Projection::LatLong) { "" } else { ", and be square" }
    )]
    Size {
        /// What was to be made.
        projection: Projection,
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// A picture of faces whose sides fit no layout.
    #[error(
        "a picture of {width} x {height} pixels is no {projection} map: it should be {}",
        if projection.faces() == 2 { "2:1 or 1:2" } else { "6:1, 1:6, 4:3 or 3:4" }
    )]
    Layout {
        /// What was to be made.
        projection: Projection,
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Light that is no number.
    #[error("face {face}, pixel ({x}, {y}): {value:?} is not finite; mend the picture")]
    NotFinite {
        /// Number of the face.
        face: usize,
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// What is there.
        value: [f32; 3],
    },
}

/// Longest side of a face.
const MAX_SIDE: usize = 16_384;

/// Texels around a place and their weights, which sum to 1; weight 0 for those that are not needed.
pub(super) type Taps = [(usize, f32); 4];

impl EnvironmentMap {
    /// A map of its faces.
    ///
    /// # Errors
    /// Another number of faces than [`Projection::faces`], sizes that differ, faces that are not square, NaN.
    pub fn new(projection: Projection, faces: &[Image<Rgb>]) -> Result<Self, EnvironmentError> {
        let (wanted, found) = (projection.faces(), faces.len());
        let first = match faces.first() {
            Some(first) if found == wanted => first,
            _ => {
                return Err(EnvironmentError::Faces {
                    projection,
                    wanted,
                    found,
                });
            }
        };
        let (width, height) = (first.width(), first.height());
        let fits = |face: &&Image<Rgb>| (face.width(), face.height()) == (width, height);
        let misfit = faces.iter().find(|face| !fits(face));
        let is_shaped = projection == Projection::LatLong || width == height;
        if misfit.is_some()
            || !is_shaped
            || !(1..=MAX_SIDE).contains(&width.max(height))
            || height == 0
        {
            let face = misfit.unwrap_or(first);
            return Err(EnvironmentError::Size {
                projection,
                width: face.width(),
                height: face.height(),
            });
        }
        let texels: Vec<Rgb> = faces.iter().flat_map(|f| f.pixels()).copied().collect();
        if let Some(at) = texels.iter().position(|c| !c.is_finite()) {
            let (face, rest) = (at / (width * height), at % (width * height));
            return Err(EnvironmentError::NotFinite {
                face,
                x: rest % width,
                y: rest / width,
                value: texels[at].to_array(),
            });
        }
        Ok(Self::of_texels(projection, width, height, texels))
    }

    /// A map of a function of the direction, the mean of `samples × samples` values in each texel; rows in parallel. What
    /// lies outside the disc of a sphere, angular or fisheye map is black.
    ///
    /// `rows` of a face are clamped to 1 to 8192, `samples` to 1 to 64.
    pub fn from_fn(
        projection: Projection,
        rows: usize,
        samples: usize,
        radiance: impl Fn(Vec3) -> Rgb + Sync,
    ) -> Self {
        let (width, height) = projection.face_size(rows.clamp(1, MAX_SIDE / 2));
        let samples = samples.clamp(1, 64);
        let texel = |face, x, y| {
            if !projection.shows((width, height), x, y) {
                return Rgb::BLACK;
            }
            let (mut sum, mut weights) = (Rgb::BLACK, 0.0);
            for i in 0..samples * samples {
                let share = Vec2::new((i % samples) as f32, (i / samples) as f32) + 0.5;
                let at = (Vec2::new(x as f32, y as f32) + share / samples as f32)
                    / Vec2::new(width as f32, height as f32);
                let weight = projection.density(at);
                sum += radiance(projection.direction(face, at)) * weight;
                weights += weight;
            }
            sum / weights
        };
        Self::of_rows(projection, width, height, texel)
    }

    /// A map whose texels a function of face, column and row makes; rows in parallel.
    pub(super) fn of_rows(
        projection: Projection,
        width: usize,
        height: usize,
        texel: impl Fn(usize, usize, usize) -> Rgb + Sync,
    ) -> Self {
        let mut texels = vec![Rgb::BLACK; projection.faces() * width * height];
        let rows = texels.par_chunks_mut(width).enumerate();
        rows.for_each(|(row, texels)| {
            let (face, y) = (row / height, row % height);
            for (x, out) in texels.iter_mut().enumerate() {
                *out = texel(face, x, y);
            }
        });
        Self::of_texels(projection, width, height, texels)
    }

    pub(super) fn of_texels(
        projection: Projection,
        width: usize,
        height: usize,
        texels: Vec<Rgb>,
    ) -> Self {
        Self {
            projection,
            width,
            height,
            texels,
        }
    }

    /// How directions become places.
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// Columns of a face.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows of a face.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All texels, face by face and row by row.
    pub fn texels(&self) -> &[Rgb] {
        &self.texels
    }

    /// The texel of a face, a column and a row; panics outside.
    pub fn texel(&self, face: usize, x: usize, y: usize) -> Rgb {
        self.texels[self.index(face, x, y)]
    }

    pub(super) fn index(&self, face: usize, x: usize, y: usize) -> usize {
        debug_assert!(x < self.width && y < self.height, "({x}, {y}) in a face");
        (face * self.height + y) * self.width + x
    }

    /// One picture for each face.
    pub fn faces(&self) -> Vec<Image<Rgb>> {
        let faces = self.texels.chunks_exact(self.width * self.height);
        let image = |texels: &[Rgb]| {
            Image::from_pixels(self.width, self.height, texels.to_vec()).expect("a whole face")
        };
        faces.map(image).collect()
    }

    /// The same map with each texel's light changed.
    pub fn map(&self, change: impl FnMut(&Rgb) -> Rgb) -> Self {
        Self {
            texels: self.texels.iter().map(change).collect(),
            ..*self
        }
    }

    /// Direction of the middle of a texel, of unit length.
    pub fn direction(&self, face: usize, x: usize, y: usize) -> Vec3 {
        let middle = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
        let size = Vec2::new(self.width as f32, self.height as f32);
        self.projection.direction(face, middle / size)
    }

    /// Solid angles of the texels of a face, row by row, in steradians; all faces have the same.
    pub fn solid_angles(&self) -> Vec<f64> {
        let size = (self.width, self.height);
        let mut all = vec![0.0; self.width * self.height];
        let rows = all.par_chunks_mut(self.width).enumerate();
        rows.for_each(|(y, row)| {
            if self.projection == Projection::LatLong {
                row.fill(self.projection.texel_solid_angle(size, 0, y));
                return;
            }
            for (x, out) in row.iter_mut().enumerate() {
                *out = self.projection.texel_solid_angle(size, x, y);
            }
        });
        all
    }

    /// The texel around a direction, without filtering; black where the map shows nothing.
    #[inline]
    pub fn nearest(&self, direction: Vec3) -> Rgb {
        let Some((face, at)) = self.projection.coordinates(direction) else {
            return Rgb::BLACK;
        };
        self.texels[self.nearest_index(face, at)]
    }

    pub(super) fn nearest_index(&self, face: usize, at: Vec2) -> usize {
        let (x, y) = super::azimuthal::nearest([self.width, self.height], at);
        self.index(face, x, y)
    }

    /// Radiance from a direction of any length, bilinear between the four texels around it, across edges of faces too;
    /// black where the map shows nothing.
    ///
    /// At a corner of a cube three texels meet; the weight of the fourth is shared among them.
    #[inline]
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        let Some((face, at)) = self.projection.coordinates(direction) else {
            return Rgb::BLACK;
        };
        let taps = self.taps(face, at);
        let light = taps
            .iter()
            .map(|&(index, weight)| self.texels[index] * weight);
        light.sum()
    }

    /// Radiance that a mirror at a point with this unit normal shows to an eye; `to_eye` points away from the surface.
    /// This is environment mapping as Blinn and Newell had it: `r = 2 (n·v) n - v`.
    pub fn reflection(&self, normal: Vec3, to_eye: Vec3) -> Rgb {
        self.radiance(reflected(normal, to_eye))
    }

    /// The texels that [`Self::radiance`] takes, and their weights.
    #[inline]
    pub(super) fn taps(&self, face: usize, at: Vec2) -> Taps {
        let size = Vec2::new(self.width as f32, self.height as f32);
        let place = at * size - 0.5;
        let low = place.floor();
        let share = place - low;
        #[expect(clippy::cast_possible_truncation, reason = "from -1 to the side")]
        let (x, y) = (low.x as isize, low.y as isize);
        let corners = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
        let rest = 1.0 - share;
        let weights = [
            rest.x * rest.y,
            share.x * rest.y,
            rest.x * share.y,
            share.x * share.y,
        ];
        if self.is_plain(x, y, at) {
            let first = self.index(face, x.cast_unsigned(), y.cast_unsigned());
            let indices = [first, first + 1, first + self.width, first + self.width + 1];
            return core::array::from_fn(|i| (indices[i], weights[i]));
        }
        self.taps_across(face, corners, weights)
    }

    /// Whether all four texels from `(x, y)` on lie in the face, and in its disc.
    fn is_plain(&self, x: isize, y: isize, at: Vec2) -> bool {
        let (width, height) = (self.width.cast_signed(), self.height.cast_signed());
        if x < 0 || y < 0 || x + 1 >= width || y + 1 >= height {
            return false;
        }
        // The farthest of the four middles is less than a texel's diagonal away.
        let reach = 1.0 - 2.9 / self.width.min(self.height) as f32;
        self.projection.disc().is_none()
            || (reach > 0.0 && (2.0 * at - 1.0).length_squared() < reach * reach)
    }

    fn taps_across(&self, face: usize, corners: [(isize, isize); 4], weights: [f32; 4]) -> Taps {
        let size = [self.width, self.height];
        let find = |(x, y)| self.projection.neighbour(size, face, x, y);
        let found = corners.map(find);
        let missing: f32 = (0..4)
            .filter(|&i| found[i].is_none())
            .map(|i| weights[i])
            .sum();
        let present = found.iter().flatten().count().max(1);
        core::array::from_fn(|i| match found[i] {
            Some((face, x, y)) => {
                let index = self.index(face, x, y);
                (index, weights[i] + missing / present as f32)
            }
            None => (0, 0.0),
        })
    }

    /// Calls `take` with directions, light and solid angles of the texels of a row, counted through all faces; `angles`
    /// are [`Self::solid_angles`]. Texels of small maps are cut into parts no larger than those of a map of 64 rows,
    /// so that sums over them are integrals of what the texels stand for, not of their middles.
    pub(super) fn parts_of_row(
        &self,
        row: usize,
        angles: &[f64],
        mut take: impl FnMut(Vec3, Rgb, f64),
    ) {
        let (face, y) = (row / self.height, row % self.height);
        let cuts = 64_usize.div_ceil(self.height).min(16);
        let size = Vec2::new(self.width as f32, self.height as f32);
        let is_disc = self.projection.disc().is_some();
        let place = |x: usize, i: usize| {
            let share = Vec2::new((i % cuts) as f32, (i / cuts) as f32) + 0.5;
            let at = (Vec2::new(x as f32, y as f32) + share / cuts as f32) / size;
            let is_outside = is_disc && (2.0 * at - 1.0).length_squared() > 1.0;
            (!is_outside).then_some(at)
        };
        for x in 0..self.width {
            let places = || (0..cuts * cuts).filter_map(|i| place(x, i));
            let density = |at: Vec2| f64::from(self.projection.density(at));
            let scale = angles[y * self.width + x] / places().map(density).sum::<f64>();
            let light = self.texel(face, x, y);
            for at in places() {
                take(
                    self.projection.direction(face, at),
                    light,
                    scale * density(at),
                );
            }
        }
    }

    /// Radiant flux through a small sphere by its cross-section: `∫ L dω`, with exact solid angles of texels.
    pub fn flux(&self) -> [f64; 3] {
        let weights = self.solid_angles();
        let mut sum = [0.0; 3];
        for texels in self.texels.chunks_exact(weights.len()) {
            for (texel, weight) in texels.iter().zip(&weights) {
                for (band, sum) in sum.iter_mut().enumerate() {
                    *sum += f64::from(texel[band]) * weight;
                }
            }
        }
        sum
    }

    /// Mean radiance over the directions that the map shows.
    pub fn mean(&self) -> [f64; 3] {
        self.flux().map(|band| band / self.projection.covered())
    }
}

/// Direction from which a mirror shows light to an eye: `2 (n·v) n - v`, for a normal of unit length.
pub fn reflected(normal: Vec3, to_eye: Vec3) -> Vec3 {
    2.0 * normal.dot(to_eye) * normal - to_eye
}
