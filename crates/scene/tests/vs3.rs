//! `.vs3` files: surfaces come where and as View3D has them, and what is wrong is named by its line.

use glam::Vec3;
use hemicube_scene::options::SceneOptions;
use hemicube_scene::{Face, Mask, Scene, Units, open_bytes};
use std::time::Instant;

fn scene(text: &str) -> Scene {
    let scene = open_bytes(text.as_bytes(), "folder/room.vs3", None)
        .unwrap_or_else(|e| panic!("the file is good: {e}"));
    scene.check().expect("what opens is consistent");
    scene
}

fn refused(text: &str) -> String {
    let message = open_bytes(text.as_bytes(), "room.vs3", None)
        .expect_err("it is refused")
        .to_string();
    assert!(
        message.starts_with("room.vs3: "),
        "it names the file: {message}"
    );
    assert_eq!(message.lines().count(), 1, "one line: {message}");
    message
}

#[track_caller]
fn assert_refused(text: &str, parts: &[&str]) {
    let message = refused(text);
    for part in parts {
        assert!(message.contains(part), "'{part}' is not in: {message}");
    }
}

fn assert_warned(scene: &Scene, part: &str) {
    let warnings = &scene.report.warnings;
    let lines: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert!(
        lines.iter().any(|w| w.contains(part)),
        "no warning says '{part}': {lines:?}"
    );
}

fn nodes(scene: &Scene) -> Vec<&str> {
    scene.instances.iter().map(|i| i.node.as_str()).collect()
}

/// Half the vector area of an instance's faces, pointing to the front.
fn vector_area(scene: &Scene, instance: usize) -> Vec3 {
    let mesh = &scene.meshes[scene.instances[instance].mesh];
    let at = |v: u32| mesh.positions[v as usize];
    let area = |face: &Face| -> Vec3 {
        let c = face.corners();
        (1..c.len() - 1)
            .map(|i| 0.5 * (at(c[i]) - at(c[0])).cross(at(c[i + 1]) - at(c[0])))
            .sum()
    };
    mesh.faces.iter().map(area).sum()
}

/// The square of side 4 at z = 0 that faces up, and a smaller one upon it.
const VERTICES: &str = "\
V 1 0 0 0
V 2 4 0 0
V 3 4 4 0
V 4 0 4 0
V 5 1 1 0
V 6 2 1 0
V 7 2 3 0
V 8 1 3 0
";

fn on_square(surfaces: &str) -> String {
    format!("F 3\n{VERTICES}{surfaces}")
}

#[test]
fn the_parts_of_a_file() {
    let text = "\
! a comment
T A room, with! marks
/ another comment
C encl=1, EPS = 1e-5 epsu=? list=2 emit=1 row=2 maxU=8
F 3
V 1 0 0 0   ! a vertex
V,2,1,0,0
v 3 1 1 0\r
V 4\t0 1 0
s 1   1 2 3 4   0 0  0.25  floor extra words
S 2   1 3 2 0   0 0  1.5
End of data
V this is not read
";
    let scene = scene(text);
    assert_eq!(scene.name, "A room, with! marks", "the title");
    assert_eq!(scene.units, Units::Radiometric, "heat, not light");
    let asked = scene
        .view_factors
        .as_ref()
        .expect("it is made for view factors");
    assert!(asked.enclosure, "encl=1");
    assert_eq!(asked.error, Some(1e-5), "eps");
    assert_eq!(nodes(&scene), ["floor", "surface 2"], "names, or numbers");
    assert_eq!(scene.meshes[0].faces, [Face::Quad([0, 1, 2, 3])], "a quad");
    assert_eq!(
        scene.meshes[1].faces,
        [Face::Triangle([0, 1, 2])],
        "a triangle"
    );
    assert_eq!(
        scene.materials[0].base_color.to_array(),
        [0.75; 3],
        "1 less the emissivity"
    );
    assert_eq!(
        scene.materials[1].base_color.to_array(),
        [0.0; 3],
        "emissivity 1.5 is 1"
    );
    assert_eq!(
        vector_area(&scene, 0),
        Vec3::Z,
        "the front is the counter-clockwise side"
    );
    assert_warned(&scene, "emissivity 1.5");
    assert_warned(&scene, "line 4, emit=1");
    assert_warned(&scene, "line 4, row=2");
    assert_warned(&scene, "epsu, maxU");
}

