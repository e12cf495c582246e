//! The links of a hierarchical solver, drawn over a picture of its light.

use crate::failure::Failure;
use crate::output::Target;
use crate::picture::View;
use hemicube::radiosity::backend::{Backend, Shooter};
use hemicube::radiosity::form_factor::FormFactors;
use hemicube::radiosity::solve::{DrawnLink, Hierarchical, Order};
use hemicube::radiosity::{PatchMesh, RadiosityError, Solution, SolveOptions};
use hemicube_chart::{Canvas, Drawing};
use std::sync::{Arc, Mutex, PoisonError};

/// Endings of pictures of links.
pub const ENDINGS: &[&str] = &["png", "svg"];

/// Lines of a picture: the links that bring most.
const LINES: usize = 400;
/// Widths of the lines in pixels, of the weakest drawn and of the strongest.
const WIDTHS: [f64; 2] = [0.7, 3.0];
/// Colours from the root's links to those of elements: warm, then cold.
const COLORS: [[u8; 3]; 6] = [
    [214, 39, 40],
    [255, 127, 14],
    [233, 196, 20],
    [44, 160, 44],
    [31, 119, 220],
    [148, 60, 200],
];
/// Levels of the hierarchy that share a colour.
const LEVELS_OF_COLOR: u32 = 3;

/// A backend that keeps the strongest links when a hierarchical solver ends.
pub struct LinksOf<'a> {
    backend: &'a dyn Backend,
    links: Mutex<Vec<DrawnLink>>,
}

impl<'a> LinksOf<'a> {
    /// Around another backend, which does the work.
    pub fn new(backend: &'a dyn Backend) -> Self {
        Self {
            backend,
            links: Mutex::default(),
        }
    }

    /// The links that were kept.
    pub fn into_links(self) -> Vec<DrawnLink> {
        let links = self.links.into_inner();
        links.unwrap_or_else(PoisonError::into_inner)
    }
}

impl Backend for LinksOf<'_> {
    fn name(&self, options: &SolveOptions) -> String {
        self.backend.name(options)
    }

    fn form_factors(
        &self,
        mesh: Arc<PatchMesh>,
        options: &SolveOptions,
    ) -> Result<Box<dyn FormFactors>, RadiosityError> {
        self.backend.form_factors(mesh, options)
    }

    fn shooting(
        &self,
        solution: Solution,
        options: &SolveOptions,
        order: Order,
    ) -> Result<Shooter, RadiosityError> {
        self.backend.shooting(solution, options, order)
    }

    fn finished(&self, solver: &Hierarchical) {
        let mut links = self.links.lock().unwrap_or_else(PoisonError::into_inner);
        *links = solver.strongest_links(LINES);
    }

    fn verdict(&self) -> Result<(), RadiosityError> {
        self.backend.verdict()
    }
}

/// Writes the links as lines: over the picture (.png), or alone (.svg).
pub fn write(
    links: &[DrawnLink],
    solution: &Solution,
    view: &View<'_>,
    target: &Target,
) -> Result<(), Failure> {
    let drawing = draw(links, view)?;
    if target.ends_in("svg") {
        return target.write(drawing.svg().as_bytes());
    }
    let mut canvas = Canvas::new(drawing.width, drawing.height);
    canvas.paste(&view.display(solution, view.exposure(solution)?)?, 0, 0);
    canvas.draw(&drawing, 0, 0);
    target.write(&canvas.png()?)
}

/// Lines from centre to centre, the strongest last.
fn draw(links: &[DrawnLink], view: &View<'_>) -> Result<Drawing, Failure> {
    let (width, height) = view.size();
    let mut drawing = Drawing::new(width, height);
    let strongest = links.first().map_or(1.0, |link| f64::from(link.flux));
    for link in links.iter().rev() {
        let Some([from, to]) = view.segment(link.from, link.to)? else {
            continue;
        };
        // Flux spans orders of magnitude.
        let strength = (f64::from(link.flux) / strongest).powf(0.25);
        let line_width = WIDTHS[0] + (WIDTHS[1] - WIDTHS[0]) * strength;
        drawing.line(from, to, color(link.level), line_width);
    }
    Ok(drawing)
}

fn color(level: u32) -> [u8; 3] {
    let step = (level / LEVELS_OF_COLOR) as usize;
    COLORS[step.min(COLORS.len() - 1)]
}
