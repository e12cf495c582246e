//! Regular bumps: ripples, bricks, and the dimples of a golf ball.

use super::{Relief, ReliefSample, hump};
use core::f32::consts::{PI, TAU};
use glam::{DVec2, Vec2, Vec3};

/// Rings around a point, as on water.
///
/// `h = a cos(2 pi r / wavelength - phase) exp(-damping r)`; in the very middle, where its slope is not defined unless
/// phase and damping are 0, it counts as 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ripples {
    /// Where they start. Default value: the origin.
    pub center: Vec3,
    /// Distance from ring to ring. Default value: 0.25.
    pub wavelength: f32,
    /// Height of the rings. Default value: 0.02.
    pub amplitude: f32,
    /// How far the rings have gone on, in radians. Default value: 0.
    pub phase: f32,
    /// How fast they fade, per length. Default value: 0.
    pub damping: f32,
}

impl Default for Ripples {
    fn default() -> Self {
        Self {
            center: Vec3::ZERO,
            wavelength: 0.25,
            amplitude: 0.02,
            phase: 0.0,
            damping: 0.0,
        }
    }
}

impl Ripples {
    /// Around another point.
    pub const fn with_center(self, center: Vec3) -> Self {
        Self { center, ..self }
    }

    /// With such a distance from ring to ring.
    pub const fn with_wavelength(self, wavelength: f32) -> Self {
        Self { wavelength, ..self }
    }

    /// With such a height.
    pub const fn with_amplitude(self, amplitude: f32) -> Self {
        Self { amplitude, ..self }
    }
}

impl Relief for Ripples {
    fn sample(&self, point: Vec3) -> ReliefSample {
        let to = point - self.center;
        let r = to.length();
        let k = TAU / self.wavelength;
        let (sin, cos) = (k * r - self.phase).sin_cos();
        let fade = self.amplitude * (-self.damping * r).exp();
        let slope = -fade * (k * sin + self.damping * cos);
        ReliefSample {
            height: fade * cos,
            gradient: to * if r > 0.0 { slope / r } else { 0.0 },
        }
        .or_flat()
    }
}

/// Bricks in running bond over x and y (y up or down alike), with rounded edges and mortar below them.
///
/// Every second course is shifted by half a brick. The height is 0 in the mortar and `height` on a brick; the edge rises
/// over `bevel` by the fade `t^3 (6 t^2 - 15 t + 10)`, along x and along y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bricks {
    /// Width and height of a brick with its half joints. Default value: 0.25 by 0.125.
    pub size: Vec2,
    /// Width of a joint. Default value: 0.015.
    pub joint: f32,
    /// Width of a rounded edge. Default value: 0.015.
    pub bevel: f32,
    /// Height of a brick above its mortar. Default value: 0.01.
    pub height: f32,
}

impl Default for Bricks {
    fn default() -> Self {
        Self {
            size: Vec2::new(0.25, 0.125),
            joint: 0.015,
            bevel: 0.015,
            height: 0.01,
        }
    }
}

impl Bricks {
    /// With bricks of such a size.
    pub const fn with_size(self, size: Vec2) -> Self {
        Self { size, ..self }
    }

    /// With bricks so far above their mortar.
    pub const fn with_height(self, height: f32) -> Self {
        Self { height, ..self }
    }

    /// With joints and rounded edges of such widths.
    pub const fn with_joint(self, joint: f32, bevel: f32) -> Self {
        Self {
            joint,
            bevel,
            ..self
        }
    }

    /// Rise from the middle of a joint and its derivative, at `along` of a brick of such a size.
    fn rise(&self, along: f32, size: f32) -> (f32, f32) {
        let place = along - size * (along / size).floor();
        let (distance, sign) = if place < 0.5 * size {
            (place, 1.0)
        } else {
            (size - place, -1.0)
        };
        let t = (distance - 0.5 * self.joint) / self.bevel;
        if t <= 0.0 {
            (0.0, 0.0)
        } else if t >= 1.0 {
            (1.0, 0.0)
        } else {
            let value = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
            let slope = 30.0 * t * t * (t * (t - 2.0) + 1.0);
            (value, sign * slope / self.bevel)
        }
    }
}

