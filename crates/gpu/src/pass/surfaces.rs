//! The surfaces of a scene on the device, and the order in which they are drawn.

use crate::buffer::{bind, filled};
use crate::context::Context;
use crate::error::GpuError;
use crate::hemicube::count;
use crate::pass::bump::Reliefs;
use crate::pass::geometry::{Cover, Geometry};
use crate::pass::layers::Layers;
use crate::pass::light::SurfaceLight;
use crate::pass::lit::{Pixels, Stage};
use crate::pass::material::{materials, slots};
use crate::pass::metering::MeteredSurfaces;
use crate::pass::passes::Passes;
use crate::pass::textured::{MaterialTextures, TextureFiltering};
use crate::pass::variant::Variant;
use crate::pass::view::Bounds;
use core::num::NonZeroU64;
use hemicube_radiosity::{DrawnMesh, Solution};
use hemicube_raster::Rgb;
use hemicube_scene::{Camera, MetalsAs, Scene, Units};
use hemicube_shaders::surface as twins;
use std::sync::Arc;
use wgpu::{BindGroup, Buffer, BufferUsages, RenderPass};

/// How surfaces are drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct How {
    pub(crate) pixels: Pixels,
    pub(crate) filtering: TextureFiltering,
    /// Whether reliefs turn normals.
    pub(crate) bumps: bool,
    /// Whether what mirrors does.
    pub(crate) reflections: bool,
    /// Whether light is that of elements instead of that between vertices.
    pub(crate) flat: bool,
    /// An instance that is left out.
    pub(crate) without: Option<usize>,
}

/// What draws a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Drawn {
    /// Without textures.
    Lit,
    /// With those of its material.
    Textured,
    /// And its relief.
    Bumped,
    /// And as a mirror that shows a map.
    Mirroring(usize),
}

/// The surfaces of a scene on the device.
#[derive(Debug)]
pub(crate) struct Surfaces {
    pub(crate) geometry: Geometry,
    pub(crate) light: SurfaceLight,
    pub(crate) metered: MeteredSurfaces,
    pub(crate) bounds: Bounds,
    scene: Arc<Scene>,
    materials: Buffer,
    /// Which of them emit.
    emits: Vec<bool>,
    textures: MaterialTextures,
    pub(crate) reliefs: Reliefs,
    /// Maps of mirrors.
    mirrors: Vec<BindGroup>,
    /// For each part of the drawn mesh the map that it mirrors.
    mirror_of_parts: Vec<Option<usize>>,
}

impl Surfaces {
    /// Puts a solution's surfaces on the device.
    ///
    /// # Errors
    /// What does not fit the adapter's limits.
    pub(crate) fn new(
        context: &Context,
        passes: &Passes,
        solution: &Solution,
    ) -> Result<Self, GpuError> {
        let scene = solution.mesh().scene().clone();
        let drawn = DrawnMesh::new(solution, Rgb::BLACK);
        let (geometry, sources, reliefs) = Geometry::new(context, solution, &drawn)?;
        let light = SurfaceLight::new(context, &passes.light, solution, &sources)?;
        let factors = materials(&scene);
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        Ok(Self {
            metered: MeteredSurfaces::new(context, solution.mesh()),
            bounds: Bounds::of(geometry.positions.iter().copied()),
            materials: filled(&context.device, "materials", &factors, usage),
            emits: emits(&factors),
            textures: MaterialTextures::new(context, &scene)?,
            reliefs: Reliefs::new(
                context,
                &passes.bump.layout,
                reliefs,
                &drawn.normals,
                &light.vertex_light,
            ),
            mirrors: Vec::new(),
            mirror_of_parts: vec![None; drawn.parts.len()],
            light,
            geometry,
            scene,
        })
    }

    /// Which parts of the drawn mesh mirror which maps from now on.
    pub(crate) fn set_mirrors(&mut self, mirrors: Vec<BindGroup>, of_parts: &[Option<usize>]) {
        self.mirrors = mirrors;
        self.mirror_of_parts = of_parts.to_vec();
    }

