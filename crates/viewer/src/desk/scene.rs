//! Standing in a scene: entering it, picking surfaces, changing them.

use crate::desk::Desk;
use crate::desk::errands::Errand;
use crate::document::EditedMaterial;
use crate::measure::{GridJob, read_along};
use crate::session::{Command, Settings};
use crate::walk::{Body, Eye, Path};
use glam::Vec3;
use hemicube_radiosity::MaterialEdit;
use hemicube_raster::Rgb;
use hemicube_render::choose_camera;
use hemicube_scene::{Camera, Material};

impl Desk {
    /// Another mesh is here: perhaps another scene.
    pub(super) fn enter(&mut self) {
        let Some(snapshot) = self.snapshot.clone() else {
            return;
        };
        let mesh = snapshot.mesh();
        (self.selection, self.hover, self.grid) = (None, None, None);
        self.errands.clear();
        self.grid_job = None;
        let source = self.session.status().source;
        if self.entered.is_some() && source == self.entered && self.pending.is_none() {
            return;
        }
        self.body = Body::in_scene(mesh.visibility().diameter());
        self.falling = 0.0;
        self.edited.clear();
        self.original = Some(mesh.scene().clone());
        self.path = Path::default();
        self.playing = None;
        let first = self.first_stop().unwrap_or_else(|| choose_camera(mesh));
        self.look_through(&first);
        if let Some(path) = source
            .as_ref()
            .filter(|source| std::path::Path::new(source).is_file())
        {
            self.prefs.remember(path);
        }
        self.entered = source;
        if let Some(document) = self.pending.take() {
            self.eye = document.eye;
            self.path.clone_from(&document.path);
            self.mixer.clone_from(&document.mixer);
            let names: Vec<String> = snapshot.lanes[0]
                .solution
                .groups()
                .iter()
                .map(|g| g.name.clone())
                .collect();
            self.mixer.follow(names.iter().map(String::as_str));
            for edit in document.edits(mesh.scene()) {
                self.edit(edit);
            }
        }
    }

    /// The camera that was asked for, or the first.
    fn first_stop(&mut self) -> Option<Camera> {
        let wanted = self.camera.take();
        let found = self
            .stops()
            .iter()
            .find(|camera| Some(&camera.name) == wanted.as_ref());
        let camera = found.or(self.stops().first()).cloned();
        if let (None, Some(wanted)) = (found, wanted) {
            let names: Vec<&str> = self.stops().iter().map(|stop| &*stop.name).collect();
            let names = names.join(", ");
            self.complain(format!(
                "no camera is called '{wanted}'; there are: {names}"
            ));
        }
        camera
    }

    /// Cameras of the scene.
    pub fn stops(&self) -> &[Camera] {
        match &self.snapshot {
            Some(snapshot) => &snapshot.mesh().scene().cameras,
            None => &[],
        }
    }

    /// Takes the place of a camera.
    pub fn look_through(&mut self, camera: &Camera) {
        let mode = self.eye.mode;
        let Some(snapshot) = &self.snapshot else {
            return;
        };
        let mesh = snapshot.mesh();
        let hit = mesh
            .visibility()
            .first_hit(camera.eye, camera.forward, f32::INFINITY);
        let distance = hit.map_or(0.5 * mesh.visibility().diameter(), |hit| hit.distance);
        self.eye = Eye {
            mode,
            ..Eye::of_camera(camera, distance)
        };
        self.falling = 0.0;
        self.playing = None;
    }

    /// What is under a point of a pane: x to the right and y down, each from -1 to 1.
    pub fn point_at(&mut self, pane: usize, x: f32, y: f32, aspect: f32) {
        self.hover = self.reading_at(pane, self.eye.direction_at(x, y, aspect));
        self.refresh_readings();
    }

    fn reading_at(&self, pane: usize, direction: Vec3) -> Option<crate::measure::Reading> {
        let (snapshot, pane) = (self.snapshot.as_ref()?, self.panes.get(pane)?);
        read_along(snapshot.mesh(), &pane.light, self.eye.position, direction)
    }

    /// The surface under the pointer becomes the selected one.
    pub fn select(&mut self) {
        self.selection = self.hover;
        if let Some(reading) = &self.selection {
            self.eye.distance = reading.point.distance(self.eye.position).max(1e-6);
        }
    }

    /// A material of the scene.
    pub fn material(&self, index: usize) -> Option<&Material> {
        self.snapshot.as_ref()?.mesh().scene().materials.get(index)
    }

    /// Base colour and emission of a material as they were last set, shot or not.
    pub fn colors(&self, index: usize) -> Option<[Rgb; 2]> {
        let material = self.material(index)?;
        let edited = self.edited.get(&material.name);
        let base_color = edited.and_then(|edited| edited.base_color);
        let emission = edited.and_then(|edited| edited.emission);
        Some([
            base_color.unwrap_or(material.base_color),
            emission.unwrap_or(material.emission),
        ])
    }

    /// Changes a material; the solver shoots the difference.
    pub fn edit(&mut self, edit: MaterialEdit) {
        let Some(material) = self.material(edit.material) else {
            return;
        };
        let name = material.name.clone();
        let edited = self.edited.entry(name).or_insert(EditedMaterial {
            base_color: None,
            emission: None,
        });
        edited.base_color = edit.base_color.or(edited.base_color);
        edited.emission = edit.emission.or(edited.emission);
        self.session.send(Command::Edit(edit));
    }

    /// Changes a material back to what its file says.
    pub fn undo_edit(&mut self, index: usize) {
        let original = self
            .original
            .as_ref()
            .and_then(|scene| scene.materials.get(index))
            .cloned();
        if let Some(material) = original {
            let edit = MaterialEdit::new(index)
                .with_base_color(material.base_color)
                .with_emission(material.emission);
            self.edit(edit);
            self.edited.remove(&material.name);
        }
    }

    /// Most radiance that sliders offer: four times that of the brightest lamp of the file.
    pub fn emission_scale(&self) -> f32 {
        let materials = self.original.iter().flat_map(|scene| &scene.materials);
        let brightest = materials
            .map(|material| material.emission.luminance())
            .fold(0.0, f32::max);
        if brightest > 0.0 {
            4.0 * brightest
        } else {
            10_000.0
        }
    }

    /// Other ways to the light.
    pub fn configure(&mut self, settings: Settings) {
        let before = core::mem::replace(&mut self.prefs.settings, settings);
        if before.with_refinement(settings.refinement) != settings {
            self.session.send(Command::Configure(settings));
        } else if before != settings {
            // Solvers may go on as they are.
            self.session.send(Command::Refine(settings.refinement));
        }
    }

    /// Measures a grid on the selected surface.
    pub fn measure_grid(&mut self) {
        if self.selection.is_some() {
            self.send_on(Errand::Grid);
        }
    }

    pub(super) fn start_grid(&mut self) {
        let (Some(reading), Some(solution)) = (self.selection, self.dimmed_solution()) else {
            return;
        };
        let wake = self.wake();
        let job = GridJob::start(solution.into(), &reading, self.grid_options, move || wake());
        self.grid_job = Some(job);
    }
}
