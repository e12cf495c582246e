//! Discontinuity meshing: elements that end where shadows do, beside a uniform mesh.

mod penumbra;

use self::penumbra::{FLOOR, LitFloor, Penumbra};
use crate::sheet::{Cell, cell_size, picture, sheet};
use crate::{Exhibit, GalleryError, Piece, Request};
use glam::{DVec2, Vec3};
use hemicube_chart::{Chart, Curve, Scale};
use hemicube_radiosity::PatchOptions;
use hemicube_raster::line::antialiased::draw_line;
use hemicube_raster::{Image, Rgb};
use rayon::prelude::*;

pub(crate) const EXHIBITS: &[Exhibit] = &[Exhibit {
    name: "discontinuity-mesh",
    about: "a penumbra over a uniform mesh and one cut along the shadow's borders: light, mesh lines, error; error over elements",
    needs: &[],
    draw,
}];

/// Angle between lamp and blocker, so that lines of all directions arise.
const TURN: f32 = 0.3;
/// Elements along an edge of the floor, of the uniform mesh and of the one that is cut.
const UNIFORM: f32 = 32.0;
const CUT: f32 = 8.0;
/// Points along an edge of the floor at which the chart's errors are measured.
const MEASURED: usize = 160;
/// The most light on the floor, so that pictures are as bright as may be.
const BRIGHTEST: f64 = 0.0034;
/// How much brighter errors are shown.
const EXAGGERATION: f64 = 2.0;

fn options(across: f32, is_cut: bool) -> PatchOptions {
    PatchOptions::default()
        .with_element_size(FLOOR / across)
        .with_discontinuities(is_cut)
}

/// A mesh, seen.
struct Trial {
    elements: usize,
    /// Root mean square over the points that see a part of the lamp, relative to the light without a blocker.
    error: f64,
    light: Image<f64>,
    exact: Image<f64>,
    edges: Vec<[Vec3; 2]>,
}

impl Trial {
    fn new(penumbra: &Penumbra, options: PatchOptions, side: usize) -> Self {
        let mesh = penumbra
            .mesh(options)
            .expect("the exhibit's own scene can be cut");
        let floor = LitFloor::new(penumbra, &mesh);
        let at = |i: usize| {
            let along = |k: usize| ((k as f32 + 0.5) / side as f32 - 0.5) * FLOOR;
            Vec3::new(along(i % side), 0.0, along(i / side))
        };
        let pixels = (0..side * side).into_par_iter();
        let lights: Vec<[f64; 3]> = pixels
            .map(|i| {
                let [seen, all] = penumbra.factors(at(i).as_dvec3());
                [floor.light(at(i)), seen, all]
            })
            .collect();
        let partly = lights
            .iter()
            .filter(|[_, seen, all]| *seen > 1e-9 && *seen < all - 1e-9);
        let (sum, count) = partly.fold((0.0, 0.0), |(sum, count), [found, seen, all]| {
            (sum + ((found - seen) / all).powi(2), count + 1.0)
        });
        let image = |which: usize| {
            let pixels = lights.iter().map(|l| l[which]).collect();
            Image::from_pixels(side, side, pixels).expect("one value for each pixel")
        };
        Self {
            elements: floor.elements().count(),
            error: f64::sqrt(sum / f64::max(count, 1.0)),
            light: image(0),
            exact: image(1),
            edges: floor.edges(),
        }
    }

    /// Its light, with the edges of the elements if they are wanted.
    fn picture(&self, with_edges: bool) -> Image<Rgb> {
        let side = self.light.width();
        let mut image = picture(side, side, |x, y| grey(*self.light.pixel(x, y)));
        let ink = Rgb::new(0.9, 0.25, 0.05);
        let on_picture = |p: Vec3| {
            let at = (DVec2::new(p.x.into(), p.z.into()) / f64::from(FLOOR) + 0.5) * side as f64;
            at - 0.5
        };
        for [a, b] in self.edges.iter().filter(|_| with_edges) {
            draw_line(&mut image.pen(ink), on_picture(*a), on_picture(*b), 0.7);
        }
        image
    }

