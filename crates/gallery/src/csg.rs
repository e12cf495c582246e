//! Solids by set operations: a still life, and a tree of operations with the spans of a ray.

mod fruit_bowl;
mod operations;

use crate::exhibit::{Exhibit, GalleryError, Piece, Request};
use hemicube_chart::{Anchor, Canvas, Chart, Curve, Drawing, Scale, label};
use hemicube_csg::{CsgError, View};
use hemicube_raster::antialias::{Antialiasing, Factor, Filter, Picture, Supersampler};
use hemicube_raster::tonemap::ToneMap;
use hemicube_raster::{Image, Rgb};

pub(crate) const EXHIBITS: &[Exhibit] = &[
    Exhibit {
        name: "fruit-bowl",
        about: "a still life of set operations, and the luminosity along a line of it, jagged and antialiased",
        needs: &[],
        draw: fruit_bowl,
    },
    Exhibit {
        name: "csg-operations",
        about: "the tree of a solid: every operation as a picture, with the spans of one ray below",
        needs: &[],
        draw: operations::draw,
    },
];

/// Pixels of a picture in a direction that can be asked for.
const LARGEST_SIDE: usize = 4096;

/// The size asked for, if a picture can have it.
fn checked_size(
    request: &Request,
    default: (usize, usize),
    smallest: usize,
) -> Result<(usize, usize), GalleryError> {
    let (width, height) = request.size.unwrap_or(default);
    let refuse = |why: &str| {
        let why = why.to_owned();
        Err(GalleryError::Size { width, height, why })
    };
    if width.min(height) < smallest {
        return refuse("too small for its parts; ask for a larger one");
    }
    if width.max(height) > LARGEST_SIDE {
        return refuse("ask for at most 4096 a side");
    }
    Ok((width, height))
}

/// The scenes of this room are written by hand, with numbers that the constructors take.
fn built<T>(result: Result<T, CsgError>) -> T {
    result.expect("the exhibit's own numbers are within their ranges")
}

fn shown(image: &Image<Rgb>) -> Image<Rgb> {
    image.map(|&color| ToneMap::None.apply(color, 1.0))
}

/// The fineness of the lines to which both ways are compared: 256 samples per pixel.
const REFERENCE_FACTOR: usize = 16;

fn fruit_bowl(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let size = checked_size(request, (800, 600), 16)?;
    let scene = built(fruit_bowl::scene());
    let camera = built(fruit_bowl::camera());
    let view = View {
        scene: &scene,
        camera: &camera,
        size,
    };
    let image = shown(&view.render(bartlett(2)));
    // Through the far squares, the bananas and the neck of the pear.
    let row = size.1 * 11 / 60;
    let lines = [
        ("1 sample", Antialiasing::NONE),
        ("4x4 Bartlett", bartlett(4)),
    ]
    .map(|(name, antialiasing)| (name, luminosity(&view, row, antialiasing)));
    let truth = luminosity(&view, row, bartlett(REFERENCE_FACTOR));
    let errors = [0, 1].map(|i| rms_difference(&lines[i].1, &truth));
    let sheet = scan_line_sheet(&image, row, &lines, errors);
    Ok(vec![
        Piece::picture("", &image)?,
        Piece::sheet("-scan-line", &sheet)?,
    ])
}

/// Supersampling with the Bartlett filter that belongs to it.
fn bartlett(factor: usize) -> Antialiasing {
    let factor = Factor::new(factor).expect("a factor from 1 to 32");
    Antialiasing::regular(factor).with_filter(Filter::for_factor(factor))
}

/// Displayed luminance of a row of pixels. Light above white is cut before filtering, as a display would: a lamp's
/// reflection else outshines the edge it is seen beside.
fn luminosity(view: &View<'_>, row: usize, antialiasing: Antialiasing) -> Vec<f32> {
    let (width, height) = view.size;
    let mut line = vec![0.0; width];
    let value = |x, y| view.color(x, y).luminance().min(1.0);
    Supersampler::new(width, height, antialiasing).sample(row..row + 1, &mut line, value);
    line
}

fn rms_difference(line: &[f32], truth: &[f32]) -> f64 {
    let square = |(a, b): (&f32, &f32)| f64::from(a - b).powi(2);
    let sum: f64 = line.iter().zip(truth).map(square).sum();
    (sum / line.len().max(1) as f64).sqrt()
}

