//! Antialiased areas into a picture of 1024 x 1024 pixels, by this project and by `vello_cpu` and `ab_glyph_rasterizer`.
//!
//! Three sets: 2000 triangles in boxes of 200 pixels, 20 000 in boxes of 20, 100 round shapes of 200 corners with a
//! radius of about 500. CPU time of one thread; medians of rounds in which all take turns.

use ab_glyph_rasterizer::{Point, Rasterizer as AbGlyph};
use cpu_time::ThreadTime;
use glam::{DVec2, dvec2};
use hemicube::raster::antialias::area::{Area, FillRule, Outline, Rasterizer, mask, paint};
use hemicube::raster::{Image, Rgb};
use hemicube_tests::spheres::random;
use std::hint::black_box;
use vello_cpu::kurbo::BezPath;
use vello_cpu::peniko::Color;
use vello_cpu::{Pixmap, RenderContext, Resources};

const SIDE: usize = 1024;
const ROUNDS: usize = 9;

type Polygon = Vec<DVec2>;

fn main() {
    let sets = [
        ("2000 triangles, box 200", triangles(2000, 200.0)),
        ("20 000 triangles, box 20", triangles(20_000, 20.0)),
        ("100 shapes of 200 corners, radius 500", blobs(100)),
    ];
    for (name, polygons) in &sets {
        check(polygons);
        let area: f64 = polygons.iter().map(covered).sum();
        println!("{name}: {:.1} Mpx", area / 1e6);
        println!("  {:34} {:>9} {:>9} {:>9}", "", "ms", "Mpx/s", "kpoly/s");
        for (way, seconds) in measure(polygons) {
            let (pixels, shapes) = (area / seconds / 1e6, polygons.len() as f64 / seconds / 1e3);
            println!("  {way:34} {:9.2} {pixels:9.0} {shapes:9.0}", seconds * 1e3);
        }
    }
}

/// A number in [0, 1).
fn number(seed: u64, index: u64) -> f64 {
    f64::from(random(seed, index))
}

fn triangles(count: u64, side: f64) -> Vec<Polygon> {
    let triangle = |i: u64| {
        let at = |k| number(7, 8 * i + k);
        let corner = dvec2(at(6), at(7)) * (SIDE as f64 - side);
        [0, 2, 4]
            .map(|k| corner + dvec2(at(k), at(k + 1)) * side)
            .to_vec()
    };
    (0..count).map(triangle).collect()
}

/// Circles whose radius goes up and down seven times by a twentieth, around points near the middle.
fn blobs(count: u64) -> Vec<Polygon> {
    let blob = |i: u64| {
        let center = DVec2::splat(SIDE as f64 / 2.0)
            + dvec2(number(8, 2 * i), number(8, 2 * i + 1)) * 20.0
            - 10.0;
        let corner = |k: u32| {
            let angle = f64::from(k) / 200.0 * core::f64::consts::TAU;
            center + DVec2::from_angle(angle) * (475.0 + 25.0 * (7.0 * angle + i as f64).sin())
        };
        (0..200).map(corner).collect()
    };
    (0..count).map(blob).collect()
}

fn outline(polygon: &Polygon) -> Outline {
    Outline::polygon(polygon.iter().copied())
}

fn path(polygon: &Polygon) -> BezPath {
    let mut path = BezPath::new();
    path.move_to((polygon[0].x, polygon[0].y));
    for p in &polygon[1..] {
        path.line_to((p.x, p.y));
    }
    path.close_path();
    path
}

fn color(i: usize) -> [u8; 3] {
    [17, 53, 101].map(|k| (64 + i * k % 192).try_into().expect("below 256"))
}

/// Area inside the picture, which holds all shapes.
fn covered(polygon: &Polygon) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let sum: f64 = polygon.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum();
    (sum / 2.0).abs()
}

/// Our coverage adds up to the area of each shape and is what `vello_cpu` finds, but for its rounding to bytes.
fn check(polygons: &[Polygon]) {
    let mut resources = Resources::new();
    for polygon in polygons.iter().take(20) {
        let ours = mask(&outline(polygon), FillRule::NonZero, (SIDE, SIDE));
        let sum: f64 = ours.pixels().iter().map(|&c| f64::from(c)).sum();
        let exact = covered(polygon);
        assert!(
            (sum - exact).abs() < 1e-3 + 1e-6 * exact,
            "area {sum}, exact {exact}"
        );
        let mut context = RenderContext::new(1024, 1024);
        context.set_paint(Color::from_rgb8(255, 255, 255));
        context.fill_path(&path(polygon));
        context.flush();
        let mut pixmap = Pixmap::new(1024, 1024);
        context.render(&mut pixmap, &mut resources);
        for (i, (&ours, theirs)) in ours.pixels().iter().zip(pixmap.data()).enumerate() {
            let difference = ours - f32::from(theirs.a) / 255.0;
            assert!(
                difference.abs() < 1.5 / 255.0,
                "pixel {i}: {ours}, theirs {}",
                theirs.a
            );
        }
    }
}

