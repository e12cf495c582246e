//! A Vulkan driver for the tests of the GPU.

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

/// Installs a driver that draws in software if there is none and it can be done: on Linux with apt, as root. Says how it is
/// done by hand otherwise. Tests decide for themselves what they do without.
pub fn install() {
    let is_there = std::env::var_os("VK_DRIVER_FILES").is_some() || FOLDERS.iter().any(has_driver);
    if !cfg!(target_os = "linux") || is_there {
        return;
    }
    let command = ["install", "-y", "-qq", "--no-install-recommends"];
    let by_hand = format!("apt-get {} {}", command.join(" "), PACKAGES.join(" "));
    if !is_root() {
        eprintln!(
            "xtask: no Vulkan driver, so tests of the GPU are skipped; `sudo {by_hand}` installs one"
        );
        return;
    }
    eprintln!("\n> {by_hand}");
    // An index that is a little old does for these packages.
    run("apt-get", &["update", "-qq"]);
    if !run("apt-get", &[&command[..], &PACKAGES].concat()) {
        eprintln!("xtask: no Vulkan driver could be installed");
    }
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
