//! Cameras.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A named view of the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Name by which `--camera` finds it.
    pub name: String,
    /// Where the eye is, in world units.
    pub eye: Vec3,
    /// Viewing direction, of unit length, pointing from the eye into the scene.
    pub forward: Vec3,
    /// Upward direction of the picture, of unit length, perpendicular to `forward`.
    pub up: Vec3,
    /// How directions become pixels.
    pub projection: Projection,
}

/// How a camera projects.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Projection {
    /// Central projection.
    Perspective {
        /// Full vertical angle of view in radians.
        vertical_fov: f32,
        /// Width by height that the file asks for; the picture's size decides if `None`.
        aspect: Option<f32>,
    },
    /// Parallel projection.
    Orthographic {
        /// Half the width of the view volume in world units.
        half_width: f32,
        /// Half its height.
        half_height: f32,
    },
    /// All directions on an equirectangular picture of 360° by 180°: columns are longitudes, `forward` in the middle and
    /// growing to the right; rows are latitudes, `up` at the top.
    Panorama,
    /// Directions on a disc that touches the picture's shorter sides, by their angle from `forward`.
    Fisheye {
        /// Full angle of view across the disc in radians, at most a full turn.
        angle: f32,
        /// How angles become radii.
        mapping: FisheyeMapping,
    },
}

/// How a fisheye's angles `θ` from the axis become radii, for a disc of radius 1 at `θ = α / 2`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
pub enum FisheyeMapping {
    /// `r = 2 θ / α`.
    #[default]
    Equidistant,
    /// `r = sin(θ/2) / sin(α/4)`: equal solid angles have equal areas.
    Equisolid,
}

impl Camera {
    /// A perspective camera at `eye` that looks at a point; `up` need not be perpendicular to the view.
    ///
    /// Degenerate input (target in the eye, `up` along the view) is mended by another axis.
    pub fn looking_at(
        name: impl Into<String>,
        eye: Vec3,
        target: Vec3,
        up: Vec3,
        vertical_fov: f32,
    ) -> Self {
        let forward = (target - eye).try_normalize().unwrap_or(Vec3::NEG_Z);
        let up = up
            .reject_from_normalized(forward)
            .try_normalize()
            .unwrap_or_else(|| forward.any_orthonormal_vector());
        let projection = Projection::Perspective {
            vertical_fov,
            aspect: None,
        };
        Self {
            name: name.into(),
            eye,
            forward,
            up,
            projection,
        }
    }

    /// Direction to the right of the picture, of unit length.
    pub fn right(&self) -> Vec3 {
        self.forward.cross(self.up)
    }
}
