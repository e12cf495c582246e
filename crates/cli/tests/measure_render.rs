//! `hemicube measure` and `hemicube render`.

mod common;

use common::{Folder, is_png, small};

#[test]
fn scene_and_its_lit_file_measure_the_same() {
    let folder = Folder::new();
    folder.write(
        "in.csv",
        "name;nz;ny;nx;x;y;z\n\"a;b\";0;2;0;100;1;100\n# a remark\n\nfar;0;-1;0;1e6;1e6;0\n",
    );
    folder.done(&small(&[
        "solve", "cornell", "-o", "lit.glb", "--seed", "7",
    ]));
    let from_lit = folder.done(&["measure", "lit.glb", "--points", "in.csv"]);
    let summary = folder.done(&small(&[
        "measure", "cornell", "--seed", "7", "--points", "in.csv", "-o", "out.csv",
    ]));
    assert_eq!(folder.text("out.csv"), from_lit, "the same bits");
    assert!(
        summary.contains("2 points") && summary.contains("out.csv"),
        "{summary}"
    );
    let lines: Vec<&str> = from_lit.lines().collect();
    assert_eq!(
        lines[0], "name;nz;ny;nx;x;y;z;irradiance_r;irradiance_g;irradiance_b;illuminance",
        "the header"
    );
    assert!(
        lines[1].starts_with("\"a;b\";0;2;0;100;1;100;"),
        "columns are passed through: {}",
        lines[1]
    );
    let value = |line: &str, from_end: usize| -> f32 {
        line.rsplit(';')
            .nth(from_end)
            .and_then(|field| field.parse().ok())
            .unwrap_or(f32::NAN)
    };
    assert!(value(lines[1], 0) > 0.0, "the floor is lit: {}", lines[1]);
    let weighted =
        0.2126 * value(lines[1], 3) + 0.7152 * value(lines[1], 2) + 0.0722 * value(lines[1], 1);
    assert!(
        (value(lines[1], 0) / (179.0 * weighted) - 1.0).abs() < 1e-4,
        "radiometric scenes: 179 lm/W"
    );
}

#[test]
fn bad_points_are_refused_by_line() {
    let folder = Folder::new();
    for (text, wanted) in [
        (
            "x,y,z,nx,ny,nz\n1,2,3,0,1,0\n1,2,3,0,0,0\n",
            "line 3: its normal",
        ),
        (
            "x,y,z,nx,ny,nz\n1,2,nan,0,1,0\n",
            "line 2: z 'nan' is not a finite number",
        ),
        ("x,y,z,nx,ny\n1,2,3,0,1\n", "no column nz"),
    ] {
        folder.write("in.csv", text);
        let error = folder.fails(
            1,
            &["measure", "furnace", "--points", "in.csv", "-o", "out.csv"],
        );
        assert!(
            error.contains("in.csv: ") && error.contains(wanted),
            "{error}"
        );
    }
    assert_eq!(folder.files(), ["in.csv"], "no output");
}

