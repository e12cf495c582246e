//! Files that others made, damaged and whole, through everything: opened, lit, solved, stored, read again, drawn.
//!
//! They are not part of the project; `HEMICUBE_TESTDATA` says where they are.

use hemicube::radiosity::export::lit_glb::{LitGlbOptions, read, write};
use hemicube::radiosity::{PatchOptions, Solution, SolveOptions, solve};
use hemicube::raster::tonemap::{Exposure, ToneMap};
use hemicube::raster::{Image, Rgb};
use hemicube::render::{RenderOptions, choose_camera, render_display};
use hemicube::scene::{Scene, SceneOptions, open};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Faces above which a file is only opened: each face is at least one element, whatever is asked for.
const MOST_FACES: usize = 20_000;

/// Steps of each file; many faces take long ones.
const STEPS: u64 = 40;

/// All files of a folder and the folders in it, sorted.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder that is there can be listed");
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry that is there can be read").path())
        .collect();
    paths.sort();
    let below = |path: PathBuf| {
        if path.is_dir() {
            files(&path)
        } else {
            vec![path]
        }
    };
    paths.into_iter().flat_map(below).collect()
}

fn budget() -> SolveOptions {
    SolveOptions {
        mesh: PatchOptions::default().with_elements(300).with_patches(60),
        rays: 16,
        max_steps: Some(STEPS),
        ..SolveOptions::default()
    }
}

fn under_a_sky(mut scene: Scene) -> Scene {
    let options = SceneOptions {
        sky: Some(Rgb::splat(1000.0)),
        ..SceneOptions::default()
    };
    scene.apply(&options).expect("any scene can have a sky");
    scene
}

/// Asserts what must hold for any message.
fn assert_one_line(place: &str, message: &str) {
    assert!(
        !message.contains(['\n', '\r']) && message.len() < 1500,
        "{place}: not one line: {message}"
    );
}

/// Asserts what must hold for the light of any scene.
fn assert_sound(place: &str, solution: &Solution) {
    for band in 0..3 {
        let values = solution.irradiance(0, band);
        let wrong = values.iter().position(|h| !h.is_finite() || *h < 0.0);
        assert!(
            wrong.is_none(),
            "{place}: irradiance of element {wrong:?} in band {band} is negative or not finite"
        );
        let balance = solution.total_balance(band);
        let error = balance.relative_error(solution.unshot_flux(band));
        // Light is kept in f32: sums of a few thousand shots are good to five digits.
        assert!(
            error < 1e-4,
            "{place}: energy is off by {error} in band {band}: {balance:?}"
        );
    }
}

/// What a display shows from the file's first camera, or from one that sees the scene.
fn picture(place: &str, solution: &Solution, size: (usize, usize)) -> Image<Rgb> {
    let cameras = &solution.mesh().scene().cameras;
    let camera = cameras
        .first()
        .cloned()
        .unwrap_or_else(|| choose_camera(solution.mesh()));
    let options = RenderOptions::default()
        .with_size(size.0, size.1)
        .with_samples(1);
    let (exposure, tone_map) = (Exposure::Auto, ToneMap::default());
    let image = render_display(solution, &camera, &options, exposure, tone_map)
        .unwrap_or_else(|error| panic!("{place}: camera '{}': {error}", camera.name));
    assert!(
        image.pixels().iter().all(|pixel| pixel.is_finite()),
        "{place}: a pixel is not finite"
    );
    image
}

/// Stores a solution, reads it again and asserts that the light is the same.
fn stored_and_read(place: &str, solution: &Solution) -> Solution {
    let bytes = write(solution, &LitGlbOptions::default())
        .unwrap_or_else(|error| panic!("{place}: cannot be stored: {error}"));
    let again = read(&bytes).unwrap_or_else(|error| panic!("{place}: cannot be read: {error}"));
    for band in 0..3 {
        assert_eq!(
            again.irradiance(0, band),
            solution.irradiance(0, band),
            "{place}: stored light in band {band}"
        );
    }
    again
}

/// One file through everything; whether it could be lit.
fn goes_through(path: &Path) -> bool {
    let place = path.display().to_string();
    let scene = match open(path.to_str().expect("the names of the test data are UTF-8")) {
        Ok(scene) => scene,
        Err(error) => {
            assert_one_line(&place, &error.to_string());
            return false;
        }
    };
    if let Err(error) = scene.check() {
        panic!("{place}: opens but is not consistent: {error}");
    }
    for warning in &scene.report.warnings {
        assert_one_line(&place, &warning.to_string());
    }
    if scene.face_count() > MOST_FACES {
        println!("{place}: {} faces, only opened", scene.face_count());
        return false;
    }
    let solution = match solve(Arc::new(under_a_sky(scene)), &budget(), |_, _| true) {
        Ok(solution) => solution,
        Err(error) => {
            assert_one_line(&place, &error.to_string());
            return false;
        }
    };
    assert_sound(&place, &solution);
    let again = stored_and_read(&place, &solution);
    picture(&place, &again, (64, 48));
    true
}

