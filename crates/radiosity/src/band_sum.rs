//! Sums of many colours that keep their digits.

use hemicube_raster::Rgb;

/// A sum of colours in f64: thousands of samples in f32 would lose the fourth digit.
#[derive(Debug, Clone, Copy, Default)]
pub struct BandSum([f64; 3]);

impl BandSum {
    /// Adds a colour.
    pub fn add(&mut self, color: Rgb) {
        for band in 0..3 {
            self.0[band] += f64::from(color[band]);
        }
    }

    /// The sum over `count`.
    #[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
    pub fn mean(self, count: u32) -> Rgb {
        let [r, g, b] = self.0.map(|sum| (sum / f64::from(count)) as f32);
        Rgb::new(r, g, b)
    }
}
