//! The node hierarchy: where meshes, cameras and lights stand.

use super::extension::{self, Instancing, LightOfNode, Lights, Visibility};
use super::geometry::Geometry;
use super::{Source, light, name_or};
use crate::open::no_triangles;
use crate::{ImportReport, Instance, Scene};
use glam::{Affine3A, DAffine3, DMat4, DQuat, DVec3, DVec4};
use gltf::json::scene::Node;
use serde_json::Value;

/// More instances than a scene of this size can be meant to have.
const MAX_INSTANCES: usize = 10_000_000;

/// Walks the scene and fills in instances with their meshes, cameras and lights.
pub fn read_scene(source: Source<'_>, scene: &mut Scene) -> Result<(), String> {
    let lights: Option<Lights> = extension::read(
        source.root.extensions.as_ref().map(|e| &e.others),
        "KHR_lights_punctual",
        "document",
        &mut scene.report,
    );
    let lights = lights.unwrap_or_default().lights;
    let mut reader = Reader {
        source,
        lights,
        geometry: Geometry::new(source),
        scene,
    };
    walk(source, &mut reader)?;
    if reader.scene.instances.is_empty() {
        return Err(no_triangles(&reader.scene.report));
    }
    Ok(())
}

/// Where the walk is in a node: its number, its next child, and where it stands.
struct Level {
    node: usize,
    next_child: usize,
    world_from_node: DAffine3,
}

/// What the walk knows of a node.
#[derive(Clone, Copy, PartialEq)]
enum State {
    Unseen,
    /// The walk is below it.
    Open,
    Done,
}

/// Visits every node of the scene once, parents first, without recursion.
fn walk(source: Source<'_>, reader: &mut Reader<'_, '_>) -> Result<(), String> {
    let nodes = &source.root.nodes;
    let mut states = vec![State::Unseen; nodes.len()];
    for root in roots(source)? {
        let mut path: Vec<Level> = Vec::new();
        if let Some(level) = enter(root, None, nodes, &mut states, reader)? {
            path.push(level);
        }
        while let Some(level) = path.last_mut() {
            let children = nodes[level.node].children.as_deref().unwrap_or_default();
            let Some(child) = children.get(level.next_child) else {
                states[level.node] = State::Done;
                path.pop();
                continue;
            };
            level.next_child += 1;
            let parent = (level.node, level.world_from_node);
            if let Some(level) = enter(child.value(), Some(parent), nodes, &mut states, reader)? {
                path.push(level);
            }
        }
    }
    Ok(())
}

/// Reads a node, unless it was there before; a node below itself is refused.
fn enter(
    node: usize,
    parent: Option<(usize, DAffine3)>,
    nodes: &[Node],
    states: &mut [State],
    reader: &mut Reader<'_, '_>,
) -> Result<Option<Level>, String> {
    let asked_by = || {
        parent.map_or_else(
            || String::from("scene"),
            |(parent, _)| format!("node {parent}"),
        )
    };
    match states.get(node) {
        None => {
            return Err(format!(
                "{}: node {node} of {}; export the file again",
                asked_by(),
                nodes.len()
            ));
        }
        Some(State::Open) => {
            return Err(format!(
                "{}: node {node} is below itself; export the file again",
                asked_by()
            ));
        }
        Some(State::Done) => {
            let what = format!(
                "{} has it too; it is placed once, where it was first",
                asked_by()
            );
            reader.scene.report.warn(format!("node {node}"), what);
            return Ok(None);
        }
        Some(State::Unseen) => {}
    }
    states[node] = State::Open;
    let name = name_or(nodes[node].name.as_ref(), "node", node);
    let world_from_parent = parent.map_or(DAffine3::IDENTITY, |(_, world)| world);
    let world_from_node =
        world_from_parent * parent_from_node(&nodes[node], &name, &mut reader.scene.report);
    let others = nodes[node].extensions.as_ref().map(|e| &e.others);
    let visibility: Option<Visibility> = extension::read(
        others,
        "KHR_node_visibility",
        &format!("node '{name}'"),
        &mut reader.scene.report,
    );
    if visibility.is_some_and(|v| !v.visible) {
        let what = "KHR_node_visibility hides it and what is below it; left out";
        reader.scene.report.warn(format!("node '{name}'"), what);
        states[node] = State::Done;
        return Ok(None);
    }
    reader.read(&nodes[node], &name, &world_from_node)?;
    Ok(Some(Level {
        node,
        next_child: 0,
        world_from_node,
    }))
}

