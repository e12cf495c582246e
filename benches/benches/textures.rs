//! Samples of a texture by each filter, and mip chains.
//!
//! A plane to the horizon, textured with 1024 x 1024 texels in floats and in bytes: every pixel of 512 x 384 is one sample
//! with the derivatives of its perspective, as a renderer asks for them. Million samples per second of one thread in CPU
//! time, medians of rounds; `image` samples the same places by its bilinear interpolation. Then mip chains, beside what
//! `fast_image_resize` takes for the same levels by its box filter.

use cpu_time::ThreadTime;
use fast_image_resize as resize;
use glam::{DVec2, Vec2, Vec4};
use hemicube::raster::Image;
use hemicube::raster::texture::{
    Cubic, Encoding, Magnify, Minify, MipFilter, Ripmap, Sampler, SummedAreaTable, Texcoord,
    TexcoordPlanes, Texture, TextureOptions,
};
use hemicube::raster::triangle::Viewport;
use hemicube_tests::spheres::random;

const SIDE: usize = 1024;
const VIEWPORT: Viewport = Viewport::new(512, 384);
const ROUNDS: usize = 7;

fn main() {
    let bytes = picture();
    let options = TextureOptions::default();
    let in_bytes = Texture::from_rgba8(&bytes, Encoding::Srgb, &options).expect("it has texels");
    let in_floats = Texture::new(&in_bytes.level(0), &options).expect("it has texels");
    let pixels = plane();
    println!("million samples per second: floats, bytes");
    for (name, sampler) in samplers() {
        let [floats, bytes] = [&in_floats, &in_bytes].map(|texture| {
            measured(&pixels, |p| {
                sampler.sample_grad(texture, p.uv, p.ddx, p.ddy)
            })
        });
        println!("{name:28} {floats:6.1} {bytes:6.1}");
    }
    let sampler = Sampler::default();
    let ripmap = Ripmap::new(&in_floats, &options);
    let table = SummedAreaTable::new(&in_floats);
    let rip = measured(&pixels, |p| {
        ripmap.sample_grad(&sampler, p.uv, p.ddx, p.ddy)
    });
    let sum = measured(&pixels, |p| table.sample_grad(&sampler, p.uv, p.ddx, p.ddy));
    println!(
        "{:28} {rip:6.1}\n{:28} {sum:6.1}",
        "ripmap", "summed-area table"
    );
    peer(&in_floats, &pixels);
    chains(&bytes, &in_floats);
}

fn samplers() -> Vec<(&'static str, Sampler)> {
    let magnified = |magnify| {
        Sampler::default()
            .with_magnify(magnify)
            .with_lod_range(0.0, 0.0)
    };
    let minified = |minify| Sampler::default().with_minify(minify);
    let ewa = minified(Minify::Ewa);
    vec![
        ("point", magnified(Magnify::Point)),
        ("bilinear", magnified(Magnify::Bilinear)),
        ("bicubic", magnified(Magnify::Bicubic(Cubic::CatmullRom))),
        ("nearest mip level", minified(Minify::NearestMipmap)),
        ("trilinear", minified(Minify::Trilinear)),
        ("anisotropic, at most 16", minified(Minify::Anisotropic)),
        ("EWA, at most 4", ewa.with_max_anisotropy(4.0)),
        ("EWA, at most 16", ewa),
        ("EWA, at most 64", ewa.with_max_anisotropy(64.0)),
    ]
}

/// Smooth waves with grain: neither flat nor noise.
fn picture() -> Image<[u8; 4]> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "in 0..=255"
    )]
    let texel = |i: usize| {
        let (x, y) = ((i % SIDE) as f32, (i / SIDE) as f32);
        let wave = |k: f32| 100.0 * (x / (11.0 * k)).sin() * (y / (7.0 * k)).cos();
        let grain = 20.0 * random(5, i as u64);
        let byte = |k: f32| (118.0 + wave(k) + grain) as u8;
        [byte(1.0), byte(2.0), byte(3.0), 255]
    };
    Image::from_pixels(SIDE, SIDE, (0..SIDE * SIDE).map(texel).collect()).expect("a square")
}

