//! Elements that are cut where faces meet: nothing is lost, nothing cracks, every line is kept.

use glam::Vec3;
use hemicube::radiosity::{PatchMesh, PatchOptions, SolveOptions, solve};
use hemicube::scene::builtin::{SceneBuilder, Sides};
use hemicube::scene::{Scene, Units, builtin, open_path};
use hemicube_tests::meshes::Flaws;
use hemicube_tests::testdata;
use std::sync::Arc;

fn mesh_of(scene: Scene, options: PatchOptions) -> PatchMesh {
    PatchMesh::build(Arc::new(scene), options).expect("the scene can be cut")
}

/// Lengths below this are touches; the mesh's own tolerance is at least ten times as large.
fn tolerance(mesh: &PatchMesh) -> f64 {
    1e-7 * f64::from(mesh.visibility().diameter())
}

fn assert_sound(name: &str, mesh: &PatchMesh) {
    let flaws = Flaws::of(mesh, tolerance(mesh));
    assert_eq!(
        (flaws.cracks, flaws.hanging),
        (0, 0),
        "{name}: {flaws:?}, {:?}",
        mesh.cuts()
    );
    assert!(flaws.area < 2e-4, "{name}: {flaws:?}");
    let sum = |ids: &[_]| {
        ids.iter()
            .map(|&id| f64::from(mesh.node(id).area))
            .sum::<f64>()
    };
    let (elements, patches) = (sum(mesh.elements()), sum(mesh.patches()));
    assert!(
        (elements / patches - 1.0).abs() < 1e-6,
        "{name}: {elements} of {patches}"
    );
}

#[test]
fn built_in_scenes_have_no_cracks() {
    for name in ["cornell", "two-rooms", "office", "conference-room"] {
        let counts = if name == "cornell" {
            &[300, 4000][..]
        } else {
            &[300]
        };
        for &elements in counts {
            let options = PatchOptions::default().with_elements(elements);
            let mesh = mesh_of(builtin::scene(name).expect("it is built in"), options);
            assert!(mesh.cuts().elements > 0, "{name}: something is cut");
            assert_sound(name, &mesh);
        }
    }
}

#[test]
fn real_models_have_no_cracks() {
    let Some(folder) = testdata() else { return };
    for file in [
        "scenes/cornell_gltf_kajiya/scene.gltf",
        "scenes/godot_room/room.glb",
        "scenes/playcanvas/glass-table.glb",
        "scenes/playcanvas/house.glb",
        "scenes/common3d/suzanne.obj",
    ] {
        let scene = open_path(&folder.join(file)).expect("it can be read");
        let mesh = mesh_of(scene, PatchOptions::default().with_elements(2000));
        assert_sound(file, &mesh);
    }
}

#[test]
fn too_many_lines_in_a_cell_are_told() {
    let shelves = |count: u32| {
        on_a_floor(|b, grey| {
            for i in 1..=count {
                let x = 2.0 * i as f32 / (count + 1) as f32;
                let low = Vec3::new(x - 0.005, 0.0, 0.2);
                let high = Vec3::new(x + 0.005, 1.0, 1.8);
                b.cuboid(grey, low, high, Sides::without(&[Sides::BOTTOM]));
            }
        })
    };
    for (count, is_told) in [(4, false), (60, true)] {
        let options = PatchOptions::default().with_element_size(2.5);
        let mesh = mesh_of(shelves(count), options);
        let warnings = &mesh.report().warnings;
        let told = warnings.iter().filter(|w| w.place == "cuts").count();
        assert_eq!(told, usize::from(is_told), "{count}: {warnings:?}");
        assert_eq!(mesh.cuts().crowded > 0, is_told, "{count} shelves");
        assert_sound("shelves", &mesh);
    }
}

