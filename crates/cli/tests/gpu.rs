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
        &["render", "cornell", "-o", "a.png", "--draw-on", "gpu"],
        &["form-factors", "cornell", "--method", "gpu-raycast"],
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
        let plates = [&["form-factors", "parallel-plates"][..], option].concat();
        let cornell = [&["solve", "cornell"][..], &MESH, option].concat();
        for args in [plates, cornell] {
            let output = folder.run(&args);
            let told = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(2), "{option:?}: {told}");
            assert!(told.contains(option[0]), "{told}");
        }
    }
}

#[cfg(feature = "gpu")]
mod built {
    use super::*;
    use serde_json::Value;

    fn has_adapter(folder: &Folder) -> bool {
        let is_there = folder.run(&["adapters"]).status.success();
        if !is_there {
            let must_be_there = std::env::var_os("HEMICUBE_TESTS_NEED_GPU").is_some();
            assert!(
                !must_be_there,
                "there is a driver, so tests of the GPU are not skipped"
            );
            println!("skipped: this machine shows no adapter");
        }
        is_there
    }

    fn solve(folder: &Folder, args: &[&str]) -> Value {
        let args = [&["solve", "cornell", "--json"][..], &MESH, args].concat();
        serde_json::from_str(&folder.done(&args)).expect("a report")
    }

    #[test]
    fn adapters_tell_how_rays_are_cast() {
        let folder = Folder::new();
        if !has_adapter(&folder) {
            return;
        }
        let told = folder.done(&["adapters"]);
        let line = told.lines().find(|line| line.contains("rays"));
        let line = line.expect("a line about rays");
        assert!(line.contains("HEMICUBE_RAY_QUERIES="), "{line}");
        let json: Value =
            serde_json::from_str(&folder.done(&["adapters", "--json"])).expect("JSON");
        let uses = &json["adapters"][0]["uses_ray_queries"];
        assert!(uses.is_boolean(), "{json}");
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

    #[test]
    fn view_factors_are_those_of_the_cpu() {
        let folder = Folder::new();
        if !has_adapter(&folder) {
            return;
        }
        let factors = |method: &str| -> Value {
            let args = [
                "form-factors",
                "parallel-plates",
                "--json",
                "--method",
                method,
            ];
            serde_json::from_str(&folder.done(&args)).expect("a report")
        };
        for (gpu, cpu, bound) in [("gpu", "hemicube", 1e-4), ("gpu-raycast", "raycast", 5e-3)] {
            let (a, b) = (factors(gpu), factors(cpu));
            assert_eq!(a["method"], gpu, "{a}");
            let of = |report: &Value| report["factors"][0][1].as_f64().expect("a factor");
            let (a, b) = (of(&a), of(&b));
            assert!((a - b).abs() < bound, "{gpu}: {a} and {b}");
        }
        let args = [
            "form-factors",
            "parallel-plates",
            "--method",
            "gpu",
            "--adapter",
            "no such thing",
        ];
        let output = folder.run(&args);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            output.status.success() && told.contains("going on with the CPU"),
            "{told}"
        );
        let output = folder.run(&[&args[..], &["--require-gpu"]].concat());
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{told}");
        assert!(told.contains("no GPU"), "{told}");
    }

    #[test]
    fn memory_of_the_device_is_told_as_it_is_taken() {
        use hemicube::gpu::{Context, GpuShooting};
        use hemicube::radiosity::stop::NEVER;
        use hemicube::radiosity::{SolveOptions, unlit};
        let folder = Folder::new();
        if !has_adapter(&folder) {
            return;
        }
        let info: Value =
            serde_json::from_str(&folder.done(&["info", "office", "--json"])).expect("facts");
        let scene = hemicube::scene::builtin::scene("office").expect("it is built in");
        let options = SolveOptions::default();
        let start = unlit(scene.into(), &options, NEVER).expect("it has light");
        let context = Context::headless(None).expect("there is an adapter");
        let solver = GpuShooting::new(context.into(), start, options.hemicube).expect("it fits");
        assert_eq!(info["mesh"]["gpu_memory_bytes"], solver.bytes(), "{info}");
    }

    fn pixels(folder: &Folder, name: &str) -> Vec<[f32; 3]> {
        let bytes = std::fs::read(folder.path(name)).expect(name);
        let options = hemicube::raster::image::ReadOptions::default();
        let picture = hemicube::raster::image::read_picture(&bytes, &options).expect(name);
        picture
            .rgb()
            .pixels()
            .iter()
            .map(|c| c.to_array())
            .collect()
    }

    #[test]
    fn pictures_are_those_of_the_cpu() {
        let folder = Folder::new();
        if !has_adapter(&folder) {
            return;
        }
        solve(&folder, &["--tolerance", "0.05", "-o", "lit.glb"]);
        let size = ["--size", "96x96", "--antialias", "2x2:bartlett"];
        for (name, more) in [("a.png", &[][..]), ("a.exr", &["--environment", "*"])] {
            let on = |device| {
                let file = format!("{device}-{name}");
                let args = ["render", "lit.glb", "-o", &file, "--draw-on", device];
                folder.done(&[&args[..], &size, more].concat());
                pixels(&folder, &file)
            };
            let (cpu, gpu) = (on("cpu"), on("gpu"));
            let bounded = |x: f32| x.min(1.0);
            let band = |(a, b): (&f32, &f32)| (bounded(*a) - bounded(*b)).abs();
            let off = |(a, b): (&[f32; 3], &[f32; 3])| a.iter().zip(b).map(band).sum::<f32>();
            let sum: f32 = cpu.iter().zip(&gpu).map(off).sum();
            let mean = sum / (3 * cpu.len()) as f32;
            assert!(mean < 5e-3, "{name}: {mean}");
        }
    }

    #[test]
    fn what_a_gpu_does_not_draw_the_cpu_does_unless_one_is_required() {
        let folder = Folder::new();
        if !has_adapter(&folder) {
            return;
        }
        let args = [
            "render",
            "cornell",
            "-o",
            "a.png",
            "--size",
            "16x16",
            "--iterations",
            "2",
        ];
        let gather = [
            "--draw-on",
            "gpu",
            "--shading",
            "gather",
            "--gather-rays",
            "4",
        ];
        let args = [&args[..], &MESH, &gather].concat();
        let output = folder.run(&args);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{told}");
        assert!(told.contains("drawing with the CPU"), "{told}");
        let output = folder.run(&[&args[..], &["--require-gpu"]].concat());
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{told}");
        assert!(told.contains("gathered by the CPU"), "{told}");
    }
}
