//! What every way to rows of form factors must do, each by its name.

use glam::Vec3;
use hemicube::radiosity::form_factor::hemicube::HemicubeOptions;
use hemicube::radiosity::form_factor::{
    AnalyticOptions, FormFactorKind, FormFactorOptions, Hemisphere, HemisphereOptions, Nusselt,
    NusseltOptions,
};
use hemicube::radiosity::{
    FormFactors, NodeId, Order, PatchMesh, PatchOptions, RayCastOptions, Row, Shooting, Solution,
    Solver,
};
use hemicube::raster::Rgb;
use hemicube::scene::{Scene, builtin};
use hemicube_tests::gpu;
use std::sync::Arc;

fn mesh_of(scene: Scene, options: PatchOptions) -> Arc<PatchMesh> {
    Arc::new(PatchMesh::build(Arc::new(scene), options).expect("the scene can be cut"))
}

fn built_in(name: &str, elements: usize) -> Arc<PatchMesh> {
    let options = PatchOptions::default().with_elements(elements);
    mesh_of(builtin::scene(name).expect("it is built in"), options)
}

/// Coarse, so that the tests are quick.
fn coarse() -> FormFactorOptions {
    FormFactorOptions {
        raycast: RayCastOptions {
            rays: 256,
            ..RayCastOptions::default()
        },
        hemicube: HemicubeOptions::default().with_resolution(64),
        hemisphere: HemisphereOptions::default().with_cells(1000),
        nusselt: NusseltOptions::default().with_rays(256),
        analytic: AnalyticOptions::default().with_error(1e-3),
    }
}

fn build(
    kind: FormFactorKind,
    mesh: &Arc<PatchMesh>,
    options: &FormFactorOptions,
) -> Box<dyn FormFactors> {
    kind.build(mesh.clone(), options)
        .expect("the options are good")
}

/// All ways by their names, those of a GPU among them, and the CPU's way that each is or is the twin of.
fn ways(
    mesh: &Arc<PatchMesh>,
    options: &FormFactorOptions,
) -> Vec<(&'static str, FormFactorKind, Box<dyn FormFactors>)> {
    let cpu = FormFactorKind::ALL.map(|kind| (kind.name(), kind, build(kind, mesh, options)));
    let twins = [FormFactorKind::Hemicube, FormFactorKind::RayCast];
    let gpu = gpu::ways(mesh, options.hemicube, options.raycast);
    cpu.into_iter()
        .chain(
            gpu.into_iter()
                .zip(twins)
                .map(|((name, factors), kind)| (name, kind, factors)),
        )
        .collect()
}

fn row(factors: &dyn FormFactors, patch: usize) -> Row {
    let mut row = Row::default();
    factors.fill_row(factors.mesh().patches()[patch], &mut row);
    row
}

/// The rows of all patches, computed once.
struct Kept {
    mesh: Arc<PatchMesh>,
    rows: Vec<Row>,
}

impl Kept {
    fn new(factors: &dyn FormFactors) -> Self {
        let patches = 0..factors.mesh().patches().len();
        Self {
            mesh: factors.mesh().clone(),
            rows: patches.map(|patch| row(factors, patch)).collect(),
        }
    }
}

impl FormFactors for Kept {
    fn mesh(&self) -> &Arc<PatchMesh> {
        &self.mesh
    }

    fn fill_row(&self, source: NodeId, row: &mut Row) {
        row.clone_from(&self.rows[self.mesh.patch_of_node(source).expect("a patch")]);
    }
}

/// Parallel unit squares with a wide pane half way that lets through what its colour lets pass.
fn behind_glass(color: Rgb) -> Arc<PatchMesh> {
    let mut scene = builtin::scene("parallel-plates").expect("it is built in");
    let mut pane = scene.meshes[1].clone();
    pane.positions.iter_mut().for_each(|p| {
        *p = (*p - Vec3::new(0.5, 0.0, 0.5)) * 9.0;
        p.y = 0.5;
    });
    pane.material = scene.materials.len();
    let mut glass = scene.materials[0].clone();
    (glass.transmission, glass.base_color) = (0.5, color);
    scene.materials.push(glass);
    let mut instance = scene.instances[1].clone();
    instance.mesh = scene.meshes.len();
    scene.meshes.push(pane);
    scene.instances.push(instance);
    mesh_of(scene, PatchOptions::default().with_element_size(100.0))
}

