//! Reading and writing pictures: real files, damaged ones, and round trips.

use hemicube_raster::image::{
    Format, Picture, ReadError, ReadOptions, Values, open_picture, read_picture,
};
use hemicube_raster::{Image, Rgb};
use proptest::prelude::*;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// The folder of files, or `None` with a word about it.
fn testdata() -> Option<PathBuf> {
    let root = std::env::var_os("HEMICUBE_TESTDATA").map_or_else(
        || {
            PathBuf::from(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../../shared/testdata"
            ))
        },
        PathBuf::from,
    );
    if root.is_dir() {
        return Some(root);
    }
    eprintln!("skipped: there is no {}", root.display());
    None
}

/// All files below a folder, in order.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    for entry in entries {
        let path = entry.expect("the folder can be listed").path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn open(path: &Path) -> Result<Picture, ReadError> {
    open_picture(path, &ReadOptions::default())
}

#[test]
fn every_real_picture_loads() {
    let Some(root) = testdata() else { return };
    let mut count = 0;
    for folder in ["images", "env", "textures"] {
        for path in files(&root.join(folder)) {
            let name = path.to_string_lossy().into_owned();
            if name.ends_with(".npz") || name.ends_with(".json") {
                continue;
            }
            let picture = open(&path).unwrap_or_else(|e| panic!("{e}"));
            let finite = picture.image.pixels().as_flattened();
            assert!(finite.iter().all(|x| x.is_finite()), "{name}: finite");
            count += 1;
        }
    }
    assert!(count > 60, "only {count} files");
}

#[test]
fn damaged_pictures_are_refused_in_one_line() {
    let Some(root) = testdata() else { return };
    for path in files(&root.join("hostile/exr_damaged")) {
        let error = open(&path)
            .expect_err("all of them are damaged")
            .to_string();
        assert!(!error.contains(char::is_control), "{error:?}");
        assert!(error.contains(&*path.to_string_lossy()), "{error}");
    }
    for path in files(&root.join("hostile/png")) {
        let name = path.file_name().expect("a file").to_string_lossy();
        let is_damaged = name.starts_with('x') || !name.ends_with(".png");
        match open(&path) {
            Ok(_) => assert!(!is_damaged, "{name} is read"),
            Err(error) => {
                assert!(is_damaged, "{error}");
                assert!(!error.to_string().contains(char::is_control), "{error}");
            }
        }
    }
}

#[test]
fn gamma_of_a_png_is_undone() {
    let Some(root) = testdata() else { return };
    let load = |name: &str| {
        let path = root.join(format!("hostile/png/pngsuite/{name}.png"));
        open(&path).expect("a picture").image
    };
    // The same picture, stored with other exponents; below row 20 it has the exponent as an inscription.
    let truth = load("g10n2c08");
    for name in ["g03n2c08", "g05n2c08"] {
        let image = load(name);
        for (i, (a, b)) in truth
            .pixels()
            .iter()
            .zip(image.pixels())
            .enumerate()
            .take(20 * 32)
        {
            let worst = a
                .iter()
                .zip(b)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f32::max);
            // A code of 255 with an exponent of 1 / 0.35 is worth up to 1.2 %.
            assert!(worst < 0.012, "{name}, pixel {i}: {a:?} {b:?}");
        }
    }
}

#[test]
fn display_window_of_an_exr_is_the_picture() {
    let Some(root) = testdata() else { return };
    let load = |name: &str| {
        let path = root.join(format!("images/exr_valid/DisplayWindow/{name}.exr"));
        open(&path).expect("a picture").image
    };
    let full = load("t01");
    assert_eq!((full.width(), full.height()), (400, 300), "t01");
    // From (-40, -40) to (440, 330) around the data window, and from (30, 20) to (399, 299) in it.
    let framed = load("t07");
    assert_eq!((framed.width(), framed.height()), (481, 371), "t07");
    assert_eq!(framed.pixel(39, 40), &[0.0; 4], "outside the data window");
    let cropped = load("t03");
    assert_eq!((cropped.width(), cropped.height()), (370, 280), "t03");
    for (x, y) in [(30, 20), (399, 20), (200, 150), (399, 299)] {
        assert_eq!(framed.pixel(x + 40, y + 40), full.pixel(x, y), "({x}, {y})");
        assert_eq!(
            cropped.pixel(x - 30, y - 20),
            full.pixel(x, y),
            "({x}, {y})"
        );
    }
    let beside = load("t09");
    assert_eq!((beside.width(), beside.height()), (200, 300), "t09");
    assert!(
        beside.pixels().iter().all(|p| p == &[0.0; 4]),
        "nothing of the data"
    );
}

