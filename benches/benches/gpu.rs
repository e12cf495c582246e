//! The GPU's hemicubes beside the CPU's: rows, their errors, what a shot costs the device, whole solutions; rows by rays, by a
//! tree in a shader and by the adapter's ray queries.
//!
//! Time is stated twice: by the clock, and as CPU time of the whole process, which is what counts for adapters that draw
//! in software on the same cores. Without an adapter the program says that it skips. Arguments choose a part, and then
//! sizes: `rows 10000 512`, `rays 10000`, `solve 100000`.

use cpu_time::ProcessTime;
use hemicube::radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube::radiosity::form_factor::raycast::Strategy;
use hemicube::radiosity::form_factor::{Analytic, AnalyticOptions, RayCast, RayCastOptions};
use hemicube::radiosity::solve::{Order, run};
use hemicube::radiosity::stop::NEVER;
use hemicube::radiosity::{
    FormFactors, NodeId, PatchMesh, PatchOptions, Row, Shooting, SolveOptions, Solver, unlit,
};
use hemicube::scene::builtin;
use hemicube_gpu::{
    Context, ContextOptions, GpuHemicube, GpuRayCast, GpuShooting, RayQueries, ShotCounts, adapters,
};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long rows of each kind are filled, about.
const TIME: Duration = Duration::from_millis(1200);
/// Rows whose errors are looked at.
const SAMPLE: usize = 6;

fn main() {
    let context = match Context::headless(None) {
        Ok(context) => Arc::new(context),
        Err(error) => return println!("skipped: {error}"),
    };
    let all = adapters();
    let about = all.iter().find(|a| a.name == context.name);
    let driver = about.map_or("", |a| &a.driver);
    println!("{}, {driver}\n", context.name);
    let wanted = Wanted::of_arguments();
    if wanted.part("rows") {
        rows(&context, &wanted);
    }
    if wanted.part("rays") {
        rays(&wanted);
    }
    if wanted.part("counts") {
        counts(&context, &wanted);
    }
    if wanted.part("solve") {
        solve(&context, &wanted);
    }
}

/// Which measurements to make: all that the arguments do not leave out.
struct Wanted {
    part: Option<String>,
    elements: Option<usize>,
    resolution: Option<u32>,
}

impl Wanted {
    fn of_arguments() -> Self {
        let mut arguments = std::env::args().skip(1).filter(|arg| !arg.starts_with('-'));
        let part = arguments.next();
        let mut number = || arguments.next().map(|arg| arg.parse().expect("a number"));
        Self {
            part,
            elements: number(),
            resolution: number().map(|n| u32::try_from(n).expect("a small number")),
        }
    }

    fn part(&self, part: &str) -> bool {
        self.part.as_deref().is_none_or(|only| only == part)
    }

    fn elements(&self, elements: usize) -> bool {
        self.elements.is_none_or(|only| only == elements)
    }

    fn resolution(&self, resolution: u32) -> bool {
        self.resolution.is_none_or(|only| only == resolution)
    }
}

fn mesh(elements: usize) -> Arc<PatchMesh> {
    mesh_of("cornell", elements)
}

fn mesh_of(scene: &str, elements: usize) -> Arc<PatchMesh> {
    let scene = Arc::new(builtin::scene(scene).expect("it is built in"));
    let options = PatchOptions::default()
        .with_elements(elements)
        .with_patches(elements / 10);
    Arc::new(PatchMesh::build(scene, options).expect("it can be cut"))
}

/// One hemicube a row, but for patches that are partly buried.
fn options(resolution: u32) -> HemicubeOptions {
    HemicubeOptions::default()
        .with_resolution(resolution)
        .with_max_points(1)
}

fn rows(context: &Arc<Context>, wanted: &Wanted) {
    println!(
        "rows of cornell: a second, a CPU second, error (share of the light at wrong elements)"
    );
    println!(
        "elements resolution      CPU                       GPU                       GPU / CPU by CPU time"
    );
    let sizes = [1000, 10_000, 100_000];
    for elements in sizes.into_iter().filter(|&n| wanted.elements(n)) {
        let mesh = mesh(elements);
        let (sample, exact) = exact(&mesh);
        let resolutions = [64, 128, 256, 512, 1024];
        for resolution in resolutions.into_iter().filter(|&n| wanted.resolution(n)) {
            let cpu = Hemicube::new(mesh.clone(), options(resolution)).expect("good options");
            let gpu = GpuHemicube::new(context.clone(), mesh.clone(), options(resolution))
                .expect("it fits");
            let (a, b) = (
                Measured::of(&cpu, &sample, &exact),
                Measured::of(&gpu, &sample, &exact),
            );
            // Two rasterisers may differ in cells that they round to different sides, not in more.
            assert!(
                (a.error - b.error).abs() < 0.02,
                "{} and {}",
                a.error,
                b.error
            );
            println!(
                "{:8} {resolution:10} {:7.0} {:7.0} {:.4} {:9.1} {:7.1} {:.4} {:9.3}",
                mesh.elements().len(),
                a.by_clock,
                a.by_cpu,
                a.error,
                b.by_clock,
                b.by_cpu,
                b.error,
                b.by_cpu / a.by_cpu,
            );
            assert_eq!(gpu.failure(), None, "the device works");
        }
    }
}

