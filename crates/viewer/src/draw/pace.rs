//! How much is drawn where the processor draws.

use crate::frames::FrameTimes;
use std::time::Duration;

/// Least time between two pictures that differ only in their light, where the processor draws and where a GPU does.
pub const LIGHT_PACE: Duration = Duration::from_millis(100);
pub const QUICK_LIGHT_PACE: Duration = Duration::from_millis(33);

/// Frames that take longer get fewer pixels while the eye moves; frames that take less than [`QUICK`] get more.
const LATE: Duration = Duration::from_millis(60);
const QUICK: Duration = Duration::from_millis(16);
/// Pixels are at most so many times as wide and as high.
const MOST: u32 = 3;
/// Frames after which it is looked at again.
const PATIENCE: u32 = 4;

/// How large the pixels of pictures are while the eye moves.
#[derive(Debug)]
pub struct Pixels {
    divisor: u32,
    frames: u32,
}

impl Default for Pixels {
    fn default() -> Self {
        Self {
            divisor: 1,
            frames: 0,
        }
    }
}

impl Pixels {
    /// Width of a pixel in those of the window: 1 at rest; while the eye moves what keeps frames in time, which is
    /// remembered for the next time that it moves.
    pub fn divisor(&mut self, moves: bool, adapts: bool, frames: &FrameTimes) -> u32 {
        if !moves || !adapts {
            self.frames = 0;
            return 1;
        }
        self.frames += 1;
        if self.frames > PATIENCE
            && let Some(time) = frames.recent(PATIENCE as usize)
        {
            if time > LATE && self.divisor < MOST {
                (self.divisor, self.frames) = (self.divisor + 1, 0);
            } else if time < QUICK && self.divisor > 1 {
                (self.divisor, self.frames) = (self.divisor - 1, 0);
            }
        }
        self.divisor
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(pixels: &mut Pixels, frames: u32, each: u64) -> u32 {
        let mut times = FrameTimes::default();
        let mut divisor = 0;
        for _ in 0..frames {
            times.push(Duration::from_millis(each));
            divisor = pixels.divisor(true, true, &times);
        }
        divisor
    }

    #[test]
    fn late_frames_get_fewer_pixels_and_quick_ones_more() {
        let mut pixels = Pixels::default();
        assert_eq!(after(&mut pixels, 3, 100), 1, "not at once");
        assert_eq!(after(&mut pixels, 40, 100), MOST, "as few as there may be");
        let times = FrameTimes::default();
        assert_eq!(
            pixels.divisor(false, true, &times),
            1,
            "all of them at rest"
        );
        assert_eq!(pixels.divisor(true, true, &times), MOST, "remembered");
        assert_eq!(after(&mut pixels, 40, 30), MOST, "in time as it is");
        assert_eq!(after(&mut pixels, 40, 5), 1, "there is time for all");
        assert_eq!(after(&mut pixels, 40, 100), MOST, "late again");
        assert_eq!(
            pixels.divisor(true, false, &times),
            1,
            "not where it is not wanted"
        );
    }
}
