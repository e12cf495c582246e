//! How the device draws what the window shows.

use crate::desk::Desk;
use crate::display::Quantity;
use hemicube_gpu::pass::{
    DrawOptions, Interpolation, MeshLines, Smoothing, Style, TextureFiltering,
};
use hemicube_raster::Rgb;
use hemicube_raster::colormap::{Colormap, FieldPaint, Isolines};
use hemicube_raster::texture::Minify;

/// The device's options for what the window shows.
pub fn options(desk: &Desk, is_fine: bool) -> DrawOptions {
    let display = &desk.prefs.display;
    let options = DrawOptions::default()
        .with_exposure(desk.exposure)
        .with_tone_map(display.tone_map())
        .with_background(Rgb::splat(0.02 / desk.exposure.max(1e-30)))
        .with_style(style(desk))
        .with_filtering(TextureFiltering::default().with_minify(if is_fine {
            Minify::Ewa
        } else {
            Minify::Trilinear
        }))
        .with_bumps(display.bumps)
        .with_reflections(display.reflections)
        .with_smoothing(if is_fine && display.smooth_edges {
            Smoothing::Multisample
        } else {
            Smoothing::None
        })
        .with_interpolation(if display.flat {
            Interpolation::Flat
        } else {
            Interpolation::Gouraud
        });
    let is_wireframe = display.quantity == Quantity::Wireframe;
    if display.mesh || is_wireframe {
        let width = if is_wireframe { 1.2 } else { 1.0 };
        options.with_lines(MeshLines::default().with_width(width))
    } else {
        options
    }
}

fn style(desk: &Desk) -> Style {
    let display = &desk.prefs.display;
    match display.quantity {
        Quantity::Light => Style::Lit,
        Quantity::Wireframe => Style::Plain(Rgb::splat(0.82)),
        Quantity::FormFactors => {
            Style::FalseColour(FieldPaint::new(Colormap::sequential(), [0.0, 1.0]))
        }
        Quantity::Illuminance => {
            let top = desk.scale_top;
            let paint = FieldPaint::new(Colormap::sequential(), [0.0, top]);
            Style::FalseColour(if display.isolines {
                paint.with_isolines(Isolines {
                    spacing: 0.1 * top,
                    ..Isolines::default()
                })
            } else {
                paint
            })
        }
    }
}
