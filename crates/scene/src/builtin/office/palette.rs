//! Materials of the office.

use super::super::build::SceneBuilder;
use super::paint;
use crate::{Material, TextureSlot, Wrap};
use glam::{Affine2, Vec2};
use hemicube_raster::Rgb;

/// Materials by what they are for.
pub(super) struct Palette {
    pub floor: usize,
    pub plaster: usize,
    pub accent: usize,
    pub ceiling: usize,
    pub white: usize,
    pub oak: usize,
    pub walnut: usize,
    pub steel: usize,
    pub brass: usize,
    pub black: usize,
    pub rug: usize,
    pub rug_edge: usize,
    pub linen: usize,
    pub sofa: usize,
    pub leather: usize,
    pub mustard: usize,
    pub teal: usize,
    pub felt: usize,
    pub curtain: usize,
    pub paper: usize,
    pub clay: usize,
    pub ceramic: usize,
    pub soil: usize,
    pub leaf: usize,
    pub blade: usize,
    pub bark: usize,
    pub hills: usize,
    pub arches: usize,
    pub fields: usize,
    pub books: Vec<usize>,
    pub daylight: usize,
    pub panel: usize,
    pub cove: usize,
    pub globe: usize,
    pub shade: usize,
    pub bulb: usize,
    pub screen: usize,
}

impl Palette {
    pub(super) fn new(b: &mut SceneBuilder) -> Self {
        let planks = b.texture("planks", Wrap::Repeat, paint::planks());
        let oak = paint::wood(Rgb::new(0.52, 0.35, 0.20), Rgb::new(0.36, 0.215, 0.11), 200);
        let oak = b.texture("oak", Wrap::Repeat, oak);
        let walnut = paint::wood(
            Rgb::new(0.235, 0.125, 0.068),
            Rgb::new(0.115, 0.056, 0.031),
            300,
        );
        let walnut = b.texture("walnut", Wrap::Repeat, walnut);
        let plaster = b.texture("plaster", Wrap::Repeat, paint::plaster());
        let cloth = b.texture("cloth", Wrap::Repeat, paint::cloth());
        let rug = b.texture("rug", Wrap::ClampToEdge, paint::rug());
        let hills = b.texture("hills", Wrap::ClampToEdge, paint::hills());
        let arches = b.texture("arches", Wrap::ClampToEdge, paint::arches());
        let fields = b.texture("fields", Wrap::ClampToEdge, paint::fields());
        let spine = b.texture("spine", Wrap::ClampToEdge, paint::spine());
        let outdoors = b.texture("outdoors", Wrap::ClampToEdge, paint::outdoors());
        let screen = b.texture("screen", Wrap::ClampToEdge, paint::screen());

        let (wall, weave, unit) = (Vec2::splat(1.6), Vec2::splat(0.24), Vec2::ONE);
        Self {
            floor: b.textured("planks", planks, Vec2::new(2.4, 1.8)),
            plaster: tinted(b, "plaster", plaster, wall, Rgb::new(0.80, 0.765, 0.70)),
            accent: tinted(b, "accent", plaster, wall, Rgb::new(0.125, 0.235, 0.225)),
            ceiling: b.diffuse("ceiling", 0.85, 0.845, 0.83),
            white: b.diffuse("white", 0.78, 0.765, 0.73),
            oak: b.textured("oak", oak, Vec2::new(1.8, 0.9)),
            walnut: b.textured("walnut", walnut, Vec2::new(1.8, 0.9)),
            steel: b.diffuse("steel", 0.46, 0.46, 0.45),
            brass: b.diffuse("brass", 0.56, 0.38, 0.15),
            black: b.diffuse("black", 0.035, 0.035, 0.037),
            rug: b.textured("rug", rug, unit),
            rug_edge: b.diffuse("rug-edge", 0.04, 0.055, 0.10),
            linen: tinted(b, "linen", cloth, weave, Rgb::new(0.78, 0.72, 0.62)),
            sofa: tinted(b, "sofa", cloth, weave, Rgb::new(0.50, 0.475, 0.43)),
            leather: b.diffuse("leather", 0.40, 0.165, 0.065),
            mustard: tinted(b, "mustard", cloth, weave, Rgb::new(0.74, 0.42, 0.075)),
            teal: tinted(b, "teal", cloth, weave, Rgb::new(0.09, 0.25, 0.26)),
            felt: tinted(b, "felt", cloth, weave, Rgb::new(0.13, 0.14, 0.16)),
            curtain: double_sided(b, "curtain", Rgb::new(0.72, 0.69, 0.62)),
            paper: b.diffuse("paper", 0.76, 0.73, 0.65),
            clay: b.diffuse("clay", 0.52, 0.235, 0.13),
            ceramic: b.diffuse("ceramic", 0.74, 0.71, 0.65),
            soil: b.diffuse("soil", 0.10, 0.065, 0.04),
            leaf: double_sided(b, "leaf", Rgb::new(0.085, 0.22, 0.055)),
            blade: double_sided(b, "blade", Rgb::new(0.16, 0.29, 0.12)),
            bark: b.diffuse("bark", 0.21, 0.14, 0.085),
            hills: b.textured("hills", hills, unit),
            arches: b.textured("arches", arches, unit),
            fields: b.textured("fields", fields, unit),
            books: books(b, spine),
            daylight: pictured_light(b, "daylight", outdoors, Rgb::new(1300.0, 1540.0, 1880.0)),
            panel: light(b, "panel", Rgb::new(3700.0, 3400.0, 2950.0)),
            cove: light(b, "cove", Rgb::new(6400.0, 4400.0, 2400.0)),
            globe: light(b, "globe", Rgb::new(3300.0, 2350.0, 1350.0)),
            shade: light(b, "lamp-shade", Rgb::new(1500.0, 960.0, 460.0)),
            bulb: light(b, "bulb", Rgb::new(15000.0, 10200.0, 5300.0)),
            screen: pictured_light(b, "screen", screen, Rgb::new(330.0, 345.0, 370.0)),
        }
    }
}

