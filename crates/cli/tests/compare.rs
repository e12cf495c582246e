//! `hemicube compare`, and the histories that `hemicube solve` writes.

mod common;

use common::{Folder, is_png, small};

const MESH: [&str; 6] = ["--elements", "300", "--patches", "60", "--rays", "64"];

#[test]
fn classic_comparison_has_a_picture_and_curves() {
    let folder = Folder::new();
    let args = [
        "compare", "cornell", "--steps", "20", "-o", "v.png", "--csv", "c.csv", "--size", "40x40",
    ];
    let report = folder.json(&[&args[..], &MESH].concat());
    assert!(is_png(&folder.path("v.png")), "a picture");
    assert_eq!(
        report["files"],
        serde_json::json!(["v.png", "c.csv"]),
        "both files"
    );
    let table = folder.text("c.csv");
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(
        lines[0],
        "step,gathering,shooting,sorted-shooting,ambient-shooting"
    );
    assert_eq!(
        lines.len(),
        22,
        "a header and a line for each step from 0 on"
    );
    let last: Vec<f64> = lines[21]
        .split(',')
        .map(|x| x.parse().expect("a number"))
        .collect();
    assert_eq!(last[0], 20.0, "the last step");
    assert!(
        last[4] < last[3] && last[3] < last[2] && last[3] < last[1],
        "in the known order: {last:?}"
    );
    for (variant, error) in report["variants"]
        .as_array()
        .expect("variants")
        .iter()
        .zip(&last[1..])
    {
        assert_eq!(variant["error"].as_f64(), Some(*error), "as in the table");
    }
}

#[test]
fn variants_can_be_chosen_and_threads_change_nothing() {
    let folder = Folder::new();
    let all = "gauss,jacobi,gauss-seidel,southwell,overshooting,conjugate-gradient";
    let compare = |threads, table| {
        let args = [
            "compare",
            "two-rooms",
            "--steps",
            "9",
            "--variants",
            all,
            "--csv",
            table,
            "--threads",
            threads,
        ];
        folder.done(&[&args[..], &MESH].concat())
    };
    let text = compare("1", "one.csv");
    compare("2", "two.csv");
    assert_eq!(
        folder.text("one.csv"),
        folder.text("two.csv"),
        "the same bits"
    );
    for name in all.split(',') {
        assert!(text.contains(name), "{name} in {text}");
    }
}

#[test]
fn comparison_of_what_cannot_be_is_refused() {
    let folder = Folder::new();
    folder.fails(2, &["compare", "cornell", "-o", "v.jpg"]);
    folder.fails(2, &["compare", "cornell", "--csv", "c.txt"]);
    let error = folder.fails(2, &["compare", "cornell", "--size", "9x9"]);
    assert!(error.contains("-o FILE.png"), "{error}");
    for args in [
        &["compare", "cornell", "--variants", "magic"][..],
        &["compare", "cornell", "--steps", "0"],
    ] {
        assert_eq!(folder.run(args).status.code(), Some(2), "{args:?}");
    }
    assert!(folder.files().is_empty(), "no output");
}

#[test]
fn histories_are_tables_and_plots() {
    let folder = Folder::new();
    folder.done(&small(&["solve", "cornell", "--convergence", "h.csv"]));
    let table = folder.text("h.csv");
    let mut lines = table.lines();
    assert_eq!(
        lines.next(),
        Some("step,seconds,unshot,residual,error_to_end,noise")
    );
    let rows: Vec<Vec<f64>> = lines
        .map(|line| {
            line.split(',')
                .map(|x| x.parse().unwrap_or(f64::NAN))
                .collect()
        })
        .collect();
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    assert_eq!(
        (first[0], first[2], first[4]),
        (0.0, 1.0, 1.0),
        "everything is unshot, nothing reflected"
    );
    assert!(last[2] <= 5e-4, "to the tolerance: {last:?}");
    for pair in rows.windows(2) {
        assert!(
            pair[1][0] > pair[0][0] && pair[1][1] >= pair[0][1],
            "steps and time ascend"
        );
        assert!(pair[1][2] < pair[0][2], "what is unshot falls: {pair:?}");
    }
    folder.done(&small(&[
        "solve",
        "cornell",
        "--convergence",
        "h.svg",
        "--solver",
        "gauss-seidel",
    ]));
    let svg = folder.text("h.svg");
    for word in ["<svg", "gauss-seidel", "steps", "100 %", "unshot"] {
        assert!(svg.contains(word), "'{word}' in {svg}");
    }
    folder.done(&small(&[
        "solve",
        "cornell",
        "--convergence",
        "h.png",
        "--solver",
        "gauss",
    ]));
    assert!(is_png(&folder.path("h.png")), "a picture");
    let error = folder.fails(2, &["solve", "cornell", "--convergence", "h.txt"]);
    assert!(error.contains("use .csv or .png or .svg"), "{error}");
}

#[test]
fn time_ends_a_comparison_and_nothing_is_written() {
    let folder = Folder::new();
    let error = folder.fails(
        1,
        &[
            "compare",
            "office",
            "--elements",
            "100000",
            "--time",
            "50ms",
            "-o",
            "v.png",
        ],
    );
    assert!(error.contains("--time: time was up"), "{error}");
    assert!(folder.files().is_empty(), "no file");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_comparison_and_nothing_is_written() {
    let folder = Folder::new();
    let args = [
        "compare",
        "office",
        "--elements",
        "200000",
        "--patches",
        "20000",
        "-o",
        "v.png",
    ];
    let child = folder.command(&args).spawn().expect("the program starts");
    std::thread::sleep(std::time::Duration::from_secs(2));
    let pid = child.id().to_string();
    let kill = std::process::Command::new("kill")
        .args(["-INT", &pid])
        .status();
    assert!(kill.expect("there is kill").success(), "it still ran");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130), "as other verbs");
    assert!(folder.files().is_empty(), "no file");
}
