//! The lit `.glb`: looks lit in any viewer, and holds everything needed to go on from it.
//!
//! Every primitive is unlit (`KHR_materials_unlit`) with the base colour and texture kept and `COLOR_0` = exposure × H/π
//! clamped to [0, 1], so their product is the reflected light and no albedo counts twice. Emitters are primitives of
//! their own whose colour is their tone-mapped light; one whose light a texture says (a screen) keeps that texture.
//! `_IRRADIANCE` is the solution's irradiance in full precision, without any estimate. The scene, the mesh's options
//! and the solution's arrays lie in a buffer view of ours, found through `extras.hemicube`, and in another one which
//! elements were cut, if some were; from them the same mesh is built again, so a solution continues exactly.

use crate::drawn::{DrawnMesh, DrawnPart};
use crate::error::RadiosityError;
use crate::patch::{PatchMesh, PatchOptions};
use crate::solution::{BANDS, Solution, SolutionData};
use crate::stop::NEVER;
use core::f32::consts::PI;
use glam::{Mat3, Quat, Vec3};
use hemicube_raster::Rgb;
use hemicube_raster::tonemap::{Exposure, ToneMap};
use hemicube_scene::gltf::container;
use hemicube_scene::{
    AlphaMode, Camera, Magnify, Material, MetalsAs, Minify, Projection, Scene, TextureImage,
    TextureSlot, Wrap,
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::io::{self, Write};
use std::sync::Arc;

/// Layout of the buffer view of ours; another number is another layout.
const VERSION: u64 = 7;

/// How a lit `.glb` is written.
#[derive(Debug, Clone)]
pub struct LitGlbOptions {
    /// Exposure of the stored colours. Default value: automatic, and then so low that hardly any light is cut off.
    pub exposure: Exposure,
    /// Tone map of the emitters' colours. Default value: Reinhard.
    pub tone_map: ToneMap,
    /// Added to the irradiance that the colours show, not to the one that is stored (an ambient estimate). Default
    /// value: black.
    pub ambient: Rgb,
    /// Report kept in `extras.hemicube.report`. Default value: null.
    pub report: Value,
}

impl Default for LitGlbOptions {
    fn default() -> Self {
        Self {
            exposure: Exposure::Auto,
            tone_map: ToneMap::Reinhard,
            ambient: Rgb::BLACK,
            report: Value::Null,
        }
    }
}

/// What is needed to build the same mesh and go on with the same solution.
#[derive(Serialize, Deserialize)]
struct State<'a> {
    scene: Cow<'a, Scene>,
    mesh: PatchOptions,
    solution: SolutionData<'a>,
}

/// A lit `.glb` ready to be written, in pieces: at a million elements a copy of it would be the largest thing in memory.
#[derive(Debug)]
pub struct LitGlb {
    /// Up to the first byte of the binary chunk.
    head: Vec<u8>,
    /// The views of the binary chunk, each of whole words.
    views: Vec<Vec<u8>>,
}

impl LitGlb {
    /// The file of a solution.
    ///
    /// # Errors
    /// A file of 4 GiB or more, which the format cannot hold.
    pub fn new(solution: &Solution, options: &LitGlbOptions) -> Result<Self, RadiosityError> {
        let mut file = Builder::default();
        let scene = solution.mesh().scene();
        let exposure = exposure_factor(solution, options);
        let look = Look {
            exposure,
            tone_map: options.tone_map,
            ambient: options.ambient,
        };
        file.images(scene);
        file.primitives(solution, &DrawnMesh::new(solution, Rgb::BLACK), look);
        file.cameras(scene);
        let view = file.own_view(stored(solution)?, None);
        let mut own = json!({ "version": VERSION, "state": view, "exposure": exposure, "report": options.report });
        let refinement = solution.mesh().refinement();
        if !refinement.is_empty() {
            let refinement = postcard::to_stdvec(refinement)
                .map_err(|e| RadiosityError::File(format!("storing the mesh: {e}")))?;
            own["refinement"] = json!(file.own_view(refinement, None));
        }
        file.root
            .insert(String::from("extras"), json!({ "hemicube": own }));
        file.finish()
    }

    /// Writes it.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_to(&self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(&self.head)?;
        self.views.iter().try_for_each(|view| out.write_all(view))
    }
}

