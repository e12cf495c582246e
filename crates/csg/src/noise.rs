//! Gradient noise over a wide range of coordinates, for patterns and bumps.

use glam::{DVec3, IVec3};
use hemicube_raster::noise::gradient_noise;

/// Perlin's noise in about [-1, 1], 0 at points with whole coordinates, and its gradient; it repeats after 2^32. Of points
/// that are not finite it is NaN.
fn noise(p: DVec3) -> (f64, DVec3) {
    let corner = p.floor();
    let cell = IVec3::from_array(corner.to_array().map(wrapped));
    let (value, gradient) = gradient_noise(cell, (p - corner).as_vec3(), 0);
    (value.into(), gradient.as_dvec3())
}

/// A sum of noises, each twice as fine and half as high as the one before: between -2 and 2.
pub(crate) fn turbulence(p: DVec3, octaves: u32) -> f64 {
    let octave = |i: u32| {
        let scale = f64::from(1_u32 << i.min(16));
        // Shifted, so that the zeros of the octaves do not lie on each other.
        noise(p * scale + 17.3 * f64::from(i)).0 / scale
    };
    (0..octaves).map(octave).sum()
}

/// The gradient of the noise.
pub(crate) fn noise_gradient(p: DVec3) -> DVec3 {
    noise(p).1
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a float that is too large saturates, a cell that is too far wraps; noise is noise there too"
)]
fn wrapped(x: f64) -> i32 {
    x as i64 as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_smooth_bounded_and_without_bias() {
        let (mut sum, mut count) = (0.0, 0.0);
        for i in 0..20_000 {
            let p = DVec3::new(0.37, 0.11, 0.73) * f64::from(i) * 0.618;
            let (value, slope) = noise(p);
            assert!(value.abs() <= 1.1, "{value} at {p}");
            let step = DVec3::new(1.0, -2.0, 0.5) * 1e-4;
            let near = noise(p + step).0;
            assert!(
                (value + slope.dot(step) - near).abs() < 1e-5,
                "a jump at {p}"
            );
            sum += value;
            count += 1.0;
        }
        let mean: f64 = sum / count;
        assert!(mean.abs() < 0.02, "mean {mean}");
    }

    #[test]
    fn noise_vanishes_at_whole_points_and_bears_huge_ones() {
        assert_eq!(noise(DVec3::new(3.0, -7.0, 12.0)).0, 0.0, "a whole point");
        for x in [1e300, -1e18, f64::MAX] {
            assert!(!noise(DVec3::splat(x)).0.is_infinite(), "{x}");
        }
    }
}
