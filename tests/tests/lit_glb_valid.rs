//! Lit files are valid glTF: checked here, and by Khronos' validator where it can be found.

use glam::{Affine2, Vec2, Vec3};
use hemicube::radiosity::export::lit_glb::{self, LitGlbOptions, write};
use hemicube::radiosity::solve::ambient::ambient_irradiance;
use hemicube::radiosity::{Quality, Solution, SolveOptions, solve};
use hemicube::raster::{Image, Rgb};
use hemicube::scene::builtin::{self, Sides};
use hemicube::scene::{AlphaMode, Camera, Material, Scene, TextureSlot, Units, Wrap};
use serde_json::Value;
use std::collections::HashSet;
use std::f32::consts::PI;
use std::io::Write;
use std::process::{Command, Stdio};
use std::sync::Arc;

fn solved(scene: Scene, options: &SolveOptions) -> Solution {
    solve(Arc::new(scene), options, |_, _| true).expect("it can be solved")
}

fn lit(scene: Scene) -> Vec<u8> {
    let solution = solved(scene, &Quality::Draft.into());
    write(&solution, &LitGlbOptions::default()).expect("it can be written")
}

/// A room with a pane, a leaf with holes, a turned texture, a lamp and a screen.
fn special() -> Scene {
    let mut b = builtin::SceneBuilder::new("special", Units::Photometric);
    let dots: Vec<[u8; 4]> = (0..16_u8)
        .map(|i| [200, 16 * i, 90, if i % 3 == 0 { 0 } else { 255 }])
        .collect();
    let dots = Image::from_pixels(4, 4, dots).expect("16 pixels");
    let texture = b.texture("dots", Wrap::MirroredRepeat, dots);
    let slot = TextureSlot::new(texture);
    let turned = TextureSlot {
        transform: Affine2::from_scale_angle_translation(
            Vec2::new(0.5, 2.0),
            0.3,
            Vec2::new(0.1, -0.2),
        ),
        ..slot
    };
    let with = |name: &str, slot: TextureSlot| Material {
        base_color_texture: Some(slot),
        ..Material::diffuse(name, Rgb::splat(0.8))
    };
    let wall = b.diffuse("wall", 0.7, 0.7, 0.6);
    let tiles = b.material(with("tiles", turned));
    let leaf = b.material(Material {
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        double_sided: true,
        ..with("leaf", slot)
    });
    let glass = b.material(Material {
        transmission: 0.9,
        double_sided: true,
        ..Material::diffuse("glass", Rgb::new(0.8, 1.0, 0.9))
    });
    let veil = b.material(Material {
        alpha: 0.4,
        alpha_mode: AlphaMode::Blend,
        ..Material::diffuse("veil", Rgb::WHITE)
    });
    let lamp = b.material(
        Material {
            alpha: 0.5,
            alpha_mode: AlphaMode::Blend,
            ..Material::diffuse("lamp", Rgb::splat(0.5))
        }
        .with_emission(Rgb::new(4000.0, 3000.0, 2000.0)),
    );
    let screen = b.material(Material {
        emission_texture: Some(slot),
        ..Material::diffuse("screen", Rgb::splat(0.1)).with_emission(Rgb::splat(300.0))
    });
    b.node("room");
    b.room(
        wall,
        Vec3::ZERO,
        Vec3::splat(3.0),
        Sides::without(&[Sides::BOTTOM]),
    );
    b.room(
        tiles,
        Vec3::ZERO,
        Vec3::splat(3.0),
        Sides::only(&[Sides::BOTTOM]),
    );
    b.node("things");
    let upright = |x: f32, z: f32| {
        [(0.0, 0.5), (1.0, 0.5), (1.0, 1.5), (0.0, 1.5)]
            .map(|(dx, y): (f32, f32)| Vec3::new(x + dx, y, z))
    };
    b.picture(leaf, upright(0.3, 1.0));
    b.quad(glass, upright(1.6, 1.2));
    b.quad(veil, upright(1.0, 2.0));
    b.picture(screen, upright(1.5, 0.1));
    b.quad(
        lamp,
        [(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0)].map(|(x, z)| Vec3::new(x, 2.9, z)),
    );
    b.camera(Camera::looking_at(
        "door",
        Vec3::new(2.7, 1.6, 2.8),
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::Y,
        1.0,
    ));
    b.finish()
}

