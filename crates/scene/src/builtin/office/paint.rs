//! Pictures for the office, computed: wood, cloth, rugs, art, the view out of the window.
//!
//! Colours are linear reflectances. What tiles is periodic.

use glam::{IVec2, Vec2};
use hemicube_raster::color::srgb8_from_linear;
use hemicube_raster::{Image, Rgb};
use std::f32::consts::{PI, TAU};

/// A picture of `color(at)`, `at` running from (0, 0) in the upper left corner to (1, 1).
fn paint(width: usize, height: usize, color: impl Fn(Vec2) -> Rgb) -> Image<[u8; 4]> {
    let at = |i: usize| Vec2::new((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
    let size = Vec2::new(width as f32, height as f32);
    let encode = |c: Rgb| {
        [
            srgb8_from_linear(c.r),
            srgb8_from_linear(c.g),
            srgb8_from_linear(c.b),
            255,
        ]
    };
    let pixels = (0..width * height)
        .map(|i| encode(color(at(i) / size)))
        .collect();
    Image::from_pixels(width, height, pixels).expect("as many pixels as the size says")
}

/// A number in [0, 1) that looks random, the same on every machine.
pub(super) fn hash(x: i32, y: i32, seed: u32) -> f32 {
    let mut h =
        x.cast_unsigned().wrapping_mul(0x8da6_b343) ^ y.cast_unsigned().wrapping_mul(0xd816_3841);
    h ^= seed.wrapping_mul(0xcb1a_b31f);
    for shift in [16, 15] {
        h = (h ^ (h >> shift)).wrapping_mul(0x7feb_352d);
    }
    ((h ^ (h >> 16)) >> 8) as f32 / 16_777_216.0
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "coordinates of pictures are small"
)]
fn cell(x: f32) -> i32 {
    x.floor() as i32
}

fn smooth(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Value noise in [0, 1] over `at * cells`, periodic in the unit square.
fn noise(at: Vec2, cells: IVec2, seed: u32) -> f32 {
    let p = at * cells.as_vec2();
    let (x, y) = (cell(p.x), cell(p.y));
    let f = p - p.floor();
    let f = f * f * (3.0 - 2.0 * f);
    let corner = |dx: i32, dy: i32| {
        hash(
            (x + dx).rem_euclid(cells.x),
            (y + dy).rem_euclid(cells.y),
            seed,
        )
    };
    let row = |dy: i32| corner(0, dy) + (corner(1, dy) - corner(0, dy)) * f.x;
    row(0) + (row(1) - row(0)) * f.y
}

/// Four octaves of noise, in [0, 1].
fn clouds(at: Vec2, cells: IVec2, seed: u32) -> f32 {
    let octave = |i: u32| noise(at, cells * (1 << i), seed + i) / (1 << i) as f32;
    (0..4).map(octave).sum::<f32>() / 1.875
}

/// Grain of a board in [0, 1]: streaks along x with rings of growth.
fn grain(at: Vec2, seed: u32) -> f32 {
    let bend = clouds(at, IVec2::new(2, 3), seed) * 2.2;
    let rings = 0.5 + 0.5 * (TAU * (at.y * 5.0 + bend)).sin();
    let pores = noise(at, IVec2::new(10, 140), seed + 11) * 0.6
        + noise(at, IVec2::new(24, 260), seed + 12) * 0.4;
    0.45 * rings + 0.55 * pores
}

/// A floor of twelve rows of oak planks, two planks to a row.
pub(super) fn planks() -> Image<[u8; 4]> {
    let (light, dark) = (Rgb::new(0.50, 0.315, 0.175), Rgb::new(0.27, 0.15, 0.075));
    paint(1024, 768, |at| {
        let row = cell(at.y * 12.0);
        let across = at.y * 12.0 - row as f32;
        let along = at.x * 2.0 + hash(row, 0, 1) * 2.0;
        let plank = cell(along).rem_euclid(2);
        let tone = hash(row, plank, 2);
        let board = Vec2::new(
            (along - along.floor()) * 0.5 + 0.5 * hash(row, plank, 3),
            across * 0.25 + tone,
        );
        let streaks = grain(board, 20);
        let color = light.lerp(dark, (0.62 * streaks + 0.5 * tone - 0.12).clamp(0.0, 1.0));
        let end = (along - along.floor()).min(1.0 - (along - along.floor())) * 1.2;
        let side = across.min(1.0 - across) * 0.15;
        let joint = smooth(0.0005, 0.0028, end.min(side));
        color * (0.35 + 0.65 * joint)
    })
}

/// A board of furniture wood.
pub(super) fn wood(light: Rgb, dark: Rgb, seed: u32) -> Image<[u8; 4]> {
    paint(512, 512, |at| light.lerp(dark, grain(at, seed)))
}

/// Plaster: almost even.
pub(super) fn plaster() -> Image<[u8; 4]> {
    paint(256, 256, |at| {
        let value = 0.955 + 0.045 * clouds(at, IVec2::new(6, 6), 40);
        Rgb::splat(value)
    })
}

/// Woven cloth in shades of white, for the material's base colour to tint.
pub(super) fn cloth() -> Image<[u8; 4]> {
    paint(256, 256, |at| {
        let thread = at * 48.0;
        let over = (cell(thread.x) + cell(thread.y)).rem_euclid(2) == 0;
        let f = thread - thread.floor();
        let bulge = if over {
            (PI * f.y).sin()
        } else {
            (PI * f.x).sin()
        };
        let uneven = clouds(at, IVec2::new(8, 8), 50);
        Rgb::splat(0.74 + 0.12 * bulge + 0.14 * uneven)
    })
}

/// A rug: borders around a field of stepped diamonds.
pub(super) fn rug() -> Image<[u8; 4]> {
    let cream = Rgb::new(0.62, 0.55, 0.43);
    let rust = Rgb::new(0.36, 0.095, 0.045);
    let indigo = Rgb::new(0.035, 0.055, 0.115);
    let ochre = Rgb::new(0.50, 0.28, 0.07);
    let size = Vec2::new(2.6, 1.8);
    paint(1024, 704, |at| {
        // Knots are square, so that curves become steps.
        let knot = (at * size / 0.02).floor() * 0.02 + 0.01;
        let edge = knot.min(size - knot).min_element();
        let color = if edge < 0.06 || (0.24..0.28).contains(&edge) {
            indigo
        } else if edge < 0.10 || (0.20..0.24).contains(&edge) {
            ochre
        } else if edge < 0.20 {
            let along = if (knot.y - size.y / 2.0).abs() > size.y / 2.0 - 0.2 {
                knot.x
            } else {
                knot.y
            };
            if (along * 10.0 + (edge - 0.15).abs() * 14.0).rem_euclid(2.0) < 1.0 {
                rust
            } else {
                cream
            }
        } else {
            let p = (knot - size / 2.0) / Vec2::new(0.52, 0.62);
            let local = p - (p + 0.5).floor();
            let diamond = local.x.abs() + local.y.abs();
            match diamond {
                d if d < 0.10 => ochre,
                d if d < 0.20 => indigo,
                d if d < 0.34 => rust,
                d if d < 0.39 => cream,
                d if d < 0.44 => indigo,
                _ => cream,
            }
        };
        let threads = 0.5 + 0.5 * (TAU * at.y * size.y / 0.0125).sin();
        let uneven = clouds(at, IVec2::new(26, 18), 60) + 0.6 * noise(at, IVec2::new(4, 90), 61);
        color * (0.72 + 0.13 * threads + 0.20 * uneven)
    })
}

/// A poster: a sun over hills that fade into haze.
pub(super) fn hills() -> Image<[u8; 4]> {
    let (sky, haze) = (Rgb::new(0.72, 0.56, 0.40), Rgb::new(0.62, 0.50, 0.40));
    let (near, sun) = (Rgb::new(0.03, 0.07, 0.075), Rgb::new(0.62, 0.13, 0.045));
    paint(512, 384, |at| {
        let paper = 0.94 + 0.06 * clouds(at, IVec2::new(20, 15), 70);
        let mut color = sky.lerp(haze, at.y);
        if (Vec2::new(at.x * 4.0 / 3.0, at.y) - Vec2::new(0.88, 0.36)).length() < 0.17 {
            color = sun;
        }
        for layer in 0..5 {
            let depth = layer as f32 / 4.0;
            let x = at.x * (1.6 + depth) + 3.7 * depth;
            let ridge =
                (x * 2.1).sin() * 0.08 + (x * 4.7 + 1.0).sin() * 0.035 + (x * 11.0).sin() * 0.01;
            if at.y > 0.46 + 0.115 * layer as f32 + ridge {
                color = haze.lerp(near, 0.22 + 0.78 * depth);
            }
        }
        mat_board(at, Vec2::new(0.07, 0.09), color) * paper
    })
}

/// A print: arches and a leaf in the colours of the fifties.
pub(super) fn arches() -> Image<[u8; 4]> {
    let paper = Rgb::new(0.74, 0.69, 0.58);
    let bands = [
        Rgb::new(0.045, 0.09, 0.10),
        Rgb::new(0.52, 0.15, 0.06),
        Rgb::new(0.66, 0.40, 0.12),
        Rgb::new(0.20, 0.33, 0.30),
    ];
    paint(384, 512, |at| {
        let p = Vec2::new(at.x, at.y * 4.0 / 3.0);
        let mut color = paper;
        let centre = Vec2::new(0.42, 0.88);
        let from = p - centre;
        let radius = if from.y < 0.0 {
            from.length()
        } else {
            from.x.abs()
        };
        if p.y < 1.14 && radius < 0.29 {
            let band = cell(radius / 0.0725).clamp(0, 3);
            color = bands
                .into_iter()
                .nth(usize::try_from(band).unwrap_or(0))
                .unwrap_or(paper);
        }
        let moon = p - Vec2::new(0.68, 0.34);
        if moon.length() < 0.13 {
            color = bands[2];
        }
        let stem = p - Vec2::new(0.78, 0.85);
        let leaf = ((stem.y * 9.0).sin() * 0.07).abs();
        if stem.y.abs() < 0.29 && stem.x.abs() < leaf {
            color = bands[3] * 0.7;
        }
        let uneven = 0.93 + 0.07 * clouds(at, IVec2::new(18, 24), 80);
        mat_board(at, Vec2::new(0.10, 0.075), color) * uneven
    })
}

/// A painting: two fields of colour with soft borders.
pub(super) fn fields() -> Image<[u8; 4]> {
    let (ground, upper, lower) = (
        Rgb::new(0.42, 0.17, 0.07),
        Rgb::new(0.70, 0.42, 0.13),
        Rgb::new(0.06, 0.13, 0.16),
    );
    paint(640, 384, |at| {
        let wobble = (clouds(at, IVec2::new(5, 4), 90) - 0.5) * 0.05;
        let brush = 0.86
            + 0.22
                * (0.5 * noise(at, IVec2::new(9, 70), 91) + 0.5 * clouds(at, IVec2::new(7, 9), 92));
        let field = |low: f32, high: f32| {
            let inside_x = (at.x.min(1.0 - at.x) + wobble - 0.06) / 0.05;
            let inside_y = ((at.y - low).min(high - at.y) + wobble) / 0.05;
            smooth(0.0, 1.0, inside_x.min(inside_y))
        };
        ground
            .lerp(upper, field(0.08, 0.56))
            .lerp(lower, field(0.62, 0.93))
            * brush
    })
}

/// White board around a print.
fn mat_board(at: Vec2, border: Vec2, color: Rgb) -> Rgb {
    let inside = at.cmpgt(border).all() && at.cmplt(Vec2::ONE - border).all();
    if inside {
        color
    } else {
        Rgb::new(0.78, 0.76, 0.71)
    }
}

/// What the window shows, as a share of the brightest sky: clouds, hills in haze, trees.
pub(super) fn outdoors() -> Image<[u8; 4]> {
    let (zenith, horizon) = (Rgb::new(0.27, 0.50, 0.98), Rgb::new(0.84, 0.89, 0.93));
    let (hill, tree) = (Rgb::new(0.26, 0.36, 0.42), Rgb::new(0.05, 0.085, 0.035));
    paint(768, 512, |at| {
        let cover = clouds(Vec2::new(at.x, at.y * 1.6), IVec2::new(3, 5), 100);
        let sky = zenith.lerp(horizon, smooth(0.0, 0.72, at.y));
        let mut color = sky.lerp(Rgb::new(1.0, 0.98, 0.95), 0.85 * smooth(0.46, 0.72, cover));
        for layer in 0..3 {
            let depth = layer as f32 / 2.0;
            let x = at.x * (2.0 + 2.0 * depth) + 5.0 * depth;
            let ridge = 0.03 * (x * 2.3).sin() + 0.018 * (x * 5.1 + 2.0).sin();
            if at.y > 0.66 + 0.065 * layer as f32 + ridge {
                color = horizon.lerp(hill, 0.40 + 0.5 * depth) * (1.0 - 0.2 * depth);
            }
        }
        let crowns =
            0.08 * clouds(at, IVec2::new(9, 3), 110) + 0.025 * noise(at, IVec2::new(60, 20), 111);
        let crown_line = 0.93 - crowns - 0.05 * (at.x * 7.0).sin();
        if at.y > crown_line {
            let sunlit = clouds(at, IVec2::new(40, 30), 112) * smooth(0.16, 0.0, at.y - crown_line);
            color = tree.lerp(Rgb::new(0.24, 0.30, 0.10), sunlit);
        }
        color
    })
}

/// What the monitor shows, as a share of its white: a room with a red and a green wall, and the numbers beside it.
pub(super) fn screen() -> Image<[u8; 4]> {
    paint(512, 288, |at| {
        let p = Vec2::new(at.x * 16.0, at.y * 9.0);
        if p.y < 0.4 {
            let button =
                (0..3).any(|i| (p - Vec2::new(0.35 + 0.35 * i as f32, 0.2)).length() < 0.09);
            return if button {
                Rgb::new(0.6, 0.2, 0.1)
            } else {
                Rgb::splat(0.16)
            };
        }
        if p.x > 10.6 {
            panel(p - Vec2::new(10.6, 0.4))
        } else {
            little_room(p - Vec2::new(5.3, 4.7))
        }
    })
}

/// Text and a falling curve.
fn panel(p: Vec2) -> Rgb {
    let background = Rgb::new(0.035, 0.04, 0.05);
    if p.y > 5.0 && p.y < 8.0 && p.x > 0.5 && p.x < 4.9 {
        let (x, y) = (p.x - 0.5, 8.0 - p.y);
        let curve = 0.25 + 2.4 * (-1.1 * x).exp();
        let axis = x < 0.05 || y < 0.05;
        return if axis || (y - curve).abs() < 0.07 {
            Rgb::new(0.9, 0.55, 0.15)
        } else {
            background * 1.6
        };
    }
    let line = cell(p.y / 0.42);
    let inside = p.y / 0.42 - line as f32;
    let indent = 0.5 + 0.4 * (hash(line, 1, 120) * 3.0).floor();
    let length = 1.0 + 2.6 * hash(line, 2, 120);
    let is_text =
        line < 11 && (0.3..0.68).contains(&inside) && p.x > indent && p.x < indent + length;
    let gap = hash(cell(p.x * 3.0), line, 121) < 0.18;
    match (is_text && !gap, hash(line, 3, 120) < 0.4) {
        (true, true) => Rgb::new(0.25, 0.55, 0.75),
        (true, false) => Rgb::new(0.55, 0.58, 0.6),
        _ => background,
    }
}

/// The famous box, seen along its axis; `p` from its middle, 8.6 high.
fn little_room(p: Vec2) -> Rgb {
    let reach = p.abs().max_element();
    if reach > 4.1 {
        return Rgb::splat(0.012);
    }
    let shade = |c: Rgb, k: f32| c * k;
    let white = Rgb::new(0.72, 0.66, 0.55);
    let rectangle = |low: Vec2, high: Vec2| p.cmpgt(low).all() && p.cmplt(high).all();
    if rectangle(Vec2::new(-1.9, -0.5), Vec2::new(-0.2, 2.9)) {
        return shade(white, 0.55 - 0.06 * p.y);
    }
    if rectangle(Vec2::new(0.2, 1.4), Vec2::new(1.9, 3.3)) {
        return shade(white, 0.62);
    }
    if rectangle(Vec2::new(0.3, 1.05), Vec2::new(1.75, 1.4)) {
        return shade(white, 1.1);
    }
    if reach < 2.2 {
        return shade(white, 0.78 - 0.07 * p.y.abs());
    }
    let depth = (reach - 2.2) / 1.9;
    match p {
        _ if p.x == -reach => shade(Rgb::new(0.62, 0.09, 0.06), 0.9 - 0.4 * depth),
        _ if p.x == reach => shade(Rgb::new(0.16, 0.45, 0.10), 0.9 - 0.4 * depth),
        _ if p.y == -reach && p.x.abs() < 1.0 + 0.3 * depth && (0.25..0.7).contains(&depth) => {
            Rgb::WHITE
        }
        _ if p.y == -reach => shade(white, 0.55 - 0.2 * depth),
        _ => shade(white, 1.0 - 0.35 * depth),
    }
}

/// The back of a book in shades of white: bands, a label, lines of its title.
pub(super) fn spine() -> Image<[u8; 4]> {
    paint(64, 256, |at| {
        let band = [0.06, 0.10, 0.90, 0.94]
            .iter()
            .any(|y| (at.y - y).abs() < 0.008);
        let title = (0.20..0.52).contains(&at.y)
            && (0.3..0.7).contains(&at.x)
            && hash(cell(at.y * 60.0), 0, 130) > 0.35;
        let edge = 0.80 + 0.20 * (PI * at.x).sin();
        let value = if band || title { 0.55 } else { 0.93 };
        Rgb::splat(value * edge)
    })
}
