//! What the rows of a matrix stand for: faces or objects of the scene, under the names that their maker gave them.

use crate::form_factor::matrix::patch_area;
use crate::patch::face::Side;
use crate::patch::{NodeKind, PatchMesh};
use std::collections::{HashMap, HashSet};

/// Marks patches that belong to no row.
const NONE: u32 = u32::MAX;

/// What one row of a matrix stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SurfacesBy {
    /// A lit side of a face; two triangles that make a planar quad are one face.
    #[default]
    Face,
    /// All faces of the scene nodes of one name.
    Object,
}

impl SurfacesBy {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Face, Self::Object];

    /// Name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Face => "face",
            Self::Object => "object",
        }
    }
}

/// The surfaces between which factors are wanted: which patches each one has, and its name.
///
/// Surfaces without an exposed point (the foot of a cupboard on the floor) are none: their factors would be shares of
/// nothing. [`buried`](Self::buried) names them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Surfaces {
    names: Vec<String>,
    of_patch: Vec<u32>,
    buried: Vec<String>,
}

impl Surfaces {
    /// The faces or objects of a mesh, in the order of the scene.
    ///
    /// An object is called like its node. So is its face, with its number within the object where there are several, and
    /// with `back` for the second lit side of a double-sided face. No name occurs twice.
    pub fn new(mesh: &PatchMesh, by: SurfacesBy) -> Self {
        let (names, of_patch) = match by {
            SurfacesBy::Face => by_face(mesh),
            SurfacesBy::Object => by_object(mesh),
        };
        let mut area = vec![0.0; names.len()];
        for (patch, &surface) in of_patch.iter().enumerate() {
            area[surface as usize] += patch_area(mesh, patch);
        }
        let mut kept = Self {
            names: Vec::with_capacity(names.len()),
            of_patch,
            buried: Vec::new(),
        };
        let mut new_number = Vec::with_capacity(names.len());
        for (name, area) in names.into_iter().zip(area) {
            if area > 0.0 {
                new_number.push(crate::index32(kept.names.len()));
                kept.names.push(name);
            } else {
                new_number.push(NONE);
                kept.buried.push(name);
            }
        }
        for surface in &mut kept.of_patch {
            *surface = new_number[*surface as usize];
        }
        kept
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// Their names, each once.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The surface that a patch is of, by its position in [`PatchMesh::patches`]; `None` if that is buried.
    pub fn of_patch(&self, patch: usize) -> Option<usize> {
        let surface = self.of_patch[patch];
        (surface != NONE).then_some(surface as usize)
    }

    /// Names of the surfaces that lie inside solids wherever they were probed and that therefore are left out.
    pub fn buried(&self) -> &[String] {
        &self.buried
    }

    /// Emissivity of each surface: 1 less its diffuse reflectance, the mean over its exposed area and the bands.
    pub fn emissivities(&self, mesh: &PatchMesh) -> Vec<f64> {
        let (mut reflected, mut area) = (vec![0.0; self.len()], vec![0.0; self.len()]);
        for patch in 0..self.of_patch.len() {
            let Some(surface) = self.of_patch(patch) else {
                continue;
            };
            for e in mesh.elements_of_patch(patch) {
                let a = f64::from(mesh.exposed_area(e));
                let bands = mesh.reflectance()[e].to_array().map(f64::from);
                area[surface] += a;
                reflected[surface] += a * bands.iter().sum::<f64>() / 3.0;
            }
        }
        let emissivity = |(reflected, area): (f64, f64)| 1.0 - reflected / area;
        reflected.into_iter().zip(area).map(emissivity).collect()
    }
}

/// Face and side that each patch is of.
fn face_of_patch(mesh: &PatchMesh, patch: usize) -> (usize, Side) {
    match mesh.node(mesh.patches()[patch]).kind {
        NodeKind::Surface { face, side } => (face as usize, side),
        NodeKind::Cluster { .. } => unreachable!("patches are parts of faces"),
    }
}

fn node_of_face(mesh: &PatchMesh, face: usize) -> &str {
    let instance = mesh.faces()[face].instance as usize;
    &mesh.scene().instances[instance].node
}

fn by_object(mesh: &PatchMesh) -> (Vec<String>, Vec<u32>) {
    let mut names: Vec<String> = Vec::new();
    let mut known: HashMap<&str, u32> = HashMap::new();
    let of_patch = (0..mesh.patches().len()).map(|patch| {
        let node = node_of_face(mesh, face_of_patch(mesh, patch).0);
        *known.entry(node).or_insert_with(|| {
            names.push(node.to_owned());
            crate::index32(names.len() - 1)
        })
    });
    let of_patch = of_patch.collect();
    (names, of_patch)
}

fn by_face(mesh: &PatchMesh) -> (Vec<String>, Vec<u32>) {
    // Patches of one side of a face are consecutive, and so are both sides of a face.
    let mut sides: Vec<(usize, Side)> = Vec::new();
    let mut of_patch = Vec::with_capacity(mesh.patches().len());
    for patch in 0..mesh.patches().len() {
        let side = face_of_patch(mesh, patch);
        if sides.last() != Some(&side) {
            sides.push(side);
        }
        of_patch.push(crate::index32(sides.len() - 1));
    }
    let mut faces_of_node: HashMap<&str, usize> = HashMap::new();
    for &(face, side) in &sides {
        *faces_of_node.entry(node_of_face(mesh, face)).or_default() +=
            usize::from(side == Side::Front);
    }
    let mut numbers: HashMap<&str, usize> = HashMap::new();
    let mut taken = HashSet::new();
    let name = |&(face, side): &(usize, Side)| {
        let node = node_of_face(mesh, face);
        let number = numbers.entry(node).or_default();
        *number += usize::from(side == Side::Front);
        let mut name = node.to_owned();
        if faces_of_node[node] > 1 {
            name.push_str(&format!(" {number}"));
        }
        if side == Side::Back {
            name.push_str(" back");
        }
        unique(name, &mut taken)
    };
    (sides.iter().map(name).collect(), of_patch)
}

/// The name, with a number if it is taken: face 1 of `box` meets a node called `box 1`.
fn unique(name: String, taken: &mut HashSet<String>) -> String {
    let mut candidate = name.clone();
    let mut count = 1_usize;
    while !taken.insert(candidate.clone()) {
        count += 1;
        candidate = format!("{name} ({count})");
    }
    candidate
}
