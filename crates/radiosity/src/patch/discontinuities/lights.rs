//! What casts shadows with borders: lamps by their corners and edges, points, the sun.

use super::outlines::Outlines;
use crate::patch::face::WorldFace;
use glam::DVec3;
use hemicube_scene::{LightKind, Scene};
use std::collections::BTreeMap;

/// Corners above which a lamp is left out: its penumbra has no sharp borders.
const MOST_CORNERS: usize = 24;
/// Distance of the sun over the scene's diameter: its rays are parallel to a ten-thousandth.
const SUN: f64 = 1e4;
/// Sine of the angle between edges or normals that count as in line.
const STRAIGHT: f64 = 1e-3;

/// Something that casts shadows.
#[derive(Debug, Clone)]
pub struct Lamp {
    /// Its corners; one of a point or the sun.
    pub corners: Vec<DVec3>,
    /// Its edges, as pairs of corners.
    pub edges: Vec<[DVec3; 2]>,
    /// Direction into which a flat lamp shines; zero if it shines everywhere.
    pub normal: DVec3,
    /// What it sends out, in no particular unit: lamps are taken by it.
    pub power: f64,
}

impl Lamp {
    /// Mean of the corners.
    pub fn centre(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / self.corners.len() as f64
    }

    /// Largest distance between corners.
    pub fn size(&self) -> f64 {
        let pairs = self
            .corners
            .iter()
            .flat_map(|a| self.corners.iter().map(|b| a.distance(*b)));
        pairs.fold(0.0, f64::max)
    }

    /// Whether it shines towards a point.
    pub fn faces(&self, point: DVec3) -> bool {
        self.normal == DVec3::ZERO || (point - self.centre()).dot(self.normal) > 0.0
    }
}

/// The lamps of a scene, the strongest first, and how many were left out.
pub fn lamps(scene: &Scene, outlines: &Outlines<'_>, faces: &[WorldFace]) -> (Vec<Lamp>, usize) {
    let mut lamps: Vec<Lamp> = flat_lamps(scene, outlines, faces);
    let all = lamps.len();
    lamps.retain(|lamp| lamp.corners.len() <= MOST_CORNERS);
    let left_out = all - lamps.len();
    lamps.extend(
        scene
            .lights
            .iter()
            .map(|light| point_lamp(&light.kind, faces)),
    );
    // Stable: of lamps that are alike the earlier one comes first.
    lamps.sort_by(|a, b| b.power.total_cmp(&a.power));
    (lamps, left_out)
}

fn point_lamp(light: &LightKind, faces: &[WorldFace]) -> Lamp {
    let (at, strength) = match *light {
        LightKind::Point {
            position,
            intensity,
        }
        | LightKind::Spot {
            position,
            intensity,
            ..
        } => (position.as_dvec3(), intensity),
        LightKind::Directional {
            direction,
            irradiance,
            ..
        } => {
            let (centre, diameter) = bounds(faces);
            let at = centre - direction.as_dvec3() * (SUN * diameter);
            (at, irradiance)
        }
    };
    Lamp {
        corners: vec![at],
        edges: Vec::new(),
        normal: DVec3::ZERO,
        // Its borders are the sharpest: no penumbra softens them.
        power: 1e6 * f64::from(strength.max_band()),
    }
}

fn bounds(faces: &[WorldFace]) -> (DVec3, f64) {
    let corners = faces
        .iter()
        .flat_map(WorldFace::polygon)
        .map(|p| p.as_dvec3());
    let (low, high) = corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
        (low.min(p), high.max(p))
    });
    ((low + high) * 0.5, low.distance(high))
}

