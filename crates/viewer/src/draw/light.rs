//! Light for pictures: brought to the device, or read there where a solver keeps it.
//!
//! ```text
//! new light of a solver on this device    read its buffer; measure how bright it is
//! the measurement is there                set exposure and scale; draw
//! ```
//! The measurement waits behind one of the solver's steps at most, and 8 KiB come back. Exposure so is that of the light
//! that is drawn, and each light is drawn once. While the eye moves, pictures are drawn with the exposure before.

use crate::desk::{Desk, Pane, Pause};
use crate::display::Quantity;
use crate::draw::scene::OnStage;
use crate::draw::stand_in::{as_light, dimmed};
use crate::draw::{ShownLight, Stage};
use crate::session::{LaneView, Snapshot};
use hemicube_gpu::{Context, DeviceLight, GpuError};
use hemicube_radiosity::PatchMesh;
use hemicube_raster::Rgb;
use std::sync::Arc;
use std::time::Instant;

/// The light on the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lit {
    pub(super) light: ShownLight,
    /// Of which pane, if there are several.
    pane: usize,
}

/// What groups of lamps on the device are dimmed by, and the mesh that they light.
type Dimmed = (Arc<PatchMesh>, Vec<Rgb>);

/// What lies on the device of a scene's light.
#[derive(Debug, Default)]
pub struct StageLight {
    pub lit: Option<Lit>,
    dimmed: Option<Dimmed>,
}

impl Stage {
    /// Brings a pane's light to where pictures are made of it, unless it is there.
    pub(super) fn set_light(
        &mut self,
        desk: &Desk,
        snapshot: &Snapshot,
        pane: &Pane,
        number: usize,
        light: ShownLight,
    ) -> Result<(), GpuError> {
        let lit = Some(Lit {
            light,
            pane: number,
        });
        if let Some(scene) = self.scene.as_mut().filter(|scene| scene.light.lit != lit) {
            let begin = Instant::now();
            let lane = &snapshot.lanes[pane.lane];
            match kept(lane, &self.context, light.quantity) {
                Some(kept) => read(scene, lane, kept, &pane.dims)?,
                None => bring(scene, snapshot, lane, pane, light.quantity)?,
            }
            let ambient = match light.quantity {
                Quantity::Light => desk.ambient(pane.lane),
                _ => Rgb::BLACK,
            };
            scene.walkthrough.set_ambient(ambient);
            scene.light.lit = lit;
            (self.lit, self.pause) = (Some(begin), Some(Pause::after(begin)));
        }
        if number == 0 {
            self.meter(desk, light);
        }
        Ok(())
    }

    /// Begins to measure light that is not known on this side, if that has not been done.
    fn meter(&mut self, desk: &Desk, light: ShownLight) {
        let is_measured = matches!(light.quantity, Quantity::Light | Quantity::Illuminance);
        if desk.has_light() || !is_measured {
            (self.metering, self.metered) = (None, None);
            return;
        }
        let Some(scene) = self.scene.as_mut().filter(|_| self.metered != Some(light)) else {
            return;
        };
        let wake = desk.wake();
        self.metering = Some(scene.walkthrough.meter(move || wake()));
        self.metered = Some(light);
    }

    /// Takes over what was measured, if it is there.
    pub(super) fn take_meter(&mut self, desk: &mut Desk, snapshot: &Snapshot) {
        if desk.has_light() {
            // It is known better.
            self.metering = None;
        } else if let Some(meter) = self.metering.as_ref().and_then(|metering| metering.take()) {
            self.metering = None;
            desk.set_meter(snapshot.geometry, meter);
        }
    }
}

/// The light of a lane where a solver keeps it, if pictures on this device can be made of it.
fn kept<'a>(
    lane: &'a LaneView,
    context: &Arc<Context>,
    quantity: Quantity,
) -> Option<&'a DeviceLight> {
    let device = lane.on_device.as_ref()?;
    let is_light = quantity != Quantity::FormFactors;
    (is_light && device.light.is_on(context)).then_some(&device.light)
}

/// Makes pictures of light that a solver keeps.
fn read(
    scene: &mut OnStage,
    lane: &LaneView,
    light: &DeviceLight,
    dims: &[Rgb],
) -> Result<(), GpuError> {
    let (solved, mesh) = (&lane.solution, lane.solution.mesh());
    let is_dimmed = |(of, by): &Dimmed| Arc::ptr_eq(of, mesh) && by == dims;
    if !scene.light.dimmed.as_ref().is_some_and(is_dimmed) {
        let other = dimmed(solved, dims);
        let dimmed = other.as_ref().unwrap_or(solved);
        scene.walkthrough.set_dims(dimmed)?;
        scene.light.dimmed = Some((mesh.clone(), dims.to_vec()));
    }
    scene.walkthrough.set_light_of(light)
}

/// Brings light, or what is shown in its place, to the device.
fn bring(
    scene: &mut OnStage,
    snapshot: &Snapshot,
    lane: &LaneView,
    pane: &Pane,
    quantity: Quantity,
) -> Result<(), GpuError> {
    let solved = &lane.solution;
    let other = match quantity {
        Quantity::FormFactors => snapshot.row.as_ref().map(|row| as_light(solved, row)),
        _ => dimmed(solved, &pane.dims),
    };
    scene.light.dimmed = None;
    scene
        .walkthrough
        .set_light(other.as_ref().unwrap_or(solved))
}
