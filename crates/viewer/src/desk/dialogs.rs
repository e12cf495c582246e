//! File dialogs, which take as long as a user does.

use crate::desk::Wake;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

/// What a dialog is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pick {
    /// A scene, a lit scene or a session to open.
    Open,
    /// Where the lit scene goes.
    SaveLit,
    /// Where the session goes.
    SaveSession,
    /// Where the table of the grid goes.
    SaveGrid,
    /// Where the picture goes.
    SavePicture,
    /// Where the film goes.
    SaveFilm,
}

impl Pick {
    /// What it is about.
    pub fn title(self) -> &'static str {
        match self {
            Self::Open => "Open a scene",
            Self::SaveLit => "Save the lit scene",
            Self::SaveSession => "Save the session",
            Self::SaveGrid => "Save the grid",
            Self::SavePicture => "Save the picture",
            Self::SaveFilm => "Save the film",
        }
    }

    fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Open => &["glb", "gltf", "obj", "stl", "vs3", "json"],
            Self::SaveLit => &["glb"],
            Self::SaveSession => &["json"],
            Self::SaveGrid => &["csv"],
            Self::SavePicture => &["png"],
            Self::SaveFilm => &["png", "y4m"],
        }
    }
}

/// What becomes of a dialog.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// A file was picked.
    Picked(Pick, PathBuf),
    /// It was closed.
    Closed,
    /// The system has no dialogs; the name was proposed.
    NoDialog(Pick, String),
}

/// Nobody closes a dialog that quickly: there was none.
const AT_ONCE: Duration = Duration::from_millis(300);

/// Dialogs that are open, and their answers.
#[derive(Debug)]
pub struct Dialogs {
    answers: Receiver<Answer>,
    sender: Sender<Answer>,
    /// Only one at a time.
    is_open: bool,
}

impl Default for Dialogs {
    fn default() -> Self {
        let (sender, answers) = channel();
        Self {
            answers,
            sender,
            is_open: false,
        }
    }
}

impl Dialogs {
    /// Opens a dialog unless one is open; `name` is proposed for what is saved.
    pub fn ask(&mut self, pick: Pick, name: &str, wake: Wake) {
        if self.is_open {
            return;
        }
        self.is_open = true;
        let dialog = rfd::AsyncFileDialog::new()
            .set_title(pick.title())
            .add_filter(pick.endings().join(", "), pick.endings());
        let sender = self.sender.clone();
        let (begin, proposed) = (Instant::now(), name.to_owned());
        let answered = move |file: Option<rfd::FileHandle>| {
            let answer = match file {
                Some(file) => Answer::Picked(pick, file.path().to_path_buf()),
                None if begin.elapsed() < AT_ONCE => Answer::NoDialog(pick, proposed),
                None => Answer::Closed,
            };
            // The window may be gone.
            let _ = sender.send(answer);
            wake();
        };
        // Some systems want dialogs to be made on this thread and allow to wait for them on another.
        if pick == Pick::Open {
            let file = dialog.pick_file();
            std::thread::spawn(move || answered(pollster::block_on(file)));
        } else {
            let file = dialog.set_file_name(name).save_file();
            std::thread::spawn(move || answered(pollster::block_on(file)));
        }
    }

    /// The next answer, if there is one.
    pub fn answer(&mut self) -> Option<Answer> {
        let answer = self.answers.try_recv().ok()?;
        self.is_open = false;
        Some(answer)
    }

    /// As if a dialog had been answered.
    pub fn put(&self, answer: Answer) {
        let _ = self.sender.send(answer);
    }
}
