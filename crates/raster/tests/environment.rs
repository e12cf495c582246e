//! Environment maps at work: conversion keeps light, blur keeps light, harmonics are what they claim.

use core::f64::consts::{FRAC_PI_2, PI};
use glam::Vec3;
use hemicube_raster::Rgb;
use hemicube_raster::environment::{
    Bounds, Choice, ConvertOptions, DistantLight, EnvironmentMap, EnvironmentPyramid,
    EnvironmentSet, IrradianceSum, Lobe, PrefilterOptions, PrefilteredEnvironment, Probe,
    Projection, SphericalHarmonics, convert, highlights,
};
use hemicube_raster::reflection::BlinnPhong;

const WHOLE: [Projection; 6] = [
    Projection::Cube,
    Projection::LatLong,
    Projection::Sphere,
    Projection::Paraboloid,
    Projection::Octahedral,
    Projection::Angular,
];

/// A sky with a horizon, a soft sun and a checkered ground: smooth parts and edges.
fn sky(d: Vec3) -> Rgb {
    let sun = 40.0 * (d.dot(Vec3::new(0.5, 0.6, -0.62).normalize()) - 0.98).max(0.0);
    if d.y < 0.0 {
        let (x, z) = (d.x / d.y, d.z / d.y);
        let is_dark = (x.floor() + z.floor()).rem_euclid(2.0) < 1.0;
        return Rgb::new(0.3, 0.25, 0.2) * if is_dark { 0.3 } else { 1.0 };
    }
    Rgb::new(0.3 + 0.2 * d.x, 0.5, 0.9 - 0.4 * d.y) + Rgb::splat(sun)
}

#[test]
fn uniform_light_stays_uniform() {
    for from in Projection::ALL {
        for to in Projection::ALL {
            let source = EnvironmentMap::from_fn(from, 16, 1, |_| Rgb::new(0.25, 1.0, 3.0));
            let (map, report) = convert(&source, to, &ConvertOptions::default());
            assert!(
                report.solid_angle_error.abs() < 1e-12,
                "{from} to {to}: {report:?}"
            );
            if from.covers_sphere() {
                let angles = map.solid_angles();
                for (i, &texel) in map.texels().iter().enumerate() {
                    // What lies outside a disc is black; the rest is rounding.
                    if angles[i % angles.len()] < 1e-12 {
                        continue;
                    }
                    let off = (texel - Rgb::new(0.25, 1.0, 3.0)).map(f32::abs).max_band();
                    assert!(off < 2e-6, "{from} to {to}: {texel:?}");
                }
            }
            if from.covers_sphere() && to.covers_sphere() {
                assert!(report.flux_error() < 1e-6, "{from} to {to}: {report:?}");
            }
        }
    }
}

#[test]
fn flux_is_kept() {
    for from in WHOLE {
        let source = EnvironmentMap::from_fn(from, 24, 4, sky);
        for to in WHOLE {
            for rows in [10, 0] {
                let (_, report) = convert(&source, to, &ConvertOptions::default().with_rows(rows));
                assert!(
                    report.spread() < 5e-3,
                    "{from} to {to} of {rows} rows: {report:?}"
                );
                assert!(
                    report.flux_error() < 1e-6,
                    "{from} to {to} of {rows} rows: {report:?}"
                );
            }
        }
    }
}

/// A single bright texel, anywhere, is a sun: it keeps its energy, and nearly all of that stays where it is.
#[test]
fn a_sun_of_one_texel_keeps_its_energy() {
    for from in WHOLE {
        let dark = EnvironmentMap::from_fn(from, 16, 1, |_| Rgb::splat(0.1));
        let angles = dark.solid_angles();
        let is_inside = |i: &usize| {
            angles[i % angles.len()] > 0.6 * angles.iter().sum::<f64>() / angles.len() as f64
        };
        let suns: Vec<usize> = (0..dark.texels().len())
            .step_by(197)
            .filter(is_inside)
            .collect();
        for to in WHOLE {
            for &sun in &suns {
                let mut texels = 0..;
                let source = dark.map(|&light| {
                    if texels.next() == Some(sun) {
                        Rgb::splat(1e4)
                    } else {
                        light
                    }
                });
                let (_, report) = convert(&source, to, &ConvertOptions::default().with_rows(16));
                // A sun in one texel of a few hundred: the coarsest case there is.
                assert!(
                    report.spread() < 0.03,
                    "{from} to {to}, texel {sun}: {report:?}"
                );
                assert!(
                    report.flux_error() < 1e-6,
                    "{from} to {to}, texel {sun}: {report:?}"
                );
            }
        }
    }
}