fn files() -> Vec<(&'static str, Vec<u8>)> {
    let builtin = |name| builtin::scene(name).expect("it is built in");
    let mut files: Vec<(&str, Vec<u8>)> = ["cornell", "office", "perpendicular-plates"]
        .into_iter()
        .map(|name| (name, lit(builtin(name))))
        .collect();
    files.push(("special", lit(special())));
    files
}

/// A file taken apart.
struct Parts<'a> {
    name: &'a str,
    root: Value,
    binary: &'a [u8],
}

fn word(bytes: &[u8], at: usize) -> usize {
    let bytes = bytes[at..at + 4].try_into().expect("four bytes");
    u32::from_le_bytes(bytes) as usize
}

fn number(value: &Value) -> usize {
    let number = value.as_u64().expect("a whole number");
    usize::try_from(number).expect("it fits the memory")
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

impl<'a> Parts<'a> {
    /// Checks the container: header, two chunks, lengths, padding.
    fn of(name: &'a str, file: &'a [u8]) -> Self {
        assert_eq!(&file[..4], b"glTF", "{name}: magic");
        assert_eq!(word(file, 4), 2, "{name}: version");
        assert_eq!(word(file, 8), file.len(), "{name}: length");
        let text_length = word(file, 12);
        assert_eq!(&file[16..20], b"JSON", "{name}: first chunk");
        assert_eq!(text_length % 4, 0, "{name}: padding of the JSON");
        let text = &file[20..20 + text_length];
        let rest = &file[20 + text_length..];
        assert_eq!(&rest[4..8], b"BIN\0", "{name}: second chunk");
        assert_eq!(word(rest, 0), rest.len() - 8, "{name}: nothing after it");
        assert_eq!(word(rest, 0) % 4, 0, "{name}: padding of the binary");
        let root: Value = serde_json::from_slice(text).expect("the JSON chunk is JSON");
        let buffers = list(&root["buffers"]);
        assert_eq!(buffers.len(), 1, "{name}: buffers");
        let length = number(&buffers[0]["byteLength"]);
        assert!(
            length <= rest.len() - 8 && length + 4 > rest.len() - 8,
            "{name}: buffer {length} in a chunk of {}",
            rest.len() - 8
        );
        Self {
            name,
            root,
            binary: &rest[8..],
        }
    }

    fn accessor(&self, index: &Value) -> (&Value, &[u8]) {
        let accessor = &self.root["accessors"][number(index)];
        let view = &self.root["bufferViews"][number(&accessor["bufferView"])];
        let start = number(&view["byteOffset"]);
        (
            accessor,
            &self.binary[start..start + number(&view["byteLength"])],
        )
    }

    fn floats(&self, index: &Value) -> Vec<f32> {
        let (accessor, bytes) = self.accessor(index);
        assert_eq!(accessor["componentType"], 5126, "{}: floats", self.name);
        let to_float = |b: &[u8]| f32::from_le_bytes(b.try_into().expect("four bytes"));
        bytes.chunks_exact(4).map(to_float).collect()
    }

    fn primitives(&self) -> impl Iterator<Item = &Value> {
        list(&self.root["meshes"])
            .iter()
            .flat_map(|mesh| list(&mesh["primitives"]))
    }
}

fn width(accessor: &Value) -> usize {
    match accessor["type"].as_str() {
        Some("SCALAR") => 1,
        Some("VEC2") => 2,
        Some("VEC3") => 3,
        Some("VEC4") => 4,
        other => panic!("accessor of type {other:?}"),
    }
}

fn check_views_and_accessors(parts: &Parts<'_>) {
    let name = parts.name;
    for (i, view) in list(&parts.root["bufferViews"]).iter().enumerate() {
        let (start, length) = (number(&view["byteOffset"]), number(&view["byteLength"]));
        assert!(length > 0, "{name}: view {i} is empty");
        assert_eq!(start % 4, 0, "{name}: view {i} is aligned");
        assert!(
            start + length <= number(&parts.root["buffers"][0]["byteLength"]),
            "{name}: view {i} lies in the buffer"
        );
    }
    for (i, accessor) in list(&parts.root["accessors"]).iter().enumerate() {
        let count = number(&accessor["count"]);
        let view = &parts.root["bufferViews"][number(&accessor["bufferView"])];
        assert!(count > 0, "{name}: accessor {i} is empty");
        // Floats and 32-bit indices, tightly packed.
        assert_eq!(
            count * width(accessor) * 4,
            number(&view["byteLength"]),
            "{name}: accessor {i} fills its view"
        );
    }
}

fn check_primitive(parts: &Parts<'_>, i: usize, primitive: &Value) {
    let name = parts.name;
    let attributes = &primitive["attributes"];
    let (position, _) = parts.accessor(&attributes["POSITION"]);
    let vertices = number(&position["count"]);
    for (attribute, accessor) in attributes.as_object().expect("attributes") {
        let (accessor, _) = parts.accessor(accessor);
        assert_eq!(
            number(&accessor["count"]),
            vertices,
            "{name}: {attribute} of primitive {i}"
        );
    }
    let positions = parts.floats(&attributes["POSITION"]);
    for axis in 0..3 {
        let along = || positions.iter().skip(axis).step_by(3).copied();
        let low = along().fold(f32::INFINITY, f32::min);
        let high = along().fold(f32::NEG_INFINITY, f32::max);
        assert_eq!(
            position["min"][axis].as_f64(),
            Some(f64::from(low)),
            "{name}: min of primitive {i}"
        );
        assert_eq!(
            position["max"][axis].as_f64(),
            Some(f64::from(high)),
            "{name}: max of primitive {i}"
        );
    }
    let corners = if let Some(index) = primitive.get("indices") {
        let (accessor, bytes) = parts.accessor(index);
        assert_eq!(accessor["componentType"], 5125, "{name}: indices of {i}");
        let largest = bytes.chunks_exact(4).map(|b| word(b, 0)).max();
        assert!(
            largest.is_some_and(|largest| largest < vertices),
            "{name}: primitive {i} has vertex {largest:?} of {vertices}"
        );
        number(&accessor["count"])
    } else {
        vertices
    };
    assert_eq!(corners % 3, 0, "{name}: primitive {i} is of triangles");
    let colors = parts.floats(&attributes["COLOR_0"]);
    assert!(
        colors.iter().all(|c| (0.0..=1.0).contains(c)),
        "{name}: colours of primitive {i} lie in [0, 1]"
    );
    let irradiance = parts.floats(&attributes["_IRRADIANCE"]);
    assert!(
        irradiance.iter().all(|h| h.is_finite() && *h >= 0.0),
        "{name}: irradiance of primitive {i}"
    );
    let material = &parts.root["materials"][number(&primitive["material"])];
    assert!(
        material["extensions"]["KHR_materials_unlit"].is_object(),
        "{name}: the material of primitive {i} is unlit"
    );
    let texture = &material["pbrMetallicRoughness"]["baseColorTexture"];
    assert_eq!(
        texture.is_object(),
        attributes["TEXCOORD_0"].is_u64(),
        "{name}: primitive {i} has coordinates just for a texture"
    );
    if texture.is_object() {
        let texture = &parts.root["textures"][number(&texture["index"])];
        assert!(
            parts.root["images"][number(&texture["source"])].is_object()
                && parts.root["samplers"][number(&texture["sampler"])].is_object(),
            "{name}: the texture of primitive {i} has image and sampler"
        );
    }
}

/// Empty arrays and objects are against the format; extensions must be announced.
fn check_json(name: &str, at: &str, value: &Value, extensions: &mut HashSet<String>) {
    match value {
        Value::Array(items) => {
            assert!(!items.is_empty(), "{name}: {at} is empty");
            for item in items {
                check_json(name, at, item, extensions);
            }
        }
        Value::Object(members) => {
            for (key, member) in members.iter().filter(|(key, _)| *key != "extras") {
                if key == "extensions" {
                    extensions.extend(
                        member
                            .as_object()
                            .into_iter()
                            .flat_map(|m| m.keys().cloned()),
                    );
                }
                check_json(name, key, member, extensions);
            }
        }
        _ => {}
    }
}

#[test]
fn lit_files_are_well_formed() {
    for (name, file) in files() {
        let parts = Parts::of(name, &file);
        check_views_and_accessors(&parts);
        for (i, primitive) in parts.primitives().enumerate() {
            check_primitive(&parts, i, primitive);
        }
        let mut extensions = HashSet::new();
        check_json(name, "root", &parts.root, &mut extensions);
        let used: HashSet<String> = list(&parts.root["extensionsUsed"])
            .iter()
            .filter_map(|v| v.as_str().map(String::from))
            .collect();
        assert_eq!(used, extensions, "{name}: extensionsUsed");
        for node in list(&parts.root["nodes"]) {
            assert!(
                node["mesh"].is_u64() || node["camera"].is_u64(),
                "{name}: {node} holds something"
            );
        }
    }
}

#[test]
fn the_special_file_keeps_what_is_special() {
    let file = lit(special());
    let parts = Parts::of("special", &file);
    let of = |name: &str| {
        let found = list(&parts.root["materials"])
            .iter()
            .find(|m| m["name"] == name);
        found.unwrap_or_else(|| panic!("there is a material '{name}'"))
    };
    assert_eq!(of("leaf")["alphaMode"], "MASK", "a leaf has holes");
    for name in ["glass", "veil", "lamp"] {
        assert_eq!(of(name)["alphaMode"], "BLEND", "'{name}' is seen through");
    }
    let alpha = of("glass")["pbrMetallicRoughness"]["baseColorFactor"][3].as_f64();
    assert!(
        alpha.is_some_and(|a| (a - 0.1).abs() < 1e-6),
        "glass hides a tenth: {alpha:?}"
    );
    let texture = |name: &str| of(name)["pbrMetallicRoughness"]["baseColorTexture"].clone();
    assert!(
        texture("tiles")["extensions"]["KHR_texture_transform"]["rotation"]
            .as_f64()
            .is_some_and(|r| (r + 0.3).abs() < 1e-5),
        "the tiles are turned, clockwise as the extension counts: {}",
        texture("tiles")
    );
    assert!(texture("screen").is_object(), "a screen keeps its picture");
}

#[test]
fn files_of_an_older_layout_are_refused_in_words() {
    let mut bytes = lit(builtin::furnace_with(0.5, 1.0));
    let key = b"\"version\":7";
    let places: Vec<usize> = (0..bytes.len() - key.len())
        .filter(|&i| bytes[i..].starts_with(key))
        .collect();
    assert_eq!(places.len(), 1, "the layout's number");
    bytes[places[0] + key.len() - 1] = b'6';
    assert!(lit_glb::is_lit(&bytes), "it is still one of ours");
    let refused = lit_glb::read(&bytes).expect_err("its scene is laid out otherwise");
    let message = refused.to_string();
    assert!(
        message.contains("layout 6, this program reads 7")
            && message.contains("solve the scene again"),
        "{message}"
    );
}

#[test]
fn hardly_any_light_is_cut_off() {
    for name in ["cornell", "office", "two-rooms"] {
        let file = lit(builtin::scene(name).expect("it is built in"));
        let parts = Parts::of(name, &file);
        let exposure = parts.root["extras"]["hemicube"]["exposure"].as_f64();
        let exposure = exposure.expect("the exposure is kept");
        let (mut all, mut cut) = (0.0, 0.0);
        for primitive in parts.primitives().filter(|p| p["indices"].is_u64()) {
            let positions = parts.floats(&primitive["attributes"]["POSITION"]);
            let irradiance = parts.floats(&primitive["attributes"]["_IRRADIANCE"]);
            let (_, indices) = parts.accessor(&primitive["indices"]);
            for triangle in indices.chunks_exact(12) {
                let corners = [0, 4, 8].map(|at| word(triangle, at));
                let [a, b, c] = corners.map(|v| Vec3::from_slice(&positions[3 * v..]));
                let area = f64::from((b - a).cross(c - a).length() / 2.0);
                let above = corners.map(|v| {
                    let largest = Vec3::from_slice(&irradiance[3 * v..]).max_element();
                    exposure * f64::from(largest / PI) > 1.0
                });
                all += area;
                cut += area * above.iter().filter(|above| **above).count() as f64 / 3.0;
            }
        }
        assert!(
            cut <= 0.035 * all,
            "{name}: {:.1} % of the area is above 1",
            100.0 * cut / all
        );
    }
}

#[test]
fn the_ambient_estimate_is_only_shown() {
    let scene = builtin::scene("cornell").expect("it is built in");
    let unfinished = SolveOptions {
        tolerance: 0.3,
        ..Quality::Draft.into()
    };
    let solution = solved(scene, &unfinished);
    let ambient = ambient_irradiance(&solution);
    assert!(!ambient.is_black(), "there is light to come");
    let options = |ambient| LitGlbOptions {
        exposure: hemicube::raster::tonemap::Exposure::Ev(0.0),
        ambient,
        ..LitGlbOptions::default()
    };
    let written = |ambient| write(&solution, &options(ambient)).expect("it can be written");
    let (without, with) = (written(Rgb::BLACK), written(ambient));
    let (without, with) = (Parts::of("without", &without), Parts::of("with", &with));
    let gather = |parts: &Parts<'_>, attribute: &str| -> Vec<f32> {
        parts
            .primitives()
            .flat_map(|p| parts.floats(&p["attributes"][attribute]))
            .collect()
    };
    assert_eq!(
        gather(&without, "_IRRADIANCE"),
        gather(&with, "_IRRADIANCE"),
        "the stored irradiance is that of the solution"
    );
    let sum = |parts| gather(parts, "COLOR_0").iter().sum::<f32>();
    assert!(
        sum(&with) > 1.05 * sum(&without),
        "the colours show the estimate"
    );
}

