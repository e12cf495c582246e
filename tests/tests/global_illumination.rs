//! Global illumination with known solutions: furnaces, one patch to a face, plates, spheres, cavities, ducts, rooms.
//!
//! `data/global_illumination.json` says of each case what it needs, its values, how those were checked and the tolerance
//! that is asked here. What needs mirrors or a medium is left out, by name.

use glam::DVec3;
use hemicube::radiosity::form_factor::{MatrixOptions, ViewFactorMatrix};
use hemicube::radiosity::solve::ambient::ambient_irradiance;
use hemicube::radiosity::solve::{MatrixRun, MatrixSolverKind, solve_matrix};
use hemicube::radiosity::{
    FormFactors, GatherOptions, Gatherer, NodeId, Order, PatchMesh, PatchOptions, RayCast,
    RayCastOptions, Row, Shooting, Solution, SolveOptions, Solver, solve,
};
use hemicube::raster::Rgb;
use hemicube::scene::Scene;
use hemicube_tests::shapes::{Facet, Radiates, sphere};
use hemicube_tests::surfaces::{Surface, add_point_light, exact_matrix, scene, vector, y_up};
use serde_json::Value;
use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::sync::Arc;

const FURNACES: [&str; 3] = [
    "gi-furnace-box-0.7",
    "gi-furnace-box-0.95",
    "gi-furnace-Lroom-0.5",
];
const ZONAL: [&str; 3] = [
    "gi-zonal-cube-goral",
    "gi-zonal-office",
    "gi-zonal-colour-walls",
];
const PLATES: [&str; 3] = ["gi-plates-1x1x1", "gi-plates-2x3x0.7", "gi-perp-1x1"];
const INFINITE_PLATES: &str = "gi-infinite-plates-a";
const DUCTS: [&str; 2] = ["gi-duct-345", "gi-duct-equilateral"];
const CONCENTRIC: [&str; 2] = ["gi-concentric-spheres-1-2", "gi-concentric-spheres-1-1.3"];
const CAPS: [&str; 2] = ["gi-sphere-cap10-port", "gi-sphere-cap25"];
const CAVITIES: [&str; 2] = ["gi-cavity-f0.1-r0.8", "gi-cavity-f0.02-r0.5"];
const CONVEX_IN_SKY: &str = "gi-envfurnace-convex";
const WHITE_IN_SKY: &str = "gi-envfurnace-white-nonconvex";
const ROOMS: [&str; 4] = [
    "gi-box-cube4-rho0.5-point",
    "gi-box-cube4-rho0.9-point",
    "gi-box-cube1-ceiling-emits",
    "gi-globillum-empty",
];

fn cases() -> Vec<Value> {
    let text = include_str!("../data/global_illumination.json");
    let root: Value = serde_json::from_str(text).expect("the reference data is JSON");
    root["cases"].as_array().expect("a list of cases").clone()
}

