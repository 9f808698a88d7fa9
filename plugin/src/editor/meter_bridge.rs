//! The meters side by side, with solo and mute of the layers below them.

use egui::{Align2, FontFamily, FontId, Pos2, Rect, Ui, Vec2};

use super::levels::{FLOOR_DB, LAYER_NAMES, Levels, Meter};
use super::theme;
use super::widgets::section::filled;
use crate::probe::LAYERS;

/// The highest level shown, in dB.
const TOP_DB: f32 = 6.0;
const METERS: usize = LAYERS + 3;
/// Width of a meter that has room for its name in the usual size, in points.
const ROOM_FOR_NAMES: f32 = 22.0;
/// Height of a button below a meter, in points.
const BUTTON: f32 = 15.0;

/// Shows the meters, and below those of layers their switches.
pub fn show(ui: &mut Ui, rect: Rect, levels: &mut Levels) {
    bars(ui, rect.with_max_y(rect.bottom() - 2.0 * BUTTON - 3.0), levels);
    let step = rect.width() / METERS as f32;
    let ui = &mut ui.new_child(egui::UiBuilder::new().id_salt("layers").max_rect(rect));
    for (place, meter) in Meter::all().enumerate() {
        if let Meter::Layer(layer) = meter {
            let left = rect.left() + place as f32 * step;
            let spot = Rect::from_min_max(
                Pos2::new(left + 1.0, rect.bottom() - 2.0 * BUTTON - 1.0),
                Pos2::new(left + step - 1.0, rect.bottom()),
            );
            switches(ui, spot.split_top_bottom_at_fraction(0.5).into(), layer, levels);
        }
    }
}

/// Solo and mute of a layer, in two areas.
pub fn switches(ui: &mut Ui, places: [Rect; 2], layer: usize, levels: &mut Levels) {
    let Some((short, long)) = LAYER_NAMES.get(layer) else { return };
    let mut switch = |place: Rect, is_on: &mut bool, letter: &str, how: &str| {
        let place = place.shrink2(Vec2::new(0.0, 0.5));
        let button = filled(ui, place, letter, &format!("{letter} {short}"), *is_on, true);
        let hint = || format!("Hear {long} {how}, until the window closes. Not saved, not automated.");
        if button.on_hover_ui(|ui| drop(ui.label(hint()))).clicked() {
            *is_on = !*is_on;
        }
    };
    switch(places[0], &mut levels.soloed[layer], "S", "alone");
    switch(places[1], &mut levels.muted[layer], "M", "not at all");
}

fn bars(ui: &Ui, rect: Rect, levels: &Levels) {
    let painter = ui.painter();
    let silenced = levels.silenced();
    painter.rect_filled(rect, 3.0, theme::WELL);
    let step = rect.width() / METERS as f32;
    let (top, bottom) = (rect.top() + 18.0, rect.bottom() - 16.0);
    let height =
        |level_db: f32| bottom + (top - bottom) * ((level_db - FLOOR_DB) / (TOP_DB - FLOOR_DB)).clamp(0.0, 1.0);
    for (place, meter) in Meter::all().enumerate() {
        let level = levels.get(meter);
        let middle = rect.left() + (place as f32 + 0.5) * step;
        let bar = |from: f32, to: f32| {
            Rect::from_min_max(Pos2::new(middle - 0.3 * step, to), Pos2::new(middle + 0.3 * step, from))
        };
        painter.rect_filled(bar(bottom, top), 1.0, theme::PANEL);
        let color = match meter {
            Meter::Layer(layer) if silenced.get(layer) == Some(&true) => theme::WEAK,
            _ if level.shown_db > 0.0 => theme::ALARM,
            Meter::Input | Meter::Drive => theme::BLUE,
            _ => theme::EMBER,
        };
        painter.rect_filled(bar(bottom, height(level.shown_db)), 1.0, color);
        let is_narrow = step < ROOM_FOR_NAMES;
        let name = if is_narrow && meter == Meter::Drive { "dr" } else { meter.name() };
        // Names of the usual size would overlap between narrow meters.
        let font = if is_narrow { FontId::new(8.5, FontFamily::Proportional) } else { theme::small() };
        painter.text(Pos2::new(middle, bottom + 2.0), Align2::CENTER_TOP, name, font, theme::WEAK);
        if level.shown_db > FLOOR_DB {
            let (at, text) = (Pos2::new(middle, rect.top() + 2.0), format!("{:.0}", level.shown_db));
            painter.text(at, Align2::CENTER_TOP, text, theme::small(), theme::TEXT);
        }
    }
    let line = Rect::from_min_size(Pos2::new(rect.left(), height(0.0)), Vec2::new(rect.width(), 1.0));
    painter.rect_filled(line, 0.0, theme::TEXT.gamma_multiply(0.2));
}
