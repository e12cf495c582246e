//! Irradiance at any point, gathered from the solution with visibility.
//!
//! The error is the solution's and the sampling's, not an interpolation's. Emitters are integrated on their own: the
//! exact factor of each emitting patch from the point times the share of rays that reach it. Reflected light is
//! gathered by cosine-distributed rays. Of more than 2048 emitting patches the brightest are integrated, the others met
//! by those rays.

use crate::band_sum::BandSum;
use crate::cast::to_f32;
use crate::form_factor::polygon::{FlatPolygon, point_to_polygon};
use crate::primary::from_light;
use crate::sampling::{cosine_direction, hash, point2};
use crate::solution::Solution;
use crate::visibility::Visibility;
use core::f32::consts::PI;
use glam::Vec3;
use hemicube_raster::Rgb;

/// Most emitting patches that are integrated one by one.
const MAX_EMITTERS: usize = 2048;

/// How the rays are spent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GatherOptions {
    /// Rays over the hemisphere of each point. Default value: 2048.
    pub rays: u32,
    /// Shifts the low-discrepancy sequences. Default value: 0.
    pub seed: u64,
}

impl Default for GatherOptions {
    fn default() -> Self {
        Self {
            rays: 2048,
            seed: 0,
        }
    }
}

/// Gathers irradiance from one solution.
#[derive(Debug)]
pub struct Gatherer<'a> {
    solution: &'a Solution,
    visibility: &'a Visibility,
    options: GatherOptions,
    /// Radiosity of each element.
    radiosity: Vec<Rgb>,
    emitters: Vec<Emitter>,
    /// `π L` of the sky as dimmed.
    sky: Rgb,
    /// Exitance of each element that is integrated through `emitters` and so left out of the rays.
    integrated: Vec<Rgb>,
}

#[derive(Debug)]
struct Emitter {
    flat: FlatPolygon,
    normal: Vec3,
    exitance: Rgb,
}

impl<'a> Gatherer<'a> {
    /// Prepares gathering.
    pub fn new(solution: &'a Solution, options: GatherOptions) -> Self {
        let mesh = solution.mesh();
        let count = mesh.elements().len();
        let (emitters, integrated) = emitters(solution);
        Self {
            radiosity: (0..count).map(|e| solution.element_radiosity(e)).collect(),
            emitters,
            integrated,
            sky: mesh.scene().sky * last_dim(solution) * PI,
            options: GatherOptions {
                rays: options.rays.max(1),
                ..options
            },
            solution,
            visibility: mesh.visibility(),
        }
    }

    /// Irradiance at a point on a surface whose unit normal points to the side that is measured: lx or W/m².
    pub fn irradiance(&self, point: Vec3, normal: Vec3) -> Rgb {
        let bits = |x: f32| u64::from(x.to_bits());
        let place = hash(hash(bits(point.x), bits(point.y)), bits(point.z));
        let seed = hash(place, self.options.seed);
        let origin = self.visibility.off_surface(point, normal);
        self.direct(point, origin, normal, seed, self.options.rays)
            + self.reflected(point, normal, seed)
    }

    /// Irradiance at a point of a surface with the normal `flat`, for several other normals there: what a relief on it
    /// receives. Their rays for reflected light are the same, uniform over the hemisphere of `flat`; below it lies the
    /// surface itself, of radiosity `own`, which a normal tilted by `θ` sees with factor `(1 - cos θ) / 2`. An eighth as
    /// many rays go to emitters, for each normal.
    pub fn irradiance_of_normals(
        &self,
        point: Vec3,
        flat: Vec3,
        own: Rgb,
        normals: &[Vec3],
    ) -> Vec<Rgb> {
        let bits = |x: f32| u64::from(x.to_bits());
        let place = hash(hash(bits(point.x), bits(point.y)), bits(point.z));
        let seed = hash(place, self.options.seed);
        let origin = self.visibility.off_surface(point, flat);
        let mut sums = vec![BandSum::default(); normals.len()];
        for i in 0..self.options.rays {
            let direction = hemisphere_direction(flat, point2(i, seed));
            let arriving = self.arriving(origin, direction);
            for (sum, normal) in sums.iter_mut().zip(normals) {
                // Against the density 1 / 2π; irradiance sums L cos θ, and arriving light is π L.
                sum.add(arriving * (2.0 * normal.dot(direction).max(0.0)));
            }
        }
        let total = |(sum, &normal): (BandSum, &Vec3)| {
            let below = own * (0.5 * (1.0 - normal.dot(flat)));
            let rays = self.options.rays.div_ceil(8);
            let direct = self.direct(point, origin, normal, seed, rays);
            sum.mean(self.options.rays) + below + direct
        };
        sums.into_iter().zip(normals).map(total).collect()
    }

