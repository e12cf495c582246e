//! Clipping of triangles in homogeneous coordinates, before the division by w.
//!
//! A triangle that crosses the plane of the eye has no shape on the screen until the part behind the eye is cut off, so
//! clipping works on clip-space positions with the convention of wgpu: what is seen has `-w <= x, y <= w` and
//! `0 <= z <= w`, y pointing up. The method is Sutherland and Hodgman, *Reentrant polygon clipping* (CACM 1974): one
//! plane after the other. To the sides it cuts only at a guard band far outside of the picture (Blinn and Newell,
//! *Clipping using homogeneous coordinates*, SIGGRAPH 1978, for the test of w): the rasteriser skips what is beside the
//! picture for less than a new vertex costs.
//!
//! A cut point is always computed from the inner end of an edge towards the outer one. Two triangles that share the
//! edge so get the same bits, and no crack opens between them.

use glam::{DVec2, DVec4, Vec4};

/// A corner of a triangle as a vertex stage hands it over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClipVertex<const N: usize> {
    /// Homogeneous position; seen if `-w <= x, y <= w` and `0 <= z <= w`. y points up.
    pub position: Vec4,
    /// What is interpolated over the triangle, linear in space (not on the screen).
    pub attributes: [f32; N],
}

impl<const N: usize> ClipVertex<N> {
    /// A corner of its position and its attributes.
    pub const fn new(position: Vec4, attributes: [f32; N]) -> Self {
        Self {
            position,
            attributes,
        }
    }

    fn is_finite(&self) -> bool {
        self.position.is_finite() && self.attributes.iter().all(|a| a.is_finite())
    }

    fn widened(&self) -> ClippedVertex<N> {
        ClippedVertex {
            position: self.position.as_dvec4(),
            attributes: self.attributes.map(f64::from),
        }
    }
}

/// A corner of a clipped polygon, in f64: no product of two f32 overflows there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClippedVertex<const N: usize> {
    /// Homogeneous position with `w >= 1e-38`.
    pub position: DVec4,
    /// Attributes at that position.
    pub attributes: [f64; N],
}

impl<const N: usize> ClippedVertex<N> {
    const ZERO: Self = Self {
        position: DVec4::ZERO,
        attributes: [0.0; N],
    };

    /// The point at `t` of the way to `other`. As a weighted mean, not as `self + t (other - self)`: the mean of two
    /// positive w stays positive whatever their sizes.
    fn lerp(&self, other: &Self, t: f64) -> Self {
        Self {
            position: self.position * (1.0 - t) + other.position * t,
            attributes: std::array::from_fn(|k| {
                self.attributes[k] * (1.0 - t) + other.attributes[k] * t
            }),
        }
    }
}

/// Corners that a clipped polygon can have. Each of the 7 planes adds at most one to a convex polygon, which makes 10.
/// Rounding may dent a polygon, and a dent on a plane may add more; beyond 16 they are left out.
const CAPACITY: usize = 16;

/// The convex polygon that clipping leaves of a triangle: none or at least three corners, in the order of the triangle.
#[derive(Debug, Clone, Copy)]
pub struct ClippedPolygon<const N: usize> {
    corners: [ClippedVertex<N>; CAPACITY],
    len: usize,
}

impl<const N: usize> ClippedPolygon<N> {
    const EMPTY: Self = Self {
        corners: [ClippedVertex::ZERO; CAPACITY],
        len: 0,
    };

    /// The corners; empty if nothing is left.
    pub fn corners(&self) -> &[ClippedVertex<N>] {
        &self.corners[..self.len]
    }

