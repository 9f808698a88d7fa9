//! The Engines page: spectra and pictures of the engines above, their parameters below.

use egui::Rect;
use pyrophone_settings::Id;
use pyrophone_settings::table::DYNAMIC_RANGES;

use super::controls::{self, Page};
use super::param_editor::ParamEditor;
use super::play::Parts;
use super::{GAP, listen, meter_bridge, part, theme};

/// Heights of the recording's words without and with a message, in points.
const WORDS: f32 = 80.0;
const MESSAGE: f32 = 30.0;
/// Width below which one of the rows of text wraps, the height of that row, and the least height of sounds and text
/// together at which it is shown, in points.
const ROOM_FOR_ROWS: f32 = 400.0;
const ROW: f32 = 26.0;
const ROOM_FOR_FOUR_ROWS: f32 = 220.0;
/// Width of the meters, in points.
const METERS: f32 = 190.0;
/// Height that the parameters like to have, in points.
const CONTROLS: f32 = 388.0;
/// Height of the engines' pictures; if all pictures together have less than this height, they are left out.
const ENGINES: f32 = 84.0;
const ROOM_FOR_ENGINES: f32 = 270.0;

/// Explanations of the running spectrograms.
const COURSES: [&str; 2] = [
    "Flame of the last eight seconds: low frequencies at the bottom, louder is brighter; delayed to be in time with the output",
    "Output of the last eight seconds: low frequencies at the bottom, louder is brighter",
];

/// Draws the page.
pub fn show(ui: &mut egui::Ui, rest: Rect, parts: &mut Parts<'_>, edit: &mut ParamEditor<'_>) {
    let controls = pictures(ui, rest, parts, edit);
    part(ui, controls, "controls", |ui| controls::show(ui, Page::Engines, edit));
}

/// Draws spectra, sounds, meters and the engines' pictures in the upper part of `rest`; returns the area below them.
pub fn pictures(ui: &mut egui::Ui, rest: Rect, parts: &mut Parts<'_>, edit: &mut ParamEditor<'_>) -> Rect {
    // Pictures get the space left by the parameters, and at least two fifths.
    let split = rest.top() + (rest.height() - CONTROLS).clamp(0.4 * rest.height(), 0.62 * rest.height());
    let (upper, lower) = rest.split_top_bottom_at_y(split);
    let middle = upper.left() + 0.54 * (upper.width() - METERS);
    let left = upper.with_max_x(middle);
    let right = upper.with_min_x(middle + GAP).with_max_x(upper.right() - METERS - GAP);
    let meters = upper.with_min_x(upper.right() - METERS);

    let shows_engines = left.height() >= ROOM_FOR_ENGINES;
    let spectra = if shows_engines { left.with_max_y(left.bottom() - ENGINES - GAP) } else { left };
    let (assessment, overview) = (parts.assessment, parts.view.overview.clone());
    parts.monitor.spectra().show(ui, spectra, overview.as_deref(), &assessment, edit);
    if shows_engines {
        engines(ui, left.with_min_y(left.bottom() - ENGINES), parts, edit);
    }
    sounds(ui, right, parts, edit);
    meter_bridge::show(ui, meters.with_max_y(meters.bottom() - listen::HEIGHT - GAP), parts.levels);
    part(ui, listen::place(meters), "listen", |ui| {
        parts.listen.show(ui, parts.monitor, parts.loader, parts.view, edit);
    });
    lower.with_min_y(lower.top() + GAP)
}

/// Pictures of the engines: extension's factors, texture's levels, and the loudness matching.
fn engines(ui: &egui::Ui, rect: Rect, parts: &mut Parts<'_>, edit: &ParamEditor<'_>) {
    let width = (rect.width() - 2.0 * GAP) / 3.0;
    let place = |index: f32| {
        let left = rect.left() + index * (width + GAP);
        rect.with_min_x(left).with_max_x(left + width)
    };
    let uses_learned = DYNAMIC_RANGES.get(edit.get(Id::DynamicRange) as usize) == Some(&"learned");
    let [recording, learned] = &parts.view.amplitudes;
    let learned = learned.as_deref().filter(|_| uses_learned);
    parts.monitor.betas.show(ui, place(0.0));
    parts.monitor.levels.show(ui, place(1.0));
    parts.monitor.dynamics.show(ui, place(2.0), recording.as_deref(), learned);
    let explanations = [
        "Noise factor of each window of extension (beta of Chadwick & James, Algorithm 1): the gain with which the noise continues where the flame ends",
        "The levels of texture synthesis, coarsest at the top: the coarsest is the flame's own, all others come from the recording",
        "Share of the flame's windows (blue) and of the recording's (grey) below each level; the line leads from the current window's level to the one it is mapped to",
    ];
    for (index, words) in explanations.into_iter().enumerate() {
        let id = egui::Id::unique(("engines", index));
        ui.interact(place(index as f32), id, egui::Sense::hover()).on_hover_text(words);
    }
}

/// Flame, output and recording over time, and the recording's words.
fn sounds(ui: &mut egui::Ui, rect: Rect, parts: &mut Parts<'_>, edit: &mut ParamEditor<'_>) {
    let view = parts.view;
    let cancels = parts.meters.input_cancels();
    let has_message = view.error.is_some() || view.notice.is_some() || cancels;
    let is_broken = rect.width() < ROOM_FOR_ROWS && rect.height() >= ROOM_FOR_FOUR_ROWS;
    let height = WORDS + if is_broken { ROW } else { 0.0 } + if has_message { MESSAGE } else { 0.0 };
    let words = rect.with_min_y(rect.bottom() - height);
    let course = (rect.height() - height - 4.0 * GAP) / 4.0;
    let row = |index: f32| {
        let top = rect.top() + index * (course + GAP);
        rect.with_min_y(top).with_max_y(top + course)
    };
    parts.monitor.drive().show(ui, row(0.0), theme::BLUE);
    parts.monitor.output().show(ui, row(1.0), theme::EMBER);
    parts.recording.show_pictures(ui, [row(2.0), row(3.0)], parts.loader, view);
    parts.monitor.heat.show(ui, row(2.0));
    for (index, words) in COURSES.into_iter().enumerate() {
        let id = egui::Id::unique(("courses", index));
        ui.interact(row(index as f32), id, egui::Sense::hover()).on_hover_text(words);
    }
    part(ui, words, "recording", |ui| {
        parts.recording.show(ui, parts.loader, edit, view);
        if cancels && view.error.is_none() {
            let warning = "The input's channels cancel each other: invert one of them, or use mono.";
            ui.label(egui::RichText::new(warning).font(theme::small()).color(theme::ALARM));
        }
    });
}