#[test]
fn harmonics_survive_conversion() {
    for from in WHOLE {
        let source = EnvironmentMap::from_fn(from, 24, 4, sky);
        let before = SphericalHarmonics::of_map(&source, 4);
        for to in WHOLE {
            let (map, _) = convert(&source, to, &ConvertOptions::default());
            let after = SphericalHarmonics::of_map(&map, 4);
            let scale = before.coefficients()[0][1];
            let mut worst: f64 = 0.0;
            for (a, b) in before.coefficients().iter().zip(after.coefficients()) {
                worst = worst.max((a[1] - b[1]).abs() / scale);
            }
            // Texels are up to 10 degrees wide here; the error falls with their size.
            let allowed = 0.02;
            assert!(worst < allowed, "{from} to {to}: {worst}");
        }
    }
}

#[test]
fn levels_keep_flux() {
    for projection in WHOLE {
        let map = EnvironmentMap::from_fn(projection, 64, 2, sky);
        let pyramid = EnvironmentPyramid::new(map);
        let wanted = pyramid.base().flux()[1];
        for level in pyramid.levels() {
            let change = level.flux()[1] / wanted - 1.0;
            assert!(change.abs() < 1e-6, "{projection}: {change}");
        }
    }
}

/// Directions spread evenly (Fibonacci lattice).
fn directions(n: u32) -> impl Iterator<Item = Vec3> {
    (0..n).map(move |i| {
        let y = 1.0 - (2 * i + 1) as f32 / n as f32;
        let turn = (i as f32 * 2.399_963_2) % (2.0 * core::f32::consts::PI);
        let rho = (1.0 - y * y).sqrt();
        Vec3::new(rho * turn.cos(), y, rho * turn.sin())
    })
}

#[test]
fn harmonics_are_orthonormal() {
    let degree = 4;
    let basis = |index: usize| {
        // The light of one harmonic, by way of a map of a light that has all of them.
        EnvironmentMap::from_fn(Projection::Cube, 48, 1, |d| {
            let known = [
                0.282_095,
                0.488_603 * d.x,
                0.488_603 * d.y,
                0.488_603 * d.z,
                1.092_548 * d.x * d.z,
                1.092_548 * d.x * d.y,
                0.315_392 * (3.0 * d.y * d.y - 1.0),
                1.092_548 * d.y * d.z,
                0.546_274 * (d.z * d.z - d.x * d.x),
            ];
            Rgb::splat(known[index])
        })
    };
    for index in 0..9 {
        let harmonics = SphericalHarmonics::of_map(&basis(index), degree);
        for (i, coefficient) in harmonics.coefficients().iter().enumerate() {
            let wanted = if i == index { 1.0 } else { 0.0 };
            assert!(
                (coefficient[0] - wanted).abs() < 1e-3,
                "{index} in {i}: {coefficient:?}"
            );
        }
    }
    let many = SphericalHarmonics::of_map(&basis(6), 99);
    assert_eq!(many.degree(), SphericalHarmonics::MAX_DEGREE, "clamped");
    for d in directions(50) {
        let found = many.radiance(d).r;
        let wanted = 0.315_392 * (3.0 * d.y * d.y - 1.0);
        assert!((found - wanted).abs() < 3e-3, "{found} is not {wanted}");
    }
}

