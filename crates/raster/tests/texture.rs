//! Samplers against the rules of Vulkan and Direct3D and against readable versions of themselves.

use glam::{Vec2, Vec4};
use hemicube_raster::Image;
use hemicube_raster::texture::{
    Alpha, Cubic, Encoding, Footprint, Log2, Magnify, Minify, Sampler, Shape, Texture,
    TextureError, TextureOptions, Wrap, nearest_level, straight,
};
use proptest::prelude::*;

const MINIFY: [Minify; 6] = [
    Minify::Point,
    Minify::Bilinear,
    Minify::NearestMipmap,
    Minify::Trilinear,
    Minify::Anisotropic,
    Minify::Ewa,
];

/// Texels of well-mixed numbers in [0, 1], opaque.
fn noise(width: usize, height: usize) -> Image<[f32; 4]> {
    let number = |i: usize, k: usize| ((i * 7919 + k * 104_729) % 251) as f32 / 250.0;
    let texel = |i| [number(i, 1), number(i, 2), number(i, 3), 1.0];
    Image::from_pixels(width, height, (0..width * height).map(texel).collect()).expect("its size")
}

fn texture(image: &Image<[f32; 4]>) -> Texture {
    Texture::new(image, &TextureOptions::default()).expect("it has texels")
}

fn flat(width: usize, height: usize, color: [f32; 4]) -> Texture {
    texture(&Image::filled(width, height, color))
}

fn close(a: Vec4, b: Vec4, error: f32) -> bool {
    (a - b).abs().max_element() <= error
}

/// The four texels around a point in f64, by the formula of the specification.
fn bilinear(image: &Image<[f32; 4]>, uv: Vec2, wrap: [Wrap; 2], border: Vec4) -> Vec4 {
    let (x, y) = (
        f64::from(uv.x) * image.width() as f64 - 0.5,
        f64::from(uv.y) * image.height() as f64 - 0.5,
    );
    let mut sum = glam::DVec4::ZERO;
    for (row, down) in [
        (y.floor(), 1.0 - (y - y.floor())),
        (y.floor() + 1.0, y - y.floor()),
    ] {
        for (column, across) in [
            (x.floor(), 1.0 - (x - x.floor())),
            (x.floor() + 1.0, x - x.floor()),
        ] {
            #[expect(clippy::cast_possible_truncation, reason = "a few hundred")]
            let at = (
                wrap[0].index(column as i64, image.width()),
                wrap[1].index(row as i64, image.height()),
            );
            let texel = match at {
                (Some(column), Some(row)) => Vec4::from_array(*image.pixel(column, row)),
                _ => border,
            };
            sum += texel.as_dvec4() * (across * down);
        }
    }
    sum.as_vec4()
}

