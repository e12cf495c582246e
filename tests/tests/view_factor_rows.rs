//! Rows of every method against the exact factors of polygon pairs, free ones and occluded ones.
//!
//! Each pair of `data/view_factors.json` becomes a scene: the two polygons, and the occluders as faces that absorb on both
//! sides. What a method may be off by is worked out for each entry, from how many cells outlines cross and how many
//! rays are cast.

use glam::{DVec3, Vec3};
use hemicube::radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube::radiosity::form_factor::hemisphere;
use hemicube::radiosity::form_factor::raycast::Strategy;
use hemicube::radiosity::form_factor::{
    Estimate, Hemisphere, HemisphereOptions, Nusselt, NusseltOptions, Sampler, Sampling, nusselt,
};
use hemicube::radiosity::patch::NodeKind;
use hemicube::radiosity::{
    FormFactors, NodeId, PatchMesh, PatchOptions, RayCast, RayCastOptions, Row,
};
use hemicube_tests::shapes::Facet;
use hemicube_tests::surfaces::{Surface, add_absorber, corners, scene, y_up};
use serde_json::Value;
use std::f64::consts::PI;
use std::sync::Arc;

/// Two polygons and what stands between them.
struct Pair {
    name: String,
    from: Facet,
    to: Facet,
    occluders: Vec<Facet>,
    exact: f64,
    unoccluded: f64,
    mesh: Arc<PatchMesh>,
}

/// All pairs of polygons of the data.
fn pairs() -> Vec<Pair> {
    let text = include_str!("../data/view_factors.json");
    let root: Value = serde_json::from_str(text).expect("the reference data is JSON");
    let entries = root["references"].as_array().expect("a list of entries");
    let is_polygon = |surface: &Value| surface["type"] == "polygon";
    let pairs: Vec<Pair> = entries
        .iter()
        .filter(|entry| is_polygon(&entry["surf1"]) && is_polygon(&entry["surf2"]))
        .map(Pair::new)
        .collect();
    assert_eq!(pairs.len(), 53, "38 free pairs and 15 with occluders");
    pairs
}

impl Pair {
    fn new(entry: &Value) -> Self {
        let name = entry["id"].as_str().expect("entries have an id");
        let outline = |surface: &Value| corners(&surface["vertices"]);
        let (from, to) = (outline(&entry["surf1"]), outline(&entry["surf2"]));
        let occluders = entry["occluders"].as_array().into_iter().flatten();
        let occluders: Vec<Facet> = occluders.map(outline).collect();
        let surface = |name: &str, facet: &Facet| Surface::new(name, vec![facet.clone()], 0.5, 0.0);
        let mut scene = scene(name, &[surface("from", &from), surface("to", &to)]);
        for occluder in &occluders {
            add_absorber(&mut scene, "occluder", vec![occluder.clone()]);
        }
        let one_each = PatchOptions::whole_faces();
        let mesh = PatchMesh::build(Arc::new(scene), one_each).expect("it can be cut");
        let exact = entry["F12"].as_f64().expect("a factor");
        Self {
            name: name.into(),
            from,
            to,
            exact,
            unoccluded: entry["F12_unoccluded"].as_f64().unwrap_or(exact),
            occluders,
            mesh: Arc::new(mesh),
        }
    }

    fn is_free(&self) -> bool {
        self.occluders.is_empty()
    }

    /// Nodes of one of the polygons, which is more than one if it has more than four corners.
    fn nodes(&self, polygon: u32) -> Vec<NodeId> {
        let is_of = |&id: &NodeId| {
            let mut node = self.mesh.node(id);
            while let Some(parent) = node.parent {
                node = self.mesh.node(parent);
            }
            node.kind == NodeKind::Cluster { instance: polygon }
        };
        self.mesh.elements().iter().copied().filter(is_of).collect()
    }

    /// Positions of the elements of one of the polygons.
    fn elements(&self, polygon: u32) -> Vec<usize> {
        let nodes = self.nodes(polygon);
        let elements = 0..self.mesh.elements().len();
        elements
            .filter(|&e| nodes.contains(&self.mesh.elements()[e]))
            .collect()
    }

    /// Standard deviation of the factor from as many rays as this, that tell which share is hidden.
    fn shadow(&self, rays: f64) -> f64 {
        let seen = if self.unoccluded > 0.0 {
            self.exact / self.unoccluded
        } else {
            1.0
        };
        self.unoccluded * (seen * (1.0 - seen) / rays.max(1.0)).sqrt()
    }

