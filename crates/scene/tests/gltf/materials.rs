//! Materials, textures and pictures.

use super::document::{Builder, assert_warned, with_material};
use base64::Engine as _;
use glam::Vec2;
use hemicube_scene::{AlphaMode, Magnify, Minify, ReliefKind, TextureUse, Wrap};
use serde_json::{Value, json};

#[test]
fn a_primitive_without_material_has_that_of_the_specification() {
    let scene = Builder::with_triangle().scene();
    let material = &scene.materials[scene.meshes[0].material];
    assert_eq!(material.base_color.to_array(), [1.0; 3], "white");
    assert_eq!(
        (material.metallic, material.double_sided),
        (1.0, false),
        "metallic 1, one-sided"
    );
}

#[test]
fn emission_is_factor_times_strength() {
    let strong = json!({"KHR_materials_emissive_strength": {"emissiveStrength": 200}});
    let scene = with_material(
        json!({"name": "tube", "emissiveFactor": [1, 0.5, 0.25], "extensions": strong}),
    )
    .scene();
    assert_eq!(
        scene.materials[0].emission.to_array(),
        [200.0, 100.0, 50.0],
        "cd/m2"
    );
    assert!(scene.has_light(), "so there is light");
    let scene = with_material(json!({"emissiveFactor": [-1, 0.5, 1e39]})).scene();
    assert_eq!(
        scene.materials[0].emission.to_array(),
        [0.0, 0.5, 0.0],
        "neither negative nor infinite"
    );
    assert_eq!(
        scene.materials[0].name, "material 0",
        "a material without a name has its number"
    );
    assert_warned(&scene, "material 'material 0': emission");
}

#[test]
fn factors_out_of_range_are_clamped_with_a_warning() {
    let pbr =
        json!({"baseColorFactor": [2, 0.5, -1, 1e39], "metallicFactor": 3, "roughnessFactor": -1});
    let scene = with_material(json!({"pbrMetallicRoughness": pbr})).scene();
    let material = &scene.materials[0];
    assert_eq!(
        material.base_color.to_array(),
        [1.0, 0.5, 0.0],
        "base colour"
    );
    assert_eq!(
        (material.alpha, material.metallic, material.roughness),
        (1.0, 1.0, 0.0),
        "other factors"
    );
    for key in ["baseColorFactor", "metallicFactor", "roughnessFactor"] {
        assert_warned(&scene, key);
    }
}

#[test]
fn material_extensions_are_read() {
    let scene = with_material(json!({
        "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25,
        "extensions": {"KHR_materials_unlit": {}, "KHR_materials_transmission": {"transmissionFactor": 0.75}}
    }))
    .scene();
    let material = &scene.materials[0];
    assert!(
        material.double_sided && material.unlit,
        "double-sided and unlit"
    );
    assert_eq!(
        material.alpha_mode,
        AlphaMode::Mask { cutoff: 0.25 },
        "mask"
    );
    assert_eq!(material.transmission, 0.75, "transmission");
    assert_warned(&scene, "counts as diffuse");
    let glossy =
        json!({"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.1, 0.2, 0.3, 0.5]}});
    let scene = with_material(json!({"alphaMode": "BLEND", "extensions": glossy})).scene();
    let material = &scene.materials[0];
    assert_eq!(
        material.base_color.to_array(),
        [0.1, 0.2, 0.3],
        "the diffuse colour"
    );
    assert_eq!((material.metallic, material.alpha), (0.0, 0.5), "no metal");
    assert_eq!(material.alpha_mode, AlphaMode::Blend, "blend");
}

/// A material whose base colour texture has a transform, and the picture it needs.
fn with_texture(transform: Value) -> Builder {
    let image = hemicube_raster::Image::filled(1, 1, [255, 128, 0, 255]);
    let image = hemicube_scene::TextureImage::from_pixels("dot", image);
    let data = base64::engine::general_purpose::STANDARD.encode(image.encoded());
    let info = json!({"index": 0, "extensions": {"KHR_texture_transform": transform}});
    let mut builder = with_material(json!({"pbrMetallicRoughness": {"baseColorTexture": info}}));
    builder.json["images"] = json!([{"uri": format!("data:image/png;base64,{data}")}]);
    builder.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648}]);
    builder.json["textures"] = json!([{"source": 0, "sampler": 0}]);
    builder
}

#[test]
fn texture_transforms_hit_the_markers_of_the_khronos_test_model() {
    // TextureTransformTest: the tip of the arrow, (0.778, 0.778) in the picture, must come to lie under the marker.
    let tip = Vec2::splat(0.777_817_5);
    for (transform, marker, tolerance) in [
        (
            json!({"rotation": core::f32::consts::FRAC_PI_8}),
            Vec2::new(0.420_951_8, 1.016_267_5),
            1e-5,
        ),
        // The markers of these two are placed by eye.
        (json!({"scale": [1.5, 1.5]}), Vec2::splat(0.518_545), 1e-3),
        (
            json!({"offset": [-0.2, -0.1], "rotation": 0.3, "scale": [1.5, 1.5]}),
            Vec2::new(0.43, 0.75),
            0.03,
        ),
    ] {
        let scene = with_texture(transform.clone()).scene();
        let slot = scene.materials[0]
            .base_color_texture
            .expect("the texture is used");
        let found = slot.coordinates(marker);
        assert!(
            found.distance(tip) < tolerance,
            "{transform}: {found}, not {tip}"
        );
    }
}

