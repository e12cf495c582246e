//! `hemicube form-factors`: matrices for thermal models.

mod common;

use common::Folder;
use serde_json::Value;

/// The unit cube seen from within.
const CUBE: &str = "\
T The unit cube
C encl=1
F 3
V 1 0. 0. 0.
V 2 1. 0. 0.
V 3 1. 1. 0.
V 4 0. 1. 0.
V 5 0. 0. 1.
V 6 1. 0. 1.
V 7 1. 1. 1.
V 8 0. 1. 1.
S 1   1 2 3 4   0 0  0.50  zeq0
S 2   1 4 8 5   0 0  0.50  xeq0
S 3   1 5 6 2   0 0  0.50  yeq0
S 4   7 6 5 8   0 0  0.50  zeq1
S 5   7 3 2 6   0 0  0.50  xeq1
S 6   7 8 4 3   0 0  0.50  yeq1
End of data
";

const OPPOSITE: f64 = 0.199_824_9;
const BESIDE: f64 = 0.200_043_8;

fn with_cube() -> Folder {
    let folder = Folder::new();
    folder.write("cube.vs3", CUBE);
    folder
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list");
    list.iter().map(|x| x.as_f64().expect("a number")).collect()
}

#[test]
fn small_matrices_are_printed_and_none_is_written() {
    let folder = with_cube();
    let text = folder.done(&["form-factors", "cube.vs3"]);
    for part in [
        "The unit cube",
        "6 x 6 by object",
        "corrected",
        "zeq0",
        "0.20004",
        "0.19982",
    ] {
        assert!(text.contains(part), "'{part}' is not in {text}");
    }
    assert_eq!(folder.files(), ["cube.vs3"], "no file");
}

#[test]
fn the_cube_has_its_factors() {
    let folder = with_cube();
    let report = folder.json(&["form-factors", "cube.vs3"]);
    assert_eq!(
        report["by"], "object",
        "surfaces of a .vs3 file are its objects"
    );
    assert_eq!(report["corrected"], true, "the file says encl=1");
    for (i, row) in report["factors"]
        .as_array()
        .expect("rows")
        .iter()
        .enumerate()
    {
        for (j, factor) in numbers(row).into_iter().enumerate() {
            let expected = match (i, j) {
                _ if i == j => 0.0,
                _ if i % 3 == j % 3 => OPPOSITE,
                _ => BESIDE,
            };
            assert!(
                (factor - expected).abs() < 2e-4,
                "({i}, {j}) is {factor}, not {expected}"
            );
        }
    }
    let first = &report["surfaces"][0];
    assert_eq!(first["name"], "zeq0", "its name");
    assert_eq!(first["area"], 1.0, "its area");
    assert_eq!(first["emissivity"], 0.5, "its emissivity");
    assert!(
        report["closure_error"].as_f64().expect("a number") < 1e-6,
        "rows sum to 1"
    );
}

#[test]
fn the_ending_says_how_it_is_written() {
    let folder = with_cube();
    for ending in ["csv", "npy", "mtx", "out"] {
        let file = format!("F.{ending}");
        let text = folder.done(&["form-factors", "cube.vs3", "-o", &file]);
        assert!(text.contains(&format!("wrote     {file}")), "{text}");
    }
    assert!(
        folder.text("F.csv").starts_with(
            "name,area,zeq0,xeq0,yeq0,zeq1,xeq1,yeq1,sky,absorbed,transmitted\nzeq0,1,0,"
        ),
        "CSV"
    );
    assert_eq!(
        folder.read("F.npy").len(),
        128 + 4 * 36,
        "NumPy: a header and 36 numbers"
    );
    assert!(
        folder.text("F.mtx").contains("\n6 6 30\n1 2 "),
        "Matrix Market: no zeros"
    );
    let out = folder.text("F.out");
    assert!(
        out.starts_with("View3D 4.0.0 0 1 0 6          \n1 1 1 1 1 1\n0.000000 0.2"),
        "View3D: {out}"
    );
    assert!(
        out.ends_with("\n0.500 0.500 0.500 0.500 0.500 0.500\n"),
        "View3D: {out}"
    );
    assert_eq!(
        folder.files().len(),
        5,
        "no temporary file stays: {:?}",
        folder.files()
    );
}

#[test]
fn every_method_gives_about_the_same_and_each_run_exactly() {
    let folder = with_cube();
    for method in ["raycast", "hemicube"] {
        let args = [
            "form-factors",
            "cube.vs3",
            "--method",
            method,
            "--elements",
            "96",
        ];
        let report = folder.json(&args);
        let factors = numbers(&report["factors"][0]);
        assert!(
            (factors[3] - OPPOSITE).abs() < 1e-3,
            "{method}: {}",
            factors[3]
        );
        let again = folder.json(&[&args[..], &["--threads", "1"]].concat());
        assert_eq!(
            report["factors"], again["factors"],
            "{method}: the same on one thread"
        );
    }
}

