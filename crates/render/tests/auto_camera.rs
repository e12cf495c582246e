//! Views of scenes that bring none.

mod common;

use common::{picture, plain};
use glam::Vec3;
use hemicube_radiosity::{Grouping, PatchMesh, PatchOptions, Solution};
use hemicube_raster::Rgb;
use hemicube_render::choose_camera;
use hemicube_scene::builtin::{self, SceneBuilder, Sides};
use hemicube_scene::{Camera, Scene, Units};
use std::sync::Arc;

fn mesh_of(scene: Scene) -> Arc<PatchMesh> {
    let options = PatchOptions::default().with_elements(200);
    Arc::new(PatchMesh::build(Arc::new(scene), options).expect("surfaces"))
}

fn built_in(name: &str) -> Arc<PatchMesh> {
    mesh_of(builtin::scene(name).expect("built in"))
}

/// Share of the pixels that show a surface, lit evenly.
fn covered(mesh: &Arc<PatchMesh>, camera: &Camera) -> f64 {
    let light = vec![Rgb::WHITE; mesh.elements().len()];
    let solution = Solution::new(mesh.clone(), &light, Grouping::Together);
    let image = picture(&solution, camera, &plain(48));
    let shown = image.pixels().iter().filter(|p| !p.is_black()).count();
    shown as f64 / image.pixels().len() as f64
}

#[test]
fn rooms_are_seen_from_inside() {
    for name in ["furnace", "two-rooms"] {
        let mesh = built_in(name);
        let (low, high) = mesh.scene().bounds().expect("surfaces");
        let camera = choose_camera(&mesh);
        let inside = camera.eye.cmpgt(low).all() && camera.eye.cmplt(high).all();
        assert!(inside, "{name}: eye {}", camera.eye);
        let share = covered(&mesh, &camera);
        assert!(
            share > 0.98,
            "{name}: {share} of the picture shows surfaces"
        );
    }
}

#[test]
fn an_open_box_is_looked_into() {
    let mesh = built_in("cornell");
    let camera = choose_camera(&mesh);
    assert!(
        camera.eye.z < -300.0,
        "before the open front: {}",
        camera.eye
    );
    assert!(camera.forward.z > 0.8, "into it: {}", camera.forward);
}

#[test]
fn things_are_seen_from_outside_and_whole() {
    let mut builder = SceneBuilder::new("cube", Units::Photometric);
    let grey = builder.diffuse("grey", 0.5, 0.5, 0.5);
    builder.node("cube");
    builder.cuboid(grey, Vec3::splat(-3.0), Vec3::splat(5.0), Sides::ALL);
    let mesh = mesh_of(builder.finish());
    let camera = choose_camera(&mesh);
    assert!(camera.eye.distance(Vec3::ONE) > 8.0, "eye {}", camera.eye);
    assert!(camera.eye.y > 1.0, "from above: {}", camera.eye);
    let share = covered(&mesh, &camera);
    assert!((0.2..0.9).contains(&share), "{share} of the picture");
    for name in ["parallel-plates", "perpendicular-plates"] {
        let mesh = built_in(name);
        let share = covered(&mesh, &choose_camera(&mesh));
        assert!(share > 0.05, "{name}: {share} of the picture");
    }
}

#[test]
fn a_slab_is_seen_from_outside() {
    let mut builder = SceneBuilder::new("slab", Units::Photometric);
    let grey = builder.diffuse("grey", 0.5, 0.5, 0.5);
    builder.node("slab");
    let (low, high) = (Vec3::new(-20.0, 0.0, -20.0), Vec3::new(20.0, 0.9, 20.0));
    builder.cuboid(grey, low, high, Sides::ALL);
    let mut scene = builder.finish();
    for material in &mut scene.materials {
        material.double_sided = true;
    }
    let camera = choose_camera(&mesh_of(scene));
    assert!(camera.eye.y > 5.0, "from above: {}", camera.eye);
}

#[test]
fn the_choice_is_the_same_every_time() {
    let mesh = built_in("two-rooms");
    let once = choose_camera(&mesh);
    assert_eq!(choose_camera(&mesh), once, "same mesh, same camera");
}
