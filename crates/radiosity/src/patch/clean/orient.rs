//! One-sided faces that disagree with their neighbours about which side is their front.
//!
//! Two faces of one node that share an edge, and share it with no third, run along it in opposite directions if they show
//! the same side. Faces so connected are a *shell*. Where some of a shell disagree, they are turned around so that all
//! show one side, and rays decide which: from points on the shell to what looks at it, which are lamps, the sun, the sky
//! and the cameras. (Takayama, Jacobson, Kavan, Sorkine-Hornung 2014 count rays that leave the scene, which would turn
//! rooms inside out.) Where no side is seen more, the one stays that most of the area shows already.

use crate::patch::face::{Side, WorldFace};
use crate::sampling::{cosine_direction, point_in_polygon, point2};
use crate::visibility::Visibility;
use glam::Vec3;
use hemicube_scene::report::counted;
use hemicube_scene::{ImportReport, LightKind, Scene};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Points of a shell from which rays ask what sees it.
const POINTS: u32 = 48;
/// Points on emitting faces to which they ask.
const EMITTER_POINTS: u32 = 24;
/// Cameras to which they ask.
const MOST_CAMERAS: usize = 8;
/// Rays to a sky from each point.
const SKY_RAYS: u32 = 8;
/// A side is in front if it is seen so many times as often as the other.
const CLEARLY: u32 = 4;
/// Votes below which nothing is decided against a shell that agrees with itself.
const FEW_VOTES: u32 = 16;

/// Turns around what disagrees, and if asked whole shells of which lights and cameras see backs only. `corners` are the
/// numbers of each face's vertices.
pub fn orient(
    scene: &Scene,
    faces: &mut [WorldFace],
    corners: &[[u32; 4]],
    turn_to_light: bool,
    report: &mut ImportReport,
) {
    let neighbours = neighbours(scene, faces, corners);
    let all_agree = neighbours.iter().all(|pair| !pair.disagree);
    if all_agree && !turn_to_light {
        return;
    }
    let shells = shells(scene, faces, &neighbours);
    let doubtful: Vec<&Shell> = shells
        .iter()
        .filter(|shell| turn_to_light || !shell.agrees)
        .collect();
    let witnesses = Witnesses::new(scene, faces);
    let turned: Vec<Vec<u32>> = doubtful
        .par_iter()
        .map(|shell| witnesses.wrong_faces(shell, faces))
        .collect();
    for (shell, wrong) in doubtful.iter().zip(&turned) {
        tell(scene, faces, shell, wrong.len(), report);
    }
    for &face in turned.iter().flatten() {
        turn(&mut faces[face as usize]);
    }
}

fn tell(
    scene: &Scene,
    faces: &[WorldFace],
    shell: &Shell,
    turned: usize,
    report: &mut ImportReport,
) {
    let instance = faces[shell.faces[0].0 as usize].instance;
    let place = format!("node '{}'", scene.instances[instance as usize].node);
    if shell.is_twisted {
        let what = format!(
            "{} have no side in common, as on a Möbius strip; make the material double-sided",
            counted(shell.faces.len(), "face")
        );
        report.warn(place, what);
    } else if turned > 0 {
        let what = format!(
            "{turned} of {} turned around, so that all of them show the same side",
            counted(shell.faces.len(), "connected face")
        );
        report.warn(place, what);
    }
}

/// Shows the other side of a face as its front.
fn turn(face: &mut WorldFace) {
    let n = face.polygon().len();
    face.corners[..n].reverse();
    face.mesh_corners[..n].reverse();
    if n == 3 {
        face.corners[3] = face.corners[2];
        face.mesh_corners[3] = face.mesh_corners[2];
    }
    face.normal = -face.normal;
}

/// Two faces at an edge that no third one shares.
struct Neighbours {
    faces: [u32; 2],
    /// They run along it in the same direction.
    disagree: bool,
}

fn neighbours(scene: &Scene, faces: &[WorldFace], corners: &[[u32; 4]]) -> Vec<Neighbours> {
    let mut edges: Vec<([u32; 3], u32, bool)> = faces
        .par_iter()
        .zip(corners)
        .enumerate()
        .filter(|(_, (face, _))| scene.materials[face.material as usize].lit_sides() == 1)
        .flat_map_iter(|(index, (face, corners))| {
            let n = face.polygon().len();
            (0..n).map(move |i| {
                let (a, b) = (corners[i], corners[(i + 1) % n]);
                let key = [face.instance, a.min(b), a.max(b)];
                (key, crate::index32(index), a < b)
            })
        })
        .collect();
    edges.par_sort_unstable();
    let pairs = edges.chunk_by(|a, b| a.0 == b.0);
    pairs
        .filter(|uses| uses.len() == 2)
        .map(|uses| Neighbours {
            faces: [uses[0].1, uses[1].1],
            disagree: uses[0].2 == uses[1].2,
        })
        .collect()
}

