//! Takes the maps that mirroring objects show.

use crate::behind::Behind;
use crate::draw::draw;
use crate::lens::Lens;
use crate::options::RenderOptions;
use crate::reflections::{Mirror, Mirrors, Reflections};
use crate::shade::{Light, Shader};
use crate::stage::Stage;
use core::f32::consts::FRAC_PI_2;
use glam::{Vec2, Vec3};
use hemicube_raster::environment::{
    Bounds, EnvironmentMap, EnvironmentPyramid, PrefilterOptions, PrefilteredEnvironment,
    Projection as Faces,
};
use hemicube_raster::{Image, Rgb};
use hemicube_scene::{Camera, Projection};
use std::collections::BTreeMap;

/// Samples in each direction of a map's pixel.
const SAMPLES: usize = 2;

/// Samples of each texel of a blurred map.
const BLUR_SAMPLES: u32 = 64;

/// Share of a map's pixels that must show surfaces for a scene to count as closed around an object.
const CLOSED: f32 = 0.9;

/// An object that mirrors: the box around its mirroring parts.
#[derive(Debug, Clone, Copy)]
struct Object {
    instance: usize,
    low: Vec3,
    high: Vec3,
}

impl Object {
    fn centre(&self) -> Vec3 {
        self.low.midpoint(self.high)
    }

    fn size(&self) -> f32 {
        self.low.distance(self.high)
    }
}

/// The maps of all mirroring objects; the largest objects have maps of their own.
pub(crate) fn capture(stage: &Stage<'_>, behind: Behind<'_>, wanted: &Reflections) -> Mirrors {
    let mirroring = wanted.mirroring_parts(stage);
    let mut objects = objects(stage, &mirroring);
    // The sort is stable: of equals the first in the scene.
    objects.sort_by(|a, b| b.size().total_cmp(&a.size()));
    let own = &objects[..objects.len().min(wanted.maps)];
    let mirrors: Vec<Mirror> = own
        .iter()
        .map(|object| mirror_of(stage, behind, wanted, object))
        .collect();
    let nearest = |at: Vec3| {
        let distance = |m: &Mirror| m.position.distance_squared(at);
        let of = |(i, m): (usize, &Mirror)| (i, distance(m));
        let numbered = mirrors.iter().enumerate().map(of);
        numbered.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
    };
    let map_of: BTreeMap<usize, Option<usize>> = objects
        .iter()
        .enumerate()
        .map(|(i, object)| {
            let map = if i < mirrors.len() {
                Some(i)
            } else {
                nearest(object.centre())
            };
            (object.instance, map)
        })
        .collect();
    let parts = stage.drawn.parts.iter().zip(&mirroring);
    let of_part = parts.map(|(part, &mirrors)| {
        let map = map_of.get(&part.instance).copied().flatten();
        map.filter(|_| mirrors)
    });
    Mirrors {
        of_parts: of_part.collect(),
        mirrors,
    }
}

/// The mirroring objects in the order of the scene.
fn objects(stage: &Stage<'_>, mirroring: &[bool]) -> Vec<Object> {
    let mut found: BTreeMap<usize, Object> = BTreeMap::new();
    let parts = stage.drawn.parts.iter().zip(mirroring);
    for (part, _) in parts.filter(|(_, mirrors)| **mirrors) {
        let object = found.entry(part.instance).or_insert(Object {
            instance: part.instance,
            low: Vec3::INFINITY,
            high: Vec3::NEG_INFINITY,
        });
        for &corner in part.triangles.iter().flatten() {
            let position = stage.drawn.positions[corner as usize];
            (object.low, object.high) = (object.low.min(position), object.high.max(position));
        }
    }
    found.into_values().collect()
}

/// What is seen from the middle of an object that is not there.
fn mirror_of(
    stage: &Stage<'_>,
    behind: Behind<'_>,
    wanted: &Reflections,
    object: &Object,
) -> Mirror {
    let eye = object.centre();
    let faces: Vec<Image<Rgb>> = (0..6)
        .map(|face| {
            face_picture(
                stage,
                behind,
                wanted.resolution,
                &face_camera(eye, face),
                object.instance,
            )
        })
        .collect();
    let map = EnvironmentMap::new(Faces::Cube, &faces).expect("six finite squares of one size");
    let options = PrefilterOptions::default()
        .with_rows(wanted.resolution)
        .with_samples(BLUR_SAMPLES);
    let room = (wanted.box_projected && is_closed(stage, eye)).then(|| {
        let (low, high) = stage.bounds();
        Bounds { low, high }
    });
    Mirror {
        position: eye,
        map: PrefilteredEnvironment::new(&EnvironmentPyramid::new(map), &options),
        room,
    }
}

fn face_picture(
    stage: &Stage<'_>,
    behind: Behind<'_>,
    side: usize,
    camera: &Camera,
    without: usize,
) -> Image<Rgb> {
    let options = RenderOptions::default()
        .with_size(side, side)
        .with_samples(SAMPLES);
    let lens = Lens::new(camera, side, side);
    let shader = Shader::new(stage, Light::Gouraud, lens, 1.0 / SAMPLES as f64).with_behind(behind);
    draw(
        &shader,
        camera,
        &options,
        Some(without),
        |radiance| radiance,
        |_| {},
    )
}

/// A camera whose square picture is a face of the cube of [`Faces::Cube`], by its number.
pub fn face_camera(eye: Vec3, face: usize) -> Camera {
    let towards = |s: f32, t: f32| Faces::Cube.direction(face, Vec2::new(s, t));
    Camera {
        name: String::from("face"),
        eye,
        forward: towards(0.5, 0.5),
        up: (towards(0.5, 0.25) - towards(0.5, 0.75)).normalize(),
        projection: Projection::Perspective {
            vertical_fov: FRAC_PI_2,
            aspect: None,
        },
    }
}

/// Whether rays from a point in all directions mostly meet something.
fn is_closed(stage: &Stage<'_>, point: Vec3) -> bool {
    const RAYS: u16 = 512;
    let visibility = stage.solution.mesh().visibility();
    // Directions of the golden spiral.
    let direction = |i: u16| {
        let z = 1.0 - (2.0 * f32::from(i) + 1.0) / f32::from(RAYS);
        let turn = 2.399_963_2 * f32::from(i);
        let radius = (1.0 - z * z).sqrt();
        Vec3::new(radius * turn.cos(), radius * turn.sin(), z)
    };
    let meets = |&i: &u16| {
        visibility
            .first_hit(point, direction(i), f32::INFINITY)
            .is_some()
    };
    let count = (0..RAYS).filter(meets).count();
    count as f32 >= CLOSED * f32::from(RAYS)
}