/// A floor of two by two metres from two faces, with something on it.
fn on_a_floor(build: impl FnOnce(&mut SceneBuilder, usize)) -> Scene {
    let mut builder = SceneBuilder::new("floor", Units::Photometric);
    let grey = builder.diffuse("grey", 0.5, 0.5, 0.5);
    builder.node("floor");
    let at = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    builder.quad(
        grey,
        [at(0.0, 0.0), at(0.0, 2.0), at(1.2, 2.0), at(1.2, 0.0)],
    );
    builder.quad(
        grey,
        [at(1.2, 0.0), at(1.2, 2.0), at(2.0, 2.0), at(2.0, 0.0)],
    );
    builder.node("thing");
    build(&mut builder, grey);
    builder.finish()
}

/// Corners of a block's footprint, turned by some angle, counter-clockwise seen from above.
fn footprint(centre: Vec3, half: f32, angle: f32) -> [Vec3; 4] {
    [0, 1, 2, 3].map(|i| {
        let turn = angle + i as f32 * core::f32::consts::FRAC_PI_2;
        centre + Vec3::new(turn.cos(), 0.0, -turn.sin()) * half
    })
}

/// A block without a bottom that stands on (or, sunk, in) the floor.
fn stand(builder: &mut SceneBuilder, material: usize, foot: [Vec3; 4], sunk: f32) {
    builder.quad(material, foot.map(|p| p + Vec3::Y * (0.8 - sunk)));
    for i in 0..4 {
        let (a, b) = (foot[i] - Vec3::Y * sunk, foot[(i + 1) % 4] - Vec3::Y * sunk);
        builder.quad(material, [a, b, b + Vec3::Y * 0.8, a + Vec3::Y * 0.8]);
    }
}

/// Elements of the floor.
fn floor_elements(mesh: &PatchMesh) -> Vec<usize> {
    let is_floor = |&e: &usize| {
        let node = mesh.node(mesh.elements()[e]);
        node.normal.y > 0.99 && node.centroid.y.abs() < 1e-4
    };
    (0..mesh.elements().len()).filter(is_floor).collect()
}