/// Where the walk begins: the default scene, the first one, or every node that is no one's child.
fn roots(source: Source<'_>) -> Result<Vec<usize>, String> {
    let root = source.root;
    let number = root.scene.map_or(0, |scene| scene.value());
    match root.scenes.get(number) {
        Some(scene) => Ok(scene.nodes.iter().map(|node| node.value()).collect()),
        None if root.scenes.is_empty() && root.scene.is_none() => {
            let mut is_child = vec![false; root.nodes.len()];
            for child in root
                .nodes
                .iter()
                .filter_map(|node| node.children.as_ref())
                .flatten()
            {
                if let Some(flag) = is_child.get_mut(child.value()) {
                    *flag = true;
                }
            }
            Ok((0..root.nodes.len())
                .filter(|&node| !is_child[node])
                .collect())
        }
        None => Err(format!(
            "scene {number} of {}; export the file again",
            root.scenes.len()
        )),
    }
}

/// A node's transform: its matrix, or `translation * rotation * scale`.
fn parent_from_node(node: &Node, name: &str, report: &mut ImportReport) -> DAffine3 {
    if let Some(matrix) = node.matrix {
        let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
        if matrix.row(3) != DVec4::W {
            report.warn(
                format!("node '{name}'"),
                "its matrix is projective; its last row is taken as 0 0 0 1",
            );
        }
        return DAffine3::from_mat4(DMat4 {
            x_axis: matrix.x_axis.truncate().extend(0.0),
            y_axis: matrix.y_axis.truncate().extend(0.0),
            z_axis: matrix.z_axis.truncate().extend(0.0),
            w_axis: matrix.w_axis.truncate().extend(1.0),
        });
    }
    let vector = |v: Option<[f32; 3]>| v.map(|v| DVec3::from(v.map(f64::from)));
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |q| {
        let rotation = unit_quaternion(q.0);
        if rotation.is_none() {
            report.warn(
                format!("node '{name}'"),
                format!("rotation {:?} is none; left out", q.0),
            );
        }
        rotation.unwrap_or(DQuat::IDENTITY)
    });
    let (scale, translation) = (
        vector(node.scale).unwrap_or(DVec3::ONE),
        vector(node.translation).unwrap_or(DVec3::ZERO),
    );
    DAffine3::from_scale_rotation_translation(scale, rotation, translation)
}

/// The rotation of a quaternion of any length but 0.
fn unit_quaternion(q: [f32; 4]) -> Option<DQuat> {
    let q = DVec4::from(q.map(f64::from)).try_normalize()?;
    Some(DQuat::from_vec4(q))
}

struct Reader<'a, 's> {
    source: Source<'a>,
    lights: Vec<Value>,
    geometry: Geometry<'a>,
    scene: &'s mut Scene,
}

impl Reader<'_, '_> {
    /// What a node carries.
    fn read(&mut self, node: &Node, name: &str, world_from_node: &DAffine3) -> Result<(), String> {
        if let Some(mesh) = node.mesh {
            let meshes = self
                .geometry
                .meshes(mesh.value(), self.scene)
                .map_err(|e| format!("node '{name}': {e}"))?;
            for world_from_mesh in self.placements(node, name, world_from_node) {
                self.place(name, &meshes, &world_from_mesh)?;
            }
        }
        if let Some(camera) = node.camera {
            self.read_camera(camera.value(), node, name, world_from_node);
        }
        let others = node.extensions.as_ref().map(|e| &e.others);
        let place = format!("node '{name}'");
        let light: Option<LightOfNode> = extension::read(
            others,
            "KHR_lights_punctual",
            &place,
            &mut self.scene.report,
        );
        if let Some(LightOfNode { light: index }) = light {
            match self.lights.get(index) {
                Some(from) => {
                    let light =
                        light::light(from, index, name, world_from_node, &mut self.scene.report);
                    self.scene.lights.extend(light);
                }
                None => self.scene.report.warn(
                    place,
                    format!("light {index} of {}; left out", self.lights.len()),
                ),
            }
        }
        Ok(())
    }

