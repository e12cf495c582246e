//! A bowl of fruit on a chessboard of wood: what constructive solid geometry is shown with.
//!
//! Lengths are in decimetres, the table is the plane y = 0.

use core::f64::consts::{FRAC_PI_2, PI, TAU};
use glam::DVec3;
use hemicube_csg::{Camera, CsgError, Light, Material, Pattern, Scene, Sky, Solid};
use hemicube_raster::Rgb;
use hemicube_raster::color::linear_from_srgb;

type Made = Result<Solid, CsgError>;

/// The bowl, its fruit, and the light of a window and a lamp.
pub fn scene() -> Result<Scene, CsgError> {
    let mut solids = vec![table()?, bowl()?];
    solids.extend(in_the_bowl()?);
    solids.extend(on_the_table()?);
    let window = Light::distant(DVec3::new(-0.75, 0.85, 0.3), Rgb::new(2.7, 2.55, 2.3))?;
    let lamp = Light::point(DVec3::new(6.0, 6.5, 3.0), Rgb::new(17.0, 15.0, 12.5))?;
    let sky = Sky::new(
        Rgb::new(0.22, 0.25, 0.31),
        Rgb::new(0.17, 0.165, 0.165),
        Rgb::new(0.07, 0.05, 0.04),
    )?;
    Ok(Scene::new(solids).with_lights([window, lamp]).with_sky(sky))
}

/// From the edge of the table, a little above the bowl.
pub fn camera() -> Result<Camera, CsgError> {
    Camera::new(DVec3::new(0.6, 4.4, 9.2), DVec3::new(0.25, 1.05, 0.0), 30.0)
}

/// A colour as one reads it off a screen.
fn srgb(code: u32) -> Rgb {
    let band = |shift: u32| {
        #[expect(clippy::cast_possible_truncation, reason = "eight bits")]
        let byte = (code >> shift) as u8;
        linear_from_srgb(f32::from(byte) / 255.0)
    };
    Rgb::new(band(16), band(8), band(0))
}

fn plain(code: u32) -> Result<Pattern, CsgError> {
    Pattern::plain(srgb(code))
}

/// A skin with a coat of wax.
fn waxed(pattern: Pattern) -> Result<Material, CsgError> {
    Material::matte(pattern)
        .with_highlight(0.06, 60.0)?
        .with_coat(Rgb::splat(0.025))
}

