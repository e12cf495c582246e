//! Pictures that an adapter does not draw at once are those that it would draw.

mod common;

use common::{camera, context, difference, lit_builtin, show};
use hemicube_gpu::pass::{DrawOptions, MeshLines, Smoothing, Target, Walkthrough};
use hemicube_gpu::{Context, GpuError};
use hemicube_raster::Rgb;
use std::sync::Arc;

/// Wider and higher than the lowered limit, by no whole number of tiles.
const SIZE: [u32; 2] = [600, 350];

#[test]
fn tiles_are_parts_of_the_picture() {
    let Some(context) = context() else { return };
    let small = Context::headless_within(None, |limits| wgpu::Limits {
        max_texture_dimension_2d: 256,
        ..limits
    });
    let small = Arc::new(small.expect("the adapter can do with less"));
    let solution = lit_builtin("cornell", 800);
    let camera = camera(&solution);
    let mut whole = Walkthrough::new(context, &solution).expect("it fits");
    let mut tiled = Walkthrough::new(small, &solution).expect("it fits");
    for (name, smoothing) in [
        ("one sample", Smoothing::None),
        ("four samples", Smoothing::Multisample),
        ("2x2:bartlett", grid("2x2:bartlett")),
        ("3x3", grid("3x3")),
    ] {
        let options = DrawOptions::default()
            .with_smoothing(smoothing)
            .with_exposure(0.1)
            .with_lines(MeshLines::default());
        let a = whole.display(&camera, SIZE, &options).expect("a picture");
        let b = tiled.display(&camera, SIZE, &options).expect("tiles");
        show(&format!("tiles-{}", name.replace(':', "-")), &a, &b);
        let others = a.pixels().iter().zip(b.pixels());
        let others = others.filter(|(a, b)| (**a - **b).map(f32::abs).max_band() > 1e-3);
        let (off, others) = (difference(&a, &b), others.count());
        println!("{name}: {others} pixels are others, {off:?}");
        // Corners are rounded to the 256th of a pixel, sometimes to the other side.
        assert!(off.mean < 1e-3 && off.of_99 < 2e-3, "{name}: {off:?}");
    }
    let a = whole.elements(&camera, SIZE).expect("numbers");
    let b = tiled.elements(&camera, SIZE).expect("numbers");
    let others = a.pixels().iter().zip(b.pixels()).filter(|(a, b)| a != b);
    let others = others.count();
    println!("{others} pixels show another element");
    assert!(others < a.pixels().len() / 1000, "{others} pixels");
    for at in [[10, 20], [599, 349], [300, 260]] {
        let picked = tiled.pick(&camera, SIZE, at).expect("a number");
        let seen = *b.pixel(at[0] as usize, at[1] as usize) as usize;
        assert_eq!(picked.map_or(0, |e| e + 1), seen, "pixel {at:?}");
    }
}

#[test]
fn pictures_beyond_all_memory_are_refused_in_words() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 100);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("it fits");
    for size in [[0, 10], [10, 0], [u32::MAX, u32::MAX], [20_000, 20_000]] {
        let refused = gpu.display(&camera, size, &DrawOptions::default());
        let Err(GpuError::Option(words)) = refused else {
            panic!("{size:?} is refused");
        };
        assert!(words.contains(&size[0].to_string()), "{words}");
        let _ = gpu.elements(&camera, size).expect_err("refused");
        let _ = gpu.pick(&camera, size, [0, 0]).expect_err("refused");
    }
}

#[test]
fn a_picture_wider_than_any_texture_is_drawn() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 100);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("it fits");
    let options = DrawOptions::default().with_smoothing(Smoothing::None);
    let image = gpu.display(&camera, [40_000, 2], &options);
    let image = image.expect("a picture");
    let lit = image.pixels().iter().filter(|c| **c != Rgb::BLACK).count();
    assert_eq!((image.width(), image.height()), (40_000, 2), "size");
    assert!(lit > 0, "the room's middle is in it");
}

#[test]
fn a_target_whose_samples_are_no_texture_is_refused_in_words() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 100);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context.clone(), &solution).expect("it fits");
    let texture = context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("window"),
        size: wgpu::Extent3d {
            width: 1000,
            height: 1000,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let target = Target {
        view: &texture.create_view(&Default::default()),
        format: texture.format(),
        size: [1000, 1000],
    };
    let options = DrawOptions::default().with_smoothing(grid("32x32"));
    let mut encoder = context.device.create_command_encoder(&Default::default());
    let error = gpu.draw(&mut encoder, target, &camera, &options);
    let words = error.expect_err("32,000 samples a side").to_string();
    assert!(
        words.contains("samples") && words.contains("32000"),
        "{words}"
    );
}

fn grid(name: &str) -> Smoothing {
    Smoothing::Supersample(name.parse().expect(name))
}
