//! The cheapest rule that is good enough for a pair without obstruction.
//!
//! | pair | rule | evaluations |
//! |---|---|---|
//! | far apart | product of Gauss rules of 2, 3, 4 points each way on both polygons | 16, 81, 256 kernels |
//! | one polygon small beside its distance to the other | Lambert's exact factor of a point, averaged by Gauss rules of 2, 4, 8 points each way | 4, 16, 64 contours |
//! | all others, touching ones too | [`exchange`](super::exchange::exchange), to rounding | |
//!
//! # Bound
//! The kernel of two polygons with radii `r_a`, `r_b` and centres d apart is analytic as long as `r_a + r_b < d`; a
//! product rule of n points misses its terms from order 2n on. So the error, as a share of the largest that the factor
//! could be, `A_a A_b h_a h_b / π d⁴` with the largest heights over each other's plane, is below
//! `C_n ((r_a + r_b) / d)^2n`. The constants are twice the largest error of 100,000 random pairs (squares to slivers,
//! triangles, all orientations, sizes up to 1 : 30).

use super::exchange::exchange;
use super::site::{Nodes, Site};
use crate::form_factor::polygon::{FlatPolygon, facing_parts, point_to_polygon};

/// `C_n` of the product rules of 2, 3 and 4 points.
const PRODUCT: [f64; 3] = [0.2, 0.05, 0.01];
/// The same of the averages of point factors of 2, 4 and 8 points, over the radius of the small polygon and its
/// distance from the other.
const AVERAGE: [(i32, f64); 3] = [(4, 0.2), (6, 0.03), (8, 0.005)];

/// From which distances the rules are good enough.
#[derive(Debug, Clone, Copy)]
pub struct Rules {
    /// `d² / (r_a + r_b)²` of the product rules, cheapest first.
    product: [f64; 3],
    /// Distance over radius of the averages, cheapest first.
    average: [f64; 3],
}

impl Rules {
    /// For a relative error of each factor.
    pub fn new(error: f64) -> Self {
        let order = |n: usize| 2.0 * (n as f64 + 2.0);
        Self {
            product: core::array::from_fn(|n| (PRODUCT[n] / error).powf(2.0 / order(n)).max(1.2)),
            average: core::array::from_fn(|n| {
                let (order, constant) = AVERAGE[n];
                (constant / error).powf(1.0 / f64::from(order)).max(1.1)
            }),
        }
    }

    /// `A_a F_ab` of two polygons; 0 where neither faces the other.
    pub fn exchange(&self, a: &Site, b: &Site) -> f64 {
        match facing(a, b) {
            Facing::Not => 0.0,
            Facing::Whole => self.of_whole(a, b),
            Facing::Part => {
                facing_parts(&a.polygon, &b.polygon).map_or(0.0, |(a, b)| self.of_parts(&a, &b))
            }
        }
    }

    fn of_whole(&self, a: &Site, b: &Site) -> f64 {
        let reach = a.radius + b.radius;
        let ratio = a.centre.distance_squared(b.centre) / (reach * reach);
        let (na, nb) = (a.polygon.normal, b.polygon.normal);
        if ratio > self.product[0] {
            return a.nodes2.exchange(na, &b.nodes2, nb);
        }
        if ratio > self.product[1] {
            return a.nodes3.exchange(na, &b.nodes3, nb);
        }
        if ratio > self.product[2] {
            let nodes = |site: &Site| Nodes::<16>::new(site.polygon.corners(), 4);
            return nodes(a).exchange(na, &nodes(b), nb);
        }
        self.of_parts(&a.polygon, &b.polygon)
    }

