//! Rays that find out where light would go.

use glam::Vec3;
use hemicube::radiosity::PatchMesh;
use hemicube::radiosity::patch::NodeKind;
use hemicube::radiosity::sampling::{cosine_direction, point2};
use hemicube::raster::Rgb;
use rayon::prelude::*;

/// Rays from all elements together, about; each element has at least a few.
const RAYS: usize = 200_000;

/// Rays around a point.
const AROUND: u32 = 128;

/// Where the light from surfaces would go, as shares.
#[derive(Debug, Clone, Copy, Default)]
pub struct Fate {
    /// What is shared out: area or flux.
    pub total: f64,
    /// Arrives on sides that receive.
    pub received: f64,
    /// Ends on back sides, which only absorb.
    pub absorbed: f64,
    /// Leaves the scene.
    pub escaped: f64,
}

impl Fate {
    fn add(&mut self, other: Self, weight: f64) {
        self.total += weight * other.total;
        self.received += weight * other.received;
        self.absorbed += weight * other.absorbed;
        self.escaped += weight * other.escaped;
    }

    /// A part as share of the whole.
    pub fn share(&self, part: f64) -> f64 {
        if self.total > 0.0 {
            part / self.total
        } else {
            0.0
        }
    }
}

/// What the rays of a scene found.
#[derive(Debug)]
pub struct Probe {
    /// Area of all lit sides, in square scene units.
    pub area: f64,
    /// Area of lit sides that look into a solid.
    pub buried: f64,
    /// Of light that leaves the surfaces evenly.
    pub surfaces: Fate,
    /// Of each instance's emission; none for those that do not emit.
    pub emission: Vec<Fate>,
    /// For each instance: area of its lit sides, and what of it looks into a solid.
    pub instance_area: Vec<(f64, f64)>,
    /// For each instance: light of the surfaces that ends on its back sides; obstructions are meant to absorb.
    pub on_backs: Vec<f64>,
}

struct OfElement {
    instance: usize,
    area: f64,
    exposed: f64,
    emission: f64,
    fate: Fate,
    /// Instances whose backs were hit, and the share of rays.
    backs: Vec<(usize, f64)>,
}

impl Probe {
    /// Follows a modest number of rays from the elements of a mesh.
    pub fn new(mesh: &PatchMesh) -> Self {
        let rays = u32::try_from((RAYS / mesh.elements().len().max(1)).clamp(4, 64)).unwrap_or(4);
        let elements: Vec<OfElement> = (0..mesh.elements().len())
            .into_par_iter()
            .map(|e| of_element(mesh, e, rays))
            .collect();
        let instances = mesh.scene().instances.len();
        let mut probe = Self {
            area: 0.0,
            buried: 0.0,
            surfaces: Fate::default(),
            emission: vec![Fate::default(); instances],
            instance_area: vec![(0.0, 0.0); instances],
            on_backs: vec![0.0; instances],
        };
        for element in elements {
            let buried = element.area - element.exposed;
            probe.area += element.area;
            probe.buried += buried;
            let (area, hidden) = &mut probe.instance_area[element.instance];
            *area += element.area;
            *hidden += buried;
            probe.surfaces.add(element.fate, element.exposed);
            probe.emission[element.instance].add(element.fate, element.emission * element.area);
            for (instance, share) in element.backs {
                probe.on_backs[instance] += share * element.exposed;
            }
        }
        probe
    }
}

fn of_element(mesh: &PatchMesh, e: usize, rays: u32) -> OfElement {
    let node = mesh.node(mesh.elements()[e]);
    let NodeKind::Surface { face, .. } = node.kind else {
        unreachable!("elements are surfaces")
    };
    let visibility = mesh.visibility();
    let exposed = mesh.exposed(e);
    let mut fate = Fate {
        total: 1.0,
        ..Fate::default()
    };
    let mut backs: Vec<(usize, f64)> = Vec::new();
    let share = 1.0 / f64::from(rays);
    for i in 0..rays {
        let point = exposed.point(point2(i, 2 * e as u64));
        let origin = mesh.visibility().off_surface(point, node.normal);
        let direction = cosine_direction(node.normal, point2(i, 2 * e as u64 + 1));
        let escaped = visibility.follow(origin, direction, |hit, arriving, passing| {
            let stays = share * mean(arriving - arriving * passing);
            if visibility.receives(hit.face, hit.side) {
                fate.received += stays;
            } else {
                fate.absorbed += stays;
                let face = &mesh.faces()[hit.face];
                if !mesh.scene().materials[face.material as usize].obstruction {
                    backs.push((face.instance as usize, stays));
                }
            }
        });
        fate.escaped += share * mean(escaped);
    }
    OfElement {
        instance: mesh.faces()[face as usize].instance as usize,
        area: f64::from(node.area),
        exposed: f64::from(exposed.area()),
        emission: mean(mesh.emission()[e]),
        fate,
        backs,
    }
}

fn mean(color: Rgb) -> f64 {
    color.to_array().into_iter().map(f64::from).sum::<f64>() / 3.0
}

/// What is seen from a point in all directions: shares of fronts (sides that receive), backs and nothing.
pub fn seen_around(mesh: &PatchMesh, point: Vec3) -> [f64; 3] {
    let mut seen = [0.0; 3];
    for i in 0..AROUND {
        let [u, v] = point2(i, 0);
        let (y, angle) = (1.0 - 2.0 * u, core::f32::consts::TAU * v);
        let radius = (1.0 - y * y).max(0.0).sqrt();
        let direction = Vec3::new(radius * angle.cos(), y, radius * angle.sin());
        let which = match mesh.visibility().first_hit(point, direction, f32::INFINITY) {
            Some(hit) if mesh.visibility().receives(hit.face, hit.side) => 0,
            Some(_) => 1,
            None => 2,
        };
        seen[which] += 1.0 / f64::from(AROUND);
    }
    seen
}
