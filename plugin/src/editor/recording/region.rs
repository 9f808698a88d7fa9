//! The part of the recording used for learning, on its outline.

use egui::{CursorIcon, Id, Pos2, Rect, Sense, Stroke, Ui};

use super::super::{map, theme};

/// The shortest part in seconds: anything shorter is an accidental drag.
pub const SHORTEST_S: f64 = 0.1;
/// Distance from an edge, in points, within which the pointer grabs it.
const REACH: f32 = 6.0;

/// State of a drag.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Held {
    /// The fixed end.
    anchor_s: f64,
    now_s: f64,
}

/// The region, during a drag and otherwise.
#[derive(Debug, Clone, Copy, Default)]
pub struct Region {
    held: Option<Held>,
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
        let mut change = None;
        if response.double_clicked() {
            self.held = None;
            change = set.map(|_| Change::All);
        } else if response.drag_started() {
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
        if let Some([start_s, end_s]) = dragged.or(set) {
            let painter = ui.painter().with_clip_rect(rect);
            let shade = theme::GROUND.gamma_multiply(0.7);
            painter.rect_filled(rect.with_max_x(x(start_s)), 0.0, shade);
            painter.rect_filled(rect.with_min_x(x(end_s)), 0.0, shade);
            for edge_s in [start_s, end_s] {
                painter.vline(x(edge_s), rect.y_range(), Stroke::new(1.5, theme::EMBER));
            }
        }
        if !response.dragged() {
            response.on_hover_text("Drag to choose the part to learn from. Double-click for all of it.");
        }
        change
    }
}
