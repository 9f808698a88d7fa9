//! The noise factor beta of extension's windows (§4, Algorithm 1), window by window.

use std::collections::VecDeque;

use egui::{Align2, Pos2, Rect, Shape, Stroke, Ui, Vec2};

use super::super::theme;
use super::spectrogram::label;

/// Number of windows shown: some eight seconds of the usual ones.
const WINDOWS: usize = 720;
/// Decades shown below the recent maximum.
const DECADES: f32 = 3.0;

/// Recent factors, the newest last.
#[derive(Debug, Clone, Default)]
pub struct Betas {
    values: VecDeque<f32>,
}

impl Betas {
    /// Adds a window's factor.
    pub fn take(&mut self, beta: f32) {
        if self.values.len() == WINDOWS {
            self.values.pop_front();
        }
        self.values.push_back(if beta.is_finite() { beta.max(0.0) } else { 0.0 });
    }

    /// Draws them on a logarithmic axis whose top is the largest; windows without noise lie at the bottom.
    pub fn show(&self, ui: &Ui, rect: Rect) {
        let painter = ui.painter().with_clip_rect(rect);
        painter.rect_filled(rect, 3.0, theme::WELL);
        let largest = self.values.iter().copied().fold(0.0f32, f32::max);
        if largest > 0.0 {
            let (top, bottom) = (rect.top() + 20.0, rect.bottom() - 3.0);
            let y = |beta: f32| {
                let below = ((largest / beta.max(1e-30)).log10() / DECADES).min(1.0);
                top + below * (bottom - top)
            };
            let step = rect.width() / WINDOWS as f32;
            let first = WINDOWS - self.values.len();
            let points = self.values.iter().enumerate();
            let points = points.map(|(n, beta)| Pos2::new(rect.left() + (first + n) as f32 * step, y(*beta)));
            painter.add(Shape::line(points.collect(), Stroke::new(0.8, theme::EMBER.gamma_multiply(0.8))));
        }
        label(ui, rect, "beta per window", theme::EMBER);
        if let Some(beta) = self.values.back() {
            let at = rect.right_top() + Vec2::new(-6.0, 4.0);
            painter.text(at, Align2::RIGHT_TOP, shown(*beta), theme::small(), theme::TEXT);
        }
    }
}

fn shown(beta: f32) -> String {
    match beta {
        0.0 => "no noise".to_owned(),
        0.01..1000.0 => format!("{beta:.2}"),
        _ => format!("{beta:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_are_kept_and_nonsense_is_none() {
        let mut betas = Betas::default();
        for n in 0..1000 {
            betas.take(n as f32);
        }
        assert_eq!((betas.values.len(), betas.values.back()), (WINDOWS, Some(&999.0)));
        betas.take(f32::NAN);
        betas.take(-1.0);
        assert_eq!(betas.values.range(WINDOWS - 2..).copied().collect::<Vec<_>>(), [0.0, 0.0]);
        assert_eq!(["no noise", "1.50", "1.0e-5"], [0.0, 1.5, 1e-5].map(shown).each_ref().map(String::as_str));
    }
}
