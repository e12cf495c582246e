//! What sees what: rays against the scene's faces through an `obvhs` BVH.

use crate::patch::face::{Side, WorldFace};
use glam::{Vec3, Vec3A};
use hemicube_raster::Rgb;
use hemicube_scene::{Material, Scene};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use std::sync::Arc;
use std::time::Duration;

/// Rays start and end this share of the coordinates' size off the surfaces, so that a surface does not hide itself.
const OFFSET: f32 = 1e-5;

/// Panes that one ray may cross before it counts as absorbed.
const MAX_PANES: usize = 32;

/// A ray's first meeting with a surface.
#[derive(Debug, Clone, Copy)]
pub struct Hit {
    /// Index into the faces.
    pub face: usize,
    /// The side that was hit.
    pub side: Side,
    /// Where.
    pub point: Vec3,
    /// Distance from the ray's origin.
    pub distance: f32,
}

/// Answers visibility queries between the faces of a scene.
pub struct Visibility {
    scene: Arc<Scene>,
    faces: Arc<[WorldFace]>,
    bvh: CwBvh,
    /// Triangles in the order of the BVH's leaves.
    triangles: Vec<RtTriangle>,
    face_of_triangle: Vec<u32>,
    /// For each face whether light may pass straight through it; empty if none does.
    transmits: Vec<bool>,
    tinted: bool,
    diameter: f32,
}

impl core::fmt::Debug for Visibility {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Visibility")
            .field("triangles", &self.triangles.len())
            .finish_non_exhaustive()
    }
}

impl Visibility {
    /// Builds the BVH over the faces of a scene.
    pub fn new(scene: Arc<Scene>, faces: Arc<[WorldFace]>) -> Self {
        let mut triangles = Vec::with_capacity(faces.len() * 2);
        let mut owners = Vec::with_capacity(faces.len() * 2);
        for (number, face) in faces.iter().enumerate() {
            for corners in face.triangles() {
                let [v0, v1, v2] = corners.map(|c| Vec3A::from(face.corners[c]));
                triangles.push(Triangle { v0, v1, v2 });
                owners.push(u32::try_from(number).expect("a mesh has fewer than 2^32 faces"));
            }
        }
        let bvh = build_cwbvh_from_tris(
            &triangles,
            BvhBuildParams::medium_build(),
            &mut Duration::default(),
        );
        let ordered = |i: &u32| RtTriangle::from(&triangles[*i as usize]);
        let through: Vec<bool> = scene.materials.iter().map(Material::may_transmit).collect();
        let transmits: Vec<bool> = faces.iter().map(|f| through[f.material as usize]).collect();
        let any = transmits.contains(&true);
        Self {
            triangles: bvh.primitive_indices.iter().map(ordered).collect(),
            face_of_triangle: bvh
                .primitive_indices
                .iter()
                .map(|&i| owners[i as usize])
                .collect(),
            tinted: any && scene.materials.iter().any(|m| m.transmission > 0.0),
            transmits: if any { transmits } else { Vec::new() },
            diameter: diameter(&faces),
            bvh,
            scene,
            faces,
        }
    }

    /// Whether a side of a face receives light; the others only block and absorb.
    pub fn receives(&self, face: usize, side: Side) -> bool {
        let lit = self.scene.materials[self.faces[face].material as usize].lit_sides();
        lit > side as usize
    }

    /// Length of the diagonal around all faces: farther away there is nothing.
    pub fn diameter(&self) -> f32 {
        self.diameter
    }

    /// Whether light may change its colour on the way, so that factors differ between bands.
    pub fn is_tinted(&self) -> bool {
        self.tinted
    }

    /// A distance that is safely more than rounding errors at a point: those of its coordinates, and those of
    /// intersections, which grow with the triangles.
    pub fn offset(&self, point: Vec3) -> f32 {
        OFFSET * point.abs().max_element().max(0.1 * self.diameter)
    }

    /// A point moved off its surface to the side of the normal.
    pub fn off_surface(&self, point: Vec3, normal: Vec3) -> Vec3 {
        point + normal * self.offset(point)
    }

    /// First surface along a ray, whatever it is made of. The direction must have unit length.
    ///
    /// Sides that do not receive lag behind by an [offset](Self::offset): a plate is often two one-sided faces in one
    /// place, and a ray must meet the front that looks at it, not the back of the other.
    pub fn first_hit(&self, origin: Vec3, direction: Vec3, max_distance: f32) -> Option<Hit> {
        let ray = ray(origin, direction, max_distance);
        let mut hit = RayHit::none();
        let found = self.bvh.ray_traverse(ray, &mut hit, |ray, i| {
            let t = self.triangles[i].intersect(ray);
            if t < ray.tmax {
                t + self.lag(i, direction, origin + direction * t)
            } else {
                t
            }
        });
        found.then(|| {
            let (face, side) = self.met(hit.primitive_id as usize, direction);
            Hit {
                face,
                side,
                point: origin + direction * hit.t,
                distance: hit.t,
            }
        })
    }

