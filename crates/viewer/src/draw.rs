//! Panes as pictures on the device of the window.
//!
//! A picture is drawn again only if something in it changed: the light, the eye, the size, how it is shown. The scene lies
//! on the device once, however many panes there are; each pane brings its light before it is drawn.

use crate::desk::{Desk, Pane};
use crate::display::{Display, Quantity};
use crate::panels::Tile;
use crate::session::{PatchRow, Snapshot};
use crate::walk::Eye;
use core::f32::consts::PI;
use egui_wgpu::{RenderState, Renderer};
use hemicube_gpu::pass::{
    DrawOptions, Interpolation, Lookup, MeshLines, Smoothing, Style, Target, TextureFiltering,
    Walkthrough,
};
use hemicube_gpu::{Context, GpuError};
use hemicube_radiosity::solution::BANDS;
use hemicube_radiosity::{PatchMesh, Solution};
use hemicube_raster::colormap::{Colormap, FieldPaint, Isolines};
use hemicube_raster::texture::Minify;
use hemicube_raster::{Image, Rgb};
use hemicube_render::Reflections;
use hemicube_scene::Scene;
use std::path::Path;
use std::sync::Arc;
use wgpu::{Texture, TextureFormat, TextureUsages, TextureViewDescriptor};

/// egui wants sRGB-encoded values that no sampler decodes.
const SHOWN: TextureFormat = TextureFormat::Rgba8Unorm;

/// Pixels of a side of what mirrors show, and most objects that have such pictures of their own.
const MIRROR_SIDE: usize = 64;
const MIRRORS: usize = 8;

/// What draws panes.
pub struct Stage {
    context: Arc<Context>,
    /// Whether the processor draws, which the solver needs, too.
    is_software: bool,
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
    /// Whether its textures are there, too.
    is_textured: bool,
    /// The light that mirrors show; none if nothing mirrors yet.
    mirrored: Option<u64>,
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
    /// Whether it is drawn as well as can be: always, unless the processor draws and something moves.
    is_fine: bool,
    /// Whether mirrors show light at rest.
    mirrors_rest: bool,
}

