//! Every shader is valid, and the structs and constants that it shares with Rust are the same there.

use core::mem::{offset_of, size_of};
use hemicube_shaders::{Shader, all, hemicube, raycast, shooting, surface};
use naga::valid::{Capabilities, ValidationFlags, Validator};

fn parsed(shader: &Shader) -> Result<naga::Module, String> {
    let said = |what: String| format!("{}: {what}", shader.name);
    let module = naga::front::wgsl::parse_str(shader.source)
        .map_err(|e| said(e.emit_to_string(shader.source)))?;
    Validator::new(ValidationFlags::all(), Capabilities::all())
        .validate(&module)
        .map_err(|e| said(e.emit_to_string(shader.source)))?;
    Ok(module)
}

#[test]
fn all_shaders_are_valid() {
    let failures: Vec<String> = all().filter_map(|shader| parsed(shader).err()).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(all().count() >= 3, "there are shaders");
}

/// A struct in Rust: name, size, and the offsets of its fields.
type Twin = (&'static str, usize, Vec<(&'static str, usize)>);

macro_rules! twin {
    ($type:ty: $($field:ident),*) => {
        (
            stringify!($type).rsplit("::").next().expect("a name").trim(),
            size_of::<$type>(),
            vec![$((stringify!($field), offset_of!($type, $field))),*],
        )
    };
}

fn twins() -> Vec<Twin> {
    vec![
        twin!(hemicube::Receiver: normal, flags, centroid, radius),
        twin!(hemicube::Viewpoint: origin, least_near, tangent, farthest, bitangent, padding_0, normal, padding_1),
        twin!(hemicube::HemicubeParams: receivers, vertices, elements, resolution, groups, indices, padding_0, padding_1),
        twin!(hemicube::DrawParams: viewpoint, face, padding_0, padding_1),
        twin!(hemicube::LayerParams: layer, is_last, padding_0, padding_1),
        twin!(raycast::RayParams: rays, parts, elements, first_ray, shift, tangent, offset, bitangent, farthest, normal, lag),
        twin!(raycast::RayPart: corners, share, count, padding_0, padding_1),
        twin!(raycast::RayTriangle: a, element, b, both_sides, c, padding),
        twin!(shooting::ShootingParams: elements, patches, channels, bands, farthest, padding_0, padding_1, padding_2),
        twin!(shooting::ElementLight: area, inverse_area, padding_0, padding_1, reflectance, padding_2),
        twin!(shooting::ShootingPatch: first_element, elements, first_view, views, normal, padding),
        twin!(shooting::ShotView: origin, weight, tangent, least_near),
        twin!(shooting::ShotState: shooter, view, views, shots, weight, unshot, largest, most_shots),
        twin!(surface::View: clip_from_world, eye, background, exposure, size, flags, max_reflectance, max_anisotropy, ewa_radius, padding_0, padding_1),
        twin!(surface::Slot: matrix, offset, flags, size),
        twin!(surface::Material: base_color, alpha, emission, metallic, roughness, transmission, cutoff, relief, padding, slots),
        twin!(surface::LightParams: elements, vertices, groups, padding, extra),
        twin!(surface::MeterParams: weights, elements),
        twin!(surface::LineParams: color, width, lift, padding_0, padding_1),
        twin!(surface::ToneParams: curve, encodes, samples, padding),
        twin!(surface::TiltFit: right, padding_0, up, padding_1, changes),
        twin!(surface::Mirror: position, scale, low, has_room, high, projection, levels, by_normal, padding_0, padding_1),
        twin!(surface::Surroundings: right, projection, up, scale, forward, padding_0, size, map_size, window_scale, window_offset),
        twin!(surface::CubeParams: side, face, samples, source_side),
        twin!(surface::LobeSample: direction, solid_angle, weight, padding_0, padding_1, padding_2),
        twin!(surface::FilterParams: factor, taps, padding_0, padding_1),
        twin!(surface::FieldParams: line_color, missing, weights, low, high, spacing, start, width, padding_0, padding_1, padding_2),
    ]
}

#[test]
fn structs_have_the_same_layout_in_rust() {
    let modules: Vec<naga::Module> = all().map(|s| parsed(s).expect("a valid shader")).collect();
    for (name, size, fields) in twins() {
        let mut found = 0;
        for module in &modules {
            for (_, kind) in module
                .types
                .iter()
                .filter(|(_, t)| t.name.as_deref() == Some(name))
            {
                let naga::TypeInner::Struct { members, span } = &kind.inner else {
                    panic!("{name} is a struct");
                };
                let theirs: Vec<(&str, usize)> = members
                    .iter()
                    .map(|m| (m.name.as_deref().unwrap_or_default(), m.offset as usize))
                    .collect();
                assert_eq!(theirs, fields, "fields of {name}");
                assert_eq!(*span as usize, size, "size of {name}");
                found += 1;
            }
        }
        assert!(found > 0, "no shader has a struct {name}");
    }
}