#[test]
fn irradiance_of_degree_2_is_near_the_truth() {
    let map = EnvironmentMap::from_fn(Projection::Cube, 16, 2, sky);
    let by_texels = IrradianceSum::new(&map);
    let mut errors = vec![];
    for degree in [1, 2, 4, 8] {
        let harmonics = SphericalHarmonics::of_map(&map, degree);
        let (mut sum, mut truth_sum) = (0.0, 0.0);
        for normal in directions(60) {
            let truth = by_texels.irradiance(normal).g;
            sum += (harmonics.irradiance(normal).g - truth).powi(2);
            truth_sum += truth;
        }
        errors.push((sum / 60.0).sqrt() / (truth_sum / 60.0));
    }
    assert!(
        errors[1] < 0.02 && errors[2] < 0.006 && errors[3] < 0.003,
        "{errors:?}"
    );
    assert!(
        errors[0] > 3.0 * errors[1],
        "degree 1 is not enough: {errors:?}"
    );
}

#[test]
fn uniform_light_has_irradiance_pi() {
    for projection in WHOLE {
        let map = EnvironmentMap::from_fn(projection, 16, 1, |_| Rgb::WHITE);
        let harmonics = SphericalHarmonics::of_map(&map, 3);
        for normal in directions(20) {
            let found = harmonics.irradiance(normal).g / core::f32::consts::PI;
            assert!(
                (found - 1.0).abs() < 4e-3,
                "{projection} {normal}: {found} π"
            );
        }
    }
}

#[test]
fn white_furnace_stays_white() {
    let map = EnvironmentMap::from_fn(Projection::LatLong, 16, 1, |_| Rgb::WHITE);
    let pyramid = EnvironmentPyramid::new(map);
    for lobe in [Lobe::Ggx, Lobe::Phong] {
        let options = PrefilterOptions::default()
            .with_rows(16)
            .with_levels(5)
            .with_samples(32)
            .with_lobe(lobe);
        let blurred = PrefilteredEnvironment::new(&pyramid, &options);
        for level in blurred.levels() {
            for texel in level.texels() {
                assert!((texel.g - 1.0).abs() < 1e-5, "{lobe:?}: {texel:?}");
            }
        }
    }
}

/// Solid angle that a lobe would fill at the height of its peak, by the midpoint rule over the angle.
fn width(lobe: Lobe, roughness: f32) -> f64 {
    let steps = 200_000;
    let peak = f64::from(lobe.weight(roughness, 1.0));
    let sum: f64 = (0..steps)
        .map(|i| {
            // Squared, so that narrow lobes have enough steps.
            let t = (f64::from(i) + 0.5) / f64::from(steps);
            let (angle, step) = (FRAC_PI_2 * t * t, FRAC_PI_2 * 2.0 * t / f64::from(steps));
            #[expect(clippy::cast_possible_truncation, reason = "a cosine")]
            let weight = lobe.weight(roughness, angle.cos() as f32);
            f64::from(weight) * angle.sin() * step
        })
        .sum();
    2.0 * PI * sum / peak
}

#[test]
fn phong_is_as_wide_as_ggx() {
    for roughness in [0.1, 0.25, 0.4, 0.5, 0.75, 0.9, 1.0] {
        let [ggx, phong] = [Lobe::Ggx, Lobe::Phong].map(|lobe| width(lobe, roughness));
        // Cosines are f32: near 1 they leave steps in narrow lobes.
        assert!(
            (phong / ggx - 1.0).abs() < 5e-3,
            "{roughness}: {phong} sr, GGX {ggx} sr"
        );
    }
    // A power of the cosine fills 2π / (n + 1). Blinn's exponent of the same roughness is four times n.
    let exponent = 2.0 * PI / width(Lobe::Phong, 0.3) - 1.0;
    let blinn = f64::from(BlinnPhong::from_roughness(0.3 * 0.3).exponent);
    assert!(
        (4.0 * exponent / blinn - 1.0).abs() < 0.1,
        "{exponent}, {blinn}"
    );
}

/// Whether any part of a texel lies in the disc of its face.
fn is_in_disc(n: usize, x: usize, y: usize) -> bool {
    let parts = (0..33 * 33).map(|i| (i % 33, i / 33));
    let at = |i: usize, part: usize| (i as f32 + part as f32 / 32.0) * 2.0 / n as f32 - 1.0;
    parts
        .into_iter()
        .any(|(i, j)| at(x, i).hypot(at(y, j)) < 0.999)
}

