//! Panes as pictures on the device of the window.
//!
//! A picture is drawn again only if something in it changed: the light, the eye, the size, how it is shown. The scene lies
//! on the device once, however many panes there are; each pane brings its light before it is drawn.
//!
//! Where the processor draws, which also solves, pictures are cheaper while something changes: edges and textures are
//! smoothed less, new light comes a few times a second, and while the eye moves there are as few pixels as it takes to
//! follow it.

mod light;
mod options;
mod pace;
mod pictures;
mod scene;
mod stand_in;

use crate::desk::{Desk, Pane, Pause};
use crate::display::{Display, Quantity};
use crate::panels::Tile;
use crate::session::Snapshot;
use crate::walk::Eye;
use egui_wgpu::RenderState;
use hemicube_gpu::pass::{Lookup, Metering, Target};
use hemicube_gpu::{Context, GpuError};
use hemicube_raster::{Image, Rgb};
use hemicube_render::Reflections;
use options::options;
use pace::{LIGHT_PACE, Pixels, QUICK_LIGHT_PACE};
pub use pictures::PanePaint;
use pictures::{PaneShow, Picture, SHOWN};
use scene::{Coming, OnStage, Order};
pub use stand_in::DECADES;
use stand_in::without_textures;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Pixels of a side of what mirrors show, and most objects that have such pictures of their own.
const MIRROR_SIDE: usize = 64;
const MIRRORS: usize = 8;

/// What draws panes.
pub struct Stage {
    context: Arc<Context>,
    /// Whether the processor draws, which the solver needs, too.
    is_software: bool,
    show: PaneShow,
    scene: Option<OnStage>,
    coming: Option<Coming>,
    /// The geometry that could not be put on the device.
    refused: Option<u64>,
    /// The light on the device that is being measured, and the last that was asked to be.
    metering: Option<Metering>,
    metered: Option<ShownLight>,
    pictures: Vec<Picture>,
    pixels: Pixels,
    /// Width of a pixel of the pictures in those of the window.
    divisor: u32,
    /// When light last came to the device, and how long it may not come again.
    lit: Option<Instant>,
    pause: Option<Pause>,
    /// Whether the last frame brought a new picture.
    has_drawn: bool,
    /// When there will be something new to draw.
    due: Option<Duration>,
}

/// What decides on the light on the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ShownLight {
    serial: u64,
    quantity: Quantity,
    ambient: bool,
    selected: Option<usize>,
}

/// Everything that a picture depends on.
#[derive(Clone, PartialEq)]
struct Shown {
    light: u64,
    eye: Eye,
    display: Display,
    exposure: f32,
    selected: Option<usize>,
    /// Whether it is drawn as well as can be: always, unless the processor draws and something moves.
    is_fine: bool,
    /// Whether mirrors show light at rest.
    mirrors_rest: bool,
}

impl Shown {
    /// What of it decides on the light on the device.
    fn light(&self) -> ShownLight {
        ShownLight {
            serial: self.light,
            quantity: self.display.quantity,
            ambient: self.display.ambient,
            selected: self.selected,
        }
    }

    /// Whether only the light differs, and what follows from it.
    fn is_same_but_for_light(&self, other: &Self) -> bool {
        let rest = |s: &Self| Self {
            light: 0,
            exposure: 0.0,
            ..s.clone()
        };
        rest(self) == rest(other)
    }
}

impl Stage {
    /// On the device of a window.
    ///
    /// # Errors
    /// The device cannot do all that is needed.
    pub fn new(window: &RenderState) -> Result<Self, GpuError> {
        let name = window.adapter.get_info().name;
        let context = Context::from_wgpu(&name, window.device.clone(), window.queue.clone())?;
        Ok(Self {
            context: Arc::new(context),
            is_software: window.adapter.get_info().device_type == wgpu::DeviceType::Cpu,
            show: PaneShow::new(window),
            scene: None,
            coming: None,
            refused: None,
            metering: None,
            metered: None,
            pictures: Vec::new(),
            pixels: Pixels::default(),
            divisor: 1,
            lit: None,
            pause: None,
            has_drawn: false,
            due: None,
        })
    }

