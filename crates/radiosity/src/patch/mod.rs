//! The patch mesh: a forest of nodes with two cuts through it.
//!
//! *Clusters* (one for each placed mesh) hold *surfaces* (one for each lit side of a face), and surfaces are halved
//! into smaller and smaller cells. *Patches* (they shoot) and *elements* (they receive; Cohen, Greenberg, Immel, Brock
//! 1986) are two cuts through that forest: every root-to-leaf path crosses each once, patches above elements.

pub mod edit;
pub mod exposure;
pub mod face;
mod locate;
pub mod subdivide;

use crate::error::RadiosityError;
use crate::patch::exposure::{ExposedArea, ExposedPoints};
use crate::patch::face::{Side, WorldFace, newell_normal, world_faces};
use crate::patch::locate::Locator;
use crate::patch::subdivide::{Cell, Vertices, any_edge_longer, split};
use crate::sampling::{cosine_direction, point_in_polygon, point2};
use crate::stop::{NEVER, Stop};
use crate::visibility::Visibility;
use glam::Vec3;
use hemicube_raster::Rgb;
use hemicube_scene::report::counted;
use hemicube_scene::{ImportReport, Scene};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Most elements that a mesh may have; a million take about 600 MB with everything that is made of them.
pub const MAX_ELEMENTS: usize = 4_000_000;

/// A node of the forest; ids are stable, nodes are only ever appended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub u32);

impl NodeId {
    /// As an index into arrays over nodes.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// One node of the forest.
#[derive(Debug, Clone, Copy)]
pub struct Node {
    /// The node above; `None` for clusters.
    pub parent: Option<NodeId>,
    /// First of the consecutive nodes below.
    first_child: u32,
    child_count: u32,
    /// What it is.
    pub kind: NodeKind,
    /// Its vertices, counter-clockwise seen from the side that receives; empty for clusters.
    cell: Cell,
    /// Area in square scene units; of clusters the sum over their surfaces.
    pub area: f32,
    /// Mean of the vertices.
    pub centroid: Vec3,
    /// Unit normal of the side that receives and radiates; zero for clusters.
    pub normal: Vec3,
}

/// What a node stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NodeKind {
    /// Everything that one instance of the scene brings.
    Cluster {
        /// Index of the scene's instance.
        instance: u32,
    },
    /// A lit side of a face, or a part of one.
    Surface {
        /// Index into [`PatchMesh::faces`].
        face: u32,
        /// Which of its sides.
        side: Side,
    },
}

/// How fine the mesh is. Sizes are edge lengths in scene units; counts choose the size that stays just below them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PatchOptions {
    /// Longest edge of a patch. Default value: three element sizes.
    pub patch_size: Option<f32>,
    /// Longest edge of an element. Default value: a third of the patch size, or by `elements`.
    pub element_size: Option<f32>,
    /// Number of patches to aim at if there is no `patch_size`, beyond one for each lit side of a face.
    pub patches: Option<usize>,
    /// Number of elements to aim at if there is no `element_size`, beyond one for each lit side of a face.
    /// Default value: 4000.
    pub elements: Option<usize>,
}

impl PatchOptions {
    /// A mesh of about so many elements.
    pub fn with_elements(self, elements: usize) -> Self {
        Self {
            elements: Some(elements),
            ..self
        }
    }

    /// A mesh of about so many patches.
    pub fn with_patches(self, patches: usize) -> Self {
        Self {
            patches: Some(patches),
            ..self
        }
    }

    /// Elements with edges of at most this length.
    pub fn with_element_size(self, size: f32) -> Self {
        Self {
            element_size: Some(size),
            ..self
        }
    }

    /// No cuts: each lit side of a face is one patch and one element.
    pub fn whole_faces() -> Self {
        Self::default().with_element_size(LONGER_THAN_ANY_EDGE)
    }

    /// Patches with edges of at most this length.
    pub fn with_patch_size(self, size: f32) -> Self {
        Self {
            patch_size: Some(size),
            ..self
        }
    }

