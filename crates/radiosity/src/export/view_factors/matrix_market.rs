//! The Matrix Market exchange format.

use super::one_line;
use crate::form_factor::ViewFactorMatrix;
use std::io::{self, Write};

/// Characters that a line may have at most (Boisvert, Pozo, Remington 1996, *The Matrix Market Exchange Formats*: 1024).
const LINE: usize = 1000;

/// Writes the factors that are not zero in Matrix Market format, `coordinate real general`.
///
/// Comments before the size hold one line a surface: number (from 1), area, share of the sky, share that backs absorb,
/// name. `scipy.io.mmread("F.mtx")` reads the factors.
///
/// # Errors
/// Those of the writer.
pub fn matrix_market(matrix: &ViewFactorMatrix, out: &mut impl Write) -> io::Result<()> {
    let n = matrix.size();
    writeln!(out, "%%MatrixMarket matrix coordinate real general")?;
    writeln!(
        out,
        "% view factors F_ij from row i to column j; of each row: number, area, sky, absorbed, name"
    )?;
    for (i, name) in matrix.names().iter().enumerate() {
        let (area, sky, absorbed) = (matrix.areas()[i], matrix.sky()[i], matrix.absorbed()[i]);
        let line = format!(
            "% {} {area} {sky:.7} {absorbed:.7} {}",
            i + 1,
            one_line(name)
        );
        writeln!(out, "{}", shortened(&line))?;
    }
    let entries = matrix.entries();
    let is_kept = |&(_, f): &(usize, f32)| f != 0.0;
    let count: usize = (0..n).map(|i| entries.row(i).filter(is_kept).count()).sum();
    writeln!(out, "{n} {n} {count}")?;
    for i in 0..n {
        for (j, f) in entries.row(i).filter(is_kept) {
            writeln!(out, "{} {} {f:e}", i + 1, j + 1)?;
        }
    }
    Ok(())
}

/// What of a line fits into one of the format.
fn shortened(line: &str) -> &str {
    let end = line.floor_char_boundary(LINE);
    &line[..end]
}
