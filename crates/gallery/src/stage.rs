//! A stage for exhibits on surfaces: a camera, meshes, and a closure that shades each pixel of them.
//!
//! Visibility is the rasteriser's z-buffer. What a pixel sees there is computed anew from the triangle in f64, with exact
//! derivatives: with `M` the matrix whose columns are the corners' clip-space `(x, y, w)`, the barycentric coordinates
//! of the point seen at `(X, Y)` are `b = l / (l_0 + l_1 + l_2)`, `l = M^-1 (X, Y, 1)` (Olano and Greer, *Triangle scan
//! conversion using 2D homogeneous coordinates*, Graphics Hardware 1997).

mod meshes;
mod sheet;

pub(crate) use meshes::{Mesh, Vertex};
pub(crate) use sheet::{Cell, Grid};

use core::ops::Range;
use glam::{DMat3, DVec3, Mat4, Vec2, Vec3, Vec4};
use hemicube_raster::triangle::{ClipVertex, Cull, DepthBuffer, Viewport, draw_triangle};
use hemicube_raster::{Image, Rgb};
use rayon::prelude::*;

/// A pinhole camera.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Camera {
    /// Where it stands.
    pub eye: Vec3,
    /// What it looks at.
    pub target: Vec3,
    /// Angle between the picture's upper and lower edge, in radians.
    pub vertical_fov: f32,
}

impl Camera {
    /// Nearest and farthest distance seen, as multiples of the distance to the target.
    const DEPTHS: [f32; 2] = [0.01, 100.0];

    /// From one point to another, with +Y up.
    pub fn new(eye: Vec3, target: Vec3, vertical_fov_degrees: f32) -> Self {
        Self {
            eye,
            target,
            vertical_fov: vertical_fov_degrees.to_radians(),
        }
    }

    /// Clip space from the world, for a picture of such an aspect (width by height).
    fn clip_from_world(&self, aspect: f32) -> Mat4 {
        let distance = self.eye.distance(self.target);
        let [near, far] = Self::DEPTHS.map(|k| k * distance);
        glam::camera::rh::proj::directx::perspective(self.vertical_fov, aspect, near, far)
            * glam::camera::rh::view::look_at_mat4(self.eye, self.target, Vec3::Y)
    }
}

/// What a sample of the picture sees of a mesh. Derivatives are by the sample's column (to the right) and row (down).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fragment {
    /// Which of the meshes.
    pub mesh: usize,
    /// Place in the world.
    pub position: Vec3,
    /// Its derivatives.
    pub d_position: [Vec3; 2],
    /// Interpolated normal, of length 1.
    pub normal: Vec3,
    /// Derivatives of the normal of length 1.
    pub d_normal: [Vec3; 2],
    /// Texture coordinates.
    pub texcoord: Vec2,
    /// Their derivatives.
    pub d_texcoord: [Vec2; 2],
    /// Interpolated tangent (not of length 1) and the bitangent's sign.
    pub tangent: Vec4,
    /// Direction to the eye, of length 1.
    pub view: Vec3,
}

impl Fragment {
    /// Derivatives of the place by u and v. `None` where the texture has no area on the screen.
    pub fn d_position_by_texcoord(&self) -> Option<[Vec3; 2]> {
        let [dx, dy] = self.d_texcoord;
        let [px, py] = self.d_position;
        let inverse = 1.0 / dx.perp_dot(dy);
        let by = [
            (px * dy.y - py * dx.y) * inverse,
            (py * dx.x - px * dy.x) * inverse,
        ];
        by.iter().all(|d| d.is_finite()).then_some(by)
    }
}

/// How a picture is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Sampling {
    /// Width and height of the picture in pixels.
    pub size: (usize, usize),
    /// Samples along each side of a pixel; their mean is the pixel.
    pub per_side: usize,
}

