//! How directions become places in pictures.

use super::azimuthal::{self, Kind};
use super::{cube, latlong, octahedral};
use core::fmt;
use core::str::FromStr;
use glam::{Vec2, Vec3};

/// How the directions around a point become places in pictures, its faces.
///
/// The world is right-handed with +y up, as glTF has it; *ahead* is -z, *right* is +x. Texture coordinates `(s, t)` begin
/// in the upper left corner. All but the sphere map show what an eye in the middle sees; that one shows a mirror.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Projection {
    /// Six square faces px, nx, py, ny, pz, nz with the orientation of graphics interfaces: pz lies ahead, px at the right.
    #[default]
    Cube,
    /// Latitude and longitude (equirectangular): ahead in the middle, zenith above.
    LatLong,
    /// Photograph of a mirror ball from far away, taken from +z: `GL_SPHERE_MAP`, matcaps. All texels are equally large.
    Sphere,
    /// Two halves in discs: `1 / (1 + |z|)` of x and y; the first one ahead, the second one behind.
    Paraboloid,
    /// An octahedron unfolded into a square: zenith in the middle, nadir in the corners.
    Octahedral,
    /// Light probe: distance from the middle as the angle from straight ahead, 180° at the rim.
    Angular,
    /// Equidistant fisheye of 180°: what lies ahead, nothing behind.
    Fisheye,
    /// Orthographic fisheye of 180°: distance from the middle as the sine of the angle.
    Hemispherical,
}

