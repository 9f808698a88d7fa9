//! Positions in the recording of the last matches.

use egui::{Mesh, Pos2, Rect, Shape, Stroke, Ui, Vec2};

use super::super::theme;

/// Number of distinct positions.
const CELLS: usize = 256;
/// Time constant in seconds with which a position cools down.
const COOLING_S: f64 = 2.0;
/// Heat below which a position counts as cold.
const COLD: f32 = 1e-3;
/// Height of the strip in points.
const HEIGHT: f32 = 7.0;

/// Recent number of matches by position.
#[derive(Debug, Clone)]
pub struct Heat {
    cells: [f32; CELLS],
    /// Position of the last match, as a share of the recording.
    last: Option<f32>,
    last_s: f64,
}

impl Default for Heat {
    fn default() -> Self {
        Self { cells: [0.0; CELLS], last: None, last_s: 0.0 }
    }
}

impl Heat {
    /// Adds a match at `place` (0-1) of the recording.
    pub fn take(&mut self, place: f32) {
        if (0.0..=1.0).contains(&place) {
            self.cells[((place * CELLS as f32) as usize).min(CELLS - 1)] += 1.0;
            self.last = Some(place);
        }
    }

    /// Cools down to `now_s`, the window's clock.
    pub fn cool(&mut self, now_s: f64) {
        let part = (-((now_s - self.last_s).max(0.0) / COOLING_S)).exp() as f32;
        self.last_s = now_s;
        for heat in &mut self.cells {
            *heat *= part;
            if *heat < COLD {
                *heat = 0.0;
            }
        }
        if self.cells.iter().all(|heat| *heat == 0.0) {
            self.last = None;
        }
    }

    /// A strip along the lower edge of the recording's outline, and a line at the last match.
    pub fn show(&self, ui: &Ui, rect: Rect) {
        let Some(last) = self.last else { return };
        let painter = ui.painter();
        let hottest = self.cells.iter().copied().fold(1e-3, f32::max);
        let strip = rect.with_min_y(rect.bottom() - HEIGHT);
        let width = strip.width() / CELLS as f32;
        let mut mesh = Mesh::default();
        for (index, heat) in self.cells.iter().enumerate().filter(|(_, heat)| **heat > 0.0) {
            let at = Pos2::new(strip.left() + index as f32 * width, strip.top());
            // The eye distinguishes square roots of counts better than counts.
            let color = theme::glow(0.25 + 0.75 * (heat / hottest).sqrt());
            mesh.add_colored_rect(Rect::from_min_size(at, Vec2::new(width.max(1.0), HEIGHT)), color);
        }
        painter.add(Shape::mesh(mesh));
        let x = rect.left() + last * rect.width();
        painter.vline(x, rect.y_range(), Stroke::new(1.0, theme::EMBER));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_heat_up_and_cool_down() {
        let mut heat = Heat::default();
        heat.cool(10.0);
        for place in [0.5, 0.5, 1.0, -0.1, 1.1, f32::NAN] {
            heat.take(place);
        }
        assert_eq!((heat.cells[CELLS / 2], heat.cells[CELLS - 1], heat.cells.iter().sum::<f32>()), (2.0, 1.0, 3.0));
        assert_eq!(heat.last, Some(1.0));
        heat.cool(12.0);
        assert!((heat.cells[CELLS / 2] - 2.0 / std::f32::consts::E).abs() < 1e-5);
        heat.cool(60.0);
        assert_eq!((heat.cells, heat.last), ([0.0; CELLS], None));
    }
}