#[test]
fn the_worked_example_of_the_texture_transform_specification() {
    let transform = json!({"offset": [0, 1], "rotation": core::f32::consts::FRAC_PI_2, "scale": [0.5, 0.5], "texCoord": 1});
    let scene = with_texture(transform).scene();
    let slot = scene.materials[0]
        .base_color_texture
        .expect("the texture is used");
    assert_eq!(
        slot.texcoord_set, 1,
        "texCoord of the extension comes first"
    );
    for (from, to) in [
        (Vec2::ZERO, Vec2::Y),
        (Vec2::ONE, Vec2::splat(0.5)),
        (Vec2::X, Vec2::new(0.0, 0.5)),
    ] {
        assert!(
            slot.coordinates(from).distance(to) < 1e-6,
            "{from} is {}, not {to}",
            slot.coordinates(from)
        );
    }
    let texture = scene.textures[slot.texture];
    assert_eq!(
        texture.wrap,
        [Wrap::ClampToEdge, Wrap::MirroredRepeat],
        "wrap modes of the sampler"
    );
    assert_warned(&scene, "needs TEXCOORD_1, which it lacks");
}

#[test]
fn what_only_pictures_use_is_read() {
    let mut builder = with_texture(json!({}));
    let material = &mut builder.json["materials"][0];
    material["normalTexture"] = json!({"index": 0, "scale": 0.5, "texCoord": 0});
    material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = json!({"index": 0});
    builder.json["samplers"][0]["magFilter"] = json!(9728);
    builder.json["samplers"][0]["minFilter"] = json!(9729);
    let scene = builder.scene();
    let material = &scene.materials[0];
    let relief = material.relief.expect("the normal map is used");
    assert_eq!(relief.kind, ReliefKind::Normal { scale: 0.5 }, "its scale");
    assert!(material.roughness_texture.is_some(), "roughness");
    assert_eq!(
        material.roughness_texture, material.metallic_texture,
        "one picture"
    );
    assert_eq!(material.slots().count(), 4, "all slots");
    let texture = scene.textures[relief.slot.texture];
    assert_eq!(
        (texture.magnify, texture.minify),
        (Magnify::Nearest, Minify::Linear),
        "filters of the sampler"
    );
}

#[test]
fn mip_chains_are_made_once_and_shared() {
    let scene = with_texture(json!({})).scene();
    let image = &scene.images[0];
    let wrap = [Wrap::Repeat; 2];
    let chain: *const _ = image.chain(wrap, TextureUse::Color);
    assert_eq!(
        chain,
        image.clone().chain(wrap, TextureUse::Color),
        "the clone has the same"
    );
    let data: *const _ = image.chain(wrap, TextureUse::Data);
    assert_ne!(chain, data, "another use is another chain");
}

#[test]
fn a_picture_that_cannot_be_used_costs_its_slot() {
    for (image, part) in [
        (
            json!({"uri": "data:image/png;base64,AAAA"}),
            "neither PNG, JPEG nor WebP",
        ),
        (json!({"uri": "data:image/png;base64,%%"}), "not base64"),
        (json!({"uri": "missing.png"}), "no folder is known"),
        (
            json!({"uri": "https://example.org/a.png"}),
            "not a file beside this one",
        ),
        (json!({"uri": "/etc/hostname"}), "not a relative file name"),
        (
            json!({"uri": "%2Fetc%2Fhostname"}),
            "not a relative file name",
        ),
        (json!({"bufferView": 5}), "buffer view 5 of 1"),
        (json!({}), "it names no data"),
    ] {
        let mut builder = with_texture(json!({}));
        builder.json["images"] = json!([image]);
        let scene = builder.scene();
        assert!(
            scene.materials[0].base_color_texture.is_none(),
            "{image}: the slot is dropped"
        );
        assert_warned(&scene, part);
    }
    let mut builder = with_texture(json!({}));
    builder.json["textures"] = json!([{"extensions": {"EXT_texture_webp": {"source": 0}}}]);
    assert_warned(
        &builder.scene(),
        "has no picture except by EXT_texture_webp",
    );
}

#[test]
fn a_picture_is_decoded_once_for_all_its_textures() {
    let mut builder = with_texture(json!({}));
    builder.json["textures"] = json!([{"source": 0}, {"source": 0}]);
    builder.json["materials"][0]["emissiveTexture"] = json!({"index": 1});
    let scene = builder.scene();
    assert_eq!(
        (scene.images.len(), scene.textures.len()),
        (1, 2),
        "one picture, two textures"
    );
}
