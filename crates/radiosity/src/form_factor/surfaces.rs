//! What the rows of a matrix stand for: faces or objects of the scene, under the names that their maker gave them.

mod contacts;
mod overlaps;

pub use overlaps::Overlap;

use crate::form_factor::matrix::patch_area;
use crate::patch::face::Side;
use crate::patch::{NodeKind, PatchMesh};
use contacts::Contact;
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
///
/// A [mask](hemicube_scene::Mask) is a surface without a patch: it and what it covers see nothing but each other, and
/// both areas count. Between objects the covered part belongs to its base, between faces it is a surface called
/// `BASE under MASK`.
#[derive(Debug, Clone, PartialEq)]
pub struct Surfaces {
    names: Vec<String>,
    of_patch: Vec<u32>,
    buried: Vec<String>,
    contacts: Vec<Contact>,
}

impl Surfaces {
    /// The faces or objects of a mesh, in the order of the scene, or of the
    /// [rows](hemicube_scene::ViewFactorRequest::rows) that it asks for; masks come last otherwise.
    ///
    /// An object is called like its node. So is its face, with its number within the object where there are several, and
    /// with `back` for the second lit side of a double-sided face. No name occurs twice.
    pub fn new(mesh: &PatchMesh, by: SurfacesBy) -> Self {
        let (mut names, of_patch) = match by {
            SurfacesBy::Face => by_face(mesh),
            SurfacesBy::Object => by_object(mesh),
        };
        let contacts = contacts::add_rows(mesh, by, &mut names);
        let mut area = vec![0.0; names.len()];
        for (patch, &surface) in of_patch.iter().enumerate() {
            area[surface as usize] += patch_area(mesh, patch);
        }
        for contact in &contacts {
            for row in contact.rows {
                area[row as usize] += contact.area;
            }
        }
        let mut surfaces = Self {
            names: Vec::with_capacity(names.len()),
            of_patch,
            buried: Vec::new(),
            contacts,
        };
        let mut new_number = vec![NONE; names.len()];
        for i in order(mesh, by, &names) {
            let name = core::mem::take(&mut names[i]);
            if area[i] > 0.0 {
                new_number[i] = crate::index32(surfaces.names.len());
                surfaces.names.push(name);
            } else {
                surfaces.buried.push(name);
            }
        }
        let renumber = |surface: &mut u32| *surface = new_number[*surface as usize];
        surfaces.of_patch.iter_mut().for_each(renumber);
        let in_contact = surfaces.contacts.iter_mut();
        in_contact.flat_map(|c| &mut c.rows).for_each(renumber);
        surfaces
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

    /// Surfaces that lie in one place and face the same way, the largest overlap first. Each hides nothing of the other,
    /// so both get the light that arrives there, and rows sum to more than 1. Back to back is no overlap.
    pub fn overlaps(&self, mesh: &PatchMesh) -> Vec<Overlap> {
        overlaps::find(mesh, self)
    }

    /// Exchange areas `A_i F_ij` with surfaces that lie on one another: row, column and area, both ways, rows ascending.
    pub(crate) fn contact_exchanges(&self) -> Vec<(u32, u32, f64)> {
        let both = |c: &Contact| {
            let [cover, base] = c.rows;
            [(cover, base, c.area), (base, cover, c.area)]
        };
        let mut exchanges: Vec<_> = self.contacts.iter().flat_map(both).collect();
        exchanges.sort_by_key(|&(row, column, _)| (row, column));
        exchanges
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
        for contact in &self.contacts {
            for (row, reflectance) in contact.rows.into_iter().zip(contact.reflectances) {
                area[row as usize] += contact.area;
                reflected[row as usize] += contact.area * reflectance;
            }
        }
        let emissivity = |(reflected, area): (f64, f64)| 1.0 - reflected / area;
        reflected.into_iter().zip(area).map(emissivity).collect()
    }
}

/// The rows in the order that the scene asks for; those that it does not name come last, as they are.
fn order(mesh: &PatchMesh, by: SurfacesBy, names: &[String]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..names.len()).collect();
    let asked = mesh.scene().view_factors.as_ref();
    if let (SurfacesBy::Object, Some(asked)) = (by, asked) {
        let rows = asked.rows.iter().map(String::as_str).zip(0_usize..);
        let place: HashMap<&str, usize> = rows.collect();
        order.sort_by_key(|&i| place.get(names[i].as_str()).copied().unwrap_or(usize::MAX));
    }
    order
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
