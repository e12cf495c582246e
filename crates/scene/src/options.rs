//! Adjusting a scene to what the user asked for.
//!
//! [`SceneOptions`] hold what the command line and other callers can ask, [`Scene::apply`] does it. The parsers
//! ([`parse_rgb`], [`parse_named_rgb`] and `FromStr` of the enums) are here, so that all callers speak the same language.

use crate::scene::{MAX_LIGHT, Units};
use crate::{Camera, LightKind, Material, Projection, Scene, SceneError};
use glam::{Affine3A, Mat3, Vec3};
use hemicube_raster::Rgb;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;
use wildmatch::WildMatch;

/// Names that an error message lists before it only counts them.
const LISTED: usize = 12;

/// How a scene is adjusted before anything is computed; see [`Scene::apply`].
///
/// Names are globs: `*` stands for any text, `?` for one character, case matters. A glob that matches nothing is an
/// error.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneOptions {
    /// Materials and the radiance L they emit from now on; their emission texture goes. The last match wins.
    ///
    /// Default value: none.
    pub emit: Vec<(String, Rgb)>,
    /// Uniform sky radiance.
    ///
    /// Default value: that of the scene.
    pub sky: Option<Rgb>,
    /// Materials and their reflectance: it replaces base colour, its texture (with the texture's holes) and the colour
    /// of vertices, and the material is no metal any more. Transmission stays. The last match wins.
    ///
    /// Default value: none.
    pub reflectance: Vec<(String, Rgb)>,
    /// Nodes that are left out.
    ///
    /// Default value: none.
    pub hide: Vec<String>,
    /// Nodes whose faces are turned around, once however many globs match.
    ///
    /// Default value: none.
    pub flip: Vec<String>,
    /// Makes all materials double-sided.
    ///
    /// Default value: false.
    pub double_sided: bool,
    /// Unit of length of the file; the scene is scaled to metres. Intensities of lights keep their value.
    ///
    /// Default value: lengths stay as they are.
    pub unit: Option<Unit>,
    /// Which axis of the file points up; `Z` turns the world so that it becomes +Y.
    ///
    /// Default value: the scene stays as it is.
    pub up: Option<UpAxis>,
    /// What the numbers of light mean.
    ///
    /// Default value: as the scene says.
    pub units: Option<Units>,
    /// What metals do as long as nothing specular is solved.
    ///
    /// Default value: [`MetalsAs::Diffuse`].
    pub metals: MetalsAs,
    /// Bound to which larger reflectances are lowered, above 0 and at most 1.
    ///
    /// Default value: 0.98.
    pub max_reflectance: f32,
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self {
            emit: Vec::new(),
            sky: None,
            reflectance: Vec::new(),
            hide: Vec::new(),
            flip: Vec::new(),
            double_sided: false,
            unit: None,
            up: None,
            units: None,
            metals: MetalsAs::default(),
            max_reflectance: MAX_REFLECTANCE,
        }
    }
}

/// Bound of the reflectance unless asked otherwise: a closed scene then settles within a few hundred reflections.
pub(crate) const MAX_REFLECTANCE: f32 = 0.98;

impl SceneOptions {
    /// Lets the materials of a name emit radiance L.
    pub fn with_emit(mut self, material: impl Into<String>, radiance: Rgb) -> Self {
        self.emit.push((material.into(), radiance));
        self
    }

    /// Surrounds the scene with a sky of uniform radiance.
    pub fn with_sky(mut self, radiance: Rgb) -> Self {
        self.sky = Some(radiance);
        self
    }

    /// Gives the materials of a name this diffuse reflectance.
    pub fn with_reflectance(mut self, material: impl Into<String>, reflectance: Rgb) -> Self {
        self.reflectance.push((material.into(), reflectance));
        self
    }

    /// Leaves out the nodes of a name.
    pub fn with_hide(mut self, node: impl Into<String>) -> Self {
        self.hide.push(node.into());
        self
    }

