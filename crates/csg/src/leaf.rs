//! A primitive at its place in the world, with what it is made of.

use crate::CsgError;
use crate::bounds::{self, Bounds};
use crate::material::Material;
use crate::primitive::{CentredLine, Primitive};
use crate::ray::Ray;
use crate::span::{Boundaries, Boundary};
use glam::{DAffine3, DMat3, DVec3};
use std::sync::Arc;

/// The leaf of a tree of set operations. Transforms of whole solids are composed down to here, so a ray is transformed
/// once however deep the tree is.
#[derive(Debug, Clone)]
pub(crate) struct Leaf {
    primitive: Primitive,
    world_from_local: DAffine3,
    local_from_world: DAffine3,
    pub material: Option<Arc<Material>>,
    /// From the world to where the material was attached: patterns move with the solid.
    pub material_from_world: DAffine3,
}

/// How much a primitive may be stretched or squeezed by all of its transforms.
const STRETCH: core::ops::RangeInclusive<f64> = 1e-12..=1e12;

impl Leaf {
    pub(crate) fn new(primitive: Primitive, world_from_local: DAffine3) -> Self {
        Self {
            primitive,
            world_from_local,
            local_from_world: world_from_local.inverse(),
            material: None,
            material_from_world: DAffine3::IDENTITY,
        }
    }

    /// Moves it by a transform that is known to have an inverse.
    pub(crate) fn transform(&mut self, new_from_old: &DAffine3) -> Result<(), CsgError> {
        let world_from_local = *new_from_old * self.world_from_local;
        let local_from_world = world_from_local.inverse();
        let is_usable = |m: &DAffine3| {
            let columns = [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis];
            m.is_finite() && columns.iter().all(|c| STRETCH.contains(&c.length()))
        };
        if !is_usable(&world_from_local) || !is_usable(&local_from_world) {
            let determinant = new_from_old.matrix3.determinant();
            return Err(CsgError::Transform { determinant });
        }
        self.world_from_local = world_from_local;
        self.local_from_world = local_from_world;
        self.material_from_world *= new_from_old.inverse();
        Ok(())
    }

    pub(crate) fn bounds(&self) -> Bounds {
        match self.primitive {
            Primitive::HalfSpace => self.half_space_bounds(),
            primitive => primitive.bounds().transformed(&self.world_from_local),
        }
    }

    /// On one side of a plane at right angles to an axis, else everywhere: what such planes cut off is not looked at.
    fn half_space_bounds(&self) -> Bounds {
        let mut bounds = Bounds::EVERYTHING;
        let place = self.world_from_local.translation;
        let normal = self.normal(place);
        for axis in 0..3 {
            let margin = bounds::MARGIN * (1.0 + place[axis].abs());
            if normal[axis] == 1.0 {
                bounds.high[axis] = place[axis] + margin;
            } else if normal[axis] == -1.0 {
                bounds.low[axis] = place[axis] - margin;
            }
        }
        bounds
    }

    pub(crate) fn contains(&self, point: DVec3) -> bool {
        self.primitive
            .contains(self.local_from_world.transform_point3(point))
    }

    /// Outward unit normal at a point of the surface.
    pub(crate) fn normal(&self, point: DVec3) -> DVec3 {
        let local = self.local_from_world.transform_point3(point);
        let normal = self.primitive.normal(local);
        (self.local_from_world.matrix3.transpose() * normal).normalize_or_zero()
    }

    /// Appends the ends of the ray's spans.
    pub(crate) fn push_ends<'a>(&'a self, ray: &Ray, list: &mut Boundaries<'a>) {
        let origin = self.local_from_world.transform_point3(ray.origin());
        let direction = self.local_from_world.transform_vector3(ray.direction());
        let length = direction.length();
        let direction = direction / length;
        let nearest = -origin.dot(direction);
        let line = CentredLine {
            origin: origin + direction * nearest,
            direction,
        };
        let boundary = |&t: &f64| Boundary {
            t: (nearest + t) / length,
            leaf: t.is_finite().then_some(self),
        };
        list.extend(self.primitive.ends(&line).as_slice().iter().map(boundary));
    }

    /// Rotates and scales a gradient taken where the material is into the world.
    pub(crate) fn world_gradient(&self, gradient: DVec3) -> DVec3 {
        let m: DMat3 = self.material_from_world.matrix3;
        m.transpose() * gradient
    }
}
