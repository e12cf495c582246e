//! Scenes from named surfaces of the reference data, and exact factors between them.

use crate::shapes::Facet;
use core::f64::consts::PI;
use glam::{Affine3A, DVec3, Vec3};
use hemicube::radiosity::form_factor::{ViewFactorMatrix, analytic};
use hemicube::raster::Rgb;
use hemicube::scene::{Face, Instance, Light, LightKind, Material, Mesh, Scene, Units};

/// A surface of one reflectance and exitance.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Its name, which becomes that of the scene's node.
    pub name: String,
    /// Its parts: planar polygons, convex or not.
    pub facets: Vec<Facet>,
    /// Diffuse reflectance.
    pub reflectance: f64,
    /// Emitted exitance.
    pub exitance: f64,
}

impl Surface {
    /// A surface of facets.
    pub fn new(
        name: impl Into<String>,
        facets: Vec<Facet>,
        reflectance: f64,
        exitance: f64,
    ) -> Self {
        Self {
            name: name.into(),
            facets,
            reflectance,
            exitance,
        }
    }

    /// Surfaces of a list `[{ "id", "verts", "rho", "exitance" }]`; exitance 0 where there is none.
    pub fn list(json: &serde_json::Value) -> Vec<Self> {
        let surfaces = json.as_array().expect("a list of surfaces").iter();
        let surface = |entry: &serde_json::Value| {
            Self::new(
                entry["id"].as_str().expect("surfaces have a name"),
                vec![corners(&entry["verts"])],
                entry["rho"].as_f64().expect("surfaces have a reflectance"),
                entry["exitance"].as_f64().unwrap_or(0.0),
            )
        };
        surfaces.map(surface).collect()
    }

    /// Area of all facets.
    pub fn area(&self) -> f64 {
        self.facets.iter().map(|f| analytic::area(f)).sum()
    }
}

/// The corners of a polygon of the reference data.
pub fn corners(json: &serde_json::Value) -> Facet {
    let corners = json.as_array().expect("a list of corners").iter();
    corners.map(vector).collect()
}

/// Three numbers of the reference data.
pub fn vector(json: &serde_json::Value) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|i| json[i].as_f64().expect("three numbers")))
}

/// The scenes' +Y up for the reference data's +z up; also narrows to f32.
pub fn y_up(v: DVec3) -> Vec3 {
    DVec3::new(v.x, v.z, -v.y).as_vec3()
}

/// A scene of surfaces, each a mesh and a node of its own, in photometric units and +Y up.
pub fn scene(name: &str, surfaces: &[Surface]) -> Scene {
    let mut scene = Scene {
        name: name.into(),
        units: Units::Photometric,
        max_reflectance: 1.0,
        ..Scene::default()
    };
    for surface in surfaces {
        add(&mut scene, surface, false);
    }
    scene
}

/// Adds a surface whose sides both absorb everything.
pub fn add_absorber(scene: &mut Scene, name: &str, facets: Vec<Facet>) {
    add(scene, &Surface::new(name, facets, 0.0, 0.0), true);
}

/// Adds a point light of so many lumens in all directions.
pub fn add_point_light(scene: &mut Scene, place: DVec3, flux: f64) {
    scene.lights.push(Light {
        name: String::from("point"),
        kind: LightKind::Point {
            position: y_up(place),
            intensity: Rgb::splat(to_f32(flux / (4.0 * PI))),
        },
    });
}

fn add(scene: &mut Scene, surface: &Surface, double_sided: bool) {
    let radiance = Rgb::splat(to_f32(surface.exitance / PI));
    let reflectance = Rgb::splat(to_f32(surface.reflectance));
    scene.materials.push(Material {
        double_sided,
        ..Material::diffuse(surface.name.clone(), reflectance).with_emission(radiance)
    });
    let mut mesh = Mesh {
        name: surface.name.clone(),
        material: scene.materials.len() - 1,
        ..Mesh::default()
    };
    for facet in &surface.facets {
        let first = u32::try_from(mesh.positions.len()).expect("few corners");
        mesh.positions.extend(facet.iter().map(|&c| y_up(c)));
        mesh.faces
            .extend(faces(facet).iter().map(|face| match *face {
                Face::Triangle(corners) => Face::Triangle(corners.map(|c| first + c)),
                Face::Quad(corners) => Face::Quad(corners.map(|c| first + c)),
            }));
    }
    scene.instances.push(Instance {
        node: surface.name.clone(),
        mesh: scene.meshes.len(),
        world_from_mesh: Affine3A::IDENTITY,
        flipped: false,
    });
    scene.meshes.push(mesh);
}

/// A polygon's faces: itself if it is a triangle or a convex quad, else triangles.
fn faces(polygon: &[DVec3]) -> Vec<Face> {
    match polygon.len() {
        3 => return vec![Face::Triangle([0, 1, 2])],
        4 if is_convex(polygon) => return vec![Face::Quad([0, 1, 2, 3])],
        _ => {}
    }
    let (x, y) = analytic::vector_area(polygon)
        .normalize()
        .any_orthonormal_pair();
    let flat = polygon.iter().map(|p| [p.dot(x), p.dot(y)]);
    let mut triangles: Vec<u32> = Vec::new();
    earcut::Earcut::new().earcut(flat, &[], &mut triangles);
    let normal = analytic::vector_area(polygon);
    let triangle = |&[a, b, c]: &[u32; 3]| {
        let at = |i: u32| polygon[i as usize];
        let is_front = (at(b) - at(a)).cross(at(c) - at(a)).dot(normal) > 0.0;
        Face::Triangle(if is_front { [a, b, c] } else { [a, c, b] })
    };
    triangles.as_chunks::<3>().0.iter().map(triangle).collect()
}

fn is_convex(polygon: &[DVec3]) -> bool {
    let normal = analytic::vector_area(polygon);
    let n = polygon.len();
    (0..n).all(|i| {
        let (a, b, c) = (polygon[i], polygon[(i + 1) % n], polygon[(i + 2) % n]);
        (b - a).cross(c - b).dot(normal) > 0.0
    })
}

/// Exact factors between surfaces that hide nothing from each other.
pub fn exact_matrix(surfaces: &[Surface]) -> ViewFactorMatrix {
    let areas: Vec<f64> = surfaces.iter().map(Surface::area).collect();
    let names = surfaces.iter().map(|s| s.name.clone()).collect();
    let mut factors = Vec::new();
    for (from, area) in surfaces.iter().zip(&areas) {
        for to in surfaces {
            factors.push((exchange_area(&from.facets, &to.facets) / area).min(1.0));
        }
    }
    ViewFactorMatrix::from_rows(areas, names, &factors).expect("the factors are possible")
}

/// `A_a F_ab` of two surfaces that hide nothing from each other or from themselves.
pub fn exchange_area(a: &[Facet], b: &[Facet]) -> f64 {
    let pairs = a.iter().flat_map(|a| b.iter().map(move |b| (a, b)));
    pairs.map(|(a, b)| analytic::exchange_area(a, b)).sum()
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "scenes hold their light in f32"
)]
fn to_f32(x: f64) -> f32 {
    x as f32
}
