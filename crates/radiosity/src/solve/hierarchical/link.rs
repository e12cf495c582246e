//! Links: what one node brings to another.

use hemicube_raster::Rgb;

/// What rays saw between two nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Seen {
    /// All of them got through.
    Clear,
    /// None of them.
    Blocked,
    /// Some of them, or through panes.
    Mixed,
}

/// Light from one node to another; the receiver holds it.
///
/// All errors are in units of the factor: irradiance for a radiosity of 1. In 24 bytes, errors and slopes have 8 bits of
/// precision and tints 10.
#[derive(Debug, Clone, Copy)]
pub(super) struct Link {
    /// The node that sends.
    pub(super) source: u32,
    /// Of two cells: irradiance of the receiver for a radiosity of 1, visibility included. With a cluster: see
    /// [`Transport`](super::transport::Transport).
    pub(super) factor: f32,
    /// How the factor changes over a receiving cell, as a share of it for each unit of length along the two tangents.
    slope: [Half; 2],
    /// Standard deviation over the receiver of what the link does not tell, over the source, and error of the mean.
    spread: [Half; 3],
    rays: u16,
    tint: u32,
}

/// Error of a link by its cause.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Spread {
    /// Light varies over the receiver.
    pub(super) over_receiver: f32,
    /// The factor varies over the source, of which only the mean radiosity is sent.
    pub(super) over_source: f32,
    /// Few rays told what is visible.
    pub(super) noise: f32,
}

impl Link {
    pub(super) fn new(source: u32, factor: f32, slope: [f32; 2], spread: Spread) -> Self {
        let Spread {
            over_receiver,
            over_source,
            noise,
        } = spread;
        Self {
            source,
            factor,
            slope: slope.map(Half::new),
            spread: [over_receiver, over_source, noise].map(Half::new),
            rays: 0,
            tint: WHITE,
        }
    }

    /// With what rays saw, and by how many of them.
    pub(super) fn with_seen(mut self, seen: Seen, rays: u32) -> Self {
        let state = match seen {
            Seen::Clear => 0,
            Seen::Blocked => 1,
            Seen::Mixed => 2,
        };
        self.rays = u16::try_from(rays.min(MOST_RAYS)).unwrap_or(u16::MAX) << 2 | state;
        self
    }

    /// With the share of each band that gets through, relative to the factor.
    pub(super) fn with_tint(mut self, tint: Rgb) -> Self {
        let level = |share: f32| u32::from(level_of(share));
        self.tint = level(tint.r) | level(tint.g) << 10 | level(tint.b) << 20;
        self
    }

    pub(super) fn slope(&self) -> [f32; 2] {
        self.slope.map(Half::get)
    }

    pub(super) fn spread(&self) -> Spread {
        let [over_receiver, over_source, noise] = self.spread.map(Half::get);
        Spread {
            over_receiver,
            over_source,
            noise,
        }
    }

    /// What rays saw, and by how many of them.
    pub(super) fn seen(&self) -> (Seen, u32) {
        let seen = match self.rays & 3 {
            0 => Seen::Clear,
            1 => Seen::Blocked,
            _ => Seen::Mixed,
        };
        (seen, u32::from(self.rays >> 2))
    }

    /// Share of a band that gets through, relative to the factor.
    pub(super) fn tint(&self, band: usize) -> f32 {
        if self.tint == WHITE {
            return 1.0;
        }
        let level = self.tint >> (10 * band) & LEVELS;
        level as f32 / LEVELS as f32
    }
}

const LEVELS: u32 = 1023;
const WHITE: u32 = LEVELS | LEVELS << 10 | LEVELS << 20;
const MOST_RAYS: u32 = 0x3FFF;

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and 1023"
)]
fn level_of(share: f32) -> u16 {
    (share.clamp(0.0, 1.0) * LEVELS as f32).round() as u16
}

/// The upper half of an f32.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Half(u16);

impl Half {
    fn new(x: f32) -> Self {
        // The finite range is far from its end, so rounding up cannot carry into infinity.
        Self((x.to_bits().saturating_add(0x8000) >> 16) as u16)
    }

    fn get(self) -> f32 {
        f32::from_bits(u32::from(self.0) << 16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_packed_comes_back() {
        let spread = Spread {
            over_receiver: 0.3,
            over_source: 1e-9,
            noise: 0.0,
        };
        let tint = Rgb::new(1.0, 0.25, 0.0);
        let link = Link::new(7, 0.125, [-3.0, 0.011], spread)
            .with_seen(Seen::Blocked, 64)
            .with_tint(tint);
        assert_eq!((link.source, link.factor), (7, 0.125), "in full");
        assert_eq!(link.seen(), (Seen::Blocked, 64), "rays");
        let near = |a: f32, b: f32| (a - b).abs() <= b.abs() / 256.0;
        let [u, v] = link.slope();
        assert!(near(u, -3.0) && near(v, 0.011), "slope {u}, {v}");
        let found = link.spread();
        assert!(near(found.over_receiver, 0.3), "{found:?}");
        assert!(near(found.over_source, 1e-9), "{found:?}");
        assert_eq!(found.noise, 0.0, "{found:?}");
        for band in 0..3 {
            assert!((link.tint(band) - tint[band]).abs() < 6e-4, "band {band}");
        }
        let plain = Link::new(0, 1.0, [0.0; 2], Spread::default());
        assert_eq!(plain.tint(2), 1.0, "what is not tinted stays so");
        assert_eq!(size_of::<Link>(), 24, "bytes of a link");
    }
}
