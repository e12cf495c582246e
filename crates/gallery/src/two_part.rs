//! Two-part mapping: every intermediate surface with every way from it to the object.

mod card;
mod distortion;
mod mapping;
mod rays;

use crate::Exhibit;
use crate::stage::{Camera, Fragment};
use glam::Vec3;
use hemicube_raster::two_part::{OMap, SMap, SphereLayout, SurfacePoint, TwoPart};

pub(crate) const EXHIBITS: &[Exhibit] = &[
    Exhibit {
        name: "two-part-mapping",
        about: "plane, cylinder, sphere and box as intermediate surfaces, each by reflected ray, normal, centroid and its own normal",
        needs: &[],
        draw: mapping::draw,
    },
    Exhibit {
        name: "two-part-distortion",
        about: "how much each two-part mapping stretches its texture: area and anisotropy as colours and as a table",
        needs: &[],
        draw: distortion::draw,
    },
    Exhibit {
        name: "two-part-rays",
        about: "the intermediate surface around an object and the lines along which it takes its texture, in section",
        needs: &[],
        draw: rays::draw,
    },
];

/// The intermediate surfaces around a vase of height 2, with their names.
const S_MAPS: [(&str, SMap); 5] = [
    (
        "plane",
        SMap::Plane {
            distance: 1.3,
            width: 2.2,
            height: 2.2,
        },
    ),
    ("cylinder", SMap::cylinder(1.1, 2.4)),
    ("sphere, lat-long", SMap::sphere(1.4)),
    (
        "sphere, stereographic",
        SMap::Sphere {
            radius: 1.4,
            layout: SphereLayout::HEMISPHERE,
        },
    ),
    ("box", SMap::cube(1.2)),
];

/// The ways from there to the object, with their names.
const O_MAPS: [(&str, OMap); 4] = [
    ("reflected ray", OMap::ReflectedRay),
    ("object normal", OMap::ObjectNormal),
    ("centroid", OMap::Centroid(Vec3::ZERO)),
    ("intermediate normal", OMap::IntermediateNormal),
];

/// All pairs, row by row of the intermediate surfaces, with their names.
fn pairs() -> impl Iterator<Item = ([&'static str; 2], TwoPart)> {
    S_MAPS
        .into_iter()
        .flat_map(|(s_name, s)| O_MAPS.map(|(o_name, o)| ([s_name, o_name], TwoPart::new(s, o))))
}

/// From where the vase is seen.
fn camera() -> Camera {
    Camera::new(Vec3::new(1.3, 1.5, 4.3), Vec3::new(0.0, -0.05, 0.0), 30.0)
}

/// What a sample sees, as a mapping wants it.
fn surface_point(fragment: &Fragment, eye: Vec3) -> SurfacePoint {
    SurfacePoint {
        point: fragment.position,
        normal: fragment.normal,
        view: eye - fragment.position,
        d_point: fragment.d_position,
        d_normal: fragment.d_normal,
        d_view: fragment.d_position.map(|d| -d),
    }
}