#[test]
fn halves_that_are_no_numbers_are_counted_and_mended() {
    let Some(root) = testdata() else { return };
    let path = root.join("images/exr_valid/TestImages/AllHalfValues.exr");
    let picture = open(&path).expect("a picture");
    // 2 * 1023 NaN and two infinities, in three channels.
    assert_eq!(picture.non_finite, 3 * 2048, "of 65,536 half floats");
    let options = ReadOptions::default().with_non_finite(true);
    let kept = open_picture(&path, &options).expect("a picture");
    let samples = kept.image.pixels().as_flattened();
    let count = samples.iter().filter(|x| !x.is_finite()).count();
    assert_eq!(count, 3 * 2048, "kept");
}

/// Facts that another reader states, without the half step that Radiance adds: largest and mean value before `EXPOSURE`.
#[test]
fn radiance_pictures_hold_what_others_read() {
    let Some(root) = testdata() else { return };
    for (name, max, mean, exposure) in [
        ("equirect_hdr/lebombo_1k", 41.38, 0.6412, 1.0),
        ("equirect_hdr/studio_small_03_1k", 3576.0, 1.888, 1.0),
        ("equirect_hdr/venice_sunset_1k", 6512.0, 0.4666, 1.0),
        ("fisheye/evalglare_testimage", 207.5, 7.273, 1.0),
        ("fisheye/mirror_fish", 6.797, 0.1606, 8.0),
        ("fisheye/mixtex_fish", 132.5, 0.279, 1.5),
    ] {
        let picture = open(&root.join(format!("env/{name}.hdr"))).expect("a picture");
        let samples: Vec<f64> = picture
            .rgb()
            .pixels()
            .iter()
            .flat_map(|c| c.to_array())
            .map(f64::from)
            .collect();
        let found = samples.iter().copied().fold(0.0, f64::max) * exposure;
        assert!(
            (found / max - 1.0).abs() < 0.005,
            "{name}: {found} is not {max}"
        );
        let found = samples.iter().sum::<f64>() / samples.len() as f64 * exposure;
        assert!(
            (found / mean - 1.0).abs() < 0.006,
            "{name}: {found} is not {mean}"
        );
    }
}

fn written(image: &Image<Rgb>) -> Vec<u8> {
    let mut file = Vec::new();
    image.write_hdr(&mut file).expect("memory");
    file
}

fn read(bytes: &[u8]) -> Result<Picture, ReadError> {
    read_picture(bytes, &ReadOptions::default())
}

proptest! {
    #[test]
    fn hdr_keeps_bands_to_a_256th_of_the_brightest(
        width in 1_usize..40,
        height in 1_usize..5,
        values in prop::collection::vec((0_f32..1.0, -30_i32..30), 3 * 200),
        repeated in 1_usize..30,
    ) {
        let value = |i: usize| values[i % values.len()].0 * 2_f32.powi(values[i % values.len()].1);
        let color = |i: usize| Rgb::new(value(3 * (i / repeated)), value(3 * (i / repeated) + 1), value(3 * (i / repeated) + 2));
        let image = Image::from_pixels(width, height, (0..width * height).map(color).collect()).expect("a picture");
        let picture = read(&written(&image)).expect("what was written");
        for (&was, is) in image.pixels().iter().zip(picture.rgb().pixels()) {
            for band in 0..3 {
                prop_assert!((was[band] - is[band]).abs() <= was.max_band() / 256.0, "{was:?} {is:?}");
            }
        }
        // A second time nothing changes.
        prop_assert_eq!(&written(&picture.rgb()), &written(&image));
    }

    #[test]
    fn damage_never_panics(which in 0_usize..5, places in prop::collection::vec((0_f64..1.0, any::<u8>()), 1..6), cut in 0.0_f64..2.0) {
        let mut bytes = sample(which);
        let length = bytes.len();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in the file")]
        let place = |share: f64| (share * length as f64) as usize;
        for (at, value) in places {
            bytes[place(at)] = value;
        }
        bytes.truncate(place(cut.min(1.0)));
        if let Err(error) = read(&bytes) {
            prop_assert!(!error.to_string().contains(char::is_control), "{error}");
        }
    }
}

/// A small file of each format that can be made here.
fn sample(which: usize) -> Vec<u8> {
    let color = |i: u16| Rgb::new(f32::from(i % 7), f32::from(i % 5), f32::from(i)) / 9.0;
    let image = Image::from_pixels(16, 12, (0..192).map(color).collect()).expect("a picture");
    let mut file = Cursor::new(Vec::new());
    match which {
        0 => image.write_png(&mut file).expect("memory"),
        1 => image.write_exr(&mut file).expect("memory"),
        2 => return written(&image),
        3 => encoded(&image, image::ImageFormat::Jpeg, &mut file),
        _ => encoded(&image, image::ImageFormat::WebP, &mut file),
    }
    file.into_inner()
}

