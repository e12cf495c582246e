//! Lines and circles, whole pixels and antialiased, by this project and by `imageproc`, `line_drawing` and `vello_cpu`.
//!
//! Random lines and circles of one size at a time in pictures of 256 x 256 and 1024 x 1024 pixels: the small one stays in
//! the second-level cache, in the large one each row of a steep line waits for memory. Million pixels a second in CPU
//! time of one thread, each the best of rounds in which all take turns: what else runs on the machine disturbs least then.
//! A line has as many pixels as columns or rows, whichever are more; antialiased lines of width 1 are counted the same
//! way. `vello_cpu` blends them into four bytes of sRGB, Wu's lines are mixed into three floats, ours into a mask of
//! bytes or floats, into four bytes or three floats of linear light.
#![expect(
    clippy::cast_possible_truncation,
    reason = "sides, radii and counts of a benchmark are small"
)]

use cpu_time::ThreadTime;
use glam::{DVec2, IVec2};
use hemicube::raster::circle::{antialiased as smooth, draw_circle, fill_circle};
use hemicube::raster::ellipse::draw_ellipse;
use hemicube::raster::line::{antialiased, draw_line};
use hemicube::raster::target::Blend;
use hemicube::raster::{Image, Rgb};
use hemicube_tests::spheres::random;
use image::{Rgb as Rgb3, Rgb32FImage, Rgba, RgbaImage};
use imageproc::drawing;
use vello_cpu::color::palette::css;
use vello_cpu::kurbo::{BezPath, Stroke};
use vello_cpu::{Pixmap, RenderContext, Resources};

const ROUNDS: usize = 25;
const PIXELS: f64 = 4e5;

type Ends = [IVec2; 2];

fn main() {
    // What is drawn at once is timed on the pool's only thread.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a thread can be started").install(measure);
}

fn measure() {
    println!(
        "million pixels a second of one thread (times that of the first crate that is not ours)"
    );
    for (side, lengths, radii) in [
        (256, [10.0, 100.0, 200.0], [5, 50, 120]),
        (1024, [10.0, 100.0, 700.0], [5, 50, 400]),
    ] {
        println!("pictures of {side} x {side} pixels");
        lengths.iter().for_each(|&length| lines(side, length));
        radii.iter().for_each(|&radius| circles(side, radius));
        lengths
            .iter()
            .for_each(|&length| antialiased_lines(side, length));
        radii
            .iter()
            .for_each(|&radius| antialiased_circles(side, radius));
    }
}

type Way<'a> = (&'a str, Box<dyn FnMut() + 'a>);

/// Prints million pixels a second of each way, in the best of its rounds.
fn report(what: &str, pixels: usize, mut ways: Vec<Way>) {
    let mut seconds = vec![f64::INFINITY; ways.len()];
    for _ in 0..ROUNDS {
        for ((_, way), seconds) in ways.iter_mut().zip(&mut seconds) {
            let start = ThreadTime::now();
            way();
            *seconds = seconds.min(start.elapsed().as_secs_f64());
        }
    }
    let speeds: Vec<f64> = seconds
        .iter()
        .map(|seconds| pixels as f64 / seconds / 1e6)
        .collect();
    let peer = ways.iter().position(|(name, _)| !name.starts_with("ours"));
    let peer = peer.expect("there is one to compare with");
    print!("{what:28}");
    for ((name, _), speed) in ways.iter().zip(&speeds) {
        print!("  {name} {speed:.0} ({:.2})", speed / speeds[peer]);
    }
    println!();
}

/// Lines of a length in all directions, inside of the picture.
fn ends(side: usize, length: f64) -> Vec<Ends> {
    let mut ends = Vec::new();
    for index in 0_u64.. {
        let at = |k| f64::from(random(7, 4 * index + k));
        let from = DVec2::new(at(0), at(1)) * (side - 1) as f64;
        let to = from + DVec2::from_angle(at(2) * std::f64::consts::TAU) * length;
        let inside = |p: DVec2| p.min_element() >= 1.0 && p.max_element() < (side - 2) as f64;
        if inside(from) && inside(to) {
            ends.push([from, to].map(|p| p.round().as_ivec2()));
        }
        if ends.len() as f64 * length >= PIXELS {
            break;
        }
    }
    ends
}

fn pixels_of([from, to]: &Ends) -> usize {
    (*to - *from).abs().max_element() as usize + 1
}

fn float_pair(p: IVec2) -> (f32, f32) {
    (p.x as f32, p.y as f32)
}