/// The bytes of a lit `.glb`.
///
/// # Errors
/// As [`LitGlb::new`].
pub fn write(solution: &Solution, options: &LitGlbOptions) -> Result<Vec<u8>, RadiosityError> {
    let LitGlb { head, views } = LitGlb::new(solution, options)?;
    let rest = views.into_iter().flatten();
    Ok(head.into_iter().chain(rest).collect())
}

/// What is needed to go on with a solution.
fn stored(solution: &Solution) -> Result<Vec<u8>, RadiosityError> {
    let mesh = solution.mesh();
    let state = State {
        scene: Cow::Borrowed(mesh.scene()),
        mesh: mesh.options(),
        solution: solution.data(),
    };
    // Three arrays of f32; beyond that the scene, which is small next to them where size matters.
    let values = 3 * BANDS * solution.groups().len() * mesh.elements().len();
    let bytes = Vec::with_capacity(4 * values + (1 << 16));
    postcard::to_extend(&state, bytes)
        .map_err(|e| RadiosityError::File(format!("storing the solution: {e}")))
}

/// The exposure of the stored colours.
///
/// An automatic one is lowered until at most [`CUT_SHARE`] of the area that reflects has a band of exposure × H/π
/// above 1: no tone curve comes after it, so whatever is above is lost.
fn exposure_factor(solution: &Solution, options: &LitGlbOptions) -> f32 {
    let mesh = solution.mesh();
    let irradiance = |e: usize| solution.element_irradiance(e) + options.ambient;
    let elements = || 0..mesh.elements().len();
    let factor = options
        .exposure
        .factor(elements().map(|e| (mesh.reflectance()[e] * irradiance(e) / PI).luminance()));
    if options.exposure != Exposure::Auto {
        return factor;
    }
    let mut lit: Vec<(f32, f64)> = elements()
        .filter(|&e| mesh.emission()[e].is_black() && !mesh.reflectance()[e].is_black())
        .map(|e| {
            let area = f64::from(mesh.exposed_area(e));
            (irradiance(e).max_band() / PI, area)
        })
        .filter(|(light, _)| light.is_finite())
        .collect();
    lit.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    let mut left = CUT_SHARE * lit.iter().map(|(_, area)| area).sum::<f64>();
    let brightest_kept = lit.iter().find(|(_, area)| {
        left -= area;
        left < 0.0
    });
    match brightest_kept {
        Some(&(light, _)) if light * factor > 1.0 => light.recip(),
        _ => factor,
    }
}

/// Share of the reflecting area whose light may be cut off at 1.
const CUT_SHARE: f64 = 0.02;

/// How light becomes the stored colours.
#[derive(Clone, Copy)]
struct Look {
    exposure: f32,
    tone_map: ToneMap,
    ambient: Rgb,
}

/// Collects the parts of the file.
#[derive(Default)]
struct Builder {
    binary: Vec<Vec<u8>>,
    /// Bytes of those.
    length: usize,
    views: Vec<Value>,
    accessors: Vec<Value>,
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    samplers: Vec<Value>,
    textures: Vec<Value>,
    /// For each of the scene's textures the one in the file.
    texture_of: Vec<Option<usize>>,
    transforms_used: bool,
    root: Map<String, Value>,
}

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

