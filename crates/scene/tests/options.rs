//! What the options of a scene do, what they refuse, and what a point of a surface does with light.

use glam::{Affine3A, Vec2, Vec3, Vec4};
use hemicube_raster::{Image, Rgb};
use hemicube_scene::options::{Unit, UpAxis, parse_named_rgb, parse_rgb};
use hemicube_scene::{
    AlphaMode, Camera, Face, Instance, Light, LightKind, Material, Mesh, MetalsAs, Projection,
    Scene, SceneOptions, Texture, TextureImage, TextureSlot, Units, Wrap,
};

/// A red floor and a white lamp, each a triangle, the lamp placed 1 m up along file z.
fn scene() -> Scene {
    let mut scene = Scene {
        name: String::from("test"),
        ..Scene::default()
    };
    scene.materials = vec![
        Material::diffuse("red", Rgb::new(0.6, 0.1, 0.1)),
        Material::diffuse("lamp white", Rgb::splat(0.7)).with_emission(Rgb::splat(5.0)),
    ];
    for (i, node) in ["floor", "lamp"].into_iter().enumerate() {
        scene.meshes.push(Mesh {
            name: node.to_owned(),
            material: i,
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            colors: vec![Vec4::new(0.5, 0.5, 0.5, 0.25); 3],
            faces: vec![Face::Triangle([0, 1, 2])],
            ..Mesh::default()
        });
        let world_from_mesh = Affine3A::from_translation(Vec3::new(2.0, 0.0, i as f32));
        scene.instances.push(Instance {
            node: node.to_owned(),
            mesh: i,
            world_from_mesh,
            flipped: false,
        });
    }
    scene
}

fn applied(options: &SceneOptions) -> Scene {
    let mut scene = scene();
    scene.apply(options).expect("the options fit");
    scene
}

/// The message of a refusal, which is one line and leaves the scene as it was.
fn refused(options: &SceneOptions) -> String {
    let mut scene = scene();
    let message = scene
        .apply(options)
        .expect_err("this is refused")
        .to_string();
    assert!(!message.contains('\n'), "one line: {message}");
    assert_eq!(scene.instances.len(), 2, "a refused option changes nothing");
    assert_eq!(
        scene.materials,
        self::scene().materials,
        "a refused option changes nothing"
    );
    message
}

#[test]
fn defaults_change_nothing() {
    let scene = applied(&SceneOptions::default());
    assert_eq!(scene.materials, self::scene().materials, "materials");
    assert_eq!(scene.instances, self::scene().instances, "instances");
    assert!(scene.report.warnings.is_empty(), "{:?}", scene.report);
    assert_eq!(
        (scene.metals, scene.max_reflectance),
        (MetalsAs::Diffuse, 0.98),
        "rules"
    );
}

#[test]
fn emit_sets_radiance_and_the_last_match_wins() {
    let options = SceneOptions::default()
        .with_emit("*", Rgb::splat(1.0))
        .with_emit("lamp*", Rgb::new(2.0, 3.0, 4.0));
    let scene = applied(&options);
    assert_eq!(scene.materials[0].emission, Rgb::splat(1.0), "red");
    assert_eq!(scene.materials[1].emission, Rgb::new(2.0, 3.0, 4.0), "lamp");
}

#[test]
fn reflectance_replaces_texture_metal_and_vertex_colour() {
    let mut scene = scene();
    scene.materials[0].metallic = 1.0;
    scene.images.push(TextureImage::from_pixels(
        "black",
        Image::filled(1, 1, [0, 0, 0, 255]),
    ));
    scene.textures.push(Texture::new(0, [Wrap::Repeat; 2]));
    scene.materials[0].base_color_texture = Some(TextureSlot::new(0));
    let wanted = Rgb::new(0.2, 0.3, 0.4);
    scene
        .apply(&SceneOptions::default().with_reflectance("re?", wanted))
        .expect("it fits");
    let color = scene.meshes[0].colors[0];
    assert_eq!(
        scene.surface_at(0, &[Vec2::ZERO], color).reflectance,
        wanted,
        "exactly what was asked"
    );
    assert_eq!(color.w, 0.25, "alpha of the vertices stays");
    assert_eq!(
        scene.meshes[1].colors[0].x, 0.5,
        "other materials keep their colours"
    );
}