    /// The factor of the pair and its standard error, of estimates from one part to all of the other polygon. Estimates of
    /// one part add up to one, so their errors may add up, too.
    fn estimate(&self, all: impl Fn(NodeId) -> Vec<Estimate>) -> (f64, f64) {
        let total: f64 = self.nodes(0).iter().map(|&id| self.area(id)).sum();
        let (mut factor, mut variance) = (0.0, 0.0);
        for id in self.nodes(0) {
            let weight = self.area(id) / total;
            for estimate in all(id) {
                factor += weight * f64::from(estimate.factor.g);
                variance += (weight * f64::from(estimate.standard_error.g)).powi(2);
            }
        }
        (factor, variance.sqrt())
    }

    /// Mean over the parts of the first polygon of `of(node)`, by their areas.
    fn mean(&self, of: impl Fn(NodeId) -> f64) -> f64 {
        let (mut area, mut sum) = (0.0, 0.0);
        for id in self.nodes(0) {
            let a = self.area(id);
            area += a;
            sum += a * of(id);
        }
        sum / area
    }

    /// The factor of the pair by rows.
    fn factor(&self, factors: &dyn FormFactors) -> f64 {
        let targets = self.nodes(1);
        self.mean(|id| {
            let mut row = Row::default();
            factors.fill_row(id, &mut row);
            let received = row.receivers.iter().zip(row.band(0));
            let to_target =
                received.filter(|(e, _)| targets.contains(&self.mesh.elements()[**e as usize]));
            to_target.map(|(_, &f)| f64::from(f)).sum()
        })
    }

    /// What rows of a method may be off by because they take the first polygon for so many Gauss points: the difference
    /// between the mean of the points' factors and the exact factor, and that mean's own standard error.
    fn error_of_points(&self, points: impl Fn(NodeId) -> usize) -> (f64, f64) {
        let rays = RayCast::new(self.mesh.clone(), RayCastOptions::default());
        let sampling = Sampling::default().with_rays(1 << 14);
        let mut variance = 0.0;
        let total: f64 = self.nodes(0).iter().map(|&id| self.area(id)).sum();
        let mut mean = 0.0;
        for id in self.nodes(0) {
            let normal = self.mesh.node(id).normal;
            for (point, weight) in gauss_points(&self.mesh.polygon(id), points(id)) {
                let weight = weight * self.area(id) / total;
                for to in self.nodes(1) {
                    let factor = rays.point_factor(point, normal, to, sampling);
                    mean += weight * f64::from(factor.factor.g);
                    variance += (weight * f64::from(factor.standard_error.g)).powi(2);
                }
            }
        }
        ((mean - self.exact).abs(), variance.sqrt())
    }

    fn area(&self, id: NodeId) -> f64 {
        f64::from(self.mesh.node(id).area)
    }

    /// Length in radians of all outlines that can be seen from a point, averaged over points of the first polygon. A convex
    /// outline is at most as long as a great circle.
    fn outlines(&self) -> f64 {
        let centre = self.from.iter().sum::<DVec3>() / self.from.len() as f64;
        let near_corners = self.from.iter().map(|&c| centre.lerp(c, 0.7));
        let points: Vec<DVec3> = near_corners.chain([centre]).collect();
        let all = || self.occluders.iter().chain([&self.to]);
        let length = |point: DVec3| -> f64 {
            let of = |polygon: &Facet| {
                let edges = (0..polygon.len()).map(|i| {
                    let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
                    (a - point).angle_between(b - point)
                });
                edges.sum::<f64>().min(2.0 * PI)
            };
            all().map(of).sum()
        };
        points.iter().map(|&p| length(p)).sum::<f64>() / points.len() as f64
    }
}

