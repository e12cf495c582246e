//! Which parts of a shadow's border are seen from the lamp that casts it.

use super::lights::Lamp;
use super::lines::{Caster, Wedge};
use crate::patch::constraints::plane::Segment;
use glam::DVec3;

/// Places along a line where it is tested, for each element that it crosses; the least and the most.
const PER_ELEMENT: f64 = 2.0;
const FEWEST: f64 = 4.0;
const MOST: f64 = 32.0;
/// Halvings by which the end of what is seen is found.
const HALVINGS: usize = 6;
/// How far beside the line, as a share of an element, it is looked at the lamp.
const BESIDE: f64 = 0.02;
/// How far from its border, as a share of its size, the lamp is looked at.
const INWARDS: f64 = 1e-3;

/// The parts of a line of a wedge on a face that the lamp sees.
pub fn seen_parts(
    caster: &Caster<'_>,
    lamp: &Lamp,
    wedge: &Wedge,
    face: usize,
    [a, b]: Segment,
) -> Vec<Segment> {
    let view = View {
        caster,
        lamp,
        wedge,
        face,
        across: across(caster, face, b - a),
    };
    let count = (PER_ELEMENT * a.distance(b) / caster.element_size)
        .clamp(FEWEST, MOST)
        .ceil();
    let at = |place: f64| a.lerp(b, (place + 0.5) / count);
    let is_seen: Vec<bool> = counted(count).map(|i| view.is_border(at(i))).collect();
    let mut parts = Vec::new();
    let mut start = None;
    for (place, &seen) in counted(count).zip(&is_seen) {
        if seen && start.is_none() {
            start = Some(if place == 0.0 {
                a
            } else {
                view.last_seen(at(place), at(place - 1.0))
            });
        } else if !seen && let Some(from) = start.take() {
            parts.push([from, view.last_seen(at(place - 1.0), at(place))]);
        }
    }
    parts.extend(start.map(|from| [from, b]));
    parts
}

/// 0, 1, 2 and so on below a count.
fn counted(count: f64) -> impl Iterator<Item = f64> {
    (0..u32::MAX).map(f64::from).take_while(move |&i| i < count)
}

/// Unit direction on a face across a line.
fn across(caster: &Caster<'_>, face: usize, along: DVec3) -> DVec3 {
    let normal = caster.mesh.faces[face].normal.as_dvec3();
    normal.cross(along).normalize_or_zero()
}

/// What it takes to look from places of a line at a lamp.
struct View<'a> {
    caster: &'a Caster<'a>,
    lamp: &'a Lamp,
    wedge: &'a Wedge,
    face: usize,
    across: DVec3,
}

impl View<'_> {
    /// Whether something of the lamp appears or goes at a point.
    fn is_border(&self, point: DVec3) -> bool {
        if !self.lamp.faces(point) || !self.caster.is_narrow(self.lamp, self.wedge, point) {
            return false;
        }
        let looked_at = self.looked_at(point);
        let beside = self.across * (BESIDE * self.caster.element_size);
        let seen = [point + beside, point - beside].map(|p| self.is_clear(p, looked_at));
        match self.wedge {
            Wedge::VertexEdge(..) => seen[0] != seen[1],
            Wedge::EdgeVertex(..) => seen[0] || seen[1],
        }
    }

    /// The point of the lamp that is seen along the wedge.
    fn looked_at(&self, point: DVec3) -> DVec3 {
        let on_border = match *self.wedge {
            Wedge::VertexEdge(corner, _) => corner,
            Wedge::EdgeVertex([a, b], corner) => {
                // Where the line through the occluder's corner comes nearest to the lamp's edge.
                let (along, ray) = (b - a, (corner - point).normalize_or_zero());
                let across = along - ray * along.dot(ray);
                let offset = point - a;
                let t = (offset - ray * offset.dot(ray)).dot(across)
                    / across.length_squared().max(1e-300);
                a.lerp(b, t.clamp(0.0, 1.0))
            }
        };
        on_border.lerp(self.lamp.centre(), INWARDS)
    }

    /// Whether nothing is between a point of the face and one of the lamp.
    fn is_clear(&self, from: DVec3, to: DVec3) -> bool {
        let mesh = self.caster.mesh;
        let visibility = &mesh.visibility;
        let normal = mesh.faces[self.face].normal;
        let towards = to - from;
        let side = if towards.dot(normal.as_dvec3()) < 0.0 {
            -normal
        } else {
            normal
        };
        let from = visibility.off_surface(from.as_vec3(), side);
        // The sun is beyond where rays need to go.
        let reach = towards.length().min(2.0 * f64::from(visibility.diameter()));
        let end = (from.as_dvec3() + (to - from.as_dvec3()).normalize_or_zero() * reach).as_vec3();
        let shines = self.lamp.normal.as_vec3();
        visibility.is_clear(from, visibility.off_surface(end, shines))
    }

    /// The last point that is seen on the way from one that is to one that is not.
    fn last_seen(&self, seen: DVec3, hidden: DVec3) -> DVec3 {
        let (mut near, mut far) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (near + far);
            if self.is_border(seen.lerp(hidden, middle)) {
                near = middle;
            } else {
                far = middle;
            }
        }
        seen.lerp(hidden, near)
    }
}