    /// Takes over the factors of a scene's materials.
    ///
    /// # Errors
    /// The scene has another number of materials.
    pub(crate) fn set_materials(
        &mut self,
        context: &Context,
        scene: &Scene,
    ) -> Result<(), GpuError> {
        let new = materials(scene);
        if size_of_val(new.as_slice()) as u64 != self.materials.size() {
            return Err(GpuError::Option(String::from(
                "the scene has other materials than the picture; make the picture anew",
            )));
        }
        let bytes = bytemuck::cast_slice(&new);
        context.queue.write_buffer(&self.materials, 0, bytes);
        self.emits = emits(&new);
        Ok(())
    }

    /// What the scene tells a view about its materials.
    pub(crate) fn tell(&self, view: &mut twins::View) {
        if self.scene.metals == MetalsAs::Diffuse {
            view.flags |= twins::VIEW_METALS_DIFFUSE;
        }
        view.max_reflectance = self.scene.max_reflectance;
    }

    /// A view together with what all passes read; its dynamic offset is that of a material.
    pub(crate) fn bind(&self, context: &Context, passes: &Passes, view: twins::View) -> BindGroup {
        let device = &context.device;
        let buffer = filled(device, "view", &[view], BufferUsages::UNIFORM);
        let light = &self.light;
        let one_material = wgpu::BufferBinding {
            buffer: &self.materials,
            offset: 0,
            size: NonZeroU64::new(twins::MATERIAL_STRIDE.into()),
        };
        let resources = [
            buffer.as_entire_binding(),
            wgpu::BindingResource::Buffer(one_material),
            light.element_light.as_entire_binding(),
            light.element_dims.as_entire_binding(),
        ];
        bind(device, "surfaces", &passes.scene, &resources)
    }

    /// Vertices, their light and triangles.
    pub(crate) fn set_buffers(&self, pass: &mut RenderPass<'_>) {
        let format = wgpu::IndexFormat::Uint32;
        pass.set_vertex_buffer(0, self.geometry.vertices.slice(..));
        pass.set_vertex_buffer(1, self.light.vertex_light.slice(..));
        pass.set_index_buffer(self.geometry.indices.slice(..), format);
    }

    /// Number of all indices.
    pub(crate) fn index_count(&self) -> u32 {
        let runs = self.geometry.runs.iter();
        runs.map(|run| run.indices.end).max().unwrap_or(0)
    }

    /// Draws all surfaces as they are lit that hide what is behind.
    pub(crate) fn draw_solid_lit(
        &mut self,
        context: &Context,
        passes: &mut Passes,
        pass: &mut RenderPass<'_>,
        bindings: &BindGroup,
        how: How,
    ) {
        self.set_buffers(pass);
        let mut run = 0;
        while run < self.geometry.runs.len() {
            let of = self.geometry.runs[run].clone();
            let is_drawn = of.cover != Cover::Transparent && how.without != Some(of.instance);
            if is_drawn {
                let last = self.last_alike(run, how);
                let stage = match of.cover {
                    Cover::Masked => Stage::Masked,
                    _ => Stage::Opaque,
                };
                self.set_run(context, passes, pass, bindings, (run, stage), how);
                let end = self.geometry.runs[last].indices.end;
                pass.draw_indexed(of.indices.start..end, 0, 0..1);
                run = last;
            }
            run += 1;
        }
    }

    /// Draws all solid surfaces with the pipeline and the bindings that are set.
    pub(crate) fn draw_solid(&self, pass: &mut RenderPass<'_>) {
        self.set_buffers(pass);
        let solid = self
            .geometry
            .runs
            .iter()
            .filter(|run| run.cover != Cover::Transparent);
        let end = solid.map(|run| run.indices.end).max().unwrap_or(0);
        pass.draw_indexed(0..end, 0, 0..1);
    }

    /// What the numbers of light mean.
    pub(crate) fn units(&self) -> Units {
        self.scene.units
    }

    /// The last of the neighbours of a solid run that one call can draw together with it.
    fn last_alike(&self, first: usize, how: How) -> usize {
        let runs = &self.geometry.runs;
        let drawn = self.drawn(first, how);
        let is_alike = |&next: &usize| {
            let of = &runs[next];
            of.cover == runs[first].cover
                && of.material == runs[first].material
                && of.has_colors == runs[first].has_colors
                && how.without != Some(of.instance)
                && self.drawn(next, how) == drawn
        };
        let alike = (first + 1..runs.len()).take_while(is_alike);
        alike.last().unwrap_or(first)
    }

