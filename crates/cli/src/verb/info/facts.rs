//! What is in a scene.

use super::device;
use super::probe::Probe;
use crate::failure::one_line;
use crate::report::{Warnings, counted, counted_patches, cut_along, factors, grouped};
use crate::solving::percent;
use glam::Vec3;
use hemicube::radiosity::patch::NodeKind;
use hemicube::radiosity::patch::constraints::CutCounts;
use hemicube::radiosity::solution::Provenance;
use hemicube::radiosity::{PatchMesh, Solution};
use hemicube::raster::Rgb;
use hemicube::scene::{LightKind, Material, Scene, Units};
use serde::Serialize;
use std::fmt::Write as _;
use std::sync::Arc;

/// Materials that people get to read about; `--json` has all of them.
const SHOWN_MATERIALS: usize = 40;

/// Everything that `info` tells.
#[derive(Debug, Serialize)]
pub struct Facts {
    name: String,
    units: &'static str,
    meshes: usize,
    instances: usize,
    faces: usize,
    bounds: Option<[Vec3; 2]>,
    textures: usize,
    materials: Vec<MaterialFacts>,
    lights: Vec<LightFacts>,
    sky: Rgb,
    max_reflectance: f32,
    cameras: Vec<String>,
    mesh: Option<MeshFacts>,
    solution: Option<SolutionFacts>,
    warnings: Warnings,
    /// Why it would stay black or leak.
    pub hints: Vec<String>,
}

#[derive(Debug, Serialize)]
struct MaterialFacts {
    name: String,
    faces: usize,
    /// Mean over its lit faces, textures included; the base colour as long as there is no mesh.
    reflectance: Rgb,
    textured: bool,
    emission: Rgb,
    transmission: f32,
    metallic: f32,
    double_sided: bool,
    obstruction: bool,
}

#[derive(Debug, Serialize)]
struct LightFacts {
    name: String,
    kind: &'static str,
    strength: Rgb,
    unit: &'static str,
}

#[derive(Debug, Serialize)]
struct MeshFacts {
    elements: usize,
    patches: usize,
    cuts: CutCounts,
    area: f64,
    buried_share: f64,
    escaped_share: f64,
    absorbed_by_backs_share: f64,
    /// To solve it on a GPU.
    gpu_memory_bytes: u64,
}

#[derive(Debug, Serialize)]
struct SolutionFacts {
    #[serde(flatten)]
    provenance: Provenance,
    unshot_fraction: f64,
    light_groups: Vec<String>,
}

impl Facts {
    /// What a scene tells without its mesh.
    pub fn of_scene(scene: &Scene) -> Self {
        Self {
            name: scene.name.clone(),
            units: scene.units.name(),
            meshes: scene.meshes.len(),
            instances: scene.instances.len(),
            faces: scene.face_count(),
            bounds: scene.bounds().map(|(low, high)| [low, high]),
            textures: scene.textures.len(),
            materials: materials(scene),
            lights: lights(scene),
            sky: scene.sky,
            max_reflectance: scene.max_reflectance,
            cameras: scene.cameras.iter().map(|c| c.name.clone()).collect(),
            mesh: None,
            solution: None,
            warnings: Warnings::of_scene(scene),
            hints: Vec::new(),
        }
    }

    /// What its mesh and the rays in it tell.
    pub fn add_mesh(&mut self, mesh: &Arc<PatchMesh>, probe: &Probe) {
        self.warnings.extend(mesh.report());
        for (material, mean) in self.materials.iter_mut().zip(mean_reflectance(mesh)) {
            material.reflectance = mean.unwrap_or(material.reflectance);
        }
        self.mesh = Some(MeshFacts {
            elements: mesh.elements().len(),
            patches: mesh.patches().len(),
            cuts: mesh.cuts(),
            area: probe.area,
            buried_share: probe.buried / probe.area,
            escaped_share: probe.surfaces.share(probe.surfaces.escaped),
            absorbed_by_backs_share: probe.surfaces.share(probe.surfaces.absorbed),
            gpu_memory_bytes: device::memory(mesh, 1),
        });
    }

