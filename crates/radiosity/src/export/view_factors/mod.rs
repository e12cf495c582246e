//! View factors in files: what thermal models, spreadsheets and Python read.
//!
//! | ending | what it holds | who reads it |
//! |---|---|---|
//! | `.csv` | names, areas, factors, shares of sky, backs and panes ([`csv`]) | pandas, spreadsheets |
//! | `.npy` | factors alone, dense, f32 ([`npy`]) | NumPy |
//! | `.mtx` | names and areas as comments, factors that are not zero ([`matrix_market`]) | SciPy, MATLAB, Julia |
//! | `.out` | areas, factors with six decimals, emissivities ([`view3d`]) | what reads files of View3D |
//!
//! Everywhere row i and column j hold `F_ij`, the share of what leaves surface i that arrives at surface j. All are
//! written row by row; nothing larger than a row is made on the way.

mod csv;
mod matrix_market;
mod npy;
mod view3d;

pub use csv::csv;
pub use matrix_market::matrix_market;
pub use npy::npy;
pub use view3d::{View3dFacts, view3d};

/// Text on one line: control characters become spaces.
fn one_line(text: &str) -> String {
    let is_break = |c: char| c.is_control() || matches!(c, '\u{2028}' | '\u{2029}');
    text.chars()
        .map(|c| if is_break(c) { ' ' } else { c })
        .collect()
}