/// Connected faces.
struct Shell {
    /// Each with whether it shows the other side than the first.
    faces: Vec<(u32, bool)>,
    /// Whether all show the same side.
    agrees: bool,
    /// Whether they cannot.
    is_twisted: bool,
}

fn shells(scene: &Scene, faces: &[WorldFace], neighbours: &[Neighbours]) -> Vec<Shell> {
    let mut sets = Sets::new(faces.len());
    let mut twisted = Vec::new();
    for pair in neighbours {
        if !sets.join(pair.faces, pair.disagree) {
            twisted.push(pair.faces[0]);
        }
    }
    let mut shells: BTreeMap<u32, Shell> = BTreeMap::new();
    for (i, face) in faces.iter().enumerate() {
        if scene.materials[face.material as usize].lit_sides() != 1 {
            continue;
        }
        let face = crate::index32(i);
        let (root, is_other) = sets.root(face);
        let shell = shells.entry(root).or_insert_with(|| Shell {
            faces: Vec::new(),
            agrees: true,
            is_twisted: false,
        });
        let is_first_other = shell.faces.first().is_some_and(|first| first.1);
        shell.agrees &= shell.faces.is_empty() || is_other == is_first_other;
        shell.faces.push((face, is_other));
    }
    for face in twisted {
        let (root, _) = sets.root(face);
        if let Some(shell) = shells.get_mut(&root) {
            (shell.is_twisted, shell.agrees) = (true, false);
        }
    }
    shells.into_values().collect()
}

/// Disjoint sets of faces, each with its side relative to the one above (Tarjan 1975, with parities).
struct Sets(Vec<(u32, bool)>);

impl Sets {
    fn new(count: usize) -> Self {
        Self((0..crate::index32(count)).map(|i| (i, false)).collect())
    }

    fn root(&mut self, face: u32) -> (u32, bool) {
        let (mut at, mut is_other) = (face, false);
        while self.0[at as usize].0 != at {
            let (above, side) = self.0[at as usize];
            let (top, top_side) = self.0[above as usize];
            // Halves the path on the way.
            self.0[at as usize] = (top, side ^ if top == above { false } else { top_side });
            is_other ^= self.0[at as usize].1;
            at = top;
        }
        (at, is_other)
    }

    /// Says of two faces whether they show different sides; false if that is known to be wrong.
    fn join(&mut self, [a, b]: [u32; 2], differ: bool) -> bool {
        let ((a, side_a), (b, side_b)) = (self.root(a), self.root(b));
        let difference = side_a ^ side_b ^ differ;
        if a == b {
            return !difference;
        }
        self.0[a.max(b) as usize] = (a.min(b), difference);
        true
    }
}

/// What looks at surfaces.
struct Witnesses<'a> {
    visibility: Visibility,
    /// Eyes and lamps without size.
    places: Vec<Vec3>,
    /// Directions from which the sun shines.
    suns: Vec<Vec3>,
    /// Points on emitting faces, and normals.
    emitters: Vec<(Vec3, Vec3, bool)>,
    scene: &'a Scene,
}

impl<'a> Witnesses<'a> {
    fn new(scene: &'a Scene, faces: &[WorldFace]) -> Self {
        let eyes = scene.cameras.iter().map(|camera| camera.eye);
        let mut places: Vec<Vec3> = eyes.take(MOST_CAMERAS).collect();
        let mut suns = Vec::new();
        for light in &scene.lights {
            match light.kind {
                LightKind::Point { position, .. } | LightKind::Spot { position, .. } => {
                    places.push(position);
                }
                LightKind::Directional { direction, .. } => suns.push(-direction),
            }
        }
        let shared: Arc<[WorldFace]> = faces.into();
        Self {
            visibility: Visibility::new(Arc::new(scene.clone()), shared),
            places,
            suns,
            emitters: emitter_points(scene, faces),
            scene,
        }
    }