#[test]
fn points_come_from_standard_input_too() {
    use std::io::Write as _;
    let folder = Folder::new();
    let args = small(&["measure", "furnace", "--points", "-", "--quiet"]);
    let mut child = folder
        .command(&args)
        .stdin(std::process::Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut input = child.stdin.take().expect("its input is ours");
    input.write_all(b"0.5,0.5,0.5,0,0,1\n").expect("it reads");
    drop(input);
    let output = child.wait_with_output().expect("it ends");
    assert!(
        output.stdout.starts_with(b"x,y,z,nx,ny,nz,irradiance_r"),
        "a header is added"
    );
}

#[test]
fn drawing_twice_gives_the_same_bytes() {
    let folder = Folder::new();
    folder.done(&small(&["solve", "cornell", "-o", "lit.glb"]));
    for shading in ["flat", "gouraud", "gather"] {
        let draw = |name: &str| {
            let args = [
                "render",
                "lit.glb",
                "-o",
                name,
                "--size",
                "24x24",
                "--shading",
                shading,
            ];
            folder.done(&[&args[..], &["--gather-rays", "16", "--antialias", "2"]].concat());
            folder.read(name)
        };
        assert_eq!(draw("a.png"), draw("b.png"), "{shading}");
        assert!(is_png(&folder.path("a.png")), "{shading}");
    }
    folder.done(&[
        "render",
        "lit.glb",
        "-o",
        "VIEW.EXR",
        "--size",
        "24x24",
        "--eye",
        "-1,2,-800",
        "--fov",
        "40",
    ]);
    assert!(
        folder
            .read("VIEW.EXR")
            .starts_with(&[0x76, 0x2f, 0x31, 0x01]),
        "an OpenEXR file"
    );
}

#[test]
fn size_follows_the_camera() {
    let folder = Folder::new();
    let report = folder.json(&small(&[
        "render",
        "cornell",
        "-o",
        "view.png",
        "--antialias",
        "1",
    ]));
    assert_eq!(
        (&report["width"], &report["height"]),
        (&720.into(), &720.into()),
        "the Cornell box is square"
    );
    assert_eq!(report["camera"], "front", "the scene's first camera");
}

#[test]
fn unknown_camera_lists_the_known_ones_before_the_work() {
    let folder = Folder::new();
    let error = folder.fails(
        1,
        &[
            "render",
            "two-rooms",
            "--quality",
            "final",
            "-o",
            "v.png",
            "--camera",
            "attic",
        ],
    );
    assert!(
        error.contains("attic") && error.contains("doorway"),
        "{error}"
    );
    assert!(folder.files().is_empty(), "no output");
}

#[test]
fn projections_antialiasing_and_textures_are_options() {
    let folder = Folder::new();
    folder.done(&small(&["solve", "cornell", "-o", "lit.glb"]));
    let render = |name: &'static str, more: &[&'static str]| {
        let args = ["render", "lit.glb", "-o", name];
        folder.json(&[&args[..], more].concat())
    };
    let panorama = render("p.png", &["--projection", "panorama", "--antialias", "1"]);
    assert_eq!(
        (&panorama["width"], &panorama["height"]),
        (&960.into(), &480.into()),
        "twice as wide as high"
    );
    for projection in ["fisheye", "fisheye-equisolid"] {
        let more = [
            "--fov",
            "220",
            "--size",
            "20x20",
            "--antialias",
            "2-jittered:mitchell",
        ];
        render(
            "f.png",
            &[&["--projection", projection], &more[..]].concat(),
        );
    }
    for filter in ["point", "bilinear", "trilinear", "ewa"] {
        render("t.png", &["--texture-filter", filter, "--size", "16x16"]);
    }
    let wide = render("w.exr", &["--size", "16x16", "--antialias", "4x4:bartlett"]);
    assert_eq!(wide["width"], 16, "the filter does not change the size");
}

#[test]
fn options_of_pictures_that_cannot_be_are_told() {
    let folder = Folder::new();
    folder.done(&small(&["solve", "cornell", "-o", "lit.glb"]));
    for (code, word, more) in [
        (2, "lanczos", &["--antialias", "3x3:tent"][..]),
        (2, "32x32", &["--antialias", "33"]),
        (2, "fisheye", &["--fov", "200"]),
        (2, "panorama", &["--projection", "panorama", "--fov", "90"]),
        (
            2,
            "none",
            &["--environment", "none", "--environment", "metals"],
        ),
        (1, "chrome", &["--environment", "chrome*"]),
        (1, "sky.hdr", &["--environment-file", "sky.hdr"]),
        (2, "--mirror-roughness", &["--mirror-roughness", "2"]),
    ] {
        let args = [&["render", "lit.glb", "-o", "v.png", "--size", "8x8"], more].concat();
        let output = folder.run(&args);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{more:?}: {error}");
        assert!(error.contains(word), "{more:?}: {error}");
        assert_eq!(folder.files(), ["lit.glb"], "no picture");
    }
}

/// A textured, bumpy, metallic triangle under a sky, as glTF.
const BUMPY: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"plate","mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],
"materials":[{"name":"chrome","doubleSided":true,"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"roughnessFactor":0.1},
"normalTexture":{"index":0,"scale":0.8}}],"textures":[{"source":0,"sampler":0}],"samplers":[{"magFilter":9728}],
"images":[{"uri":"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAFklEQVR4nGNY0PAhoeEDQ8OCDw0N/wE1nQfwXUNf2AAAAABJRU5ErkJggg=="}],
"buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,AACAvwAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAEAAAAAAAAAAAAAAgD8AAIA/AACAPwAAAD8AAAAA"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-1,0,0],"max":[1,2,0]},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}]}"#;

