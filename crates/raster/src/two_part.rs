//! Two-part texture mapping: a texture first laid on a simple surface, then from there on any object.
//!
//! Bier and Sloan, *Two-part texture mappings* (IEEE Computer Graphics and Applications 6(9), 1986). The S map lays the
//! texture on an intermediate surface around the object ([`SMap`]: plane, cylinder, sphere or box), the O map says which
//! point of it an object's point takes ([`OMap`]: along the reflected ray, the object's normal, the line from the
//! centroid, or the intermediate surface's normal). Any of the four goes with any of the four:
//!
//! | | reflected ray | object normal | centroid | intermediate normal |
//! |---|---|---|---|---|
//! | plane | | | | slide projector |
//! | cylinder | | | | shrink wrap |
//! | sphere | environment | | globe | = centroid from its centre |
//! | box | environment | | globe | six projectors |
//!
//! For rendering both are used backwards, at each pixel. Derivatives of the texture coordinate for a filter's footprint
//! are exact ([`TwoPart::map`]): they are those of the branch that the pixel itself takes, so neither the jump of u from
//! 1 to 0 nor the edge between two faces of a box gives a pixel a footprint as wide as the texture, which would draw a
//! blurred line there.

mod distortion;
mod dual;
mod intermediate;

pub use distortion::{Distortion, DistortionSummary, surface_frame};
pub use intermediate::{BoxLayout, SMap, SphereLayout};

use dual::{Dual, Dual3};
use glam::{DMat3, DVec2, DVec3, Quat, Vec2, Vec3};
use intermediate::{Hit, Ray};

/// Which point of the intermediate surface a point of the object takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OMap {
    /// The one that the reflected ray of vision arrives at: the texture moves with the eye, as a reflection does.
    ReflectedRay,
    /// The one that the object's normal points at.
    ObjectNormal,
    /// The one that lies on the line from the object's centroid through the point.
    Centroid(Vec3),
    /// The one whose own normal goes through the point.
    IntermediateNormal,
}

/// A surface point to be textured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Its place.
    pub point: Vec3,
    /// The object's normal there; its length does not matter.
    pub normal: Vec3,
    /// From the point towards the eye; its length does not matter. Only [`OMap::ReflectedRay`] looks at it.
    pub view: Vec3,
    /// Derivatives of the place by two parameters: a pixel's column and row, or lengths along two tangents.
    pub d_point: [Vec3; 2],
    /// Derivatives of the normal, in the same length.
    pub d_normal: [Vec3; 2],
    /// Derivatives of the vector to the eye, in the same length. If that is `eye - point`, they are `-d_point`.
    pub d_view: [Vec3; 2],
}

impl SurfacePoint {
    /// A point without derivatives.
    pub const fn new(point: Vec3, normal: Vec3, view: Vec3) -> Self {
        Self {
            point,
            normal,
            view,
            d_point: [Vec3::ZERO; 2],
            d_normal: [Vec3::ZERO; 2],
            d_view: [Vec3::ZERO; 2],
        }
    }
}

/// A place in the texture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mapped {
    /// Texture coordinate: origin in the upper left corner, u right, v down; in [0, 1] on the texture itself.
    pub texcoord: Vec2,
    /// Its derivatives by the two parameters of the surface point.
    pub d_texcoord: [Vec2; 2],
    /// The face of the intermediate surface ([`SMap`]); textures do not go on smoothly from one to another.
    pub face: usize,
}

/// A line of a two-part mapping, to be drawn in a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trace {
    /// The object's point, or the centroid where the line starts there.
    pub from: Vec3,
    /// The point of the intermediate surface.
    pub to: Vec3,
}

/// An S map with an O map, and where the intermediate surface stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoPart {
    /// How the texture lies on the intermediate surface.
    pub s: SMap,
    /// How it comes from there to the object.
    pub o: OMap,
    /// Centre of the intermediate surface. Default value: the origin.
    pub center: Vec3,
    /// How the intermediate surface is turned, of length 1. Default value: not at all.
    pub rotation: Quat,
}

impl TwoPart {
    /// Both parts, the intermediate surface around the origin.
    pub const fn new(s: SMap, o: OMap) -> Self {
        Self {
            s,
            o,
            center: Vec3::ZERO,
            rotation: Quat::IDENTITY,
        }
    }

    /// With the intermediate surface around another centre.
    pub const fn with_center(self, center: Vec3) -> Self {
        Self { center, ..self }
    }