    /// How the light of a lit .glb was obtained.
    pub fn add_solution(&mut self, solution: &Solution) {
        if let Some(mesh) = &mut self.mesh {
            mesh.gpu_memory_bytes = device::memory(solution.mesh(), solution.groups().len());
        }
        self.solution = Some(SolutionFacts {
            provenance: solution.provenance.clone(),
            unshot_fraction: solution.unshot_fraction(),
            light_groups: solution.groups().iter().map(|g| g.name.clone()).collect(),
        });
    }

    /// As JSON.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::to_value(self).expect("facts are plain numbers and text")
    }

    /// As lines for people.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let _ = writeln!(text, "scene     {} ({})", one_line(&self.name), self.units);
        let _ = writeln!(
            text,
            "geometry  {}, {}, {}, {}",
            match self.meshes {
                1 => String::from("1 mesh"),
                n => format!("{} meshes", grouped(n as u64)),
            },
            counted(self.instances as u64, "instance"),
            counted(self.faces as u64, "face"),
            counted(self.textures as u64, "texture")
        );
        if let Some([low, high]) = self.bounds {
            let _ = writeln!(
                text,
                "bounds    {} to {}, size {}",
                point(low),
                point(high),
                point(high - low)
            );
        }
        self.write_mesh(&mut text);
        self.write_solution(&mut text);
        self.write_light(&mut text);
        let cameras = if self.cameras.is_empty() {
            String::from("none")
        } else {
            one_line(&self.cameras.join(", "))
        };
        let _ = writeln!(text, "cameras   {cameras}");
        self.write_materials(&mut text);
        text.push_str(&self.warnings.text());
        for hint in &self.hints {
            let _ = writeln!(text, "hint: {}", one_line(hint));
        }
        if self.hints.is_empty() {
            text.push_str("no reason found why it would stay black or leak\n");
        }
        text
    }

    fn write_mesh(&self, text: &mut String) {
        let Some(mesh) = &self.mesh else { return };
        let whose = if self.solution.is_some() {
            ""
        } else {
            " in a normal solve"
        };
        let _ = writeln!(
            text,
            "mesh      {}, {}{}{whose}; lit area {}",
            counted(mesh.elements as u64, "element"),
            counted_patches(mesh.patches),
            cut_along(mesh.cuts),
            short(mesh.area),
        );
        let _ = writeln!(
            text,
            "light     of what leaves the surfaces {} escapes, {} ends on back sides; {} of the area faces into solids",
            percent(mesh.escaped_share),
            percent(mesh.absorbed_by_backs_share),
            percent(mesh.buried_share)
        );
        let _ = writeln!(
            text,
            "gpu       {:.1} MiB to solve it on a GPU with hemicubes of 256 cells an edge",
            mesh.gpu_memory_bytes as f64 / f64::from(1 << 20)
        );
    }

    fn write_solution(&self, text: &mut String) {
        let Some(solution) = &self.solution else {
            return;
        };
        let from = &solution.provenance;
        let _ = writeln!(
            text,
            "solution  {}, {}, seed {}: {}, {}, {:.1} s; {} unshot",
            one_line(&from.solver),
            factors(
                &from.form_factors,
                from.rays_per_hemisphere,
                from.shot_rays,
                from.hemicube_resolution
            ),
            from.seed,
            counted(from.steps, "step"),
            counted(from.rays, "ray"),
            from.seconds,
            percent(solution.unshot_fraction)
        );
    }

    fn write_light(&self, text: &mut String) {
        for light in &self.lights {
            let _ = writeln!(
                text,
                "light     {} '{}' {} {}",
                light.kind,
                one_line(&light.name),
                rgb(light.strength),
                light.unit
            );
        }
        let radiance = if self.units == Units::Photometric.name() {
            "cd/m²"
        } else {
            "W/(m² sr)"
        };
        for material in self
            .materials
            .iter()
            .filter(|m| m.faces > 0 && m.emission.max_band() > 0.0)
        {
            let name = one_line(&material.name);
            let _ = writeln!(
                text,
                "light     material '{name}' {} {radiance} on {}",
                rgb(material.emission),
                counted(material.faces as u64, "face")
            );
        }
        if self.sky.max_band() > 0.0 {
            let _ = writeln!(text, "light     sky {} {radiance}", rgb(self.sky));
        }
    }

    fn write_materials(&self, text: &mut String) {
        let used = || self.materials.iter().filter(|m| m.faces > 0);
        let width = used()
            .take(SHOWN_MATERIALS)
            .map(|m| m.name.chars().count())
            .max()
            .unwrap_or(0)
            .clamp(8, 32);
        let _ = writeln!(
            text,
            "{:width$}  {:>9}  mean reflectance",
            "material", "faces"
        );
        for material in used().take(SHOWN_MATERIALS) {
            let _ = writeln!(
                text,
                "{:width$}  {:>9}  {}",
                one_line(&material.name),
                grouped(material.faces as u64),
                material.words()
            );
        }
        let more = used().count().saturating_sub(SHOWN_MATERIALS);
        if more > 0 {
            let _ = writeln!(text, "and {more} materials more; --json lists them");
        }
    }
}

