//! The part of the recording used for learning, on its outline: chosen by pointer or arrow keys.

use egui::{CursorIcon, Id, Pos2, Rect, Response, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo};

use super::super::widgets::keys::{arrows, fine, is_reset};
use super::super::{map, theme};

/// The shortest part in seconds: anything shorter is an accidental drag.
pub const SHORTEST_S: f64 = 0.1;
/// Distance from an edge, in points, within which the pointer grabs it.
const REACH: f32 = 6.0;
/// Share of the recording for an arrow key.
const STEP: f64 = 0.01;
/// Time in seconds after the last key until its part is learnt from: every change means learning anew.
const REST_S: f64 = 0.4;

/// State of a drag.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Held {
    /// The fixed end.
    anchor_s: f64,
    now_s: f64,
}

/// A part chosen by keys, and the time when it is taken over.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Keyed {
    region_s: [f64; 2],
    due_s: f64,
}

/// The region, during a drag and otherwise.
#[derive(Debug, Clone, Copy, Default)]
pub struct Region {
    held: Option<Held>,
    keyed: Option<Keyed>,
}

/// Change to the region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// A part from start to end, in seconds.
    Part([f64; 2]),
    /// All of the recording again.
    All,
}

impl Region {
    /// Shows the region over the recording's outline, and lets the user drag its edges or draw a new one. A double
    /// click restores all.
    pub fn show(&mut self, ui: &Ui, rect: Rect, duration_s: f64, region_s: Option<[f64; 2]>) -> Option<Change> {
        let x = |time_s: f64| rect.left() + (time_s / duration_s) as f32 * rect.width();
        let time_s = |x: f32| (f64::from((x - rect.left()) / rect.width()) * duration_s).clamp(0.0, duration_s);
        let response = ui.interact(rect, Id::unique("region"), Sense::click_and_drag());
        map::note(ui, "region", rect);
        let set = region_s.map(|region_s| region_s.map(|edge_s| edge_s.clamp(0.0, duration_s)));
        let edge_at = |at: Pos2| {
            let [start_s, end_s] = set?;
            let far = [start_s, end_s].map(|edge_s| (x(edge_s) - at.x).abs());
            let nearest = usize::from(far[1] < far[0]);
            (far[nearest] <= REACH).then_some([end_s, start_s][nearest])
        };
        let mut change = self.step(ui, &response, duration_s, set);
        if response.double_clicked() || is_reset(ui, &response) {
            *self = Self::default();
            change = set.map(|_| Change::All);
        } else if response.drag_started() {
            response.request_focus();
            self.keyed = None;
            // The point of the press, not the point where the drag was detected.
            let pressed = ui.input(|input| input.pointer.press_origin());
            self.held = pressed.map(|at| Held { anchor_s: edge_at(at).unwrap_or(time_s(at.x)), now_s: time_s(at.x) });
        }
        if let (Some(held), Some(at)) = (&mut self.held, response.interact_pointer_pos()) {
            held.now_s = time_s(at.x);
        }
        let dragged = self.held.map(|Held { anchor_s, now_s }| [anchor_s.min(now_s), anchor_s.max(now_s)]);
        if response.drag_stopped() {
            self.held = None;
            change = dragged.filter(|[start_s, end_s]| end_s - start_s >= SHORTEST_S).map(Change::Part);
        }
        if response.hovered() {
            let at_edge = ui.input(|input| input.pointer.hover_pos()).and_then(edge_at).is_some();
            ui.ctx().set_cursor_icon(if at_edge { CursorIcon::ResizeHorizontal } else { CursorIcon::Crosshair });
        }
        let shown = dragged.or(self.keyed.map(|keyed| keyed.region_s)).or(set);
        describe(&response, duration_s, shown);
        if response.has_focus() {
            ui.painter().rect_stroke(rect, 3.0, Stroke::new(1.0, theme::EMBER), StrokeKind::Inside);
        }
        if let Some([start_s, end_s]) = shown {
            let painter = ui.painter().with_clip_rect(rect);
            let shade = theme::GROUND.gamma_multiply(0.7);
            painter.rect_filled(rect.with_max_x(x(start_s)), 0.0, shade);
            painter.rect_filled(rect.with_min_x(x(end_s)), 0.0, shade);
            for edge_s in [start_s, end_s] {
                painter.vline(x(edge_s), rect.y_range(), Stroke::new(1.5, theme::EMBER));
            }
        }
        if !response.dragged() {
            response.on_hover_text(
                "Drag to choose the part to learn from. Double-click for all of it.\nWith keys: up and down change its length, left and right move it, Delete takes all of it.",
            );
        }
        change
    }

    /// Follows the arrow keys: right and left move the part, up and down move its end. Returns it once the keys rest.
    fn step(&mut self, ui: &Ui, response: &Response, duration_s: f64, set: Option<[f64; 2]>) -> Option<Change> {
        let now_s = ui.input(|input| input.time);
        let steps = arrows(ui, response).map(|steps| steps * STEP * fine(ui) * duration_s);
        if steps != [0.0; 2] && duration_s > SHORTEST_S {
            let from = self.keyed.map(|keyed| keyed.region_s).or(set).unwrap_or([0.0, duration_s]);
            self.keyed = Some(Keyed { region_s: moved(from, steps, duration_s), due_s: now_s + REST_S });
        }
        let keyed = self.keyed?;
        if now_s < keyed.due_s && response.has_focus() {
            ui.ctx().request_repaint_after_secs((keyed.due_s - now_s) as f32);
            return None;
        }
        self.keyed = None;
        let is_whole = keyed.region_s == [0.0, duration_s];
        Some(if is_whole { Change::All } else { Change::Part(keyed.region_s) })
    }
}

/// A part moved and lengthened by these steps in seconds, within the recording.
fn moved([start_s, end_s]: [f64; 2], [by_s, longer_s]: [f64; 2], duration_s: f64) -> [f64; 2] {
    let by_s = by_s.clamp(-start_s, (duration_s - end_s).max(0.0));
    let end_s =
        (end_s + by_s + longer_s).clamp(start_s + by_s + SHORTEST_S, duration_s.max(start_s + by_s + SHORTEST_S));
    [start_s + by_s, end_s]
}

/// Describes the region to assistive technology.
fn describe(response: &Response, duration_s: f64, region_s: Option<[f64; 2]>) {
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::Slider, true, "Part to learn from");
        let text = match region_s {
            Some([start_s, end_s]) => format!("{start_s:.2} to {end_s:.2} s"),
            None => format!("all {duration_s:.2} s"),
        };
        info.current_text_value = Some(text);
        info
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_move_a_part_within_the_recording() {
        assert_eq!(moved([0.0, 10.0], [0.0, -4.0], 10.0), [0.0, 6.0]);
        assert_eq!(moved([0.0, 6.0], [3.0, 0.0], 10.0), [3.0, 9.0]);
        assert_eq!(moved([3.0, 9.0], [3.0, 0.0], 10.0), [4.0, 10.0], "its length stays at the end");
        assert_eq!(moved([4.0, 10.0], [-9.0, 0.0], 10.0), [0.0, 6.0], "and at the start");
        assert_eq!(moved([4.0, 6.0], [0.0, 9.0], 10.0), [4.0, 10.0]);
        assert_eq!(moved([4.0, 6.0], [0.0, -9.0], 10.0), [4.0, 4.0 + SHORTEST_S]);
    }
}
