//! Brightness that the device measures against that which the CPU sorts.

mod common;

use common::{context, lit_builtin};
use hemicube_gpu::pass::{Meter, Walkthrough};
use hemicube_radiosity::Solution;
use hemicube_raster::Rgb;
use hemicube_raster::tonemap::automatic_exposure;
use std::sync::mpsc::channel;
use std::time::Duration;

fn metered(walkthrough: &mut Walkthrough) -> Meter {
    let (send, told) = channel();
    let metering = walkthrough.meter(move || send.send(()).unwrap_or_default());
    walkthrough.context().wait().expect("the device works");
    let wait = Duration::from_secs(5);
    told.recv_timeout(wait).expect("who waits is told");
    metering.take().expect("it is there")
}

/// Luminances and illuminances as the CPU has them.
fn expected(solution: &Solution, ambient: Rgb) -> [Vec<f32>; 2] {
    let mesh = solution.mesh();
    let lit = |e: usize| solution.element_irradiance(e) + ambient;
    let elements = || 0..mesh.elements().len();
    let is_dark = |e: &usize| solution.element_exitance(*e).is_black();
    let reflected = |e: usize| (mesh.reflectance()[e] * lit(e)).luminance() / core::f32::consts::PI;
    let units = mesh.scene().units;
    [
        elements().filter(is_dark).map(reflected).collect(),
        elements().map(|e| units.illuminance(lit(e))).collect(),
    ]
}

fn sorted(values: impl IntoIterator<Item = f32>) -> Vec<f32> {
    let mut values: Vec<f32> = values.into_iter().filter(|&x| x > 0.0).collect();
    values.sort_by(f32::total_cmp);
    values
}

#[test]
fn brightness_is_that_of_the_cpu_to_a_sixteenth_of_a_stop() {
    let Some(context) = context() else { return };
    for (scene, ambient) in [("cornell", Rgb::BLACK), ("office", Rgb::new(3.0, 2.0, 1.0))] {
        let mut solution = lit_builtin(scene, 1200);
        let mut gpu = Walkthrough::new(context.clone(), &solution).expect("a scene");
        for dim in [Rgb::WHITE, Rgb::new(0.5, 0.0, 0.25), Rgb::BLACK] {
            for group in 0..solution.groups().len() {
                solution.set_dim(group, dim);
            }
            gpu.set_dims(&solution).expect("the same mesh");
            gpu.set_ambient(ambient);
            let meter = metered(&mut gpu);
            let [luminances, illuminances] = expected(&solution, ambient);
            let exposures = [
                automatic_exposure(luminances.iter().copied()),
                automatic_exposure(meter.luminances()),
            ];
            let off = exposures[1] / exposures[0] - 1.0;
            println!("{scene}, {dim:?}: exposure {exposures:?}, off by {off:.4}");
            assert!(off.abs() < 0.022, "{scene}: {exposures:?}");
            for (wanted, found) in [
                (luminances, sorted(meter.luminances())),
                (illuminances, sorted(meter.illuminances())),
            ] {
                let wanted = sorted(wanted);
                assert_eq!(wanted.len(), found.len(), "{scene}: as many");
                for (a, b) in wanted.iter().zip(&found) {
                    assert!((b / a - 1.0).abs() < 0.0225, "{scene}: {a} {b}");
                }
            }
        }
    }
}

#[test]
fn surfaces_that_are_painted_are_metered_as_they_are() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 300);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let materials = &solution.mesh().scene().materials;
    let white = materials
        .iter()
        .position(|m| m.name == "white")
        .expect("walls");
    let edit = hemicube_radiosity::MaterialEdit::new(white).with_base_color(Rgb::splat(0.01));
    let painted = solution.mesh().edited(&edit).expect("a colour");
    let before = automatic_exposure(metered(&mut gpu).luminances());
    gpu.set_metered(&painted);
    let after = automatic_exposure(metered(&mut gpu).luminances());
    assert!(after > 2.0 * before, "{before} {after}");
}
