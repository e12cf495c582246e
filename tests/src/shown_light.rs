//! Light as pictures show it: interpolated over elements from their vertices.

use glam::Vec3;
use hemicube::radiosity::sampling::point2;
use hemicube::radiosity::{DrawnMesh, GatherOptions, Gatherer, Solution};
use hemicube::raster::Rgb;
use rayon::prelude::*;
use std::collections::HashMap;

/// Irradiance of a solution at any place of its surfaces.
#[derive(Debug)]
pub struct ShownLight<'a> {
    solution: &'a Solution,
    drawn: DrawnMesh,
    /// Part and number of each element's triangles.
    triangles: HashMap<u32, Vec<(usize, usize)>>,
}

impl<'a> ShownLight<'a> {
    /// As a picture shows it, without an ambient estimate.
    pub fn new(solution: &'a Solution) -> Self {
        let drawn = DrawnMesh::new(solution, Rgb::BLACK);
        let mut triangles: HashMap<u32, Vec<(usize, usize)>> = HashMap::new();
        for (p, part) in drawn.parts.iter().enumerate() {
            for (t, &element) in part.elements.iter().enumerate() {
                triangles.entry(element).or_default().push((p, t));
            }
        }
        Self {
            solution,
            drawn,
            triangles,
        }
    }

    /// Irradiance at a point on a surface whose unit normal points to the side that is looked at; none where no surface is.
    pub fn irradiance(&self, point: Vec3, normal: Vec3) -> Option<Rgb> {
        let mesh = self.solution.mesh();
        let visibility = mesh.visibility();
        let above = point + normal * (1e-3 * visibility.diameter());
        let hit = visibility.first_hit(above, -normal, 2e-3 * visibility.diameter())?;
        let element = mesh.element_at(hit.face, hit.side, hit.point)?;
        let weighed = self.triangles[&u32::try_from(element).ok()?]
            .iter()
            .map(|&(p, t)| {
                let corners = self.drawn.parts[p].triangles[t].map(|v| v as usize);
                (
                    corners,
                    barycentric(corners.map(|v| self.drawn.positions[v]), hit.point),
                )
            });
        // Of an element's triangles the one that the point is in, or nearest to.
        let least = |weights: &[f32; 3]| weights.iter().copied().fold(f32::INFINITY, f32::min);
        let (corners, weights) = weighed.max_by(|(_, a), (_, b)| least(a).total_cmp(&least(b)))?;
        let shares = weights.map(|weight| weight.clamp(0.0, 1.0));
        let total: f32 = shares.iter().sum();
        Some(
            (0..3)
                .map(|i| self.drawn.irradiance[corners[i]] * (shares[i] / total))
                .sum(),
        )
    }
}

fn barycentric([a, b, c]: [Vec3; 3], point: Vec3) -> [f32; 3] {
    let normal = (b - a).cross(c - a);
    let share =
        |p: Vec3, q: Vec3| (p - point).cross(q - point).dot(normal) / normal.length_squared();
    [share(b, c), share(c, a), share(a, b)]
}

/// Irradiance at a place, gathered.
#[derive(Debug, Clone, Copy)]
pub struct Gathered {
    /// On a surface.
    pub point: Vec3,
    /// Of the side that is looked at.
    pub normal: Vec3,
    /// Irradiance there.
    pub irradiance: Rgb,
}

/// Light at places spread evenly over the exposed surfaces of a solution, gathered from it by so many rays.
pub fn gathered(solution: &Solution, places: usize, rays: u32) -> Vec<Gathered> {
    let mesh = solution.mesh();
    let options = GatherOptions {
        rays,
        ..GatherOptions::default()
    };
    let gatherer = Gatherer::new(solution, options);
    let areas = (0..mesh.elements().len()).map(|e| f64::from(mesh.exposed_area(e)));
    let step = areas.clone().sum::<f64>() / places as f64;
    // Systematic sampling: one place whenever the sum of the areas passes another step.
    let (mut sum, mut chosen) = (0.5 * step, Vec::new());
    for (e, area) in areas.enumerate() {
        sum += area;
        while sum >= step {
            sum -= step;
            chosen.push(e);
        }
    }
    let place = |(i, &e): (usize, &usize)| {
        let number = u32::try_from(i).expect("few places");
        let point = mesh.exposed(e).point(point2(number, 0));
        let normal = mesh.node(mesh.elements()[e]).normal;
        let irradiance = gatherer.irradiance(point, normal);
        Gathered {
            point,
            normal,
            irradiance,
        }
    };
    chosen.par_iter().enumerate().map(place).collect()
}

/// Root of the mean squared error of what a solution shows, in luminance, relative to the mean luminance.
pub fn shown_error(solution: &Solution, truth: &[Gathered]) -> f64 {
    let shown = ShownLight::new(solution);
    let (mut squares, mut light, mut count) = (0.0, 0.0, 0.0);
    for place in truth {
        if let Some(found) = shown.irradiance(place.point, place.normal) {
            let right = f64::from(place.irradiance.luminance());
            squares += (f64::from(found.luminance()) - right).powi(2);
            light += right;
            count += 1.0;
        }
    }
    (squares / count).sqrt() / (light / count)
}