    /// What draws a run.
    fn drawn(&self, run: usize, how: How) -> Drawn {
        let run = &self.geometry.runs[run];
        let material = &self.scene.materials[run.material];
        let mirror = self.mirror_of_parts.get(run.part).copied().flatten();
        match mirror.filter(|&map| how.reflections && map < self.mirrors.len()) {
            Some(map) => Drawn::Mirroring(map),
            None if how.bumps && material.relief.is_some() => Drawn::Bumped,
            None if slots(material).iter().any(Option::is_some) => Drawn::Textured,
            None => Drawn::Lit,
        }
    }

    /// Draws what lets light through, from the farthest on.
    pub(crate) fn draw_layers(
        &mut self,
        context: &Context,
        passes: &mut Passes,
        pass: &mut RenderPass<'_>,
        bindings: &BindGroup,
        how: How,
        camera: &Camera,
    ) {
        let layers = Layers::new(&self.geometry, camera);
        if layers.triangles.is_empty() {
            return;
        }
        let indices = layers.triangles.as_flattened();
        let buffer = filled(&context.device, "layers", indices, BufferUsages::INDEX);
        self.set_buffers(pass);
        pass.set_index_buffer(buffer.slice(..), wgpu::IndexFormat::Uint32);
        for (run, range) in &layers.ranges {
            if how.without == Some(self.geometry.runs[*run].instance) {
                continue;
            }
            for stage in [Stage::Through, Stage::Own] {
                self.set_run(context, passes, pass, bindings, (*run, stage), how);
                pass.draw_indexed(range.clone(), 0, 0..1);
            }
        }
    }

    /// Pipeline and bindings of a run.
    fn set_run(
        &mut self,
        context: &Context,
        passes: &mut Passes,
        pass: &mut RenderPass<'_>,
        bindings: &BindGroup,
        (run, stage): (usize, Stage),
        how: How,
    ) {
        let drawn = self.drawn(run, how);
        let material = self.geometry.runs[run].material;
        let pipelines = match drawn {
            Drawn::Lit => &mut passes.lit,
            Drawn::Textured => &mut passes.textured.pipelines,
            Drawn::Bumped => &mut passes.bump.pipelines,
            Drawn::Mirroring(_) => &mut passes.environment.pipelines,
        };
        let variant = self.variant(run, drawn, how);
        pass.set_pipeline(&pipelines.pipeline(context, stage, how.pixels, variant));
        pass.set_bind_group(0, bindings, &[count(material) * twins::MATERIAL_STRIDE]);
        if drawn == Drawn::Lit {
            return;
        }
        let layout = &passes.textured.layout;
        let textures = &mut self.textures;
        let bound = textures.of(context, layout, &self.scene, material, how.filtering);
        pass.set_bind_group(1, &bound, &[]);
        if drawn != Drawn::Textured {
            pass.set_bind_group(2, &self.reliefs.bindings, &[]);
        }
        if let Drawn::Mirroring(map) = drawn {
            pass.set_bind_group(3, &self.mirrors[map], &[]);
        }
    }

    /// What the shader of a run is made for.
    fn variant(&self, run: usize, drawn: Drawn, how: How) -> Variant {
        let run = &self.geometry.runs[run];
        let (material, emits) = (
            &self.scene.materials[run.material],
            self.emits[run.material],
        );
        let variant = Variant::untextured(material, emits, run.has_colors, how.flat);
        match drawn {
            Drawn::Lit => variant,
            Drawn::Textured => variant.with_textures(material, how.filtering, false),
            Drawn::Bumped | Drawn::Mirroring(_) => {
                variant.with_textures(material, how.filtering, how.bumps)
            }
        }
    }
}

/// Which materials emit.
fn emits(materials: &[twins::Material]) -> Vec<bool> {
    let emits = |material: &twins::Material| material.emission != [0.0; 3];
    materials.iter().map(emits).collect()
}