impl Builder {
    /// A buffer view over a copy of some bytes.
    fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        let mut copy = Vec::with_capacity(bytes.len().next_multiple_of(4));
        copy.extend_from_slice(bytes);
        self.own_view(copy, target)
    }

    /// A buffer view over some bytes.
    fn own_view(&mut self, mut bytes: Vec<u8>, target: Option<u32>) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.length, "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        self.length += bytes.len();
        self.binary.push(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    /// An accessor over floats, `width` a vertex.
    fn floats(&mut self, values: &[f32], width: usize, bounds: bool) -> usize {
        let view = self.view(bytemuck::cast_slice(values), Some(ARRAY_BUFFER));
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][width - 1];
        let mut accessor = json!({ "bufferView": view, "componentType": 5126, "count": values.len() / width, "type": kind });
        if bounds {
            let extreme = |of: fn(f32, f32) -> f32, start: f32| -> Vec<f32> {
                (0..width)
                    .map(|k| {
                        values
                            .iter()
                            .skip(k)
                            .step_by(width)
                            .copied()
                            .fold(start, of)
                    })
                    .collect()
            };
            accessor["min"] = json!(extreme(f32::min, f32::INFINITY));
            accessor["max"] = json!(extreme(f32::max, f32::NEG_INFINITY));
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn indices(&mut self, triangles: &[[u32; 3]]) -> usize {
        let view = self.view(bytemuck::cast_slice(triangles), Some(ELEMENT_ARRAY_BUFFER));
        self.accessors.push(
            json!({ "bufferView": view, "componentType": 5125, "count": triangles.len() * 3, "type": "SCALAR" }),
        );
        self.accessors.len() - 1
    }

    fn images(&mut self, scene: &Scene) {
        self.texture_of = vec![None; scene.textures.len()];
        if scene.images.is_empty() {
            return;
        }
        let images: Vec<Value> = scene
            .images
            .iter()
            .map(|image| {
                let view = self.view(&without_color_space(image.encoded()), None);
                json!({ "name": image.name, "bufferView": view, "mimeType": image.media_type() })
            })
            .collect();
        self.root.insert(String::from("images"), json!(images));
    }

    /// One node and mesh for each instance, one primitive for each of its materials.
    fn primitives(&mut self, solution: &Solution, drawn: &DrawnMesh, look: Look) {
        let scene = solution.mesh().scene().clone();
        let mut materials = vec![[None; 2]; scene.materials.len()];
        let mut start = 0;
        while start < drawn.parts.len() {
            let instance = drawn.parts[start].instance;
            let end = start
                + drawn.parts[start..]
                    .iter()
                    .take_while(|p| p.instance == instance)
                    .count();
            let mut primitives = Vec::new();
            for whole in &drawn.parts[start..end] {
                for (kind, part) in [false, true].into_iter().zip(by_emission(solution, whole)) {
                    if part.triangles.is_empty() {
                        continue;
                    }
                    let source = &scene.materials[part.material];
                    let material = *materials[part.material][usize::from(kind)]
                        .get_or_insert_with(|| self.material(&scene, source, kind));
                    primitives.push(if kind {
                        self.emitter_primitive(solution, drawn, &part, material, look)
                    } else {
                        self.primitive(solution, drawn, &part, material, look)
                    });
                }
            }
            self.meshes
                .push(json!({ "name": scene.instances[instance].node, "primitives": primitives }));
            self.nodes.push(
                json!({ "name": scene.instances[instance].node, "mesh": self.meshes.len() - 1 }),
            );
            start = end;
        }
    }

    /// The unlit twin of a material, for its triangles that emit or for those that do not.
    fn material(&mut self, scene: &Scene, material: &Material, emitting: bool) -> usize {
        let mut look = json!({ "metallicFactor": 0.0, "roughnessFactor": 1.0 });
        let mut mode = material.alpha_mode;
        if emitting {
            // Light and opacity are in the colours of the vertices.
            mode = if material.may_transmit() {
                AlphaMode::Blend
            } else {
                AlphaMode::Opaque
            };
            if let Some(slot) = material.emission_texture {
                look["baseColorTexture"] = self.texture(scene, slot);
            }
        } else {
            let shown = if scene.metals == MetalsAs::Black {
                1.0 - material.metallic
            } else {
                1.0
            };
            let [r, g, b] = material
                .base_color
                .map(|c| (c * shown).clamp(0.0, 1.0))
                .to_array();
            let opaque = 1.0 - material.transmission * (1.0 - material.metallic);
            let alpha = if mode == AlphaMode::Opaque {
                opaque
            } else {
                material.alpha * opaque
            };
            look["baseColorFactor"] = json!([r, g, b, alpha.clamp(0.0, 1.0)]);
            if let Some(slot) = material.base_color_texture {
                look["baseColorTexture"] = self.texture(scene, slot);
            }
            if mode == AlphaMode::Opaque && opaque < 1.0 {
                mode = AlphaMode::Blend;
            }
        }
        let mut out = json!({
            "name": material.name,
            "pbrMetallicRoughness": look,
            "extensions": { "KHR_materials_unlit": {} },
        });
        match mode {
            AlphaMode::Mask { cutoff } => {
                out["alphaMode"] = json!("MASK");
                out["alphaCutoff"] = json!(cutoff.max(0.0));
            }
            AlphaMode::Blend => out["alphaMode"] = json!("BLEND"),
            AlphaMode::Opaque => {}
        }
        self.materials.push(out);
        self.materials.len() - 1
    }

    fn texture(&mut self, scene: &Scene, slot: TextureSlot) -> Value {
        let index = self.texture_of[slot.texture].unwrap_or_else(|| {
            let texture = scene.textures[slot.texture];
            let sampler = json!({ "wrapS": wrap_code(texture.wrap[0]), "wrapT": wrap_code(texture.wrap[1]),
                "magFilter": magnify_code(texture.magnify), "minFilter": minify_code(texture.minify) });
            let known = self.samplers.iter().position(|s| *s == sampler);
            let sampler = known.unwrap_or_else(|| {
                self.samplers.push(sampler);
                self.samplers.len() - 1
            });
            self.textures
                .push(json!({ "source": texture.image, "sampler": sampler }));
            self.textures.len() - 1
        });
        self.texture_of[slot.texture] = Some(index);
        let mut texture = json!({ "index": index });
        if slot.transform != glam::Affine2::IDENTITY {
            self.transforms_used = true;
            let (scale, angle, offset) = slot.transform.to_scale_angle_translation();
            texture["extensions"] = json!({ "KHR_texture_transform": {
                "offset": offset.to_array(), "rotation": -angle, "scale": scale.to_array() } });
        }
        texture
    }

    fn primitive(
        &mut self,
        solution: &Solution,
        drawn: &DrawnMesh,
        part: &DrawnPart,
        material: usize,
        look: Look,
    ) -> Value {
        let source = &solution.mesh().scene().materials[part.material];
        let (vertices, triangles) = own_vertices(part);
        let mut attributes = Map::new();
        let mut insert = |name: &str, accessor: usize| {
            attributes.insert(String::from(name), json!(accessor));
        };
        let gather = |f: &dyn Fn(usize) -> [f32; 3]| -> Vec<f32> {
            vertices.iter().flat_map(|&v| f(v as usize)).collect()
        };
        let positions = gather(&|v| drawn.positions[v].to_array());
        insert("POSITION", self.floats(&positions, 3, true));
        let color = |v: usize| {
            let light = (drawn.irradiance[v] + look.ambient) * (look.exposure / PI);
            let own = drawn.colors[v];
            (light.map(|c| c.clamp(0.0, 1.0)) * Rgb::new(own.x, own.y, own.z))
                .map(|c| c.clamp(0.0, 1.0))
                .to_array()
        };
        let alphas = source.alpha_mode != AlphaMode::Opaque
            && vertices.iter().any(|&v| drawn.colors[v as usize].w != 1.0);
        let colors = if alphas {
            let with_alpha = vertices.iter().flat_map(|&v| {
                let [r, g, b] = color(v as usize);
                [r, g, b, drawn.colors[v as usize].w.clamp(0.0, 1.0)]
            });
            self.floats(&with_alpha.collect::<Vec<_>>(), 4, false)
        } else {
            self.floats(&gather(&color), 3, false)
        };
        insert("COLOR_0", colors);
        if let Some(slot) = source.base_color_texture {
            let vertices = vertices.iter().map(|&v| v as usize);
            insert("TEXCOORD_0", self.texcoords(drawn, slot, vertices));
        }
        let irradiance = gather(&|v| drawn.irradiance[v].to_array());
        insert("_IRRADIANCE", self.floats(&irradiance, 3, false));
        json!({ "attributes": attributes, "indices": self.indices(&triangles), "material": material })
    }

    /// Triangles that emit. Their light differs from triangle to triangle, so each has vertices of its own.
    fn emitter_primitive(
        &mut self,
        solution: &Solution,
        drawn: &DrawnMesh,
        part: &DrawnPart,
        material: usize,
        look: Look,
    ) -> Value {
        let source = &solution.mesh().scene().materials[part.material];
        let corners = || part.triangles.iter().flatten().map(|&v| v as usize);
        let positions: Vec<f32> = corners()
            .flat_map(|v| drawn.positions[v].to_array())
            .collect();
        let irradiance: Vec<f32> = corners()
            .flat_map(|v| drawn.irradiance[v].to_array())
            .collect();
        let colors = emitter_colors(solution, drawn, part, look);
        let colors = if source.may_transmit() {
            self.floats(colors.as_flattened(), 4, false)
        } else {
            let opaque: Vec<f32> = colors.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
            self.floats(&opaque, 3, false)
        };
        let mut attributes = json!({
            "POSITION": self.floats(&positions, 3, true),
            "COLOR_0": colors,
            "_IRRADIANCE": self.floats(&irradiance, 3, false),
        });
        if let Some(slot) = source.emission_texture {
            attributes["TEXCOORD_0"] = json!(self.texcoords(drawn, slot, corners()));
        }
        json!({ "attributes": attributes, "material": material })
    }

    /// The coordinates that a texture uses.
    fn texcoords(
        &mut self,
        drawn: &DrawnMesh,
        slot: TextureSlot,
        vertices: impl Iterator<Item = usize>,
    ) -> usize {
        let set = slot.texcoord_set.min(1);
        let values: Vec<f32> = vertices
            .flat_map(|v| drawn.texcoords[v][set].to_array())
            .collect();
        self.floats(&values, 2, false)
    }

    fn cameras(&mut self, scene: &Scene) {
        let bounds = scene.bounds().unwrap_or((Vec3::ZERO, Vec3::ONE));
        let mut cameras = Vec::new();
        for camera in &scene.cameras {
            let Some(described) = camera_json(camera, bounds) else {
                continue;
            };
            let rotation = Mat3::from_cols(camera.right(), camera.up, -camera.forward);
            let rotation = Quat::from_mat3(&rotation).normalize();
            self.nodes.push(json!({
                "name": camera.name, "camera": cameras.len(),
                "translation": camera.eye.to_array(), "rotation": rotation.to_array(),
            }));
            cameras.push(described);
        }
        if !cameras.is_empty() {
            self.root.insert(String::from("cameras"), json!(cameras));
        }
    }

    fn finish(mut self) -> Result<LitGlb, RadiosityError> {
        let mut used = vec!["KHR_materials_unlit"];
        if self.transforms_used {
            used.push("KHR_texture_transform");
        }
        let root = &mut self.root;
        let generator = concat!("hemicube ", env!("CARGO_PKG_VERSION"));
        root.insert(
            String::from("asset"),
            json!({ "version": "2.0", "generator": generator }),
        );
        root.insert(String::from("extensionsUsed"), json!(used));
        root.insert(String::from("scene"), json!(0));
        root.insert(
            String::from("scenes"),
            json!([{ "nodes": (0..self.nodes.len()).collect::<Vec<_>>() }]),
        );
        root.insert(String::from("nodes"), json!(self.nodes));
        root.insert(String::from("meshes"), json!(self.meshes));
        root.insert(String::from("materials"), json!(self.materials));
        if !self.textures.is_empty() {
            root.insert(String::from("samplers"), json!(self.samplers));
            root.insert(String::from("textures"), json!(self.textures));
        }
        root.insert(String::from("accessors"), json!(self.accessors));
        root.insert(String::from("bufferViews"), json!(self.views));
        root.insert(
            String::from("buffers"),
            json!([{ "byteLength": self.length }]),
        );
        let mut text = Value::Object(self.root).to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + text.len() + 8 + self.length;
        let too_large = || {
            RadiosityError::File(format!(
                "the lit .glb would have {length} bytes, the format holds 4 GiB; use fewer elements"
            ))
        };
        let word = |n: usize| {
            u32::try_from(n)
                .map(u32::to_le_bytes)
                .map_err(|_| too_large())
        };
        let mut out = Vec::with_capacity(28 + text.len());
        out.extend_from_slice(b"glTF");
        out.extend_from_slice(&2_u32.to_le_bytes());
        out.extend_from_slice(&word(length)?);
        out.extend_from_slice(&word(text.len())?);
        out.extend_from_slice(b"JSON");
        out.extend_from_slice(&text);
        out.extend_from_slice(&word(self.length)?);
        out.extend_from_slice(b"BIN\0");
        Ok(LitGlb {
            head: out,
            views: self.binary,
        })
    }
}

/// The vertices that a part uses, in the order of first use, and its triangles over them.
fn own_vertices(part: &DrawnPart) -> (Vec<u32>, Vec<[u32; 3]>) {
    let mut local = std::collections::HashMap::new();
    let mut vertices = Vec::new();
    let triangles = part
        .triangles
        .iter()
        .map(|triangle| {
            triangle.map(|v| {
                *local.entry(v).or_insert_with(|| {
                    vertices.push(v);
                    crate::index32(vertices.len() - 1)
                })
            })
        })
        .collect();
    (vertices, triangles)
}

/// The triangles of a part that reflect, and those that are shown as emitters: where a texture makes a lamp, those
/// that emit more than they reflect.
fn by_emission(solution: &Solution, part: &DrawnPart) -> [DrawnPart; 2] {
    let mesh = solution.mesh();
    let textured = mesh.scene().materials[part.material]
        .emission_texture
        .is_some();
    let mut split = [(); 2].map(|()| DrawnPart {
        triangles: Vec::new(),
        elements: Vec::new(),
        ..*part
    });
    for (&triangle, &element) in part.triangles.iter().zip(&part.elements) {
        let e = element as usize;
        let reflected = mesh.reflectance()[e] * solution.element_irradiance(e);
        let emits = !mesh.emission()[e].is_black()
            && (!textured || solution.element_exitance(e).luminance() > reflected.luminance());
        let to = &mut split[usize::from(emits)];
        to.triangles.push(triangle);
        to.elements.push(element);
    }
    split
}

/// Tone-mapped light and opacity of emitters, for each corner of each triangle. Where a texture says what is emitted
/// it is the light of its white, which the texture then multiplies.
fn emitter_colors(
    solution: &Solution,
    drawn: &DrawnMesh,
    part: &DrawnPart,
    look: Look,
) -> Vec<[f32; 4]> {
    let mesh = solution.mesh();
    let source = &mesh.scene().materials[part.material];
    let corners = part
        .triangles
        .iter()
        .zip(&part.elements)
        .flat_map(|(t, &e)| t.map(|v| (v as usize, e as usize)));
    corners
        .map(|(v, e)| {
            let exitance = solution.element_exitance(e);
            // A viewer multiplies by the opacity, which is in the element's light already.
            let opacity = (1.0 - mesh.transmittance()[e].luminance()).clamp(0.01, 1.0);
            let radiance = if source.emission_texture.is_some() {
                source.emission * dimmed(exitance, mesh.emission()[e])
            } else {
                let reflected = mesh.reflectance()[e] * (drawn.irradiance[v] + look.ambient);
                (exitance + reflected) / (PI * opacity)
            };
            let [r, g, b] = look
                .tone_map
                .apply(radiance, look.exposure)
                .map(|c| c.clamp(0.0, 1.0))
                .to_array();
            [r, g, b, opacity]
        })
        .collect()
}

/// What dimming left of an emission, per band.
fn dimmed(exitance: Rgb, emission: Rgb) -> Rgb {
    let band = |i: usize| {
        if emission[i] > 0.0 {
            exitance[i] / emission[i]
        } else {
            1.0
        }
    };
    Rgb::new(band(0), band(1), band(2))
}

/// A camera whose depths hold the scene's bounds; none for projections that glTF does not know.
fn camera_json(camera: &Camera, (low, high): (Vec3, Vec3)) -> Option<Value> {
    let size = low.distance(high).max(1e-3);
    let farthest = camera.eye.distance((low + high) * 0.5) + size;
    let described = match camera.projection {
        Projection::Perspective {
            vertical_fov,
            aspect,
        } => {
            let mut perspective =
                json!({ "yfov": vertical_fov, "znear": size * 1e-3, "zfar": farthest });
            if let Some(aspect) = aspect.filter(|a| *a > 0.0) {
                perspective["aspectRatio"] = json!(aspect);
            }
            json!({ "type": "perspective", "name": camera.name, "perspective": perspective })
        }
        Projection::Orthographic {
            half_width,
            half_height,
        } => json!({
            "type": "orthographic", "name": camera.name,
            "orthographic": { "xmag": half_width, "ymag": half_height, "znear": 0.0, "zfar": farthest },
        }),
        Projection::Panorama | Projection::Fisheye { .. } => return None,
    };
    Some(described)
}

/// A PNG file without the chunks by which some viewers, against the glTF specification, would change its colours or
/// proportions, and without those of an animation; any other file as it is.
fn without_color_space(file: &[u8]) -> Cow<'_, [u8]> {
    const LEFT_OUT: [&[u8]; 8] = [
        b"gAMA", b"cHRM", b"iCCP", b"cICP", b"pHYs", b"acTL", b"fcTL", b"fdAT",
    ];
    let Some((signature, mut rest)) = file.split_at_checked(8) else {
        return Cow::Borrowed(file);
    };
    if signature != b"\x89PNG\r\n\x1a\n" {
        return Cow::Borrowed(file);
    }
    let mut kept = signature.to_vec();
    while let Some((length, after)) = rest.split_first_chunk::<4>() {
        // Length, name, data, checksum.
        let whole = usize::try_from(u32::from_be_bytes(*length))
            .map_or(usize::MAX, |n| n.saturating_add(12));
        let (Some(chunk), Some(name)) = (rest.get(..whole), after.get(..4)) else {
            return Cow::Borrowed(file);
        };
        if !LEFT_OUT.contains(&name) {
            kept.extend_from_slice(chunk);
        }
        rest = &rest[whole..];
    }
    Cow::Owned(kept)
}

