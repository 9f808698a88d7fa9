//! Turning a parameter: drag (finer with Shift), wheel, arrow keys, double click for the default, a menu on the right button.

use egui::{Response, Ui, WidgetInfo};
use pyrophone_settings::{PARAMETERS, ParameterKind};

use super::super::param_editor::ParamEditor;
use super::keys::{fine, is_reset};
use super::menu::menu;

/// Points of pointer travel for a full turn.
const TRAVEL: f32 = 180.0;
/// Share of the range for a notch of the wheel or an arrow key.
pub const NOTCH: f64 = 0.02;

/// Direction of the pointer that moves a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Travel {
    /// Up and to the right increase; a full turn needs the same travel whatever the widget's size.
    Knob,
    /// Along a vertical track of this length in points.
    Fader(f32),
    /// Along a horizontal track of this length in points.
    Slider(f32),
}

/// Follows mouse and keys; returns the resulting value. The pointer does not move parameters without effect.
pub fn turn(ui: &Ui, response: &Response, index: usize, travel: Travel, edit: &mut ParamEditor<'_>) -> f64 {
    let parameter = &PARAMETERS[index];
    let is_held = ui.data(|data| data.get_temp::<f64>(response.id)).is_some();
    if is_held || edit.inert(index).is_none() {
        drag(ui, response, index, travel, edit);
        notches(ui, response, index, edit);
    }
    if response.double_clicked() {
        edit.set_once(index, parameter.default_value());
    } else if response.clicked() {
        response.request_focus();
    }
    if is_reset(ui, response) {
        edit.set_once(index, parameter.default_value());
    }
    menu(response, index, true, edit);
    let plain = edit.value(index);
    response.widget_info(|| {
        let mut info = WidgetInfo::slider(true, plain, parameter.name);
        info.current_text_value = Some(parameter.to_text(plain));
        info
    });
    plain
}

fn drag(ui: &Ui, response: &Response, index: usize, travel: Travel, edit: &mut ParamEditor<'_>) {
    let parameter = &PARAMETERS[index];
    let plain = edit.value(index);
    let place = parameter.to_normalised(plain);
    let id = response.id;
    let by_primary = ui.input(|input| input.pointer.primary_down());
    if response.drag_started() && by_primary {
        response.request_focus();
        edit.begin(index);
        ui.data_mut(|data| data.insert_temp(id, place));
    }
    let Some(held) = ui.data(|data| data.get_temp::<f64>(id)) else { return };
    if response.dragged() {
        let delta = response.drag_delta();
        let moved = match travel {
            Travel::Knob => (delta.x - delta.y) / TRAVEL,
            Travel::Fader(length) => -delta.y / length.max(1.0),
            Travel::Slider(length) => delta.x / length.max(1.0),
        };
        let held = (held + fine(ui) * f64::from(moved)).clamp(0.0, 1.0);
        ui.data_mut(|data| data.insert_temp(id, held));
        let next = parameter.from_normalised(held);
        if next != plain {
            edit.set(index, next);
        }
    }
    if response.drag_stopped() {
        ui.data_mut(|data| data.remove::<f64>(id));
        edit.end(index);
    }
}

/// Notches of the wheel, where the pointer rests on the focused widget or Ctrl is held, and of arrow keys: without
/// focus the wheel scrolls the page.
fn notches(ui: &Ui, response: &Response, index: usize, edit: &mut ParamEditor<'_>) {
    let parameter = &PARAMETERS[index];
    let mut notches = 0.0;
    if response.hovered() && (response.has_focus() || ui.input(|input| input.modifiers.command)) {
        notches += ui.input(wheel);
        ui.input_mut(|input| input.smooth_scroll_delta = egui::Vec2::ZERO);
    }
    notches += super::notches(ui, response);
    if notches == 0.0 {
        return;
    }
    let plain = edit.value(index);
    let next = match parameter.kind {
        ParameterKind::Int { .. } => (plain + notches.signum()).clamp(parameter.low(), parameter.high()),
        _ => parameter.from_normalised((parameter.to_normalised(plain) + notches * NOTCH * fine(ui)).clamp(0.0, 1.0)),
    };
    if next != plain {
        edit.set_once(index, next);
    }
}

/// Notches of the wheel since the last frame.
fn wheel(input: &egui::InputState) -> f64 {
    let notches = input.events.iter().filter_map(|event| match event {
        egui::Event::MouseWheel { unit, delta, .. } => Some(match unit {
            egui::MouseWheelUnit::Point => delta.y / 40.0,
            egui::MouseWheelUnit::Line | egui::MouseWheelUnit::Page => delta.y,
        }),
        _ => None,
    });
    f64::from(notches.sum::<f32>())
}
