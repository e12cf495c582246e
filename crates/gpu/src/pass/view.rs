//! Cameras as shaders read them.

use crate::error::GpuError;
use glam::{DMat4, DVec2, DVec3, Vec3};
use hemicube_render::{check_camera, clip_from_world};
use hemicube_scene::{Camera, Projection};
use hemicube_shaders::surface as twins;

/// Near plane, as a share of the scene's diameter: reversed depth resolves what is behind it.
const NEAREST: f64 = 1e-4;

/// A box around everything that is drawn.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds {
    pub(crate) low: Vec3,
    pub(crate) high: Vec3,
}

impl Bounds {
    pub(crate) fn of(points: impl Iterator<Item = Vec3>) -> Self {
        let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (low, high) = points.fold(nothing, |(low, high), p| (low.min(p), high.max(p)));
        Self { low, high }
    }

    fn corners(&self) -> [DVec3; 8] {
        core::array::from_fn(|i| {
            let take = |bit: usize, axis: usize| {
                f64::from(if i >> bit & 1 == 0 {
                    self.low[axis]
                } else {
                    self.high[axis]
                })
            };
            DVec3::new(take(0, 0), take(1, 1), take(2, 2))
        })
    }

    fn diameter(&self) -> f64 {
        f64::from(self.low.distance(self.high))
    }
}

/// A part of the picture's plane that fills the target: the point of clip space `p` becomes `scale p + offset`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window {
    pub(crate) scale: DVec2,
    pub(crate) offset: DVec2,
}

impl Window {
    /// What a target sees that takes this window's place in another one: first that one, then this.
    pub(crate) fn within(self, outer: Self) -> Self {
        Self {
            scale: self.scale * outer.scale,
            offset: self.scale * outer.offset + self.offset,
        }
    }

    fn matrix(&self) -> DMat4 {
        DMat4::from_translation(self.offset.extend(0.0)) * DMat4::from_scale(self.scale.extend(1.0))
    }
}

/// The view of a camera for a target of so many pixels; what concerns light is left at 0.
///
/// # Errors
/// A camera that cannot see, or one whose projection bends lines, which triangles do not.
pub(crate) fn view(
    camera: &Camera,
    aspect: f64,
    target: [u32; 2],
    bounds: &Bounds,
    window: Window,
) -> Result<twins::View, GpuError> {
    check_camera(camera).map_err(|e| GpuError::Option(e.to_string()))?;
    let eye = match camera.projection {
        Projection::Perspective { .. } => camera.eye.extend(1.0),
        Projection::Orthographic { .. } => (-camera.forward).extend(0.0),
        Projection::Panorama | Projection::Fisheye { .. } => {
            return Err(GpuError::Option(format!(
                "camera '{}': panoramas and fisheyes bend lines, which the GPU draws straight; use the CPU",
                camera.name
            )));
        }
    };
    let (near, far) = planes(camera, bounds);
    let clip_from_world = window.matrix() * reversed(clip_from_world(camera, aspect, near, far));
    Ok(twins::View {
        clip_from_world: clip_from_world.as_mat4().to_cols_array_2d(),
        eye: eye.to_array(),
        exposure: 1.0,
        #[expect(clippy::cast_precision_loss, reason = "a side has at most 16 bits")]
        size: target.map(|side| side as f32),
        max_reflectance: 1.0,
        ..bytemuck::Zeroable::zeroed()
    })
}

/// Distances along the viewing direction between which everything lies.
fn planes(camera: &Camera, bounds: &Bounds) -> (f64, f64) {
    let forward = camera.forward.as_dvec3().normalize();
    let distance = |p: DVec3| (p - camera.eye.as_dvec3()).dot(forward);
    let farthest = bounds
        .corners()
        .map(distance)
        .into_iter()
        .fold(0.0, f64::max)
        * 1.01;
    let far = if farthest > 0.0 && farthest.is_finite() {
        farthest
    } else {
        1.0
    };
    ((NEAREST * bounds.diameter()).min(0.5 * far), far)
}

/// The same with depth from 1, near, to 0, far.
fn reversed(clip: DMat4) -> DMat4 {
    let flip = DMat4::from_cols_array_2d(&[
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0, 1.0],
    ]);
    flip * clip
}
