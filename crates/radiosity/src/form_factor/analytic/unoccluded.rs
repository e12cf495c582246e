//! The cheapest rule that is good enough for a pair without obstruction.
//!
//! | pair | rule | evaluations |
//! |---|---|---|
//! | far apart | product of Gauss rules of 2, 3, 4 points each way on both polygons | 16, 81, 256 kernels |
//! | one polygon small beside its distance to the other | Lambert's exact factor of a point, averaged by Gauss rules of 2, 3, 4 points each way | 4, 9, 16 contours |
//! | all others, touching ones too | [`exchange`], to rounding | |
//!
//! # Error
//! The kernel of two polygons with radii `r_a`, `r_b` and centres d apart is analytic as long as `r_a + r_b < d`; a
//! product rule of n points misses its terms from order 2n on, so that its relative error falls as
//! `C_n ((r_a + r_b) / d)^2n`. The constants are those of the RMS error over 200,000 random pairs (squares to slivers,
//! triangles, all orientations, sizes up to 1 : 30): where a rule is taken first, that is the wanted error, farther away
//! it is less. The largest error was some thirty times the RMS; it belongs to pairs that see each other edge-on, whose
//! factors are tiny.

use super::exchange::exchange;
use super::site::{Nodes, Site};
use crate::form_factor::polygon::{FlatPolygon, facing_parts, point_to_polygon};

/// `C_n` of the product rules of 2, 3 and 4 points each way.
const PRODUCT: [f64; 3] = [0.2, 0.05, 0.01];
/// Order 2n and `C_n` of the averages of point factors over 2, 3 and 4 points each way, with the radius of the small
/// polygon over its distance from the other.
const AVERAGE: [(i32, f64); 3] = [(4, 0.2), (6, 0.03), (8, 0.005)];

/// From which distances the rules are good enough.
#[derive(Debug, Clone, Copy)]
pub struct Rules {
    /// `d² / (r_a + r_b)²` of the product rules, cheapest first.
    product: [f64; 3],
    /// Distance over radius of the averages, cheapest first.
    average: [f64; 3],
}

impl Default for Rules {
    /// For a relative error of 1e-5.
    fn default() -> Self {
        Self::new(1e-5)
    }
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
            Facing::Part => facing_parts(&a.polygon, &b.polygon)
                .map_or(0.0, |(a, b)| self.exchange_of_parts(&a, &b)),
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
            return product::<4>(&a.polygon, &b.polygon, 4);
        }
        self.near(&a.polygon, &b.polygon)
    }

    /// [`Self::exchange`] of polygons of which nothing else is known.
    pub fn exchange_of_polygons(&self, a: &FlatPolygon, b: &FlatPolygon) -> f64 {
        facing_parts(a, b).map_or(0.0, |(a, b)| self.exchange_of_parts(&a, &b))
    }

    /// [`Self::exchange`] of two polygons that are wholly in front of each other's plane.
    pub fn exchange_of_parts(&self, a: &FlatPolygon, b: &FlatPolygon) -> f64 {
        let (centre_a, centre_b) = (a.centre(), b.centre());
        let reach = a.radius(centre_a) + b.radius(centre_b);
        let ratio = centre_a.distance_squared(centre_b) / (reach * reach);
        if a.corners().len() > 4 || b.corners().len() > 4 {
            self.near(a, b)
        } else if ratio > self.product[0] {
            product::<1>(a, b, 2)
        } else if ratio > self.product[1] {
            product::<3>(a, b, 3)
        } else {
            self.near(a, b)
        }
    }

    /// The rules for pairs that are not far apart beside their size.
    fn near(&self, a: &FlatPolygon, b: &FlatPolygon) -> f64 {
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
            averaged::<1>(small, large, 2).min(most)
        } else if ratio > self.average[1] {
            averaged::<3>(small, large, 3).min(most)
        } else if ratio > self.average[2] {
            averaged::<4>(small, large, 4).min(most)
        } else {
            exchange(a.corners(), b.corners()).area
        }
    }
}

