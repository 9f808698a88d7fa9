//! Axes of the spectrum plot.

use egui::{Align2, Pos2, Rect, Stroke};
use pyrophone_analysis::bands::{frequency_hz, position};

use crate::editor::theme;

/// Range of levels shown.
const RANGE_DB: f32 = 100.0;
/// Height of a name on an axis, in points.
const NAME: f32 = 13.0;

/// Mapping of frequencies and levels to the screen.
#[derive(Clone, Copy)]
pub struct Axes {
    /// Area of the plot.
    pub rect: Rect,
    /// Level at the top edge.
    pub top_db: f32,
}

impl Axes {
    /// Horizontal position of a frequency.
    pub fn x(&self, frequency_hz: f64) -> f32 {
        self.rect.left() + position(frequency_hz) as f32 * self.rect.width()
    }

    /// Frequency at a horizontal position.
    pub fn frequency_hz(&self, x: f32) -> f64 {
        frequency_hz(f64::from((x - self.rect.left()) / self.rect.width()))
    }

    /// Vertical position of a level.
    pub fn y(&self, level_db: f32) -> f32 {
        self.rect.top() + (self.top_db - level_db) / RANGE_DB * self.rect.height()
    }

    /// Level at a vertical position.
    pub fn level_db(&self, y: f32) -> f32 {
        self.top_db - (y - self.rect.top()) / self.rect.height() * RANGE_DB
    }
}

/// Draws lines and their names.
pub fn grid(painter: &egui::Painter, axes: &Axes) {
    let rule = Stroke::new(1.0, theme::LINE.gamma_multiply(0.6));
    for (frequency_hz, name) in [
        (50.0, "50"),
        (100.0, "100"),
        (200.0, "200"),
        (500.0, "500"),
        (1000.0, "1k"),
        (2000.0, "2k"),
        (5000.0, "5k"),
        (10_000.0, "10k"),
    ] {
        let x = axes.x(frequency_hz);
        painter.line_segment([Pos2::new(x, axes.rect.top()), Pos2::new(x, axes.rect.bottom())], rule);
        let at = Pos2::new(x + 3.0, axes.rect.bottom() - 2.0);
        painter.text(at, Align2::LEFT_BOTTOM, name, theme::small(), theme::WEAK);
    }
    let first = (axes.top_db / 20.0).floor() as i32;
    for level_db in (first - 6..=first).map(|n| 20 * n) {
        let y = axes.y(level_db as f32);
        painter.line_segment([Pos2::new(axes.rect.left(), y), Pos2::new(axes.rect.right(), y)], rule);
        // The frequencies' names are below.
        if y < axes.rect.bottom() - 2.0 * NAME {
            let at = Pos2::new(axes.rect.right() - 4.0, y + 1.0);
            painter.text(at, Align2::RIGHT_TOP, format!("{level_db}"), theme::small(), theme::WEAK);
        }
    }
}