/// The corners that the formulas of azimuth and tilt give by hand.
#[test]
fn azimuth_and_tilt() {
    let text = "\
F 3a
S 1 R 0 0 0.9 north
  3. 0. 0.   0 90   3. 2.
S 2 R 0 0 0.9 east
  0 0 0  90 90
  3 2
S 3 T 0 0 0.9 floor
  0 0 0  180 0
  0 0  1 0
  0 1
S 4 Q 0 0 0.9 ceiling
  3 0 3   0 180
  2 0  3 0  3 1  2 1
S 5 R 0 0 0.9 slope
  0 0 0  30 60  1 1
E
";
    let scene = scene(text);
    let near = |i: usize, expected: Vec3| {
        let found = vector_area(&scene, i);
        assert!(
            found.distance(expected) < 1e-5,
            "surface {}: {found} is not {expected}",
            i + 1
        );
    };
    near(0, Vec3::Y * 6.0);
    near(1, Vec3::X * 6.0);
    near(2, Vec3::Z * 0.5);
    near(3, Vec3::NEG_Z);
    let (sin30, cos30) = (0.5, 0.866_025_4);
    near(4, Vec3::new(cos30 * sin30, cos30 * cos30, 0.5));
    let corners = [
        Vec3::new(3.0, 0.0, 2.0),
        Vec3::new(3.0, 0.0, 0.0),
        Vec3::ZERO,
        Vec3::new(0.0, 0.0, 2.0),
    ];
    assert_eq!(scene.meshes[0].positions, corners, "right angles are exact");
}

#[test]
fn combined_surfaces_follow_the_first_under_its_name() {
    let scene = scene(&on_square(
        "S 1 1 2 3 0 0 0 0.9 a\nS 2 5 6 7 8 0 0 0.9 b\nS 3 1 3 4 0 0 1 0.8 c\nE\n",
    ));
    assert_eq!(nodes(&scene), ["a", "a", "b"], "c belongs to a");
    assert_eq!(
        scene.materials[1].name, "c",
        "its material keeps its own name"
    );
    assert_eq!(
        vector_area(&scene, 1).z,
        8.0,
        "the second half of the square"
    );
}

#[test]
fn a_wall_is_what_is_left_around_its_window() {
    let scene = scene(&on_square(
        "S 1 1 2 3 4 0 0 0.9 wall\nS 2 5 6 7 8 1 0 0.8 window\nE\n",
    ));
    assert_eq!(nodes(&scene), ["wall", "window"], "both are rows");
    assert_eq!(vector_area(&scene, 0), Vec3::Z * 14.0, "16 less 2");
    assert_eq!(vector_area(&scene, 1), Vec3::Z * 2.0, "the window");
    let wall = &scene.meshes[0];
    for corner in &scene.meshes[1].positions {
        assert!(
            wall.positions.contains(corner),
            "they share {corner} bit for bit"
        );
    }
    let quads = wall.faces.iter().all(|face| matches!(face, Face::Quad(_)));
    assert!(
        quads && wall.faces.len() == 4,
        "four quads: {:?}",
        wall.faces
    );
}

#[test]
fn windows_in_windows_and_doors_on_edges() {
    let more =
        "V 9 1 0 0\nV 10 2 0 0\nV 11 1.25 1.5 0\nV 12 1.75 1.5 0\nV 13 1.75 2 0\nV 14 1.25 2 0\n";
    let text = format!(
        "F 3\n{VERTICES}{more}S 1 1 2 3 4 0 0 0.9 wall\nS 2 5 6 7 8 1 0 0.8 window\nS 3 11 12 13 14 2 0 0.7 pane\n\
         S 4 9 10 6 5 1 0 0.6 door\nE\n"
    );
    let scene = scene(&text);
    let areas: Vec<f32> = (0..4).map(|i| vector_area(&scene, i).z).collect();
    for (area, expected) in areas.iter().zip([13.0, 1.75, 0.25, 1.0]) {
        assert!((area - expected).abs() < 1e-6, "{areas:?}");
    }
}

#[test]
fn null_surfaces_and_masks_take_from_their_base_and_only_block() {
    for (key, masks, reflectance) in [("N", 0, 0.0), ("M", 1, 0.5)] {
        let text = format!("S 1 1 2 3 4 0 0 0.9 floor\n{key} 2 8 7 6 5 1 0 0.5 rug\nE\n");
        let scene = scene(&on_square(&text));
        assert_eq!(
            nodes(&scene),
            ["floor", "rug"],
            "{key}: what blocks comes last"
        );
        assert!(!scene.materials[0].obstruction, "{key}: the floor radiates");
        assert!(scene.materials[1].obstruction, "{key}: the rug only blocks");
        assert_eq!(
            scene.materials[1].base_color.to_array(),
            [reflectance; 3],
            "{key}: masks are rows, and have their emissivity"
        );
        assert_eq!(
            vector_area(&scene, 0).z,
            14.0,
            "{key}: the floor loses the rug"
        );
        assert!(scene.report.warnings.is_empty(), "{key}: no warning");
        let asked = scene.view_factors.expect("it is made for view factors");
        assert_eq!(asked.masks.len(), masks, "{key}: who covers");
        assert_eq!(asked.rows.len(), 1 + masks, "{key}: rows by object");
    }
}