proptest! {
    #[test]
    fn bilinear_is_the_formula(
        width in 1_usize..9, height in 1_usize..9, u in -3.0_f32..3.0, v in -3.0_f32..3.0,
        rules in [0_usize..5, 0_usize..5],
    ) {
        let (image, uv) = (noise(width, height), Vec2::new(u, v));
        let sampler = Sampler::default()
            .with_wrap(rules.map(|rule| Wrap::ALL[rule]))
            .with_border(Vec4::new(2.0, 3.0, 4.0, 1.0));
        let found = sampler.sample(&texture(&image), uv);
        let expected = bilinear(&image, uv, sampler.wrap, sampler.border);
        prop_assert!(close(found, expected, 1e-5), "{found}, not {expected}");
    }

    /// Direct3D 11.3, 7.18.16.3: a flat texture stays flat, whatever reads it.
    #[test]
    fn flat_textures_stay_flat(
        width in 1_usize..40, height in 1_usize..40, u in -9.0_f32..9.0, v in -9.0_f32..9.0,
        d in [-2.0_f32..2.0, -2.0_f32..2.0, -2.0_f32..2.0, -2.0_f32..2.0], cubic in 0_usize..3,
    ) {
        let color = [0.3, 0.7, 0.123, 1.0];
        let texture = flat(width, height, color);
        for minify in MINIFY {
            let cubic = [Cubic::CatmullRom, Cubic::BSpline, Cubic::Mitchell][cubic];
            let sampler = Sampler::default().with_minify(minify).with_magnify(Magnify::Bicubic(cubic));
            let found = sampler.sample_grad(&texture, Vec2::new(u, v), Vec2::new(d[0], d[1]), Vec2::new(d[2], d[3]));
            // Weights of f32 and their sums.
            prop_assert!(close(found, Vec4::from_array(color), 2e-6), "{minify:?}: {found}");
        }
    }

    /// Direct3D 11.3, 7.18.16.3: what is filtered lies between the texels.
    #[test]
    fn samples_lie_between_texels(u in -2.0_f32..2.0, v in -2.0_f32..2.0, d in [-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0]) {
        let texture = texture(&noise(13, 9));
        for minify in MINIFY {
            let sampler = Sampler::default().with_minify(minify);
            let found = sampler.sample_grad(&texture, Vec2::new(u, v), Vec2::new(d[0], d[1]), Vec2::new(d[2], d[3]));
            prop_assert!(found.min_element() > -1e-6 && found.max_element() < 1.0 + 1e-6, "{minify:?}: {found}");
        }
    }

    /// Nothing panics or hangs, and what comes out is a number.
    #[test]
    fn any_numbers_are_sampled(
        bits in prop::array::uniform6(any::<u32>()), rules in [0_usize..5, 0_usize..5],
        bias in any::<f32>(), limits in [any::<f32>(), any::<f32>()], anisotropy in any::<f32>(), radius in any::<f32>(),
    ) {
        let texture = texture(&noise(11, 6));
        let [u, v, a, b, c, d] = bits.map(f32::from_bits);
        for minify in MINIFY {
            for shape in [Shape::Derivatives, Shape::Ellipse] {
                let sampler = Sampler::default()
                    .with_wrap(rules.map(|rule| Wrap::ALL[rule]))
                    .with_minify(minify)
                    .with_shape(shape)
                    .with_lod_bias(bias)
                    .with_lod_range(limits[0], limits[1])
                    .with_max_anisotropy(anisotropy)
                    .with_ewa_radius(radius);
                let found = sampler.sample_grad(&texture, Vec2::new(u, v), Vec2::new(a, b), Vec2::new(c, d));
                prop_assert!(found.is_finite(), "{sampler:?}: {found}");
            }
        }
    }

    /// The singular values of the derivatives are those of the axes, and the axes are perpendicular.
    #[test]
    fn axes_span_the_same_ellipse(d in [-50.0_f32..50.0, -50.0_f32..50.0, -50.0_f32..50.0, -50.0_f32..50.0]) {
        let footprint = Footprint { dx: Vec2::new(d[0], d[1]), dy: Vec2::new(d[2], d[3]) };
        let axes = footprint.axes();
        let squares = |f: &Footprint| [
            f.dx.x * f.dx.x + f.dy.x * f.dy.x,
            f.dx.x * f.dx.y + f.dy.x * f.dy.y,
            f.dx.y * f.dx.y + f.dy.y * f.dy.y,
        ];
        let size = axes.dx.length_squared();
        for (before, after) in squares(&footprint).into_iter().zip(squares(&axes)) {
            prop_assert!((before - after).abs() < 1e-5 * size, "{footprint:?}: {axes:?}");
        }
        prop_assert!(axes.dx.length() >= axes.dy.length() - 1e-3, "the longer first: {axes:?}");
        prop_assert!(axes.dx.dot(axes.dy).abs() < 1e-4 * size, "{axes:?}");
    }
}

