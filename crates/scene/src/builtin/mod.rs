//! Scenes that need no file.
//!
//! `cornell` and `two-rooms` are the rooms for which the project keeps reference values, `furnace` and the plates have
//! solutions in closed form, the others are for the eye: `office` and `conference-room` are rooms of every day, `chapel`,
//! `steel-mill` and `theatre` are large.

mod build;
mod chapel;
mod conference_room;
mod cornell;
mod furnace;
mod office;
mod plates;
mod quads;
mod steel_mill;
mod theatre;
mod two_rooms;

pub use build::{SceneBuilder, Sides, Vertex};
pub use furnace::furnace_with;

use crate::Scene;

/// A built-in scene as `hemicube scenes` lists it.
#[derive(Debug, Clone, Copy)]
pub struct BuiltinScene {
    /// Name by which it is opened.
    pub name: &'static str,
    /// What it shows, in one line.
    pub description: &'static str,
    make: fn() -> Scene,
}

const SCENES: &[BuiltinScene] = &[
    BuiltinScene {
        name: "cornell",
        description: "the Cornell box as measured, in millimetres, radiometric; camera front",
        make: cornell::scene,
    },
    BuiltinScene {
        name: "office",
        description: "a furnished, textured study in daylight and lamplight, photometric; cameras entrance, desk, window, corner",
        make: office::scene,
    },
    BuiltinScene {
        name: "conference-room",
        description: "24 luminaires over a table and 32 chairs, photometric; cameras entrance, table, board",
        make: conference_room::scene,
    },
    BuiltinScene {
        name: "chapel",
        description: "a thick wall of 113 tinted windows under a curved roof, photometric; cameras nave, windows, altar",
        make: chapel::scene,
    },
    BuiltinScene {
        name: "theatre",
        description: "stage, stalls, two balconies and hundreds of lamps, for a million elements, photometric; cameras stalls, stage, balcony, boxes",
        make: theatre::scene,
    },
    BuiltinScene {
        name: "steel-mill",
        description: "crane, ladles, trusses and a glowing strip in 30,000 polygons, photometric; cameras hall, strip, crane, furnace",
        make: steel_mill::scene,
    },
    BuiltinScene {
        name: "two-rooms",
        description: "two rooms joined by a doorway, one of them lit by a cove only, radiometric; cameras room-a, room-b, doorway",
        make: two_rooms::scene,
    },
    BuiltinScene {
        name: "furnace",
        description: "a closed box of exitance 1 W/m² and reflectance 0.5: radiosity is 2 W/m² everywhere",
        make: furnace::scene,
    },
    BuiltinScene {
        name: "parallel-plates",
        description: "two unit squares face to face, 1 m apart, one emits: form factor 0.19982",
        make: plates::parallel,
    },
    BuiltinScene {
        name: "perpendicular-plates",
        description: "two unit squares at a right angle with a common edge, one emits: form factor 0.20004",
        make: plates::perpendicular,
    },
];

/// The built-in scene of a name, made anew; `None` if there is none of that name.
pub fn scene(name: &str) -> Option<Scene> {
    SCENES
        .iter()
        .find(|scene| scene.name == name)
        .map(|scene| (scene.make)())
}

/// All built-in scenes.
pub fn list() -> &'static [BuiltinScene] {
    SCENES
}