#[test]
fn corners_around_discs_are_black() {
    let source = EnvironmentMap::from_fn(Projection::Cube, 16, 1, |_| Rgb::splat(0.7));
    for to in [
        Projection::Sphere,
        Projection::Angular,
        Projection::Fisheye,
        Projection::Hemispherical,
    ] {
        for rows in [9, 32] {
            let (converted, _) = convert(&source, to, &ConvertOptions::default().with_rows(rows));
            let made = EnvironmentMap::from_fn(to, rows, 2, |_| Rgb::splat(0.7));
            for i in 0..rows * rows {
                let (x, y) = (i % rows, i / rows);
                let wanted = if is_in_disc(rows, x, y) { 0.7 } else { 0.0 };
                for map in [&converted, &made] {
                    let light = map.texel(0, x, y).g;
                    assert!(
                        (light - wanted).abs() < 1e-5,
                        "{to}, {rows} rows, ({x}, {y}): {light}"
                    );
                }
            }
        }
    }
}

#[test]
fn blur_is_near_the_sum_over_all_texels() {
    let map = EnvironmentMap::from_fn(Projection::Cube, 64, 2, sky);
    let angles = map.solid_angles();
    let pyramid = EnvironmentPyramid::new(map.clone());
    for lobe in [Lobe::Ggx, Lobe::Phong] {
        let options = PrefilterOptions::default()
            .with_rows(32)
            .with_levels(5)
            .with_lobe(lobe);
        let blurred = PrefilteredEnvironment::new(&pyramid, &options);
        for level in 1..5 {
            let roughness = level as f32 / 4.0;
            let map_of_level = &blurred.levels()[level];
            let (mut error, mut mean, mut count) = (0.0, 0.0, 0.0);
            for i in (0..map_of_level.texels().len()).step_by(101) {
                let n = map_of_level.height();
                let (face, y, x) = (i / (n * n), i / n % n, i % n);
                let axis = map_of_level.direction(face, x, y);
                let (mut sum, mut weights) = (0.0, 0.0);
                for (k, light) in map.texels().iter().enumerate() {
                    let (face, y, x) = (k / 4096, k / 64 % 64, k % 64);
                    let cosine = map.direction(face, x, y).dot(axis);
                    let weight = f64::from(lobe.weight(roughness, cosine)) * angles[k % 4096];
                    sum += weight * f64::from(light.g);
                    weights += weight;
                }
                let truth = sum / weights;
                error += (f64::from(map_of_level.texels()[i].g) - truth).powi(2);
                mean += truth;
                count += 1.0;
            }
            let relative = (error / count).sqrt() / (mean / count);
            assert!(
                relative < 0.03,
                "{lobe:?}, roughness {roughness}: {relative}"
            );
        }
    }
}

#[test]
fn highlights_carry_the_irradiance_of_their_lamps() {
    let lights = [
        DistantLight {
            direction: Vec3::new(1.0, 2.0, 0.5),
            irradiance: Rgb::new(3.0, 2.0, 1.0),
        },
        DistantLight {
            direction: Vec3::NEG_Z,
            irradiance: Rgb::splat(0.5),
        },
        DistantLight {
            direction: Vec3::ZERO,
            irradiance: Rgb::splat(9.0),
        },
    ];
    let map = highlights(&lights, 40.0, Projection::Octahedral, 64, 4);
    let flux = map.flux();
    for (band, wanted) in [3.5, 2.5, 1.5].into_iter().enumerate() {
        assert!((flux[band] / wanted - 1.0).abs() < 2e-3, "{flux:?}");
    }
    let peak = map.radiance(Vec3::NEG_Z).g;
    let wanted = 0.5 * 41.0 / (2.0 * core::f32::consts::PI);
    assert!((peak / wanted - 1.0).abs() < 0.02, "{peak} is not {wanted}");
}

