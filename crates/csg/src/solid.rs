//! Solids: primitives, set operations on them to any depth, transforms.

use crate::bounds::Bounds;
use crate::error::CsgError;
use crate::leaf::Leaf;
use crate::material::Material;
use crate::ray::Ray;
use crate::span::{Boundaries, Operation, combine, complement};
use core::ops::{BitAnd, BitOr, Not, Range, Sub};
use glam::{DAffine3, DQuat, DVec3};
use std::sync::Arc;

/// A set of points with a surface: what is inside a primitive, or the union, intersection, difference or complement of
/// others, nested as one likes.
///
/// ```
/// use glam::DVec3;
/// use hemicube_csg::{Ray, Solid};
///
/// # fn main() -> Result<(), hemicube_csg::CsgError> {
/// let shell = Solid::sphere(DVec3::ZERO, 2.0)? - Solid::sphere(DVec3::ZERO, 1.0)?;
/// let spans = shell.spans(&Ray::new(DVec3::new(-5.0, 0.0, 0.0), DVec3::X));
/// assert_eq!(spans, [3.0..4.0, 6.0..7.0]);
/// # Ok(())
/// # }
/// ```
///
/// Rays walk the tree by recursion. [`Solid::union`] builds a balanced tree from any number of solids; chains of
/// operators are as deep as they are long.
#[derive(Debug, Clone)]
pub struct Solid {
    bounds: Bounds,
    kind: Kind,
}

#[derive(Debug, Clone)]
enum Kind {
    Empty,
    Leaf(Arc<Leaf>),
    Complement(Box<Solid>),
    Pair(Operation, Box<[Solid; 2]>),
}

impl Solid {
    pub(crate) fn of_leaf(leaf: Leaf) -> Self {
        Self {
            bounds: leaf.bounds(),
            kind: Kind::Leaf(Arc::new(leaf)),
        }
    }

    /// No point at all.
    pub fn empty() -> Self {
        Self {
            bounds: Bounds::EMPTY,
            kind: Kind::Empty,
        }
    }

    fn pair(operation: Operation, a: Self, b: Self) -> Self {
        let bounds = match operation {
            Operation::Union => a.bounds.union(&b.bounds),
            Operation::Intersection => a.bounds.intersection(&b.bounds),
            Operation::Difference => a.bounds,
        };
        Self {
            bounds,
            kind: Kind::Pair(operation, Box::new([a, b])),
        }
    }

    /// The union of any number of solids, empty if there are none. Neighbours are joined first, so that a ray only
    /// looks at those that lie near it: halves along the longest side of the box around their centres, again and
    /// again.
    pub fn union(solids: impl IntoIterator<Item = Self>) -> Self {
        let (bounded, unbounded): (Vec<Self>, Vec<Self>) =
            solids.into_iter().partition(|s| s.bounds.is_bounded());
        let near: Vec<Self> = bounded
            .into_iter()
            .filter(|s| !s.bounds.is_empty())
            .collect();
        unbounded
            .into_iter()
            .fold(Self::union_of_neighbours(near), BitOr::bitor)
    }

    fn union_of_neighbours(mut solids: Vec<Self>) -> Self {
        if solids.len() < 2 {
            return solids.pop().unwrap_or_else(Self::empty);
        }
        let axis = longest_axis(solids.iter().map(|s| s.bounds.centre()));
        let by_place = |a: &Self, b: &Self| {
            let place = |s: &Self| s.bounds.centre()[axis];
            place(a).total_cmp(&place(b))
        };
        solids.sort_by(by_place);
        let upper = solids.split_off(solids.len() / 2);
        Self::union_of_neighbours(solids) | Self::union_of_neighbours(upper)
    }

    /// A box that holds the solid; not always the smallest one.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Gives a material to those parts of the surface that have none yet. Cut surfaces belong to what cuts: a red
    /// apple minus a white sphere has a red skin and a white bite.
    pub fn with_material(self, material: Material) -> Self {
        let material = Arc::new(material);
        self.map_leaves(&mut |leaf| {
            if leaf.material.is_none() {
                leaf.material = Some(Arc::clone(&material));
                leaf.material_from_world = DAffine3::IDENTITY;
            }
            Ok(())
        })
        .expect("attaching a material changes no geometry")
    }

    /// The solid moved, turned, stretched or sheared; its patterns go with it.
    pub fn transformed(self, new_from_old: DAffine3) -> Result<Self, CsgError> {
        let determinant = new_from_old.matrix3.determinant();
        let columns = new_from_old.matrix3.to_cols_array().map(f64::abs);
        let largest = columns.into_iter().fold(0.0, f64::max);
        let is_usable = new_from_old.is_finite()
            && new_from_old.translation.abs().max_element() <= crate::LARGEST
            && (1e-6..=1e6).contains(&largest)
            && determinant.abs() > 1e-18;
        if !is_usable {
            return Err(CsgError::Transform { determinant });
        }
        self.map_leaves(&mut |leaf| leaf.transform(&new_from_old))
    }

