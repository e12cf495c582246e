//! Covers that lie on a surface: cover and covered part see nothing but each other, so no way to form factors is asked
//! about them.

use super::SurfacesBy;
use crate::patch::PatchMesh;
use glam::DVec3;
use hemicube_scene::Mask;
use std::collections::HashMap;

/// Two rows that exchange everything over an area that both have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contact {
    /// The covering and the covered surface.
    pub(super) rows: [u32; 2],
    /// Diffuse reflectance of both, the mean over the bands.
    pub(super) reflectances: [f64; 2],
    pub(super) area: f64,
}

/// Adds a row for each cover of the scene, and one for a covered surface that has none yet.
///
/// Between objects the covered part belongs to its surface, between faces it is one of its own.
pub(super) fn add_rows(mesh: &PatchMesh, by: SurfacesBy, names: &mut Vec<String>) -> Vec<Contact> {
    let masks = mesh.scene().view_factors.iter();
    let masks: Vec<&Mask> = masks.flat_map(|asked| &asked.masks).collect();
    if masks.is_empty() {
        return Vec::new();
    }
    let mut known: HashMap<String, u32> = names.iter().cloned().zip(0..).collect();
    let mut row = |name: String| {
        *known.entry(name).or_insert_with_key(|name| {
            names.push(name.clone());
            crate::index32(names.len() - 1)
        })
    };
    let nodes = covering_nodes(mesh);
    let contacts = masks.iter().filter_map(|mask| {
        let &(area, cover) = nodes.get(mask.node.as_str())?;
        let base = match by {
            SurfacesBy::Object => mask.base.clone(),
            SurfacesBy::Face => format!("{} under {}", mask.base, mask.node),
        };
        Some(Contact {
            rows: [row(mask.node.clone()), row(base)],
            reflectances: [cover, mask.base_material].map(|material| reflectance(mesh, material)),
            area,
        })
    });
    contacts.collect()
}

/// Area and material of what only blocks, by node.
fn covering_nodes(mesh: &PatchMesh) -> HashMap<&str, (f64, usize)> {
    let mut nodes = HashMap::new();
    for &(face, _) in mesh.obstructions() {
        let face = &mesh.faces()[face as usize];
        let node = mesh.scene().instances[face.instance as usize].node.as_str();
        let (area, _) = nodes.entry(node).or_insert((0.0, face.material as usize));
        let corners: Vec<DVec3> = face.polygon().iter().map(|c| c.as_dvec3()).collect();
        *area += 0.5 * doubled_area(&corners).length();
    }
    nodes
}

/// Twice the vector area of a flat polygon: from its direction the corners run counter-clockwise.
pub(super) fn doubled_area(corners: &[DVec3]) -> DVec3 {
    corners
        .windows(2)
        .map(|pair| (pair[0] - corners[0]).cross(pair[1] - corners[0]))
        .sum()
}

fn reflectance(mesh: &PatchMesh, material: usize) -> f64 {
    let bands = mesh.scene().materials[material].base_color.to_array();
    bands.map(f64::from).iter().sum::<f64>() / 3.0
}