/// A texture in shades of white, tinted.
fn tinted(b: &mut SceneBuilder, name: &str, texture: usize, tile: Vec2, tint: Rgb) -> usize {
    let transform = Affine2::from_scale(tile.recip());
    let slot = TextureSlot {
        transform,
        ..TextureSlot::new(texture)
    };
    b.material(Material {
        base_color_texture: Some(slot),
        ..Material::diffuse(name, tint)
    })
}

fn double_sided(b: &mut SceneBuilder, name: &str, reflectance: Rgb) -> usize {
    b.material(Material {
        double_sided: true,
        ..Material::diffuse(name, reflectance)
    })
}

/// Something white that glows.
fn light(b: &mut SceneBuilder, name: &str, luminance: Rgb) -> usize {
    b.material(Material::diffuse(name, Rgb::splat(0.6)).with_emission(luminance))
}

/// Something dark that shows a picture.
fn pictured_light(b: &mut SceneBuilder, name: &str, picture: usize, white: Rgb) -> usize {
    let material = Material::diffuse(name, Rgb::splat(0.05)).with_emission(white);
    b.material(Material {
        emission_texture: Some(TextureSlot::new(picture)),
        ..material
    })
}

/// Cloth and cardboard covers.
fn books(b: &mut SceneBuilder, spine: usize) -> Vec<usize> {
    let covers = [
        ("navy", Rgb::new(0.045, 0.075, 0.17)),
        ("brick", Rgb::new(0.40, 0.10, 0.06)),
        ("forest", Rgb::new(0.07, 0.17, 0.10)),
        ("cream", Rgb::new(0.68, 0.61, 0.47)),
        ("ochre", Rgb::new(0.60, 0.36, 0.08)),
        ("grey", Rgb::new(0.33, 0.34, 0.35)),
        ("plum", Rgb::new(0.15, 0.05, 0.07)),
        ("sky", Rgb::new(0.24, 0.40, 0.50)),
        ("white", Rgb::new(0.74, 0.73, 0.70)),
    ];
    covers
        .iter()
        .map(|(name, cover)| tinted(b, &format!("book-{name}"), spine, Vec2::ONE, *cover))
        .collect()
}