/// Largest distance of points along a segment from the nearest edge of the floor's elements.
fn farthest_from_edges(mesh: &PatchMesh, a: Vec3, b: Vec3) -> f32 {
    let edges: Vec<(Vec3, Vec3)> = floor_elements(mesh)
        .into_iter()
        .flat_map(|e| {
            let polygon = mesh.polygon(mesh.elements()[e]);
            let n = polygon.len();
            (0..n)
                .map(|i| (polygon[i], polygon[(i + 1) % n]))
                .collect::<Vec<_>>()
        })
        .collect();
    let distance = |p: Vec3| {
        let to = |&(a, b): &(Vec3, Vec3)| {
            let t = ((p - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
            p.distance(a.lerp(b, t))
        };
        edges.iter().map(to).fold(f32::INFINITY, f32::min)
    };
    (1..100)
        .map(|i| distance(a.lerp(b, i as f32 / 100.0)))
        .fold(0.0, f32::max)
}

#[test]
fn footprints_are_edges_and_elements_wholly_covered_or_wholly_free() {
    let foot = footprint(Vec3::new(1.1, 0.0, 0.9), 0.5, 0.3);
    for sunk in [0.0, 0.1] {
        let scene = on_a_floor(|builder, grey| stand(builder, grey, foot, sunk));
        for size in [0.4, 0.15] {
            let options = PatchOptions::default().with_element_size(size);
            let mesh = mesh_of(scene.clone(), options);
            assert_sound("a block on the floor", &mesh);
            for i in 0..4 {
                let off = farthest_from_edges(&mesh, foot[i], foot[(i + 1) % 4]);
                // A line moves by a hundredth of the cell that it crosses at most.
                assert!(
                    off < 0.012 * size,
                    "sunk {sunk}, elements of {size}: {off} off"
                );
            }
            for e in floor_elements(&mesh) {
                let node = mesh.node(mesh.elements()[e]);
                let share = mesh.exposed_area(e) / node.area;
                // What the lines have moved by.
                let thin = 0.02 * size * size / node.area;
                assert!(
                    share < 0.03 + thin || share > 0.97 - thin,
                    "sunk {sunk}, elements of {size}: {share} of the one at {} is free",
                    node.centroid
                );
            }
        }
    }
}

#[test]
fn small_feet_and_small_faces_do_not_cut() {
    let foot = footprint(Vec3::new(0.61, 0.0, 0.72), 0.02, 0.3);
    let scene = on_a_floor(|builder, grey| stand(builder, grey, foot, 0.0));
    let mesh = mesh_of(scene, PatchOptions::default().with_element_size(0.4));
    assert_eq!(mesh.cuts().joints, 0, "a foot of 4 cm, elements of 40 cm");
}

#[test]
fn a_vertex_in_an_edge_becomes_a_corner_on_both_sides() {
    let scene = on_a_floor(|builder, grey| {
        // A wall behind the floor, over both of its faces.
        let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        builder.quad(
            grey,
            [at(0.0, 0.0), at(2.0, 0.0), at(2.0, 1.0), at(0.0, 1.0)],
        );
    });
    for size in [5.0, 0.7, 0.13] {
        let mesh = mesh_of(
            scene.clone(),
            PatchOptions::default().with_element_size(size),
        );
        assert_sound("floor and wall", &mesh);
        let whole = PatchOptions::default()
            .with_element_size(size)
            .with_joints(false);
        let cracked = Flaws::of(&mesh_of(scene.clone(), whole), 1e-6);
        assert!(
            cracked.hanging > 0,
            "elements of {size}: without joints the vertex hangs"
        );
    }
}

#[test]
fn patches_stay_as_they_are() {
    // A number of elements counts what joints add, and would choose other sizes.
    for (name, size) in [("cornell", 60.0), ("two-rooms", 0.3)] {
        let of = |joints: bool| {
            let options = PatchOptions::default()
                .with_element_size(size)
                .with_patch_size(2.0 * size);
            mesh_of(
                builtin::scene(name).expect("it is built in"),
                options.with_joints(joints),
            )
        };
        let (cut, whole) = (of(true), of(false));
        let areas = |mesh: &PatchMesh| -> Vec<f32> {
            mesh.patches()
                .iter()
                .map(|&id| mesh.node(id).area)
                .collect()
        };
        assert_eq!(areas(&cut), areas(&whole), "{name}");
    }
}

#[test]
fn one_and_two_threads_cut_alike() {
    let build = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let scene = builtin::scene("office").expect("it is built in");
            let mesh = mesh_of(scene, PatchOptions::default().with_elements(500));
            let corners: Vec<Vec<u32>> = mesh
                .elements()
                .iter()
                .map(|&id| mesh.corners(id).to_vec())
                .collect();
            (mesh.vertices().to_vec(), corners)
        })
    };
    assert!(build(1) == build(2), "vertices and corners");
}

/// Triangles anywhere in a cube, from a linear congruence.
fn soup(count: usize, size: f32, seed: u64) -> Scene {
    let mut state = seed;
    let mut random = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 40) as f32 / (1_u64 << 24) as f32
    };
    let mut builder = SceneBuilder::new("soup", Units::Photometric);
    let grey = builder.diffuse("grey", 0.5, 0.5, 0.5);
    builder.node("soup");
    for _ in 0..count {
        let mut point = |scale: f32| Vec3::new(random(), random(), random()) * scale;
        let at = point(1.0);
        let (a, b) = (at + point(size), at + point(size));
        builder.quad(grey, [at, a, at + (b - at) * 0.5 + (a - at) * 0.5, b]);
    }
    builder.finish()
}

#[test]
fn random_faces_through_each_other_have_no_cracks() {
    for seed in 1..=2 {
        let options = PatchOptions::default().with_element_size(0.2);
        let mesh = mesh_of(soup(40, 1.0, seed), options);
        assert!(mesh.cuts().joints > 30, "seed {seed}: {:?}", mesh.cuts());
        assert_sound(&format!("seed {seed}"), &mesh);
    }
}

