//! A posteriori refinement of a mesh: balance, no cracks, patches as they were.

use hemicube::radiosity::patch::{NodeKind, PatchMesh, PatchOptions, Refinement};
use hemicube::radiosity::stop::NEVER;
use hemicube_tests::solutions::built_in;
use hemicube_tests::watertight::{area_error, hanging_vertices};
use std::collections::HashMap;
use std::sync::LazyLock;

/// Scenes with quads, triangles and fans, two-sided surfaces, small and large faces.
const SCENES: [&str; 4] = ["cornell", "two-rooms", "office", "conference-room"];

fn mesh_of(scene: &str) -> PatchMesh {
    let options = PatchOptions::default().with_elements(800).with_patches(100);
    PatchMesh::build(built_in(scene), options).expect("the scene can be cut")
}

/// Marks some elements, by a hash of their number and the round, and always the first.
fn some(mesh: &PatchMesh, round: usize, one_of: usize) -> Vec<bool> {
    let is_marked =
        |e: usize| e == 0 || ((e * 7919 + round * 104_729) % 1009).is_multiple_of(one_of);
    (0..mesh.elements().len()).map(is_marked).collect()
}

fn refined(mesh: &PatchMesh, marks: &[bool]) -> PatchMesh {
    let plan = mesh
        .plan_refinement(marks, 0.0)
        .expect("something is marked");
    let refined = mesh
        .with_refinement(&plan.refinement, NEVER)
        .expect("it fits");
    assert_eq!(refined.elements().len(), plan.elements, "as planned");
    refined
}

/// A scene's mesh, and what rounds of marks make of it that go deep in a few places.
struct Pair {
    scene: &'static str,
    mesh: PatchMesh,
    fine: PatchMesh,
}

static PAIRS: LazyLock<Vec<Pair>> = LazyLock::new(|| {
    let pair = |scene| {
        let mesh = mesh_of(scene);
        let thrice = |mesh: PatchMesh, round| refined(&mesh, &some(&mesh, round, 40));
        let fine = (0..3).fold(mesh.clone(), thrice);
        Pair { scene, mesh, fine }
    };
    SCENES.map(pair).into()
});

#[test]
fn no_vertex_hangs_on_an_edge() {
    for Pair { scene, mesh, fine } in PAIRS.iter() {
        let before = hanging_vertices(mesh, 1e-3).len();
        let after = hanging_vertices(fine, 1e-3);
        // The scene's own faces may meet so.
        assert!(
            after.len() <= before * 8 && (before > 0 || after.is_empty()),
            "{scene}: {before} before, then {} as {:?}",
            after.len(),
            after.first()
        );
    }
}

#[test]
fn neighbours_differ_by_one_level_at_most() {
    for Pair {
        scene, fine: mesh, ..
    } in PAIRS.iter()
    {
        let levels = mesh.levels();
        assert!(
            levels.iter().any(|&level| level >= 3),
            "{scene}: it goes deep"
        );
        let mut of_edge: HashMap<(u32, u32), Vec<u8>> = HashMap::new();
        for (&id, &level) in mesh.elements().iter().zip(&levels) {
            let corners = mesh.corners(id);
            for (i, &a) in corners.iter().enumerate() {
                let b = corners[(i + 1) % corners.len()];
                of_edge.entry((a.min(b), a.max(b))).or_default().push(level);
            }
        }
        for (edge, levels) in of_edge {
            let (least, most) = (levels.iter().min(), levels.iter().max());
            let differ = most.zip(least).map_or(0, |(most, least)| most - least);
            assert!(differ <= 1, "{scene}: {levels:?} at {edge:?}");
        }
    }
}

#[test]
fn patches_stay_and_elements_fill_them() {
    for Pair { scene, mesh, fine } in PAIRS.iter() {
        assert_eq!(mesh.patches(), fine.patches(), "{scene}: the same patches");
        for &patch in mesh.patches() {
            assert_eq!(
                mesh.polygon(patch)[..],
                fine.polygon(patch)[..],
                "{scene}: of the same shape"
            );
        }
        // Slivers have areas made of rounded coordinates.
        let error = area_error(fine);
        assert!(error < 1e-3, "{scene}: areas differ by {error:.1e}");
        let cuts = fine.elements().iter().enumerate();
        for (e, &id) in cuts {
            let mut above = Some(id);
            let patch = fine.patches()[fine.patch_of_element(e)];
            while let Some(node) = above.filter(|&node| node != patch) {
                above = fine.node(node).parent;
            }
            assert_eq!(
                above,
                Some(patch),
                "{scene}: element {e} lies below its patch"
            );
        }
    }
}

