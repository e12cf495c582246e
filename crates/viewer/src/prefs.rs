//! What is remembered from one start to the next.

use crate::display::Display;
use crate::session::Settings;
use crate::walk::FilmFormat;
use serde::{Deserialize, Serialize};

/// Recent files that are remembered.
const RECENT: usize = 10;

/// What is remembered from one start to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Prefs {
    /// How the light is found.
    pub settings: Settings,
    /// What the picture shows, and how.
    pub display: Display,
    /// Whether one walks on floors. Default value: no.
    pub gravity: bool,
    /// Whether walls stop one. Default value: yes.
    pub collisions: bool,
    /// Whether the panel at the left is open. Default value: yes.
    pub left_open: bool,
    /// Whether the panel at the right is open. Default value: yes.
    pub right_open: bool,
    /// How films are kept.
    pub film_format: FilmFormat,
    /// Height of films in pixels; they are 16 by 9. Default value: 720.
    pub film_height: usize,
    /// Files that were opened, the last one first.
    pub recent: Vec<String>,
}

impl Default for Prefs {
    fn default() -> Self {
        Self {
            settings: Settings::default(),
            display: Display::default(),
            gravity: false,
            collisions: true,
            left_open: true,
            right_open: true,
            film_format: FilmFormat::default(),
            film_height: 720,
            recent: Vec::new(),
        }
    }
}

impl Prefs {
    /// Puts a file at the head of the recent ones.
    pub fn remember(&mut self, path: &str) {
        self.recent.retain(|other| other != path);
        self.recent.insert(0, path.to_owned());
        self.recent.truncate(RECENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recent_files_are_few_and_different() {
        let mut prefs = Prefs::default();
        for i in 0..30 {
            prefs.remember(&format!("{}.glb", i % 12));
        }
        assert_eq!(prefs.recent.len(), RECENT, "{:?}", prefs.recent);
        assert_eq!(prefs.recent[0], "5.glb", "the last one first");
        prefs.remember("9.glb");
        let nines = prefs.recent.iter().filter(|path| *path == "9.glb").count();
        assert_eq!(
            (nines, prefs.recent[0].as_str()),
            (1, "9.glb"),
            "moved, not doubled"
        );
    }

    #[test]
    fn they_come_back_whatever_an_older_version_wrote() {
        let prefs = Prefs {
            gravity: true,
            film_height: 1080,
            ..Prefs::default()
        };
        let json = serde_json::to_string(&prefs).expect("they can be written");
        assert_eq!(
            serde_json::from_str::<Prefs>(&json).ok(),
            Some(prefs),
            "as they were"
        );
        let old = serde_json::from_str::<Prefs>(r#"{"gravity": true, "gone": 1}"#);
        assert!(
            old.is_ok_and(|prefs| prefs.gravity && prefs.collisions),
            "missing and unknown fields"
        );
    }
}