/// Surface 2 is combined with 1, so its mask covers 1; 4 stands before 5 in the file, though 5 is placed first.
#[test]
fn masks_know_whom_they_cover_and_where_their_row_is() {
    let scene = scene(&on_square(
        "S 1 1 2 3 0 0 0 0.9 wall\nS 2 1 3 4 0 0 1 0.9 part\nV 9 0 3.5 0\nV 10 0.5 3.5 0\nV 11 0.5 4 0\n\
         M 3 4 11 10 9 2 0 0.4 rug\nO 4 1 4 3 2\nS 5 1 4 3 2 0 0 0.8 back\nE\n",
    ));
    let asked = scene
        .view_factors
        .as_ref()
        .expect("it is made for view factors");
    let mask = Mask {
        node: "rug".into(),
        base: "wall".into(),
        base_material: 1,
    };
    assert_eq!(asked.masks, [mask], "the first of what is combined");
    assert_eq!(asked.rows, ["wall", "rug", "back"], "View3D's order");
    assert_eq!(scene.materials[1].name, "part", "its own material");
}

#[test]
fn a_base_that_is_masked_all_over_stays_a_row() {
    let scene = scene(&on_square(
        "S 1 5 6 7 8 0 0 0.9 wall\nM 2 8 7 6 5 1 0 0.4 cover\nS 3 1 2 3 4 0 0 0.8 floor\nE\n",
    ));
    assert_eq!(nodes(&scene), ["floor", "cover"], "nothing of it is seen");
    assert!(scene.report.warnings.is_empty(), "and that is well");
    let asked = scene
        .view_factors
        .as_ref()
        .expect("it is made for view factors");
    let material = asked.masks[0].base_material;
    assert_eq!(
        scene.materials[material].name, "wall",
        "its material is kept"
    );
}

#[test]
fn a_mask_goes_with_its_base() {
    let mut scene = scene(&on_square(
        "S 1 1 2 3 4 0 0 0.9 wall\nM 2 8 7 6 5 1 0 0.4 cover\nS 3 1 4 3 2 0 0 0.8 floor\nE\n",
    ));
    scene
        .apply(&SceneOptions::default().with_hide("wall"))
        .expect("nodes can be hidden");
    let asked = scene.view_factors.expect("it is made for view factors");
    assert!(asked.masks.is_empty(), "it covers nothing");
}

#[test]
fn obstructions_may_be_bases_and_need_no_facts() {
    let scene = scene(&on_square(
        "S 1 5 6 7 8 2 0 0.8 panel\nO 2 1 2 3 4 0 0 0 cupboard\nO 3 1 4 3 2\nE\n",
    ));
    assert_eq!(
        nodes(&scene),
        ["panel", "cupboard", "obstruction 3"],
        "names, or numbers"
    );
    let blocks: Vec<bool> = scene.materials.iter().map(|m| m.obstruction).collect();
    assert_eq!(blocks, [false, true, true], "what only blocks");
    assert_eq!(
        vector_area(&scene, 1).z,
        14.0,
        "the cupboard is left around the panel"
    );
}

#[test]
fn names_are_told_apart() {
    let scene = scene(&on_square(
        "S 1 1 2 3 4 0 0 0.9 wall\nS 2 5 6 7 8 0 0 0.9 wall\nE\n",
    ));
    assert_eq!(nodes(&scene), ["wall", "wall (2)"], "each name once");
}

