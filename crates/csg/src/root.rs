//! Roots of functions on an interval where they are monotone.

/// Steps after which bisection alone has used up the digits of any interval.
const MOST_STEPS: usize = 128;

/// The root of a function that is monotone and changes its sign between two places, up to `tolerance` or rounding; `f`
/// gives value and derivative, `rises` says that the sign changes from - to +. It begins at `start`, or in
/// the middle if that is not between.
///
/// Newton's steps as long as they stay within what is left of the interval and shrink, else halves: it converges
/// quadratically near simple roots and always as fast as bisection. Where rounding has hidden the change of sign, it
/// ends beside the place with the smaller value.
pub(crate) fn monotone_root(
    [from, to]: [f64; 2],
    start: f64,
    rises: bool,
    tolerance: f64,
    f: impl Fn(f64) -> (f64, f64),
) -> f64 {
    let (mut low, mut high) = (from, to);
    let is_within = start > low && start < high;
    let mut t = if is_within { start } else { 0.5 * (low + high) };
    let mut last_step = high - low;
    let tolerance = tolerance.max(4.0 * f64::EPSILON * from.abs().max(to.abs()));
    for _ in 0..MOST_STEPS {
        let (value, slope) = f(t);
        if (value < 0.0) == rises {
            low = t;
        } else {
            high = t;
        }
        let newton = t - value / slope;
        let is_good = newton > low && newton < high && (newton - t).abs() < 0.5 * last_step;
        let next = if is_good { newton } else { 0.5 * (low + high) };
        let step = (next - t).abs();
        // Near the root each of Newton's steps shrinks more than the one before: the next one would be shorter than this.
        let next_step = if is_good {
            step * (step / last_step)
        } else {
            step
        };
        (t, last_step) = (next, step);
        if next_step <= tolerance {
            break;
        }
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simple_roots_are_exact_to_rounding() {
        for root in [-0.9, -1e-3, 0.0, 0.3, 0.999] {
            let rising = |t: f64| ((t - root) * (1.0 + t * t), 1.0 + t * (3.0 * t - 2.0 * root));
            let found = monotone_root([-1.0, 1.0], f64::NAN, true, 0.0, rising);
            assert!((found - root).abs() < 1e-15, "{root}: {found}");
            let falling = |t: f64| {
                let (value, slope) = rising(t);
                (-value, -slope)
            };
            let found = monotone_root([-1.0, 1.0], f64::NAN, false, 0.0, falling);
            assert!((found - root).abs() < 1e-15, "{root}, falling: {found}");
        }
    }

    #[test]
    fn flat_roots_are_found_by_halves() {
        let flat = |t: f64| ((t - 0.5).powi(5), 5.0 * (t - 0.5).powi(4));
        let found = monotone_root([-1.0, 2.0], f64::NAN, true, 0.0, flat);
        assert!((found - 0.5).abs() < 1e-3, "{found}");
    }

    #[test]
    fn a_sign_that_does_not_change_ends() {
        let found = monotone_root([0.0, 1.0], f64::NAN, true, 0.0, |_| (1.0, 0.0));
        assert!((0.0..=1.0).contains(&found), "{found}");
        let found = monotone_root([0.0, 1.0], f64::NAN, true, 0.0, |_| (f64::NAN, f64::NAN));
        assert!((0.0..=1.0).contains(&found), "{found}");
    }
}
