//! How much a mapping stretches a texture.

use glam::{DVec3, Vec2, Vec3};

/// Singular values of the map from the surface to the texture: texture coordinates per unit of length.
///
/// A small circle on the surface is an ellipse in the texture with these half axes, per radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distortion {
    /// The larger one: along it, the texture is the most squeezed on the surface.
    pub major: f64,
    /// The smaller one: along it, it is the most stretched.
    pub minor: f64,
}

impl Distortion {
    /// From the derivatives of place and texture coordinate by any two parameters, a pixel's column and row for example.
    ///
    /// With `P` and `T` the matrices that have them as columns, the singular values of `T P^+` are the square roots of
    /// the eigenvalues of `(P^T P)^-1 T^T T`. `None` if the derivatives of the place are parallel or a number is not
    /// finite.
    pub fn of(d_point: [Vec3; 2], d_texcoord: [Vec2; 2]) -> Option<Self> {
        let [p, q] = d_point.map(|d| d.as_dvec3());
        let [s, t] = d_texcoord.map(|d| d.as_dvec2());
        let det_g = p.cross(q).length_squared();
        let (e, f, g) = (p.dot(p), p.dot(q), q.dot(q));
        let (a, b, c) = (s.dot(s), s.dot(t), t.dot(t));
        let trace = (g * a - 2.0 * f * b + e * c) / det_g;
        let area = s.perp_dot(t).abs() / det_g.sqrt();
        // sigma_1^2 + sigma_2^2 = trace and sigma_1 sigma_2 = area give sigma_1 +- sigma_2 without cancellation.
        let sum = (trace + 2.0 * area).max(0.0).sqrt();
        let difference = (trace - 2.0 * area).max(0.0).sqrt();
        let distortion = Self {
            major: 0.5 * (sum + difference),
            minor: 0.5 * (sum - difference).max(0.0),
        };
        (distortion.major.is_finite() && distortion.minor.is_finite()).then_some(distortion)
    }

    /// Texture area on a unit of surface.
    pub fn area(&self) -> f64 {
        self.major * self.minor
    }

    /// Ratio of the two, at least 1: 1 where the mapping is conformal, infinite where it is a line or a point.
    pub fn anisotropy(&self) -> f64 {
        if self.major == 0.0 {
            f64::INFINITY
        } else {
            self.major / self.minor
        }
    }
}

/// Smallest, mean and largest distortion over a surface, weighted by area.
///
/// Means are geometric: a mapping has poles and lines where it squeezes without bound, and an arithmetic mean would tell
/// of nothing else. Where a value is zero or infinite it counts as smallest or largest, but not in the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistortionSummary {
    /// Surface area on which there is a texture, in the units of the places.
    pub mapped_area: f64,
    /// Share of the surface on which there is a texture.
    pub mapped: f64,
    /// Texture area on a unit of surface: smallest, mean, largest.
    pub area: [f64; 3],
    /// Ratio of the singular values: smallest, mean, largest.
    pub anisotropy: [f64; 3],
}

impl DistortionSummary {
    /// Sums up samples of surface area and of the distortion there, `None` where there is no texture. `None` if there is
    /// a texture nowhere.
    pub fn of(samples: impl IntoIterator<Item = (f64, Option<Distortion>)>) -> Option<Self> {
        let mut sums = Sums::default();
        for (weight, distortion) in samples {
            sums.add(weight, distortion);
        }
        sums.summary()
    }
}

/// Sums for a summary.
#[derive(Debug, Default)]
struct Sums {
    total: f64,
    mapped: f64,
    area: Spread,
    anisotropy: Spread,
}

impl Sums {
    fn add(&mut self, weight: f64, distortion: Option<Distortion>) {
        self.total += weight;
        if let Some(distortion) = distortion {
            self.mapped += weight;
            self.area.add(weight, distortion.area());
            self.anisotropy.add(weight, distortion.anisotropy());
        }
    }

    fn summary(&self) -> Option<DistortionSummary> {
        Some(DistortionSummary {
            mapped_area: self.mapped,
            mapped: self.mapped / self.total,
            area: self.area.summary()?,
            anisotropy: self.anisotropy.summary()?,
        })
    }
}

/// Range and geometric mean of values that are not negative.
#[derive(Debug, Default)]
struct Spread {
    range: Option<[f64; 2]>,
    logarithms: f64,
    weight: f64,
}

impl Spread {
    fn add(&mut self, weight: f64, value: f64) {
        let [low, high] = self.range.unwrap_or([value; 2]);
        self.range = Some([low.min(value), high.max(value)]);
        if value > 0.0 && value.is_finite() {
            self.logarithms += weight * value.ln();
            self.weight += weight;
        }
    }

    /// Smallest, mean, largest; a mean of nothing is the largest.
    fn summary(&self) -> Option<[f64; 3]> {
        let [low, high] = self.range?;
        let mean = if self.weight > 0.0 {
            (self.logarithms / self.weight).exp()
        } else {
            high
        };
        Some([low, mean, high])
    }
}

/// Two directions of length 1 at right angles to each other and to `normal`: along them derivatives are per unit of
/// length. Any two if the normal is zero.
pub fn surface_frame(normal: Vec3) -> [Vec3; 2] {
    let normal = normal.as_dvec3().try_normalize().unwrap_or(DVec3::Z);
    let (a, b) = normal.any_orthonormal_pair();
    [a.as_vec3(), b.as_vec3()]
}
