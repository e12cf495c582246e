//! Devices that fail, and scenes that are too large for them.

mod device;

use device::{context, found};
use hemicube_gpu::{Context, Gpu, GpuError, GpuHemicube, GpuRayCast, GpuShooting};
use hemicube_radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions};
use hemicube_radiosity::form_factor::{FormFactorKind, FormFactors, Row};
use hemicube_radiosity::patch::{PatchMesh, PatchOptions};
use hemicube_radiosity::stop::NEVER;
use hemicube_radiosity::{RayCastOptions, SolveOptions, SolverKind, solve_on, unlit};
use hemicube_scene::builtin;
use hemicube_shaders::memory::{SceneSize, ShootingSize};
use std::sync::{Arc, Mutex};

fn mesh(elements: usize) -> Arc<PatchMesh> {
    let scene = Arc::new(builtin::scene("cornell").expect("it is built in"));
    let options = PatchOptions::default()
        .with_elements(elements)
        .with_patches(elements / 4);
    Arc::new(PatchMesh::build(scene, options).expect("a mesh"))
}

fn coarse() -> HemicubeOptions {
    HemicubeOptions::default().with_resolution(64)
}

fn small(solver: SolverKind, form_factors: FormFactorKind) -> SolveOptions {
    SolveOptions {
        mesh: PatchOptions::default().with_elements(300).with_patches(80),
        hemicube: coarse(),
        rays: 64,
        form_factors,
        solver,
        tolerance: 1e-3,
        ..SolveOptions::default()
    }
}

