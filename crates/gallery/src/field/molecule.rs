//! The electrostatic potential on the surface of a molecule.

use super::accessible_surface::{Balls, Mesh, PROBE};
use super::drawing::{Eye, draw};
use super::open_dx::Grid;
use super::pqr::{self, Atom};
use super::sheet::{SIDES, antialiasing, round_down, sheet, short};
use super::{read, refuse};
use crate::exhibit::{GalleryError, Piece, Request};
use crate::sheet::picture_size;
use crate::stage::Hit;
use glam::{DVec3, Vec3};
use hemicube_raster::colormap::{Colormap, FieldPaint, Isolines};
use hemicube_raster::io_error::in_words;
use hemicube_raster::{Image, Rgb};
use rayon::prelude::*;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Length of the edges of the mesh, Å.
const SPACING: f64 = 0.4;

/// Points on each ball when its free area is counted.
const COUNTED_POINTS: u32 = 500;

/// Potential of an elementary charge at 1 Å in vacuum, in kT/e at 298 K: `e² / (4 π ε₀ Å kT)`.
const COULOMB: f64 = 560.7;

/// Permittivity at 1 Å from a charge; it grows in proportion to the distance. A rough and quick model of a molecule in
/// water (the distance-dependent dielectric `ε = 4 r`).
const DIELECTRIC: f64 = 4.0;

/// The most terms of Coulomb's law that are summed: half a minute of one thread.
const MOST_TERMS: usize = 20_000_000_000;

/// Where the potential comes from.
enum Potential {
    /// A program for continuum electrostatics has computed it.
    Grid(Grid),
    /// Coulomb's law, in a medium whose permittivity grows with the distance.
    Charges,
}

impl Potential {
    /// At a point; NaN where it is not known.
    fn at(&self, atoms: &[Atom], point: DVec3) -> f32 {
        match self {
            Self::Grid(grid) => grid.sample(point).unwrap_or(f32::NAN),
            Self::Charges => coulomb(atoms, point),
        }
    }

    fn quantity(&self) -> String {
        match self {
            Self::Grid(grid) => {
                let unit = grid.unit.as_deref().unwrap_or("unit of the file");
                format!("Electrostatic potential / ({unit})")
            }
            Self::Charges => String::from("Coulomb potential, permittivity 4 r/Å, / (kT/e)"),
        }
    }
}

/// `Σ q_i e² / (4 π ε₀ ε r)` with `ε = 4 r / Å`, in kT/e.
fn coulomb(atoms: &[Atom], point: DVec3) -> f32 {
    let of_atom = |a: &Atom| a.charge / point.distance_squared(a.centre).max(1e-6);
    let sum: f64 = atoms.iter().map(of_atom).sum();
    #[expect(clippy::cast_possible_truncation, reason = "rounds to the nearest f32")]
    let potential = (sum * COULOMB / DIELECTRIC) as f32;
    potential
}

/// With a potential on a grid.
pub fn draw_with_grid(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let [atoms, potential] = &request.files[..] else {
        let why = "give atoms.pqr and potential.dx";
        return Err(refuse(Path::new("--file"), why));
    };
    let size = picture_size(request, SIZE, SIDES)?;
    let file = File::open(potential).map_err(|error| refuse(potential, in_words(&error)))?;
    let grid = Grid::read(BufReader::new(file)).map_err(|why| refuse(potential, why))?;
    draw_molecule(atoms, &Potential::Grid(grid), size)
}

/// With the potential of the atoms' charges.
pub fn draw_with_charges(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let [atoms] = &request.files[..] else {
        return Err(refuse(Path::new("--file"), "give atoms.pqr"));
    };
    draw_molecule(
        atoms,
        &Potential::Charges,
        picture_size(request, SIZE, SIDES)?,
    )
}

const SIZE: (usize, usize) = (760, 640);

fn draw_molecule(
    path: &Path,
    potential: &Potential,
    size: (usize, usize),
) -> Result<Vec<Piece>, GalleryError> {
    let atoms = pqr::parse(&read(path)?).map_err(|why| refuse(path, why))?;
    let balls = Balls::new(&atoms).map_err(|why| refuse(path, why))?;
    let mesh = balls.mesh(SPACING);
    let is_summed = matches!(potential, Potential::Charges);
    if is_summed && atoms.len() * mesh.positions.len() > MOST_TERMS {
        let why = "has too many charges to be summed; give the potential as a grid to 'molecule'";
        return Err(refuse(path, why));
    }
    let values: Vec<f32> = mesh
        .positions
        .par_iter()
        .map(|p| potential.at(&atoms, p.as_dvec3()))
        .collect();
    if !values.iter().any(|v| v.is_finite()) {
        let why = "the grid of the potential does not meet its surface; give that of this molecule";
        return Err(refuse(path, why));
    }
    let paint = paint(&values);
    let picture = picture(&balls, &mesh, &values, &paint, size);
    let notes = notes(&balls, &mesh, &values, &paint);
    let title = format!("{} atoms", atoms.len());
    let sheet = sheet(&[(&title, &picture)], &paint, &potential.quantity(), &notes);
    Ok(vec![
        Piece::picture("", &picture)?,
        Piece::sheet("-legend", &sheet)?,
    ])
}

