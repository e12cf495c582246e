//! MTL files.

use super::parse::{LogicalLines, number_of, text, words};
use crate::gltf::uri;
use crate::open::one_line;
use crate::{
    AlphaMode, ImportReport, Material, Relief, ReliefKind, Scene, Texture, TextureImage,
    TextureSlot, Wrap,
};
use hemicube_raster::{Image, Rgb};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// How deep a bump map without `-bm` is, as a share of the picture's extent. The format leaves the unit open.
const DEPTH_OF_BUMPS: f32 = 0.01;

/// Reflectance of what has no colour in the file.
const GREY: Rgb = Rgb::splat(0.5);

/// Fills the scene's materials for the names that faces use.
pub fn read_all(
    names: &[Option<String>],
    libraries: &[String],
    folder: Option<&Path>,
    scene: &mut Scene,
) {
    let definitions = definitions(libraries, folder, &mut scene.report);
    let mut maps = Maps {
        folder,
        images: HashMap::new(),
        alphas: HashMap::new(),
    };
    for name in names {
        let material = match name {
            None => Material::diffuse("default", GREY),
            Some(name) => match definitions.get(name) {
                Some(definition) => material(name, definition, &mut maps, scene),
                None => {
                    scene.report.warn(
                        format!("material '{name}'"),
                        "no MTL file defines it; taken as grey 0.5",
                    );
                    Material::diffuse(name.as_str(), GREY)
                }
            },
        };
        scene.materials.push(material);
    }
}

/// A material as its MTL file states it.
#[derive(Debug, Default)]
struct Definition {
    diffuse: Option<Rgb>,
    emission: Option<Rgb>,
    filter: Option<Rgb>,
    opacity: Option<f32>,
    shininess: Option<f32>,
    roughness: Option<f32>,
    metallic: Option<f32>,
    illumination: Option<f32>,
    map_diffuse: Option<Map>,
    map_emission: Option<Map>,
    map_opacity: Option<Map>,
    map_roughness: Option<Map>,
    map_metallic: Option<Map>,
    map_normal: Option<Map>,
    map_height: Option<Map>,
}

/// A texture statement.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct Map {
    file: String,
    clamp: bool,
    /// `-bm`, in bits so that maps can be compared; 1 if it is not given.
    bump_multiplier: u32,
}

/// The materials of all libraries; of two with one name the later counts.
fn definitions(
    libraries: &[String],
    folder: Option<&Path>,
    report: &mut ImportReport,
) -> HashMap<String, Definition> {
    let mut definitions = HashMap::new();
    for library in libraries {
        // A name with spaces is one file to most programs, the format's text says several.
        let parts: Vec<&str> = library.split_whitespace().collect();
        let is_list = !exists(library, folder) && parts.iter().any(|part| exists(part, folder));
        let files = if is_list {
            parts
        } else {
            vec![library.as_str()]
        };
        for file in files {
            match read_beside(file, folder) {
                Ok(bytes) => parse(&bytes, &mut definitions, report),
                Err(what) => report.warn("mtllib", format!("{what}; its materials are grey 0.5")),
            }
        }
    }
    definitions
}

fn parse(bytes: &[u8], definitions: &mut HashMap<String, Definition>, report: &mut ImportReport) {
    let mut current: Option<(String, Definition)> = None;
    for (_, line) in LogicalLines::new(bytes) {
        let line = line.trim_ascii();
        let key = line
            .split(u8::is_ascii_whitespace)
            .next()
            .unwrap_or_default();
        let rest = &line[key.len()..];
        if key.eq_ignore_ascii_case(b"newmtl") {
            definitions.extend(current.replace((text(rest), Definition::default())));
        } else if let Some((name, definition)) = &mut current {
            statement(definition, key, rest, name, report);
        }
    }
    definitions.extend(current);
}

