//! Every shader is valid, and the structs and constants that it shares with Rust are the same there.

use core::mem::{offset_of, size_of};
use hemicube_shaders::{Shader, all, hemicube, raycast, shooting};
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
        ("STACK", raycast::STACK),
        ("CHANNEL_WORDS", shooting::CHANNEL_WORDS),
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
