//! How long it takes until a change of a lamp is seen.

use crate::desk::Desk;
use crate::session::Snapshot;
use crate::trial::ON_SCREEN;
use hemicube_radiosity::MaterialEdit;
use std::time::{Duration, Instant};

/// Factor on the lamp; every second edit takes it back.
const FACTOR: f32 = 0.5;
/// Share of the change that has to be there to count as seen.
const SEEN: f64 = 0.5;
/// Rest between two edits.
const REST: Duration = Duration::from_millis(400);

/// Dims the strongest lamp, waits until at least half of the change is on the surfaces and in the picture, brightens it, and so on.
#[derive(Debug, Default)]
pub struct Edits {
    /// What each change took.
    pub times: Vec<Duration>,
    pending: Option<Pending>,
    rests: Option<Instant>,
    count: u32,
}

#[derive(Debug)]
struct Pending {
    begin: Instant,
    group: usize,
    /// Flux on the surfaces, and what it will be.
    before: f64,
    after: f64,
    /// Frames since the first whose picture had the change.
    frames: u32,
}

impl Edits {
    /// A frame begins.
    pub fn frame(&mut self, desk: &mut Desk) {
        let is_on_screen = |pending: &mut Pending| pending.frames >= ON_SCREEN;
        if let Some(pending) = self.pending.take_if(is_on_screen) {
            self.times.push(pending.begin.elapsed());
            self.rests = Some(Instant::now());
        }
        let is_resting = self.rests.is_some_and(|since| since.elapsed() < REST);
        if self.pending.is_none() && !is_resting {
            self.pending = edit(desk, self.count);
            self.count += u32::from(self.pending.is_some());
        }
    }

    /// A frame was handed over.
    pub fn handed_over(&mut self) {
        if let Some(pending) = &mut self.pending {
            pending.frames += u32::from(pending.frames > 0);
        }
    }

    /// A picture of this light was drawn.
    pub fn drawn(&mut self, snapshot: &Snapshot) {
        if let Some(pending) = &mut self.pending {
            let now = snapshot.lanes[0].received(pending.group);
            let change = (now - pending.before) / (pending.after - pending.before);
            pending.frames += u32::from(change >= SEEN && pending.frames == 0);
        }
    }

    /// Since when a change is waited for.
    pub fn waiting(&self) -> Option<Duration> {
        self.pending.as_ref().map(|pending| pending.begin.elapsed())
    }
}

/// Changes the strongest lamp that has a light group of its own.
fn edit(desk: &mut Desk, count: u32) -> Option<Pending> {
    let snapshot = desk.snapshot.clone()?;
    let materials = &snapshot.mesh().scene().materials;
    let lamps = snapshot.source_of_material.iter().enumerate();
    let (material, group, before) = lamps
        .filter_map(|(material, &group)| {
            let group = group.filter(|_| materials[material].emits())?;
            Some((material, group, snapshot.lanes[0].received(group)))
        })
        .max_by(|a, b| a.2.total_cmp(&b.2))?;
    let factor = if count.is_multiple_of(2) {
        FACTOR
    } else {
        1.0 / FACTOR
    };
    let emission = materials[material].emission * factor;
    desk.edit(MaterialEdit::new(material).with_emission(emission));
    Some(Pending {
        begin: Instant::now(),
        group,
        before,
        after: before * f64::from(factor),
        frames: 0,
    })
}