    /// From points, sun, and the emitting patches, to which so many rays go in all.
    fn direct(&self, point: Vec3, origin: Vec3, normal: Vec3, seed: u64, rays: u32) -> Rgb {
        let scene = self.solution.mesh().scene();
        let dim = last_dim(self.solution);
        let lights: Rgb = scene
            .lights
            .iter()
            .map(|light| from_light(self.visibility, &light.kind, point, normal))
            .sum();
        let mut sum = lights * dim;
        let arriving: Vec<(usize, Rgb)> = self
            .emitters
            .iter()
            .enumerate()
            .map(|(i, emitter)| {
                let factor = point_to_polygon(point.as_dvec3(), normal.as_dvec3(), &emitter.flat);
                (i, emitter.exitance * to_f32(factor))
            })
            .filter(|(_, unoccluded)| !unoccluded.is_black())
            .collect();
        let total: f32 = arriving
            .iter()
            .map(|(_, unoccluded)| unoccluded.max_band())
            .sum();
        // Rays go to emitters by what they would bring. Those that earn less than a ray are drawn systematically, and the
        // visible share of the drawn ones counts for all of them; what nothing hides is exact.
        let visible = |i: usize, rays| {
            self.visible_share(
                origin,
                normal,
                &self.emitters[i],
                rays,
                hash(seed, i as u64),
            )
        };
        let mut ticks = point2(0, seed)[0];
        let (mut small, mut drawn, mut drawn_visible) = (Rgb::BLACK, Rgb::BLACK, Rgb::BLACK);
        for (i, unoccluded) in arriving {
            let wanted = rays as f32 * unoccluded.max_band() / total;
            if wanted >= 1.0 {
                sum += unoccluded * visible(i, ceil_count(wanted));
                continue;
            }
            small += unoccluded;
            ticks += wanted;
            if ticks >= 1.0 || drawn.is_black() {
                ticks -= ticks.floor();
                drawn += unoccluded / wanted;
                drawn_visible += unoccluded * visible(i, 1) / wanted;
            }
        }
        let share = |band| {
            if drawn[band] > 0.0 {
                drawn_visible[band] / drawn[band]
            } else {
                0.0
            }
        };
        sum + small * Rgb::new(share(0), share(1), share(2))
    }

    /// Share of an emitter's light that reaches a point, weighted by the kernel `cos cos / r²`.
    fn visible_share(
        &self,
        origin: Vec3,
        normal: Vec3,
        emitter: &Emitter,
        rays: u32,
        seed: u64,
    ) -> Rgb {
        // What is below the horizon cannot be seen, and the factor does not count it.
        let above = emitter
            .flat
            .above_horizon(origin.as_dvec3(), normal.as_dvec3());
        let Some(above) = above else {
            return Rgb::BLACK;
        };
        let (mut sum, mut weights) = (Rgb::BLACK, 0.0);
        for i in 0..rays {
            let target = above.point(point2(i, seed)).as_vec3();
            let offset = target - origin;
            let squared = offset.length_squared();
            let weight = (offset.dot(normal) * -offset.dot(emitter.normal)).max(0.0)
                / (squared * squared).max(f32::MIN_POSITIVE);
            if weight > 0.0 {
                let target = self.visibility.off_surface(target, emitter.normal);
                sum += self.visibility.transmittance(origin, target) * weight;
                weights += weight;
            }
        }
        if weights > 0.0 {
            sum / weights
        } else {
            Rgb::BLACK
        }
    }

    /// From everything that rays meet, less what is integrated directly.
    fn reflected(&self, point: Vec3, normal: Vec3, seed: u64) -> Rgb {
        let origin = self.visibility.off_surface(point, normal);
        let mut sum = BandSum::default();
        for i in 0..self.options.rays {
            let direction = cosine_direction(normal, point2(i, seed));
            sum.add(self.arriving(origin, direction));
        }
        sum.mean(self.options.rays)
    }

    /// `π L` of what a ray meets, less what is integrated directly.
    fn arriving(&self, origin: Vec3, direction: Vec3) -> Rgb {
        let mesh = self.solution.mesh();
        let mut arriving = Rgb::BLACK;
        let escaped = self.visibility.follow(origin, direction, |hit, share, _| {
            if let Some(e) = mesh.element_at(hit.face, hit.side, hit.point) {
                arriving += share * (self.radiosity[e] - self.integrated[e]);
            }
        });
        arriving + escaped * self.sky
    }
}

/// Direction of uniform density `1 / 2π` on the side of a unit normal.
fn hemisphere_direction(normal: Vec3, [u, v]: [f32; 2]) -> Vec3 {
    let (right, up) = normal.any_orthonormal_pair();
    let radius = (1.0 - u * u).max(0.0).sqrt();
    let (sin, cos) = (2.0 * PI * v).sin_cos();
    normal * u + (right * cos + up * sin) * radius
}

/// What dims lights without an area and the sky: they are in the last group.
fn last_dim(solution: &Solution) -> Rgb {
    solution
        .groups()
        .last()
        .map_or(Rgb::WHITE, |group| group.dim)
}

/// The emitting patches, the brightest ones if there are very many, and the exitance of each element that they cover.
fn emitters(solution: &Solution) -> (Vec<Emitter>, Vec<Rgb>) {
    let mesh = solution.mesh();
    let flux = |patch: usize| -> Rgb {
        let of_element =
            |e: usize| solution.element_exitance(e) * mesh.node(mesh.elements()[e]).area;
        mesh.elements_of_patch(patch).map(of_element).sum()
    };
    let mut found: Vec<(usize, Rgb)> = (0..mesh.patches().len())
        .map(|patch| (patch, flux(patch)))
        .filter(|(_, flux)| !flux.is_black())
        .collect();
    if found.len() > MAX_EMITTERS {
        found.sort_by(|a, b| {
            b.1.max_band()
                .total_cmp(&a.1.max_band())
                .then(a.0.cmp(&b.0))
        });
        found.truncate(MAX_EMITTERS);
        found.sort_by_key(|&(patch, _)| patch);
    }
    let mut integrated = vec![Rgb::BLACK; mesh.elements().len()];
    let emitter = |(patch, flux): (usize, Rgb)| {
        for e in mesh.elements_of_patch(patch) {
            integrated[e] = solution.element_exitance(e);
        }
        let id = mesh.patches()[patch];
        let node = mesh.node(id);
        Emitter {
            flat: FlatPolygon::new(&mesh.polygon(id), node.normal),
            normal: node.normal,
            exitance: flux / node.area,
        }
    };
    let emitters = found.into_iter().map(emitter).collect();
    (emitters, integrated)
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "at most the number of rays"
)]
fn ceil_count(wanted: f32) -> u32 {
    wanted.ceil() as u32
}
