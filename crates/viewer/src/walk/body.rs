//! A body in the scene: it stops at walls, slides along them, stands on floors and climbs steps.
//!
//! It is a few rays against the [`Visibility`] in the direction of each move, at the height of the eyes and of the knees,
//! in the middle and at both shoulders. That is no exact solid: what is thinner than the distance between rays can
//! be walked through.

use crate::walk::Eye;
use glam::Vec3;
use hemicube_radiosity::Visibility;

/// How a body is built, in scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Distance that it keeps from walls.
    pub radius: f32,
    /// Eyes above the floor.
    pub eye_height: f32,
    /// Highest step that it climbs.
    pub step_height: f32,
    /// Way in a second.
    pub speed: f32,
    /// Speed gained in a second of falling.
    pub gravity: f32,
}

/// What is asked of a body, and for how long.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Step {
    /// Forward, from -1 to 1.
    pub forward: f32,
    /// To the right, from -1 to 1.
    pub right: f32,
    /// Upwards, from -1 to 1; where there is gravity it is ignored.
    pub up: f32,
    /// Whether it runs: three times as fast.
    pub runs: bool,
    /// Seconds.
    pub seconds: f32,
    /// Whether walls stop it.
    pub collides: bool,
    /// Whether it falls.
    pub falls: bool,
}

/// Diagonals between which a scene is taken to be in metres.
const METRES: core::ops::Range<f32> = 2.5..400.0;
/// Diagonal, in metres, that other scenes are taken to have.
const ROOM: f32 = 9.0;
/// Longest move in one go; a long frame is several.
const LONGEST: f32 = 0.05;

impl Body {
    /// A grown-up in a scene of that diagonal. Scenes that cannot be in metres are taken for a room of 9 m.
    pub fn in_scene(diagonal: f32) -> Self {
        let metre = if METRES.contains(&diagonal) {
            1.0
        } else {
            diagonal.max(f32::MIN_POSITIVE) / ROOM
        };
        Self {
            radius: 0.25 * metre,
            eye_height: 1.6 * metre,
            step_height: 0.35 * metre,
            speed: 1.6 * metre,
            gravity: 9.81 * metre,
        }
    }

    /// Moves an eye. `falling` is the speed downwards, to be kept between calls.
    pub fn step(&self, eye: &mut Eye, falling: &mut f32, step: &Step, visibility: &Visibility) {
        let pieces = (step.seconds / LONGEST).ceil().clamp(1.0, 20.0);
        let piece = Step {
            seconds: (step.seconds / pieces).min(LONGEST),
            ..*step
        };
        let mut left = pieces;
        while left > 0.0 {
            self.small_step(eye, falling, &piece, visibility);
            left -= 1.0;
        }
    }

    fn small_step(&self, eye: &mut Eye, falling: &mut f32, step: &Step, visibility: &Visibility) {
        let way = self.wish(eye, step);
        eye.position += if step.collides {
            self.slide(eye.position, way, step.falls, visibility)
        } else {
            way
        };
        if step.falls {
            self.fall(eye, falling, step.seconds, visibility);
        } else {
            *falling = 0.0;
        }
    }

    /// Where it wants to go: level where there is gravity, else as it looks.
    fn wish(&self, eye: &Eye, step: &Step) -> Vec3 {
        let ahead = if step.falls {
            Vec3::Y.cross(eye.right()).normalize_or_zero()
        } else {
            eye.forward()
        };
        let up = if step.falls { 0.0 } else { step.up };
        let wish = ahead * step.forward + eye.right() * step.right + Vec3::Y * up;
        let pace = if step.runs { 3.0 } else { 1.0 };
        wish.clamp_length_max(1.0) * (self.speed * pace * step.seconds)
    }

    /// The part of a way that walls leave: what leads into one is taken out, twice so that corners hold.
    fn slide(&self, from: Vec3, way: Vec3, walks: bool, visibility: &Visibility) -> Vec3 {
        let mut way = way;
        for _ in 0..3 {
            let Some(normal) = self.obstacle(from, way, walks, visibility) else {
                return way;
            };
            way -= normal * way.dot(normal).min(0.0);
            if walks {
                way.y = 0.0;
            }
        }
        if self.obstacle(from, way, walks, visibility).is_some() {
            Vec3::ZERO
        } else {
            way
        }
    }

    /// Normal, towards the body, of the nearest surface that a way would bring it too close to.
    fn obstacle(
        &self,
        from: Vec3,
        way: Vec3,
        walks: bool,
        visibility: &Visibility,
    ) -> Option<Vec3> {
        let direction = way.try_normalize()?;
        let reach = way.length() + self.radius;
        let across = direction.cross(Vec3::Y).normalize_or(Vec3::X) * (0.8 * self.radius);
        let knees = Vec3::Y * (self.step_height - self.eye_height);
        let heights: &[Vec3] = if walks {
            &[Vec3::ZERO, knees]
        } else {
            &[Vec3::ZERO]
        };
        let starts = heights
            .iter()
            .flat_map(|&height| [Vec3::ZERO, across, -across].map(|side| from + height + side));
        let nearest = starts
            .filter_map(|start| visibility.first_hit(start, direction, reach))
            .min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        let normal = visibility.normal(nearest.face);
        Some(normal * -normal.dot(direction).signum())
    }

