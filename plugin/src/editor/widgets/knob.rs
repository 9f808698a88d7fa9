//! A knob: drag (finer with Shift), wheel, arrow keys, double click for the default, a click on the value to type one.

use egui::text::{CCursor, CCursorRange};
use egui::{Align2, Id, Key, Pos2, Rect, Response, Sense, Stroke, Ui, Vec2, WidgetInfo};
use pyrophone_settings::{Kind, PARAMETERS, Parameter};

use super::super::hand::Hand;
use super::super::{map, theme};
use crate::entry::indication::Automation;

/// A knob with its name and value, in points.
pub const SIZE: Vec2 = Vec2::new(74.0, 80.0);
const RADIUS: f32 = 19.0;
/// Radius of the dots that show what the host does with it.
const DOT: f32 = 2.5;
/// Points that a full turn takes.
const TRAVEL: f32 = 180.0;
/// How much slower Shift makes it.
const FINE: f64 = 0.1;
/// Part of the range that a notch of the wheel or an arrow key moves.
const NOTCH: f64 = 0.02;
/// The turn's two ends, clockwise from the right.
const START: f32 = 0.75 * std::f32::consts::PI;
const TURN: f32 = 1.5 * std::f32::consts::PI;

/// The knob of a parameter.
pub fn knob(ui: &mut Ui, index: usize, hand: &mut Hand<'_>) {
    let parameter = &PARAMETERS[index];
    let (rect, _) = ui.allocate_exact_size(SIZE, Sense::hover());
    let dial = Rect::from_center_size(Pos2::new(rect.center().x, rect.top() + 37.0), Vec2::splat(2.0 * RADIUS + 6.0));
    let id = Id::unique(("knob", parameter.id));
    let response = ui.interact(dial, id, Sense::click_and_drag());
    let plain = turn(ui, &response, parameter, index, hand);
    map::note(ui, format_args!("knob.{}", parameter.id), dial);

    let painter = ui.painter();
    painter.text(
        Pos2::new(rect.center().x, rect.top()),
        Align2::CENTER_TOP,
        parameter.name,
        theme::small(),
        theme::WEAK,
    );
    draw(ui, &response, dial.center(), parameter, plain);
    indicate(ui, dial, hand.indication(index));
    value(
        ui,
        Rect::from_min_max(Pos2::new(rect.left(), rect.bottom() - 20.0), rect.max),
        parameter,
        index,
        plain,
        hand,
    );
    response.on_hover_text(parameter.help);
}

/// Follows mouse and keys; the value as it is then.
fn turn(ui: &Ui, response: &Response, parameter: &Parameter, index: usize, hand: &mut Hand<'_>) -> f64 {
    let plain = hand.value(index);
    let place = parameter.to_normalised(plain);
    let id = response.id;
    let fine = if ui.input(|input| input.modifiers.shift) { FINE } else { 1.0 };
    if response.drag_started() {
        response.request_focus();
        hand.begin(index);
        ui.data_mut(|data| data.insert_temp(id, place));
    }
    if response.dragged() {
        let delta = response.drag_delta();
        let held: f64 = ui.data(|data| data.get_temp(id)).unwrap_or(place);
        let held = (held + fine * f64::from((delta.x - delta.y) / TRAVEL)).clamp(0.0, 1.0);
        ui.data_mut(|data| data.insert_temp(id, held));
        let next = parameter.from_normalised(held);
        if next != plain {
            hand.set(index, next);
        }
    }
    if response.drag_stopped() {
        hand.end(index);
    }
    if response.double_clicked() {
        hand.set_once(index, parameter.default_value());
    } else if response.clicked() {
        response.request_focus();
    }
    let mut notches = 0.0;
    if response.hovered() {
        notches += ui.input(|input| f64::from(input.raw_scroll_notches()));
    }
    if response.has_focus() {
        notches += super::notches(ui, response);
        if ui.input(|input| input.key_pressed(Key::Delete) || input.key_pressed(Key::Backspace)) {
            hand.set_once(index, parameter.default_value());
        }
    }
    if notches != 0.0 {
        let next = match parameter.kind {
            Kind::Int { .. } => (plain + notches.signum()).clamp(parameter.low(), parameter.high()),
            _ => parameter.from_normalised((place + notches * NOTCH * fine).clamp(0.0, 1.0)),
        };
        if next != plain {
            hand.set_once(index, next);
        }
    }
    response.widget_info(|| {
        let mut info = WidgetInfo::slider(true, plain, parameter.name);
        info.current_text_value = Some(parameter.to_text(plain));
        info
    });
    hand.value(index)
}

