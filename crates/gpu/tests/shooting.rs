//! Shooting on the device against shooting on the CPU.

mod device;

use device::context;
use hemicube_gpu::GpuShooting;
use hemicube_radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube_radiosity::solve::shooting::{Order, Shooting};
use hemicube_radiosity::stop::NEVER;
use hemicube_radiosity::{SolveOptions, Solver, unlit};
use hemicube_scene::builtin;
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
    for band in 0..3 {
        let error = gpu
            .total_balance(band)
            .relative_error(gpu.unshot_flux(band));
        assert!(error < 1e-4, "band {band}: energy is off by {error:.1e}");
    }
    let mesh = cpu.mesh();
    let (mut difference, mut sum) = (0.0, 0.0);
    for e in 0..mesh.elements().len() {
        let (x, y) = (cpu.element_irradiance(e).g, gpu.element_irradiance(e).g);
        let area = f64::from(mesh.exposed_area(e));
        difference += area * f64::from((x - y).abs());
        sum += area * f64::from(x);
    }
    println!("irradiance differs by {:.2e}", difference / sum);
    assert!(difference < 0.01 * sum, "{}", difference / sum);
    assert!((a.unshot - b.unshot).abs() < 0.01, "{a:?} {b:?}");
}