    /// Turns around the faces of the nodes of a name.
    pub fn with_flip(mut self, node: impl Into<String>) -> Self {
        self.flip.push(node.into());
        self
    }

    /// Makes all materials double-sided, or leaves them as they are.
    pub fn with_double_sided(mut self, double_sided: bool) -> Self {
        self.double_sided = double_sided;
        self
    }

    /// Says in which unit the file gives lengths.
    pub fn with_unit(mut self, unit: Unit) -> Self {
        self.unit = Some(unit);
        self
    }

    /// Says which axis of the file points up.
    pub fn with_up(mut self, up: UpAxis) -> Self {
        self.up = Some(up);
        self
    }

    /// Says what the numbers of light mean.
    pub fn with_units(mut self, units: Units) -> Self {
        self.units = Some(units);
        self
    }

    /// Says what metals do.
    pub fn with_metals(mut self, metals: MetalsAs) -> Self {
        self.metals = metals;
        self
    }

    /// Lowers larger reflectances to this bound.
    pub fn with_max_reflectance(mut self, bound: f32) -> Self {
        self.max_reflectance = bound;
        self
    }
}

/// What metals do as long as nothing specular is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum MetalsAs {
    /// They count as diffuse with their base colour in full.
    #[default]
    Diffuse,
    /// They reflect nothing: diffuse reflectance is base colour × (1 - metallic).
    Black,
}

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Unit {
    /// 0.001 m.
    Millimetre,
    /// 0.01 m.
    Centimetre,
    /// 1 m.
    Metre,
    /// 0.0254 m.
    Inch,
    /// 0.3048 m.
    Foot,
}

impl Unit {
    /// Its length in metres.
    pub fn metres(self) -> f32 {
        match self {
            Self::Millimetre => 0.001,
            Self::Centimetre => 0.01,
            Self::Metre => 1.0,
            Self::Inch => 0.0254,
            Self::Foot => 0.3048,
        }
    }
}

/// An axis that points up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum UpAxis {
    /// +Y, as in glTF.
    Y,
    /// +Z, as in CAD and GIS.
    Z,
}

/// `NAMES`, `Display` and `FromStr` of an enum that the user chooses from.
macro_rules! choice {
    ($type:ident, $what:literal, $($variant:ident = $name:literal),+) => {
        impl $type {
            /// The names by which a user chooses.
            pub const NAMES: &[&str] = &[$($name),+];

            /// The name by which a user chooses it.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }
        }

        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.pad(self.name())
            }
        }

        impl FromStr for $type {
            type Err = String;

            /// Reads one of [`NAMES`](Self::NAMES), in lower or upper case.
            fn from_str(text: &str) -> Result<Self, String> {
                match text.trim() {
                    $(name if name.eq_ignore_ascii_case($name) => Ok(Self::$variant),)+
                    _ => Err(format!("{} is no {}; use one of {}", quoted(text), $what, Self::NAMES.join(", "))),
                }
            }
        }
    };
}
choice!(
    MetalsAs,
    "way to count metals",
    Diffuse = "diffuse",
    Black = "black"
);
choice!(
    Unit,
    "unit of length",
    Millimetre = "mm",
    Centimetre = "cm",
    Metre = "m",
    Inch = "in",
    Foot = "ft"
);
choice!(UpAxis, "axis that can point up", Y = "y", Z = "z");
choice!(
    Units,
    "kind of light units",
    Photometric = "photometric",
    Radiometric = "radiometric"
);

