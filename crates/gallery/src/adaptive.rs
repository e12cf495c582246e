//! Adaptive subdivision: the mesh over the light, level by level, and what it gains over a uniform mesh.

use crate::exhibit::{Exhibit, GalleryError, Piece, Request};
use crate::sheet::{Cell, cell_size, sheet};
use hemicube_radiosity::{
    AdaptiveOptions, PatchOptions, Quality, RadiosityError, Solution, SolveOptions, resume, solve,
};
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_raster::{Image, Rgb};
use hemicube_render::{MeshOverlay, RenderOptions, render, render_display};
use hemicube_scene::builtin;
use std::fmt::Write as _;
use std::sync::Arc;

pub(crate) const EXHIBITS: &[Exhibit] = &[Exhibit {
    name: "adaptive-subdivision",
    about: "the Cornell box at levels 0 to 4: elements are cut where light varies over them, patches stay; error beside a \
            uniform mesh of as many elements",
    needs: &[],
    draw,
}];

/// Levels of refinement that are shown.
const LEVELS: u8 = 4;

/// Contrast from which on elements are cut.
const CONTRAST: f32 = 0.08;

/// Elements of the mesh whose picture counts as the truth.
const FINE: usize = 16_000;

/// Elements of the first mesh that is refined to be compared: enough for as many patches as the uniform one has.
const FIRST_OF_COMPARED: usize = 800;

/// Contrast so low that the number of elements decides.
const LEAST_CONTRAST: f32 = 0.02;

/// How many times brighter than they are errors are drawn.
const GAIN: f32 = 5.0;

/// Times the mean from which on all is white: at the edges of lamps pixels are off whose light nobody reads.
const WHITE: f32 = 4.0;

/// A sheet of five meshes, the light of the last, and errors of a mesh refined by error and of a uniform one; two tables.
fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let size = cell_size(request, (1500, 1660), (3, 3), 2)?;
    let mut solution = begun(&first_options());
    let mut table = String::from("level,elements,elements_above_contrast\n");
    let mut cells = Vec::new();
    for level in 0..=LEVELS {
        let adaptive = options_of_level(&solution, level);
        let options = SolveOptions {
            adaptive: Some(adaptive),
            ..first_options()
        };
        solution = solved(resume(solution, &options, |_, _| true));
        let elements = solution.mesh().elements().len();
        let above = adaptive.left(&solution).elements;
        let _ = writeln!(table, "{level},{elements},{above}");
        let lines = [
            format!("level {level}: {elements} elements"),
            format!(
                "{above} of them with a contrast above {:.0} %",
                100.0 * CONTRAST
            ),
        ];
        let image = picture(&solution, size, Some(MeshOverlay::Elements));
        cells.push(Cell::new(image, &lines.each_ref().map(String::as_str)));
    }
    let patches = format!(
        "{} patches shoot at every level",
        solution.mesh().patches().len()
    );
    cells.push(Cell::new(
        picture(&solution, size, None),
        &["the light of the last mesh", &patches],
    ));
    let errors = compared(size, solution.mesh().elements().len() / 2, &mut cells);
    Ok(vec![
        Piece::sheet("", &sheet(&cells, 3))?,
        Piece::csv("", table),
        Piece::csv("errors", errors),
    ])
}

/// Adds pictures of a refined mesh and of the errors of it and of a uniform mesh of so many elements. Their table.
fn compared(size: (usize, usize), elements: usize, cells: &mut Vec<Cell>) -> String {
    // With more patches and rays, so that meshes make the error; the truth with twice as many, to share none with either.
    let truth = linear(&begun(&shooting_well(options_of(FINE), 2)), size);
    let uniform = begun(&shooting_well(options_of(elements), 1));
    let limit = uniform.mesh().elements().len();
    let adaptive = begun(&SolveOptions {
        adaptive: Some(
            AdaptiveOptions::default()
                .with_contrast(LEAST_CONTRAST)
                .with_most_elements(limit),
        ),
        ..shooting_well(options_of(FIRST_OF_COMPARED), 1)
    });
    let image = picture(&adaptive, size, Some(MeshOverlay::Elements));
    let line = format!("at most {limit} elements");
    cells.push(Cell::new(
        image,
        &[&line, "the worst by error are cut first"],
    ));
    let mut table = String::from("mesh,elements,error_percent\n");
    for (name, solution) in [("adaptive", &adaptive), ("uniform", &uniform)] {
        let shown = linear(solution, size);
        let (image, error) = difference(&shown, &truth);
        let elements = solution.mesh().elements().len();
        let percent = 100.0 * error;
        let _ = writeln!(table, "{name},{elements},{percent:.2}");
        let lines = [
            format!("{GAIN} x error, {name}: {percent:.1} %"),
            format!("RMS, against {FINE} elements"),
        ];
        cells.push(Cell::new(image, &lines.each_ref().map(String::as_str)));
    }
    table
}