    fn check(&self) -> Result<(), RadiosityError> {
        for (name, size) in [
            ("patch size", self.patch_size),
            ("element size", self.element_size),
        ] {
            if let Some(size) = size.filter(|s| !s.is_finite() || *s <= 0.0) {
                return Err(RadiosityError::Option(format!(
                    "{name} {size} is not a positive length"
                )));
            }
        }
        for (name, count) in [("patches", self.patches), ("elements", self.elements)] {
            if let Some(count) = count.filter(|&n| n == 0 || n > MAX_ELEMENTS) {
                return Err(RadiosityError::Option(format!(
                    "{name} {count} is not between 1 and {MAX_ELEMENTS}"
                )));
            }
        }
        Ok(())
    }
}

/// The scene cut into patches and elements.
#[derive(Debug, Clone)]
pub struct PatchMesh {
    scene: Arc<Scene>,
    options: PatchOptions,
    faces: Arc<[WorldFace]>,
    visibility: Arc<Visibility>,
    /// Root nodes of each face's front and back; `None` where that side only absorbs.
    roots: Vec<[Option<NodeId>; 2]>,
    locator: Locator,
    /// Faces without a lit side, with their vertices.
    obstructions: Vec<(u32, Cell)>,
    vertices: Vec<Vec3>,
    nodes: Vec<Node>,
    patches: Vec<NodeId>,
    elements: Vec<NodeId>,
    element_of_node: Vec<u32>,
    patch_of_element: Vec<u32>,
    patch_of_node: Vec<u32>,
    elements_of_patch: Vec<core::ops::Range<u32>>,
    reflectance: Vec<Rgb>,
    emission: Vec<Rgb>,
    transmittance: Vec<Rgb>,
    exposure: Vec<ExposedPoints>,
    exposed_area: Vec<f32>,
    report: ImportReport,
}

/// Marks nodes that are not in a cut.
const NONE: u32 = u32::MAX;

/// Largest coordinate in the world; beyond it squares of areas leave the range of f32.
const MAX_COORDINATE: f32 = 1e9;

/// Longer than an edge between any two places within [`MAX_COORDINATE`].
const LONGER_THAN_ANY_EDGE: f32 = 1e10;

impl PatchMesh {
    /// Cuts a scene into patches and elements.
    ///
    /// # Errors
    /// A scene that breaks [`Scene::check`], has no face with an area or one beyond `1e9` units, or sizes that are no
    /// sizes.
    pub fn build(scene: Arc<Scene>, options: PatchOptions) -> Result<Self, RadiosityError> {
        Self::build_until(scene, options, NEVER)
    }

    /// As [`Self::build`], unless it is stopped.
    ///
    /// # Errors
    /// As [`Self::build`], or [`RadiosityError::Stopped`].
    pub fn build_until(
        scene: Arc<Scene>,
        options: PatchOptions,
        stop: Stop<'_>,
    ) -> Result<Self, RadiosityError> {
        scene.check()?;
        options.check()?;
        let mut report = ImportReport::default();
        let faces: Arc<[WorldFace]> = world_faces(&scene, &mut report).into();
        let sides = |face: &WorldFace| scene.materials[face.material as usize].lit_sides();
        if faces.iter().all(|face| sides(face) == 0) {
            return Err(RadiosityError::NoSurfaces(scene.name.clone()));
        }
        refuse_far_places(&scene, &faces)?;
        let sizes = Sizes::choose(&scene, &faces, options)?;
        let mut mesh = Self {
            options,
            roots: vec![[None; 2]; faces.len()],
            locator: Locator::default(),
            obstructions: Vec::new(),
            vertices: Vec::new(),
            nodes: Vec::new(),
            patches: Vec::new(),
            elements: Vec::new(),
            element_of_node: Vec::new(),
            patch_of_element: Vec::new(),
            patch_of_node: Vec::new(),
            elements_of_patch: Vec::new(),
            reflectance: Vec::new(),
            emission: Vec::new(),
            transmittance: Vec::new(),
            report,
            exposure: Vec::new(),
            exposed_area: Vec::new(),
            visibility: Arc::new(Visibility::new(scene.clone(), faces.clone())),
            faces,
            scene,
        };
        let stopped = RadiosityError::Stopped("while the mesh was built");
        if mesh.grow(sizes, stop).is_none() || mesh.average_materials(stop).is_none() {
            return Err(stopped);
        }
        let exposure = exposure::of_elements(&mesh, stop).ok_or(stopped)?;
        mesh.exposed_area = exposure
            .iter()
            .zip(&mesh.elements)
            .map(|(exposure, &id)| exposure.share * mesh.node(id).area)
            .collect();
        mesh.exposure = exposure
            .into_iter()
            .map(|exposure| exposure.points)
            .collect();
        Ok(mesh)
    }

