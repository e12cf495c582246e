//! OBJ and MTL files: what is read is what was written, what is damaged is named by its line.

use glam::{Vec2, Vec3};
use hemicube_raster::Image;
use hemicube_scene::{AlphaMode, Face, ReliefKind, Scene, TextureImage, open, open_bytes};
use std::path::PathBuf;
use std::time::Instant;

fn scene(text: &str) -> Scene {
    let scene = open_bytes(text.as_bytes(), "folder/box.obj", None).expect("the file is good");
    scene.check().expect("what opens is consistent");
    scene
}

fn warnings(scene: &Scene) -> Vec<String> {
    scene
        .report
        .warnings
        .iter()
        .map(ToString::to_string)
        .collect()
}

fn assert_warned(scene: &Scene, part: &str) {
    assert!(
        warnings(scene).iter().any(|w| w.contains(part)),
        "no warning says '{part}': {:?}",
        warnings(scene)
    );
}

/// A folder for one test, removed when it goes.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str, files: &[(&str, &[u8])]) -> Self {
        let folder = Self(
            PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
                .join(format!("obj-{test}-{}", std::process::id())),
        );
        std::fs::create_dir_all(&folder.0).expect("a folder for the test");
        for (name, bytes) in files {
            std::fs::write(folder.0.join(name), bytes).expect("a file for the test");
        }
        folder
    }

    fn open(&self, name: &str) -> Scene {
        let path = self.0.join(name);
        let scene = open(path.to_str().expect("a path in UTF-8")).expect("the file is good");
        scene.check().expect("what opens is consistent");
        scene
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A folder left behind does no harm.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn a_planar_convex_quad_stays_one() {
    let scene = scene(&format!("{SQUARE}f 1 2 3 4\n"));
    assert_eq!(
        scene.meshes[0].faces,
        [Face::Quad([0, 1, 2, 3])],
        "one quad"
    );
    assert_eq!(
        scene.meshes[0].positions,
        [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
        "its corners"
    );
    assert_eq!(
        scene.instances[0].node, "box",
        "without o and g the file names it"
    );
    assert_eq!(
        scene.materials[0].base_color.to_array(),
        [0.5; 3],
        "grey 0.5 without material"
    );
}

#[test]
fn a_quad_that_is_not_planar_is_split_along_its_first_diagonal() {
    let scene = scene("v 0 0 0\nv 1 0 0\nv 1 1 0.01\nv 0 1 0\nf 1 2 3 4\n");
    assert_eq!(
        scene.meshes[0].faces,
        [Face::Triangle([0, 1, 2]), Face::Triangle([0, 2, 3])],
        "v0 to v2"
    );
}

/// The vector area of all faces of a mesh: half the sum of cross products, pointing to the front.
fn vector_area(scene: &Scene, mesh: usize) -> Vec3 {
    let mesh = &scene.meshes[mesh];
    let at = |v: u32| mesh.positions[v as usize];
    let area = |face: &Face| -> Vec3 {
        let c = face.corners();
        (1..c.len() - 1)
            .map(|i| 0.5 * (at(c[i]) - at(c[0])).cross(at(c[i + 1]) - at(c[0])))
            .sum()
    };
    mesh.faces.iter().map(area).sum()
}

#[test]
fn concave_polygons_keep_their_area_and_side() {
    // A quad with a reflex corner, and a letter L; once seen from the front and once from behind.
    for (text, corners, area, pieces) in [
        ("v 0 0 5\nv 2 0 5\nv 0.5 0.5 5\nv 0 2 5\n", 4, 1.0, 2),
        (
            "v 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\n",
            6,
            3.0,
            4,
        ),
    ] {
        let numbers: Vec<String> = (1..=corners).map(|i: i32| i.to_string()).collect();
        let backwards: Vec<String> = (1..=corners).rev().map(|i: i32| i.to_string()).collect();
        let scene = scene(&format!(
            "{text}f {}\no back\nf {}\n",
            numbers.join(" "),
            backwards.join(" ")
        ));
        for (mesh, side) in [(0, 1.0), (1, -1.0)] {
            assert_eq!(
                scene.meshes[mesh].faces.len(),
                pieces,
                "{corners} corners, side {side}"
            );
            let found = vector_area(&scene, mesh);
            assert!(
                found.distance(Vec3::Z * side * area) < 1e-6,
                "{corners} corners: {found}, not {}",
                side * area
            );
            let unsigned: f32 = (0..pieces).map(|i| triangle_area(&scene, mesh, i)).sum();
            assert!(
                (unsigned - area).abs() < 1e-6,
                "no piece lies outside: {unsigned}, not {area}"
            );
        }
    }
}

fn triangle_area(scene: &Scene, mesh: usize, face: usize) -> f32 {
    let mesh = &scene.meshes[mesh];
    let p: Vec<Vec3> = mesh.faces[face]
        .corners()
        .iter()
        .map(|&v| mesh.positions[v as usize])
        .collect();
    0.5 * (p[1] - p[0]).cross(p[2] - p[0]).length()
}

#[test]
fn indices_count_from_the_start_and_from_the_end() {
    let scene = scene(
        "v 9 9 9\nv 0 0 0\nv 1 0 0\nvt 0.25 0.75\nvn 0 0 2\nv 0 1 0\nf -3/-1/-1 3/1/1 -1/1/-1\n",
    );
    let mesh = &scene.meshes[0];
    assert_eq!(
        mesh.positions,
        [Vec3::ZERO, Vec3::X, Vec3::Y],
        "vertices that no face uses are left out"
    );
    assert_eq!(
        mesh.texcoords,
        [vec![Vec2::new(0.25, 0.25); 3]],
        "v counts from above: 1 - 0.75"
    );
    assert_eq!(mesh.normals, [Vec3::Z; 3], "of unit length");
}

#[test]
fn corners_share_a_vertex_only_if_everything_is_the_same() {
    let scene = scene(&format!(
        "{SQUARE}vt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/1 3/2 4/1\n"
    ));
    let mesh = &scene.meshes[0];
    assert_eq!(
        mesh.positions.len(),
        5,
        "vertex 3 has two texture coordinates"
    );
    assert_eq!(
        mesh.faces[1],
        Face::Triangle([0, 3, 4]),
        "the first corner is shared"
    );
}

#[test]
fn vertex_colours_are_srgb() {
    let scene = scene("v 0 0 0 1 0 0.5\nv 1 0 0 1 1 1\nv 0 1 0\nf 1 2 3\n");
    let colors = &scene.meshes[0].colors;
    assert!(
        (colors[0].z - 0.214_041).abs() < 1e-5,
        "0.5 in sRGB is 0.214041 (IEC 61966-2-1): {}",
        colors[0].z
    );
    assert_eq!(
        colors[0].truncate().truncate(),
        Vec2::X,
        "0 and 1 are the same in both"
    );
    assert_eq!(colors[2].to_array(), [1.0; 4], "white where there is none");
}

#[test]
fn objects_groups_and_materials_become_meshes() {
    let scene = scene(&format!(
        "{SQUARE}o room\nusemtl white\nf 1 2 3\nusemtl red paint # 7\nf 1 3 4\nusemtl white\nf 2 3 4\ng door\nf 1 2 4\n"
    ));
    let names: Vec<(&str, &str, usize)> = scene
        .instances
        .iter()
        .map(|i| {
            (
                i.node.as_str(),
                scene.materials[scene.meshes[i.mesh].material].name.as_str(),
                scene.meshes[i.mesh].faces.len(),
            )
        })
        .collect();
    assert_eq!(
        names,
        [
            ("room", "white", 2),
            ("room", "red paint # 7", 1),
            ("room/door", "white", 1)
        ],
        "name, material, faces"
    );
}

#[test]
fn line_ends_continuations_comments_and_odd_bytes_are_read() {
    let mut text = b"\xef\xbb\xbf# made by hand\r\nv 0 0 0\rv 1 0 \\\r\n 0 # a comment\nv 0 1 0\ng caf\xe9\nf 1 2 \\\n  3".to_vec();
    let scene = open_bytes(&text, "box.obj", None).expect("the file is good");
    assert_eq!(scene.face_count(), 1, "one face of three lines' ends");
    assert_eq!(
        scene.instances[0].node, "caf\u{fffd}",
        "bytes that are not UTF-8 are shown as such"
    );
    text.extend(b"\\");
    assert!(
        open_bytes(&text, "box.obj", None).is_ok(),
        "a continuation into nothing"
    );
}

#[test]
fn a_bad_face_costs_itself_and_names_its_line() {
    let scene = scene(&format!(
        "{SQUARE}f 1 2 3\nf 1 2 9\nf 0 1 2\nf 1 2\nf 1 x 2\nf 1/2/3/4 2 3\nf -9 1 2\nf 1 1 2\nf 1 2 2 3\nv nan 0 0\nf 1 2 5\nf\nv 1\n"
    ));
    assert_eq!(
        scene.meshes[0].faces.len(),
        2,
        "the first, and the one that is mended to a triangle"
    );
    for part in [
        "line 6: vertex 9 of 6",
        "line 7: '0' is no corner",
        "line 8: it has 2 corners",
        "line 9: 'x' is no corner",
        "line 10: '1/2/3/4' is no corner",
        "line 11: '-9' is no corner",
        "line 12: it uses a vertex twice",
        "line 14: v needs three finite numbers",
        "line 15: vertex 5 is at",
        "line 16: it has 0 corners",
    ] {
        assert_warned(&scene, part);
    }
}

#[test]
fn a_file_without_faces_is_refused() {
    for text in ["", "v 0 0 0\n", "f 1 2 3\n"] {
        let message = open_bytes(text.as_bytes(), "a/b.obj", None)
            .expect_err("no faces")
            .to_string();
        assert!(
            message.starts_with("a/b.obj: contains no triangles"),
            "{message}"
        );
        assert!(!message.contains('\n'), "one line: {message}");
    }
}

#[test]
fn lines_points_and_curves_are_counted() {
    let scene = scene(&format!("{SQUARE}f 1 2 3\nl 1 2\np 1\ncurv 0 1 1 2\n"));
    assert_warned(&scene, "2 points and lines");
    assert_warned(&scene, "1 free-form elements");
}

fn png(pixel: [u8; 4]) -> Vec<u8> {
    TextureImage::from_pixels("dot", Image::filled(2, 2, pixel))
        .encoded()
        .to_vec()
}

#[test]
fn materials_are_read_from_the_files_beside() {
    let obj = format!(
        "mtllib my colours.mtl\nmtllib a.mtl b.mtl\n{SQUARE}usemtl lamp\nf 1 2 3\nusemtl glass\nf 1 2 3\nusemtl leaf\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl nowhere\nf 1 2 3\nusemtl pane\nf 1 2 3\nusemtl bark\nf 1 2 3\n"
    );
    let colours = "newmtl lamp\nKd 0.1 0.2 0.3\nKe 5 6 7\nNs 98\nnewmtl glass\r\nKd 0.8\r\nTr 0.75\r\nnewmtl leaf\nmap_Kd -s 2 2 2 -clamp on C:\\art\\leaf colour.png\nmap_d mask.png\nnewmtl pane\nillum 6\nTf 0.5 0.5 0.5\nnewmtl bark\nmap_Kd -o 0.5 missing.png\nillum 4\nTf 1 1 1\n";
    let folder = Folder::new(
        "materials",
        &[
            ("scene.obj", obj.as_bytes()),
            ("my colours.mtl", colours.as_bytes()),
            ("b.mtl", b"newmtl b\nKd 2 0 0\nd 1\n"),
            ("leaf colour.png", &png([10, 20, 30, 255])),
            ("mask.png", &png([64, 64, 64, 255])),
        ],
    );
    let scene = folder.open("scene.obj");
    let material = |name: &str| {
        scene
            .materials
            .iter()
            .find(|m| m.name == name)
            .expect("a material of that name")
    };
    let lamp = material("lamp");
    assert_eq!(lamp.base_color.to_array(), [0.1, 0.2, 0.3], "Kd");
    assert_eq!(lamp.emission.to_array(), [5.0, 6.0, 7.0], "Ke");
    assert!(
        (lamp.roughness - 0.02_f32.sqrt()).abs() < 1e-6,
        "sqrt(2 / (98 + 2)): {}",
        lamp.roughness
    );
    assert_eq!(lamp.alpha_mode, AlphaMode::Opaque, "opaque");
    let glass = material("glass");
    assert_eq!(
        (glass.alpha, glass.alpha_mode),
        (0.25, AlphaMode::Blend),
        "1 - Tr"
    );
    assert_eq!(
        glass.base_color.to_array(),
        [0.8; 3],
        "one number for all bands"
    );
    let slot = material("leaf")
        .base_color_texture
        .expect("the map is used");
    let image = &scene.images[scene.textures[slot.texture].image];
    assert_eq!(
        image.pixels().pixel(0, 0),
        &[10, 20, 30, 64],
        "colour of map_Kd, alpha of map_d"
    );
    assert_eq!(
        material("leaf").alpha_mode,
        AlphaMode::Blend,
        "so it lets light through"
    );
    assert_eq!(
        material("b").base_color.to_array(),
        [1.0, 0.0, 0.0],
        "the second library of the line, clamped"
    );
    assert_eq!(material("pane").transmission, 0.5, "Tf of a glass");
    assert_eq!(material("bark").transmission, 0.0, "Tf of what is no glass");
    assert!(
        material("bark").base_color_texture.is_none(),
        "a missing picture is dropped"
    );
    assert_eq!(material("nowhere").base_color.to_array(), [0.5; 3], "grey");
    for part in [
        "'a.mtl' is not there",
        "'missing.png' is not there",
        "material 'nowhere': no MTL",
        "Kd [2.0, 0.0, 0.0]",
    ] {
        assert_warned(&scene, part);
    }
}

#[test]
fn folders_and_names_of_nothing_are_told_in_one_line() {
    let folder = Folder::new(
        "names",
        &[
            ("notes.txt", b"hello"),
            ("wrong.txt", b"glTF"),
            ("a.obj", b""),
        ],
    );
    let path = |name: &str| {
        folder
            .0
            .join(name)
            .to_str()
            .expect("a path in UTF-8")
            .to_owned()
    };
    for (name, part) in [
        (path(""), "it is a folder"),
        (path("notes.txt"), "not a scene format"),
        (path("wrong.txt"), "cut off within its header"),
        (path("a.obj"), "contains no triangles"),
        (path("nothing.obj"), "neither a file nor a built-in scene"),
        (
            String::from("no such scene"),
            "neither a file nor a built-in scene",
        ),
    ] {
        let message = open(&name).expect_err("it cannot be opened").to_string();
        assert!(
            message.contains(part) && message.contains(&name),
            "'{part}' and the name are not in: {message}"
        );
        assert!(!message.contains('\n'), "one line: {message}");
    }
}

#[test]
fn a_polygon_of_a_million_corners_is_refused_soon() {
    let mut text = String::from(SQUARE);
    text.push('f');
    text.push_str(&" 1 2 3 4".repeat(250_000));
    text.push_str("\nf 1 2 3\n");
    assert_warned(&scene(&text), "1000000 corners are more than");
}

#[test]
fn many_faces_in_many_groups_need_no_quadratic_time() {
    const SIDE: usize = 300;
    let mut text = String::new();
    for y in 0..=SIDE {
        for x in 0..=SIDE {
            text.push_str(&format!("v {x} {y} 0\n"));
        }
    }
    for y in 0..SIDE {
        for x in 0..SIDE {
            let a = y * (SIDE + 1) + x + 1;
            // Each face in a group of its own, of two materials in turn.
            text.push_str(&format!(
                "g g{a}\nusemtl m{}\nf {a} {} {} {}\n",
                x % 2,
                a + 1,
                a + SIDE + 2,
                a + SIDE + 1
            ));
        }
    }
    let start = Instant::now();
    let scene = scene(&text);
    assert_eq!(scene.meshes.len(), SIDE * SIDE, "a mesh for each group");
    println!("{} groups in {:?}", scene.meshes.len(), start.elapsed());
}

#[test]
fn reliefs_roughness_and_webp_are_read() {
    let webp = {
        let mut file = Vec::new();
        let encoder = image::codecs::webp::WebPEncoder::new_lossless(&mut file);
        let pixel = [10, 200, 30, 255];
        encoder
            .encode(&pixel, 1, 1, image::ExtendedColorType::Rgba8)
            .expect("encoding into memory");
        file
    };
    let (normals, heights) = (png([128, 128, 255, 255]), png([90, 90, 90, 255]));
    let mtl = b"newmtl a\nmap_Bump -bm 0.5 heights.png\nmap_Pr rough.webp\nnewmtl b\nbump normals.png\nmap_Pm heights.png\n\
newmtl c\nnorm -bm 2 normals.png\nPr 0.25\nmap_Kd missing.png\n";
    let obj = b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\nusemtl b\n\
f 1/1 2/2 3/3\nusemtl c\nf 1/1 2/2 3/3\n";
    let folder = Folder::new(
        "relief",
        &[
            ("o.obj", obj),
            ("m.mtl", mtl),
            ("rough.webp", &webp),
            ("normals.png", &normals),
            ("heights.png", &heights),
        ],
    );
    let scene = folder.open("o.obj");
    let [a, b, c] = ["a", "b", "c"].map(|name| {
        let found = scene.materials.iter().find(|m| m.name == name);
        found.expect("a material that is used")
    });
    let kind = |m: &hemicube_scene::Material| m.relief.expect("a relief").kind;
    assert_eq!(
        kind(a),
        ReliefKind::Height { depth: 0.005 },
        "half of the default"
    );
    assert_eq!(
        kind(b),
        ReliefKind::Normal { scale: 1.0 },
        "its colours tell"
    );
    assert_eq!(kind(c), ReliefKind::Normal { scale: 2.0 }, "norm");
    assert_eq!(
        (a.roughness, b.metallic, c.roughness),
        (1.0, 1.0, 0.25),
        "factors"
    );
    let rough = a.roughness_texture.expect("a map");
    let image = &scene.images[scene.textures[rough.texture].image];
    assert_eq!(image.pixels().pixel(0, 0)[1], 200, "WebP");
    assert_eq!(image.media_type(), "image/png", "kept as what glTF knows");
    assert!(TextureImage::decode("again", image.encoded().to_vec()).is_ok());
}