/// Reads a colour: `R,G,B`, or one number for all three bands.
///
/// ```
/// use hemicube_scene::options::parse_rgb;
/// assert_eq!(parse_rgb("1, 0.5, 0").unwrap().to_array(), [1.0, 0.5, 0.0]);
/// assert_eq!(parse_rgb("0.5").unwrap().to_array(), [0.5; 3]);
/// ```
pub fn parse_rgb(text: &str) -> Result<Rgb, String> {
    let wanted = |what: String| format!("{what}; use R,G,B or one number for all three bands");
    let bands: Vec<f32> = text
        .split(',')
        .map(|band| match band.trim().parse::<f32>() {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err(wanted(format!(
                "{} in {} is not a finite number",
                quoted(band.trim()),
                quoted(text)
            ))),
            Err(_) => Err(wanted(format!(
                "{} in {} is not a number",
                quoted(band.trim()),
                quoted(text)
            ))),
        })
        .collect::<Result<_, _>>()?;
    match bands[..] {
        [grey] => Ok(Rgb::splat(grey)),
        [r, g, b] => Ok(Rgb::new(r, g, b)),
        _ => Err(wanted(format!(
            "{} has {} numbers, not 3",
            quoted(text),
            bands.len()
        ))),
    }
}

/// Reads `MATERIAL=R,G,B` or `MATERIAL=X`; the name may contain `=`, the last one counts.
///
/// ```
/// use hemicube_scene::options::parse_named_rgb;
/// let (name, radiance) = parse_named_rgb("lamp*=17,12,4").unwrap();
/// assert_eq!((name.as_str(), radiance.to_array()), ("lamp*", [17.0, 12.0, 4.0]));
/// ```
pub fn parse_named_rgb(text: &str) -> Result<(String, Rgb), String> {
    match text.rsplit_once('=') {
        Some((name, color)) if !name.is_empty() => Ok((name.to_owned(), parse_rgb(color)?)),
        Some(_) => Err(format!(
            "{} has no name before '='; use NAME=R,G,B or NAME=X",
            quoted(text)
        )),
        None => Err(format!(
            "{} has no '='; use NAME=R,G,B or NAME=X",
            quoted(text)
        )),
    }
}

/// Text in quotes, on one line whatever it contains.
fn quoted(text: &str) -> String {
    let escape = |c: char| {
        if c.is_control() {
            c.escape_default().to_string()
        } else {
            c.to_string()
        }
    };
    format!("'{}'", text.chars().map(escape).collect::<String>())
}

impl Scene {
    /// Adjusts the scene.
    ///
    /// Everything asked is checked first, against the scene as it came: an error leaves it untouched. Then, in this
    /// order: materials (emission, reflectance, sides), sky, units of light, metals, bound of the reflectance; nodes are
    /// turned around, then hidden; at last the world is scaled to metres and turned up. The report then tells which
    /// metals count as diffuse and which reflectances are lowered; the numbers themselves are kept and
    /// [`surface_at`](Self::surface_at) follows [`metals`](Self::metals) and [`max_reflectance`](Self::max_reflectance).
    ///
    /// # Errors
    /// A glob that matches nothing, a number that is negative, not finite or out of range.
    pub fn apply(&mut self, options: &SceneOptions) -> Result<(), SceneError> {
        self.check_options(options).map_err(SceneError::Check)?;
        self.apply_to_materials(options);
        self.sky = options.sky.unwrap_or(self.sky);
        self.units = options.units.unwrap_or(self.units);
        self.metals = options.metals;
        self.max_reflectance = options.max_reflectance;
        self.apply_to_nodes(options);
        let scale = options.unit.map_or(1.0, Unit::metres);
        let rotation = options.up.map_or(Mat3::IDENTITY, y_up_from_file);
        if scale != 1.0 || rotation != Mat3::IDENTITY {
            self.transform_world(scale, rotation);
        }
        self.report_metals();
        self.report_lowered();
        Ok(())
    }

    fn check_options(&self, options: &SceneOptions) -> Result<(), String> {
        let materials: Vec<&str> = self.materials.iter().map(|m| m.name.as_str()).collect();
        let nodes: Vec<&str> = self.instances.iter().map(|i| i.node.as_str()).collect();
        for (glob, radiance) in &options.emit {
            matches_something(glob, "emit", "material", &materials)?;
            in_range(
                *radiance,
                &format!("emit {}: radiance", quoted(glob)),
                MAX_LIGHT,
            )?;
        }
        for (glob, reflectance) in &options.reflectance {
            matches_something(glob, "reflectance", "material", &materials)?;
            in_range(*reflectance, &format!("reflectance {}:", quoted(glob)), 1.0)?;
        }
        for (globs, option) in [(&options.hide, "hide"), (&options.flip, "flip")] {
            for glob in globs {
                matches_something(glob, option, "node", &nodes)?;
            }
        }
        if let Some(radiance) = options.sky {
            in_range(radiance, "sky: radiance", MAX_LIGHT)?;
        }
        let bound = options.max_reflectance;
        if !(bound > 0.0 && bound <= 1.0) {
            return Err(format!(
                "max-reflectance {bound} is not above 0 and at most 1"
            ));
        }
        Ok(())
    }

