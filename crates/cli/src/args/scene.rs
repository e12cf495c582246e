//! Options that adjust a scene before anything is computed.

use super::parse;
use clap::Args;
use clap::builder::TypedValueParser;
use hemicube::raster::Rgb;
use hemicube::scene::options::{Unit, UpAxis};
use hemicube::scene::{MetalsAs, Scene, SceneOptions, Units};

/// Options that adjust a scene; names may be globs (`*`, `?`).
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Scene (names may be globs: * any text, ? one character)")]
pub struct SceneArgs {
    /// Let a material emit this radiance, in cd/m² or W/(m² sr); repeatable
    #[arg(long, value_name = "MATERIAL=R,G,B", value_parser = parse::emission)]
    pub emit: Vec<(String, Rgb)>,
    /// Radiance of a uniform sky around the scene [default: the scene's]
    #[arg(long, value_name = "R,G,B", value_parser = parse::radiance, allow_hyphen_values = true)]
    pub sky: Option<Rgb>,
    /// Give a material this diffuse reflectance, 0 to 1; repeatable
    #[arg(long, value_name = "MATERIAL=R,G,B", value_parser = parse::reflectance)]
    pub reflectance: Vec<(String, Rgb)>,
    /// Leave out a node; repeatable
    #[arg(long, value_name = "NODE")]
    pub hide: Vec<String>,
    /// Turn a node's faces around; repeatable
    #[arg(long, value_name = "NODE")]
    pub flip: Vec<String>,
    /// Light both sides of all faces
    #[arg(long)]
    pub double_sided: bool,
    /// Unit of length of the file [default: m]
    #[arg(long, value_parser = named::<Unit>(Unit::NAMES))]
    pub unit: Option<Unit>,
    /// Axis of the file that points up [default: y]
    #[arg(long, value_parser = named::<UpAxis>(UpAxis::NAMES))]
    pub up: Option<UpAxis>,
    /// What the numbers of light mean: cd and lx, or W [default: as the file says]
    #[arg(long, value_parser = named::<Units>(Units::NAMES))]
    pub units: Option<Units>,
    /// Metals count as diffuse with their base colour, or as black [default: diffuse]
    #[arg(long, value_parser = named::<MetalsAs>(MetalsAs::NAMES))]
    pub metals: Option<MetalsAs>,
    /// Larger reflectances are lowered to this [default: 0.98]
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = parse::bound)]
    pub max_reflectance: Option<f32>,
}

/// One of the names that the scene's own parser knows.
fn named<T>(names: &'static [&'static str]) -> impl TypedValueParser<Value = T>
where
    T: std::str::FromStr<Err = String> + Clone + Send + Sync + 'static,
{
    clap::builder::PossibleValuesParser::new(names).try_map(|name| name.parse::<T>())
}

impl SceneArgs {
    /// Adjusts a scene; what is not given stays as the scene has it.
    pub fn apply(&self, scene: &mut Scene) -> Result<(), hemicube::scene::SceneError> {
        let options = self.options(SceneOptions {
            metals: scene.metals,
            max_reflectance: scene.max_reflectance,
            ..SceneOptions::default()
        });
        scene.apply(&options)
    }

    /// What is to be changed in a scene that is opened later; `None` if nothing is.
    #[cfg(feature = "viewer")]
    pub fn changes(&self) -> Option<SceneOptions> {
        (!self.given().is_empty()).then(|| self.options(SceneOptions::default()))
    }

    fn options(&self, usual: SceneOptions) -> SceneOptions {
        SceneOptions {
            emit: self.emit.clone(),
            sky: self.sky,
            reflectance: self.reflectance.clone(),
            hide: self.hide.clone(),
            flip: self.flip.clone(),
            double_sided: self.double_sided,
            unit: self.unit,
            up: self.up,
            units: self.units,
            metals: self.metals.unwrap_or(usual.metals),
            max_reflectance: self.max_reflectance.unwrap_or(usual.max_reflectance),
        }
    }

    /// Names of the options that were given.
    pub fn given(&self) -> Vec<&'static str> {
        let all = [
            (!self.emit.is_empty(), "--emit"),
            (self.sky.is_some(), "--sky"),
            (!self.reflectance.is_empty(), "--reflectance"),
            (!self.hide.is_empty(), "--hide"),
            (!self.flip.is_empty(), "--flip"),
            (self.double_sided, "--double-sided"),
            (self.unit.is_some(), "--unit"),
            (self.up.is_some(), "--up"),
            (self.units.is_some(), "--units"),
            (self.metals.is_some(), "--metals"),
            (self.max_reflectance.is_some(), "--max-reflectance"),
        ];
        all.into_iter()
            .filter_map(|(given, name)| given.then_some(name))
            .collect()
    }
}
