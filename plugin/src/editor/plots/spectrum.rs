//! Spectra of drive, recording and output on one plot, with handles for extension.

mod advice;
mod axes;
mod extension;
mod words;

use egui::{Pos2, Rect, Shape, Stroke, Ui};
use pyrophone_analysis::bands::{BANDS, decibels, position};
use pyrophone_analysis::{FLOOR_DB, RecordingOverview};
use pyrophone_settings::Id;

use super::super::param_editor::ParamEditor;
use super::super::theme;
pub use advice::Advice;
use axes::{Axes, grid};
use words::{legend, read_out};

/// Time constant in seconds of the curves, and fall rate of their peaks.
const SMOOTHING_S: f32 = 0.5;
const FALL_DB_PER_S: f32 = 6.0;
/// Space above the loudest level.
const HEADROOM_DB: f32 = 8.0;
/// The lowest top: below it, the axis does not follow a fading sound.
const REST_DB: f32 = -60.0;
/// The band in which a recording's level is matched and its likeness measured, in Hz.
const LIKENESS_HZ: (f64, f64) = (250.0, 16_000.0);

/// A sound's recent spectrum.
#[derive(Debug, Clone)]
pub struct Track {
    power: [f32; BANDS],
    peak_db: [f32; BANDS],
}

impl Default for Track {
    fn default() -> Self {
        Self { power: [0.0; BANDS], peak_db: [FLOOR_DB; BANDS] }
    }
}

impl Track {
    /// Adds the power densities of one step.
    pub fn take(&mut self, density: &[f32; BANDS], step_s: f32) {
        let part = 1.0 - (-step_s / SMOOTHING_S).exp();
        for ((power, peak_db), now) in self.power.iter_mut().zip(&mut self.peak_db).zip(density) {
            *power += part * (now - *power);
            *peak_db = decibels(*power).max(*peak_db - FALL_DB_PER_S * step_s);
        }
    }

    fn levels_db(&self) -> [f32; BANDS] {
        self.power.map(decibels)
    }
}

/// Drive and output.
#[derive(Debug, Clone)]
pub struct Spectra {
    /// Drive.
    pub drive: Track,
    /// Output.
    pub output: Track,
    top_db: f32,
}

impl Default for Spectra {
    fn default() -> Self {
        Self { drive: Track::default(), output: Track::default(), top_db: REST_DB }
    }
}

impl Spectra {
    /// Draws the plot; handles on it move parameters.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        rect: Rect,
        recording: Option<&RecordingOverview>,
        advice: &Advice,
        edit: &mut ParamEditor<'_>,
    ) {
        let (drive, output) = (self.drive.levels_db(), self.output.levels_db());
        let loudest = drive.iter().chain(&output).copied().fold(FLOOR_DB, f32::max);
        let wanted = (loudest + HEADROOM_DB).max(REST_DB);
        self.top_db += (wanted - self.top_db) * if wanted > self.top_db { 0.3 } else { 0.02 };
        let axes = Axes { rect, top_db: self.top_db };
        let painter = ui.painter().with_clip_rect(rect);
        painter.rect_filled(rect, 3.0, theme::WELL);
        grid(&painter, &axes);
        let matched = recording.map(|overview| matched(&overview.spectrum_db, &output));
        if let Some((levels, _)) = &matched {
            curve(&painter, &axes, levels, Stroke::new(1.2, theme::ASH.gamma_multiply(0.8)));
        }
        for (track, levels, color) in [(&self.drive, &drive, theme::BLUE), (&self.output, &output, theme::EMBER)] {
            curve(&painter, &axes, &track.peak_db, Stroke::new(0.8, color.gamma_multiply(0.35)));
            curve(&painter, &axes, levels, Stroke::new(1.6, color));
        }
        // Handles without effect would mislead.
        if edit.inert(Id::Alpha as usize).is_none() {
            extension::show(ui, &painter, &axes, &drive, edit);
        }
        advice.show(ui, &painter, rect, edit);
        legend(&painter, rect, matched.as_ref().and_then(|(_, likeness)| *likeness), recording.is_some());
        read_out(ui, &painter, &axes, &drive, &output);
    }
}

fn curve(painter: &egui::Painter, axes: &Axes, levels_db: &[f32; BANDS], stroke: Stroke) {
    let points = levels_db.iter().enumerate().map(|(band, level)| {
        let x = axes.rect.left() + (band as f32 + 0.5) / BANDS as f32 * axes.rect.width();
        Pos2::new(x, axes.y(*level).min(axes.rect.bottom() + 2.0))
    });
    painter.add(Shape::line(points.collect(), stroke));
}

/// A recording's spectrum at the output's level, and the mean distance of the two, in dB; with a silent output, at its
/// own level.
fn matched(recording: &[f32; BANDS], output: &[f32; BANDS]) -> ([f32; BANDS], Option<f32>) {
    let band = |frequency_hz: f64| (position(frequency_hz) * BANDS as f64) as usize;
    let span = band(LIKENESS_HZ.0)..band(LIKENESS_HZ.1);
    let compared = || span.clone().filter(|at| output[*at] > -140.0 && recording[*at] > -140.0);
    let count = compared().count();
    if count < span.len() / 2 {
        return (*recording, None);
    }
    let offset = compared().map(|at| output[at] - recording[at]).sum::<f32>() / count as f32;
    let apart = compared().map(|at| (output[at] - recording[at] - offset).abs()).sum::<f32>() / count as f32;
    (recording.map(|level| level + offset), Some(apart))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn likeness_does_not_depend_on_the_level() {
        let recording: [f32; BANDS] = std::array::from_fn(|band| -60.0 - 0.2 * band as f32);
        let quieter = recording.map(|level| level - 23.0);
        let (levels, apart) = matched(&recording, &quieter);
        assert!(apart.unwrap() < 1e-3);
        assert!(levels.iter().zip(&quieter).all(|(a, b)| (a - b).abs() < 1e-3));
        let tilted: [f32; BANDS] = std::array::from_fn(|band| recording[band] + 0.1 * band as f32);
        let apart = matched(&recording, &tilted).1.unwrap();
        assert!((1.5..6.0).contains(&apart), "{apart}");
        assert_eq!(matched(&recording, &[FLOOR_DB; BANDS]), (recording, None));
    }

    #[test]
    fn tracks_smooth_and_their_peaks_fall() {
        let mut track = Track::default();
        for _ in 0..200 {
            track.take(&[1e-6; BANDS], 0.03);
        }
        assert!((track.levels_db()[0] + 60.0).abs() < 0.1);
        for _ in 0..100 {
            track.take(&[0.0; BANDS], 0.03);
        }
        assert!(track.levels_db()[0] < -80.0);
        assert!((track.peak_db[0] + 78.0).abs() < 1.0, "{}", track.peak_db[0]);
    }
}
