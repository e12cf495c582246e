//! Rays through a picture: where a camera looks at each place of it, and how that changes from pixel to pixel.
//!
//! Every projection is a map from places to rays. Its derivatives (ray differentials: Igehy, *Tracing ray differentials*,
//! 1999) are exact; textures are filtered by what they say of a sample's footprint.

use core::f64::consts::{PI, TAU};
use glam::{DVec2, DVec3};
use hemicube_scene::{Camera, FisheyeMapping, Projection};

/// A ray through a place of the picture. The direction need not have unit length.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CameraRay {
    pub origin: DVec3,
    pub direction: DVec3,
    /// What a step of one pixel to the right and one down does to the origin,
    pub origin_steps: [DVec3; 2],
    /// and to the direction.
    pub direction_steps: [DVec3; 2],
}

/// A camera and the size of its picture, made ready.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lens {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Pixels.
    size: DVec2,
    kind: Kind,
}

#[derive(Debug, Clone, Copy)]
enum Kind {
    /// Half width and half height of the picture at distance 1.
    Perspective(DVec2),
    /// Half width and half height.
    Orthographic(DVec2),
    Panorama,
    Fisheye {
        half_angle: f64,
        mapping: FisheyeMapping,
    },
}

impl Lens {
    /// A camera that passed its door, for a picture of so many pixels.
    pub fn new(camera: &Camera, width: usize, height: usize) -> Self {
        let (right, up, forward) = frame(camera);
        let size = DVec2::new(width as f64, height as f64);
        Self {
            eye: camera.eye.as_dvec3(),
            right,
            up,
            forward,
            size,
            kind: Kind::of(camera.projection, size.x / size.y),
        }
    }

    /// The ray through a place, in pixels from the upper left corner; none where the picture shows nothing.
    pub fn ray(&self, at: DVec2) -> Option<CameraRay> {
        match self.kind {
            Kind::Perspective(half) => Some(self.perspective(at, half)),
            Kind::Orthographic(half) => Some(self.orthographic(at, half)),
            Kind::Panorama => Some(self.panorama(at)),
            Kind::Fisheye {
                half_angle,
                mapping,
            } => self.fisheye(at, half_angle, mapping),
        }
    }

    /// Place in [-1, 1] with y up.
    fn centred(&self, at: DVec2) -> DVec2 {
        let p = at / self.size * 2.0 - 1.0;
        DVec2::new(p.x, -p.y)
    }

    /// One pixel to the right and one down in a picture plane of these half sides.
    fn plane_steps(&self, half: DVec2) -> [DVec3; 2] {
        let step = half * 2.0 / self.size;
        [self.right * step.x, self.up * -step.y]
    }

    fn perspective(&self, at: DVec2, half: DVec2) -> CameraRay {
        let p = self.centred(at) * half;
        CameraRay {
            origin: self.eye,
            direction: self.forward + self.right * p.x + self.up * p.y,
            origin_steps: [DVec3::ZERO; 2],
            direction_steps: self.plane_steps(half),
        }
    }

    fn orthographic(&self, at: DVec2, half: DVec2) -> CameraRay {
        let p = self.centred(at) * half;
        CameraRay {
            origin: self.eye + self.right * p.x + self.up * p.y,
            direction: self.forward,
            origin_steps: self.plane_steps(half),
            direction_steps: [DVec3::ZERO; 2],
        }
    }

    /// `d = cos b (cos l F + sin l R) + sin b U` with longitude `l` and latitude `b`.
    fn panorama(&self, at: DVec2) -> CameraRay {
        let per_pixel = DVec2::new(TAU, PI) / self.size;
        let (sin_l, cos_l) = (at.x * per_pixel.x - PI).sin_cos();
        let (sin_b, cos_b) = (0.5 * PI - at.y * per_pixel.y).sin_cos();
        let outwards = self.forward * cos_l + self.right * sin_l;
        let along = self.right * cos_l - self.forward * sin_l;
        CameraRay {
            origin: self.eye,
            direction: outwards * cos_b + self.up * sin_b,
            origin_steps: [DVec3::ZERO; 2],
            direction_steps: [
                along * (cos_b * per_pixel.x),
                (outwards * sin_b - self.up * cos_b) * per_pixel.y,
            ],
        }
    }

    /// `d = cos θ F + sin θ e` where `e` points from the disc's middle to the place.
    fn fisheye(&self, at: DVec2, half_angle: f64, mapping: FisheyeMapping) -> Option<CameraRay> {
        let radius = 0.5 * self.size.min_element();
        let p = (at - 0.5 * self.size) / radius;
        let p = DVec2::new(p.x, -p.y);
        let r = p.length();
        if r > 1.0 {
            return None;
        }
        let (theta, slope) = angle_from_axis(r, half_angle, mapping);
        let outwards = if r > 0.0 { p / r } else { DVec2::X };
        let around = outwards.perp();
        let in_space = |v: DVec2| self.right * v.x + self.up * v.y;
        let (sin, cos) = theta.sin_cos();
        // sin θ / r, which tends to θ' in the middle.
        let ratio = if r > 1e-9 { sin / r } else { slope };
        let step = |way: DVec2| {
            let radial = in_space(outwards) * cos - self.forward * sin;
            radial * (slope * way.dot(outwards)) + in_space(around) * (ratio * way.dot(around))
        };
        Some(CameraRay {
            origin: self.eye,
            direction: self.forward * cos + in_space(p) * ratio,
            origin_steps: [DVec3::ZERO; 2],
            direction_steps: [
                step(DVec2::new(1.0 / radius, 0.0)),
                step(DVec2::new(0.0, -1.0 / radius)),
            ],
        })
    }
}

