//! Form factors by hemicubes against exact values, rays and themselves.

use hemicube::radiosity::form_factor::hemicube::{
    CubeFace, DeltaFactors, Hemicube, HemicubeOptions, ItemBuffers, Projection,
};
use hemicube::radiosity::form_factor::raycast::Strategy;
use hemicube::radiosity::{
    FormFactors, Order, PatchMesh, PatchOptions, RayCast, RayCastOptions, Row, Shooting, Solution,
    Solver,
};
use hemicube::raster::Rgb;
use hemicube::scene::{Scene, builtin};
use std::sync::Arc;

const PARALLEL: (&str, f64) = ("parallel-plates", 0.199_824_895_698);
const PERPENDICULAR: (&str, f64) = ("perpendicular-plates", 0.200_043_776_075);

fn mesh_of(scene: Scene, options: PatchOptions) -> Arc<PatchMesh> {
    Arc::new(PatchMesh::build(Arc::new(scene), options).expect("the scene can be cut"))
}

fn built_in(name: &str, options: PatchOptions) -> Arc<PatchMesh> {
    mesh_of(builtin::scene(name).expect("it is built in"), options)
}

fn one_element_a_face() -> PatchOptions {
    PatchOptions::default().with_element_size(100.0)
}

fn hemicube(mesh: &Arc<PatchMesh>, resolution: u32, max_points: u32) -> Hemicube {
    let options = HemicubeOptions::default()
        .with_resolution(resolution)
        .with_max_points(max_points);
    Hemicube::new(mesh.clone(), options).expect("the options are good")
}

fn row(factors: &dyn FormFactors, patch: usize) -> Row {
    let mut row = Row::default();
    factors.fill_row(factors.mesh().patches()[patch], &mut row);
    row
}

/// Signed error of the factor from the first to the second of two unit squares.
fn error_of_squares((scene, exact): (&str, f64), resolution: u32, max_points: u32) -> f64 {
    let mesh = built_in(scene, one_element_a_face());
    let row = row(&hemicube(&mesh, resolution, max_points), 0);
    assert_eq!(
        row.receivers,
        [1],
        "{scene}: only the other square receives"
    );
    f64::from(row.fractions[0]) - exact
}

#[test]
fn delta_factors_sum_to_one() {
    for resolution in [16, 64, 256, 1000] {
        let deltas = DeltaFactors::new(resolution).expect("a good resolution");
        let n = resolution as usize;
        let mut sum = 0.0;
        for face in CubeFace::ALL {
            let viewport = face.viewport(n);
            for y in 0..viewport.height {
                for x in 0..viewport.width {
                    let delta = deltas.at(face, x, y);
                    assert!(delta > 0.0, "{resolution}: cell {x}, {y} of {face:?}");
                    sum += delta;
                }
            }
        }
        assert!(
            (sum - 1.0).abs() < 1e-11 && (deltas.sum() - 1.0).abs() < 1e-14,
            "{resolution}: {sum} cell by cell"
        );
    }
}

/// The other projections: sums, and single cells against `cos cos A / π r²` at their middle, good to a percent where a cell
/// is small against its distance.
#[test]
fn other_projections_have_their_own_delta_factors() {
    for projection in Projection::ALL {
        for resolution in [16, 64, 256] {
            let deltas = DeltaFactors::of(projection, resolution).expect("a good resolution");
            let n = resolution as usize;
            let (mut sum, mut cells) = (0.0, 0.0);
            for &face in projection.faces() {
                let viewport = face.viewport(n);
                for y in 0..viewport.height {
                    for x in 0..viewport.width {
                        let delta = deltas.at(face, x, y);
                        assert!(
                            delta >= 0.0,
                            "{projection:?}: {delta} in cell {x}, {y} of {face:?}"
                        );
                        sum += delta;
                        cells += f64::from(u8::from(delta > 0.0));
                    }
                }
            }
            assert!(
                (sum - 1.0).abs() < 1e-11,
                "{projection:?}, {resolution}: {sum}"
            );
            // Of the tetrahedron's face half a row more is in it.
            let stated = projection.cells(resolution);
            assert!(
                (stated..stated * 1.07).contains(&cells),
                "{projection:?}, {resolution}: {cells} cells, {stated} are stated"
            );
        }
    }
    let deltas = DeltaFactors::of(Projection::CubicTetrahedron, 64).expect("good");
    let at = |i: usize| 3.0 * (i as f64 + 0.5) / 64.0 - 2.0;
    for (column, row) in [(63, 0), (40, 10), (63, 60), (32, 20), (50, 48)] {
        let (x, y) = (at(column), at(63 - row));
        let r2 = 1.0 + x * x + y * y;
        let area = (3.0_f64 / 64.0).powi(2);
        let exact = (x + y + 1.0) / 3.0_f64.sqrt() * area / (std::f64::consts::PI * r2 * r2);
        let found = deltas.at(CubeFace::Corner(1), column, row);
        assert!(
            (found / exact - 1.0).abs() < 0.01,
            "corner {column}, {row}: {found}, not {exact}"
        );
    }
    let deltas = DeltaFactors::of(Projection::SinglePlane, 256).expect("good");
    let at = |i: usize| 8.0 * ((i as f64 + 0.5) / 128.0 - 1.0);
    for (column, row) in [(128, 127), (100, 150), (3, 250)] {
        let r2 = 1.0 + at(column).powi(2) + at(row).powi(2);
        let exact = (1.0_f64 / 16.0).powi(2) / (std::f64::consts::PI * r2 * r2) / 0.9874;
        let found = deltas.at(CubeFace::Plane, column, row);
        assert!(
            (found / exact - 1.0).abs() < 0.01,
            "plane {column}, {row}: {found}, not {exact}"
        );
    }
}

