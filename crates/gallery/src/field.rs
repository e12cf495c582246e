//! Scalar fields on surfaces, shown through textures of one dimension.

mod accessible_surface;
mod drawing;
mod finite_elements;
mod molecule;
mod open_dx;
mod outer_faces;
mod pqr;
mod sheet;
mod vtk;

use crate::exhibit::{Exhibit, GalleryError};
use hemicube_raster::io_error::in_words;
use std::fs::File;
use std::io::Read;
use std::path::Path;

pub(crate) const EXHIBITS: &[Exhibit] = &[
    Exhibit {
        name: "molecule",
        about: "electrostatic potential on the solvent-accessible surface of a molecule, with isolines",
        needs: &["atoms.pqr", "potential.dx"],
        draw: molecule::draw_with_grid,
    },
    Exhibit {
        name: "molecule-charges",
        about: "the same from the charges of the atoms alone, by Coulomb's law",
        needs: &["atoms.pqr"],
        draw: molecule::draw_with_charges,
    },
    Exhibit {
        name: "finite-elements",
        about: "a scalar field on a mesh of elements: interpolated colours beside interpolated values, isolines, element edges",
        needs: &["mesh.vtk"],
        draw: finite_elements::draw_exhibit,
    },
];

/// Longer files are refused before they fill the memory.
const LONGEST_FILE: u64 = 256 << 20;

fn refuse(path: &Path, why: impl Into<String>) -> GalleryError {
    GalleryError::File {
        path: path.to_owned(),
        why: why.into(),
    }
}

/// A whole file that is not too long.
fn read(path: &Path) -> Result<Vec<u8>, GalleryError> {
    let failed = |error: std::io::Error| refuse(path, in_words(&error));
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(failed)?;
    file.take(LONGEST_FILE + 1)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    if bytes.len() as u64 > LONGEST_FILE {
        return Err(refuse(
            path,
            "longer than 256 MiB; give a smaller part of it",
        ));
    }
    Ok(bytes)
}

/// A word of a file as an error shows it: short, and without control characters.
fn quoted(word: &str) -> String {
    let visible = word.chars().filter(|c| !c.is_control());
    let short: String = visible.clone().take(24).collect();
    let dots = if visible.count() > 24 { "..." } else { "" };
    format!("'{short}{dots}'")
}

/// A finite number.
fn number(word: &str) -> Result<f64, String> {
    word.parse()
        .ok()
        .filter(|x: &f64| x.is_finite())
        .ok_or_else(|| format!("{} is no finite number", quoted(word)))
}

/// A folder of files that others made; they are not part of the project. `HEMICUBE_TESTDATA` or the folder
/// `shared/testdata` beside the workspace has them.
#[cfg(test)]
fn testdata(folder: &str) -> Option<std::path::PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/testdata");
    let root = std::env::var_os("HEMICUBE_TESTDATA").unwrap_or_else(|| beside.into());
    let folder = Path::new(&root).join(folder);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: no test data at {}", folder.display());
    None
}
