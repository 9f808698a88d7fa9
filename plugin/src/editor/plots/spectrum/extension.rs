//! Spectral extension on the spectrum plot: cutoff, blend, fit and slope, with handles that move them.

use egui::{Align2, CursorIcon, Id as WidgetId, Pos2, Rect, Sense, Shape, Stroke, Ui, Vec2};
use pyrophone_analysis::FLOOR_DB;
use pyrophone_analysis::bands::{BANDS, position};
use pyrophone_settings::Id;

use super::axes::Axes;
use crate::editor::param_editor::ParamEditor;
use crate::editor::widgets::notches;
use crate::editor::{map, theme};

/// Share of its range by which an arrow key moves a handle.
const KEY_NOTCH: f64 = 0.01;
/// Highest frequency of the slope.
const END_HZ: f64 = 20_000.0;
/// Position of the slope's handle between cutoff and end, on the logarithmic axis.
const GRIP: f64 = 0.35;

/// Draws cutoff, blend and fit, and the slope with which noise continues the drive; each can be dragged.
pub fn show(ui: &Ui, painter: &egui::Painter, axes: &Axes, drive: &[f32; BANDS], edit: &mut ParamEditor<'_>) {
    // All is drawn with the values from before a drag.
    let extension = Extension {
        cutoff_hz: edit.get(Id::Cutoff),
        blend_hz: edit.get(Id::BlendWidth),
        fit_hz: edit.get(Id::FitWidth),
        alpha: edit.get(Id::Alpha),
    };
    extension.show_bands(painter, axes);
    extension.show_cutoff(ui, painter, axes, edit);
    extension.show_slope(ui, painter, axes, drive, edit);
}

/// Parameters of extension.
struct Extension {
    cutoff_hz: f64,
    blend_hz: f64,
    fit_hz: f64,
    alpha: f64,
}

impl Extension {
    /// Horizontal positions of the blend's edges.
    fn blend_edges(&self, axes: &Axes) -> [f32; 2] {
        [-0.5, 0.5].map(|side| axes.x((self.cutoff_hz + side * self.blend_hz).max(1.0)))
    }

    /// The bands of blend and fit.
    fn show_bands(&self, painter: &egui::Painter, axes: &Axes) {
        let (top, bottom) = (axes.rect.top(), axes.rect.bottom());
        let [left, right] = self.blend_edges(axes);
        let band = Rect::from_min_max(Pos2::new(left, top), Pos2::new(right, bottom));
        painter.rect_filled(band, 0.0, theme::EMBER.gamma_multiply(0.10));
        let fit = [-1.0, 1.0].map(|side| axes.x((self.cutoff_hz + side * self.fit_hz).max(1.0)));
        let ends = fit.map(|x| Pos2::new(x, top + 3.0));
        painter.line_segment(ends, Stroke::new(2.0, theme::BLUE));
    }

    /// Lines at the cutoff and at the blend's edges.
    fn show_cutoff(&self, ui: &Ui, painter: &egui::Painter, axes: &Axes, edit: &mut ParamEditor<'_>) {
        let (top, bottom) = (axes.rect.top(), axes.rect.bottom());
        // The lower third is for the blend, which is often narrower than the pointer's precision.
        let third = bottom - 0.3 * (bottom - top);
        let x = axes.x(self.cutoff_hz);
        let edges = self.blend_edges(axes);
        let area = |left: f32, right: f32, top: f32, bottom: f32| {
            Rect::from_min_max(Pos2::new(left, top), Pos2::new(right, bottom))
        };
        let cursor = CursorIcon::ResizeHorizontal;
        let widen = |pointer: Pos2| 2.0 * (axes.frequency_hz(pointer.x) - self.cutoff_hz).abs();
        let mut is_wide = false;
        let below = area(edges[0] - 8.0, (edges[0] + 4.0).min(x - 1.0), third, bottom);
        let above = area((edges[1] - 4.0).max(x + 1.0), edges[1] + 8.0, third, bottom);
        for (name, area) in [("blend low", below), ("blend high", above)] {
            let handle = Handle { name, area, cursor, help: "Blend width: drag", id: Id::BlendWidth };
            is_wide |= handle.show(ui, edit, widen);
        }
        let line = area(x - 5.0, x + 5.0, top + 14.0, third - 4.0);
        let handle = Handle { name: "cutoff", area: line, cursor, help: "Cutoff: drag", id: Id::Cutoff };
        let is_cutoff = handle.show(ui, edit, |pointer| axes.frequency_hz(pointer.x));
        let stroke = Stroke::new(if is_cutoff { 2.5 } else { 1.2 }, theme::EMBER.gamma_multiply(0.8));
        painter.line_segment([Pos2::new(x, top), Pos2::new(x, bottom)], stroke);
        let stroke = Stroke::new(if is_wide { 2.0 } else { 1.0 }, theme::EMBER.gamma_multiply(0.6));
        for x in edges {
            painter.line_segment([Pos2::new(x, third), Pos2::new(x, bottom)], stroke);
        }
    }

