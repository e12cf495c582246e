//! One relief made in every way, beside the mesh that really has it.

use super::{BACKGROUND, shaded};
use crate::sheet::{Cell, cell_size, sheet};
use crate::stage::{Camera, Fragment, Mesh, Sampling, Vertex, draw as draw_stage};
use crate::{GalleryError, Piece, Request};
use core::f32::consts::{PI, TAU};
use glam::{Vec2, Vec3};
use hemicube_raster::bump::relief::{Bricks, GolfBall, Noise, OrangePeel, Relief, Ripples};
use hemicube_raster::bump::{
    HeightMap, SurfaceGradient, blinn_normal, decode_normal, encode_normal, tangents,
};
use hemicube_raster::texture::{Alpha, Sampler, Texture, TextureOptions};
use hemicube_raster::{Image, Rgb};

const COLOR: Rgb = Rgb::new(0.75, 0.72, 0.66);

/// Texels of the height map and the normal map, around and from pole to pole.
const TEXELS: (usize, usize) = (1024, 512);

/// The relief of the first row.
fn golf_ball() -> GolfBall {
    GolfBall::default().with_dimples(180).with_depth(0.035)
}

/// A bumped normal of what a sample sees.
type Normal<'a> = Box<dyn Fn(&Fragment) -> Vec3 + Sync + 'a>;

pub(super) fn draw(request: &Request) -> Result<Vec<Piece>, GalleryError> {
    let cell_size = cell_size(request, (1240, 660), (5, 2), 3)?;
    let sphere = Mesh::sphere(1.0, 128);
    let maps = Maps::new();
    let displaced = displaced();
    let truth = normals(&displaced, cell_size, &|f| f.normal);
    let mut cells: Vec<Cell> = ways(&maps)
        .into_iter()
        .map(|(name, how, normal)| {
            let error = mean_angle(&normals(&sphere, cell_size, &normal), &truth);
            Cell {
                image: picture(&sphere, cell_size, &normal),
                lines: lines(name, how, &format!("{error:.1} deg off")),
            }
        })
        .collect();
    cells.push(Cell {
        image: picture(&displaced, cell_size, &|f| f.normal),
        lines: lines("displaced mesh", "real relief:", "a bumpy outline"),
    });
    for (name, how, more, normal) in procedural() {
        cells.push(Cell {
            image: picture(&sphere, cell_size, &normal),
            lines: lines(name, how, more),
        });
    }
    Ok(vec![
        Piece::sheet("", &sheet(&cells, 5))?,
        magnified(cell_size)?,
    ])
}

fn lines(name: &str, how: &str, more: &str) -> Vec<String> {
    [name, how, more].map(str::to_owned).to_vec()
}

/// The golf ball's relief over the sphere's texture.
struct Maps {
    heights: HeightMap,
    normals: Texture,
}

impl Maps {
    fn new() -> Self {
        let relief = golf_ball();
        let heights =
            HeightMap::from_fn(TEXELS.0, TEXELS.1, |uv| relief.sample(on_sphere(uv)).height);
        let heights = heights.expect("a map of this size");
        let texel = |i: usize| {
            let at = Vec2::new((i % TEXELS.0) as f32, (i / TEXELS.0) as f32) + 0.5;
            let uv = at / Vec2::new(TEXELS.0 as f32, TEXELS.1 as f32);
            // Baked for the sphere: a unit of u is shorter towards the poles.
            let extent = Vec2::new(TAU * (PI * uv.y).sin(), PI);
            let [r, g, b] = encode_normal(heights.normal(uv, extent));
            [r, g, b, 1.0]
        };
        let texels = (0..TEXELS.0 * TEXELS.1).map(texel).collect();
        let image = Image::from_pixels(TEXELS.0, TEXELS.1, texels).expect("as many texels");
        let options = TextureOptions::default().with_alpha(Alpha::Independent);
        let normals = Texture::new(&image, &options).expect("a texture of this size");
        Self { heights, normals }
    }
}

/// The point of the unit sphere with a texture coordinate, as [`Mesh::sphere`] has it.
fn on_sphere(uv: Vec2) -> Vec3 {
    let (sin, cos) = (PI * uv.y).sin_cos();
    let (s, c) = (TAU * uv.x).sin_cos();
    Vec3::new(-s * sin, cos, -c * sin)
}

