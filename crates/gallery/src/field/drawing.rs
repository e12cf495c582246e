//! Triangles with something to look up at each pixel: an item buffer says which triangle is seen, barycentric
//! coordinates and their exact derivatives say where on it.

use glam::{DMat3, DMat4, DVec2, DVec3, Vec2, Vec3, Vec4};
use hemicube_raster::antialias::{Antialiasing, Supersampler};
use hemicube_raster::texture::TexcoordPlanes;
use hemicube_raster::triangle::{Cull, DepthBuffer, Viewport, draw_ids};
use hemicube_raster::{Image, Rgb};
use rayon::prelude::*;

/// Where an object is seen from.
#[derive(Debug, Clone, Copy)]
pub struct Eye {
    clip_from_world: DMat4,
    /// Towards the eye.
    pub direction: DVec3,
}

/// Vertical field of view, radians.
const FIELD_OF_VIEW: f64 = 0.45;

/// How much larger the picture is than what it shows.
const MARGIN: f64 = 1.04;

impl Eye {
    /// From a direction, so near that all points just fit into the picture.
    pub fn around(points: &[Vec3], direction: DVec3, (width, height): (usize, usize)) -> Self {
        let direction = direction.normalize_or(DVec3::Z);
        // Seen from above or below, -Z is up in the picture.
        let is_steep = direction.y.abs() > 0.99;
        let up = if is_steep { DVec3::NEG_Z } else { DVec3::Y };
        let right = up.cross(direction).normalize();
        let axes = DMat3::from_cols(right, direction.cross(right), direction);
        let seen = || points.iter().map(|p| axes.transpose() * p.as_dvec3());
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = seen().fold(start, |(low, high), p| (low.min(p), high.max(p)));
        let centre = (low + high) * 0.5;
        let aspect = width as f64 / height as f64;
        let slope = DVec2::new(aspect, 1.0) * (0.5 * FIELD_OF_VIEW).tan() / MARGIN;
        let needed = |p: DVec3| p.z + ((p - centre).truncate().abs() / slope).max_element();
        let size = (high - low).max_element().max(1e-30);
        // Not so near that what lies in front is out of proportion.
        let nearest = high.z + 0.5 * size;
        let height = seen().map(needed).fold(nearest, f64::max);
        let eye = axes * centre.truncate().extend(height);
        let view = glam::dcamera::rh::view::look_to_mat4(eye, -direction, up);
        let (near, far) = (height - high.z, height - low.z);
        let projection = glam::dcamera::rh::proj::directx::perspective(
            FIELD_OF_VIEW,
            aspect,
            near - 0.01 * size,
            far + 0.01 * size,
        );
        Self {
            clip_from_world: projection * view,
            direction,
        }
    }

    fn clip(&self, point: Vec3) -> Vec4 {
        (self.clip_from_world * point.as_dvec3().extend(1.0)).as_vec4()
    }
}

/// A place on a triangle that is seen in a pixel.
#[derive(Debug, Clone, Copy)]
pub struct Fragment {
    /// Which triangle.
    pub triangle: usize,
    /// Where on it; they sum to 1.
    pub barycentric: [f32; 3],
    /// Their gradients on the screen, per pixel of the finished picture.
    pub gradients: [Vec2; 3],
}