/// Median seconds of each way.
fn measure(polygons: &[Polygon]) -> Vec<(&'static str, f64)> {
    let outlines: Vec<Outline> = polygons.iter().map(outline).collect();
    let paths: Vec<BezPath> = polygons.iter().map(path).collect();
    let mut rasterizer = Rasterizer::new(SIDE, SIDE);
    let mut bytes = Image::filled(SIDE, SIDE, 0_u8);
    let mut colors = Image::filled(SIDE, SIDE, Rgb::BLACK);
    let mut context = RenderContext::new(1024, 1024);
    let mut pixmap = Pixmap::new(1024, 1024);
    let mut resources = Resources::new();
    let mut glyphs = AbGlyph::new(SIDE, SIDE);
    let colored =
        |(i, outline)| Area::new(outline, Rgb::from(color(i).map(|c| f32::from(c) / 255.0)));
    let areas: Vec<Area<'_, Rgb>> = outlines.iter().enumerate().map(colored).collect();
    let white: Vec<Area<'_, u8>> = outlines
        .iter()
        .map(|outline| Area::new(outline, 255))
        .collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a thread can be started");
    let mut times: [Vec<f64>; 6] = Default::default();
    for _ in 0..ROUNDS {
        times[0].push(seconds(|| {
            for outline in &outlines {
                rasterizer.fill(outline, FillRule::NonZero, &mut bytes, 255, 1.0);
            }
        }));
        times[1].push(seconds(|| {
            for area in &areas {
                rasterizer.fill(area.outline, area.rule, &mut colors, area.value, 1.0);
            }
        }));
        // Timed on the pool's only thread.
        times[2].push(pool.install(|| seconds(|| paint(&mut bytes, &white))));
        times[3].push(pool.install(|| seconds(|| paint(&mut colors, &areas))));
        times[4].push(seconds(|| {
            context.reset();
            for (i, path) in paths.iter().enumerate() {
                let [r, g, b] = color(i);
                context.set_paint(Color::from_rgb8(r, g, b));
                context.fill_path(path);
            }
            context.flush();
            context.render(&mut pixmap, &mut resources);
        }));
        times[5].push(seconds(|| {
            for polygon in polygons {
                black_box(glyph_mask(&mut glyphs, polygon));
            }
        }));
        black_box((&bytes, &colors, &pixmap));
    }
    let names = [
        "one by one, mask of bytes",
        "one by one, linear colour",
        "all at once, mask of bytes",
        "all at once, linear colour",
        "vello_cpu 0.3, scene of RGBA bytes",
        "ab_glyph_rasterizer 0.1, floats",
    ];
    names.into_iter().zip(times.map(median)).collect()
}

/// The coverage of a shape in the box around it, as glyphs are drawn; the last value, so that nothing is left out.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "coordinates within the picture"
)]
fn glyph_mask(rasterizer: &mut AbGlyph, polygon: &Polygon) -> f32 {
    let low = polygon
        .iter()
        .fold(DVec2::INFINITY, |m, &p| m.min(p))
        .floor();
    let high = polygon.iter().fold(DVec2::ZERO, |m, &p| m.max(p)).ceil();
    let size = high - low;
    rasterizer.reset(size.x as usize + 1, size.y as usize + 1);
    let point = |p: &DVec2| Point {
        x: (p.x - low.x) as f32,
        y: (p.y - low.y) as f32,
    };
    let next = polygon.iter().cycle().skip(1);
    for (a, b) in polygon.iter().zip(next) {
        rasterizer.draw_line(point(a), point(b));
    }
    let mut last = 0.0;
    rasterizer.for_each_pixel(|_, coverage| last = black_box(coverage));
    last
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = ThreadTime::now();
    work();
    start.elapsed().as_secs_f64()
}

fn median(mut seconds: Vec<f64>) -> f64 {
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}