#[test]
fn centres_read_texels_exactly() {
    let image = noise(6, 5);
    let texture = texture(&image);
    for (i, texel) in image.pixels().iter().enumerate() {
        let uv = Vec2::new((i % 6) as f32 + 0.5, (i / 6) as f32 + 0.5) / Vec2::new(6.0, 5.0);
        let point = Sampler::default()
            .with_magnify(Magnify::Point)
            .sample(&texture, uv);
        assert_eq!(point.to_array(), *texel, "texel {i}");
        for magnify in [Magnify::Bilinear, Magnify::Bicubic(Cubic::CatmullRom)] {
            let found = Sampler::default()
                .with_magnify(magnify)
                .sample(&texture, uv);
            assert!(
                close(found, point, 2e-6),
                "{magnify:?} at texel {i}: {found}"
            );
        }
    }
}

#[test]
fn repeated_textures_have_no_seam() {
    let texture = texture(&noise(8, 8));
    for magnify in [Magnify::Bilinear, Magnify::Bicubic(Cubic::BSpline)] {
        for wrap in [Wrap::Repeat, Wrap::MirroredRepeat] {
            let sampler = Sampler::default()
                .with_magnify(magnify)
                .with_wrap([wrap; 2]);
            for edge in [-1.0, 0.0, 1.0, 2.0] {
                let across = |step: f32| sampler.sample(&texture, Vec2::new(edge + step, 0.4));
                let jump = across(1e-5) - across(-1e-5);
                assert!(
                    jump.abs().max_element() < 1e-3,
                    "{wrap:?} at {edge}: {jump}"
                );
            }
        }
    }
}

#[test]
fn coordinates_without_number_read_the_origin() {
    let texture = texture(&noise(4, 4));
    let sampler = Sampler::default();
    let origin = sampler.sample(&texture, Vec2::ZERO);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(sampler.sample(&texture, Vec2::splat(bad)), origin, "{bad}");
        let far = sampler.sample_grad(&texture, Vec2::ZERO, Vec2::splat(bad), Vec2::ZERO);
        assert_eq!(
            far,
            sampler.sample_lod(&texture, Vec2::ZERO, 99.0),
            "derivative {bad}"
        );
    }
}

#[test]
fn huge_footprints_do_not_overflow() {
    let texture = texture(&noise(11, 6));
    for minify in MINIFY {
        let sampler = Sampler::default().with_minify(minify).with_ewa_radius(8.0);
        for exponent in 0..127_i16 {
            let size = f32::from(exponent).exp2();
            let found = sampler.sample_grad(&texture, Vec2::ZERO, Vec2::new(size, 0.0), Vec2::Y);
            assert!(found.is_finite(), "{minify:?}, 2^{exponent}: {found}");
        }
    }
}

#[test]
fn pictures_without_texels_are_refused() {
    let empty = Image::filled(0, 3, [0.0; 4]);
    let error = Texture::new(&empty, &TextureOptions::default()).expect_err("no texel");
    assert_eq!(
        error,
        TextureError::Empty {
            width: 0,
            height: 3
        }
    );
    assert_eq!(
        error.to_string(),
        "a texture of 0 x 3 texels: both sides must be at least 1"
    );
    let long = Image::filled(Texture::MAX_SIDE + 1, 1, [0_u8; 4]);
    let error = Texture::from_rgba8(&long, Encoding::Srgb, &TextureOptions::default());
    assert!(
        matches!(error, Err(TextureError::TooLarge { .. })),
        "{error:?}"
    );
}

#[test]
fn one_row_and_one_column_are_textures() {
    for (width, height) in [(1, 17), (17, 1), (1, 1)] {
        let texture = texture(&noise(width, height));
        assert_eq!(
            texture.level_size(texture.levels() - 1),
            (1, 1),
            "{width} x {height}"
        );
        for minify in MINIFY {
            let sampler = Sampler::default().with_minify(minify);
            let found = sampler.sample_grad(
                &texture,
                Vec2::new(0.3, 0.9),
                Vec2::new(0.4, 0.1),
                Vec2::new(0.0, 0.3),
            );
            assert!(
                found.is_finite(),
                "{minify:?} of {width} x {height}: {found}"
            );
        }
    }
}