/// Points and weights of Gauss quadrature, 1, 4 or 16 of them, on a triangle or a quad.
fn gauss_points(polygon: &[Vec3], count: usize) -> Vec<(Vec3, f64)> {
    let rule: &[(f32, f64)] = match count {
        1 => return vec![(polygon.iter().sum::<Vec3>() / polygon.len() as f32, 1.0)],
        4 => &[(0.211_324_87, 0.5), (0.788_675_1, 0.5)],
        16 => &[
            (0.069_431_84, 0.173_927_422_568_726_93),
            (0.330_009_5, 0.326_072_577_431_273_07),
            (0.669_990_5, 0.326_072_577_431_273_07),
            (0.930_568_16, 0.173_927_422_568_726_93),
        ],
        _ => panic!("{count} points"),
    };
    let [a, b, c] = [polygon[0], polygon[1], polygon[2]];
    let d = polygon.get(3).copied().unwrap_or(a);
    let mut points = Vec::new();
    for &(u, wu) in rule {
        for &(v, wv) in rule {
            let along_u = (b - a).lerp(c - d, v);
            let along_v = (d - a).lerp(c - b, u);
            let point = a.lerp(b, u).lerp(d.lerp(c, u), v);
            let jacobian = f64::from(along_u.cross(along_v).length());
            points.push((point, wu * wv * jacobian));
        }
    }
    let sum: f64 = points.iter().map(|&(_, w)| w).sum();
    points.iter().map(|&(p, w)| (p, w / sum)).collect()
}

/// Asserts a bound, and prints how much of it is used.
#[track_caller]
fn assert_within(what: &str, error: f64, bound: f64, parts: &str) {
    println!("{what:40} off by {error:+.1e}, bound {bound:.1e} ({parts})");
    assert!(
        error.abs() <= bound,
        "{what}: off by {error:.2e}, {bound:.2e} are allowed ({parts})"
    );
}

/// The bound has two parts.
///
/// *Points*: rows of near polygons are means over 16 points. What the exact factors of the points miss is the method's
/// proximity error, and is computed here: free of noise where nothing is hidden, else with its own error.
///
/// *Cells*: a cell is wrong only if an outline crosses it. An outline of ℓ radians crosses about `4/π · ℓ N/2` of the cells, 2/N
/// wide in the middle of the top, which pass at most `4/πN²` each, and is wrong by half of one, this way or that way:
/// `σ = 1/2 √(2 ℓ N / π) · 4/πN²`. Five of them are allowed.
#[test]
fn hemicubes_of_512_cells_are_within_their_bounds() {
    let cells: f64 = 512.0;
    for pair in pairs() {
        let options = HemicubeOptions::default().with_resolution(512);
        let factors = Hemicube::new(pair.mesh.clone(), options).expect("the options are good");
        let (points, noise) = pair.error_of_points(|id| factors.points(id));
        let crossed = 2.0 / PI * pair.outlines() * cells;
        let sigma = 0.5 * crossed.sqrt() * 4.0 / (PI * cells * cells);
        let bound = points + Z * noise + 5.0 * sigma;
        let parts = format!("points {points:.1e} ± {noise:.0e}, cells {sigma:.1e}");
        let error = pair.factor(&factors) - pair.exact;
        assert_within(&format!("{}, hemicube", pair.name), error, bound, &parts);
    }
}

/// *Points* as for hemicubes. *Cells*: five of the standard deviations that the method states, for each outline; or those of
/// independent rays, where these are fewer.
#[test]
fn hemispheres_are_within_their_bounds() {
    let options = HemisphereOptions::default();
    for (i, pair) in (0..).zip(pairs()) {
        let factors = Hemisphere::new(pair.mesh.clone(), options.with_seed(i)).expect("good");
        let (points, noise) = pair.error_of_points(|id| factors.points(id));
        let outlines = (pair.outlines() / (2.0 * PI)).sqrt();
        let independent = (pair.unoccluded / f64::from(options.cells)).sqrt();
        let sigma = (hemisphere::bound(options.cells) * outlines).min(independent);
        let bound = points + Z * noise + 5.0 * sigma;
        let parts = format!("points {points:.1e} ± {noise:.0e}, cells {sigma:.1e}");
        let error = pair.factor(&factors) - pair.exact;
        assert_within(&format!("{}, hemisphere", pair.name), error, bound, &parts);
    }
}

/// *Points* as for hemicubes. *Shadow*: of what is hidden in part, five standard deviations of as many rays as
/// the pair gets. A ten-thousandth is for closing the row.
#[test]
fn nusselts_analog_is_within_its_bounds() {
    let options = NusseltOptions::default().with_rays(4096);
    for pair in pairs() {
        let factors = Nusselt::new(pair.mesh.clone(), options).expect("the options are good");
        let (points, noise) = pair.error_of_points(|id| factors.points(id));
        let shadow = pair.shadow(pair.unoccluded * f64::from(options.rays));
        let bound = points + Z * noise + 5.0 * shadow + 1e-4 * pair.exact + 1e-9;
        let parts = format!("points {points:.1e} ± {noise:.0e}, shadow {shadow:.1e}");
        let error = pair.factor(&factors) - pair.exact;
        assert_within(&format!("{}, Nusselt", pair.name), error, bound, &parts);
    }
}