fn statement(to: &mut Definition, key: &[u8], rest: &[u8], name: &str, report: &mut ImportReport) {
    let color = |report: &mut ImportReport| {
        let color = color(rest);
        if color.is_none() {
            let key = text(key);
            report.warn(
                format!("material '{name}'"),
                format!("{key} is not three finite numbers; left out"),
            );
        }
        color
    };
    let number = || words(rest).map(number_of).find(|x| x.is_finite());
    match key.to_ascii_lowercase().as_slice() {
        b"kd" => to.diffuse = color(report).or(to.diffuse),
        b"ke" => to.emission = color(report).or(to.emission),
        b"tf" => to.filter = color(report).or(to.filter),
        b"d" => to.opacity = number(),
        b"tr" => to.opacity = number().map(|tr| 1.0 - tr),
        b"ns" => to.shininess = number(),
        b"pr" => to.roughness = number(),
        b"pm" => to.metallic = number(),
        b"illum" => to.illumination = number(),
        b"map_kd" => to.map_diffuse = map(rest),
        b"map_ke" => to.map_emission = map(rest),
        b"map_d" => to.map_opacity = map(rest),
        b"map_pr" => to.map_roughness = map(rest),
        b"map_pm" => to.map_metallic = map(rest),
        b"norm" | b"map_kn" => to.map_normal = map(rest),
        b"map_bump" | b"bump" => to.map_height = map(rest),
        _ => {}
    }
}

/// `r g b`, or one number for all; `spectral` and `xyz` colours are not read.
fn color(rest: &[u8]) -> Option<Rgb> {
    let values: Vec<f32> = words(rest).take(3).map(number_of).collect();
    match *values.as_slice() {
        [grey] => Some(Rgb::splat(grey)),
        [r, g, b] => Some(Rgb::new(r, g, b)),
        _ => None,
    }
    .filter(|color| color.is_finite())
}

/// A texture's options and its file, whose name may have spaces.
fn map(rest: &[u8]) -> Option<Map> {
    let line = text(rest);
    let mut rest = line.as_str();
    let (mut clamp, mut bump_multiplier) = (false, 1.0_f32);
    while rest.starts_with('-') {
        let (option, after) = rest.split_once(char::is_whitespace)?;
        let (mut numbers, words) = match option.to_ascii_lowercase().as_str() {
            "-o" | "-s" | "-t" => (3, 0),
            "-mm" => (2, 0),
            "-blendu" | "-blendv" | "-cc" | "-clamp" | "-imfchan" | "-type" | "-bm" | "-boost"
            | "-texres" => (0, 1),
            _ => (0, 0),
        };
        rest = after.trim_start();
        for _ in 0..words {
            let (word, after) = rest.split_once(char::is_whitespace)?;
            clamp |= option.eq_ignore_ascii_case("-clamp") && word == "on";
            if option.eq_ignore_ascii_case("-bm") {
                bump_multiplier = word.parse().unwrap_or(1.0);
            }
            rest = after.trim_start();
        }
        // The second and third number may be missing.
        while let Some((word, after)) = rest.split_once(char::is_whitespace)
            && numbers > 0
            && word.parse::<f32>().is_ok()
        {
            (rest, numbers) = (after.trim_start(), numbers - 1);
        }
    }
    (!rest.is_empty()).then(|| Map {
        file: String::from(rest),
        clamp,
        bump_multiplier: bump_multiplier.to_bits(),
    })
}

fn material(name: &str, from: &Definition, maps: &mut Maps<'_>, scene: &mut Scene) -> Material {
    let place = format!("material '{name}'");
    let mut clamped = |value: f32, key: &str| {
        let within = value.clamp(0.0, 1.0);
        if within != value {
            scene.report.warn(
                &place,
                format!("{key} {value} is not within 0 and 1; clamped"),
            );
        }
        within
    };
    let alpha = clamped(from.opacity.unwrap_or(1.0), "opacity");
    if alpha == 0.0 {
        scene.report.warn(
            &place,
            "its opacity (d, or 1 - Tr) is 0: it lets all light through",
        );
    }
    let default = if from.map_diffuse.is_some() {
        Rgb::WHITE
    } else {
        GREY
    };
    let base = from.diffuse.unwrap_or(default);
    let base_color = base.map(|band| band.clamp(0.0, 1.0));
    if base_color != base {
        scene.report.warn(
            &place,
            format!("Kd {:?} is not within 0 and 1; clamped", base.to_array()),
        );
    }
    let base_color_texture = maps.color_and_opacity(from, &place, scene);
    let default = if from.map_emission.is_some() {
        Rgb::WHITE
    } else {
        Rgb::BLACK
    };
    let emission = from.emission.unwrap_or(default);
    if emission.to_array().iter().any(|&band| band < 0.0) {
        scene.report.warn(
            &place,
            format!("Ke {:?} is negative; taken as 0 there", emission.to_array()),
        );
    }
    let has_opacity_map = from.map_opacity.is_some() && base_color_texture.is_some();
    Material {
        name: String::from(name),
        base_color,
        alpha,
        base_color_texture,
        metallic: metallic(from),
        metallic_texture: maps.optional(from.map_metallic.as_ref(), &place, scene),
        roughness: roughness(from),
        roughness_texture: maps.optional(from.map_roughness.as_ref(), &place, scene),
        relief: maps.relief(from, &place, scene),
        emission: emission.map(|band| band.max(0.0)),
        emission_texture: maps.optional(from.map_emission.as_ref(), &place, scene),
        transmission: transmission(from),
        alpha_mode: if alpha < 1.0 || has_opacity_map {
            AlphaMode::Blend
        } else {
            AlphaMode::Opaque
        },
        ..Material::default()
    }
}