#[test]
fn delta_factors_are_those_of_their_cells() {
    // A sixteenth of an edge is small enough for cos cos A / (π r²) at the middle to be good to a percent.
    let deltas = DeltaFactors::new(16).expect("a good resolution");
    let middle = |i: usize| (i as f64 + 0.5) / 8.0 - 1.0;
    let area = 1.0 / 64.0;
    for (x, y) in [(0, 0), (3, 5), (8, 8), (15, 2)] {
        let r2 = 1.0 + middle(x).powi(2) + middle(y).powi(2);
        let top = area / (std::f64::consts::PI * r2 * r2);
        let found = deltas.at(CubeFace::Top, x, y);
        assert!(
            (found / top - 1.0).abs() < 0.02,
            "top {x}, {y}: {found}, not {top}"
        );
    }
    for (x, y) in [(0, 0), (3, 5), (8, 7), (15, 2)] {
        let z = 1.0 - (y as f64 + 0.5) / 8.0;
        let r2 = 1.0 + middle(x).powi(2) + z * z;
        let side = area * z / (std::f64::consts::PI * r2 * r2);
        let found = deltas.at(CubeFace::Side(2), x, y);
        assert!(
            (found / side - 1.0).abs() < 0.02,
            "side {x}, {y}: {found}, not {side}"
        );
    }
}

/// The bound has two parts. *Cells*: a cell is wrong only if the square's outline crosses it. The outline of a square at
/// distance 1 has length 4 on the faces, at most `4 √2 N / 2` cells of at most `4 / π N²` each: `3.6 / N`. Of the
/// perpendicular square three edges are above the plane, each at most 2 edges of a face long: below `8 / N`.
/// *Points*: Gauss quadrature over the shooting square has an error at infinite resolution too; with exact point factors,
/// 1 / 4 / 16 points are off by 4.0e-2 / -1.45e-3 / 1.5e-6 for parallel and by -9.9e-3 / 3.6e-4 / -3.8e-7 for
/// perpendicular squares.
#[test]
fn unit_squares_have_their_known_factors() {
    for (squares, cells, points) in [
        (PARALLEL, 3.6, [(1, 3.97e-2), (4, 1.45e-3), (16, 1.6e-6)]),
        (PERPENDICULAR, 8.0, [(1, 9.92e-3), (4, 3.7e-4), (16, 4e-7)]),
    ] {
        for resolution in [64, 256, 1024] {
            for (count, quadrature) in points {
                let error = error_of_squares(squares, resolution, count);
                let bound = quadrature + cells / f64::from(resolution);
                assert!(
                    error.abs() < bound,
                    "{}, {count} points at {resolution}: off by {error:.1e}, bound {bound:.1e}",
                    squares.0
                );
            }
        }
    }
}

#[test]
fn more_points_end_the_proximity_error() {
    let [one, four, sixteen] = [1, 4, 16].map(|n| error_of_squares(PARALLEL, 1024, n).abs());
    assert!(one > 0.03, "one hemicube is a fifth too high: {one}");
    assert!(
        four < one / 10.0 && sixteen < four,
        "one {one:.1e}, four {four:.1e}, sixteen {sixteen:.1e}"
    );
}