fn encoded(image: &Image<Rgb>, format: image::ImageFormat, file: &mut Cursor<Vec<u8>>) {
    let codes: Vec<u8> = image
        .pixels()
        .iter()
        .flat_map(|c| c.to_array().map(hemicube_raster::color::srgb8_from_linear))
        .collect();
    let buffer = image::RgbImage::from_raw(16, 12, codes).expect("a picture");
    buffer.write_to(file, format).expect("memory");
}

#[test]
fn formats_are_told_by_their_first_bytes() {
    let formats = [
        Format::Png,
        Format::Exr,
        Format::Hdr,
        Format::Jpeg,
        Format::WebP,
    ];
    for (which, format) in formats.into_iter().enumerate() {
        let picture = read(&sample(which)).expect("a whole file");
        assert_eq!(picture.format, format, "file {which}");
        assert_eq!(
            (picture.image.width(), picture.image.height()),
            (16, 12),
            "{format}"
        );
        assert_eq!(picture.is_8_bit(), !format.is_linear(), "{format}");
    }
    assert!(matches!(read(b"GIF89a"), Err(ReadError::Format)), "a GIF");
    assert!(matches!(read(b""), Err(ReadError::Format)), "nothing");
}

#[test]
fn sizes_are_checked_first() {
    let options = ReadOptions::default().with_max_side(15);
    for which in 0..5 {
        let error = read_picture(&sample(which), &options).expect_err("too wide");
        assert!(
            matches!(error, ReadError::Size { width: 16, .. }),
            "{error}"
        );
    }
    let hollow = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8192 +X 16384\n\x02\x02";
    assert!(
        matches!(read(hollow), Err(ReadError::Hollow { .. })),
        "134 million pixels in 60 bytes"
    );
}

#[test]
fn data_are_not_colors() {
    let options = ReadOptions::default().with_values(Values::Data);
    let picture = read_picture(&sample(0), &options).expect("a picture");
    let code = hemicube_raster::color::srgb8_from_linear(1.0 / 9.0);
    assert_eq!(
        picture.image.pixel(1, 0)[0],
        f32::from(code) / 255.0,
        "a code"
    );
}

#[test]
fn exr_keeps_all_bits() {
    let picture = read(&sample(1)).expect("a picture");
    assert_eq!(picture.image.pixel(3, 1)[2], 19.0 / 9.0, "exact");
    assert_eq!(picture.image.pixel(3, 1)[3], 1.0, "opaque");
}

/// Scanlines may be columns and run either way; here a picture of 2 x 3 pixels with the codes 10, 20, ... row by row.
#[test]
fn hdr_scanlines_run_in_all_eight_ways() {
    let orders = [
        ("-Y 3 +X 2", [1, 2, 3, 4, 5, 6]),
        ("-Y 3 -X 2", [2, 1, 4, 3, 6, 5]),
        ("+Y 3 +X 2", [5, 6, 3, 4, 1, 2]),
        ("+Y 3 -X 2", [6, 5, 4, 3, 2, 1]),
        ("+X 2 -Y 3", [1, 3, 5, 2, 4, 6]),
        ("+X 2 +Y 3", [5, 3, 1, 6, 4, 2]),
        ("-X 2 -Y 3", [2, 4, 6, 1, 3, 5]),
        ("-X 2 +Y 3", [6, 4, 2, 5, 3, 1]),
    ];
    for (size, order) in orders {
        let mut file =
            format!("#?RGBE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\nEXPOSURE= 0.5\n\n{size}\n")
                .into_bytes();
        file.extend(order.iter().flat_map(|&n: &u8| [10 * n, 0, 0, 136]));
        let image = read(&file).expect(size).rgb();
        let reds: Vec<f32> = image.pixels().iter().map(|c| c.r - 0.5).collect();
        assert_eq!(reds, [10.0, 20.0, 30.0, 40.0, 50.0, 60.0], "{size}");
    }
}

#[test]
fn old_run_lengths_repeat_a_pixel() {
    let mut file = b"#?RADIANCE\nEXPOSURE=0.5\n\n-Y 1 +X 300\n".to_vec();
    file.extend([7, 7, 7, 136, 1, 1, 1, 42, 1, 1, 1, 1, 9, 9, 9, 136]);
    let image = read(&file).expect("1 + 42 + 256 + 1 pixels").rgb();
    assert_eq!(
        image.pixel(298, 0),
        &Rgb::splat(15.0),
        "divided by the exposure"
    );
    assert_eq!(image.pixel(299, 0), &Rgb::splat(19.0), "the last one");
}
