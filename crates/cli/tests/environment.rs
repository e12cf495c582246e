//! `hemicube environment`.

mod common;

use common::{Folder, is_png, small};
use hemicube::raster::{Image, Rgb};
use serde_json::Value;
use std::io::Cursor;

/// A small panorama in a file: rows from blue to brown, a bright spot.
fn panorama(folder: &Folder) {
    let mut file = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16 +X 32\n".to_vec();
    for y in 0..16_u8 {
        for x in 0..32_u8 {
            let sun = if (x, y) == (20, 5) { 8 } else { 0 };
            file.extend([60 + 4 * y, 90 + x, 200 - 8 * y, 128 + sun]);
        }
    }
    std::fs::write(folder.path("sky.hdr"), file).expect("a file for a test");
}

fn flux(report: &Value) -> Vec<f64> {
    let bands = report["flux"].as_array().expect("three bands");
    bands
        .iter()
        .map(|band| band.as_f64().expect("a number"))
        .collect()
}

#[test]
fn maps_keep_their_light_through_all_projections() {
    let folder = Folder::new();
    panorama(&folder);
    let before = flux(&folder.json(&["environment", "info", "sky.hdr"]));
    for (to, file) in [
        ("cube", "cube.exr"),
        ("octahedral", "oct.exr"),
        ("sphere", "sphere.exr"),
        ("angular", "angular.exr"),
        ("paraboloid", "halves-{face}.exr"),
        ("cube", "faces-{face}.exr"),
    ] {
        let report = folder.json(&[
            "environment",
            "convert",
            "sky.hdr",
            "-o",
            file,
            "--to",
            to,
            "--size",
            "24",
        ]);
        assert!(
            report["flux_error"].as_f64().expect("a number") < 1e-6,
            "{to}: {report}"
        );
        assert!(
            report["solid_angle_error"]
                .as_f64()
                .expect("a number")
                .abs()
                < 1e-11,
            "{to}"
        );
        let after = flux(&folder.json(&["environment", "info", file, "--from", to]));
        for (a, b) in before.iter().zip(&after) {
            assert!((a / b - 1.0).abs() < 1e-6, "{to}: {before:?} {after:?}");
        }
    }
    let text = folder.done(&[
        "environment",
        "convert",
        "faces-{face}.exr",
        "-o",
        "back.png",
        "--to",
        "latlong",
    ]);
    assert!(
        text.contains("4 pi") && text.contains("wrote     back.png"),
        "{text}"
    );
    assert!(is_png(&folder.path("back.png")), "a PNG");
    let text = folder.done(&["environment", "info", "cube.exr"]);
    assert!(
        text.contains("cube, 6 faces of 24 x 24"),
        "told by its sides: {text}"
    );
    assert!(
        !folder
            .files()
            .iter()
            .any(|name| name.starts_with(".hemicube")),
        "{:?}",
        folder.files()
    );
}

#[test]
fn faces_are_found_in_a_folder_by_any_of_their_names() {
    let folder = Folder::new();
    panorama(&folder);
    std::fs::create_dir(folder.path("box")).expect("a folder");
    folder.done(&[
        "environment",
        "convert",
        "sky.hdr",
        "-o",
        "f-{face}.hdr",
        "--to",
        "cube",
        "--size",
        "8",
    ]);
    for (ours, theirs) in [
        ("px", "posx"),
        ("nx", "negx"),
        ("py", "posy"),
        ("ny", "negy"),
        ("pz", "posz"),
        ("nz", "negz"),
    ] {
        std::fs::rename(
            folder.path(&format!("f-{ours}.hdr")),
            folder.path(&format!("box/my_{theirs}.hdr")),
        )
        .expect("a new name");
    }
    let report = folder.json(&["environment", "info", "box"]);
    assert_eq!(report["map"]["projection"], "cube", "{report}");
    std::fs::remove_file(folder.path("box/my_negy.hdr")).expect("a file less");
    let line = folder.fails(1, &["environment", "info", "box"]);
    assert!(line.contains("six pictures"), "{line}");
}

#[test]
fn nothing_is_written_when_one_of_six_cannot_be() {
    let folder = Folder::new();
    panorama(&folder);
    std::fs::create_dir(folder.path("f-ny.png")).expect("a folder in the way");
    let line = folder.fails(
        1,
        &[
            "environment",
            "convert",
            "sky.hdr",
            "-o",
            "f-{face}.png",
            "--to",
            "cube",
            "--size",
            "8",
        ],
    );
    assert!(line.contains("f-ny.png"), "{line}");
    let made: Vec<String> = folder
        .files()
        .into_iter()
        .filter(|f| f.ends_with(".png"))
        .collect();
    assert_eq!(made, ["f-ny.png"], "only what was there");
}

#[test]
fn a_room_is_captured_from_its_middle() {
    let folder = Folder::new();
    let report = folder.json(&small(&[
        "environment",
        "capture",
        "cornell",
        "-o",
        "room.exr",
        "--at",
        "278,274,280",
        "--size",
        "24",
        "--antialias",
        "1",
    ]));
    assert_eq!(report["map"]["width"], 24, "{report}");
    let info = folder.json(&["environment", "info", "room.exr"]);
    let up = info["irradiance"]["up"][0].as_f64().expect("a number");
    let down = info["irradiance"]["down"][0].as_f64().expect("a number");
    assert!(up > 2.0 * down, "the lamp is above: {info}");
    // The camera of the scene looks at +z and has red at its left, which is +x.
    let [left, right] = ["left", "right"].map(|side| {
        let band = |band: usize| info["irradiance"][side][band].as_f64().expect("a number");
        band(0) / band(1)
    });
    assert!(right > 1.4 * left, "the red wall is at +x: {info}");
    folder.done(&small(&[
        "environment",
        "capture",
        "cornell",
        "-o",
        "ball.png",
        "--at",
        "278,274,280",
        "--size",
        "16",
        "--to",
        "sphere",
    ]));
    assert!(is_png(&folder.path("ball.png")), "a PNG");
}

