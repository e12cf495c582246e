//! The S maps: textures on planes, cylinders, spheres and boxes, and where lines meet these surfaces.

use super::dual::{Dual, Dual3};
use core::f32::consts::{FRAC_PI_2, PI, TAU};
use core::f64::consts as wide;
use glam::{Vec2, Vec3};

/// The intermediate surface and how the texture lies on it. Its centre is the origin, its axis or pole +Y.
///
/// Sizes that are not positive and finite make a surface that nothing meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SMap {
    /// A rectangle in the plane `z = distance`, seen from +Z: `u = 1/2 + x / width`, `v = 1/2 - y / height`. The plane
    /// goes on beyond the texture.
    Plane {
        /// Its z.
        distance: f32,
        /// Side along x.
        width: f32,
        /// Side along y.
        height: f32,
    },
    /// A can: on its side `u = 1/2 + atan2(x, z) / 2 pi`, `v = 1/2 - y / height`; on its caps the texture's inscribed
    /// disc, seen from outside. Faces: 0 side, 1 upper cap, 2 lower cap.
    Cylinder {
        /// Its radius.
        radius: f32,
        /// Its height.
        height: f32,
        /// Whether it has caps; without, the side goes on upwards and downwards.
        caps: bool,
    },
    /// A sphere.
    Sphere {
        /// Its radius.
        radius: f32,
        /// How the texture lies on it.
        layout: SphereLayout,
    },
    /// A box. Faces: 0 to 5 are +x, -x, +y, -y, +z, -z, as the layers of a cube map, but seen from outside.
    Box {
        /// Half its sides.
        half: Vec3,
        /// How the texture lies on it.
        layout: BoxLayout,
    },
}

/// How a texture lies on a sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SphereLayout {
    /// Longitude and latitude: `u = 1/2 + atan2(x, z) / 2 pi`, `v` the angle from the pole over pi.
    LatLong,
    /// Bier and Sloan's choice, the stereographic projection from the pole at -Y onto the plane that touches the sphere
    /// at +Y: with `phi` the angle from +Y the distance there is `2 r tan(phi/2)`. It is conformal: small squares of the
    /// texture stay squares, but towards -Y they grow without bound.
    Stereographic {
        /// The angle phi, in radians, at which the texture's edges lie; beyond, coordinates leave [0, 1].
        edge: f32,
    },
}

impl SphereLayout {
    /// A stereographic one in which the texture's inscribed disc is a hemisphere.
    pub const HEMISPHERE: Self = Self::Stereographic { edge: FRAC_PI_2 };
}

/// How a texture lies on a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoxLayout {
    /// Each face has all of the texture.
    EachFace,
    /// The texture is the box unfolded as a cross, four faces wide and three high: -x, +z, +x, -z from left to right in
    /// the middle, +y above and -y below +z.
    Cross,
}

/// For each face of a box: the axes that point out of it, to the right and down in its texture (axis, sign).
const FACES: [[(usize, f64); 3]; 6] = [
    [(0, 1.0), (2, -1.0), (1, -1.0)],
    [(0, -1.0), (2, 1.0), (1, -1.0)],
    [(1, 1.0), (0, 1.0), (2, 1.0)],
    [(1, -1.0), (0, 1.0), (2, -1.0)],
    [(2, 1.0), (0, 1.0), (1, -1.0)],
    [(2, -1.0), (0, -1.0), (1, -1.0)],
];

/// Column and row of each face in the cross.
const CROSS: [[f64; 2]; 6] = [
    [2.0, 1.0],
    [0.0, 1.0],
    [1.0, 0.0],
    [1.0, 2.0],
    [1.0, 1.0],
    [3.0, 1.0],
];

/// A line to meet the surface with; the direction may have any length but 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub origin: Dual3,
    pub direction: Dual3,
}

impl Ray {
    fn at(&self, t: Dual) -> Dual3 {
        self.origin + self.direction.scaled(t)
    }
}

/// A point of the intermediate surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit {
    pub point: Dual3,
    pub face: usize,
}

/// Where a line goes in and out of a convex solid, with the face that it goes out by.
#[derive(Debug, Clone, Copy)]
struct Passage {
    enters: f64,
    leaves: Dual,
    face: usize,
}

impl Passage {
    /// The part inside of both.
    fn and(self, other: Self) -> Self {
        let first = if self.leaves.value <= other.leaves.value {
            self
        } else {
            other
        };
        Self {
            enters: self.enters.max(other.enters),
            ..first
        }
    }

