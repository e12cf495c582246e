//! Numbers that carry their derivatives (forward-mode automatic differentiation, Clifford's dual numbers).
//!
//! A formula written once for [`Dual`] gives its value and its exact derivatives. A branch taken by value takes the
//! derivatives of the same branch: that is what keeps texture derivatives small across seams.

use core::ops::{Add, Div, Mul, Neg, Sub};
use glam::DVec3;

/// A value and its derivatives by two parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dual {
    pub value: f64,
    pub d: [f64; 2],
}

impl Dual {
    /// A number that does not change.
    pub const fn constant(value: f64) -> Self {
        Self { value, d: [0.0; 2] }
    }

    /// A function of a value and of its derivative there.
    fn chain(self, value: f64, slope: f64) -> Self {
        Self {
            value,
            d: self.d.map(|d| d * slope),
        }
    }

    /// A function of two values and of its derivatives by them.
    fn combine(self, o: Self, value: f64, slope: f64, slope_o: f64) -> Self {
        Self {
            value,
            d: [0, 1].map(|k| self.d[k] * slope + o.d[k] * slope_o),
        }
    }

    /// Square root; at 0, where the slope is infinite, the derivatives count as 0.
    pub fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }

    /// Angle of the vector `(x, self)` in radians. Its derivatives do not know where the angle jumps; at (0, 0) they
    /// count as 0.
    pub fn atan2(self, x: Self) -> Self {
        let square = x.value * x.value + self.value * self.value;
        let inverse = if square > 0.0 { 1.0 / square } else { 0.0 };
        Self {
            value: self.value.atan2(x.value),
            d: [0, 1].map(|k| (x.value * self.d[k] - self.value * x.d[k]) * inverse),
        }
    }

    pub fn is_finite(self) -> bool {
        self.value.is_finite() && self.d.iter().all(|d| d.is_finite())
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            value: self.value + o.value,
            d: [self.d[0] + o.d[0], self.d[1] + o.d[1]],
        }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        self.combine(o, self.value * o.value, o.value, self.value)
    }
}

impl Mul<f64> for Dual {
    type Output = Self;
    fn mul(self, k: f64) -> Self {
        self.chain(self.value * k, k)
    }
}

impl Add<f64> for Dual {
    type Output = Self;
    fn add(self, k: f64) -> Self {
        Self {
            value: self.value + k,
            ..self
        }
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let value = self.value / o.value;
        let slope = 1.0 / o.value;
        self.combine(o, value, slope, -value * slope)
    }
}

/// A vector of such numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dual3(pub [Dual; 3]);

impl Dual3 {
    /// A vector and its derivatives.
    pub fn new(value: DVec3, d: [DVec3; 2]) -> Self {
        Self([0, 1, 2].map(|i| Dual {
            value: value[i],
            d: [d[0][i], d[1][i]],
        }))
    }

    pub fn x(self) -> Dual {
        self.0[0]
    }

    pub fn y(self) -> Dual {
        self.0[1]
    }

    pub fn z(self) -> Dual {
        self.0[2]
    }

    pub fn dot(self, o: Self) -> Dual {
        self.x() * o.x() + self.y() * o.y() + self.z() * o.z()
    }

    pub fn scaled(self, k: Dual) -> Self {
        Self(self.0.map(|c| c * k))
    }

    /// Of length 1; `None` for a vector of length 0.
    pub fn normalized(self) -> Option<Self> {
        let length = self.dot(self).sqrt();
        (length.value > 0.0).then(|| self.scaled(Dual::constant(1.0) / length))
    }

    /// The vector, unless all of it is 0.
    pub fn non_zero(self) -> Option<Self> {
        (self.value() != DVec3::ZERO).then_some(self)
    }

    pub fn value(self) -> DVec3 {
        DVec3::from(self.0.map(|c| c.value))
    }

    pub fn is_finite(self) -> bool {
        self.0.iter().all(|c| c.is_finite())
    }
}

impl Add for Dual3 {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self([0, 1, 2].map(|i| self.0[i] + o.0[i]))
    }
}

impl Sub for Dual3 {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self([0, 1, 2].map(|i| self.0[i] - o.0[i]))
    }
}
