//! How many rays places get next (Neyman 1934): with their errors falling as the root of the rays, the sum of all
//! squared errors is least where rays are in proportion to the errors that one ray would have.

use super::estimates::LEAST_RAYS;

/// Most rays of a place in a round.
const MOST_RAYS: u32 = 1 << 12;
/// Rays of a round for each that was cast before: the errors that they follow are estimates.
const GROWTH: f64 = 2.0;
/// Most rays of a round, some ten seconds: between rounds somebody may stop, and what comes next is chosen by better estimates.
const MOST_OF_ROUND: f64 = (1_u32 << 25) as f64;
/// Steps in which the factor is found.
const BISECTIONS: u32 = 40;

/// Rays of the next round for places of known squared errors and rays, after which the squares sum to `goal`, or come as
/// near as so many rays can. Powers of two, and none where few are missing.
pub(super) fn allocate(squares: &[f64], rays: &[u32], goal: f64) -> Vec<u32> {
    // Of one ray alone.
    let spreads: Vec<f64> = squares
        .iter()
        .zip(rays)
        .map(|(square, &rays)| (square * f64::from(rays.max(1))).sqrt())
        .collect();
    let sum = |factor: f64| -> f64 {
        let pairs = spreads.iter().zip(rays);
        pairs
            .map(|(spread, &rays)| {
                spread * spread / (factor * spread).max(f64::from(rays)).max(1.0)
            })
            .sum()
    };
    let extra = |factor: f64| -> f64 {
        let pairs = spreads.iter().zip(rays);
        pairs
            .map(|(spread, &rays)| {
                (factor * spread - f64::from(rays)).clamp(0.0, f64::from(MOST_RAYS))
            })
            .sum()
    };
    let most = GROWTH * rays.iter().map(|&rays| f64::from(rays)).sum::<f64>();
    let most = most.min(MOST_OF_ROUND);
    let (mut low, mut high) = (
        0.0,
        1e12 / spreads.iter().fold(1e-30, |a: f64, &b| a.max(b)),
    );
    // By halves of the exponent: the factor may be of any size.
    low += high * 1e-24;
    for _ in 0..BISECTIONS {
        let middle = (low * high).sqrt();
        if sum(middle) > goal && extra(middle) < most {
            low = middle;
        } else {
            high = middle;
        }
    }
    let pairs = spreads.iter().zip(rays);
    let wanted: Vec<u32> = pairs
        .map(|(spread, &rays)| round(high * spread - f64::from(rays), rays))
        .collect();
    if wanted.iter().any(|&rays| rays > 0) {
        return wanted;
    }
    // All that is missing is less than a round anywhere.
    let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
    let again = |(&square, &rays): (&f64, &u32)| {
        let rays = rays.clamp(LEAST_RAYS, MOST_RAYS);
        let rays = 1 << rays.ilog2();
        if square > 0.0 && square >= mean {
            rays
        } else {
            0
        }
    };
    squares.iter().zip(rays).map(again).collect()
}

/// A power of two near a number of rays; none if it is few.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped to a range of u32"
)]
fn round(wanted: f64, before: u32) -> u32 {
    if wanted < 0.25 * f64::from(before) || wanted < 0.5 * f64::from(LEAST_RAYS) {
        return 0;
    }
    let exponent = wanted.log2().round().clamp(0.0, 31.0) as u32;
    (1 << exponent).clamp(LEAST_RAYS, MOST_RAYS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_go_where_errors_are() {
        // Of one ray: 1, 3 and 0.
        let rays = [64, 64, 64];
        let squares = [1.0 / 64.0, 9.0 / 64.0, 0.0];
        let wanted = allocate(&squares, &rays, 1.0 / 96.0 + 9.0 / 288.0);
        assert_eq!(wanted, [32, 256, 0], "96 and 288 by powers of two");
    }

    #[test]
    fn a_round_is_not_much_larger_than_what_was_before() {
        let rays = [64; 100];
        let squares = [0.5; 100];
        let wanted = allocate(&squares, &rays, 1e-9);
        let sum: u32 = wanted.iter().sum();
        assert!((6400..=2 * 6400).contains(&sum), "{sum} after 6400");
    }

    #[test]
    fn rounds_end_soon_however_many_places_there_are() {
        let rays = vec![64; 1 << 20];
        let squares = vec![0.5; 1 << 20];
        let wanted = allocate(&squares, &rays, 1e-9);
        let sum: f64 = wanted.iter().map(|&rays| f64::from(rays)).sum();
        assert!((1e7..=2.0 * MOST_OF_ROUND).contains(&sum), "{sum}");
    }

    #[test]
    fn something_is_done_as_long_as_it_is_asked_for() {
        let wanted = allocate(&[1.0, 1.0], &[64, 64], 1.9);
        assert_eq!(wanted, [64, 64], "a little is missing");
        assert_eq!(allocate(&[0.0], &[16], 1.0), [0], "nothing is");
        assert!(allocate(&[], &[], 1.0).is_empty(), "no places");
    }
}