#[test]
fn nodes_are_hidden_and_flipped_once() {
    let scene = applied(
        &SceneOptions::default()
            .with_hide("fl*")
            .with_flip("l*")
            .with_flip("*p"),
    );
    assert_eq!(scene.instances.len(), 1, "the floor is gone");
    assert!(
        scene.instances[0].flipped,
        "two globs turn the lamp around once"
    );
    let twice = scene.clone().apply(&SceneOptions::default().with_flip("*"));
    assert!(twice.is_ok(), "{twice:?}");
}

#[test]
fn double_sided_sky_units() {
    let options = SceneOptions::default()
        .with_double_sided(true)
        .with_sky(Rgb::splat(2.0))
        .with_units(Units::Radiometric);
    let scene = applied(&options);
    assert!(
        scene.materials.iter().all(|m| m.double_sided),
        "all of them"
    );
    assert_eq!(
        (scene.sky, scene.units),
        (Rgb::splat(2.0), Units::Radiometric),
        "sky and units"
    );
}

#[test]
fn unit_and_up_move_everything() {
    let mut scene = scene();
    let intensity = Rgb::splat(9.0);
    let position = Vec3::new(1000.0, 2000.0, 3000.0);
    scene.lights.push(Light {
        name: String::from("p"),
        kind: LightKind::Point {
            position,
            intensity,
        },
    });
    let direction = Vec3::NEG_Z;
    let (inner_angle, outer_angle) = (0.1, 0.2);
    let spot = LightKind::Spot {
        position,
        direction,
        intensity,
        inner_angle,
        outer_angle,
    };
    scene.lights.push(Light {
        name: String::from("s"),
        kind: spot,
    });
    let sun = LightKind::Directional {
        direction,
        irradiance: intensity,
    };
    scene.lights.push(Light {
        name: String::from("d"),
        kind: sun,
    });
    scene.cameras.push(Camera {
        projection: Projection::Orthographic {
            half_width: 1000.0,
            half_height: 500.0,
        },
        ..Camera::looking_at("c", position, position + Vec3::Y, Vec3::Z, 1.0)
    });
    scene
        .apply(
            &SceneOptions::default()
                .with_unit(Unit::Millimetre)
                .with_up(UpAxis::Z),
        )
        .expect("it fits");

    let moved = Vec3::new(1.0, 3.0, -2.0);
    let near = |a: Vec3, b: Vec3| a.abs_diff_eq(b, 1e-6);
    let (low, _) = scene.bounds().expect("it is not empty");
    assert!(near(low, Vec3::new(0.002, 0.0, -0.001)), "low corner {low}");
    assert!(
        near(scene.cameras[0].eye, moved),
        "eye {}",
        scene.cameras[0].eye
    );
    assert!(
        near(scene.cameras[0].forward, Vec3::NEG_Z),
        "file y is world -z"
    );
    assert!(near(scene.cameras[0].up, Vec3::Y), "file z is up");
    let projection = Projection::Orthographic {
        half_width: 1.0,
        half_height: 0.5,
    };
    assert_eq!(
        scene.cameras[0].projection, projection,
        "parallel views are scaled"
    );
    let LightKind::Point {
        position,
        intensity,
    } = scene.lights[0].kind
    else {
        panic!("it was a point")
    };
    assert!(
        near(position, moved) && intensity == Rgb::splat(9.0),
        "{position} {intensity:?}"
    );
    let LightKind::Spot {
        position,
        direction,
        ..
    } = scene.lights[1].kind
    else {
        panic!("it was a spot")
    };
    assert!(
        near(position, moved) && near(direction, Vec3::NEG_Y),
        "{position} {direction}"
    );
    let LightKind::Directional { direction, .. } = scene.lights[2].kind else {
        panic!("it was a sun")
    };
    assert!(near(direction, Vec3::NEG_Y), "{direction}");
}

#[test]
fn lengths_of_units() {
    let lengths =
        ["mm", "cm", "m", "in", "FT"].map(|name| name.parse::<Unit>().expect(name).metres());
    assert_eq!(lengths, [0.001, 0.01, 1.0, 0.0254, 0.3048], "in metres");
}

#[test]
fn globs_that_match_nothing_list_the_names() {
    let message = refused(&SceneOptions::default().with_emit("Red", Rgb::WHITE));
    assert_eq!(
        message, "emit 'Red': no material is called that; there are 'red', 'lamp white'",
        "case matters"
    );
    assert!(
        refused(&SceneOptions::default().with_reflectance("x", Rgb::WHITE)).contains("'red'"),
        "reflectance"
    );
    assert!(
        refused(&SceneOptions::default().with_hide("x")).contains("'floor', 'lamp'"),
        "hide"
    );
    assert!(
        refused(&SceneOptions::default().with_flip("x")).contains("no node"),
        "flip"
    );
}

