//! Words on the spectrum plot: legend, and values under the pointer.

use egui::{Color32, Pos2, Rect, Stroke, Ui, Vec2};
use pyrophone_analysis::bands::{BANDS, position};

use super::axes::Axes;
use crate::editor::theme;

/// Width of the plot below which the legend is short, in points.
const ROOM_FOR_SENTENCES: f32 = 400.0;

/// Names of the curves; `apart_db` is the mean distance between output and recording.
pub fn legend(painter: &egui::Painter, rect: Rect, apart_db: Option<f32>, has_recording: bool) {
    let mut at = rect.left_top() + Vec2::new(8.0, 5.0);
    let mut word = |text: &str, color: Color32| {
        let drawn = readable(painter, at, text, color);
        at.x = drawn.right() + 12.0;
    };
    word("drive", theme::BLUE);
    word("output", theme::EMBER);
    if has_recording {
        match apart_db {
            Some(apart_db) if rect.width() < ROOM_FOR_SENTENCES => {
                word(&format!("recording ±{apart_db:.1} dB"), theme::ASH)
            }
            Some(apart_db) => {
                word("recording, level matched", theme::ASH);
                word(&format!("output within {apart_db:.1} dB of it"), theme::WEAK);
            }
            None => word("recording", theme::ASH),
        }
    }
}

/// Text that stays readable over curves; returns its area.
pub fn readable(painter: &egui::Painter, at: Pos2, text: &str, color: Color32) -> Rect {
    let room = painter.clip_rect().right() - at.x - 8.0;
    let galley = painter.layout(text.to_owned(), theme::small(), color, room.max(40.0));
    let place = Rect::from_min_size(at, galley.size());
    painter.rect_filled(place.expand(1.5), 2.0, theme::text_background());
    painter.galley(at, galley, color);
    place
}

/// Frequency and levels under the pointer.
pub fn read_out(ui: &Ui, painter: &egui::Painter, axes: &Axes, drive: &[f32; BANDS], output: &[f32; BANDS]) {
    let Some(pointer) = ui.input(|input| input.pointer.hover_pos()).filter(|at| axes.rect.contains(*at)) else {
        return;
    };
    let frequency_hz = axes.frequency_hz(pointer.x);
    let band = ((position(frequency_hz) * BANDS as f64) as usize).min(BANDS - 1);
    let hair = Stroke::new(1.0, theme::TEXT.gamma_multiply(0.25));
    painter.line_segment([Pos2::new(pointer.x, axes.rect.top()), Pos2::new(pointer.x, axes.rect.bottom())], hair);
    let text = format!("{frequency_hz:.0} Hz   drive {:.0}   output {:.0} dB/Hz", drive[band], output[band]);
    // Above the frequencies' names, where curves are rare, and clear of the levels' names.
    let at = axes.rect.left_bottom() + Vec2::new(8.0, -30.0);
    readable(painter, at, &text, theme::TEXT);
}
