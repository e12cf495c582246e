//! `.vs3` files of View3D (Walton 2002, NISTIR 6925) come in.
//!
//! # What is read
//! Title, `F 3` (vertices and surfaces) and `F 3a` (surfaces by azimuth and tilt), `C` (`encl` and `eps` become
//! [`Scene::view_factors`]; the others are passed over with a warning where they matter), and all kinds of surfaces:
//!
//! - **S** radiates from its front. Each becomes an [`Instance`] called like the surface, with a material of the same
//!   name whose reflectance is 1 less the emissivity. Surfaces that are *combined* with another are instances called like
//!   that one, right after it: matrices by object sum them.
//! - **S with a base** lies in the plane of its base, like a window in a wall. The base is what is left around it, as one
//!   or more faces.
//! - **N** (null surface) takes a part of its base away: that part only blocks.
//! - **M** (mask) covers a part of its base. Mask and covered part see nothing but each other, so the part is taken away
//!   from the geometry as by N, and a [`Mask`] tells of both: matrices by object have the whole area of the base, and
//!   the mask as a row with the factor 1 to it, as View3D has. (View3D 4.0 departs from its manual where
//!   the base lies on a base itself, the mask then has a factor of -1 to the lower base, and where both surfaces of a
//!   pair are masked, one of the masks is then looked through. Here neither happens.)
//! - **O** only blocks ([`Material::obstruction`]); it may be the base of radiating surfaces.
//!
//! Instances stand in the order of the surfaces, so rows of a matrix by object have the numbers of View3D's output.
//! A name that two surfaces have gets the number of the second one. Coordinates are kept as they are: `F 3a` has z up,
//! which `--up z` turns to +Y.
//!
//! # What is not read
//! Two-dimensional files (`F 2`), coordinate transformations (`X`; View3D passes them over too), `emit=1`.

mod cut;
mod parse;

use crate::open::{checked, one_line, stem};
use crate::{Face, Instance, Mask, Material, Mesh, Scene, SceneError, Units, ViewFactorRequest};
use cut::{Sheet, doubled_area};
use glam::{Affine3A, DVec3};
use hemicube_raster::Rgb;
use parse::{Corners, Document, Kind};
use std::collections::HashSet;

/// Largest distance of a corner from its quad's plane, and of a subsurface from its base, as a share of the size.
const FLAT: f64 = 3e-5;
/// Cosine of the largest angle between normals that count as the same.
const SAME_DIRECTION: f64 = 0.999;
/// A subsurface may reach so far over the edge of its base, as a share of the base's size.
const OVER_EDGE: f64 = 1e-5;
/// Surfaces that a base may have upon it; each is cut from all pieces that the others left.
const MOST_ON_BASE: usize = 4096;
/// The highest reflectance that View3D allows.
const MAX_REFLECTANCE: f32 = 0.999;

/// Reads a `.vs3` file from memory; `file` names it in messages.
///
/// # Errors
/// One line that starts with `file`: what is wrong, in which line, how to mend it.
pub fn import(bytes: &[u8], file: &str) -> Result<Scene, SceneError> {
    let mut scene = Scene {
        name: stem(file),
        units: Units::Radiometric,
        max_reflectance: MAX_REFLECTANCE,
        ..Scene::default()
    };
    let invalid = |what: String| SceneError::Invalid(one_line(&format!("{file}: {what}")));
    let document = parse::parse(bytes, &mut scene.report).map_err(invalid)?;
    let surfaces = placed(&document).map_err(invalid)?;
    if !surfaces.iter().any(|s| s.kind == Kind::Radiating) {
        let what = "it has no radiating surface; describe them in lines that begin with S";
        return Err(invalid(what.to_owned()));
    }
    if !document.title.is_empty() {
        scene.name = one_line(&document.title);
    }
    scene.view_factors = Some(ViewFactorRequest {
        enclosure: document.enclosure,
        error: document.eps,
        masks: Vec::new(),
        rows: rows(&surfaces),
    });
    fill(&mut scene, &surfaces).map_err(invalid)?;
    checked(scene, file)
}

