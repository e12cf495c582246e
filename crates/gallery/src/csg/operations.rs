//! The tree of a solid, each of its operations as a picture, and below each the spans in which one ray is inside:
//! Roth's interval lists at work.

use super::{built, checked_size, shown};
use crate::exhibit::{GalleryError, Piece, Request};
use glam::DVec3;
use hemicube_chart::{Anchor, Canvas, Drawing};
use hemicube_csg::{Camera, CsgError, Light, Material, Pattern, Ray, Scene, Sky, Solid, View};
use hemicube_raster::antialias::Antialiasing;
use hemicube_raster::{Image, Rgb};

/// A solid of the tree.
struct Node {
    name: &'static str,
    solid: Solid,
    /// Middle of its picture, in columns of pictures, and its row.
    column: f64,
    row: usize,
    /// The two that it is made of, as places in the list.
    operands: Option<[usize; 2]>,
}

const ROWS: usize = 3;
const COLUMNS: usize = 4;

/// Below each picture: its name and the bar of its spans.
const CAPTION: usize = 58;

const GAP: usize = 24;

pub fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let (width, height) = checked_size(request, (240, 200), 16)?;
    let nodes = built(nodes());
    let camera = built(camera());
    let (step_x, step_y) = (width + GAP, height + CAPTION + GAP);
    let mut canvas = Canvas::new(COLUMNS * step_x + GAP, ROWS * step_y + GAP);
    let left = |node: &Node| GAP + whole(node.column * step_x as f64);
    let top = |node: &Node| GAP + node.row * step_y;
    canvas.draw(
        &branches(
            &nodes,
            &|node| [left(node) as f64 + width as f64 / 2.0, top(node) as f64],
            (height + CAPTION) as f64,
        ),
        0,
        0,
    );
    for node in &nodes {
        let picture = picture(node, &camera, (width, height));
        canvas.paste(&picture, left(node), top(node));
        canvas.draw(&caption(node, width), left(node), top(node) + height);
    }
    Ok(vec![Piece::sheet("", &canvas)?])
}

fn at(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A rounded cube without two crossing rods.
fn nodes() -> Result<Vec<Node>, CsgError> {
    let paint = |r: f32, g: f32, b: f32| {
        Material::matte(Pattern::plain(Rgb::new(r, g, b))?).with_highlight(0.04, 60.0)
    };
    let cube = Solid::cuboid(DVec3::splat(-1.0), DVec3::splat(1.0))?
        .with_material(paint(0.75, 0.24, 0.10)?);
    let ball = Solid::sphere(DVec3::ZERO, 1.32)?.with_material(paint(0.10, 0.32, 0.70)?);
    let rod = |axis: DVec3| Solid::cylinder(axis * -1.6, axis * 1.6, 0.55);
    let green = paint(0.12, 0.50, 0.18)?;
    let across = rod(DVec3::X)?.with_material(green.clone());
    let upright = rod(DVec3::Y)?.with_material(green);
    let rounded = cube.clone() & ball.clone();
    let rods = across.clone() | upright.clone();
    let whole = rounded.clone() - rods.clone();
    let node = |name, solid, column, row, operands| Node {
        name,
        solid,
        column,
        row,
        operands,
    };
    Ok(vec![
        node("cube", cube, 0.0, 2, None),
        node("ball", ball, 1.0, 2, None),
        node("rod", across, 2.0, 2, None),
        node("rod", upright, 3.0, 2, None),
        node("cube & ball", rounded, 0.5, 1, Some([0, 1])),
        node("rod | rod", rods, 2.5, 1, Some([2, 3])),
        node("(cube & ball) - (rod | rod)", whole, 1.5, 0, Some([4, 5])),
    ])
}

fn camera() -> Result<Camera, CsgError> {
    Camera::new(at(3.4, 3.0, 5.2), DVec3::ZERO, 30.0)
}

/// The ray whose spans are drawn: from the left through the solid, beside the rod along it.
fn ray() -> Ray {
    Ray::new(at(-RAY_LENGTH / 2.0, 0.5, 0.4), DVec3::X)
}

const RAY_LENGTH: f64 = 4.0;

fn picture(node: &Node, camera: &Camera, size: (usize, usize)) -> Image<Rgb> {
    let light = built(Light::distant(at(0.2, 1.0, 0.6), Rgb::splat(2.3)));
    let fill = built(Light::distant(at(1.0, 0.3, 0.5), Rgb::splat(0.5)));
    let sky = built(Sky::even(Rgb::splat(0.35)));
    let scene = Scene::new([node.solid.clone(), thread()])
        .with_lights([light, fill])
        .with_sky(sky);
    let view = View {
        scene: &scene,
        camera,
        size,
    };
    shown(&view.render(Antialiasing::default()))
}

/// The ray as something to be seen: a thin thread.
fn thread() -> Solid {
    let ray = ray();
    let thread = Solid::cylinder(ray.at(-0.4), ray.at(RAY_LENGTH + 0.4), 0.022);
    let black = Pattern::plain(Rgb::splat(0.01)).map(Material::matte);
    built(thread).with_material(built(black))
}

/// Lines from each operation to what it combines.
fn branches(nodes: &[Node], top: &dyn Fn(&Node) -> [f64; 2], height: f64) -> Drawing {
    let mut drawing = Drawing::new(0, 0);
    for node in nodes {
        for operand in node.operands.into_iter().flatten() {
            let [x, y] = top(node);
            drawing.line([x, y + height - 8.0], top(&nodes[operand]), [120; 3], 1.5);
        }
    }
    drawing
}

/// The name, and a bar that is thick where the ray is inside.
fn caption(node: &Node, width: usize) -> Drawing {
    let mut drawing = Drawing::new(width, CAPTION);
    let (middle, y) = (width as f64 / 2.0, 36.0);
    drawing.text([middle, 4.0], node.name, Anchor::Middle, 20, [40; 3]);
    let along = |t: f64| width as f64 * (t / RAY_LENGTH).clamp(0.0, 1.0);
    drawing.line([0.0, y], [width as f64, y], [150; 3], 1.0);
    for span in node.solid.spans(&ray()) {
        let (start, end) = (along(span.start), along(span.end));
        drawing.line([start, y], [end, y], [0, 114, 178], 7.0);
    }
    drawing
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a place on the sheet"
)]
fn whole(place: f64) -> usize {
    place as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::ops::Range;

    #[test]
    fn spans_of_the_ray_are_those_of_the_algebra() {
        let nodes = built(nodes());
        let spans = |name: &str| {
            let node = nodes.iter().rev().find(|n| n.name == name).expect(name);
            node.solid.spans(&ray())
        };
        let close = |found: &[Range<f64>], expected: &[Range<f64>]| {
            let near = |(a, b): (&Range<f64>, &Range<f64>)| {
                (a.start - b.start).abs() < 1e-9 && (a.end - b.end).abs() < 1e-9
            };
            assert!(
                found.len() == expected.len() && found.iter().zip(expected).all(near),
                "{found:?} instead of {expected:?}"
            );
        };
        let ball = (1.32_f64.powi(2) - 0.25 - 0.16).sqrt();
        let upright = (0.55_f64.powi(2) - 0.16).sqrt();
        close(&spans("ball"), &[2.0 - ball..2.0 + ball]);
        close(&spans("cube & ball"), &[1.0..3.0]);
        close(&spans("rod | rod"), &[2.0 - upright..2.0 + upright]);
        let left = [1.0..2.0 - upright, 2.0 + upright..3.0];
        close(&spans("(cube & ball) - (rod | rod)"), &left);
    }
}
