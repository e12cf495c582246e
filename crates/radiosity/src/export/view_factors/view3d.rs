//! The text output of View3D, so that what reads its files reads ours.

use crate::form_factor::ViewFactorMatrix;
use std::io::{self, Write};

/// Characters of the first line before its end; readers of the format rely on that width.
const HEADER: usize = 30;

/// What a file of View3D tells besides the factors.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct View3dFacts<'a> {
    /// Emissivity of each surface, 0 to 1. Default value: none, which writes 1 (black).
    pub emissivities: &'a [f64],
    /// Whether the factors were made to close, as `encl=1` asks. Default value: false.
    pub enclosure: bool,
}

/// Writes the text file that View3D 4.0.0 writes with `out=0`.
///
/// - Line 1: `View3D 4.0.0`, format 0, enclosure 0 or 1, 0 (the factors are those of black surfaces), the number of
///   surfaces; padded to 30 characters.
/// - Line 2: areas with six significant digits.
/// - One line a surface: its factors with six decimals.
/// - Last line: emissivities with three decimals.
///
/// Names, sky and backs have no place in it.
///
/// # Errors
/// Those of the writer.
pub fn view3d(
    matrix: &ViewFactorMatrix,
    facts: View3dFacts<'_>,
    out: &mut impl Write,
) -> io::Result<()> {
    let n = matrix.size();
    let header = format!("View3D 4.0.0 0 {} 0 {n}", u8::from(facts.enclosure));
    writeln!(out, "{header:HEADER$}")?;
    line(out, matrix.areas().iter().map(|&area| six_digits(area)))?;
    let mut row = vec![0.0; n];
    for i in 0..n {
        row.fill(0.0);
        for (j, f) in matrix.entries().row(i) {
            row[j] = f;
        }
        line(out, row.iter().map(|f| format!("{f:.6}")))?;
    }
    let emissivity = |i: usize| facts.emissivities.get(i).copied().unwrap_or(1.0);
    line(out, (0..n).map(|i| format!("{:.3}", emissivity(i))))
}

/// Words with spaces between them.
fn line(out: &mut impl Write, words: impl Iterator<Item = String>) -> io::Result<()> {
    for (i, word) in words.enumerate() {
        if i > 0 {
            out.write_all(b" ")?;
        }
        out.write_all(word.as_bytes())?;
    }
    out.write_all(b"\n")
}

/// A positive number as `%g` of C writes it.
fn six_digits(x: f64) -> String {
    if x == 0.0 {
        return String::from("0");
    }
    let scientific = format!("{x:.5e}");
    let (digits, exponent) = scientific.split_once('e').expect("it has an exponent");
    let exponent: i32 = exponent.parse().expect("it is a whole number");
    let without_zeros = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    if (-4..6).contains(&exponent) {
        let decimals = usize::try_from(5 - exponent).expect("it is from 0 to 9");
        return without_zeros(&format!("{x:.decimals$}"));
    }
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{}e{sign}{:02}", without_zeros(digits), exponent.abs())
}

#[cfg(test)]
mod tests {
    use super::six_digits;

    #[test]
    fn areas_look_as_printf_prints_them() {
        // Each as `printf "%g"` of coreutils gives it.
        for (area, text) in [
            (1.0, "1"),
            (0.25, "0.25"),
            (0.1 + 0.2, "0.3"),
            (1234.567, "1234.57"),
            (999_999.5, "1e+06"),
            (123_456.0, "123456"),
            (1_234_567.0, "1.23457e+06"),
            (0.000_123_456_7, "0.000123457"),
            (0.000_012_345_67, "1.23457e-05"),
            (9.999_999, "10"),
            (1e-120, "1e-120"),
            (0.0, "0"),
        ] {
            assert_eq!(six_digits(area), text, "{area:e}");
        }
    }
}
