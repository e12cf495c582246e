//! Which mip level each pixel of a plane reads, by rule, and the footprints of some pixels on the texture.

use super::plane::{Plane, SIDE};
use super::size;
use crate::sheet::{Cell, MARGIN, picture, sheet_above};
use crate::{Exhibit, GalleryError, Piece, Request};
use glam::Vec2;
use hemicube_chart::{Anchor, Canvas, Drawing};
use hemicube_raster::texture::{Footprint, Log2, Texcoord};
use hemicube_raster::{Image, Rgb};

pub(super) const EXHIBIT: Exhibit = Exhibit {
    name: "lod",
    about: "the mip level of each pixel in colours: longer derivative, true ellipse, anisotropic; and footprints of pixels",
    needs: &[],
    draw,
};

/// Colours of levels 0, 1, 2 and so on.
const COLORS: [Rgb; LAST + 1] = [
    Rgb::new(0.85, 0.85, 0.85),
    Rgb::new(0.8, 0.1, 0.05),
    Rgb::new(0.9, 0.6, 0.05),
    Rgb::new(0.1, 0.5, 0.15),
    Rgb::new(0.05, 0.35, 0.75),
    Rgb::new(0.4, 0.1, 0.5),
    Rgb::new(0.9, 0.45, 0.6),
    Rgb::new(0.25, 0.1, 0.03),
    Rgb::new(0.1, 0.55, 0.55),
    Rgb::new(0.5, 0.6, 0.1),
    Rgb::new(0.05, 0.05, 0.07),
];

/// The level of one texel.
const LAST: usize = SIDE.ilog2() as usize;

/// Side of a square of the legend.
const SWATCH: usize = 24;

type Rule = (&'static str, fn(&Footprint) -> f32);

const RULES: [Rule; 4] = [
    ("longer derivative", |f| f.lod(Log2::Exact)),
    ("the same, fast logarithm", |f| f.lod(Log2::Fast)),
    ("true ellipse", |f| f.axes().lod(Log2::Exact)),
    ("anisotropic, 16", |f| {
        f.anisotropic_lod(16.0, Log2::Exact).lod
    }),
];

fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = size(request, (400, 300))?;
    let plane = Plane::new(width, height);
    let pixels = plane.pixels();
    let levels = |rule: fn(&Footprint) -> f32| -> Vec<f32> {
        pixels.iter().map(|p| rule(&footprint(p))).collect()
    };
    let first = levels(RULES[0].1);
    let start = plane.horizon() * width;
    let cell = |(name, rule): Rule| {
        let found = levels(rule);
        let most = found
            .iter()
            .zip(&first)
            .map(|(a, b)| a - b)
            .max_by(|a, b| a.abs().total_cmp(&b.abs()));
        let image = picture(width, height, |x, y| {
            (y * width + x)
                .checked_sub(start)
                .map_or(Rgb::WHITE, |i| level_color(found[i]))
        });
        Cell::new(image, &[name, &compared(most.unwrap_or(0.0))])
    };
    Ok(vec![
        Piece::sheet("", &with_legend(&RULES.map(cell)))?,
        Piece::sheet("-footprints", &footprints(&plane, &pixels, width))?,
    ])
}

fn footprint(at: &Texcoord) -> Footprint {
    Footprint::new(at.ddx, at.ddy, (SIDE, SIDE))
}

/// The maps of levels, and below them which colour means which level.
fn with_legend(maps: &[Cell]) -> Canvas {
    let (mut canvas, top) = sheet_above(maps, 2, 3 * SWATCH + MARGIN);
    let names = (0..=LAST).map(|level| level.to_string());
    for (level, name) in names.enumerate() {
        let swatch = Image::filled(SWATCH, SWATCH, level_color(level as f32));
        let left = MARGIN + level * (SWATCH + 4);
        canvas.paste(&swatch, left, top);
        let mut number = Drawing::new(SWATCH, SWATCH);
        let middle = [0.5 * SWATCH as f64, 2.0];
        number.text(middle, &name, Anchor::Middle, 16, [40; 3]);
        canvas.draw(&number, left, top + SWATCH);
    }
    let words = format!("level; 0 has {SIDE} texels a side, each next one half as many");
    let mut line = Drawing::new(8 * words.len() + 8, SWATCH);
    line.text([0.0, 2.0], &words, Anchor::Start, 16, [40; 3]);
    canvas.draw(&line, MARGIN, top + 2 * SWATCH);
    canvas
}