/// Emitting faces; those of one material that go on in one plane are one lamp.
fn flat_lamps(scene: &Scene, outlines: &Outlines<'_>, faces: &[WorldFace]) -> Vec<Lamp> {
    let emits = |face: u32| scene.materials[faces[face as usize].material as usize].emits();
    let is_one = |a: u32, b: u32| {
        let (a, b) = (&faces[a as usize], &faces[b as usize]);
        a.material == b.material
            && f64::from(a.normal.cross(b.normal).length()) < STRAIGHT
            && a.normal.dot(b.normal) > 0.0
    };
    let mut lamp_of: BTreeMap<u32, u32> = BTreeMap::new();
    for face in (0..faces.len())
        .map(crate::index32)
        .filter(|&face| emits(face))
    {
        lamp_of.insert(face, face);
    }
    // Faces of one lamp get the lowest number among them.
    let inner: Vec<[u32; 2]> = outlines
        .edges
        .iter()
        .filter_map(|edge| match edge.faces[..] {
            [(a, _), (b, _)] if emits(a) && emits(b) && is_one(a, b) => Some([a, b]),
            _ => None,
        })
        .collect();
    let root = |lamp_of: &BTreeMap<u32, u32>, mut face: u32| {
        while lamp_of[&face] != face {
            face = lamp_of[&face];
        }
        face
    };
    for [a, b] in inner {
        let (a, b) = (root(&lamp_of, a), root(&lamp_of, b));
        lamp_of.insert(a.max(b), a.min(b));
    }
    let mut edges_of: BTreeMap<u32, Vec<[DVec3; 2]>> = BTreeMap::new();
    for edge in &outlines.edges {
        let lit: Vec<u32> = edge
            .faces
            .iter()
            .map(|f| f.0)
            .filter(|&f| emits(f))
            .collect();
        let is_inner = matches!(lit[..], [a, b] if is_one(a, b));
        for &face in lit.iter().filter(|_| !is_inner) {
            edges_of
                .entry(root(&lamp_of, face))
                .or_default()
                .push(outlines.ends(edge));
        }
    }
    let mut power_of: BTreeMap<u32, f64> = BTreeMap::new();
    for &face in lamp_of.keys() {
        *power_of.entry(root(&lamp_of, face)).or_default() += power(scene, &faces[face as usize]);
    }
    edges_of
        .into_iter()
        .map(|(face, edges)| {
            let edges = straightened(edges);
            let world = &faces[face as usize];
            let is_two_sided = scene.materials[world.material as usize].double_sided;
            Lamp {
                corners: corners(&edges),
                edges,
                normal: if is_two_sided {
                    DVec3::ZERO
                } else {
                    world.normal.as_dvec3()
                },
                power: power_of[&face],
            }
        })
        .collect()
}

fn power(scene: &Scene, face: &WorldFace) -> f64 {
    let emission = scene.materials[face.material as usize].emission;
    let doubled = crate::patch::face::newell_normal(face.polygon()).length();
    f64::from(emission.max_band()) * f64::from(doubled)
}

fn corners(edges: &[[DVec3; 2]]) -> Vec<DVec3> {
    let mut corners: Vec<DVec3> = Vec::new();
    for &end in edges.iter().flatten() {
        if !corners.contains(&end) {
            corners.push(end);
        }
    }
    corners
}

/// Edges that go on straight become one.
fn straightened(mut edges: Vec<[DVec3; 2]>) -> Vec<[DVec3; 2]> {
    let mut i = 0;
    while i < edges.len() {
        let joined = (0..edges.len()).filter(|&j| j != i).find_map(|j| {
            let shared = |a: usize, b: usize| edges[i][a] == edges[j][b];
            let ends = [(0, 0), (0, 1), (1, 0), (1, 1)]
                .into_iter()
                .find(|&(a, b)| shared(a, b))?;
            let (from, to) = (edges[i][1 - ends.0], edges[j][1 - ends.1]);
            let (one, two) = (edges[i][ends.0] - from, to - edges[i][ends.0]);
            let is_straight = one.cross(two).length() < STRAIGHT * one.length() * two.length()
                && one.dot(two) > 0.0;
            is_straight.then_some((j, [from, to]))
        });
        match joined {
            Some((j, edge)) => {
                edges[i] = edge;
                edges.remove(j);
                i = 0;
            }
            None => i += 1,
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::face::world_faces;
    use glam::Vec3;
    use hemicube_raster::Rgb;
    use hemicube_scene::builtin::SceneBuilder;
    use hemicube_scene::{ImportReport, Material, Units};

    #[test]
    fn a_lamp_of_many_faces_is_a_square() {
        let mut builder = SceneBuilder::new("lamp", Units::Photometric);
        let lamp = builder.material(Material {
            emission: Rgb::WHITE,
            ..Material::diffuse("lamp", Rgb::BLACK)
        });
        builder.node("lamp");
        for i in 0..9 {
            let (x, z) = ((i % 3) as f32, (i / 3) as f32);
            let at = |dx: f32, dz: f32| Vec3::new(x + dx, 2.0, z + dz);
            builder.quad(
                lamp,
                [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
            );
        }
        let scene = builder.finish();
        let faces = world_faces(&scene, &mut ImportReport::default());
        let (lamps, left_out) = lamps(&scene, &Outlines::new(&faces), &faces);
        assert_eq!((lamps.len(), left_out), (1, 0), "one lamp");
        assert_eq!(
            (lamps[0].corners.len(), lamps[0].edges.len()),
            (4, 4),
            "{:?}",
            lamps[0]
        );
        assert!(
            (lamps[0].power - 18.0).abs() < 1e-4,
            "power {}",
            lamps[0].power
        );
        assert!(
            lamps[0].faces(DVec3::ZERO) == (lamps[0].normal.y < 0.0),
            "its direction"
        );
    }
}
