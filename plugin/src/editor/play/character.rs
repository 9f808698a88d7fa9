//! The character of the fire: the eight macros, and a pad for two of them.

use egui::{Color32, Rect, Ui};
use pyrophone_settings::Id;
use pyrophone_settings::macros::{MACROS, Macro};

use super::super::param_editor::ParamEditor;
use super::super::theme;
use super::super::widgets::knob::{Look, named_dial};
use super::super::widgets::section::{columns, section};
use super::Parts;

/// Space between dials and pad, and the least width in points for both.
const GAP: f32 = 14.0;
const ROOM_FOR_PAD: f32 = 440.0;
/// Bounds of a dial's radius in points, and the height for its name and value below it.
const RADII: (f32, f32) = (13.0, 54.0);
const WORDS: f32 = 40.0;
const PER_ROW: usize = 4;

/// The panel.
pub fn show(ui: &mut Ui, rect: Rect, parts: &mut Parts<'_>, edit: &mut ParamEditor<'_>) {
    let inner = section(ui, rect, "CHARACTER", "eight macros: offsets from the settings; 0 % changes nothing");
    let mut dials = inner;
    if inner.width() >= ROOM_FOR_PAD {
        let side = inner.height().min(0.34 * inner.width());
        let pad = inner.with_min_x(inner.right() - side);
        dials = inner.with_max_x(pad.left() - GAP);
        parts.pad.show(ui, pad, edit);
    }
    let rows = MACROS.len().div_ceil(PER_ROW);
    let height = dials.height() / rows as f32;
    for (row, macros) in MACROS.chunks(PER_ROW).enumerate() {
        let top = dials.top() + row as f32 * height;
        let places = columns(dials.with_min_y(top).with_max_y(top + height), PER_ROW, 2.0);
        for (place, line) in places.zip(macros) {
            dial(ui, place, line, edit);
        }
    }
}

fn dial(ui: &mut Ui, rect: Rect, line: &Macro, edit: &mut ParamEditor<'_>) {
    let radius = (0.5 * (rect.height() - WORDS)).min(0.36 * rect.width()).clamp(RADII.0, RADII.1);
    let more = || format!("Raises: {}.\nFrom -100 to 100 %: {}.", line.figure, line.effects_in_words());
    let look = Look { name: line.name, font: theme::strong(), color: color(line.id), radius, more: Some(&more) };
    named_dial(ui, rect, line.id as usize, &look, edit);
}

/// The colour of a macro, after its main target.
fn color(id: Id) -> Color32 {
    match id {
        Id::MacroCrackle | Id::MacroSharpness => theme::SPARK,
        Id::MacroHiss => theme::ASH,
        Id::MacroWhoosh => theme::VIOLET,
        Id::MacroTightness | Id::MacroDistance => theme::BLUE,
        _ => theme::EMBER,
    }
}
