//! What keys do.

use crate::desk::{Desk, Motion, Pick};
use crate::display::Quantity;
use crate::session::{Command, Phase};
use egui::{Context, InputState, Key, KeyboardShortcut, Modifiers};

/// Obeys the keys of a frame, unless somebody types into a field. Returns where they move the eye.
pub fn obey_keys(ctx: &Context, desk: &mut Desk) -> Motion {
    if ctx.text_edit_focused() {
        return Motion::default();
    }
    shortcuts(ctx, desk);
    let pressed = ctx.input(|input| {
        KEYS.into_iter()
            .filter(|&key| pressed(input, key))
            .collect::<Vec<_>>()
    });
    for key in pressed {
        obey(ctx, desk, key);
    }
    ctx.input(motion)
}

/// Keys that do something once, when they go down.
const KEYS: [Key; 35] = [
    Key::Space,
    Key::N,
    Key::R,
    Key::H,
    Key::F,
    Key::X,
    Key::M,
    Key::L,
    Key::T,
    Key::B,
    Key::V,
    Key::I,
    Key::Plus,
    Key::Equals,
    Key::Minus,
    Key::Num0,
    Key::G,
    Key::K,
    Key::C,
    Key::P,
    Key::O,
    Key::F1,
    Key::F2,
    Key::F3,
    Key::F11,
    Key::F12,
    Key::Num1,
    Key::Num2,
    Key::Num3,
    Key::Num4,
    Key::Num5,
    Key::Num6,
    Key::Num7,
    Key::Num8,
    Key::Num9,
];

fn pressed(input: &InputState, key: Key) -> bool {
    input.key_pressed(key)
        && !input.modifiers.ctrl
        && !input.modifiers.alt
        && !input.modifiers.mac_cmd
}

fn shortcuts(ctx: &Context, desk: &mut Desk) {
    let hit = |key| {
        ctx.input_mut(|input| {
            input.consume_shortcut(&KeyboardShortcut::new(Modifiers::COMMAND, key))
        })
    };
    if hit(Key::O) {
        desk.ask(Pick::Open);
    }
    if hit(Key::S) && desk.snapshot.is_some() {
        desk.ask(Pick::SaveLit);
    }
}

fn obey(ctx: &Context, desk: &mut Desk, key: Key) {
    let flip = |value: &mut bool| *value = !*value;
    let display = &mut desk.prefs.display;
    match key {
        // A button that has the focus takes it.
        Key::Space if ctx.memory(|memory| memory.focused().is_some()) => {}
        Key::Space => {
            let is_solving = desk.status.phase == Phase::Solving;
            desk.session.send(if is_solving {
                Command::Pause
            } else {
                Command::Run
            });
        }
        Key::N => desk.session.send(Command::Step),
        Key::R => desk.session.send(Command::Restart),
        Key::H => {
            flip(&mut desk.shows_hemicube);
            desk.prefs.left_open |= desk.shows_hemicube;
            desk.unfolds_hemicube = desk.shows_hemicube;
        }
        Key::F => show(&mut display.quantity, Quantity::Illuminance),
        Key::X => show(&mut display.quantity, Quantity::Wireframe),
        Key::M => flip(&mut display.mesh),
        Key::L => flip(&mut display.flat),
        Key::T => flip(&mut display.textures),
        Key::B => flip(&mut display.bumps),
        Key::V => flip(&mut display.reflections),
        Key::I => flip(&mut display.ambient),
        Key::Plus | Key::Equals => display.stops += 0.5,
        Key::Minus => display.stops -= 0.5,
        Key::Num0 => (display.auto_exposure, display.stops) = (true, 0.0),
        Key::G => flip(&mut desk.prefs.gravity),
        Key::K => flip(&mut desk.prefs.collisions),
        Key::C => desk.add_stop(),
        Key::P => desk.toggle_play(),
        Key::O => desk.toggle_mode(),
        Key::F1 => flip(&mut desk.shows_help),
        Key::F2 => flip(&mut desk.prefs.left_open),
        Key::F3 => flip(&mut desk.prefs.right_open),
        Key::F11 => {
            let is_full = ctx.input(|input| input.viewport().fullscreen.unwrap_or(false));
            ctx.send_viewport_cmd(egui::ViewportCommand::Fullscreen(!is_full));
        }
        Key::F12 => desk.ask(Pick::SavePicture),
        digit => {
            let number = KEYS
                .iter()
                .position(|&key| key == digit)
                .and_then(|place| place.checked_sub(26));
            let camera = number.and_then(|i| desk.stops().get(i)).cloned();
            if let Some(camera) = camera {
                desk.look_through(&camera);
            }
        }
    }
}

/// Shows a quantity, or light again if it is shown already.
fn show(shown: &mut Quantity, quantity: Quantity) {
    *shown = if *shown == quantity {
        Quantity::Light
    } else {
        quantity
    };
}

/// Where the keys that are held move the eye.
fn motion(input: &InputState) -> Motion {
    if input.modifiers.ctrl || input.modifiers.alt || input.modifiers.mac_cmd {
        return Motion::default();
    }
    let held =
        |keys: [Key; 2]| f32::from(u8::from(keys.into_iter().any(|key| input.key_down(key))));
    Motion {
        forward: held([Key::W, Key::ArrowUp]) - held([Key::S, Key::ArrowDown]),
        right: held([Key::D, Key::ArrowRight]) - held([Key::A, Key::ArrowLeft]),
        up: held([Key::E, Key::PageUp]) - held([Key::Q, Key::PageDown]),
        runs: input.modifiers.shift,
    }
}