/// Some patches and their exact rows, by element.
fn exact(mesh: &Arc<PatchMesh>) -> (Vec<NodeId>, Vec<Vec<f64>>) {
    let exact = AnalyticOptions::default().with_error(1e-4);
    let exact = Analytic::new(mesh.clone(), exact).expect("an error in range");
    let step = mesh.patches().len() / SAMPLE;
    let sample: Vec<NodeId> = mesh
        .patches()
        .iter()
        .copied()
        .step_by(step.max(1))
        .collect();
    let rows = sample.iter().map(|&id| dense(&exact, id)).collect();
    (sample, rows)
}

fn dense(factors: &dyn FormFactors, source: NodeId) -> Vec<f64> {
    let mut row = Row::default();
    factors.fill_row(source, &mut row);
    let mut dense = vec![0.0; factors.mesh().elements().len()];
    for (&e, &f) in row.receivers.iter().zip(row.band(0)) {
        dense[e as usize] = f64::from(f);
    }
    dense
}

struct Measured {
    by_clock: f64,
    by_cpu: f64,
    error: f64,
}

impl Measured {
    fn of(factors: &dyn FormFactors, sample: &[NodeId], exact: &[Vec<f64>]) -> Self {
        let error = |(&id, exact): (&NodeId, &Vec<f64>)| {
            let found = dense(factors, id);
            let differences = found.iter().zip(exact).map(|(a, b)| (a - b).abs());
            differences.sum::<f64>() / 2.0
        };
        let errors = sample.iter().zip(exact).map(error);
        let error = errors.sum::<f64>() / sample.len() as f64;
        let mesh = factors.mesh();
        let at_once = factors.rows_at_once().max(2);
        let mut rows = vec![Row::default(); at_once];
        let (start, cpu) = (Instant::now(), ProcessTime::now());
        let mut count = 0;
        while start.elapsed() < TIME {
            let patch = |i: usize| mesh.patches()[(count + i) * 7919 % mesh.patches().len()];
            let sources: Vec<NodeId> = (0..at_once).map(patch).collect();
            factors.fill_rows(&sources, &mut rows);
            count += at_once;
        }
        Self {
            by_clock: count as f64 / start.elapsed().as_secs_f64(),
            by_cpu: count as f64 / cpu.elapsed().as_secs_f64(),
            error,
        }
    }
}

fn rays(wanted: &Wanted) {
    println!("\nrows of cornell and office by rays, 4096 a patch: a second, a CPU second");
    println!(
        "scene    elements  CPU                tree in a shader   ray queries        arrive elsewhere"
    );
    let devices = [RayQueries::Never, RayQueries::Always].map(|when| {
        let options = ContextOptions::default().with_ray_queries(when);
        Arc::new(Context::with_options(&options).expect("there is an adapter"))
    });
    for scene in ["cornell", "office"] {
        for elements in [1000, 10_000, 100_000] {
            if wanted.elements(elements) {
                rays_of(scene, elements, &devices);
            }
        }
    }
}

fn rays_of(scene: &str, elements: usize, [tree, queries]: &[Arc<Context>; 2]) {
    let mesh = mesh_of(scene, elements);
    let options = RayCastOptions {
        rays: 4096,
        strategy: Strategy::Shots,
        ..RayCastOptions::default()
    };
    let cpu = RayCast::new(mesh.clone(), options);
    let on = |context: &Arc<Context>| {
        GpuRayCast::new(context.clone(), mesh.clone(), options).expect("it fits")
    };
    let (tree_rows, query_rows) = (on(tree), on(queries));
    let step = mesh.patches().len() / SAMPLE;
    let sample: Vec<NodeId> = mesh
        .patches()
        .iter()
        .copied()
        .step_by(step.max(1))
        .collect();
    let of_tree: Vec<Vec<f64>> = sample.iter().map(|&id| dense(&tree_rows, id)).collect();
    let measured = [
        Measured::of(&cpu, &sample, &of_tree),
        Measured::of(&tree_rows, &sample, &of_tree),
    ];
    print!("{scene:8} {:8}", mesh.elements().len());
    for m in &measured {
        print!(" {:8.0} {:8.0} ", m.by_clock, m.by_cpu);
    }
    if !queries.has_ray_queries() {
        return println!(" the adapter has none");
    }
    let m = Measured::of(&query_rows, &sample, &of_tree);
    // The same rays; those that meet an edge may fall to either side.
    assert!(m.error < 1e-3, "{} of the rays arrive elsewhere", m.error);
    println!(" {:8.0} {:8.0}  {:.1e}", m.by_clock, m.by_cpu, m.error);
}