#[test]
fn faces_and_objects_of_a_built_in_scene() {
    let folder = Folder::new();
    let faces = folder.json(&["form-factors", "cornell"]);
    let objects = folder.json(&["form-factors", "cornell", "--by", "object"]);
    let count = |report: &Value| report["surfaces"].as_array().expect("a list").len();
    assert!(
        count(&faces) > count(&objects),
        "{} faces, {} objects",
        count(&faces),
        count(&objects)
    );
    let open = objects["sky"]["mean"].as_f64().expect("a number");
    assert!(open > 0.01, "the box is open in front: {open}");
    let area = |report: &Value| -> f64 {
        let surfaces = report["surfaces"].as_array().expect("a list");
        surfaces
            .iter()
            .map(|s| s["area"].as_f64().expect("an area"))
            .sum()
    };
    assert!(
        (area(&faces) / area(&objects) - 1.0).abs() < 1e-9,
        "the same area"
    );
}

#[test]
fn large_matrices_are_not_printed() {
    let folder = Folder::new();
    let text = folder.done(&["form-factors", "cornell"]);
    assert!(text.contains("-o F.csv"), "it says how to get them: {text}");
    assert!(text.lines().count() < 12, "only the report: {text}");
}

#[test]
fn an_open_enclosure_is_noted() {
    let folder = Folder::new();
    folder.write("cube.vs3", &CUBE.replace("S 6 ", "! 6 "));
    let output = folder.run(&["form-factors", "cube.vs3"]);
    let notes = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && notes.contains("the enclosure is open: 20 %"),
        "{notes}"
    );
    let quiet = folder.run(&["form-factors", "cube.vs3", "--quiet"]);
    assert!(quiet.stderr.is_empty(), "no notes");
}

#[test]
fn scene_options_hold() {
    let folder = Folder::new();
    let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1000 0 0\nvertex 0 1000 0\nendloop\nendfacet\nendsolid\n\
                solid b\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 500\nvertex 0 1000 500\nvertex 1000 0 500\nendloop\nendfacet\nendsolid\n";
    folder.write("part.stl", text);
    let report = folder.json(&[
        "form-factors",
        "part.stl",
        "--unit",
        "mm",
        "--reflectance",
        "a=0.25",
    ]);
    let surfaces = report["surfaces"].as_array().expect("a list");
    assert!(
        (surfaces[0]["area"].as_f64().expect("an area") - 0.5).abs() < 1e-6,
        "half a square metre"
    );
    assert_eq!(surfaces[0]["emissivity"], 0.75, "1 - 0.25");
    assert_eq!(surfaces[1]["name"], "b", "solids are objects");
    let hidden = folder.json(&["form-factors", "part.stl", "--hide", "b"]);
    assert_eq!(
        hidden["surfaces"].as_array().expect("a list").len(),
        1,
        "one is left"
    );
}

#[test]
fn what_makes_no_sense_is_refused_before_the_work() {
    let folder = with_cube();
    let line = folder.fails(2, &["form-factors", "cube.vs3", "-o", "F.xlsx"]);
    assert!(line.contains(".csv or .npy or .mtx or .out"), "{line}");
    let line = folder.fails(
        2,
        &[
            "form-factors",
            "cube.vs3",
            "--method",
            "hemicube",
            "--rays",
            "9",
        ],
    );
    assert!(line.contains("--rays is for --method raycast"), "{line}");
    let line = folder.fails(
        2,
        &["form-factors", "cube.vs3", "--hemicube-resolution", "64"],
    );
    assert!(
        line.contains("--hemicube-resolution is for --method hemicube"),
        "{line}"
    );
    let line = folder.fails(1, &["form-factors", "cube.vs3", "-o", "no/F.csv"]);
    assert!(line.contains("does not exist"), "{line}");
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    let line = folder.fails(1, &["form-factors", "flat.obj"]);
    assert!(
        line.contains("flat.obj") || line.contains("'flat'"),
        "{line}"
    );
    folder.write("bad.vs3", &CUBE.replace("S 3 ", "S 2 "));
    let line = folder.fails(1, &["form-factors", "bad.vs3"]);
    assert!(
        line.contains("bad.vs3: line 14: surface 2 stands where surface 3 is due"),
        "{line}"
    );
    assert!(
        !folder.files().iter().any(|f| f.starts_with("F.")),
        "nothing is written"
    );
}