impl Kind {
    fn of(projection: Projection, aspect: f64) -> Self {
        match projection {
            Projection::Perspective { vertical_fov, .. } => {
                let y = (0.5 * f64::from(vertical_fov)).tan();
                Self::Perspective(DVec2::new(y * aspect, y))
            }
            Projection::Orthographic {
                half_width,
                half_height,
            } => {
                let y = f64::from(half_height).max(f64::from(half_width) / aspect);
                Self::Orthographic(DVec2::new(y * aspect, y))
            }
            Projection::Panorama => Self::Panorama,
            Projection::Fisheye { angle, mapping } => Self::Fisheye {
                half_angle: 0.5 * f64::from(angle),
                mapping,
            },
        }
    }
}

/// Angle from the axis at a radius in [0, 1], and its derivative.
fn angle_from_axis(r: f64, half_angle: f64, mapping: FisheyeMapping) -> (f64, f64) {
    match mapping {
        FisheyeMapping::Equidistant => (r * half_angle, half_angle),
        FisheyeMapping::Equisolid => {
            let most = (0.5 * half_angle).sin();
            let sin = r * most;
            let slope = 2.0 * most / (1.0 - sin * sin).max(1e-12).sqrt();
            (2.0 * sin.min(1.0).asin(), slope)
        }
    }
}

/// Right, up and forward of a camera, at right angles and of unit length.
pub(crate) fn frame(camera: &Camera) -> (DVec3, DVec3, DVec3) {
    let forward = camera.forward.as_dvec3().normalize();
    let up = camera.up.as_dvec3();
    let up = (up - forward * up.dot(forward)).normalize();
    (forward.cross(up), up, forward)
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::PI as PI32;
    use glam::Vec3;

    fn lens(projection: Projection) -> Lens {
        let camera = Camera::looking_at("t", Vec3::ONE, Vec3::new(3.0, 0.5, -1.0), Vec3::Y, 0.9);
        Lens::new(
            &Camera {
                projection,
                ..camera
            },
            64,
            48,
        )
    }

    fn projections() -> Vec<Projection> {
        let fisheye = |mapping, angle| Projection::Fisheye { angle, mapping };
        vec![
            Projection::Perspective {
                vertical_fov: 0.9,
                aspect: None,
            },
            Projection::Orthographic {
                half_width: 2.0,
                half_height: 1.0,
            },
            Projection::Panorama,
            fisheye(FisheyeMapping::Equidistant, PI32),
            fisheye(FisheyeMapping::Equisolid, 1.5 * PI32),
        ]
    }

    #[test]
    fn steps_are_the_derivatives() {
        let h = 1e-5;
        for projection in projections() {
            let lens = lens(projection);
            for at in [
                DVec2::new(20.3, 11.7),
                DVec2::new(32.0, 24.0),
                DVec2::new(44.0, 30.0),
            ] {
                let ray = lens.ray(at).expect("inside");
                for (k, way) in [DVec2::X, DVec2::Y].into_iter().enumerate() {
                    let (a, b) = (lens.ray(at - way * h), lens.ray(at + way * h));
                    let (a, b) = (a.expect("inside"), b.expect("inside"));
                    let direction = (b.direction - a.direction) / (2.0 * h);
                    let origin = (b.origin - a.origin) / (2.0 * h);
                    assert!(
                        (direction - ray.direction_steps[k]).length() < 1e-8,
                        "{projection:?} at {at}: {direction} and {}",
                        ray.direction_steps[k]
                    );
                    assert!((origin - ray.origin_steps[k]).length() < 1e-8, "origin");
                }
            }
        }
    }

    #[test]
    fn middle_looks_forward_and_equal_areas_are_equal_solid_angles() {
        for projection in projections() {
            let lens = lens(projection);
            let ray = lens.ray(DVec2::new(32.0, 24.0)).expect("the middle");
            assert!(
                ray.direction.normalize().distance(lens.forward) < 1e-12,
                "{projection:?}"
            );
        }
        let lens = lens(projections()[4]);
        let solid_angle = |at| {
            let ray = lens.ray(at).expect("inside");
            let [x, y] = ray.direction_steps;
            x.cross(y).length()
        };
        let middle = solid_angle(DVec2::new(32.0, 24.0));
        for at in [DVec2::new(40.0, 20.0), DVec2::new(20.0, 40.0)] {
            assert!((solid_angle(at) / middle - 1.0).abs() < 1e-9, "{at}");
        }
    }

    #[test]
    fn fisheye_shows_nothing_outside_its_disc() {
        let lens = lens(projections()[3]);
        assert!(lens.ray(DVec2::new(2.0, 2.0)).is_none(), "a corner");
        let rim = lens.ray(DVec2::new(32.0, 0.0)).expect("the rim");
        assert!(rim.direction.distance(lens.up) < 1e-6, "90 degrees up");
    }
}
