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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistortionSummary {
    /// Surface area on which there is a texture, in the units of the places.
    pub mapped_area: f64,
    /// Share of the surface on which there is a texture.
    pub mapped: f64,
    /// Texture area on a unit of surface: smallest, mean, largest.
    pub area: [f64; 3],
    /// Ratio of the singular values: smallest, mean, largest. The mean is the geometric one: one line of infinite
    /// anisotropy does not drown the rest. Points of infinite anisotropy count in the largest only.
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

/// Sums for a summary; x, y and z are weights, areas and logarithms of anisotropies.
#[derive(Debug, Default)]
struct Sums {
    total: f64,
    mapped: f64,
    area: f64,
    anisotropy: f64,
    /// Weight of what has a finite anisotropy.
    finite: f64,
    area_range: Option<[f64; 2]>,
    anisotropy_range: Option<[f64; 2]>,
}

impl Sums {
    fn add(&mut self, weight: f64, distortion: Option<Distortion>) {
        self.total += weight;
        let Some(distortion) = distortion else {
            return;
        };
        let (area, anisotropy) = (distortion.area(), distortion.anisotropy());
        self.mapped += weight;
        self.area += weight * area;
        if anisotropy.is_finite() {
            self.anisotropy += weight * anisotropy.ln();
            self.finite += weight;
        }
        widen(&mut self.area_range, area);
        widen(&mut self.anisotropy_range, anisotropy);
    }

    fn summary(&self) -> Option<DistortionSummary> {
        let ([a0, a1], [b0, b1]) = (self.area_range?, self.anisotropy_range?);
        let mean = if self.finite > 0.0 {
            (self.anisotropy / self.finite).exp()
        } else {
            f64::INFINITY
        };
        Some(DistortionSummary {
            mapped_area: self.mapped,
            mapped: self.mapped / self.total,
            area: [a0, self.area / self.mapped, a1],
            anisotropy: [b0, mean, b1],
        })
    }
}

fn widen(range: &mut Option<[f64; 2]>, value: f64) {
    let [low, high] = range.unwrap_or([value; 2]);
    *range = Some([low.min(value), high.max(value)]);
}

/// Two directions of length 1 at right angles to each other and to `normal`: along them derivatives are per unit of
/// length. Any two if the normal is zero.
pub fn surface_frame(normal: Vec3) -> [Vec3; 2] {
    let normal = normal.as_dvec3().try_normalize().unwrap_or(DVec3::Z);
    let (a, b) = normal.any_orthonormal_pair();
    [a.as_vec3(), b.as_vec3()]
}
