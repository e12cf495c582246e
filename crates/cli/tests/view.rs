//! `hemicube view`: the real program, in a real window where there is a display that can be made.

use std::path::Path;
use std::process::{Command, Output};

fn hemicube(args: &[&str], display: Option<&str>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hemicube"));
    command
        .args(args)
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET");
    match display {
        Some(display) => command.env("DISPLAY", display),
        None => command.env_remove("DISPLAY"),
    };
    command.output().expect("the program starts")
}

fn one_line(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(text.lines().count(), 1, "one line: {text}");
    text
}

#[cfg(not(feature = "viewer"))]
#[test]
fn without_the_feature_it_says_what_builds_it() {
    let output = hemicube(&["view", "cornell"], None);
    assert_eq!(output.status.code(), Some(2), "wrong usage");
    let line = one_line(&output);
    assert!(
        line.contains("--features viewer") && line.contains("hemicube render"),
        "{line}"
    );
    assert!(!Path::new("cornell").exists(), "nothing is written");
}

#[cfg(all(feature = "viewer", target_os = "linux"))]
mod with_windows {
    use super::*;
    use hemicube::radiosity::SolverKind;
    use hemicube::raster::image::{ReadOptions, open_picture};
    use hemicube_viewer::display::Display;
    use hemicube_viewer::document::Document;
    use hemicube_viewer::session::{Mixer, Settings};
    use hemicube_viewer::walk::{Eye, Path as Way};
    use std::io::{BufRead, BufReader};
    use std::path::PathBuf;
    use std::process::{Child, Stdio};
    use std::time::{Duration, Instant};

    #[test]
    fn without_a_display_it_names_render() {
        let output = hemicube(&["view", "cornell"], None);
        assert_eq!(output.status.code(), Some(1), "it could not be done");
        let line = one_line(&output);
        assert!(line.contains("hemicube render"), "{line}");
        let nobody = hemicube(&["view", "cornell"], Some(":4093"));
        assert_eq!(nobody.status.code(), Some(1), "nobody answers there");
        assert!(
            one_line(&nobody).contains("hemicube render"),
            "{:?}",
            nobody.stderr
        );
    }

    #[test]
    fn options_of_scene_and_solver_are_understood() {
        let given = "view house.obj --unit cm --up z --emit lamp*=3000 --camera kitchen --elements 20000 --solver \
                     stochastic --form-factors hemicube --tolerance 1e-3";
        let args: Vec<&str> = given.split_whitespace().collect();
        let output = hemicube(&args, None);
        assert_eq!(output.status.code(), Some(1), "only the display is missing");
        assert!(one_line(&output).contains("DISPLAY"), "{:?}", output.stderr);
        let wrong = hemicube(&["view", "--form-factors", "nusselt"], None);
        assert_eq!(wrong.status.code(), Some(2), "not while one looks at it");
    }

    /// A process that ends with the test, whatever its outcome.
    struct Running(Child);

    impl Drop for Running {
        fn drop(&mut self) {
            let _ = self.0.kill();
            let _ = self.0.wait();
        }
    }

    /// A display that nobody sees, and its name.
    fn display() -> Option<(Running, String)> {
        let mut command = Command::new("Xvfb");
        command.args([
            "-displayfd",
            "1",
            "-screen",
            "0",
            "960x600x24",
            "-nolisten",
            "tcp",
        ]);
        let mut child = Running(
            command
                .stdout(Stdio::piped())
                .stderr(Stdio::null())
                .spawn()
                .ok()?,
        );
        let mut line = String::new();
        let stdout = child.0.stdout.take()?;
        BufReader::new(stdout).read_line(&mut line).ok()?;
        let number: u32 = line.trim().parse().ok()?;
        Some((child, format!(":{number}")))
    }

    /// Mean brightness, from 0 to 1, of the middle of the screen, where the picture is.
    fn brightness(display: &str, file: &Path) -> Option<f32> {
        let taken = Command::new("import")
            .args(["-display", display, "-window", "root"])
            .arg(file)
            .output()
            .ok()?;
        if !taken.status.success() {
            return None;
        }
        let picture = open_picture(file, &ReadOptions::default()).ok()?.rgb();
        let (width, height) = (picture.width(), picture.height());
        let (mut sum, mut count) = (0.0, 0.0);
        for y in height / 3..2 * height / 3 {
            for x in 2 * width / 5..3 * width / 5 {
                sum += picture.pixel(x, y).luminance();
                count += 1.0;
            }
        }
        Some(sum / count)
    }

    /// A session that shoots in the order of the mesh and does not adapt the exposure.
    fn session(folder: &Path) -> PathBuf {
        let scene = hemicube::scene::builtin::scene("office").expect("it is built in");
        let mut display = Display::default();
        (display.auto_exposure, display.stops) = (false, -9.0);
        let document = Document::new(
            String::from("office"),
            Settings::default().with_solver(SolverKind::Shooting),
            display,
            Eye::of_camera(&scene.cameras[0], 2.0),
            Way::default(),
            Mixer::default(),
            Default::default(),
        );
        let path = folder.join("office.json");
        std::fs::write(&path, document.to_json()).expect("there is room");
        path
    }

    #[test]
    fn a_room_gets_brighter_in_a_real_window() {
        let Some((_server, name)) = display() else {
            println!("skipped: no Xvfb on this machine");
            return;
        };
        let folder = tempfile::tempdir().expect("there is room");
        let shot = folder.path().join("shot.png");
        if brightness(&name, &shot).is_none() {
            println!("skipped: no `import` (ImageMagick) on this machine");
            return;
        }
        let mut command = Command::new(env!("CARGO_BIN_EXE_hemicube"));
        command
            .arg("view")
            .arg(session(folder.path()))
            .args(["--fresh", "--size", "960x600"]);
        command
            .env("DISPLAY", &name)
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET");
        let mut program = Running(command.spawn().expect("the program starts"));
        let begin = Instant::now();
        let mut look = |what: &str, wanted: &dyn Fn(f32) -> bool| loop {
            let ended = program.0.try_wait().expect("it can be asked");
            assert!(ended.is_none(), "the window stays open: {ended:?}");
            let value = brightness(&name, &shot);
            if let Some(value) = value.filter(|&value| wanted(value)) {
                return value;
            }
            // Long, because other tests may want the processor, too.
            assert!(
                begin.elapsed() < Duration::from_secs(300),
                "{what}: {value:?}"
            );
            std::thread::sleep(Duration::from_millis(150));
        };
        let first = look("light arrives", &|value| value > 0.01);
        let last = look("it gets brighter", &|value| {
            value > 1.25 * first && value > 0.1
        });
        assert!(last < 0.95, "a room, not a white screen: {last}");
    }
}