#[test]
fn a_vs3_room_is_informed_about_and_solved() {
    let folder = with_cube();
    let info = folder.done(&["info", "cube.vs3"]);
    assert!(
        info.contains("zeq0") && info.contains("radiometric"),
        "{info}"
    );
    let room = CUBE.replace("End of data", "O 7 1 2 3 4 0 0 0 board\nEnd");
    folder.write("room.vs3", &room);
    assert!(
        folder.done(&["info", "room.vs3"]).contains("only blocks"),
        "obstructions are told"
    );
    let args = [
        "solve",
        "cube.vs3",
        "--emit",
        "zeq0=100",
        "--elements",
        "200",
        "--patches",
        "24",
        "-o",
        "lit.glb",
    ];
    let report = folder.json(&args);
    assert_eq!(report["flux_unit"], "W", "heat");
    assert!(
        report["balance"][1]["relative_error"]
            .as_f64()
            .expect("a number")
            < 1e-3,
        "{report}"
    );
    let again = folder.json(&["form-factors", "lit.glb"]);
    assert_eq!(
        again["corrected"], true,
        "a lit file keeps what its scene asks for"
    );
}

/// A mask on one face of the cube: its row, its column and the whole area of its base.
#[test]
fn masks_are_rows() {
    let folder = Folder::new();
    let masked = CUBE.replace("encl=1", "encl=0").replace(
        "S 2 ",
        "V 9 .5 0. 0.\nV 10 .5 1. 0.\nM 2   4 10 9 1   1 0  0.30  mask\nS 3 ",
    );
    let masked = masked
        .replace("S 3   1 5", "S 4   1 5")
        .replace("S 4   7", "S 5   7")
        .replace("S 5   7 3", "S 6   7 3")
        .replace("S 6   7 8", "S 7   7 8");
    folder.write("masked.vs3", &masked);
    let report = folder.json(&["form-factors", "masked.vs3"]);
    let surface = |i: usize, what: &str| report["surfaces"][i][what].clone();
    assert_eq!(surface(1, "name"), "mask", "it has a row of its own");
    assert_eq!(surface(1, "emissivity"), 0.3f32 as f64, "its emissivity");
    assert_eq!(surface(0, "area"), 1.0, "the base with the covered half");
    assert_eq!(surface(1, "area"), 0.5, "the mask");
    assert_eq!(
        numbers(&report["factors"][1])[0],
        1.0,
        "it sees its base alone"
    );
    assert_eq!(
        numbers(&report["factors"][0])[1],
        0.5,
        "which sees it by half"
    );
    let opposite = numbers(&report["factors"][0])[4];
    assert!((opposite - OPPOSITE / 2.0).abs() < 1e-5, "{opposite}");
    assert_eq!(
        report["warnings"].as_array().map(Vec::len),
        Some(0),
        "no warning"
    );
}

#[test]
fn a_correction_says_what_it_changed() {
    let folder = with_cube();
    let args = [
        "form-factors",
        "cube.vs3",
        "--method",
        "hemicube",
        "--hemicube-resolution",
        "64",
    ];
    let report = folder.json(&args);
    let change = |what: &str| report["correction"][what].as_f64().expect("a number");
    assert!(
        change("largest") > 0.0 && change("largest") < 0.05,
        "{report}"
    );
    assert!(
        change("rms") > 0.0 && change("rms") <= change("largest"),
        "{report}"
    );
    let text = folder.done(&["form-factors", "cube.vs3"]);
    assert!(text.contains("changed   by at most"), "{text}");
    let plain = folder.json(&["form-factors", "cornell"]);
    assert!(plain["correction"].is_null(), "nothing was corrected");
}

/// View3D computes it without a word, and rows that see both sum to more than 1.
#[test]
fn surfaces_in_one_place_are_told_of() {
    let folder = Folder::new();
    let twice = CUBE.replace("encl=1", "encl=0").replace(
        "End of data",
        "V 9 .5 .5 1.\nV 10 1.5 .5 1.\nV 11 1.5 1.5 1.\nV 12 .5 1.5 1.\nS 7   11 10 9 12   0 0  0.50  poster\nEnd",
    );
    folder.write("twice.vs3", &twice);
    let text = folder.done(&["form-factors", "twice.vs3"]);
    let warning = text.lines().find(|line| line.starts_with("warning: "));
    let warning = warning.unwrap_or_else(|| panic!("a warning in {text}"));
    for part in [
        "'zeq1' and 'poster'",
        "area of 0.2500",
        "the base of the other",
    ] {
        assert!(warning.contains(part), "'{part}' is not in {warning}");
    }
    let report = folder.json(&["form-factors", "twice.vs3"]);
    assert_eq!(
        report["overlaps"][0]["between"],
        serde_json::json!(["zeq1", "poster"])
    );
    assert!(
        folder.json(&["form-factors", "cornell"])["overlaps"]
            .as_array()
            .is_some_and(Vec::is_empty),
        "none in a clean scene"
    );
}

#[test]
fn quiet_leaves_hints_out() {
    let folder = Folder::new();
    let args = ["form-factors", "two-rooms"];
    assert!(folder.done(&args).contains("no file"), "a hint");
    let quiet = folder.done(&[&args[..], &["-q"]].concat());
    assert!(!quiet.contains("no file"), "{quiet}");
}