fn case(id: &str) -> Value {
    let found = cases().into_iter().find(|case| case["id"] == id);
    found.unwrap_or_else(|| panic!("no case {id} in the data"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn numbers(value: &Value) -> Vec<f64> {
    let values = value.as_array().expect("a list").iter();
    values.map(number).collect()
}

/// The relative tolerance that a case asks for.
fn tolerance(case: &Value) -> f64 {
    number(&case["tolerance"]["rel"])
}

#[track_caller]
fn assert_relative(found: f64, exact: f64, tolerance: f64, what: &str) {
    let error = (found / exact - 1.0).abs();
    assert!(
        error <= tolerance,
        "{what}: {found} instead of {exact}, off by {error:.1e}, {tolerance:.0e} is asked"
    );
}

/// As [`assert_relative`], relative to the largest of the expected values.
#[track_caller]
fn assert_close(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}: as many values");
    let most = expected.iter().copied().fold(0.0, f64::max);
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!(
            (a - b).abs() <= tolerance * most,
            "{what}, patch {i}: {a} instead of {b}"
        );
    }
}

fn options(elements: usize, patches: usize, tolerance: f64) -> SolveOptions {
    SolveOptions {
        mesh: PatchOptions::default()
            .with_elements(elements)
            .with_patches(patches),
        tolerance,
        ..SolveOptions::default()
    }
}

/// For spheres of 2048 facets: a few rays from each tell more than many from some.
fn many_facets() -> SolveOptions {
    SolveOptions {
        rays: 100,
        ..options(1, 1, 2e-3)
    }
}

fn solved(scene: Scene, options: &SolveOptions) -> Solution {
    solve(Arc::new(scene), options, |_, _| true).expect("the scene can be solved")
}

/// Area and mean radiosity of the elements of one node of the scene.
fn mean_of_surface(solution: &Solution, name: &str, of: impl Fn(usize) -> f64) -> (f64, f64) {
    let mesh = solution.mesh();
    let (mut area, mut sum) = (0.0, 0.0);
    for e in 0..mesh.elements().len() {
        if element_name(mesh, e).starts_with(name) {
            let a = f64::from(mesh.exposed_area(e));
            area += a;
            sum += a * of(e);
        }
    }
    assert!(area > 0.0, "there is a surface {name}");
    (area, sum / area)
}

/// Name of the scene's node that an element is of.
fn element_name(mesh: &PatchMesh, element: usize) -> &str {
    let mut node = mesh.node(mesh.elements()[element]);
    while let Some(parent) = node.parent {
        node = mesh.node(parent);
    }
    let hemicube::radiosity::patch::NodeKind::Cluster { instance } = node.kind else {
        unreachable!("roots are clusters")
    };
    &mesh.scene().instances[instance as usize].node
}

#[test]
fn furnaces_are_uniform_and_so_is_every_bounce() {
    for id in FURNACES {
        let case = case(id);
        let surfaces = Surface::list(&case["scene"]["surfaces"]);
        let exact = number(&case["reference"]["B"]);
        let bounces = numbers(&case["reference"]["bounce_terms"]);

        let solution = solved(scene(id, &surfaces), &options(300, 100, 1e-7));
        let radiosity = |e: usize| f64::from(solution.element_radiosity(e).g);
        let irradiance = |e: usize| f64::from(solution.element_irradiance(e).g);
        let (_, mean) = mean_of_surface(&solution, "", radiosity);
        assert_relative(mean, exact, tolerance(&case), &format!("{id}, mean"));
        // Shooting needs columns that sum to 1, too. Where something is hidden, those of cast factors do so to about
        // their noise; elements differ by that, their mean does not.
        let is_convex = surfaces.len() == 6;
        let tolerance_of_elements = if is_convex { tolerance(&case) } else { 1.5e-2 };
        for e in 0..solution.mesh().elements().len() {
            let what = format!("{id}, element {e}");
            assert_relative(radiosity(e), exact, tolerance_of_elements, &what);
            assert_relative(irradiance(e), exact, tolerance_of_elements, &what);
        }

        let options = RayCastOptions::default();
        let rays = RayCast::new(solution.mesh().clone(), options);
        let matrices = ViewFactorMatrix::build(&rays, MatrixOptions::default()).expect("it fits");
        let n = matrices[0].size();
        let emission = vec![surfaces[0].exitance; n];
        let reflectance = vec![surfaces[0].reflectance; n];
        let kind = MatrixSolverKind::Jacobi;
        let mut run = MatrixRun::new(&matrices[0], &emission, &reflectance, kind).expect("good");
        for (k, &exact) in bounces.iter().enumerate() {
            for &radiosity in run.radiosity() {
                let what = format!("{id}, {k} bounces");
                assert_relative(radiosity, exact, tolerance(&case), &what);
            }
            run.step();
        }
        for kind in MatrixSolverKind::ALL {
            let found = solve_matrix(&matrices[0], &emission, &reflectance, kind, 1e-9, 2000);
            for radiosity in found.expect("it is solvable").radiosity {
                let what = format!("{id}, {}", kind.name());
                assert_relative(radiosity, exact, tolerance(&case), &what);
            }
        }
    }
}

/// Rows of a matrix for a mesh whose patches are its elements.
struct Given {
    mesh: Arc<PatchMesh>,
    matrix: ViewFactorMatrix,
}

impl FormFactors for Given {
    fn mesh(&self) -> &Arc<PatchMesh> {
        &self.mesh
    }

    fn fill_row(&self, source: NodeId, row: &mut Row) {
        row.clear(1);
        let patch = self.mesh.patch_of_node(source).expect("a patch");
        for (element, factor) in self.matrix.entries().row(patch) {
            row.receivers
                .push(u32::try_from(element).expect("few elements"));
            row.fractions.push(factor);
        }
    }
}

#[test]
fn one_patch_to_a_face_has_the_exact_factors_and_every_solver_its_iterates() {
    for id in ZONAL {
        let case = case(id);
        let (reference, tolerance) = (&case["reference"], tolerance(&case));
        let surfaces = Surface::list(&case["scene"]["surfaces"]);
        let matrix = exact_matrix(&surfaces);
        for (i, row) in reference["F"].as_array().expect("rows").iter().enumerate() {
            for (j, exact) in numbers(row).into_iter().enumerate() {
                let found = f64::from(matrix.get(i, j));
                // Ten printed digits, seven kept ones.
                assert!(
                    (found - exact).abs() < 6e-8 * exact.max(1e-3),
                    "{id}, F_{i}{j}: {found} instead of {exact}"
                );
            }
        }

        let emission: Vec<f64> = surfaces.iter().map(|s| s.exitance).collect();
        let reflectance: Vec<f64> = surfaces.iter().map(|s| s.reflectance).collect();
        let radiosity = surfaces.iter().map(|s| number(&reference["B"][&s.name]));
        let exact: Vec<f64> = radiosity.collect();
        for kind in MatrixSolverKind::ALL {
            let found = solve_matrix(&matrix, &emission, &reflectance, kind, 1e-10, 1000);
            let found = found.expect("it is solvable").radiosity;
            assert_close(&found, &exact, tolerance, &format!("{id}, {}", kind.name()));
        }
        for (kind, key) in [
            (MatrixSolverKind::Jacobi, "jacobi_sweeps_1_to_5"),
            (MatrixSolverKind::GaussSeidel, "gauss_seidel_sweeps_1_to_3"),
        ] {
            let mut run = MatrixRun::new(&matrix, &emission, &reflectance, kind).expect("good");
            for (sweep, expected) in reference[key]
                .as_array()
                .expect("sweeps")
                .iter()
                .enumerate()
            {
                run.step();
                let what = format!("{id}, {} sweep {}", kind.name(), sweep + 1);
                assert_close(run.radiosity(), &numbers(expected), tolerance, &what);
            }
        }
        shots_are_those_of_the_reference(id, &surfaces, matrix, reference, tolerance);
    }
}

/// Sorted shooting and the ambient term, on a scene with one element to a face.
fn shots_are_those_of_the_reference(
    id: &str,
    surfaces: &[Surface],
    matrix: ViewFactorMatrix,
    reference: &Value,
    tolerance: f64,
) {
    let one_each = PatchOptions::default().with_element_size(100.0);
    let mesh = PatchMesh::build(Arc::new(scene(id, surfaces)), one_each).expect("it can be cut");
    let factors = Given {
        mesh: Arc::new(mesh),
        matrix,
    };
    let n = surfaces.len();
    assert_eq!(factors.mesh.elements().len(), n, "{id}: one element a face");
    let dark = vec![Rgb::BLACK; n];
    let start = Solution::new(factors.mesh.clone(), &dark, Default::default());
    let mut shooting = Shooting::new(&factors, start, Order::Sorted);
    let shots = reference["shooting_sorted_first_6"].as_array();
    for (shot, expected) in shots.expect("shots").iter().enumerate() {
        let what = format!("{id}, shot {}", shot + 1);
        let next = &surfaces[shooting.next_patch()].name;
        assert_eq!(expected["shot"], next.as_str(), "{what}: who shoots");
        shooting.step();
        let solution = shooting.solution();
        let all =
            |of: &dyn Fn(usize) -> f32| -> Vec<f64> { (0..n).map(|e| f64::from(of(e))).collect() };
        let radiosity = all(&|e| solution.element_radiosity(e).g);
        assert_close(&radiosity, &numbers(&expected["B"]), tolerance, &what);
        let most = radiosity.iter().copied().fold(0.0, f64::max);
        let unshot = all(&|e| solution.unshot(0, 1)[e]);
        for (found, exact) in unshot.iter().zip(numbers(&expected["unshot"])) {
            assert!(
                (found - exact).abs() <= tolerance * most,
                "{what}: {found} unshot instead of {exact}"
            );
        }
        let ambient = f64::from(ambient_irradiance(solution).g);
        assert_relative(ambient, number(&expected["ambient"]), tolerance, &what);
    }
}

#[test]
fn two_plates_reflect_each_other() {
    for id in PLATES {
        let case = case(id);
        let reference = &case["reference"];
        let surfaces = Surface::list(&case["scene"]["surfaces"]);
        let matrix = exact_matrix(&surfaces);
        for (found, key) in [(matrix.get(0, 1), "F12"), (matrix.get(1, 0), "F21")] {
            assert_relative(
                f64::from(found),
                number(&reference[key]),
                tolerance(&case),
                id,
            );
        }
        assert_two_patches(&surfaces, &matrix, &case);
    }
}

/// Solves two patches by every method and compares with `B1` and `B2`.
fn assert_two_patches(surfaces: &[Surface], matrix: &ViewFactorMatrix, case: &Value) {
    let emission: Vec<f64> = surfaces.iter().map(|s| s.exitance).collect();
    let reflectance: Vec<f64> = surfaces.iter().map(|s| s.reflectance).collect();
    for kind in MatrixSolverKind::ALL {
        let found = solve_matrix(matrix, &emission, &reflectance, kind, 1e-10, 1000);
        let found = found.expect("it is solvable").radiosity;
        for (found, key) in found.iter().zip(["B1", "B2"]) {
            let what = format!("{} {key}, {}", case["id"], kind.name());
            assert_relative(
                *found,
                number(&case["reference"][key]),
                tolerance(case),
                &what,
            );
        }
    }
}

/// Plates of 1000 heights: the rim is 0.2 % of what leaves.
#[test]
fn very_wide_plates_are_nearly_infinite() {
    let case = case(INFINITE_PLATES);
    let (one, two) = (&case["scene"]["plate1"], &case["scene"]["plate2"]);
    let side = 1000.0;
    let square = |height: f64| {
        let corner = |x: f64, y: f64| DVec3::new(side * x, side * y, height);
        vec![
            corner(0.0, 0.0),
            corner(1.0, 0.0),
            corner(1.0, 1.0),
            corner(0.0, 1.0),
        ]
    };
    let mut upper = square(1.0);
    upper.reverse();
    let plate = |name: &str, facet: Facet, of: &Value| {
        Surface::new(
            name,
            vec![facet],
            number(&of["rho"]),
            number(&of["exitance"]),
        )
    };
    let surfaces = [plate("one", square(0.0), one), plate("two", upper, two)];
    assert_two_patches(&surfaces, &exact_matrix(&surfaces), &case);
}

/// Ducts 20,000 times as long as wide: what leaves through the ends is below 1e-4.
#[test]
fn very_long_ducts_obey_crossed_strings() {
    for id in DUCTS {
        let case = case(id);
        let lengths = numbers(&case["scene"]["side_lengths"]);
        let surfaces = duct(&case["scene"], &lengths, 20_000.0);
        let matrix = exact_matrix(&surfaces);
        let reference = &case["reference"];
        for (i, row) in reference["F"].as_array().expect("rows").iter().enumerate() {
            for (j, exact) in numbers(row).into_iter().enumerate() {
                let found = f64::from(matrix.get(i, j));
                assert!(
                    (found - exact).abs() <= tolerance(&case),
                    "{id}, F_{i}{j}: {found} instead of {exact}"
                );
            }
        }
        let emission: Vec<f64> = surfaces.iter().map(|s| s.exitance).collect();
        let reflectance: Vec<f64> = surfaces.iter().map(|s| s.reflectance).collect();
        let exact = numbers(&reference["B"]);
        for kind in MatrixSolverKind::ALL {
            let found = solve_matrix(&matrix, &emission, &reflectance, kind, 1e-10, 1000);
            let found = found.expect("it is solvable").radiosity;
            for (i, (found, exact)) in found.iter().zip(&exact).enumerate() {
                let what = format!("{id}, side {i}, {}", kind.name());
                assert_relative(*found, *exact, tolerance(&case), &what);
            }
        }
    }
}

/// The three sides of a triangular duct along y that look inwards.
fn duct(scene: &Value, lengths: &[f64], long: f64) -> Vec<Surface> {
    let [a, b, c] = *lengths else {
        panic!("a triangle has three sides")
    };
    // Side 0 from the origin along x, then counter-clockwise sides 1 and 2.
    let cosine = (a * a + c * c - b * b) / (2.0 * a * c);
    let apex = DVec3::new(c * cosine, 0.0, c * (1.0 - cosine * cosine).sqrt());
    let corners = [DVec3::ZERO, DVec3::X * a, apex];
    let (rho, exitance) = (numbers(&scene["rho"]), numbers(&scene["exitance"]));
    (0..3)
        .map(|i| {
            let (from, to) = (corners[i], corners[(i + 1) % 3]);
            let along = DVec3::Y * long;
            let facet = vec![from, to, to + along, from + along];
            Surface::new(format!("side {i}"), vec![facet], rho[i], exitance[i])
        })
        .collect()
}

/// A sphere of 32 × 64 facets, 2048 in all.
fn tessellated(radius: f64, side: Radiates) -> Vec<Facet> {
    sphere(DVec3::ZERO, radius, 0.0..PI, 32, 64, side)
}

#[test]
fn concentric_spheres_exchange_by_their_areas() {
    for id in CONCENTRIC {
        let case = case(id);
        let (inner, outer) = (
            &case["scene"]["inner_sphere"],
            &case["scene"]["outer_sphere"],
        );
        let surface = |name: &str, of: &Value, side| {
            let facets = tessellated(number(&of["radius"]), side);
            Surface::new(name, facets, number(&of["rho"]), number(&of["exitance"]))
        };
        let surfaces = [
            surface("inner", inner, Radiates::Outwards),
            surface("outer", outer, Radiates::Inwards),
        ];
        let solution = solved(scene(id, &surfaces), &many_facets());
        let radiosity = |e: usize| f64::from(solution.element_radiosity(e).g);
        let irradiance = |e: usize| f64::from(solution.element_irradiance(e).g);
        let (_, b1) = mean_of_surface(&solution, "inner", radiosity);
        let (_, b2) = mean_of_surface(&solution, "outer", radiosity);
        let (_, h1) = mean_of_surface(&solution, "inner", irradiance);
        println!("{id}: B1 {b1}, B2 {b2}, net {}", b1 - h1);
        for (found, key) in [(b1, "B1"), (b2, "B2"), (b1 - h1, "net_flux_per_area1")] {
            let exact = number(&case["reference"][key]);
            assert_relative(found, exact, tolerance(&case), &format!("{id}, {key}"));
        }
    }
}

#[test]
fn irradiance_in_a_sphere_is_the_same_everywhere() {
    for id in CAPS {
        let case = case(id);
        let (cap, rest) = (&case["scene"]["cap"], &case["scene"]["rest"]);
        let surfaces = cap_and_rest(number(&cap["half_angle_deg"]), 48, cap, rest);
        let solution = solved(scene(id, &surfaces), &many_facets());
        let (reference, tolerance) = (&case["reference"], tolerance(&case));
        let exact = number(&reference["H"]);
        let radiosity = |e: usize| f64::from(solution.element_radiosity(e).g);
        let irradiance = |e: usize| f64::from(solution.element_irradiance(e).g);
        for (name, key) in [("cap", "B_cap"), ("rest", "B_rest")] {
            let (_, found) = mean_of_surface(&solution, name, radiosity);
            let what = format!("{id}, {key}");
            assert_relative(found, number(&reference[key]), tolerance, &what);
            let (_, found) = mean_of_surface(&solution, name, irradiance);
            println!("{id} {name}: mean H {found}");
            assert_relative(found, exact, tolerance, &format!("{id}, mean H of {name}"));
        }
        let gatherer = Gatherer::new(&solution, GatherOptions::default());
        let mesh = solution.mesh();
        for &id in mesh.elements().iter().step_by(101) {
            let node = mesh.node(id);
            let found = f64::from(gatherer.irradiance(node.centroid, node.normal).g);
            let what = format!("{}, at {}", case["id"], node.centroid);
            assert_relative(found, exact, tolerance, &what);
        }
    }
}

/// A unit sphere that looks inwards, of so many facets around, cut at an angle in degrees from +z.
fn cap_and_rest(half_angle: f64, around: u32, cap: &Value, rest: &Value) -> [Surface; 2] {
    let angle = half_angle.to_radians();
    let rings = [angle, PI - angle].map(|a| ring_count(a, around));
    let facets = |angles, rings| sphere(DVec3::ZERO, 1.0, angles, rings, around, Radiates::Inwards);
    let surface = |name: &str, facets, of: &Value| {
        let exitance = of["exitance"].as_f64().unwrap_or(0.0);
        Surface::new(name, facets, number(&of["rho"]), exitance)
    };
    [
        surface("cap", facets(0.0..angle, rings[0]), cap),
        surface("rest", facets(angle..PI, rings[1]), rest),
    ]
}

/// Rings over an angle, about as wide as the facets around are long at the equator.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a small positive number"
)]
fn ring_count(angle: f64, around: u32) -> u32 {
    (0.5 * f64::from(around) * angle / PI).round().max(2.0) as u32
}

