//! A horizontal slider: a bar filled up to its parameter's value, with name and value on it.

use egui::{Align2, Id, Rect, Sense, Shape, Stroke, StrokeKind, Ui, Vec2};
use pyrophone_settings::PARAMETERS;

use super::super::param_editor::ParamEditor;
use super::super::{map, theme};
use super::baked::{baked, bits};
use super::turn::{Travel, turn};

/// Opacity of a parameter without effect.
const DIMMED: f32 = 0.45;

/// A slider for the parameter at `index` in all of `rect`; `name` is its label there.
pub fn slider(ui: &mut Ui, rect: Rect, index: usize, name: &str, edit: &mut ParamEditor<'_>) {
    let parameter = &PARAMETERS[index];
    let response = ui.interact(rect, Id::unique(("slider", parameter.id)), Sense::click_and_drag());
    map::note(ui, format_args!("slider.{}", parameter.id), rect);
    let plain = turn(ui, &response, index, Travel::Slider(rect.width()), edit);
    let reason = edit.inert(index);
    let dimmed = if reason.is_some() { DIMMED } else { 1.0 };
    let painter = ui.painter().with_clip_rect(rect);
    let filled = rect.with_max_x(rect.left() + rect.width() * parameter.to_normalised(plain) as f32);
    let is_hot = response.hovered() || response.dragged() || response.has_focus();
    baked(&painter, response.id, (bits(rect), bits(filled), is_hot, reason.is_some()), || {
        let border = if is_hot { theme::EMBER } else { theme::LINE };
        vec![
            Shape::rect_filled(rect, 3.0, theme::WELL),
            Shape::rect_filled(filled, 3.0, theme::EMBER.gamma_multiply(0.45 * dimmed)),
            Shape::rect_stroke(rect, 3.0, Stroke::new(1.0, border), StrokeKind::Inside),
        ]
    });
    let inset = Vec2::new(6.0, 0.0);
    let color = theme::TEXT.gamma_multiply(dimmed);
    let text = parameter.to_text(plain);
    let value = painter.text(rect.right_center() - inset, Align2::RIGHT_CENTER, text, theme::small(), color);
    // A name that does not fit is left out: the tooltip shows it.
    let name_galley = painter.layout_no_wrap(name.to_owned(), theme::small(), color);
    if rect.left() + inset.x + name_galley.size().x + 4.0 <= value.left() {
        let at = rect.left_center() + inset - Vec2::new(0.0, 0.5 * name_galley.size().y);
        painter.galley(at, name_galley, color);
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