impl MaterialFacts {
    fn words(&self) -> String {
        if self.obstruction {
            return String::from("only blocks");
        }
        let mut words = rgb(self.reflectance);
        if self.textured {
            words.push_str(", textured");
        }
        if self.transmission > 0.0 {
            let _ = write!(
                words,
                ", lets {} through",
                percent(self.transmission.into())
            );
        }
        if self.metallic > 0.0 {
            words.push_str(", metal");
        }
        if self.emission.max_band() > 0.0 {
            words.push_str(", emits");
        }
        words.push_str(if self.double_sided {
            ", both sides"
        } else {
            ""
        });
        words
    }
}

fn materials(scene: &Scene) -> Vec<MaterialFacts> {
    let mut faces = vec![0; scene.materials.len()];
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        faces[mesh.material] += mesh.faces.len();
    }
    let facts = |(material, faces): (&Material, usize)| MaterialFacts {
        name: material.name.clone(),
        faces,
        reflectance: material
            .base_color
            .map(|band| band.min(scene.max_reflectance)),
        textured: material.base_color_texture.is_some(),
        emission: material.emission,
        transmission: match material.alpha_mode {
            hemicube::scene::AlphaMode::Blend => 1.0 - material.alpha,
            _ => material.transmission,
        },
        metallic: material.metallic,
        double_sided: material.double_sided,
        obstruction: material.obstruction,
    };
    scene.materials.iter().zip(faces).map(facts).collect()
}

/// Area-weighted mean reflectance of each material's elements.
fn mean_reflectance(mesh: &PatchMesh) -> Vec<Option<Rgb>> {
    let mut sums = vec![(Rgb::BLACK, 0.0); mesh.scene().materials.len()];
    for (&id, &reflectance) in mesh.elements().iter().zip(mesh.reflectance()) {
        let node = mesh.node(id);
        if let NodeKind::Surface { face, .. } = node.kind {
            let (sum, area) = &mut sums[mesh.faces()[face as usize].material as usize];
            *sum += reflectance * node.area;
            *area += node.area;
        }
    }
    sums.into_iter()
        .map(|(sum, area)| (area > 0.0).then(|| sum / area))
        .collect()
}

fn lights(scene: &Scene) -> Vec<LightFacts> {
    let photometric = scene.units == Units::Photometric;
    let candela = if photometric { "cd" } else { "W/sr" };
    scene
        .lights
        .iter()
        .map(|light| {
            let (kind, strength, unit) = match light.kind {
                LightKind::Point { intensity, .. } => ("point", intensity, candela),
                LightKind::Spot { intensity, .. } => ("spot", intensity, candela),
                LightKind::Directional { irradiance, .. } => (
                    "sun",
                    irradiance,
                    crate::report::irradiance_unit(scene.units),
                ),
            };
            LightFacts {
                name: light.name.clone(),
                kind,
                strength,
                unit,
            }
        })
        .collect()
}

fn point(p: Vec3) -> String {
    let [x, y, z] = p.to_array().map(|c| short(c.into()));
    format!("({x}, {y}, {z})")
}

fn rgb(color: Rgb) -> String {
    let [r, g, b] = color.to_array().map(|c| short(c.into()));
    if r == g && g == b {
        r
    } else {
        format!("{r},{g},{b}")
    }
}

/// A number with about four significant digits.
fn short(x: f64) -> String {
    let decimals: i32 = match x.abs() {
        a if a >= 1000.0 => 0,
        a if a >= 100.0 => 1,
        a if a >= 10.0 => 2,
        _ => 3,
    };
    // Adding 0 takes the sign off what rounds to -0.
    let rounded = (x * 10_f64.powi(decimals)).round() / 10_f64.powi(decimals) + 0.0;
    rounded.to_string()
}
