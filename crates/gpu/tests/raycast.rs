//! Rays of the GPU against those of the CPU.

mod device;

use device::context;
use hemicube_gpu::GpuRayCast;
use hemicube_radiosity::form_factor::raycast::Strategy;
use hemicube_radiosity::form_factor::{FormFactors, RayCast, RayCastOptions, Row};
use hemicube_radiosity::patch::{PatchMesh, PatchOptions};
use hemicube_scene::builtin;
use std::sync::Arc;

#[test]
fn rows_are_those_of_the_cpu_within_their_standard_errors() {
    let Some(context) = context() else { return };
    for (scene, elements) in [("cornell", 600), ("office", 3000)] {
        let scene = builtin::scene(scene).expect("a built-in scene");
        let mesh = PatchOptions::default()
            .with_elements(elements)
            .with_patches(elements / 4);
        let mesh = Arc::new(PatchMesh::build(Arc::new(scene), mesh).expect("a mesh"));
        let options = RayCastOptions {
            rays: 2048,
            strategy: Strategy::Shots,
            seed: 3,
            shot_rays: None,
        };
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