#[test]
fn levels_of_detail_are_those_of_vulkan() {
    let footprint = |dx: [f32; 2], dy: [f32; 2]| Footprint {
        dx: dx.into(),
        dy: dy.into(),
    };
    for (dx, dy, lod) in [
        ([1.0, 0.0], [0.0, 1.0], 0.0),
        ([3.0, 4.0], [0.0, 1.0], 5.0_f32.log2()),
        ([0.5, 0.0], [0.0, 0.25], -1.0),
        ([0.0, 0.0], [0.0, 0.0], f32::NEG_INFINITY),
    ] {
        let found = footprint(dx, dy).lod(Log2::Exact);
        assert!(
            found == lod || (found - lod).abs() < 1e-6,
            "{dx:?} {dy:?}: {found}"
        );
    }
    let check = |dx, dy, limit, ratio: f32, samples: u16, lod: f32| {
        let found = footprint(dx, dy).anisotropic_lod(limit, Log2::Exact);
        assert!(
            (found.ratio - ratio).abs() < 1e-5,
            "{dx:?} {dy:?}: {found:?}"
        );
        assert_eq!(found.samples, samples, "{dx:?} {dy:?}: {found:?}");
        assert!(
            found.lod == lod || (found.lod - lod).abs() < 1e-5,
            "{dx:?} {dy:?}: {found:?}"
        );
    };
    check([8.0, 0.0], [0.0, 2.0], 16.0, 4.0, 4, 1.0);
    check([64.0, 0.0], [0.0, 1.0], 16.0, 16.0, 16, 2.0);
    check([0.0, 3.0], [8.0, 0.0], 16.0, 8.0 / 3.0, 3, 3.0_f32.log2());
    check([8.0, 0.0], [0.0, 0.0], 16.0, 16.0, 16, -1.0);
    check([0.0, 0.0], [0.0, 0.0], 16.0, 1.0, 1, f32::NEG_INFINITY);
}

#[test]
fn anisotropy_of_direct3d_knows_sheared_footprints() {
    // Two long derivatives that are nearly parallel: 8 long, an eighth wide.
    let sheared = Footprint {
        dx: Vec2::new(8.0, 0.0),
        dy: Vec2::new(8.0, 1.0),
    };
    let vulkan = sheared.anisotropic_lod(64.0, Log2::Exact);
    assert!(vulkan.ratio < 1.01, "lengths alone: {vulkan:?}");
    let direct3d = sheared.d3d_anisotropic_lod(64.0, Log2::Exact);
    // area 8, longer side sqrt(65): ratio 65 / 8, width 8 / sqrt(65) below a texel, so fewer samples.
    let width = 8.0 / 65.0_f32.sqrt();
    assert!((direct3d.lod - width.log2()).abs() < 1e-5, "{direct3d:?}");
    assert!(
        (direct3d.ratio - 65.0 / 8.0 * width).abs() < 1e-4,
        "{direct3d:?}"
    );
    let long = Footprint {
        dx: Vec2::new(64.0, 0.0),
        dy: Vec2::Y,
    };
    let limited = long.d3d_anisotropic_lod(16.0, Log2::Exact);
    assert!(limited.ratio == 16.0 && limited.lod == 2.0, "{limited:?}");
    let nothing = Footprint::default().d3d_anisotropic_lod(16.0, Log2::Exact);
    assert!(
        nothing.ratio == 1.0 && nothing.lod == f32::NEG_INFINITY,
        "{nothing:?}"
    );
}

#[test]
fn fast_logarithm_is_linear_between_powers_of_two() {
    for step in 0..4096_u16 {
        let square = 1e-3 * 1.005_f32.powi(i32::from(step) % 2000) + f32::from(step);
        let (exact, fast) = (Log2::Exact.half_log2(square), Log2::Fast.half_log2(square));
        // 0.5 (log2(1 + m) - m) has its maximum of 0.0430 at m = 1 / ln 2 - 1.
        assert!(
            (-1e-6..=0.0431).contains(&(exact - fast)),
            "{square}: {exact}, {fast}"
        );
    }
    assert_eq!(Log2::Fast.half_log2(4.0), 1.0, "powers of two are exact");
    assert_eq!(Log2::Fast.half_log2(0.0), f32::NEG_INFINITY, "none at all");
}

