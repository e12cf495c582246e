//! The patch mesh: a forest of nodes with two cuts through it.
//!
//! *Clusters* (one for each placed mesh) hold *surfaces* (one for each lit side of a face), and surfaces are cut
//! into smaller and smaller cells. *Patches* (they shoot) and *elements* (they receive; Cohen, Greenberg, Immel, Brock
//! 1986) are two cuts through that forest: every root-to-leaf path crosses each once, patches above elements. Elements can
//! be cut further once there is light ([`PatchMesh::plan_refinement`]): nodes of patches and of elements that stay keep
//! their ids.

mod box_tree;
pub mod clean;
pub mod constraints;
pub mod discontinuities;
pub mod edit;
pub mod exposure;
pub mod face;
mod grow;
mod locate;
mod materials;
mod options;
mod red_green;
mod refine;
mod sizes;
pub mod subdivide;

use crate::cast::to_f32;
pub use options::PatchOptions;
pub use red_green::Refinement;
pub use refine::RefinementPlan;

use crate::error::RadiosityError;
use crate::patch::constraints::CutCounts;
use crate::patch::exposure::{ExposedArea, ExposedPoints};
use crate::patch::face::{Side, WorldFace, world_faces};
use crate::patch::locate::Locator;
use crate::patch::refine::Base;
use crate::patch::sizes::Sizes;
use crate::patch::subdivide::Cell;
use crate::sampling::{cosine_direction, point2};
use crate::stop::{NEVER, Stop};
use crate::visibility::Visibility;
use glam::Vec3;
use hemicube_raster::Rgb;
use hemicube_scene::{ImportReport, Scene};
use rayon::prelude::*;
use std::collections::HashSet;
use std::sync::Arc;

/// Most elements that a mesh may have; a million take some 700 MB with everything that is made of them.
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
    /// Whether the nodes below it come from lines that cross it instead of its size.
    is_cut: bool,
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
    hard_edges: HashSet<(u32, u32)>,
    /// What it was before any refinement, if there was one.
    base: Option<Arc<Base>>,
    refinement: Refinement,
    cuts: CutCounts,
    report: ImportReport,
}

/// Marks nodes that are not in a cut.
const NONE: u32 = u32::MAX;

/// Largest coordinate in the world; beyond it squares of areas leave the range of f32.
const MAX_COORDINATE: f32 = 1e9;

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
        Self::build_within(scene, options, MAX_ELEMENTS, stop)
    }

    /// As [`Self::build_until`], of at most so many elements, if that is less than [`MAX_ELEMENTS`].
    ///
    /// # Errors
    /// As [`Self::build_until`], or [`RadiosityError::TooManyElements`], mostly before elements are made.
    pub fn build_within(
        scene: Arc<Scene>,
        options: PatchOptions,
        most: usize,
        stop: Stop<'_>,
    ) -> Result<Self, RadiosityError> {
        let most = most.min(MAX_ELEMENTS);
        scene.check()?;
        options.check()?;
        let mut report = ImportReport::default();
        let mut faces = world_faces(&scene, &mut report);
        let sides = |face: &WorldFace| scene.materials[face.material as usize].lit_sides();
        if faces.iter().all(|face| sides(face) == 0) {
            return Err(RadiosityError::NoSurfaces(scene.name.clone()));
        }
        refuse_far_places(&scene, &faces)?;
        clean::clean(&scene, &mut faces, options.clean, &mut report);
        let faces: Arc<[WorldFace]> = faces.into();
        let sizes = Sizes::choose(&scene, &faces, options, most)?;
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
            hard_edges: HashSet::new(),
            base: None,
            refinement: Refinement::default(),
            cuts: CutCounts::default(),
            visibility: Arc::new(Visibility::new(scene.clone(), faces.clone())),
            faces,
            scene,
        };
        let stopped = RadiosityError::Stopped("while the mesh was built");
        if mesh.grow_to_count(sizes, stop).is_none() {
            return Err(stopped);
        }
        mesh.refuse_too_many(most)?;
        mesh.finish(stop).ok_or(stopped)?;
        Ok(mesh)
    }

    /// Everything that follows from the nodes and the cuts; none if it was stopped.
    fn finish(&mut self, stop: Stop<'_>) -> Option<()> {
        self.average_materials(stop)?;
        let exposure = exposure::of_elements(self, stop)?;
        self.exposed_area = exposure
            .iter()
            .zip(&self.elements)
            .map(|(exposure, &id)| exposure.share * self.node(id).area)
            .collect();
        self.exposure = exposure
            .into_iter()
            .map(|exposure| exposure.points)
            .collect();
        Some(())
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

    /// What cut elements beyond their size.
    pub fn cuts(&self) -> CutCounts {
        self.cuts
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

    /// Sides of faces that receive light; each is at least one element.
    pub fn lit_sides(&self) -> usize {
        self.roots.iter().flatten().flatten().count()
    }

    /// Faces that only block (their material is an [obstruction](hemicube_scene::Material::obstruction)): position in
    /// [`Self::faces`] and [vertices](Self::vertices). No node stands for them.
    pub fn obstructions(&self) -> &[(u32, Cell)] {
        &self.obstructions
    }

    /// Edges along which light may jump, by their vertices, the smaller index first: shadows end there, or another surface
    /// stands there. Light is not averaged over them.
    pub fn hard_edges(&self) -> &HashSet<(u32, u32)> {
        &self.hard_edges
    }

    /// Whether light may jump along an edge.
    pub(crate) fn is_hard_edge(&self, a: u32, b: u32) -> bool {
        !self.hard_edges.is_empty() && self.hard_edges.contains(&(a.min(b), a.max(b)))
    }

    /// The same mesh with other [hard edges](Self::hard_edges); which vertex comes first does not matter.
    pub fn with_hard_edges(self, edges: impl IntoIterator<Item = (u32, u32)>) -> Self {
        let sorted = |(a, b): (u32, u32)| (a.min(b), a.max(b));
        Self {
            hard_edges: edges.into_iter().map(sorted).collect(),
            ..self
        }
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
}

impl PatchMesh {
    fn refuse_too_many(&self, most: usize) -> Result<(), RadiosityError> {
        let elements = self.elements.len();
        if elements > most {
            return Err(RadiosityError::TooManyElements { elements, most });
        }
        Ok(())
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

fn id32(index: usize) -> u32 {
    u32::try_from(index).expect("a mesh has fewer than 2^32 nodes")
}