    /// With the intermediate surface turned.
    pub const fn with_rotation(self, rotation: Quat) -> Self {
        Self { rotation, ..self }
    }

    /// The texture coordinate and the face of a point with a normal and the direction to the eye.
    ///
    /// `None` where the mapping is not defined: the line is parallel to a plane, leads away from it or misses the surface;
    /// the normal (where it is needed), the vector to the eye (where it is needed) or the one from the centroid is zero;
    /// the point lies on the axis or in the centre whose normal is asked for; it is the pole from which the stereographic
    /// projection projects; a number is not finite.
    ///
    /// ```
    /// use glam::{Vec2, Vec3};
    /// use hemicube_raster::two_part::{OMap, SMap, TwoPart};
    ///
    /// let globe = TwoPart::new(SMap::sphere(1.0), OMap::Centroid(Vec3::ZERO));
    /// let (texcoord, face) = globe.texcoord(Vec3::Z * 0.3, Vec3::X, Vec3::Z).unwrap();
    /// assert_eq!((texcoord, face), (Vec2::splat(0.5), 0));
    /// ```
    pub fn texcoord(&self, point: Vec3, normal: Vec3, view: Vec3) -> Option<(Vec2, usize)> {
        let mapped = self.map(&SurfacePoint::new(point, normal, view))?;
        Some((mapped.texcoord, mapped.face))
    }

    /// The texture coordinate with its exact derivatives (dual numbers all the way). Where a pole makes them infinite
    /// there is no texture coordinate; where u turns around a pole within less than a pixel they are as large as that.
    pub fn map(&self, surface: &SurfacePoint) -> Option<Mapped> {
        let (_, hit) = self.meet(surface)?;
        let [u, v] = self.s.texcoord(&hit);
        let of = |get: fn(&Dual) -> f64| DVec2::new(get(&u), get(&v)).as_vec2();
        let mapped = Mapped {
            texcoord: of(|c| c.value),
            d_texcoord: [of(|c| c.d[0]), of(|c| c.d[1])],
            face: hit.face,
        };
        let [dx, dy] = mapped.d_texcoord;
        let is_finite = mapped.texcoord.is_finite() && dx.is_finite() && dy.is_finite();
        is_finite.then_some(mapped)
    }

    /// The line that a point takes its texture along.
    pub fn trace(&self, surface: &SurfacePoint) -> Option<Trace> {
        let (from, hit) = self.meet(surface)?;
        let rotation = self.rotation.as_dquat();
        let world = |p: DVec3| (rotation * p + self.center.as_dvec3()).as_vec3();
        Some(Trace {
            from: world(from.value()),
            to: world(hit.point.value()),
        })
    }

    /// Start and end of the line, in the frame of the intermediate surface.
    fn meet(&self, surface: &SurfacePoint) -> Option<(Dual3, Hit)> {
        let inverse = DMat3::from_quat(self.rotation.as_dquat().conjugate());
        let center = self.center.as_dvec3();
        let p = local(surface.point.as_dvec3() - center, surface.d_point, inverse);
        let normal = || local(surface.normal.as_dvec3(), surface.d_normal, inverse);
        let (start, hit) = match self.o {
            OMap::IntermediateNormal => (p, self.s.foot(p)),
            OMap::ReflectedRay => {
                let view = surface.view.as_dvec3();
                let v = local(view, surface.d_view, inverse).non_zero()?;
                let n = normal().normalized()?;
                let direction = n.scaled(n.dot(v) * 2.0) - v;
                (p, self.exit(p, direction))
            }
            OMap::ObjectNormal => (p, self.exit(p, normal().non_zero()?)),
            OMap::Centroid(centroid) => {
                let c = local(centroid.as_dvec3() - center, [Vec3::ZERO; 2], inverse);
                (c, self.exit(c, (p - c).non_zero()?))
            }
        };
        let hit = hit.filter(|hit| hit.point.is_finite())?;
        Some((start, hit))
    }

    fn exit(&self, origin: Dual3, direction: Dual3) -> Option<Hit> {
        let is_finite = origin.is_finite() && direction.is_finite();
        let ray = Ray { origin, direction };
        is_finite.then(|| self.s.exit(&ray)).flatten()
    }
}

/// A vector with its derivatives in a turned frame.
fn local(value: DVec3, d: [Vec3; 2], inverse: DMat3) -> Dual3 {
    Dual3::new(inverse * value, d.map(|d| inverse * d.as_dvec3()))
}
