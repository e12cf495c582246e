//! The exhibits of environment mapping: they draw, and their figures are right.

use hemicube_gallery::{Exhibit, GalleryError, Piece, Request, exhibits};
use hemicube_raster::Rgb;
use hemicube_raster::environment::{EnvironmentMap, FACE_NAMES, Projection};

fn exhibit(name: &str) -> &'static Exhibit {
    exhibits()
        .find(|e| e.name == name)
        .unwrap_or_else(|| panic!("no exhibit {name}"))
}

fn drawn(name: &str, size: (usize, usize)) -> Vec<Piece> {
    let request = Request {
        size: Some(size),
        ..Request::default()
    };
    let pieces = (exhibit(name).draw)(&request).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert!(
        pieces.iter().any(|p| p.suffix == ".png"),
        "{name} has a picture"
    );
    pieces
}

/// Rows of its table, without the header.
fn table(pieces: &[Piece]) -> Vec<Vec<String>> {
    let csv = pieces
        .iter()
        .find(|p| p.suffix.ends_with(".csv"))
        .expect("a table");
    let text = String::from_utf8(csv.bytes.clone()).expect("text");
    let cells = |line: &str| line.split(',').map(str::to_owned).collect();
    text.lines().skip(1).map(cells).collect()
}

fn number(cell: &str) -> f64 {
    cell.parse()
        .unwrap_or_else(|_| panic!("'{cell}' is no number"))
}

#[test]
fn projections_keep_their_light() {
    let rows = table(&drawn("environment-projections", (64, 64)));
    assert_eq!(rows.len(), 8, "all projections");
    for row in rows {
        assert!(number(&row[4]).abs() < 1e-11, "{row:?}: solid angles");
        let is_whole = !["fisheye", "hemispherical"].contains(&row[0].as_str());
        assert!(!is_whole || number(&row[6]) < 1e-6, "{row:?}: flux");
    }
}

#[test]
fn spheres_are_drawn() {
    drawn("environment-spheres", (64, 64));
}

#[test]
fn harmonics_come_closer_by_degree() {
    let rows = table(&drawn("irradiance-map", (64, 64)));
    let error = |name: &str, degree: &str| {
        let row = rows
            .iter()
            .find(|r| r[0] == name && r[1] == degree)
            .expect("a row");
        number(&row[2])
    };
    for name in ["evening", "one small lamp"] {
        assert!(error(name, "0") > error(name, "1"), "{name}");
        assert!(error(name, "1") > 3.0 * error(name, "2"), "{name}");
        assert!(error(name, "4") > error(name, "8"), "{name}");
    }
    assert!(error("evening", "2") < 0.05, "nine numbers do for a sky");
}

#[test]
fn parallax_is_corrected() {
    let rows = table(&drawn("parallax-correction", (64, 64)));
    let errors: Vec<f64> = rows.iter().map(|row| number(&row[1])).collect();
    assert!(errors[2] < 0.6 * errors[0].min(errors[1]), "{errors:?}");
}

#[test]
fn files_of_faces_are_drawn_as_well() {
    let folder = tempfile::tempdir().expect("a folder for a test");
    let cube =
        EnvironmentMap::from_fn(Projection::Cube, 16, 1, |d| Rgb::from((d + 1.0).to_array()));
    for (face, name) in cube.faces().iter().zip(FACE_NAMES) {
        let mut file = Vec::new();
        face.write_hdr(&mut file).expect("Radiance");
        std::fs::write(folder.path().join(format!("{name}.hdr")), file).expect("a file");
    }
    let table_of = |files| {
        let request = Request {
            size: Some((64, 64)),
            files: vec![files],
            ..Request::default()
        };
        let pieces = (exhibit("environment-projections-file").draw)(&request);
        table(&pieces.unwrap_or_else(|e| panic!("{e}")))
    };
    let of_folder = table_of(folder.path().to_path_buf());
    assert_eq!(of_folder, table_of(folder.path().join("{face}.hdr")));
}

#[test]
fn sizes_and_files_that_make_no_sense_are_refused() {
    for name in [
        "environment-projections",
        "environment-spheres",
        "irradiance-map",
        "parallax-correction",
    ] {
        let request = Request {
            size: Some((10, 10)),
            ..Request::default()
        };
        let result = (exhibit(name).draw)(&request);
        assert!(matches!(result, Err(GalleryError::Size { .. })), "{name}");
    }
    for name in ["environment-projections-file", "environment-spheres-file"] {
        for files in [vec![], vec!["/nowhere/sky.hdr".into()]] {
            let request = Request {
                files,
                ..Request::default()
            };
            let error = (exhibit(name).draw)(&request)
                .expect_err("no file")
                .to_string();
            assert!(!error.contains('\n'), "{error}");
        }
    }
}
