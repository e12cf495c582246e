//! Circles by eight octants, ellipses by two regions.

use super::figure::{INK, Sheet, TRUE, rgb};
use crate::{Exhibit, GalleryError, Piece, Request};
use glam::{DVec2, IVec2};
use hemicube_chart::{Chart, Curve, Scale};
use hemicube_raster::circle::{Octant, OctantStep, draw_circle, fill_circle};
use hemicube_raster::ellipse::draw_ellipse;
use hemicube_raster::{Image, Rgb};
use std::f64::consts::TAU;

pub const CIRCLES: Exhibit = Exhibit {
    name: "circles",
    about: "the midpoint circle: eight octants, the reference point P and its decision, the filled disc",
    needs: &[],
    draw: draw_circles,
};

pub const ELLIPSES: Exhibit = Exhibit {
    name: "ellipses",
    about: "midpoint ellipses: one pixel a column in one region, one a row in the other",
    needs: &[],
    draw: draw_ellipses,
};

/// Colours of the octants; pixels on axes and diagonals belong to two and are grey.
const OCTANTS: [[u8; 3]; 8] = [
    [240, 150, 140],
    [245, 200, 130],
    [225, 225, 120],
    [150, 215, 140],
    [140, 215, 215],
    [140, 175, 235],
    [180, 150, 225],
    [235, 150, 205],
];
const SHARED: [u8; 3] = [170, 170, 170];
const RADIUS: i32 = 13;
const SIDE: usize = 31;
const CENTRE: IVec2 = IVec2::new(15, 15);

/// The octant of a pixel relative to the centre; `None` on its borders.
fn octant(p: IVec2) -> Option<usize> {
    let is_border = p.x == 0 || p.y == 0 || p.x.abs() == p.y.abs();
    let bits = [p.x < 0, p.y < 0, p.x.abs() < p.y.abs()];
    let index = bits.iter().fold(0, |sum, &bit| 2 * sum + usize::from(bit));
    (!is_border).then_some(index)
}

/// Pixels set by something, with a colour for each.
fn coloured(set: &Image<bool>, color: impl Fn(IVec2) -> [u8; 3]) -> Image<Rgb> {
    let mut image = Image::filled(set.width(), set.height(), Rgb::WHITE);
    for (y, row) in (0..).zip(set.pixels().chunks(set.width())) {
        for (x, _) in (0..).zip(row).filter(|(_, is_set)| **is_set) {
            *image.pixel_mut(x as usize, y as usize) = rgb(color(IVec2::new(x, y)));
        }
    }
    image
}

/// Points on the true ellipse, in cells.
fn ellipse(center: IVec2, radii: IVec2) -> Vec<DVec2> {
    (0..=180)
        .map(|k| DVec2::from_angle(f64::from(k) * TAU / 180.0) * radii.as_dvec2())
        .map(|p| center.as_dvec2() + p + 0.5)
        .collect()
}

/// The step that is shown: the fourth.
fn shown() -> OctantStep {
    Octant::new(RADIUS)
        .nth(4)
        .expect("an octant of this radius has eleven pixels")
}

fn draw_circles(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let mut sheet = Sheet::new(request, (1640, 610), 3, [SIDE, SIDE])?;
    let mut circle = Image::filled(SIDE, SIDE, false);
    draw_circle(&mut circle.pen(true), CENTRE, RADIUS);
    let count = circle.pixels().iter().filter(|&&set| set).count();
    let by_octant = |p: IVec2| octant(p - CENTRE).map_or(SHARED, |k| OCTANTS[k]);
    sheet.pixels(0, &coloured(&circle, by_octant));
    let truth = ellipse(CENTRE, IVec2::splat(RADIUS));
    sheet.curve(0, &truth, TRUE, 2.0);
    sheet.label(
        0,
        "Eight-fold symmetry",
        &[
            format!("radius {RADIUS}: {count} pixels, each once"),
            String::from("grey: shared by two octants"),
        ],
    );
    draw_reference_point(&mut sheet);
    let mut disc = Image::filled(SIDE, SIDE, false);
    fill_circle(&mut disc.pen(true), CENTRE, RADIUS);
    let area = disc.pixels().iter().filter(|&&set| set).count();
    sheet.pixels(2, &coloured(&disc, |_| OCTANTS[5]));
    sheet.curve(2, &truth, TRUE, 2.0);
    let exact = f64::from(RADIUS * RADIUS) * std::f64::consts::PI;
    sheet.label(
        2,
        "Filled: one span a row",
        &[format!("{area} pixels, pi r^2 = {exact:.1}")],
    );
    Ok(vec![
        Piece::sheet("", &sheet.finish())?,
        Piece::chart("-decision", &decision_chart(), (900, 480)),
    ])
}