/// A surface in its place.
struct Placed {
    line: usize,
    kind: Kind,
    corners: Vec<DVec3>,
    normal: DVec3,
    /// Largest distance of a corner from the centroid.
    radius: f64,
    /// Counted from 0.
    base: Option<usize>,
    combined_with: Option<usize>,
    emissivity: f32,
    name: String,
}

impl Placed {
    fn problem(&self, what: &str) -> String {
        format!("line {}: surface '{}' {what}", self.line, self.name)
    }

    fn area(&self) -> f64 {
        0.5 * doubled_area(&self.corners).length()
    }
}

/// The surfaces in their places, with every rule of the format checked.
fn placed(document: &Document) -> Result<Vec<Placed>, String> {
    let mut surfaces = Vec::with_capacity(document.surfaces.len());
    for surface in &document.surfaces {
        let corners = match &surface.corners {
            Corners::Places(places) => places.clone(),
            Corners::Vertices(vertices) => {
                let at = |&v: &usize| {
                    document.vertices.get(v - 1).copied().ok_or_else(|| {
                        let count = document.vertices.len();
                        format!(
                            "line {}: surface '{}' uses vertex {v} of {count}; add it with V {v} x y z",
                            surface.line, surface.name
                        )
                    })
                };
                vertices.iter().map(at).collect::<Result<_, _>>()?
            }
        };
        let centroid = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let reach = corners.iter().map(|c| c.distance(centroid));
        let placed = Placed {
            line: surface.line,
            kind: surface.kind,
            normal: doubled_area(&corners).normalize_or_zero(),
            radius: reach.fold(0.0, f64::max),
            corners,
            base: surface.base.checked_sub(1),
            combined_with: surface.combined_with.checked_sub(1),
            emissivity: surface.emissivity,
            name: one_line(&surface.name),
        };
        check_shape(&placed)?;
        surfaces.push(placed);
    }
    for (i, surface) in surfaces.iter().enumerate() {
        check_base(surface, i, &surfaces)?;
        check_combination(surface, i, &surfaces)?;
    }
    name_apart(&mut surfaces);
    Ok(surfaces)
}

/// Refuses what is no flat convex polygon.
fn check_shape(surface: &Placed) -> Result<(), String> {
    let corners = &surface.corners;
    let n = corners.len();
    let longest = 2.0 * surface.radius;
    if doubled_area(corners).length() <= 1e-6 * longest * longest {
        return Err(surface.problem("has no area; check its vertices"));
    }
    let away = |c: &DVec3| (*c - corners[0]).dot(surface.normal).abs();
    if corners.iter().map(away).fold(0.0, f64::max) > FLAT * longest {
        return Err(surface.problem(
            "is not flat; write it as two triangles and combine the second with the first (cmb)",
        ));
    }
    let turns_back = |i: usize| {
        let (before, here, after) = (corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n]);
        (here - before).cross(after - here).dot(surface.normal) < -1e-6 * longest * longest
    };
    if (0..n).any(turns_back) {
        return Err(surface.problem(
            "is not convex, or its vertices are not in order; write it as two triangles and combine them (cmb)",
        ));
    }
    Ok(())
}

fn check_base(surface: &Placed, number: usize, all: &[Placed]) -> Result<(), String> {
    let covers = matches!(surface.kind, Kind::Mask | Kind::Null);
    let Some(base) = surface.base else {
        return match covers {
            true => Err(surface.problem("has no base; masks and null surfaces lie on one")),
            false => Ok(()),
        };
    };
    let Some(on) = all.get(base) else {
        let what = format!(
            "has the base {}, there are {} surfaces",
            base + 1,
            all.len()
        );
        return Err(surface.problem(&what));
    };
    let allowed = match on.kind {
        Kind::Radiating => base < number,
        Kind::Obstruction => !covers,
        Kind::Mask | Kind::Null => false,
    };
    if !allowed {
        return Err(surface.problem(&format!(
            "cannot have '{}' (surface {}) as its base; a base is a radiating surface with a lower number{}",
            on.name,
            base + 1,
            if covers { "" } else { ", or an obstruction" }
        )));
    }
    let away = |c: &DVec3| (*c - on.corners[0]).dot(on.normal).abs();
    if surface.corners.iter().map(away).fold(0.0, f64::max) > FLAT * 2.0 * on.radius {
        return Err(surface.problem(&format!("is not in the plane of its base '{}'", on.name)));
    }
    let along = surface.normal.dot(on.normal) * if covers { -1.0 } else { 1.0 };
    if along < SAME_DIRECTION {
        let way = if covers { "towards" } else { "the same way as" };
        return Err(surface.problem(&format!(
            "must face {way} its base '{}'; reverse its vertices",
            on.name
        )));
    }
    let sheet = &on.corners;
    let outside = |c: &DVec3| {
        (0..sheet.len()).any(|i| {
            let (a, b) = (sheet[i], sheet[(i + 1) % sheet.len()]);
            let inwards = on.normal.cross(b - a).normalize_or_zero();
            (*c - a).dot(inwards) < -OVER_EDGE * 2.0 * on.radius
        })
    };
    if surface.corners.iter().any(outside) {
        return Err(surface.problem(&format!("reaches over the edge of its base '{}'", on.name)));
    }
    Ok(())
}