#[test]
fn points_find_their_element() {
    for Pair {
        scene, fine: mesh, ..
    } in PAIRS.iter()
    {
        for (e, &id) in mesh.elements().iter().enumerate() {
            let NodeKind::Surface { face, side } = mesh.node(id).kind else {
                panic!("elements are surfaces")
            };
            for &corner in mesh.polygon(id).iter() {
                // Near the corners, where lines cross.
                let point = corner.lerp(mesh.node(id).centroid, 0.1);
                let found = mesh.element_at(face as usize, side, point);
                assert_eq!(found, Some(e), "{scene}: element {e}");
                let patch = mesh.patch_at(face as usize, side, point);
                assert_eq!(patch, Some(mesh.patch_of_element(e)), "{scene}: its patch");
            }
        }
    }
}

#[test]
fn angles_do_not_decay() {
    let mesh = mesh_of("cornell");
    let least = |mesh: &PatchMesh| -> f32 {
        let of_element = |&id: &_| {
            let polygon = mesh.polygon(id);
            let n = polygon.len();
            let angle = |i: usize| {
                let (to, from) = (
                    polygon[(i + 1) % n] - polygon[i],
                    polygon[(i + n - 1) % n] - polygon[i],
                );
                to.angle_between(from)
            };
            (0..n).map(angle).fold(f32::INFINITY, f32::min)
        };
        mesh.elements()
            .iter()
            .map(of_element)
            .fold(f32::INFINITY, f32::min)
    };
    let marks = |mesh: &PatchMesh| -> Vec<bool> {
        // Always around the same corner.
        let corner = mesh.vertices()[mesh.corners(mesh.elements()[0])[0] as usize];
        let near = |&id: &_| mesh.polygon(id).contains(&corner);
        mesh.elements().iter().map(near).collect()
    };
    let once = refined(&mesh, &marks(&mesh));
    let often = (0..5).fold(once.clone(), |mesh, _| refined(&mesh, &marks(&mesh)));
    let (first, last) = (least(&once), least(&often));
    assert!(
        last > 0.9 * first,
        "{last} radians after six rounds, {first} after one"
    );
}

#[test]
fn a_record_makes_the_same_mesh() {
    let Pair { mesh, fine, .. } = &PAIRS[2];
    let again = mesh_of("office")
        .with_refinement(fine.refinement(), NEVER)
        .expect("it fits");
    assert_eq!(fine.elements(), again.elements(), "the same nodes");
    assert_eq!(fine.vertices(), again.vertices(), "the same vertices");
    let bits = |mesh: &PatchMesh| -> Vec<u32> {
        let areas = 0..mesh.elements().len();
        areas.map(|e| mesh.exposed_area(e).to_bits()).collect()
    };
    assert_eq!(bits(fine), bits(&again), "the same exposed areas");
    let plain = fine
        .with_refinement(&Refinement::default(), NEVER)
        .expect("it fits");
    assert_eq!(mesh.elements(), plain.elements(), "and back again");
    assert_eq!(bits(mesh), bits(&plain), "as it was");
}

#[test]
fn records_of_other_meshes_are_refused() {
    let other = PAIRS[2]
        .mesh
        .with_refinement(PAIRS[0].fine.refinement(), NEVER);
    let error = other.expect_err("it does not fit").to_string();
    assert!(error.contains("does not fit"), "{error}");
}

#[test]
fn small_elements_are_left() {
    let mesh = mesh_of("cornell");
    let all = vec![true; mesh.elements().len()];
    assert!(
        mesh.plan_refinement(&all, 1e9).is_none(),
        "none has an edge so long"
    );
    let plan = mesh.plan_refinement(&all, 0.0).expect("all are cut");
    assert_eq!(
        plan.elements,
        4 * all.len(),
        "each into four, without transitions"
    );
}
