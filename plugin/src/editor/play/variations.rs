//! Takes: the same character, other events; and recording of the output.

use egui::{Align2, Id as Place, Pos2, Rect, Role, ScrollArea, Sense, Shape, Stroke, StrokeKind, Ui, Vec2, WidgetInfo};
use pyrophone_settings::Id;

use super::super::param_editor::ParamEditor;
use super::super::widgets::section::{filled, section, within};
use super::super::widgets::value::value;
use super::super::{map, theme};
use super::Parts;

/// Height of the buttons and of a line of the list, in points.
const ROW: f32 = 22.0;
const LINE: f32 = 20.0;
const GAP: f32 = 5.0;
/// Height of the two rows for recording, in points.
const FOOT: f32 = 50.0;

/// The panel.
pub fn show(ui: &mut Ui, rect: Rect, parts: &mut Parts<'_>, edit: &mut ParamEditor<'_>) {
    let inner = section(ui, rect, "VARIATIONS", "same fire, different events");
    let top = inner.with_max_y(inner.top() + ROW);
    let (new, amount) = top.split_left_right_at_fraction(0.5);
    let button = filled(ui, new.with_max_x(new.right() - 2.0), "New take", "New take", false, true);
    let hint = "Changes the seed behind everything random: same character, different events";
    if button.on_hover_text(hint).clicked() {
        let take = edit.params.takes.add();
        edit.set_once(Id::Take as usize, f64::from(take));
    }
    amount_field(ui, amount.with_min_x(amount.left() + 2.0), edit);
    let foot = inner.with_min_y(inner.bottom() - FOOT);
    let list = inner.with_min_y(top.bottom() + GAP).with_max_y(foot.top() - GAP);
    takes(ui, list, edit);
    recording(ui, foot, parts, edit);
}

/// A field for the range of the takes' variation.
fn amount_field(ui: &mut Ui, rect: Rect, edit: &mut ParamEditor<'_>) {
    let index = Id::TakeAmount as usize;
    ui.painter().rect_stroke(rect, f32::from(theme::ROUNDING), Stroke::new(1.0, theme::LINE), StrokeKind::Inside);
    let name_at = rect.left_center() + Vec2::new(6.0, 0.0);
    let name = ui.painter().text(name_at, Align2::LEFT_CENTER, "Stray", theme::small(), theme::WEAK);
    let place = rect.with_min_x(name.right() + 2.0).shrink2(Vec2::new(2.0, 3.0));
    let color = if edit.inert(index).is_some() { theme::WEAK } else { theme::TEXT };
    value(ui, place, index, color, edit);
    ui.interact(name.expand(3.0), Place::unique("take amount"), Sense::hover())
        .on_hover_text(Id::TakeAmount.parameter().help);
}

/// The list: the seeds as set, then every take that was tried.
fn takes(ui: &mut Ui, rect: Rect, edit: &mut ParamEditor<'_>) {
    let now = edit.get(Id::Take) as u16;
    let mut listed = edit.params.takes.list();
    if now != 0 && !listed.contains(&now) {
        listed.push(now);
    }
    within(ui, rect, "takes", |ui| {
        ScrollArea::vertical().id_salt("takes").auto_shrink(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            let mut chosen = line(ui, "As set", "own seeds", 0, now == 0).then_some(0);
            for (number, take) in listed.iter().enumerate() {
                let name = format!("Take {}", number + 1);
                if line(ui, &name, &format!("seed {take}"), *take, *take == now) {
                    chosen = Some(*take);
                }
            }
            if let Some(take) = chosen.filter(|take| *take != now) {
                edit.set_once(Id::Take as usize, f64::from(take));
            }
            if listed.is_empty() {
                ui.label(egui::RichText::new("New takes are listed here.").font(theme::small()).color(theme::WEAK));
            }
        });
    });
}

/// A line of the list; true if it was clicked.
fn line(ui: &mut Ui, name: &str, note: &str, take: u16, is_now: bool) -> bool {
    let (rect, response) = ui.allocate_exact_size(Vec2::new(ui.available_width(), LINE), Sense::click());
    map::note(ui, format_args!("take.{take}"), rect);
    let painter = ui.painter();
    let is_hot = response.hovered() || response.has_focus();
    painter.rect_filled(rect, 3.0, if is_hot { theme::LINE } else { theme::GROUND });
    if is_now {
        painter.rect_stroke(rect, 3.0, Stroke::new(1.0, theme::EMBER), StrokeKind::Inside);
    }
    let color = if is_now { theme::EMBER } else { theme::WEAK };
    let at = rect.left_center() + Vec2::new(8.0, 0.0);
    let triangle = [Vec2::new(0.0, -4.0), Vec2::new(6.0, 0.0), Vec2::new(0.0, 4.0)].map(|by| at + by);
    painter.add(Shape::convex_polygon(triangle.to_vec(), color, Stroke::NONE));
    let words = if is_now { theme::TEXT } else { theme::WEAK };
    painter.text(at + Vec2::new(14.0, 0.0), Align2::LEFT_CENTER, name, theme::small(), words);
    response.widget_info(|| WidgetInfo::selected(Role::RadioButton, true, is_now, format!("{name}, {note}")));
    let right = Pos2::new(rect.right() - 6.0, rect.center().y);
    painter.text(right, Align2::RIGHT_CENTER, note, theme::small(), theme::WEAK);
    response.on_hover_text("Hear this take").clicked()
}

fn recording(ui: &mut Ui, rect: Rect, parts: &mut Parts<'_>, edit: &ParamEditor<'_>) {
    within(ui, rect, "recording", |ui| {
        ui.horizontal(|ui| {
            parts.listen.record(ui, parts.monitor);
            parts.listen.saves(ui, parts.monitor, parts.view);
            parts.listen.burst(ui, parts.monitor, edit);
        });
        ui.horizontal(|ui| {
            parts.listen.drag_out(ui, parts.monitor);
            parts.listen.word(ui, parts.monitor);
        });
    });
}