fn check_combination(surface: &Placed, number: usize, all: &[Placed]) -> Result<(), String> {
    let Some(with) = surface.combined_with else {
        return Ok(());
    };
    if surface.kind != Kind::Radiating {
        return Err(
            surface.problem("cannot be combined: it is no row of its own; set its cmb to 0")
        );
    }
    let first = all
        .get(with)
        .filter(|first| with < number && first.kind == Kind::Radiating);
    let Some(first) = first else {
        return Err(surface.problem(&format!(
            "cannot be combined with surface {}; name a radiating surface with a lower number",
            with + 1
        )));
    };
    match first.combined_with {
        Some(other) => Err(surface.problem(&format!(
            "is combined with '{}', which is combined itself; combine both with surface {}",
            first.name,
            other + 1
        ))),
        None => Ok(()),
    }
}

/// Gives each surface a name of its own: rows and options go by names.
fn name_apart(surfaces: &mut [Placed]) {
    let mut taken = HashSet::new();
    for (i, surface) in surfaces.iter_mut().enumerate() {
        while !taken.insert(surface.name.clone()) {
            surface.name = format!("{} ({})", surface.name, i + 1);
        }
    }
}

/// Names of the rows by object, in View3D's order: surfaces that are combined with another are none, null surfaces and
/// obstructions neither.
fn rows(surfaces: &[Placed]) -> Vec<String> {
    let is_row =
        |s: &&Placed| matches!(s.kind, Kind::Radiating | Kind::Mask) && s.combined_with.is_none();
    surfaces
        .iter()
        .filter(is_row)
        .map(|s| s.name.clone())
        .collect()
}

/// Places everything in the scene: radiating surfaces in their order, each with those that are combined with it, then
/// what only blocks.
fn fill(scene: &mut Scene, surfaces: &[Placed]) -> Result<(), String> {
    let mut upon: Vec<Vec<usize>> = vec![Vec::new(); surfaces.len()];
    let mut combined: Vec<Vec<usize>> = vec![Vec::new(); surfaces.len()];
    for (i, surface) in surfaces.iter().enumerate() {
        if let Some(base) = surface.base {
            upon[base].push(i);
        }
        if let Some(with) = surface.combined_with {
            combined[with].push(i);
        }
    }
    let radiates = |&i: &usize| surfaces[i].kind == Kind::Radiating;
    for i in (0..surfaces.len()).filter(radiates) {
        if surfaces[i].combined_with.is_some() {
            continue;
        }
        for &part in [i].iter().chain(&combined[i]) {
            let node = &surfaces[i].name;
            let material = place(scene, &surfaces[part], node, surfaces, &upon[part])?;
            let covers = upon[part]
                .iter()
                .filter(|&&cover| surfaces[cover].kind == Kind::Mask);
            let asked = scene.view_factors.get_or_insert_default();
            asked.masks.extend(covers.map(|&cover| Mask {
                node: surfaces[cover].name.clone(),
                base: node.clone(),
                base_material: material,
            }));
        }
    }
    for i in (0..surfaces.len()).filter(|i| !radiates(i)) {
        place(scene, &surfaces[i], &surfaces[i].name, surfaces, &upon[i])?;
    }
    Ok(())
}

