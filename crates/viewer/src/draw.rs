//! Panes as pictures on the device of the window.
//!
//! A picture is drawn again only if something in it changed: the light, the eye, the size, how it is shown. The scene lies
//! on the device once, however many panes there are; each pane brings its light before it is drawn.

use crate::desk::{Desk, Pane};
use crate::display::{Display, Quantity};
use crate::panels::Tile;
use crate::session::Snapshot;
use crate::walk::Eye;
use egui_wgpu::{RenderState, Renderer};
use hemicube_gpu::pass::{
    DrawOptions, Interpolation, MeshLines, Smoothing, Style, Target, Walkthrough,
};
use hemicube_gpu::{Context, GpuError};
use hemicube_radiosity::{PatchMesh, Solution};
use hemicube_raster::{Image, Rgb};
use std::path::Path;
use std::sync::Arc;
use wgpu::{Texture, TextureFormat, TextureUsages, TextureViewDescriptor};

/// egui wants sRGB-encoded values that no sampler decodes.
const SHOWN: TextureFormat = TextureFormat::Rgba8Unorm;

/// What draws panes.
pub struct Stage {
    context: Arc<Context>,
    egui: Arc<egui::mutex::RwLock<Renderer>>,
    scene: Option<OnStage>,
    pictures: Vec<Picture>,
}

/// A scene on the device.
struct OnStage {
    walkthrough: Walkthrough,
    geometry: u64,
    /// The mesh whose materials are there.
    mesh: Arc<PatchMesh>,
}

/// A pane's picture, and what it shows.
struct Picture {
    texture: Texture,
    id: egui::TextureId,
    shows: Option<Shown>,
}