#[test]
fn rows_account_for_all_that_leaves() {
    for mesh in [
        built_in("cornell", 300),
        built_in("two-rooms", 300),
        built_in("office", 1500),
        behind_glass(Rgb::new(1.0, 0.5, 0.25)),
    ] {
        for (name, _, factors) in ways(&mesh, &coarse()) {
            let patches = mesh.patches().len();
            for patch in (0..patches).step_by(patches.div_ceil(15)) {
                let row = row(&*factors, patch);
                let what = format!("{}, {name}, patch {patch}", mesh.scene().name);
                for band in 0..3 {
                    let sum = row.sum(&mesh, band);
                    assert!((sum - 1.0).abs() < 1e-5, "{what}: it sums to {sum}");
                }
                let in_range = row.fractions.iter().all(|&f| (0.0..=1.0).contains(&f));
                assert!(in_range, "{what}: factors are in [0, 1]");
                assert!(row.receivers.is_sorted(), "{what}: receivers ascend");
                assert_eq!(
                    row.fractions.len(),
                    row.bands * row.receivers.len(),
                    "{what}: a factor for each"
                );
            }
        }
    }
}

/// Of one element to a square. The bounds are those of the methods: 16 points are off by 1.6e-6 and 4e-7; cells at
/// 256 by 3.6 / N and 8 / N; rays by five standard deviations of 4096.
#[test]
fn unit_squares_have_their_known_factors() {
    for (scene, exact) in [
        ("parallel-plates", 0.199_824_895_698),
        ("perpendicular-plates", 0.200_043_776_075),
    ] {
        let scene = builtin::scene(scene).expect("it is built in");
        let mesh = mesh_of(scene, PatchOptions::default().with_element_size(100.0));
        for (name, kind, factors) in ways(&mesh, &FormFactorOptions::default()) {
            let row = row(&*factors, 0);
            assert_eq!(row.receivers, [1], "only the other square receives");
            let error = f64::from(row.fractions[0]) - exact;
            let bound = match kind {
                // Two standard deviations of 256 random rays; theirs are spread more evenly.
                FormFactorKind::RayCast if name == "gpu-raycast" => 0.05,
                // A ten-thousandth is for closing the row.
                FormFactorKind::RayCast | FormFactorKind::Nusselt => 2.5e-5,
                FormFactorKind::Analytic => 1e-6,
                FormFactorKind::Hemicube => 8.0 / 256.0,
                // Cells of a face that is half as wide again.
                FormFactorKind::CubicTetrahedron => 12.0 / 256.0,
                // Cells eight times as wide, and 1.3 % of the light in the wrong place.
                FormFactorKind::SinglePlane => 0.05,
                FormFactorKind::Hemisphere => 1.2e-2,
            };
            println!("{}, {name}: {error:+.1e}", mesh.scene().name);
            assert!(
                error.abs() < bound,
                "{}, {name}: off by {error:.1e}, {bound:.1e} is allowed",
                mesh.scene().name
            );
        }
    }
}

#[test]
fn tinted_panes_let_each_band_through_by_its_share() {
    let color = Rgb::new(1.0, 0.5, 0.25);
    let mesh = behind_glass(color);
    for (name, _, factors) in ways(&mesh, &FormFactorOptions::default()) {
        let row = row(&*factors, 0);
        assert_eq!(row.bands, 3, "{name}: bands differ");
        let far = row.receivers.iter().position(|&e| e == 1);
        let far = far.expect("the far square is seen");
        for band in 0..3 {
            let found = f64::from(row.band(band)[far]);
            let exact = f64::from(0.5 * color[band]) * 0.199_824_895_698;
            // As for the squares without the pane, by its share.
            let bound = f64::from(0.5 * color[band]) * 2e-2;
            assert!(
                (found - exact).abs() < bound,
                "{name}, band {band}: {found} through the pane, not {exact}"
            );
        }
    }
}