fn at(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Squares of two woods, varnished.
fn table() -> Made {
    let light = Pattern::wood(srgb(0xd9b884), srgb(0xb8874e), 0.23)?;
    let dark = Pattern::wood(srgb(0x7a4a28), srgb(0x4e2b16), 0.19)?;
    let board = Material::matte(Pattern::checker(1.0, light, dark)?)
        .with_highlight(0.03, 120.0)?
        .with_coat(Rgb::splat(0.03))?;
    Ok(Solid::half_space(DVec3::ZERO, DVec3::Y)?.with_material(board))
}

/// A glazed shell with a foot: a ball without a smaller ball and without its upper half, on a ring.
fn bowl() -> Made {
    let centre = at(0.0, 2.32, 0.0);
    let shell = Solid::sphere(centre, 2.1)? - Solid::sphere(centre, 2.0)?;
    let rim = Solid::torus(at(0.0, 1.5, 0.0), DVec3::Y, 1.89, 0.07)?;
    let below = Solid::half_space(at(0.0, 1.5, 0.0), DVec3::Y)?;
    let foot = Solid::frustum(DVec3::ZERO, 1.0, at(0.0, 0.4, 0.0), 0.75)?
        - Solid::sphere(at(0.0, -1.1, 0.0), 1.35)?
        - Solid::sphere(centre, 2.05)?;
    let glaze = Pattern::stripes(at(0.0, 0.5, 0.0), plain(0x1d3f6e)?, plain(0x23578a)?)?;
    let glaze = Material::matte(glaze)
        .with_highlight(0.08, 300.0)?
        .with_coat(Rgb::splat(0.16))?;
    Ok(((shell & below) | rim | foot).with_material(glaze))
}

fn in_the_bowl() -> Result<Vec<Solid>, CsgError> {
    let red = apple([0xb01a1c, 0xd8a030])?
        .turned(at(0.3, 0.0, 1.0), -0.25)?
        .moved(at(-0.78, 1.5, 0.5))?;
    let green = apple([0x8ab02c, 0xc8c050])?
        .turned(at(1.0, 0.0, 0.2), -0.5)?
        .moved(at(-0.35, 1.62, -0.8))?;
    let orange = |place, turn| orange()?.turned(at(1.0, 0.4, 0.2), turn)?.moved(place);
    let banana = |turn: f64, lean: f64, place| {
        banana()?
            .turned(DVec3::X, lean)?
            .turned(DVec3::Y, turn)?
            .moved(place)
    };
    Ok(vec![
        red,
        green,
        orange(at(0.5, 1.32, 0.72), 0.4)?,
        orange(at(0.85, 1.5, -0.42), 1.9)?,
        pear()?
            .turned(at(0.0, 0.0, 1.0), -0.35)?
            .moved(at(0.28, 1.75, -0.1))?,
        banana(-0.25, -0.3, at(0.35, 2.5, -0.85))?,
        banana(-0.1, -0.5, at(0.4, 2.42, -1.15))?,
    ])
}

fn on_the_table() -> Result<Vec<Solid>, CsgError> {
    Ok(vec![
        grapes()?.moved(at(-1.72, 0.0, 1.75))?,
        half_orange()?
            .turned(at(1.0, 0.0, 0.0), 0.95)?
            .turned(DVec3::Y, -0.3)?
            .moved(at(2.3, 0.62, 1.9))?,
        lemon()?
            .turned(DVec3::Y, 0.6)?
            .moved(at(2.75, 0.47, 0.35))?,
    ])
}

/// A torus whose tube is wider than its ring, narrower below, with a stalk in the dimple. Its middle is the origin.
fn apple([skin, cheek]: [u32; 2]) -> Made {
    let body = Solid::torus(DVec3::ZERO, DVec3::Y, 0.36, 0.44)?.scaled(at(1.0, 1.12, 1.0))?;
    let ground = Pattern::gradient(
        at(0.1, 0.62, -0.3),
        srgb(cheek),
        at(0.0, -0.05, 0.1),
        srgb(skin),
    )?;
    let flesh = body.with_material(waxed(ground)?);
    let stalk = Solid::torus(at(0.3, 0.3, 0.0), DVec3::Z, 0.3, 0.028)?
        & Solid::half_space(at(0.12, 0.0, 0.0), DVec3::X)?
        & Solid::half_space(at(0.0, 0.25, 0.0), DVec3::NEG_Y)?;
    let wood = Material::matte(plain(0x4a321c)?);
    Ok(flesh | stalk.with_material(wood))
}

/// A ball with pores, and a navel.
fn orange() -> Made {
    let peel = Material::matte(plain(0xf08610)?)
        .with_highlight(0.05, 40.0)?
        .with_coat(Rgb::splat(0.02))?
        .with_bumps(0.007, 0.035)?;
    let navel = Solid::cone(at(0.0, 0.7, 0.0), 0.07, at(0.0, 0.56, 0.0))?;
    let green = Material::matte(plain(0x5a6a20)?);
    Ok(Solid::sphere(DVec3::ZERO, 0.62)?.with_material(peel) - navel.with_material(green))
}

/// Peel, pith and ten segments: balls within balls, and thin walls that stay when the segments are cut out. The cut
/// faces +Y.
fn half_orange() -> Made {
    let ball = |radius| Solid::sphere(DVec3::ZERO, radius);
    let peel = Material::matte(plain(0xf08610)?)
        .with_highlight(0.05, 40.0)?
        .with_bumps(0.007, 0.035)?;
    let walls = (0..5).map(|i| {
        let wall = Solid::cuboid(at(-0.6, -0.7, -0.009), at(0.6, 0.7, 0.009))?;
        wall.turned(DVec3::Y, PI / 5.0 * f64::from(i))
    });
    let core = Solid::cylinder(at(0.0, -0.7, 0.0), at(0.0, 0.7, 0.0), 0.05)?;
    let walls = Solid::union(walls.collect::<Result<Vec<_>, _>>()?) | core;
    let juice = Pattern::speckles(srgb(0xf48c14), srgb(0xfbb848), 0.06, 0.35)?;
    let segments = ball(0.54)? - walls;
    let pith = ball(0.575)?.with_material(Material::matte(plain(0xf6e6c0)?));
    let wet = Material::matte(juice)
        .with_highlight(0.08, 90.0)?
        .with_bumps(0.006, 0.05)?;
    let shell = ball(0.62)?.with_material(peel) - pith.clone();
    // Segments lie a little deeper than the walls between them.
    let lower = Solid::half_space(at(0.0, -0.012, 0.0), DVec3::Y)?;
    let cut = Solid::half_space(DVec3::ZERO, DVec3::Y)?;
    let whole = shell | (pith - segments.clone()) | (segments & lower).with_material(wet);
    let rind = Material::matte(plain(0xf6e6c0)?);
    Ok(whole & cut.with_material(rind))
}

/// An ellipsoid with a nipple at each end.
fn lemon() -> Made {
    let body = Solid::sphere(DVec3::ZERO, 0.46)?.scaled(at(1.3, 1.0, 1.0))?;
    let tip = |side: f64| {
        let neck = Solid::frustum(
            at(0.48 * side, 0.0, 0.0),
            0.24,
            at(0.68 * side, 0.0, 0.0),
            0.09,
        )?;
        Ok(neck | Solid::sphere(at(0.67 * side, 0.0, 0.0), 0.098)?)
    };
    let peel = Material::matte(plain(0xf2cf1c)?)
        .with_highlight(0.06, 50.0)?
        .with_coat(Rgb::splat(0.02))?
        .with_bumps(0.006, 0.05)?;
    Ok((body | tip(-1.0)? | tip(1.0)?).with_material(peel))
}

/// Two balls with the cone that touches both, so that the skin is smooth. Upright, its belly around the origin.
fn pear() -> Made {
    let (belly, neck, height): (f64, f64, f64) = (0.62, 0.27, 0.95);
    // The cone touches both balls at this sine above their equators.
    let sine = (belly - neck) / height;
    let cosine = (1.0 - sine * sine).sqrt();
    let touch = |radius: f64, base: f64| (at(0.0, base + radius * sine, 0.0), radius * cosine);
    let ((low, wide), (high, narrow)) = (touch(belly, 0.0), touch(neck, height));
    let body = Solid::sphere(DVec3::ZERO, belly)?
        | Solid::frustum(low, wide, high, narrow)?
        | Solid::sphere(at(0.0, height, 0.0), neck)?;
    let skin = Pattern::speckles(srgb(0xb9b83a), srgb(0x8c6a24), 0.11, 0.16)?;
    let stalk = Solid::frustum(
        at(0.0, height + neck - 0.03, 0.0),
        0.03,
        at(0.09, height + neck + 0.28, 0.0),
        0.045,
    )?;
    let wood = Material::matte(plain(0x4a321c)?);
    Ok(body.with_material(waxed(skin)?) | stalk.with_material(wood))
}

/// A piece of a ring between two planes, with a tapering end and a tip on both sides. It lies along x, bent downwards.
fn banana() -> Made {
    let (bend, thickness, half_angle): (f64, f64, f64) = (1.25, 0.2, 0.62);
    let ring = Solid::torus(DVec3::ZERO, DVec3::Z, bend, thickness)?;
    let peel = Material::matte(Pattern::speckles(
        srgb(0xf0c828),
        srgb(0x6a4416),
        0.09,
        0.06,
    )?)
    .with_highlight(0.05, 30.0)?;
    let side = |sign: f64| at(sign * half_angle.sin(), half_angle.cos(), 0.0);
    let along = |sign: f64| at(sign * half_angle.cos(), -half_angle.sin(), 0.0);
    let within = Solid::half_space(side(1.0) * bend, along(1.0))?
        & Solid::half_space(side(-1.0) * bend, along(-1.0))?;
    let end = |sign: f64, length: f64| {
        let (from, towards) = (side(sign) * bend, along(sign) - side(sign) * 0.12);
        let neck = from + towards * length;
        let taper = Solid::frustum(from - towards * 0.02, thickness, neck, 0.07)?;
        let tip = Solid::frustum(neck - towards * 0.01, 0.068, neck + towards * 0.1, 0.055)?;
        let brown = Material::matte(plain(0x4e3a18)?);
        Ok::<_, CsgError>((taper, tip.with_material(brown)))
    };
    let ((left, left_tip), (right, right_tip)) = (end(-1.0, 0.3)?, end(1.0, 0.42)?);
    let body = ((ring & within) | left | right).with_material(peel);
    (body | left_tip | right_tip).moved(at(0.0, -bend, 0.0))
}

/// A heap of balls with a stalk, standing on the table.
fn grapes() -> Made {
    let skin = Pattern::gradient(
        at(0.0, 0.0, 0.0),
        srgb(0x3a143c),
        at(0.6, 0.9, 0.4),
        srgb(0x6c2a58),
    )?;
    let material = Material::matte(skin)
        .with_highlight(0.08, 70.0)?
        .with_coat(Rgb::splat(0.03))?;
    // Layers of rings, each higher one smaller and turned by half a step.
    let layers = [
        (9, 0.62, 0.19),
        (8, 0.52, 0.47),
        (6, 0.36, 0.74),
        (3, 0.19, 0.98),
    ];
    let mut berries = Vec::new();
    for (layer, &(count, radius, height)) in (0..).zip(&layers) {
        for i in 0..count {
            let angle = (f64::from(i) + 0.5 * f64::from(layer)) / f64::from(count) * TAU;
            let place = at(1.25 * radius * angle.cos(), height, radius * angle.sin());
            berries.push(Solid::sphere(place, 0.19)?);
        }
    }
    berries.push(Solid::sphere(at(0.0, 0.19, 0.0), 0.19)?);
    let stalk = Solid::torus(at(0.0, 0.95, 0.0), DVec3::Z, 0.5, 0.03)?
        & Solid::half_space(at(0.0, 0.95, 0.0), DVec3::NEG_Y)?
        & Solid::half_space(DVec3::ZERO, at(-1.0, 0.0, 0.0).rotate_z(0.4))?;
    let green = Material::matte(plain(0x6a7830)?);
    let turned = Solid::union(berries).with_material(material);
    (turned | stalk.moved(at(-0.5, 0.1, 0.0))?.with_material(green))
        .turned(DVec3::Y, FRAC_PI_2 * 0.3)
}
