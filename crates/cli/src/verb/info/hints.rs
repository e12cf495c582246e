//! Why a scene would stay black or leak light, and how to mend it.

use super::probe::{Fate, Probe, seen_around};
use crate::solving::percent;
use hemicube::radiosity::PatchMesh;
use hemicube::scene::{Camera, LightKind, Material, Scene};

/// Names that a hint lists.
const LISTED: usize = 5;

/// Share of light that may get lost before it is worth a line.
const NOTICEABLE: f64 = 0.02;

/// All hints, the gravest first.
pub fn of(mesh: &PatchMesh, probe: &Probe) -> Vec<String> {
    let scene = mesh.scene();
    let mut hints = Vec::new();
    light(scene, &mut hints);
    emitters(scene, probe, &mut hints);
    lights_and_cameras(mesh, &mut hints);
    backs(scene, probe, &mut hints);
    openness(scene, probe, &mut hints);
    materials(scene, &mut hints);
    hints
}

fn light(scene: &Scene, hints: &mut Vec<String>) {
    let used = used_materials(scene);
    let unused = |(material, used): (&Material, &bool)| {
        (material.emits() && !used).then(|| material.name.clone())
    };
    let unused: Vec<String> = scene
        .materials
        .iter()
        .zip(&used)
        .filter_map(unused)
        .collect();
    if !unused.is_empty() {
        hints.push(format!(
            "{} would emit, but no face has it",
            listed(&unused)
        ));
    }
    if !scene.has_light() {
        let lamps = scene
            .materials
            .iter()
            .zip(&used)
            .filter(|(m, used)| **used && is_called_lamp(&m.name));
        let lamps: Vec<String> = lamps.map(|(m, _)| m.name.clone()).collect();
        let material = if lamps.is_empty() {
            String::from("a material")
        } else {
            listed(&lamps)
        };
        hints.push(format!(
            "black: nothing gives light; make {material} emit with --emit MATERIAL=R,G,B or add a sky with --sky R,G,B",
        ));
    }
}

/// Emitters whose light does not get anywhere.
fn emitters(scene: &Scene, probe: &Probe, hints: &mut Vec<String>) {
    let lost = |fate: &Fate| fate.total > 0.0 && fate.share(fate.received) < 0.1;
    for (instance, fate) in scene
        .instances
        .iter()
        .zip(&probe.emission)
        .filter(|(_, fate)| lost(fate))
    {
        hints.push(format!(
            "emitter '{}' lights next to nothing: {} of its light ends on back sides, {} leaves the scene; if it faces the wrong way, --flip '{0}'",
            instance.node,
            percent(fate.share(fate.absorbed)),
            percent(fate.share(fate.escaped)),
        ));
    }
}

/// Lights and cameras that see mostly back sides: they are in a solid, or the walls face the wrong way.
fn lights_and_cameras(mesh: &PatchMesh, hints: &mut Vec<String>) {
    let scene = mesh.scene();
    let lights = scene.lights.iter().filter_map(|light| match light.kind {
        LightKind::Point { position, .. } | LightKind::Spot { position, .. } => {
            Some(("light", &light.name, position))
        }
        LightKind::Directional { .. } => None,
    });
    let cameras = scene
        .cameras
        .iter()
        .map(|Camera { name, eye, .. }| ("camera", name, *eye));
    let mostly_backs: Vec<String> = lights
        .chain(cameras)
        .filter(|&(_, _, place)| seen_around(mesh, place)[1] > 0.5)
        .map(|(what, name, _)| format!("{what} '{name}'"))
        .collect();
    if !mostly_backs.is_empty() {
        let verb = if mostly_backs.len() == 1 {
            "sees"
        } else {
            "see"
        };
        hints.push(format!(
            "{} {verb} mostly back sides, which stay black: inside a solid, or the walls face outward; turn them with --flip NODE ('*' for all) or use --double-sided",
            shortened(&mostly_backs),
        ));
    }
}

