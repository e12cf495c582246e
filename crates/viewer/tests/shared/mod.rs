//! A window with a device, for tests.

use egui::{Ui, Vec2};
use egui_kittest::Harness;
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup};
use egui_wgpu::{RenderState, RendererOptions};
use hemicube_viewer::session::{Phase, Settings};
use hemicube_viewer::{ViewOptions, Viewer};
use std::time::{Duration, Instant};

/// A window that nobody sees.
pub type Window = Harness<'static, Option<Viewer>>;

/// Whether there is an adapter; a machine that is to test everything must have one.
pub fn has_adapter() -> bool {
    let adapters = hemicube_gpu::adapters();
    let is_there = adapters.iter().any(|adapter| adapter.usable.is_ok());
    if !is_there {
        assert!(
            std::env::var_os("HEMICUBE_TESTS_NEED_GPU").is_none(),
            "there is a driver, so there is an adapter"
        );
        println!("skipped: no adapter on this machine");
    }
    is_there
}

/// A window and its device, if there is one.
pub fn window(scene: &str, settings: Settings) -> Option<(Window, RenderState)> {
    if !has_adapter() {
        return None;
    }
    let device: RenderState =
        create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE);
    let renderer = WgpuTestRenderer::from_render_state(device.clone());
    let options = ViewOptions {
        scene: scene.to_owned(),
        settings: Some(settings),
        forgets: true,
        ..ViewOptions::default()
    };
    let of_window = device.clone();
    let show = move |ui: &mut Ui, state: &mut Option<Viewer>| {
        let new = || Viewer::new(ui.ctx(), None, Some(&of_window), &options);
        state.get_or_insert_with(new).frame(ui);
    };
    let builder = Harness::builder()
        .with_size(Vec2::new(960.0, 600.0))
        .renderer(renderer);
    Some((builder.build_ui_state(show, None), device))
}

/// Runs frames until something is as wanted.
pub fn wait(window: &mut Window, what: &str, wanted: impl Fn(&Viewer) -> bool) {
    let begin = Instant::now();
    loop {
        window.step();
        let viewer = window.state().as_ref();
        if viewer.is_some_and(&wanted) {
            return;
        }
        let status = viewer.map(|viewer| &viewer.desk.status);
        let time = begin.elapsed();
        assert!(time < Duration::from_secs(90), "{what}: {status:?}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Runs frames until the light is found and shown.
pub fn finish(window: &mut Window) {
    wait(window, "it finishes", |viewer| {
        viewer.desk.status.phase == Phase::Finished && viewer.is_up_to_date()
    });
}