#[test]
fn scene_and_its_lit_file_look_the_same() {
    let folder = Folder::new();
    folder.write("bumpy.gltf", BUMPY);
    let view = ["--size", "24x24", "--antialias", "2"];
    let sky = ["--sky", "1,2,3"];
    folder.done(&small(&[
        "solve",
        "bumpy.gltf",
        "-o",
        "lit.glb",
        "--sky",
        "1,2,3",
    ]));
    folder.done(&[&["render", "lit.glb", "-o", "lit.png"], &view[..]].concat());
    let args = [
        &["render", "bumpy.gltf", "-o", "scene.png"],
        &view[..],
        &sky[..],
    ]
    .concat();
    folder.done(&small(&args));
    assert_eq!(
        folder.read("lit.png"),
        folder.read("scene.png"),
        "the same bytes"
    );
    folder.done(
        &[
            &[
                "render",
                "lit.glb",
                "-o",
                "matt.png",
                "--environment",
                "none",
            ],
            &view[..],
        ]
        .concat(),
    );
    assert_ne!(
        folder.read("lit.png"),
        folder.read("matt.png"),
        "chrome mirrors"
    );
}

/// Looking out of a closed room shows nothing of the surroundings; so an eye is outside.
#[test]
fn surroundings_are_read_in_any_form() {
    let folder = Folder::new();
    let mut file = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16 +X 32\n".to_vec();
    for i in 0..16 * 32_u32 {
        let [x, y] = [i % 32, i / 32].map(|v| u8::try_from(v).expect("small"));
        file.extend([40 + 4 * y, 90 + x, 200 - 8 * y, 129]);
    }
    std::fs::write(folder.path("sky.hdr"), file).expect("a file for a test");
    let to_cube = [
        "environment",
        "convert",
        "sky.hdr",
        "--to",
        "cube",
        "--size",
        "16",
    ];
    folder.done(&[&to_cube[..], &["-o", "cross.exr"]].concat());
    folder.done(&[&to_cube[..], &["-o", "f-{face}.exr"]].concat());
    std::fs::create_dir(folder.path("faces")).expect("a folder");
    for name in folder.files().iter().filter(|name| name.starts_with("f-")) {
        let to = folder.path(&format!("faces/{name}"));
        std::fs::copy(folder.path(name), to).expect("a copy");
    }
    folder.done(&small(&["solve", "furnace", "-o", "lit.glb"]));
    let drawn = |surroundings: &str| {
        let eye = ["--eye", "9,2,9", "--look-at", "20,3,20", "--size", "24x16"];
        let args = [
            "render",
            "lit.glb",
            "-o",
            "v.exr",
            "--environment-file",
            surroundings,
        ];
        folder.done(&[&args[..], &eye].concat());
        folder.read("v.exr")
    };
    let cross = drawn("cross.exr");
    assert_eq!(drawn("faces"), cross, "a folder");
    assert_eq!(drawn("f-{face}.exr"), cross, "a name for all");
}

#[test]
fn the_mesh_lies_over_pictures_for_displays() {
    let folder = Folder::new();
    folder.done(&small(&["solve", "cornell", "-o", "lit.glb"]));
    let render = |file: &'static str, mesh: &[&'static str]| {
        let args = ["render", "lit.glb", "-o", file, "--size", "90x90"];
        folder.done(&[&args[..], mesh].concat());
        folder.read(file)
    };
    let pictures = [
        render("plain.png", &[]),
        render("elements.png", &["--mesh"]),
        render("patches.png", &["--mesh=patches"]),
    ];
    assert_ne!(pictures[0], pictures[1], "elements have edges");
    assert_ne!(pictures[1], pictures[2], "and patches others");
    assert_eq!(
        pictures[1],
        render("again.png", &["--mesh=elements"]),
        "the same by name"
    );
    let error = folder.fails(2, &["render", "lit.glb", "-o", "light.exr", "--mesh"]);
    assert!(error.contains("radiance"), "{error}");
}
