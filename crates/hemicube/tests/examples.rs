//! The examples run and say what is true.

#![expect(dead_code, reason = "the examples' main functions are not called here")]

#[path = "../examples/custom_form_factors.rs"]
mod custom_form_factors;
#[path = "../examples/irradiance.rs"]
mod irradiance;
#[path = "../examples/step.rs"]
mod step;

use hemicube::radiosity::{Order, Quality};

#[test]
fn irradiance_is_read_at_points() {
    let points = irradiance::work_plane("cornell", Quality::Draft).expect("the example works");
    assert_eq!(points.len(), 9, "nine points");
    let below_the_light = points[4].1;
    assert!(
        points.iter().all(|(_, h)| h.r <= below_the_light.r),
        "it is brightest below the light"
    );
}

#[test]
fn unshot_energy_falls_faster_when_sorted() {
    let cyclic = step::unshot_history("cornell", Order::Cyclic, 100).expect("the example works");
    let sorted = step::unshot_history("cornell", Order::Sorted, 100).expect("the example works");
    assert!(
        sorted.is_sorted_by(|a, b| a >= b),
        "unshot energy never grows"
    );
    assert!(
        sorted[99] < cyclic[99],
        "sorted {}, cyclic {}",
        sorted[99],
        cyclic[99]
    );
}

#[test]
fn own_form_factors_light_the_furnace() {
    let mean = custom_form_factors::mean_irradiance("furnace").expect("the example works");
    // H = E / (1 - ρ) with E = 1 and ρ = 0.5.
    assert!((mean.g - 2.0).abs() < 1e-4, "mean irradiance {mean:?}");
}