/// Everything that a picture depends on.
#[derive(Clone, PartialEq)]
struct Shown {
    light: u64,
    eye: Eye,
    display: Display,
    exposure: f32,
    selected: Option<usize>,
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
            egui: window.renderer.clone(),
            scene: None,
            pictures: Vec::new(),
        })
    }

    /// Draws what changed, and tells where the pictures are: one for each tile, none where nothing can be drawn.
    pub fn draw(&mut self, desk: &mut Desk, tiles: &[Tile]) -> Vec<Option<egui::TextureId>> {
        let Some(snapshot) = desk.snapshot.clone() else {
            return vec![None; tiles.len()];
        };
        if let Err(error) = self.set_scene(&snapshot) {
            desk.complain(error.to_string());
            return vec![None; tiles.len()];
        }
        self.fit(tiles);
        let panes = desk.panes.clone();
        let draw = |(i, pane): (usize, &Pane)| {
            let drawn = self.draw_pane(desk, &snapshot, pane, i, tiles[i].size);
            match drawn {
                Ok(()) => Some(self.pictures[i].id),
                Err(error) => {
                    desk.complain(error.to_string());
                    None
                }
            }
        };
        panes
            .iter()
            .take(tiles.len())
            .enumerate()
            .map(draw)
            .collect()
    }

    /// Puts a scene on the device unless it is there.
    fn set_scene(&mut self, snapshot: &Snapshot) -> Result<(), GpuError> {
        let solution = &snapshot.lanes[0].solution;
        let fits = |scene: &OnStage| {
            scene.geometry == snapshot.geometry
                && scene.mesh.elements().len() == solution.mesh().elements().len()
        };
        if let Some(scene) = self.scene.as_mut().filter(|scene| fits(scene)) {
            if Arc::ptr_eq(&scene.mesh, solution.mesh()) {
                return Ok(());
            }
            scene.walkthrough.set_materials(solution.mesh().scene())?;
            scene.mesh = solution.mesh().clone();
            self.forget();
            return Ok(());
        }
        self.make_scene(snapshot.geometry, solution)
    }

    fn make_scene(&mut self, geometry: u64, solution: &Solution) -> Result<(), GpuError> {
        let walkthrough = match &self.scene {
            Some(scene) => scene.walkthrough.another(solution)?,
            None => Walkthrough::new(self.context.clone(), solution)?,
        };
        self.scene = Some(OnStage {
            walkthrough,
            geometry,
            mesh: solution.mesh().clone(),
        });
        self.forget();
        Ok(())
    }

    fn forget(&mut self) {
        self.pictures
            .iter_mut()
            .for_each(|picture| picture.shows = None);
    }

    /// Makes the pictures as many and as large as the tiles.
    fn fit(&mut self, tiles: &[Tile]) {
        let mut renderer = self.egui.write();
        for picture in self.pictures.drain(tiles.len().min(self.pictures.len())..) {
            renderer.free_texture(&picture.id);
        }
        for (i, tile) in tiles.iter().enumerate() {
            let size = self.pictures.get(i).map(|picture| picture.texture.size());
            if size.is_some_and(|size| [size.width, size.height] == tile.size) {
                continue;
            }
            let texture = texture(&self.context, tile.size);
            let view = texture.create_view(&TextureViewDescriptor::default());
            let (device, filter) = (&self.context.device, wgpu::FilterMode::Linear);
            let id = match self.pictures.get(i) {
                Some(picture) => {
                    renderer
                        .update_egui_texture_from_wgpu_texture(device, &view, filter, picture.id);
                    picture.id
                }
                None => renderer.register_native_texture(device, &view, filter),
            };
            let picture = Picture {
                texture,
                id,
                shows: None,
            };
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
        size: [u32; 2],
    ) -> Result<(), GpuError> {
        let shown = Shown {
            light: desk.light_serial,
            eye: desk.eye,
            display: desk.prefs.display,
            exposure: desk.exposure,
            selected: desk
                .selected_patch()
                .filter(|_| desk.prefs.display.quantity == Quantity::FormFactors),
        };
        if self.pictures[i].shows.as_ref() == Some(&shown) {
            return Ok(());
        }
        let has_new_light = self.pictures.len() > 1
            || self.pictures[i]
                .shows
                .as_ref()
                .is_none_or(|s| s.light != shown.light);
        if has_new_light {
            self.set_light(desk, snapshot, pane)?;
        }
        let Some(scene) = &mut self.scene else {
            return Ok(());
        };
        let view = self.pictures[i]
            .texture
            .create_view(&TextureViewDescriptor::default());
        let target = Target {
            view: &view,
            format: SHOWN,
            size,
        };
        let descriptor = wgpu::CommandEncoderDescriptor {
            label: Some("pane"),
        };
        let mut encoder = self.context.device.create_command_encoder(&descriptor);
        let camera = desk.eye.camera("view");
        scene
            .walkthrough
            .draw(&mut encoder, target, &camera, &options(desk))?;
        self.context.queue.submit([encoder.finish()]);
        self.pictures[i].shows = Some(shown);
        Ok(())
    }

    /// Brings a pane's light to the device. Solutions that have got more light groups meanwhile are put there anew.
    fn set_light(&mut self, desk: &Desk, snapshot: &Snapshot, pane: &Pane) -> Result<(), GpuError> {
        let solved = &snapshot.lanes[pane.lane].solution;
        let is_dimmed = pane.dims.iter().any(|&dim| dim != Rgb::WHITE);
        let dimmed = is_dimmed.then(|| {
            let mut solution = (**solved).clone();
            for (group, &dim) in pane.dims.iter().enumerate().take(solution.groups().len()) {
                solution.set_dim(group, dim);
            }
            solution
        });
        let solution = dimmed.as_ref().unwrap_or(solved);
        let Some(scene) = &mut self.scene else {
            return Ok(());
        };
        if scene.walkthrough.set_light(solution).is_err() {
            self.make_scene(snapshot.geometry, solution)?;
        }
        if let Some(scene) = &mut self.scene {
            scene.walkthrough.set_ambient(desk.ambient(pane.lane));
        }
        Ok(())
    }

    /// The first pane's picture as a file.
    ///
    /// # Errors
    /// There is no scene; it cannot be written.
    pub fn save(&mut self, desk: &Desk, size: [u32; 2], path: &Path) -> Result<(), String> {
        let scene = self.scene.as_mut().ok_or("there is no scene yet")?;
        let camera = desk.eye.camera("view");
        let picture = scene.walkthrough.display(&camera, size, &options(desk));
        let picture: Image<Rgb> = picture.map_err(|error| error.to_string())?;
        let encoded = crate::film_job::srgb8(&picture);
        crate::walk::save_png(path, &encoded).map_err(|error| error.to_string())
    }
}

fn texture(context: &Context, [width, height]: [u32; 2]) -> Texture {
    context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("pane"),
        size: wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: SHOWN,
        usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}

/// The device's options for what the window shows.
fn options(desk: &Desk) -> DrawOptions {
    let display = &desk.prefs.display;
    let options = DrawOptions::default()
        .with_exposure(desk.exposure)
        .with_tone_map(display.tone_map())
        .with_smoothing(if display.smooth_edges {
            Smoothing::Multisample
        } else {
            Smoothing::None
        })
        .with_interpolation(if display.flat {
            Interpolation::Flat
        } else {
            Interpolation::Gouraud
        });
    let options = match display.quantity {
        Quantity::Wireframe => options.with_style(Style::Plain(Rgb::splat(0.9))),
        _ => options,
    };
    if display.mesh || display.quantity == Quantity::Wireframe {
        options.with_lines(MeshLines::default())
    } else {
        options
    }
}
