//! Light at vertices: linear light stays linear, and nothing bleeds.

use hemicube::radiosity::patch::{PatchMesh, PatchOptions};
use hemicube::radiosity::stop::NEVER;
use hemicube::radiosity::{DrawnMesh, Grouping, Solution};
use hemicube::raster::Rgb;
use hemicube::scene::Scene;
use hemicube_tests::solutions::built_in;
use std::sync::Arc;

/// A mesh whose elements receive what a function says of them.
fn lit(mesh: PatchMesh, light: impl Fn(&PatchMesh, usize) -> f32) -> Solution {
    let elements = mesh.elements().len();
    let dark = vec![Rgb::BLACK; elements];
    let mut solution = Solution::new(Arc::new(mesh), &dark, Grouping::Together);
    let values: Vec<f32> = (0..elements).map(|e| light(solution.mesh(), e)).collect();
    let unshot = vec![0.0; 3 * elements];
    solution.replace_light(&values.repeat(3), &unshot, &[0.0; 3], &[0.0; 3]);
    solution
}

/// What each element's corners show: element, vertex of the drawn mesh, light.
fn shown(solution: &Solution) -> (DrawnMesh, Vec<(usize, usize)>) {
    let drawn = DrawnMesh::new(solution, Rgb::BLACK);
    let mut corners = Vec::new();
    for part in &drawn.parts {
        for (triangle, &e) in part.triangles.iter().zip(&part.elements) {
            corners.extend(triangle.map(|v| (e as usize, v as usize)));
        }
    }
    (drawn, corners)
}

fn mesh_of(scene: Arc<Scene>, elements: usize) -> PatchMesh {
    let options = PatchOptions::default().with_elements(elements);
    PatchMesh::build(scene, options).expect("a mesh")
}

/// The same with some of its elements cut, twice.
fn refined(mesh: PatchMesh) -> PatchMesh {
    (0..2).fold(mesh, |mesh, _| {
        let marks: Vec<bool> = (0..mesh.elements().len()).map(|e| e % 7 == 3).collect();
        let plan = mesh.plan_refinement(&marks, 0.0).expect("some are cut");
        mesh.with_refinement(&plan.refinement, NEVER)
            .expect("it fits")
    })
}

#[test]
fn linear_light_is_exact() {
    for mesh in [
        mesh_of(built_in("parallel-plates"), 200),
        refined(mesh_of(built_in("parallel-plates"), 200)),
    ] {
        let linear = |p: glam::Vec3| 5.0 + p.dot(glam::Vec3::new(1.0, 2.0, -3.0));
        let solution = lit(mesh, |mesh, e| {
            linear(mesh.node(mesh.elements()[e]).centroid)
        });
        let (drawn, corners) = shown(&solution);
        assert!(corners.len() > 600, "{} corners", corners.len());
        for (e, v) in corners {
            // Amid elements and on borders.
            let (at, light) = (drawn.positions[v], drawn.irradiance[v].g);
            assert!(
                (light - linear(at)).abs() < 1e-4,
                "element {e} at {at}: {light}, not {}",
                linear(at)
            );
        }
    }
}

#[test]
fn a_single_element_shows_its_own_light() {
    let whole = PatchMesh::build(built_in("parallel-plates"), PatchOptions::whole_faces());
    let solution = lit(whole.expect("a mesh"), |_, e| 1.0 + e as f32);
    let (drawn, corners) = shown(&solution);
    for (e, v) in corners {
        let off = drawn.irradiance[v] - solution.element_irradiance(e);
        assert!(off.max_band().abs() < 1e-6, "element {e}: {off:?}");
    }
}

