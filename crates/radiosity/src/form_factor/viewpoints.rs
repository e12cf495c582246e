//! The points of a patch from which its row is taken by hemicubes, hemispheres and Nusselt's analog.
//!
//! One point takes the patch for a differential element: that is good where everything is far, measured by the patch's
//! size. Near patches get 4 or 16 points, those of Gauss quadrature; patches that are partly buried get points of their
//! exposed elements.

use super::nearby::{Nearby, Surface};
use crate::error::RadiosityError;
use crate::patch::{NodeId, PatchMesh};
use crate::sampling::{hash, point2};
use glam::Vec3;
use std::sync::{Arc, OnceLock};

/// Distance of the nearest surface, in longest edges of the patch, from which one point is enough.
const FAR: f32 = 3.0;
/// And from which four are.
const MIDDLE: f32 = 1.25;

/// A point of a patch with a frame.
#[derive(Debug, Clone, Copy)]
pub struct Viewpoint {
    /// On the surface.
    pub point: Vec3,
    /// Off the surface, so that rays do not meet it.
    pub origin: Vec3,
    /// Two axes in the patch's plane and its normal. They are turned around the normal by another angle at each point.
    pub axes: [Vec3; 3],
    /// Share of the patch that it stands for; they sum to 1.
    pub weight: f64,
}

/// Chooses the points of patches.
#[derive(Debug)]
pub(super) struct Viewpoints {
    mesh: Arc<PatchMesh>,
    max_points: u32,
    /// Of each element: radius around its centroid.
    radii: Vec<f32>,
    /// Made when the first patch asks what is near.
    nearby: OnceLock<Nearby>,
}

impl Viewpoints {
    /// At most 1, 4 or 16 points for a patch; `what` stands on them, for the message.
    ///
    /// # Errors
    /// Another number.
    pub(super) fn new(
        mesh: Arc<PatchMesh>,
        max_points: u32,
        what: &str,
    ) -> Result<Self, RadiosityError> {
        if ![1, 4, 16].contains(&max_points) {
            return Err(RadiosityError::Option(format!(
                "{max_points} {what} for a patch are not 1, 4 or 16"
            )));
        }
        let radius = |&id: &NodeId| {
            let (polygon, centre) = (mesh.polygon(id), mesh.node(id).centroid);
            let distances = polygon.iter().map(|c| c.distance(centre));
            distances.fold(0.0, f32::max)
        };
        Ok(Self {
            radii: mesh.elements().iter().map(radius).collect(),
            max_points,
            nearby: OnceLock::new(),
            mesh,
        })
    }

    /// Radius of an element around its centroid.
    pub(super) fn radius(&self, element: usize) -> f32 {
        self.radii[element]
    }

    /// The points of a node.
    pub(super) fn of(&self, source: NodeId) -> Vec<Viewpoint> {
        let mesh = &*self.mesh;
        let node = mesh.node(source);
        let polygon = mesh.polygon(source);
        let side = self.points_per_side(source);
        let parts = exposed_parts(mesh, source);
        let points = match (parts.last(), side) {
            (Some(&(total, _)), _) => {
                // Points that happen to lie close to the solid see it too large; more of them even that out.
                let count = 4 * (side * side).max(4).min(self.max_points);
                let stratum = |i: u32| {
                    let wanted = total * (i as f32 + 0.5) / count as f32;
                    let part = parts.partition_point(|&(sum, _)| sum <= wanted);
                    let (_, element) = parts[part.min(parts.len() - 1)];
                    let point = mesh.exposed(element).point(point2(i, u64::from(source.0)));
                    (point, 1.0 / f64::from(count))
                };
                (0..count).map(stratum).collect()
            }
            (None, 1) => vec![(node.centroid, 1.0)],
            (None, 2) => gauss_points(&polygon, &GAUSS_2),
            (None, _) => gauss_points(&polygon, &GAUSS_4),
        };
        let frame = |(i, (point, weight)): (u64, (Vec3, f64))| {
            let turn = hash(u64::from(source.0), i) >> 40;
            let angle = turn as f32 / (1 << 24) as f32 * core::f32::consts::TAU;
            let (t, b) = node.normal.any_orthonormal_pair();
            let tangent = (t * angle.cos() + b * angle.sin()).normalize();
            Viewpoint {
                point,
                origin: mesh.visibility().off_surface(point, node.normal),
                axes: [tangent, node.normal.cross(tangent), node.normal],
                weight,
            }
        };
        (0..).zip(points).map(frame).collect()
    }

