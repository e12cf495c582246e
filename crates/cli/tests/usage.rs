//! Help, errors and everything around the work.

mod common;

use common::{Folder, small};

#[test]
fn every_verb_has_help_with_an_example() {
    let folder = Folder::new();
    for verb in [
        "solve",
        "measure",
        "render",
        "form-factors",
        "compare",
        "environment",
        "gallery",
        "scenes",
        "info",
        "completions",
    ] {
        let help = folder.done(&[verb, "--help"]);
        assert!(help.contains("Example"), "{verb}: {help}");
        assert!(help.contains(&format!("hemicube {verb}")), "{verb}: {help}");
    }
    let help = folder.done(&["--help"]);
    assert!(
        help.contains("Examples:") && help.lines().count() <= 50,
        "one screen: {help}"
    );
    assert!(
        folder.done(&["--version"]).starts_with("hemicube "),
        "its version"
    );
}

#[test]
fn completions_are_scripts() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        assert!(
            folder.done(&["completions", shell]).contains("hemicube"),
            "{shell}"
        );
    }
}

#[test]
fn scenes_are_listed() {
    let folder = Folder::new();
    let text = folder.done(&["scenes"]);
    let list = folder.json(&["scenes"]);
    for scene in list["scenes"].as_array().expect("a list") {
        let name = scene["name"].as_str().expect("a name");
        assert!(text.lines().any(|line| line.starts_with(name)), "{name}");
    }
    assert!(text.contains("cornell"), "{text}");
}

#[test]
fn wrong_usage_is_told_by_clap() {
    let folder = Folder::new();
    for args in [
        &["solve"][..],
        &["solve", "cornell", "--form-factors", "magic"],
        &["solve", "cornell", "--rays", "0"],
        &["solve", "cornell", "--time", "soon"],
        &["solve", "cornell", "--emit", "lamp"],
        &["solve", "cornell", "--emit", "*=-1"],
        &["solve", "cornell", "--sky", "1,2,nan"],
        &["solve", "cornell", "--sky", "-1"],
        &["solve", "cornell", "--reflectance", "*=1.5"],
        &["solve", "cornell", "--elements", "4294967296"],
        &["solve", "cornell", "--shot-rays", "0"],
        &["solve", "cornell", "--hemicube-resolution", "33"],
        &["solve", "cornell", "--adaptive", "0"],
        &["solve", "cornell", "--adaptive", "-0.1"],
        &["solve", "cornell", "--adaptive", "1"],
        &["solve", "cornell", "--adaptive", "nan"],
        &["solve", "cornell", "--adaptive", "0.1", "--smallest", "0"],
        &["solve", "cornell", "--smallest", "0.1"],
        &["solve", "cornell", "--most-elements", "1000"],
        &["render", "cornell", "-o", "v.png", "--mesh=lines"],
        &["form-factors", "cornell", "--error", "0"],
        &[
            "form-factors",
            "cornell",
            "--method",
            "hemicube",
            "--hemicube-resolution",
            "17",
        ],
        &["render", "cornell"],
        &["render", "cornell", "-o", "v.png", "--size", "0x10"],
        &[
            "solve",
            "furnace",
            "--image",
            "v.png",
            "--size",
            "16384x16384",
        ],
        &[
            "render", "cornell", "-o", "v.png", "--camera", "front", "--eye", "0,0,0",
        ],
        &["paint"],
    ] {
        assert_eq!(folder.run(args).status.code(), Some(2), "{args:?}");
    }
}