fn lines(side: usize, length: f64) {
    let ends = ends(side, length);
    let mut image = Image::filled(side, side, [0_u8; 4]);
    let mut theirs = RgbaImage::new(side as u32, side as u32);
    let mut third = image.clone();
    let white = [255_u8; 4];
    // Every line for itself: ends are drawn, and as many pixels.
    for [from, to] in ends.iter().take(200) {
        let mut single = Image::filled(side, side, 0_u8);
        draw_line(&mut single.pen(1), *from, *to);
        let set = single.pixels().iter().filter(|&&p| p == 1).count();
        assert_eq!(set, pixels_of(&[*from, *to]), "pixels from {from} to {to}");
    }
    report(
        &format!("lines of {length} pixels"),
        ends.iter().map(pixels_of).sum(),
        vec![
            (
                "ours",
                Box::new(|| {
                    for [from, to] in &ends {
                        draw_line(&mut image.pen(white), *from, *to);
                    }
                }),
            ),
            (
                "imageproc",
                Box::new(|| {
                    for [from, to] in &ends {
                        let (from, to) = (float_pair(*from), float_pair(*to));
                        drawing::draw_line_segment_mut(&mut theirs, from, to, Rgba(white));
                    }
                }),
            ),
            (
                "line_drawing",
                Box::new(|| {
                    for [from, to] in &ends {
                        let (from, to) = ((from.x, from.y), (to.x, to.y));
                        for (x, y) in line_drawing::Bresenham::new(from, to) {
                            *third.pixel_mut(x as usize, y as usize) = white;
                        }
                    }
                }),
            ),
        ],
    );
    let is_set = |p: &[u8; 4]| p[0] > 0;
    let set = image.pixels().iter().filter(|p| is_set(p)).count();
    let agrees = |other: usize| {
        let ratio = other as f64 / set as f64;
        assert!(
            (0.98..1.02).contains(&ratio),
            "{other} pixels are set, {set} by ours"
        );
    };
    agrees(theirs.pixels().filter(|p| is_set(&p.0)).count());
    agrees(third.pixels().iter().filter(|p| is_set(p)).count());
}

/// Centres of circles inside of the picture.
fn centers(side: usize, radius: i32) -> Vec<IVec2> {
    let room = side as f32 - 4.0 - 2.0 * radius as f32;
    (0..(PIXELS / (5.7 * f64::from(radius))) as u64)
        .map(|i| {
            let at = |k| (random(8, 2 * i + k) * room) as i32 + radius + 2;
            IVec2::new(at(0), at(1))
        })
        .collect()
}

fn circles(side: usize, radius: i32) {
    let centers = centers(side, radius);
    let mut image = Image::filled(side, side, [0_u8; 4]);
    let mut theirs = RgbaImage::new(side as u32, side as u32);
    let white = [255_u8; 4];
    let mut pixels = [0; 2];
    let middle = IVec2::splat(side as i32 / 2);
    draw_circle(&mut image.pen([1; 4]), middle, radius);
    drawing::draw_hollow_circle_mut(&mut theirs, (middle.x, middle.y), radius, Rgba([1; 4]));
    let same = image
        .pixels()
        .iter()
        .zip(theirs.pixels())
        .all(|(a, b)| *a == b.0);
    assert!(same, "a circle is not that of imageproc");
    pixels[0] = image.pixels().iter().filter(|p| p[0] > 0).count();
    fill_circle(&mut image.pen([1; 4]), middle, radius);
    pixels[1] = image.pixels().iter().filter(|p| p[0] > 0).count();
    let mut fourth = image.clone();
    let mut third = image.clone();
    let mut fifth = theirs.clone();
    report(
        &format!("circles of radius {radius}"),
        pixels[0] * centers.len(),
        vec![
            (
                "ours",
                Box::new(|| {
                    for &center in &centers {
                        draw_circle(&mut image.pen(white), center, radius);
                    }
                }),
            ),
            (
                "imageproc",
                Box::new(|| {
                    for center in &centers {
                        let center = (center.x, center.y);
                        drawing::draw_hollow_circle_mut(&mut theirs, center, radius, Rgba(white));
                    }
                }),
            ),
            (
                "line_drawing",
                Box::new(|| {
                    for center in &centers {
                        let circle = line_drawing::BresenhamCircle::new(center.x, center.y, radius);
                        for (x, y) in circle {
                            *third.pixel_mut(x as usize, y as usize) = white;
                        }
                    }
                }),
            ),
        ],
    );
    let radii = IVec2::new(radius, radius * 2 / 3);
    let mut single = Image::filled(side, side, 0_u8);
    draw_ellipse(&mut single.pen(1), middle, radii);
    let pixels_of_ellipse = single.pixels().iter().filter(|&&p| p > 0).count();
    report(
        &format!("ellipses of radius {radius}"),
        pixels_of_ellipse * centers.len(),
        vec![
            (
                "ours",
                Box::new(|| {
                    for &center in &centers {
                        draw_ellipse(&mut fourth.pen(white), center, radii);
                    }
                }),
            ),
            (
                "imageproc",
                Box::new(|| {
                    for center in &centers {
                        let (center, color) = ((center.x, center.y), Rgba(white));
                        drawing::draw_hollow_ellipse_mut(
                            &mut fifth, center, radii.x, radii.y, color,
                        );
                    }
                }),
            ),
        ],
    );
    let some = &centers[..centers.len().div_ceil(radius as usize)];
    report(
        &format!("filled, of radius {radius}"),
        pixels[1] * some.len(),
        vec![
            (
                "ours",
                Box::new(|| {
                    for &center in some {
                        fill_circle(&mut fourth.pen(white), center, radius);
                    }
                }),
            ),
            (
                "imageproc",
                Box::new(|| {
                    for center in some {
                        let center = (center.x, center.y);
                        drawing::draw_filled_circle_mut(&mut fifth, center, radius, Rgba(white));
                    }
                }),
            ),
        ],
    );
}