    fn push(&mut self, corner: ClippedVertex<N>) {
        if self.len < CAPACITY {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    /// The part of the polygon on the inner side of a plane.
    fn cut(&self, plane: Plane) -> Self {
        let mut kept = Self::EMPTY;
        let Some(last) = self.corners().last() else {
            return kept;
        };
        let mut from = last;
        let mut from_distance = plane.distance(from.position);
        for to in self.corners() {
            let to_distance = plane.distance(to.position);
            match (from_distance >= 0.0, to_distance >= 0.0) {
                (true, false) => kept.push(plane.cross(from, from_distance, to, to_distance)),
                (false, true) => kept.push(plane.cross(to, to_distance, from, from_distance)),
                _ => {}
            }
            if to_distance >= 0.0 {
                kept.push(*to);
            }
            (from, from_distance) = (to, to_distance);
        }
        if kept.len < 3 { Self::EMPTY } else { kept }
    }
}

/// A half-space to clip with.
#[derive(Debug, Clone, Copy)]
enum Plane {
    /// `w >= 1e-38`: in front of the eye, also under a projection whose near plane is not.
    Eye,
    /// `z >= 0`
    Near,
    /// `z <= w`
    Far,
    /// `-x <= guard w`
    Left(f64),
    /// `x <= guard w`
    Right(f64),
    /// `-y <= guard w`
    Bottom(f64),
    /// `y <= guard w`
    Top(f64),
}

impl Plane {
    /// The smallest w, close to the smallest normal f32: dividing by it overflows no f64.
    const SMALLEST_W: f64 = 1e-38;

    /// All planes; the one of the eye first, because the others may rely on a positive w.
    fn all(guard: DVec2) -> [Self; 7] {
        [
            Self::Eye,
            Self::Near,
            Self::Far,
            Self::Left(guard.x),
            Self::Right(guard.x),
            Self::Bottom(guard.y),
            Self::Top(guard.y),
        ]
    }

    /// Signed distance in an arbitrary scale, not negative on the inner side.
    fn distance(self, p: DVec4) -> f64 {
        match self {
            Self::Eye => p.w - Self::SMALLEST_W,
            Self::Near => p.z,
            Self::Far => p.w - p.z,
            Self::Left(guard) => guard * p.w + p.x,
            Self::Right(guard) => guard * p.w - p.x,
            Self::Bottom(guard) => guard * p.w + p.y,
            Self::Top(guard) => guard * p.w - p.y,
        }
    }

    /// Where the edge between an inner and an outer corner crosses the plane.
    fn cross<const N: usize>(
        self,
        inner: &ClippedVertex<N>,
        inner_distance: f64,
        outer: &ClippedVertex<N>,
        outer_distance: f64,
    ) -> ClippedVertex<N> {
        let t = inner_distance / (inner_distance - outer_distance);
        let mut corner = inner.lerp(outer, t);
        // Rounding must not leave it on the wrong side, where w might even be negative.
        let p = &mut corner.position;
        match self {
            Self::Eye => p.w = Self::SMALLEST_W,
            Self::Near => p.z = 0.0,
            Self::Far => p.z = p.w,
            Self::Left(guard) => p.x = -guard * p.w,
            Self::Right(guard) => p.x = guard * p.w,
            Self::Bottom(guard) => p.y = -guard * p.w,
            Self::Top(guard) => p.y = guard * p.w,
        }
        corner
    }
}

/// What clipping has to do with a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Clipping<const N: usize> {
    /// Nothing of it is seen.
    Outside,
    /// No plane cuts it.
    Inside([ClippedVertex<N>; 3]),
    /// Planes may cut it.
    Crossing([ClippedVertex<N>; 3]),
}

impl<const N: usize> Clipping<N> {
    /// Compares the corners with the planes; a triangle with a corner that is not finite counts as outside.
    pub(crate) fn of(vertices: &[ClipVertex<N>; 3], guard: DVec2) -> Self {
        if !vertices.iter().all(ClipVertex::is_finite) {
            return Self::Outside;
        }
        let corners = [0, 1, 2].map(|k| vertices[k].widened());
        // The picture's own borders say what is unseen, the guard band says what must be cut.
        let [a, b, c] = corners.each_ref().map(|v| outcode(v.position, DVec2::ONE));
        if a & b & c != 0 {
            return Self::Outside;
        }
        let needs_cut = |v: &ClippedVertex<N>| outcode(v.position, guard) != 0;
        if guard.min_element() >= 1.0 && a | b | c == 0 || !corners.iter().any(needs_cut) {
            Self::Inside(corners)
        } else {
            Self::Crossing(corners)
        }
    }
}

/// One bit for each plane beyond which a position is (Cohen and Sutherland).
fn outcode(position: DVec4, guard: DVec2) -> u32 {
    Plane::all(guard).into_iter().fold(0, |code, plane| {
        code << 1 | u32::from(plane.distance(position) < 0.0)
    })
}

/// The part of a triangle in front of the near plane, before the far plane and within `guard` times the picture's
/// half width and half height (1 is the picture itself; values below 1 cut into it).
///
/// Empty if nothing of the triangle is in the picture or if a number of it is not finite.
pub fn clip_triangle<const N: usize>(
    vertices: &[ClipVertex<N>; 3],
    guard: DVec2,
) -> ClippedPolygon<N> {
    match Clipping::of(vertices, guard) {
        Clipping::Outside => ClippedPolygon::EMPTY,
        Clipping::Inside(corners) | Clipping::Crossing(corners) => cut_corners(&corners, guard),
    }
}

/// The part of the triangle of three corners on the inner side of all planes.
pub(crate) fn cut_corners<const N: usize>(
    corners: &[ClippedVertex<N>; 3],
    guard: DVec2,
) -> ClippedPolygon<N> {
    let mut triangle = ClippedPolygon::EMPTY;
    for corner in corners {
        triangle.push(*corner);
    }
    Plane::all(guard)
        .into_iter()
        .fold(triangle, |polygon, plane| polygon.cut(plane))
}
