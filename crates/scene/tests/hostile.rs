//! Files that others made, damaged and whole: each opens or is refused in one line, and nothing panics.
//!
//! They are not part of the project: `HEMICUBE_TESTDATA` or the folder `shared/testdata` beside the workspace has them.

use hemicube_scene::{Scene, SceneError, TextureImage, open, open_bytes};
use std::path::{Path, PathBuf};

/// The files of a folder and the folders in it, sorted; `None` if there is no such folder here.
fn files(folder: &str) -> Option<Vec<PathBuf>> {
    let root = std::env::var_os("HEMICUBE_TESTDATA").map_or_else(
        || {
            PathBuf::from(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../../shared/testdata"
            ))
        },
        PathBuf::from,
    );
    let folder = root.join(folder);
    if !folder.is_dir() {
        println!("skipped: no test data at {}", folder.display());
        return None;
    }
    let (mut files, mut folders) = (Vec::new(), vec![folder]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder that is there can be listed") {
            let path = entry.expect("an entry that is there can be read").path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.push(path);
            }
        }
    }
    files.sort();
    Some(files)
}

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    path.extension()
        .and_then(|e| e.to_str())
        .is_some_and(|e| endings.contains(&e.to_lowercase().as_str()))
}

fn opened(path: &Path) -> Result<Scene, SceneError> {
    open(path.to_str().expect("the names of the test data are UTF-8"))
}

/// Opens every scene of a folder, checks what must hold for any file, and hands the outcome on.
fn open_all(folder: &str, mut look: impl FnMut(&Path, Result<Scene, SceneError>)) {
    for path in files(folder).unwrap_or_default() {
        if !has_ending(&path, &["gltf", "glb", "obj", "stl", "vs3"]) {
            continue;
        }
        let outcome = opened(&path);
        match &outcome {
            Ok(scene) => {
                if let Err(error) = scene.check() {
                    panic!("{}: opens but is not consistent: {error}", path.display());
                }
                assert!(
                    scene.face_count() > 0,
                    "{}: opens without faces",
                    path.display()
                );
                println!(
                    "{}: {} faces, {} warnings",
                    path.display(),
                    scene.face_count(),
                    scene.report.warnings.len()
                );
                for warning in &scene.report.warnings {
                    let line = warning.to_string();
                    assert!(
                        !line.contains('\n'),
                        "{}: a warning of two lines: {line}",
                        path.display()
                    );
                    println!("    {line}");
                }
            }
            Err(error) => {
                let line = error.to_string();
                println!("refused: {line}");
                assert!(
                    !line.contains(['\n', '\r']),
                    "{}: an error of two lines: {line}",
                    path.display()
                );
                assert!(
                    line.contains(path.to_str().unwrap_or_default()),
                    "{line}: does not name {}",
                    path.display()
                );
                assert!(
                    line.len() < 1_000,
                    "{}: an endless line: {line}",
                    path.display()
                );
            }
        }
        look(&path, outcome);
    }
}

#[test]
fn damaged_files_open_or_are_refused_in_one_line() {
    open_all("hostile", |_, _| {});
}

/// Good and damaged files with some bytes changed, by a fixed sequence of pseudo-random numbers (Knuth's MMIX).
#[test]
fn files_with_changed_bytes_do_not_panic() {
    const ROUNDS: usize = 24;
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        usize::try_from(state >> 33).expect("31 bits") % below
    };
    for path in ["hostile", "scenes"]
        .into_iter()
        .flat_map(|folder| files(folder).unwrap_or_default())
    {
        let bytes = std::fs::read(&path).expect("a file that is there can be read");
        if !has_ending(&path, &["gltf", "glb", "obj", "stl", "vs3"])
            || bytes.is_empty()
            || bytes.len() > 50_000
        {
            continue;
        }
        let name = path.to_str().expect("the names of the test data are UTF-8");
        for _ in 0..ROUNDS {
            let mut changed = bytes.clone();
            for _ in 0..=random(4) {
                let place = random(changed.len());
                // A digit among digits keeps JSON and OBJ readable and makes the numbers wrong.
                changed[place] = if changed[place].is_ascii_digit() {
                    b"0123456789-"[random(11)]
                } else {
                    changed[place]
                };
                if random(3) == 0 {
                    changed[place] = u8::try_from(random(256)).expect("a byte");
                }
            }
            match open_bytes(&changed, name, path.parent()) {
                Ok(scene) => assert!(scene.check().is_ok(), "{name}: opens but is not consistent"),
                Err(error) => assert!(
                    !error.to_string().contains('\n'),
                    "{name}: {error:?} is more than one line"
                ),
            }
        }
    }
}

#[test]
fn every_picture_decodes_or_says_why_not() {
    for folder in ["hostile", "scenes", "textures", "env"] {
        for path in files(folder).unwrap_or_default() {
            if has_ending(&path, &["png", "jpg", "jpeg"]) {
                let bytes = std::fs::read(&path).expect("a file that is there can be read");
                if let Err(what) = TextureImage::decode("picture", bytes) {
                    println!("{}: {what}", path.display());
                    assert!(
                        !what.contains('\n'),
                        "{}: {what:?} is more than one line",
                        path.display()
                    );
                }
            }
        }
    }
}

/// Triangles as independent readers count them; a planar convex quad counts as two.
const TRIANGLES: &[(&str, usize)] = &[
    ("gltf_primitives.glb", 12),
    ("IrradianceVolumeExample.glb", 32),
    ("VolumetricFogExample.glb", 360),
    ("cube.gltf", 12),
    ("sphere.gltf", 3968),
    ("torus.gltf", 3072),
    ("suzanne.obj", 968),
    ("teapot.obj", 6320),
    ("cornell_gltf_kajiya/scene.gltf", 32),
    ("cbox_back.obj", 2),
    ("cbox_largebox.obj", 12),
    ("cbox_smallbox.obj", 12),
    ("triangle.glb", 1),
    ("room.glb", 63_720),
    ("zdm2.glb", 58_772),
    ("NormalTangentTest.glb", 7774),
    ("TwoSidedPlane.glb", 2),
    ("geometry-camera-light.glb", 14),
    ("glass-table.glb", 592),
    ("house.glb", 10_497),
    ("icosahedron.glb", 260),
    ("plastic_monobloc_chair_01_1k.gltf", 3356),
    ("roughness_scale/scene.gltf", 51_200),
    ("AlphaBlendModeTest.glb", 61),
    ("BoxTextured.glb", 12),
    ("Duck.glb", 4212),
    ("monkey.glb", 968),
];

fn triangles(scene: &Scene) -> usize {
    let of_mesh = |mesh: usize| {
        scene.meshes[mesh]
            .faces
            .iter()
            .map(|face| face.corners().len() - 2)
            .sum::<usize>()
    };
    scene
        .instances
        .iter()
        .map(|instance| of_mesh(instance.mesh))
        .sum()
}

#[test]
fn whole_files_have_the_triangles_that_others_count() {
    let mut wrong = Vec::new();
    open_all("scenes", |path, outcome| {
        let Some((_, expected)) = TRIANGLES.iter().find(|(name, _)| path.ends_with(name)) else {
            return;
        };
        match outcome {
            Ok(scene) if triangles(&scene) == *expected => {}
            Ok(scene) => wrong.push(format!(
                "{}: {} for {expected}",
                path.display(),
                triangles(&scene)
            )),
            Err(error) => wrong.push(error.to_string()),
        }
    });
    assert!(
        wrong.is_empty(),
        "triangles that differ from what others count: {wrong:#?}"
    );
}
