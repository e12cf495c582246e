//! Cameras and the lights of `KHR_lights_punctual`, as their node places them.

use super::extension;
use super::material::not_negative;
use super::name_or;
use crate::open::one_line;
use crate::{Camera, ImportReport, Light, LightKind, Projection};
use core::f32::consts::{FRAC_PI_2, PI};
use glam::{DAffine3, DVec3, Vec3};
use gltf::json;
use gltf::json::validation::Checked;
use hemicube_raster::Rgb;
use serde::Deserialize;
use serde_json::Value;

/// A light on a node; `None`, with a warning, if it makes no sense.
pub fn light(
    from: &Value,
    index: usize,
    node: &str,
    world_from_node: &DAffine3,
    report: &mut ImportReport,
) -> Option<Light> {
    let from = match extension::Light::deserialize(from) {
        Ok(light) => light,
        Err(error) => {
            let what = one_line(&error.to_string());
            report.warn(
                format!("light {index}"),
                format!("it is damaged ({what}); left out"),
            );
            return None;
        }
    };
    let name = name_or(from.name.as_ref(), "light", index);
    let place = format!("light '{name}' on node '{node}'");
    let light = not_negative(
        Rgb::from(from.color) * from.intensity,
        "its intensity",
        &place,
        report,
    );
    let position = world_from_node.translation.as_vec3();
    let direction = direction(world_from_node, DVec3::NEG_Z);
    let kind = match (from.kind.as_str(), direction) {
        ("point", _) => LightKind::Point {
            position,
            intensity: light,
        },
        ("directional", Some(direction)) => LightKind::Directional {
            direction,
            irradiance: light,
        },
        ("spot", Some(direction)) => {
            let (inner_angle, outer_angle) = cone(&from.spot, &place, report);
            LightKind::Spot {
                position,
                direction,
                intensity: light,
                inner_angle,
                outer_angle,
            }
        }
        ("directional" | "spot", None) => {
            report.warn(
                place,
                "its node's transform leaves it no direction; left out",
            );
            return None;
        }
        (other, _) => {
            let other: String = one_line(other).chars().take(60).collect();
            report.warn(
                place,
                format!("type '{other}' is none of KHR_lights_punctual; left out"),
            );
            return None;
        }
    };
    if !position.is_finite() {
        report.warn(place, "its position is not finite; left out");
        return None;
    }
    Some(Light { name, kind })
}

/// Inner and outer angle with 0 <= inner < outer <= pi/2, as the extension demands.
fn cone(spot: &extension::Spot, place: &str, report: &mut ImportReport) -> (f32, f32) {
    let (inner, outer) = (spot.inner_cone_angle, spot.outer_cone_angle);
    // The default outer angle is rounded up in some files, so pi/2 is not taken to the last digit.
    if inner >= 0.0 && inner < outer && outer <= FRAC_PI_2 + 1e-4 {
        return (inner, outer.min(FRAC_PI_2));
    }
    let mended_outer = if outer > 0.0 {
        outer.min(FRAC_PI_2)
    } else {
        FRAC_PI_2 / 2.0
    };
    let mended_inner = if inner > 0.0 {
        inner.min(mended_outer * 0.999)
    } else {
        0.0
    };
    report.warn(
        place,
        format!("cone angles {inner} and {outer} rad are not 0 <= inner < outer <= pi/2; taken as {mended_inner} and {mended_outer}"),
    );
    (mended_inner, mended_outer)
}

/// A camera on a node; it looks along the node's -Z with +Y up.
pub fn camera(
    from: &json::Camera,
    name: String,
    world_from_node: &DAffine3,
    report: &mut ImportReport,
) -> Option<Camera> {
    let place = format!("camera '{name}'");
    let Some(projection) = projection(from) else {
        report.warn(
            place,
            "its angle or size of view is missing or makes no sense; left out",
        );
        return None;
    };
    let eye = world_from_node.translation.as_vec3();
    let (forward, up) = (
        direction(world_from_node, DVec3::NEG_Z),
        direction(world_from_node, DVec3::Y),
    );
    let (Some(forward), Some(up), true) = (forward, up, eye.is_finite()) else {
        report.warn(
            place,
            "its node's transform leaves it no direction; left out",
        );
        return None;
    };
    // A sheared node has its axes out of square.
    let up = up
        .reject_from_normalized(forward)
        .try_normalize()
        .unwrap_or_else(|| forward.any_orthonormal_vector());
    Some(Camera {
        name,
        eye,
        forward,
        up,
        projection,
    })
}

fn projection(from: &json::Camera) -> Option<Projection> {
    use json::camera::Type;
    match from.type_ {
        Checked::Valid(Type::Perspective) => {
            let view = from.perspective.as_ref()?;
            let vertical_fov = Some(view.yfov).filter(|&fov| fov > 0.0 && fov < PI)?;
            let aspect = view
                .aspect_ratio
                .filter(|aspect| aspect.is_finite() && *aspect > 0.0);
            Some(Projection::Perspective {
                vertical_fov,
                aspect,
            })
        }
        Checked::Valid(Type::Orthographic) => {
            let view = from.orthographic.as_ref()?;
            let (half_width, half_height) = (view.xmag.abs(), view.ymag.abs());
            let usable = |x: f32| x.is_finite() && x > 0.0;
            (usable(half_width) && usable(half_height)).then_some(Projection::Orthographic {
                half_width,
                half_height,
            })
        }
        Checked::Invalid => None,
    }
}

/// A direction of the node in the world, of unit length.
fn direction(world_from_node: &DAffine3, axis: DVec3) -> Option<Vec3> {
    let direction = world_from_node
        .transform_vector3(axis)
        .try_normalize()?
        .as_vec3();
    direction.is_finite().then_some(direction)
}
