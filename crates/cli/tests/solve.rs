//! `hemicube solve`: files, reports, going on.

mod common;

use common::{Folder, is_png, small};

const POINTS: &str = "x,y,z,nx,ny,nz\n100,1,100,0,1,0\n278,300,279,0,1,0\n400,1,400,0,1,0\n";

#[test]
fn furnace_has_the_closed_form_and_both_files() {
    let folder = Folder::new();
    let report = folder.json(&small(&[
        "solve", "furnace", "-o", "lit.glb", "--image", "view.png", "--size", "60x40",
    ]));
    assert!(is_png(&folder.path("view.png")), "a picture");
    assert_eq!(
        report["files"],
        serde_json::json!(["lit.glb", "view.png"]),
        "the files that were written"
    );
    assert_eq!(report["stopped"], "finished", "within the tolerance");
    for band in report["balance"]
        .as_array()
        .expect("a balance for each band")
    {
        let number = |name: &str| band[name].as_f64().expect("a number");
        let sum = number("absorbed") + number("unshot") + number("escaped");
        assert!(
            (number("emitted") - sum).abs() <= 1e-5 * number("emitted"),
            "energy balances: {band}"
        );
        assert!(number("relative_error") < 1e-5, "and says so: {band}");
    }
    // B = E / (1 - rho) = 2, so every point receives 2.
    folder.write("in.csv", "0.5,0.5,0.5,0,1,0\n");
    let measured = folder.json(&["measure", "lit.glb", "--points", "in.csv"]);
    let irradiance = measured["points"][0]["irradiance"][0]
        .as_f64()
        .expect("a number");
    assert!(
        (irradiance - 2.0).abs() < 0.01,
        "irradiance {irradiance}, up to what is unshot"
    );
}

#[test]
fn report_for_people_tells_all() {
    let folder = Folder::new();
    let text = folder.done(&small(&["solve", "cornell"]));
    for word in [
        "cornell", "elements", "patches", "steps", "rays", "unshot", "emitted", "absorbed",
        "escaped", "error",
    ] {
        assert!(text.contains(word), "'{word}' in {text}");
    }
    assert!(
        folder.files().is_empty(),
        "no file was asked for: {:?}",
        folder.files()
    );
}

#[test]
fn resuming_equals_one_go() {
    let folder = Folder::new();
    folder.write("in.csv", POINTS);
    folder.done(&small(&[
        "solve",
        "cornell",
        "-o",
        "whole.glb",
        "--tolerance",
        "0",
        "--iterations",
        "120",
    ]));
    folder.done(&small(&[
        "solve",
        "cornell",
        "-o",
        "half.glb",
        "--tolerance",
        "0",
        "--iterations",
        "50",
    ]));
    folder.done(&[
        "solve",
        "--resume",
        "half.glb",
        "-o",
        "more.glb",
        "--tolerance",
        "0",
        "--iterations",
        "70",
    ]);
    let values = |lit: &str| folder.done(&["measure", lit, "--points", "in.csv", "-q"]);
    assert_eq!(
        values("more.glb"),
        values("whole.glb"),
        "the same values to the bit"
    );
    assert_ne!(
        values("half.glb"),
        values("whole.glb"),
        "and not because nothing happened"
    );
    let info = folder.json(&["info", "more.glb"]);
    assert_eq!(info["solution"]["steps"], 120, "steps go on counting");
}

#[test]
fn resuming_may_overwrite_its_own_file() {
    let folder = Folder::new();
    folder.done(&small(&[
        "solve",
        "furnace",
        "-o",
        "lit.glb",
        "--iterations",
        "10",
    ]));
    folder.done(&[
        "solve",
        "lit.glb",
        "--resume",
        "lit.glb",
        "-o",
        "lit.glb",
        "--iterations",
        "10",
    ]);
    assert_eq!(
        folder.json(&["info", "lit.glb"])["solution"]["steps"],
        20,
        "ten and ten"
    );
    assert_eq!(folder.files(), ["lit.glb"], "and nothing beside it");
}

#[test]
fn lit_file_is_a_scene_too() {
    let folder = Folder::new();
    folder.done(&small(&[
        "solve",
        "furnace",
        "-o",
        "lit.glb",
        "--reflectance",
        "*=0.25",
    ]));
    let again = folder.json(&small(&["solve", "lit.glb"]));
    // A closed scene absorbs what is emitted, whatever it reflects.
    let (emitted, absorbed) = (
        again["balance"][0]["emitted"].as_f64(),
        again["balance"][0]["absorbed"].as_f64(),
    );
    assert!(
        emitted > Some(0.0) && absorbed > emitted.map(|e| 0.99 * e),
        "solved afresh: {again}"
    );
    let info = folder.json(&["info", "lit.glb"]);
    assert_eq!(
        info["materials"][0]["reflectance"]["r"].as_f64(),
        Some(0.25),
        "as it was adjusted: {}",
        info["materials"]
    );
}