#[test]
fn cavities_reflect_less_than_their_walls() {
    for id in CAVITIES {
        let case = case(id);
        let open = number(&case["scene"]["opening_area_fraction"]);
        // A cap of area fraction f ends where (1 - cos) / 2 = f.
        let angle = (1.0 - 2.0 * open).acos();
        let walls = &case["scene"]["sphere"];
        let [_, walls] = cap_and_rest(angle.to_degrees(), 32, walls, walls);
        let mut scene = scene(id, &[walls]);
        scene.sky = Rgb::splat(100.0);
        let solution = solved(scene, &options(1, 1, 1e-4));
        let balance = solution.total_balance(1);
        let found = balance.escaped / balance.emitted;
        println!("{id}: {found}");
        let reference = &case["reference"];
        assert_relative(found, number(&reference["rho_eff"]), tolerance(&case), id);
        let absorbed = balance.absorbed / balance.emitted;
        assert_relative(
            absorbed,
            number(&reference["emissivity_eff"]),
            tolerance(&case),
            id,
        );
    }
}

#[test]
fn convex_bodies_under_a_sky_reflect_all_of_it_once() {
    let case = case(CONVEX_IN_SKY);
    let luminance = number(&case["scene"]["environment"]["luminance"]);
    let rho = number(&case["scene"]["rho"]);
    for (name, facets) in [
        ("box", cuboid(DVec3::new(2.0, 1.0, 3.0))),
        ("tetrahedron", tetrahedron()),
        ("sphere", tessellated(1.0, Radiates::Outwards)),
    ] {
        let scene = under_sky(name, facets, rho, luminance);
        let solution = solved(scene, &options(300, 100, 1e-4));
        assert_ratio(&solution, luminance, &case, name);
    }
}

