//! Volumes of nested solids against closed form, by two ways that share no code: points inside, and lengths of spans.

mod common;

use common::Numbers;
use core::f64::consts::PI;
use glam::{DAffine3, DMat3, DVec3};
use hemicube_csg::{CsgError, Ray, Solid};

/// Share of random points of a box that lie inside, times its volume; and its standard deviation.
fn by_points(solid: &Solid, count: u32) -> (f64, f64) {
    let bounds = solid.bounds();
    let size = bounds.high - bounds.low;
    let mut numbers = Numbers::new(5);
    let inside = (0..count)
        .filter(|_| {
            let share = (numbers.point() + 1.0) * 0.5;
            solid.contains(bounds.low + size * share)
        })
        .count() as f64;
    let (count, volume) = (f64::from(count), size.element_product());
    let share = inside / count;
    (
        volume * share,
        volume * (share * (1.0 - share) / count).sqrt(),
    )
}

/// Lengths of spans of parallel rays, one at a random place of each cell of a grid.
fn by_rays(solid: &Solid, side: u32) -> f64 {
    let bounds = solid.bounds();
    let size = bounds.high - bounds.low;
    let mut numbers = Numbers::new(6);
    let mut sum = 0.0;
    for i in 0..side {
        for j in 0..side {
            let u = (f64::from(i) + numbers.next()) / f64::from(side);
            let v = (f64::from(j) + numbers.next()) / f64::from(side);
            let start = bounds.low + size * DVec3::new(-0.5, u, v);
            let spans = solid.spans(&Ray::new(start, DVec3::X));
            sum += spans.iter().map(|s| s.end - s.start).sum::<f64>();
        }
    }
    sum * size.y * size.z / f64::from(side * side)
}

fn check(name: &str, solid: Result<Solid, CsgError>, expected: f64) {
    let solid = solid.expect("a solid");
    // Bounds have a margin of 1e-9, which a box as its own bounds shows.
    let (volume, deviation) = by_points(&solid, 200_000);
    assert!(
        (volume - expected).abs() < 4.0 * deviation + 1e-7 * expected,
        "{name}: {volume} ± {deviation} by points, {expected} in truth"
    );
    // Stratified: the error of 160² rays is below 1 in 1000 for all of these.
    let volume = by_rays(&solid, 160);
    assert!(
        (volume / expected - 1.0).abs() < 1e-3,
        "{name}: {volume} by rays, {expected} in truth"
    );
}

const O: DVec3 = DVec3::ZERO;

#[test]
fn primitives_have_their_volumes() {
    check("ball", Solid::sphere(O, 0.7), 4.0 / 3.0 * PI * 0.343);
    check("box", Solid::cuboid(O, DVec3::new(1.0, 2.0, 3.0)), 6.0);
    let tilted = DVec3::new(1.0, 2.0, 2.0);
    check("rod", Solid::cylinder(O, tilted, 0.5), PI * 0.25 * 3.0);
    check("cone", Solid::cone(O, 1.0, tilted), PI);
    check(
        "frustum",
        Solid::frustum(O, 0.5, tilted, 1.0),
        PI * (0.25 + 0.5 + 1.0),
    );
    check(
        "ring",
        Solid::torus(O, tilted, 1.0, 0.3),
        2.0 * PI * PI * 0.09,
    );
}

#[test]
fn an_apple_has_the_volume_of_its_revolution() {
    // Rings of radius rho and height 2 sqrt(r² - (rho - R)²), by the midpoint rule.
    let (ring, tube, steps) = (0.4, 0.6, 200_000);
    let step = (ring + tube) / f64::from(steps);
    let shell = |i: i32| {
        let rho = (f64::from(i) + 0.5) * step;
        4.0 * PI * rho * (tube * tube - (rho - ring).powi(2)).max(0.0).sqrt() * step
    };
    check(
        "apple",
        Solid::torus(O, DVec3::Y, ring, tube),
        (0..steps).map(shell).sum(),
    );
}

#[test]
fn nested_solids_have_their_volumes() -> Result<(), CsgError> {
    // A ball with a round hole, 2 h long: 4/3 π h³ whatever the radius (the napkin ring).
    let hole = Solid::cylinder(DVec3::new(0.0, -2.0, 0.0), DVec3::new(0.0, 2.0, 0.0), 0.6)?;
    let napkin_ring = Solid::sphere(O, 1.0)? - hole;
    check(
        "napkin ring",
        Ok(napkin_ring.clone()),
        4.0 / 3.0 * PI * 0.512,
    );

    // Two rods that cross at right angles: 16/3 r³ (Steinmetz); three: 8 (2 - sqrt 2) r³.
    let rod = |axis: DVec3| Solid::cylinder(axis * -2.0, axis * 2.0, 1.0);
    let two = rod(DVec3::X)? & rod(DVec3::Y)?;
    check("two rods", Ok(two.clone()), 16.0 / 3.0);
    check(
        "three rods",
        Ok(two & rod(DVec3::Z)?),
        8.0 * (2.0 - 2.0_f64.sqrt()),
    );

    // Two balls at distance d: π (4 r + d) (2 r - d)² / 12 in common.
    let pair = |d: f64| Ok([Solid::sphere(O, 1.0)?, Solid::sphere(DVec3::X * d, 1.0)?]);
    let lens = PI * (4.0 + 0.8) * 1.2_f64.powi(2) / 12.0;
    let ball = 4.0 / 3.0 * PI;
    let [a, b] = pair(0.8)?;
    check("lens", Ok(a & b), lens);
    let [a, b] = pair(0.8)?;
    check("moon", Ok(a - b), ball - lens);
    let [a, b] = pair(0.8)?;
    check("both", Ok(a | b), 2.0 * ball - lens);

    // A box without a napkin ring's complement's other half, sheared and stretched: volumes scale with the
    // determinant.
    let shear = DMat3::from_cols_array(&[1.5, 0.2, 0.0, -0.3, 0.7, 0.4, 0.1, 0.0, 2.0]);
    let half = napkin_ring & Solid::half_space(O, DVec3::new(1.0, 1.0, 1.0))?;
    let sheared = half.transformed(DAffine3::from_mat3(shear));
    let expected = 0.5 * 4.0 / 3.0 * PI * 0.512 * shear.determinant();
    check("half a napkin ring, sheared", sheared, expected);

    // A hollow die with a pip: 2³ - 1.8³ minus the part of a ball of radius 0.3 within the wall of 0.1.
    let cube = |half: f64| Solid::cuboid(DVec3::splat(-half), DVec3::splat(half));
    let pip = Solid::sphere(DVec3::Y, 0.3)?;
    let cap = |h: f64| PI * h * h * (0.9 - h) / 3.0;
    let in_wall = 2.0 / 3.0 * PI * 0.027 - cap(0.2);
    let die = cube(1.0)? - cube(0.9)? - pip;
    check("die", Ok(die), 8.0 - 1.8_f64.powi(3) - in_wall);
    Ok(())
}

#[test]
fn many_solids_are_one_union() -> Result<(), CsgError> {
    let mut numbers = Numbers::new(11);
    let balls: Result<Vec<Solid>, CsgError> = (0..300)
        .map(|i| {
            let place = DVec3::new(
                f64::from(i % 10),
                f64::from(i / 10 % 10),
                f64::from(i / 100),
            );
            Solid::sphere(place + numbers.point() * 0.1, 0.3)
        })
        .collect();
    check(
        "300 balls",
        Ok(Solid::union(balls?)),
        300.0 * 4.0 / 3.0 * PI * 0.027,
    );
    assert!(!Solid::union([]).contains(O), "the union of none is empty");
    Ok(())
}