fn counts(context: &Arc<Context>, wanted: &Wanted) {
    println!("\nof one hemicube in cornell, as the device counts");
    println!(
        "elements resolution  triangles  visible  vertices  fragments    MB  ms arrange, draw, sum   KB read back"
    );
    let sizes = [
        (1000, 256),
        (10_000, 256),
        (10_000, 512),
        (10_000, 1024),
        (100_000, 512),
    ];
    let sizes = sizes.into_iter();
    for (elements, resolution) in sizes.filter(|&(n, r)| wanted.elements(n) && wanted.resolution(r))
    {
        let mesh = mesh(elements);
        let gpu =
            GpuHemicube::new(context.clone(), mesh.clone(), options(resolution)).expect("it fits");
        let some: Vec<NodeId> = mesh.patches().iter().copied().step_by(7).take(32).collect();
        let counts = gpu.shot_counts(&some).expect("the device works");
        let points: usize = some.iter().map(|&patch| gpu.points(patch)).sum();
        assert_eq!(counts.hemicubes, points as u64, "all are drawn");
        print(&mesh, resolution, &counts);
    }
}

fn print(mesh: &PatchMesh, resolution: u32, counts: &ShotCounts) {
    let n = counts.hemicubes as f64;
    let drawing = counts.drawing.unwrap_or_default();
    let [triangles, visible, vertices, fragments] = [
        drawing.triangles,
        drawing.visible_triangles,
        drawing.vertices,
        drawing.fragments,
    ]
    .map(|count| count as f64 / n);
    let bytes = (counts.bytes + drawing.bytes()) as f64 / n;
    let ms = counts.seconds.unwrap_or_default();
    let [arrange, draw, sum] = [ms.arrange, ms.draw, ms.sum].map(|s| 1e3 * s / n);
    println!(
        "{:8} {resolution:10} {triangles:10.0} {visible:8.0} {vertices:9.0} {fragments:10.0} {:5.1}  {arrange:6.2} {draw:6.2} {sum:6.2} {:14.1}",
        mesh.elements().len(),
        bytes / 1e6,
        counts.read_back as f64 / n / 1e3,
    );
}

fn solve(context: &Arc<Context>, wanted: &Wanted) {
    println!("\nsorted shooting in cornell to an unshot share, 256 cells along an edge");
    println!("elements  unshot     CPU: s, CPU s, shots      GPU: s, CPU s, shots, submissions");
    let sizes = [
        (1000, 100, 5e-3),
        (10_000, 400, 5e-2),
        (100_000, 1000, 1e-1),
    ];
    for (elements, patches, tolerance) in sizes.into_iter().filter(|&(n, ..)| wanted.elements(n)) {
        let scene = Arc::new(builtin::scene("cornell").expect("it is built in"));
        let options = SolveOptions {
            mesh: PatchOptions::default()
                .with_elements(elements)
                .with_patches(patches),
            ..SolveOptions::default()
        };
        let start = unlit(scene, &options, NEVER).expect("it has light");
        let hemicube = HemicubeOptions::default();
        let factors = Hemicube::new(start.mesh().clone(), hemicube).expect("good options");
        let mut cpu = Shooting::new(&factors, start.clone(), Order::Sorted);
        let a = timed(&mut cpu, tolerance);
        let mut gpu = GpuShooting::new(context.clone(), start, hemicube).expect("it fits");
        let b = timed(&mut gpu, tolerance);
        let submissions = gpu.submissions();
        let shots = [cpu.solution(), gpu.solution()].map(|s| s.provenance.steps);
        for band in 0..3 {
            let solution = gpu.solution();
            let unshot = solution.unshot_flux(band);
            let error = solution.total_balance(band).relative_error(unshot);
            assert!(error < 1e-4, "{error:.1e} of the energy is lost");
        }
        println!(
            "{:8} {tolerance:7.0e} {:11.2} {:6.2} {:6} {:14.2} {:6.2} {:6} {submissions:6}",
            gpu.solution().mesh().elements().len(),
            a[0],
            a[1],
            shots[0],
            b[0],
            b[1],
            shots[1],
        );
    }
}

/// Seconds by the clock and of CPU time.
fn timed(solver: &mut impl Solver, tolerance: f64) -> [f64; 2] {
    let (start, cpu) = (Instant::now(), ProcessTime::now());
    run(solver, tolerance, |_, _| true);
    solver.settle();
    [start.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64()]
}
