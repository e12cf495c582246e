//! Progress bars on standard error: only on a terminal, only for what takes more than a second.

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Parts of the whole that a bar distinguishes.
const PARTS: u64 = 10_000;

/// A bar that appears after a second.
#[derive(Debug)]
pub struct Bar {
    what: &'static str,
    start: Instant,
    wanted: bool,
    bar: OnceLock<ProgressBar>,
    done: AtomicU64,
}

impl Bar {
    /// A bar with its title; never seen if `quiet` or if there is no terminal.
    pub fn new(what: &'static str, quiet: bool) -> Self {
        let wanted = !quiet && stderr().is_terminal();
        Self {
            what,
            start: Instant::now(),
            wanted,
            bar: OnceLock::new(),
            done: AtomicU64::new(0),
        }
    }

    /// Shows how much is done, from 0 to 1, and a few words.
    pub fn show(&self, share: f64, words: impl FnOnce() -> String) {
        if !self.wanted || self.start.elapsed() < Duration::from_secs(1) {
            return;
        }
        let bar = self.bar.get_or_init(|| {
            let style = ProgressStyle::with_template("{prefix} [{bar:30}] {percent:>3} %  {msg}")
                .expect("the template is ours")
                .progress_chars("=> ");
            ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::stderr_with_hz(8))
                .with_style(style)
                .with_prefix(self.what)
                .with_elapsed(self.start.elapsed())
        });
        bar.set_position(parts(share));
        bar.set_message(format!("{}{}", words(), self.remaining(share)));
    }

    /// The time that is left if the work goes on as it did on average.
    fn remaining(&self, share: f64) -> String {
        let seconds = self.start.elapsed().as_secs_f64() * (1.0 - share) / share;
        match Duration::try_from_secs_f64(seconds.ceil()) {
            Ok(left) if left.as_secs() < 1_000_000 => format!("  {} left", HumanDuration(left)),
            _ => String::new(),
        }
    }

    /// Counts one of `all` equal pieces of work; for work that many threads share.
    pub fn count(&self, all: usize) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        if self.wanted && done.is_multiple_of(16) {
            self.show(done as f64 / all.max(1) as f64, || {
                format!("{done} of {all}")
            });
        }
    }

    /// Removes the bar from the screen.
    pub fn finish(&self) {
        if let Some(bar) = self.bar.get() {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.finish();
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and the number of parts"
)]
fn parts(share: f64) -> u64 {
    (share.clamp(0.0, 1.0) * PARTS as f64) as u64
}
