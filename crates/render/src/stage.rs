//! A solution made ready to be drawn from any camera.

use crate::options::RenderOptions;
use hemicube_radiosity::solve::ambient::ambient_irradiance;
use hemicube_radiosity::{DrawnMesh, Solution, SolverKind};
use hemicube_raster::Rgb;
use hemicube_scene::{AlphaMode, Material, Scene};

/// How a triangle's material takes part in visibility.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cover {
    /// Hides what is behind.
    Opaque,
    /// Hides what is behind except in holes.
    Mask,
    /// Lets light through.
    Transparent,
}

impl Cover {
    fn of(material: &Material) -> Self {
        match material.alpha_mode {
            _ if material.transmission > 0.0 => Self::Transparent,
            AlphaMode::Blend => Self::Transparent,
            AlphaMode::Mask { .. } => Self::Mask,
            AlphaMode::Opaque => Self::Opaque,
        }
    }
}

/// A triangle to draw.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StageTriangle {
    /// Vertices of the drawn mesh, counter-clockwise seen from the lit side.
    pub corners: [u32; 3],
    /// Index into the drawn mesh's parts.
    pub part: u32,
    /// Position among the mesh's elements.
    pub element: u32,
    /// How it covers.
    pub cover: Cover,
}

/// A solution made ready to be drawn.
#[derive(Debug)]
pub(crate) struct Stage<'a> {
    pub solution: &'a Solution,
    pub drawn: DrawnMesh,
    /// All triangles in the order of the drawn mesh.
    pub triangles: Vec<StageTriangle>,
    /// Irradiance that is added everywhere, also to the elements' own values.
    pub extra: Rgb,
    /// For each element what dimming makes of its emission.
    pub dims: Vec<Rgb>,
    /// Radiance where nothing is drawn.
    pub behind: Rgb,
}

impl<'a> Stage<'a> {
    pub fn new(solution: &'a Solution, options: &RenderOptions) -> Self {
        let extra = extra_irradiance(solution, options);
        let drawn = DrawnMesh::new(solution, extra);
        let scene = solution.mesh().scene();
        Self {
            triangles: triangles(&drawn, scene),
            dims: emission_dims(solution),
            behind: behind(solution, options),
            solution,
            drawn,
            extra,
        }
    }

    pub fn scene(&self) -> &Scene {
        self.solution.mesh().scene()
    }
}

/// The ambient estimate, for solutions that were made with it.
fn extra_irradiance(solution: &Solution, options: &RenderOptions) -> Rgb {
    let wanted = SolverKind::AmbientShooting.name();
    if options.ambient && solution.provenance.solver == wanted {
        ambient_irradiance(solution)
    } else {
        Rgb::BLACK
    }
}

fn triangles(drawn: &DrawnMesh, scene: &Scene) -> Vec<StageTriangle> {
    let of_part = |(number, part): (u32, &hemicube_radiosity::drawn::DrawnPart)| {
        let cover = Cover::of(&scene.materials[part.material]);
        let triangles = part.triangles.iter().zip(&part.elements);
        let staged = triangles.map(|(&corners, &element)| StageTriangle {
            corners,
            part: number,
            element,
            cover,
        });
        staged.collect::<Vec<_>>()
    };
    (0..).zip(&drawn.parts).flat_map(of_part).collect()
}

/// Dimmed by undimmed exitance; 1 where an element emits nothing.
fn emission_dims(solution: &Solution) -> Vec<Rgb> {
    let dim = |(e, emission): (usize, &Rgb)| {
        let dimmed = solution.element_exitance(e);
        let ratio = |band: usize| {
            if emission[band] > 0.0 {
                dimmed[band] / emission[band]
            } else {
                1.0
            }
        };
        Rgb::new(ratio(0), ratio(1), ratio(2))
    };
    let emission = solution.mesh().emission();
    emission.iter().enumerate().map(dim).collect()
}

/// The sky, dimmed with its group, or the options' background, or black.
fn behind(solution: &Solution, options: &RenderOptions) -> Rgb {
    let sky = solution.mesh().scene().sky;
    if sky.is_black() {
        return options.background.unwrap_or(Rgb::BLACK);
    }
    let dim = solution
        .groups()
        .last()
        .map_or(Rgb::WHITE, |group| group.dim);
    sky * dim
}