/// The ways to bump the sphere with the golf ball's relief.
fn ways(maps: &Maps) -> Vec<(&'static str, &'static str, Normal<'_>)> {
    let blinn = |f: &Fragment| {
        let slopes = maps.heights.sample(f.texcoord).slopes;
        let by_texcoord = f.d_position_by_texcoord();
        by_texcoord.map_or(f.normal, |[pu, pv]| {
            blinn_normal(f.normal, pu, pv, slopes.to_array())
        })
    };
    let sampler = Sampler::default();
    let mapped = move |f: &Fragment| {
        let [dx, dy] = f.d_texcoord;
        let texel = sampler.sample_grad(&maps.normals, f.texcoord, dx, dy);
        let m = decode_normal([texel.x, texel.y, texel.z]);
        let bitangent = tangents::bitangent(f.normal, f.tangent);
        SurfaceGradient::from_tangent_space(m, f.tangent.truncate(), bitangent).apply(f.normal)
    };
    let relief = golf_ball();
    vec![
        ("smooth", "no bumps:", Box::new(|f: &Fragment| f.normal)),
        ("height map", "Blinn's normals:", Box::new(blinn)),
        ("normal map", "MikkTSpace tangents:", Box::new(mapped)),
        (
            "surface gradient",
            "of a function of space:",
            Box::new(move |f: &Fragment| of_volume(&relief, f)),
        ),
    ]
}

/// The normal bumped by a function of space.
fn of_volume(relief: &impl Relief, f: &Fragment) -> Vec3 {
    let gradient = relief.sample(f.position).gradient;
    SurfaceGradient::from_volume(f.normal, gradient).apply(f.normal)
}

/// Other reliefs, with two lines about each.
fn procedural() -> Vec<(&'static str, &'static str, &'static str, Normal<'static>)> {
    let peel = OrangePeel::default().with_frequency(14.0).with_depth(0.018);
    let ripples = Ripples::default()
        .with_center(Vec3::new(-0.35, 0.3, 0.9))
        .with_wavelength(0.16)
        .with_amplitude(0.012);
    let noise = Noise::default().with_frequency(3.0).with_amplitude(0.09);
    let fine = Noise::default()
        .with_frequency(14.0)
        .with_octaves(2)
        .with_amplitude(0.012);
    let bricks = Bricks::default()
        .with_size(Vec2::new(1.0 / 14.0, 1.0 / 14.0))
        .with_joint(0.008, 0.008)
        .with_height(0.05);
    let of_texture = move |f: &Fragment| {
        let slopes = bricks.sample(f.texcoord.extend(0.0)).gradient.truncate();
        SurfaceGradient::from_texture(f.normal, f.d_position, f.d_texcoord, slopes).apply(f.normal)
    };
    let sum = move |f: &Fragment| {
        let of = |relief: &dyn Relief| {
            SurfaceGradient::from_volume(f.normal, relief.sample(f.position).gradient)
        };
        (of(&ripples) + of(&fine)).apply(f.normal)
    };
    vec![
        (
            "orange peel",
            "pits in cells",
            "of space",
            Box::new(move |f: &Fragment| of_volume(&peel, f)),
        ),
        (
            "ripples",
            "rings around",
            "a point",
            Box::new(move |f: &Fragment| of_volume(&ripples, f)),
        ),
        (
            "bricks",
            "over the texture,",
            "no tangents",
            Box::new(of_texture),
        ),
        (
            "noise",
            "four octaves of",
            "gradient noise",
            Box::new(move |f: &Fragment| of_volume(&noise, f)),
        ),
        ("sum", "gradients add:", "ripples + noise", Box::new(sum)),
    ]
}

/// The sphere with the relief in its vertices.
fn displaced() -> Mesh {
    let relief = golf_ball();
    Mesh::sphere(1.0, 384).displaced(|vertex: &Vertex| relief.sample(vertex.position).height)
}

fn camera() -> Camera {
    Camera::new(Vec3::new(0.0, 0.6, 5.2), Vec3::ZERO, 24.0)
}

fn picture(
    mesh: &Mesh,
    size: (usize, usize),
    normal: &(impl Fn(&Fragment) -> Vec3 + Sync),
) -> Image<Rgb> {
    let sampling = Sampling { size, per_side: 2 };
    draw_stage(&camera(), sampling, &[mesh], BACKGROUND, |f| {
        shaded(COLOR, normal(f), f.view)
    })
}