/// The picture with its line marked, and below, column for column, the luminosity along it.
fn scan_line_sheet(
    image: &Image<Rgb>,
    row: usize,
    lines: &[(&'static str, Vec<f32>)],
    [jagged, smooth]: [f64; 2],
) -> Canvas {
    let curve = |(name, line): &(&'static str, Vec<f32>)| {
        let points = line.iter().enumerate();
        Curve::new(*name, points.map(|(x, &y)| (x as f64, y.into())).collect())
    };
    let chart = Chart {
        title: format!("Luminosity along row {row}"),
        x_label: String::from("column"),
        y_label: String::from("displayed luminance"),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        curves: lines.iter().map(curve).collect(),
    };
    let [left, right] = chart.margins();
    let width = left + image.width() + right;
    let (top, height) = (12, 300);
    let mut canvas = Canvas::new(width, top + image.height() + height + 56);
    canvas.paste(image, left, top);
    canvas.draw(&mark(left, image.width()), 0, top + row);
    canvas.draw(&chart.draw(width, height), 0, top + image.height() + 8);
    let figures = [
        String::from("RMS difference from 256 samples a pixel"),
        format!("1 sample: {jagged:.3}   4x4 samples, Bartlett 7x7: {smooth:.3}"),
    ];
    canvas.draw(
        &label(&figures, width - left, 48),
        left,
        top + image.height() + height + 8,
    );
    canvas
}

/// A thin line over the picture, with a pointer on both sides.
fn mark(left: usize, width: usize) -> Drawing {
    const RED: [u8; 3] = [220, 30, 30];
    let (start, end) = (left as f64, (left + width) as f64);
    let mut drawing = Drawing::new(left + width + 20, 20);
    drawing.line([start, 0.5], [end, 0.5], RED, 1.0);
    drawing.text([start - 4.0, -8.0], ">", Anchor::End, 16, RED);
    drawing.text([end + 4.0, -8.0], "<", Anchor::Start, 16, RED);
    drawing
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small(name: &str, size: (usize, usize)) -> Result<Vec<Piece>, GalleryError> {
        let exhibit = EXHIBITS
            .iter()
            .find(|e| e.name == name)
            .expect("an exhibit");
        let request = Request {
            size: Some(size),
            ..Request::default()
        };
        (exhibit.draw)(&request)
    }

    #[test]
    fn exhibits_draw_small() {
        for exhibit in EXHIBITS {
            let pieces = small(exhibit.name, (64, 48)).expect("it draws");
            assert!(
                pieces.iter().all(|p| p.bytes.len() > 200),
                "{}",
                exhibit.name
            );
        }
    }

    #[test]
    fn sizes_that_make_no_sense_are_refused() {
        for exhibit in EXHIBITS {
            for size in [(0, 0), (1, 600), (100_000, 600)] {
                let error = small(exhibit.name, size).expect_err("no picture");
                assert!(
                    matches!(error, GalleryError::Size { .. }),
                    "{}: {error}",
                    exhibit.name
                );
            }
        }
    }

    #[test]
    fn antialiased_lines_are_nearer_to_the_truth() {
        let (scene, camera) = (built(fruit_bowl::scene()), built(fruit_bowl::camera()));
        let view = View {
            scene: &scene,
            camera: &camera,
            size: (96, 72),
        };
        let line = |antialiasing| luminosity(&view, 13, antialiasing);
        let truth = line(bartlett(REFERENCE_FACTOR));
        let jagged = rms_difference(&line(Antialiasing::NONE), &truth);
        let smooth = rms_difference(&line(bartlett(4)), &truth);
        assert!(smooth < 0.3 * jagged, "{smooth} and {jagged}");
        assert!(jagged > 0.02, "{jagged}: the line crosses fine patterns");
    }

    #[test]
    fn fruit_lies_in_the_bowl_and_nothing_hangs_below_the_table() {
        let scene = built(fruit_bowl::scene());
        let down = |x: f64, z: f64| {
            let ray = hemicube_csg::Ray::new(glam::DVec3::new(x, 9.0, z), glam::DVec3::NEG_Y);
            scene.hit(&ray).expect("the table is endless").point.y
        };
        assert!(down(0.28, -0.1) > 2.2, "the pear is on top");
        assert!((down(0.0, 1.89) - 1.57).abs() < 1e-6, "the rim");
        assert!(down(5.0, 5.0).abs() < 1e-9, "the table");
    }
}
