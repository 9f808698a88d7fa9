//! The recording: its name, its outline with the part that is learnt from, where it was matched, and what it is like.

use egui::{Align, Label, Layout, Rect, RichText, Ui};

use super::super::recording::message;
use super::super::theme;
use super::super::widgets::section::{section, title_row, within};
use super::Parts;

/// Height of the line below the outline, in points, and of the row of buttons.
const FOOT: f32 = 16.0;
const BUTTONS: f32 = 20.0;

/// The panel.
pub fn show(ui: &mut Ui, rect: Rect, parts: &mut Parts<'_>) {
    let inner = section(ui, rect, "RECORDING", "");
    let title = title_row(rect);
    let name_at = title.with_min_x(title.left() + 78.0);
    let row = title.with_max_y(title.top() + BUTTONS).translate(egui::Vec2::new(0.0, -2.0));
    let (loader, view) = (parts.loader, parts.view);
    within(ui, row.with_min_x(name_at.left()), "recording buttons", |ui| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            // From the right, so in reverse.
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
    let outline = inner.with_min_y(row.bottom() + 4.0).with_max_y(foot.top() - 3.0);
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

/// What can be done on the left, what the recording is like on the right.
fn words(ui: &mut Ui, parts: &Parts<'_>) {
    let view = parts.view;
    let small = |text: &str| RichText::new(text).font(theme::small()).color(theme::WEAK);
    let mut figures = vec![];
    figures.extend(view.crackles_per_s.map(|rate| format!("{rate:.1} crackles/s")));
    figures.push(if view.embed { "embedded" } else { "linked" }.to_owned());
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        ui.add(Label::new(small(&figures.join(" · "))));
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            let hint = match view.cut.region_s {
                Some([start_s, end_s]) => format!("learns from {start_s:.1} to {end_s:.1} s; double click takes all"),
                None => "drag to choose what it learns from".to_owned(),
            };
            ui.add(Label::new(small(&hint)).truncate()).on_hover_text(&hint);
        });
    });
}
