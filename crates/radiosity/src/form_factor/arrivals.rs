//! A row while it is added up.

use crate::cast::to_f32;
use crate::form_factor::Row;
use crate::patch::PatchMesh;

/// Shares of what leaves a patch in each band, in f64, by where they arrive.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Arrivals {
    /// Of each element; what it lets through counts, too, and once more where that arrives.
    pub(super) received: Vec<[f64; 3]>,
    /// At sides that only absorb.
    pub(super) absorbed: [f64; 3],
    /// Nowhere.
    pub(super) escaped: [f64; 3],
}

impl Arrivals {
    /// None yet.
    pub(super) fn new(elements: usize) -> Self {
        Self {
            received: vec![[0.0; 3]; elements],
            absorbed: [0.0; 3],
            escaped: [0.0; 3],
        }
    }

    /// Writes them into a row of one band or three, divided by their sum so that it closes.
    pub(super) fn write(&self, mesh: &PatchMesh, bands: usize, row: &mut Row) {
        let (absorbed, escaped) = (self.absorbed, self.escaped);
        let scale = [0, 1, 2].map(|band| {
            let kept = self.received.iter().zip(mesh.transmittance());
            let kept: f64 = kept
                .map(|(share, through)| share[band] * f64::from(1.0 - through[band]))
                .sum();
            1.0 / (kept + absorbed[band] + escaped[band]).max(1e-30)
        });
        let found = |(_, share): &(u32, &[f64; 3])| share.iter().any(|&s| s > 0.0);
        let found: Vec<(u32, &[f64; 3])> = (0..).zip(&self.received).filter(found).collect();
        row.clear(bands);
        row.receivers.extend(found.iter().map(|&(e, _)| e));
        for band in 0..bands {
            let factor = |(_, share): &(u32, &[f64; 3])| to_f32(share[band] * scale[band]);
            row.fractions.extend(found.iter().map(factor));
        }
        row.absorbed = [0, 1, 2].map(|band| to_f32(absorbed[band] * scale[band]));
        row.escaped = [0, 1, 2].map(|band| to_f32(escaped[band] * scale[band]));
    }
}

/// Adds a share in each band.
pub(super) fn add(sum: &mut [f64; 3], share: [f64; 3]) {
    for (sum, share) in sum.iter_mut().zip(share) {
        *sum += share;
    }
}