    /// Whether all pictures are as they ought to be.
    pub fn is_up_to_date(&self, desk: &Desk) -> bool {
        let wanted = Some(self.wanted(desk));
        !self.pictures.is_empty() && self.pictures.iter().all(|picture| picture.shows == wanted)
    }

    /// The device.
    pub fn context(&self) -> &Arc<Context> {
        &self.context
    }

    /// Least time between two pictures that differ only in their light.
    pub fn light_pace(&self) -> Duration {
        if self.is_software {
            LIGHT_PACE
        } else {
            QUICK_LIGHT_PACE
        }
    }

    /// Whether the last frame brought a new picture.
    pub fn has_drawn(&self) -> bool {
        self.has_drawn
    }

    /// Whether a scene is on its way to the device.
    pub fn is_coming(&self) -> bool {
        self.coming.is_some()
    }

    /// Width of a pixel of the pictures in those of the window.
    pub fn divisor(&self) -> u32 {
        self.divisor
    }

    /// When there will be something new to draw, if that is known.
    pub fn due(&self) -> Option<Duration> {
        self.due
    }

    /// Draws what changed, and tells where the pictures are: one for each tile, none where nothing can be drawn.
    pub fn draw(&mut self, desk: &mut Desk, tiles: &[Tile]) -> Vec<Option<PanePaint>> {
        (self.has_drawn, self.due) = (false, None);
        let Some(snapshot) = desk.snapshot.clone() else {
            return vec![None; tiles.len()];
        };
        match self.set_scene(desk, &snapshot) {
            Ok(true) => {}
            Ok(false) => return self.shown_so_far(tiles.len()),
            Err(error) => {
                desk.complain(error.to_string());
                return vec![None; tiles.len()];
            }
        }
        self.take_meter(desk, &snapshot);
        self.fit(desk, tiles);
        let panes = desk.panes.clone();
        let draw = |(i, pane): (usize, &Pane)| match self.draw_pane(desk, &snapshot, pane, i) {
            Ok(()) => Some(self.pictures[i].paint.clone()),
            Err(error) => {
                desk.complain(error.to_string());
                None
            }
        };
        panes
            .iter()
            .take(tiles.len())
            .enumerate()
            .map(draw)
            .collect()
    }

    /// What there is while a scene is on its way.
    fn shown_so_far(&self, count: usize) -> Vec<Option<PanePaint>> {
        let picture = |i: usize| {
            let picture = self.pictures.get(i)?;
            picture.shows.as_ref().map(|_| picture.paint.clone())
        };
        (0..count).map(picture).collect()
    }

    /// Whether a scene is on the device with the materials that it has now; if not, it is on its way.
    fn set_scene(&mut self, desk: &Desk, snapshot: &Snapshot) -> Result<bool, GpuError> {
        if let Some(result) = self.coming.as_ref().and_then(Coming::take) {
            let geometry = self.coming.take().map(|coming| coming.geometry);
            self.forget();
            match result {
                Ok(scene) => self.scene = Some(scene),
                Err(error) => {
                    self.refused = geometry;
                    return Err(error);
                }
            }
        }
        let solution = &snapshot.lanes[0].solution;
        let wanted = (snapshot.geometry, solution.groups().len());
        let is_there = |scene: &OnStage| (scene.geometry, scene.groups) == wanted;
        let comes = |coming: &Coming| (coming.geometry, coming.groups) == wanted;
        if !self.scene.as_ref().is_some_and(is_there) {
            if !self.coming.as_ref().is_some_and(comes) && self.refused != Some(snapshot.geometry) {
                self.order(desk, snapshot);
            }
            return Ok(false);
        }
        self.set_materials(snapshot, desk.prefs.display.textures)?;
        Ok(true)
    }