/// Light that back sides swallow.
fn backs(scene: &Scene, probe: &Probe, hints: &mut Vec<String>) {
    let on_backs: f64 = probe.on_backs.iter().sum();
    let absorbed = probe.surfaces.share(on_backs);
    if absorbed > 2.5 * NOTICEABLE {
        hints.push(format!(
            "leak: {} of reflected light ends on back sides, most of it on {}; if they face the wrong way, --flip NODE, or light both sides with --double-sided",
            percent(absorbed),
            listed(&largest(scene, &probe.on_backs, 0.05 * on_backs)),
        ));
    }
    let hidden: Vec<f64> = probe
        .instance_area
        .iter()
        .map(|&(area, hidden)| if hidden > 0.5 * area { hidden } else { 0.0 })
        .collect();
    let total: f64 = hidden.iter().sum();
    if total > NOTICEABLE * probe.area {
        hints.push(format!(
            "{} of the area faces into solids and gets no light, most of it of {}; if they face the wrong way, --flip NODE",
            percent(total / probe.area),
            listed(&largest(scene, &hidden, 0.0)),
        ));
    }
}

/// Light that leaves.
fn openness(scene: &Scene, probe: &Probe, hints: &mut Vec<String>) {
    let escaped = probe.surfaces.share(probe.surfaces.escaped);
    let has_sky = scene.sky.max_band() > 0.0;
    if escaped > 0.9 && !has_sky {
        hints.push(format!(
            "open: {} of reflected light leaves the scene; if this is a room, its walls face outward: --flip '*'; outdoors, add a sky with --sky R,G,B",
            percent(escaped)
        ));
    } else if escaped > NOTICEABLE {
        let what = if has_sky {
            "(the sky shines in there)"
        } else {
            "as through an open wall or gaps"
        };
        hints.push(format!(
            "open: {} of reflected light leaves the scene {what}",
            percent(escaped)
        ));
    }
    if escaped == 0.0 && has_sky {
        hints.push(String::from(
            "the sky does not get in: the scene is closed, or its windows are opaque",
        ));
    }
}

fn materials(scene: &Scene, hints: &mut Vec<String>) {
    let used = used_materials(scene);
    let of = |test: &dyn Fn(&Material) -> bool| -> Vec<String> {
        let chosen = scene
            .materials
            .iter()
            .zip(&used)
            .filter(|(material, used)| **used && test(material));
        chosen.map(|(material, _)| material.name.clone()).collect()
    };
    let opaque_glass = of(&|m| is_called_glass(&m.name) && !m.may_transmit());
    if !opaque_glass.is_empty() {
        hints.push(format!(
            "{} should be glass by its name but lets no light through; export it with KHR_materials_transmission or alpha blend, or --hide its nodes",
            listed(&opaque_glass)
        ));
    }
    let black = of(&|m| {
        !m.obstruction && m.base_color.max_band() < 1e-3 && !m.emits() && !m.may_transmit()
    });
    if !black.is_empty() {
        hints.push(format!(
            "{} reflects nothing; give it a reflectance with --reflectance MATERIAL=R,G,B",
            listed(&black)
        ));
    }
}

fn is_called_glass(name: &str) -> bool {
    let name = name.to_lowercase();
    ["glass", "window", "glazing"]
        .iter()
        .any(|word| name.contains(word))
        && !["frame", "sill", "fibre", "fiber"]
            .iter()
            .any(|word| name.contains(word))
}

fn is_called_lamp(name: &str) -> bool {
    let name = name.to_lowercase();
    ["light", "lamp", "bulb", "lumin", "emi"]
        .iter()
        .any(|word| name.contains(word))
}

/// For each material whether a placed face has it.
fn used_materials(scene: &Scene) -> Vec<bool> {
    let mut used = vec![false; scene.materials.len()];
    for instance in &scene.instances {
        used[scene.meshes[instance.mesh].material] = true;
    }
    used
}

/// Names of the instances with the largest values above a bound.
fn largest(scene: &Scene, values: &[f64], above: f64) -> Vec<String> {
    let mut order: Vec<usize> = (0..values.len()).filter(|&i| values[i] > above).collect();
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    let mut names: Vec<String> = Vec::new();
    for i in order {
        let name = &scene.instances[i].node;
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}

fn listed(names: &[String]) -> String {
    shortened(
        &names
            .iter()
            .map(|name| format!("'{name}'"))
            .collect::<Vec<_>>(),
    )
}

fn shortened(names: &[String]) -> String {
    let mut text = names
        .iter()
        .take(LISTED)
        .cloned()
        .collect::<Vec<_>>()
        .join(", ");
    if names.len() > LISTED {
        text.push_str(&format!(" and {} more", names.len() - LISTED));
    }
    text
}
