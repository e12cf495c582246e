//! The picture in the window, on whatever adapter there is.

use egui::{Key, Ui, Vec2};
use egui_kittest::Harness;
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state, default_wgpu_setup};
use egui_wgpu::{RenderState, RendererOptions};
use hemicube_radiosity::Quality;
use hemicube_viewer::session::{Phase, Settings};
use hemicube_viewer::{ViewOptions, Viewer};
use std::time::{Duration, Instant};

type Window = Harness<'static, Option<Viewer>>;

/// A window with a device, if there is one.
fn window() -> Option<Window> {
    let adapters = hemicube_gpu::adapters();
    if adapters.iter().all(|adapter| adapter.usable.is_err()) {
        assert!(
            std::env::var_os("HEMICUBE_TESTS_NEED_GPU").is_none(),
            "there is a driver, so there is an adapter"
        );
        println!("skipped: no adapter on this machine");
        return None;
    }
    let device: RenderState =
        create_render_state(default_wgpu_setup(), RendererOptions::PREDICTABLE);
    let renderer = WgpuTestRenderer::from_render_state(device.clone());
    let settings = Settings::default()
        .with_quality(Quality::Draft)
        .with_tolerance(1e-2);
    let options = ViewOptions {
        scene: String::from("cornell"),
        settings: Some(settings),
        forgets: true,
        ..ViewOptions::default()
    };
    let show = move |ui: &mut Ui, state: &mut Option<Viewer>| {
        let new = || Viewer::new(ui.ctx(), None, Some(&device), &options);
        state.get_or_insert_with(new).frame(ui);
    };
    let builder = Harness::builder()
        .with_size(Vec2::new(960.0, 600.0))
        .renderer(renderer);
    let mut window = builder.build_ui_state(show, None);
    let begin = Instant::now();
    let is_finished = |window: &Window| {
        let viewer = window.state().as_ref();
        viewer.is_some_and(|viewer| {
            viewer.desk.status.phase == Phase::Finished && viewer.is_up_to_date()
        })
    };
    while !is_finished(&window) {
        window.step();
        assert!(begin.elapsed() < Duration::from_secs(90), "it finishes");
        std::thread::sleep(Duration::from_millis(5));
    }
    Some(window)
}

/// Mean colour of a part of the window, given by shares of its size.
fn mean(window: &mut Window, x: core::ops::Range<f32>, y: core::ops::Range<f32>) -> [f32; 3] {
    window.run_steps(3);
    let picture = window.render().expect("it can be drawn");
    let (width, height) = (picture.width() as f32, picture.height() as f32);
    let (mut sums, mut count) = ([0.0; 3], 0.0);
    for (column, row, pixel) in picture.enumerate_pixels() {
        if x.contains(&(column as f32 / width)) && y.contains(&(row as f32 / height)) {
            for (sum, &band) in sums.iter_mut().zip(&pixel.0) {
                *sum += f32::from(band);
            }
            count += 1.0;
        }
    }
    sums.map(|sum| sum / count)
}

#[test]
fn the_room_is_lit_and_every_way_to_show_it_is_different() {
    let Some(mut window) = window() else { return };
    // Without the panels the picture is wide and the room in its middle.
    for key in [Key::F2, Key::F3] {
        window.key_press(key);
        window.run_steps(2);
    }
    let left = mean(&mut window, 0.25..0.30, 0.4..0.6);
    let right = mean(&mut window, 0.70..0.75, 0.4..0.6);
    assert!(
        left[0] > 60.0 && left[0] > 1.5 * left[1],
        "the red wall: {left:?}"
    );
    assert!(
        right[1] > 60.0 && right[1] > 1.1 * right[0],
        "the green wall: {right:?}"
    );
    let back = mean(&mut window, 0.45..0.55, 0.35..0.45);
    assert!(
        back.iter().all(|&band| band < 245.0) && back[0] > 80.0,
        "the back wall: {back:?}"
    );

    let mut shown = vec![back];
    for key in [Key::F, Key::X] {
        window.key_press(key);
        shown.push(mean(&mut window, 0.45..0.55, 0.35..0.45));
    }
    window.key_press(Key::X);
    window.key_press(Key::Minus);
    shown.push(mean(&mut window, 0.45..0.55, 0.35..0.45));
    for (i, a) in shown.iter().enumerate() {
        for b in &shown[i + 1..] {
            let apart: f32 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
            assert!(
                apart > 5.0,
                "light, false colours, wireframe, darker: {shown:?}"
            );
        }
    }
    assert!(shown[3][0] < back[0], "half a stop darker: {shown:?}");
}
