//! Materials.

use super::extension::{self, EmissiveStrength, SpecularGlossiness, TextureInfo, Transmission};
use super::texture::Textures;
use super::{Source, name_or};
use crate::{AlphaMode, ImportReport, Material, Relief, ReliefKind, Scene};
use gltf::json;
use gltf::json::validation::Checked;
use hemicube_raster::Rgb;

/// Fills the scene's materials, in the order of the file.
pub fn read_all(source: Source<'_>, scene: &mut Scene) {
    let mut textures = Textures::new(source);
    for (i, material) in source.root.materials.iter().enumerate() {
        let material = read(
            material,
            name_or(material.name.as_ref(), "material", i),
            &mut textures,
            scene,
        );
        scene.materials.push(material);
    }
}

/// The material of a primitive that names none: that of the specification (white, metallic 1).
pub fn default_material() -> Material {
    Material {
        metallic: 1.0,
        ..Material::default()
    }
}

fn read(
    from: &json::Material,
    name: String,
    textures: &mut Textures<'_>,
    scene: &mut Scene,
) -> Material {
    let place = format!("material '{name}'");
    let others = from.extensions.as_ref().map(|e| &e.others);
    let mut material = Material {
        name,
        double_sided: from.double_sided,
        ..Material::default()
    };
    read_metallic_roughness(
        &from.pbr_metallic_roughness,
        &place,
        &mut material,
        textures,
        scene,
    );
    let glossy = extension::read(
        others,
        "KHR_materials_pbrSpecularGlossiness",
        &place,
        &mut scene.report,
    );
    if let Some(glossy) = glossy {
        read_specular_glossiness(&glossy, &place, &mut material, textures, scene);
    }
    read_emission(from, &place, &mut material, textures, scene);
    let transmission: Option<Transmission> = extension::read(
        others,
        "KHR_materials_transmission",
        &place,
        &mut scene.report,
    );
    if let Some(transmission) = transmission {
        material.transmission = unit(
            transmission.transmission_factor,
            "transmissionFactor",
            &place,
            &mut scene.report,
        );
        let texture = transmission.transmission_texture;
        material.transmission_texture =
            texture.and_then(|info| textures.slot(&info, &place, scene));
    }
    if let Some(normal) = &from.normal_texture {
        material.relief = read_relief(normal, &place, textures, scene);
    }
    material.alpha_mode = alpha_mode(from, &place, &mut scene.report);
    material.unlit = others.is_some_and(|others| others.contains_key("KHR_materials_unlit"));
    if material.unlit {
        scene
            .report
            .warn(&place, "KHR_materials_unlit: it counts as diffuse");
    }
    material
}

fn read_metallic_roughness(
    from: &json::material::PbrMetallicRoughness,
    place: &str,
    material: &mut Material,
    textures: &mut Textures<'_>,
    scene: &mut Scene,
) {
    set_base_color(
        from.base_color_factor.0,
        "baseColorFactor",
        place,
        material,
        &mut scene.report,
    );
    material.metallic = unit(
        from.metallic_factor.0,
        "metallicFactor",
        place,
        &mut scene.report,
    );
    material.roughness = unit(
        from.roughness_factor.0,
        "roughnessFactor",
        place,
        &mut scene.report,
    );
    let mut slot = |info: &Option<json::texture::Info>| {
        info.as_ref()
            .and_then(|info| textures.slot(&TextureInfo::from(info), place, scene))
    };
    material.base_color_texture = slot(&from.base_color_texture);
    material.metallic_texture = slot(&from.metallic_roughness_texture);
    material.roughness_texture = material.metallic_texture;
}

/// The extension replaces metallic and roughness; what it reflects diffusely is its diffuse colour.
fn read_specular_glossiness(
    from: &SpecularGlossiness,
    place: &str,
    material: &mut Material,
    textures: &mut Textures<'_>,
    scene: &mut Scene,
) {
    set_base_color(
        from.diffuse_factor,
        "diffuseFactor",
        place,
        material,
        &mut scene.report,
    );
    material.base_color_texture = from
        .diffuse_texture
        .as_ref()
        .and_then(|info| textures.slot(info, place, scene));
    (material.metallic, material.metallic_texture) = (0.0, None);
    material.roughness_texture = None;
    material.roughness = 1.0
        - unit(
            from.glossiness_factor,
            "glossinessFactor",
            place,
            &mut scene.report,
        );
}

