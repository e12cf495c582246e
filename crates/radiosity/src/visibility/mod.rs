//! What sees what: rays against the scene's faces.
//!
//! Faces become quads, neighbouring triangles in pairs; eight quads are tested at once and without gaps along edges,
//! below a hierarchy of boxes with eight children a node. Triangles smaller than about 1e-12 in some dimension are lost
//! to underflow.

mod batch;
mod pairing;
mod quads;
mod ray;
mod wide_bvh;

use self::ray::Ray;
use self::wide_bvh::WideBvh;
use crate::patch::face::{Side, WorldFace};
use glam::Vec3;
use hemicube_raster::Rgb;
use hemicube_scene::{Material, Scene};
use std::sync::Arc;

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
    bvh: WideBvh,
    /// Of each face, side by side: a face itself is far larger, and all that most hits want of it is its side.
    normals: Vec<Vec3>,
    /// For each face whether light may pass straight through it; empty if none does.
    transmits: Vec<bool>,
    tinted: bool,
    diameter: f32,
    largest_offset: f32,
}

impl core::fmt::Debug for Visibility {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Visibility")
            .field("faces", &self.faces.len())
            .finish_non_exhaustive()
    }
}

impl Visibility {
    /// Builds the BVH over the faces of a scene.
    pub fn new(scene: Arc<Scene>, faces: Arc<[WorldFace]>) -> Self {
        let through: Vec<bool> = scene.materials.iter().map(Material::may_transmit).collect();
        let transmits: Vec<bool> = faces.iter().map(|f| through[f.material as usize]).collect();
        let any = transmits.contains(&true);
        Self {
            tinted: any && scene.materials.iter().any(|m| m.transmission > 0.0),
            transmits: if any { transmits } else { Vec::new() },
            diameter: Self::diameter_of(&faces),
            largest_offset: Self::largest_offset_of(&faces),
            normals: faces.iter().map(|face| face.normal).collect(),
            bvh: WideBvh::new(&pairing::quads(&faces)),
            scene,
            faces,
        }
    }

    /// Whether a side of a face receives light; the others only block and absorb.
    pub fn receives(&self, face: usize, side: Side) -> bool {
        let lit = self.scene.materials[self.faces[face].material as usize].lit_sides();
        lit > side as usize
    }

    /// Unit normal of a face.
    pub fn normal(&self, face: usize) -> Vec3 {
        self.normals[face]
    }

    /// Length of the diagonal around all faces: farther away there is nothing.
    pub fn diameter(&self) -> f32 {
        self.diameter
    }

    /// [`Self::diameter`] of faces.
    pub(crate) fn diameter_of(faces: &[WorldFace]) -> f32 {
        let corners = faces.iter().flat_map(WorldFace::polygon);
        let around = |(low, high): (Vec3, Vec3), p: &Vec3| (low.min(*p), high.max(*p));
        let (low, high) = corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), around);
        low.distance(high)
    }

    /// Whether light may change its colour on the way, so that factors differ between bands.
    pub fn is_tinted(&self) -> bool {
        self.tinted
    }

    /// A distance that is safely more than rounding errors at a point: those of its coordinates, and those of
    /// intersections, which grow with the triangles.
    pub fn offset(&self, point: Vec3) -> f32 {
        Self::offset_in(self.diameter, point)
    }

    /// [`Self::offset`] where it is largest.
    pub(crate) fn largest_offset(&self) -> f32 {
        self.largest_offset
    }

    /// [`Self::largest_offset`] of faces.
    pub(crate) fn largest_offset_of(faces: &[WorldFace]) -> f32 {
        let corners = faces.iter().flat_map(WorldFace::polygon);
        let reach = corners.fold(Vec3::ZERO, |reach, p| reach.max(p.abs()));
        Self::offset_in(Self::diameter_of(faces), reach)
    }

    /// [`Self::offset`] in a scene of a [diameter](Self::diameter).
    pub(crate) fn offset_in(diameter: f32, point: Vec3) -> f32 {
        OFFSET * point.abs().max_element().max(0.1 * diameter)
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
        let ray = Ray::new(origin, direction, max_distance, self.bvh.extent());
        let lag = |face: u32, distance: f32| self.lag(face as usize, direction, origin, distance);
        let met = self.bvh.closest(&ray, lag)?;
        let face = met.face as usize;
        Some(Hit {
            face,
            side: self.side_met(face, direction),
            point: origin + direction * met.distance,
            distance: met.distance,
        })
    }

    /// The side that a ray meets of a face.
    fn side_met(&self, face: usize, direction: Vec3) -> Side {
        if self.normals[face].dot(direction) < 0.0 {
            Side::Front
        } else {
            Side::Back
        }
    }

    /// How far a hit counts as farther away than it is.
    fn lag(&self, face: usize, direction: Vec3, origin: Vec3, distance: f32) -> f32 {
        if self.receives(face, self.side_met(face, direction)) {
            0.0
        } else {
            self.offset(origin + direction * distance)
        }
    }

    /// Whether nothing at all lies between two points, each already off its surface. Panes and holes of alpha masks
    /// are in the way too.
    pub fn is_clear(&self, from: Vec3, to: Vec3) -> bool {
        self.bvh
            .is_clear(&Ray::between(from, to, self.bvh.extent()))
    }

    /// [`Self::is_clear`] of many segments, in four fifths of the time.
    ///
    /// # Panics
    /// If `clear` does not have the length of `segments`.
    pub fn clear_segments(&self, segments: &[(Vec3, Vec3)], clear: &mut [bool]) {
        assert!(
            segments.len() == clear.len(),
            "{} answers for {} segments",
            clear.len(),
            segments.len()
        );
        self.bvh.clear_segments(segments, clear);
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
        let ray = Ray::between(from, to, self.bvh.extent());
        let clear = self.bvh.passes(&ray, |met| {
            let face = met.face as usize;
            through *= self.transmittance_at(face, from.lerp(to, met.distance));
            through.is_black()
        });
        if clear { through } else { Rgb::BLACK }
    }

    /// [`Self::transmittance`] of many segments.
    pub fn transmittances(&self, segments: &[(Vec3, Vec3)], through: &mut Vec<Rgb>) {
        through.clear();
        if self.transmits.is_empty() {
            let mut clear = vec![false; segments.len()];
            self.clear_segments(segments, &mut clear);
            let share = |is_clear| if is_clear { Rgb::WHITE } else { Rgb::BLACK };
            through.extend(clear.into_iter().map(share));
        } else {
            let pairs = segments.iter();
            through.extend(pairs.map(|&(from, to)| self.transmittance(from, to)));
        }
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