    /// The solid moved.
    pub fn moved(self, by: DVec3) -> Result<Self, CsgError> {
        self.transformed(DAffine3::from_translation(by))
    }

    /// The solid stretched along the axes, away from the origin; a negative factor mirrors it.
    pub fn scaled(self, factors: DVec3) -> Result<Self, CsgError> {
        self.transformed(DAffine3::from_scale(factors))
    }

    /// The solid turned around an axis through the origin, anticlockwise seen from the axis' tip.
    pub fn turned(self, axis: DVec3, radians: f64) -> Result<Self, CsgError> {
        let Some(axis) = axis.try_normalize() else {
            return Err(CsgError::Direction {
                shape: "turn",
                what: "axis",
                value: axis.to_array(),
            });
        };
        self.transformed(DAffine3::from_quat(DQuat::from_axis_angle(axis, radians)))
    }

    fn map_leaves(
        self,
        change: &mut impl FnMut(&mut Leaf) -> Result<(), CsgError>,
    ) -> Result<Self, CsgError> {
        Ok(match self.kind {
            Kind::Empty => self,
            Kind::Leaf(leaf) => {
                let mut leaf = Arc::unwrap_or_clone(leaf);
                change(&mut leaf)?;
                Self::of_leaf(leaf)
            }
            Kind::Complement(inner) => !inner.map_leaves(change)?,
            Kind::Pair(operation, pair) => {
                let [a, b] = *pair;
                Self::pair(operation, a.map_leaves(change)?, b.map_leaves(change)?)
            }
        })
    }

    /// Whether a point lies inside. On the surface either may be true.
    pub fn contains(&self, point: DVec3) -> bool {
        match &self.kind {
            Kind::Empty => false,
            Kind::Leaf(leaf) => leaf.contains(point),
            Kind::Complement(inner) => !inner.contains(point),
            Kind::Pair(operation, pair) => {
                operation.is_inside(pair[0].contains(point), pair[1].contains(point))
            }
        }
    }

    /// The parts of a line that lie inside, ascending, before its origin too. They may reach to infinity; those
    /// shorter than about 1e-9 are left out.
    pub fn spans(&self, ray: &Ray) -> Vec<Range<f64>> {
        let mut list = Vec::new();
        if ray.is_cast() {
            self.push_boundaries(ray, &(f64::NEG_INFINITY..f64::INFINITY), &mut list);
        }
        list.as_chunks()
            .0
            .iter()
            .map(|[enter, leave]| enter.t..leave.t)
            .collect()
    }

    /// Appends the boundaries that the ray crosses. Only within `range` are they those of the solid: what lies outside
    /// may be left out.
    pub(crate) fn push_boundaries<'a>(
        &'a self,
        ray: &Ray,
        range: &Range<f64>,
        list: &mut Boundaries<'a>,
    ) {
        if !self.bounds.is_hit(ray, range) {
            return;
        }
        let first = list.len();
        match &self.kind {
            Kind::Empty => {}
            Kind::Leaf(leaf) => leaf.push_ends(ray, list),
            Kind::Complement(inner) => {
                inner.push_boundaries(ray, range, list);
                complement(list, first);
            }
            Kind::Pair(operation, pair) => {
                pair[0].push_boundaries(ray, range, list);
                let second = list.len();
                if second == first && *operation != Operation::Union {
                    return;
                }
                pair[1].push_boundaries(ray, range, list);
                combine(*operation, list, first, second);
            }
        }
    }
}

/// The axis along which points spread most.
pub(crate) fn longest_axis(points: impl Iterator<Item = DVec3>) -> usize {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = points.fold(start, |(low, high), p| (low.min(p), high.max(p)));
    (high - low).max_position()
}

/// Union: what is in one or in both.
impl BitOr for Solid {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self::pair(Operation::Union, self, other)
    }
}

/// Intersection: what is in both.
impl BitAnd for Solid {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        Self::pair(Operation::Intersection, self, other)
    }
}

/// Difference: what is in the first and not in the second.
impl Sub for Solid {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::pair(Operation::Difference, self, other)
    }
}

/// Complement: everything else.
impl Not for Solid {
    type Output = Self;
    fn not(self) -> Self {
        Self {
            bounds: Bounds::EVERYTHING,
            kind: Kind::Complement(Box::new(self)),
        }
    }
}
