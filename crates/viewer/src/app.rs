//! The window.

use crate::desk::Desk;
use crate::draw::Stage;
use crate::panels::{self, HemicubeTexture, obey_keys};
use crate::prefs::Prefs;
use crate::session::{Phase, Settings};
use crate::theme;
use egui_wgpu::RenderState;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Name under which preferences are kept.
const PREFS: &str = "prefs";

/// How a window starts.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewOptions {
    /// File, built-in scene or session. Default value: `office`.
    pub scene: String,
    /// Closes the window after that time and tells how long frames took. Default value: none, it stays open.
    pub measure: Option<Duration>,
    /// Width and height of the window in points. Default value: none, as it was last, at first 1280 by 800.
    pub size: Option<[f32; 2]>,
    /// How the light is found. Default value: none, as last time.
    pub settings: Option<Settings>,
    /// Whether what was set last time is left alone and nothing is remembered. Default value: no.
    pub forgets: bool,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self {
            scene: String::from("office"),
            measure: None,
            size: None,
            settings: None,
            forgets: false,
        }
    }
}

/// The viewer, as a window shows it.
pub struct Viewer {
    /// Everything that it shows.
    pub desk: Desk,
    stage: Option<Stage>,
    hemicube: HemicubeTexture,
    /// Whether the last frame was to be followed by this one at once.
    is_followed: bool,
    /// When it closes by itself.
    ends: Option<Instant>,
    picture_size: [u32; 2],
}

impl Viewer {
    /// A viewer with what was remembered, if anything was; it draws pictures if there is a device to draw with.
    pub fn new(
        ctx: &egui::Context,
        remembered: Option<&str>,
        device: Option<&RenderState>,
        options: &ViewOptions,
    ) -> Self {
        theme::apply(ctx);
        let mut prefs = remembered
            .filter(|_| !options.forgets)
            .and_then(|text| serde_json::from_str::<Prefs>(text).ok())
            .unwrap_or_default();
        if let Some(settings) = options.settings {
            prefs.settings = settings;
        }
        let waking = ctx.clone();
        let mut desk = Desk::new(
            prefs,
            &options.scene,
            Arc::new(move || waking.request_repaint()),
        );
        desk.frames.keeps_all = options.measure.is_some();
        let stage = match device.map(Stage::new) {
            Some(Ok(stage)) => Some(stage),
            Some(Err(error)) => {
                desk.complain(error.to_string());
                None
            }
            None => None,
        };
        Self {
            desk,
            stage,
            hemicube: HemicubeTexture::default(),
            is_followed: false,
            ends: options.measure.map(|time| Instant::now() + time),
            picture_size: [1, 1],
        }
    }

    /// In a window.
    pub fn in_window(creation: &eframe::CreationContext<'_>, options: &ViewOptions) -> Self {
        let remembered = creation
            .storage
            .and_then(|storage| storage.get_string(PREFS));
        let device = creation.wgpu_render_state.as_ref();
        Self::new(&creation.egui_ctx, remembered.as_deref(), device, options)
    }

    /// Shows everything, and does what keys and pointer ask.
    pub fn frame(&mut self, ui: &mut egui::Ui) {
        self.desk.frames.tick(self.is_followed);
        self.desk.refresh();
        let motion = obey_keys(ui.ctx(), &mut self.desk);
        let seconds = ui.input(|input| input.stable_dt);
        let moves = self.desk.advance(motion, seconds);
        panels::around(ui, &mut self.desk, &mut self.hemicube);
        let middle = egui::Frame::new();
        egui::CentralPanel::default()
            .frame(middle)
            .show(ui, |ui| self.picture(ui));
        panels::over(ui, &mut self.desk);
        if let Some(rest) = self.desk.note_eye() {
            ui.ctx().request_repaint_after(rest);
        }
        let is_solving = self.desk.status.phase == Phase::Solving;
        if moves || self.ends.is_some() {
            ui.ctx().request_repaint();
        }
        self.is_followed = moves || self.ends.is_some() || is_solving;
    }

    fn picture(&mut self, ui: &mut egui::Ui) {
        let rect = ui.available_rect_before_wrap();
        let tiles = panels::tiles(rect, self.desk.panes.len(), ui.ctx().pixels_per_point());
        if let Some(tile) = tiles.first() {
            self.picture_size = tile.size;
        }
        let pictures = match &mut self.stage {
            Some(stage) => stage.draw(&mut self.desk, &tiles),
            None => vec![None; tiles.len()],
        };
        panels::view(ui, &mut self.desk, rect, &tiles, &pictures);
        self.save_picture();
    }

    fn save_picture(&mut self) {
        let (Some(path), Some(stage)) = (self.desk.wanted_picture.take(), &mut self.stage) else {
            return;
        };
        match stage.save(&self.desk, self.picture_size, &path) {
            Ok(()) => self.desk.tell(format!("wrote {}", path.display())),
            Err(why) => self.desk.complain(format!("{}: {why}", path.display())),
        }
    }

    fn end_in_time(&mut self, ctx: &egui::Context) {
        if self.ends.take_if(|end| Instant::now() >= *end).is_some() {
            if let Some(report) = self.desk.frames.report() {
                println!("{report}");
            }
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }
}

impl eframe::App for Viewer {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.frame(ui);
        self.end_in_time(ui.ctx());
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        if let Ok(text) = serde_json::to_string(&self.desk.prefs) {
            storage.set_string(PREFS, text);
        }
    }
}