#[test]
fn long_lists_of_names_are_cut() {
    let mut scene = scene();
    scene.materials = (0..40)
        .map(|i| Material::diffuse(format!("m{i}\n"), Rgb::WHITE))
        .collect();
    let error = scene
        .apply(&SceneOptions::default().with_emit("x", Rgb::WHITE))
        .expect_err("no such name")
        .to_string();
    assert!(error.ends_with("'m11\\n', ... (40 in all)"), "{error}");
    assert!(
        !error.contains('\n'),
        "names with line breaks are escaped: {error}"
    );
    let error = Scene::default()
        .apply(&SceneOptions::default().with_hide("x"))
        .expect_err("it is empty")
        .to_string();
    assert_eq!(error, "hide 'x': the scene has no nodes", "nothing to list");
}

#[test]
fn numbers_out_of_range_are_refused() {
    let bad = [
        (
            SceneOptions::default().with_emit("red", Rgb::new(0.0, -1.5, 0.0)),
            "emit 'red': radiance -1.5 (green) is below 0",
        ),
        (
            SceneOptions::default().with_emit("red", Rgb::splat(f32::NAN)),
            "emit 'red': radiance NaN (red) is not a finite number",
        ),
        (
            SceneOptions::default().with_sky(Rgb::splat(f32::INFINITY)),
            "sky: radiance inf (red) is not a finite number",
        ),
        (
            SceneOptions::default().with_sky(Rgb::splat(-2.0)),
            "sky: radiance -2 (red) is below 0",
        ),
        (
            SceneOptions::default().with_reflectance("red", Rgb::new(0.1, 0.1, 1.2)),
            "reflectance 'red': 1.2 (blue) is above 1",
        ),
        (
            SceneOptions::default().with_max_reflectance(0.0),
            "max-reflectance 0 is not above 0 and at most 1",
        ),
        (
            SceneOptions::default().with_max_reflectance(1.01),
            "max-reflectance 1.01 is not",
        ),
        (
            SceneOptions::default().with_max_reflectance(f32::NAN),
            "max-reflectance NaN is not",
        ),
    ];
    for (options, start) in bad {
        let message = refused(&options);
        assert!(message.starts_with(start), "{message}");
    }
}

#[test]
fn parsers_say_what_they_accept() {
    let (name, color) = parse_named_rgb("a=b=1,2,3").expect("the last = counts");
    assert_eq!(
        (name.as_str(), color),
        ("a=b", Rgb::new(1.0, 2.0, 3.0)),
        "name and colour"
    );
    assert_eq!(parse_rgb("0.25"), Ok(Rgb::splat(0.25)), "grey");
    for bad in ["", "1,2", "1,2,3,4", "a", "nan", "1e99", "1;2;3"] {
        let message = parse_rgb(bad).expect_err(bad);
        assert!(message.contains("R,G,B or one number"), "{message}");
    }
    for bad in ["red", "=1", "red=", "red=x"] {
        let message = parse_named_rgb(bad).expect_err(bad);
        assert!(
            message.contains("R,G,B") && !message.contains('\n'),
            "{message}"
        );
    }
    assert_eq!(
        "km".parse::<Unit>(),
        Err(String::from(
            "'km' is no unit of length; use one of mm, cm, m, in, ft"
        )),
        "unit"
    );
    assert!(
        "x".parse::<UpAxis>()
            .expect_err("x")
            .ends_with("use one of y, z"),
        "up"
    );
    assert!(
        "lux"
            .parse::<Units>()
            .expect_err("lux")
            .ends_with("use one of photometric, radiometric"),
        "units"
    );
    assert!(
        "grey"
            .parse::<MetalsAs>()
            .expect_err("grey")
            .ends_with("use one of diffuse, black"),
        "metals"
    );
    for name in Units::NAMES {
        assert_eq!(
            &name.parse::<Units>().expect("its own name").to_string(),
            name,
            "round trip"
        );
    }
}

