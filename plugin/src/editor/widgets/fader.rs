//! A fader over the meter of the level that it sets.

use egui::{Align2, Color32, Id, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui, Vec2};
use pyrophone_settings::PARAMETERS;

use super::super::levels::{FLOOR_DB, Level};
use super::super::param_editor::ParamEditor;
use super::super::{map, theme};
use super::baked::{baked, bits};
use super::turn::{Travel, turn};

/// Size of the handle, in points, and the width of the track.
const HANDLE: Vec2 = Vec2::new(24.0, 10.0);
const TRACK: f32 = 10.0;

/// Content of a fader.
#[derive(Debug, Clone, Copy)]
pub struct Track {
    /// Colour of the meter.
    pub color: Color32,
    /// Level of the signal it controls.
    pub level: Level,
    /// True if the signal is not heard at present.
    pub is_silenced: bool,
}

/// A fader for the parameter at `index`, a level in dB, along all of `rect`; meter and handle share the parameter's scale.
pub fn fader(ui: &mut Ui, rect: Rect, index: usize, track: &Track, edit: &mut ParamEditor<'_>) {
    let parameter = &PARAMETERS[index];
    let response = ui.interact(rect, Id::unique(("fader", parameter.id)), Sense::click_and_drag());
    map::note(ui, format_args!("fader.{}", parameter.id), rect);
    let well = Rect::from_center_size(rect.center(), Vec2::new(TRACK.min(rect.width()), rect.height()));
    let travel = well.shrink2(Vec2::new(0.0, 0.5 * HANDLE.y));
    let plain = turn(ui, &response, index, Travel::Fader(travel.height()), edit);
    let reason = edit.inert(index);
    let y = |level_db: f64| travel.bottom() - parameter.to_normalised(level_db) as f32 * travel.height();

    let painter = ui.painter();
    // Under the meter: the well, and 0 dB, where the fader leaves the level unchanged.
    baked(painter, response.id.with("well"), bits(rect), || {
        let zero = Stroke::new(1.0, theme::WEAK.gamma_multiply(0.7));
        let tick = |side: f32| {
            let x = rect.center().x + side * (0.5 * TRACK + 2.0);
            Shape::line_segment([Pos2::new(x, y(0.0)), Pos2::new(x + 3.0 * side, y(0.0))], zero)
        };
        vec![Shape::rect_filled(well, 3.0, theme::WELL), tick(-1.0), tick(1.0)]
    });
    let level = &track.level;
    let color = if track.is_silenced { theme::WEAK } else { track.color };
    if level.shown_db > FLOOR_DB {
        let bar = well.with_min_y(y(f64::from(level.shown_db))).intersect(well);
        painter.rect_filled(bar, 3.0, color.gamma_multiply(if reason.is_some() { 0.4 } else { 1.0 }));
    }
    if level.held_db > FLOOR_DB {
        painter.hline(well.x_range(), y(f64::from(level.held_db)), Stroke::new(1.5, color));
    }
    let handle =
        Rect::from_center_size(Pos2::new(rect.center().x, y(plain)), Vec2::new(HANDLE.x.min(rect.width()), HANDLE.y));
    let is_hot = response.hovered() || response.dragged() || response.has_focus();
    baked(painter, response.id.with("handle"), (bits(handle), is_hot), || {
        let border = if is_hot { theme::EMBER } else { theme::WEAK };
        let middle = handle.shrink2(Vec2::new(4.0, 0.0));
        vec![
            Shape::rect_filled(handle, 3.0, theme::LINE),
            Shape::rect_stroke(handle, 3.0, Stroke::new(1.0, border), StrokeKind::Inside),
            Shape::hline(middle.x_range(), handle.center().y, Stroke::new(1.5, theme::TEXT)),
        ]
    });
    if response.dragged() {
        let (at, text) = (handle.center_top() - Vec2::new(0.0, 2.0), parameter.to_text(plain));
        painter.text(at, Align2::CENTER_BOTTOM, text, theme::small(), theme::TEXT);
    }
    response.on_hover_ui(|ui| {
        ui.set_max_width(280.0);
        ui.label(format!("{}: {}", parameter.name, parameter.to_text(plain)));
        ui.label(parameter.help);
        if let Some(reason) = reason {
            ui.label(egui::RichText::new(format!("No effect at present: {reason}.")).color(theme::ALARM));
        }
    });
}