/// Asks for more than any machine has: 2 TiB.
fn exhaust(context: &Context) {
    let _ = context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("too large"),
        size: wgpu::Extent3d {
            width: 16_384,
            height: 16_384,
            depth_or_array_layers: 2048,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Uint,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
}

/// Solves, and does something to the device after a few steps; what was reported.
fn solve_and_break(
    options: &SolveOptions,
    is_required: bool,
    harm: fn(&Context),
) -> Option<(Result<hemicube_radiosity::Solution, String>, Vec<GpuError>)> {
    let context = context()?;
    let heard = Arc::new(Mutex::new(Vec::new()));
    let hears = heard.clone();
    let gpu = Gpu::new(context.clone())
        .with_required(is_required)
        .with_report(move |error| hears.lock().expect("no panic").push(error.clone()));
    let scene = Arc::new(builtin::scene("cornell").expect("it is built in"));
    let mut steps = 0;
    let solved = solve_on(scene, options, &gpu, NEVER, |_, _| {
        steps += 1;
        if steps == 3 {
            harm(&context);
        }
        true
    });
    let heard = heard.lock().expect("no panic").clone();
    Some((solved.map_err(|error| error.to_string()), heard))
}

#[test]
fn the_cpu_goes_on_where_the_device_is_lost_or_full() {
    for (harm, what) in [
        (
            (|context: &Context| context.device.destroy()) as fn(&Context),
            "destroyed",
        ),
        (exhaust, "out of memory"),
    ] {
        for (solver, kind, name) in [
            (
                SolverKind::SortedShooting,
                FormFactorKind::Hemicube,
                "gpu, then hemicube",
            ),
            (SolverKind::Shooting, FormFactorKind::Hemicube, "gpu"),
            (SolverKind::Shooting, FormFactorKind::RayCast, "gpu-raycast"),
        ] {
            let options = small(solver, kind);
            let Some((solved, heard)) = solve_and_break(&options, false, harm) else {
                return;
            };
            let solution = solved.expect("the CPU ends it");
            assert!(
                solution.unshot_fraction() <= 1e-3,
                "{what}, {name}: to the end"
            );
            assert_eq!(solution.provenance.form_factors, name, "{what}");
            for band in 0..3 {
                let unshot = solution.unshot_flux(band);
                let error = solution.total_balance(band).relative_error(unshot);
                assert!(error < 1e-4, "{what}, {name}: {error:.1e} is lost");
            }
            assert_eq!(heard.len(), 1, "{what}, {name}: told once: {heard:?}");
            let told = heard[0].to_string();
            assert!(
                told.contains(what) && !told.contains('\n'),
                "{name}: {told}"
            );
        }
    }
}

#[test]
fn a_device_that_is_required_ends_the_work_with_it() {
    for solver in [SolverKind::SortedShooting, SolverKind::Shooting] {
        let options = small(solver, FormFactorKind::Hemicube);
        let broken = solve_and_break(&options, true, |context| context.device.destroy());
        let Some((solved, heard)) = broken else {
            return;
        };
        let why = solved.expect_err("it must not go on");
        assert!(why.contains("destroyed"), "{}: {why}", solver.name());
        assert!(heard.is_empty(), "an error is no note: {heard:?}");
    }
}

#[test]
fn memory_that_runs_out_while_something_is_made_is_that_things_error_alone() {
    let Some(context) = context() else { return };
    let made = context.guard(|| {
        exhaust(&context);
        Ok(())
    });
    let error = made.expect_err("no machine has 2 TiB");
    assert!(matches!(error, GpuError::OutOfMemory { .. }), "{error}");
    assert_eq!(context.failure(), None, "others go on");
    let factors = GpuHemicube::new(context, mesh(300), coarse()).expect("it fits");
    let patch = factors.mesh().patches()[0];
    factors.fill_row(patch, &mut Row::default());
    assert_eq!(factors.failure(), None, "the device works");
}

#[test]
fn rows_after_the_loss_are_those_of_the_cpu() {
    let Some(context) = context() else { return };
    let mesh = mesh(300);
    let cpu = Hemicube::new(mesh.clone(), coarse()).expect("CPU");
    let gpu = GpuHemicube::new(context.clone(), mesh.clone(), coarse()).expect("GPU");
    context.device.destroy();
    let (mut a, mut b) = (Row::default(), Row::default());
    cpu.fill_row(mesh.patches()[3], &mut a);
    gpu.fill_row(mesh.patches()[3], &mut b);
    assert_eq!(a, b, "the CPU's row");
    assert!(
        matches!(gpu.failure(), Some(GpuError::Lost { .. })),
        "{gpu:?}"
    );
    let start = unlit(mesh.scene().clone(), &SolveOptions::default(), NEVER).expect("a start");
    let late = GpuShooting::new(context.clone(), start, coarse());
    assert!(
        matches!(late, Err(GpuError::Lost { .. })),
        "too late to begin"
    );
    let late = GpuRayCast::new(context, mesh, RayCastOptions::default());
    assert!(
        matches!(late, Err(GpuError::Lost { .. })),
        "too late to begin"
    );
}

/// Bindings of 200 KB hold the lists of nine times 1000 elements (20 bytes each), so batches are split; 10,000 elements are
/// refused in words.
#[test]
fn scenes_over_the_limits_are_split_or_refused_in_words() {
    let lowered = |bytes: u64| {
        found(Context::headless_within(None, |limits| wgpu::Limits {
            max_storage_buffer_binding_size: bytes,
            ..limits
        }))
    };
    let (Some(context), Some(low)) = (context(), lowered(200_000)) else {
        return;
    };
    let mesh_of_1000 = mesh(1000);
    let whole = GpuHemicube::new(context, mesh_of_1000.clone(), coarse()).expect("it fits");
    let split = GpuHemicube::new(low.clone(), mesh_of_1000.clone(), coarse()).expect("in parts");
    assert_eq!(whole.batch_size(), 16, "all at once");
    let wanted = 200_000 / (20 * mesh_of_1000.elements().len());
    assert_eq!(split.batch_size(), wanted, "as many as fit");
    let sources = &mesh_of_1000.patches()[..20];
    let mut rows = vec![Row::default(); 20];
    let mut in_parts = rows.clone();
    whole.fill_rows(sources, &mut rows);
    split.fill_rows(sources, &mut in_parts);
    assert!(rows == in_parts, "the same bits however they are split");
    let large = mesh(10_000);
    let elements = large.elements().len();
    let error =
        GpuHemicube::new(low.clone(), large.clone(), coarse()).expect_err("it is too large");
    let told = error.to_string();
    let needed = 32 * elements;
    for part in ["elements", &needed.to_string(), "200000 bytes", "the CPU"] {
        assert!(told.contains(part), "'{part}' is not in: {told}");
    }
    assert_eq!(low.failure(), None, "nothing was asked of the driver");
    let rays = GpuRayCast::new(low, large, RayCastOptions::default());
    assert!(
        matches!(rays, Err(GpuError::Limit { .. })),
        "rays: {rays:?}"
    );
}

#[test]
fn memory_is_what_was_computed_without_a_device() {
    let Some(context) = context() else { return };
    let mut options = SolveOptions::default();
    options.mesh = options.mesh.with_elements(2000).with_patches(200);
    let scene = Arc::new(builtin::scene("cornell").expect("it is built in"));
    let start = unlit(scene, &options, NEVER).expect("a start");
    let mesh = start.mesh().clone();
    let size = SceneSize {
        elements: mesh.elements().len() as u64,
        receivers: mesh.elements().len() as u64,
        vertices: mesh.vertices().len() as u64,
        indices: 6,
        layers: 1,
        resolution: 64,
    };
    let factors = GpuHemicube::new(context.clone(), mesh.clone(), coarse()).expect("it fits");
    assert_eq!(
        factors.bytes(),
        size.geometry() + size.batch(16),
        "hemicubes"
    );
    let points = mesh.patches().iter().map(|&patch| factors.points(patch));
    let shooting = ShootingSize {
        patches: mesh.patches().len() as u64,
        hemicubes: points.sum::<usize>() as u64,
        channels: 3,
    };
    let solver = GpuShooting::new(context, start, coarse()).expect("it fits");
    assert_eq!(solver.bytes(), size.shooting(&shooting), "shooting");
}
