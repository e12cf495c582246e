//! `hemicube adapters`: the GPUs of this machine.

use crate::args::GlobalArgs;
use crate::failure::Failure;

/// Prints the list.
#[cfg(feature = "gpu")]
pub fn run(global: GlobalArgs) -> Result<(), Failure> {
    use crate::output::{print, print_json};
    use serde_json::json;
    use std::fmt::Write as _;
    let all = hemicube::gpu::adapters();
    if global.json {
        let list: Vec<_> = all
            .iter()
            .map(|a| {
                json!({
                    "name": a.name, "backend": a.backend, "kind": a.kind, "driver": a.driver,
                    "usable": a.usable.is_ok(), "why_not": a.usable.as_ref().err(), "extras": a.extras, "uses_ray_queries": a.uses_ray_queries,
                    "max_binding_bytes": a.max_binding, "max_picture_side": a.max_side,
                })
            })
            .collect();
        return print_json(&json!({ "adapters": list }));
    }
    if all.is_empty() {
        return Err(Failure::Failed(String::from(
            "this machine shows no adapter; install its Vulkan driver (Mesa's lavapipe draws in software)",
        )));
    }
    let mut text = String::new();
    for adapter in &all {
        let _ = writeln!(text, "{adapter}");
        let _ = writeln!(text, "  driver    {}", adapter.driver);
        let _ = writeln!(
            text,
            "  limits    {} MiB a buffer, pictures of {} pixels a side",
            adapter.max_binding >> 20,
            adapter.max_side
        );
        if !adapter.extras.is_empty() {
            let _ = writeln!(text, "  extras    {}", adapter.extras.join(", "));
        }
        let rays = if adapter.uses_ray_queries {
            "by the adapter's ray queries"
        } else {
            "by a tree in a shader"
        };
        let variable = hemicube::gpu::RAY_QUERY_VARIABLE;
        let _ = writeln!(text, "  rays      {rays} ({variable}=never|auto|always)");
        if let Err(why) = &adapter.usable {
            let _ = writeln!(text, "  unusable  {why}");
        }
    }
    print(&text)
}

/// Says how to build the program for it.
#[cfg(not(feature = "gpu"))]
pub fn run(_: GlobalArgs) -> Result<(), Failure> {
    let why = crate::backend::NOT_BUILT;
    Err(Failure::Usage(format!("adapters: {why}")))
}
