//! Models mended before they are cut: what Baum, Mann, Smith and Winget (Making radiosity usable, 1991) ask of one.
//!
//! 1. Vertices that nearly agree become one ([`weld`]): faces then share edges, and are cut alike along them.
//! 2. One-sided faces of a shell that disagree about its outside are turned around ([`orient`]).
//! 3. Of faces that lie upon one another in one plane the smaller is lifted off the larger ([`stack`]), which is buried
//!    below it. Otherwise rays would meet the one or the other at random.
//!
//! All of it happens to the faces in the world; the scene stays as it came. A model without such faults keeps all its
//! bits.

pub mod orient;
pub mod stack;
pub mod weld;

use super::face::{WorldFace, newell_normal};
use hemicube_scene::report::counted;
use hemicube_scene::{ImportReport, Scene};
use serde::{Deserialize, Serialize};

/// What to mend.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CleanOptions {
    /// Whether anything is mended at all. Default value: yes.
    pub enabled: bool,
    /// Distance in scene units up to which vertices become one. Default value: two millionths of the scene's diagonal,
    /// which is what rounding of coordinates leaves.
    pub weld: Option<f32>,
    /// Whether whole shells are turned around of which lights and cameras see backs only. Default value: no, since walls
    /// may rightly turn their backs on a camera outside.
    pub turn_to_light: bool,
}

impl Default for CleanOptions {
    fn default() -> Self {
        Self {
            enabled: true,
            weld: None,
            turn_to_light: false,
        }
    }
}

impl CleanOptions {
    /// The model as it is.
    pub fn none() -> Self {
        Self {
            enabled: false,
            ..Self::default()
        }
    }

    /// Vertices up to so far apart become one.
    pub fn with_weld(self, distance: f32) -> Self {
        Self {
            weld: Some(distance),
            ..self
        }
    }

    /// Whether whole shells are turned to what sees them.
    pub fn with_turn_to_light(self, turn: bool) -> Self {
        Self {
            turn_to_light: turn,
            ..self
        }
    }
}

/// Mends the faces of a scene and tells what was done.
pub fn clean(
    scene: &Scene,
    faces: &mut [WorldFace],
    options: CleanOptions,
    report: &mut ImportReport,
) {
    if !options.enabled {
        return;
    }
    let weld::Welded { moved, corners } = weld::weld(faces, options.weld);
    // Rounding is mended without a word.
    if let Some(distance) = options.weld.filter(|_| moved > 0) {
        let what = format!(
            "{} moved by up to {distance} units onto others",
            counted(moved, "corner")
        );
        report.warn("vertices", what);
    }
    orient::orient(scene, faces, &corners, options.turn_to_light, report);
    stack::lift(scene, faces, report);
}