    /// Where a ray, starting at 0, leaves the solid, if it meets it.
    fn exit(self, ray: &Ray) -> Option<Hit> {
        let t = self.leaves;
        let is_met = t.value >= 0.0 && t.value >= self.enters && t.value.is_finite();
        is_met.then(|| Hit {
            point: ray.at(t),
            face: self.face,
        })
    }
}

/// Between the planes `p = -half` and `p = half` along an axis; `faces` are those at +half and -half. `None` for a line
/// beside them.
fn slab(origin: Dual, direction: Dual, half: f64, faces: [usize; 2]) -> Option<Passage> {
    if direction.value == 0.0 {
        return (origin.value.abs() <= half).then_some(Passage {
            enters: f64::NEG_INFINITY,
            leaves: Dual::constant(f64::INFINITY),
            face: faces[0],
        });
    }
    let forward = direction.value > 0.0;
    let side = if forward { half } else { -half };
    Some(Passage {
        enters: (-side - origin.value) / direction.value,
        leaves: (-origin + side) / direction,
        face: faces[usize::from(!forward)],
    })
}

/// Inside of a quadric `|o + t d|^2 = r^2`, from `a = |d|^2`, `b = o.d`, `c = |o|^2 - r^2`. `None` for a line beside it.
fn quadric(a: Dual, b: Dual, c: Dual) -> Option<Passage> {
    if a.value == 0.0 {
        // Along the axis of a cylinder.
        return (c.value <= 0.0).then_some(Passage {
            enters: f64::NEG_INFINITY,
            leaves: Dual::constant(f64::INFINITY),
            face: 0,
        });
    }
    let discriminant = b * b - a * c;
    if discriminant.value < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    // Of the two forms of the root the one in which nothing cancels.
    let leaves = if b.value > 0.0 {
        -c / (b + root)
    } else {
        (root - b) / a
    };
    Some(Passage {
        enters: (-b - root).value / a.value,
        leaves,
        face: 0,
    })
}

impl SMap {
    /// A square plane of such a side, as far in front of the origin.
    pub const fn plane(side: f32) -> Self {
        Self::Plane {
            distance: side,
            width: side,
            height: side,
        }
    }

    /// A can with caps.
    pub const fn cylinder(radius: f32, height: f32) -> Self {
        Self::Cylinder {
            radius,
            height,
            caps: true,
        }
    }

    /// A sphere with longitudes and latitudes.
    pub const fn sphere(radius: f32) -> Self {
        Self::Sphere {
            radius,
            layout: SphereLayout::LatLong,
        }
    }

    /// A cube of such half a side, the whole texture on each face.
    pub const fn cube(half: f32) -> Self {
        Self::Box {
            half: Vec3::splat(half),
            layout: BoxLayout::EachFace,
        }
    }

    /// Number of its faces, each with texture coordinates of its own.
    pub const fn faces(&self) -> usize {
        match self {
            Self::Plane { .. } | Self::Sphere { .. } | Self::Cylinder { caps: false, .. } => 1,
            Self::Cylinder { caps: true, .. } => 3,
            Self::Box { .. } => 6,
        }
    }

    /// Lengths on a face that a unit of u and of v spans: on longitudes and latitudes along the equator and from pole to
    /// pole, on a stereographic one at its pole. Repeating a texture in proportion to them keeps its texels square.
    ///
    /// # Panics
    /// If there is no such face.
    pub fn extent(&self, face: usize) -> Vec2 {
        assert!(face < self.faces(), "face {face} of {}", self.faces());
        match *self {
            Self::Plane { width, height, .. } => Vec2::new(width, height),
            Self::Cylinder { radius, height, .. } if face == 0 => Vec2::new(TAU * radius, height),
            Self::Cylinder { radius, .. } => Vec2::splat(2.0 * radius),
            Self::Sphere { radius, layout } => match layout {
                SphereLayout::LatLong => Vec2::new(TAU, PI) * radius,
                SphereLayout::Stereographic { edge } => {
                    Vec2::splat(4.0 * radius * (0.5 * edge).tan())
                }
            },
            Self::Box { half, layout } => {
                let [_, (right, _), (down, _)] = FACES[face];
                let side = Vec2::new(half[right], half[down]) * 2.0;
                match layout {
                    BoxLayout::EachFace => side,
                    BoxLayout::Cross => side * Vec2::new(4.0, 3.0),
                }
            }
        }
    }

