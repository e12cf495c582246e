//! The picture in the window, on whatever adapter there is.

mod shared;

use egui::Key;
use hemicube_radiosity::Quality;
use hemicube_viewer::session::Settings;
use shared::Window;

/// A window in which the light is found, if there is a device.
fn window() -> Option<Window> {
    let settings = Settings::default()
        .with_quality(Quality::Draft)
        .with_tolerance(1e-2);
    let (mut window, _) = shared::window("cornell", settings)?;
    shared::finish(&mut window);
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