#[test]
fn light_is_linear_along_a_strip() {
    // A board of twelve elements, one beside the other: nothing is known across.
    let strip = hemicube::scene::Mesh {
        positions: [[0.0, 0.0], [12.0, 0.0], [12.0, 1.0], [0.0, 1.0]]
            .map(|[x, y]| glam::Vec3::new(x, y, 0.0))
            .to_vec(),
        faces: vec![hemicube::scene::Face::Quad([0, 1, 2, 3])],
        ..hemicube::scene::Mesh::default()
    };
    let scene = Scene {
        meshes: vec![strip],
        instances: vec![hemicube::scene::Instance {
            mesh: 0,
            node: String::from("strip"),
            world_from_mesh: glam::Affine3A::IDENTITY,
            flipped: false,
        }],
        materials: vec![hemicube::scene::Material::default()],
        ..Scene::default()
    };
    let options = PatchOptions::default().with_element_size(1.0);
    let mesh = PatchMesh::build(Arc::new(scene), options).expect("a mesh");
    let linear = |p: glam::Vec3| 1.0 + 0.25 * p.x;
    let solution = lit(mesh, |mesh, e| {
        linear(mesh.node(mesh.elements()[e]).centroid)
    });
    let drawn = shown(&solution).0;
    assert!(drawn.positions.len() >= 26, "a strip");
    for (&at, light) in drawn.positions.iter().zip(&drawn.irradiance) {
        assert!((light.g - linear(at)).abs() < 1e-4, "at {at}: {light:?}");
    }
}

#[test]
fn light_stays_near_that_of_the_elements_around() {
    let mesh = refined(mesh_of(built_in("cornell"), 600));
    let noise = |e: usize| ((e * 7919) % 1009) as f32;
    let solution = lit(mesh, |_, e| noise(e));
    let drawn = DrawnMesh::new(&solution, Rgb::BLACK);
    let sources = drawn.light_sources(solution.mesh());
    let mut beyond = 0;
    for (v, range) in sources.starts().windows(2).enumerate() {
        let range = range[0] as usize..range[1] as usize;
        let (around, weights) = (
            &sources.elements()[range.clone()],
            &sources.weights()[range],
        );
        let weighed = around.iter().zip(weights).filter(|(_, w)| **w != 0.0);
        let values: Vec<f32> = weighed.map(|(&e, _)| noise(e as usize)).collect();
        let (low, high) = values.iter().fold((f32::INFINITY, 0.0), |(low, high), &x| {
            (f32::min(low, x), f32::max(high, x))
        });
        // Amid the elements between them, on borders as far beyond as they differ.
        let is_border = weights.iter().any(|&w| w < 0.0);
        let reach = if is_border { high - low } else { 0.0 } + 0.01;
        let light = drawn.irradiance[v].g;
        beyond += usize::from(!values.is_empty() && !(low..=high).contains(&light));
        assert!(
            values.is_empty() || ((low - reach).max(0.0)..=high + reach).contains(&light),
            "vertex {v}: {light} of {values:?}"
        );
    }
    assert!(beyond > 10, "borders are extrapolated: {beyond} vertices");
}

/// Every corner shows the light of its element, and nothing of another's.
fn assert_nothing_bleeds(solution: &Solution) {
    let (drawn, corners) = shown(solution);
    for (e, v) in corners {
        let own = solution.element_irradiance(e);
        assert!(
            (drawn.irradiance[v] - own).max_band().abs() < 1e-6,
            "element {e}: {:?}",
            drawn.irradiance[v]
        );
    }
}

#[test]
fn nothing_bleeds_over_a_crease() {
    let mesh = mesh_of(built_in("perpendicular-plates"), 100);
    let first = mesh.node(mesh.elements()[0]).normal;
    let solution = lit(mesh, |mesh, e| {
        f32::from(u8::from(mesh.node(mesh.elements()[e]).normal == first))
    });
    assert_nothing_bleeds(&solution);
}

