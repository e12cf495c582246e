//! Opening the window.

use crate::app::{ViewOptions, Viewer};
use eframe::egui_wgpu::{WgpuSetup, WgpuSetupCreateNew};
use hemicube_gpu::{ADAPTER_VARIABLE, Context};
use std::sync::Arc;

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// Nothing that shows windows.
    #[error(
        "no window can be opened ({0}); `hemicube render SCENE -o view.png` draws pictures without one"
    )]
    NoWindow(String),
    /// No adapter that draws into windows.
    #[error(
        "no adapter draws into a window ({0}); install a Vulkan driver (Mesa's lavapipe draws in software), or draw with `hemicube render SCENE -o view.png`"
    )]
    NoAdapter(String),
}

/// Opens a window and stays until it is closed.
///
/// # Errors
/// There is no window system, or nothing that draws.
pub fn view(options: ViewOptions) -> Result<(), ViewError> {
    refuse_without_display()?;
    let [width, height] = options.size.unwrap_or([1280.0, 800.0]);
    let mut viewport = egui::ViewportBuilder::default()
        .with_app_id("hemicube")
        .with_title("Hemicube")
        .with_icon(icon())
        .with_min_inner_size([640.0, 400.0]);
    viewport = viewport.with_inner_size([width, height]);
    let mut native = eframe::NativeOptions {
        viewport,
        renderer: eframe::Renderer::Wgpu,
        // There are no gradients but those of pictures, which have their bytes already.
        dithering: false,
        persist_window: options.size.is_none() && !options.forgets,
        ..Default::default()
    };
    native.wgpu_options.wgpu_setup = WgpuSetup::CreateNew(setup());
    let creator: eframe::AppCreator<'_> =
        Box::new(move |creation| Ok(Box::new(Viewer::in_window(creation, &options))));
    eframe::run_native("hemicube", native, creator).map_err(|error| {
        let why = in_one_line(&error.to_string());
        match error {
            eframe::Error::Wgpu(_) => ViewError::NoAdapter(why),
            _ => ViewError::NoWindow(why),
        }
    })
}

/// Without line ends, and without the place in the source that some errors begin with.
fn in_one_line(error: &str) -> String {
    let line = error.split_whitespace().collect::<Vec<_>>().join(" ");
    let place = line.split_once("os error at ");
    match place.and_then(|(_, rest)| rest.split_once(": ")) {
        Some((_, what)) => what.to_owned(),
        None => line,
    }
}

/// On systems where that can be told beforehand.
fn refuse_without_display() -> Result<(), ViewError> {
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let needs_display = cfg!(all(
        unix,
        not(target_os = "macos"),
        not(target_os = "android")
    ));
    if needs_display
        && !is_set("DISPLAY")
        && !is_set("WAYLAND_DISPLAY")
        && !is_set("WAYLAND_SOCKET")
    {
        let why = String::from("neither DISPLAY nor WAYLAND_DISPLAY is set");
        return Err(ViewError::NoWindow(why));
    }
    Ok(())
}

/// A device with all that solvers and pictures use of the adapter: both work on it.
fn setup() -> WgpuSetupCreateNew {
    let mut setup = WgpuSetupCreateNew::without_display_handle();
    setup.device_descriptor = Arc::new(Context::descriptor);
    let wanted = std::env::var(ADAPTER_VARIABLE)
        .ok()
        .filter(|name| !name.is_empty());
    if let Some(wanted) = wanted {
        let wanted = wanted.to_lowercase();
        setup.native_adapter_selector = Some(Arc::new(move |adapters, surface| {
            let fits = |adapter: &&wgpu::Adapter| {
                adapter.get_info().name.to_lowercase().contains(&wanted)
                    && surface.is_none_or(|surface| adapter.is_surface_supported(surface))
            };
            adapters
                .iter()
                .find(fits)
                .cloned()
                .ok_or_else(|| format!("no adapter's name contains '{wanted}'"))
        }));
    }
    setup
}

/// Half a cube on a patch, seen from above.
fn icon() -> egui::IconData {
    const SIDE: u32 = 64;
    let mut rgba = Vec::with_capacity((SIDE * SIDE * 4) as usize);
    for y in 0..SIDE {
        for x in 0..SIDE {
            rgba.extend(icon_pixel(x as f32 + 0.5 - 32.0, y as f32 + 0.5 - 32.0));
        }
    }
    egui::IconData {
        rgba,
        width: SIDE,
        height: SIDE,
    }
}

/// Top and two sides of a cube in isometric view, lit from above.
fn icon_pixel(x: f32, y: f32) -> [u8; 4] {
    let is_inside = x.abs() <= 27.0 && y.abs() + 0.5 * x.abs() <= 27.0;
    if !is_inside {
        return [0; 4];
    }
    let is_top = y + 0.5 * x.abs() <= 0.0;
    match (is_top, x < 0.0) {
        (true, _) => [255, 214, 140, 255],
        (false, true) => [196, 92, 66, 255],
        (false, false) => [96, 140, 84, 255],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_short_and_say_nothing_of_sources() {
        let winit = "winit EventLoopError: os error at /a/b/mod.rs:788: Failed to open connection to X server";
        let what = "Failed to open connection to X server";
        assert_eq!(in_one_line(winit), what, "what happened");
        assert_eq!(
            in_one_line("none:\n  not one"),
            "none: not one",
            "in one line"
        );
    }
}
