//! Polygons smaller than a pixel, in motion: samples miss them or count them twice, areas do not.

use super::{named, picture_size};
use crate::sheet::{Cell, magnified, sheet};
use crate::{Exhibit, GalleryError, Piece, Request};
use glam::{DVec2, dvec2};
use hemicube_chart::{Chart, Curve, Scale};
use hemicube_raster::antialias::area::{Area, Outline, paint};
use hemicube_raster::antialias::{Antialiasing, render};
use hemicube_raster::{Image, Rgb};
use std::fmt::Write as _;

pub(super) const TINY_POLYGONS: Exhibit = Exhibit {
    name: "tiny-polygons",
    about: "Bars, squares and triangles thinner than a pixel that move: samples make them vanish or double, areas keep them",
    needs: &[],
    draw,
};

/// Pixels of the scene; frames are magnified to the size asked for.
const SIDE: usize = 24;
/// Steps of a motion by one pixel.
const FRAMES: usize = 16;
const SHOWN: [usize; 4] = [0, 3, 6, 9];

const WAYS: [&str; 3] = ["none", "2x2", "4x4:bartlett"];

fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, _) = picture_size(request, (192, 192))?;
    let times = (width / SIDE).max(1);
    let mut cells = Vec::new();
    for way in [Some("none"), Some("4x4:bartlett"), None] {
        for frame in SHOWN {
            let image = picture(frame, way.map(named));
            let name = way.unwrap_or("exact area");
            let moved = format!("moved {:.2} px", offset(frame).x);
            let light = format!("light {:.2}", total(&image));
            cells.push(Cell::new(magnified(&image, times), &[name, &moved, &light]));
        }
    }
    Ok(vec![
        Piece::sheet("", &sheet(&cells, SHOWN.len()))?,
        Piece::chart("-light", &chart(), (900, 480)),
        Piece::csv("", table()),
    ])
}

/// How far the scene has moved in a frame: down a little more slowly than to the right.
fn offset(frame: usize) -> DVec2 {
    let share = frame as f64 / FRAMES as f64;
    dvec2(share, 0.7 * share)
}

/// Convex polygons, at rest: upright bars, squares, slivers and a fan of them, all inside of the picture.
fn polygons() -> Vec<Vec<DVec2>> {
    let rectangle = |x: f64, y: f64, w: f64, h: f64| {
        vec![
            dvec2(x, y),
            dvec2(x + w, y),
            dvec2(x + w, y + h),
            dvec2(x, y + h),
        ]
    };
    let mut polygons = Vec::new();
    for i in 0..5 {
        polygons.push(rectangle(2.1 + 1.9 * f64::from(i), 2.05, 0.45, 7.3));
    }
    for i in 0..16 {
        let (column, row) = (f64::from(i % 4), f64::from(i / 4));
        polygons.push(rectangle(13.2 + 2.23 * column, 2.3 + 1.87 * row, 0.6, 0.6));
    }
    for i in 0..7 {
        let angle = f64::from(i) * 0.22 + 0.05;
        let tip = dvec2(2.2, 12.3) + DVec2::from_angle(angle) * 9.2;
        let side = DVec2::from_angle(angle).perp() * 0.35;
        polygons.push(vec![dvec2(2.2, 12.3), tip - side, tip + side]);
    }
    for i in 0..4 {
        polygons.push(rectangle(13.1, 12.2 + 2.3 * f64::from(i), 8.4, 0.3));
    }
    polygons
}

/// The scene in a frame, by samples or by area. Polygons do not overlap but in the fan's tip.
fn picture(frame: usize, antialiasing: Option<Antialiasing>) -> Image<Rgb> {
    let moved = |polygon: Vec<DVec2>| polygon.into_iter().map(|p| p + offset(frame)).collect();
    let polygons: Vec<Vec<DVec2>> = polygons().into_iter().map(moved).collect();
    match antialiasing {
        Some(antialiasing) => {
            let inside = |x, y| {
                polygons
                    .iter()
                    .any(|polygon| contains(polygon, dvec2(x, y)))
            };
            let color = |x: f64, y: f64| if inside(x, y) { Rgb::WHITE } else { Rgb::BLACK };
            render(&color, (SIDE, SIDE), antialiasing)
        }
        None => {
            let mut outline = Outline::new();
            for polygon in polygons {
                outline.add_polygon(polygon);
            }
            let mut image = Image::filled(SIDE, SIDE, Rgb::BLACK);
            paint(&mut image, &[Area::new(&outline, Rgb::WHITE)]);
            image
        }
    }
}

/// Whether a convex polygon that turns to the right, with y down, contains a point.
fn contains(polygon: &[DVec2], p: DVec2) -> bool {
    let next = polygon.iter().cycle().skip(1);
    let mut sides = polygon.iter().zip(next);
    sides.all(|(&a, &b)| (b - a).perp_dot(p - a) >= 0.0)
}

fn total(image: &Image<Rgb>) -> f32 {
    image.pixels().iter().map(|pixel| pixel.r).sum()
}

/// Light of all frames by each way, the area last.
fn light() -> Vec<(String, Vec<f32>)> {
    let ways = WAYS.map(Some).into_iter().chain([None]);
    let of_way = |way: Option<&str>| {
        let frames = (0..=FRAMES).map(|frame| total(&picture(frame, way.map(named))));
        (way.unwrap_or("exact area").to_owned(), frames.collect())
    };
    ways.map(of_way).collect()
}

fn chart() -> Chart {
    let curve = |(name, values): (String, Vec<f32>)| {
        let points = values.iter().enumerate();
        let points = points.map(|(frame, &light)| (offset(frame).x, f64::from(light)));
        Curve::new(name, points.collect())
    };
    Chart {
        title: String::from("Light of small polygons in motion"),
        x_label: String::from("moved by, pixels"),
        y_label: String::from("sum of all pixels"),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        curves: light().into_iter().map(curve).collect(),
    }
}

fn table() -> String {
    let mut csv = String::from("antialiasing,frame,moved_px,light\n");
    for (name, values) in light() {
        for (frame, light) in values.iter().enumerate() {
            let _ = writeln!(csv, "{name},{frame},{:.4},{light:.4}", offset(frame).x);
        }
    }
    csv
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn area_keeps_its_light_and_samples_do_not() {
        let light = light();
        let spread = |i: usize| {
            let values = &light[i].1;
            let largest = values.iter().copied().fold(0.0, f32::max);
            let least = values.iter().copied().fold(f32::INFINITY, f32::min);
            (largest - least) / largest
        };
        assert!(spread(3) < 1e-4, "area: {}", spread(3));
        assert!(spread(0) > 0.3, "one sample: {}", spread(0));
        assert!(spread(2) < 0.15, "16 samples: {}", spread(2));
    }
}