/// All of the error is that of the rays to the sky: about 2 % with 2048 of them.
#[test]
fn white_bodies_vanish_in_a_uniform_sky() {
    let case = case(WHITE_IN_SKY);
    let luminance = number(&case["scene"]["environment"]["luminance"]);
    let rho = number(&case["scene"]["rho"]);
    for (name, facets) in [("L-prism", l_prism()), ("open box", open_box())] {
        let options = SolveOptions {
            rays: 1 << 17,
            ..options(1, 1, 1e-6)
        };
        let solution = solved(under_sky(name, facets, rho, luminance), &options);
        assert_ratio(&solution, luminance, &case, name);
    }
}

fn under_sky(name: &str, facets: Vec<Facet>, rho: f64, luminance: f64) -> Scene {
    let mut scene = scene(name, &[Surface::new(name, facets, rho, 0.0)]);
    scene.sky = (DVec3::splat(luminance).as_vec3().to_array()).into();
    scene
}

/// Radiosity of every element over π times the luminance of the sky.
fn assert_ratio(solution: &Solution, luminance: f64, case: &Value, name: &str) {
    let exact = number(&case["reference"]["ratio"]);
    let mut worst: f64 = 0.0;
    for e in 0..solution.mesh().elements().len() {
        let found = f64::from(solution.element_radiosity(e).g) / (PI * luminance);
        worst = worst.max((found / exact - 1.0).abs());
    }
    println!("{name}: an element is off by {worst:.1e}");
    assert!(
        worst <= tolerance(case),
        "{name}: an element is off by {worst:.1e}"
    );
}

