//! Parallax: where a line of sight meets the relief below a surface.
//!
//! Bumped normals shade a relief but do not move it; parallax mapping also shifts the texture by what the eye sees
//! (Kaneko et al., *Detailed shape representation with parallax mapping*, ICAT 2001), here with the line of sight followed
//! through the relief, so that near parts hide far ones (Policarpo et al., *Real-time relief mapping*, I3D 2005; Tatarchuk
//! 2006). Silhouettes stay smooth with it too.

use glam::{Vec2, Vec3};

/// How a line of sight is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parallax {
    /// Equal steps of depth in which the first crossing is looked for, at least 1, at most 4096 are made; ridges thinner
    /// than a step may be missed. Default value: 32.
    pub steps: u32,
    /// Halvings of the step that holds the crossing, at most 32 are made. Default value: 6.
    pub refinements: u32,
}

impl Default for Parallax {
    fn default() -> Self {
        Self {
            steps: 32,
            refinements: 6,
        }
    }
}

impl Parallax {
    /// With so many steps.
    pub const fn with_steps(self, steps: u32) -> Self {
        Self { steps, ..self }
    }

    /// With so many halvings.
    pub const fn with_refinements(self, refinements: u32) -> Self {
        Self {
            refinements,
            ..self
        }
    }

    /// The texture coordinate that is seen, and its depth. `depth` is 0 at the surface and 1 at the bottom; `slope` is what
    /// [`sight_slope`] gives: the texture coordinate's change on the way from the surface to the bottom.
    ///
    /// The depth is off by at most `2^-refinements / steps` for a relief that has no ridges thinner than a step. Depths
    /// beyond the bottom count as 1, and so does NaN.
    pub fn meet(&self, depth: impl Fn(Vec2) -> f32, texcoord: Vec2, slope: Vec2) -> (Vec2, f32) {
        let is_below = |at: f32| at >= depth(texcoord + slope * at).clamp(0.0, 1.0);
        let steps = self.steps.clamp(1, 4096);
        let step = 1.0 / steps as f32;
        let crossed = (0..=steps)
            .map(|i| i as f32 * step)
            .find(|&at| is_below(at));
        let (mut low, mut high) = match crossed {
            Some(at) if at > 0.0 => (at - step, at),
            Some(at) => (at, at),
            // Rounding: the last step is at the bottom.
            None => (1.0, 1.0),
        };
        for _ in 0..self.refinements.min(32) {
            let middle = 0.5 * (low + high);
            if is_below(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        (texcoord + slope * high, high)
    }
}

/// The change of the texture coordinate along the line of sight from the surface down to `depth` below it.
///
/// `d_point` are the derivatives of the place by u and v, `view` points to the eye. `None` if the surface is not seen from
/// outside (`n . view <= 0`) or its derivatives are parallel.
pub fn sight_slope(normal: Vec3, d_point: [Vec3; 2], view: Vec3, depth: f32) -> Option<Vec2> {
    let out = normal.dot(view);
    let along = (normal * out - view) * (depth / out);
    let [pu, pv] = d_point;
    // Least squares: along = pu a + pv b.
    let (e, f, g) = (pu.dot(pu), pu.dot(pv), pv.dot(pv));
    let (s, t) = (along.dot(pu), along.dot(pv));
    let determinant = e * g - f * f;
    let slope = Vec2::new(g * s - f * t, e * t - f * s) / determinant;
    (out > 0.0 && determinant > 1e-6 * e * g && slope.is_finite()).then_some(slope)
}
