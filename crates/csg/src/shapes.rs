//! The primitives by their measures. Whatever cannot be is refused here; behind this door all numbers are good.

use crate::error::CsgError;
use crate::leaf::Leaf;
use crate::primitive::Primitive;
use crate::solid::Solid;
use crate::{LARGEST, SMALLEST};
use glam::{DAffine3, DMat3, DVec3};

impl Solid {
    /// A ball.
    pub fn sphere(centre: DVec3, radius: f64) -> Result<Self, CsgError> {
        check_point("sphere", "centre", centre)?;
        check_length("sphere", "radius", radius)?;
        let scale = DMat3::from_diagonal(DVec3::splat(radius));
        Ok(placed(Primitive::Sphere, scale, centre))
    }

    /// A box with sides parallel to the axes, between two opposite corners.
    pub fn cuboid(corner: DVec3, opposite: DVec3) -> Result<Self, CsgError> {
        check_point("cuboid", "corner", corner)?;
        check_point("cuboid", "opposite corner", opposite)?;
        let half = (opposite - corner).abs() * 0.5;
        for (what, side) in ["width", "height", "depth"]
            .into_iter()
            .zip(half.to_array())
        {
            check_length("cuboid", what, 2.0 * side)?;
        }
        let centre = (corner + opposite) * 0.5;
        Ok(placed(
            Primitive::Cuboid,
            DMat3::from_diagonal(half),
            centre,
        ))
    }

    /// A round rod from one point to another.
    pub fn cylinder(from: DVec3, to: DVec3, radius: f64) -> Result<Self, CsgError> {
        round("cylinder", [from, to], [radius, radius])
    }

    /// A cone with a round base.
    pub fn cone(base: DVec3, radius: f64, apex: DVec3) -> Result<Self, CsgError> {
        check_length("cone", "radius", radius)?;
        round("cone", [base, apex], [radius, 0.0])
    }

    /// A cone without its tip: a round rod of a radius at each end. One of the two may be 0.
    pub fn frustum(
        from: DVec3,
        from_radius: f64,
        to: DVec3,
        to_radius: f64,
    ) -> Result<Self, CsgError> {
        if from_radius < to_radius {
            return round("frustum", [to, from], [to_radius, from_radius]);
        }
        round("frustum", [from, to], [from_radius, to_radius])
    }

    /// A ring: all points within `tube_radius` of a circle of `ring_radius` around an axis.
    ///
    /// A tube wider than the ring is an apple: the hole has closed, and the solid has a dimple at each end of its
    /// axis.
    pub fn torus(
        centre: DVec3,
        axis: DVec3,
        ring_radius: f64,
        tube_radius: f64,
    ) -> Result<Self, CsgError> {
        check_point("torus", "centre", centre)?;
        check_length("torus", "ring radius", ring_radius)?;
        check_length("torus", "tube radius", tube_radius)?;
        let axis = checked_direction("torus", "axis", axis)?;
        let tube = tube_radius / ring_radius;
        crate::error::check_number("torus: tube radius / ring radius", tube, 1e-4, 1e3)?;
        let (x, z) = axis.any_orthonormal_pair();
        let frame = DMat3::from_cols(x, axis, z) * ring_radius;
        Ok(placed(Primitive::Torus { tube }, frame, centre))
    }

    /// Everything behind a plane through a point; the normal points away from it.
    pub fn half_space(point: DVec3, normal: DVec3) -> Result<Self, CsgError> {
        check_point("half-space", "point", point)?;
        let normal = checked_direction("half-space", "normal", normal)?;
        let (x, z) = normal.any_orthonormal_pair();
        let frame = DMat3::from_cols(x, normal, z);
        Ok(placed(Primitive::HalfSpace, frame, point))
    }
}

/// A solid of revolution with a straight side, the first radius being at least the second.
fn round(
    shape: &'static str,
    [from, to]: [DVec3; 2],
    [radius, other]: [f64; 2],
) -> Result<Solid, CsgError> {
    check_point(shape, "start", from)?;
    check_point(shape, "end", to)?;
    check_length(shape, "radius", radius)?;
    if other != 0.0 {
        check_length(shape, "radius", other)?;
    }
    let axis = to - from;
    check_length(shape, "height", axis.length())?;
    let (x, z) = axis.normalize().any_orthonormal_pair();
    let frame = DMat3::from_cols(x * radius, axis, z * radius);
    let taper = 1.0 - other / radius;
    Ok(placed(Primitive::Frustum { taper }, frame, from))
}

fn placed(primitive: Primitive, frame: DMat3, origin: DVec3) -> Solid {
    let world_from_local = DAffine3::from_mat3_translation(frame, origin);
    Solid::of_leaf(Leaf::new(primitive, world_from_local))
}

fn check_length(shape: &'static str, what: &'static str, value: f64) -> Result<(), CsgError> {
    if (SMALLEST..=LARGEST).contains(&value) {
        return Ok(());
    }
    Err(CsgError::Length { shape, what, value })
}

pub(crate) fn check_point(
    shape: &'static str,
    what: &'static str,
    point: DVec3,
) -> Result<(), CsgError> {
    if point.is_finite() && point.abs().max_element() <= LARGEST {
        return Ok(());
    }
    let value = point.to_array();
    Err(CsgError::Point { shape, what, value })
}

pub(crate) fn checked_direction(
    shape: &'static str,
    what: &'static str,
    direction: DVec3,
) -> Result<DVec3, CsgError> {
    direction.try_normalize().ok_or(CsgError::Direction {
        shape,
        what,
        value: direction.to_array(),
    })
}
