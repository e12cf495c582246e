//! Choosing a way to form factors by its name.

use crate::error::RadiosityError;
use crate::form_factor::hemicube::{Hemicube, HemicubeOptions, Projection};
use crate::form_factor::{
    Analytic, AnalyticOptions, FormFactors, Hemisphere, HemisphereOptions, Nusselt, NusseltOptions,
    RayCast, RayCastOptions,
};
use crate::patch::PatchMesh;
use std::sync::Arc;

/// Ways to form factors, by their names on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FormFactorKind {
    /// Rays, between pairs or over the hemisphere.
    #[default]
    RayCast,
    /// Closed forms, quadrature and exact shadows.
    Analytic,
    /// Item buffers on the faces of a half cube.
    Hemicube,
    /// Item buffers on the three triangles of a cube's corner, with the options of the hemicube.
    CubicTetrahedron,
    /// An item buffer on a wide square, with the options of the hemicube.
    SinglePlane,
    /// Rays through cells of equal form factor.
    Hemisphere,
    /// Exact factors of points of the patch, times what rays see.
    Nusselt,
}

/// What the ways to form factors need to know; each looks at its own part.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FormFactorOptions {
    /// Error of analytic factors.
    pub analytic: AnalyticOptions,
    /// Rays, how they are spent, and the seed of all sampling.
    pub raycast: RayCastOptions,
    /// Resolution and number of hemicubes.
    pub hemicube: HemicubeOptions,
    /// Cells and number of hemispheres; their seed is that of the rays.
    pub hemisphere: HemisphereOptions,
    /// Number of points and rays of Nusselt's analog; its seed is that of the rays.
    pub nusselt: NusseltOptions,
}

impl FormFactorKind {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::RayCast,
        Self::Analytic,
        Self::Hemicube,
        Self::CubicTetrahedron,
        Self::SinglePlane,
        Self::Hemisphere,
        Self::Nusselt,
    ];

    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::RayCast => "raycast",
            Self::Analytic => "analytic",
            Self::Hemicube => "hemicube",
            Self::CubicTetrahedron => "cubic-tetrahedron",
            Self::SinglePlane => "single-plane",
            Self::Hemisphere => "hemisphere",
            Self::Nusselt => "nusselt",
        }
    }

    /// The form factors of a mesh.
    ///
    /// # Errors
    /// Options out of their range.
    pub fn build(
        self,
        mesh: Arc<PatchMesh>,
        options: &FormFactorOptions,
    ) -> Result<Box<dyn FormFactors>, RadiosityError> {
        let seed = options.raycast.seed;
        let item_buffers = |projection| -> Result<Box<dyn FormFactors>, RadiosityError> {
            let options = options.hemicube.with_projection(projection);
            Ok(Box::new(Hemicube::new(mesh.clone(), options)?))
        };
        Ok(match self {
            Self::RayCast => Box::new(RayCast::new(mesh, options.raycast)),
            Self::Analytic => Box::new(Analytic::new(mesh, options.analytic)?),
            Self::Hemicube => item_buffers(Projection::Hemicube)?,
            Self::CubicTetrahedron => item_buffers(Projection::CubicTetrahedron)?,
            Self::SinglePlane => item_buffers(Projection::SinglePlane)?,
            Self::Hemisphere => {
                Box::new(Hemisphere::new(mesh, options.hemisphere.with_seed(seed))?)
            }
            Self::Nusselt => Box::new(Nusselt::new(mesh, options.nusselt.with_seed(seed))?),
        })
    }
}