/// The product rule of `side` points each way on both polygons, in packs of four.
fn product<const PACKS: usize>(a: &FlatPolygon, b: &FlatPolygon, side: usize) -> f64 {
    let nodes = |polygon: &FlatPolygon| Nodes::<PACKS>::new(polygon.corners(), side);
    nodes(a).exchange(a.normal, &nodes(b), b.normal)
}

/// `∫ F_{x,source} dA` over a convex polygon by a product rule of `side` points each way in
/// packs of four.
fn averaged<const PACKS: usize>(receiver: &FlatPolygon, source: &FlatPolygon, side: usize) -> f64 {
    let factors = |(piece, count): ([glam::DVec3; 4], usize)| -> f64 {
        let nodes = Nodes::<PACKS>::new(&piece[..count], side);
        nodes
            .iter()
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

    /// RMS and largest relative error over random pairs, for a wanted one.
    fn errors(error: f64, pairs: usize) -> (f64, f64) {
        let rules = Rules::new(error);
        let mut random = Random(0);
        let (mut squares, mut largest, mut count) = (0.0, 0.0_f64, 0);
        while count < pairs {
            let a = random.site(DVec3::ZERO, 1.0);
            let place = random.direction() * 0.8 * 8.0_f64.powf(random.next());
            let size = 0.03_f64.powf(random.next());
            let b = random.site(place, size);
            if facing(&a, &b) == Facing::Whole {
                let exact = exchange(a.polygon.corners(), b.polygon.corners()).area;
                let relative = (rules.exchange(&a, &b) - exact).abs() / exact;
                squares += relative * relative;
                largest = largest.max(relative);
                count += 1;
            }
        }
        ((squares / pairs as f64).sqrt(), largest)
    }

    #[test]
    fn random_pairs_are_as_exact_as_wanted() {
        for error in [1e-3, 1e-5, 1e-7] {
            let (rms, largest) = errors(error, 3000);
            println!("wanted {error:.0e}: RMS {rms:.1e}, largest {largest:.1e}");
            assert!(rms < error, "wanted {error:.0e}: RMS {rms:.1e}");
            assert!(largest < 40.0 * error, "wanted {error:.0e}: {largest:.1e}");
        }
    }

    #[test]
    fn a_pair_is_the_same_both_ways() {
        let mut random = Random(99);
        let rules = Rules::new(1e-6);
        for _ in 0..500 {
            let a = random.site(DVec3::ZERO, 1.0);
            let place = random.direction() * 3.0 * random.next();
            let size = random.next() + 0.01;
            let b = random.site(place, size);
            let (there, back) = (rules.exchange(&a, &b), rules.exchange(&b, &a));
            assert!(
                (there - back).abs() <= 1e-9 * there.max(1e-6),
                "{there} there, {back} back"
            );
            assert!(
                there <= a.area.min(b.area),
                "{there} of {} and {}",
                a.area,
                b.area
            );
        }
    }

    #[test]
    fn parts_behind_the_other_plane_add_nothing() {
        let square = |origin: DVec3, u: DVec3, v: DVec3| {
            Site::new(&[origin, origin + u, origin + u + v, origin + v])
        };
        let floor = square(DVec3::ZERO, DVec3::X, DVec3::Y);
        let above = square(DVec3::new(1.5, 0.0, 0.0), DVec3::Z, DVec3::Y);
        let whole = square(DVec3::new(1.5, 0.0, -0.7), DVec3::Z * 1.7, DVec3::Y);
        assert_eq!(
            facing(&floor, &above),
            Facing::Whole,
            "it stands on the plane"
        );
        assert_eq!(facing(&floor, &whole), Facing::Part, "it reaches below");
        let rules = Rules::new(1e-9);
        let (one, two) = (
            rules.exchange(&floor, &above),
            rules.exchange(&floor, &whole),
        );
        assert!((one - two).abs() < 1e-9 && one > 0.01, "{one} and {two}");
        let beside = square(DVec3::new(2.0, 0.0, 0.0), DVec3::X, DVec3::Y);
        assert_eq!(rules.exchange(&floor, &beside), 0.0, "in one plane");
    }
}