#[test]
fn rows_have_the_same_bits_on_any_number_of_threads() {
    let mesh = built_in("two-rooms", 300);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads can be started").install(|| {
            let rows = |(name, _, factors): (&'static str, _, Box<dyn FormFactors>)| {
                let some = (0..mesh.patches().len()).step_by(11);
                let rows: Vec<Row> = some.map(|patch| row(&*factors, patch)).collect();
                (name, rows)
            };
            ways(&mesh, &coarse())
                .into_iter()
                .map(rows)
                .collect::<Vec<_>>()
        })
    };
    let one = run(1);
    for threads in [2, 8] {
        for ((name, one), (_, several)) in one.iter().zip(&run(threads)) {
            assert!(
                one == several,
                "{name}: {threads} threads give other bits than one"
            );
        }
    }
}

/// Radiosity of the furnace is 2. Its mean tells of closure, which is exact; elements tell of the factors' noise.
#[test]
fn furnaces_are_emission_over_one_minus_reflectance() {
    let options = PatchOptions::default().with_elements(96).with_patches(24);
    let mesh = mesh_of(builtin::furnace_with(0.5, 1.0), options);
    for (name, kind, factors) in ways(&mesh, &FormFactorOptions::default()) {
        let factors = Kept::new(&*factors);
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
        println!("{name}: mean {mean}, an element is off by {worst:.1e}");
        assert!(
            (mean / 2.0 - 1.0).abs() < 1e-5,
            "{name}: mean radiosity {mean}"
        );
        let bound = match kind {
            // Shots of 256 rays where the CPU asks pairs.
            FormFactorKind::RayCast if name == "gpu-raycast" => 0.1,
            FormFactorKind::RayCast | FormFactorKind::Analytic => 1e-4,
            // Points of touching patches: the factors of walls at their common edge are a few per mille off.
            FormFactorKind::Nusselt
            | FormFactorKind::Hemicube
            | FormFactorKind::CubicTetrahedron => 5e-3,
            // What it misses is spread over all that it sees.
            FormFactorKind::SinglePlane => 2e-2,
            // 16 hemispheres of each patch, and 16,000 rays of all that meet an element: two independent deviations.
            FormFactorKind::Hemisphere => 1.6e-2,
        };
        assert!(
            worst < bound,
            "{name}: an element is off by {worst:.1e}, {bound:.1e} is allowed"
        );
    }
}

#[test]
fn names_tell_them_apart() {
    let names: Vec<&str> = FormFactorKind::ALL.map(FormFactorKind::name).into();
    assert_eq!(
        names,
        [
            "raycast",
            "analytic",
            "hemicube",
            "cubic-tetrahedron",
            "single-plane",
            "hemisphere",
            "nusselt"
        ],
        "names of the ways"
    );
}

#[test]
fn bad_options_are_refused() {
    let mesh = built_in("parallel-plates", 2);
    let message = |error: hemicube::radiosity::RadiosityError| error.to_string();
    let cells = HemisphereOptions::default();
    for (options, bad) in [
        (cells.with_cells(0), "0"),
        (cells.with_cells(15), "15"),
        (cells.with_cells(1 << 30), "1073741824"),
        (cells.with_max_points(9), "9"),
    ] {
        let error = Hemisphere::new(mesh.clone(), options).expect_err("bad options");
        let message = message(error);
        assert!(message.starts_with(bad), "it has the number: {message}");
    }
    let rays = NusseltOptions::default();
    for (options, bad) in [
        (rays.with_rays(0), "0"),
        (rays.with_rays(u32::MAX), "4294967295"),
        (rays.with_max_points(2), "2"),
    ] {
        let error = Nusselt::new(mesh.clone(), options).expect_err("bad options");
        let message = message(error);
        assert!(message.starts_with(bad), "it has the number: {message}");
    }
}
