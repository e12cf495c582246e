//! A field on finite elements: interpolated colours, and colours of interpolated values.

use super::drawing::{Eye, draw};
use super::outer_faces::{Face, outer_faces};
use super::sheet::{SIDES, antialiasing, round_down, sheet, short};
use super::vtk::Dataset;
use super::{read, refuse};
use crate::exhibit::{GalleryError, Piece, Request};
use crate::sheet::picture_size;
use crate::stage::Hit;
use glam::{DVec3, Vec2, Vec3};
use hemicube_raster::antialias::Antialiasing;
use hemicube_raster::colormap::{Colormap, FieldPaint, Isolines, Oklab, Wireframe};
use hemicube_raster::{Image, Rgb};
use std::path::Path;

/// A triangle of the surface: a triangular face, or half of a quadrilateral one.
#[derive(Debug, Clone, Copy)]
struct Part {
    corners: [Vec3; 3],
    /// Where its corners lie on the face: in the unit square, or on half of it if the face is a triangle.
    texcoords: [[f32; 2]; 3],
    /// At the corners of the face; of a triangle the last one does not count.
    values: [f32; 4],
    is_quad: bool,
}

/// A place on a face.
#[derive(Debug, Clone, Copy)]
struct Place {
    u: f32,
    v: f32,
    /// Gradients on the screen, per pixel.
    u_gradient: Vec2,
    v_gradient: Vec2,
}

/// The surface with its field.
struct Field {
    parts: Vec<Part>,
    name: String,
    face_count: usize,
}

/// How a pixel gets its colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Interpolation {
    /// Colours of the corners are mixed.
    Colors,
    /// Values of the corners are mixed, and their colour is looked up.
    Values,
}

pub fn draw_exhibit(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let [path] = &request.files[..] else {
        return Err(refuse(Path::new("--file"), "give mesh.vtk"));
    };
    let size = picture_size(request, (520, 400), SIDES)?;
    let dataset = Dataset::parse(&read(path)?).map_err(|why| refuse(path, why))?;
    let field = Field::new(&dataset).map_err(|why| refuse(path, why))?;
    let paint = field.paint();
    let eye = field.eye(size);
    let colors = field.picture(&paint, &eye, size, Interpolation::Colors);
    let values = field.picture(&paint, &eye, size, Interpolation::Values);
    let notes = [
        format!(
            "{} points, {} outer faces, values from {} to {}, a line every {}.",
            dataset.points.len(),
            field.face_count,
            short(paint.range[0].into()),
            short(paint.range[1].into()),
            short(paint.isolines.map_or(0.0, |lines| lines.spacing).into()),
        ),
        format!(
            "Interpolated colours are wrong by {:.3} in Oklab on average (0.02 is just visible).",
            field.color_error(&paint, &eye, size)
        ),
    ];
    let pictures = [
        ("Colours interpolated", &colors),
        ("Values interpolated, texture", &values),
    ];
    let sheet = sheet(&pictures, &paint, &field.name, &notes);
    Ok(vec![
        Piece::sheet("", &sheet)?,
        Piece::picture("-values", &values)?,
    ])
}

impl Field {
    /// The outer faces with the first scalars of the points; or of the cells, if the points have none.
    fn new(dataset: &Dataset) -> Result<Self, String> {
        let faces = outer_faces(&dataset.cells)?;
        if faces.is_empty() {
            return Err(String::from(
                "has no faces to be seen; give a mesh of surfaces or volumes",
            ));
        }
        let of_points = dataset.point_scalars.first();
        let of_cells = dataset.cell_scalars.first();
        let Some(scalars) = of_points.or(of_cells) else {
            return Err(String::from(
                "holds no scalars; add POINT_DATA or CELL_DATA with SCALARS",
            ));
        };
        let value = |face: &Face, corner: u32| match of_points {
            Some(scalars) => scalars.values[corner as usize],
            None => scalars.values[face.cell],
        };
        let part = |face: &Face, of_face: [usize; 3]| {
            let corners = face.corners();
            let is_quad = corners.len() == 4;
            let texcoords = if is_quad { SQUARE } else { TRIANGLE };
            Part {
                corners: of_face.map(|i| dataset.points[corners[i] as usize]),
                texcoords: of_face.map(|i| texcoords[i]),
                values: [0, 1, 2, 3].map(|i| value(face, corners[i.min(corners.len() - 1)])),
                is_quad,
            }
        };
        let halves = |face: &Face| {
            let second = (face.corners().len() == 4).then(|| part(face, [0, 2, 3]));
            core::iter::once(part(face, [0, 1, 2])).chain(second)
        };
        Ok(Self {
            parts: faces.iter().flat_map(halves).collect(),
            name: printable(&scalars.name),
            face_count: faces.len(),
        })
    }