#[test]
fn halves_between_levels_round_down() {
    for (lod, level) in [
        (0.0, 0),
        (0.5, 0),
        (0.500_01, 1),
        (1.0, 1),
        (1.5, 1),
        (1.6, 2),
        (3.0, 3),
    ] {
        assert_eq!(nearest_level(lod), level, "{lod}");
    }
}

#[test]
fn trilinear_blends_what_its_levels_hold() {
    let texture = texture(&noise(16, 16));
    let sampler = Sampler::default();
    let uv = Vec2::new(0.37, 0.81);
    let level = |i: usize| {
        let image = texture.level(i);
        bilinear(&image, uv, sampler.wrap, Vec4::ZERO)
    };
    for (lod, upper, weight) in [
        (1.0, 1, 0.0),
        (1.25, 1, 0.25),
        (2.75, 2, 0.75),
        (4.0, 4, 0.0),
        (9.0, 4, 0.0),
    ] {
        let expected = level(upper).lerp(level((upper + 1).min(4)), weight);
        let found = sampler.sample_lod(&texture, uv, lod);
        assert!(
            close(found, expected, 1e-6),
            "lod {lod}: {found}, not {expected}"
        );
    }
    let nearest = sampler
        .with_minify(Minify::NearestMipmap)
        .sample_lod(&texture, uv, 1.6);
    assert!(close(nearest, level(2), 1e-6), "{nearest}");
    let limited = sampler
        .with_lod_range(2.0, 2.0)
        .sample_lod(&texture, uv, -7.0);
    assert!(
        close(limited, level(2), 1e-6),
        "limits come after all: {limited}"
    );
    let biased = sampler.with_lod_bias(1.0).sample_lod(&texture, uv, 1.0);
    assert!(close(biased, level(2), 1e-6), "{biased}");
}

#[test]
fn transparent_colours_do_not_bleed() {
    // Opaque red beside transparent green.
    let image =
        Image::from_pixels(2, 1, vec![[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0]]).expect("two");
    let between = Sampler::default().sample(&texture(&image), Vec2::splat(0.5));
    assert_eq!(
        between,
        Vec4::new(0.5, 0.0, 0.0, 0.5),
        "half of it, premultiplied"
    );
    assert_eq!(
        straight(between),
        Vec4::new(1.0, 0.0, 0.0, 0.5),
        "red alone"
    );
    assert_eq!(straight(Vec4::ZERO), Vec4::ZERO, "nothing is black");
    let data = TextureOptions::default().with_alpha(Alpha::Independent);
    let data = Texture::new(&image, &data).expect("it has texels");
    let between = Sampler::default().sample(&data, Vec2::splat(0.5));
    assert_eq!(between, Vec4::new(0.5, 0.5, 0.0, 0.5), "four numbers");
}

#[test]
fn bytes_and_floats_agree_to_half_a_code() {
    let bytes = noise(31, 18).map(|t| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a code"
        )]
        t.map(|x| (x * 255.0) as u8)
    });
    for encoding in [Encoding::Srgb, Encoding::Linear] {
        let bytes =
            Texture::from_rgba8(&bytes, encoding, &TextureOptions::default()).expect("texels");
        let floats = texture(&bytes.level(0));
        assert!(
            bytes.bytes() * 4 == floats.bytes(),
            "a quarter of the memory"
        );
        for level in 0..bytes.levels() {
            for (a, b) in bytes
                .level(level)
                .pixels()
                .iter()
                .zip(floats.level(level).pixels())
            {
                // Half a step of the sRGB curve where it is steepest, 2.24 in linear light, or of 1/255.
                assert!(
                    close((*a).into(), (*b).into(), 0.0045),
                    "level {level}: {a:?}, {b:?}"
                );
            }
        }
    }
}
