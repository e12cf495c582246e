//! Random bumps: gradient noise, and the pits of an orange.

use super::{Relief, ReliefSample, hump};
use glam::{IVec3, Vec3};

/// Perlin's gradient noise (*Improving noise*, SIGGRAPH 2002: fifth-degree fade) in several octaves.
///
/// Each octave has twice the frequency and `gain` times the height of the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Cells per unit of length in the first octave. Default value: 4.
    pub frequency: f32,
    /// Height of the first octave: it stays within about plus and minus this. Default value: 0.05.
    pub amplitude: f32,
    /// Number of octaves, at most 16 are used. Default value: 4.
    pub octaves: u32,
    /// Height of an octave over that of the one before. Default value: 0.5.
    pub gain: f32,
    /// Which of the noises. Default value: 0.
    pub seed: u32,
}

impl Default for Noise {
    fn default() -> Self {
        Self {
            frequency: 4.0,
            amplitude: 0.05,
            octaves: 4,
            gain: 0.5,
            seed: 0,
        }
    }
}

impl Noise {
    /// With so many cells per unit of length.
    pub const fn with_frequency(self, frequency: f32) -> Self {
        Self { frequency, ..self }
    }

    /// With such a height.
    pub const fn with_amplitude(self, amplitude: f32) -> Self {
        Self { amplitude, ..self }
    }

    /// With so many octaves.
    pub const fn with_octaves(self, octaves: u32) -> Self {
        Self { octaves, ..self }
    }

    /// With another seed.
    pub const fn with_seed(self, seed: u32) -> Self {
        Self { seed, ..self }
    }
}

impl Relief for Noise {
    fn sample(&self, point: Vec3) -> ReliefSample {
        let mut sum = ReliefSample::FLAT;
        let (mut frequency, mut amplitude) = (self.frequency, self.amplitude);
        for octave in 0..self.octaves.min(16) {
            let one = gradient_noise(point * frequency, self.seed.wrapping_add(octave));
            sum.height += amplitude * one.height;
            sum.gradient += one.gradient * (amplitude * frequency);
            frequency *= 2.0;
            amplitude *= self.gain;
        }
        sum.or_flat()
    }
}

/// One octave with cells of side 1.
fn gradient_noise(point: Vec3, seed: u32) -> ReliefSample {
    let corner = point.floor();
    let t = point - corner;
    let cell = corner.as_ivec3();
    let fade = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let slope = t * t * (t * (t - 2.0) + 1.0) * 30.0;
    let mut sum = ReliefSample::FLAT;
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
                let gradient = corner_gradient(bits ^ bits >> 13);
                let value = gradient.dot(t - to);
                let weight = weights.element_product();
                let d_weight = Vec3::new(
                    slopes.x * weights.y * weights.z,
                    weights.x * slopes.y * weights.z,
                    weights.x * weights.y * slopes.z,
                );
                sum.height += weight * value;
                sum.gradient += gradient * weight + d_weight * value;
            }
        }
    }
    sum
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
fn hash(cell: IVec3, seed: u32) -> u32 {
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

/// The skin of an orange: round pits of random depth, one somewhere in each cell of space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrangePeel {
    /// Cells per unit of length. Default value: 12.
    pub frequency: f32,
    /// Depth of the deepest pits. Default value: 0.02.
    pub depth: f32,
    /// Radius of the pits in cells, at most 1. Default value: 0.75.
    pub radius: f32,
    /// Which of the skins. Default value: 0.
    pub seed: u32,
}

impl Default for OrangePeel {
    fn default() -> Self {
        Self {
            frequency: 12.0,
            depth: 0.02,
            radius: 0.75,
            seed: 0,
        }
    }
}

impl OrangePeel {
    /// With so many cells per unit of length.
    pub const fn with_frequency(self, frequency: f32) -> Self {
        Self { frequency, ..self }
    }

    /// With such a depth.
    pub const fn with_depth(self, depth: f32) -> Self {
        Self { depth, ..self }
    }
}

impl Relief for OrangePeel {
    fn sample(&self, point: Vec3) -> ReliefSample {
        // With a radius of a cell at most, only pits of the 27 cells around can reach here.
        let radius = self.radius.min(1.0);
        let p = point * self.frequency;
        let corner = p.floor();
        let cell = corner.as_ivec3();
        let mut sum = ReliefSample::FLAT;
        for i in 0..27 {
            let step = IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            let bits = hash(cell.wrapping_add(step), self.seed);
            let share = |shift: u32| (bits >> shift & 0xff) as f32 / 256.0;
            let center = corner + step.as_vec3() + Vec3::new(share(0), share(8), share(16));
            let depth = self.depth * (0.4 + 0.6 * share(24));
            let to = (p - center) / radius;
            let (value, slope) = hump(to.length_squared());
            sum.height -= depth * value;
            sum.gradient -= to * (2.0 * slope * depth * self.frequency / radius);
        }
        sum.or_flat()
    }
}