/// Colours on both sides of 0, equally far, so that all but the highest twentieth of the magnitudes are told apart,
/// and ten intervals of isolines.
fn paint(values: &[f32]) -> FieldPaint {
    let known = values.iter().filter(|v| v.is_finite());
    let mut sizes: Vec<f32> = known.map(|v| v.abs()).collect();
    sizes.sort_unstable_by(f32::total_cmp);
    let high = sizes.get(sizes.len() * 19 / 20).copied().unwrap_or(0.0);
    let spacing = round_down(high / 4.0);
    let lines = Isolines {
        spacing,
        width: 1.2,
        ..Isolines::default()
    };
    // Chemists draw what attracts positive charges in red.
    let colors = Colormap::diverging().reversed();
    FieldPaint::new(colors, [-5.0 * spacing, 5.0 * spacing]).with_isolines(lines)
}

/// From the front; or, where the potential is known on the smaller part of the surface only, from the side of that
/// part.
fn best_side(mesh: &Mesh, values: &[f32]) -> DVec3 {
    let mean = |is_counted: &dyn Fn(f32) -> bool| {
        let pairs = mesh.positions.iter().zip(values);
        let counted = pairs.filter(|(_, value)| is_counted(**value));
        let (sum, count) = counted.fold((DVec3::ZERO, 0_u32), |(sum, count), (p, _)| {
            (sum + p.as_dvec3(), count + 1)
        });
        (sum / f64::from(count.max(1)), count)
    };
    let (all, count) = mean(&|_| true);
    let (known, known_count) = mean(&f32::is_finite);
    if 2 * known_count < count {
        known - all
    } else {
        DVec3::new(0.3, 0.25, 1.0)
    }
}

/// The surface in the light of a lamp beside the eye. Its normal is that of the ball on which a pixel lies, so grooves
/// between balls are sharp however coarse the mesh is.
fn picture(
    balls: &Balls,
    mesh: &Mesh,
    values: &[f32],
    paint: &FieldPaint,
    size: (usize, usize),
) -> Image<Rgb> {
    let corners: Vec<[Vec3; 3]> = mesh
        .triangles
        .iter()
        .map(|t| t.map(|i| mesh.positions[i as usize]))
        .collect();
    let eye = Eye::around(&mesh.positions, best_side(mesh, values), size);
    let lamp = (eye.direction + DVec3::new(-0.4, 0.6, 0.0)).normalize_or(eye.direction);
    let shade = |fragment: &Hit| {
        let triangle = mesh.triangles[fragment.triangle];
        let (value, gradient) = fragment.interpolate(triangle.map(|i| values[i as usize]));
        let place = fragment.place(corners[fragment.triangle]).as_dvec3();
        #[expect(clippy::cast_possible_truncation, reason = "a cosine")]
        let cosine = balls.normal(place).dot(lamp).max(0.0) as f32;
        paint.color(value, gradient.length()) * (0.25 + 0.75 * cosine)
    };
    draw(&corners, &eye, size, antialiasing(), Rgb::WHITE, shade)
}

/// Areas by mesh and by counting, and how much of the surface has a value.
fn notes(balls: &Balls, mesh: &Mesh, values: &[f32], paint: &FieldPaint) -> Vec<String> {
    let counted = balls.counted_area(COUNTED_POINTS);
    let lines = paint.isolines.map_or(0.0, |lines| lines.spacing);
    vec![
        format!(
            "Accessible surface, probe {PROBE} Å: {:.0} Å² as a mesh of {} triangles,",
            mesh.area(),
            mesh.triangles.len()
        ),
        format!("{counted:.0} Å² counted with {COUNTED_POINTS} points a ball (Shrake and Rupley)."),
        format!("A line every {}; {}.", short(lines.into()), extent(values)),
    ]
}

/// Where the potential is known.
fn extent(values: &[f32]) -> String {
    let known = values.iter().filter(|v| v.is_finite()).count();
    if known == values.len() {
        return String::from("known on the whole surface");
    }
    // Rounded, a small part would be all or nothing.
    let share = (100.0 * known as f64 / values.len() as f64).clamp(0.1, 99.9);
    format!("known on {share:.1} % of the surface, grey elsewhere")
}

#[cfg(test)]
mod tests;
