//! Panes: what is seen through them on the device against the CPU's layers.

mod device;
mod light;

use device::context;
use glam::{Affine3A, Vec3};
use hemicube_gpu::{GpuHemicube, GpuShooting};
use hemicube_radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube_radiosity::form_factor::{FormFactors, Row};
use hemicube_radiosity::patch::{PatchMesh, PatchOptions};
use hemicube_radiosity::solve::shooting::{Order, Shooting};
use hemicube_radiosity::stop::NEVER;
use hemicube_radiosity::{SolveOptions, Solver, unlit};
use hemicube_raster::Rgb;
use hemicube_scene::mesh::{Face, Instance, Mesh};
use hemicube_scene::{Scene, builtin};
use light::assert_alike;
use std::sync::Arc;

/// A scene with upright panes across its middle, each of its own colour, that let half of it through.
fn with_panes(name: &str, colors: &[Rgb]) -> Scene {
    let mut scene = builtin::scene(name).expect("it is built in");
    let (low, high) = scene.bounds().expect("it has faces");
    let (middle, size) = ((low + high) / 2.0, high - low);
    for (i, &color) in colors.iter().enumerate() {
        let z = middle.z + size.z * 0.02 * i as f32;
        let corner = |x: f32, y: f32| Vec3::new(middle.x + x * size.x, middle.y + y * size.y, z);
        let pane = Mesh {
            name: format!("pane {i}"),
            material: scene.materials.len(),
            positions: vec![
                corner(-0.3, -0.4),
                corner(0.3, -0.4),
                corner(0.3, 0.4),
                corner(-0.3, 0.4),
            ],
            faces: vec![Face::Quad([0, 1, 2, 3])],
            ..Mesh::default()
        };
        let mut glass = scene.materials[0].clone();
        (glass.transmission, glass.base_color, glass.double_sided) = (0.5, color, true);
        glass.emission = Rgb::BLACK;
        scene.materials.push(glass);
        scene.instances.push(Instance {
            node: pane.name.clone(),
            mesh: scene.meshes.len(),
            world_from_mesh: Affine3A::IDENTITY,
            flipped: false,
        });
        scene.meshes.push(pane);
    }
    scene
}

fn mesh(scene: Scene, elements: usize) -> Arc<PatchMesh> {
    let options = PatchOptions::default()
        .with_elements(elements)
        .with_patches(elements / 4);
    Arc::new(PatchMesh::build(Arc::new(scene), options).expect("a mesh"))
}

const TINTS: [Rgb; 3] = [
    Rgb::new(1.0, 0.5, 0.25),
    Rgb::new(0.3, 0.9, 0.8),
    Rgb::new(0.9, 0.9, 0.2),
];

#[test]
fn rows_through_panes_are_those_of_the_cpu() {
    let Some(context) = context() else { return };
    for panes in [1, 3] {
        let mesh = mesh(with_panes("cornell", &TINTS[..panes]), 500);
        let options = HemicubeOptions::default().with_resolution(64);
        let cpu = Hemicube::new(mesh.clone(), options).expect("CPU");
        assert!(cpu.is_layered(), "panes let light through");
        let gpu = GpuHemicube::new(context.clone(), mesh.clone(), options).expect("GPU");
        let (mut a, mut b, mut again) = (Row::default(), Row::default(), Row::default());
        let mut worst = 0.0_f64;
        let mut through = 0;
        for &patch in mesh.patches().iter().step_by(mesh.patches().len() / 8 + 1) {
            cpu.fill_row(patch, &mut a);
            gpu.fill_row(patch, &mut b);
            gpu.fill_row(patch, &mut again);
            assert_eq!(b, again, "{panes} panes: the same bits in every run");
            assert_eq!(b.bands, 3, "{panes} tinted panes: a factor for each band");
            for band in 0..3 {
                let sum = b.sum(&mesh, band);
                assert!((sum - 1.0).abs() < 1e-5, "{panes} panes: {sum}");
                let mut dense = vec![0.0_f64; mesh.elements().len()];
                for (row, sign) in [(&a, 1.0), (&b, -1.0)] {
                    for (&e, &f) in row.receivers.iter().zip(row.band(band)) {
                        dense[e as usize] += sign * f64::from(f);
                    }
                }
                worst = dense.iter().map(|d| d.abs()).sum::<f64>().max(worst);
            }
            through += usize::from(b.band(0) != b.band(2));
        }
        println!("{panes} panes: rows differ by {worst:.2e} of the light, {through} are tinted");
        assert!(through > 3, "some patches look through");
        // As without panes: cells at outlines fall to one side or the other.
        assert!(worst < 2e-3, "{panes} panes: {worst}");
        assert_eq!(gpu.failure(), None, "the device works");
    }
}

#[test]
fn light_through_panes_is_that_of_the_cpu_and_none_is_lost() {
    let Some(context) = context() else { return };
    let scene = Arc::new(with_panes("cornell", &TINTS[..2]));
    let mut options = SolveOptions::default();
    options.mesh = options.mesh.with_elements(300).with_patches(80);
    let start = unlit(scene, &options, NEVER).expect("a start");
    let hemicube = HemicubeOptions::default().with_resolution(64);
    let factors = Hemicube::new(start.mesh().clone(), hemicube).expect("factors");
    let mut cpu = Shooting::new(&factors, start.clone(), Order::Sorted);
    let mut gpu = GpuShooting::new(context, start, hemicube).expect("a solver");
    for _ in 0..2 {
        gpu.step();
    }
    gpu.settle();
    while cpu.progress().iteration < gpu.progress().iteration {
        cpu.step();
    }
    let (cpu, gpu) = (cpu.into_solution(), gpu.into_solution());
    // Small receivers are counted here and integrated there.
    assert_alike(&cpu, &gpu, 0.02);
}
