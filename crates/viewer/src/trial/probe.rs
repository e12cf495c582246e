//! How long input waits: something knocks at the window as a key does, and the window tells when it opens.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time between two knocks; no multiple of what a display takes for a frame.
const BETWEEN: Duration = Duration::from_millis(37);

/// A thread that knocks until it is dropped.
#[derive(Debug)]
pub struct Probe {
    state: Arc<State>,
}

#[derive(Debug)]
struct State {
    begin: Instant,
    /// Microseconds after the begin of a knock that was not heard yet; 0 for none.
    knocked: AtomicU64,
    ends: AtomicBool,
}

impl Probe {
    /// `knock` wakes the window by the way that input takes.
    pub fn start(knock: impl Fn() + Send + 'static) -> Self {
        let state = Arc::new(State {
            begin: Instant::now(),
            knocked: AtomicU64::new(0),
            ends: AtomicBool::new(false),
        });
        let of_thread = state.clone();
        std::thread::spawn(move || {
            while !of_thread.ends.load(Ordering::Relaxed) {
                std::thread::sleep(BETWEEN);
                let now = of_thread.micros().max(1);
                let is_first =
                    of_thread
                        .knocked
                        .compare_exchange(0, now, Ordering::AcqRel, Ordering::Relaxed);
                if is_first.is_ok() {
                    knock();
                }
            }
        });
        Self { state }
    }

    /// How long a knock has waited until now, if there was one.
    pub fn heard(&self) -> Option<Duration> {
        let knocked = self.state.knocked.swap(0, Ordering::AcqRel);
        let waited = self.state.micros().saturating_sub(knocked);
        (knocked > 0).then(|| Duration::from_micros(waited))
    }
}

impl Drop for Probe {
    fn drop(&mut self) {
        self.state.ends.store(true, Ordering::Relaxed);
    }
}

impl State {
    fn micros(&self) -> u64 {
        u64::try_from(self.begin.elapsed().as_micros()).unwrap_or(u64::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    #[test]
    fn a_knock_waits_until_it_is_heard() {
        let (sender, knocks) = channel();
        let probe = Probe::start(move || sender.send(()).unwrap_or_default());
        assert!(knocks.recv().is_ok(), "it knocks");
        std::thread::sleep(Duration::from_millis(20));
        let waited = probe.heard().expect("somebody knocked");
        assert!(waited >= Duration::from_millis(20), "{waited:?}");
        drop(probe);
        // The thread drops its sender when it has ended.
        while knocks.recv().is_ok() {}
    }
}