#[test]
fn a_base_that_is_covered_all_over_is_told_of() {
    let scene = scene(&on_square(
        "S 1 5 6 7 8 0 0 0.9 wall\nS 2 5 6 7 8 1 0 0.9 paper\nE\n",
    ));
    assert_eq!(nodes(&scene), ["paper"], "what is seen");
    assert_warned(&scene, "'wall'");
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    let surface = "S 1 1 2 3 4 0 0 0.9 a\n";
    let at = |text: &str| on_square(text);
    assert_refused(
        &at("Q 1 2 3\n"),
        &["line 10", "'Q'", "begin comments with !"],
    );
    assert_refused(
        &at("S 1 1 2 3 4 0 0\n"),
        &["line 10", "emissivity of surface 1 is missing"],
    );
    assert_refused(
        &at("S 1 1 2 3\n"),
        &["line 10", "vertex 4 of surface 1 is missing"],
    );
    assert_refused(
        &at("S 1 1 2 9 4 0 0 0.9 a\n"),
        &["line 10", "vertex 9 of 8", "V 9 x y z"],
    );
    assert_refused(
        &at("S 1 1 0 3 4 0 0 0.9 a\n"),
        &["line 10", "vertex 2 of surface 1 is 0"],
    );
    assert_refused(&at("S 1 1 2 -3 4 0 0 0.9 a\n"), &["line 10", "'-3'"]);
    assert_refused(
        &at("S 2 1 2 3 4 0 0 0.9 a\n"),
        &["line 10", "surface 2 stands where surface 1 is due"],
    );
    assert_refused(
        &at(&format!("{surface}{surface}")),
        &["line 11", "surface 1 stands where surface 2"],
    );
    assert_refused(
        &at("V 8 1 2 3\n"),
        &["line 10", "vertex 8 stands where vertex 9 is due"],
    );
    assert_refused(&at("V 9 1 nan 3\n"), &["line 10", "y of vertex 9", "'nan'"]);
    assert_refused(
        &at("V 9 1 2 1e999\n"),
        &["line 10", "z of vertex 9", "'1e999'"],
    );
    assert_refused(&at("V 9 1 2\n"), &["line 10", "z of vertex 9 is missing"]);
    assert_refused(
        &at("S 1 1 2 3 4 0 0 NaN a\n"),
        &["line 10", "emissivity", "'NaN'"],
    );
    assert_refused(
        &at("S 1 1 2 1 2 0 0 0.9 a\n"),
        &["line 10", "'a'", "has no area"],
    );
    assert_refused(
        &at("S 1 1 3 2 4 0 0 0.9 a\n"),
        &["line 10", "'a'", "has no area"],
    );
    assert_refused(
        &at("V 9 2 2 1\nS 1 1 2 9 4 0 0 0.9 a\n"),
        &["line 11", "is not flat", "two triangles"],
    );
    assert_refused(
        &at("V 9 .5 .5 0\nS 1 1 2 9 4 0 0 0.9 a\n"),
        &["line 11", "is not convex"],
    );
    assert_refused("F 2\n", &["line 1", "F 2", "F 3"]);
    assert_refused("F 7\n", &["line 1", "F 7", "use F 3 or F 3a"]);
    assert_refused(&at("C eps=small\n"), &["line 10", "eps='small'"]);
    assert_refused(&at("C encl\n"), &["line 10", "encl=''"]);
    assert_refused("", &["no radiating surface"]);
    assert_refused(&at("O 1 1 2 3 4\n"), &["no radiating surface"]);
    assert_refused(
        &at("S 1 R 0 0 0.9 a\n"),
        &["line 10", "shape (R)", "write F 3a"],
    );
    assert_refused("F 3a\nS 1 X 0 0 0.9 a\n1 2 3\n", &["line 2", "shape 'X'"]);
    assert_refused(
        "F 3a\nS 1 R 0 0 0.9 a\n1 2 3 0 90\n",
        &["line 2", "rectangle", "needs 7 numbers", "5 are there"],
    );
    assert_refused(
        "F 3a\nS 1 T 0 0 0.9 a\n1 2 3 0 90 1 x\n",
        &["line 3", "'x'"],
    );
    assert_refused(
        "F 3a\nS 1 R 0 0 0.9 a\n1 2 3 0 90\nS 2 R 0 0 0.9 b\n",
        &["line 2", "5 are there"],
    );
}