/// Draws front and back sides of the meshes; where none is seen, the picture shows `background`.
pub(crate) fn draw(
    camera: &Camera,
    sampling: Sampling,
    meshes: &[&Mesh],
    background: Rgb,
    shade: impl Fn(&Fragment) -> Rgb + Sync,
) -> Image<Rgb> {
    let (width, height) = sampling.size;
    let per_side = sampling.per_side.max(1);
    let mut image = Image::filled(width, height, background);
    if width == 0 || height == 0 {
        return image;
    }
    let viewport = Viewport::new(width * per_side, height * per_side);
    let clip_from_world = camera.clip_from_world(width as f32 / height as f32);
    let positions: Vec<Vec<Vec4>> = meshes
        .iter()
        .map(|mesh| {
            let vertices = mesh.vertices.iter();
            vertices
                .map(|v| clip_from_world * v.position.extend(1.0))
                .collect()
        })
        .collect();
    let stage = Stage {
        camera,
        viewport,
        meshes,
        positions,
    };
    let bins = stage.bins(ROWS_PER_BAND * per_side);
    let rows = image.pixels_mut().par_chunks_mut(width * ROWS_PER_BAND);
    rows.enumerate().for_each(|(band, pixels)| {
        let first = band * ROWS_PER_BAND * per_side;
        let rows = first..first + pixels.len() / width * per_side;
        let samples = stage.shade_rows(rows, &bins[band], &shade);
        average(&samples, per_side, width, background, pixels);
    });
    image
}

/// Pixel rows that are drawn at a time.
const ROWS_PER_BAND: usize = 16;

/// Means of the samples of each pixel, those without a mesh being background.
fn average(
    samples: &[Option<Rgb>],
    per_side: usize,
    width: usize,
    background: Rgb,
    pixels: &mut [Rgb],
) {
    let share = 1.0 / (per_side * per_side) as f32;
    for (i, pixel) in pixels.iter_mut().enumerate() {
        let (x, y) = (i % width * per_side, i / width * per_side);
        let rows = (y..y + per_side).map(|y| y * width * per_side + x);
        let of_pixel = rows.flat_map(|start| &samples[start..start + per_side]);
        *pixel = of_pixel.map(|s| s.unwrap_or(background)).sum::<Rgb>() * share;
    }
}

struct Stage<'a> {
    camera: &'a Camera,
    /// Of the samples.
    viewport: Viewport,
    meshes: &'a [&'a Mesh],
    /// Clip-space positions of the vertices of each mesh.
    positions: Vec<Vec<Vec4>>,
}