#[test]
fn nothing_bleeds_over_a_hard_edge() {
    let mesh = mesh_of(built_in("parallel-plates"), 200);
    // Edges between the elements to the left and to the right of the middle.
    let polygon = mesh.polygon(mesh.elements()[0]);
    let along = (polygon[1] - polygon[0]).normalize();
    let middle = along.dot(mesh.vertices()[..4].iter().sum::<glam::Vec3>() / 4.0);
    let is_left =
        |mesh: &PatchMesh, e: usize| along.dot(mesh.node(mesh.elements()[e]).centroid) < middle;
    let edges: Vec<(u32, u32)> = mesh
        .elements()
        .iter()
        .flat_map(|&id| {
            let corners = mesh.corners(id);
            let n = corners.len();
            let on_line = |v: u32| (along.dot(mesh.vertices()[v as usize]) - middle).abs() < 1e-5;
            let edges = (0..n).map(|i| (corners[i], corners[(i + 1) % n]));
            edges
                .filter(|&(a, b)| on_line(a) && on_line(b))
                .collect::<Vec<_>>()
        })
        .collect();
    assert!(edges.len() >= 8, "the line is one of the mesh");
    let soft = lit(mesh.clone(), |mesh, e| {
        f32::from(u8::from(is_left(mesh, e)))
    });
    let blended = DrawnMesh::new(&soft, Rgb::BLACK)
        .irradiance
        .iter()
        .filter(|c| c.g > 0.1 && c.g < 0.9)
        .count();
    assert!(
        blended >= 8,
        "without hard edges {blended} vertices are between"
    );
    for mesh in [
        mesh.clone().with_hard_edges(edges.clone()),
        refined(mesh.with_hard_edges(edges)),
    ] {
        let hard = lit(mesh, |mesh, e| f32::from(u8::from(is_left(mesh, e))));
        assert_nothing_bleeds(&hard);
    }
}

#[test]
fn buried_elements_have_no_weight() {
    for scene in ["cornell", "office"] {
        let mesh = mesh_of(built_in(scene), 2000);
        let solution = lit(
            mesh,
            |mesh, e| if mesh.exposed_area(e) > 0.0 { 1.0 } else { 1e6 },
        );
        let (drawn, corners) = shown(&solution);
        let mut buried = 0;
        for (e, v) in corners {
            if solution.mesh().exposed_area(e) <= 0.0 {
                buried += 1;
                continue;
            }
            let light = drawn.irradiance[v].g;
            assert!((light - 1.0).abs() < 1e-5, "{scene}, element {e}: {light}");
        }
        assert!(buried > 0, "{scene}: something stands on something");
    }
}

#[test]
fn light_does_not_pass_below_a_wall() {
    // A wall that stands on an edge of the floor's mesh, as thin as can be.
    use hemicube::scene::{Face, Instance, Material, Mesh};
    let quad = |corners: [[f32; 3]; 4]| Mesh {
        positions: corners.map(glam::Vec3::from_array).to_vec(),
        faces: vec![Face::Quad([0, 1, 2, 3])],
        ..Mesh::default()
    };
    let left = quad([
        [0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 0.0, 0.0],
    ]);
    let right = quad([
        [1.0, 0.0, 0.0],
        [1.0, 0.0, 1.0],
        [2.0, 0.0, 1.0],
        [2.0, 0.0, 0.0],
    ]);
    let wall = quad([
        [1.0, 0.0, 0.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [1.0, 1.0, 0.0],
    ]);
    let meshes = vec![left, right, wall];
    let instances = (0..3)
        .map(|mesh| Instance {
            mesh,
            node: String::from("node"),
            world_from_mesh: glam::Affine3A::IDENTITY,
            flipped: false,
        })
        .collect();
    let scene = Scene {
        meshes,
        instances,
        materials: vec![Material {
            double_sided: true,
            ..Material::default()
        }],
        ..Scene::default()
    };
    let mesh = mesh_of(Arc::new(scene), 60);
    let is_left = |mesh: &PatchMesh, e: usize| mesh.node(mesh.elements()[e]).centroid.x < 1.0;
    let solution = lit(mesh, |mesh, e| f32::from(u8::from(is_left(mesh, e))));
    let (drawn, corners) = shown(&solution);
    for (e, v) in corners {
        let own = solution.element_irradiance(e);
        assert!(
            (drawn.irradiance[v] - own).max_band().abs() < 1e-6,
            "element {e}: {:?}",
            drawn.irradiance[v]
        );
    }
}
