//! NumPy's array file.

use crate::form_factor::ViewFactorMatrix;
use std::io::{self, Write};

/// Header and data start at multiples of this.
const ALIGNMENT: usize = 64;

/// Writes the factors as a NumPy array file, version 1.0: little-endian f32, n × n, rows after one another (C order).
///
/// `numpy.load("F.npy")` reads it. It holds the factors alone: names, areas and the shares of sky and backs are in the
/// [CSV](super::csv()) file and in the program's `--json` report.
///
/// # Errors
/// Those of the writer.
pub fn npy(matrix: &ViewFactorMatrix, out: &mut impl Write) -> io::Result<()> {
    let n = matrix.size();
    out.write_all(&header(n))?;
    let mut row = vec![0_u8; 4 * n];
    for i in 0..n {
        row.fill(0);
        for (j, f) in matrix.entries().row(i) {
            row[4 * j..4 * j + 4].copy_from_slice(&f.to_le_bytes());
        }
        out.write_all(&row)?;
    }
    Ok(())
}

/// Magic, version, length of the description, description padded with spaces up to a line end.
fn header(n: usize) -> Vec<u8> {
    let mut text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({n}, {n}), }}");
    let before = 10;
    let whole = (before + text.len() + 1).next_multiple_of(ALIGNMENT);
    text.extend(core::iter::repeat_n(' ', whole - before - text.len() - 1));
    text.push('\n');
    let length = u16::try_from(text.len()).expect("two numbers take fewer than 65,536 characters");
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend_from_slice(&length.to_le_bytes());
    header.extend_from_slice(text.as_bytes());
    header
}