    fn apply_to_materials(&mut self, options: &SceneOptions) {
        for (i, material) in self.materials.iter_mut().enumerate() {
            if let Some(radiance) = last_match(&options.emit, &material.name) {
                material.emission = radiance;
                material.emission_texture = None;
            }
            if let Some(reflectance) = last_match(&options.reflectance, &material.name) {
                material.base_color = reflectance;
                material.base_color_texture = None;
                material.metallic = 0.0;
                material.metallic_texture = None;
                for color in self
                    .meshes
                    .iter_mut()
                    .filter(|m| m.material == i)
                    .flat_map(|m| &mut m.colors)
                {
                    *color = Vec3::ONE.extend(color.w);
                }
            }
            material.double_sided |= options.double_sided;
        }
    }

    fn apply_to_nodes(&mut self, options: &SceneOptions) {
        let matchers =
            |globs: &[String]| globs.iter().map(|g| WildMatch::new(g)).collect::<Vec<_>>();
        let (flip, hide) = (matchers(&options.flip), matchers(&options.hide));
        for instance in &mut self.instances {
            instance.flipped ^= flip.iter().any(|glob| glob.matches(&instance.node));
        }
        let is_hidden = |node: &str| hide.iter().any(|glob| glob.matches(node));
        self.instances.retain(|instance| !is_hidden(&instance.node));
        if let Some(asked) = &mut self.view_factors {
            // A cover without its base covers nothing.
            asked.masks.retain(|mask| !is_hidden(&mask.base));
        }
    }

    /// Scales and turns everything that has a place.
    fn transform_world(&mut self, scale: f32, rotation: Mat3) {
        let world_from_file = Affine3A::from_mat3(rotation * scale);
        for instance in &mut self.instances {
            instance.world_from_mesh = world_from_file * instance.world_from_mesh;
        }
        for camera in &mut self.cameras {
            transform_camera(camera, scale, rotation);
        }
        for light in &mut self.lights {
            match &mut light.kind {
                LightKind::Point { position, .. } => *position = rotation * *position * scale,
                LightKind::Spot {
                    position,
                    direction,
                    ..
                } => {
                    *position = rotation * *position * scale;
                    *direction = rotation * *direction;
                }
                LightKind::Directional { direction, .. } => *direction = rotation * *direction,
            }
        }
    }

    /// Tells which metals count as diffuse.
    fn report_metals(&mut self) {
        if self.metals == MetalsAs::Black {
            return;
        }
        let metals: Vec<&str> = self
            .used_materials()
            .filter(|m| self.is_metal(m))
            .map(|m| m.name.as_str())
            .collect();
        if metals.is_empty() {
            return;
        }
        let what = format!(
            "{} of {} are metals and count as diffuse with their base colour: {}; `--metals black` leaves them black",
            metals.len(),
            self.materials.len(),
            listed(&metals)
        );
        self.warn_once("materials", what);
    }

    /// Tells which reflectances are lowered; textures are not searched.
    fn report_lowered(&mut self) {
        let bound = self.max_reflectance;
        let diffuse = |m: &Material| match self.metals {
            MetalsAs::Black if m.metallic_texture.is_none() => m.metallic < 1.0,
            _ => true,
        };
        let lowered: Vec<(String, f32)> = self
            .used_materials()
            .filter(|m| {
                m.base_color_texture.is_none() && diffuse(m) && m.base_color.max_band() > bound
            })
            .map(|m| (m.name.clone(), m.base_color.max_band()))
            .collect();
        for (name, reflectance) in lowered {
            self.warn_once(
                &format!("material {}", quoted(&name)),
                format!("reflectance {reflectance} lowered to {bound}"),
            );
        }
    }