#[test]
fn what_leaves_is_accounted_for() {
    let glass = |mut scene: Scene| {
        for material in scene.materials.iter_mut().skip(1) {
            material.transmission = 0.5;
        }
        scene
    };
    let cut = PatchOptions::default().with_elements(300);
    let scene = |name| builtin::scene(name).expect("it is built in");
    for (name, mesh) in [
        ("cornell", mesh_of(scene("cornell"), cut)),
        ("two-rooms", mesh_of(scene("two-rooms"), cut)),
        ("cornell of glass", mesh_of(glass(scene("cornell")), cut)),
    ] {
        for resolution in [32, 128] {
            let factors = hemicube(&mesh, resolution, 4);
            for patch in (0..mesh.patches().len()).step_by(5) {
                let row = row(&factors, patch);
                for band in 0..3 {
                    let sum = row.sum(&mesh, band);
                    assert!(
                        (sum - 1.0).abs() < 1e-6,
                        "{name} at {resolution}, patch {patch}, band {band}: {sum}"
                    );
                }
                let in_range = row.fractions.iter().all(|&f| (0.0..=1.0).contains(&f));
                assert!(in_range, "{name}: factors are in [0, 1]");
                assert!(row.receivers.is_sorted(), "{name}: receivers ascend");
            }
        }
    }
}

/// RMS over all pairs of the difference between two methods, and of the first method's factors.
fn rms_difference(a: &dyn FormFactors, b: &dyn FormFactors) -> (f64, f64) {
    let mesh = a.mesh();
    let n = mesh.elements().len();
    let dense = |row: &Row| {
        let mut dense = vec![0.0; n];
        for (&e, &f) in row.receivers.iter().zip(row.band(0)) {
            dense[e as usize] = f64::from(f);
        }
        dense
    };
    let (mut squares, mut whole) = (0.0, 0.0);
    for patch in 0..mesh.patches().len() {
        let (one, two) = (dense(&row(a, patch)), dense(&row(b, patch)));
        for (x, y) in one.iter().zip(&two) {
            squares += (x - y) * (x - y);
            whole += x * x;
        }
    }
    let pairs = (n * mesh.patches().len()) as f64;
    ((squares / pairs).sqrt(), (whole / pairs).sqrt())
}

fn pairs(mesh: &Arc<PatchMesh>) -> RayCast {
    let options = RayCastOptions {
        rays: 4096,
        strategy: Strategy::Pairs,
        seed: 0,
        shot_rays: None,
    };
    RayCast::new(mesh.clone(), options)
}

#[test]
fn cornell_agrees_with_rays() {
    let options = PatchOptions::default().with_elements(300);
    let mesh = built_in("cornell", options.with_joints(false));
    let options = RayCastOptions {
        rays: 262_144,
        strategy: Strategy::Shots,
        seed: 0,
        shot_rays: None,
    };
    let shots = RayCast::new(mesh.clone(), options);
    let (by_cubes, whole) = rms_difference(&hemicube(&mesh, 128, 16), &shots);
    let (by_pairs, _) = rms_difference(&pairs(&mesh), &shots);
    let (apart, _) = rms_difference(&pairs(&mesh), &hemicube(&mesh, 128, 16));
    // What is left comes from the two patches of the floor in which the blocks stand: points of the patch that happen
    // to lie close to a block see it large, and pairs take geometry and visibility for independent.
    assert!(
        by_cubes < 0.08 * whole,
        "RMS {by_cubes:.2e} between hemicubes and shots, RMS factor {whole:.2e}"
    );
    assert!(
        by_cubes < by_pairs,
        "hemicubes {by_cubes:.2e} are nearer to shots than pairs {by_pairs:.2e}"
    );
    assert!(
        apart < 0.13 * whole,
        "RMS {apart:.2e} between hemicubes and pairs, RMS factor {whole:.2e}"
    );
}

#[test]
fn panes_let_their_share_through() {
    let mut scene = builtin::scene("parallel-plates").expect("it is built in");
    let mut pane = scene.meshes[1].clone();
    pane.positions.iter_mut().for_each(|p| {
        *p = (*p - glam::Vec3::new(0.5, 0.0, 0.5)) * 9.0;
        p.y = 0.5;
    });
    pane.name = "pane".into();
    pane.material = scene.materials.len();
    let mut glass = scene.materials[0].clone();
    glass.transmission = 0.25;
    glass.base_color = Rgb::WHITE;
    scene.materials.push(glass);
    scene.meshes.push(pane);
    let mut instance = scene.instances[1].clone();
    instance.mesh = scene.meshes.len() - 1;
    instance.node = "pane".into();
    scene.instances.push(instance);
    let mesh = mesh_of(scene, one_element_a_face());
    let row = row(&hemicube(&mesh, 256, 16), 0);
    let far = row.receivers.iter().position(|&e| e == 1);
    let found = f64::from(row.fractions[far.expect("the far square is seen")]);
    let exact = 0.25 * PARALLEL.1;
    assert!(
        (found - exact).abs() < 0.25 * 3.6 / 256.0,
        "{found} through a pane, not {exact}"
    );
}

