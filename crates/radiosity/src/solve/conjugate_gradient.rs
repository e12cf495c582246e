//! Conjugate gradients, stabilised for matrices that are not symmetric (BiCGSTAB; van der Vorst 1992).
//!
//! With exact factors `A_i F_ij = A_j F_ji`, and scaled by `A_i / ρ_i` the equations `(I - ρ F) B = E` are symmetric:
//! plain conjugate gradients would do (Baranoski, Bramley, Shirley 1995). Sampled factors are reciprocal
//! only up to their noise, on which plain conjugate gradients get stuck, and patches with ρ = 0 have no such scaling.
//! BiCGSTAB needs neither and solves the equations as they are, at twice the products with the matrix a step:
//!
//! ```text
//! ϱ' = (r̂, r)    p = r + (ϱ'/ϱ)(α/ω)(p - ω v)     v = K p     α = ϱ' / (r̂, v)
//! s = r - α v     t = K s     ω = (t, s) / (t, t)     B += α p + ω s     r = s - ω t
//! ```
//!
//! with `K = I - ρ F`, whose diagonal is 1 for planar patches, so that there is nothing to precondition with; `(x, y)`
//! is weighted by area.

use crate::solve::system::{MatrixMethod, System};

/// Share of the first residual at which a descent ends: below it only rounding is left.
const DEEP: f64 = 1e-13;

/// One step is one iteration, with two products of the matrix and a vector in each channel. A sweep is a descent, as
/// far as numbers carry or as many steps as patches.
#[derive(Debug, Clone, Default)]
pub struct ConjugateGradient {
    residuals: Vec<Vec<f64>>,
    descents: Vec<Descent>,
    steps: usize,
}

/// The descent of one channel.
#[derive(Debug, Clone)]
struct Descent {
    /// r̂, the residual that it began with.
    shadow: Vec<f64>,
    direction: Vec<f64>,
    /// v, what K makes of the direction.
    image: Vec<f64>,
    rho: f64,
    alpha: f64,
    omega: f64,
    first: f64,
    is_over: bool,
}

impl Descent {
    fn new(residual: &[f64], areas: &[f64]) -> Self {
        let first = dot(residual, residual, areas);
        Self {
            shadow: residual.to_vec(),
            direction: vec![0.0; residual.len()],
            image: vec![0.0; residual.len()],
            rho: 1.0,
            alpha: 1.0,
            omega: 1.0,
            first,
            is_over: first == 0.0,
        }
    }

    /// The next direction; none where the shadow has become blind to the residual.
    fn turn(&mut self, residual: &[f64], areas: &[f64]) {
        let rho = dot(&self.shadow, residual, areas);
        // Below it only rounding is left of their product, and the step would be anything.
        let sizes = dot(&self.shadow, &self.shadow, areas) * dot(residual, residual, areas);
        let is_breakdown = rho * rho <= 1e-24 * sizes;
        let beta = rho / self.rho * (self.alpha / self.omega);
        if self.is_over || is_breakdown || !beta.is_finite() {
            self.is_over = true;
            self.direction.fill(0.0);
            return;
        }
        self.rho = rho;
        for (i, p) in self.direction.iter_mut().enumerate() {
            *p = residual[i] + beta * (*p - self.omega * self.image[i]);
        }
    }

    /// Goes along the direction; the residual becomes s.
    fn advance(&mut self, image: Vec<f64>, residual: &mut [f64], areas: &[f64]) {
        self.image = image;
        let along = dot(&self.shadow, &self.image, areas);
        self.alpha = self.rho / along;
        if self.is_over || along == 0.0 || !self.alpha.is_finite() {
            self.is_over = true;
            self.alpha = 0.0;
        }
        add(residual, -self.alpha, &self.image);
    }

    /// Goes along s by as much as lowers the residual most.
    fn smooth(
        &mut self,
        image: &[f64],
        residual: &mut [f64],
        radiosity: &mut [f64],
        areas: &[f64],
    ) {
        let length = dot(image, image, areas);
        self.omega = if self.is_over || length == 0.0 {
            0.0
        } else {
            dot(image, residual, areas) / length
        };
        add(radiosity, self.alpha, &self.direction);
        add(radiosity, self.omega, residual);
        add(residual, -self.omega, image);
        let left = dot(residual, residual, areas);
        self.is_over |= self.omega == 0.0 || left <= self.first * DEEP * DEEP;
    }
}

impl MatrixMethod for ConjugateGradient {
    fn step(&mut self, system: &mut System<'_>) -> bool {
        let areas = system.areas;
        if self.descents.is_empty() {
            self.residuals = system.residuals();
            let descents = self.residuals.iter().map(|r| Descent::new(r, areas));
            self.descents = descents.collect();
            self.steps = 0;
        }
        for (descent, residual) in self.descents.iter_mut().zip(&self.residuals) {
            descent.turn(residual, areas);
        }
        let along = images(system, |c| &self.descents[c].direction);
        for ((descent, image), residual) in
            (self.descents.iter_mut().zip(along)).zip(&mut self.residuals)
        {
            descent.advance(image, residual, areas);
        }
        let across = images(system, |c| &self.residuals[c]);
        for (c, descent) in self.descents.iter_mut().enumerate() {
            let radiosity = &mut system.channels[c].radiosity;
            descent.smooth(&across[c], &mut self.residuals[c], radiosity, areas);
        }
        self.steps += 1;
        let is_over = self.steps >= system.size() || self.descents.iter().all(|d| d.is_over);
        if is_over {
            self.restart();
        }
        is_over
    }

    fn restart(&mut self) {
        self.descents.clear();
        self.residuals.clear();
    }

    fn residuals(&self) -> Option<&[Vec<f64>]> {
        (!self.descents.is_empty()).then_some(&self.residuals)
    }
}

/// `K x = x - ρ F x` in each channel.
fn images<'v>(system: &System<'_>, vector: impl Fn(usize) -> &'v Vec<f64> + Sync) -> Vec<Vec<f64>> {
    let mut images = system.reflected(|c| vector(c));
    for (c, image) in images.iter_mut().enumerate() {
        image
            .iter_mut()
            .zip(vector(c))
            .for_each(|(y, x)| *y = x - *y);
    }
    images
}

fn dot(a: &[f64], b: &[f64], areas: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .zip(areas)
        .map(|((a, b), w)| a * b * w)
        .sum()
}

/// `a += k b`
fn add(a: &mut [f64], k: f64, b: &[f64]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += k * b;
    }
}