impl Shown {
    /// Whether only the eye and the colours differ.
    fn has_light_of(&self, other: &Self) -> bool {
        let light = |s: &Self| (s.light, s.display.quantity, s.display.ambient, s.selected);
        light(self) == light(other)
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
        if let Err(error) = self.set_scene(&snapshot, desk.prefs.display.textures) {
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
    fn set_scene(&mut self, snapshot: &Snapshot, textures: bool) -> Result<(), GpuError> {
        let solution = &snapshot.lanes[0].solution;
        if self
            .scene
            .as_ref()
            .is_none_or(|scene| scene.geometry != snapshot.geometry)
        {
            self.make_scene(snapshot.geometry, solution)?;
        }
        let Some(scene) = &mut self.scene else {
            return Ok(());
        };
        let mesh = solution.mesh();
        if Arc::ptr_eq(&scene.mesh, mesh) && scene.is_textured == textures {
            return Ok(());
        }
        if textures {
            scene.walkthrough.set_materials(mesh.scene())?;
        } else {
            scene.walkthrough.set_materials(&without_textures(mesh))?;
        }
        scene.mesh = mesh.clone();
        scene.is_textured = textures;
        self.forget();
        Ok(())
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
            is_textured: true,
            mirrored: None,
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
            let (device, filter) = (&self.context.device, wgpu::FilterMode::Nearest);
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
            is_fine: !self.is_software || desk.is_still(),
            mirrors_rest: desk.prefs.display.reflections && desk.is_still(),
        };
        let is_fine = shown.is_fine;
        if self.pictures[i].shows.as_ref() == Some(&shown) {
            return Ok(());
        }
        // With several panes the light on the device is another's.
        let before = self.pictures[i].shows.as_ref();
        let has_new_light =
            self.pictures.len() > 1 || before.is_none_or(|before| !before.has_light_of(&shown));
        if has_new_light {
            self.set_light(desk, snapshot, pane)?;
        }
        if desk.prefs.display.reflections && desk.prefs.display.quantity == Quantity::Light {
            self.set_mirrors(desk, snapshot, shown.light)?;
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
            .draw(&mut encoder, target, &camera, &options(desk, is_fine))?;
        self.context.queue.submit([encoder.finish()]);
        self.pictures[i].shows = Some(shown);
        Ok(())
    }

    /// Brings a pane's light to the device. Solutions that have got more light groups meanwhile are put there anew.
    fn set_light(&mut self, desk: &Desk, snapshot: &Snapshot, pane: &Pane) -> Result<(), GpuError> {
        let solved = &snapshot.lanes[pane.lane].solution;
        let other = match desk.prefs.display.quantity {
            Quantity::FormFactors => snapshot.row.as_ref().map(|row| as_light(solved, row)),
            _ => dimmed(solved, &pane.dims),
        };
        let solution = other.as_ref().unwrap_or(solved);
        let Some(scene) = &mut self.scene else {
            return Ok(());
        };
        if scene.walkthrough.set_light(solution).is_err() {
            let is_textured = scene.is_textured;
            self.make_scene(snapshot.geometry, solution)?;
            self.set_scene(snapshot, is_textured)?;
        }
        if let Some(scene) = &mut self.scene {
            let ambient = match desk.prefs.display.quantity {
                Quantity::Light => desk.ambient(pane.lane),
                _ => Rgb::BLACK,
            };
            scene.walkthrough.set_ambient(ambient);
        }
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
        let descriptor = wgpu::CommandEncoderDescriptor {
            label: Some("mirrors"),
        };
        let mut encoder = self.context.device.create_command_encoder(&descriptor);
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

/// A solution with factors on its light groups; none if all of them are 1.
fn dimmed(solved: &Solution, dims: &[Rgb]) -> Option<Solution> {
    if dims.iter().all(|&dim| dim == Rgb::WHITE) {
        return None;
    }
    let mut solution = solved.clone();
    for (group, &dim) in dims.iter().enumerate().take(solution.groups().len()) {
        solution.set_dim(group, dim);
    }
    Some(solution)
}

/// Decades of form factors that colours show.
const DECADES: f32 = 4.0;

/// Form factors as irradiance whose illuminance goes from 0 to 1 over the [`DECADES`] below the largest factor.
fn as_light(solved: &Solution, row: &PatchRow) -> Solution {
    let mesh = solved.mesh();
    let per_area = |(e, &f): (usize, &f32)| f / mesh.exposed_area(e).max(f32::MIN_POSITIVE);
    let densities: Vec<f32> = row.fractions.iter().enumerate().map(per_area).collect();
    let most = densities.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
    let unit = mesh.scene().units.illuminance(Rgb::WHITE);
    let height = |density: f32| ((density / most).log10() / DECADES + 1.0).clamp(0.0, 1.0) / unit;
    let mut solution = solved.clone();
    let channels = solution.groups().len() * BANDS;
    let mut irradiance = vec![0.0; channels * densities.len()];
    for (i, value) in irradiance
        .iter_mut()
        .take(BANDS * densities.len())
        .enumerate()
    {
        *value = height(densities[i % densities.len()]);
    }
    let none = vec![0.0; irradiance.len()];
    solution.replace_light(
        &irradiance,
        &none,
        &vec![0.0; channels],
        &vec![0.0; channels],
    );
    for group in 0..solution.groups().len() {
        solution.set_dim(group, Rgb::WHITE);
    }
    solution
}

/// The scene with each textured material in the mean colour of its surfaces.
fn without_textures(mesh: &PatchMesh) -> Scene {
    let mut scene = (**mesh.scene()).clone();
    let mut sums = vec![(Rgb::BLACK, Rgb::BLACK, 0.0); scene.materials.len()];
    for e in 0..mesh.elements().len() {
        let area = mesh.exposed_area(e);
        let (reflectance, emission, areas) = &mut sums[mesh.material_of_element(e)];
        *reflectance += mesh.reflectance()[e] * area;
        *emission += mesh.emission()[e] * (area / PI);
        *areas += area;
    }
    for (material, (reflectance, emission, area)) in scene.materials.iter_mut().zip(sums) {
        // What lets light through keeps its pictures: they say where.
        if area <= 0.0 || material.may_transmit() {
            continue;
        }
        if material.base_color_texture.take().is_some()
            || material.metallic_texture.take().is_some()
        {
            material.base_color = reflectance / area;
            material.metallic = 0.0;
        }
        if material.emission_texture.take().is_some() {
            material.emission = emission / area;
        }
    }
    scene
}

/// The device's options for what the window shows.
fn options(desk: &Desk, is_fine: bool) -> DrawOptions {
    let display = &desk.prefs.display;
    let options = DrawOptions::default()
        .with_exposure(desk.exposure)
        .with_tone_map(display.tone_map())
        .with_background(Rgb::splat(0.02 / desk.exposure.max(1e-30)))
        .with_style(style(desk))
        .with_filtering(TextureFiltering::default().with_minify(if is_fine {
            Minify::Ewa
        } else {
            Minify::Trilinear
        }))
        .with_bumps(display.bumps)
        .with_reflections(display.reflections)
        .with_smoothing(if is_fine && display.smooth_edges {
            Smoothing::Multisample
        } else {
            Smoothing::None
        })
        .with_interpolation(if display.flat {
            Interpolation::Flat
        } else {
            Interpolation::Gouraud
        });
    let is_wireframe = display.quantity == Quantity::Wireframe;
    if display.mesh || is_wireframe {
        let width = if is_wireframe { 1.2 } else { 1.0 };
        options.with_lines(MeshLines::default().with_width(width))
    } else {
        options
    }
}

fn style(desk: &Desk) -> Style {
    let display = &desk.prefs.display;
    match display.quantity {
        Quantity::Light => Style::Lit,
        Quantity::Wireframe => Style::Plain(Rgb::splat(0.82)),
        Quantity::FormFactors => {
            Style::FalseColour(FieldPaint::new(Colormap::sequential(), [0.0, 1.0]))
        }
        Quantity::Illuminance => {
            let top = desk.scale_top();
            let paint = FieldPaint::new(Colormap::sequential(), [0.0, top]);
            Style::FalseColour(if display.isolines {
                paint.with_isolines(Isolines {
                    spacing: 0.1 * top,
                    ..Isolines::default()
                })
            } else {
                paint
            })
        }
    }
}
