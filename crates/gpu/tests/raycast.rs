//! Rays of the GPU against those of the CPU.

mod device;

use device::{context, found};
use glam::{Affine3A, Vec3};
use hemicube_gpu::{Context, ContextOptions, GpuRayCast, RayQueries};
use hemicube_radiosity::form_factor::raycast::Strategy;
use hemicube_radiosity::form_factor::{FormFactors, RayCast, RayCastOptions, Row};
use hemicube_radiosity::patch::{PatchMesh, PatchOptions};
use hemicube_scene::mesh::{Face, Instance, Mesh};
use hemicube_scene::{Scene, builtin};
use std::sync::Arc;

/// A device whose rays are cast by the adapter's own queries, if there is one, which it says otherwise.
fn with_queries() -> Option<Arc<Context>> {
    let options = ContextOptions::default().with_ray_queries(RayQueries::Always);
    let context = found(Context::with_options(&options))?;
    if !context.has_ray_queries() {
        println!("skipped: {} has no ray queries", context.name);
        return None;
    }
    Some(context)
}

/// A device that walks a tree.
fn with_tree() -> Option<Arc<Context>> {
    let options = ContextOptions::default().with_ray_queries(RayQueries::Never);
    found(Context::with_options(&options))
}

/// Cornell's room with a plate across its middle that is seen from one side and absorbs on the other, or only blocks.
fn with_plate(blocks: bool) -> Scene {
    let mut scene = builtin::scene("cornell").expect("it is built in");
    let mut material = scene.materials[0].clone();
    (material.double_sided, material.obstruction) = (false, blocks);
    scene.materials.push(material);
    let (low, high) = scene.bounds().expect("it has faces");
    let (middle, size) = ((low + high) / 2.0, high - low);
    let corner = |x: f32, z: f32| middle + Vec3::new(x * size.x, 0.2 * size.y, z * size.z);
    let plate = Mesh {
        name: String::from("plate"),
        material: scene.materials.len() - 1,
        positions: vec![
            corner(-0.3, -0.3),
            corner(0.3, -0.3),
            corner(0.3, 0.3),
            corner(-0.3, 0.3),
        ],
        faces: vec![Face::Quad([0, 1, 2, 3])],
        ..Mesh::default()
    };
    scene.instances.push(Instance {
        node: plate.name.clone(),
        mesh: scene.meshes.len(),
        world_from_mesh: Affine3A::IDENTITY,
        flipped: false,
    });
    scene.meshes.push(plate);
    scene
}

#[test]
fn software_walks_a_tree_unless_it_is_told_otherwise() {
    let Some(context) = context() else { return };
    let adapters = hemicube_gpu::adapters();
    let of_context = adapters.iter().find(|a| a.name == context.name);
    let kind = of_context.map_or("", |adapter| adapter.kind);
    if std::env::var_os(hemicube_gpu::RAY_QUERY_VARIABLE).is_none() && kind == "software" {
        assert!(!context.has_ray_queries(), "{}", context.name);
    }
    let tree = with_tree().expect("there is an adapter");
    assert!(!tree.has_ray_queries(), "it was told not to");
}

#[test]
fn rows_are_those_of_the_cpu_within_their_standard_errors() {
    let Some(context) = with_tree() else { return };
    compare_with_the_cpu(&context);
}

#[test]
fn rows_by_ray_queries_are_those_of_the_cpu_within_their_standard_errors() {
    let Some(context) = with_queries() else {
        return;
    };
    compare_with_the_cpu(&context);
}

