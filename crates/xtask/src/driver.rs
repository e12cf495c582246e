//! A Vulkan driver for the tests of the GPU, and a display for that of the viewer.

use std::path::Path;
use std::process::{Command, Stdio};

/// Where drivers say that they are there.
const FOLDERS: [&str; 3] = [
    "/usr/share/vulkan/icd.d",
    "/usr/local/share/vulkan/icd.d",
    "/etc/vulkan/icd.d",
];
/// Mesa's lavapipe, which draws in software, and the loader.
const PACKAGES: [&str; 2] = ["mesa-vulkan-drivers", "libvulkan1"];

/// A display that nobody sees, what windows need of the keyboard, and what takes pictures of the screen.
const DISPLAY: [&str; 3] = ["xvfb", "libxkbcommon-x11-0", "imagemagick"];

/// Installs what tests of the GPU and of windows need if it is not there and it can be done: on Linux with apt, as root. Says
/// how it is done by hand otherwise. Returns whether there is a Vulkan driver then.
pub fn install() -> bool {
    if !has_vulkan() {
        install_packages(
            &PACKAGES,
            "no Vulkan driver, so tests of the GPU are skipped",
        );
    }
    if !["Xvfb", "import"].into_iter().all(is_command) {
        install_packages(
            &DISPLAY,
            "no Xvfb or no ImageMagick, so the test of a real window is skipped",
        );
    }
    has_vulkan()
}

fn has_vulkan() -> bool {
    std::env::var_os("VK_DRIVER_FILES").is_some() || FOLDERS.iter().any(has_driver)
}

fn install_packages(packages: &[&str], without: &str) {
    if !cfg!(target_os = "linux") {
        return;
    }
    let command = ["install", "-y", "-qq", "--no-install-recommends"];
    let by_hand = format!("apt-get {} {}", command.join(" "), packages.join(" "));
    if !is_root() {
        eprintln!("xtask: {without}; `sudo {by_hand}` installs it");
        return;
    }
    eprintln!("\n> {by_hand}");
    // An index that is a little old does for these packages.
    run("apt-get", &["update", "-qq"]);
    if !run("apt-get", &[&command[..], packages].concat()) {
        eprintln!("xtask: {without}; it could not be installed");
    }
}

/// Whether a program of that name would be found.
fn is_command(name: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(name).is_file())
}

fn has_driver(folder: &&str) -> bool {
    Path::new(folder)
        .read_dir()
        .is_ok_and(|mut files| files.next().is_some())
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output();
    id.is_ok_and(|id| id.stdout.trim_ascii() == b"0")
}

fn run(program: &str, args: &[&str]) -> bool {
    let status = Command::new(program)
        .args(args)
        .env("DEBIAN_FRONTEND", "noninteractive")
        .stdout(Stdio::null())
        .status();
    status.is_ok_and(|status| status.success())
}