/// Sends all files of a folder through everything; there must be at least so many and so many of them lit.
fn walk(folder: &str, least_files: usize, least_lit: usize) {
    let Some(root) = hemicube_tests::testdata() else {
        return;
    };
    let files = files(&root.join(folder));
    let lit = files.iter().filter(|path| goes_through(path)).count();
    println!("{folder}: {} files, {lit} of them lit", files.len());
    assert!(
        files.len() >= least_files && lit >= least_lit,
        "{folder}: {lit} of {} files were lit; there should be {least_lit} of {least_files}",
        files.len()
    );
}

#[test]
fn damaged_files_are_refused_or_go_through_everything() {
    walk("hostile", 600, 10);
}

#[test]
fn whole_files_go_through_everything() {
    walk("scenes", 100, 20);
}

/// A file that we know: its triangles as others count them, its light, and how to find it.
struct Known {
    path: &'static str,
    triangles: usize,
    sky: f32,
    emit: Option<(&'static str, Rgb)>,
    elements: usize,
}

const KNOWN: [Known; 5] = [
    Known {
        path: "godot_room/room.glb",
        triangles: 63_720,
        sky: 1000.0,
        emit: None,
        elements: 300,
    },
    Known {
        path: "playcanvas/house.glb",
        triangles: 10_497,
        sky: 1000.0,
        emit: None,
        elements: 300,
    },
    Known {
        path: "cornell_gltf_kajiya/scene.gltf",
        triangles: 32,
        sky: 0.0,
        emit: Some(("light", Rgb::new(17.0, 12.0, 4.0))),
        elements: 800,
    },
    Known {
        path: "emissive_triangle/triangle.glb",
        triangles: 1,
        sky: 0.0,
        emit: None,
        elements: 300,
    },
    Known {
        path: "polyhaven_chair/plastic_monobloc_chair_01_1k.gltf",
        triangles: 3356,
        sky: 1000.0,
        emit: None,
        elements: 300,
    },
];

fn triangle_count(scene: &Scene) -> usize {
    let of_mesh = |mesh: usize| {
        let faces = scene.meshes[mesh].faces.iter();
        faces.map(|face| face.corners().len() - 2).sum::<usize>()
    };
    scene.instances.iter().map(|i| of_mesh(i.mesh)).sum()
}

/// Mean luminance of a picture, in [0, 1].
fn mean_luminance(image: &Image<Rgb>) -> f32 {
    let sum: f32 = image.pixels().iter().map(|pixel| pixel.luminance()).sum();
    sum / image.pixels().len() as f32
}

#[test]
fn known_files_have_their_triangles_and_a_picture() {
    let Some(root) = hemicube_tests::testdata() else {
        return;
    };
    for known in KNOWN {
        let place = known.path;
        let path = root.join("scenes").join(place);
        let name = path.to_str().expect("the names of the test data are UTF-8");
        let mut scene =
            open(name).unwrap_or_else(|error| panic!("a file that is whole opens: {error}"));
        assert_eq!(
            triangle_count(&scene),
            known.triangles,
            "{place}: triangles"
        );
        let options = SceneOptions {
            sky: (known.sky > 0.0).then(|| Rgb::splat(known.sky)),
            emit: known
                .emit
                .map(|(material, radiance)| (String::from(material), radiance))
                .into_iter()
                .collect(),
            ..SceneOptions::default()
        };
        scene
            .apply(&options)
            .unwrap_or_else(|error| panic!("{place}: {error}"));
        let options = SolveOptions {
            mesh: budget().mesh.with_elements(known.elements),
            max_steps: Some(200),
            ..budget()
        };
        let solution = solve(Arc::new(scene), &options, |_, _| true)
            .unwrap_or_else(|error| panic!("{place}: {error}"));
        assert_sound(place, &solution);
        let mean = mean_luminance(&picture(place, &solution, (96, 64)));
        assert!(
            (0.05..0.9).contains(&mean),
            "{place}: a picture of mean {mean} is black or blown out"
        );
    }
}