/// `Pm`; its map alone is the share as it stands.
fn metallic(from: &Definition) -> f32 {
    let default = if from.map_metallic.is_some() {
        1.0
    } else {
        0.0
    };
    from.metallic.unwrap_or(default).clamp(0.0, 1.0)
}

/// `Pr` (its map alone is the roughness as it stands), or of Phong's exponent `sqrt(2 / (Ns + 2))` (Blinn-Phong to Beckmann: Walter et al. 2007).
fn roughness(from: &Definition) -> f32 {
    let of_shininess = || from.shininess.map(|ns| (2.0 / (ns.max(0.0) + 2.0)).sqrt());
    if from.map_roughness.is_some() && from.roughness.is_none() {
        return 1.0;
    }
    from.roughness
        .or_else(of_shininess)
        .unwrap_or(1.0)
        .clamp(0.0, 1.0)
}

/// Of the illumination models only 6 and 7 refract; elsewhere exporters write `Tf 1 1 1` for opaque surfaces.
fn transmission(from: &Definition) -> f32 {
    let is_glass = from
        .illumination
        .is_some_and(|illum| illum == 6.0 || illum == 7.0);
    match from.filter {
        Some(filter) if is_glass && from.opacity.is_none_or(|d| d >= 1.0) => {
            filter.luminance().clamp(0.0, 1.0)
        }
        _ => 0.0,
    }
}

/// Pictures, each read once.
struct Maps<'a> {
    folder: Option<&'a Path>,
    images: HashMap<String, Option<usize>>,
    /// Pictures put together of a colour map and an opacity map.
    alphas: HashMap<(Option<Map>, Map), Option<TextureSlot>>,
}

