//! All pipelines of pictures.

use crate::context::Context;
use crate::pass::antialias::FilterPass;
use crate::pass::bump::BumpPass;
use crate::pass::cube::CubePass;
use crate::pass::environment::EnvironmentPass;
use crate::pass::falsecolour::FalseColourPass;
use crate::pass::light::LightPass;
use crate::pass::lit::{SurfacePass, scene_layout};
use crate::pass::metering::MeterPass;
use crate::pass::overlay::OverlayPass;
use crate::pass::pick::PickPass;
use crate::pass::surroundings::SurroundingsPass;
use crate::pass::textured::TexturedPass;
use crate::pass::tonemap::TonePass;
use wgpu::BindGroupLayout;

/// All pipelines of pictures, each made at its first use.
#[derive(Debug)]
pub(crate) struct Passes {
    pub(crate) scene: BindGroupLayout,
    pub(crate) light: LightPass,
    pub(crate) meter: MeterPass,
    pub(crate) lit: SurfacePass,
    pub(crate) textured: TexturedPass,
    pub(crate) bump: BumpPass,
    pub(crate) environment: EnvironmentPass,
    pub(crate) surroundings: SurroundingsPass,
    pub(crate) cube: CubePass,
    pub(crate) falsecolour: FalseColourPass,
    pub(crate) overlay: OverlayPass,
    pub(crate) tones: TonePass,
    pub(crate) filter: FilterPass,
    pub(crate) pick: PickPass,
}

impl Passes {
    pub(crate) fn new(context: &Context) -> Self {
        let scene = scene_layout(context);
        let textured = TexturedPass::new(context, &scene);
        let bump = BumpPass::new(context, &scene, &textured.layout);
        let environment = EnvironmentPass::new(context, &scene, &textured.layout, &bump.layout);
        Self {
            light: LightPass::new(context),
            meter: MeterPass::new(context),
            lit: SurfacePass::lit(&scene),
            textured,
            bump,
            environment,
            surroundings: SurroundingsPass::new(context),
            cube: CubePass::new(context),
            falsecolour: FalseColourPass::new(context, &scene),
            overlay: OverlayPass::new(context, &scene),
            tones: TonePass::new(context),
            filter: FilterPass::new(context),
            pick: PickPass::new(&scene),
            scene,
        }
    }
}
