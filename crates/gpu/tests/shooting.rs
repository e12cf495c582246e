//! Shooting on the device against shooting on the CPU.

mod device;
mod light;

use device::context;
use hemicube_gpu::GpuShooting;
use hemicube_radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube_radiosity::solve::shooting::{Order, Shooting};
use hemicube_radiosity::stop::NEVER;
use hemicube_radiosity::{SolveOptions, Solver, unlit};
use hemicube_scene::builtin;
use light::assert_alike;
use std::sync::Arc;

#[test]
fn light_is_that_of_the_cpu_and_none_is_lost() {
    let Some(context) = context() else { return };
    let scene = Arc::new(builtin::scene("cornell").expect("a built-in scene"));
    let mut options = SolveOptions::default();
    options.mesh = options.mesh.with_elements(1500).with_patches(400);
    let start = unlit(scene, &options, NEVER).expect("a start");
    let hemicube = HemicubeOptions::default().with_resolution(128);
    let factors = Hemicube::new(start.mesh().clone(), hemicube).expect("factors");
    let mut cpu = Shooting::new(&factors, start.clone(), Order::Sorted);
    let mut gpu = GpuShooting::new(context, start, hemicube).expect("a solver");
    assert!(
        (gpu.progress().unshot - cpu.progress().unshot).abs() < 1e-5,
        "the same start"
    );
    for _ in 0..12 {
        gpu.step();
    }
    while cpu.progress().iteration < gpu.progress().iteration {
        cpu.step();
    }
    let (a, b) = (cpu.progress(), gpu.progress());
    println!("{a:?} {b:?}");
    let (cpu, gpu) = (cpu.into_solution(), gpu.into_solution());
    assert_alike(&cpu, &gpu, 0.01);
    assert!((a.unshot - b.unshot).abs() < 0.01, "{a:?} {b:?}");
}