#[test]
fn furnace_is_emission_over_one_minus_reflectance() {
    for resolution in [32, 128] {
        let options = PatchOptions::default().with_elements(96).with_patches(24);
        let mesh = mesh_of(builtin::furnace_with(0.5, 1.0), options);
        let factors = hemicube(&mesh, resolution, 16);
        let dark = vec![Rgb::BLACK; mesh.elements().len()];
        let solution = Solution::new(mesh.clone(), &dark, Default::default());
        let mut solver = Shooting::new(&factors, solution, Order::Sorted);
        for _ in 0..1000 {
            solver.step();
        }
        let (mut flux, mut area, mut worst) = (0.0, 0.0, 0.0_f64);
        for (e, &id) in mesh.elements().iter().enumerate() {
            let radiosity = f64::from(solver.solution().element_radiosity(e).g);
            flux += radiosity * f64::from(mesh.node(id).area);
            area += f64::from(mesh.node(id).area);
            worst = worst.max((radiosity / 2.0 - 1.0).abs());
        }
        let mean = flux / area;
        assert!(
            (mean / 2.0 - 1.0).abs() < 5e-3,
            "mean radiosity {mean} at {resolution}"
        );
        // Aliasing of the elements' outlines; measured 5.1e-3 at 32 and 9e-4 at 128.
        let bound = 0.3 / f64::from(resolution);
        assert!(
            worst < bound,
            "an element is off by {worst:.1e} at {resolution}, bound {bound:.1e}"
        );
    }
}

#[test]
fn rows_have_the_same_bits_on_any_number_of_threads() {
    let mesh = built_in("two-rooms", PatchOptions::default().with_elements(300));
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads can be started").install(|| {
            let factors = hemicube(&mesh, 64, 16);
            let rows = (0..mesh.patches().len()).step_by(7);
            rows.map(|patch| row(&factors, patch)).collect::<Vec<_>>()
        })
    };
    let one = run(1);
    for threads in [2, 8] {
        assert!(
            run(threads) == one,
            "{threads} threads give other bits than one"
        );
    }
}

#[test]
fn item_buffers_show_what_a_patch_sees() {
    let mesh = built_in("parallel-plates", one_element_a_face());
    let buffers = hemicube(&mesh, 64, 1).item_buffers(mesh.patches()[0]);
    let seen = |face: usize| {
        buffers.faces[face]
            .iter()
            .filter(|&&item| item == 1)
            .count()
    };
    // From its middle, a unit square at distance 1 covers a quarter of the top: 32 x 32 cells, whatever the turn.
    assert!(
        (seen(0).abs_diff(1024)) < 64,
        "{} cells of the top",
        seen(0)
    );
    assert!((1..5).all(|face| seen(face) == 0), "the sides see nothing");
    assert!(
        buffers.faces[0].contains(&ItemBuffers::NOTHING),
        "beside the square there is nothing"
    );
}

#[test]
fn the_coarsest_and_the_finest_hemicube_close() {
    let mesh = built_in("cornell", PatchOptions::default().with_elements(100));
    for resolution in [16, 4096] {
        let factors = hemicube(&mesh, resolution, 1);
        let sum = row(&factors, 3).sum(&mesh, 0);
        assert!(
            (sum - 1.0).abs() < 1e-5,
            "resolution {resolution}: the row sums to {sum}"
        );
    }
}

#[test]
fn bad_options_are_refused() {
    let mesh = built_in("parallel-plates", one_element_a_face());
    for (resolution, points) in [(0, 16), (14, 16), (17, 16), (4098, 16), (64, 0), (64, 3)] {
        let options = HemicubeOptions::default()
            .with_resolution(resolution)
            .with_max_points(points);
        let error = Hemicube::new(mesh.clone(), options).expect_err("bad options");
        let bad = if points == 16 { resolution } else { points };
        assert!(
            error.to_string().contains(&bad.to_string()),
            "the message has the number: {error}"
        );
    }
}
