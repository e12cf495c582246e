//! Adaptive subdivision: the mesh over the light, level by level.

use crate::exhibit::{Exhibit, GalleryError, Piece, Request};
use crate::sheet::{Cell, cell_size, sheet};
use hemicube_radiosity::{
    AdaptiveOptions, PatchOptions, Quality, RadiosityError, Solution, SolveOptions, resume, solve,
};
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_raster::{Image, Rgb};
use hemicube_render::{MeshOverlay, RenderOptions, render_display};
use hemicube_scene::builtin;
use std::fmt::Write as _;
use std::sync::Arc;

pub(crate) const EXHIBITS: &[Exhibit] = &[Exhibit {
    name: "adaptive-subdivision",
    about: "the Cornell box at levels 0 to 4: elements are cut where light varies over them, patches stay",
    needs: &[],
    draw,
}];

/// Levels of refinement that are shown.
const LEVELS: u8 = 4;

/// Contrast from which on elements are cut.
const CONTRAST: f32 = 0.25;

/// A sheet of five meshes and the light of the last, and a table.
fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let size = cell_size(request, (1500, 1110), (3, 2), 2)?;
    let mut solution = begun();
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
    Ok(vec![
        Piece::sheet("", &sheet(&cells, 3))?,
        Piece::csv("", table),
    ])
}

fn first_options() -> SolveOptions {
    SolveOptions {
        mesh: PatchOptions::default().with_elements(200).with_patches(50),
        tolerance: 1e-3,
        ..Quality::Draft.into()
    }
}

fn begun() -> Solution {
    let scene = builtin::scene("cornell").expect("it is built in");
    solved(solve(Arc::new(scene), &first_options(), |_, _| true))
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
            size: Some((240, 300)),
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
    }
}