    /// Starts to put a scene on the device.
    fn order(&mut self, desk: &Desk, snapshot: &Snapshot) {
        let mut ways = vec![options(desk, false)];
        if !self.is_software {
            ways = vec![options(desk, true)];
        }
        let order = Order {
            context: self.context.clone(),
            solution: snapshot.lanes[0].solution.clone(),
            geometry: snapshot.geometry,
            options: ways,
            camera: desk.eye.camera("first"),
        };
        let wake = desk.wake();
        self.coming = Some(order.start(move || wake()));
    }

    /// Brings the scene's materials to the device, with their textures or without.
    fn set_materials(&mut self, snapshot: &Snapshot, textures: bool) -> Result<(), GpuError> {
        let mesh = snapshot.mesh();
        let Some(scene) = &mut self.scene else {
            return Ok(());
        };
        if Arc::ptr_eq(&scene.mesh, mesh) && scene.is_textured == textures {
            return Ok(());
        }
        if textures {
            scene.walkthrough.set_materials(mesh.scene())?;
        } else {
            scene.walkthrough.set_materials(&without_textures(mesh))?;
        }
        scene.walkthrough.set_metered(mesh);
        scene.mesh = mesh.clone();
        scene.is_textured = textures;
        self.forget();
        Ok(())
    }

    /// What is shown, and what was measured, is no longer so.
    fn forget(&mut self) {
        (self.metering, self.metered) = (None, None);
        self.pictures
            .iter_mut()
            .for_each(|picture| picture.shows = None);
    }

    /// Makes the pictures as many and as large as the tiles; smaller ones while the eye moves if that is needed.
    fn fit(&mut self, desk: &Desk, tiles: &[Tile]) {
        let adapts = self.is_software && desk.prefs.display.coarse_motion;
        self.divisor = self.pixels.divisor(desk.moves(), adapts, &desk.frames);
        let divisor = self.divisor;
        self.pictures.truncate(tiles.len());
        for (i, tile) in tiles.iter().enumerate() {
            let size = tile.size.map(|pixels| pixels.div_ceil(divisor).max(1));
            if self.pictures.get(i).is_some_and(|p| p.size() == size) {
                continue;
            }
            let picture = self.show.picture(&self.context, size, divisor > 1);
            if i < self.pictures.len() {
                self.pictures[i] = picture;
            } else {
                self.pictures.push(picture);
            }
        }
    }

    fn draw_pane(
        &mut self,
        desk: &Desk,
        snapshot: &Snapshot,
        pane: &Pane,
        i: usize,
    ) -> Result<(), GpuError> {
        let mut shown = self.wanted(desk);
        let before = self.pictures[i].shows.clone();
        if before.as_ref() == Some(&shown) {
            return Ok(());
        }
        let is_same = |shown: &Shown| {
            let before = before.as_ref();
            before.is_some_and(|before| before.is_same_but_for_light(shown))
        };
        if let Some(serial) = self.light_to_keep(before.as_ref(), &shown) {
            shown.light = serial;
            let has_it = |before: &Shown| before.light == serial;
            if is_same(&shown) && before.as_ref().is_some_and(has_it) {
                return Ok(());
            }
        } else {
            self.set_light(desk, snapshot, pane, i, shown.light())?;
        }
        // With the exposure of this light it is drawn once, not twice.
        let waits = is_same(&shown) && self.pictures.len() == 1;
        if self.metering.is_some() && (waits || !desk.is_metered()) {
            return Ok(());
        }
        if desk.prefs.display.reflections && desk.prefs.display.quantity == Quantity::Light {
            self.set_mirrors(desk, snapshot, shown.light)?;
        }
        self.draw_picture(desk, i, shown.is_fine)?;
        self.pictures[i].shows = Some(shown);
        self.has_drawn = true;
        Ok(())
    }

    /// What a picture ought to show now.
    fn wanted(&self, desk: &Desk) -> Shown {
        Shown {
            light: desk.light_serial,
            eye: desk.eye,
            display: desk.prefs.display,
            exposure: desk.exposure,
            selected: desk
                .selected_patch()
                .filter(|_| desk.prefs.display.quantity == Quantity::FormFactors),
            is_fine: !self.is_software || desk.is_still(),
            mirrors_rest: desk.prefs.display.reflections && desk.is_still(),
        }
    }

