//! The running flame signal: recent least and largest samples, the newest at the right.

use std::collections::VecDeque;

use egui::{Color32, Mesh, Pos2, Rect, Shape, Ui};

use super::super::theme;

/// Number of columns stored, and seconds of each: four seconds in all.
const COLUMNS: usize = 240;
const COLUMN_S: f64 = 1.0 / 60.0;
/// Factor by which the recent maximum decays per column, and the least that fills the plot.
const FORGET: f32 = 0.997;
const LEAST: f32 = 1e-4;

/// Recent outline of a signal.
#[derive(Debug, Clone, Default)]
pub struct Outline {
    columns: VecDeque<[f32; 2]>,
    open: [f32; 2],
    samples: usize,
    largest: f32,
}

impl Outline {
    /// Adds a sample at `sample_rate_hz`.
    pub fn push(&mut self, sample: f32, sample_rate_hz: f64) {
        let sample = if sample.is_finite() { sample } else { 0.0 };
        self.open = [self.open[0].min(sample), self.open[1].max(sample)];
        self.samples += 1;
        if (self.samples as f64) < COLUMN_S * sample_rate_hz {
            return;
        }
        if self.columns.len() == COLUMNS {
            self.columns.pop_front();
        }
        let [low, high] = std::mem::take(&mut self.open);
        self.columns.push_back([low, high]);
        self.largest = (self.largest * FORGET).max(high).max(-low);
        self.samples = 0;
    }

    /// Draws it, scaled to its recent maximum; silence is a line.
    pub fn show(&self, ui: &Ui, rect: Rect, color: Color32) {
        let painter = ui.painter().with_clip_rect(rect);
        painter.rect_filled(rect, 3.0, theme::WELL);
        let half = 0.45 * rect.height() / self.largest.max(LEAST);
        let (middle, step) = (rect.center().y, rect.width() / COLUMNS as f32);
        let first = COLUMNS - self.columns.len();
        let mut mesh = Mesh::default();
        for (index, [low, high]) in self.columns.iter().enumerate() {
            let left = rect.left() + (first + index) as f32 * step;
            let (top, bottom) = (middle - (half * high).max(0.5), middle - (half * low).min(-0.5));
            let bar = Rect::from_min_max(Pos2::new(left, top), Pos2::new(left + step.max(0.5), bottom));
            mesh.add_colored_rect(bar, color);
        }
        painter.add(Shape::mesh(mesh));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_columns_are_kept() {
        let mut outline = Outline::default();
        for n in 0..1000 * COLUMNS {
            outline.push(if n % 2 == 0 { n as f32 } else { f32::NAN }, 6000.0);
        }
        assert_eq!(outline.columns.len(), COLUMNS);
        assert_eq!(outline.columns[COLUMNS - 1], [0.0, 239_998.0]);
        assert_eq!(outline.largest, 239_998.0);
    }
}