#[test]
fn the_report_names_metals_and_lowered_reflectances_once() {
    let mut scene = scene();
    scene.materials[0].metallic = 1.0;
    scene.materials[1].base_color = Rgb::WHITE;
    for _ in 0..2 {
        scene.apply(&SceneOptions::default()).expect("defaults fit");
    }
    let texts: Vec<String> = scene
        .report
        .warnings
        .iter()
        .map(ToString::to_string)
        .collect();
    assert_eq!(texts.len(), 2, "{texts:?}");
    assert!(
        texts[0].starts_with("materials: 1 of 2 are metals and count as diffuse")
            && texts[0].contains("'red'"),
        "{}",
        texts[0]
    );
    assert_eq!(
        texts[1], "material 'lamp white': reflectance 1 lowered to 0.98",
        "both numbers"
    );

    let mut black = self::scene();
    black.materials[0].metallic = 1.0;
    black
        .apply(&SceneOptions::default().with_metals(MetalsAs::Black))
        .expect("it fits");
    assert!(
        black.report.warnings.is_empty(),
        "black metals need no warning: {:?}",
        black.report
    );
}

/// One material, one image of 1 x 1 for all its textures.
fn sample(material: Material, texel: [u8; 4], metals: MetalsAs) -> hemicube_scene::SurfaceSample {
    let mut scene = Scene {
        metals,
        materials: vec![material],
        ..Scene::default()
    };
    scene.images.push(TextureImage::from_pixels(
        "texel",
        Image::filled(1, 1, texel),
    ));
    scene.textures.push(Texture::new(0, [Wrap::Repeat; 2]));
    scene.surface_at(0, &[Vec2::splat(0.3)], Vec4::new(0.5, 1.0, 1.0, 1.0))
}

fn near(a: Rgb, b: [f32; 3]) -> bool {
    (a - Rgb::from(b)).map(f32::abs).max_band() < 1e-5
}

#[test]
fn reflectance_is_base_colour_times_texture_times_vertex_colour() {
    let material = Material {
        base_color_texture: Some(TextureSlot::new(0)),
        ..Material::diffuse("m", Rgb::splat(0.8))
    };
    let surface = sample(material, [188, 255, 0, 255], MetalsAs::Diffuse);
    let half = hemicube_raster::color::linear_from_srgb8_table()[188];
    assert!(
        near(surface.reflectance, [0.8 * half * 0.5, 0.8, 0.0]),
        "{surface:?}"
    );
    assert!(
        surface.transmittance.is_black() && !surface.clamped,
        "opaque: {surface:?}"
    );
}

#[test]
fn metals_follow_the_rule() {
    let metal = Material {
        metallic: 0.5,
        metallic_texture: Some(TextureSlot::new(0)),
        ..Material::diffuse("m", Rgb::splat(0.8))
    };
    let blue = [0, 0, 255, 255];
    assert!(
        near(
            sample(metal.clone(), blue, MetalsAs::Diffuse).reflectance,
            [0.4, 0.8, 0.8]
        ),
        "in full"
    );
    assert!(
        near(
            sample(metal.clone(), blue, MetalsAs::Black).reflectance,
            [0.2, 0.4, 0.4]
        ),
        "half is metal"
    );
    assert!(
        near(
            sample(metal, [255, 255, 0, 255], MetalsAs::Black).reflectance,
            [0.4, 0.8, 0.8]
        ),
        "none is metal"
    );
}

#[test]
fn alpha_blends_and_cuts() {
    let glow = Material {
        alpha: 0.25,
        alpha_mode: AlphaMode::Blend,
        ..Material::diffuse("m", Rgb::splat(0.8))
    };
    let surface = sample(
        glow.clone().with_emission(Rgb::splat(4.0)),
        [255; 4],
        MetalsAs::Diffuse,
    );
    assert!(near(surface.reflectance, [0.1, 0.2, 0.2]), "{surface:?}");
    assert!(
        near(surface.transmittance, [0.75; 3]),
        "white, not tinted: {surface:?}"
    );
    assert!(near(surface.emission, [1.0; 3]), "{surface:?}");

    let mask = Material {
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        base_color_texture: Some(TextureSlot::new(0)),
        alpha: 1.0,
        ..glow
    };
    let mask = mask.with_emission(Rgb::splat(4.0));
    let hole = sample(mask.clone(), [255, 255, 255, 100], MetalsAs::Diffuse);
    assert_eq!(
        (hole.reflectance, hole.emission, hole.transmittance),
        (Rgb::BLACK, Rgb::BLACK, Rgb::WHITE),
        "a hole"
    );
    let solid = sample(mask, [255, 255, 255, 200], MetalsAs::Diffuse);
    assert!(
        near(solid.reflectance, [0.4, 0.8, 0.8]) && solid.transmittance.is_black(),
        "not weighted: {solid:?}"
    );
}

