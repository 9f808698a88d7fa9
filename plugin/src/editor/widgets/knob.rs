//! A knob: its dial, its name and its value.

use egui::{Align2, Color32, Id, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, Vec2};
use pyrophone_settings::{PARAMETERS, Parameter};

use super::super::param_editor::ParamEditor;
use super::super::{map, theme};
use super::baked::baked;
use super::turn::{Travel, turn};
use super::value::value;
use crate::entry::indication::Automation;

/// A knob with its name and value, in points.
pub const SIZE: Vec2 = Vec2::new(74.0, 80.0);
const RADIUS: f32 = 19.0;
/// Radius of the dots that show mapping and automation by the host.
const DOT: f32 = 2.5;
/// Both ends of the turn, clockwise from the right.
const START: f32 = 0.75 * std::f32::consts::PI;
const TURN: f32 = 1.5 * std::f32::consts::PI;
/// Height of a line of small text, in points.
const LINE: f32 = 15.0;
/// Opacity of a parameter without effect.
const DIMMED: f32 = 0.45;

/// Appearance of a dial.
#[derive(Clone)]
pub struct Look<'a> {
    /// Its name.
    pub name: &'a str,
    /// Font of the name.
    pub font: egui::FontId,
    /// Colour of the set value.
    pub color: Color32,
    /// Radius of the dial in points.
    pub radius: f32,
    /// Tooltip text besides the parameter's help, made where it is shown.
    pub more: Option<&'a dyn Fn() -> String>,
}

/// The knob of a parameter, its name above the dial.
pub fn knob(ui: &mut Ui, index: usize, edit: &mut ParamEditor<'_>) {
    let parameter = &PARAMETERS[index];
    let (rect, _) = ui.allocate_exact_size(SIZE, Sense::hover());
    let look = Look { name: parameter.name, font: theme::small(), color: theme::EMBER, radius: RADIUS, more: None };
    let centre = Pos2::new(rect.center().x, rect.top() + 37.0);
    let is_dimmed = edit.inert(index).is_some();
    let color = faded(theme::WEAK, is_dimmed);
    let at = Pos2::new(rect.center().x, rect.top());
    ui.painter().text(at, Align2::CENTER_TOP, parameter.name, theme::small(), color);
    dial(ui, centre, index, &look, edit);
    value(ui, rect.with_min_y(rect.bottom() - 20.0), index, faded(theme::TEXT, is_dimmed), edit);
}

/// A dial with its name and its value below, centred in the upper part of `rect`.
pub fn named_dial(ui: &mut Ui, rect: Rect, index: usize, look: &Look<'_>, edit: &mut ParamEditor<'_>) {
    let height = 2.0 * look.radius + look.font.size + LINE + 8.0;
    let top = rect.top() + (0.5 * (rect.height() - height)).max(0.0);
    let centre = Pos2::new(rect.center().x, top + look.radius + 2.0);
    let is_dimmed = edit.inert(index).is_some();
    dial(ui, centre, index, look, edit);
    let name_at = Pos2::new(rect.center().x, centre.y + look.radius + 4.0);
    let name =
        ui.painter().text(name_at, Align2::CENTER_TOP, look.name, look.font.clone(), faded(theme::TEXT, is_dimmed));
    let place = Rect::from_center_size(
        Pos2::new(rect.center().x, name.bottom() + 0.5 * LINE),
        Vec2::new(rect.width().min(74.0), LINE),
    );
    value(ui, place, index, faded(theme::WEAK, is_dimmed), edit);
}

fn faded(color: Color32, is_dimmed: bool) -> Color32 {
    if is_dimmed { color.gamma_multiply(DIMMED) } else { color }
}

