//! Whether radiosity by rays states its noise truly: a run to a noise of 3 %, then [`CHECKED`] of its elements again with
//! [`TIMES`] the rays. Arguments behind `--`: scene, elements, noise; once for each number of threads that follows, by default
//! all at once.

use hemicube::radiosity::{
    PatchOptions, Quality, SolveOptions, Solver, Stochastic, StochasticOptions, unlit,
};
use hemicube::scene::builtin;
use hemicube_tests::solutions::balance_error;
use std::sync::Arc;
use std::time::Instant;

/// Elements that are computed again.
const CHECKED: usize = 2000;
/// Rays of those, for each that they had.
const TIMES: u32 = 64;

fn main() {
    let asked: Vec<String> = std::env::args()
        .skip(1)
        .filter(|arg| !arg.starts_with('-'))
        .collect();
    let word = |i: usize, default: &'static str| asked.get(i).map_or(default, String::as_str);
    let elements: usize = word(1, "20000").parse().expect("a number of elements");
    let noise: f64 = word(2, "0.03").parse().expect("a noise");
    let name = word(0, "cornell");
    let threads: Vec<usize> = asked
        .iter()
        .skip(3)
        .map(|n| n.parse().expect("a number of threads"))
        .collect();
    let pools = if threads.is_empty() {
        &[0]
    } else {
        &threads[..]
    };
    for &threads in pools {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads")
            .install(|| check(name, elements, noise));
    }
}

fn check(name: &str, elements: usize, noise: f64) {
    let begin = Instant::now();
    let scene = Arc::new(builtin::scene(name).expect("the name of a built-in scene"));
    let options = SolveOptions {
        mesh: PatchOptions::default()
            .with_elements(elements)
            .with_patches((elements / 20).clamp(400, 50_000)),
        ..Quality::Normal.into()
    };
    let start = unlit(scene, &options, &|| false).expect("a mesh");
    println!(
        "{name}: {} elements on {} patches, {} threads; mesh {:.1} s",
        start.mesh().elements().len(),
        start.mesh().patches().len(),
        rayon::current_num_threads(),
        begin.elapsed().as_secs_f64()
    );
    let options = StochasticOptions {
        noise,
        ..StochasticOptions::default()
    };
    let mut solver = Stochastic::new(start, options).expect("options that it takes");
    while !solver.is_exhausted() {
        solver.step();
    }
    let seconds = begin.elapsed().as_secs_f64();
    let error = balance_error(solver.solution());
    assert!(error < 1e-4, "{error:.1e} of the energy is lost");
    for (name, stage) in solver.stages().named() {
        let (rays, rate) = (stage.rays as f64 / 1e6, stage.rate() / 1e6);
        let seconds = stage.time.as_secs_f64();
        println!("{name}: {rays:.1} M rays, {seconds:.1} s, {rate:.2} M/s");
    }
    println!("noise {:.4} after {seconds:.1} s", solver.noise());
    let check = solver.check_noise(CHECKED, TIMES);
    println!(
        "{} elements: noise {:.4} stated, {:.4} found, by {:.1} M rays",
        check.elements,
        check.stated,
        check.found,
        check.rays as f64 / 1e6
    );
}
