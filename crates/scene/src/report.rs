//! What happened on the way in.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Warnings of one kind that are listed one by one before the rest is only counted.
const LISTED: usize = 1_000;

/// Everything a user should know about how a file became a scene.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct ImportReport {
    /// Things left out, mended or read in an unusual way.
    pub warnings: Vec<Warning>,
    /// Warnings beyond the first thousand.
    pub unlisted: usize,
}

/// One thing left out, mended or read in an unusual way.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Warning {
    /// Where: `mesh 'lamp', triangle 12`.
    pub place: String,
    /// What, and what was done about it.
    pub what: String,
}

/// A number with its noun: `1 line`, `2 lines`.
pub fn counted(count: usize, noun: &str) -> String {
    match count {
        1 => format!("1 {noun}"),
        _ => format!("{count} {noun}s"),
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.what)
    }
}

impl ImportReport {
    /// Notes a warning; beyond the first thousand they are only counted.
    pub fn warn(&mut self, place: impl Into<String>, what: impl Into<String>) {
        if self.warnings.len() < LISTED {
            self.warnings.push(Warning {
                place: place.into(),
                what: what.into(),
            });
        } else {
            self.unlisted += 1;
        }
    }
}