impl Projection {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Cube,
        Self::LatLong,
        Self::Sphere,
        Self::Paraboloid,
        Self::Octahedral,
        Self::Angular,
        Self::Fisheye,
        Self::Hemispherical,
    ];

    /// Name in options and reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cube => "cube",
            Self::LatLong => "latlong",
            Self::Sphere => "sphere",
            Self::Paraboloid => "paraboloid",
            Self::Octahedral => "octahedral",
            Self::Angular => "angular",
            Self::Fisheye => "fisheye",
            Self::Hemispherical => "hemispherical",
        }
    }

    /// Pictures that it needs.
    pub const fn faces(self) -> usize {
        match self {
            Self::Cube => 6,
            Self::Paraboloid => 2,
            _ => 1,
        }
    }

    /// Whether it shows all directions; fisheyes show those ahead.
    pub const fn covers_sphere(self) -> bool {
        !matches!(self, Self::Fisheye | Self::Hemispherical)
    }

    /// Solid angle that it shows, in steradians.
    pub fn covered(self) -> f64 {
        use core::f64::consts::PI;
        if self.covers_sphere() {
            4.0 * PI
        } else {
            2.0 * PI
        }
    }

    /// Width and height of a face of so many rows.
    pub const fn face_size(self, rows: usize) -> (usize, usize) {
        match self {
            Self::LatLong => (2 * rows, rows),
            _ => (rows, rows),
        }
    }

    pub(super) fn disc(self) -> Option<Kind> {
        match self {
            Self::Sphere => Some(Kind::Sphere),
            Self::Angular => Some(Kind::Angular),
            Self::Paraboloid => Some(Kind::Paraboloid),
            Self::Fisheye => Some(Kind::Fisheye),
            Self::Hemispherical => Some(Kind::Hemispherical),
            Self::Cube | Self::LatLong | Self::Octahedral => None,
        }
    }

    /// Face and texture coordinates of a direction of any length.
    ///
    /// `None` for a direction that is 0 or not finite, and for those behind a fisheye.
    #[inline]
    pub fn coordinates(self, direction: Vec3) -> Option<(usize, Vec2)> {
        let d = direction.try_normalize()?;
        match self {
            Self::Cube => Some(cube::coordinates(d)),
            Self::LatLong => Some((0, latlong::coordinates(d))),
            Self::Octahedral => Some((0, octahedral::coordinates(d))),
            _ => self.disc()?.coordinates(d),
        }
    }

    /// Direction of a place, of unit length. A place outside a disc means the nearest one on its rim; on a paraboloid
    /// the formula goes on, into the other half, which fills the guard ring that filtering needs.
    pub fn direction(self, face: usize, at: Vec2) -> Vec3 {
        match (self, self.disc()) {
            (_, Some(disc)) => disc.direction(face, at),
            (Self::Cube, _) => cube::direction(face, at),
            (Self::LatLong, _) => latlong::direction(at),
            _ => octahedral::direction(at),
        }
    }

    /// Gradients of s and t by the direction, which is of unit length: turning it by a small `d` moves its place by
    /// `(gradient[0]·d, gradient[1]·d)`. Finite in singular directions, where it does not exist.
    pub fn gradient(self, direction: Vec3) -> [Vec3; 2] {
        match (self, self.disc()) {
            (_, Some(disc)) => disc.gradient(direction),
            (Self::Cube, _) => cube::gradient(direction),
            (Self::LatLong, _) => latlong::gradient(direction),
            _ => octahedral::gradient(direction),
        }
    }

    /// Solid angle by area of texture coordinates; of places outside a disc, that of its rim.
    pub fn density(self, at: Vec2) -> f32 {
        match (self, self.disc()) {
            (_, Some(disc)) => disc.density(at),
            (Self::Cube, _) => cube::density(at),
            (Self::LatLong, _) => latlong::density(at),
            _ => octahedral::density(at),
        }
    }

    /// Solid angle of a rectangle of texture coordinates in any face, in steradians; what lies outside a disc does not
    /// count. Exact: those of all texels sum to [`Self::covered`], whatever the size.
    pub fn solid_angle(self, s: [f64; 2], t: [f64; 2]) -> f64 {
        match (self, self.disc()) {
            (_, Some(disc)) => disc.solid_angle(s, t),
            (Self::Cube, _) => cube::solid_angle(s, t),
            (Self::LatLong, _) => latlong::solid_angle(s, t),
            _ => octahedral::solid_angle(s, t),
        }
    }

    /// Solid angle of a texel of a face of so many columns and rows.
    pub fn texel_solid_angle(self, (width, height): (usize, usize), x: usize, y: usize) -> f64 {
        let ends = |i: usize, n: usize| [i as f64 / n as f64, (i + 1) as f64 / n as f64];
        self.solid_angle(ends(x, width), ends(y, height))
    }

    /// Whether any direction falls on a texel: not outside the disc of a sphere, angular or fisheye map. The halves of a
    /// paraboloid go on over their rim.
    pub(super) fn shows(self, (width, height): (usize, usize), x: usize, y: usize) -> bool {
        if self.faces() != 1 || self.disc().is_none() {
            return true;
        }
        // Of the point of the texel that is nearest to the middle of the disc, which has the radius 1.
        let of =
            |i: usize, n: usize| (2 * i).abs_diff(n).min((2 * i + 2).abs_diff(n)) as f32 / n as f32;
        let is_middle = |i: usize, n: usize| 2 * i < n && n < 2 * i + 2;
        let along = |i: usize, n: usize| if is_middle(i, n) { 0.0 } else { of(i, n) };
        along(x, width).hypot(along(y, height)) < 1.0
    }

    /// The texel that a column and a row mean which may lie outside a face: the neighbour on the sphere. `None` at the
    /// corners of a cube, where there is no fourth texel.
    pub(super) fn neighbour(
        self,
        [width, height]: [usize; 2],
        face: usize,
        x: isize,
        y: isize,
    ) -> Option<(usize, usize, usize)> {
        match self {
            Self::Cube => cube::across(width, face, x, y),
            Self::LatLong => {
                let (x, y) = latlong::around(width, height, x, y);
                Some((0, x, y))
            }
            Self::Octahedral => {
                let (x, y) = octahedral::across(width, x, y);
                Some((0, x, y))
            }
            _ if azimuthal::is_inside([width, height], x, y) => {
                Some((face, x.cast_unsigned(), y.cast_unsigned()))
            }
            Self::Paraboloid => {
                let size = [width, height];
                let d = self.direction(face, azimuthal::place(size, x, y));
                let (_, at) = self.coordinates(d)?;
                let (x, y) = azimuthal::nearest(size, at);
                Some((1 - face, x, y))
            }
            _ => {
                let (x, y) = azimuthal::inwards([width, height], x, y);
                Some((0, x, y))
            }
        }
    }
}

impl fmt::Display for Projection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The name of a projection could not be understood.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "projection '{0}' is not known; use cube, latlong, sphere, paraboloid, octahedral, angular, fisheye or hemispherical"
)]
pub struct ParseProjectionError(pub String);

impl FromStr for Projection {
    type Err = ParseProjectionError;

    fn from_str(name: &str) -> Result<Self, ParseProjectionError> {
        Self::ALL
            .into_iter()
            .find(|projection| projection.name() == name)
            .ok_or_else(|| ParseProjectionError(name.to_owned()))
    }
}
