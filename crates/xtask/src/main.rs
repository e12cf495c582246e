//! The workspace's chores: `cargo xtask test`.

mod driver;

use std::process::{Command, ExitCode};

const HELP: &str = "\
The workspace's chores.

  cargo xtask test [ARGS...]   all tests of all crates, those of the GPU among them; ARGS go to `cargo test`. Without a
                               Vulkan driver, installs one that draws in software where it can (as root, with apt)
  cargo xtask check            what a change must pass: format, clippy, documentation, tests, packages
  cargo xtask gallery          draws the README's pictures into assets/ again
";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let rest: Vec<&str> = args.iter().skip(1).map(String::as_str).collect();
    let done = match args.first().map(String::as_str) {
        Some("test") => test(&rest),
        Some("check") => check(),
        Some("gallery") => gallery(),
        Some("help" | "--help" | "-h") => {
            print!("{HELP}");
            true
        }
        other => {
            eprintln!("xtask: no chore '{}'\n\n{HELP}", other.unwrap_or_default());
            return ExitCode::from(2);
        }
    };
    if done {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// Set where there is a Vulkan driver: tests of the GPU then fail where they would be skipped elsewhere.
const NEEDS_GPU: &str = "HEMICUBE_TESTS_NEED_GPU";

/// Everything that `cargo test` finds in the workspace, the examples among it.
fn test(args: &[&str]) -> bool {
    let needs: &[_] = if driver::install() {
        &[(NEEDS_GPU, "1")]
    } else {
        &[]
    };
    let all = [
        "test",
        "--workspace",
        "--features",
        "hemicube-cli/viewer,hemicube-tests/gpu",
        "--locked",
    ];
    cargo(&[&all, args].concat(), needs)
}

fn check() -> bool {
    let packages = [
        "shaders",
        "gpu",
        "raster",
        "chart",
        "csg",
        "gallery",
        "scene",
        "radiosity",
        "render",
        "viewer",
    ]
    .map(|name| format!("hemicube-{name}"));
    let mut package = vec![
        "package",
        "--locked",
        "--allow-dirty",
        "--no-verify",
        "--quiet",
    ];
    for name in packages
        .iter()
        .map(String::as_str)
        .chain(["hemicube", "hemicube-cli"])
    {
        package.extend(["--package", name]);
    }
    cargo(&["fmt", "--all", "--check"], &[])
        && cargo(
            &[
                "clippy",
                "--workspace",
                "--all-targets",
                "--locked",
                "--",
                "-D",
                "warnings",
            ],
            &[],
        )
        && cargo(
            &["doc", "--workspace", "--no-deps", "--locked"],
            &[("RUSTDOCFLAGS", "-D warnings")],
        )
        && test(&[])
        && cargo(&package, &[])
}

/// Pictures made by the program, as the README shows them.
fn gallery() -> bool {
    let shots = ["0", "1", "10", "100"];
    let run = |args: &[&str]| {
        let prefix = [
            "run",
            "--release",
            "--locked",
            "--package",
            "hemicube-cli",
            "--",
        ];
        cargo(&[&prefix[..], args].concat(), &[])
    };
    let office = "solve office --quality final --size 960x540 --image assets/office.png";
    // Elements and noise of scenes that are lit by rays alone.
    let large = [
        "theatre --elements 100000 --noise 0.12 --camera balcony --image assets/theatre.png",
        "steel-mill --elements 55000 --noise 0.1 --image assets/steel-mill.png",
        "chapel --elements 100000 --noise 0.05 --image assets/chapel.png",
    ];
    let cornell = "solve cornell --solver sorted-shooting --size 400x400 --exposure 1";
    let compare = "compare cornell --steps 100 -o assets/compare.png";
    run(&office.split(' ').collect::<Vec<_>>())
        && run(&compare.split(' ').collect::<Vec<_>>())
        && large.iter().all(|scene| {
            let solve = format!("solve --solver stochastic {scene}");
            run(&solve.split(' ').collect::<Vec<_>>())
        })
        && shots.iter().all(|shots| {
            let picture = format!("assets/cornell-{shots}.png");
            let options = ["--iterations", shots, "--image", &picture];
            run(&[&cornell.split(' ').collect::<Vec<_>>()[..], &options].concat())
        })
}

/// Runs cargo and says what it runs.
fn cargo(args: &[&str], variables: &[(&str, &str)]) -> bool {
    eprintln!("\n> cargo {}", args.join(" "));
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    match Command::new(cargo)
        .args(args)
        .envs(variables.iter().copied())
        .status()
    {
        Ok(status) => status.success(),
        Err(error) => {
            eprintln!("xtask: cargo could not be started: {error}");
            false
        }
    }
}
