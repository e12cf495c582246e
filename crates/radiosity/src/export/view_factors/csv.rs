//! Comma-separated values.

use crate::form_factor::ViewFactorMatrix;
use std::io::{self, Write};

/// Writes a table that pandas and spreadsheets read as it is (RFC 4180, UTF-8, lines end in `\n`).
///
/// The first line names the columns: `name`, `area`, one for each surface in the order of the rows, `sky`, `absorbed`,
/// `transmitted`. The other lines are surfaces: name, area in square scene units, factors to all surfaces, and the shares
/// that meet nothing, end at backs, or pass on through panes at which they arrived. Factors, sky and absorbed, less
/// transmitted, sum to 1 in each line. Numbers have the shortest digits that read back as the same f32 (areas: f64).
///
/// In Python:
/// ```text
/// table = pandas.read_csv("F.csv", index_col="name")
/// F = table.iloc[:, 1:1 + len(table)].to_numpy()
/// ```
/// By position, because a surface may be called `sky`. A name with commas, quotes or line ends stands in quotes; quotes
/// in it are doubled.
///
/// # Errors
/// Those of the writer.
pub fn csv(matrix: &ViewFactorMatrix, out: &mut impl Write) -> io::Result<()> {
    write!(out, "name,area")?;
    for name in matrix.names() {
        write!(out, ",{}", quoted(name))?;
    }
    writeln!(out, ",sky,absorbed,transmitted")?;
    for i in 0..matrix.size() {
        write!(out, "{},{}", quoted(&matrix.names()[i]), matrix.areas()[i])?;
        let mut written = 0;
        for (j, f) in matrix.entries().row(i) {
            zeros(out, j - written)?;
            out.write_all(b",")?;
            number(out, f64::from(f), || f.to_string())?;
            written = j + 1;
        }
        zeros(out, matrix.size() - written)?;
        for share in [
            matrix.sky()[i],
            matrix.absorbed()[i],
            matrix.transmitted()[i],
        ] {
            out.write_all(b",")?;
            number(out, share, || rounded(share).to_string())?;
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}

/// Factors that a sparse matrix leaves out.
fn zeros(out: &mut impl Write, count: usize) -> io::Result<()> {
    (0..count).try_for_each(|_| out.write_all(b",0"))
}

/// A number; small ones with an exponent instead of a row of zeros.
fn number(out: &mut impl Write, x: f64, plain: impl Fn() -> String) -> io::Result<()> {
    if x == 0.0 {
        out.write_all(b"0")
    } else if x.abs() < 1e-4 {
        write!(out, "{:e}", rounded(x))
    } else {
        out.write_all(plain().as_bytes())
    }
}

/// Shares are made of factors in f32; more digits would be noise.
#[expect(clippy::cast_possible_truncation, reason = "rounding is meant")]
fn rounded(x: f64) -> f32 {
    x as f32
}

/// A field as RFC 4180 wants it.
fn quoted(text: &str) -> String {
    let needs_quotes = text.contains([',', '"', '\n', '\r'])
        || text.starts_with(char::is_whitespace)
        || text.ends_with(char::is_whitespace);
    if needs_quotes {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