#[test]
fn rays_of_ray_queries_arrive_where_those_of_the_tree_do() {
    let (Some(queries), Some(tree)) = (with_queries(), with_tree()) else {
        return;
    };
    let scene = |name| builtin::scene(name).expect("a built-in scene");
    for (scene, elements, absorbs) in [
        (scene("cornell"), 600, false),
        (with_plate(false), 600, true),
        (with_plate(true), 600, true),
        (scene("office"), 3000, false),
        (scene("theatre"), 4000, false),
    ] {
        let (mesh, options) = (meshed(scene, elements, elements / 4), shots());
        let mut absorbed = 0.0;
        let [a, b] = [&queries, &tree].map(|context| {
            GpuRayCast::new(context.clone(), mesh.clone(), options).expect("factors")
        });
        let (mut found, mut wanted) = (Row::default(), Row::default());
        let (mut rays, mut others) = (0.0, 0.0);
        for &patch in mesh.patches().iter().step_by(mesh.patches().len() / 40 + 1) {
            a.fill_row(patch, &mut found);
            b.fill_row(patch, &mut wanted);
            let of_patch = f64::from(RayCast::new(mesh.clone(), options).rays_of_shot(patch));
            let mut counts = vec![0.0; mesh.elements().len() + 2];
            for (row, sign) in [(&found, 1.0), (&wanted, -1.0)] {
                for (&e, &f) in row.receivers.iter().zip(row.band(0)) {
                    counts[e as usize] += sign * f64::from(f) * of_patch;
                }
                let [.., absorbed, escaped] = &mut counts[..] else {
                    unreachable!("there are bins")
                };
                *absorbed += sign * f64::from(row.absorbed[0]) * of_patch;
                *escaped += sign * f64::from(row.escaped[0]) * of_patch;
            }
            // A ray that arrives elsewhere is missed there and found here.
            others += counts.iter().map(|count: &f64| count.abs()).sum::<f64>() / 2.0;
            rays += of_patch;
            absorbed += found.absorbed[0];
        }
        println!(
            "{}: {others:.0} of {rays} rays arrive elsewhere",
            mesh.scene().name
        );
        assert!(others <= 2e-4 * rays, "{others} of {rays}");
        assert!(!absorbs || absorbed > 0.5, "backs absorb: {absorbed}");
        assert_eq!((a.failure(), b.failure()), (None, None), "devices work");
    }
}

#[test]
fn trees_over_the_limits_are_refused_in_words() {
    let Some(context) = with_queries() else {
        return;
    };
    let mut low = Arc::into_inner(context).expect("nobody else has it");
    low.limits.max_blas_primitive_count = 100;
    let scene = builtin::scene("cornell").expect("a built-in scene");
    let mesh = meshed(scene, 600, 100);
    let refused = GpuRayCast::new(Arc::new(low), mesh, RayCastOptions::default());
    let told = refused.expect_err("it is too large").to_string();
    for part in ["triangles", "100", "the CPU"] {
        assert!(told.contains(part), "'{part}' is not in: {told}");
    }
}

fn meshed(scene: Scene, elements: usize, patches: usize) -> Arc<PatchMesh> {
    let options = PatchOptions::default()
        .with_elements(elements)
        .with_patches(patches);
    Arc::new(PatchMesh::build(Arc::new(scene), options).expect("a mesh"))
}

fn shots() -> RayCastOptions {
    RayCastOptions {
        rays: 2048,
        strategy: Strategy::Shots,
        seed: 3,
        shot_rays: None,
    }
}

fn compare_with_the_cpu(context: &Arc<Context>) {
    for (scene, elements) in [("cornell", 600), ("office", 3000)] {
        let scene = builtin::scene(scene).expect("a built-in scene");
        let (mesh, options) = (meshed(scene, elements, elements / 4), shots());
        let cpu = RayCast::new(mesh.clone(), options);
        let gpu = GpuRayCast::new(context.clone(), mesh.clone(), options).expect("factors");
        let (mut a, mut b, mut again) = (Row::default(), Row::default(), Row::default());
        let (mut worst, mut escaped) = (0.0_f64, 0.0_f64);
        for &patch in mesh.patches().iter().step_by(mesh.patches().len() / 12 + 1) {
            cpu.fill_row(patch, &mut a);
            gpu.fill_row(patch, &mut b);
            gpu.fill_row(patch, &mut again);
            assert_eq!(b, again, "the same bits in every run");
            assert!((b.sum(&mesh, 0) - 1.0).abs() < 1e-5, "{}", b.sum(&mesh, 0));
            let rays = f64::from(cpu.rays_of_shot(patch));
            let mut pairs = vec![[0.0_f64; 2]; mesh.elements().len()];
            for (row, which) in [(&a, 0), (&b, 1)] {
                for (&e, &f) in row.receivers.iter().zip(row.band(0)) {
                    pairs[e as usize][which] = f64::from(f);
                }
            }
            pairs.push([f64::from(a.absorbed[0]), f64::from(b.absorbed[0])]);
            pairs.push([f64::from(a.escaped[0]), f64::from(b.escaped[0])]);
            escaped += f64::from(b.escaped[0]);
            for [x, y] in pairs {
                // Of two counts of independent rays; two rays more, because a few are not a normal distribution.
                let error = (2.0 * (x + y) / rays).sqrt() + 2.0 / rays;
                worst = worst.max((x - y).abs() / error);
            }
        }
        println!(
            "{}: worst {worst:.2} standard errors, escaped {escaped:.2}",
            mesh.scene().name
        );
        assert!(worst < 4.5, "{worst} standard errors");
        if mesh.scene().name == "office" {
            assert_eq!(escaped, 0.0, "rays slip through the walls of a closed room");
        }
        assert_eq!(gpu.failure(), None, "the device works");
    }
}
