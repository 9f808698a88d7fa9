//! The Setup page: sizes of the engines, and the MIDI controllers that move parameters.

use egui::Rect;

use super::controls::{self, Page};
use super::midi::MidiPanel;
use super::param_editor::ParamEditor;
use super::play::Parts;
use super::{GAP, engines, part};

/// Share of the width for the list of controllers, with its bounds in points.
const LIST: f32 = 0.345;
const LIST_BOUNDS: (f32, f32) = (260.0, 520.0);

/// Draws the page.
pub fn show(ui: &mut egui::Ui, rest: Rect, parts: &mut Parts<'_>, midi: &mut MidiPanel, hand: &mut ParamEditor<'_>) {
    let lower = engines::pictures(ui, rest, parts, hand);
    let list = (LIST * lower.width()).clamp(LIST_BOUNDS.0, LIST_BOUNDS.1);
    let (left, right) = lower.split_left_right_at_x(lower.right() - list);
    part(ui, left.with_max_x(left.right() - GAP), "controls", |ui| controls::show(ui, Page::Setup, hand));
    part(ui, right, "midi", |ui| midi.list(ui, right, &hand.params.controllers));
}
