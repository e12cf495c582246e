//! What comes from files and goes to them.

use crate::desk::errands::Errand;
use crate::desk::{Desk, Pick};
use crate::display::Quantity;
use crate::document::Document;
use crate::film_job::{FilmJob, FilmPlan};
use crate::session::{Command, Source};
use crate::walk::FilmFormat;
use hemicube_gpu::pass::Meter;
use hemicube_radiosity::Solution;
use hemicube_radiosity::export::lit_glb::{self, LitGlbOptions};
use hemicube_raster::Rgb;
use hemicube_raster::tonemap::Exposure;
use std::io::Write;
use std::path::{Path, PathBuf};

impl Desk {
    /// Opens the dialog for a purpose.
    pub fn ask(&mut self, pick: Pick) {
        let scene = &self.status.scene;
        let stem = if scene.is_empty() { "scene" } else { scene };
        let name = match pick {
            Pick::Open => String::new(),
            Pick::SaveLit => format!("{stem}-lit.glb"),
            Pick::SaveSession => format!("{stem}.hemicube.json"),
            Pick::SaveGrid => format!("{stem}-grid.csv"),
            Pick::SavePicture => format!("{stem}.png"),
            Pick::SaveFilm => match self.prefs.film_format.ending() {
                Some(ending) => format!("{stem}.{ending}"),
                None => format!("{stem}-frames"),
            },
        };
        let wake = self.wake();
        self.dialogs.ask(pick, &name, wake);
    }

    /// Does what a file was picked for.
    pub fn picked(&mut self, pick: Pick, path: PathBuf) {
        match pick {
            Pick::Open => self.open(&path.to_string_lossy()),
            Pick::SaveFilm | Pick::SaveLit => self.send_on(Errand::Save(pick, path)),
            Pick::SavePicture | Pick::SaveSession | Pick::SaveGrid => self.save(pick, path),
        }
    }

    /// Writes what was picked, as everything is now.
    pub(super) fn save(&mut self, pick: Pick, path: PathBuf) {
        let saved = match pick {
            Pick::Open => return,
            Pick::SavePicture => {
                self.wanted_picture = Some(path);
                return;
            }
            Pick::SaveFilm => {
                self.start_film(path);
                return;
            }
            Pick::SaveLit => self.save_lit(&path),
            Pick::SaveSession => self.save_session(&path),
            Pick::SaveGrid => self.save_grid(&path),
        };
        match saved {
            Ok(()) => self.tell(format!("wrote {}", path.display())),
            Err(why) => self.complain(format!("{}: {why}", path.display())),
        }
    }

    /// The light of the first pane, with its dims.
    pub fn dimmed_solution(&self) -> Option<Solution> {
        let (snapshot, pane) = (self.snapshot.as_ref()?, self.panes.first()?);
        let mut solution = (*snapshot.lanes[pane.lane].solution).clone();
        for (group, &dim) in pane.dims.iter().enumerate().take(solution.groups().len()) {
            solution.set_dim(group, dim);
        }
        Some(solution)
    }

    /// Factor on all light, worked out from all surfaces: it does not change when one turns around.
    pub(super) fn exposure_factor(&self) -> f32 {
        let (Some(snapshot), Some(pane)) = (&self.snapshot, self.panes.first()) else {
            return 1.0;
        };
        if let Some(meter) = self.meter() {
            return self.prefs.display.exposure(meter.luminances());
        }
        let mesh = snapshot.mesh();
        let ambient = self.ambient(pane.lane);
        let reflected = |e: usize| {
            let irradiance = pane.light.irradiance[e] + ambient;
            (mesh.reflectance()[e] * irradiance).luminance() / core::f32::consts::PI
        };
        // Lamps are left out, as an eye that adapts to a room does not look into them.
        let is_dark = |e: &usize| pane.light.exitance[*e].is_black();
        let elements = (0..mesh.elements().len()).filter(is_dark);
        self.prefs.display.exposure(elements.map(reflected))
    }

    /// Top of the scale of false colours, in lx; the light is looked at only where the scale is shown.
    pub(super) fn top_of_scale(&self) -> f32 {
        let (Some(snapshot), Some(pane)) = (&self.snapshot, self.panes.first()) else {
            return 1.0;
        };
        let units = snapshot.mesh().scene().units;
        let is_shown = self.prefs.display.quantity == Quantity::Illuminance;
        if let Some(meter) = self.meter() {
            let shown = meter.illuminances().filter(|_| is_shown);
            return self.prefs.display.scale_top(shown);
        }
        let shown = pane.light.irradiance.iter().filter(|_| is_shown);
        self.prefs
            .display
            .scale_top(shown.map(|&h| units.illuminance(h)))
    }