impl Maps<'_> {
    /// The texture of the base colour, with the opacity map as its alpha.
    fn color_and_opacity(
        &mut self,
        from: &Definition,
        place: &str,
        scene: &mut Scene,
    ) -> Option<TextureSlot> {
        let Some(opacity) = &from.map_opacity else {
            return from
                .map_diffuse
                .as_ref()
                .and_then(|map| self.slot(map, place, scene));
        };
        let key = (from.map_diffuse.clone(), opacity.clone());
        if let Some(&known) = self.alphas.get(&key) {
            return known;
        }
        let color = from
            .map_diffuse
            .as_ref()
            .and_then(|map| self.slot(map, place, scene));
        let slot = match self.image(&opacity.file, place, scene) {
            Some(opacity) => Some(with_opacity(color, opacity, scene)),
            None => color,
        };
        self.alphas.insert(key, slot);
        slot
    }

    /// `norm`, else `map_Bump`: many exporters write a map of normals there too, which its colours give away.
    fn relief(&mut self, from: &Definition, place: &str, scene: &mut Scene) -> Option<Relief> {
        let map = from.map_normal.as_ref().or(from.map_height.as_ref())?;
        let slot = self.slot(map, place, scene)?;
        let multiplier = f32::from_bits(map.bump_multiplier);
        let multiplier = if multiplier.is_finite() {
            multiplier
        } else {
            1.0
        };
        let image = &scene.images[scene.textures[slot.texture].image];
        let kind = if from.map_normal.is_some() || holds_normals(image) {
            ReliefKind::Normal { scale: multiplier }
        } else {
            let depth = DEPTH_OF_BUMPS * multiplier;
            ReliefKind::Height { depth }
        };
        Some(Relief { slot, kind })
    }

    fn optional(
        &mut self,
        map: Option<&Map>,
        place: &str,
        scene: &mut Scene,
    ) -> Option<TextureSlot> {
        self.slot(map?, place, scene)
    }

    fn slot(&mut self, map: &Map, place: &str, scene: &mut Scene) -> Option<TextureSlot> {
        let image = self.image(&map.file, place, scene)?;
        let wrap = if map.clamp {
            Wrap::ClampToEdge
        } else {
            Wrap::Repeat
        };
        scene.textures.push(Texture::new(image, [wrap; 2]));
        Some(TextureSlot::new(scene.textures.len() - 1))
    }

    fn image(&mut self, file: &str, place: &str, scene: &mut Scene) -> Option<usize> {
        if let Some(&known) = self.images.get(file) {
            return known;
        }
        let read = read_beside(file, self.folder).and_then(|bytes| {
            TextureImage::decode(file, bytes)
                .map_err(|what| format!("'{file}': {}", one_line(&what)))
        });
        let image = match read {
            Ok(image) => {
                scene.images.push(image);
                Some(scene.images.len() - 1)
            }
            Err(what) => {
                scene
                    .report
                    .warn(place, format!("{what}; left out, the factor alone counts"));
                None
            }
        };
        self.images.insert(String::from(file), image);
        image
    }
}

/// Whether a picture's mean colour is that of normals, near (0.5, 0.5, 1), and not grey.
fn holds_normals(image: &TextureImage) -> bool {
    let pixels = image.pixels().pixels();
    let sum = pixels.iter().fold([0_u64; 3], |sum, p| {
        core::array::from_fn(|k| sum[k] + u64::from(p[k]))
    });
    let [r, g, b] = sum.map(|s| s / (pixels.len() as u64).max(1));
    b > 170 && b > r + 40 && b > g + 40
}

/// A new picture of the opacity map's size: colour of the one, opacity of the other (its alpha if it has any, else red).
fn with_opacity(color: Option<TextureSlot>, opacity: usize, scene: &mut Scene) -> TextureSlot {
    let color = color.map(|slot| scene.textures[slot.texture]);
    let mask = scene.images[opacity].pixels();
    let (width, height) = (mask.width(), mask.height());
    let has_alpha = mask.pixels().iter().any(|p| p[3] < 255);
    let channel = if has_alpha { 3 } else { 0 };
    let color_image = color.map(|texture| scene.images[texture.image].pixels());
    let pixel = |x: usize, y: usize| {
        let [r, g, b, _] = color_image.map_or([255; 4], |image| {
            *image.pixel(x * image.width() / width, y * image.height() / height)
        });
        [r, g, b, mask.pixel(x, y)[channel]]
    };
    let pixels = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| pixel(x, y))
        .collect();
    let pixels =
        Image::from_pixels(width, height, pixels).expect("as many pixels as its sides say");
    let image = TextureImage::from_pixels(
        format!("{} with opacity", scene.images[opacity].name),
        pixels,
    );
    scene.images.push(image);
    let wrap = color.map_or([Wrap::Repeat; 2], |texture| texture.wrap);
    let image = scene.images.len() - 1;
    scene.textures.push(Texture::new(image, wrap));
    TextureSlot::new(scene.textures.len() - 1)
}

/// The bytes of a file beside the OBJ file; of an absolute path its last part is looked for there.
fn read_beside(name: &str, folder: Option<&Path>) -> Result<Vec<u8>, String> {
    let path = path_beside(name, folder)?;
    uri::read(&path).map_err(|e| uri::unread(name, &e))
}

fn exists(name: &str, folder: Option<&Path>) -> bool {
    path_beside(name, folder).is_ok_and(|path| path.is_file())
}

fn path_beside(name: &str, folder: Option<&Path>) -> Result<PathBuf, String> {
    if uri::has_scheme(name) || name.starts_with(['/', '\\']) {
        return uri::relative(name.rsplit(['/', '\\']).next().unwrap_or_default(), folder);
    }
    uri::relative(name, folder)
}