#[test]
fn contradictions_are_wrong_usage_in_words() {
    let folder = Folder::new();
    folder.done(&small(&[
        "solve",
        "furnace",
        "-o",
        "lit.glb",
        "--iterations",
        "5",
    ]));
    folder.write("in.csv", "0,0,0,0,1,0\n");
    for (args, wanted) in [
        (&["solve", "furnace", "-o", "lit.gltf"][..], "use .glb"),
        (
            &[
                "solve",
                "furnace",
                "-o",
                "v.glb",
                "--shot-rays",
                "9",
                "--solver",
                "hierarchical",
            ],
            "hierarchical has no shots",
        ),
        (
            &[
                "solve",
                "furnace",
                "-o",
                "v.glb",
                "--shot-rays",
                "9",
                "--form-factors",
                "hemicube",
            ],
            "--shot-rays is for --form-factors raycast",
        ),
        (
            &["solve", "furnace", "--image", "view.jpg"],
            "use .png or .exr",
        ),
        (&["solve", "furnace", "--image", "view"], "has no ending"),
        (
            &[
                "solve",
                "furnace",
                "--form-factors",
                "hemicube",
                "--rays",
                "9",
            ],
            "--rays is for --form-factors raycast or nusselt, not hemicube",
        ),
        (
            &["solve", "furnace", "--hemicube-resolution", "64"],
            "--hemicube-resolution is for --form-factors hemicube or cubic-tetrahedron or single-plane, not raycast",
        ),
        (
            &["compare", "furnace", "--hemicube-resolution", "64"],
            "not raycast",
        ),
        (
            &[
                "solve",
                "--resume",
                "lit.glb",
                "--form-factors",
                "analytic",
                "--rays",
                "9",
            ],
            "not analytic",
        ),
        (
            &["solve", "furnace", "-o", "l.glb", "--size", "9x9"],
            "--image",
        ),
        (
            &["render", "lit.glb", "-o", "v.png", "--emit", "*=1"],
            "--emit of lit.glb",
        ),
        (
            &["render", "lit.glb", "-o", "v.png", "--elements", "9"],
            "--elements of lit.glb",
        ),
        (
            &["measure", "lit.glb", "--points", "in.csv", "--sky", "1"],
            "--sky of lit.glb",
        ),
        (
            &["solve", "cornell", "--resume", "lit.glb"],
            "another scene",
        ),
        (&["gallery", "lines"], "add -o DIR"),
        (&["gallery", "--size", "96x96"], "add -o DIR"),
        (&["gallery", "--file", "in.csv"], "add -o DIR"),
        (&["gallery", "--seed", "0"], "add -o DIR"),
        (
            &[
                "solve",
                "--resume",
                "lit.glb",
                "--flip",
                "*",
                "--elements",
                "9",
            ],
            "--flip, --elements",
        ),
    ] {
        let error = folder.fails(2, args);
        assert!(error.contains(wanted), "{args:?}: {error}");
    }
    assert_eq!(folder.files(), ["in.csv", "lit.glb"], "no output");
}

#[test]
fn an_exhibit_that_is_named_twice_is_drawn_once() {
    let folder = Folder::new();
    let draw = |names: &[&str]| {
        let args = [&["gallery", "-o", "."], names].concat();
        folder.json(&args)["files"].clone()
    };
    let twice = draw(&["fill-rules", "filters", "fill-rules"]);
    assert_eq!(twice, draw(&["fill-rules", "filters"]));
}

#[test]
fn failures_are_one_line_and_leave_nothing_behind() {
    let folder = Folder::new();
    folder.write("text.glb", "not a scene");
    folder.write("points.csv", "1,2,3\n");
    folder.write("empty.obj", "");
    std::fs::create_dir(folder.path("folder.glb")).expect("a folder");
    let before = folder.files();
    for (args, wanted) in [
        (&["solve", "nowhere.glb", "-o", "l.glb"][..], "nowhere.glb"),
        (&["solve", "text.glb", "-o", "l.glb"], "text.glb"),
        (&["solve", "empty.obj", "-o", "l.glb"], "empty.obj"),
        (&["solve", "folder.glb", "-o", "l.glb"], "folder"),
        (&["solve", "furnace", "-o", "folder.glb"], "is a folder"),
        (
            &["solve", "furnace", "-o", "missing/l.glb"],
            "does not exist",
        ),
        (
            &["solve", "furnace", "-o", "points.csv/l.glb"],
            "points.csv",
        ),
        (
            &["solve", "furnace", "--emit", "*=0", "-o", "l.glb"],
            "--emit",
        ),
        (
            &["solve", "furnace", "--hide", "nothing", "-o", "l.glb"],
            "nothing",
        ),
        (&["solve", "--resume", "text.glb"], "text.glb"),
        (&["solve", "--resume", "gone.glb"], "gone.glb"),
        (
            &["measure", "furnace", "--points", "points.csv"],
            "points.csv",
        ),
        (&["measure", "furnace", "--points", "gone.csv"], "gone.csv"),
        (&["info", "gone.glb"], "gone.glb"),
        (&["solve", "a\nb", "-o", "l.glb"], "a b"),
    ] {
        let error = folder.fails(1, args);
        assert!(error.contains(wanted), "{args:?}: {error}");
    }
    assert_eq!(folder.files(), before, "nothing new");
}

