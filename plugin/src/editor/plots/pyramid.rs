//! The levels of texture's output pyramid (§5.2), the coarsest on top.

use std::collections::VecDeque;

use egui::{Align2, Color32, Mesh, Pos2, Rect, Shape, Stroke, Ui, Vec2};
use pyrophone_synthesis::texture::Extent;

use super::super::theme;
use super::spectrogram::label;

/// Number of extents stored for each level: eight seconds.
const COLUMNS: usize = 480;
/// Factor by which the recent maximum decays per column.
const FORGET: f32 = 0.998;
/// The least swing that fills a row.
const LEAST: f32 = 1e-4;

/// Recent extents of the levels.
#[derive(Debug, Clone, Default)]
pub struct Levels {
    levels: Vec<Level>,
}

#[derive(Debug, Clone, Default)]
struct Level {
    extents: VecDeque<[f32; 2]>,
    largest: f32,
}

impl Levels {
    /// Adds the extent of a level.
    pub fn take(&mut self, extent: Extent) {
        let level = usize::from(extent.level);
        if level >= self.levels.len() {
            self.levels.resize(level + 1, Level::default());
        }
        let level = &mut self.levels[level];
        if level.extents.len() == COLUMNS {
            level.extents.pop_front();
        }
        let [low, high] = [extent.low, extent.high].map(|x| if x.is_finite() { x } else { 0.0 });
        level.extents.push_back([low, high]);
        level.largest = (level.largest * FORGET).max(high).max(-low);
    }

    /// Draws each level in a separate row, scaled to its recent maximum.
    pub fn show(&self, ui: &Ui, rect: Rect) {
        let painter = ui.painter().with_clip_rect(rect);
        painter.rect_filled(rect, 3.0, theme::WELL);
        let rows = rect.with_min_y(rect.top() + 18.0);
        let height = rows.height() / self.levels.len().max(1) as f32;
        for (row, (number, level)) in self.levels.iter().enumerate().rev().enumerate() {
            let top = rows.top() + row as f32 * height;
            let place = rows.with_min_y(top).with_max_y(top + height);
            // The coarsest is the drive's own, all others are the recording's.
            let color = if row == 0 { theme::BLUE } else { theme::EMBER };
            painter.add(Shape::mesh(level.mesh(place, color)));
            let at = place.left_center() + Vec2::new(3.0, 0.0);
            let galley = painter.layout_no_wrap(number.to_string(), theme::small(), theme::TEXT);
            let behind = Rect::from_min_size(at - Vec2::new(0.0, 0.5 * galley.size().y), galley.size()).expand(1.0);
            painter.rect_filled(behind, 2.0, theme::WELL.gamma_multiply(0.8));
            painter.text(at, Align2::LEFT_CENTER, number, theme::small(), theme::TEXT);
            let rule = Stroke::new(1.0, theme::LINE.gamma_multiply(0.5));
            painter.hline(place.x_range(), place.bottom(), rule);
        }
        label(ui, rect, "output pyramid", theme::EMBER);
    }
}

impl Level {
    /// Columns as wide as a point, or as an extent where that is wider.
    fn mesh(&self, place: Rect, color: Color32) -> Mesh {
        let mut mesh = Mesh::default();
        let wide = (COLUMNS as f32 / place.width().max(1.0)).ceil().max(1.0) as usize;
        let half = 0.46 * place.height() / self.largest.max(LEAST);
        let (middle, step) = (place.center().y, place.width() / COLUMNS as f32);
        let first = COLUMNS - self.extents.len();
        let mut at = 0;
        while at < self.extents.len() {
            let end = self.extents.len().min(at + wide);
            let [low, high] =
                self.extents.range(at..end).fold([0.0f32; 2], |[low, high], [l, h]| [low.min(*l), high.max(*h)]);
            let x = |column: usize| place.left() + (first + column) as f32 * step;
            let (left, right) = (x(at), x(end));
            // Silence is a line.
            let (top, bottom) = (middle - (half * high).max(0.5), middle - (half * low).min(-0.5));
            mesh.add_colored_rect(Rect::from_min_max(Pos2::new(left, top), Pos2::new(right, bottom)), color);
            at = end;
        }
        mesh
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_appear_with_their_first_extent_and_keep_the_latest() {
        let mut levels = Levels::default();
        for n in 0..1000 {
            levels.take(Extent { level: 5, low: -0.5, high: n as f32 });
        }
        levels.take(Extent { level: 0, low: f32::NAN, high: 0.25 });
        assert_eq!(levels.levels.len(), 6);
        assert_eq!(levels.levels[5].extents.len(), COLUMNS);
        assert_eq!(levels.levels[5].largest, 999.0);
        assert_eq!(levels.levels[0].extents, [[0.0, 0.25]]);
        let place = Rect::from_min_max(Pos2::new(0.0, 0.0), Pos2::new(160.0, 20.0));
        let mesh = levels.levels[5].mesh(place, theme::EMBER);
        assert_eq!(mesh.vertices.len(), 4 * 160, "a column a point");
        let bounds = mesh.calc_bounds();
        assert!(bounds.width() <= 160.1 && bounds.top() >= 0.0 && bounds.bottom() <= 20.0, "{bounds:?}");
    }
}
