//! Edges of the scene's faces with the faces along them, and which of them are outlines as seen from a point.

use crate::patch::face::WorldFace;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Heights below this share of the distance count as in the plane.
const FLAT: f64 = 1e-6;

/// An edge of the scene.
#[derive(Debug, Clone)]
pub struct SceneEdge {
    /// Its ends by their number in [`Outlines::points`], the lower one first.
    pub ends: [u32; 2],
    /// The faces along it, and whether each runs from the lower to the higher number there.
    pub faces: Vec<(u32, bool)>,
}

/// All edges of some faces.
pub struct Outlines<'a> {
    faces: &'a [WorldFace],
    /// The corners, each place once.
    pub points: Vec<DVec3>,
    /// In the order of their ends.
    pub edges: Vec<SceneEdge>,
}

impl<'a> Outlines<'a> {
    /// Of the faces of a scene; faces share an edge where both its ends are in exactly the same places.
    pub fn new(faces: &'a [WorldFace]) -> Self {
        let mut points = Vec::new();
        let mut by_place: HashMap<[u32; 3], u32> = HashMap::new();
        let mut uses: Vec<([u32; 2], u32, bool)> = Vec::with_capacity(4 * faces.len());
        let mut at = |place: Vec3| {
            *by_place
                .entry((place + Vec3::ZERO).to_array().map(f32::to_bits))
                .or_insert_with(|| {
                    points.push(place.as_dvec3());
                    crate::index32(points.len() - 1)
                })
        };
        for (i, face) in faces.iter().enumerate() {
            let corners: Vec<u32> = face.polygon().iter().map(|&p| at(p)).collect();
            for (k, &a) in corners.iter().enumerate() {
                let b = corners[(k + 1) % corners.len()];
                uses.push(([a.min(b), a.max(b)], crate::index32(i), a < b));
            }
        }
        uses.sort_unstable();
        let mut edges: Vec<SceneEdge> = Vec::new();
        for (ends, face, forward) in uses {
            match edges.last_mut() {
                Some(last) if last.ends == ends => last.faces.push((face, forward)),
                _ => edges.push(SceneEdge {
                    ends,
                    faces: vec![(face, forward)],
                }),
            }
        }
        Self {
            faces,
            points,
            edges,
        }
    }

    /// The places of an edge's ends.
    pub fn ends(&self, edge: &SceneEdge) -> [DVec3; 2] {
        edge.ends.map(|end| self.points[end as usize])
    }

    /// Whether the faces along an edge show different sides to a point, or there is only one.
    pub fn is_outline(&self, edge: &SceneEdge, from: DVec3) -> bool {
        // Neighbours that are wound alike run along their edge in opposite directions.
        let mut sides = edge.faces.iter().map(|&(face, forward)| {
            let face = &self.faces[face as usize];
            let offset = from - face.corners[0].as_dvec3();
            let height = offset.dot(face.normal.as_dvec3());
            let is_flat = height.abs() <= FLAT * offset.length();
            (!is_flat).then_some((height > 0.0) == forward)
        });
        match (sides.next(), sides.next(), sides.next()) {
            (Some(only), None, _) => only.is_some(),
            // Over a closed surface the directions differ, across its outline they agree.
            (Some(Some(one)), Some(Some(other)), None) => one == other,
            (one, other, more) => one != other || more.is_some(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::face::world_faces;
    use hemicube_scene::builtin::{SceneBuilder, Sides};
    use hemicube_scene::{ImportReport, Units};

    #[test]
    fn a_cube_seen_from_above_has_the_outline_of_its_lid() {
        let mut builder = SceneBuilder::new("cube", Units::Photometric);
        let grey = builder.diffuse("grey", 0.5, 0.5, 0.5);
        builder.node("cube");
        builder.cuboid(grey, Vec3::ZERO, Vec3::ONE, Sides::ALL);
        let faces = world_faces(&builder.finish(), &mut ImportReport::default());
        let outlines = Outlines::new(&faces);
        assert_eq!(outlines.edges.len(), 12, "edges of a cube");
        let seen = |from: DVec3| {
            outlines
                .edges
                .iter()
                .filter(|e| outlines.is_outline(e, from))
                .count()
        };
        assert_eq!(seen(DVec3::new(0.5, 3.0, 0.5)), 4, "from above");
        assert_eq!(seen(DVec3::splat(3.0)), 6, "from a corner");
        assert_eq!(seen(DVec3::splat(0.5)), 0, "from inside");
    }

    #[test]
    fn the_rim_of_a_sheet_is_its_outline() {
        let mut builder = SceneBuilder::new("sheet", Units::Photometric);
        let grey = builder.diffuse("grey", 0.5, 0.5, 0.5);
        builder.node("sheet");
        let at = |x: f32, z: f32| Vec3::new(x, 0.0, z);
        builder.quad(
            grey,
            [at(0.0, 0.0), at(0.0, 1.0), at(1.0, 1.0), at(1.0, 0.0)],
        );
        builder.quad(
            grey,
            [at(1.0, 0.0), at(1.0, 1.0), at(2.0, 1.0), at(2.0, 0.0)],
        );
        let faces = world_faces(&builder.finish(), &mut ImportReport::default());
        let outlines = Outlines::new(&faces);
        let seen = |from: DVec3| {
            outlines
                .edges
                .iter()
                .filter(|e| outlines.is_outline(e, from))
                .count()
        };
        assert_eq!(
            seen(DVec3::new(0.3, 1.0, 0.4)),
            6,
            "from above, without the seam"
        );
        assert_eq!(seen(DVec3::new(5.0, 0.0, 0.4)), 0, "from its own plane");
    }
}