#[test]
fn read_only_targets_are_refused_before_the_work() {
    let folder = Folder::new();
    folder.write("lit.glb", "precious");
    let mut permissions = std::fs::metadata(folder.path("lit.glb"))
        .expect("it is there")
        .permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(folder.path("lit.glb"), permissions).expect("ours to set");
    let error = folder.fails(1, &["solve", "furnace", "-o", "lit.glb"]);
    assert!(error.contains("read-only"), "{error}");
    assert_eq!(folder.text("lit.glb"), "precious", "untouched");
}

#[cfg(unix)]
#[test]
fn paths_may_hold_spaces_and_other_bytes() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = Folder::new();
    let name = std::ffi::OsStr::from_bytes(b"my \xff light.glb");
    let mut solve = folder.command(&[
        "solve",
        "furnace",
        "--iterations",
        "5",
        "--elements",
        "100",
        "-o",
    ]);
    solve.arg(name);
    assert!(
        solve.output().expect("it starts").status.success(),
        "written"
    );
    let mut info = folder.command(&["info"]);
    assert!(
        info.arg(name).output().expect("it starts").status.success(),
        "read"
    );
}

#[cfg(unix)]
#[test]
fn reader_that_goes_away_is_no_error() {
    let folder = Folder::new();
    let mut child = folder
        .command(&["completions", "bash"])
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert!(
        output.stderr.is_empty() && output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn info_says_why_a_scene_stays_black() {
    let folder = Folder::new();
    let hints = |args: &[&str]| folder.json(args)["hints"].to_string();
    assert_eq!(
        hints(&["info", "furnace"]),
        "[]",
        "nothing wrong with the furnace"
    );
    assert!(
        hints(&["info", "cornell"]).contains("open"),
        "the Cornell box is open at the front"
    );
    assert!(
        hints(&["info", "cornell", "--emit", "*=0"]).contains("nothing gives light"),
        "no lamp"
    );
    assert!(
        hints(&["info", "cornell", "--flip", "light*"]).contains("emitter"),
        "the lamp faces the ceiling"
    );
    assert!(
        hints(&["info", "two-rooms", "--flip", "*"]).contains("back sides"),
        "all walls face outward"
    );
    let text = folder.done(&["info", "cornell"]);
    for word in ["bounds", "elements", "white", "cameras", "front"] {
        assert!(text.contains(word), "'{word}' in {text}");
    }
}

#[test]
fn files_that_are_not_there_are_told_in_words() {
    let folder = Folder::new();
    let gallery = |name: &'static str, files: &[&'static str]| {
        let files = files.iter().flat_map(|&file| ["--file", file]);
        ["gallery", "-o", ".", name]
            .into_iter()
            .chain(files)
            .collect()
    };
    let all: [Vec<&'static str>; 9] = [
        vec!["measure", "cornell", "--points", "none.csv"],
        vec!["environment", "info", "none.hdr"],
        vec![
            "environment",
            "convert",
            "none.exr",
            "-o",
            "o.exr",
            "--to",
            "cube",
        ],
        small(&[
            "render",
            "cornell",
            "-o",
            "v.png",
            "--environment-file",
            "none.hdr",
        ]),
        gallery("environment-spheres-file", &["none.hdr"]),
        gallery("phrase-in-font", &["none.ttf"]),
        gallery("molecule-charges", &["none.pqr"]),
        gallery("parallax-textures", &["none.png", "none.png", "none.png"]),
        gallery("finite-elements", &["none.vtk"]),
    ];
    for args in all {
        let line = folder.fails(1, &args);
        let is_told = line.contains("none.") && line.contains("there is no such file");
        assert!(is_told && !line.contains("os error"), "{args:?}: {line}");
    }
}

#[test]
fn numbers_out_of_range_are_told_with_option_and_range() {
    let folder = Folder::new();
    for (args, option, range) in [
        (
            &[
                "environment",
                "convert",
                "a.hdr",
                "-o",
                "b.hdr",
                "--to",
                "cube",
                "--size",
                "0",
            ][..],
            "--size",
            "from 1 to 8192",
        ),
        (
            &[
                "environment",
                "capture",
                "cornell",
                "-o",
                "b.hdr",
                "--at",
                "0,0,0",
                "--size",
                "-3",
            ],
            "--size",
            "from 1 to 2048",
        ),
        (
            &["solve", "cornell", "--rays", "many"],
            "--rays",
            "from 1 to 1048576",
        ),
        (
            &["scenes", "--threads", "70000"],
            "--threads",
            "from 1 to 1024",
        ),
    ] {
        let output = folder.run(args);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {text}");
        assert!(
            text.contains(option) && text.contains(range),
            "{args:?}: {text}"
        );
    }
}