    /// Too dark is blue, too bright is orange.
    fn error_picture(&self) -> Image<Rgb> {
        let side = self.light.width();
        picture(side, side, |x, y| {
            let off = (self.light.pixel(x, y) - self.exact.pixel(x, y)) * EXAGGERATION;
            let (bright, dark) = (grey(off.max(0.0)), grey((-off).max(0.0)));
            bright * Rgb::new(1.0, 0.5, 0.1) + dark * Rgb::new(0.1, 0.4, 1.0)
        })
    }

    fn lines(&self, name: &str) -> [String; 2] {
        let percent = 100.0 * self.error;
        [
            format!("{name}: {} elements", self.elements),
            format!("{percent:.2} % RMS in the penumbra"),
        ]
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a shade of grey")]
fn grey(light: f64) -> Rgb {
    Rgb::splat((light / BRIGHTEST).clamp(0.0, 1.0) as f32)
}

fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = cell_size(request, (1100, 800), (3, 2), 2)?;
    let side = width.min(height);
    let penumbra = Penumbra::turned(TURN);
    let [uniform, cut] = [(UNIFORM, false), (CUT, true)]
        .map(|(across, is_cut)| Trial::new(&penumbra, options(across, is_cut), side));
    let cell = |image: Image<Rgb>, lines: [String; 2]| Cell {
        image,
        lines: lines.to_vec(),
    };
    let error = format!("error, {EXAGGERATION} times");
    let colours = String::from("orange: too bright, blue: too dark");
    let row = |trial: &Trial, name: &str| {
        [
            cell(trial.picture(true), trial.lines(name)),
            cell(
                trial.picture(false),
                [String::from("interpolated"), String::new()],
            ),
            cell(trial.error_picture(), [error.clone(), colours.clone()]),
        ]
    };
    let cells = [row(&uniform, "uniform"), row(&cut, "cut along borders")].concat();
    Ok(vec![
        Piece::sheet("", &sheet(&cells, 3))?,
        Piece::chart("-error", &chart(&penumbra), (800, 520)),
    ])
}

/// Error over the number of elements.
fn chart(penumbra: &Penumbra) -> Chart {
    let curve = |name: &str, is_cut: bool, across: &[f32]| {
        let points = across.iter().map(|&across| {
            let trial = Trial::new(penumbra, options(across, is_cut), MEASURED);
            (trial.elements as f64, trial.error)
        });
        Curve::new(name, points.collect())
    };
    Chart {
        title: String::from("Error in a penumbra, light exact at the vertices"),
        x_label: String::from("elements of the floor"),
        y_label: String::from("RMS over the penumbra, share of the unblocked light"),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        curves: vec![
            curve("uniform", false, &[4.0, 8.0, 16.0, 32.0, 64.0, 128.0]),
            curve("cut along the borders", true, &[2.0, 4.0, 8.0, 16.0, 32.0]),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_cut_elements_do_better_than_many_uniform_ones() {
        let penumbra = Penumbra::turned(TURN);
        let [uniform, cut] = [(16.0, false), (4.0, true)]
            .map(|(across, is_cut)| Trial::new(&penumbra, options(across, is_cut), 60));
        assert_eq!(uniform.elements, 256, "a uniform mesh");
        assert!(
            cut.elements < 256 && cut.error < 0.5 * uniform.error,
            "{} of {}",
            cut.error,
            uniform.error
        );
    }

    #[test]
    fn it_is_drawn_at_any_size_that_holds_its_pictures() {
        let request = |width: usize, height: usize| Request {
            size: Some((width, height)),
            ..Request::default()
        };
        let pieces = draw(&request(200, 240)).expect("a small sheet");
        assert_eq!(pieces.len(), 2, "pictures and a chart");
        assert!(draw(&request(20, 20)).is_err(), "too small");
    }
}