    /// The scene it was made from.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The options it was made with.
    pub fn options(&self) -> PatchOptions {
        self.options
    }

    /// What was left out on the way.
    pub fn report(&self) -> &ImportReport {
        &self.report
    }

    /// The scene's faces in the world.
    pub fn faces(&self) -> &[WorldFace] {
        &self.faces
    }

    /// Rays against those faces.
    pub fn visibility(&self) -> &Visibility {
        &self.visibility
    }

    /// The part of an element that is not buried inside a solid; light is received and radiated there.
    pub fn exposed(&self, element: usize) -> ExposedArea {
        let id = self.elements[element];
        ExposedArea::new(
            self.polygon(id),
            self.node(id).area,
            self.exposed_area[element],
            self.exposure[element],
        )
    }

    /// Area of the exposed part of an element. Irradiance and radiosity are means over this part.
    pub fn exposed_area(&self, element: usize) -> f32 {
        self.exposed_area[element]
    }

    /// Whether rays from the elements, one each, all meet a side that receives: nothing escapes, no backs absorb.
    pub fn is_closed(&self) -> bool {
        self.elements.par_iter().enumerate().all(|(e, &id)| {
            let normal = self.node(id).normal;
            let sample = point2(id32(e), 0);
            let origin = self.node(id).centroid;
            let origin = self.visibility.off_surface(origin, normal);
            let hit =
                self.visibility
                    .first_hit(origin, cosine_direction(normal, sample), f32::INFINITY);
            hit.is_some_and(|hit| self.visibility.receives(hit.face, hit.side))
        })
    }

    /// Faces that only block (their material is an [obstruction](hemicube_scene::Material::obstruction)): position in
    /// [`Self::faces`] and [vertices](Self::vertices). No node stands for them.
    pub fn obstructions(&self) -> &[(u32, Cell)] {
        &self.obstructions
    }

