//! A solution made ready to be drawn from any camera.

use crate::options::{RenderOptions, TextureFilter};
use crate::sight::SurfaceHit;
use crate::tangents::Tangents;
use crate::tilt::TiltedLight;
use core::ops::Range;
use glam::Vec3;
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
    /// For each element the first of its triangles.
    first_triangles: Vec<u32>,
    /// Irradiance that is added everywhere, also to the elements' own values.
    pub extra: Rgb,
    /// For each element what dimming makes of its emission.
    pub dims: Vec<Rgb>,
    /// Radiance where nothing is drawn.
    pub behind: Rgb,
    /// How textures are read.
    pub filter: TextureFilter,
    /// Of triangles with a relief.
    pub tangents: Tangents,
    /// Light for tilted normals, if any surface has a relief.
    pub tilted: Option<TiltedLight<'a>>,
    /// For each vertex one of its elements.
    elements_of_vertices: Vec<u32>,
}

impl<'a> Stage<'a> {
    pub fn new(solution: &'a Solution, options: &RenderOptions) -> Self {
        let extra = extra_irradiance(solution, options);
        let drawn = DrawnMesh::new(solution, extra);
        let scene = solution.mesh().scene();
        let triangles = triangles(&drawn, scene);
        Self {
            first_triangles: first_triangles(&triangles, solution.mesh().elements().len()),
            dims: emission_dims(solution),
            behind: behind(solution, options),
            filter: options.texture_filter,
            tangents: Tangents::new(solution.mesh(), &drawn),
            tilted: has_relief(&drawn, scene)
                .then(|| TiltedLight::new(solution, drawn.positions.len())),
            elements_of_vertices: elements_of_vertices(&triangles, drawn.positions.len()),
            triangles,
            solution,
            drawn,
            extra,
        }
    }

    /// The triangle of a hit.
    pub fn triangle(&self, hit: &SurfaceHit) -> &StageTriangle {
        &self.triangles[hit.triangle as usize]
    }

    /// The scene's material at a hit.
    pub fn material_of(&self, hit: &SurfaceHit) -> usize {
        self.drawn.parts[self.triangle(hit).part as usize].material
    }

    /// The scene's instance to which a triangle belongs.
    pub fn instance_of(&self, triangle: &StageTriangle) -> usize {
        self.drawn.parts[triangle.part as usize].instance
    }

    /// The triangles of an element, one after the other.
    pub fn triangles_of(&self, element: usize) -> Range<usize> {
        let first = self.first_triangles[element] as usize;
        let element = index32(element);
        let same = |t: &&StageTriangle| t.element == element;
        first..first + self.triangles[first..].iter().take_while(same).count()
    }

    /// The box around everything that is drawn.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let positions = self.drawn.positions.iter();
        positions.fold(nothing, |(low, high), &p| (low.min(p), high.max(p)))
    }

    /// Radiosity of the surface itself at a vertex.
    pub fn own_radiosity(&self, vertex: usize) -> Rgb {
        let element = self.elements_of_vertices[vertex] as usize;
        let reflectance = self.solution.mesh().reflectance()[element];
        self.solution.element_exitance(element) + reflectance * self.drawn.irradiance[vertex]
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

/// For each element the first of its triangles; they are neighbours, all elements have some.
fn first_triangles(triangles: &[StageTriangle], elements: usize) -> Vec<u32> {
    let mut first = vec![0; elements];
    for (number, triangle) in triangles.iter().enumerate().rev() {
        first[triangle.element as usize] = index32(number);
    }
    first
}

fn has_relief(drawn: &DrawnMesh, scene: &Scene) -> bool {
    let parts = &drawn.parts;
    parts
        .iter()
        .any(|p| scene.materials[p.material].relief.is_some())
}

fn elements_of_vertices(triangles: &[StageTriangle], vertices: usize) -> Vec<u32> {
    let mut elements = vec![0; vertices];
    for triangle in triangles {
        for vertex in triangle.corners {
            elements[vertex as usize] = triangle.element;
        }
    }
    elements
}

fn index32(index: usize) -> u32 {
    u32::try_from(index).expect("fewer than 2^32 triangles")
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
