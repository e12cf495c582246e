//! Bump mapping: relief by tilted normals alone, and the light that shows it.

mod filtering;
mod mapping;
mod parallax;
mod reflection;

use crate::Exhibit;
use glam::Vec3;
use hemicube_raster::Rgb;
use hemicube_raster::bump::facing;
use hemicube_raster::reflection::BlinnPhong;

pub(crate) const EXHIBITS: &[Exhibit] = &[
    Exhibit {
        name: "bump-mapping",
        about: "one relief as height map, normal map, function and really displaced mesh; procedural reliefs; magnified heights",
        needs: &[],
        draw: mapping::draw,
    },
    Exhibit {
        name: "bump-filtering",
        about: "a glittering plane to the horizon: bumps without a filter, as mean normals, by Toksvig and by LEAN, beside the truth",
        needs: &[],
        draw: filtering::draw,
    },
    Exhibit {
        name: "reflection-models",
        about: "Phong and Blinn-Phong by exponent, as classic lobes and with their energy kept",
        needs: &[],
        draw: reflection::draw,
    },
    Exhibit {
        name: "parallax-textures",
        about: "a colour, depth and normal texture of one surface, from flat to parallax",
        needs: &["color.png", "depth.png", "normal.png"],
        draw: parallax::draw,
    },
];

const BACKGROUND: Rgb = Rgb::splat(0.9);

/// Direction to the main light: from the upper left.
fn main_light() -> Vec3 {
    Vec3::new(-0.55, 0.65, 0.6).normalize()
}

/// A surface of a colour, a little glossy, in the main light, a weak one from the right, and some from everywhere.
fn shaded(color: Rgb, normal: Vec3, view: Vec3) -> Rgb {
    let normal = facing(normal, view);
    let lights = [(main_light(), 0.75), (Vec3::new(0.9, 0.1, 0.4), 0.12)];
    let gloss = BlinnPhong::new(50.0);
    let mut sum = color * 0.08;
    for (light, strength) in lights {
        let light = light.normalize();
        let cosine = normal.dot(light).max(0.0);
        sum += color * (cosine * strength);
        sum += Rgb::splat(0.35 * strength * gloss.lobe(normal, light, view));
    }
    sum.map(|c| c.min(1.0))
}
