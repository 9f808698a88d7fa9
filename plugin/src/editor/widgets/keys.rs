//! Keyboard control of the focused widget.

use egui::{EventFilter, Key, Response, Ui};

/// Factor of Shift on the speed of keys, wheel and pointer.
const FINE: f64 = 0.1;

/// Steps of the arrow keys in this frame: up and right increase. The keys then do not move the focus.
pub fn notches(ui: &Ui, response: &Response) -> f64 {
    arrows(ui, response).into_iter().sum()
}

/// Steps of the arrow keys in this frame, to the right and up. The keys then do not move the focus.
pub fn arrows(ui: &Ui, response: &Response) -> [f64; 2] {
    if !response.has_focus() {
        return [0.0; 2];
    }
    ui.memory_mut(|memory| {
        let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        memory.set_focus_lock_filter(response.id, arrows);
    });
    let pressed = |key: Key| ui.input(|input| f64::from(u8::from(input.key_pressed(key))));
    [pressed(Key::ArrowRight) - pressed(Key::ArrowLeft), pressed(Key::ArrowUp) - pressed(Key::ArrowDown)]
}

/// True if the user asks the focused widget for its default.
pub fn is_reset(ui: &Ui, response: &Response) -> bool {
    response.has_focus() && ui.input(|input| input.key_pressed(Key::Delete) || input.key_pressed(Key::Backspace))
}

/// Factor on steps: smaller while Shift is held.
pub fn fine(ui: &Ui) -> f64 {
    if ui.input(|input| input.modifiers.shift) { FINE } else { 1.0 }
}
