//! `hemicube scenes`: the built-in scenes.

use crate::args::GlobalArgs;
use crate::failure::Failure;
use crate::output::{print, print_json};
use hemicube::scene::builtin;
use serde_json::json;
use std::fmt::Write as _;

/// Prints the list.
pub fn run(global: GlobalArgs) -> Result<(), Failure> {
    if global.json {
        let scenes: Vec<_> = builtin::list()
            .iter()
            .map(|s| json!({ "name": s.name, "description": s.description }))
            .collect();
        return print_json(&json!({ "scenes": scenes }));
    }
    let width = builtin::list()
        .iter()
        .map(|s| s.name.len())
        .max()
        .unwrap_or(0);
    let mut text = String::new();
    for scene in builtin::list() {
        let _ = writeln!(text, "{:width$}  {}", scene.name, scene.description);
    }
    print(&text)
}
