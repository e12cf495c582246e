//! Rays through solids: how many each primitive, a union and a tree answer in a second, in CPU time of one thread.
//!
//! Each solid first has its volume by lengths of spans compared with closed form; medians of rounds.

use cpu_time::ThreadTime;
use glam::DVec3;
use hemicube::csg::{CsgError, Ray, Solid};
use hemicube_tests::spheres::random;
use std::f64::consts::PI;

const RAYS: u64 = 100_000;
const ROUNDS: usize = 7;

fn main() -> Result<(), CsgError> {
    println!("solid: rays per second of one thread, of which hit, volume off by");
    for (name, solid, volume) in solids()? {
        let rays = rays(&solid);
        let (off, hits) = check(&solid, &rays, volume);
        let seconds = measure(&solid, &rays);
        println!(
            "{name:>14}: {:6.2} M/s, {:3.0} %, {:+.2} %",
            RAYS as f64 / seconds / 1e6,
            100.0 * hits,
            100.0 * off
        );
    }
    Ok(())
}

/// With their volumes.
fn solids() -> Result<Vec<(&'static str, Solid, f64)>, CsgError> {
    let (o, y) = (DVec3::ZERO, DVec3::Y);
    let rod = |axis: DVec3| Solid::cylinder(axis * -2.0, axis * 2.0, 1.0);
    let balls: Result<Vec<Solid>, CsgError> = (0..1000_u32)
        .map(|i| {
            let place = [i % 10, i / 10 % 10, i / 100].map(f64::from);
            Solid::sphere(place.into(), 0.3)
        })
        .collect();
    let hole = Solid::cylinder(y * -2.0, y * 2.0, 0.6)?;
    Ok(vec![
        ("sphere", Solid::sphere(o, 1.0)?, 4.0 / 3.0 * PI),
        ("cuboid", Solid::cuboid(-DVec3::ONE, DVec3::ONE)?, 8.0),
        ("cone", Solid::cone(o, 1.0, y)?, PI / 3.0),
        ("torus", Solid::torus(o, y, 1.0, 0.3)?, 2.0 * PI * PI * 0.09),
        (
            "napkin ring",
            Solid::sphere(o, 1.0)? - hole,
            4.0 / 3.0 * PI * 0.512,
        ),
        (
            "three rods",
            rod(DVec3::X)? & rod(y)? & rod(DVec3::Z)?,
            8.0 * (2.0 - 2.0_f64.sqrt()),
        ),
        (
            "1000 balls",
            Solid::union(balls?),
            1000.0 * 4.0 / 3.0 * PI * 0.027,
        ),
    ])
}

/// Parallel to z, at random places of the side of the solid's box.
fn rays(solid: &Solid) -> Vec<Ray> {
    let (low, high) = (solid.bounds().low, solid.bounds().high);
    let ray = |i: u64| {
        let [u, v] = [0, 1].map(|k| f64::from(random(7, 2 * i + k)));
        let start = low + (high - low) * DVec3::new(u, v, -1.0);
        Ray::new(start, DVec3::Z)
    };
    (0..RAYS).map(ray).collect()
}

/// How far the volume by lengths of spans is off, and the share of rays that hit.
fn check(solid: &Solid, rays: &[Ray], volume: f64) -> (f64, f64) {
    let size = solid.bounds().high - solid.bounds().low;
    let (mut length, mut hits) = (0.0, 0.0);
    for ray in rays {
        let spans = solid.spans(ray);
        length += spans.iter().map(|s| s.end - s.start).sum::<f64>();
        hits += f64::from(u8::from(!spans.is_empty()));
    }
    let count = rays.len() as f64;
    let off = length / count * size.x * size.y / volume - 1.0;
    assert!(off.abs() < 0.01, "volume off by {off}: not worth measuring");
    (off, hits / count)
}

fn measure(solid: &Solid, rays: &[Ray]) -> f64 {
    let mut seconds: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let start = ThreadTime::now();
            let count: usize = rays.iter().map(|ray| solid.spans(ray).len()).sum();
            std::hint::black_box(count);
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[ROUNDS / 2]
}
