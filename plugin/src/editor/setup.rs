//! The Setup page: what is decided once.
//!
//! | part | content |
//! |---|---|
//! | parameters | sizes of the engines, dynamics mode, quality |
//! | [`user`] | scale of the window, folder of presets |
//! | MIDI | the controllers that move parameters |

pub mod user;

use egui::Rect;

use super::controls::{self, Page};
use super::midi::MidiPanel;
use super::param_editor::ParamEditor;
use super::{GAP, part};
use user::UserPanel;

/// Share of the width for the list of controllers, with its bounds in points.
const LIST: f32 = 0.345;
const LIST_BOUNDS: (f32, f32) = (260.0, 520.0);

/// Draws the page.
pub fn show(ui: &mut egui::Ui, rest: Rect, user: &mut UserPanel, midi: &mut MidiPanel, edit: &mut ParamEditor<'_>) {
    let list = (LIST * rest.width()).clamp(LIST_BOUNDS.0, LIST_BOUNDS.1);
    let (left, right) = rest.split_left_right_at_x(rest.right() - list);
    let left = left.with_max_x(left.right() - GAP);
    let (above, below) = left.split_top_bottom_at_y(left.top() + user::HEIGHT);
    part(ui, above, "user", |ui| user.show(ui, above));
    part(ui, below.with_min_y(below.top() + GAP), "controls", |ui| controls::show(ui, Page::Setup, edit));
    part(ui, right, "midi", |ui| midi.list(ui, right, &edit.params.controllers));
}