impl Stage<'_> {
    /// For each band of so many rows the triangles that may be seen there, as mesh and triangle, in their order.
    fn bins(&self, rows: usize) -> Vec<Vec<(usize, usize)>> {
        let mut bins = vec![Vec::new(); self.viewport.height.div_ceil(rows)];
        for (m, mesh) in self.meshes.iter().enumerate() {
            for (t, triangle) in mesh.triangles.iter().enumerate() {
                let corners = triangle.map(|vertex| self.positions[m][vertex as usize]);
                for bin in &mut bins[self.bands_of(&corners, rows)] {
                    bin.push((m, t));
                }
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
    fn bands_of(&self, corners: &[Vec4; 3], rows: usize) -> Range<usize> {
        let bands = self.viewport.height.div_ceil(rows);
        if !corners.iter().all(|p| p.w > 0.0) {
            return 0..bands;
        }
        let per_ndc = 0.5 * self.viewport.height as f32 / rows as f32;
        let [a, b, c] = corners.map(|p| (1.0 - p.y / p.w) * per_ndc);
        // A row more on both sides for corners that are rounded to sub-pixels.
        let margin = 1.0 / rows as f32;
        let first = (a.min(b).min(c) - margin).floor().clamp(0.0, bands as f32);
        let end = (a.max(b).max(c) + margin).ceil().clamp(first, bands as f32);
        first as usize..end as usize
    }

    /// The samples of some rows, `None` where no mesh is seen. `triangles` are those that may be seen there.
    fn shade_rows(
        &self,
        rows: Range<usize>,
        triangles: &[(usize, usize)],
        shade: &impl Fn(&Fragment) -> Rgb,
    ) -> Vec<Option<Rgb>> {
        let width = self.viewport.width;
        let seen = self.visible(rows.clone(), triangles);
        let sample = |(i, seen): (usize, &Option<(usize, usize)>)| {
            let (mesh, triangle) = (*seen)?;
            let fragment = self.fragment(mesh, triangle, i % width, rows.start + i / width)?;
            Some(shade(&fragment))
        };
        seen.iter().enumerate().map(sample).collect()
    }

    /// Mesh and triangle seen by each sample of some rows.
    fn visible(
        &self,
        rows: Range<usize>,
        triangles: &[(usize, usize)],
    ) -> Vec<Option<(usize, usize)>> {
        let width = self.viewport.width;
        let mut depths = vec![DepthBuffer::EMPTY; rows.len() * width];
        let mut seen = vec![None; depths.len()];
        for &(m, t) in triangles {
            let corners = self.meshes[m].triangles[t]
                .map(|vertex| ClipVertex::new(self.positions[m][vertex as usize], []));
            draw_triangle(
                rows.clone(),
                self.viewport,
                Cull::None,
                &corners,
                &mut depths,
                |x, y, _, []| {
                    seen[(y - rows.start) * width + x] = Some((m, t));
                    true
                },
            );
        }
        seen
    }

    /// What a sample sees of a triangle. `None` for a triangle seen edge-on.
    fn fragment(&self, mesh: usize, triangle: usize, x: usize, y: usize) -> Option<Fragment> {
        let corners = self.meshes[mesh].triangles[triangle].map(|vertex| vertex as usize);
        let columns = corners.map(|i| {
            let p = self.positions[mesh][i].as_dvec4();
            DVec3::new(p.x, p.y, p.w)
        });
        let inverse = DMat3::from_cols_array_2d(&columns.map(|c| c.to_array()))
            .try_inverse()
            .filter(|m| m.is_finite())?;
        let (w, h) = (self.viewport.width as f64, self.viewport.height as f64);
        let ndc = DVec3::new(
            (x as f64 + 0.5) * 2.0 / w - 1.0,
            1.0 - (y as f64 + 0.5) * 2.0 / h,
            1.0,
        );
        let weights = inverse * ndc;
        let sum = weights.element_sum();
        let b = weights / sum;
        let slope = |step: DVec3| {
            let dl = inverse * step;
            ((dl - b * dl.element_sum()) / sum).as_vec3()
        };
        let db = [
            slope(DVec3::new(2.0 / w, 0.0, 0.0)),
            slope(DVec3::new(0.0, -2.0 / h, 0.0)),
        ];
        let vertices = corners.map(|i| self.meshes[mesh].vertices[i]);
        Some(self.interpolate(mesh, &vertices, b.as_vec3(), db))
    }

    fn interpolate(&self, mesh: usize, vertices: &[Vertex; 3], b: Vec3, db: [Vec3; 2]) -> Fragment {
        let weights = b.to_array();
        let sum3 = |w: [f32; 3], of: fn(&Vertex) -> Vec3| -> Vec3 {
            of(&vertices[0]) * w[0] + of(&vertices[1]) * w[1] + of(&vertices[2]) * w[2]
        };
        let sum2 = |w: [f32; 3]| -> Vec2 {
            let [p, q, r] = vertices.each_ref().map(|v| v.texcoord);
            p * w[0] + q * w[1] + r * w[2]
        };
        let derivatives = db.map(|db| db.to_array());
        let position = sum3(weights, |v| v.position);
        let raw = sum3(weights, |v| v.normal);
        let length = raw.length().max(f32::MIN_POSITIVE);
        let normal = raw / length;
        let d_normal = derivatives.map(|w| {
            let d = sum3(w, |v| v.normal);
            (d - normal * normal.dot(d)) / length
        });
        let tangent = sum3(weights, |v| v.tangent.truncate());
        Fragment {
            mesh,
            position,
            d_position: derivatives.map(|w| sum3(w, |v| v.position)),
            normal,
            d_normal,
            texcoord: sum2(weights),
            d_texcoord: derivatives.map(sum2),
            tangent: tangent.extend(vertices[0].tangent.w),
            view: (self.camera.eye - position).normalize_or_zero(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    const CAMERA: Camera = Camera {
        eye: Vec3::new(0.6, 1.0, 2.5),
        target: Vec3::ZERO,
        vertical_fov: 0.7,
    };

    const SIZE: (usize, usize) = (40, 30);

    /// All fragments of a picture, by the place of their sample.
    fn fragments(mesh: &Mesh, sampling: Sampling) -> Vec<Fragment> {
        let all = Mutex::new(Vec::new());
        draw(&CAMERA, sampling, &[mesh], Rgb::BLACK, |fragment| {
            all.lock().expect("no panic").push(*fragment);
            Rgb::WHITE
        });
        all.into_inner().expect("no panic")
    }

    #[test]
    fn derivatives_are_those_of_the_projection() {
        let mesh = Mesh::plane(2.0, 1);
        let clip = CAMERA.clip_from_world(SIZE.0 as f32 / SIZE.1 as f32);
        let sampling = Sampling {
            size: SIZE,
            per_side: 1,
        };
        let on_screen = |p: Vec3| {
            let p = clip * p.extend(1.0);
            let half = Vec2::new(SIZE.0 as f32, SIZE.1 as f32) * 0.5;
            (Vec2::new(p.x, -p.y) / p.w + 1.0) * half
        };
        let all = fragments(&mesh, sampling);
        assert!(all.len() > 200, "{} samples", all.len());
        for f in all {
            let here = on_screen(f.position);
            assert!(
                (here - here.floor() - 0.5).length() < 1e-3,
                "{here} is a pixel centre"
            );
            let step = 1e-2;
            for (d, expected) in f.d_position.into_iter().zip([Vec2::X, Vec2::Y]) {
                let there = on_screen(f.position + d * step);
                let moved = (there - here) / step;
                assert!((moved - expected).length() < 0.02, "{moved} for {expected}");
            }
            let [pu, pv] = f.d_position_by_texcoord().expect("a textured plane");
            let error = (pu - Vec3::X * 2.0).length() + (pv - Vec3::Z * 2.0).length();
            assert!(error < 1e-4, "{pu} {pv}");
            // The plane's texture is laid over x and z.
            for (d, t) in f.d_position.into_iter().zip(f.d_texcoord) {
                assert!((Vec2::new(d.x, d.z) / 2.0 - t).length() < 1e-5, "{d} {t}");
            }
        }
    }

    #[test]
    fn sphere_covers_its_disc_and_shows_its_normals() {
        let mesh = Mesh::sphere(1.0, 96);
        let camera = Camera::new(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, 40.0);
        let sampling = Sampling {
            size: (64, 64),
            per_side: 2,
        };
        let image = draw(&camera, sampling, &[&mesh], Rgb::BLACK, |f| {
            assert!((f.position - f.normal).length() < 2e-3, "normal is place");
            Rgb::WHITE
        });
        let covered: f32 = image.pixels().iter().map(|p| p.r).sum();
        // Half the angle of view is 20 degrees for 32 pixels, the sphere's is asin(1/5).
        let radius = 32.0 * (0.2_f32.asin().tan() / 20.0_f32.to_radians().tan());
        let expected = core::f32::consts::PI * radius * radius;
        assert!(
            (covered / expected - 1.0).abs() < 0.01,
            "{covered} of {expected}"
        );
    }

    #[test]
    fn samples_do_not_depend_on_threads() {
        let mesh = Mesh::torus(0.8, 0.3, 48);
        let sampling = Sampling {
            size: (50, 37),
            per_side: 2,
        };
        let picture = || {
            draw(&CAMERA, sampling, &[&mesh], Rgb::BLACK, |f| {
                Rgb::splat(f.normal.y)
            })
        };
        let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build();
        let one = pool(1).expect("a thread").install(picture);
        let eight = pool(8).expect("threads").install(picture);
        assert_eq!(one, eight);
    }
}