/// L = emissiveFactor x emissiveStrength. A factor above 1, which old exporters write, is taken as it stands.
fn read_emission(
    from: &json::Material,
    place: &str,
    material: &mut Material,
    textures: &mut Textures<'_>,
    scene: &mut Scene,
) {
    let others = from.extensions.as_ref().map(|e| &e.others);
    let strength: Option<EmissiveStrength> = extension::read(
        others,
        "KHR_materials_emissive_strength",
        place,
        &mut scene.report,
    );
    let strength = strength.unwrap_or_default().emissive_strength;
    let factor = Rgb::from(from.emissive_factor.0);
    if factor.max_band() > 1.0 && factor.is_finite() {
        scene.report.warn(
            place,
            format!(
                "emissiveFactor {:?} is above 1; taken as it stands",
                factor.to_array()
            ),
        );
    }
    material.emission = not_negative(factor * strength, "emission", place, &mut scene.report);
    material.emission_texture = from
        .emissive_texture
        .as_ref()
        .and_then(|info| textures.slot(&TextureInfo::from(info), place, scene));
}

fn read_relief(
    from: &json::material::NormalTexture,
    place: &str,
    textures: &mut Textures<'_>,
    scene: &mut Scene,
) -> Option<Relief> {
    let scale = from.scale;
    if !scale.is_finite() {
        let what = format!("normalTexture: its scale is {scale}; left out");
        scene.report.warn(place, what);
        return None;
    }
    let slot = textures.slot(&TextureInfo::from(from), place, scene)?;
    let kind = ReliefKind::Normal { scale };
    Some(Relief { slot, kind })
}

fn alpha_mode(from: &json::Material, place: &str, report: &mut ImportReport) -> AlphaMode {
    use json::material::AlphaMode as Mode;
    match from.alpha_mode {
        Checked::Valid(Mode::Opaque) => AlphaMode::Opaque,
        Checked::Valid(Mode::Blend) => AlphaMode::Blend,
        Checked::Valid(Mode::Mask) => {
            let cutoff = from.alpha_cutoff.unwrap_or_default().0;
            // A cutoff above 1 is allowed: nothing is left of the surface.
            let cutoff = if cutoff.is_finite() && cutoff >= 0.0 {
                cutoff
            } else {
                0.5
            };
            AlphaMode::Mask { cutoff }
        }
        Checked::Invalid => {
            report.warn(place, "its alphaMode is none of glTF's; taken as opaque");
            AlphaMode::Opaque
        }
    }
}

fn set_base_color(
    factor: [f32; 4],
    key: &str,
    place: &str,
    material: &mut Material,
    report: &mut ImportReport,
) {
    let [r, g, b, a] = factor.map(clamped);
    if [r, g, b, a] != factor {
        report.warn(
            place,
            format!("{key} {factor:?} is not within 0 and 1; clamped"),
        );
    }
    (material.base_color, material.alpha) = (Rgb::new(r, g, b), a);
}

/// A factor within 0 and 1; others are clamped with a warning.
fn unit(factor: f32, key: &str, place: &str, report: &mut ImportReport) -> f32 {
    let within = clamped(factor);
    if within != factor {
        report.warn(
            place,
            format!("{key} {factor} is not within 0 and 1; clamped"),
        );
    }
    within
}

fn clamped(factor: f32) -> f32 {
    if factor.is_nan() {
        0.0
    } else {
        factor.clamp(0.0, 1.0)
    }
}

/// Light that is at least 0 and finite; other bands become 0 with a warning.
pub fn not_negative(light: Rgb, what: &str, place: &str, report: &mut ImportReport) -> Rgb {
    let mended = light.map(|band| {
        if band.is_finite() && band > 0.0 {
            band
        } else {
            0.0
        }
    });
    if mended != light {
        report.warn(
            place,
            format!(
                "{what} {:?} is negative or not finite; taken as 0 there",
                light.to_array()
            ),
        );
    }
    mended
}

impl From<&json::texture::Info> for TextureInfo {
    fn from(info: &json::texture::Info) -> Self {
        let extensions = info.extensions.as_ref().map(|e| e.others.clone());
        texture_info(info.index.value(), info.tex_coord, extensions)
    }
}

impl From<&json::material::NormalTexture> for TextureInfo {
    fn from(info: &json::material::NormalTexture) -> Self {
        let extensions = info.extensions.as_ref().map(|e| e.others.clone());
        texture_info(info.index.value(), info.tex_coord, extensions)
    }
}

fn texture_info(
    index: usize,
    tex_coord: u32,
    extensions: Option<serde_json::Map<String, serde_json::Value>>,
) -> TextureInfo {
    #[expect(clippy::cast_possible_truncation, reason = "it was read from 32 bits")]
    let index = index as u32;
    TextureInfo {
        index,
        tex_coord,
        extensions: extensions.unwrap_or_default(),
    }
}
