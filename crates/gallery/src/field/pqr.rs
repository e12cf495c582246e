//! Atoms with charges and radii: the PQR format of PDB2PQR and APBS.

use super::{number, quoted};
use glam::DVec3;

/// An atom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Atom {
    /// In Å.
    pub centre: DVec3,
    /// In elementary charges.
    pub charge: f64,
    /// In Å; 0 if it has no surface of its own.
    pub radius: f64,
}

/// The farthest from the origin that an atom may lie, in Å, and the largest radius and charge.
const FARTHEST: f64 = 1e5;
const LARGEST_RADIUS: f64 = 20.0;
const LARGEST_CHARGE: f64 = 1e4;

/// The most atoms that are drawn.
const MOST_ATOMS: usize = 100_000;

/// The atoms of a file, from its lines `ATOM` and `HETATM`, whose last five words are x, y, z, charge and radius.
/// Everything else is passed over. An error is one line, with the number of the line in the file.
pub fn parse(text: &[u8]) -> Result<Vec<Atom>, String> {
    let text = String::from_utf8_lossy(text);
    let mut atoms = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let is_atom = line.starts_with("ATOM") || line.starts_with("HETATM");
        if is_atom {
            let atom = atom(line).map_err(|why| format!("line {}: {why}", i + 1))?;
            if atoms.len() == MOST_ATOMS {
                return Err(format!(
                    "line {}: more than {MOST_ATOMS} atoms; give a smaller part of the molecule",
                    i + 1
                ));
            }
            atoms.push(atom);
        }
    }
    if atoms.iter().all(|a| a.radius == 0.0) {
        return Err(String::from(
            "holds no atom with a radius; give a PQR file, as PDB2PQR makes it of a PDB file",
        ));
    }
    Ok(atoms)
}

fn atom(line: &str) -> Result<Atom, String> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let Some([.., x, y, z, charge, radius]) = words.get(1..) else {
        return Err(format!(
            "{} has {} words, an atom ends with x, y, z, charge and radius",
            quoted(line),
            words.len()
        ));
    };
    let centre = DVec3::new(number(x)?, number(y)?, number(z)?);
    let (charge, radius) = (number(charge)?, number(radius)?);
    let limits = [
        ("a coordinate", centre.abs().max_element(), FARTHEST),
        ("the charge", charge.abs(), LARGEST_CHARGE),
        ("the radius", radius, LARGEST_RADIUS),
    ];
    for (what, value, limit) in limits {
        if value > limit {
            return Err(format!("{what} is {value}, at most {limit} can be drawn"));
        }
    }
    if radius < 0.0 {
        return Err(format!("the radius is {radius}, it must not be negative"));
    }
    Ok(Atom {
        centre,
        charge,
        radius,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn atoms_are_read_with_and_without_a_chain() {
        let text = b"REMARK 1\nATOM 1 N THR 1 17.047 14.099 3.625 -0.3200 2.0000\n\
            HETATM    2  CA  THR A   1      16.967  12.784   -4.338  0.3300 0.0\nTER\nEND\n";
        let atoms = parse(text).expect("two atoms");
        assert_eq!(atoms.len(), 2, "REMARK and TER are passed over");
        assert_eq!(atoms[0].centre, DVec3::new(17.047, 14.099, 3.625), "place");
        assert_eq!(
            (atoms[0].charge, atoms[0].radius),
            (-0.32, 2.0),
            "charge and radius"
        );
        assert_eq!(atoms[1].centre.z, -4.338, "with a chain");
    }

    #[test]
    fn what_is_broken_is_refused_in_one_line() {
        for (text, word) in [
            ("", "no atom"),
            ("ATOM 1 H A 1 0 0 0 0.1 0", "no atom with a radius"),
            ("ATOM", "line 1"),
            ("ATOM 1 2 3", "line 1"),
            (
                "\nATOM 1 N T 1 0 0 x 0 1",
                "line 2: 'x' is no finite number",
            ),
            ("ATOM 1 N T 1 0 0 NaN 0 1", "'NaN'"),
            ("ATOM 1 N T 1 0 0 1e30 0 1", "a coordinate is"),
            ("ATOM 1 N T 1 0 0 0 0 -1", "negative"),
            ("ATOM 1 N T 1 0 0 0 0 1e9", "the radius is"),
            (
                "ATOM \u{1b}[31m\u{0} aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa",
                "line 1",
            ),
        ] {
            let line = parse(text.as_bytes()).expect_err(text);
            assert!(line.contains(word), "{line}");
            assert!(
                !line.contains(char::is_control) && line.len() < 160,
                "{line}"
            );
        }
        assert!(parse(&[0xff; 100]).is_err(), "no text");
        let many = "ATOM 1 N T 1 0 0 0 0 1\n".repeat(MOST_ATOMS + 1);
        let line = parse(many.as_bytes()).expect_err("too many");
        assert!(line.starts_with("line 100001: more than"), "{line}");
    }
}
