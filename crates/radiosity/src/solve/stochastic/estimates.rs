//! Averages of what rays bring, with what is known of their errors.

/// Fewest rays of a place in a round, a power of two.
pub(super) const LEAST_RAYS: u32 = 16;

/// Rounds of rays: how many each place is to have in the next one, powers of two or none, and has had.
#[derive(Debug, Clone, Copy)]
pub(super) struct Round<'a> {
    pub(super) wanted: &'a [u32],
    pub(super) before: &'a [u32],
}

/// What the rays of a round brought.
pub(super) struct Brought {
    /// Irradiance, `[place][channel]`.
    pub(super) irradiance: Vec<f32>,
    /// Squared standard errors of the same, summed over channels.
    pub(super) squares: Vec<f32>,
    /// Rays that were cast.
    pub(super) rays: u64,
}

impl Brought {
    /// Nothing.
    pub(super) fn nothing(places: usize, channels: usize) -> Self {
        Self {
            irradiance: vec![0.0; places * channels],
            squares: vec![0.0; places],
            rays: 0,
        }
    }
}

/// Irradiance of places, averaged over rounds by their rays.
#[derive(Debug, Clone)]
pub(super) struct Estimates {
    channels: usize,
    /// Irradiance times rays, `[place][channel]`.
    sums: Vec<f32>,
    /// Squared errors of those sums, all channels together.
    squares: Vec<f32>,
    rays: Vec<u32>,
}

impl Estimates {
    /// Nothing is known yet.
    pub(super) fn new(places: usize, channels: usize) -> Self {
        Self {
            channels,
            sums: vec![0.0; places * channels],
            squares: vec![0.0; places],
            rays: vec![0; places],
        }
    }

    /// Adds a round that had so many rays at each place.
    pub(super) fn add(&mut self, brought: &Brought, rays: &[u32]) {
        let sums = self.sums.chunks_exact_mut(self.channels);
        let light = sums.zip(brought.irradiance.chunks_exact(self.channels));
        let squares = self.squares.iter_mut().zip(&brought.squares);
        let counts = self.rays.iter_mut().zip(rays);
        for (((sums, light), (old, new)), (count, &rays)) in light.zip(squares).zip(counts) {
            let weight = rays as f32;
            let pairs = sums.iter_mut().zip(light);
            pairs.for_each(|(sum, light)| *sum += weight * light);
            *old += weight * weight * new;
            *count += rays;
        }
    }

    /// The next round.
    pub(super) fn round<'a>(&'a self, wanted: &'a [u32]) -> Round<'a> {
        Round {
            wanted,
            before: &self.rays,
        }
    }

    /// Rays that each place has had.
    pub(super) fn rays(&self) -> &[u32] {
        &self.rays
    }

    /// Irradiance of a place in a channel; 0 as long as nothing is known.
    pub(super) fn irradiance(&self, place: usize, channel: usize) -> f64 {
        let sum = f64::from(self.sums[place * self.channels + channel]);
        sum / f64::from(self.rays[place].max(1))
    }

    /// Irradiance of all places, summed over channels.
    pub(super) fn sums(&self) -> Vec<f32> {
        let places = self.sums.chunks_exact(self.channels).zip(&self.rays);
        places
            .map(|(sums, &rays)| sums.iter().sum::<f32>() / rays.max(1) as f32)
            .collect()
    }

    /// Squared standard error of the irradiance summed over channels.
    pub(super) fn square(&self, place: usize) -> f64 {
        f64::from(self.squares[place]) / f64::from(self.rays[place].max(1)).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_count_by_their_rays() {
        let mut estimates = Estimates::new(2, 1);
        let mut add = |irradiance: [f32; 2], squares: [f32; 2], rays: [u32; 2]| {
            let brought = Brought {
                irradiance: irradiance.to_vec(),
                squares: squares.to_vec(),
                rays: 0,
            };
            estimates.add(&brought, &rays);
        };
        add([1.0, 5.0], [0.3, 2.0], [16, 16]);
        add([3.0, 0.0], [0.1, 0.0], [48, 0]);
        assert_eq!(estimates.irradiance(0, 0), 2.5, "three of four rays say 3");
        assert_eq!(estimates.irradiance(1, 0), 5.0, "one round only");
        let square = 0.3 / 16.0 + 0.1 * 9.0 / 16.0;
        assert!(
            (estimates.square(0) - square).abs() < 1e-7,
            "variances add by squared weights"
        );
    }
}
