//! The same input gives the same bits on any number of threads.

use hemicube::radiosity::form_factor::raycast::Strategy;
use hemicube::radiosity::{
    FormFactors, Order, PatchMesh, PatchOptions, Quality, RayCast, RayCastOptions,
};
use hemicube::radiosity::{
    GatherOptions, Gatherer, Shooting, Solution, SolveOptions, Solver, solve,
};
use hemicube::raster::Rgb;
use hemicube::scene::{Scene, builtin};
use hemicube_tests::reference_points;
use std::sync::Arc;

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads can be started").install(work)
}

fn irradiance_bits(solution: &Solution) -> Vec<u32> {
    let channels = (0..3).flat_map(|band| solution.irradiance(0, band).iter());
    channels.map(|h| h.to_bits()).collect()
}

fn with_sky_and_sun() -> Scene {
    use hemicube::scene::{Light, LightKind};
    let mut scene = builtin::scene("cornell").expect("it is built in");
    scene.sky = Rgb::new(0.2, 0.3, 0.5);
    let direction = glam::Vec3::new(0.2, -0.5, 1.0).normalize();
    let kind = LightKind::Directional {
        direction,
        irradiance: Rgb::splat(3.0),
    };
    scene.lights.push(Light {
        name: "sun".into(),
        kind,
    });
    scene
}

#[test]
fn solutions_and_measurements_have_the_same_bits() {
    let points = reference_points("cornell");
    let run = |threads| {
        on_threads(threads, || {
            let options = SolveOptions {
                max_steps: Some(200),
                ..Quality::Draft.into()
            };
            let solution = solve(Arc::new(with_sky_and_sun()), &options, |_, _| true)
                .expect("it can be solved");
            let gatherer = Gatherer::new(&solution, GatherOptions { rays: 64, seed: 0 });
            let measured: Vec<_> = points
                .iter()
                .map(|p| gatherer.irradiance(p.point, p.normal))
                .collect();
            (irradiance_bits(&solution), measured)
        })
    };
    let one = run(1);
    for threads in [2, 8] {
        assert!(
            run(threads) == one,
            "{threads} threads give other bits than one"
        );
    }
}

#[test]
fn shots_have_the_same_bits() {
    let run = |threads| {
        on_threads(threads, || {
            let options = PatchOptions::default().with_elements(500);
            let mesh = Arc::new(
                PatchMesh::build(Arc::new(with_sky_and_sun()), options).expect("it can be cut"),
            );
            let ray_options = RayCastOptions {
                strategy: Strategy::Shots,
                ..RayCastOptions::default()
            };
            let factors = RayCast::new(mesh.clone(), ray_options);
            let dark = vec![Rgb::BLACK; mesh.elements().len()];
            let solution = Solution::new(mesh, &dark, Default::default());
            let mut solver = Shooting::new(&factors, solution, Order::Sorted);
            (0..50).for_each(|_| {
                solver.step();
            });
            assert!(factors.rays() > 0, "shots cast rays");
            irradiance_bits(solver.solution())
        })
    };
    let one = run(1);
    for threads in [2, 8] {
        assert!(
            run(threads) == one,
            "{threads} threads give other bits than one"
        );
    }
}
