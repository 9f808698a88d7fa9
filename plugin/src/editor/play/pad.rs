//! A pad that moves two macros at once, by pointer or arrow keys.

use std::collections::VecDeque;

use egui::{
    Align2, ComboBox, CursorIcon, Id as Place, Pos2, Rect, Response, RichText, Role, Sense, Shape, Stroke, StrokeKind,
    Ui, Vec2, WidgetInfo,
};
use pyrophone_settings::PARAMETERS;
use pyrophone_settings::macros::MACROS;

use super::super::param_editor::ParamEditor;
use super::super::widgets::baked::{baked, bits};
use super::super::widgets::keys::{arrows, fine, is_reset};
use super::super::widgets::section::{columns, within};
use super::super::widgets::turn::NOTCH;
use super::super::{map, theme};

/// Height of the row of choices, in points, and lines of the grid.
const CHOICES: f32 = 22.0;
const LINES: usize = 4;
/// Number of points in the trail.
const TRAIL: usize = 90;
const DOT: f32 = 7.0;

/// Its horizontal and vertical macro, by their indices in [`MACROS`], and its recent positions.
#[derive(Debug)]
pub struct Pad {
    axes: [usize; 2],
    trail: VecDeque<[f64; 2]>,
    is_held: bool,
    has_focus: bool,
}

impl Default for Pad {
    /// Fury across, Crackle up.
    fn default() -> Self {
        Self { axes: [1, 2], trail: VecDeque::new(), is_held: false, has_focus: false }
    }
}

impl Pad {
    /// Shows the pad, and below it the choice of its macros.
    pub fn show(&mut self, ui: &mut Ui, rect: Rect, edit: &mut ParamEditor<'_>) {
        let (pad, choices) = rect.split_top_bottom_at_y(rect.bottom() - CHOICES);
        let pad = pad.with_max_y(pad.bottom() - 4.0);
        self.choices(ui, choices, edit);
        self.follow(ui, pad, edit);
        self.draw(ui, pad, edit);
    }

    fn choices(&mut self, ui: &mut Ui, rect: Rect, edit: &mut ParamEditor<'_>) {
        for (axis, place) in columns(rect, 2, 4.0).enumerate() {
            let before = self.axes[axis];
            within(ui, place, ["across", "up"][axis], |ui| {
                ui.spacing_mut().icon_width = 8.0;
                ui.spacing_mut().button_padding.x = 4.0;
                let shown = RichText::new(MACROS[before].name).font(theme::small());
                let list = ComboBox::from_id_salt(("pad", axis)).width(place.width()).truncate();
                let list = list.selected_text(shown).show_ui(ui, |ui| {
                    for (index, line) in MACROS.iter().enumerate() {
                        ui.selectable_value(&mut self.axes[axis], index, line.name);
                    }
                });
                map::note(ui, format_args!("pad axis {axis}"), list.response.rect);
                list.response.on_hover_text(["Macro on the horizontal axis", "Macro on the vertical axis"][axis]);
            });
            if self.axes[axis] != before {
                self.let_go(edit);
                if self.axes[1 - axis] == self.axes[axis] {
                    // Both axes must have different macros, so they swap.
                    self.axes[1 - axis] = before;
                }
                self.trail.clear();
            }
        }
    }

    fn follow(&mut self, ui: &Ui, pad: Rect, edit: &mut ParamEditor<'_>) {
        let response = ui.interact(pad, Place::unique("pad"), Sense::click_and_drag());
        map::note(ui, "pad", pad);
        let pressed = response.is_pointer_button_down_on() && ui.input(|input| input.pointer.primary_down());
        if pressed && !self.is_held {
            self.is_held = true;
            self.indices().into_iter().for_each(|index| edit.begin(index));
        }
        if let (true, Some(at)) = (self.is_held && pressed, response.interact_pointer_pos()) {
            let across = f64::from((at.x - pad.left()) / pad.width());
            let up = f64::from((pad.bottom() - at.y) / pad.height());
            for (index, share) in self.indices().into_iter().zip([across, up]) {
                edit.set(index, 200.0 * share.clamp(0.0, 1.0) - 100.0);
            }
        } else if self.is_held {
            self.let_go(edit);
        }
        if response.double_clicked() || is_reset(ui, &response) {
            self.indices().into_iter().for_each(|index| edit.set_once(index, 0.0));
        } else if pressed {
            response.request_focus();
        }
        self.step(ui, &response, edit);
        self.describe(&response, edit);
        self.has_focus = response.has_focus();
        if !response.dragged() {
            let response = response.on_hover_cursor(CursorIcon::Crosshair);
            response.on_hover_text(
                "Drag to move two macros at once, or use the arrow keys. Double-click to set both to 0 %.",
            );
        }
    }

