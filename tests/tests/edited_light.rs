//! Light that is edited: shooting the difference ends where solving from scratch does.

use hemicube::radiosity::form_factor::Cached;
use hemicube::radiosity::solve::run;
use hemicube::radiosity::stop::NEVER;
use hemicube::radiosity::{
    Grouping, MaterialEdit, Order, PatchMesh, PatchOptions, RadiosityError, RayCast, Shooting,
    Solution, SolveOptions, Solver, SolverKind, resume, solve, unlit,
};
use hemicube::raster::Rgb;
use hemicube::scene::{AlphaMode, Scene, builtin};
use std::sync::Arc;

fn options(solver: SolverKind, grouping: Grouping) -> SolveOptions {
    SolveOptions {
        mesh: PatchOptions::default().with_elements(300).with_patches(80),
        rays: 64,
        tolerance: 1e-6,
        solver,
        grouping,
        ..SolveOptions::default()
    }
}

fn solved(scene: Scene, options: &SolveOptions) -> Solution {
    solve(Arc::new(scene), options, |_, _| true).expect("it can be solved")
}

fn material(scene: &Scene, name: &str) -> usize {
    let found = scene.materials.iter().position(|m| m.name == name);
    found.unwrap_or_else(|| panic!("no material '{name}'"))
}

fn edited(solution: Solution, edit: &MaterialEdit, group: usize) -> Solution {
    let mesh = solution.mesh().edited(edit).expect("it can be edited");
    solution.relit(Arc::new(mesh), |_| group)
}

fn brightest(solution: &Solution) -> f32 {
    let radiosity = |e| solution.element_radiosity(e).map(f32::abs).max_band();
    (0..solution.mesh().elements().len())
        .map(radiosity)
        .fold(0.0, f32::max)
}

