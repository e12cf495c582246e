//! What a user of the CPU side compiles.

use std::process::Command;

/// The packages that a package needs with its default features, one line each.
fn tree(package: &str) -> String {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args([
            "tree",
            "--locked",
            "--prefix",
            "none",
            "--edges",
            "normal",
            "--package",
            package,
        ])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo can be started");
    assert!(
        output.status.success(),
        "cargo tree: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).expect("names of packages are ASCII")
}

#[test]
fn the_cpu_side_needs_no_gpu_and_no_window() {
    for package in ["hemicube", "hemicube-cli"] {
        let tree = tree(package);
        assert!(tree.lines().count() > 20, "{package}: the tree is listed");
        for heavy in ["wgpu", "naga", "egui", "eframe", "winit"] {
            let found = tree
                .lines()
                .find(|line| line.starts_with(&format!("{heavy} ")));
            assert!(found.is_none(), "{package} needs {heavy}");
        }
    }
}

#[test]
fn there_is_one_glam() {
    let tree = tree("hemicube");
    let mut versions: Vec<&str> = tree
        .lines()
        .filter_map(|line| line.strip_prefix("glam v"))
        .map(|line| line.split(' ').next().unwrap_or(""))
        .collect();
    versions.sort_unstable();
    versions.dedup();
    assert_eq!(versions.len(), 1, "glam in versions {versions:?}");
}
