//! Gradient noise, for patterns and bumps.

use glam::DVec3;

/// Smooth noise in about [-1, 1], 0 at points with whole coordinates: Perlin, *Improving noise* (SIGGRAPH 2002), with
/// a hash of the coordinates in place of a table, so that it does not repeat. Twice continuously differentiable.
pub(crate) fn gradient_noise(p: DVec3) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    let fade = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let [x, y, z] = cell.to_array().map(whole);
    let corner = |i: i64, j: i64, k: i64| {
        let offset = DVec3::new(i as f64, j as f64, k as f64);
        gradient(hash(
            x.wrapping_add(i),
            y.wrapping_add(j),
            z.wrapping_add(k),
        ))
        .dot(f - offset)
    };
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let edge = |j, k| mix(corner(0, j, k), corner(1, j, k), fade.x);
    let face = |k| mix(edge(0, k), edge(1, k), fade.y);
    mix(face(0), face(1), fade.z)
}

/// A sum of noises, each twice as fine and half as high as the one before: between -2 and 2.
pub(crate) fn turbulence(p: DVec3, octaves: u32) -> f64 {
    let octave = |i: u32| {
        let scale = f64::from(1_u32 << i.min(16));
        // Shifted, so that the zeros of the octaves do not lie on each other.
        gradient_noise(p * scale + 17.3 * f64::from(i)) / scale
    };
    (0..octaves).map(octave).sum()
}

/// The gradient of the noise, by central differences; its error of 1e-6 is below what a picture shows.
pub(crate) fn noise_gradient(p: DVec3) -> DVec3 {
    let h = 1e-3;
    let slope = |step: DVec3| (gradient_noise(p + step) - gradient_noise(p - step)) / (2.0 * h);
    DVec3::new(
        slope(DVec3::X * h),
        slope(DVec3::Y * h),
        slope(DVec3::Z * h),
    )
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "a float that is too large saturates; noise is noise there too"
)]
fn whole(x: f64) -> i64 {
    x as i64
}

/// Mixes three whole numbers into one (the finaliser of SplitMix64).
fn hash(x: i64, y: i64, z: i64) -> u64 {
    let mut h = x
        .wrapping_mul(0x1F12_3BB5_u32.into())
        .wrapping_add(y.wrapping_mul(0x0549_1333_i64))
        .wrapping_add(z.wrapping_mul(0x3E4F_1CD1_i64))
        .cast_unsigned()
        .wrapping_mul(0x9E37_79B9_7F4A_7C15);
    h = (h ^ (h >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    h = (h ^ (h >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    h ^ (h >> 31)
}

/// One of the twelve vectors from the centre of a cube to its edges.
fn gradient(hash: u64) -> DVec3 {
    let sign = |bit: u64| if hash >> bit & 1 == 0 { 1.0 } else { -1.0 };
    let (a, b) = (sign(0), sign(1));
    match (hash >> 8) % 3 {
        0 => DVec3::new(a, b, 0.0),
        1 => DVec3::new(a, 0.0, b),
        _ => DVec3::new(0.0, a, b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_smooth_bounded_and_without_bias() {
        let (mut sum, mut count) = (0.0, 0.0);
        for i in 0..20_000 {
            let p = DVec3::new(0.37, 0.11, 0.73) * f64::from(i) * 0.618;
            let noise = gradient_noise(p);
            assert!(noise.abs() <= 1.1, "{noise} at {p}");
            let near = gradient_noise(p + DVec3::splat(1e-6));
            assert!((noise - near).abs() < 1e-5, "a jump at {p}");
            sum += noise;
            count += 1.0;
        }
        let mean: f64 = sum / count;
        assert!(mean.abs() < 0.02, "mean {mean}");
    }

    #[test]
    fn noise_vanishes_at_whole_points_and_bears_huge_ones() {
        assert_eq!(
            gradient_noise(DVec3::new(3.0, -7.0, 12.0)),
            0.0,
            "a whole point"
        );
        for x in [1e300, -1e18, f64::MAX] {
            assert!(!gradient_noise(DVec3::splat(x)).is_infinite(), "{x}");
        }
    }
}