    fn fall(&self, eye: &mut Eye, falling: &mut f32, seconds: f32, visibility: &Visibility) {
        let depth = *falling * seconds + self.eye_height;
        let floor = visibility.first_hit(
            eye.position,
            Vec3::NEG_Y,
            depth.max(self.eye_height) + self.step_height,
        );
        let Some(floor) = floor else {
            // There may be none at all: below the scene nobody falls on.
            let is_above = visibility
                .first_hit(eye.position, Vec3::NEG_Y, f32::INFINITY)
                .is_some();
            if is_above {
                *falling += self.gravity * seconds;
                eye.position.y -= *falling * seconds;
            } else {
                *falling = 0.0;
            }
            return;
        };
        *falling = 0.0;
        let wanted = floor.point.y + self.eye_height;
        let rise = wanted - eye.position.y;
        // Stairs are climbed smoothly, and never through the ceiling.
        let most = 4.0 * self.speed * seconds;
        let room = visibility.first_hit(eye.position, Vec3::Y, rise.abs() + self.radius);
        let allowed = room.map_or(f32::INFINITY, |hit| {
            (hit.distance - 0.5 * self.radius).max(0.0)
        });
        eye.position.y += rise.clamp(-most, most).min(allowed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walk::EyeMode;
    use hemicube_radiosity::{PatchMesh, PatchOptions};
    use hemicube_scene::builtin;
    use std::sync::Arc;

    fn mesh(name: &str) -> PatchMesh {
        let scene = Arc::new(builtin::scene(name).expect("it is built in"));
        PatchMesh::build(scene, PatchOptions::default().with_elements(100))
            .expect("it can be built")
    }

    fn eye_at(position: Vec3) -> Eye {
        Eye {
            position,
            yaw: 0.0,
            pitch: 0.0,
            vertical_fov: 1.0,
            distance: 1.0,
            mode: EyeMode::Walk,
        }
    }

    fn walking(seconds: f32) -> Step {
        Step {
            forward: 1.0,
            seconds,
            collides: true,
            falls: true,
            ..Step::default()
        }
    }

    #[test]
    fn a_wall_stops_and_lets_slide() {
        let mesh = mesh("furnace");
        let (low, high) = mesh.scene().bounds().expect("it has faces");
        let body = Body::in_scene(mesh.visibility().diameter());
        let mut eye = eye_at(0.5 * (low + high));
        let mut falling = 0.0;
        for _ in 0..400 {
            body.step(&mut eye, &mut falling, &walking(0.05), mesh.visibility());
        }
        let gap = eye.position.z - low.z;
        assert!(
            (gap - body.radius).abs() < 0.15 * body.radius,
            "it keeps its distance: {gap}"
        );
        let before = eye.position.x;
        eye.yaw = 0.6;
        for _ in 0..10 {
            body.step(&mut eye, &mut falling, &walking(0.05), mesh.visibility());
        }
        assert!(
            eye.position.x > before + 0.1 * body.speed,
            "it slides along"
        );
        assert!(
            eye.position.z >= low.z + 0.8 * body.radius,
            "and does not go through"
        );
    }

    #[test]
    fn it_falls_to_the_floor_and_stands() {
        let mesh = mesh("two-rooms");
        let (low, high) = mesh.scene().bounds().expect("it has faces");
        let body = Body::in_scene(mesh.visibility().diameter());
        let middle = mesh.scene().cameras[0].eye;
        let mut eye = eye_at(Vec3::new(middle.x, high.y - 0.3, middle.z));
        let mut falling = 0.0;
        let stands = Step {
            forward: 0.0,
            ..walking(0.05)
        };
        for _ in 0..100 {
            body.step(&mut eye, &mut falling, &stands, mesh.visibility());
        }
        let height = eye.position.y - low.y;
        assert!(
            (height - body.eye_height).abs() < 0.01,
            "eyes above the floor: {height}"
        );
    }

    #[test]
    fn nobody_leaves_a_closed_room_whatever_the_keys() {
        for name in ["furnace", "office"] {
            let mesh = mesh(name);
            let (low, high) = mesh.scene().bounds().expect("it has faces");
            let body = Body::in_scene(mesh.visibility().diameter());
            let start = match mesh.scene().cameras.first() {
                Some(camera) => camera.eye,
                None => 0.5 * (low + high),
            };
            let mut eye = eye_at(start);
            let (mut falling, mut random) = (0.0, 7_u32);
            let mut next = || {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (random >> 8) as f32 / (1 << 24) as f32
            };
            for i in 0..3000 {
                if i % 20 == 0 {
                    eye.turn(next() * 6.3, next() - 0.5);
                }
                let step = Step {
                    right: next() - 0.5,
                    runs: next() > 0.5,
                    falls: i % 1000 > 500,
                    ..walking(0.1 * next())
                };
                body.step(&mut eye, &mut falling, &step, mesh.visibility());
            }
            let inside = eye.position.cmpgt(low).all() && eye.position.cmplt(high).all();
            assert!(inside, "{name}: {} of {low} to {high}", eye.position);
        }
    }

    #[test]
    fn scenes_in_millimetres_have_bodies_of_their_size() {
        assert_eq!(Body::in_scene(8.0).eye_height, 1.6, "metres");
        let small = Body::in_scene(960.0);
        assert!((150.0..200.0).contains(&small.eye_height), "{small:?}");
    }
}
