//! Environment maps from files: one picture, a folder of faces, a pattern; and what is wrong with their pixels.

use glam::Vec3;
use hemicube_raster::environment::{
    EnvironmentMap, FACE_NAMES, Layout, OpenMapError, Projection, map_files, open_map,
};
use hemicube_raster::{Image, Rgb};
use std::fs::File;
use std::io::{BufWriter, Cursor};
use std::path::{Path, PathBuf};

/// A folder that goes away.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("hemicube-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder for a test");
        Self(path)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // What stays in a folder for temporary files does no harm.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn write(image: &Image<Rgb>, path: &Path) {
    let mut bytes = Cursor::new(Vec::new());
    image.write_exr(&mut bytes).expect("OpenEXR");
    std::fs::write(path, bytes.into_inner()).expect("a file for a test");
}

/// A cube with another light in each direction.
fn cube() -> EnvironmentMap {
    EnvironmentMap::from_fn(Projection::Cube, 8, 1, |d| {
        Rgb::from(d.to_array()).map(|x| x + 1.5)
    })
}

#[test]
fn one_cube_comes_in_any_form() {
    let folder = Folder::new("forms");
    let cube = cube();
    std::fs::create_dir_all(folder.path("box")).expect("a folder");
    let names = ["right", "left", "top", "bottom", "front", "back"];
    for (i, face) in cube.faces().iter().enumerate() {
        write(face, &folder.path(&format!("f-{}.exr", FACE_NAMES[i])));
        write(face, &folder.path(&format!("box/room_{}.exr", names[i])));
    }
    write(
        &cube.to_image(Layout::HorizontalCross),
        &folder.path("cross.exr"),
    );
    for name in ["cross.exr", "box", "f-{face}.exr"] {
        let opened = open_map(&folder.path(name), None).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(opened.map, cube, "{name}");
        assert!(!opened.is_8_bit && opened.negative.is_none(), "{name}");
        let files = map_files(&folder.path(name), None).expect("they are there");
        assert_eq!(files, opened.files, "{name}");
    }
    let halves = EnvironmentMap::from_fn(Projection::Paraboloid, 8, 1, |d| Rgb::splat(d.z + 1.0));
    std::fs::create_dir_all(folder.path("halves")).expect("a folder");
    for (half, name) in halves.faces().iter().zip(["front", "back"]) {
        write(half, &folder.path(&format!("halves/{name}.exr")));
    }
    let opened = open_map(&folder.path("halves"), None).expect("two halves");
    assert_eq!(opened.map, halves, "told by their names");
}

#[test]
fn pixels_that_no_light_has_are_counted_and_made_finite() {
    let folder = Folder::new("flaws");
    let mut image = Image::filled(8, 4, Rgb::splat(0.5));
    *image.pixel_mut(6, 1) = Rgb::new(1.0, f32::NAN, f32::INFINITY);
    *image.pixel_mut(2, 3) = Rgb::new(f32::NEG_INFINITY, 1.0, -2.0);
    *image.pixel_mut(1, 2) = Rgb::new(0.0, -0.25, 1.0);
    let path = folder.path("sky.exr");
    write(&image, &path);
    let opened = open_map(&path, None).expect("it is read nevertheless");
    let flaw = opened.non_finite.expect("two pixels");
    assert_eq!((flaw.pixels, flaw.x, flaw.y), (2, 6, 1), "{flaw}");
    assert_eq!(flaw.file, path, "where they are");
    let negative = opened.negative.expect("a pixel");
    assert_eq!((negative.pixels, negative.x, negative.y), (1, 1, 2));
    let texel = |x, y| opened.map.texel(0, x, y).to_array();
    assert_eq!(texel(6, 1), [1.0, 0.0, 65_504.0], "no number, too much");
    assert_eq!(texel(2, 3), [-65_504.0, 1.0, -2.0], "signs stay");
    assert_eq!(texel(1, 2), [0.0, -0.25, 1.0], "negative ones stay");
    assert!(opened.map.radiance(Vec3::X).is_finite(), "for lookups");
}

#[test]
fn what_is_no_map_is_refused_in_a_line() {
    let folder = Folder::new("refused");
    let square = Image::filled(4, 4, Rgb::WHITE);
    let mut png = BufWriter::new(File::create(folder.path("square.png")).expect("a file"));
    square.write_png(&mut png).expect("PNG");
    drop(png);
    let square_file = folder.path("square.png");
    assert!(
        open_map(&square_file, Some(Projection::Sphere)).is_ok(),
        "as told"
    );
    let all = [
        (square_file, None, "neither a panorama"),
        (folder.path("none.hdr"), None, "there is no such file"),
        (folder.path(""), None, "no six pictures"),
        (folder.path("x-{face}.png"), None, "no such files"),
    ];
    for (path, from, wanted) in all {
        let error = open_map(&path, from).expect_err("no map").to_string();
        assert!(error.contains(wanted) && !error.contains('\n'), "{error}");
        assert!(!error.contains("os error"), "{error}");
    }
    for name in FACE_NAMES {
        write(&square, &folder.path(&format!("q-{name}.exr")));
    }
    let error = open_map(&folder.path("q-{face}.exr"), Some(Projection::LatLong));
    assert!(
        matches!(error, Err(OpenMapError::Count { .. })),
        "{error:?}"
    );
}