fn wrap_code(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => 10497,
        Wrap::MirroredRepeat => 33648,
        Wrap::ClampToEdge => 33071,
    }
}

fn magnify_code(magnify: Magnify) -> u32 {
    match magnify {
        Magnify::Nearest => 9728,
        Magnify::Linear => 9729,
    }
}

fn minify_code(minify: Minify) -> u32 {
    match minify {
        Minify::Nearest => 9728,
        Minify::Linear => 9729,
        Minify::Mipmap => 9987,
    }
}

/// Whether a file is a lit `.glb` of ours, that is, [`read`] is worth trying.
pub fn is_lit(bytes: &[u8]) -> bool {
    bytes.starts_with(b"glTF")
        && document(bytes).is_ok_and(|(root, _)| root["extras"]["hemicube"]["state"].is_u64())
}

/// The solution that a lit `.glb` holds, on the same mesh as when it was written.
///
/// # Errors
/// A file without our state, of another version, or damaged; the message is one line without the file's name.
pub fn read(bytes: &[u8]) -> Result<Solution, RadiosityError> {
    let damaged = |what: &str| RadiosityError::File(format!("{what}; solve the scene again"));
    let (root, binary) = document(bytes).map_err(|e| damaged(&e))?;
    let own = &root["extras"]["hemicube"];
    match own["version"].as_u64() {
        Some(VERSION) => {}
        Some(other) => {
            return Err(damaged(&format!(
                "its solution has layout {other}, this program reads {VERSION}"
            )));
        }
        None => return Err(damaged("it holds no solution")),
    }
    let state = view_bytes(&root, binary, own["state"].as_u64())
        .ok_or_else(|| damaged("its solution is cut off"))?;
    let state: State<'_> = postcard::from_bytes(state)
        .map_err(|e| damaged(&format!("its solution is damaged ({e})")))?;
    let mut scene = state.scene.into_owned();
    for (i, image) in root["images"].as_array().into_iter().flatten().enumerate() {
        let bytes = view_bytes(&root, binary, image["bufferView"].as_u64())
            .ok_or_else(|| damaged(&format!("image {i} is cut off")))?;
        let name = image["name"].as_str().unwrap_or_default();
        let decoded = TextureImage::decode(name, bytes.to_vec())
            .map_err(|e| damaged(&format!("image {i}: {e}")))?;
        scene.images.push(decoded);
    }
    let mut mesh = PatchMesh::build(Arc::new(scene), state.mesh)?;
    if !own["refinement"].is_null() {
        let bytes = view_bytes(&root, binary, own["refinement"].as_u64())
            .ok_or_else(|| damaged("its mesh is cut off"))?;
        let refinement = postcard::from_bytes(bytes)
            .map_err(|e| damaged(&format!("its mesh is damaged ({e})")))?;
        mesh = mesh
            .with_refinement(&refinement, NEVER)
            .map_err(|e| damaged(&e.to_string()))?;
    }
    Solution::from_data(Arc::new(mesh), state.solution).map_err(|e| damaged(&e))
}

/// The JSON and the binary chunk of a `.glb`.
fn document(bytes: &[u8]) -> Result<(Value, &[u8]), String> {
    let parts = container::split(bytes).map_err(|_| String::from("it is not a whole .glb"))?;
    let root: Value =
        serde_json::from_slice(parts.json).map_err(|e| format!("its JSON is damaged ({e})"))?;
    Ok((root, parts.binary.unwrap_or_default()))
}

fn view_bytes<'a>(root: &Value, binary: &'a [u8], view: Option<u64>) -> Option<&'a [u8]> {
    let view = root["bufferViews"].get(usize::try_from(view?).ok()?)?;
    let start = usize::try_from(view["byteOffset"].as_u64().unwrap_or(0)).ok()?;
    let length = usize::try_from(view["byteLength"].as_u64()?).ok()?;
    binary.get(start..start.checked_add(length)?)
}
