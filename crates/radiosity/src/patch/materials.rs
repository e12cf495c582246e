//! What each element reflects, emits and lets through, averaged over its texture.

use crate::patch::face::WorldFace;
use crate::patch::locate::Locator;
use crate::patch::{NONE, NodeId, NodeKind, PatchMesh, id32};
use crate::sampling::point_in_polygon;
use crate::stop::Stop;
use hemicube_raster::Rgb;
use hemicube_scene::report::counted;
use rayon::prelude::*;

impl PatchMesh {
    /// Averages materials over each element; none if it was stopped.
    pub(super) fn average_materials(&mut self, stop: Stop<'_>) -> Option<()> {
        self.patch_of_node = vec![NONE; self.nodes.len()];
        for (i, id) in self.patches.iter().enumerate() {
            self.patch_of_node[id.index()] = id32(i);
        }
        self.element_of_node = vec![NONE; self.nodes.len()];
        for (i, id) in self.elements.iter().enumerate() {
            self.element_of_node[id.index()] = id32(i);
        }
        self.locator = Locator::new(self);
        let averages: Option<Vec<[Rgb; 3]>> = self
            .elements
            .par_iter()
            .map(|&id| (!stop()).then(|| self.average_material(id)))
            .collect();
        let averages = averages?;
        self.reflectance = averages.iter().map(|a| a[0]).collect();
        self.emission = averages.iter().map(|a| a[1]).collect();
        self.transmittance = averages.iter().map(|a| a[2]).collect();
        let lowered = self.scene.max_reflectance;
        let clamped = self
            .reflectance
            .iter()
            .filter(|r| r.max_band() >= lowered)
            .count();
        if clamped > 0 {
            let what = format!(
                "the reflectance of {} was lowered to {lowered}",
                counted(clamped, "element")
            );
            self.report.warn("reflectance", what);
        }
        Some(())
    }

    /// Reflectance, exitance and transmittance of an element, averaged over a low-discrepancy set of its points.
    pub(super) fn average_material(&self, id: NodeId) -> [Rgb; 3] {
        let NodeKind::Surface { face, .. } = self.node_kind(id) else {
            unreachable!("elements are surfaces")
        };
        let face = &self.faces[face as usize];
        let samples = if self.varies(face) { 128 } else { 1 };
        let polygon = self.polygon(id);
        let mut sums = [Rgb::BLACK; 3];
        for i in 0..samples {
            let at = if samples == 1 {
                self.node(id).centroid
            } else {
                point_in_polygon(&polygon, i, 0)
            };
            let sample = face.surface_at(&self.scene, at);
            sums[0] += sample.reflectance;
            sums[1] += sample.emission * core::f32::consts::PI;
            sums[2] += sample.transmittance;
        }
        sums.map(|sum| sum / samples as f32)
    }

    /// Whether a face's material may differ from point to point.
    fn varies(&self, face: &WorldFace) -> bool {
        let material = &self.scene.materials[face.material as usize];
        let mesh = &self.scene.meshes[self.scene.instances[face.instance as usize].mesh];
        let textured = material.base_color_texture.is_some()
            || material.emission_texture.is_some()
            || material.metallic_texture.is_some()
            || material.transmission_texture.is_some();
        textured || !mesh.colors.is_empty()
    }
}