#[test]
fn constants_have_the_same_values_in_rust() {
    let modules: Vec<naga::Module> = all().map(|s| parsed(s).expect("a valid shader")).collect();
    let constants = [
        ("RECEIVER_BOTH_SIDES", hemicube::RECEIVER_BOTH_SIDES),
        ("RECEIVER_EXPOSED", hemicube::RECEIVER_EXPOSED),
        ("RECEIVER_OBSTRUCTION", hemicube::RECEIVER_OBSTRUCTION),
        ("FACES", hemicube::FACES),
        ("MASKS", hemicube::MASKS),
        ("MAX_LAYERS", hemicube::MAX_LAYERS),
        ("ITEM_EMPTY", hemicube::ITEM_EMPTY),
        ("SEGMENT", hemicube::SEGMENT),
        ("RECEIVES", raycast::RECEIVES),
        ("ABSORBS", raycast::ABSORBS),
        ("STACK", raycast::STACK),
        ("CHANNEL_WORDS", shooting::CHANNEL_WORDS),
        ("METER_BINS", surface::METER_BINS),
        ("METER_BINS_PER_STOP", surface::METER_BINS_PER_STOP),
        ("METER_STOPS_BELOW_ONE", surface::METER_STOPS_BELOW_ONE),
        ("VIEW_METALS_DIFFUSE", surface::VIEW_METALS_DIFFUSE),
        ("MAGNIFY_SAMPLER", surface::MAGNIFY_SAMPLER),
        ("MAGNIFY_CATMULL_ROM", surface::MAGNIFY_CATMULL_ROM),
        ("MAGNIFY_B_SPLINE", surface::MAGNIFY_B_SPLINE),
        ("MAGNIFY_MITCHELL", surface::MAGNIFY_MITCHELL),
        ("SLOT_SECOND", surface::SLOT_SECOND),
        ("SLOT_NOWHERE", surface::SLOT_NOWHERE),
        ("SLOT_BLOCKS", surface::SLOT_BLOCKS),
        ("SLOT_PREMULTIPLIED", surface::SLOT_PREMULTIPLIED),
        ("SLOT_WRAP_U_SHIFT", surface::SLOT_WRAP_U_SHIFT),
        ("SLOT_WRAP_V_SHIFT", surface::SLOT_WRAP_V_SHIFT),
        ("ALPHA_OPAQUE", surface::ALPHA_OPAQUE),
        ("ALPHA_MASK", surface::ALPHA_MASK),
        ("ALPHA_BLEND", surface::ALPHA_BLEND),
        ("SLOT_BASE", surface::SLOT_BASE),
        ("SLOT_METALLIC", surface::SLOT_METALLIC),
        ("SLOT_ROUGHNESS", surface::SLOT_ROUGHNESS),
        ("SLOT_EMISSION", surface::SLOT_EMISSION),
        ("SLOT_TRANSMISSION", surface::SLOT_TRANSMISSION),
        ("SLOT_RELIEF", surface::SLOT_RELIEF),
        ("CORNER_NUMBER", surface::CORNER_NUMBER),
        ("CORNER_TURNED", surface::CORNER_TURNED),
        ("CORNER_TRIANGLE_SHIFT", surface::CORNER_TRIANGLE_SHIFT),
        ("RELIEF_NONE", surface::RELIEF_NONE),
        ("RELIEF_NORMALS", surface::RELIEF_NORMALS),
        ("RELIEF_HEIGHTS", surface::RELIEF_HEIGHTS),
        ("RELIEF_AROUND", surface::RELIEF_AROUND),
        ("PROJECTION_CUBE", surface::PROJECTION_CUBE),
        ("PROJECTION_LATLONG", surface::PROJECTION_LATLONG),
        ("PROJECTION_SPHERE", surface::PROJECTION_SPHERE),
        ("PROJECTION_PARABOLOID", surface::PROJECTION_PARABOLOID),
        ("PROJECTION_OCTAHEDRAL", surface::PROJECTION_OCTAHEDRAL),
        ("PROJECTION_ANGULAR", surface::PROJECTION_ANGULAR),
        ("PROJECTION_FISHEYE", surface::PROJECTION_FISHEYE),
        (
            "PROJECTION_HEMISPHERICAL",
            surface::PROJECTION_HEMISPHERICAL,
        ),
        ("SPLIT_SUM_SIDE", surface::SPLIT_SUM_SIDE),
        ("CURVE_REINHARD", surface::CURVE_REINHARD),
        ("CURVE_ACES", surface::CURVE_ACES),
        ("CURVE_NONE", surface::CURVE_NONE),
        ("CURVE_LINEAR", surface::CURVE_LINEAR),
    ];
    for (name, value) in constants {
        let values: Vec<u32> = modules
            .iter()
            .flat_map(|module| module.constants.iter().map(move |(_, c)| (module, c)))
            .filter(|(_, constant)| constant.name.as_deref() == Some(name))
            .map(
                |(module, constant)| match module.global_expressions[constant.init] {
                    naga::Expression::Literal(naga::Literal::U32(value)) => value,
                    ref other => panic!("{name} is {other:?}"),
                },
            )
            .collect();
        assert!(!values.is_empty(), "no shader has a constant {name}");
        assert!(
            values.iter().all(|&v| v == value),
            "{name}: {values:?} and {value}"
        );
    }
}