    /// Moves the macros by the arrow keys, each press in one gesture.
    fn step(&self, ui: &Ui, response: &Response, edit: &mut ParamEditor<'_>) {
        if self.is_held {
            return;
        }
        for (index, steps) in self.indices().into_iter().zip(arrows(ui, response)) {
            let (parameter, plain) = (&PARAMETERS[index], edit.value(index));
            let (low, high) = (parameter.low(), parameter.high());
            let next = (plain + steps * NOTCH * fine(ui) * (high - low)).clamp(low, high);
            if next != plain {
                edit.set_once(index, next);
            }
        }
    }

    /// Describes the pad to assistive technology.
    fn describe(&self, response: &Response, edit: &ParamEditor<'_>) {
        let texts = self.indices().map(|index| PARAMETERS[index].to_text(edit.value(index)));
        let names = self.axes.map(|axis| MACROS[axis].name);
        response.widget_info(|| {
            let mut info = WidgetInfo::labeled(Role::Slider, true, format!("{} and {}", names[0], names[1]));
            info.current_text_value = Some(texts.join(", "));
            info
        });
    }

    fn let_go(&mut self, edit: &mut ParamEditor<'_>) {
        if std::mem::take(&mut self.is_held) {
            self.indices().into_iter().for_each(|index| edit.end(index));
        }
    }

    fn indices(&self) -> [usize; 2] {
        self.axes.map(|axis| MACROS[axis].id as usize)
    }

    fn draw(&mut self, ui: &Ui, pad: Rect, edit: &ParamEditor<'_>) {
        let painter = ui.painter().with_clip_rect(pad);
        baked(&painter, Place::unique("pad grid"), bits(pad), || grid(pad));
        if self.has_focus {
            painter.rect_stroke(pad, 4.0, Stroke::new(1.0, theme::EMBER), StrokeKind::Inside);
        }
        let names = self.axes.map(|axis| MACROS[axis].name);
        let weak = theme::WEAK.gamma_multiply(0.7);
        painter.text(pad.right_bottom() - Vec2::splat(5.0), Align2::RIGHT_BOTTOM, names[0], theme::small(), weak);
        painter.text(pad.left_top() + Vec2::splat(5.0), Align2::LEFT_TOP, names[1], theme::small(), weak);
        let now = self.indices().map(|index| edit.value(index));
        if self.trail.back() != Some(&now) {
            if self.trail.len() == TRAIL {
                self.trail.pop_front();
            }
            self.trail.push_back(now);
        }
        let inner = pad.shrink(DOT + 2.0);
        let place = |[x, y]: [f64; 2]| {
            inner.left_bottom()
                + Vec2::new((x + 100.0) as f32 * inner.width(), -(y + 100.0) as f32 * inner.height()) / 200.0
        };
        // The trail changes only when the pad or its macros move.
        let points: Vec<Pos2> = self.trail.iter().copied().map(place).collect();
        let key: Vec<[u32; 2]> = points.iter().map(|point| [point.x, point.y].map(f32::to_bits)).collect();
        baked(&painter, Place::unique("pad trail"), key, || {
            let (at, faint) = (place(now), theme::EMBER.gamma_multiply(0.5));
            vec![
                Shape::line(points, Stroke::new(1.2, faint)),
                Shape::circle_filled(at, DOT, theme::EMBER),
                Shape::circle_stroke(at, DOT + 4.0, Stroke::new(1.0, faint)),
            ]
        });
    }
}

/// The pad without its dot.
fn grid(pad: Rect) -> Vec<Shape> {
    let mut shapes = vec![Shape::rect_filled(pad, 4.0, theme::WELL)];
    for n in 1..LINES {
        let share = n as f32 / LINES as f32;
        let middle = if 2 * n == LINES { 1.0 } else { 0.5 };
        let rule = Stroke::new(1.0, theme::LINE.gamma_multiply(middle));
        shapes.push(Shape::vline(pad.left() + share * pad.width(), pad.y_range(), rule));
        shapes.push(Shape::hline(pad.x_range(), pad.top() + share * pad.height(), rule));
    }
    shapes.push(Shape::rect_stroke(pad, 4.0, Stroke::new(1.0, theme::LINE), StrokeKind::Inside));
    shapes
}