#[test]
fn pyramids_answer_with_the_level_that_fits() {
    let map = EnvironmentMap::from_fn(Projection::Cube, 64, 1, sky);
    let pyramid = EnvironmentPyramid::from(map);
    assert_eq!(pyramid.levels().len(), 7, "64 to 1");
    let d = Vec3::new(0.3, 0.2, -0.9).normalize();
    assert_eq!(
        pyramid.radiance(d, 0.0),
        pyramid.base().radiance(d),
        "finest"
    );
    assert_eq!(
        pyramid.radiance(d, f32::NAN),
        pyramid.base().radiance(d),
        "NaN"
    );
    assert_eq!(
        pyramid.radiance(d, 99.0),
        pyramid.levels()[6].radiance(d),
        "coarsest"
    );
    let texel = Projection::Cube.density(glam::Vec2::splat(0.5)) / 4096.0;
    let lod = pyramid.lod_of(Vec3::NEG_Z, 16.0 * texel);
    assert!((lod - 2.0).abs() < 1e-3, "16 texels are level 2, not {lod}");
    // A texel of the finest level wide: no level above it.
    let step = Vec3::X * 2.0 / 64.0;
    let found = pyramid.radiance_by_derivatives(Vec3::NEG_Z, step, Vec3::ZERO);
    assert_eq!(found, pyramid.base().radiance(Vec3::NEG_Z), "level 0");
}

/// A bare room of walls in different colours.
fn room() -> (Bounds, impl Fn(Vec3, Vec3) -> Rgb + Sync) {
    let bounds = Bounds {
        low: Vec3::new(-2.0, 0.0, -3.0),
        high: Vec3::new(2.0, 2.5, 3.0),
    };
    let trace = move |from: Vec3, d: Vec3| {
        let wall = |axis: usize| {
            let wall = if d[axis] > 0.0 {
                bounds.high[axis]
            } else {
                bounds.low[axis]
            };
            if d[axis] == 0.0 {
                f32::INFINITY
            } else {
                (wall - from[axis]) / d[axis]
            }
        };
        let distance = wall(0).min(wall(1)).min(wall(2));
        let hit = (from + d * distance - bounds.low) / (bounds.high - bounds.low);
        Rgb::new(hit.x, hit.y, hit.z)
    };
    (bounds, trace)
}

#[test]
fn box_projection_is_exact_for_bare_walls() {
    let (bounds, trace) = room();
    let probe = |position: Vec3| Probe {
        position,
        map: EnvironmentMap::from_fn(Projection::Cube, 64, 1, |d| trace(position, d)),
        room: Some(bounds),
    };
    let set = EnvironmentSet::new(vec![
        probe(Vec3::new(-1.0, 1.0, -1.5)),
        probe(Vec3::new(1.0, 1.2, 1.0)),
        Probe {
            position: Vec3::NAN,
            ..probe(Vec3::ONE)
        },
    ]);
    assert_eq!(set.probes().len(), 2, "one is nowhere");
    let point = Vec3::new(0.2, 0.7, 0.4);
    let error = |choice: Choice| {
        let all = directions(2000).map(|d| {
            let difference = set.radiance(point, d, choice) - trace(point, d);
            difference.map(f32::abs).max_band()
        });
        all.fold(0.0, f32::max)
    };
    // Where walls meet, the map is bilinear across the edge.
    assert!(
        error(Choice::BoxProjected) < 0.03,
        "{}",
        error(Choice::BoxProjected)
    );
    assert!(
        error(Choice::Blend) > 0.2 && error(Choice::Nearest) > 0.2,
        "parallax is wrong without it"
    );
    let at_probe = set.radiance(Vec3::new(1.0, 1.2, 1.0), Vec3::X, Choice::Blend);
    assert_eq!(
        at_probe,
        set.probes()[1].map.radiance(Vec3::X),
        "at a probe its own map"
    );
    assert_eq!(
        EnvironmentSet::default().radiance(point, Vec3::X, Choice::Nearest),
        Rgb::BLACK,
        "empty"
    );
}

#[test]
fn results_do_not_depend_on_threads() {
    let source = EnvironmentMap::from_fn(Projection::LatLong, 24, 1, sky);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| {
            let (map, report) = convert(&source, Projection::Cube, &ConvertOptions::default());
            (map, report, SphericalHarmonics::of_map(&source, 3))
        })
    };
    assert_eq!(on(1), on(5), "1 and 5 threads");
}
