//! The surfaces of a scene on the device, and the order in which they are drawn.

use crate::buffer::{bind, filled};
use crate::context::Context;
use crate::error::GpuError;
use crate::pass::geometry::{Cover, Geometry, Run};
use crate::pass::layers::Layers;
use crate::pass::light::SurfaceLight;
use crate::pass::lit::{Pixels, Stage};
use crate::pass::material::{materials, slots};
use crate::pass::passes::Passes;
use crate::pass::textured::{MaterialTextures, TextureFiltering};
use crate::pass::view::Bounds;
use hemicube_radiosity::{DrawnMesh, Solution};
use hemicube_raster::Rgb;
use hemicube_scene::{Camera, MetalsAs, Scene, Units};
use hemicube_shaders::surface as twins;
use std::sync::Arc;
use wgpu::{BindGroup, Buffer, BufferUsages, RenderPass};

/// Which pass draws a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Without textures.
    Lit,
    /// With textures.
    Textured,
}

/// The surfaces of a scene on the device.
#[derive(Debug)]
pub(crate) struct Surfaces {
    pub(crate) geometry: Geometry,
    pub(crate) light: SurfaceLight,
    pub(crate) bounds: Bounds,
    scene: Arc<Scene>,
    materials: Buffer,
    textures: MaterialTextures,
    /// What draws each run.
    kinds: Vec<Kind>,
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
        let (geometry, sources) = Geometry::new(context, solution, &drawn)?;
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let kind = |run: &Run| {
            let textures = slots(&scene.materials[run.material]);
            match textures.iter().any(Option::is_some) {
                true => Kind::Textured,
                false => Kind::Lit,
            }
        };
        Ok(Self {
            light: SurfaceLight::new(context, &passes.light, solution, &sources)?,
            bounds: Bounds::of(geometry.positions.iter().copied()),
            materials: filled(&context.device, "materials", &materials(&scene), usage),
            textures: MaterialTextures::new(context, &scene)?,
            kinds: geometry.runs.iter().map(kind).collect(),
            geometry,
            scene,
        })
    }

    /// Takes over the factors of a scene's materials.
    ///
    /// # Errors
    /// The scene has another number of materials.
    pub(crate) fn set_materials(&self, context: &Context, scene: &Scene) -> Result<(), GpuError> {
        let new = materials(scene);
        if size_of_val(new.as_slice()) as u64 != self.materials.size() {
            return Err(GpuError::Option(String::from(
                "the scene has other materials than the picture; make the picture anew",
            )));
        }
        let bytes = bytemuck::cast_slice(&new);
        context.queue.write_buffer(&self.materials, 0, bytes);
        Ok(())
    }

    /// What the scene tells a view about its materials.
    pub(crate) fn tell(&self, view: &mut twins::View) {
        if self.scene.metals == MetalsAs::Diffuse {
            view.flags |= twins::VIEW_METALS_DIFFUSE;
        }
        view.max_reflectance = self.scene.max_reflectance;
    }

    /// A view together with what all passes read.
    pub(crate) fn bind(&self, context: &Context, passes: &Passes, view: twins::View) -> BindGroup {
        let device = &context.device;
        let buffer = filled(device, "view", &[view], BufferUsages::UNIFORM);
        let light = &self.light;
        let all = [
            &buffer,
            &self.materials,
            &light.element_light,
            &light.element_dims,
        ];
        let resources = all.map(Buffer::as_entire_binding);
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

    /// Draws all surfaces as they are lit: what hides first, then what lets light through from the farthest on.
    pub(crate) fn draw(
        &mut self,
        context: &Context,
        passes: &mut Passes,
        pass: &mut RenderPass<'_>,
        (pixels, filtering): (Pixels, TextureFiltering),
        camera: &Camera,
    ) {
        self.set_buffers(pass);
        let mut run = 0;
        while run < self.geometry.runs.len() {
            let of = self.geometry.runs[run].clone();
            if of.cover == Cover::Solid {
                let last = self.last_alike(run);
                self.set_run(context, passes, pass, run, Stage::Opaque, (pixels, filtering));
                let end = self.geometry.runs[last].indices.end;
                pass.draw_indexed(of.indices.start..end, 0, 0..1);
                run = last;
            }
            run += 1;
        }
        self.draw_layers(context, passes, pass, (pixels, filtering), camera);
    }

    /// Draws all solid surfaces with the pipeline and the bindings that are set.
    pub(crate) fn draw_solid(&self, pass: &mut RenderPass<'_>) {
        self.set_buffers(pass);
        let solid = self.geometry.runs.iter().filter(|run| run.cover == Cover::Solid);
        let end = solid.map(|run| run.indices.end).max().unwrap_or(0);
        pass.draw_indexed(0..end, 0, 0..1);
    }

    /// What the numbers of light mean.
    pub(crate) fn units(&self) -> Units {
        self.scene.units
    }

    /// The last of the neighbours of a solid run that one call can draw together with it.
    fn last_alike(&self, first: usize) -> usize {
        let runs = &self.geometry.runs;
        let is_alike = |&next: &usize| {
            let same_textures = runs[next].material == runs[first].material;
            runs[next].cover == Cover::Solid
                && self.kinds[next] == self.kinds[first]
                && (self.kinds[first] == Kind::Lit || same_textures)
        };
        (first + 1..runs.len())
            .take_while(is_alike)
            .last()
            .unwrap_or(first)
    }

    fn draw_layers(
        &mut self,
        context: &Context,
        passes: &mut Passes,
        pass: &mut RenderPass<'_>,
        how: (Pixels, TextureFiltering),
        camera: &Camera,
    ) {
        let layers = Layers::new(&self.geometry, camera);
        if layers.triangles.is_empty() {
            return;
        }
        let indices = layers.triangles.as_flattened();
        let buffer = filled(&context.device, "layers", indices, BufferUsages::INDEX);
        pass.set_index_buffer(buffer.slice(..), wgpu::IndexFormat::Uint32);
        for (run, range) in &layers.ranges {
            for stage in [Stage::Through, Stage::Own] {
                self.set_run(context, passes, pass, *run, stage, how);
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
        run: usize,
        stage: Stage,
        (pixels, filtering): (Pixels, TextureFiltering),
    ) {
        match self.kinds[run] {
            Kind::Lit => pass.set_pipeline(&passes.lit.pipeline(context, stage, pixels)),
            Kind::Textured => {
                let textured = &mut passes.textured;
                pass.set_pipeline(&textured.pipelines.pipeline(context, stage, pixels));
                let material = self.geometry.runs[run].material;
                let layout = &textured.layout;
                let textures = &mut self.textures;
                let bound = textures.of(context, layout, &self.scene, material, filtering);
                pass.set_bind_group(1, &bound, &[]);
            }
        }
    }
}
