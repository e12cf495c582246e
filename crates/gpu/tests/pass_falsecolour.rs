//! Illuminance as colours on the GPU against the same table on the CPU.

mod common;

use common::{camera, context, difference, lit_builtin, show};
use hemicube_gpu::pass::{DrawOptions, Interpolation, Smoothing, Style, Walkthrough};
use hemicube_raster::colormap::{Colormap, FieldPaint, Isolines};
use hemicube_raster::{Image, Rgb};

const SIZE: [u32; 2] = [160, 120];

#[test]
fn elements_have_the_colours_of_their_illuminance() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 600);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let units = solution.mesh().scene().units;
    let lux = |e: usize| units.illuminance(solution.element_irradiance(e));
    let paint = FieldPaint::new(Colormap::sequential(), [0.0, 400.0]);
    let elements = gpu.elements(&camera, SIZE).expect("elements");
    let expected = elements.map(|&e| match e.checked_sub(1) {
        Some(element) => paint.color(lux(element as usize), 0.0),
        None => Rgb::BLACK,
    });
    let options = DrawOptions::default()
        .with_style(Style::FalseColour(paint.clone()))
        .with_interpolation(Interpolation::Flat)
        .with_smoothing(Smoothing::None);
    let found = gpu.display(&camera, SIZE, &options).expect("a picture");
    show("falsecolour", &expected, &found);
    let off = difference(&expected, &found);
    println!("{off:?}");
    // 16 bits, and colours of one are not exactly so after the display's bounds.
    assert!(off.of_99 < 1e-2, "{off:?}");
}

#[test]
fn lines_of_equal_value_lie_where_the_value_is() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 1200);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let size = [320, 240];
    let paint = FieldPaint::new(Colormap::sequential(), [0.0, 400.0]);
    let options = |paint: FieldPaint| {
        DrawOptions::default()
            .with_style(Style::FalseColour(paint))
            .with_smoothing(Smoothing::None)
    };
    let without = gpu
        .display(&camera, size, &options(paint.clone()))
        .expect("a picture");
    let lined = paint.clone().with_isolines(Isolines {
        spacing: 50.0,
        color: Rgb::WHITE,
        ..Isolines::default()
    });
    let with = gpu
        .display(&camera, size, &options(lined))
        .expect("a picture");
    show("isolines", &without, &with);
    // Where a line is, the table's colour is that of a multiple of 50, or nearly so.
    let value = |c: Rgb| nearest_value(&paint, c);
    let is_line = |a: &Rgb, b: &Rgb| (*b - *a).map(f32::abs).max_band() > 0.3;
    let lines: Vec<f32> = pairs(&without, &with)
        .filter(|(a, b)| is_line(a, b))
        .map(|(a, _)| value(*a))
        .collect();
    let off = |v: f32| ((v / 50.0) - (v / 50.0).round()).abs();
    let near = lines.iter().filter(|v| off(**v) < 0.2).count();
    println!("{near} of {} pixels of lines", lines.len());
    assert!(lines.len() > 300, "{} pixels", lines.len());
    assert!(near * 100 > lines.len() * 95, "{near} of {}", lines.len());
}

fn pairs<'a>(a: &'a Image<Rgb>, b: &'a Image<Rgb>) -> impl Iterator<Item = (&'a Rgb, &'a Rgb)> {
    a.pixels().iter().zip(b.pixels())
}

/// The value whose colour is nearest.
fn nearest_value(paint: &FieldPaint, color: Rgb) -> f32 {
    let values = (0..=400_u16).map(f32::from);
    let off = |v: f32| {
        let d = paint.color(v, 0.0) - color;
        d.r * d.r + d.g * d.g + d.b * d.b
    };
    values
        .min_by(|a, b| off(*a).total_cmp(&off(*b)))
        .unwrap_or(0.0)
}

#[test]
fn plain_surfaces_have_their_colour() {
    let Some(context) = context() else { return };
    let solution = lit_builtin("cornell", 300);
    let camera = camera(&solution);
    let mut gpu = Walkthrough::new(context, &solution).expect("a scene");
    let color = Rgb::new(0.9, 0.5, 0.25);
    let options = DrawOptions::default()
        .with_style(Style::Plain(color))
        .with_smoothing(Smoothing::None);
    let picture = gpu.display(&camera, SIZE, &options).expect("a picture");
    let off = (*picture.pixel(80, 110) - color).map(f32::abs).max_band();
    assert!(off < 1e-3, "{:?}", picture.pixel(80, 110));
}