/// Adds what is left of a surface around those upon it; its material's index.
fn place(
    scene: &mut Scene,
    surface: &Placed,
    node: &str,
    all: &[Placed],
    upon: &[usize],
) -> Result<usize, String> {
    if upon.len() > MOST_ON_BASE {
        let what = format!(
            "is the base of {} others, at most {MOST_ON_BASE} are read; split it",
            upon.len()
        );
        return Err(surface.problem(&what));
    }
    let mut sheet = Sheet::new(
        surface.corners.clone(),
        surface.normal,
        2.0 * surface.radius,
    );
    let mut rest = surface.area();
    for &i in upon {
        let mut hole = all[i].corners.clone();
        if all[i].normal.dot(surface.normal) < 0.0 {
            hole.reverse();
        }
        sheet.cut(&hole);
        rest -= all[i].area();
    }
    let left: f64 = sheet
        .pieces()
        .iter()
        .map(|p| 0.5 * doubled_area(p).length())
        .sum();
    if (left - rest).abs() > 1e-4 * surface.area() {
        return Err(surface.problem("is the base of surfaces that overlap; move them apart"));
    }
    let material = scene.materials.len();
    let reflectance = Rgb::splat(1.0 - surface.emissivity);
    scene.materials.push(match surface.kind {
        Kind::Radiating => Material::diffuse(&surface.name, reflectance),
        Kind::Mask => Material {
            base_color: reflectance,
            ..Material::blocking(&surface.name)
        },
        Kind::Null | Kind::Obstruction => Material::blocking(&surface.name),
    });
    let mut mesh = Mesh {
        name: surface.name.clone(),
        material,
        ..Mesh::default()
    };
    for piece in sheet.pieces() {
        add_faces(&mut mesh, piece, surface.normal);
    }
    if mesh.faces.is_empty() {
        let is_masked = upon.iter().any(|&i| all[i].kind == Kind::Mask);
        let what = match surface.kind {
            // It still exchanges with its masks, as View3D has it.
            Kind::Radiating if is_masked => return Ok(material),
            Kind::Radiating => {
                "is covered all over by those upon it; it has no area left and is no row"
            }
            _ => "is covered all over by those upon it",
        };
        scene.report.warn(
            format!("line {}, surface '{}'", surface.line, surface.name),
            what,
        );
        return Ok(material);
    }
    scene.instances.push(Instance {
        node: node.to_owned(),
        mesh: scene.meshes.len(),
        world_from_mesh: Affine3A::IDENTITY,
        flipped: false,
    });
    scene.meshes.push(mesh);
    Ok(material)
}

/// Adds a convex polygon as quads and triangles.
fn add_faces(mesh: &mut Mesh, polygon: &[DVec3], normal: DVec3) {
    // A vertex given twice in succession makes a triangle of a quad.
    let mut polygon = polygon.to_vec();
    polygon.dedup();
    if polygon.len() > 1 && polygon.first() == polygon.last() {
        polygon.pop();
    }
    let n = polygon.len();
    let is_corner = |&i: &usize| {
        let (before, here, after) = (polygon[(i + n - 1) % n], polygon[i], polygon[(i + 1) % n]);
        let (there, on) = (here - before, after - here);
        there.cross(on).dot(normal) > 1e-9 * there.length() * on.length()
    };
    // Corners on a straight line are no corners of a quad.
    let corners: Vec<DVec3> = (0..n).filter(is_corner).map(|i| polygon[i]).collect();
    if corners.len() < 3 {
        return;
    }
    let start = mesh.positions.len();
    mesh.positions.extend(corners.iter().map(|c| c.as_vec3()));
    let vertex = |i: usize| {
        u32::try_from(start + i).expect("a few thousand surfaces leave fewer than 2^32 corners")
    };
    let mut i = 1;
    while i + 1 < corners.len() {
        if i + 2 < corners.len() {
            mesh.faces.push(Face::Quad([
                vertex(0),
                vertex(i),
                vertex(i + 1),
                vertex(i + 2),
            ]));
            i += 2;
        } else {
            mesh.faces
                .push(Face::Triangle([vertex(0), vertex(i), vertex(i + 1)]));
            i += 1;
        }
    }
}