    fn is_valid(&self) -> bool {
        let is_size = |size: f32| size > 0.0 && size.is_finite();
        match *self {
            Self::Plane {
                distance,
                width,
                height,
            } => distance.is_finite() && is_size(width) && is_size(height),
            Self::Cylinder { radius, height, .. } => is_size(radius) && is_size(height),
            Self::Sphere { radius, layout } => {
                is_size(radius)
                    && match layout {
                        SphereLayout::LatLong => true,
                        SphereLayout::Stereographic { edge } => edge > 0.0 && edge < PI,
                    }
            }
            Self::Box { half, .. } => half.to_array().into_iter().all(is_size),
        }
    }

    /// The S map itself: the point of the surface on which a point of the texture lies.
    ///
    /// Coordinates outside [0, 1] are points too where the surface goes on. `None` if the face does not exist, if nothing
    /// of the face lies there (a box in a cross: outside of its square), or if a number is not finite.
    pub fn point(&self, texcoord: Vec2, face: usize) -> Option<Vec3> {
        if !self.is_valid() || !texcoord.is_finite() || face >= self.faces() {
            return None;
        }
        let (x, y) = (texcoord.x - 0.5, 0.5 - texcoord.y);
        let around = |turn: f32| {
            let (sin, cos) = (turn * TAU).sin_cos();
            Vec3::new(sin, 0.0, cos)
        };
        let point = match *self {
            Self::Plane {
                distance,
                width,
                height,
            } => Vec3::new(x * width, y * height, distance),
            Self::Cylinder { radius, height, .. } => match face {
                0 => around(x) * radius + Vec3::Y * (y * height),
                1 => Vec3::new(2.0 * x * radius, 0.5 * height, -2.0 * y * radius),
                _ => Vec3::new(2.0 * x * radius, -0.5 * height, 2.0 * y * radius),
            },
            Self::Sphere { radius, layout } => {
                let direction = match layout {
                    SphereLayout::LatLong => {
                        let (sin, cos) = (texcoord.y * PI).sin_cos();
                        around(x) * sin + Vec3::Y * cos
                    }
                    SphereLayout::Stereographic { edge } => {
                        let plane = Vec2::new(x, -y) * (2.0 * (0.5 * edge).tan());
                        let square = plane.length_squared();
                        Vec3::new(2.0 * plane.x, 1.0 - square, 2.0 * plane.y) / (1.0 + square)
                    }
                };
                direction * radius
            }
            Self::Box { half, layout } => box_point(half, layout, texcoord, face)?,
        };
        point.is_finite().then_some(point)
    }

    /// The texture coordinate of a point of the surface.
    pub(super) fn texcoord(&self, hit: &Hit) -> [Dual; 2] {
        let point = hit.point;
        let turn = || point.x().atan2(point.z()) * (1.0 / wide::TAU) + 0.5;
        match *self {
            Self::Plane { width, height, .. } => [
                point.x() * (1.0 / f64::from(width)) + 0.5,
                point.y() * (-1.0 / f64::from(height)) + 0.5,
            ],
            Self::Cylinder { radius, height, .. } => {
                let across = 0.5 / f64::from(radius);
                match hit.face {
                    0 => [turn(), point.y() * (-1.0 / f64::from(height)) + 0.5],
                    1 => [point.x() * across + 0.5, point.z() * across + 0.5],
                    _ => [point.x() * across + 0.5, point.z() * -across + 0.5],
                }
            }
            Self::Sphere { radius, layout } => match layout {
                SphereLayout::LatLong => {
                    let (x, z) = (point.x(), point.z());
                    let beside = (x * x + z * z).sqrt();
                    [turn(), beside.atan2(point.y()) * wide::FRAC_1_PI]
                }
                SphereLayout::Stereographic { edge } => {
                    let scale = 0.5 / (0.5 * f64::from(edge)).tan();
                    let above = point.y() + f64::from(radius);
                    [point.x(), point.z()].map(|c| c / above * scale + 0.5)
                }
            },
            Self::Box { half, layout } => {
                let [_, right, down] = FACES[hit.face];
                let share = |(axis, sign): (usize, f64)| {
                    point.0[axis] * (0.5 * sign / f64::from(half[axis])) + 0.5
                };
                let [u, v] = [share(right), share(down)];
                match layout {
                    BoxLayout::EachFace => [u, v],
                    BoxLayout::Cross => {
                        let [column, row] = CROSS[hit.face];
                        [(u + column) * 0.25, (v + row) * (1.0 / 3.0)]
                    }
                }
            }
        }
    }

