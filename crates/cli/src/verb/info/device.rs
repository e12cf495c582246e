//! What a scene would take of a GPU's memory.

use hemicube::radiosity::PatchMesh;
use hemicube::radiosity::form_factor::hemicube::{Hemicube, HemicubeOptions, MAX_LAYERS};
use hemicube::radiosity::patch::NodeKind;
use hemicube::radiosity::solution::BANDS;
use hemicube::shaders::memory::{SceneSize, ShootingSize};
use std::collections::BTreeSet;
use std::sync::Arc;

/// Bytes of solving on a GPU, with so many groups of luminaires.
pub fn memory(mesh: &Arc<PatchMesh>, groups: usize) -> u64 {
    let options = HemicubeOptions::default();
    let hemicubes = Hemicube::new(mesh.clone(), options).map_or(0, |hemicubes| {
        let points = mesh.patches().iter().map(|&patch| hemicubes.points(patch));
        points.sum::<usize>()
    });
    let count = |n: usize| n as u64;
    let shooting = ShootingSize {
        patches: count(mesh.patches().len()),
        hemicubes: count(hemicubes),
        channels: count(groups * BANDS),
    };
    let scene = SceneSize {
        elements: count(mesh.elements().len()),
        receivers: count(mesh.elements().len() + mesh.obstructions().len()),
        vertices: count(mesh.vertices().len()),
        indices: if has_quads(mesh) { 6 } else { 3 },
        layers: count(layers(mesh)),
        resolution: options.resolution.into(),
    };
    scene.shooting(&shooting)
}

fn has_quads(mesh: &PatchMesh) -> bool {
    let mut elements = mesh.elements().iter();
    elements.any(|&id| mesh.corners(id).len() == 4)
        || mesh.obstructions().iter().any(|(_, cell)| cell.count == 4)
}

/// Layers that are drawn: one for each pane, and what lies behind.
fn layers(mesh: &PatchMesh) -> usize {
    let elements = mesh.elements().iter().zip(mesh.transmittance());
    let panes: BTreeSet<u32> = elements
        .filter(|(_, through)| !through.is_black())
        .filter_map(|(&id, _)| match mesh.node(id).kind {
            NodeKind::Surface { face, .. } => Some(face),
            NodeKind::Cluster { .. } => None,
        })
        .collect();
    (panes.len() + 1).min(MAX_LAYERS)
}