    /// From the smallest to the largest value, with about twelve lines.
    fn paint(&self) -> FieldPaint {
        let values = || {
            self.parts
                .iter()
                .flat_map(|part| part.values)
                .filter(|v| v.is_finite())
        };
        let low = values().fold(f32::INFINITY, f32::min);
        let high = values().fold(f32::NEG_INFINITY, f32::max);
        let range = if low <= high { [low, high] } else { [0.0, 1.0] };
        let lines = Isolines {
            spacing: round_down((range[1] - range[0]) / 8.0),
            width: 1.5,
            ..Isolines::default()
        };
        FieldPaint::new(Colormap::sequential(), range).with_isolines(lines)
    }

    fn eye(&self, size: (usize, usize)) -> Eye {
        let points: Vec<Vec3> = self.parts.iter().flat_map(|part| part.corners).collect();
        Eye::around(&points, DVec3::new(1.0, 0.75, 0.6), size)
    }

    fn corners(&self) -> Vec<[Vec3; 3]> {
        self.parts.iter().map(|part| part.corners).collect()
    }

    /// With element edges, and isolines where values are interpolated.
    fn picture(
        &self,
        paint: &FieldPaint,
        eye: &Eye,
        size: (usize, usize),
        interpolation: Interpolation,
    ) -> Image<Rgb> {
        let frame = Wireframe {
            width: 1.4,
            color: Rgb::splat(0.25),
        };
        let shade = |fragment: &Hit| {
            let part = &self.parts[fragment.triangle];
            let ground = part.color(fragment, paint, interpolation);
            let edge = part.edge_coverage(fragment, &frame);
            ground.lerp(frame.color, edge) * part.light(eye.direction)
        };
        draw(
            &self.corners(),
            eye,
            size,
            antialiasing(),
            Rgb::WHITE,
            shade,
        )
    }

    /// Mean distance of the colours of both interpolations where something is seen, without lines and light.
    fn color_error(&self, paint: &FieldPaint, eye: &Eye, size: (usize, usize)) -> f64 {
        let bare = FieldPaint {
            isolines: None,
            ..paint.clone()
        };
        // Out of reach of colours, to know the ground by.
        let ground = Rgb::splat(-1.0);
        let draw = |interpolation| {
            let shade = |fragment: &Hit| {
                self.parts[fragment.triangle].color(fragment, &bare, interpolation)
            };
            draw(
                &self.corners(),
                eye,
                size,
                Antialiasing::NONE,
                ground,
                shade,
            )
        };
        let (colors, values) = (draw(Interpolation::Colors), draw(Interpolation::Values));
        let pairs = colors.pixels().iter().zip(values.pixels());
        let distances: Vec<f64> = pairs
            .filter(|(a, _)| **a != ground)
            .map(|(&a, &b)| Oklab::from(a).distance(b.into()).into())
            .collect();
        distances.iter().sum::<f64>() / distances.len().max(1) as f64
    }
}

/// Texture coordinates of the corners of a quadrilateral.
const SQUARE: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// Those of a triangle, and one that no corner has.
const TRIANGLE: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];

/// A name from a file as it can be written on a picture.
fn printable(name: &str) -> String {
    name.chars().filter(|c| !c.is_control()).take(48).collect()
}

impl Part {
    fn place(&self, fragment: &Hit) -> Place {
        let (u, u_gradient) = fragment.interpolate(self.texcoords.map(|uv| uv[0]));
        let (v, v_gradient) = fragment.interpolate(self.texcoords.map(|uv| uv[1]));
        Place {
            u,
            v,
            u_gradient,
            v_gradient,
        }
    }

    /// How much each corner of the face counts at a place, linear or bilinear as finite elements interpolate, so no
    /// diagonal is seen; and how that changes along u and v.
    fn weights(&self, Place { u, v, .. }: Place) -> [[f32; 3]; 4] {
        if self.is_quad {
            let (s, t) = (1.0 - u, 1.0 - v);
            [
                [s * t, -t, -s],
                [u * t, t, -u],
                [u * v, v, u],
                [s * v, -v, s],
            ]
        } else {
            [
                [1.0 - u - v, -1.0, -1.0],
                [u, 1.0, 0.0],
                [v, 0.0, 1.0],
                [0.0; 3],
            ]
        }
    }