    /// Materials that a placed mesh has, in their order.
    fn used_materials(&self) -> impl Iterator<Item = &Material> {
        let mut used = vec![false; self.materials.len()];
        for instance in &self.instances {
            used[self.meshes[instance.mesh].material] = true;
        }
        self.materials
            .iter()
            .zip(used)
            .filter_map(|(material, used)| used.then_some(material))
    }

    /// Whether any point of the material is metal; a texture may say that none is.
    fn is_metal(&self, material: &Material) -> bool {
        material.metallic > 0.0
            && material.metallic_texture.is_none_or(|slot| {
                let image = &self.images[self.textures[slot.texture].image];
                image.pixels().pixels().iter().any(|texel| texel[2] > 0)
            })
    }

    /// Warns unless the report says so already: options may be applied several times.
    fn warn_once(&mut self, place: &str, what: String) {
        if !self
            .report
            .warnings
            .iter()
            .any(|w| w.place == place && w.what == what)
        {
            self.report.warn(place, what);
        }
    }
}

/// The turn that brings the file's upward axis to +Y: `(x, y, z)` becomes `(x, z, -y)` if that axis is z.
fn y_up_from_file(up: UpAxis) -> Mat3 {
    match up {
        UpAxis::Y => Mat3::IDENTITY,
        UpAxis::Z => Mat3::from_cols(Vec3::X, Vec3::NEG_Z, Vec3::Y),
    }
}

fn transform_camera(camera: &mut Camera, scale: f32, rotation: Mat3) {
    camera.eye = rotation * camera.eye * scale;
    camera.forward = rotation * camera.forward;
    camera.up = rotation * camera.up;
    if let Projection::Orthographic {
        half_width,
        half_height,
    } = &mut camera.projection
    {
        *half_width *= scale;
        *half_height *= scale;
    }
}

/// The value of the last glob that matches a name.
fn last_match(values: &[(String, Rgb)], name: &str) -> Option<Rgb> {
    values
        .iter()
        .rev()
        .find(|(glob, _)| WildMatch::new(glob).matches(name))
        .map(|&(_, value)| value)
}

fn matches_something(glob: &str, option: &str, what: &str, names: &[&str]) -> Result<(), String> {
    let matcher = WildMatch::new(glob);
    if names.iter().any(|name| matcher.matches(name)) {
        return Ok(());
    }
    let mut distinct: Vec<&str> = Vec::new();
    for &name in names {
        if !distinct.contains(&name) {
            distinct.push(name);
        }
    }
    Err(match distinct.as_slice() {
        [] => format!("{option} {}: the scene has no {what}s", quoted(glob)),
        _ => format!(
            "{option} {}: no {what} is called that; there are {}",
            quoted(glob),
            listed(&distinct)
        ),
    })
}

/// The first names, and how many there are if that is more.
fn listed(names: &[&str]) -> String {
    let mut text = names
        .iter()
        .take(LISTED)
        .map(|name| quoted(name))
        .collect::<Vec<_>>()
        .join(", ");
    if names.len() > LISTED {
        text.push_str(&format!(", ... ({} in all)", names.len()));
    }
    text
}

/// Refuses a colour with a band that is not finite, below 0 or above `most`.
fn in_range(color: Rgb, what: &str, most: f32) -> Result<(), String> {
    for (band, name) in color.to_array().into_iter().zip(["red", "green", "blue"]) {
        if !band.is_finite() {
            return Err(format!(
                "{what} {band} ({name}) is not a finite number of at least 0"
            ));
        }
        if band < 0.0 {
            return Err(format!("{what} {band} ({name}) is below 0"));
        }
        if band > most {
            return Err(format!("{what} {band} ({name}) is above {most}"));
        }
    }
    Ok(())
}