/// `vello_cpu` on one thread.
struct Vello {
    context: RenderContext,
    resources: Resources,
    pixmap: Pixmap,
}

impl Vello {
    fn new(side: usize) -> Self {
        let side = side as u16;
        let mut context = RenderContext::new(side, side);
        context.set_paint(css::WHITE);
        context.set_stroke(Stroke::new(1.0).with_caps(vello_cpu::kurbo::Cap::Butt));
        Self {
            context,
            resources: Resources::new(),
            pixmap: Pixmap::new(side, side),
        }
    }

    fn stroke(&mut self, paths: &[BezPath]) {
        self.context.reset();
        self.context.set_paint(css::WHITE);
        self.context
            .set_stroke(Stroke::new(1.0).with_caps(vello_cpu::kurbo::Cap::Butt));
        for path in paths {
            self.context.stroke_path(path);
        }
        self.context.flush();
        self.context.render(&mut self.pixmap, &mut self.resources);
    }
}

/// Draws lines from middle to middle of pixels.
fn strokes<'a, P: Blend + 'a>(
    image: &'a mut Image<P>,
    pixel: P,
    ends: &'a [Ends],
) -> Box<dyn FnMut() + 'a> {
    Box::new(move || {
        for ends in ends {
            let [from, to] = ends.map(|p| p.as_dvec2() + 0.5);
            antialiased::draw_line(&mut image.pen(pixel), from, to, 1.0);
        }
    })
}

/// The same by bands of the picture.
fn all_strokes<'a, P>(image: &'a mut Image<P>, pixel: P, ends: &[Ends]) -> Box<dyn FnMut() + 'a>
where
    P: Blend + Send + Sync + 'a,
{
    let line = |ends: &Ends| {
        let [from, to] = ends.map(|p| p.as_dvec2() + 0.5);
        antialiased::Line {
            from,
            to,
            width: 1.0,
            pixel,
        }
    };
    let lines: Vec<_> = ends.iter().map(line).collect();
    Box::new(move || antialiased::draw_lines(image, &lines))
}

/// Draws circles of a radius around points.
fn rings<'a, P: Blend + 'a>(
    image: &'a mut Image<P>,
    pixel: P,
    centers: &'a [IVec2],
    radius: i32,
) -> Box<dyn FnMut() + 'a> {
    Box::new(move || {
        for center in centers {
            smooth::draw_circle(
                &mut image.pen(pixel),
                center.as_dvec2(),
                f64::from(radius),
                1.0,
            );
        }
    })
}