    /// Of two polygons wholly in front of each other's plane.
    fn of_parts(&self, a: &FlatPolygon, b: &FlatPolygon) -> f64 {
        let (centre_a, centre_b) = (a.centre(), b.centre());
        let (radius_a, radius_b) = (a.radius(centre_a), b.radius(centre_b));
        let (small, centre, radius, large) = if radius_a <= radius_b {
            (a, centre_a, radius_a, b)
        } else {
            (b, centre_b, radius_b, a)
        };
        let ratio = large.distance(centre) / radius;
        let most = a.area().min(b.area());
        if ratio > self.average[0] {
            averaged::<4>(small, large, 2).min(most)
        } else if ratio > self.average[1] {
            averaged::<16>(small, large, 4).min(most)
        } else if ratio > self.average[2] {
            averaged::<12>(small, large, 3).min(most)
        } else {
            exchange(a.corners(), b.corners()).area
        }
    }
}

/// `∫ F_{x,source} dA` over a convex polygon by a product rule of `side` points each way; N is their square, or more.
fn averaged<const N: usize>(receiver: &FlatPolygon, source: &FlatPolygon, side: usize) -> f64 {
    let factors = |(piece, count): ([glam::DVec3; 4], usize)| -> f64 {
        let nodes = Nodes::<N>::new(&piece[..count], side);
        let points = nodes.iter().take(side * side);
        points
            .map(|(x, w)| w * point_to_polygon(x, receiver.normal, source))
            .sum()
    };
    receiver.pieces().map(factors).sum()
}

/// How much of two polygons lies in front of each other's plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Facing {
    /// One of them is wholly behind the other.
    Not,
    /// Both are wholly in front.
    Whole,
    /// The plane of one cuts the other.
    Part,
}

/// Heights below this share of the radii count as in the plane.
const IN_PLANE: f64 = 1e-6;

/// How two polygons lie to each other.
pub fn facing(a: &Site, b: &Site) -> Facing {
    match (over(a, b), over(b, a)) {
        (Facing::Not, _) | (_, Facing::Not) => Facing::Not,
        (Facing::Whole, Facing::Whole) => Facing::Whole,
        _ => Facing::Part,
    }
}