/// Dots beside the knob: a controller is mapped to it (left), it is automated (right; hollow while that does not play).
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

fn draw(ui: &Ui, response: &Response, centre: Pos2, parameter: &Parameter, plain: f64) {
    let painter = ui.painter();
    let (place, default) = (parameter.to_normalised(plain), parameter.to_normalised(parameter.default_value()));
    let at = |place: f64, radius: f32| centre + radius * Vec2::angled(START + TURN * place as f32);
    let arc = |from: f64, to: f64, stroke: Stroke| {
        let steps = (48.0 * (to - from).abs()).ceil().max(1.0) as usize;
        let points = (0..=steps).map(|n| at(from + (to - from) * n as f64 / steps as f64, RADIUS)).collect();
        painter.line(points, stroke);
    };
    let is_hot = response.hovered() || response.dragged();
    painter.circle_filled(centre, RADIUS - 5.0, if is_hot { theme::LINE } else { theme::GROUND });
    arc(0.0, 1.0, Stroke::new(3.0, theme::LINE));
    // What can go either way grows from its middle.
    let from: f64 = if parameter.low() == -parameter.high() { 0.5 } else { 0.0 };
    arc(from.min(place), from.max(place), Stroke::new(3.0, theme::EMBER));
    painter.circle_filled(at(default, RADIUS + 4.0), 1.3, theme::WEAK);
    painter.line_segment([at(place, 6.0), at(place, RADIUS - 6.0)], Stroke::new(2.0, theme::TEXT));
    if response.has_focus() {
        painter.circle_stroke(centre, RADIUS + 6.5, Stroke::new(1.0, theme::EMBER));
    }
}

/// The value as text, which a click makes a field.
fn value(ui: &mut Ui, rect: Rect, parameter: &Parameter, index: usize, plain: f64, hand: &mut Hand<'_>) {
    let id = Id::unique(("value", parameter.id));
    map::note(ui, format_args!("value.{}", parameter.id), rect);
    let typed: Option<String> = ui.data(|data| data.get_temp(id));
    let Some(mut typed) = typed else {
        let response = ui.interact(rect, id.with("shown"), Sense::click());
        let color = if response.hovered() { theme::EMBER } else { theme::TEXT };
        let text = parameter.to_text(plain);
        ui.painter().text(rect.center(), Align2::CENTER_CENTER, &text, theme::small(), color);
        if response.on_hover_text("Click to type a value").clicked() {
            // What is typed replaces what was there.
            let mut field = egui::text_edit::TextEditState::default();
            let all = CCursorRange::two(CCursor::new(0), CCursor::new(text.chars().count()));
            field.cursor.set_char_range(Some(all));
            field.store(ui.ctx(), id.with("field"));
            ui.data_mut(|data| data.insert_temp(id, text));
            ui.memory_mut(|memory| memory.request_focus(id.with("field")));
        }
        return;
    };
    let is_valid = parameter.parse(&typed).is_ok();
    let field = egui::TextEdit::singleline(&mut typed)
        .id(id.with("field"))
        .font(theme::small())
        .text_color(if is_valid { theme::TEXT } else { theme::ALARM })
        .align(egui::Align2::CENTER_CENTER);
    // In a place of its own: what is beside it stays where it is.
    let mut place = ui.new_child(egui::UiBuilder::new().id_salt(id).max_rect(rect));
    let response = place.put(rect, field);
    if response.lost_focus() {
        let is_refused = ui.input(|input| input.key_pressed(Key::Escape));
        if let (Ok(plain), false) = (parameter.parse(&typed), is_refused) {
            hand.set_once(index, plain);
        }
        ui.data_mut(|data| data.remove::<String>(id));
    } else {
        ui.data_mut(|data| data.insert_temp(id, typed));
    }
}

/// Notches of the wheel since the last frame.
trait Notches {
    fn raw_scroll_notches(&self) -> f32;
}

impl Notches for egui::InputState {
    fn raw_scroll_notches(&self) -> f32 {
        let notches = self.events.iter().filter_map(|event| match event {
            egui::Event::MouseWheel { unit, delta, .. } => Some(match unit {
                egui::MouseWheelUnit::Point => delta.y / 40.0,
                egui::MouseWheelUnit::Line | egui::MouseWheelUnit::Page => delta.y,
            }),
            _ => None,
        });
        notches.sum()
    }
}