/// The first quadrant with P, the two pixels that may follow, and the midpoint between them.
fn draw_reference_point(sheet: &mut Sheet) {
    // y points up in the octant and down on the sheet.
    let center = IVec2::new(1, 14);
    let place = |x: i32, y: i32| center + IVec2::new(x, -y);
    let mut circle = Image::filled(15, 16, false);
    draw_circle(&mut circle.pen(true), center, RADIUS);
    let color = |p: IVec2| match center.y - p.y >= p.x - center.x && p.x >= center.x {
        true => OCTANTS[3],
        false => [225, 225, 225],
    };
    sheet.pixels(1, &coloured(&circle, color));
    let arc: Vec<DVec2> = (0..=40)
        .map(|k| DVec2::from_angle(-f64::from(k) / 160.0 * TAU) * f64::from(RADIUS))
        .map(|p| center.as_dvec2() + p + 0.5)
        .collect();
    sheet.curve(1, &arc, TRUE, 2.0);
    let middle = center.as_dvec2() + 0.5;
    for end in [DVec2::new(0.0, -14.0), DVec2::new(9.8, -9.8)] {
        sheet.line(1, [middle, middle + end], SHARED, 1.0);
    }
    let step = shown();
    let IVec2 { x, y } = step.point;
    let marks = [("P", [0, 0]), ("E", [1, 0]), ("SE", [1, -1])];
    for (name, [dx, dy]) in marks {
        sheet.word(1, place(x + dx, y + dy), name, INK);
    }
    let midpoint = place(x + 1, y).as_dvec2() + DVec2::new(0.5, 1.0);
    sheet.cross(1, midpoint, INK);
    let next = if step.decision < 0 { "E" } else { "SE" };
    let captions = [
        format!(
            "P = ({x}, {y}), F(midpoint ×) = {:.2}",
            step.decision as f64 + 0.25
        ),
        format!(
            "so {next} is next; d + {} if E, {} if SE",
            step.east, step.south_east
        ),
    ];
    sheet.label(1, "First octant, P and the midpoint", &captions);
}

/// The decision of each step, and the differences that it grows by.
fn decision_chart() -> Chart {
    let curve = |name: &str, value: &dyn Fn(&OctantStep) -> i64| {
        let steps = Octant::new(60).map(|s| (f64::from(s.point.x), value(&s) as f64));
        Curve::new(name, steps.collect())
    };
    Chart {
        title: String::from("Midpoint circle of radius 60: additions only"),
        x_label: String::from("x"),
        y_label: String::from("F at the midpoint, and its first-order differences"),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        curves: vec![
            curve("decision", &|s| s.decision),
            curve("east", &|s| s.east),
            curve("south-east", &|s| s.south_east),
            curve("0", &|_| 0),
        ],
    }
}

const RADII: [IVec2; 3] = [IVec2::new(18, 9), IVec2::new(7, 13), IVec2::new(19, 2)];

fn draw_ellipses(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let mut sheet = Sheet::new(request, (1500, 440), 3, [41, 29])?;
    let center = IVec2::new(20, 14);
    for (panel, radii) in RADII.into_iter().enumerate() {
        let mut set = Image::filled(41, 29, false);
        draw_ellipse(&mut set.pen(true), center, radii);
        let is_flat = |p: IVec2| {
            let p = (p - center).as_dvec2().abs();
            let [a, b] = radii.as_dvec2().to_array();
            p.x <= a * a / a.hypot(b)
        };
        let color = |p: IVec2| if is_flat(p) { OCTANTS[5] } else { OCTANTS[1] };
        sheet.pixels(panel, &coloured(&set, color));
        sheet.curve(panel, &ellipse(center, radii), TRUE, 2.0);
        let count = set.pixels().iter().filter(|&&set| set).count();
        sheet.label(
            panel,
            &format!("Radii {} and {}", radii.x, radii.y),
            &[
                format!("{count} pixels"),
                String::from("blue: one a column, orange: one a row"),
            ],
        );
    }
    Ok(vec![Piece::sheet("", &sheet.finish())?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn octants_are_eight() {
        let around: Vec<usize> = [
            (2, 1),
            (1, 2),
            (-1, 2),
            (-2, 1),
            (-2, -1),
            (-1, -2),
            (1, -2),
            (2, -1),
        ]
        .into_iter()
        .filter_map(|(x, y)| octant(IVec2::new(x, y)))
        .collect();
        let set: std::collections::BTreeSet<usize> = around.iter().copied().collect();
        assert_eq!(set.len(), 8, "{around:?}");
        assert_eq!(octant(IVec2::new(3, -3)), None, "a diagonal");
    }

    #[test]
    fn the_shown_step_decides_as_the_true_circle_does() {
        let step = shown();
        let p = step.point.as_dvec2();
        let f = (p.x + 1.0).powi(2) + (p.y - 0.5).powi(2) - f64::from(RADIUS * RADIUS);
        assert_eq!(f, step.decision as f64 + 0.25);
    }
}