    fn color(&self, fragment: &Hit, paint: &FieldPaint, interpolation: Interpolation) -> Rgb {
        let place = self.place(fragment);
        let weighted = || self.weights(place).into_iter().zip(self.values);
        match interpolation {
            Interpolation::Colors => weighted()
                .map(|([weight, ..], value)| paint.color(value, 0.0) * weight)
                .sum(),
            Interpolation::Values => {
                let sum = |k: usize| weighted().map(|(w, value)| w[k] * value).sum::<f32>();
                let gradient = place.u_gradient * sum(1) + place.v_gradient * sum(2);
                paint.color(sum(0), gradient.length())
            }
        }
    }

    fn edge_coverage(&self, fragment: &Hit, frame: &Wireframe) -> f32 {
        if !self.is_quad {
            let changes = fragment.gradients.map(|gradient| gradient.length());
            return frame.triangle_coverage(fragment.barycentric, changes);
        }
        let place = self.place(fragment);
        let changes = [place.u_gradient.length(), place.v_gradient.length()];
        frame.quad_coverage([place.u, place.v], changes)
    }

    /// Faces turned away from the eye are a little darker; both sides are alike.
    fn light(&self, towards_eye: DVec3) -> f32 {
        let [a, b, c] = self.corners.map(|p| p.as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or_zero();
        #[expect(clippy::cast_possible_truncation, reason = "a cosine")]
        let cosine = normal.dot(towards_eye).abs() as f32;
        0.6 + 0.4 * cosine
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::testdata;

    fn request(path: &Path) -> Request {
        Request {
            size: Some((80, 60)),
            files: vec![path.to_owned()],
            ..Request::default()
        }
    }

    /// A square of two elements with values that differ much.
    const SHEET: &str = "# vtk DataFile Version 3.0\ns\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 float\n\
        0 0 0 0 0 1 0 0 2 0 1 0 0 1 1 0 1 2\nCELLS 2 10\n4 0 1 4 3\n4 1 2 5 4\nCELL_TYPES 2\n9 9\n\
        POINT_DATA 6\nSCALARS t float\nLOOKUP_TABLE default\n0 10 20 0 10 20\n";

    #[test]
    fn interpolated_colours_differ_from_the_table() {
        let dataset = Dataset::parse(SHEET.as_bytes()).expect("a sheet");
        let field = Field::new(&dataset).expect("a field");
        let (paint, eye) = (field.paint(), field.eye((80, 60)));
        assert_eq!(paint.range, [0.0, 20.0], "the range of the values");
        let error = field.color_error(&paint, &eye, (80, 60));
        assert!(
            error > 0.02,
            "{error}: two elements cannot follow the table"
        );
        let same = FieldPaint::new(
            Colormap::through(&[Oklab::from_hue(0.5, 0.0, 0.0); 2]),
            [0.0, 20.0],
        );
        assert!(
            field.color_error(&same, &eye, (80, 60)) < 1e-6,
            "one colour"
        );
    }

    #[test]
    fn real_meshes_are_drawn() {
        let Some(folder) = testdata("science/fem") else {
            return;
        };
        for (name, faces) in [("hexbeam.vtk", 88), ("uniform.vtk", 6 * 81)] {
            let path = folder.join(name);
            let dataset = Dataset::parse(&read(&path).expect("a file")).expect("a mesh");
            let field = Field::new(&dataset).expect("a field");
            assert_eq!(field.face_count, faces, "{name}");
            assert_eq!(
                draw_exhibit(&request(&path)).expect("it draws").len(),
                2,
                "{name}"
            );
        }
    }

    #[test]
    fn files_without_a_field_are_refused_in_one_line() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let cut = |at: &str| SHEET.split(at).next().unwrap_or("").to_owned();
        let broken = [
            (cut("POINT_DATA"), "holds no scalars"),
            (cut("CELLS"), "has no faces"),
            (cut("10 20 0 10"), "cut off"),
            (SHEET.replace("9 9", "9 22"), "type 22"),
        ];
        for (text, word) in broken {
            let path = folder.path().join("mesh.vtk");
            std::fs::write(&path, text).expect("a temporary file can be written");
            let line = draw_exhibit(&request(&path)).expect_err(word).to_string();
            assert!(line.contains(word) && !line.contains('\n'), "{line}");
        }
        let line = draw_exhibit(&request(Path::new("/nowhere")))
            .expect_err("no file")
            .to_string();
        assert!(line.starts_with("/nowhere: "), "{line}");
    }
}