#[test]
fn bases_and_combinations_that_cannot_be() {
    let at = |text: &str| on_square(&format!("S 1 1 2 3 4 0 0 0.9 wall\n{text}"));
    assert_refused(
        &at("S 2 5 6 7 8 3 0 0.9 w\n"),
        &["line 11", "'w' has the base 3, there are 2"],
    );
    assert_refused(&at("S 2 5 6 7 8 2 0 0.9 w\n"), &["line 11", "lower number"]);
    assert_refused(
        &at("N 2 8 7 6 5 0 0 0.9 n\n"),
        &["line 11", "'n' has no base"],
    );
    assert_refused(
        &at("N 2 5 6 7 8 1 0 0.9 n\n"),
        &["line 11", "must face towards its base 'wall'"],
    );
    assert_refused(
        &at("S 2 8 7 6 5 1 0 0.9 w\n"),
        &["line 11", "the same way as its base 'wall'"],
    );
    assert_refused(
        &at("V 9 2 3 1\nS 2 5 6 9 0 1 0 0.9 w\n"),
        &["line 12", "not in the plane of its base"],
    );
    assert_refused(
        &at("V 9 9 3 0\nS 2 5 6 9 0 1 0 0.9 w\n"),
        &["line 12", "reaches over the edge"],
    );
    assert_refused(
        &at("S 2 5 6 7 8 0 2 0.9 w\n"),
        &["line 11", "cannot be combined with surface 2"],
    );
    assert_refused(
        &at("S 2 5 6 7 8 0 7 0.9 w\n"),
        &["line 11", "cannot be combined with surface 7"],
    );
    assert_refused(
        &at("N 2 8 7 6 5 1 1 0.9 n\n"),
        &["line 11", "set its cmb to 0"],
    );
    let chain = "S 2 5 6 7 8 0 1 0.9 b\nS 3 5 6 7 0 0 2 0.9 c\n";
    assert_refused(&at(chain), &["line 12", "combine both with surface 1"]);
    let twice = "S 2 5 6 7 8 1 0 0.9 b\nS 3 5 6 7 8 1 0 0.9 c\n";
    assert_refused(
        &at(twice),
        &["line 10", "'wall' is the base of surfaces that overlap"],
    );
}

#[test]
fn cut_off_files_and_noise_are_told_in_one_line() {
    let good = on_square("S 1 1 2 3 4 0 0 0.9 wall\nS 2 5 6 7 8 1 0 0.8 window\nEnd\n");
    for end in 0..good.len() {
        if let Err(error) = open_bytes(&good.as_bytes()[..end], "room.vs3", None) {
            assert_eq!(
                error.to_string().lines().count(),
                1,
                "cut at {end}: {error}"
            );
        }
    }
    let noise: Vec<u8> = (0..4000_u32)
        .map(|i| i.wrapping_mul(2_654_435_761).to_be_bytes()[0])
        .collect();
    let error = open_bytes(&noise, "room.vs3", None).expect_err("it is noise");
    assert_eq!(error.to_string().lines().count(), 1, "one line: {error}");
}

/// A façade with so many windows along each side, four corners of vertices each.
fn facade(side: usize) -> String {
    let step = 4.0 / side as f64;
    let mut text = format!("F 3\n{VERTICES}");
    let mut surfaces = String::from("S 1 1 2 3 4 0 0 0.9 facade\n");
    for k in 0..side * side {
        let (x, y) = ((k % side) as f64 * step, (k / side) as f64 * step);
        let (l, h) = (0.25 * step, 0.75 * step);
        for (i, (u, v)) in [(l, l), (h, l), (h, h), (l, h)].into_iter().enumerate() {
            text += &format!("V {} {} {} 0\n", 9 + 4 * k + i, x + u, y + v);
        }
        let v = 9 + 4 * k;
        surfaces += &format!("S {} {v} {} {} {} 1 0 0.8 w\n", k + 2, v + 1, v + 2, v + 3);
    }
    text + &surfaces
}

#[test]
fn many_subsurfaces_are_cut_or_refused_in_time() {
    let start = Instant::now();
    let scene = scene(&facade(20));
    assert!(
        (vector_area(&scene, 0).z - 12.0).abs() < 1e-3,
        "a quarter is glass"
    );
    assert_refused(
        &facade(65),
        &["'facade' is the base of 4225 others, at most 4096"],
    );
    assert!(
        start.elapsed().as_secs() < 20,
        "it takes {:?}",
        start.elapsed()
    );
}

#[test]
fn a_vertex_given_twice_makes_a_triangle() {
    let text = "T t\nF 3\nV 1 0 0 0\nV 2 1 0 0\nV 3 0 1 0\nV 4 0 0 1\nV 5 0 1 1\nV 6 1 0 1\n\
                S 1 1 2 3 3 0 0 0.9 floor\nS 2 4 5 6 6 0 0 0.9 roof\nEnd of data\n";
    let scene = open_bytes(text.as_bytes(), "twice.vs3", None).expect("it is read");
    let faces: Vec<usize> = scene.meshes.iter().map(|m| m.faces.len()).collect();
    assert_eq!(faces, [1, 1], "a triangle each");
    assert!(
        scene.report.warnings.is_empty(),
        "{:?}",
        scene.report.warnings
    );
}
