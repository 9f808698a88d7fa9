//! A report on a flame signal: pictures of the front, curves and figures, in one file.

mod page;
mod plots;
mod raster;

use std::io::Write;
use std::path::Path;

use pyrophone_recording::write_file;

use crate::error::Error;
use crate::output::make_folder;

use pyrophone_analysis::Spectrum;
pub use raster::{Picture, View};

/// The band in Hz that comes from the simulation itself (Chadwick & James 2011, §3-4).
const BAND_HZ: (f64, f64) = (30.0, 180.0);

/// Contents of a report on a flame signal.
pub struct Report<'a> {
    /// The page's heading.
    pub title: String,
    /// Origin of the signal: labels and values.
    pub facts: Vec<(String, String)>,
    /// Pictures of the front with their labels, in time order.
    pub surfaces: Vec<(String, Picture)>,
    /// Velocity flux, one value per step.
    pub flux: &'a [f64],
    /// Area of the front, one value per step; empty if unknown.
    pub area: &'a [f64],
    /// Steps per second.
    pub rate_hz: f64,
    /// The signal as it was written.
    pub pressure: &'a [f32],
    /// Its sample rate.
    pub sample_rate_hz: u32,
    /// True for an envelope, which has no meaningful spectrum.
    pub is_envelope: bool,
}

/// Writes `folder/index.html`, which needs no other file; creates the folder if needed.
pub fn write(folder: &Path, report: &Report<'_>) -> Result<(), Error> {
    let path = folder.join("index.html");
    let failed = |reason: String| {
        let path = path.display().to_string();
        Error::Recording(pyrophone_recording::Error::NotWritten { path, reason })
    };
    let html = page::render(report).map_err(failed)?;
    make_folder(folder)?;
    Ok(write_file(&path, |file| file.write_all(html.as_bytes()))?)
}

/// Figures about the signal: labels and values.
fn figures(report: &Report<'_>, spectrum: &Spectrum) -> Vec<(String, String)> {
    let count = report.pressure.len().max(1) as f64;
    let rms = (report.pressure.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / count).sqrt();
    let peak = report.pressure.iter().fold(0.0f64, |peak, x| peak.max(f64::from(x.abs())));
    let mut figures = vec![("Length".into(), format!("{:.3} s", count / f64::from(report.sample_rate_hz)))];
    if rms > 0.0 {
        figures.push(("Level (rms)".into(), format!("{:.1} dBFS", 20.0 * rms.log10())));
        figures.push(("Peak".into(), format!("{:.1} dBFS", 20.0 * peak.log10())));
        figures.push(("Crest factor".into(), format!("{:.1} dB", 20.0 * (peak / rms).log10())));
    } else {
        figures.push(("Level".into(), "silence".into()));
    }
    if let (false, Some(slope)) = (report.is_envelope, spectrum.slope(BAND_HZ.0, BAND_HZ.1)) {
        let (low, high) = BAND_HZ;
        let octave = 10.0 * slope * 2f64.log10();
        figures.push((
            format!("Spectral slope {low:.0}-{high:.0} Hz"),
            format!("{octave:+.1} dB per octave (power ~ f^{slope:.2})"),
        ));
        let share = spectrum.power(low, high) / spectrum.power(0.0, f64::INFINITY).max(f64::MIN_POSITIVE);
        figures.push((format!("Power within {low:.0}-{high:.0} Hz"), format!("{:.1} %", 100.0 * share)));
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let spread = |values: &[f64]| {
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
        format!("{low:.4} to {high:.4}, mean {:.4}", mean(values))
    };
    if !report.flux.is_empty() {
        figures.push(("Flux".into(), spread(report.flux)));
    }
    if !report.area.is_empty() {
        figures.push(("Front area".into(), spread(report.area)));
    }
    figures
}
