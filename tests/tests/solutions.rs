//! Solutions as data: groups, resuming, lit files.

use hemicube::radiosity::export::lit_glb::{LitGlbOptions, is_lit, read, write};
use hemicube::radiosity::{Grouping, Quality, Solution, SolveOptions, resume, solve};
use hemicube::raster::Rgb;
use hemicube::scene::{Scene, builtin, open_bytes};
use std::sync::Arc;

fn scene(name: &str) -> Scene {
    builtin::scene(name).expect("it is built in")
}

fn solved(scene: Scene, options: &SolveOptions) -> Solution {
    solve(Arc::new(scene), options, |_, _| true).expect("it can be solved")
}

fn same_light(a: &Solution, b: &Solution) -> bool {
    (0..3).all(|band| {
        a.irradiance(0, band) == b.irradiance(0, band) && a.unshot(0, band) == b.unshot(0, band)
    })
}

#[test]
fn groups_add_up_to_the_whole() {
    let options = SolveOptions {
        tolerance: 1e-6,
        ..Quality::Draft.into()
    };
    let together = solved(scene("two-rooms"), &options);
    let apart = solved(
        scene("two-rooms"),
        &SolveOptions {
            grouping: Grouping::ByMaterial,
            ..options
        },
    );
    assert!(apart.groups().len() >= 3, "{} groups", apart.groups().len());
    for e in 0..together.mesh().elements().len() {
        let (one, sum) = (together.element_irradiance(e), apart.element_irradiance(e));
        for band in 0..3 {
            // Both leave a millionth unshot, in another order.
            let allowed = 2e-4 * one[band] + 1e-6;
            assert!(
                (one[band] - sum[band]).abs() < allowed,
                "element {e}, band {band}: {one:?} and {sum:?}"
            );
        }
    }
}

#[test]
fn a_dimmed_group_dims_linearly() {
    let options = SolveOptions {
        grouping: Grouping::ByMaterial,
        ..Quality::Draft.into()
    };
    let mut solution = solved(scene("two-rooms"), &options);
    let before = solution.element_irradiance(0);
    (0..solution.groups().len()).for_each(|group| solution.set_dim(group, Rgb::splat(0.5)));
    assert_eq!(
        solution.element_irradiance(0),
        before * 0.5,
        "everything at half"
    );
}

#[test]
fn resuming_goes_on_exactly() {
    let options = SolveOptions {
        tolerance: 0.0,
        max_steps: Some(120),
        ..Quality::Draft.into()
    };
    let whole = solved(scene("cornell"), &options);
    let half = SolveOptions {
        max_steps: Some(60),
        ..options
    };
    let resumed = resume(solved(scene("cornell"), &half), &half, |_, _| true).expect("it goes on");
    assert_eq!(resumed.provenance.steps, 120, "steps are counted through");
    assert!(same_light(&whole, &resumed), "60 + 60 steps are 120 steps");
}

#[test]
fn a_lit_file_holds_the_solution_exactly() {
    for name in ["cornell", "office"] {
        let mut given = scene(name);
        given.sky = Rgb::splat(0.1);
        let options = SolveOptions {
            max_steps: Some(30),
            ..Quality::Draft.into()
        };
        let solution = solved(given, &options);
        let file = write(&solution, &LitGlbOptions::default()).expect("it can be written");
        assert!(is_lit(&file), "{name}: our files are known");
        let back = read(&file).expect("it can be read");
        assert!(same_light(&solution, &back), "{name}: the same light");
        assert_eq!(
            back.mesh().reflectance(),
            solution.mesh().reflectance(),
            "{name}: the same reflectance"
        );
        assert_eq!(
            back.provenance, solution.provenance,
            "{name}: the same provenance"
        );
        let further = resume(back, &options, |_, _| true).expect("it goes on");
        let direct = resume(solution, &options, |_, _| true).expect("it goes on");
        assert!(
            same_light(&further, &direct),
            "{name}: going on from the file is going on"
        );
    }
}

#[test]
fn a_lit_file_is_an_ordinary_scene_to_others() {
    let solution = solved(scene("cornell"), &Quality::Draft.into());
    let file = write(&solution, &LitGlbOptions::default()).expect("it can be written");
    let seen = open_bytes(&file, "lit.glb", None).expect("any glTF reader opens it");
    assert!(
        seen.materials.iter().all(|m| m.unlit),
        "all of it is drawn as it is"
    );
    let triangles: usize = seen.meshes.iter().map(|m| m.faces.len()).sum();
    assert!(
        triangles >= solution.mesh().elements().len(),
        "{triangles} triangles"
    );
    let colors = seen.meshes.iter().flat_map(|m| &m.colors);
    assert!(colors.clone().count() > 0, "light is in the vertex colours");
    assert!(
        colors
            .into_iter()
            .all(|c| c.min_element() >= 0.0 && c.max_element() <= 1.0),
        "colours lie in [0, 1]"
    );
    let brightest = seen
        .meshes
        .iter()
        .flat_map(|m| &m.colors)
        .fold(0.0_f32, |max, c| max.max(c.x));
    assert!(brightest > 0.2, "the room looks lit: {brightest}");
}

#[test]
fn damaged_lit_files_are_refused() {
    let solution = solved(scene("parallel-plates"), &Quality::Draft.into());
    let file = write(&solution, &LitGlbOptions::default()).expect("it can be written");
    let mut refused = 0;
    for i in (0..file.len()).step_by(23) {
        let mut damaged = file.clone();
        damaged[i] ^= 0x55;
        // Whatever comes out, it comes out in words or as a solution that holds together.
        if let Err(error) = read(&damaged) {
            assert!(!error.to_string().contains('\n'), "one line: {error}");
            refused += 1;
        }
    }
    assert!(refused > 10, "{refused} damaged files were refused");
    for length in [0, 11, 20, file.len() / 2, file.len() - 1] {
        assert!(
            read(&file[..length]).is_err(),
            "cut off after {length} bytes"
        );
    }
}

#[test]
fn a_scene_without_light_is_refused_with_the_ways_out() {
    let mut dark = scene("cornell");
    dark.materials
        .iter_mut()
        .for_each(|m| m.emission = Rgb::BLACK);
    let error = solve(Arc::new(dark), &SolveOptions::default(), |_, _| true)
        .expect_err("there is no light");
    let message = error.to_string();
    for part in ["cornell", "--emit", "--sky"] {
        assert!(
            message.contains(part),
            "the message names {part}: {message}"
        );
    }
}