#[test]
fn transmission_passes_and_tints() {
    let glass = Material {
        transmission: 0.5,
        transmission_texture: Some(TextureSlot::new(0)),
        ..Material::diffuse("m", Rgb::splat(0.8))
    };
    let surface = sample(glass.clone(), [255, 0, 0, 255], MetalsAs::Diffuse);
    assert!(near(surface.reflectance, [0.2, 0.4, 0.4]), "{surface:?}");
    assert!(near(surface.transmittance, [0.2, 0.4, 0.4]), "{surface:?}");
    let metal = Material {
        metallic: 1.0,
        ..glass
    };
    assert!(
        sample(metal, [255, 0, 0, 255], MetalsAs::Diffuse)
            .transmittance
            .is_black(),
        "metals do not transmit"
    );
}

#[test]
fn bright_surfaces_are_lowered() {
    let surface = sample(
        Material::diffuse("m", Rgb::WHITE),
        [255; 4],
        MetalsAs::Diffuse,
    );
    assert!(
        near(surface.reflectance, [0.5, 0.98, 0.98]) && surface.clamped,
        "{surface:?}"
    );
}

#[test]
fn emission_is_radiance_times_texture() {
    let material = Material {
        emission_texture: Some(TextureSlot::new(0)),
        ..Material::default()
    };
    let surface = sample(
        material.with_emission(Rgb::splat(100.0)),
        [255, 0, 255, 255],
        MetalsAs::Diffuse,
    );
    assert!(near(surface.emission, [100.0, 0.0, 100.0]), "{surface:?}");
}

#[test]
fn missing_sets_of_coordinates_read_the_origin() {
    let slot = TextureSlot {
        texcoord_set: 3,
        ..TextureSlot::new(0)
    };
    let material = Material {
        base_color_texture: Some(slot),
        ..Material::diffuse("m", Rgb::splat(0.8))
    };
    let surface = sample(material, [255; 4], MetalsAs::Diffuse);
    assert!(near(surface.reflectance, [0.4, 0.8, 0.8]), "{surface:?}");
}

#[test]
fn no_surface_gives_more_than_it_gets() {
    let steps = [0.0, 0.3, 1.0];
    for metals in [MetalsAs::Diffuse, MetalsAs::Black] {
        for (base, alpha) in steps.into_iter().flat_map(|a| steps.map(|b| (a, b))) {
            for (metallic, transmission) in steps.into_iter().flat_map(|a| steps.map(|b| (a, b))) {
                for alpha_mode in [
                    AlphaMode::Opaque,
                    AlphaMode::Blend,
                    AlphaMode::Mask { cutoff: 0.5 },
                ] {
                    let material = Material {
                        alpha,
                        metallic,
                        transmission,
                        alpha_mode,
                        ..Material::diffuse("m", Rgb::splat(base))
                    };
                    let surface = sample(material.clone(), [255; 4], metals);
                    let sum = (surface.reflectance + surface.transmittance).max_band();
                    // One rounding step above 1 is no energy.
                    assert!(sum <= 1.0 + f32::EPSILON, "{sum} from {material:?}");
                    let least = surface.reflectance.map(|band| -band).max_band();
                    assert!(
                        least <= 0.0,
                        "negative reflectance {surface:?} from {material:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn light_beyond_all_lamps_is_refused() {
    let too_much = Rgb::new(1.0, 3e38, 1.0);
    let options = SceneOptions {
        sky: Some(too_much),
        ..SceneOptions::default()
    };
    let error = scene()
        .apply(&options)
        .expect_err("such a sky is refused")
        .to_string();
    assert!(error.contains("sky"), "{error}");
    let mut bright = scene();
    bright.materials[1].emission = too_much;
    let error = bright.check().expect_err("such a lamp is refused");
    assert!(error.to_string().contains("lamp white"), "{error}");
    let mut bright = scene();
    bright.lights.push(Light {
        name: String::from("star"),
        kind: LightKind::Point {
            position: Vec3::ZERO,
            intensity: too_much,
        },
    });
    let error = bright.check().expect_err("such a light is refused");
    assert!(error.to_string().contains("star"), "{error}");
}