    /// The face of a triangle, and the side that a ray sees of it.
    fn met(&self, triangle: usize, direction: Vec3) -> (usize, Side) {
        let face = self.face_of_triangle[triangle] as usize;
        let facing = self.faces[face].normal.dot(direction) < 0.0;
        (face, if facing { Side::Front } else { Side::Back })
    }

    /// How far a hit counts as farther away than it is.
    fn lag(&self, triangle: usize, direction: Vec3, point: Vec3) -> f32 {
        let (face, side) = self.met(triangle, direction);
        if self.receives(face, side) {
            0.0
        } else {
            self.offset(point)
        }
    }

    /// Whether nothing at all lies between two points, each already off its surface.
    fn is_clear(&self, from: Vec3, to: Vec3) -> bool {
        let ray = segment(from, to);
        self.bvh
            .ray_traverse_miss(ray, |ray, i| self.triangles[i].intersect(ray))
    }

    /// Share of light in each band that gets from one point to another, each already off its surface.
    pub fn transmittance(&self, from: Vec3, to: Vec3) -> Rgb {
        if self.transmits.is_empty() {
            return if self.is_clear(from, to) {
                Rgb::WHITE
            } else {
                Rgb::BLACK
            };
        }
        let mut through = Rgb::WHITE;
        let ray = segment(from, to);
        let clear = self.bvh.ray_traverse_miss(ray, |ray, i| {
            let t = self.triangles[i].intersect(ray);
            if t > ray.tmax {
                return f32::INFINITY;
            }
            let face = self.face_of_triangle[i] as usize;
            if !self.transmits[face] {
                return t;
            }
            through *= self.transmittance_at(face, from + Vec3::from(ray.direction) * t);
            if through.is_black() { t } else { f32::INFINITY }
        });
        if clear { through } else { Rgb::BLACK }
    }

    /// Share of light that passes straight through a face at a point.
    pub fn transmittance_at(&self, face: usize, point: Vec3) -> Rgb {
        if self.transmits.get(face) != Some(&true) {
            return Rgb::BLACK;
        }
        self.faces[face]
            .surface_at(&self.scene, point)
            .transmittance
    }

    /// Follows a ray through panes and holes. `visit` gets every surface met, the share of light in each band that
    /// arrives there and the share of that which passes on; what is returned left the scene.
    pub fn follow(
        &self,
        origin: Vec3,
        direction: Vec3,
        mut visit: impl FnMut(&Hit, Rgb, Rgb),
    ) -> Rgb {
        let mut arriving = Rgb::WHITE;
        let mut start = origin;
        for _ in 0..MAX_PANES {
            let Some(hit) = self.first_hit(start, direction, f32::INFINITY) else {
                return arriving;
            };
            let passing = self.transmittance_at(hit.face, hit.point);
            visit(&hit, arriving, passing);
            arriving *= passing;
            if arriving.max_band() < 1e-4 {
                break;
            }
            // Off the pane to its other side: along a grazing ray the same pane would be met again.
            let normal = self.faces[hit.face].normal;
            start = self.off_surface(hit.point, normal * normal.dot(direction).signum());
        }
        Rgb::BLACK
    }
}

/// A ray from its origin. Adding 0 turns components of -0 into 0: the traversal takes the octant from the sign of the
/// direction in one place and from that of its inverse in another, and loses rays where they differ.
fn ray(origin: Vec3, direction: Vec3, max_distance: f32) -> Ray {
    Ray::new(
        origin.into(),
        (direction + Vec3::ZERO).into(),
        0.0,
        max_distance,
    )
}

/// The ray from one point to another, of unit length: the traversal's limits on small components are absolute.
fn segment(from: Vec3, to: Vec3) -> Ray {
    let length = from.distance(to);
    ray(from, (to - from) / length.max(f32::MIN_POSITIVE), length)
}

fn diameter(faces: &[WorldFace]) -> f32 {
    let nothing = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
    let corners = faces.iter().flat_map(WorldFace::polygon);
    let (low, high) = corners.fold(nothing, |(low, high), &p| (low.min(p), high.max(p)));
    low.distance(high)
}
