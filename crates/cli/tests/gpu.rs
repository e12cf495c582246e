//! Form factors drawn by a GPU, where the program was built for one.

mod common;

use common::Folder;

const MESH: [&str; 4] = ["--elements", "400", "--patches", "80"];

#[cfg(not(feature = "gpu"))]
#[test]
fn program_without_a_gpu_says_how_to_build_one() {
    let folder = Folder::new();
    for args in [
        &["adapters"][..],
        &["solve", "cornell", "--form-factors", "gpu"],
    ] {
        let output = folder.run(args);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {told}");
        assert!(told.contains("--features gpu"), "{args:?}: {told}");
    }
}

#[test]
fn options_of_a_gpu_without_one_are_wrong_usage() {
    let folder = Folder::new();
    for option in [&["--adapter", "any"][..], &["--require-gpu"]] {
        let args = [&["solve", "cornell"][..], &MESH, option].concat();
        let output = folder.run(&args);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{option:?}: {told}");
        assert!(told.contains(option[0]), "{told}");
    }
}

#[cfg(feature = "gpu")]
mod built {
    use super::*;
    use serde_json::Value;

    fn has_adapter(folder: &Folder) -> bool {
        let is_there = folder.run(&["adapters"]).status.success();
        if !is_there {
            println!("skipped: this machine shows no adapter");
        }
        is_there
    }

    fn solve(folder: &Folder, args: &[&str]) -> Value {
        let args = [&["solve", "cornell", "--json"][..], &MESH, args].concat();
        serde_json::from_str(&folder.done(&args)).expect("a report")
    }

    #[test]
    fn light_is_that_of_the_cpus_hemicubes_and_goes_on() {
        let folder = Folder::new();
        if !has_adapter(&folder) {
            return;
        }
        let gpu = ["--form-factors", "gpu", "--hemicube-resolution", "64"];
        let few = [&gpu[..], &["--iterations", "20", "-o", "lit.glb"]].concat();
        let first = solve(&folder, &few);
        assert_eq!(first["form_factors"], "gpu", "{first}");
        let go_on = [
            "solve",
            "--resume",
            "lit.glb",
            "--json",
            "--tolerance",
            "1e-3",
        ];
        let end: Value = serde_json::from_str(&folder.done(&go_on)).expect("a report");
        assert_eq!(end["form_factors"], "gpu", "as before: {end}");
        let cpu = ["--form-factors", "hemicube", "--hemicube-resolution", "64"];
        let cpu = solve(&folder, &[&cpu[..], &["--tolerance", "1e-3"]].concat());
        let absorbed = |report: &Value| {
            let bands = report["balance"].as_array().expect("bands");
            bands
                .iter()
                .map(|b| b["absorbed"].as_f64().expect("a number"))
                .sum::<f64>()
        };
        let (a, b) = (absorbed(&end), absorbed(&cpu));
        assert!((a - b).abs() < 0.01 * b, "absorbed {a} and {b}");
    }

    #[test]
    fn missing_gpu_is_told_and_the_cpu_goes_on_unless_one_is_required() {
        let folder = Folder::new();
        let gpu = ["--form-factors", "gpu", "--adapter", "no such thing"];
        let args = [&["solve", "cornell", "--iterations", "3"][..], &MESH, &gpu].concat();
        let output = folder.run(&args);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{told}");
        assert!(told.contains("going on with the CPU"), "{told}");
        let output = folder.run(&[&args[..], &["--require-gpu"]].concat());
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{told}");
        assert!(told.contains("no GPU"), "{told}");
    }
}
