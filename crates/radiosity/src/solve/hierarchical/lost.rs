//! Light that no element receives: rays from where it leaves tell what backs absorb and what escapes.

use crate::patch::PatchMesh;
use crate::sampling::{cosine_direction, hash, point4};
use crate::solution::BANDS;
use hemicube_raster::Rgb;
use rayon::prelude::*;

/// Rays that are one piece of work.
const AT_ONCE: u32 = 1024;

/// Shares of what leaves that are lost, by channel.
#[derive(Debug, Clone)]
pub(super) struct Lost {
    pub(super) backs: Vec<f64>,
    pub(super) escaped: Vec<f64>,
    /// Rays of each channel's light.
    rays: Vec<f64>,
}

/// Sums by channel.
#[derive(Debug, Clone)]
struct Sums {
    left: Vec<f64>,
    backs: Vec<f64>,
    escaped: Vec<f64>,
}

impl Sums {
    fn new(channels: usize) -> Self {
        Self {
            left: vec![0.0; channels],
            backs: vec![0.0; channels],
            escaped: vec![0.0; channels],
        }
    }

    fn with(mut self, other: &Self) -> Self {
        let add = |to: &mut [f64], from: &[f64]| {
            to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        };
        add(&mut self.left, &other.left);
        add(&mut self.backs, &other.backs);
        add(&mut self.escaped, &other.escaped);
        self
    }
}

/// Running sums of what elements send, to choose them by.
struct Senders<'a> {
    mesh: &'a PatchMesh,
    /// `[channel][element]`.
    radiosity: &'a [f32],
    channels: usize,
    sums: Vec<f64>,
}

impl Lost {
    /// Nothing is.
    pub(super) fn nothing(channels: usize) -> Self {
        Self {
            backs: vec![0.0; channels],
            escaped: vec![0.0; channels],
            rays: vec![0.0; channels],
        }
    }

    /// Standard error of the share that is lost; 0 where no ray was.
    pub(super) fn error(&self, channel: usize) -> f64 {
        let share = (self.backs[channel] + self.escaped[channel]).min(1.0);
        (share * (1.0 - share) / self.rays[channel].max(1.0)).sqrt()
    }

    /// Of a radiosity, `[channel][element]`, by so many rays in proportion to the flux. Signs do not count.
    pub(super) fn probe(
        mesh: &PatchMesh,
        radiosity: &[f32],
        channels: usize,
        rays: u32,
        seed: u64,
    ) -> Self {
        let senders = Senders::new(mesh, radiosity, channels);
        if senders.total() <= 0.0 {
            return Self::nothing(channels);
        }
        let chunks: Vec<Sums> = (0..rays.div_ceil(AT_ONCE))
            .into_par_iter()
            .map(|chunk| {
                let end = ((chunk + 1) * AT_ONCE).min(rays);
                senders.cast(chunk * AT_ONCE..end, rays, seed)
            })
            .collect();
        let sums = chunks.iter().fold(Sums::new(channels), Sums::with);
        let shares = |lost: &[f64]| {
            let share = |(&lost, &left): (&f64, &f64)| if left > 0.0 { lost / left } else { 0.0 };
            lost.iter().zip(&sums.left).map(share).collect()
        };
        Self {
            backs: shares(&sums.backs),
            escaped: shares(&sums.escaped),
            rays: sums.left,
        }
    }
}

impl<'a> Senders<'a> {
    fn new(mesh: &'a PatchMesh, radiosity: &'a [f32], channels: usize) -> Self {
        let elements = mesh.elements().len();
        let mut sum = 0.0;
        let mut sums = Vec::with_capacity(elements);
        for e in 0..elements {
            let magnitude: f32 = (0..channels)
                .map(|c| radiosity[c * elements + e].abs())
                .sum();
            sum += f64::from(magnitude) * f64::from(mesh.exposed_area(e));
            sums.push(sum);
        }
        Self {
            mesh,
            radiosity,
            channels,
            sums,
        }
    }

    fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    fn cast(&self, rays: core::ops::Range<u32>, all: u32, seed: u64) -> Sums {
        let (mesh, visibility) = (self.mesh, self.mesh.visibility());
        let elements = self.sums.len();
        let mut sums = Sums::new(self.channels);
        for ray in rays {
            let jitter = (hash(seed, u64::from(ray)) >> 11) as f64 / (1_u64 << 53) as f64;
            let wanted = (f64::from(ray) + jitter) / f64::from(all) * self.total();
            let e = self.sums.partition_point(|&sum| sum <= wanted);
            let e = e.min(elements - 1);
            let [u, v, s, t] = point4(ray, seed);
            let normal = mesh.node(mesh.elements()[e]).normal;
            let origin = visibility.off_surface(mesh.exposed(e).point([u, v]), normal);
            let mut absorbed = Rgb::BLACK;
            let direction = cosine_direction(normal, [s, t]);
            let escaped = visibility.follow(origin, direction, |hit, arriving, passing| {
                let receiver = mesh.element_at(hit.face, hit.side, hit.point);
                if receiver.is_none_or(|receiver| mesh.exposed_area(receiver) <= 0.0) {
                    absorbed += arriving * (Rgb::WHITE - passing);
                }
            });
            // What each channel sends of an element that was chosen by what all send.
            let value = |channel: usize| f64::from(self.radiosity[channel * elements + e].abs());
            let magnitude: f64 = (0..self.channels).map(value).sum();
            for channel in 0..self.channels {
                let share = value(channel) / magnitude;
                sums.left[channel] += share;
                sums.backs[channel] += share * f64::from(absorbed[channel % BANDS]);
                sums.escaped[channel] += share * f64::from(escaped[channel % BANDS]);
            }
        }
        sums
    }
}
