//! Mip chains: what every level must keep.

use glam::{Vec2, Vec4};
use hemicube_raster::Image;
use hemicube_raster::texture::{
    Alpha, Encoding, MipFilter, Ripmap, Sampler, Texture, TextureOptions, Wrap,
};
use proptest::prelude::*;

fn noise(width: usize, height: usize) -> Image<[f32; 4]> {
    let number = |i: usize, k: usize| ((i * 7919 + k * 104_729) % 251) as f32 / 250.0;
    let texel = |i| std::array::from_fn(|k| number(i, k));
    Image::from_pixels(width, height, (0..width * height).map(texel).collect()).expect("its size")
}

fn mean(image: &Image<[f32; 4]>) -> [f64; 4] {
    let sum = |k: usize| image.pixels().iter().map(|t| f64::from(t[k])).sum::<f64>();
    std::array::from_fn(|k| sum(k) / image.pixels().len() as f64)
}

/// Each texel of a level as the integral of the level above over its area.
fn by_areas(above: &Image<[f32; 4]>, width: usize, height: usize) -> Vec<[f64; 4]> {
    let overlap = |i: usize, to: usize, from: usize, source: usize| {
        let scale = from as f64 / to as f64;
        let (low, high) = (i as f64 * scale, (i + 1) as f64 * scale);
        (high.min(source as f64 + 1.0) - low.max(source as f64)).max(0.0) / scale
    };
    let texel = |i: usize| {
        let mut sum = [0.0; 4];
        for (j, texel) in above.pixels().iter().enumerate() {
            let (x, y) = (j % above.width(), j / above.width());
            let weight = overlap(i % width, width, above.width(), x)
                * overlap(i / width, height, above.height(), y);
            for (sum, value) in sum.iter_mut().zip(texel) {
                *sum += f64::from(*value) * weight;
            }
        }
        sum
    };
    (0..width * height).map(texel).collect()
}

proptest! {
    #[test]
    fn box_levels_keep_the_mean_of_every_size(width in 1_usize..70, height in 1_usize..70) {
        let options = TextureOptions::default().with_alpha(Alpha::Independent);
        let texture = Texture::new(&noise(width, height), &options).expect("it has texels");
        let expected = mean(&texture.level(0));
        for level in 1..texture.levels() {
            for (found, expected) in mean(&texture.level(level)).into_iter().zip(expected) {
                prop_assert!((found - expected).abs() < 1e-6, "level {level}: {found}, not {expected}");
            }
        }
        prop_assert_eq!(texture.level_size(texture.levels() - 1), (1, 1));
    }

    #[test]
    fn box_levels_are_integrals_over_areas(width in 1_usize..14, height in 1_usize..14) {
        let options = TextureOptions::default().with_alpha(Alpha::Independent);
        let texture = Texture::new(&noise(width, height), &options).expect("it has texels");
        for level in 1..texture.levels() {
            let (width, height) = texture.level_size(level);
            let expected = by_areas(&texture.level(level - 1), width, height);
            for (found, expected) in texture.level(level).pixels().iter().zip(expected) {
                for (found, expected) in found.iter().zip(expected) {
                    prop_assert!((f64::from(*found) - expected).abs() < 1e-6, "level {level}: {found}, not {expected}");
                }
            }
        }
    }
}

#[test]
fn wide_filters_read_around_the_edges_of_what_repeats() {
    // A cosine that repeats twice: shifted by half the picture it is the same, so are its levels.
    let wave = |i: usize| {
        let phase = (i % 32) as f32 * core::f32::consts::TAU / 16.0;
        [0.5 + 0.4 * phase.cos(), 0.0, 0.0, 1.0]
    };
    let image = Image::from_pixels(32, 4, (0..32 * 4).map(wave).collect()).expect("its size");
    for filter in [MipFilter::Kaiser, MipFilter::Lanczos] {
        let texture =
            Texture::new(&image, &TextureOptions::default().with_filter(filter)).expect("texels");
        let level = texture.level(1);
        for x in 0..8 {
            let (a, b) = (level.pixel(x, 0)[0], level.pixel(x + 8, 0)[0]);
            assert!((a - b).abs() < 1e-6, "{filter:?} at {x}: {a}, {b}");
        }
        let clamped = TextureOptions::default()
            .with_filter(filter)
            .with_wrap([Wrap::ClampToEdge; 2]);
        let clamped = Texture::new(&image, &clamped).expect("texels").level(1);
        assert!(
            (clamped.pixel(0, 0)[0] - level.pixel(0, 0)[0]).abs() > 1e-4,
            "the edge is read otherwise"
        );
    }
}