#[test]
fn threads_change_nothing() {
    let folder = Folder::new();
    folder.write("in.csv", POINTS);
    let solve = |threads, lit| {
        folder.done(&small(&[
            "solve",
            "cornell",
            "--threads",
            threads,
            "-o",
            lit,
        ]))
    };
    solve("1", "one.glb");
    solve("2", "two.glb");
    let values = |lit: &str, threads: &str| {
        folder.done(&["measure", lit, "--points", "in.csv", "--threads", threads])
    };
    assert_eq!(
        values("one.glb", "1"),
        values("two.glb", "2"),
        "the same bits"
    );
    let picture = |lit, name, threads| {
        folder.done(&[
            "render",
            lit,
            "-o",
            name,
            "--size",
            "48x48",
            "--threads",
            threads,
        ]);
        folder.read(name)
    };
    assert_eq!(
        picture("one.glb", "1.png", "1"),
        picture("two.glb", "2.png", "2"),
        "the same picture"
    );
}

#[test]
fn time_ends_it_with_a_file_to_go_on_from() {
    let folder = Folder::new();
    let output = folder.run(&[
        "solve",
        "two-rooms",
        "--quality",
        "final",
        "--tolerance",
        "0",
        "--time",
        "3s",
        "-o",
        "lit.glb",
    ]);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{errors}");
    assert!(
        errors.contains("time is up") && errors.contains("--resume lit.glb"),
        "{errors}"
    );
    assert!(
        folder.json(&["info", "lit.glb"])["solution"]["unshot_fraction"].as_f64() > Some(0.0),
        "not finished"
    );
}

#[test]
fn any_solver_goes_on_from_a_file_with_any_form_factors() {
    let folder = Folder::new();
    folder.done(&small(&[
        "solve",
        "cornell",
        "-o",
        "lit.glb",
        "--iterations",
        "5",
    ]));
    for (solver, method) in [
        ("gauss-seidel", "raycast"),
        ("southwell", "hemicube"),
        ("conjugate-gradient", "hemicube"),
        ("overshooting", "raycast"),
    ] {
        let mut args = vec!["solve", "--resume", "lit.glb", "-o", "lit.glb"];
        args.extend(["--solver", solver, "--form-factors", method]);
        args.extend(["--iterations", "3", "--tolerance", "1e-6"]);
        if method == "hemicube" {
            args.extend(["--hemicube-resolution", "64"]);
        }
        let report = folder.json(&args);
        assert_eq!(report["solver"], solver, "the report says who");
        assert_eq!(report["form_factors"], method, "and how");
        for band in report["balance"].as_array().expect("bands") {
            assert!(
                band["relative_error"].as_f64() < Some(1e-5),
                "{solver}: {band}"
            );
        }
    }
    // What is not said is as it was.
    let report = folder.json(&[
        "solve",
        "--resume",
        "lit.glb",
        "--iterations",
        "1",
        "--tolerance",
        "0",
    ]);
    assert_eq!(report["solver"], "overshooting", "the last solver");
    assert_eq!(report["hemicube_resolution"], 64, "the resolution is kept");
    let info = folder.json(&["info", "lit.glb"]);
    assert_eq!(
        info["solution"]["solver"], "overshooting",
        "the file says who was last"
    );
}

#[test]
fn matrices_that_do_not_fit_are_refused_in_words() {
    let folder = Folder::new();
    for solver in ["gauss", "southwell", "jacobi"] {
        let error = folder.fails(
            1,
            &[
                "solve",
                "cornell",
                "--solver",
                solver,
                "--patches",
                "3000",
                "--matrix-memory",
                "10",
            ],
        );
        assert!(
            error.contains("patches") && error.contains("10 MiB are allowed; use at most"),
            "{error}"
        );
    }
}

#[test]
fn meshes_that_do_not_fit_are_refused_with_what_would() {
    let folder = Folder::new();
    let size = &["--element-size", "0.0001"][..];
    for too_fine in [&["--elements", "100000000"][..], size] {
        let args = ["solve", "cornell", "-o", "lit.glb", "--solver", "shooting"];
        let args = [&args[..], too_fine].concat();
        let error = folder.fails(1, &args);
        assert!(
            error.contains("would take about") && error.contains("elements, about"),
            "{error}"
        );
    }
}

#[test]
fn a_shot_has_the_rays_that_were_asked_for() {
    let folder = Folder::new();
    let base = [
        "solve",
        "cornell",
        "--solver",
        "shooting",
        "--shot-rays",
        "500",
    ];
    let file = ["-o", "lit.glb", "--iterations", "7", "--elements", "200"];
    let report = folder.json(&[&base[..], &file].concat());
    assert_eq!(report["rays"], 7 * 500, "{report}");
    let info = folder.json(&["info", "lit.glb"]);
    assert_eq!(info["solution"]["shot_rays"], 500, "{info}");
}