    fn read_camera(&mut self, index: usize, node: &Node, name: &str, world_from_node: &DAffine3) {
        let Some(camera) = self.source.root.cameras.get(index) else {
            let count = self.source.root.cameras.len();
            self.scene.report.warn(
                format!("node '{name}'"),
                format!("camera {index} of {count}; left out"),
            );
            return;
        };
        let camera_name = node.name.as_ref().or(camera.name.as_ref());
        let camera_name = name_or(camera_name, "camera", index);
        let camera = light::camera(camera, camera_name, world_from_node, &mut self.scene.report);
        self.scene.cameras.extend(camera);
    }

    /// World from mesh for each copy of the node's mesh: one, or those of `EXT_mesh_gpu_instancing`.
    fn placements(&mut self, node: &Node, name: &str, world_from_node: &DAffine3) -> Vec<DAffine3> {
        let others = node.extensions.as_ref().map(|e| &e.others);
        let place = format!("node '{name}'");
        let report = &mut self.scene.report;
        let copies: Option<Instancing> =
            extension::read(others, "EXT_mesh_gpu_instancing", &place, report);
        match copies.map(|copies| copies_from_node(self.source, &copies)) {
            None => vec![*world_from_node],
            Some(Ok(copies)) => copies
                .into_iter()
                .map(|copy| *world_from_node * copy)
                .collect(),
            Some(Err(what)) => {
                report.warn(
                    place,
                    format!("EXT_mesh_gpu_instancing: {what}; the mesh is placed once"),
                );
                vec![*world_from_node]
            }
        }
    }

    fn place(
        &mut self,
        name: &str,
        meshes: &[usize],
        world_from_mesh: &DAffine3,
    ) -> Result<(), String> {
        let world_from_mesh = Affine3A::from_mat4(DMat4::from(*world_from_mesh).as_mat4());
        if !world_from_mesh.is_finite() {
            self.scene.report.warn(
                format!("node '{name}'"),
                "its transform is not finite; its mesh is left out",
            );
            return Ok(());
        }
        if self.scene.instances.len() + meshes.len() > MAX_INSTANCES {
            return Err(format!(
                "node '{name}': more than {MAX_INSTANCES} placed meshes; split the scene"
            ));
        }
        let placed = |&mesh: &usize| Instance {
            node: String::from(name),
            mesh,
            world_from_mesh,
            flipped: false,
        };
        self.scene.instances.extend(meshes.iter().map(placed));
        Ok(())
    }
}

/// The transforms of `EXT_mesh_gpu_instancing`.
fn copies_from_node(source: Source<'_>, copies: &Instancing) -> Result<Vec<DAffine3>, String> {
    let accessors = &copies.attributes;
    let read = |index: Option<usize>| index.map(|index| source.elements(index)).transpose();
    let (translations, rotations, scales) = (
        read(accessors.translation)?,
        read(accessors.rotation)?,
        read(accessors.scale)?,
    );
    let rotations = rotations.map(super::accessor::Elements::with_normalized);
    let all = [&translations, &rotations, &scales];
    let count = all
        .iter()
        .filter_map(|e| e.as_ref())
        .map(|e| e.count)
        .next()
        .ok_or("it has no attributes")?;
    if all
        .iter()
        .filter_map(|e| e.as_ref())
        .any(|e| e.count != count)
    {
        return Err(String::from("its attributes have different counts"));
    }
    if count > MAX_INSTANCES {
        return Err(format!("{count} copies are more than {MAX_INSTANCES}"));
    }
    let transform = |i: usize| {
        let translation = translations.as_ref().map_or(DVec3::ZERO, |e| {
            DVec3::from(e.vector::<3>(i).map(f64::from))
        });
        let scale = scales
            .as_ref()
            .map_or(DVec3::ONE, |e| DVec3::from(e.vector::<3>(i).map(f64::from)));
        let rotation = rotations
            .as_ref()
            .and_then(|e| unit_quaternion(e.vector::<4>(i)));
        DAffine3::from_scale_rotation_translation(
            scale,
            rotation.unwrap_or(DQuat::IDENTITY),
            translation,
        )
    };
    Ok((0..count).map(transform).collect())
}