/// How `site` lies to the plane of `plane`.
fn over(plane: &Site, site: &Site) -> Facing {
    let normal = plane.polygon.normal;
    let height = (site.centre - plane.centre).dot(normal);
    if height >= site.radius {
        return Facing::Whole;
    }
    if height <= -site.radius {
        return Facing::Not;
    }
    let tolerance = IN_PLANE * (plane.radius + site.radius);
    let heights = site
        .polygon
        .corners()
        .iter()
        .map(|&c| (c - plane.centre).dot(normal));
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| {
        (low.min(h), high.max(h))
    });
    if high <= tolerance {
        Facing::Not
    } else if low >= -tolerance {
        Facing::Whole
    } else {
        Facing::Part
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash;
    use core::f64::consts::PI;
    use glam::DVec3;

    /// Numbers in [0, 1) by counting.
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 += 1;
            (hash(self.0, 7) >> 11) as f64 / (1_u64 << 53) as f64
        }

        fn direction(&mut self) -> DVec3 {
            let z = 2.0 * self.next() - 1.0;
            let (sine, cosine) = (2.0 * PI * self.next()).sin_cos();
            let r = (1.0 - z * z).sqrt();
            DVec3::new(r * cosine, r * sine, z)
        }

        /// A rectangle, parallelogram or triangle of about this size around a point.
        fn site(&mut self, centre: DVec3, size: f64) -> Site {
            let u = self.direction();
            let turned = self.direction().cross(u).normalize();
            let v = if self.next() < 0.5 {
                turned
            } else {
                (turned + u * self.next()).normalize()
            };
            let (u, v) = (u * size, v * size * (0.1 + 0.9 * self.next()));
            let corners = [
                centre - 0.5 * (u + v),
                centre + 0.5 * (u - v),
                centre + 0.5 * (u + v),
                centre + 0.5 * (v - u),
            ];
            let count = if self.next() < 0.3 { 3 } else { 4 };
            Site::new(&corners[..count])
        }
    }

    #[test]
    fn calibrate() {
        let mut random = Random(0);
        let (mut bins, mut sq, mut abins, mut asq) = (
            [[0.0_f64; 24]; 3],
            [[0.0_f64; 24]; 3],
            [[0.0_f64; 24]; 3],
            [[0.0_f64; 24]; 3],
        );
        let mut count = [0.0_f64; 24];
        let mut acount = [0.0_f64; 24];
        let mut worst_average = [0.0_f64; 3];
        let mut pairs = 0;
        while pairs < 200_000 {
            let size = 0.03_f64.powf(random.next());
            let a = random.site(DVec3::ZERO, 1.0);
            let place = random.direction() * 8.0_f64.powf(random.next()) * 0.8;
            let b = random.site(place, size);
            if facing(&a, &b) != Facing::Whole {
                continue;
            }
            pairs += 1;
            let exact = exchange(a.polygon.corners(), b.polygon.corners()).area;
            let (na, nb) = (a.polygon.normal, b.polygon.normal);
            let d2 = a.centre.distance_squared(b.centre);
            let sigma = (a.radius + b.radius) / d2.sqrt();
            let top = |plane: &Site, s: &Site| {
                s.polygon
                    .corners()
                    .iter()
                    .map(|&c| (c - plane.centre).dot(plane.polygon.normal))
                    .fold(0.0, f64::max)
            };
            let scale = a.area * b.area * top(&a, &b) * top(&b, &a) / (PI * d2 * d2);
            if sigma < 0.9 {
                let found = [
                    a.nodes2.exchange(na, &b.nodes2, nb),
                    Nodes::<12>::new(a.polygon.corners(), 3).exchange(
                        na,
                        &Nodes::<12>::new(b.polygon.corners(), 3),
                        nb,
                    ),
                    Nodes::<16>::new(a.polygon.corners(), 4).exchange(
                        na,
                        &Nodes::<16>::new(b.polygon.corners(), 4),
                        nb,
                    ),
                ];
                for n in 0..3 {
                    let error = (found[n] - exact).abs() / exact;
                    let bin = ((-sigma.log2() * 4.0) as usize).min(23);
                    bins[n][bin] = bins[n][bin].max(error);
                    sq[n][bin] += error * error;
                    count[bin] += 1.0;
                }
            }
            let (small, large) = if a.radius < b.radius {
                (&a, &b)
            } else {
                (&b, &a)
            };
            let ratio = large.polygon.distance(small.centre) / small.radius;
            if ratio > 1.15 {
                let found = [
                    averaged::<4>(&small.polygon, &large.polygon, 2),
                    averaged::<12>(&small.polygon, &large.polygon, 3),
                    averaged::<16>(&small.polygon, &large.polygon, 4),
                ];
                for n in 0..3 {
                    let error = (found[n] - exact).abs() / exact;
                    let bin = ((ratio.log2() * 4.0) as usize).min(23);
                    abins[n][bin] = abins[n][bin].max(error);
                    asq[n][bin] += error * error;
                    acount[bin] += 1.0;
                }
            }
        }
        let rms = |s: f64, c: f64| (s / (c / 3.0)).sqrt();
        for bin in 0..24 {
            println!(
                "average {:.3}: {:.1e} {:.1e} {:.1e}   rms {:.1e} {:.1e} {:.1e}",
                2.0_f64.powf(bin as f64 / 4.0),
                abins[0][bin],
                abins[1][bin],
                abins[2][bin],
                rms(asq[0][bin], acount[bin]),
                rms(asq[1][bin], acount[bin]),
                rms(asq[2][bin], acount[bin])
            );
        }
        for bin in 0..24 {
            let sigma = 2.0_f64.powf(-(bin as f64) / 4.0);
            println!(
                "{:.3}: {:.1e} {:.1e} {:.1e}   C {:.3} {:.3} {:.3}",
                1.0 / sigma,
                bins[0][bin],
                bins[1][bin],
                bins[2][bin],
                rms(sq[0][bin], count[bin]) / sigma.powi(4),
                rms(sq[1][bin], count[bin]) / sigma.powi(6),
                rms(sq[2][bin], count[bin]) / sigma.powi(8)
            );
        }
    }
}
