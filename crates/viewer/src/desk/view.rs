//! Moving the eye.

use crate::desk::Desk;
use crate::session::Phase;
use crate::walk::{EyeMode, Step};
use std::time::{Duration, Instant};

/// What keys ask of the eye in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// Forward, from -1 to 1.
    pub forward: f32,
    /// To the right, from -1 to 1.
    pub right: f32,
    /// Upwards, from -1 to 1.
    pub up: f32,
    /// Three times as fast.
    pub runs: bool,
}

impl Motion {
    /// Whether nothing is asked.
    pub fn is_still(&self) -> bool {
        (self.forward, self.right, self.up) == (0.0, 0.0, 0.0)
    }
}

/// How long an eye rests until it counts as still.
const STILL: Duration = Duration::from_millis(250);
/// Longest time that a frame counts for: after a pause nobody jumps.
const LONGEST_FRAME: f32 = 0.2;

impl Desk {
    /// Moves on by the time of a frame; whether the eye is in motion.
    pub fn advance(&mut self, motion: Motion, seconds: f32) -> bool {
        let seconds = seconds.clamp(0.0, LONGEST_FRAME);
        let before = self.eye;
        if !motion.is_still() {
            self.playing = None;
        }
        if let Some(played) = self.playing {
            self.play(played + seconds);
            return true;
        }
        let falls = self.prefs.gravity && self.eye.mode == EyeMode::Walk;
        if let Some(snapshot) = &self.snapshot
            && (falls || !motion.is_still())
        {
            let step = Step {
                forward: motion.forward,
                right: motion.right,
                up: motion.up,
                runs: motion.runs,
                seconds,
                collides: self.prefs.collisions && self.eye.mode == EyeMode::Walk,
                falls,
            };
            let visibility = snapshot.mesh().visibility();
            self.body
                .step(&mut self.eye, &mut self.falling, &step, visibility);
        }
        !motion.is_still()
            || self.eye.position.distance(before.position) > 1e-5 * self.body.eye_height
    }

    /// Whether the picture stays as it is: the light is not on its way, and nobody moved for a while.
    pub fn is_still(&self) -> bool {
        let is_solving = matches!(self.status.phase, Phase::Solving | Phase::Preparing);
        !is_solving && !self.moves()
    }

    /// Whether somebody moved a moment ago.
    pub fn moves(&self) -> bool {
        self.moved.is_some_and(|moved| moved.elapsed() <= STILL)
    }

    /// Notes where the eye is; returns how long it has to stay there to be still.
    pub fn note_eye(&mut self) -> Option<Duration> {
        if self.seen != Some(self.eye) {
            self.seen = Some(self.eye);
            self.moved = Some(Instant::now());
        }
        let elapsed = self.moved?.elapsed();
        (elapsed <= STILL).then(|| STILL + Duration::from_millis(5) - elapsed)
    }

    fn play(&mut self, seconds: f32) {
        let mode = self.eye.mode;
        if let Some(eye) = self.path.at(seconds, self.body.speed) {
            self.eye = crate::walk::Eye { mode, ..eye };
        }
        let is_over = seconds >= self.path.duration(self.body.speed);
        self.playing = (!is_over).then_some(seconds);
    }

    /// Plays the recorded way from its start, or stops.
    pub fn toggle_play(&mut self) {
        self.playing = match self.playing {
            None if self.path.stops.len() > 1 => Some(0.0),
            _ => None,
        };
    }

    /// Adds where one stands to the recorded way.
    pub fn add_stop(&mut self) {
        self.path.stops.push(self.eye);
        let count = self.path.stops.len();
        self.tell(format!("stop {count} of the path"));
    }

    /// Walks instead of orbiting, or the other way round.
    pub fn toggle_mode(&mut self) {
        self.eye.mode = match self.eye.mode {
            EyeMode::Walk => EyeMode::Orbit,
            EyeMode::Orbit => EyeMode::Walk,
        };
        self.falling = 0.0;
    }
}