    /// The light that stays on the device although there is newer one, if it does: because it was measured and not yet
    /// shown, or the newer one has to wait for its turn.
    fn light_to_keep(&mut self, before: Option<&Shown>, wanted: &Shown) -> Option<u64> {
        let lit = self.scene.as_ref()?.light.lit?.light;
        let serial = lit.serial;
        let newest = wanted.light();
        if (ShownLight { serial, ..newest }) != lit {
            return None;
        }
        let is_new = before.is_none_or(|before| before.light != serial);
        if self.metered == Some(lit) && is_new && self.pictures.len() == 1 {
            if self.metering.is_none() && newest != lit {
                // The newest comes right after it.
                self.due = Some(Duration::ZERO);
            }
            return Some(serial);
        }
        let wait = self.wait_for_light(before?, wanted)?;
        self.due = Some(self.due.map_or(wait, |due| due.min(wait)));
        Some(serial)
    }

    /// How long new light has to wait for its turn, if it has to.
    fn wait_for_light(&self, before: &Shown, wanted: &Shown) -> Option<Duration> {
        let is_light = before.light != wanted.light && self.pictures.len() == 1;
        if !self.is_software || !is_light || wanted.is_fine {
            return None;
        }
        let since = self.lit?.elapsed();
        let pace = (since < LIGHT_PACE).then(|| LIGHT_PACE - since);
        pace.max(self.pause.and_then(Pause::left))
    }

    fn draw_picture(&mut self, desk: &Desk, i: usize, is_fine: bool) -> Result<(), GpuError> {
        let Some(scene) = &mut self.scene else {
            return Ok(());
        };
        let picture = &self.pictures[i];
        let target = Target {
            view: &picture.view(),
            format: SHOWN,
            size: picture.size(),
        };
        let mut encoder = encoder(&self.context, "pane");
        let (camera, options) = (desk.eye.camera("view"), options(desk, is_fine));
        scene
            .walkthrough
            .draw(&mut encoder, target, &camera, &options)?;
        self.context.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// Takes pictures for what mirrors: at first, and again when light that has changed is at rest.
    fn set_mirrors(
        &mut self,
        desk: &Desk,
        snapshot: &Snapshot,
        light: u64,
    ) -> Result<(), GpuError> {
        let Some(scene) = &mut self.scene else {
            return Ok(());
        };
        match scene.mirrored {
            Some(mirrored) if mirrored == light || !desk.is_still() => return Ok(()),
            Some(_) => {}
            None => {
                let wanted = Reflections::default()
                    .with_resolution(MIRROR_SIDE)
                    .with_maps(MIRRORS);
                let solution = &snapshot.lanes[0].solution;
                scene
                    .walkthrough
                    .set_reflections(solution, &wanted, Lookup::default())?;
            }
        }
        scene.mirrored = Some(light);
        let mut encoder = encoder(&self.context, "mirrors");
        scene.walkthrough.capture(&mut encoder, desk.exposure)?;
        self.context.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// The first pane's picture as a file.
    ///
    /// # Errors
    /// There is no scene; it cannot be written.
    pub fn save(&mut self, desk: &Desk, size: [u32; 2], path: &Path) -> Result<(), String> {
        let scene = self.scene.as_mut().ok_or("there is no scene yet")?;
        let camera = desk.eye.camera("view");
        let picture = scene
            .walkthrough
            .display(&camera, size, &options(desk, true));
        let picture: Image<Rgb> = picture.map_err(|error| error.to_string())?;
        let encoded = crate::film_job::srgb8(&picture);
        crate::walk::save_png(path, &encoded).map_err(|error| error.to_string())
    }
}

fn encoder(context: &Context, label: &str) -> wgpu::CommandEncoder {
    let descriptor = wgpu::CommandEncoderDescriptor { label: Some(label) };
    context.device.create_command_encoder(&descriptor)
}