    /// 1, 2 or 4, by the distance from the centre to the nearest surface above the node's plane.
    fn points_per_side(&self, source: NodeId) -> u32 {
        let mesh = &*self.mesh;
        let node = mesh.node(source);
        let polygon = mesh.polygon(source);
        let edge = (0..polygon.len())
            .map(|i| polygon[i].distance(polygon[(i + 1) % polygon.len()]))
            .fold(0.0, f32::max);
        let most = match self.max_points {
            1 => return 1,
            4 => 2,
            _ => 4,
        };
        let nearest = self.nearest_above(node.centroid, node.normal, FAR * edge);
        if nearest >= FAR * edge {
            1
        } else if nearest >= MIDDLE * edge {
            most.min(2)
        } else {
            most
        }
    }

    /// The distance from a point to the nearest surface that is not wholly below its plane if that is less than `best`,
    /// else `best`.
    fn nearest_above(&self, point: Vec3, normal: Vec3, best: f32) -> f32 {
        let mesh = &*self.mesh;
        let floor = 2.0 * mesh.visibility().offset(point);
        let is_above = |polygon: &[Vec3]| polygon.iter().any(|&c| (c - point).dot(normal) > floor);
        let mut nearest = best;
        let nearby = self.nearby.get_or_init(|| Nearby::new(mesh));
        nearby.around(point, best, |surface| match surface {
            Surface::Element(e) if is_above(&mesh.polygon(mesh.elements()[e])) => {
                nearest = self.nearer(point, e, nearest);
            }
            Surface::Obstruction(face) => {
                let face = &mesh.faces()[face as usize];
                if is_above(face.polygon()) {
                    let distance = distance_to_polygon(point, face.polygon(), face.normal);
                    nearest = nearest.min(distance);
                }
            }
            Surface::Element(_) => {}
        });
        nearest
    }

    /// The distance from a point to an element if it is less than `best`, else `best`.
    pub(super) fn nearer(&self, point: Vec3, element: usize, best: f32) -> f32 {
        let id = self.mesh.elements()[element];
        let node = self.mesh.node(id);
        let offset = point - node.centroid;
        let reach = best + self.radii[element];
        if offset.length_squared() >= reach * reach || offset.dot(node.normal).abs() >= best {
            return best;
        }
        distance_to_polygon(point, &self.mesh.polygon(id), node.normal).min(best)
    }

    /// The distance from a point to the nearest obstruction if it is less than `best`, else `best`.
    pub(super) fn nearer_obstruction(&self, point: Vec3, best: f32) -> f32 {
        let faces = self.mesh.obstructions().iter();
        let faces = faces.map(|&(face, _)| &self.mesh.faces()[face as usize]);
        faces.fold(best, |best, face| {
            distance_to_polygon(point, face.polygon(), face.normal).min(best)
        })
    }
}

/// Nodes in [0, 1] and weights of Gauss-Legendre quadrature.
const GAUSS_2: [(f32, f64); 2] = [(0.211_324_87, 0.5), (0.788_675_1, 0.5)];
const GAUSS_4: [(f32, f64); 4] = [
    (0.069_431_84, 0.173_927_422_568_726_93),
    (0.330_009_5, 0.326_072_577_431_273_07),
    (0.669_990_5, 0.326_072_577_431_273_07),
    (0.930_568_16, 0.173_927_422_568_726_93),
];

