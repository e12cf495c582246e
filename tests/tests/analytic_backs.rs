//! What sides take that only absorb, by exact factors: the sky gets the rest, to the last digit.

use glam::DVec3;
use hemicube::radiosity::form_factor::{
    Analytic, AnalyticOptions, MatrixOptions, Surfaces, SurfacesBy, ViewFactorMatrix,
};
use hemicube::radiosity::stop::NEVER;
use hemicube::radiosity::{FormFactors, PatchMesh, PatchOptions, RayCast, RayCastOptions, Row};
use hemicube_tests::shapes::Facet;
use hemicube_tests::surfaces::{Surface, exchange_area, scene};
use std::sync::Arc;

/// Parallel unit squares at distance 1, Howell C-11.
const PARALLEL: f64 = 0.199_824_895_698_387_46;

/// A rectangle that looks up.
fn rectangle([x0, y0]: [f64; 2], [x1, y1]: [f64; 2], z: f64) -> Facet {
    [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        .map(|(x, y)| DVec3::new(x, y, z))
        .to_vec()
}

/// The unit square at a height in so many parts a side.
fn square(z: f64, parts: u32) -> Vec<Facet> {
    let at = |i: u32| f64::from(i) / f64::from(parts);
    let part = |i: u32| {
        let (x, y) = (i % parts, i / parts);
        rectangle([at(x), at(y)], [at(x + 1), at(y + 1)], z)
    };
    (0..parts * parts).map(part).collect()
}

/// The floor, a unit square that looks up, with other surfaces; it has the first elements.
fn over_the_floor(others: &[(&str, Vec<Facet>)], element_size: f32) -> Arc<PatchMesh> {
    let mut surfaces = vec![Surface::new("floor", square(0.0, 1), 0.5, 0.0)];
    for (name, facets) in others {
        surfaces.push(Surface::new(*name, facets.clone(), 0.5, 0.0));
    }
    let options = PatchOptions::default().with_element_size(element_size);
    let mesh = PatchMesh::build(Arc::new(scene("backs", &surfaces)), options);
    Arc::new(mesh.expect("it can be cut"))
}

fn analytic(mesh: &Arc<PatchMesh>) -> Analytic {
    Analytic::new(mesh.clone(), AnalyticOptions::default()).expect("good options")
}

/// Absorbed and escaped share of the floor.
fn lost_by(factors: &dyn FormFactors) -> [f64; 2] {
    let mesh = factors.mesh().clone();
    let (mut sums, mut whole) = ([0.0; 2], 0.0);
    let mut row = Row::default();
    for &patch in mesh
        .patches()
        .iter()
        .filter(|&&id| mesh.node(id).centroid.y == 0.0)
    {
        factors.fill_row(patch, &mut row);
        let area = f64::from(mesh.node(patch).area);
        sums[0] += area * f64::from(row.absorbed[0]);
        sums[1] += area * f64::from(row.escaped[0]);
        whole += area;
    }
    sums.map(|sum| sum / whole)
}

#[test]
fn a_square_that_turns_its_back_takes_its_exact_share() {
    for (parts, size) in [(1, 1e6), (1, 0.26), (20, 0.51)] {
        let mesh = over_the_floor(&[("lid", square(1.0, parts))], size);
        let [absorbed, escaped] = lost_by(&analytic(&mesh));
        let name = format!("{parts} parts, elements of {size}");
        assert!((absorbed - PARALLEL).abs() < 1e-6, "{name}: {absorbed}");
        assert!((absorbed + escaped - 1.0).abs() < 1e-6, "{name}: {escaped}");
    }
}

#[test]
fn matrices_of_all_rows_say_the_same() {
    let mesh = over_the_floor(&[("lid", square(1.0, 1))], 0.26);
    let surfaces = Surfaces::new(&mesh, SurfacesBy::Object);
    let options = MatrixOptions::default();
    let matrix = ViewFactorMatrix::build_by(&analytic(&mesh), &surfaces, options, NEVER);
    let matrix = matrix.expect("it fits");
    let absorbed = matrix.absorbed()[0];
    assert!((absorbed - PARALLEL).abs() < 1e-6, "{absorbed}");
}

/// The lid hides behind a shelf that receives: rays tell the same to their error.
#[test]
fn hidden_parts_of_backs_take_nothing() {
    let shelf = rectangle([0.0, 0.0], [0.6, 1.0], 0.5);
    let down: Facet = shelf.into_iter().rev().collect();
    let mesh = over_the_floor(&[("lid", square(1.0, 1)), ("shelf", vec![down])], 1e6);
    let exact = lost_by(&analytic(&mesh));
    let many = RayCastOptions {
        rays: 1 << 16,
        ..RayCastOptions::default()
    };
    let rays = lost_by(&RayCast::new(mesh, many));
    for (exact, rays) in exact.into_iter().zip(rays) {
        assert!((exact - rays).abs() < 3e-3, "{exact}, by rays {rays}");
    }
}

/// More sides than are all computed: those that rays met are, and what the others take is estimated.
#[test]
fn many_small_backs_are_near_their_sum() {
    let place = |i: u32| {
        let (x, y) = (f64::from(i % 12), f64::from(i / 12));
        rectangle(
            [0.15 * x - 0.4, 0.15 * y - 0.4],
            [0.15 * x - 0.35, 0.15 * y - 0.32],
            0.4 + 0.05 * f64::from(i * 7 % 5),
        )
    };
    let crumbs: Vec<Facet> = (0..144).map(place).collect();
    let floor = square(0.0, 1);
    // Turned round they would receive; none hides another.
    let down = |facet: &Facet| vec![facet.iter().rev().copied().collect::<Facet>()];
    let exact: f64 = crumbs.iter().map(|c| exchange_area(&floor, &down(c))).sum();
    let mesh = over_the_floor(&[("crumbs", crumbs)], 1e6);
    let [absorbed, _] = lost_by(&analytic(&mesh));
    assert!((absorbed - exact).abs() < 0.02, "{absorbed}, exact {exact}");
}
