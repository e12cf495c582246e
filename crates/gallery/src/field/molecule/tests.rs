use super::*;
use crate::field::testdata;
use std::fmt::Write as _;

/// A file in a folder of its own that is deleted in the end.
fn file(folder: &Path, name: &str, text: &str) -> std::path::PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("a temporary file can be written");
    path
}

const WATER: &str = "ATOM 1 O HOH 1 0.0 0.0 0.0 -0.834 1.77\nATOM 2 H1 HOH 1 0.957 0.0 0.0 0.417 0.0\n\
    ATOM 3 H2 HOH 1 -0.24 0.927 0.0 0.417 0.0\n";

/// The potential of a point charge on a grid around it.
fn charge_on_a_grid() -> String {
    let mut text = String::from(
        "# POTENTIAL (kT/e)\nobject 1 class gridpositions counts 21 21 21\norigin -5 -5 -5\n\
         delta 0.5 0 0\ndelta 0 0.5 0\ndelta 0 0 0.5\nobject 3 class array type double rank 0 items 9261 data follows\n",
    );
    for index in 0..9261 {
        let place = DVec3::new(
            f64::from(index / 441),
            f64::from(index / 21 % 21),
            f64::from(index % 21),
        );
        let r = (place * 0.5 - 5.0).length().max(0.5);
        let _ = writeln!(text, "{}", COULOMB / 80.0 / r);
    }
    text
}

#[test]
fn molecules_are_drawn_with_either_potential() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let atoms = file(folder.path(), "water.pqr", WATER);
    let grid = file(folder.path(), "charge.dx", &charge_on_a_grid());
    let request = |files: Vec<std::path::PathBuf>| Request {
        size: Some((64, 48)),
        files,
        ..Request::default()
    };
    let pieces = draw_with_grid(&request(vec![atoms.clone(), grid.clone()])).expect("a molecule");
    assert_eq!(pieces.len(), 2, "a picture, and one with its legend");
    let pieces = draw_with_charges(&request(vec![atoms.clone()])).expect("a molecule");
    assert_eq!(pieces[1].suffix, "-legend.png", "its name");
    for files in [vec![], vec![grid.clone(), atoms], vec![grid]] {
        let line = draw_with_grid(&request(files))
            .expect_err("the wrong files")
            .to_string();
        assert!(!line.contains('\n'), "{line}");
    }
}

#[test]
fn a_grid_elsewhere_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let atoms = file(folder.path(), "water.pqr", WATER);
    let text = charge_on_a_grid().replace("origin -5 -5 -5", "origin 50 -5 -5");
    let grid = file(folder.path(), "elsewhere.dx", &text);
    let request = Request {
        files: vec![atoms, grid],
        ..Request::default()
    };
    let line = draw_with_grid(&request).expect_err("no value").to_string();
    assert!(line.contains("does not meet its surface"), "{line}");
}

#[test]
fn coulomb_is_that_of_a_charge_in_its_medium() {
    let atom = Atom {
        centre: DVec3::ZERO,
        charge: 2.0,
        radius: 1.0,
    };
    // At 5 Å the permittivity is 20.
    let expected = 2.0 * 560.7 / (20.0 * 5.0);
    let found = f64::from(coulomb(&[atom], DVec3::X * 5.0));
    assert!((found / expected - 1.0).abs() < 1e-6, "{found}, {expected}");
    assert!(
        coulomb(&[atom], DVec3::ZERO).is_finite(),
        "in the charge itself"
    );
}

#[test]
fn a_real_molecule_has_its_area() {
    let Some(folder) = testdata("science/molecule") else {
        return;
    };
    let bytes = read(&folder.join("1crn_apbs.pqr")).expect("a file");
    let atoms = pqr::parse(&bytes).expect("atoms");
    assert_eq!(atoms.len(), 642, "crambin with its hydrogens");
    let balls = Balls::new(&atoms).expect("balls");
    let (meshed, counted) = (balls.mesh(0.6).area(), balls.counted_area(200));
    assert!(
        (meshed / counted - 1.0).abs() < 0.04,
        "{meshed} meshed, {counted} counted"
    );
    let file = File::open(folder.join("esp.dx")).expect("a file");
    let grid = Grid::read(BufReader::new(file)).expect("a grid");
    assert_eq!(
        grid.sample(DVec3::ZERO).map(f32::is_finite),
        Some(true),
        "inside"
    );
}

#[test]
fn ranges_are_symmetric_and_bear_anything() {
    let range = |values: &[f32]| paint(values).range;
    assert_eq!(range(&[]), [-5.0, 5.0], "nothing");
    assert_eq!(range(&[f32::NAN, 0.0]), [-5.0, 5.0], "nothing but 0");
    let values: Vec<f32> = (0..1000).map(|i| (i as f32 - 500.0) / 100.0).collect();
    let [low, high] = range(&values);
    assert!(low == -high && high >= 4.5, "{low} to {high}");
}

#[test]
fn grey_is_spoken_of_where_there_is_some() {
    assert_eq!(extent(&[1.0; 5]), "known on the whole surface");
    let mut values = vec![1.0; 4000];
    values[7] = f32::NAN;
    assert_eq!(
        extent(&values),
        "known on 99.9 % of the surface, grey elsewhere"
    );
    values.fill(f32::NAN);
    values[7] = 0.0;
    assert_eq!(
        extent(&values),
        "known on 0.1 % of the surface, grey elsewhere"
    );
}
