//! A trial of the window, `hemicube view --measure TIME`: how fast it draws, how long input and edits wait, how much
//! memory and processor time it takes.
//!
//! ```text
//! until the first picture    wait, and tell how long that took
//! 40 % of what is left       stand still while light is solved; frames follow each other without a pause
//! 40 %                       turn around at the spot, so that every frame needs a new picture
//! 20 %                       dim a lamp, wait until half of the change is in the picture, brighten it, and again
//! ```

mod edits;
mod probe;
mod process;
mod report;

use crate::desk::Desk;
use crate::frames::FrameTimes;
use crate::session::{OnDevice, Phase};
use edits::Edits;
use probe::Probe;
use process::{cpu_by_threads, resident_memory};
use report::{Cpu, Report};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Radians a second that the eye turns by.
const TURN: f32 = 0.5;
/// Frames after which one is on the screen for certain: displays take no more of them in advance.
const ON_SCREEN: u32 = 2;
/// Longest list of readings of memory.
const READINGS: u32 = 20;

/// A trial that goes on.
pub struct Trial {
    opened: Instant,
    length: Duration,
    probe: Probe,
    /// Frames since the first with a lit picture, and when that was on the screen.
    since_first: u32,
    first: Option<Instant>,
    last: Option<(Instant, Part)>,
    rest: Figures,
    walk: Figures,
    waits: FrameTimes,
    edits: Edits,
    /// What was known last of light that a device keeps.
    on_device: Option<Arc<OnDevice>>,
    /// Bytes of memory, at times since the window was opened.
    memory: Vec<(Duration, u64)>,
    /// A change is waited for a little longer than the trial lasts.
    is_over: bool,
}

/// What is tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Start,
    Rest,
    Walk,
    Edit,
}

/// What was measured of a part.
#[derive(Debug)]
struct Figures {
    frames: FrameTimes,
    /// Frames whose picture was drawn anew.
    pictures: u32,
    /// Widths of their pixels added up.
    widths: u32,
    cpu: Cpu,
    solving: Solving,
}

/// What the solver did meanwhile.
#[derive(Debug, Clone, Copy, Default)]
struct Solving {
    /// How long it was at work.
    time: Duration,
    /// Its steps (of one that keeps its light on a device: hemicubes) when that began, and the last that was heard of.
    steps: Option<[u64; 2]>,
    are_hemicubes: bool,
}

impl Solving {
    /// A frame took so long.
    fn note(&mut self, desk: &Desk, frame: Duration) {
        let Some(snapshot) = desk.snapshot.as_ref() else {
            return;
        };
        let lane = &snapshot.lanes[0];
        let device = lane.on_device.as_ref();
        self.are_hemicubes = device.is_some();
        let now = device.map_or(lane.progress.iteration, |device| device.hemicubes);
        let [first, _] = self.steps.unwrap_or([now; 2]);
        self.steps = Some([first, now]);
        if desk.status.phase == Phase::Solving {
            self.time += frame;
        }
    }

    /// Steps a second while it was at work, and what they are.
    fn rate(&self) -> Option<(f64, &'static str)> {
        let [first, last] = self.steps?;
        let steps = last.checked_sub(first).filter(|&steps| steps > 0)?;
        let what = if self.are_hemicubes {
            "hemicubes"
        } else {
            "steps"
        };
        Some((steps as f64 / self.time.as_secs_f64().max(1e-3), what))
    }
}

impl Default for Figures {
    fn default() -> Self {
        Self {
            frames: FrameTimes::of_all(),
            pictures: 0,
            widths: 0,
            cpu: Cpu::default(),
            solving: Solving::default(),
        }
    }
}

impl Trial {
    /// Begins now; `knock` wakes the window from any thread.
    pub fn start(opened: Instant, length: Duration, knock: impl Fn() + Send + 'static) -> Self {
        Self {
            opened,
            length,
            probe: Probe::start(knock),
            since_first: 0,
            first: None,
            last: None,
            rest: Figures::default(),
            walk: Figures::default(),
            waits: FrameTimes::of_all(),
            edits: Edits::default(),
            on_device: None,
            memory: Vec::new(),
            is_over: false,
        }
    }