/// The outside of a prism over a base in z = 0, counter-clockwise from above.
fn prism(base: &[(f64, f64)], height: f64) -> Vec<Facet> {
    let at = |(x, y): (f64, f64), z: f64| DVec3::new(x, y, z);
    let top: Facet = base.iter().map(|&p| at(p, height)).collect();
    let bottom: Facet = base.iter().rev().map(|&p| at(p, 0.0)).collect();
    let side = |i: usize| {
        let (p, q) = (base[i], base[(i + 1) % base.len()]);
        vec![at(p, 0.0), at(q, 0.0), at(q, height), at(p, height)]
    };
    let sides = (0..base.len()).map(side);
    [top, bottom].into_iter().chain(sides).collect()
}

fn cuboid(size: DVec3) -> Vec<Facet> {
    prism(
        &[(0.0, 0.0), (size.x, 0.0), (size.x, size.y), (0.0, size.y)],
        size.z,
    )
}

fn l_prism() -> Vec<Facet> {
    let base = [
        (0.0, 0.0),
        (2.0, 0.0),
        (2.0, 1.0),
        (1.0, 1.0),
        (1.0, 2.0),
        (0.0, 2.0),
    ];
    prism(&base, 1.0)
}

/// A box without a lid, with walls of some thickness.
fn open_box() -> Vec<Facet> {
    let outer = cuboid(DVec3::ONE);
    // The rim in four strips, then the hollow: what looks outwards there is turned inwards.
    let (t, w) = (0.1, 0.8);
    let strip = |x: f64, y: f64, dx: f64, dy: f64| {
        let at = |x: f64, y: f64| DVec3::new(x, y, 1.0);
        vec![at(x, y), at(x + dx, y), at(x + dx, y + dy), at(x, y + dy)]
    };
    let rim = [
        strip(0.0, 0.0, 1.0, t),
        strip(0.0, 1.0 - t, 1.0, t),
        strip(0.0, t, t, w),
        strip(1.0 - t, t, t, w),
    ];
    let mut facets: Vec<Facet> = outer.into_iter().skip(1).chain(rim).collect();
    for mut facet in cuboid(DVec3::new(w, w, 1.0 - t)).into_iter().skip(1) {
        facet.reverse();
        facet.iter_mut().for_each(|p| *p += DVec3::splat(t));
        facets.push(facet);
    }
    facets
}