    /// The faces of a shell that show the wrong side.
    fn wrong_faces(&self, shell: &Shell, faces: &[WorldFace]) -> Vec<u32> {
        if shell.is_twisted {
            return Vec::new();
        }
        let [one, other] = self.votes(shell, faces);
        let wrong = |side: bool| {
            let of_side = shell
                .faces
                .iter()
                .filter(move |(_, is_other)| *is_other == side);
            of_side.map(|&(face, _)| face).collect()
        };
        if shell.agrees {
            let is_wrong = one == 0 && other >= FEW_VOTES;
            let first = shell.faces[0].1;
            return if is_wrong { wrong(first) } else { Vec::new() };
        }
        if one >= CLEARLY * other && one > 0 {
            return wrong(true);
        }
        if other >= CLEARLY * one && other > 0 {
            return wrong(false);
        }
        let area = |side: bool| -> f64 {
            let of_side = shell.faces.iter().filter(|(_, is_other)| *is_other == side);
            of_side.map(|&(face, _)| area(&faces[face as usize])).sum()
        };
        wrong(area(true) <= area(false))
    }

    /// How often each of its two sides is seen from points that are spread over a shell: that which the faces of the first
    /// kind show, and the other. Of a shell that agrees, the side that it shows comes first.
    fn votes(&self, shell: &Shell, faces: &[WorldFace]) -> [u32; 2] {
        let total: f64 = shell.faces.iter().map(|f| area(&faces[f.0 as usize])).sum();
        let step = total / f64::from(POINTS);
        let (mut before, mut next, mut votes) = (0.0, 0.5 * step, [0; 2]);
        let mut number = 0;
        for &(index, is_other) in &shell.faces {
            let face = &faces[index as usize];
            before += area(face);
            while next < before && number < POINTS {
                let point = point_in_polygon(face.polygon(), number, 0);
                let turned = is_other && !shell.agrees;
                for side in [Side::Front, Side::Back] {
                    let normal = if side == Side::Front {
                        face.normal
                    } else {
                        -face.normal
                    };
                    let seen = self.seen(point, normal, number);
                    votes[usize::from((side == Side::Back) != turned)] += seen;
                }
                next += step;
                number += 1;
            }
        }
        votes
    }

    /// How many witnesses see a point from the side of a normal.
    fn seen(&self, point: Vec3, normal: Vec3, number: u32) -> u32 {
        let origin = self.visibility.off_surface(point, normal);
        let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let sees_place = |place: &&Vec3| {
            (**place - point).dot(normal) > 0.0 && self.visibility.is_clear(origin, **place)
        };
        let sees_emitter = |&&(place, toward, both): &&(Vec3, Vec3, bool)| {
            let offset = point - place;
            let toward = if both {
                toward * offset.dot(toward).signum()
            } else {
                toward
            };
            let end = self.visibility.off_surface(place, toward);
            offset.dot(normal) < 0.0
                && offset.dot(toward) > 0.0
                && self.visibility.is_clear(origin, end)
        };
        let is_open = |direction: Vec3| {
            let far = self.visibility.diameter() * 2.0;
            self.visibility.is_clear(origin, origin + direction * far)
        };
        let sky = if self.scene.sky.is_black() {
            0
        } else {
            SKY_RAYS
        };
        let sky_rays = (0..sky).map(|i| cosine_direction(normal, point2(i, u64::from(number))));
        count(self.places.iter().filter(sees_place).count())
            + count(self.emitters.iter().filter(sees_emitter).count())
            + count(
                self.suns
                    .iter()
                    .filter(|sun| sun.dot(normal) > 0.0 && is_open(**sun))
                    .count(),
            )
            + count(sky_rays.filter(|&direction| is_open(direction)).count())
    }
}

/// Points that are spread over all that emits, with normals and whether both sides do.
fn emitter_points(scene: &Scene, faces: &[WorldFace]) -> Vec<(Vec3, Vec3, bool)> {
    let emits = |face: &&WorldFace| scene.materials[face.material as usize].emits();
    let emitting: Vec<&WorldFace> = faces.iter().filter(emits).collect();
    let total: f64 = emitting.iter().map(|face| area(face)).sum();
    let step = total / f64::from(EMITTER_POINTS);
    let (mut before, mut next, mut points) = (0.0, 0.5 * step, Vec::new());
    for face in emitting {
        before += area(face);
        while next < before {
            let point = point_in_polygon(face.polygon(), crate::index32(points.len()), 1);
            let both = scene.materials[face.material as usize].lit_sides() == 2;
            points.push((point, face.normal, both));
            next += step;
        }
    }
    points
}

fn area(face: &WorldFace) -> f64 {
    0.5 * f64::from(super::newell_normal(face.polygon()).length())
}