#[test]
fn sharper_filters_keep_more_of_a_wave() {
    // A wave of 5 texels: 2.5 of the first smaller level, which can just show it.
    let wave = |i: usize| {
        let phase = (i % 80) as f32 * core::f32::consts::TAU / 5.0;
        [0.5 + 0.5 * phase.cos(), 0.0, 0.0, 1.0]
    };
    let image = Image::from_pixels(80, 1, (0..80).map(wave).collect()).expect("its size");
    let contrast = |filter| {
        let options = TextureOptions::default().with_filter(filter);
        let level = Texture::new(&image, &options).expect("texels").level(1);
        let power: f32 = level.pixels().iter().map(|t| (t[0] - 0.5).powi(2)).sum();
        (2.0 * power / level.pixels().len() as f32).sqrt() / 0.5
    };
    // The box keeps cos(pi / 5) of it.
    assert!(
        (contrast(MipFilter::Box) - 0.809).abs() < 1e-3,
        "{}",
        contrast(MipFilter::Box)
    );
    let (kaiser, lanczos) = (contrast(MipFilter::Kaiser), contrast(MipFilter::Lanczos));
    assert!(kaiser > 0.82 && lanczos > 0.82, "{kaiser}, {lanczos}");
}

#[test]
fn checks_of_black_and_white_become_half_the_light() {
    let check = |i: usize| [[0, 0, 0, 255], [255; 4]][(i % 2 + i / 8) % 2];
    let image = Image::from_pixels(8, 8, (0..64).map(check).collect()).expect("its size");
    let texture =
        Texture::from_rgba8(&image, Encoding::Srgb, &TextureOptions::default()).expect("texels");
    let [r, ..] = *texture.level(1).pixel(0, 0);
    // sRGB 188 is the nearest code.
    assert!((r - 0.5).abs() < 0.003, "{r}: in gamma it would be 0.214");
}

#[test]
fn cut_outs_keep_their_share() {
    // Thin bars of alpha with soft edges: a quarter of the texels lie above one half.
    let bar = |i: usize| {
        let x = i % 64 % 8;
        let alpha = [0.9, 0.6, 0.2, 0.0, 0.0, 0.0, 0.0, 0.3][x] + 0.001 * (i / 64) as f32;
        [1.0, 1.0, 1.0, alpha]
    };
    let image = Image::from_pixels(64, 64, (0..64 * 64).map(bar).collect()).expect("its size");
    let share = |texture: &Texture, level: usize| {
        let level = texture.level(level);
        level.pixels().iter().filter(|t| t[3] > 0.5).count() as f64 / level.pixels().len() as f64
    };
    let plain = Texture::new(&image, &TextureOptions::default()).expect("texels");
    let kept = Texture::new(&image, &TextureOptions::default().with_cutoff(0.5)).expect("texels");
    assert_eq!(share(&plain, 0), 0.25, "two of eight");
    assert_eq!(share(&plain, 3), 0.0, "plain means lose the bars");
    for level in 0..4 {
        let found = share(&kept, level);
        assert!((found - 0.25).abs() < 0.02, "level {level}: {found}");
        // Only alpha is scaled: the colour stays white.
        let white = kept
            .level(level)
            .pixels()
            .iter()
            .all(|t| (t[0] - t[3]).abs() < 1e-5);
        assert!(white, "level {level}");
    }
}

#[test]
fn broken_texels_are_mended_and_counted() {
    let mut image = noise(5, 3);
    *image.pixel_mut(1, 1) = [f32::NAN, 0.5, f32::INFINITY, 1.0];
    *image.pixel_mut(4, 2) = [0.5, 0.5, 0.5, 7.0];
    let texture = Texture::new(&image, &TextureOptions::default()).expect("it has texels");
    assert_eq!(texture.mended(), 2, "NaN and too much coverage");
    for level in 0..texture.levels() {
        let is_finite = texture
            .level(level)
            .pixels()
            .iter()
            .flatten()
            .all(|x| x.is_finite());
        assert!(is_finite, "level {level}");
    }
    assert_eq!(texture.level(0).pixel(1, 1)[0], 0.0, "NaN is 0");
}

#[test]
fn ripmaps_are_the_mean_across_and_trilinear_along_the_diagonal() {
    let options = TextureOptions::default().with_alpha(Alpha::Independent);
    let texture = Texture::new(&noise(16, 16), &options).expect("it has texels");
    let ripmap = Ripmap::new(&texture, &options);
    let sampler = Sampler::default();
    let uv = Vec2::new(0.4, 0.3);
    for lod in [0.0_f32, 1.0, 2.5, 4.0] {
        let step = lod.exp2() / 16.0;
        let found = ripmap.sample_grad(&sampler, uv, Vec2::new(step, 0.0), Vec2::new(0.0, step));
        let expected = sampler.sample_lod(&texture, uv, lod);
        let error = (found - expected).abs().max_element();
        // Between levels four copies are blended, not two.
        assert!(
            error < if lod.fract() == 0.0 { 1e-5 } else { 0.2 },
            "lod {lod}: {error}"
        );
    }
    // A footprint as wide as the picture and a texel high: the mean of a row.
    let row = Vec2::new(0.5, (6.0 + 0.5) / 16.0);
    let found = ripmap.sample_grad(
        &sampler,
        row,
        Vec2::new(1.0, 0.0),
        Vec2::new(0.0, 1.0 / 16.0),
    );
    let level = texture.level(0);
    let expected: Vec4 = (0..16)
        .map(|x| Vec4::from_array(*level.pixel(x, 6)))
        .sum::<Vec4>()
        / 16.0;
    assert!(
        (found - expected).abs().max_element() < 1e-5,
        "{found}, not {expected}"
    );
}
