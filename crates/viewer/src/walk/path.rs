//! A way through stops, recorded by hand and played as one smooth move.

use crate::walk::Eye;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Stops and the speed between them.
///
/// Places lie on a centripetal Catmull-Rom spline (Yuksel, Schaefer, Keyser 2011: no loops, no cusps), angles are
/// interpolated with the same parameter, and each stretch takes a time that grows with its length and its turn.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Path {
    /// Stops in their order.
    pub stops: Vec<Eye>,
}

/// Seconds that a turn by one radian takes.
const SECONDS_PER_RADIAN: f32 = 0.9;
/// Least seconds of a stretch.
const SHORTEST: f32 = 0.25;

impl Path {
    /// Seconds of the whole way at a speed in scene units; 0 for less than two stops.
    pub fn duration(&self, speed: f32) -> f32 {
        self.stops
            .windows(2)
            .map(|pair| stretch_seconds(&pair[0], &pair[1], speed))
            .sum()
    }

    /// The eye after some seconds; the first stop before the start, the last after the end. `None` without stops.
    pub fn at(&self, seconds: f32, speed: f32) -> Option<Eye> {
        let mut left = seconds.max(0.0);
        for (i, pair) in self.stops.windows(2).enumerate() {
            let stretch = stretch_seconds(&pair[0], &pair[1], speed);
            if left < stretch {
                return Some(self.within(i, left / stretch));
            }
            left -= stretch;
        }
        self.stops.last().copied()
    }

    /// The eye within the stretch behind a stop.
    fn within(&self, i: usize, t: f32) -> Eye {
        let (from, to) = (&self.stops[i], &self.stops[i + 1]);
        let last = self.stops.len() - 1;
        // It starts and ends at rest.
        let t = match (i == 0, i + 1 == last) {
            (true, true) => t * t * (3.0 - 2.0 * t),
            (true, false) => t * t * (2.0 - t),
            (false, true) => t * (1.0 + t - t * t),
            (false, false) => t,
        };
        let before = match i {
            0 => 2.0 * from.position - to.position,
            _ => self.stops[i - 1].position,
        };
        let after = match self.stops.get(i + 2) {
            Some(stop) => stop.position,
            None => 2.0 * to.position - from.position,
        };
        Eye {
            position: catmull_rom([before, from.position, to.position, after], t),
            ..from.lerp(to, t)
        }
    }
}

fn stretch_seconds(from: &Eye, to: &Eye, speed: f32) -> f32 {
    let turn = from.forward().dot(to.forward()).clamp(-1.0, 1.0).acos();
    let way = from.position.distance(to.position) / speed.max(f32::MIN_POSITIVE);
    way.max(SECONDS_PER_RADIAN * turn).clamp(SHORTEST, 3600.0)
}

/// Point between the middle two of four, by the pyramid of Barry and Goldman with knots at square roots of distances.
fn catmull_rom(points: [Vec3; 4], t: f32) -> Vec3 {
    let mut knots = [0.0_f32; 4];
    for i in 1..4 {
        knots[i] = knots[i - 1] + points[i].distance(points[i - 1]).sqrt().max(1e-6);
    }
    let at = knots[1] + (knots[2] - knots[1]) * t;
    let mix = |a: Vec3, b: Vec3, from: f32, to: f32| a + (b - a) * ((at - from) / (to - from));
    let [p0, p1, p2, p3] = points;
    let [k0, k1, k2, k3] = knots;
    let (a, b, c) = (
        mix(p0, p1, k0, k1),
        mix(p1, p2, k1, k2),
        mix(p2, p3, k2, k3),
    );
    mix(mix(a, b, k0, k2), mix(b, c, k1, k3), k1, k2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walk::EyeMode;

    fn stop(x: f32, z: f32, yaw: f32) -> Eye {
        Eye {
            position: Vec3::new(x, 1.6, z),
            yaw,
            pitch: 0.0,
            vertical_fov: 1.0,
            distance: 1.0,
            mode: EyeMode::Walk,
        }
    }

    fn path() -> Path {
        Path {
            stops: vec![
                stop(0.0, 0.0, 0.0),
                stop(3.0, 0.0, 1.0),
                stop(3.0, 2.0, 2.0),
                stop(0.0, 5.0, 0.5),
            ],
        }
    }

    #[test]
    fn it_passes_through_its_stops() {
        let path = path();
        let mut seconds = 0.0;
        for pair in path.stops.windows(2) {
            let eye = path.at(seconds, 1.5).expect("there are stops");
            assert!(
                eye.position.distance(pair[0].position) < 1e-4,
                "{eye:?} at {seconds}"
            );
            seconds += stretch_seconds(&pair[0], &pair[1], 1.5);
        }
        assert_eq!(path.duration(1.5), seconds, "the sum of the stretches");
        assert_eq!(
            path.at(99.0, 1.5),
            path.stops.last().copied(),
            "it stays at the end"
        );
        assert_eq!(
            path.at(-1.0, 1.5).map(|e| e.position),
            Some(Vec3::new(0.0, 1.6, 0.0)),
            "and waits before the start"
        );
    }

    #[test]
    fn it_has_no_jumps() {
        let path = path();
        let frames = 2000;
        let step = path.duration(1.5) / frames as f32;
        let eyes: Vec<Eye> = (0..=frames)
            .filter_map(|i| path.at(step * i as f32, 1.5))
            .collect();
        let moves = eyes
            .windows(2)
            .map(|w| w[0].position.distance(w[1].position));
        let longest = moves.fold(0.0, f32::max);
        assert!(longest < 5.0 * 1.5 * step, "{longest} in {step} s");
    }

    #[test]
    fn degenerate_paths_are_still() {
        assert_eq!(Path::default().at(1.0, 1.0), None, "no stops");
        assert_eq!(Path::default().duration(1.0), 0.0, "no stops");
        let twice = Path {
            stops: vec![stop(1.0, 1.0, 0.0); 3],
        };
        let eye = twice.at(0.3, 0.0).expect("there are stops");
        assert!(
            eye.position.is_finite() && eye.position.distance(Vec3::new(1.0, 1.6, 1.0)) < 1e-3,
            "{eye:?}"
        );
    }
}