/// Points of a product rule on a polygon, a triangle being a quad whose last corner meets the first. Weights sum to 1.
fn gauss_points(polygon: &[Vec3], rule: &[(f32, f64)]) -> Vec<(Vec3, f64)> {
    let (a, b, c) = (polygon[0], polygon[1], polygon[2]);
    let d = polygon.get(3).copied().unwrap_or(a);
    let mut points = Vec::with_capacity(rule.len() * rule.len());
    for &(u, wu) in rule {
        for &(v, wv) in rule {
            let point = a.lerp(b, u).lerp(d.lerp(c, u), v);
            let (along_u, along_v) = ((b - a).lerp(c - d, v), (d - a).lerp(c - b, u));
            let jacobian = f64::from(along_u.cross(along_v).length());
            points.push((point, wu * wv * jacobian));
        }
    }
    let sum: f64 = points.iter().map(|&(_, weight)| weight).sum();
    points.iter_mut().for_each(|(_, weight)| *weight /= sum);
    points
}

/// Elements of a patch with running sums of their exposed areas; empty if all of it is exposed, or none.
fn exposed_parts(mesh: &PatchMesh, id: NodeId) -> Vec<(f32, usize)> {
    let Some(patch) = mesh.patch_of_node(id) else {
        return Vec::new();
    };
    let elements = mesh.elements_of_patch(patch);
    let is_whole = |e: usize| mesh.exposed_area(e) == mesh.node(mesh.elements()[e]).area;
    if elements.clone().all(is_whole) {
        return Vec::new();
    }
    let mut sum = 0.0;
    elements
        .filter(|&e| mesh.exposed_area(e) > 0.0)
        .map(|e| {
            sum += mesh.exposed_area(e);
            (sum, e)
        })
        .collect()
}

/// Distance from a point to a planar convex polygon.
fn distance_to_polygon(point: Vec3, polygon: &[Vec3], normal: Vec3) -> f32 {
    let mut is_over = true;
    let mut nearest2 = f32::INFINITY;
    for (i, &a) in polygon.iter().enumerate() {
        let edge = polygon[(i + 1) % polygon.len()] - a;
        let offset = point - a;
        is_over &= edge.cross(offset).dot(normal) >= 0.0;
        let along = (offset.dot(edge) / edge.length_squared().max(1e-30)).clamp(0.0, 1.0);
        nearest2 = nearest2.min((offset - edge * along).length_squared());
    }
    if is_over {
        (point - polygon[0]).dot(normal).abs()
    } else {
        nearest2.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::Node;

    /// What the tree says against a look at every element.
    #[test]
    fn nearest_surface_is_that_of_a_look_at_all() {
        let mesh = |name: &str, elements| {
            let scene = hemicube_scene::builtin::scene(name).expect("it is built in");
            let options = crate::patch::PatchOptions::default().with_elements(elements);
            Arc::new(PatchMesh::build(Arc::new(scene), options).expect("it can be cut"))
        };
        for mesh in [mesh("cornell", 2000), mesh("office", 4000)] {
            let viewpoints = Viewpoints::new(mesh.clone(), 16, "hemicubes").expect("16 will do");
            for &patch in mesh.patches().iter().step_by(23) {
                let Node {
                    centroid, normal, ..
                } = *mesh.node(patch);
                let floor = 2.0 * mesh.visibility().offset(centroid);
                for best in [0.05, 1.0, 300.0] {
                    let above = |&e: &usize| {
                        let corners = mesh.polygon(mesh.elements()[e]);
                        let mut corners = corners.iter();
                        mesh.exposed_area(e) > 0.0
                            && corners.any(|&c| (c - centroid).dot(normal) > floor)
                    };
                    let all = (0..mesh.elements().len()).filter(above);
                    let wanted = all.fold(best, |best, e| viewpoints.nearer(centroid, e, best));
                    let found = viewpoints.nearest_above(centroid, normal, best);
                    // Of two that are equally near the first counts, whose distance may be rounded otherwise.
                    let rounding = 1e-6 * (wanted + centroid.length());
                    let differs = (found - wanted).abs() > rounding;
                    assert!(!differs, "{patch:?}, {best}: {found}, not {wanted}");
                }
            }
        }
    }

    #[test]
    fn distances_to_a_square() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let distance = |x, y, z| distance_to_polygon(Vec3::new(x, y, z), &square, Vec3::Z);
        assert_eq!(distance(0.5, 0.5, 2.0), 2.0, "over the square");
        assert_eq!(distance(0.5, 0.5, -2.0), 2.0, "below the square");
        assert_eq!(distance(4.0, 0.5, 4.0), 5.0, "beside an edge");
    }
}