/// Pairs: only what is hidden in part is uncertain, by five standard deviations of 64 rays; else a thousandth is
/// asked, for the slivers among them, and half a percent where the row takes a chink that small for none. Shots: five binomial standard deviations, and three rays where next to none hit.
#[test]
fn cast_rows_are_within_their_bounds() {
    for (seed, pair) in (0..).zip(pairs()) {
        let cast = |strategy| {
            let options = RayCastOptions {
                rays: 4096,
                strategy,
                seed,
                shot_rays: None,
            };
            let factors = RayCast::new(pair.mesh.clone(), options);
            (pair.factor(&factors) - pair.exact, factors.rays() as f64)
        };
        let (error, _) = cast(Strategy::Pairs);
        let shadow = pair.shadow(64.0);
        let chink = if pair.exact > 0.995 { 5e-3 } else { 0.0 };
        let bound = 5.0 * shadow + 1e-3 * pair.exact + chink;
        let parts = format!("shadow {shadow:.1e}");
        assert_within(&format!("{}, pairs", pair.name), error, bound, &parts);
        let (error, rays) = cast(Strategy::Shots);
        let sigma = (pair.exact * (1.0 - pair.exact) / rays).sqrt();
        let bound = 5.0 * sigma + 3.0 / rays;
        let parts = format!("{rays} rays, {sigma:.1e}");
        assert_within(&format!("{}, shots", pair.name), error, bound, &parts);
    }
}

/// Standard errors that are allowed: of 16 replicates, one in a thousand lies farther off.
const Z: f64 = 4.1;

/// Estimates are as good as they say: none is farther off than [`Z`] of its standard errors, and all together are off by about
/// one. Where nothing is hidden, those of areas are exact.
#[test]
fn estimates_know_their_errors() {
    for sampler in Sampler::ALL {
        let (mut areas, mut rows) = (Scores::default(), Scores::default());
        for (seed, pair) in (0..).zip(pairs()) {
            let sampling = Sampling::default().with_sampler(sampler).with_seed(seed);
            let rays = f64::from(sampling.rays);
            let factors = RayCast::new(pair.mesh.clone(), RayCastOptions::default());
            let what = |kind: &str| format!("{}, {kind}, {}", pair.name, sampler.name());

            let all = |from: NodeId| -> Vec<Estimate> {
                let one = |&to: &NodeId| factors.area_factor(from, to, sampling);
                pair.nodes(1).iter().map(one).collect()
            };
            let (found, error) = pair.estimate(all);
            if pair.is_free() {
                assert_eq!(error, 0.0, "{}: nothing is hidden", pair.name);
            }
            let off = found - pair.exact;
            let bound = Z * error + 5e-4 * pair.exact;
            assert_within(&what("area"), off, bound, &format!("{error:.1e}"));
            areas.add(off, error);

            let all = |from: NodeId| -> Vec<Estimate> {
                let row = factors.estimated_row(from, sampling);
                pair.elements(1).iter().map(|&e| row.factor(e)).collect()
            };
            let (found, error) = pair.estimate(all);
            let off = found - pair.exact;
            // Where next to none hit, the error is not known.
            let bound = Z * error + 3.0 / rays;
            assert_within(&what("row"), off, bound, &format!("{error:.1e}"));
            if pair.exact * rays > 10.0 {
                rows.add(off, error);
            }
        }
        areas.assert_honest(&format!("areas, {}", sampler.name()));
        rows.assert_honest(&format!("rows, {}", sampler.name()));
    }
}

/// Errors in units of their standard errors.
#[derive(Default)]
struct Scores(Vec<f64>);

impl Scores {
    fn add(&mut self, off: f64, error: f64) {
        if error > 0.0 {
            self.0.push(off / error);
        }
    }

    /// The mean square of Student's distribution with 15 degrees of freedom is 15/13, its standard deviation over n values
    /// about 1.9/√n; four of those are allowed.
    fn assert_honest(&self, what: &str) {
        let n = self.0.len() as f64;
        let mean_square = self.0.iter().map(|z| z * z).sum::<f64>() / n;
        let spread = 4.0 * 1.9 / n.sqrt();
        println!("{what}: {n} values, mean square {mean_square:.2}");
        assert!(n >= 10.0, "{what}: only {n} values");
        assert!(
            (mean_square - 15.0 / 13.0).abs() < spread,
            "{what}: mean square {mean_square} of {n} values, 1.15 ± {spread:.2} is right"
        );
    }
}

