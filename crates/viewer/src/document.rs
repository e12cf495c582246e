//! A session as a file: everything that was set by hand, to go on another day.

use crate::display::Display;
use crate::session::{Mixer, Settings};
use crate::walk::{Eye, Path};
use hemicube_radiosity::MaterialEdit;
use hemicube_raster::Rgb;
use hemicube_scene::Scene;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Says what a file is, and how new.
const FORMAT: &str = "hemicube session 1";

/// A material as it was edited. It is found by its name, since a scene may come back with others before it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EditedMaterial {
    /// Base colour, if it was changed.
    pub base_color: Option<Rgb>,
    /// Emitted radiance, if it was changed.
    pub emission: Option<Rgb>,
}

/// A session as a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Document {
    format: String,
    /// Path or built-in name of the scene.
    pub source: String,
    /// How the light is found.
    pub settings: Settings,
    /// What the picture shows.
    pub display: Display,
    /// Where one looks from.
    pub eye: Eye,
    /// The recorded way.
    pub path: Path,
    /// Levels, groups and scenes of light.
    pub mixer: Mixer,
    /// Materials that were edited, by name.
    pub materials: BTreeMap<String, EditedMaterial>,
}

impl Document {
    /// Everything that was set by hand.
    pub fn new(
        source: String,
        settings: Settings,
        display: Display,
        eye: Eye,
        path: Path,
        mixer: Mixer,
        materials: BTreeMap<String, EditedMaterial>,
    ) -> Self {
        Self {
            format: FORMAT.to_owned(),
            source,
            settings,
            display,
            eye,
            path,
            mixer,
            materials,
        }
    }

    /// As text.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("all of it has a text")
    }

    /// From text.
    ///
    /// # Errors
    /// What is wrong, in one line.
    pub fn from_json(text: &str) -> Result<Self, String> {
        let document: Self = serde_json::from_str(text)
            .map_err(|error| format!("it is no session of hemicube: {error}"))?;
        if document.format != FORMAT {
            let format = document.format.chars().take(60).collect::<String>();
            return Err(format!(
                "its format is '{format}', this program reads '{FORMAT}'"
            ));
        }
        let eye = &document.eye;
        let numbers = [eye.yaw, eye.pitch, eye.vertical_fov, eye.distance];
        if !eye.position.is_finite() || numbers.iter().any(|x| !x.is_finite()) {
            return Err(String::from("its view has a number that is not finite"));
        }
        Ok(document)
    }

    /// Whether a file of that name may be one.
    pub fn is_named(path: &str) -> bool {
        path.to_lowercase().ends_with(".json")
    }

    /// The edits, for a scene.
    pub fn edits(&self, scene: &Scene) -> Vec<MaterialEdit> {
        let edit = |(name, edited): (&String, &EditedMaterial)| {
            let material = scene
                .materials
                .iter()
                .position(|material| material.name == *name)?;
            Some(MaterialEdit {
                material,
                base_color: edited.base_color,
                emission: edited.emission,
            })
        };
        self.materials.iter().filter_map(edit).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use hemicube_scene::{Camera, builtin};

    fn document() -> Document {
        let camera = Camera::looking_at("a", Vec3::ONE, Vec3::ZERO, Vec3::Y, 1.0);
        let eye = Eye::of_camera(&camera, 2.0);
        let red = EditedMaterial {
            base_color: Some(Rgb::new(0.1, 0.2, 0.3)),
            emission: None,
        };
        Document::new(
            String::from("cornell"),
            Settings::default(),
            Display::default(),
            eye,
            Path {
                stops: vec![eye, eye],
            },
            Mixer::new(["light", "lights and sky"]),
            BTreeMap::from([
                (String::from("red"), red.clone()),
                (String::from("gone"), red),
            ]),
        )
    }

    #[test]
    fn it_comes_back() {
        let document = document();
        assert_eq!(
            Document::from_json(&document.to_json()),
            Ok(document.clone()),
            "as it was"
        );
        let scene = builtin::scene("cornell").expect("it is built in");
        let edits = document.edits(&scene);
        assert_eq!(edits.len(), 1, "what the scene does not have is left out");
        assert_eq!(
            scene.materials[edits[0].material].name, "red",
            "by its name"
        );
    }

    #[test]
    fn other_files_are_refused_in_words() {
        let refused = |text: &str| Document::from_json(text).expect_err("it is none");
        assert!(
            refused("{}").contains("no session of hemicube"),
            "something else"
        );
        let newer = document().to_json().replace("session 1", "session 2");
        assert!(
            refused(&newer).contains("'hemicube session 2'"),
            "a newer one"
        );
        assert!(
            Document::is_named("/a/B.JSON") && !Document::is_named("a.glb"),
            "by the ending"
        );
    }
}