/// The dial itself, about `centre`.
fn dial(ui: &mut Ui, centre: Pos2, index: usize, look: &Look<'_>, edit: &mut ParamEditor<'_>) {
    let parameter = &PARAMETERS[index];
    let place = Rect::from_center_size(centre, Vec2::splat(2.0 * look.radius + 6.0));
    let response = ui.interact(place, Id::unique(("knob", parameter.id)), Sense::click_and_drag());
    let plain = turn(ui, &response, index, Travel::Knob, edit);
    map::note(ui, format_args!("knob.{}", parameter.id), place);
    let reason = edit.inert(index);
    draw(ui, &response, centre, parameter, plain, look, reason.is_some());
    indicate(ui, place, edit.indication(index));
    let controller = edit.params.controllers.number(index);
    if edit.params.controllers.learner() == Some(index) {
        ui.painter().circle_stroke(centre, look.radius + 6.0, Stroke::new(1.5, theme::BLUE));
    }
    response.on_hover_ui(|ui| {
        ui.set_max_width(320.0);
        ui.label(parameter.help);
        if let Some(number) = controller {
            ui.label(egui::RichText::new(format!("MIDI controller {number}")).font(theme::small()).color(theme::BLUE));
        }
        if let Some(more) = look.more {
            ui.label(egui::RichText::new(more()).font(theme::small()).color(theme::WEAK));
        }
        if let Some(reason) = reason {
            ui.label(egui::RichText::new(format!("No effect at present: {reason}.")).color(theme::ALARM));
        }
    });
}

/// Dots beside the knob: mapped to a controller (left), automated (right; hollow while the automation does not play).
fn indicate(ui: &Ui, dial: Rect, (is_mapped, automation): (bool, Automation)) {
    let painter = ui.painter();
    if is_mapped {
        painter.circle_filled(dial.left_top(), DOT, theme::BLUE);
    }
    match automation {
        Automation::None => {}
        Automation::Present | Automation::Overriding => {
            painter.circle_stroke(dial.right_top(), DOT, Stroke::new(1.0, theme::EMBER));
        }
        Automation::Playing => {
            painter.circle_filled(dial.right_top(), DOT, theme::EMBER);
        }
        Automation::Recording => {
            painter.circle_filled(dial.right_top(), DOT, theme::ALARM);
        }
    }
}

fn draw(
    ui: &Ui,
    response: &Response,
    centre: Pos2,
    parameter: &Parameter,
    plain: f64,
    look: &Look<'_>,
    is_dimmed: bool,
) {
    let radius = look.radius;
    let (place, default) = (parameter.to_normalised(plain), parameter.to_normalised(parameter.default_value()));
    let is_hot = response.hovered() || response.dragged();
    let has_focus = response.has_focus();
    let color = faded(look.color, is_dimmed);
    let at = [centre.x, centre.y, radius].map(f32::to_bits);
    let key = (at, place.to_bits(), color, is_dimmed, is_hot, has_focus);
    baked(ui.painter(), response.id, key, || {
        let at = |place: f64, radius: f32| centre + radius * Vec2::angled(START + TURN * place as f32);
        let width = (radius / 7.0).clamp(2.5, 5.0);
        let arc = |from: f64, to: f64, stroke: Stroke| {
            let steps = (48.0 * (to - from).abs()).ceil().max(1.0) as usize;
            let points = (0..=steps).map(|n| at(from + (to - from) * n as f64 / steps as f64, radius)).collect();
            Shape::line(points, stroke)
        };
        let fill = if is_hot { theme::LINE } else { theme::GROUND };
        // Bipolar values grow from the middle.
        let from: f64 = if parameter.low() == -parameter.high() { 0.5 } else { 0.0 };
        let edit = Stroke::new(2.0, faded(theme::TEXT, is_dimmed));
        let mut shapes = vec![
            Shape::circle_filled(centre, radius - width - 2.0, fill),
            arc(0.0, 1.0, Stroke::new(width, theme::LINE)),
            arc(from.min(place), from.max(place), Stroke::new(width, color)),
            Shape::circle_filled(at(default, radius + 0.5 * width + 2.5), 1.3, theme::WEAK),
            Shape::line_segment([at(place, 0.32 * radius), at(place, radius - width - 3.0)], edit),
        ];
        if has_focus {
            shapes.push(Shape::circle_stroke(centre, radius + width + 3.5, Stroke::new(1.0, theme::EMBER)));
        }
        shapes
    });
}