    /// A frame begins.
    pub fn begin_frame(&mut self, desk: &mut Desk) {
        let now = Instant::now();
        if self.since_first == ON_SCREEN && self.first.is_none() {
            self.first = Some(now);
        }
        if let Some(wait) = self.probe.heard().filter(|_| self.first.is_some()) {
            self.waits.push(wait);
        }
        self.note_memory();
        let part = self.part();
        let before = self.last.replace((now, part));
        let seconds = before.map_or(0.0, |(last, _)| (now - last).as_secs_f32());
        match before {
            Some((last, then)) if then == part => {
                if let Some(figures) = self.figures(part) {
                    figures.frames.push(now - last);
                    figures.solving.note(desk, now - last);
                }
            }
            other => self.change(other.map(|(_, then)| then), part),
        }
        match part {
            Part::Start | Part::Rest => {}
            Part::Walk => desk.eye.turn(TURN * seconds.min(0.2), 0.0),
            Part::Edit => self.edits.frame(desk),
        }
        self.is_over |= self.opened.elapsed() >= self.length && !self.waits_for_an_edit();
    }

    /// Whether frames are to follow each other without a pause: not before there is something to see.
    pub fn hurries(&self) -> bool {
        self.since_first > 0
    }

    /// A frame is handed over; if its picture is a new one, how wide its pixels are in those of the window.
    pub fn end_frame(&mut self, desk: &Desk, drawn: Option<u32>) {
        let is_drawn = drawn.is_some();
        self.since_first += u32::from(is_drawn || self.since_first > 0);
        self.edits.handed_over();
        if !is_drawn {
            return;
        }
        let part = self.last.map(|(_, part)| part);
        if let Some(figures) = part.and_then(|part| self.figures(part)) {
            figures.pictures += 1;
            figures.widths += drawn.unwrap_or(1);
        }
        if let Some(snapshot) = &desk.snapshot {
            self.edits.drawn(snapshot);
            self.on_device.clone_from(&snapshot.lanes[0].on_device);
        }
    }

    /// What was measured, once the time is over.
    pub fn report(&mut self) -> Option<String> {
        if !self.is_over {
            return None;
        }
        if let Some((_, part)) = self.last {
            self.change(Some(part), Part::Start);
        }
        let report = Report {
            first: self.first.map(|first| first - self.opened),
            rest: &self.rest,
            walk: &self.walk,
            waits: &self.waits,
            edits: &self.edits.times,
            unseen: self.edits.waiting(),
            memory: &self.memory,
            on_device: self.on_device.as_deref(),
        };
        Some(report.to_string())
    }

    fn part(&self) -> Part {
        let Some(first) = self.first else {
            return Part::Start;
        };
        let all = self.length.saturating_sub(first - self.opened);
        let share = first.elapsed().as_secs_f64() / all.as_secs_f64().max(1e-3);
        match share {
            ..0.4 => Part::Rest,
            ..0.8 => Part::Walk,
            _ => Part::Edit,
        }
    }

    fn figures(&mut self, part: Part) -> Option<&mut Figures> {
        match part {
            Part::Rest => Some(&mut self.rest),
            Part::Walk => Some(&mut self.walk),
            Part::Start | Part::Edit => None,
        }
    }

    /// Processor time is read where parts begin and end.
    fn change(&mut self, from: Option<Part>, to: Part) {
        let now = cpu_by_threads();
        if let Some(figures) = from.and_then(|part| self.figures(part)) {
            figures.cpu.end(&now);
        }
        if let Some(figures) = self.figures(to) {
            figures.cpu.begin(now);
        }
    }

    fn waits_for_an_edit(&self) -> bool {
        let patience = self.length.mul_f64(0.5).min(Duration::from_secs(10));
        self.edits.times.is_empty() && self.edits.waiting().is_some_and(|time| time < patience)
    }

    fn note_memory(&mut self) {
        let since = self.opened.elapsed();
        let between = self.length / READINGS;
        let is_due = self
            .memory
            .last()
            .is_none_or(|(last, _)| since >= *last + between);
        if self.first.is_some() && is_due {
            self.memory
                .extend(resident_memory().map(|bytes| (since, bytes)));
        }
    }
}
