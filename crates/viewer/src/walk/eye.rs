//! Where one looks from, and where to.

use glam::Vec3;
use hemicube_scene::{Camera, Projection};
use serde::{Deserialize, Serialize};

/// What dragging turns around.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum EyeMode {
    /// Around the eye.
    #[default]
    Walk,
    /// Around what one looks at.
    Orbit,
}

/// An eye that never leans: up in the picture is up in the world.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Eye {
    /// Its place, in world units.
    pub position: Vec3,
    /// Angle around the vertical in radians; 0 looks along -z, growing to the right.
    pub yaw: f32,
    /// Angle above the horizon in radians.
    pub pitch: f32,
    /// Full vertical angle of view in radians.
    pub vertical_fov: f32,
    /// Distance to what it orbits around.
    pub distance: f32,
    /// What dragging turns around.
    pub mode: EyeMode,
}

/// Steepest angle up and down.
const STEEPEST: f32 = 1.55;

/// Narrowest and widest angle of view.
const FOV: [f32; 2] = [0.05, 2.4];

impl Eye {
    /// The eye of a camera. Cameras that lean are set upright, projections that are not perspective get 60°.
    pub fn of_camera(camera: &Camera, distance: f32) -> Self {
        let vertical_fov = match camera.projection {
            Projection::Perspective { vertical_fov, .. } => vertical_fov,
            _ => core::f32::consts::FRAC_PI_3,
        };
        let forward = camera.forward;
        Self {
            position: camera.eye,
            yaw: forward.x.atan2(-forward.z),
            pitch: forward.y.clamp(-1.0, 1.0).asin().clamp(-STEEPEST, STEEPEST),
            vertical_fov: vertical_fov.clamp(FOV[0], FOV[1]),
            distance: distance.max(f32::MIN_POSITIVE),
            mode: EyeMode::Walk,
        }
    }

    /// Viewing direction, of unit length.
    pub fn forward(&self) -> Vec3 {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.sin_cos();
        Vec3::new(sin_yaw * cos_pitch, sin_pitch, -cos_yaw * cos_pitch)
    }

    /// Direction to the right, of unit length and level.
    pub fn right(&self) -> Vec3 {
        let (sin, cos) = self.yaw.sin_cos();
        Vec3::new(cos, 0.0, sin)
    }

    /// What it orbits around.
    pub fn target(&self) -> Vec3 {
        self.position + self.forward() * self.distance
    }

    /// Turns by angles to the right and up: the head, or the whole body around the target.
    pub fn turn(&mut self, right: f32, up: f32) {
        let target = self.target();
        self.yaw = (self.yaw + right).rem_euclid(core::f32::consts::TAU);
        self.pitch = (self.pitch + up).clamp(-STEEPEST, STEEPEST);
        if self.mode == EyeMode::Orbit {
            self.position = target - self.forward() * self.distance;
        }
    }

    /// Comes closer to the target by a factor below 1, or away from it.
    pub fn zoom(&mut self, factor: f32) {
        let target = self.target();
        match self.mode {
            EyeMode::Orbit => {
                self.distance = (self.distance * factor).clamp(1e-6, 1e9);
                self.position = target - self.forward() * self.distance;
            }
            EyeMode::Walk => {
                self.vertical_fov = (self.vertical_fov * factor).clamp(FOV[0], FOV[1]);
            }
        }
    }

    /// Slides sideways and upwards in the picture, by shares of its height.
    pub fn pan(&mut self, right: f32, up: f32) {
        let height = 2.0 * self.distance * (0.5 * self.vertical_fov).tan();
        let upward = self.right().cross(self.forward());
        self.position += (self.right() * right + upward * up) * height;
    }

    /// As a camera of the scene.
    pub fn camera(&self, name: &str) -> Camera {
        let target = self.position + self.forward();
        Camera::looking_at(name, self.position, target, Vec3::Y, self.vertical_fov)
    }

    /// Direction through a point of the picture: x to the right and y down, each from -1 to 1.
    pub fn direction_at(&self, x: f32, y: f32, aspect: f32) -> Vec3 {
        let height = (0.5 * self.vertical_fov).tan();
        let upward = self.right().cross(self.forward());
        let direction =
            self.forward() + self.right() * (x * height * aspect) - upward * (y * height);
        direction.normalize()
    }

    /// A share of the way to another eye, along the shorter turn.
    pub fn lerp(&self, other: &Self, t: f32) -> Self {
        use core::f32::consts::{PI, TAU};
        let turn = (other.yaw - self.yaw + PI).rem_euclid(TAU) - PI;
        let mix = |a: f32, b: f32| a + (b - a) * t;
        Self {
            position: self.position.lerp(other.position, t),
            yaw: (self.yaw + turn * t).rem_euclid(TAU),
            pitch: mix(self.pitch, other.pitch),
            vertical_fov: mix(self.vertical_fov, other.vertical_fov),
            distance: mix(self.distance, other.distance),
            mode: other.mode,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::{FRAC_PI_2, PI};

    fn eye() -> Eye {
        let camera = Camera::looking_at(
            "a",
            Vec3::new(1.0, 2.0, 3.0),
            Vec3::new(4.0, 1.0, -2.0),
            Vec3::Y,
            0.8,
        );
        Eye::of_camera(&camera, 2.0)
    }

    #[test]
    fn a_camera_comes_back() {
        let camera = eye().camera("a");
        let forward = (Vec3::new(4.0, 1.0, -2.0) - Vec3::new(1.0, 2.0, 3.0)).normalize();
        assert!(camera.forward.distance(forward) < 1e-5, "{camera:?}");
        assert!(camera.right().distance(eye().right()) < 1e-5, "{camera:?}");
    }

    #[test]
    fn orbiting_keeps_the_target() {
        let mut eye = eye();
        eye.mode = EyeMode::Orbit;
        let target = eye.target();
        eye.turn(1.0, 0.4);
        eye.zoom(0.5);
        assert!(eye.target().distance(target) < 1e-5, "{eye:?}");
        assert!((eye.distance - 1.0).abs() < 1e-6, "half of 2");
    }

    #[test]
    fn walking_turns_on_the_spot_and_never_over_the_top() {
        let mut eye = eye();
        let place = eye.position;
        eye.turn(20.0, 20.0);
        assert_eq!(eye.position, place, "on the spot");
        assert!(eye.pitch < FRAC_PI_2 && eye.forward().y > 0.99, "looks up");
        assert!(eye.right().y == 0.0, "does not lean");
    }

    #[test]
    fn the_middle_and_the_corners_of_the_picture() {
        let eye = eye();
        assert!(
            eye.direction_at(0.0, 0.0, 1.5).distance(eye.forward()) < 1e-6,
            "the middle"
        );
        let top = eye.direction_at(0.0, -1.0, 1.5);
        let angle = top.dot(eye.forward()).acos();
        assert!(
            (angle - 0.4).abs() < 1e-5 && top.y > eye.forward().y,
            "half of 0.8: {angle}"
        );
        let right = eye.direction_at(1.0, 0.0, 1.5);
        assert!(right.dot(eye.right()) > 0.0, "to the right");
    }

    #[test]
    fn halfway_goes_the_shorter_way_around() {
        let (mut a, mut b) = (eye(), eye());
        (a.yaw, b.yaw) = (0.1, 2.0 * PI - 0.1);
        let yaw = a.lerp(&b, 0.5).yaw;
        assert!(yaw.min(2.0 * PI - yaw) < 1e-5, "over 0, not over π: {yaw}");
        assert!((a.lerp(&b, 1.0).yaw - b.yaw).abs() < 1e-5, "all the way");
    }
}