fn antialiased_lines(side: usize, length: f64) {
    let ends = ends(side, length);
    let half = |p: IVec2| p.as_dvec2() + 0.5;
    for [from, to] in ends.iter().take(200) {
        let mut single = Image::filled(side, side, 0.0);
        antialiased::draw_line(&mut single.pen(1.0), half(*from), half(*to), 1.0);
        let sum: f64 = single.pixels().iter().map(|&c| f64::from(c)).sum();
        let length = half(*from).distance(half(*to));
        assert!((sum - length).abs() < 1e-3, "{sum} for a line of {length}");
    }
    let mut image = Image::filled(side, side, Rgb::BLACK);
    let mut mask = Image::filled(side, side, 0_u8);
    let mut shares = Image::filled(side, side, 0_f32);
    let mut bytes = Image::filled(side, side, [0_u8; 4]);
    let (mut mask_at_once, mut bytes_at_once) = (mask.clone(), bytes.clone());
    let mut image_at_once = image.clone();
    let mut theirs = Rgb32FImage::new(side as u32, side as u32);
    let mut third = image.clone();
    let mut vello = Vello::new(side);
    let paths: Vec<BezPath> = ends
        .iter()
        .map(|&[from, to]| {
            let mut path = BezPath::new();
            path.move_to(<(f64, f64)>::from(half(from)));
            path.line_to(<(f64, f64)>::from(half(to)));
            path
        })
        .collect();
    report(
        &format!("antialiased, {length} pixels"),
        ends.iter().map(pixels_of).sum(),
        vec![
            ("ours, u8", strokes(&mut mask, u8::MAX, &ends)),
            ("ours, f32", strokes(&mut shares, 1.0, &ends)),
            ("ours, [u8; 4]", strokes(&mut bytes, [255; 4], &ends)),
            ("ours, Rgb", strokes(&mut image, Rgb::WHITE, &ends)),
            (
                "ours at once, u8",
                all_strokes(&mut mask_at_once, u8::MAX, &ends),
            ),
            (
                "ours at once, [u8; 4]",
                all_strokes(&mut bytes_at_once, [255; 4], &ends),
            ),
            (
                "ours at once, Rgb",
                all_strokes(&mut image_at_once, Rgb::WHITE, &ends),
            ),
            ("vello_cpu", Box::new(|| vello.stroke(&paths))),
            (
                "imageproc (Wu)",
                Box::new(|| {
                    for [from, to] in &ends {
                        let blend = |line: Rgb3<f32>, old: Rgb3<f32>, share: f32| {
                            Rgb3([0, 1, 2].map(|k| old.0[k] + share * (line.0[k] - old.0[k])))
                        };
                        drawing::draw_antialiased_line_segment_mut(
                            &mut theirs,
                            (from.x, from.y),
                            (to.x, to.y),
                            Rgb3([1.0; 3]),
                            blend,
                        );
                    }
                }),
            ),
            (
                "line_drawing (Wu)",
                Box::new(|| {
                    for [from, to] in &ends {
                        let line = line_drawing::XiaolinWu::<f32, i32>::new(
                            float_pair(*from),
                            float_pair(*to),
                        );
                        for ((x, y), share) in line {
                            let pixel = third.pixel_mut(x as usize, y as usize);
                            *pixel = pixel.lerp(Rgb::WHITE, share);
                        }
                    }
                }),
            ),
        ],
    );
}

fn antialiased_circles(side: usize, radius: i32) {
    let centers = centers(side, radius);
    let exact = std::f64::consts::TAU * f64::from(radius);
    let mut single = Image::filled(side, side, 0.0);
    let middle = DVec2::splat(side as f64 / 2.0);
    smooth::draw_circle(&mut single.pen(1.0), middle, f64::from(radius), 1.0);
    let sum: f64 = single.pixels().iter().map(|&c| f64::from(c)).sum();
    assert!(
        (sum / exact - 1.0).abs() < 1e-5,
        "{sum} for a ring of {exact}"
    );
    let mut image = Image::filled(side, side, Rgb::BLACK);
    let mut mask = Image::filled(side, side, 0_u8);
    let mut shares = Image::filled(side, side, 0_f32);
    let mut bytes = Image::filled(side, side, [0_u8; 4]);
    let mut vello = Vello::new(side);
    let paths: Vec<BezPath> = centers
        .iter()
        .map(|center| {
            let center = (f64::from(center.x), f64::from(center.y));
            vello_cpu::kurbo::Shape::to_path(
                &vello_cpu::kurbo::Circle::new(center, f64::from(radius)),
                0.01,
            )
        })
        .collect();
    let pixels = (5.66 * f64::from(radius)) as usize * centers.len();
    report(
        &format!("antialiased, radius {radius}"),
        pixels,
        vec![
            ("ours, u8", rings(&mut mask, u8::MAX, &centers, radius)),
            ("ours, f32", rings(&mut shares, 1.0, &centers, radius)),
            (
                "ours, [u8; 4]",
                rings(&mut bytes, [255; 4], &centers, radius),
            ),
            ("ours, Rgb", rings(&mut image, Rgb::WHITE, &centers, radius)),
            ("vello_cpu", Box::new(|| vello.stroke(&paths))),
        ],
    );
}