/// How far the levels of a rule are from those of the first one, where it is farthest.
fn compared(most: f32) -> String {
    match most {
        m if m.abs() < 5e-4 => String::from("with it the others are compared"),
        m if m < 0.0 => format!("up to {:.2} levels finer", -m),
        m => format!("up to {m:.2} levels coarser"),
    }
}

/// The colours of the two levels around, blended as trilinear filtering does.
fn level_color(lod: f32) -> Rgb {
    let lod = lod.clamp(0.0, LAST as f32);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a level"
    )]
    let level = lod.floor() as usize;
    COLORS[level].lerp(COLORS[(level + 1).min(LAST)], lod.fract())
}

/// Side of the drawing of footprints in pixels, and how many of its pixels a texel takes.
const DRAWN: f32 = 480.0;
const TEXEL: f32 = 12.0;

/// Footprints of one column of pixels as seen on the texture, all around one centre: parallelograms and ellipses.
fn footprints(plane: &Plane, pixels: &[Texcoord], width: usize) -> Canvas {
    let side = 480;
    let mut drawing = Drawing::new(side, side + 48);
    let column = width * 7 / 8;
    for (k, share) in [0.9, 0.5, 0.3, 0.2].into_iter().enumerate() {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a row of the picture"
        )]
        let row = (share * plane.rows() as f64) as usize;
        let outline = footprint(&pixels[row * width + column]);
        let color = COLORS[k + 1]
            .to_array()
            .map(hemicube_raster::color::srgb8_from_linear);
        let ellipse = |t: f32| outline.dx * (0.5 * t.cos()) + outline.dy * (0.5 * t.sin());
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
            .map(|(a, b)| outline.dx * a + outline.dy * b);
        let turn = (0..48_u8).map(|i| f32::from(i) * core::f32::consts::TAU / 48.0);
        closed(&mut drawing, &corners, color);
        closed(&mut drawing, &turn.map(ellipse).collect::<Vec<_>>(), color);
    }
    let text = "footprints of four pixels; the bar is a texel";
    drawing.text(
        [8.0, f64::from(DRAWN) + 4.0],
        text,
        Anchor::Start,
        16,
        [40; 3],
    );
    let bar = f64::from(DRAWN) + 32.0;
    let end = 8.0 + f64::from(TEXEL);
    drawing.line([8.0, bar], [end, bar], [40; 3], 2.0);
    let mut canvas = Canvas::new(side, side + 48);
    canvas.draw(&drawing, 0, 0);
    canvas
}

/// The outline of points in texels around the middle of the drawing.
fn closed(drawing: &mut Drawing, points: &[Vec2], color: [u8; 3]) {
    let place = |p: Vec2| {
        let p = p * TEXEL + Vec2::splat(0.5 * DRAWN);
        [f64::from(p.x), f64::from(p.y)]
    };
    for (i, &point) in points.iter().enumerate() {
        drawing.line(
            place(point),
            place(points[(i + 1) % points.len()]),
            color,
            1.5,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_told_in_words() {
        assert_eq!(compared(-4.0), "up to 4.00 levels finer");
        assert_eq!(compared(0.5), "up to 0.50 levels coarser");
        for (i, &color) in COLORS.iter().enumerate() {
            assert!(
                !COLORS[..i].contains(&color),
                "level {i} looks like another"
            );
        }
    }

    #[test]
    fn rules_differ_as_they_must() {
        for pixel in Plane::new(64, 48).pixels() {
            let [longer, fast, ellipse, anisotropic] =
                RULES.map(|(_, rule)| rule(&footprint(&pixel)));
            assert!(
                (-1e-4..=0.0431).contains(&(longer - fast)),
                "{longer}, {fast}"
            );
            assert!(
                (-1e-4..=0.5001).contains(&(ellipse - longer)),
                "{ellipse}, {longer}"
            );
            assert!(
                (-1e-4..=4.0001).contains(&(longer - anisotropic)),
                "{longer}, {anisotropic}"
            );
        }
    }
}