    /// The slope of the noise, which continues from the drive's level about the cutoff.
    fn show_slope(
        &self,
        ui: &Ui,
        painter: &egui::Painter,
        axes: &Axes,
        drive: &[f32; BANDS],
        edit: &mut ParamEditor<'_>,
    ) {
        let (top, bottom) = (axes.rect.top(), axes.rect.bottom());
        let start_db = self.start_db(axes, drive);
        let decades = |frequency_hz: f64| (frequency_hz / self.cutoff_hz).log10();
        let level_at = |frequency_hz: f64| start_db - (10.0 * self.alpha * decades(frequency_hz)) as f32;
        let line = [(self.cutoff_hz, start_db), (END_HZ, level_at(END_HZ))]
            .map(|(hz, level)| Pos2::new(axes.x(hz), axes.y(level)));
        painter.extend(Shape::dashed_line(&line, Stroke::new(1.4, theme::TEXT.gamma_multiply(0.8)), 5.0, 4.0));
        let grip_hz = self.cutoff_hz * (END_HZ / self.cutoff_hz).powf(GRIP);
        let grip = Pos2::new(axes.x(grip_hz), axes.y(level_at(grip_hz)).clamp(top + 8.0, bottom - 8.0));
        let tilt = |pointer: Pos2| f64::from(start_db - axes.level_db(pointer.y)) / (10.0 * decades(grip_hz));
        let handle = Handle {
            name: "alpha",
            area: Rect::from_center_size(grip, Vec2::splat(18.0)),
            cursor: CursorIcon::ResizeVertical,
            help: "Alpha: the slope of the added noise; drag up or down",
            id: Id::Alpha,
        };
        let is_hot = handle.show(ui, edit, tilt);
        painter.circle_filled(grip, if is_hot { 7.5 } else { 6.0 }, theme::EMBER);
        painter.circle_stroke(grip, 6.0, Stroke::new(1.0, theme::TEXT));
        let text = format!("α {:.2}", self.alpha);
        painter.text(grip + Vec2::new(12.0, -6.0), Align2::LEFT_BOTTOM, text, theme::small(), theme::TEXT);
    }

    /// The drive's level about the cutoff; a usual one while it is silent.
    fn start_db(&self, axes: &Axes, drive: &[f32; BANDS]) -> f32 {
        let at = ((position(self.cutoff_hz) * BANDS as f64) as usize).min(BANDS - 1);
        let loudest = drive[at.saturating_sub(3)..(at + 4).min(BANDS)].iter().copied().fold(FLOOR_DB, f32::max);
        if loudest > FLOOR_DB + 20.0 { loudest } else { axes.top_db - 40.0 }
    }
}

/// An area of the plot that moves a parameter.
struct Handle {
    name: &'static str,
    area: Rect,
    cursor: CursorIcon,
    help: &'static str,
    id: Id,
}

impl Handle {
    /// Moves the parameter to the value that `value_at` gives for the pointer's position; returns whether the handle is
    /// pointed at, dragged or focused.
    fn show(&self, ui: &Ui, edit: &mut ParamEditor<'_>, value_at: impl Fn(Pos2) -> f64) -> bool {
        let widget = WidgetId::unique(("spectrum", self.name));
        let response = ui.interact(self.area, widget, Sense::click_and_drag()).on_hover_cursor(self.cursor);
        map::note(ui, format_args!("handle.{}", self.name), self.area);
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        let index = self.id as usize;
        if let notches @ (-1.0 | 1.0) = notches(ui, &response) {
            let parameter = self.id.parameter();
            let now = parameter.to_normalised(edit.get(self.id));
            edit.set_once(index, parameter.from_normalised((now + KEY_NOTCH * notches).clamp(0.0, 1.0)));
        }
        if response.drag_started() {
            edit.begin(index);
        }
        if response.dragged()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            edit.set(index, value_at(pointer));
        }
        if response.drag_stopped() {
            edit.end(index);
        }
        let is_hot = response.hovered() || response.dragged() || response.has_focus();
        response.on_hover_text(self.help);
        is_hot
    }
}