/// Normals by the middle of each pixel, zero where nothing is seen.
fn normals(
    mesh: &Mesh,
    size: (usize, usize),
    normal: &(impl Fn(&Fragment) -> Vec3 + Sync),
) -> Vec<Vec3> {
    let sampling = Sampling { size, per_side: 1 };
    let image = draw_stage(&camera(), sampling, &[mesh], Rgb::BLACK, |f| {
        Rgb::from(normal(f).to_array())
    });
    image
        .pixels()
        .iter()
        .map(|c| Vec3::from(c.to_array()))
        .collect()
}

/// Mean angle in degrees between two pictures of normals, where both have one.
fn mean_angle(a: &[Vec3], b: &[Vec3]) -> f64 {
    let both = a
        .iter()
        .zip(b)
        .filter(|(a, b)| a.length() * b.length() > 0.5);
    let (sum, count) = both.fold((0.0, 0_u32), |(sum, count), (a, b)| {
        (sum + f64::from(a.angle_between(*b)).to_degrees(), count + 1)
    });
    sum / f64::from(count.max(1))
}

/// Eight texels of height across a picture: slopes of the bilinear height and of the B-spline.
fn magnified(cell: (usize, usize)) -> Result<Piece, GalleryError> {
    let noise = Noise::default()
        .with_frequency(3.7)
        .with_octaves(1)
        .with_amplitude(0.3);
    let heights = HeightMap::from_fn(16, 16, |uv| noise.sample((uv * 2.0).extend(0.4)).height);
    let heights = heights.expect("a small map");
    let plane = Mesh::plane(1.0, 1);
    let camera = Camera::new(Vec3::new(0.0, 2.0, 0.9), Vec3::ZERO, 20.0);
    let picture = |slopes: &(dyn Fn(Vec2) -> Vec2 + Sync)| {
        let sampling = Sampling {
            size: cell,
            per_side: 2,
        };
        draw_stage(&camera, sampling, &[&plane], BACKGROUND, |f| {
            let slopes = slopes(f.texcoord * 0.5) * 0.5;
            let gradient =
                SurfaceGradient::from_texture(f.normal, f.d_position, f.d_texcoord, slopes);
            shaded(COLOR, gradient.apply(f.normal), f.view)
        })
    };
    let cells = [
        Cell {
            image: picture(&|uv| heights.bilinear_slopes(uv)),
            lines: lines("bilinear heights", "facets at each texel", ""),
        },
        Cell {
            image: picture(&|uv| heights.sample(uv).slopes),
            lines: lines("cubic B-spline", "smooth shading", ""),
        },
    ];
    Piece::sheet("-magnified", &sheet(&cells, 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_shows_the_normals_of_the_real_relief() {
        let size = (80, 80);
        let sphere = Mesh::sphere(1.0, 128);
        let truth = normals(&displaced(), size, &|f| f.normal);
        let maps = Maps::new();
        let errors: Vec<f64> = ways(&maps)
            .iter()
            .map(|(_, _, normal)| mean_angle(&normals(&sphere, size, normal), &truth))
            .collect();
        let smooth = errors[0];
        assert!(smooth > 5.0, "the relief tilts normals by {smooth} degrees");
        for error in &errors[1..] {
            // What is left is parallax: the relief moves what is seen of it by up to its depth.
            assert!(*error < 0.35 * smooth, "{errors:?}");
        }
    }

    #[test]
    fn outlines_are_smooth_unless_displaced() {
        let size = (160, 160);
        let covered = |mesh: &Mesh| {
            let normals = normals(mesh, size, &|f| f.normal);
            normals.iter().map(|n| *n != Vec3::ZERO).collect::<Vec<_>>()
        };
        let sphere = covered(&Mesh::sphere(1.0, 512));
        let real = covered(&displaced());
        let differing = sphere.iter().zip(&real).filter(|(a, b)| a != b).count();
        assert!(
            differing > 30,
            "dimples cut {differing} pixels out of the outline"
        );
    }

    #[test]
    fn sheet_is_drawn_in_the_size_asked_for() {
        let request = Request {
            size: Some((200, 260)),
            ..Request::default()
        };
        let pieces = draw(&request).expect("sheets");
        let suffixes: Vec<&str> = pieces.iter().map(|p| p.suffix.as_str()).collect();
        assert_eq!(suffixes, [".png", "-magnified.png"]);
    }
}
