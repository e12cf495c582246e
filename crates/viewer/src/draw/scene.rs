//! A scene on its way to the window's device.
//!
//! Buffers, textures and pipelines take their time: seconds for a large scene where the processor draws. They are made on
//! a thread of their own, which also draws a first small picture, because drivers finish pipelines when they are first
//! used. The window has the scene from then on.

use crate::draw::SHOWN;
use crate::draw::light::StageLight;
use hemicube_gpu::pass::{DrawOptions, Target, Walkthrough};
use hemicube_gpu::{Context, GpuError};
use hemicube_radiosity::{PatchMesh, Solution};
use hemicube_scene::Camera;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use wgpu::{TextureUsages, TextureViewDescriptor};

/// Pixels of a side of the first picture.
const SMALL: u32 = 32;

/// A scene on the device.
pub struct OnStage {
    pub walkthrough: Walkthrough,
    pub geometry: u64,
    /// Light groups that it was made for.
    pub groups: usize,
    /// The mesh whose materials are there.
    pub mesh: Arc<PatchMesh>,
    /// Whether its textures are there, too.
    pub is_textured: bool,
    /// The light that pictures are made of.
    pub light: StageLight,
    /// The light that mirrors show; none if nothing mirrors yet.
    pub mirrored: Option<u64>,
}

/// What a scene is put on the device for.
pub struct Order {
    pub context: Arc<Context>,
    pub solution: Arc<Solution>,
    pub geometry: u64,
    /// The ways in which it will be drawn first.
    pub options: Vec<DrawOptions>,
    pub camera: Camera,
}

/// A scene that is on its way.
pub struct Coming {
    /// Which.
    pub geometry: u64,
    pub groups: usize,
    result: Receiver<Result<OnStage, GpuError>>,
}

impl Order {
    /// Begins to put the scene on the device; `wake` is called when that is done.
    pub fn start(self, wake: impl Fn() + Send + 'static) -> Coming {
        let (sender, result) = channel();
        let (geometry, groups) = (self.geometry, self.solution.groups().len());
        let work = move || {
            // Nobody may want it any more.
            let _ = sender.send(self.fulfil());
            wake();
        };
        std::thread::Builder::new()
            .name(String::from("stage"))
            .spawn(work)
            .expect("a thread can be started");
        Coming {
            geometry,
            groups,
            result,
        }
    }

    fn fulfil(self) -> Result<OnStage, GpuError> {
        let mut walkthrough = Walkthrough::new(self.context.clone(), &self.solution)?;
        for options in &self.options {
            draw_small(&self.context, &mut walkthrough, &self.camera, options)?;
        }
        Ok(OnStage {
            walkthrough,
            geometry: self.geometry,
            groups: self.solution.groups().len(),
            mesh: self.solution.mesh().clone(),
            is_textured: true,
            light: StageLight::default(),
            mirrored: None,
        })
    }
}

impl Coming {
    /// The scene, once it is there; `None` while it is on its way.
    pub fn take(&self) -> Option<Result<OnStage, GpuError>> {
        match self.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(GpuError::Option(String::from(
                "putting the scene on the device broke, which is a bug: please report it",
            )))),
        }
    }
}

/// A picture that nobody sees.
fn draw_small(
    context: &Context,
    walkthrough: &mut Walkthrough,
    camera: &Camera,
    options: &DrawOptions,
) -> Result<(), GpuError> {
    let texture = context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("first picture"),
        size: wgpu::Extent3d {
            width: SMALL,
            height: SMALL,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: SHOWN,
        usage: TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let view = texture.create_view(&TextureViewDescriptor::default());
    let target = Target {
        view: &view,
        format: SHOWN,
        size: [SMALL; 2],
    };
    let descriptor = wgpu::CommandEncoderDescriptor {
        label: Some("first picture"),
    };
    let mut encoder = context.device.create_command_encoder(&descriptor);
    walkthrough.draw(&mut encoder, target, camera, options)?;
    context.queue.submit([encoder.finish()]);
    context.wait()
}