    /// Where a ray leaves the surface; the plane is met from both sides.
    pub(super) fn exit(&self, ray: &Ray) -> Option<Hit> {
        if !self.is_valid() {
            return None;
        }
        let (o, d) = (ray.origin, ray.direction);
        match *self {
            Self::Plane { distance, .. } => {
                let t = (-o.z() + f64::from(distance)) / d.z();
                (t.value >= 0.0 && t.is_finite()).then(|| Hit {
                    point: ray.at(t),
                    face: 0,
                })
            }
            Self::Cylinder {
                radius,
                height,
                caps,
            } => {
                let square = f64::from(radius) * f64::from(radius);
                let side = quadric(
                    d.x() * d.x() + d.z() * d.z(),
                    o.x() * d.x() + o.z() * d.z(),
                    o.x() * o.x() + o.z() * o.z() + -square,
                )?;
                let passage = if caps {
                    side.and(slab(o.y(), d.y(), 0.5 * f64::from(height), [1, 2])?)
                } else {
                    side
                };
                passage.exit(ray)
            }
            Self::Sphere { radius, .. } => {
                let square = f64::from(radius) * f64::from(radius);
                quadric(d.dot(d), o.dot(d), o.dot(o) + -square)?.exit(ray)
            }
            Self::Box { half, .. } => {
                let along = |axis: usize| {
                    let faces = [2 * axis, 2 * axis + 1];
                    slab(o.0[axis], d.0[axis], f64::from(half[axis]), faces)
                };
                along(0)?.and(along(1)?).and(along(2)?).exit(ray)
            }
        }
    }

    /// The point of the surface whose normal goes through `p`. `None` on the axis of a cylinder and in the centre.
    pub(super) fn foot(&self, p: Dual3) -> Option<Hit> {
        if !self.is_valid() {
            return None;
        }
        let (point, face) = match *self {
            Self::Plane { distance, .. } => {
                let on_plane = Dual::constant(f64::from(distance));
                (Dual3([p.x(), p.y(), on_plane]), 0)
            }
            Self::Cylinder { radius, .. } => {
                let beside = Dual3([p.x(), Dual::constant(0.0), p.z()]).normalized()?;
                let side = beside.scaled(Dual::constant(f64::from(radius)));
                (Dual3([side.x(), p.y(), side.z()]), 0)
            }
            Self::Sphere { radius, .. } => {
                (p.normalized()?.scaled(Dual::constant(f64::from(radius))), 0)
            }
            Self::Box { half, .. } => {
                let share = |axis: usize| p.0[axis].value.abs() / f64::from(half[axis]);
                let axis = (1..3).fold(0, |most, i| if share(i) > share(most) { i } else { most });
                if share(axis) == 0.0 {
                    return None;
                }
                let negative = p.0[axis].value < 0.0;
                let side = f64::from(half[axis]) * if negative { -1.0 } else { 1.0 };
                let mut point = p;
                point.0[axis] = Dual::constant(side);
                (point, 2 * axis + usize::from(negative))
            }
        };
        Some(Hit { point, face })
    }
}

/// The point of a face of a box under a point of the texture.
fn box_point(half: Vec3, layout: BoxLayout, texcoord: Vec2, face: usize) -> Option<Vec3> {
    let texcoord = texcoord.as_dvec2();
    let [u, v] = match layout {
        BoxLayout::EachFace => [texcoord.x, texcoord.y],
        BoxLayout::Cross => {
            let [column, row] = CROSS[face];
            [texcoord.x * 4.0 - column, texcoord.y * 3.0 - row]
        }
    };
    // A hair more, so that what was rounded on the way here still counts.
    let is_on_face = [u, v].iter().all(|c| (-1e-6..=1.0 + 1e-6).contains(c));
    if layout == BoxLayout::Cross && !is_on_face {
        return None;
    }
    let mut point = Vec3::ZERO.as_dvec3();
    for ((axis, sign), share) in FACES[face]
        .into_iter()
        .zip([1.0, 2.0 * u - 1.0, 2.0 * v - 1.0])
    {
        point[axis] = sign * share * f64::from(half[axis]);
    }
    Some(point.as_vec3())
}