/// Largest difference of an element's radiosity in any group, over the brightest.
fn difference(a: &Solution, b: &Solution) -> f64 {
    let elements = 0..a.mesh().elements().len();
    let of = |s: &Solution, e: usize| s.element_radiosity(e).to_array().map(f64::from);
    let most = elements.clone().flat_map(|e| of(b, e)).fold(0.0, f64::max);
    let apart = |e| {
        let (a, b) = (of(a, e), of(b, e));
        (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
    };
    elements.map(apart).fold(0.0, f64::max) / most
}

fn assert_balanced(solution: &Solution) {
    for band in 0..3 {
        let error = solution
            .total_balance(band)
            .relative_error(solution.unshot_flux(band));
        assert!(
            error < 1e-5,
            "band {band}: {error:.1e} of the energy is lost"
        );
    }
}

#[test]
fn an_edited_furnace_is_emission_over_absorption() {
    let options = options(SolverKind::SortedShooting, Grouping::Together);
    let before = solved(builtin::furnace_with(0.5, 1.0), &options);
    let edit = MaterialEdit::new(0)
        .with_base_color(Rgb::splat(0.8))
        .with_emission(Rgb::splat(3.0 / core::f32::consts::PI));
    let start = edited(before, &edit, 0);
    assert_balanced(&start);
    let after = resume(start, &options, |_, _| true).expect("it can be solved");
    for e in 0..after.mesh().elements().len() {
        let b = after.element_radiosity(e).g;
        assert!(
            (b - 15.0).abs() < 0.02,
            "B = E / (1 - ρ) = 3 / 0.2 = 15: {b}"
        );
    }
    assert_balanced(&after);
}

/// Dimmed light and another paint, by solvers that keep light in different ways.
fn edit_ends_where_scratch_does(solver: SolverKind) {
    let options = options(solver, Grouping::Together);
    let mut scene = builtin::scene("cornell").expect("it is built in");
    let (lamp, red) = (material(&scene, "light"), material(&scene, "red"));
    let dimmed = scene.materials[lamp].emission * Rgb::new(0.3, 0.2, 0.6);
    let paint = Rgb::new(0.1, 0.7, 0.2);
    let before = solved(scene.clone(), &options);
    let start = edited(before, &MaterialEdit::new(lamp).with_emission(dimmed), 0);
    let start = edited(start, &MaterialEdit::new(red).with_base_color(paint), 0);
    assert_balanced(&start);
    assert!(
        start.unshot_fraction() > 0.1,
        "the difference is still to be shot"
    );
    let after = resume(start, &options, |_, _| true).expect("it can be solved");
    assert_balanced(&after);

    scene.materials[lamp].emission = dimmed;
    scene.materials[red].base_color = paint;
    let scratch = solved(scene, &options);
    // Both are unshot by at most 1e-6 of the flux; the rest is f32 at the brightness before.
    let difference = difference(&after, &scratch);
    assert!(difference < 2e-5, "{}: {difference:.1e}", solver.name());
}

#[test]
fn sorted_shooting_ends_where_scratch_does() {
    edit_ends_where_scratch_does(SolverKind::SortedShooting);
}

#[test]
fn overshooting_ends_where_scratch_does() {
    edit_ends_where_scratch_does(SolverKind::Overshooting);
}

#[test]
fn gauss_seidel_ends_where_scratch_does() {
    edit_ends_where_scratch_does(SolverKind::GaussSeidel);
}

#[test]
fn an_edit_taken_back_leaves_nothing_to_shoot() {
    let options = SolveOptions {
        tolerance: 1e-5,
        ..options(SolverKind::SortedShooting, Grouping::Together)
    };
    let scene = builtin::scene("cornell").expect("it is built in");
    let lamp = material(&scene, "light");
    let emission = scene.materials[lamp].emission;
    // What was shot by some rows is taken back by the same ones: rays know which patches emit.
    let start = unlit(Arc::new(scene), &options, NEVER).expect("it can be meshed");
    let raycast = options.form_factor_options().raycast;
    let factors = Cached::new(RayCast::new(start.mesh().clone(), raycast), 1 << 26);
    let settled = |solution| {
        let mut solver = Shooting::new(&factors, solution, Order::Sorted);
        run(&mut solver, options.tolerance, |_, _| true);
        solver.into_solution()
    };
    let before = settled(start);
    let off = edited(
        before.clone(),
        &MaterialEdit::new(lamp).with_emission(Rgb::BLACK),
        0,
    );
    assert!(
        off.unshot_fraction() > 100.0,
        "all that fell is to be taken back, and hardly anything emits: {}",
        off.unshot_fraction()
    );
    let dark = settled(off.clone());
    let left = brightest(&dark) / brightest(&before);
    assert!(left < 1e-5, "it is dark: {left:.1e}");
    let back = edited(off, &MaterialEdit::new(lamp).with_emission(emission), 0);
    let (a, b) = (before.unshot_fraction(), back.unshot_fraction());
    assert!((a - b).abs() < 1e-6, "as before: {a:.1e}, {b:.1e}");
}

#[test]
fn what_starts_to_emit_gets_a_group_of_its_own() {
    let options = options(SolverKind::SortedShooting, Grouping::ByMaterial);
    let mut scene = builtin::scene("cornell").expect("it is built in");
    let green = material(&scene, "green");
    let glow = Rgb::new(0.5, 1.0, 0.25);
    let before = solved(scene.clone(), &options);
    let lamp_before: Vec<f32> = before.irradiance(0, 1).to_vec();
    let (start, group) = before.with_dark_group("green");
    assert_eq!(group, 1, "before the lights without an area");
    let start = edited(start, &MaterialEdit::new(green).with_emission(glow), group);
    let after = resume(start, &options, |_, _| true).expect("it can be solved");
    let change = lamp_before
        .iter()
        .zip(after.irradiance(0, 1))
        .map(|(a, b)| (a - b).abs());
    assert!(
        change.fold(0.0, f32::max) < 1e-4,
        "the lamp's own light stays, but for what was unshot"
    );
    scene.materials[green].emission = glow;
    let scratch = solved(scene, &options);
    let difference = difference(&after, &scratch);
    // The patches of the new lamp are as large as before, those from scratch finer.
    assert!(difference < 0.02, "{difference:.1e}");
    assert_eq!(after.groups()[1].name, "green", "named as asked");
}

#[test]
fn what_an_edit_cannot_do_is_said() {
    let mut scene = builtin::scene("cornell").expect("it is built in");
    let red = material(&scene, "red");
    scene.materials[red].alpha_mode = AlphaMode::Blend;
    scene.materials[red].alpha = 0.5;
    let options = PatchOptions::default().with_elements(50);
    let mesh = PatchMesh::build(Arc::new(scene), options).expect("it can be built");
    let refused = |edit: MaterialEdit| match mesh.edited(&edit) {
        Err(RadiosityError::Option(why)) => why,
        Err(other) => other.to_string(),
        Ok(_) => panic!("{edit:?} is refused"),
    };
    assert!(
        refused(MaterialEdit::new(99)).contains("material 99 of"),
        "no such one"
    );
    let glass = refused(MaterialEdit::new(red).with_base_color(Rgb::WHITE));
    assert!(glass.contains("'red' lets light through"), "{glass}");
    let negative = refused(MaterialEdit::new(red).with_emission(Rgb::splat(-1.0)));
    assert!(negative.contains("negative or not finite"), "{negative}");
}