#[test]
fn time_also_holds_before_the_first_step() {
    let folder = Folder::new();
    let error = folder.fails(
        1,
        &[
            "solve",
            "office",
            "--elements",
            "400000",
            "--solver",
            "stochastic",
            "--time",
            "50ms",
            "-o",
            "lit.glb",
        ],
    );
    assert!(
        error.contains("time was up while the mesh was built"),
        "{error}"
    );
    assert!(folder.files().is_empty(), "nothing is written");
    let start = std::time::Instant::now();
    let output = folder.run(&[
        "solve",
        "two-rooms",
        "--elements",
        "20000",
        "--patches",
        "4000",
        "--rays",
        "4096",
        "--solver",
        "jacobi",
        "--time",
        "5s",
        "-o",
        "lit.glb",
    ]);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        output.status.success() && errors.contains("time is up"),
        "{errors}"
    );
    // Far from the minutes that all rows take; other tests run at the same time.
    assert!(
        start.elapsed().as_secs() < 30,
        "it took {:?}",
        start.elapsed()
    );
}

#[cfg(unix)]
#[test]
fn first_interrupt_writes_what_was_reached() {
    let folder = Folder::new();
    let args = [
        "solve",
        "two-rooms",
        "--quality",
        "final",
        "--tolerance",
        "0",
        "-o",
        "lit.glb",
    ];
    let child = folder.command(&args).spawn().expect("the program starts");
    std::thread::sleep(std::time::Duration::from_millis(700));
    let kill = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(
        kill.is_ok_and(|status| status.success()),
        "the signal is sent"
    );
    let output = child.wait_with_output().expect("the program ends");
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{errors}");
    assert!(
        errors.contains("stopped at") && errors.contains("go on with --resume lit.glb"),
        "{errors}"
    );
    assert_eq!(folder.files(), ["lit.glb"], "the file and nothing else");
    assert_eq!(
        folder.json(&["info", "lit.glb"])["solution"]["solver"],
        "ambient-shooting",
        "it can be read"
    );
}

#[cfg(unix)]
#[test]
fn files_have_the_usual_permissions() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = Folder::new();
    folder.write("plain", "");
    folder.done(&small(&["solve", "furnace", "-o", "lit.glb"]));
    let mode = |name: &str| {
        std::fs::metadata(folder.path(name))
            .expect("it is there")
            .permissions()
            .mode()
    };
    assert_eq!(mode("lit.glb"), mode("plain"), "as any new file");
}

#[test]
fn links_are_drawn_of_the_solver_that_has_them() {
    let folder = Folder::new();
    let solve = ["solve", "cornell", "--quality", "draft", "--solver"];
    let links = |solver: &'static str, file: &'static str| {
        let mut all = solve.to_vec();
        all.extend([solver, "--links", file, "--size", "96x96"]);
        all
    };
    for file in ["links.png", "links.svg"] {
        folder.done(&links("hierarchical", file));
    }
    assert!(is_png(&folder.path("links.png")), "a picture");
    let lines = folder.text("links.svg").matches("<polyline").count();
    assert!(lines > 100, "{lines} lines");
    let error = folder.fails(2, &links("shooting", "other.png"));
    assert!(
        error.contains("--links is of --solver hierarchical; shooting has none"),
        "{error}"
    );
}

/// A cube of 2 m that emits, seen from inside, with one side turned around and a tile in the plane of its floor.
fn faulty_room() -> String {
    let mut obj = String::from("mtllib room.mtl\no room\n");
    for i in 0..8 {
        let coordinate = |bit: i32| 2 * (i >> bit & 1);
        obj += &format!("v {} {} {}\n", coordinate(0), coordinate(1), coordinate(2));
    }
    obj += "usemtl paint\nf 3 7 5 1\nf 5 7 8 6\nf 6 5 1 2\nf 4 8 7 3\nf 3 1 2 4\n";
    // The sixth side shows the others its back.
    obj += "f 2 4 8 6\n";
    obj +=
        "o tile\nv 0.5 0 0.5\nv 0.5 0 1.5\nv 1.5 0 1.5\nv 1.5 0 0.5\nusemtl lamp\nf 9 10 11 12\n";
    obj
}

#[test]
fn a_faulty_model_is_mended_unless_told_otherwise() {
    let folder = Folder::new();
    folder.write("room.obj", &faulty_room());
    folder.write(
        "room.mtl",
        "newmtl paint\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0.5 0.5 0.5\nKe 5 5 5\n",
    );
    let mended = folder.json(&small(&["solve", "room.obj"]))["warnings"].to_string();
    for word in ["6 connected faces turned around", "'tile'", "lifted by"] {
        assert!(mended.contains(word), "'{word}' in {mended}");
    }
    let kept = folder.json(&small(&["solve", "room.obj", "--no-clean"]))["warnings"].to_string();
    assert!(
        !kept.contains("turned") && !kept.contains("lifted"),
        "{kept}"
    );
}

