//! What is shown in place of a solution or a scene as it is: dimmed light, form factors as light, materials without their
//! textures.

use crate::session::PatchRow;
use core::f32::consts::PI;
use hemicube_radiosity::solution::BANDS;
use hemicube_radiosity::{PatchMesh, Solution};
use hemicube_raster::Rgb;
use hemicube_scene::Scene;

/// A solution with factors on its light groups; none if all of them are 1.
pub fn dimmed(solved: &Solution, dims: &[Rgb]) -> Option<Solution> {
    if dims.iter().all(|&dim| dim == Rgb::WHITE) {
        return None;
    }
    let mut solution = solved.clone();
    for (group, &dim) in dims.iter().enumerate().take(solution.groups().len()) {
        solution.set_dim(group, dim);
    }
    Some(solution)
}

/// Decades of form factors that colours show.
pub const DECADES: u8 = 4;

/// Form factors as irradiance whose illuminance goes from 0 to 1 over the [`DECADES`] below the largest factor.
pub fn as_light(solved: &Solution, row: &PatchRow) -> Solution {
    let mesh = solved.mesh();
    let per_area = |(e, &f): (usize, &f32)| f / mesh.exposed_area(e).max(f32::MIN_POSITIVE);
    let densities: Vec<f32> = row.fractions.iter().enumerate().map(per_area).collect();
    let most = densities.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
    let unit = mesh.scene().units.illuminance(Rgb::WHITE);
    let height =
        |density: f32| ((density / most).log10() / f32::from(DECADES) + 1.0).clamp(0.0, 1.0) / unit;
    let mut solution = solved.clone();
    let channels = solution.groups().len() * BANDS;
    let mut irradiance = vec![0.0; channels * densities.len()];
    for (i, value) in irradiance
        .iter_mut()
        .take(BANDS * densities.len())
        .enumerate()
    {
        *value = height(densities[i % densities.len()]);
    }
    let none = vec![0.0; irradiance.len()];
    solution.replace_light(
        &irradiance,
        &none,
        &vec![0.0; channels],
        &vec![0.0; channels],
    );
    for group in 0..solution.groups().len() {
        solution.set_dim(group, Rgb::WHITE);
    }
    solution
}

/// The scene with each textured material in the mean colour of its surfaces.
pub fn without_textures(mesh: &PatchMesh) -> Scene {
    let mut scene = (**mesh.scene()).clone();
    let mut sums = vec![(Rgb::BLACK, Rgb::BLACK, 0.0); scene.materials.len()];
    for e in 0..mesh.elements().len() {
        let area = mesh.exposed_area(e);
        let (reflectance, emission, areas) = &mut sums[mesh.material_of_element(e)];
        *reflectance += mesh.reflectance()[e] * area;
        *emission += mesh.emission()[e] * (area / PI);
        *areas += area;
    }
    for (material, (reflectance, emission, area)) in scene.materials.iter_mut().zip(sums) {
        // What lets light through keeps its pictures: they say where.
        if area <= 0.0 || material.may_transmit() {
            continue;
        }
        if material.base_color_texture.take().is_some()
            || material.metallic_texture.take().is_some()
        {
            material.base_color = reflectance / area;
            material.metallic = 0.0;
        }
        if material.emission_texture.take().is_some() {
            material.emission = emission / area;
        }
    }
    scene
}