#[test]
fn what_makes_no_sense_is_refused_in_a_line() {
    let folder = Folder::new();
    panorama(&folder);
    folder.write("text.hdr", "no picture");
    let convert = |rest: &[&'static str]| [&["environment", "convert"][..], rest].concat();
    for (code, args, wanted) in [
        (
            1,
            convert(&["none.hdr", "-o", "o.png", "--to", "cube"]),
            "none.hdr",
        ),
        (
            1,
            convert(&["text.hdr", "-o", "o.png", "--to", "cube"]),
            "no picture",
        ),
        (
            2,
            convert(&["sky.hdr", "-o", "o.gif", "--to", "cube"]),
            ".hdr or .exr or .png",
        ),
        (
            2,
            convert(&["sky.hdr", "-o", "o-{face}.png", "--to", "sphere"]),
            "one face",
        ),
        (
            2,
            convert(&[
                "sky.hdr", "-o", "o.png", "--to", "sphere", "--layout", "row",
            ]),
            "--layout row",
        ),
        (
            1,
            convert(&["sky.hdr", "-o", "o.png", "--to", "cube", "--from", "sphere"]),
            "square",
        ),
        (
            1,
            convert(&["x{face}.png", "-o", "o.png", "--to", "cube"]),
            "no such files",
        ),
    ] {
        let line = folder.fails(code, &args);
        assert!(line.contains(wanted), "{args:?}: {line}");
    }
    folder.done(&convert(&[
        "sky.hdr", "-o", "ball.png", "--to", "sphere", "--size", "16",
    ]));
    let line = folder.fails(2, &convert(&["ball.png", "-o", "o.png", "--to", "cube"]));
    assert!(line.contains("--from"), "a square may be anything: {line}");
}

#[test]
fn maps_are_not_written_over_what_is_read() {
    let folder = Folder::new();
    panorama(&folder);
    let before = folder.read("sky.hdr");
    let convert = |rest: &[&'static str]| [&["environment", "convert"][..], rest].concat();
    let refused = |args: &[&'static str]| {
        let line = folder.fails(2, &convert(args));
        assert!(line.contains("would be lost"), "{args:?}: {line}");
    };
    refused(&["sky.hdr", "-o", "sky.hdr", "--to", "cube"]);
    refused(&[
        "sky.hdr",
        "-o",
        "./sky.hdr",
        "--to",
        "latlong",
        "--size",
        "8",
    ]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.path("sky.hdr"), folder.path("link.hdr"))
            .expect("a link");
        refused(&["sky.hdr", "-o", "link.hdr", "--to", "cube"]);
    }
    folder.done(&convert(&[
        "sky.hdr",
        "-o",
        "f-{face}.hdr",
        "--to",
        "cube",
        "--size",
        "8",
    ]));
    refused(&["f-{face}.hdr", "-o", "f-ny.hdr", "--to", "latlong"]);
    refused(&[
        "f-{face}.hdr",
        "-o",
        "f-{face}.hdr",
        "--to",
        "cube",
        "--size",
        "4",
    ]);
    assert_eq!(folder.read("sky.hdr"), before, "it is as it was");
    folder.done(&convert(&[
        "sky.hdr", "-o", "sky.exr", "--to", "latlong", "--size", "8",
    ]));
    let line = folder.fails(
        2,
        &[
            "render",
            "cornell",
            "-o",
            "sky.exr",
            "--environment-file",
            "sky.exr",
        ],
    );
    assert!(line.contains("would be lost"), "{line}");
}

#[test]
fn info_and_convert_tell_of_pixels_that_no_light_has() {
    let folder = Folder::new();
    let mut image = Image::filled(8, 4, Rgb::splat(0.5));
    *image.pixel_mut(5, 2) = Rgb::new(f32::NAN, 1.0, 1.0);
    *image.pixel_mut(6, 3) = Rgb::new(f32::INFINITY, 1.0, 1.0);
    *image.pixel_mut(1, 0) = Rgb::new(0.5, -1.0, 0.5);
    let mut file = Cursor::new(Vec::new());
    image.write_exr(&mut file).expect("OpenEXR");
    std::fs::write(folder.path("sky.exr"), file.into_inner()).expect("a file");
    let text = folder.done(&["environment", "info", "sky.exr"]);
    let of = |word: &str| text.lines().find(|l| l.contains(word)).unwrap_or_default();
    let line = of("not finite");
    assert!(
        line.contains("2 pixels") && line.contains("column 5, row 2"),
        "{text}"
    );
    let line = of("negative");
    assert!(
        line.contains("1 pixel,") && line.contains("column 1, row 0"),
        "{text}"
    );
    let report = folder.json(&["environment", "info", "sky.exr"]);
    assert_eq!(report["non_finite"]["pixels"], 2, "{report}");
    assert_eq!(report["negative"]["first"]["column"], 1, "{report}");
    let flux = report["flux"][0].as_f64();
    assert!(flux.is_some_and(f64::is_finite), "mended: {report}");
    let output = folder.run(&[
        "environment",
        "convert",
        "sky.exr",
        "-o",
        "c.exr",
        "--to",
        "cube",
    ]);
    let notes = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        output.status.success() && notes.contains("column 5, row 2"),
        "{notes}"
    );
    panorama(&folder);
    let clean = folder.json(&["environment", "info", "sky.hdr"]);
    assert_eq!(clean["non_finite"]["pixels"], 0, "{clean}");
}
