//! Random solids and rays, the same at every run.
#![allow(dead_code, reason = "each test uses what it needs of it")]

use glam::{DAffine3, DQuat, DVec3};
use hemicube_csg::{Ray, Solid};
use hemicube_raster::random::SplitMix64;

/// A sequence of numbers in [0, 1).
pub struct Numbers(SplitMix64);

impl Numbers {
    pub fn new(seed: u64) -> Self {
        Self(SplitMix64::new(seed))
    }

    pub fn next(&mut self) -> f64 {
        self.0.unit64()
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// A point of the cube from -1 to 1.
    pub fn point(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| self.between(-1.0, 1.0)))
    }

    pub fn direction(&mut self) -> DVec3 {
        loop {
            let p = self.point();
            if (0.1..1.0).contains(&p.length()) {
                return p.normalize();
            }
        }
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 0 to below count"
    )]
    pub fn index(&mut self, count: usize) -> usize {
        ((self.next() * count as f64) as usize).min(count - 1)
    }

    /// A line through the middle of things, starting anywhere, often inside.
    pub fn ray(&mut self) -> Ray {
        Ray::new(self.point() * 2.0, self.direction())
    }
}

/// A primitive of any kind.
pub fn primitive(numbers: &mut Numbers) -> Solid {
    let n = numbers;
    let solid = match n.index(7) {
        0 => Solid::sphere(n.point(), n.between(0.2, 1.0)),
        1 => Solid::cuboid(n.point(), n.point() + DVec3::splat(0.1)),
        2 => Solid::cylinder(n.point(), n.point() * 1.1, n.between(0.1, 0.8)),
        3 => Solid::cone(n.point(), n.between(0.1, 1.0), n.point() * 1.1),
        4 => Solid::frustum(
            n.point(),
            n.between(0.1, 1.0),
            n.point() * 1.1,
            n.between(0.0, 1.0),
        ),
        5 => Solid::torus(
            n.point(),
            n.direction(),
            n.between(0.3, 0.9),
            n.between(0.05, 1.2),
        ),
        _ => Solid::half_space(n.point(), n.direction()),
    };
    solid.expect("the parameters are within their ranges")
}

/// A tree of set operations with transforms on the way.
pub fn tree(numbers: &mut Numbers, depth: u32) -> Solid {
    if depth == 0 {
        return primitive(numbers);
    }
    let (a, b) = (tree(numbers, depth - 1), tree(numbers, depth - 1));
    let both = match numbers.index(4) {
        0 => a | b,
        1 => a & b,
        2 => a - b,
        _ => !a | b,
    };
    let turn = DQuat::from_axis_angle(numbers.direction(), numbers.between(0.0, 6.0));
    let scale = DVec3::new(numbers.between(0.5, 1.5), numbers.between(0.5, 1.5), -1.0);
    both.transformed(DAffine3::from_scale_rotation_translation(
        scale,
        turn,
        numbers.point() * 0.3,
    ))
    .expect("an invertible transform")
}
