//! Random bumps: gradient noise, and the pits of an orange.

use super::{Relief, ReliefSample, hump};
use crate::noise::{gradient_noise, hash};
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
        for i in 0..self.octaves.min(16) {
            let one = octave(point * frequency, self.seed.wrapping_add(i));
            sum.height += amplitude * one.height;
            sum.gradient += one.gradient * (amplitude * frequency);
            frequency *= 2.0;
            amplitude *= self.gain;
        }
        sum.or_flat()
    }
}

/// One octave with cells of side 1.
fn octave(point: Vec3, seed: u32) -> ReliefSample {
    let corner = point.floor();
    let (height, gradient) = gradient_noise(corner.as_ivec3(), point - corner, seed);
    ReliefSample { height, gradient }
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