/// Unit squares at distance 1 with a smaller one half way, of which each point's shadow is a rectangle.
#[test]
fn points_and_vertices_know_their_errors() {
    let square = |low: f64, high: f64, z: f64| {
        let corner = |x: f64, y: f64| DVec3::new(x, y, z);
        vec![
            corner(low, low),
            corner(high, low),
            corner(high, high),
            corner(low, high),
        ]
    };
    let (from, mut to) = (square(0.0, 1.0, 0.0), square(0.0, 1.0, 1.0));
    to.reverse();
    let surface = |name: &str, facet: &Facet| Surface::new(name, vec![facet.clone()], 0.5, 0.0);
    let mut scene = scene(
        "screen",
        &[surface("floor", &from), surface("ceiling", &to)],
    );
    add_absorber(&mut scene, "screen", vec![square(0.2, 0.6, 0.5)]);
    let mesh = PatchMesh::build(
        Arc::new(scene),
        PatchOptions::default().with_element_size(100.0),
    );
    let mesh = Arc::new(mesh.expect("it can be cut"));
    // What a point of the floor gets from the ceiling: all, less what comes through the screen's shadow on it.
    let exact = |point: DVec3| {
        let clamp = |x: f64, at: f64| (2.0 * x - at).clamp(0.0, 1.0);
        let (x0, x1) = (clamp(0.2, point.x), clamp(0.6, point.x));
        let (y0, y1) = (clamp(0.2, point.y), clamp(0.6, point.y));
        let at = |x: f64, y: f64| DVec3::new(x, y, 1.0);
        let shadow = [at(x0, y0), at(x0, y1), at(x1, y1), at(x1, y0)];
        let factor = |polygon: &[DVec3]| nusselt::element_to_polygon(point, DVec3::Z, polygon);
        let hidden = if x1 > x0 && y1 > y0 {
            factor(&shadow)
        } else {
            0.0
        };
        factor(&to) - hidden
    };
    let factors = RayCast::new(mesh.clone(), RayCastOptions::default());
    let (ceiling, normal) = (mesh.elements()[1], mesh.node(mesh.elements()[0]).normal);
    for sampler in Sampler::ALL {
        let sampling = Sampling::default().with_sampler(sampler);
        let (mut points, mut rows) = (Scores::default(), Scores::default());
        let check = |found: Estimate, exact: f64, scores: Option<&mut Scores>, what: &str| {
            let (off, error) = (
                f64::from(found.factor.g) - exact,
                f64::from(found.standard_error.g),
            );
            assert_within(what, off, Z * error + 2e-5, &format!("{error:.1e}"));
            if let Some(scores) = scores {
                scores.add(off, error);
            }
        };
        for i in 0..25_u8 {
            let point = DVec3::new(f64::from(i % 5), f64::from(i / 5), 0.0) / 5.0
                + 0.1 * DVec3::new(1.0, 1.0, 0.0);
            let what = |kind: &str| {
                format!(
                    "{kind} at {:.1}, {:.1}, {}",
                    point.x,
                    point.y,
                    sampler.name()
                )
            };
            let at = y_up(point);
            let found = factors.point_factor(at, normal, ceiling, sampling);
            check(found, exact(point), Some(&mut points), &what("factor"));
            let row = factors.point_row(at, normal, sampling);
            check(row.factor(1), exact(point), Some(&mut rows), &what("row"));
            let sum = row.factors.iter().chain([&row.absorbed, &row.escaped]);
            let sum: f32 = sum.map(|estimate| estimate.factor.g).sum();
            assert!(
                (sum - 1.0).abs() < 1e-5,
                "{}: it sums to {sum}",
                what("row")
            );
        }
        points.assert_honest(&format!("points, {}", sampler.name()));
        rows.assert_honest(&format!("rows of points, {}", sampler.name()));
        let corners = factors.vertex_factors(0, ceiling, sampling);
        for (found, &corner) in corners.iter().zip(&from) {
            let what = format!("vertex {corner}, {}", sampler.name());
            // They are a little within the corner.
            check(*found, exact(corner), None, &what);
        }
    }
}