impl Relief for Bricks {
    fn sample(&self, point: Vec3) -> ReliefSample {
        let course = (point.y / self.size.y).floor();
        let shift = if course.rem_euclid(2.0) == 0.0 {
            0.0
        } else {
            0.5 * self.size.x
        };
        let (x, dx) = self.rise(point.x + shift, self.size.x);
        let (y, dy) = self.rise(point.y, self.size.y);
        ReliefSample {
            height: self.height * x * y,
            gradient: Vec3::new(dx * y, x * dy, 0.0) * self.height,
        }
        .or_flat()
    }
}

/// Round dimples spread evenly over all directions from the origin: a golf ball.
///
/// Their centres are a Fibonacci lattice: dimple `i` of `n` at height `1 - (2 i + 1) / n`, turned by the golden angle from
/// the one before. Only the direction of a point counts, not its distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GolfBall {
    /// How many, at most 65 536 are used. Default value: 336.
    pub dimples: u32,
    /// Depth of a dimple. Default value: 0.02.
    pub depth: f32,
    /// Radius of a dimple as a share of half the mean distance from one to the next. Default value: 0.95.
    pub radius: f32,
}

impl Default for GolfBall {
    fn default() -> Self {
        Self {
            dimples: 336,
            depth: 0.02,
            radius: 0.95,
        }
    }
}

impl GolfBall {
    /// With so many dimples.
    pub const fn with_dimples(self, dimples: u32) -> Self {
        Self { dimples, ..self }
    }

    /// With dimples of such a depth.
    pub const fn with_depth(self, depth: f32) -> Self {
        Self { depth, ..self }
    }

    /// Centres of the dimples from `first` to `last` of `n`.
    fn centers(first: u32, last: u32, n: f32) -> impl Iterator<Item = Vec3> {
        /// Pi (3 - sqrt 5).
        const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
        // In f64: of hundreds of turns f32 would keep five digits. One sine, and then turn by turn.
        let step = DVec2::from_angle(GOLDEN_ANGLE);
        let start = DVec2::from_angle(f64::from(first) * GOLDEN_ANGLE);
        let directions = std::iter::successors(Some(start), move |&d| Some(step.rotate(d)));
        (first..=last).zip(directions).map(move |(i, direction)| {
            let y = 1.0 - (2.0 * i as f32 + 1.0) / n;
            let around = direction.as_vec2() * (1.0 - y * y).sqrt();
            Vec3::new(around.x, y, around.y)
        })
    }
}

impl Relief for GolfBall {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to the number of dimples"
    )]
    fn sample(&self, point: Vec3) -> ReliefSample {
        let dimples = self.dimples.min(1 << 16);
        let n = dimples as f32;
        let distance = point.length();
        let direction = point / distance;
        // A sphere of n equal circles leaves each an area of 4 pi / n; hexagons of it are 2 sqrt(2 pi / (n sqrt 3)) apart.
        let radius = self.radius * (2.0 * PI / (n * 3.0_f32.sqrt())).sqrt();
        if dimples == 0 || !direction.is_finite() || !(radius > 0.0 && self.depth.is_finite()) {
            return ReliefSample::FLAT;
        }
        // Heights of the centres go down evenly, so only a belt of them can reach here.
        let belt = |y: f32| (((1.0 - y) * n - 1.0) * 0.5).clamp(0.0, n - 1.0);
        let first = belt(direction.y + radius).floor() as u32;
        let last = belt(direction.y - radius).ceil() as u32;
        let mut sum = ReliefSample::FLAT;
        for center in Self::centers(first, last, n) {
            let to = (direction - center) / radius;
            let (value, slope) = hump(to.length_squared());
            sum.height -= self.depth * value;
            sum.gradient -= to * (2.0 * slope * self.depth / radius);
        }
        // A direction changes by what of a step is across, over the distance.
        sum.gradient = (sum.gradient - direction * direction.dot(sum.gradient)) / distance;
        sum.or_flat()
    }
}