    /// World positions of the shared vertices.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// All nodes, indexed by id.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// A node.
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.index()]
    }

    /// The nodes below a node.
    pub fn children(&self, id: NodeId) -> impl ExactSizeIterator<Item = NodeId> + use<> {
        let node = self.node(id);
        (node.first_child..node.first_child + node.child_count).map(NodeId)
    }

    /// The cut of nodes that shoot.
    pub fn patches(&self) -> &[NodeId] {
        &self.patches
    }

    /// The cut of nodes that receive. Arrays "per element" run in this order.
    pub fn elements(&self) -> &[NodeId] {
        &self.elements
    }

    /// Position in [`Self::patches`] of the patch over an element.
    pub fn patch_of_element(&self, element: usize) -> usize {
        self.patch_of_element[element] as usize
    }

    /// Position in [`Self::patches`] of a node, if it is one of them.
    pub fn patch_of_node(&self, id: NodeId) -> Option<usize> {
        let patch = *self.patch_of_node.get(id.index())?;
        (patch != NONE).then_some(patch as usize)
    }

    /// Position in [`Self::elements`] of a node, if it is one of them.
    pub fn element_of_node(&self, id: NodeId) -> Option<usize> {
        let element = *self.element_of_node.get(id.index())?;
        (element != NONE).then_some(element as usize)
    }

    /// Positions in [`Self::elements`] of a patch's elements; they are consecutive.
    pub fn elements_of_patch(&self, patch: usize) -> core::ops::Range<usize> {
        let range = &self.elements_of_patch[patch];
        range.start as usize..range.end as usize
    }

    /// Diffuse reflectance of each element, averaged over its texture; at most the scene's `max_reflectance`.
    pub fn reflectance(&self) -> &[Rgb] {
        &self.reflectance
    }

    /// Emitted exitance `E = π L` of each element, averaged over its texture: lm/m² or W/m².
    pub fn emission(&self) -> &[Rgb] {
        &self.emission
    }

    /// Share of arriving light that passes straight through each element.
    pub fn transmittance(&self) -> &[Rgb] {
        &self.transmittance
    }

    /// Vertex indices of a node, counter-clockwise seen from the side that receives.
    pub fn corners(&self, id: NodeId) -> &[u32] {
        self.nodes[id.index()].cell.corners()
    }

    /// World positions of a node's vertices in the first `n` of four, counter-clockwise from the receiving side.
    pub fn polygon(&self, id: NodeId) -> Polygon {
        let cell = self.nodes[id.index()].cell;
        Polygon {
            corners: cell.corners.map(|c| self.vertices[c as usize]),
            count: cell.count,
        }
    }

    /// Makes clusters, surfaces and everything below; none if it was stopped.
    fn grow(&mut self, sizes: Sizes, stop: Stop<'_>) -> Option<()> {
        let mut vertices = Vertices::default();
        let mut first = 0;
        while first < self.faces.len() {
            let instance = self.faces[first].instance;
            let end = first
                + self.faces[first..]
                    .iter()
                    .take_while(|f| f.instance == instance)
                    .count();
            self.grow_cluster(instance, first..end, sizes, &mut vertices, stop)?;
            first = end;
        }
        self.vertices = vertices.positions;
        Some(())
    }

    fn grow_cluster(
        &mut self,
        instance: u32,
        faces: core::ops::Range<usize>,
        sizes: Sizes,
        vertices: &mut Vertices,
        stop: Stop<'_>,
    ) -> Option<()> {
        let material = |face: usize| &self.scene.materials[self.faces[face].material as usize];
        if faces.clone().all(|face| material(face).lit_sides() == 0) {
            for face in faces {
                let cell = cell_of(self.faces[face].polygon(), vertices);
                self.obstructions.push((id32(face), cell));
            }
            return Some(());
        }
        let cluster = NodeId(id32(self.nodes.len()));
        let blank = Node {
            parent: None,
            first_child: cluster.0 + 1,
            child_count: 0,
            kind: NodeKind::Cluster { instance },
            cell: Cell {
                corners: [0; 4],
                count: 0,
            },
            area: 0.0,
            centroid: Vec3::ZERO,
            normal: Vec3::ZERO,
        };
        self.nodes.push(blank);
        // Children of a node are consecutive, so all surfaces come before anything below them.
        for face in faces.clone() {
            let lit = self.scene.materials[self.faces[face].material as usize].lit_sides();
            for &side in &[Side::Front, Side::Back][..lit] {
                self.push_surface(cluster, face, side, vertices);
            }
        }
        let surfaces = cluster.0 + 1..id32(self.nodes.len());
        for surface in surfaces.clone() {
            if stop() {
                return None;
            }
            self.subdivide_surface(NodeId(surface), sizes, vertices);
        }
        let below = &self.nodes[surfaces.start as usize..surfaces.end as usize];
        let area: f64 = below.iter().map(|n| f64::from(n.area)).sum();
        let weighted: Vec3 = below.iter().map(|n| n.centroid * n.area).sum();
        let node = &mut self.nodes[cluster.index()];
        node.child_count = surfaces.end - surfaces.start;
        node.area = to_f32(area);
        node.centroid = weighted / node.area;
        Some(())
    }

    fn push_surface(&mut self, cluster: NodeId, face: usize, side: Side, vertices: &mut Vertices) {
        let mut polygon = self.faces[face].polygon().to_vec();
        if side == Side::Back {
            polygon.reverse();
        }
        let cell = cell_of(&polygon, vertices);
        let id = self.push_cell(
            cluster,
            NodeKind::Surface {
                face: id32(face),
                side,
            },
            cell,
            vertices,
        );
        self.roots[face][side as usize] = Some(id);
    }

    fn push_cell(
        &mut self,
        parent: NodeId,
        kind: NodeKind,
        cell: Cell,
        vertices: &Vertices,
    ) -> NodeId {
        let polygon: Vec<Vec3> = cell
            .corners()
            .iter()
            .map(|&c| vertices.positions[c as usize])
            .collect();
        let doubled = newell_normal(&polygon);
        // Parts of a face share its plane; slivers would lose the direction of their own.
        let normal = match (kind, self.node_kind(parent)) {
            (_, NodeKind::Surface { .. }) => self.nodes[parent.index()].normal,
            _ => doubled.normalize_or_zero(),
        };
        let node = Node {
            parent: Some(parent),
            first_child: 0,
            child_count: 0,
            kind,
            cell,
            area: 0.5 * doubled.dot(normal).max(0.0),
            centroid: polygon.iter().sum::<Vec3>() / f32::from(cell.count),
            normal,
        };
        self.nodes.push(node);
        NodeId(id32(self.nodes.len() - 1))
    }

    fn node_kind(&self, id: NodeId) -> NodeKind {
        self.nodes[id.index()].kind
    }

    /// Halves a surface down to the elements, noting where the cut of patches passes.
    fn subdivide_surface(&mut self, surface: NodeId, sizes: Sizes, vertices: &mut Vertices) {
        let NodeKind::Surface { face, .. } = self.node_kind(surface) else {
            unreachable!("a surface")
        };
        let patch_size = sizes.patch_size(&self.scene, &self.faces[face as usize]);
        // Depth first, so that the elements below one patch are consecutive.
        let mut stack = vec![(surface, 0, None)];
        while let Some((id, depth, patch)) = stack.pop() {
            let cell = self.nodes[id.index()].cell;
            let cells = split(cell, sizes.element, depth, vertices);
            let polygon: Vec<Vec3> = cell
                .corners()
                .iter()
                .map(|&c| vertices.positions[c as usize])
                .collect();
            let starts_patch =
                patch.is_none() && (cells.is_empty() || !any_edge_longer(&polygon, patch_size));
            let patch = if starts_patch {
                self.patches.push(id);
                let start = id32(self.elements.len());
                self.elements_of_patch.push(start..start);
                Some(id32(self.patches.len() - 1))
            } else {
                patch
            };
            if cells.is_empty() {
                let patch = patch.expect("an element lies below a patch");
                self.elements.push(id);
                self.patch_of_element.push(patch);
                self.elements_of_patch[patch as usize].end = id32(self.elements.len());
                continue;
            }
            let first_child = id32(self.nodes.len());
            let kind = self.node_kind(id);
            for &child in &cells {
                let child = self.push_cell(id, kind, child, vertices);
                stack.push((child, depth + 1, patch));
            }
            self.nodes[id.index()].first_child = first_child;
            self.nodes[id.index()].child_count = id32(cells.len());
        }
    }

    /// Averages materials over each element; none if it was stopped.
    fn average_materials(&mut self, stop: Stop<'_>) -> Option<()> {
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
    fn average_material(&self, id: NodeId) -> [Rgb; 3] {
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

/// The vertices of a face.
fn cell_of(polygon: &[Vec3], vertices: &mut Vertices) -> Cell {
    let mut at = |i: usize| vertices.at(polygon[i]);
    match polygon.len() {
        3 => Cell::triangle(at(0), at(1), at(2)),
        4 => Cell::quad(at(0), at(1), at(2), at(3)),
        _ => unreachable!("a face has three or four corners"),
    }
}

fn refuse_far_places(scene: &Scene, faces: &[WorldFace]) -> Result<(), RadiosityError> {
    let reach = |face: &WorldFace| face.corners.map(|c| c.abs().max_element());
    let is_far = |face: &&WorldFace| reach(face).iter().any(|&x| x > MAX_COORDINATE);
    let Some(face) = faces.iter().find(is_far) else {
        return Ok(());
    };
    let node = &scene.instances[face.instance as usize].node;
    let farthest = reach(face).into_iter().fold(0.0, f32::max);
    Err(RadiosityError::Option(format!(
        "scene '{}': node '{node}' reaches to {farthest:e} units, at most {MAX_COORDINATE:e} can be computed with; \
         choose a smaller --unit, or leave it out with --hide '{node}'",
        scene.name
    )))
}

/// A triangle or quad by value; dereferences to its corners.
#[derive(Debug, Clone, Copy)]
pub struct Polygon {
    corners: [Vec3; 4],
    count: u8,
}

impl core::ops::Deref for Polygon {
    type Target = [Vec3];
    fn deref(&self) -> &[Vec3] {
        &self.corners[..self.count as usize]
    }
}

/// The edge lengths at which subdivision stops.
#[derive(Debug, Clone, Copy)]
struct Sizes {
    element: f32,
    patch: f32,
    /// Patches on emitters, where they are a small part of the scene: a light shoots most and casts the shadows that
    /// people look at.
    emitter_patch: f32,
}

impl Sizes {
    fn choose(
        scene: &Scene,
        faces: &[WorldFace],
        options: PatchOptions,
    ) -> Result<Self, RadiosityError> {
        let sided = |face: &WorldFace| scene.materials[face.material as usize].lit_sides();
        let by_count = |count: usize| size_for_count(faces, sided, count);
        let patch = options.patch_size.or_else(|| options.patches.map(by_count));
        let element = match (options.element_size, options.elements, patch) {
            (Some(size), ..) => size,
            (None, Some(count), _) => by_count(count),
            (None, None, Some(patch)) => patch / 3.0,
            (None, None, None) => by_count(4000),
        };
        let patch = patch.unwrap_or(3.0 * element).max(element);
        let needed: usize = faces
            .iter()
            .map(|f| sided(f) * cells_of(f, element, MAX_ELEMENTS))
            .fold(0, usize::saturating_add);
        if needed > MAX_ELEMENTS {
            let message = format!(
                "elements of size {element} would be {needed} or more; at most {MAX_ELEMENTS} fit, so ask for larger ones"
            );
            return Err(RadiosityError::Option(message));
        }
        let area = |face: &WorldFace| f64::from(newell_normal(face.polygon()).length());
        let total: f64 = faces.iter().map(area).sum();
        let emitting: f64 = faces
            .iter()
            .filter(|f| scene.materials[f.material as usize].emits())
            .map(area)
            .sum();
        let emitter_patch = if emitting <= 0.05 * total {
            (patch / 4.0).max(element)
        } else {
            patch
        };
        Ok(Self {
            element,
            patch,
            emitter_patch,
        })
    }

    fn patch_size(&self, scene: &Scene, face: &WorldFace) -> f32 {
        if scene.materials[face.material as usize].emits() {
            self.emitter_patch
        } else {
            self.patch
        }
    }
}

/// The smallest size that gives at most so many cells beyond one for each lit side of a face, by bisection.
fn size_for_count(faces: &[WorldFace], sided: impl Fn(&WorldFace) -> usize, count: usize) -> f32 {
    let longest = faces
        .iter()
        .flat_map(|f| f.polygon().iter().map(|&p| p.distance(f.corners[0])))
        .fold(0.0, f32::max);
    let sides: usize = faces.iter().map(&sided).sum();
    let count = count.saturating_add(sides);
    let cells = |size: f32| -> usize {
        let mut sum: usize = 0;
        for face in faces {
            sum = sum.saturating_add(sided(face) * cells_of(face, size, count));
            if sum > count {
                break;
            }
        }
        sum
    };
    let (mut low, mut high) = (longest * 1e-5, longest * 2.0);
    for _ in 0..24 {
        let middle = (low * high).sqrt();
        if cells(middle) > count {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// How many cells a face becomes, estimated by its edges and stopped above a limit.
fn cells_of(face: &WorldFace, size: f32, limit: usize) -> usize {
    let polygon = face.polygon();
    let pieces = |a: Vec3, b: Vec3| -> usize {
        let halvings = (a.distance(b) / (size * 1.001))
            .log2()
            .ceil()
            .clamp(0.0, 24.0);
        1_usize << halving_count(halvings)
    };
    let cells = match *polygon {
        [a, b, c, d] => pieces(a, b)
            .max(pieces(c, d))
            .saturating_mul(pieces(b, c).max(pieces(d, a))),
        [a, b, c] => {
            let mut sides = [pieces(a, b), pieces(b, c), pieces(c, a)];
            sides.sort_unstable();
            sides[1].saturating_mul(sides[2])
        }
        _ => unreachable!("a face has three or four corners"),
    };
    cells.min(limit.saturating_add(1))
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "between 0 and 24"
)]
fn halving_count(halvings: f32) -> u32 {
    halvings as u32
}

#[expect(clippy::cast_possible_truncation, reason = "light is kept in f32")]
fn to_f32(x: f64) -> f32 {
    x as f32
}

fn id32(index: usize) -> u32 {
    u32::try_from(index).expect("a mesh has fewer than 2^32 nodes")
}