#[test]
fn elements_are_cut_where_light_varies_and_the_file_keeps_them() {
    let folder = Folder::new();
    let adaptive = ["--adaptive", "0.2", "--smallest", "60"];
    let solve = [
        "solve",
        "cornell",
        "-o",
        "fine.glb",
        "--convergence",
        "way.csv",
    ];
    let report = folder.json(&small(&[&solve[..], &adaptive].concat()));
    let number = |report: &serde_json::Value, name: &str| report[name].as_u64().expect("a number");
    let elements = number(&report, "elements");
    assert!(elements > number(&report, "unrefined_elements"), "{report}");
    assert_eq!(report["stopped"], "finished", "{report}");
    let wanted = report["contrast"]["wanted"].as_f64();
    assert!((wanted.unwrap_or(0.0) - 0.2).abs() < 1e-6, "{report}");
    let lines = folder.text("way.csv").lines().count() as u64;
    assert!(lines > 10, "the way through all rounds: {lines} lines");

    let again = folder.json(&[
        "solve",
        "--resume",
        "fine.glb",
        "--tolerance",
        "1e-3",
        "-o",
        "on.glb",
    ]);
    assert_eq!(number(&again, "elements"), elements, "the mesh of the file");
    let text = folder.done(&small(&[&["solve", "cornell"][..], &adaptive].concat()));
    for word in ["before refinement", "contrast"] {
        assert!(text.contains(word), "'{word}' in {text}");
    }
}

#[test]
fn elements_are_cut_as_asked_and_files_remember_how() {
    let folder = Folder::new();
    let cuts = |more: &[&str]| {
        let report =
            folder.json(&[&small(&["solve", "cornell", "-o", "lit.glb"])[..], more].concat());
        let number = |what: &str| report["cuts"][what].as_u64().expect("a number");
        (number("joints"), number("shadow_lines"))
    };
    let (joints, lines) = cuts(&[]);
    assert!(
        joints == 8 && lines == 0,
        "the feet of two blocks: {joints} and {lines}"
    );
    assert_eq!(cuts(&["--no-joints"]), (0, 0), "nothing is cut");
    let (joints, lines) = cuts(&["--discontinuities"]);
    assert!(
        joints == 8 && lines > 20,
        "shadows of two blocks: {joints} and {lines}"
    );
    let resumed = folder.json(&["solve", "--resume", "lit.glb", "--tolerance", "0.01"]);
    assert_eq!(
        resumed["cuts"]["shadow_lines"], lines,
        "the same mesh is built again"
    );
    let text = folder.done(&small(&["solve", "cornell", "--discontinuities"]));
    assert!(
        text.contains(&format!("cut along 8 joints and {lines} shadow lines")),
        "{text}"
    );
    let refused = folder.fails(2, &["solve", "--resume", "lit.glb", "--no-joints"]);
    assert!(refused.contains("--no-joints"), "{refused}");
}

#[test]
fn stages_of_rays_tell_what_they_cost() {
    let folder = Folder::new();
    let solve = [
        "solve",
        "cornell",
        "--solver",
        "stochastic",
        "--noise",
        "0.2",
    ];
    let report = folder.json(&small(&solve));
    let stages = report["stages"].as_array().expect("a list");
    let names: Vec<_> = stages.iter().map(|s| s["stage"].as_str()).collect();
    assert_eq!(
        names,
        ["direct", "spreading", "gathering"].map(Some),
        "{report}"
    );
    let rays = stages.iter().map(|s| s["rays"].as_u64().unwrap_or(0));
    assert_eq!(Some(rays.sum()), report["rays"].as_u64(), "all of them");
    for stage in stages {
        let [rays, seconds, rate] =
            ["rays", "seconds", "rays_per_second"].map(|n| stage[n].as_f64().expect("a number"));
        assert!((rate * seconds / rays - 1.0).abs() < 1e-6, "{stage}");
    }
    let text = folder.done(&small(&solve));
    assert!(text.contains("rays      direct"), "{text}");
    let none = folder.json(&small(&["solve", "cornell"]));
    assert!(none["stages"].is_null(), "shooting has none: {none}");
}

#[test]
fn more_elements_than_asked_for_are_explained() {
    let folder = Folder::new();
    let output = folder.run(&["solve", "chapel", "--elements", "500", "--iterations", "1"]);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        errors.contains("in place of 500: faces have 3,553 lit sides"),
        "{errors}"
    );
}
