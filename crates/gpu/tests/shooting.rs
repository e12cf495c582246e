//! Shooting on the device against shooting on the CPU.

mod device;
mod light;

use device::context;
use hemicube_gpu::{Context, GpuShooting};
use hemicube_radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube_radiosity::solve::shooting::{Order, Shooting};
use hemicube_radiosity::stop::NEVER;
use hemicube_radiosity::{Grouping, SolveOptions, Solver, unlit};
use hemicube_scene::builtin;
use light::assert_alike;
use std::sync::Arc;
use std::time::Duration;

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

/// A solver on the office with groups of its own for its lamps, coarse.
fn office(context: Arc<Context>) -> GpuShooting {
    let scene = Arc::new(builtin::scene("office").expect("a built-in scene"));
    let mut options = SolveOptions::default();
    options.mesh = options.mesh.with_elements(1000).with_patches(200);
    options.grouping = Grouping::ByMaterial;
    let start = unlit(scene, &options, NEVER).expect("a start");
    let hemicube = HemicubeOptions::default().with_resolution(64);
    GpuShooting::new(context, start, hemicube).expect("a solver")
}

#[test]
fn what_comes_after_a_step_is_small_and_true() {
    let Some(context) = context() else { return };
    let mut solver = office(context).with_hemicubes_per_step(3);
    let (elements, channels) = {
        let solution = solver.solution();
        let elements = solution.mesh().elements().len();
        (elements, 3 * solution.groups().len())
    };
    solver.watch([7, elements + 5, 300]);
    assert_eq!(solver.watched().count(), 0, "nothing was seen yet");
    let before = solver.step_bytes();
    for _ in 0..4 {
        solver.step();
    }
    // State, seven words a channel, two elements.
    let of_step = (32 + 4 * channels * 7 + 2 * 4 * channels) as u64;
    assert_eq!(solver.step_bytes() - before, 4 * of_step, "nothing else");
    assert_eq!(solver.light_bytes(), 0, "no light");
    assert!(solver.is_ahead(), "the device is");
    let unshot: f64 = solver.fluxes().iter().map(|flux| flux.unshot.abs()).sum();
    let share = unshot / solver.solution().reference_flux();
    let known = solver.progress().unshot;
    assert!((share - known).abs() < 1e-4 * known, "{share} {known}");
    let escaped: Vec<f64> = solver.fluxes().iter().map(|flux| flux.escaped).collect();

    // Light at the end of a shot, when it can come without another one.
    solver.settle();
    assert!(!solver.is_ahead(), "it has come");
    let light = (4 * channels * (2 * elements + 7)) as u64;
    assert!(
        solver.light_bytes() >= light,
        "once: {}",
        solver.light_bytes()
    );
    let solution = solver.solution();
    let mesh = solution.mesh();
    let area = |e: usize| f64::from(mesh.exposed_area(e));
    let fluxes = solver.fluxes();
    for group in 0..solution.groups().len() {
        for band in 0..3 {
            let flux = &fluxes[3 * group + band];
            let sum = |values: &[f32]| -> f64 {
                let values = values.iter().enumerate();
                values.map(|(e, &x)| area(e) * f64::from(x)).sum()
            };
            let wanted = [
                solution.irradiance(group, band),
                solution.unshot(group, band),
            ]
            .map(sum);
            let scale = wanted[0].abs() + wanted[1].abs() + 1e-9;
            for (found, wanted) in [flux.received, flux.unshot].into_iter().zip(wanted) {
                let off = (found - wanted).abs() / scale;
                assert!(off < 1e-4, "{group} {band}: {found} {wanted}");
            }
            assert_eq!(flux.escaped, 0.0, "it is booked");
            let booked = solution.balance(group, band).escaped;
            let known = escaped[3 * group + band];
            assert!(booked >= known * 0.9999, "{booked} {known}");
        }
    }
    let bytes = solver.light_bytes();
    solver.settle();
    assert_eq!(solver.light_bytes(), bytes, "nothing was new");

    let lit = |&e: &usize| solver.solution().element_irradiance(e).luminance() > 0.0;
    let lit: Vec<usize> = (0..elements).filter(lit).take(2).collect();
    solver.watch(lit.iter().copied());
    let before = solver.solution().clone();
    solver.step();
    let watched: Vec<(usize, Vec<f32>)> = solver
        .watched()
        .map(|(element, light)| (element, light.to_vec()))
        .collect();
    assert_eq!([watched[0].0, watched[1].0], lit[..], "in their order");
    // The rest of a shot comes with all light.
    solver.settle();
    for (element, light) in watched {
        let solution = solver.solution();
        for (channel, &seen) in light.iter().enumerate() {
            let [before, after] =
                [&before, solution].map(|s| s.irradiance(channel / 3, channel % 3)[element]);
            assert!((before..=after).contains(&seen), "{before} {seen} {after}");
        }
        assert!(light.iter().any(|&x| x > 0.0), "{element} is lit");
    }
}

#[test]
fn light_is_the_same_however_many_hemicubes_a_step_has() {
    let Some(context) = context() else { return };
    let solved = |hemicubes: u32, steps: u32| {
        let mut solver = office(context.clone()).with_hemicubes_per_step(hemicubes);
        for _ in 0..steps {
            solver.step();
        }
        solver.into_solution()
    };
    let (a, b) = (solved(1, 12), solved(6, 2));
    for channel in 0..3 * a.groups().len() {
        let [a, b] = [&a, &b].map(|s| s.irradiance(channel / 3, channel % 3));
        assert!(a == b, "the same bits in channel {channel}");
    }
}

#[test]
fn steps_that_overlap_bring_the_same_light() {
    let Some(context) = context() else { return };
    let mut paced = office(context.clone()).with_step_time(Duration::from_secs(1));
    paced.watch([7]);
    for _ in 0..5 {
        paced.step();
    }
    // A step has up to twice as many as the one before.
    let hemicubes = u32::try_from(paced.hemicubes()).expect("a few");
    assert!((5..=31).contains(&hemicubes), "{hemicubes}");
    assert!(paced.watched().count() == 1, "a step was read");
    let mut whole = office(context).with_hemicubes_per_step(hemicubes);
    whole.step();
    let [a, b] = [paced, whole].map(GpuShooting::into_solution);
    assert_eq!(a.provenance.steps, b.provenance.steps, "shots");
    for channel in 0..3 * a.groups().len() {
        let [a, b] = [&a, &b].map(|s| s.irradiance(channel / 3, channel % 3));
        assert!(a == b, "the same bits in channel {channel}");
    }
}
