//! Keyboard control of the focused widget.

use egui::{EventFilter, Key, Response, Ui};

/// Steps of the arrow keys in this frame: up and right increase. The keys then do not move the focus.
pub fn notches(ui: &Ui, response: &Response) -> f64 {
    if !response.has_focus() {
        return 0.0;
    }
    ui.memory_mut(|memory| {
        let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        memory.set_focus_lock_filter(response.id, arrows);
    });
    let pressed = |key: Key| ui.input(|input| f64::from(u8::from(input.key_pressed(key))));
    pressed(Key::ArrowUp) + pressed(Key::ArrowRight) - pressed(Key::ArrowDown) - pressed(Key::ArrowLeft)
}
