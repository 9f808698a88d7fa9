//! The two distributions of amplitudes that dynamic-range matching maps onto each other (§5.3), and the current match.

use std::collections::VecDeque;

use egui::{Align2, Color32, Pos2, Rect, Shape, Stroke, Ui, Vec2};
use pyrophone_synthesis::texture::Match;

use super::super::theme;
use super::spectrogram::label;
use pyrophone_analysis::range::Amplitudes;

/// Number of windows in the drive's recent distribution: some eight seconds.
const WINDOWS: usize = 5600;
/// Seconds between two updates of the distributions.
const LOOK_S: f64 = 0.25;
/// Amplitudes shown, in dB.
const LOW_DB: f32 = -84.0;
const HIGH_DB: f32 = 0.0;

/// Recent matches.
#[derive(Debug, Clone, Default)]
pub struct DynamicsPlot {
    magnitudes: VecDeque<f32>,
    last: Option<Match>,
    drive: Option<Amplitudes>,
    looked_s: f64,
}

impl DynamicsPlot {
    /// Adds a window's match.
    pub fn take(&mut self, found: Match) {
        if self.magnitudes.len() == WINDOWS {
            self.magnitudes.pop_front();
        }
        if found.magnitude.is_finite() && found.factor.is_finite() {
            self.magnitudes.push_back(found.magnitude);
            self.last = Some(found);
        }
    }

    /// The drive's recent amplitudes; `now_s` is the window's clock.
    pub fn drive(&mut self, now_s: f64) -> Option<&Amplitudes> {
        if (now_s - self.looked_s).abs() >= LOOK_S {
            self.looked_s = now_s;
            self.drive = Amplitudes::of_magnitudes(self.magnitudes.iter().copied());
        }
        self.drive.as_ref()
    }

    /// Draws the cumulative distribution of both sounds, and the pair of amplitudes matched at present. `learned` is
    /// the drive's learned distribution, used instead of the recent one.
    pub fn show(&mut self, ui: &Ui, rect: Rect, recording: Option<&[f32]>, learned: Option<&[f32]>) {
        let painter = ui.painter().with_clip_rect(rect);
        painter.rect_filled(rect, 3.0, theme::WELL);
        let plot = rect.with_min_y(rect.top() + 20.0).with_max_y(rect.bottom() - 14.0).shrink2(Vec2::new(4.0, 0.0));
        let x = |amplitude: f32| {
            let level_db = (20.0 * amplitude.max(1e-9).log10()).clamp(LOW_DB, HIGH_DB);
            plot.left() + (level_db - LOW_DB) / (HIGH_DB - LOW_DB) * plot.width()
        };
        let y = |part: f32| plot.bottom() - part * plot.height();
        for level_db in [-60, -40, -20] {
            let x = x(10f32.powf(level_db as f32 / 20.0));
            painter.vline(x, plot.y_range(), Stroke::new(1.0, theme::LINE.gamma_multiply(0.6)));
            let at = Pos2::new(x, rect.bottom() - 2.0);
            painter.text(at, Align2::CENTER_BOTTOM, format!("{level_db} dB"), theme::small(), theme::WEAK);
        }
        let now_s = ui.input(|input| input.time);
        let last = self.last;
        let running = self.drive(now_s).map(|amplitudes| amplitudes.0.clone());
        let curve = |amplitudes: &[f32], color: Color32| {
            let parts = (amplitudes.len().max(2) - 1) as f32;
            let points =
                amplitudes.iter().enumerate().map(|(n, amplitude)| Pos2::new(x(*amplitude), y(n as f32 / parts)));
            painter.add(Shape::line(points.collect(), Stroke::new(1.4, color)));
        };
        if let Some(recording) = recording {
            curve(recording, theme::ASH);
        }
        let drive = learned.or(running.as_deref());
        if let Some(drive) = drive {
            curve(drive, theme::BLUE);
        }
        label(ui, rect, "drive to recording", theme::TEXT);
        let (Some(Match { magnitude, factor, .. }), Some(drive)) = (last, drive) else { return };
        let below = drive.iter().filter(|amplitude| **amplitude <= magnitude).count() as f32 / drive.len() as f32;
        let (from, to) = (Pos2::new(x(magnitude), y(below)), Pos2::new(x(magnitude * factor), y(below)));
        painter.line_segment([from, to], Stroke::new(1.2, theme::EMBER));
        painter.circle_filled(from, 3.0, theme::BLUE);
        painter.circle_filled(to, 3.0, theme::EMBER);
        let text =
            if factor == 1.0 { "unchanged".to_owned() } else { format!("{:+.1} dB", 20.0 * factor.max(1e-9).log10()) };
        let at = rect.right_top() + Vec2::new(-6.0, 4.0);
        painter.text(at, Align2::RIGHT_TOP, text, theme::small(), theme::TEXT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drive_distribution_follows_recent_amplitudes() {
        let mut dynamics = DynamicsPlot::default();
        for n in 0..3 * WINDOWS {
            dynamics.take(Match { place_s: 0.0, magnitude: if n < WINDOWS { 1.0 } else { 0.1 }, factor: 2.0 });
        }
        dynamics.take(Match { magnitude: f32::NAN, ..Match::default() });
        let amplitudes = dynamics.drive(1.0).expect("some").clone();
        assert!(amplitudes.0.iter().all(|amplitude| *amplitude == 0.1), "what is long ago is forgotten");
        assert_eq!(dynamics.last.map(|last| last.factor), Some(2.0));
    }
}