    /// How bright the light is that a device keeps, where it is not known here.
    fn meter(&self) -> Option<&Meter> {
        let geometry = self.snapshot.as_ref()?.geometry;
        let (of, meter) = self.meter.as_ref()?;
        (*of == geometry && !self.has_light()).then_some(meter)
    }

    /// Whether exposure and scale can be told: not before light that a device keeps has been measured there.
    pub fn is_metered(&self) -> bool {
        self.has_light() || self.meter().is_some()
    }

    /// Takes over how bright the light of a geometry is that a device keeps.
    pub fn set_meter(&mut self, geometry: u64, meter: Meter) {
        self.meter = Some((geometry, meter));
        self.exposed = None;
        self.refresh_exposure();
    }

    /// The estimate of the light to come that a lane shows.
    pub fn ambient(&self, lane: usize) -> Rgb {
        let lane = self
            .snapshot
            .as_ref()
            .and_then(|snapshot| snapshot.lanes.get(lane));
        match lane {
            Some(lane) if self.prefs.display.ambient => lane.ambient,
            _ => Rgb::BLACK,
        }
    }

    fn save_lit(&self, path: &Path) -> Result<(), String> {
        let solution = self.dimmed_solution().ok_or("there is no light yet")?;
        let options = LitGlbOptions {
            exposure: Exposure::Ev(self.exposure.log2()),
            tone_map: self.prefs.display.tone_map(),
            ambient: self.ambient(0),
            report: serde_json::json!({ "scene": self.status.scene, "by": "hemicube view" }),
        };
        let bytes = lit_glb::write(&solution, &options).map_err(|error| error.to_string())?;
        write_whole(path, &bytes)
    }

    fn save_session(&self, path: &Path) -> Result<(), String> {
        let source = self.status.source.clone().ok_or("there is no scene yet")?;
        let document = Document::new(
            source,
            self.prefs.settings,
            self.prefs.display,
            self.eye,
            self.path.clone(),
            self.mixer.clone(),
            self.edited.clone(),
        );
        write_whole(path, document.to_json().as_bytes())
    }

    fn save_grid(&self, path: &Path) -> Result<(), String> {
        let grid = self.grid.as_ref().ok_or("there is no grid yet")?;
        write_whole(path, grid.csv().as_bytes())
    }

    /// Goes on with a session; its scene is opened first.
    pub(super) fn open_document(&mut self, path: &str) {
        let read = std::fs::read_to_string(path).map_err(|error| error.to_string());
        match read.and_then(|text| Document::from_json(&text)) {
            Ok(document) => {
                self.prefs.settings = document.settings;
                self.prefs.display = document.display;
                self.session.send(Command::Configure(document.settings));
                self.session
                    .send(Command::Open(Source::Named(document.source.clone())));
                self.prefs.remember(path);
                self.pending = Some(document);
            }
            Err(why) => self.complain(format!("{path}: {why}")),
        }
    }

    fn start_film(&mut self, target: PathBuf) {
        let Some(solution) = self.dimmed_solution() else {
            return self.complain("there is no light yet");
        };
        if self.path.stops.len() < 2 {
            return self.complain("a film needs two stops: go somewhere, press C, go on, press C");
        }
        let height = self.prefs.film_height.clamp(90, 2160);
        let plan = FilmPlan {
            solution,
            path: self.path.clone(),
            speed: self.body.speed,
            display: self.prefs.display,
            exposure: self.exposure,
            size: [height * 16 / 9, height],
            format: self.prefs.film_format,
            target: with_ending(target, self.prefs.film_format),
        };
        let wake = self.wake();
        self.film = Some(FilmJob::start(plan, move || wake()));
    }
}

/// The path with the ending that its format has.
fn with_ending(path: PathBuf, format: FilmFormat) -> PathBuf {
    match format.ending() {
        Some(ending) => path.with_extension(ending),
        None => path,
    }
}

/// Writes a file that appears whole or not at all.
fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), String> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let write = || -> std::io::Result<()> {
        let mut file = tempfile::NamedTempFile::new_in(folder.unwrap_or(Path::new(".")))?;
        file.write_all(bytes)?;
        file.persist(path).map_err(|error| error.error)?;
        Ok(())
    };
    write().map_err(|error| error.to_string())
}
