//! The recording: its name, its outline with the part used for learning, the positions of recent matches, and its
//! character; the slots, and the share of a second recording.

use std::path::Path;

use egui::{Align, Label, Layout, Rect, RichText, Ui};

use pyrophone_settings::table::RECORDING_SLOTS;
use pyrophone_settings::{FactoryFire, Id};

use super::super::param_editor::ParamEditor;
use super::super::recording::message;
use super::super::theme;
use super::super::widgets::pick::list;
use super::super::widgets::section::{columns, filled, section, title_row, within};
use super::super::widgets::slider::slider;
use super::Parts;
use crate::loader::status::View;

/// Height of the line below the outline, in points, and of the row of buttons.
const FOOT: f32 = 16.0;
const BUTTONS: f32 = 20.0;
/// Height of the row of slots, and least height of the panel with room for it.
const SLOTS: f32 = 20.0;
const ROOM_FOR_SLOTS: f32 = 92.0;
/// Share of that row for the slots, and width of the choice of the second recording.
const SLOTS_SHARE: f32 = 0.62;
const SECOND: f32 = 52.0;

/// The panel.
pub fn show(ui: &mut Ui, rect: Rect, parts: &mut Parts<'_>, edit: &mut ParamEditor<'_>) {
    let inner = section(ui, rect, "RECORDING", "");
    let title = title_row(rect);
    let name_at = title.with_min_x(title.left() + 78.0);
    let row = title.with_max_y(title.top() + BUTTONS).translate(egui::Vec2::new(0.0, -2.0));
    let (loader, view) = (parts.loader, parts.view);
    within(ui, row.with_min_x(name_at.left()), "recording buttons", |ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            // Laid out from the right, so in reverse.
            parts.recording.buttons(ui, loader, view);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                let name = view.recording.as_deref().unwrap_or("none yet");
                let color = if view.recording.is_some() { theme::TEXT } else { theme::WEAK };
                let label = Label::new(RichText::new(name).font(theme::small()).color(color)).truncate();
                ui.add(label).on_hover_text(name);
            });
        });
    });
    let foot = inner.with_min_y(inner.bottom() - FOOT);
    let mut outline = inner.with_min_y(row.bottom() + 4.0).with_max_y(foot.top() - 3.0);
    if inner.height() >= ROOM_FOR_SLOTS {
        let slots = outline.with_min_y(outline.bottom() - SLOTS);
        outline.max.y = slots.top() - 4.0;
        show_slots(ui, slots, view, edit);
    }
    parts.recording.show_outline(ui, outline, loader, view);
    parts.monitor.heat.show(ui, outline);
    within(ui, foot, "recording words", |ui| {
        if view.error.is_some() || view.notice.is_some() {
            message(ui, loader, view);
        } else if view.recording.is_some() {
            words(ui, parts);
        }
    });
}

/// The slots, the second recording, and its share.
fn show_slots(ui: &mut Ui, rect: Rect, view: &View, edit: &mut ParamEditor<'_>) {
    let (slots, blend) = rect.split_left_right_at_x(rect.left() + SLOTS_SHARE * rect.width());
    let chosen = edit.get(Id::RecordingSlot) as usize;
    for (slot, place) in columns(slots, RECORDING_SLOTS.len(), 3.0).enumerate() {
        let number = RECORDING_SLOTS[slot];
        let named = view.slots[slot].as_deref();
        let name = named.map(|words| words.rsplit_once(": ").map_or(words, |(name, _)| name));
        let words = match (name, view.is_named[slot]) {
            (Some(name), _) => format!("{number}  {name}"),
            (None, true) => format!("{number}  not found"),
            (None, false) => number.to_owned(),
        };
        let button = filled(ui, place, &words, &format!("Slot {number}"), slot == chosen, true);
        let hint = format!(
            "{}\nClick to make this slot active. The buttons above load a recording into it.",
            named.unwrap_or("Empty")
        );
        if button.on_hover_text(hint).clicked() {
            edit.set_once(Id::RecordingSlot as usize, slot as f64);
        }
    }
    let blend = blend.with_min_x(blend.left() + 6.0);
    let (second, share) = blend.split_left_right_at_x(blend.left() + SECOND);
    within(ui, second, "second recording", |ui| {
        list(ui, Id::RecordingSecond as usize, RECORDING_SLOTS, SECOND - 12.0, edit);
    });
    slider(ui, share, Id::RecordingBlend as usize, "Blend", edit);
}

/// Available actions on the left, the recording's properties on the right.
fn words(ui: &mut Ui, parts: &Parts<'_>) {
    let view = parts.view;
    let small = |text: &str| RichText::new(text).font(theme::small()).color(theme::WEAK);
    let mut figures = vec![];
    figures.extend(view.crackles_per_s.map(|rate| format!("{rate:.1} crackles/s")));
    let is_built_in = view.path.as_ref().is_some_and(|path| FactoryFire::is_meant_by(Path::new(path)));
    let kept = if is_built_in {
        "built in"
    } else if view.embed {
        "embedded"
    } else {
        "linked"
    };
    figures.push(kept.to_owned());
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.add(Label::new(small(&figures.join(" · "))));
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            let hint = match view.cut.region_s {
                Some([start_s, end_s]) => format!("learns from {start_s:.1} to {end_s:.1} s; double-click for all"),
                None => "drag to choose the part to learn from".to_owned(),
            };
            ui.add(Label::new(small(&hint)).truncate()).on_hover_text(&hint);
        });
    });
}