fn tetrahedron() -> Vec<Facet> {
    let [a, b, c, d] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    vec![vec![a, c, b], vec![a, b, d], vec![b, c, d], vec![c, a, d]]
}

#[test]
fn rooms_have_their_light_at_points_and_on_faces() {
    for id in ROOMS {
        let case = case(id);
        let surfaces = Surface::list(&case["scene"]["surfaces"]);
        let mut scene = scene(id, &surfaces);
        for light in case["scene"]["point_sources"]
            .as_array()
            .into_iter()
            .flatten()
        {
            add_point_light(
                &mut scene,
                vector(&light["pos"]),
                number(&light["dist"]["flux_lm"]),
            );
        }
        let solution = solved(scene, &options(2500, 600, 1e-4));
        let gatherer = Gatherer::new(&solution, GatherOptions::default());
        let mut worst: f64 = 0.0;
        for (name, exact) in case["reference"]["points"].as_object().expect("points") {
            let at = &case["points"][name];
            let (point, normal) = (y_up(vector(&at["p"])), y_up(vector(&at["n"])));
            let found = f64::from(gatherer.irradiance(point, normal).g);
            let what = format!("{id}, point {name}");
            worst = worst.max((found / number(exact) - 1.0).abs());
            println!("{what}: {found} for {exact}");
            assert_relative(found, number(exact), tolerance(&case), &what);
        }
        for (name, exact) in case["reference"]["face_mean"].as_object().expect("faces") {
            let of = |e: usize| f64::from(solution.element_irradiance(e).g);
            let (_, found) = mean_of_surface(&solution, name, of);
            worst = worst.max((found / number(exact) - 1.0).abs());
            println!("{id}, mean of {name}: {found} for {exact}");
            assert_relative(
                found,
                number(exact),
                tolerance(&case),
                &format!("{id}, mean of {name}"),
            );
        }
        println!("{id}: largest error {worst:.1e}");
    }
}

#[test]
fn every_case_is_tested_or_left_out_by_name() {
    let tested: BTreeSet<&str> = [FURNACES, ZONAL, PLATES]
        .into_iter()
        .flatten()
        .chain([DUCTS, CONCENTRIC, CAPS, CAVITIES].into_iter().flatten())
        .chain([INFINITE_PLATES, CONVEX_IN_SKY, WHITE_IN_SKY])
        .chain(ROOMS)
        .collect();
    let mut left_out = 0;
    for case in cases() {
        let id = case["id"].as_str().expect("cases have an id");
        if tested.contains(id) {
            continue;
        }
        let needs = case["needs"].to_string();
        let is_beyond = ["specular", "medium"]
            .iter()
            .any(|what| needs.contains(what));
        assert!(is_beyond, "{id} needs only {needs} and is not tested");
        println!("left out: {id}, it needs {needs}");
        left_out += 1;
    }
    assert_eq!(
        (tested.len(), left_out),
        (24, 6),
        "cases tested and left out"
    );
}
