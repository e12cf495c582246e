//! A stage for exhibits on surfaces: a camera, meshes, and a closure that shades each pixel of them.
//!
//! Visibility is an item buffer; where on its triangle a sample lies follows from the corners in f64, with exact derivatives
//! ([`draw_hits`]).

mod hits;
mod meshes;

pub(crate) use hits::{Hit, draw_hits};
pub(crate) use meshes::{Mesh, Vertex};

use glam::{Mat4, Vec2, Vec3, Vec4};
use hemicube_raster::antialias::{Antialiasing, Factor};
use hemicube_raster::{Image, Rgb};

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
    /// Samples along each side of a pixel, up to 32; their mean is the pixel.
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
    let clip_from_world = camera.clip_from_world(width as f32 / height.max(1) as f32);
    let mut triangles = Vec::new();
    // For each of them its mesh and which one it is there.
    let mut places = Vec::new();
    for (m, mesh) in meshes.iter().enumerate() {
        let clip = |v: &Vertex| clip_from_world * v.position.extend(1.0);
        let positions: Vec<Vec4> = mesh.vertices.iter().map(clip).collect();
        for (t, corners) in mesh.triangles.iter().enumerate() {
            triangles.push(corners.map(|vertex| positions[vertex as usize]));
            places.push((m, t));
        }
    }
    let factor = Factor::new(sampling.per_side).unwrap_or(Factor::ONE);
    let antialiasing = Antialiasing::regular(factor);
    draw_hits(&triangles, sampling.size, antialiasing, background, |hit| {
        let (m, t) = places[hit.triangle];
        let corners = meshes[m].triangles[t];
        let vertices = corners.map(|vertex| meshes[m].vertices[vertex as usize]);
        shade(&fragment(camera, m, &vertices, hit))
    })
}

/// What a sample sees, between three vertices.
fn fragment(camera: &Camera, mesh: usize, vertices: &[Vertex; 3], hit: &Hit) -> Fragment {
    let sum3 = |w: [f32; 3], of: fn(&Vertex) -> Vec3| -> Vec3 {
        of(&vertices[0]) * w[0] + of(&vertices[1]) * w[1] + of(&vertices[2]) * w[2]
    };
    let sum2 = |w: [f32; 3]| -> Vec2 {
        let [p, q, r] = vertices.each_ref().map(|v| v.texcoord);
        p * w[0] + q * w[1] + r * w[2]
    };
    let weights = hit.barycentric;
    let derivatives = [0, 1].map(|axis| hit.gradients.map(|g| g[axis]));
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
        view: (camera.eye - position).normalize_or_zero(),
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