/// How far luminance is off, brighter than it is, and its root mean square; both relative to the mean of the truth.
fn difference(shown: &Image<Rgb>, truth: &Image<Rgb>) -> (Image<Rgb>, f32) {
    let count = truth.pixels().len() as f32;
    let mean = truth.pixels().iter().map(|c| c.luminance()).sum::<f32>() / count;
    let relative = |c: &Rgb| (c.luminance() / mean).min(WHITE);
    let pairs = shown.pixels().iter().zip(truth.pixels());
    let off: Vec<f32> = pairs.map(|(a, b)| relative(a) - relative(b)).collect();
    let squares: f32 = off.iter().map(|x| x * x).sum();
    let drawn = off.iter().map(|x| Rgb::splat((GAIN * x.abs()).min(1.0)));
    let image = Image::from_pixels(truth.width(), truth.height(), drawn.collect());
    (
        image.expect("as many pixels as the truth has"),
        (squares / count).sqrt(),
    )
}

fn first_options() -> SolveOptions {
    options_of(200)
}

/// Of a mesh of so many elements. There are always 50 patches and more.
fn options_of(elements: usize) -> SolveOptions {
    SolveOptions {
        mesh: PatchOptions::default()
            .with_elements(elements)
            .with_patches(50),
        rays: 256,
        tolerance: 1e-3,
        ..Quality::Draft.into()
    }
}

/// The same with so many times as many patches and rays as leave the mesh most of the error.
fn shooting_well(options: SolveOptions, times: u16) -> SolveOptions {
    SolveOptions {
        mesh: options.mesh.with_patches(400 * usize::from(times)),
        rays: 1024 * u32::from(times),
        ..options
    }
}

fn begun(options: &SolveOptions) -> Solution {
    let scene = builtin::scene("cornell").expect("it is built in");
    solved(solve(Arc::new(scene), options, |_, _| true))
}

/// Cuts elements down to so many levels.
fn options_of_level(solution: &Solution, level: u8) -> AdaptiveOptions {
    let longest = solution.mesh().longest_unrefined_edge();
    AdaptiveOptions::default()
        .with_contrast(CONTRAST)
        .with_smallest(longest * 0.5_f32.powi(level.into()))
}

/// The box is built in, and its options are within their ranges.
fn solved(solution: Result<Solution, RadiosityError>) -> Solution {
    solution.expect("the exhibit's own scene can be solved")
}

/// The light that a picture shows, without the mesh.
fn linear(solution: &Solution, (width, height): (usize, usize)) -> Image<Rgb> {
    let options = RenderOptions {
        ambient: false,
        ..RenderOptions::default().with_size(width, height)
    };
    let image = render(solution, &solution.mesh().scene().cameras[0], &options);
    image.expect("the camera of a built-in scene can see")
}

fn picture(
    solution: &Solution,
    (width, height): (usize, usize),
    mesh: Option<MeshOverlay>,
) -> Image<Rgb> {
    let camera = &solution.mesh().scene().cameras[0];
    let options = RenderOptions {
        mesh,
        ambient: false,
        ..RenderOptions::default().with_size(width, height)
    };
    let image = render_display(
        solution,
        camera,
        &options,
        Exposure::Auto,
        ToneMap::Reinhard,
    );
    image.expect("the camera of a built-in scene can see")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_grow_where_light_varies() {
        let request = Request {
            size: Some((240, 420)),
            ..Request::default()
        };
        let pieces = draw(&request).expect("it can be drawn");
        let table = String::from_utf8(pieces[1].bytes.clone()).expect("a table");
        let numbers = |line: &str| -> Vec<usize> {
            line.split(',')
                .map(|n| n.parse().expect("a number"))
                .collect()
        };
        let rows: Vec<Vec<usize>> = table.lines().skip(1).map(numbers).collect();
        assert_eq!(rows.len(), usize::from(LEVELS) + 1, "{table}");
        for pair in rows.windows(2) {
            assert!(pair[1][1] > pair[0][1], "more elements: {table}");
            // A uniform mesh would have four times as many.
            assert!(pair[1][1] < 4 * pair[0][1], "not everywhere: {table}");
        }
        let errors = String::from_utf8(pieces[2].bytes.clone()).expect("a table");
        let of = |name: &str| -> f64 {
            let line = errors.lines().find(|line| line.starts_with(name));
            let last = line.and_then(|line| line.rsplit(',').next());
            last.expect("a row").parse().expect("a number")
        };
        assert!(of("adaptive") < of("uniform"), "{errors}");
    }
}
