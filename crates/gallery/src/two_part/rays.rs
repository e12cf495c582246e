//! A section through object and intermediate surface, with the lines of the mapping.

use super::{O_MAPS, S_MAPS};
use crate::stage::Mesh;
use crate::{GalleryError, Piece, Request};
use glam::{Vec2, Vec3};
use hemicube_chart::{Anchor, Drawing};
use hemicube_raster::two_part::{SMap, SurfacePoint, TwoPart};

const INK: [u8; 3] = [40, 40, 40];
const SURFACE: [u8; 3] = [0, 114, 178];
const RAY: [u8; 3] = [213, 94, 0];
const EYE: [u8; 3] = [0, 130, 90];

/// Half the width of what a section shows.
const REACH: f32 = 1.75;

/// Where the eye stands in the section, just out of it; lines to it start at the object.
const EYE_PLACE: Vec3 = Vec3::new(0.0, 0.9, 4.0);

pub(super) fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = request.size.unwrap_or((1200, 1320));
    let cell = (width / 4).min(height / 4);
    if cell < 40 || width.max(height) > 1 << 14 {
        let why = "16 sections need at least 160 x 160 pixels, and a side has at most 16384";
        return Err(GalleryError::Size {
            width,
            height,
            why: why.to_owned(),
        });
    }
    let mut drawing = Drawing::new(width, height);
    // One of the spheres: both have the same lines.
    let s_maps = S_MAPS
        .iter()
        .filter(|(name, _)| *name != "sphere, stereographic");
    for (row, (s_name, s)) in s_maps.enumerate() {
        for (column, (o_name, o)) in O_MAPS.into_iter().enumerate() {
            let section = Section {
                center: [
                    (column as f64 + 0.5) * width as f64 / 4.0,
                    (row as f64 + 0.54) * height as f64 / 4.0,
                ],
                scale: cell as f64 * 0.46 / f64::from(REACH),
            };
            section.draw(&mut drawing, &TwoPart::new(*s, o));
            let name = s_name.split(',').next().unwrap_or_default();
            let title = format!("{name} / {o_name}");
            let top = row as f64 * height as f64 / 4.0 + 4.0;
            drawing.text([section.center[0], top], &title, Anchor::Middle, 16, INK);
        }
    }
    Ok(vec![
        Piece::drawing("", &drawing),
        Piece::sheet("", &{
            let mut canvas = hemicube_chart::Canvas::new(width, height);
            canvas.draw(&drawing, 0, 0);
            canvas
        })?,
    ])
}

/// The plane x = 0 on the sheet: z to the right, y up.
struct Section {
    center: [f64; 2],
    scale: f64,
}

impl Section {
    fn place(&self, p: Vec3) -> [f64; 2] {
        [
            self.center[0] + f64::from(p.z) * self.scale,
            self.center[1] - f64::from(p.y) * self.scale,
        ]
    }

    fn draw(&self, drawing: &mut Drawing, mapping: &TwoPart) {
        for outline in outlines(&mapping.s) {
            self.path(drawing, &outline, SURFACE, 2.0);
        }
        let profile = profile();
        for side in [1.0, -1.0] {
            let points: Vec<Vec3> = profile
                .iter()
                .map(|(p, _)| Vec3::new(0.0, p.y, side * p.x))
                .collect();
            self.path(drawing, &points, INK, 2.0);
            for (point, normal) in profile.iter().skip(2).step_by(4) {
                let point = Vec3::new(0.0, point.y, side * point.x);
                let normal = Vec3::new(0.0, normal.y, side * normal.x);
                self.ray(
                    drawing,
                    mapping,
                    &SurfacePoint::new(point, normal, EYE_PLACE - point),
                );
            }
        }
    }

    /// The line of a point; for reflected rays also where it is looked at from. A point that is turned away from the eye
    /// reflects nothing into it.
    fn ray(&self, drawing: &mut Drawing, mapping: &TwoPart, surface: &SurfacePoint) {
        let is_reflected = mapping.o == O_MAPS[0].1;
        if is_reflected && surface.normal.dot(surface.view) <= 0.0 {
            return;
        }
        let Some(trace) = mapping.trace(surface) else {
            return;
        };
        if trace.to.abs().max_element() > 1.2 * REACH {
            return;
        }
        if is_reflected {
            let towards = surface.point + surface.view.normalize() * 0.45;
            drawing.line(self.place(surface.point), self.place(towards), EYE, 1.0);
        }
        let (from, to) = (self.place(trace.from), self.place(trace.to));
        drawing.line(from, to, RAY, 1.0);
        self.dot(drawing, trace.to);
    }

    fn dot(&self, drawing: &mut Drawing, p: Vec3) {
        let [x, y] = self.place(p);
        drawing.line([x - 2.0, y], [x + 2.0, y], RAY, 4.0);
    }

    fn path(&self, drawing: &mut Drawing, points: &[Vec3], color: [u8; 3], width: f64) {
        for pair in points.windows(2) {
            drawing.line(self.place(pair[0]), self.place(pair[1]), color, width);
        }
    }
}

/// Outline of the vase on the side of +z, with normals, as `(radius, height)`.
fn profile() -> Vec<(Vec2, Vec2)> {
    let vase = Mesh::vase(48);
    let is_front = |v: &&crate::stage::Vertex| (v.texcoord.x - 0.5).abs() < 1e-6;
    let flat = |p: Vec3| Vec2::new(p.z, p.y);
    let front = vase.vertices.iter().filter(is_front);
    front.map(|v| (flat(v.position), flat(v.normal))).collect()
}

/// Where the intermediate surface meets the plane x = 0.
fn outlines(s: &SMap) -> Vec<Vec<Vec3>> {
    let closed = |corners: &[[f32; 2]]| {
        let first = corners.iter().chain(corners.first());
        vec![first.map(|&[z, y]| Vec3::new(0.0, y, z)).collect()]
    };
    match *s {
        SMap::Plane {
            distance, height, ..
        } => vec![vec![
            Vec3::new(0.0, 0.5 * height, distance),
            Vec3::new(0.0, -0.5 * height, distance),
        ]],
        SMap::Cylinder { radius, height, .. } => {
            let (r, h) = (radius, 0.5 * height);
            closed(&[[r, h], [r, -h], [-r, -h], [-r, h]])
        }
        SMap::Sphere { radius, .. } => {
            let on_circle = |i: u8| {
                let (sin, cos) = (f32::from(i) * core::f32::consts::TAU / 96.0).sin_cos();
                [radius * cos, radius * sin]
            };
            closed(&(0..96).map(on_circle).collect::<Vec<_>>())
        }
        SMap::Box { half, .. } => {
            let (z, y) = (half.z, half.y);
            closed(&[[z, y], [z, -y], [-z, -y], [-z, y]])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figure_has_lines_and_is_refused_when_tiny() {
        let pieces = draw(&Request::default()).expect("a figure");
        let svg = String::from_utf8(pieces[0].bytes.clone()).expect("text");
        assert!(svg.matches("#d55e00").count() > 100, "there are rays");
        assert!(!svg.contains("NaN"), "all numbers are numbers");
        let tiny = Request {
            size: Some((90, 90)),
            ..Request::default()
        };
        assert!(draw(&tiny).is_err(), "too small");
    }

    #[test]
    fn profile_is_the_vase() {
        let profile = profile();
        assert_eq!(profile.len(), 49);
        assert!(profile.iter().all(|(p, n)| p.x > 0.3 && n.length() > 0.99));
    }
}
