//! Supersampling: what must come out of any pattern, factor and filter.
#![expect(
    clippy::cast_possible_truncation,
    reason = "test values are rounded to f32 on purpose"
)]

use hemicube_raster::antialias::{Antialiasing, Supersampler, render};
use hemicube_raster::{Image, Rgb};

const NAMES: [&str; 12] = [
    "none",
    "2x2",
    "3x3:bartlett",
    "4x4:bartlett",
    "4x4:bartlett-3x3",
    "3x3-jittered",
    "4x4-jittered@0.125:bartlett",
    "1x1:mitchell",
    "5x5:gaussian",
    "2x2:mitchell",
    "4x4:blackman-harris",
    "3x3:lanczos",
];

fn antialiasing(name: &str) -> Antialiasing {
    name.parse().expect(name)
}

fn wave(x: f64, y: f64) -> f32 {
    (0.5 + 0.5 * (1.3 * x + 0.7 * y).sin() * (0.9 * y).cos()) as f32
}

#[test]
fn flat_stays_flat_up_to_the_borders() {
    for name in NAMES {
        let color = Rgb::new(0.25, 1.0, 1000.0);
        let image = render(&|_: f64, _: f64| color, (7, 5), antialiasing(name));
        for pixel in image.pixels() {
            for band in 0..3 {
                // Rounding of up to 24 x 24 weights in f32.
                let error = (pixel[band] / color[band] - 1.0).abs();
                assert!(error < 1e-6, "{name}: {pixel:?}");
            }
        }
    }
}

#[test]
fn ramps_keep_their_place() {
    // Symmetric weights around the pixel's centre reproduce linear functions; half a sample beside it would show.
    for name in NAMES.iter().filter(|name| !name.contains("jittered")) {
        let sampler = Supersampler::new(9, 6, antialiasing(name));
        let ramp = |x: f64, y: f64| (3.0 * x - 2.0 * y + 1.0) as f32;
        let image = sampler.render(ramp);
        for (i, &value) in image.pixels().iter().enumerate() {
            let expected = ramp((i % 9) as f64 + 0.5, (i / 9) as f64 + 0.5);
            assert!(
                (value - expected).abs() < 3e-5,
                "{name}, pixel {i}: {value}"
            );
        }
    }
}

#[test]
fn pixels_are_the_weighted_sums_of_their_samples() {
    for name in NAMES {
        let sampler = Supersampler::new(6, 5, antialiasing(name));
        let image = sampler.render(wave);
        for (i, &value) in image.pixels().iter().enumerate() {
            let (first_column, first_row) = (i % 6 * sampler.factor(), i / 6 * sampler.factor());
            let mut sum = 0.0;
            for (j, &down) in sampler.weights().iter().enumerate() {
                for (k, &across) in sampler.weights().iter().enumerate() {
                    let [x, y] = sampler.position(first_column + k, first_row + j);
                    sum += f64::from(across) * f64::from(down) * f64::from(wave(x, y));
                }
            }
            assert!((f64::from(value) - sum).abs() < 1e-6, "{name}, pixel {i}");
        }
    }
}

#[test]
fn samples_lie_evenly_around_the_centre_of_their_pixel() {
    for name in NAMES.iter().filter(|name| !name.contains("jittered")) {
        let sampler = Supersampler::new(3, 3, antialiasing(name));
        let rows = sampler.rows(1..2);
        let [_, first] = sampler.position(0, rows.start);
        let [_, last] = sampler.position(0, rows.end - 1);
        assert!(
            (first + last - 3.0).abs() < 1e-12,
            "{name}: {first} .. {last}"
        );
        assert!(
            (sampler.position(0, 0)[0] - sampler.origin()).abs() < 1e-12,
            "{name}"
        );
    }
}

#[test]
fn bands_and_threads_do_not_matter() {
    for name in NAMES {
        let sampler = Supersampler::new(37, 41, antialiasing(name));
        let pool = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().expect("threads can be started")
        };
        let image: Image<f32> = pool(1).install(|| sampler.render(wave));
        assert_eq!(image, pool(8).install(|| sampler.render(wave)), "{name}");
        for height in [1, 7, 41] {
            let mut pixels = Vec::new();
            for start in (0..41).step_by(height) {
                let rows = start..(start + height).min(41);
                let mut samples = Vec::new();
                for row in sampler.rows(rows.clone()) {
                    let positions = (0..sampler.columns()).map(|c| sampler.position(c, row));
                    samples.extend(positions.map(|[x, y]| wave(x, y)));
                }
                let mut out = vec![0.0; rows.len() * 37];
                sampler.resolve(rows, &samples, &mut out);
                pixels.extend(out);
            }
            assert_eq!(image.pixels(), pixels, "{name} in bands of {height} rows");
        }
    }
}

#[test]
fn half_covered_white_on_black_is_188_in_a_file() {
    use hemicube_raster::color::srgb8_from_linear;
    let left = |x: f64, _: f64| Rgb::splat(if x < 0.5 { 1.0 } else { 0.0 });
    let image = render(&left, (1, 1), antialiasing("4x4"));
    assert_eq!(srgb8_from_linear(image.pixel(0, 0).r), 188, "half covered");
}

#[test]
fn seed_moves_jittered_samples() {
    let with_seed = |seed| {
        let mut antialiasing = antialiasing("2x2-jittered");
        antialiasing.pattern = antialiasing.pattern.with_seed(seed);
        Supersampler::new(8, 8, antialiasing).render(wave)
    };
    assert_eq!(with_seed(1), with_seed(1), "the same seed");
    assert_ne!(with_seed(1), with_seed(2), "another seed");
}

#[test]
fn empty_images_are_no_exception() {
    for (width, height) in [(0, 0), (5, 0), (0, 5)] {
        let image = Supersampler::new(width, height, antialiasing("4x4:bartlett")).render(wave);
        assert!(image.pixels().is_empty(), "{width} x {height}");
    }
}
