//! The window.

use crate::desk::Desk;
use crate::draw::Stage;
use crate::panels::{self, HemicubeTexture, obey_keys};
use crate::prefs::Prefs;
use crate::session::{Asked, Settings};
use crate::theme;
use crate::trial::Trial;
use egui_wgpu::RenderState;
use hemicube_scene::SceneOptions;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Name under which preferences are kept.
const PREFS: &str = "prefs";

/// How a window starts.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewOptions {
    /// File, built-in scene or session. Default value: `office`.
    pub scene: String,
    /// Tries the window out for that time, closes it and tells what was measured. Default value: none, it stays open.
    pub measure: Option<Duration>,
    /// Width and height of the window in points. Default value: none, as it was last, at first 1280 by 800.
    pub size: Option<[f32; 2]>,
    /// How the light is found. Default value: none, as last time.
    pub settings: Option<Settings>,
    /// What of that is otherwise. Default value: nothing.
    pub asked: Asked,
    /// Changes to the scene that is opened first; none for a session. Default value: none.
    pub changes: Option<SceneOptions>,
    /// Camera of the scene to begin with. Default value: none, its first.
    pub camera: Option<String>,
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
            asked: Asked::default(),
            changes: None,
            camera: None,
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
    trial: Option<Trial>,
    picture_size: [u32; 2],
    /// Whether nothing is remembered.
    forgets: bool,
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
        prefs.settings = options
            .asked
            .in_settings(options.settings.unwrap_or(prefs.settings));
        let waking = ctx.clone();
        let mut desk = Desk::new(prefs, Arc::new(move || waking.request_repaint()));
        desk.camera.clone_from(&options.camera);
        let stage = match device.map(Stage::new) {
            Some(Ok(stage)) => {
                desk.session.set_pace(stage.light_pace());
                desk.session.solve_on(stage.context().clone());
                Some(stage)
            }
            Some(Err(error)) => {
                desk.complain(error.to_string());
                None
            }
            None => None,
        };
        desk.open_changed(&options.scene, options.changes.clone());
        Self {
            desk,
            stage,
            hemicube: HemicubeTexture::default(),
            is_followed: false,
            trial: options.measure.map(|time| {
                let waking = ctx.clone();
                Trial::start(Instant::now(), time, move || waking.request_repaint())
            }),
            picture_size: [1, 1],
            forgets: options.forgets,
        }
    }

    /// In a window.
    pub fn in_window(creation: &eframe::CreationContext<'_>, options: &ViewOptions) -> Self {
        let remembered = creation
            .storage
            .and_then(|storage| storage.get_string(PREFS));
        if options.forgets {
            let memory = egui::Memory::default();
            creation.egui_ctx.memory_mut(|before| *before = memory);
        }
        let device = creation.wgpu_render_state.as_ref();
        Self::new(&creation.egui_ctx, remembered.as_deref(), device, options)
    }

    /// Whether the picture shows the newest light and all that was set; always, if nothing draws pictures.
    pub fn is_up_to_date(&self) -> bool {
        let stage = self.stage.as_ref();
        stage.is_none_or(|stage| stage.is_up_to_date(&self.desk))
    }

    /// Shows everything, and does what keys and pointer ask.
    pub fn frame(&mut self, ui: &mut egui::Ui) {
        self.desk.frames.tick(self.is_followed);
        self.desk.refresh();
        if let Some(trial) = &mut self.trial {
            trial.begin_frame(&mut self.desk);
        }
        let before = self.desk.eye;
        let motion = obey_keys(ui.ctx(), &mut self.desk);
        let seconds = ui.input(|input| input.stable_dt);
        let moves = self.desk.advance(motion, seconds);
        panels::around(ui, &mut self.desk, &mut self.hemicube);
        let middle = egui::Frame::new();
        egui::CentralPanel::default()
            .frame(middle)
            .show(ui, |ui| self.picture(ui));
        panels::over(ui, &mut self.desk);
        let of_stage = self.stage.as_ref().and_then(Stage::due);
        for due in [of_stage, self.desk.due].into_iter().flatten() {
            ui.ctx().request_repaint_after(due);
        }
        if let Some(rest) = self.desk.note_eye() {
            ui.ctx().request_repaint_after(rest);
        }
        let hurries = self.trial.as_ref().is_some_and(Trial::hurries);
        if moves || hurries {
            ui.ctx().request_repaint();
        } else if self.trial.is_some() {
            ui.ctx().request_repaint_after(Duration::from_millis(200));
        }
        // A light that is solved brings frames at its own pace; those tell nothing of how fast frames could be.
        self.is_followed = moves || hurries || self.desk.eye != before;
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
        self.desk.waits_for_device = self.stage.as_ref().is_some_and(Stage::is_coming);
        if let Some(trial) = &mut self.trial {
            let stage = self.stage.as_ref();
            let drawn = stage.filter(|stage| stage.has_drawn());
            trial.end_frame(&self.desk, drawn.map(Stage::divisor));
        }
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
        if let Some(report) = self.trial.as_mut().and_then(Trial::report) {
            println!("{report}");
            self.trial = None;
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }
}

impl eframe::App for Viewer {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.frame(ui);
        self.end_in_time(ui.ctx());
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    fn persist_egui_memory(&self) -> bool {
        !self.forgets
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        if self.forgets {
            return;
        }
        // Sizes that were asked for are those of one scene.
        let mut prefs = self.desk.prefs.clone();
        prefs.settings.mesh = None;
        if let Some(refinement) = &mut prefs.settings.refinement {
            refinement.smallest = None;
        }
        if let Ok(text) = serde_json::to_string(&prefs) {
            storage.set_string(PREFS, text);
        }
    }
}