/// Prints the errors and warnings of the .glb on standard input and ends with their number; 77 without the validator.
const VALIDATE: &str = r#"
let validator;
try {
  const folder = process.env.HEMICUBE_GLTF_VALIDATOR;
  validator = require(folder ? require.resolve("gltf-validator", { paths: [folder] }) : "gltf-validator");
} catch { process.exit(77); }
validator.validateBytes(new Uint8Array(require("fs").readFileSync(0))).then(report => {
  for (const m of report.issues.messages.filter(m => m.severity < 2))
    console.log(m.severity ? "warning" : "error", m.code, m.pointer, m.message);
  process.exit(Math.min(report.issues.numErrors + report.issues.numWarnings, 70));
}, e => { console.log(e); process.exit(71); });
"#;

#[test]
fn khronos_validator_finds_nothing() {
    for (name, file) in files() {
        let started = Command::new("node")
            .args(["-e", VALIDATE])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn();
        let Ok(mut node) = started else {
            eprintln!("skipped: there is no `node` to run Khronos' glTF validator with");
            return;
        };
        let mut input = node.stdin.take().expect("standard input is piped");
        // Without the validator the process ends before it has read anything.
        let sent = input.write_all(&file);
        drop(input);
        let output = node.wait_with_output().expect("node ends");
        if output.status.code() == Some(77) {
            eprintln!(
                "skipped: npm install gltf-validator, and name the folder in HEMICUBE_GLTF_VALIDATOR or NODE_PATH"
            );
            return;
        }
        sent.expect("the validator reads the file");
        assert!(
            output.status.success(),
            "{name}: {}",
            String::from_utf8_lossy(&output.stdout)
        );
    }
}
