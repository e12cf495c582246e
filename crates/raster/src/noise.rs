//! Gradient noise with its exact gradient, and hashes of cells of space.

use glam::{IVec3, Vec3};

/// Perlin's gradient noise (*Improving noise*, SIGGRAPH 2002: fifth-degree fade) at a point, and its gradient. A hash
/// stands in place of the table, so that it repeats only every 2^32 cells.
///
/// The point is given as its cell, of side 1, and its place from 0 to 1 within: coordinates of any size and precision can
/// be cut in two. The noise is 0 at the corners of cells, stays within about [-1, 1], and is twice continuously
/// differentiable.
pub fn gradient_noise(cell: IVec3, within: Vec3, seed: u32) -> (f32, Vec3) {
    let t = within;
    let fade = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let slope = t * t * (t * (t - 2.0) + 1.0) * 30.0;
    let (mut height, mut gradient) = (0.0, Vec3::ZERO);
    // Hashes go from axis to axis, so that corners share what they have in common.
    let seeded = mix(SALT, seed);
    for x in 0..2 {
        let of_x = mix(seeded, cell.x.wrapping_add(x).cast_unsigned());
        for y in 0..2 {
            let of_y = mix(of_x, cell.y.wrapping_add(y).cast_unsigned());
            for z in 0..2 {
                let bits = mix(of_y, cell.z.wrapping_add(z).cast_unsigned());
                let to = IVec3::new(x, y, z).as_vec3();
                let weights = Vec3::ONE - to + fade * (to * 2.0 - 1.0);
                let slopes = slope * (to * 2.0 - 1.0);
                let of_corner = corner_gradient(bits ^ bits >> 13);
                let value = of_corner.dot(t - to);
                let weight = weights.element_product();
                let d_weight = Vec3::new(
                    slopes.x * weights.y * weights.z,
                    weights.x * slopes.y * weights.z,
                    weights.x * weights.y * slopes.z,
                );
                height += weight * value;
                gradient += of_corner * weight + d_weight * value;
            }
        }
    }
    (height, gradient)
}

/// One of the twelve directions from the middle of a cube to those of its edges.
fn corner_gradient(hash: u32) -> Vec3 {
    let axis = (hash >> 8) % 3;
    let sign = |bit: u32| if hash >> bit & 1 == 0 { 1.0 } else { -1.0 };
    let (a, b) = (sign(0), sign(1));
    match axis {
        0 => Vec3::new(0.0, a, b),
        1 => Vec3::new(a, 0.0, b),
        _ => Vec3::new(a, b, 0.0),
    }
}

/// 32 well-mixed bits of a cell.
pub fn hash(cell: IVec3, seed: u32) -> u32 {
    let coordinates = cell.to_array().map(i32::cast_unsigned);
    let h = coordinates.into_iter().fold(mix(SALT, seed), mix);
    h ^ h >> 13
}

/// Where hashes start.
const SALT: u32 = 0x27d4_eb2f;

/// A hash with another value in it: two multiplications by odd numbers around a shift.
fn mix(h: u32, value: u32) -> u32 {
    let h = (h ^ value).wrapping_mul(0x9e37_79b1);
    (h ^ h >> 15).wrapping_mul(0x85eb_ca77)
}