/// Every pixel of a plane that fills the picture, from 2 to 60 texels wide and 600 deep.
fn plane() -> Vec<Texcoord> {
    let corner = |x: f32, y: f32, w: f32| Vec4::new(x * w, y * w, 0.5 * w, w);
    let positions = [
        corner(-1.0, -1.0, 1.0),
        corner(1.0, -1.0, 1.0),
        corner(0.0, 1.02, 50.0),
    ];
    let texcoords = [
        Vec2::new(0.0, 0.0),
        Vec2::new(1.0, 0.4),
        Vec2::new(-11.0, 31.0),
    ];
    let planes = TexcoordPlanes::new(VIEWPORT, &positions, &texcoords).expect("it has an area");
    let pixel = |i: usize| {
        let (x, y) = (i % VIEWPORT.width, i / VIEWPORT.width);
        planes.at(DVec2::new(x as f64 + 0.5, y as f64 + 0.5))
    };
    (0..VIEWPORT.width * VIEWPORT.height).map(pixel).collect()
}

/// Million samples per second.
fn measured(pixels: &[Texcoord], sample: impl Fn(&Texcoord) -> Vec4) -> f64 {
    let mut seconds = [0.0; ROUNDS];
    for time in &mut seconds {
        let start = ThreadTime::now();
        let sum: Vec4 = pixels.iter().map(&sample).sum();
        *time = start.elapsed().as_secs_f64();
        let mean = sum / pixels.len() as f32;
        // All channels lie around the middle, and the picture is opaque.
        assert!(
            (mean.w - 1.0).abs() < 1e-3 && mean.x > 0.1 && mean.x < 0.5,
            "mean {mean}"
        );
    }
    pixels.len() as f64 / median(&mut seconds) / 1e6
}

/// Bilinear interpolation of `image`, of places brought into the picture.
fn peer(texture: &Texture, pixels: &[Texcoord]) {
    let flat = texture.level(0).pixels().as_flattened().to_vec();
    let side = u32::try_from(SIDE).expect("small");
    let picture = image::Rgba32FImage::from_raw(side, side, flat).expect("a square");
    let rate = measured(pixels, |p| {
        let uv = p.uv - p.uv.floor();
        let sample = image::imageops::sample_bilinear(&picture, uv.x, uv.y);
        sample.map_or(Vec4::ONE * 0.3, |pixel| Vec4::from_array(pixel.0))
    });
    println!("{:28} {rate:6.1}", "image: sample_bilinear");
}

fn chains(bytes: &Image<[u8; 4]>, floats: &Texture) {
    println!("ms for the mip chain of {SIDE} x {SIDE} texels");
    let floats = floats.level(0);
    for filter in [MipFilter::Box, MipFilter::Kaiser, MipFilter::Lanczos] {
        let options = TextureOptions::default().with_filter(filter);
        let ours = milliseconds(|| Texture::new(&floats, &options).map(|t| t.levels()));
        let ours_bytes = milliseconds(|| {
            Texture::from_rgba8(bytes, Encoding::Srgb, &options).map(|t| t.levels())
        });
        println!(
            "{:28} {ours:6.1} {ours_bytes:6.1}",
            format!("{filter:?}: floats, bytes")
        );
    }
    for (name, filter) in [
        ("box", resize::FilterType::Box),
        ("Lanczos", resize::FilterType::Lanczos3),
    ] {
        let theirs = milliseconds(|| resized(&floats, filter));
        println!("{:28} {theirs:6.1}", format!("fast_image_resize, {name}"));
    }
}

/// The same levels by `fast_image_resize`, floats.
fn resized(
    picture: &Image<[f32; 4]>,
    filter: resize::FilterType,
) -> Result<usize, resize::ResizeError> {
    let options = resize::ResizeOptions::new()
        .resize_alg(resize::ResizeAlg::Convolution(filter))
        .use_alpha(false);
    let side = u32::try_from(SIDE).expect("small");
    let texels: Vec<u8> = picture
        .pixels()
        .as_flattened()
        .iter()
        .flat_map(|x| x.to_ne_bytes())
        .collect();
    let mut level =
        resize::images::Image::from_vec_u8(side, side, texels, resize::PixelType::F32x4)
            .expect("a square of floats");
    let mut resizer = resize::Resizer::new();
    let mut count = 1;
    while level.width() > 1 {
        let half = level.width() / 2;
        let mut next = resize::images::Image::new(half, half, resize::PixelType::F32x4);
        resizer.resize(&level, &mut next, &options)?;
        level = next;
        count += 1;
    }
    Ok(count)
}

fn milliseconds<E: std::fmt::Debug>(make: impl Fn() -> Result<usize, E>) -> f64 {
    let mut seconds = [0.0; ROUNDS];
    for time in &mut seconds {
        let start = ThreadTime::now();
        let levels = make().expect("it has texels");
        *time = start.elapsed().as_secs_f64();
        assert_eq!(levels, 11, "levels of 1024 texels");
    }
    median(&mut seconds) * 1e3
}

fn median(seconds: &mut [f64]) -> f64 {
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}
