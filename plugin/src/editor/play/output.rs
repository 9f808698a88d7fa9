//! The output: its running spectrogram, and a strip with its match.

use std::sync::Arc;

use egui::{Align2, Button, Pos2, Rect, RichText, Sense, Ui, Vec2};

use pyrophone_settings::table::DRIVE_MODES;
use pyrophone_settings::{Id, Preset, Values};

use super::super::history::Entry;
use super::super::levels::{FLOOR_DB, Meter};
use super::super::param_editor::ParamEditor;
use super::super::plots::spectrum::Advice;
use super::super::suggestion::Suggestion;
use super::super::widgets::section::{filled, within};
use super::super::{map, theme};
use super::Parts;
use pyrophone_analysis::bands::position;
use pyrophone_analysis::fidelity::Diagnosis;

/// Height of the strip in points.
const STRIP: f32 = 22.0;
/// Height of the button in it.
const BUTTON: f32 = 17.0;

/// The preset that is chosen when a fire is lit before anything was set or loaded: one that needs no recording.
const FIRST_FIRE: &str = "hearth";

/// The panel.
pub fn show(ui: &mut Ui, rect: Rect, parts: &mut Parts<'_>, edit: &mut ParamEditor<'_>) {
    let (picture, strip) = rect.split_top_bottom_at_y(rect.bottom() - STRIP);
    ui.painter().rect_filled(rect, f32::from(theme::ROUNDING) + 2.0, theme::PANEL);
    parts.monitor.output().show_picture(ui, picture);
    let painter = ui.painter().with_clip_rect(picture);
    let readable = |at: Pos2, anchor: Align2, text: &str, font, color| {
        let galley = painter.layout_no_wrap(text.to_owned(), font, color);
        let spot = anchor.anchor_size(at, galley.size());
        painter.rect_filled(spot.expand2(Vec2::new(4.0, 2.0)), 3.0, theme::WELL.gamma_multiply(0.75));
        painter.galley(spot.min, galley, color);
    };
    readable(picture.left_top() + Vec2::new(10.0, 9.0), Align2::LEFT_TOP, "OUTPUT", theme::head(), theme::EMBER);
    for (frequency_hz, name) in [(100.0, "100"), (1000.0, "1k"), (10_000.0, "10k Hz")] {
        let y = picture.bottom() - position(frequency_hz) as f32 * picture.height();
        readable(Pos2::new(picture.right() - 6.0, y), Align2::RIGHT_CENTER, name, theme::small(), theme::WEAK);
    }
    light(ui, picture, parts, edit);
    let assessment = parts.assessment;
    within(ui, strip.shrink2(Vec2::new(9.0, 2.0)), "match", |ui| figures(ui, &assessment, edit));
}

/// An offer to start the built-in flame where no input arrives: the first thing a user sees after loading the plug-in.
fn light(ui: &mut Ui, rect: Rect, parts: &Parts<'_>, edit: &mut ParamEditor<'_>) {
    let is_silent = |meter| parts.levels.get(meter).held_db <= FLOOR_DB;
    let burns = DRIVE_MODES.get(edit.get(Id::DriveMode) as usize) == Some(&"flame");
    if burns || ![Meter::Input, Meter::Drive, Meter::Output].into_iter().all(is_silent) {
        return;
    }
    let place = Rect::from_center_size(rect.center(), Vec2::new(150.0, 26.0));
    let button = filled(ui, place, "Light a built-in fire", "Light", false, true);
    if button.on_hover_text("There is no input: burn a simulated campfire instead of the track").clicked() {
        let values = edit.values();
        let is_untouched = parts.view.path.is_none() && Values::default().chosen_over(&values) == values;
        match Preset::find(FIRST_FIRE) {
            Ok(preset) if is_untouched => edit.choose(Some(Arc::new(Entry { preset, path: None }))),
            // What the user has set or loaded already sounds with the flame.
            _ => {
                let flame = DRIVE_MODES.iter().position(|mode| *mode == "flame").unwrap_or(0);
                edit.set_once(Id::DriveMode as usize, flame as f64);
            }
        }
    }
}

/// One line: a lamp, the figures, and a suggestion where there is a fault.
fn figures(ui: &mut Ui, assessment: &Advice, edit: &mut ParamEditor<'_>) {
    // Otherwise a button would be higher than the strip, and cut.
    ui.spacing_mut().interact_size.y = BUTTON;
    ui.horizontal_centered(|ui| {
        let words = words(assessment);
        let (lamp, color) = match (assessment.fault, words.is_empty()) {
            (Some(_), _) => (theme::ALARM, theme::TEXT),
            (None, true) => (theme::LINE, theme::WEAK),
            (None, false) => (theme::WELL_DONE, theme::TEXT),
        };
        let (spot, _) = ui.allocate_exact_size(Vec2::splat(8.0), Sense::hover());
        ui.painter().circle_filled(spot.center(), 3.5, lamp);
        if let Some(fault) = assessment.fault {
            advise(ui, fault, edit);
            return;
        }
        let text = if words.is_empty() { "Nothing to compare yet".to_owned() } else { words.join("  ·  ") };
        let label = egui::Label::new(RichText::new(text).font(theme::small()).color(color)).truncate();
        ui.add(label).on_hover_text(EXPLANATION);
    });
}

const EXPLANATION: &str = "Over the last eight seconds. Sync: correlation of the output's loudness with the flame's, 1 at \
    best. Buzz: how far the output's strongest tones stand out beyond the recording's. Crackle: how sudden the output is, \
    as a multiple of the recording, 1 at best.";

fn words(assessment: &Advice) -> Vec<String> {
    let mut words = vec![];
    words.extend(assessment.figures.follows.map(|follows| format!("sync {follows:.2}")));
    words.extend(assessment.figures.lines_db.map(|lines_db| match lines_db {
        ..1.0 => "no buzz".to_owned(),
        _ => format!("tones +{lines_db:.1} dB"),
    }));
    words.extend(assessment.figures.crackle.map(|crackle| format!("crackle ×{crackle:.1}")));
    words
}

/// The fault, and a button that applies the suggestion.
fn advise(ui: &mut Ui, fault: Diagnosis, edit: &mut ParamEditor<'_>) {
    let remedy = Suggestion::of(fault, &edit.values());
    let advice = fault.advice(remedy.is_none());
    let room = if remedy.is_some() { 130.0 } else { 0.0 };
    ui.allocate_ui(Vec2::new((ui.available_width() - room).max(60.0), ui.available_height()), |ui| {
        let label = egui::Label::new(RichText::new(advice).font(theme::small()).color(theme::EMBER)).truncate();
        ui.add(label).on_hover_text(advice);
    });
    let Some(remedy) = remedy else { return };
    let button = Button::new(RichText::new(&remedy.words).font(theme::small())).truncate();
    let button = ui.add_sized(Vec2::new(room - 8.0, BUTTON), button);
    map::note(ui, "button.Cure", button.rect);
    let what = format!("{}. Undo reverts it.", remedy.words);
    if button.on_hover_text(what).clicked() {
        edit.set_once(remedy.id as usize, remedy.plain);
    }
}