impl Fragment {
    /// A number given at the corners, here; and its gradient per pixel.
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

/// Nothing was drawn to it.
const BACKGROUND: u32 = u32::MAX;

/// Rows of pixels that a thread draws at a time.
const BAND: usize = 32;

/// Draws triangles on a ground, both sides, antialiased: `shade` is asked at each sample.
pub fn draw(
    corners: &[[Vec3; 3]],
    eye: &Eye,
    (width, height): (usize, usize),
    antialiasing: Antialiasing,
    ground: Rgb,
    shade: impl Fn(&Fragment) -> Rgb + Sync,
) -> Image<Rgb> {
    let grid = Supersampler::new(width, height, antialiasing);
    let clipped: Vec<[Vec4; 3]> = corners.iter().map(|t| t.map(|p| eye.clip(p))).collect();
    let mut image = Image::filled(width, height, Rgb::BLACK);
    let bands = image.pixels_mut().par_chunks_mut(BAND * width.max(1));
    bands.enumerate().for_each(|(band, out)| {
        let pixels = BAND * band..(BAND * (band + 1)).min(height);
        let samples = samples(&clipped, &grid, grid.rows(pixels.clone()), ground, &shade);
        grid.resolve(pixels, &samples, out);
    });
    image
}

/// Some rows of the grid of samples.
fn samples(
    clipped: &[[Vec4; 3]],
    grid: &Supersampler,
    rows: core::ops::Range<usize>,
    ground: Rgb,
    shade: &impl Fn(&Fragment) -> Rgb,
) -> Vec<Rgb> {
    let (width, height) = grid.size();
    let viewport = Viewport::new(grid.columns(), grid.rows(0..height).end);
    let count = rows.len() * viewport.width;
    let mut depth = vec![DepthBuffer::EMPTY; count];
    let mut ids = vec![BACKGROUND; count];
    for (id, triangle) in (0..).zip(clipped) {
        draw_ids(
            rows.clone(),
            viewport,
            Cull::None,
            triangle,
            id,
            &mut depth,
            &mut ids,
        );
    }
    let per_pixel = viewport.width as f32 / width.max(1) as f32;
    let mut planes = (BACKGROUND, None);
    let color = |(i, &id): (usize, &u32)| {
        if id == BACKGROUND {
            return ground;
        }
        if planes.0 != id {
            planes = (id, barycentric_planes(viewport, &clipped[id as usize]));
        }
        let Some(planes) = &planes.1 else {
            return ground;
        };
        let (x, y) = (i % viewport.width, rows.start + i / viewport.width);
        let pixel = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        shade(&fragment(id as usize, planes, pixel, per_pixel))
    };
    ids.iter().enumerate().map(color).collect()
}

fn barycentric_planes(viewport: Viewport, triangle: &[Vec4; 3]) -> Option<TexcoordPlanes> {
    TexcoordPlanes::new(viewport, triangle, &[Vec2::ZERO, Vec2::X, Vec2::Y])
}

fn fragment(triangle: usize, planes: &TexcoordPlanes, pixel: DVec2, per_pixel: f32) -> Fragment {
    let found = planes.at(pixel);
    // Corners are snapped when drawn, so a centre on the border may lie a hair outside.
    let (b, c) = (found.uv.x.clamp(0.0, 1.0), found.uv.y.clamp(0.0, 1.0));
    let b_gradient = Vec2::new(found.ddx.x, found.ddy.x) * per_pixel;
    let c_gradient = Vec2::new(found.ddx.y, found.ddy.y) * per_pixel;
    Fragment {
        triangle,
        barycentric: [(1.0 - b - c).max(0.0), b, c],
        gradients: [-b_gradient - c_gradient, b_gradient, c_gradient],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> [[Vec3; 3]; 2] {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let [a, b, c, d] = [
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ];
        [[a, b, c], [a, c, d]]
    }

    #[test]
    fn values_and_gradients_are_those_of_the_plane() {
        let square = square();
        let eye = Eye::around(square.as_flattened(), DVec3::Z, (100, 100));
        let image = draw(
            &square,
            &eye,
            (100, 100),
            Antialiasing::NONE,
            Rgb::BLACK,
            |f| {
                let (x, change) = f.interpolate(square[f.triangle].map(|p| p.x));
                Rgb::new(
                    x + 2.0,
                    change.length(),
                    f.place(square[f.triangle]).y + 2.0,
                )
            },
        );
        let (left, right) = (image.pixel(40, 50), image.pixel(60, 50));
        let slope = (right.r - left.r) / 20.0;
        assert!(
            (left.g / slope - 1.0).abs() < 1e-3,
            "gradient {}, difference {slope}",
            left.g
        );
        assert!(image.pixel(50, 30).b > image.pixel(50, 70).b, "y points up");
        assert_eq!(*image.pixel(0, 0), Rgb::BLACK, "the ground");
    }

    #[test]
    fn all_points_are_in_the_picture() {
        let far = [
            Vec3::new(1e6, 0.0, 0.0),
            Vec3::new(1e6, 3.0, 1.0),
            Vec3::new(1e6, -3.0, 0.5),
        ];
        let views = [(200, 50), (50, 200)]
            .into_iter()
            .flat_map(|size| [[1.0, 0.4, 0.2], [0.0, -1.0, 0.0], [0.0; 3]].map(|d| (size, d)));
        for (size, direction) in views {
            let eye = Eye::around(&far, direction.into(), size);
            for p in far {
                let p = eye.clip(p);
                assert!(
                    p.x.abs() <= p.w && p.y.abs() <= p.w && (0.0..=p.w).contains(&p.z),
                    "{p}"
                );
            }
        }
    }
}
