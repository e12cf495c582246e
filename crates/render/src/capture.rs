//! Takes the maps that mirroring objects show.

use crate::behind::Behind;
use crate::draw::draw;
use crate::error::RenderError;
use crate::lens::Lens;
use crate::options::RenderOptions;
use crate::reflections::{Mirror, Mirrors, Reflections};
use crate::shade::{Light, Shader};
use crate::stage::Stage;
use core::f32::consts::FRAC_PI_2;
use glam::{Vec2, Vec3};
use hemicube_radiosity::Solution;
use hemicube_raster::environment::{
    EnvironmentMap, EnvironmentPyramid, PrefilterOptions, PrefilteredEnvironment,
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

/// Which objects get maps, where they are taken, and which parts show which.
#[derive(Debug, Clone, Default)]
pub struct MirrorPlan {
    /// For each part of the drawn mesh the number of the map that it shows, if it mirrors.
    pub of_parts: Vec<Option<usize>>,
    /// Where maps are taken.
    pub sites: Vec<MirrorSite>,
}

/// Where a map is taken.
#[derive(Debug, Clone, Copy)]
pub struct MirrorSite {
    /// The scene's instance that mirrors; the map does not show it.
    pub instance: usize,
    /// The middle of its mirroring parts.
    pub position: Vec3,
    /// The box that stands for what the map shows, in a scene that is closed around the object.
    pub room: Option<(Vec3, Vec3)>,
}

impl MirrorPlan {
    /// What is wanted of a solution's scene.
    ///
    /// # Errors
    /// A name that nothing has, maps of an impossible size; one line.
    pub fn new(solution: &Solution, wanted: &Reflections) -> Result<Self, RenderError> {
        wanted.check(solution.mesh().scene())?;
        let stage = Stage::new(solution, &RenderOptions::default());
        Ok(Self::of_stage(&stage, wanted))
    }

    /// The largest objects have maps of their own, others show the nearest.
    fn of_stage(stage: &Stage<'_>, wanted: &Reflections) -> Self {
        let mirroring = wanted.mirroring_parts(stage);
        let mut objects = objects(stage, &mirroring);
        // The sort is stable: of equals the first in the scene.
        objects.sort_by(|a, b| b.size().total_cmp(&a.size()));
        let own = &objects[..objects.len().min(wanted.maps)];
        let sites: Vec<MirrorSite> = own.iter().map(|o| site_of(stage, wanted, o)).collect();
        let nearest = |at: Vec3| {
            let distance = |site: &MirrorSite| site.position.distance_squared(at);
            let of = |(i, site): (usize, &MirrorSite)| (i, distance(site));
            let numbered = sites.iter().enumerate().map(of);
            numbered.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
        };
        let map_of: BTreeMap<usize, Option<usize>> = objects
            .iter()
            .enumerate()
            .map(|(i, object)| {
                let map = if i < sites.len() {
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
        Self {
            of_parts: of_part.collect(),
            sites,
        }
    }
}

fn site_of(stage: &Stage<'_>, wanted: &Reflections, object: &Object) -> MirrorSite {
    let position = object.centre();
    let has_room = wanted.box_projected && is_closed(stage, position);
    MirrorSite {
        instance: object.instance,
        position,
        room: has_room.then(|| stage.bounds()),
    }
}

/// The maps of all mirroring objects.
pub(crate) fn capture(stage: &Stage<'_>, behind: Behind<'_>, wanted: &Reflections) -> Mirrors {
    let plan = MirrorPlan::of_stage(stage, wanted);
    let mirror = |site: &MirrorSite| mirror_of(stage, behind, wanted, site);
    Mirrors {
        mirrors: plan.sites.iter().map(mirror).collect(),
        of_parts: plan.of_parts,
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
    site: &MirrorSite,
) -> Mirror {
    let eye = site.position;
    let faces: Vec<Image<Rgb>> = (0..6)
        .map(|face| {
            face_picture(
                stage,
                behind,
                wanted.resolution,
                &face_camera(eye, face),
                site.instance,
            )
        })
        .collect();
    let map = EnvironmentMap::new(Faces::Cube, &faces).expect("six finite squares of one size");
    let options = PrefilterOptions::default()
        .with_rows(wanted.resolution)
        .with_samples(BLUR_SAMPLES);
    Mirror {
        position: eye,
        map: PrefilteredEnvironment::new(&EnvironmentPyramid::new(map), &options),
        room: site.room,
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

/// A camera at a place whose square picture is a face of a cube map.
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
