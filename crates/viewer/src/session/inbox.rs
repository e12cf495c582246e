//! Commands on their way to the worker.

use crate::session::{Command, lock};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};

/// Commands that have not been looked at. A command takes back those before it that it makes void, so that a slider that
/// is dragged leaves one edit and not a hundred.
#[derive(Default)]
pub struct Inbox {
    waiting: Mutex<VecDeque<Command>>,
    arrived: Condvar,
    /// Whether one is there, without taking the lock.
    is_full: AtomicBool,
}

impl core::fmt::Debug for Inbox {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Inbox")
            .field("waiting", &lock(&self.waiting).len())
            .finish()
    }
}

impl Inbox {
    /// Adds a command, and removes what it makes void.
    pub fn send(&self, command: Command) {
        let mut waiting = lock(&self.waiting);
        match (&command, waiting.back_mut()) {
            // Two edits of a material in a row are one.
            (Command::Edit(new), Some(Command::Edit(old))) if old.material == new.material => {
                old.base_color = new.base_color.or(old.base_color);
                old.emission = new.emission.or(old.emission);
            }
            _ => {
                waiting.retain(|old| !makes_void(&command, old));
                waiting.push_back(command);
            }
        }
        self.is_full.store(true, Ordering::Release);
        self.arrived.notify_one();
    }

    /// Whether something waits.
    pub fn is_full(&self) -> bool {
        self.is_full.load(Ordering::Acquire)
    }

    /// All that waits, in the order of its arrival.
    pub fn take(&self) -> Vec<Command> {
        self.take_while(|_| true)
    }

    /// What waits, up to the first command that is not `wanted`.
    pub fn take_while(&self, wanted: impl Fn(&Command) -> bool) -> Vec<Command> {
        let mut waiting = lock(&self.waiting);
        let unwanted = waiting.iter().position(|command| !wanted(command));
        let count = unwanted.unwrap_or(waiting.len());
        let taken = waiting.drain(..count).collect();
        self.is_full.store(!waiting.is_empty(), Ordering::Release);
        taken
    }

    /// Sleeps until something is there.
    pub fn wait(&self) {
        let waiting = lock(&self.waiting);
        let arrived = self
            .arrived
            .wait_while(waiting, |waiting| waiting.is_empty());
        drop(arrived.unwrap_or_else(PoisonError::into_inner));
    }
}

/// Whether `new` leaves nothing of `old`. Steps are counted, each of them.
fn makes_void(new: &Command, old: &Command) -> bool {
    use Command::{Bring, Cancel, Configure, Open, Pause, Quit, Refine, Restart, Run, Watch};
    matches!(
        (new, old),
        (Quit, _)
            | (Open(_), Open(_) | Cancel)
            | (Cancel, Open(_) | Cancel)
            | (Run | Pause, Run | Pause)
            | (Restart, Restart)
            | (Configure(_), Configure(_) | Refine(_))
            | (Refine(_), Refine(_))
            | (Watch(_), Watch(_))
            | (Bring(_), Bring(_))
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use hemicube_radiosity::MaterialEdit;
    use hemicube_raster::Rgb;

    #[test]
    fn a_dragged_slider_leaves_one_edit() {
        let inbox = Inbox::default();
        for i in 0..1000_u16 {
            let edit = MaterialEdit::new(3).with_emission(Rgb::splat(f32::from(i)));
            inbox.send(Command::Edit(edit));
        }
        inbox.send(Command::Edit(
            MaterialEdit::new(3).with_base_color(Rgb::WHITE),
        ));
        let commands = inbox.take();
        let [Command::Edit(edit)] = &commands[..] else {
            panic!("one edit: {commands:?}")
        };
        assert_eq!(edit.emission, Some(Rgb::splat(999.0)), "the newest of both");
        assert_eq!(edit.base_color, Some(Rgb::WHITE), "the newest of both");
        assert!(!inbox.is_full(), "it was emptied");
    }

    #[test]
    fn only_what_is_void_is_dropped() {
        let inbox = Inbox::default();
        for command in [
            Command::Step,
            Command::Step,
            Command::Run,
            Command::Pause,
            Command::Watch(Default::default()),
            Command::Watch(Default::default()),
        ] {
            inbox.send(command);
        }
        let names: Vec<String> = inbox.take().iter().map(|c| format!("{c:?}")).collect();
        assert_eq!(names.len(), 4, "{names:?}");
        assert_eq!(
            &names[..3],
            ["Step", "Step", "Pause"],
            "two steps, a pause, a figure"
        );
    }
}