#[test]
fn a_hundred_faces_through_one_place_keep_a_part_of_their_lines() {
    // All pairs cross.
    let mesh = mesh_of(
        soup(60, 8.0, 5),
        PatchOptions::default().with_element_size(8.0),
    );
    assert!(mesh.cuts().joints > 500, "{:?}", mesh.cuts());
    assert_sound("a knot", &mesh);
}

#[test]
fn faces_in_one_place_and_slivers_are_cut_without_harm() {
    let scene = on_a_floor(|builder, grey| {
        let at = |x: f32, z: f32| Vec3::new(x, 0.0, z);
        let rug = [at(0.3, 0.3), at(0.3, 1.1), at(1.7, 1.1), at(1.7, 0.3)];
        let turned = [rug[1], rug[2], rug[3], rug[0]];
        builder.quad(grey, rug);
        builder.quad(grey, turned);
        builder.quad(grey, rug.map(|p| p + Vec3::new(0.0, 1e-7, 1e-7)));
        // As thin as rounding, and crossing everything.
        let (a, b) = (Vec3::new(0.2, -0.5, 0.7), Vec3::new(1.9, 0.5, 0.7));
        builder.quad(grey, [a, b, b + Vec3::Z * 1e-6, a + Vec3::Z * 1e-6]);
        builder.quad(grey, [a, a, a, a]);
    });
    let mesh = mesh_of(scene, PatchOptions::default().with_element_size(0.3));
    let flaws = Flaws::of(&mesh, tolerance(&mesh));
    assert_eq!(flaws.cracks, 0, "{flaws:?}");
    for (edge, to) in [((0.3, 0.3), (1.7, 0.3)), ((0.3, 1.1), (0.3, 0.3))] {
        let at = |(x, z): (f32, f32)| Vec3::new(x, 0.0, z);
        let off = farthest_from_edges(&mesh, at(edge), at(to));
        assert!(off < 0.0036, "the rug's outline is {off} off");
    }
}

#[test]
fn a_closed_room_stays_exact_with_a_block_in_it() {
    let mut builder = SceneBuilder::new("furnace", Units::Radiometric);
    let grey = builder.material(hemicube::scene::Material {
        emission: hemicube::raster::Rgb::splat(1.0 / core::f32::consts::PI),
        ..hemicube::scene::Material::diffuse("grey", hemicube::raster::Rgb::splat(0.5))
    });
    builder.node("room");
    let (low, high) = (Vec3::ZERO, Vec3::new(2.0, 1.5, 2.0));
    builder.room(grey, low, high, Sides::ALL);
    stand(
        &mut builder,
        grey,
        footprint(Vec3::new(1.1, 0.0, 0.9), 0.5, 0.3),
        0.05,
    );
    let scene = Arc::new(builder.finish());
    let [cut, whole] = [true, false].map(|joints| {
        let options = SolveOptions {
            mesh: PatchOptions::default()
                .with_element_size(0.25)
                .with_joints(joints),
            tolerance: 1e-4,
            ..SolveOptions::default()
        };
        let solution = solve(scene.clone(), &options, |_, _| true).expect("it can be solved");
        let mesh = solution.mesh();
        assert_eq!(mesh.cuts().cells > 20, joints, "{:?}", mesh.cuts());
        let (mut sum, mut squares, mut area) = (0.0, 0.0, 0.0);
        for e in 0..mesh.elements().len() {
            let (radiosity, share) = (solution.element_radiosity(e).g, mesh.exposed_area(e));
            let error = radiosity / 2.0 - 1.0;
            sum += share * error;
            squares += share * error * error;
            area += share;
        }
        (sum / area, (squares / area).sqrt())
    });
    // What the cuts take away is what leaked below the block; the noise is that of rays, of which small elements get few.
    assert!(
        cut.0.abs() < 0.01 && cut.0.abs() < whole.0.abs(),
        "mean: {cut:?}, whole {whole:?}"
    );
    assert!(cut.1 < 0.06, "noise: {cut:?}, whole {whole:?}");
}
