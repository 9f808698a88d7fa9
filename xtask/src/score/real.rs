//! The real recordings: every drive over each of them, started at three positions.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::Result;
use pyrophone_host::Format;
use pyrophone_host::bounce::BlockSize;
use pyrophone_recording::write_wav_f32;
use pyrophone_settings::Automation;
use serde_json::Value;

use super::drives::{Drive, drives};
use super::{BLOCK, OFFSETS, later, python, sounds};
use crate::bounce::{Request, load, play, preset, reference as reference_to};

/// Locations of programs and sounds.
pub struct ScorePlace<'a> {
    /// The reference folder.
    pub reference: &'a Path,
    /// Folder for sounds.
    pub folder: &'a Path,
    /// A Python with the programs' requirements.
    pub python: &'a Path,
    /// The programs that score following and crackle.
    pub programs: [&'a Path; 2],
    /// Settings beyond the preset's.
    pub settings: &'a [String],
}

/// A figure of the table, and its location in a program's output: in the scoring program's, or in that of crackle and
/// of the recording.
struct Column {
    title: &'static str,
    path: &'static str,
    /// Location of the recording's own figure, shown beside it.
    own: Option<&'static str>,
}

const COLUMNS: [Column; 12] = [
    column("texture", "score.texture_distance.overall_fixed", None),
    column("dB sync", "score.follow.envelope_sync_log", None),
    column("sync", "score.follow.envelope_sync", None),
    column("lag, ms", "score.follow.lag_ms", None),
    column("coherence", "score.follow.low_frequency_coherence", None),
    column("contrast, dB", "crackle.output.contrast_db", Some("crackle.training.contrast_db")),
    column("crackles a second", "crackle.output.rate", Some("crackle.training.rate")),
    column("over 20 dB", "crackle.output.rate20", Some("crackle.training.rate20")),
    column("kurtosis", "crackle.output.kurtosis", Some("crackle.training.kurtosis")),
    column("gaps", "crackle.output.gap_cv", Some("crackle.training.gap_cv")),
    column("LUFS", "crackle.output.lufs", None),
    column("peak", "crackle.output.peak", None),
];

const fn column(title: &'static str, path: &'static str, own: Option<&'static str>) -> Column {
    Column { title, path, own }
}

/// Plays and scores everything, and writes it as a Markdown table of means and spreads.
pub fn report(place: &ScorePlace<'_>) -> Result<String> {
    let recordings = sounds(&place.reference.join("recordings"))?;
    let drives = drives(place.reference, place.folder)?;
    let titles: Vec<&str> = COLUMNS.iter().map(|column| column.title).collect();
    let mut text = format!("\n### Real recordings\n\n| drive on recording | {} |\n", titles.join(" | "));
    let _ = writeln!(text, "|---|{}", "---|".repeat(COLUMNS.len()));
    let recordings: Vec<(String, PathBuf)> = recordings
        .into_iter()
        .map(|(name, path)| Ok((name.clone(), as_wav(place, &name, &path)?)))
        .collect::<Result<_>>()?;
    for drive in &drives {
        for (recording, path) in &recordings {
            let draws: Vec<Value> =
                OFFSETS.iter().map(|offset| draw(place, drive, recording, path, *offset)).collect::<Result<_>>()?;
            let _ = write!(text, "| {} on {recording} ", drive.name);
            for column in &COLUMNS {
                let _ = write!(text, "| {} ", cell(column, &draws));
            }
            text.push_str("|\n");
            eprintln!("  {} on {recording}", drive.name);
        }
    }
    let _ = writeln!(text, "\nMeans of three draws, ± half their range; with crackles, output / recording.");
    Ok(text)
}

/// A recording as a WAV file: the scoring program reads no other format.
fn as_wav(place: &ScorePlace<'_>, name: &str, path: &Path) -> Result<PathBuf> {
    let sound = load(path, None)?;
    let wav = place.folder.join(format!("recording-{name}.wav"));
    write_wav_f32(&wav, &sound.channels, sound.sample_rate_hz)?;
    Ok(wav)
}

/// One draw, scored by both programs.
fn draw(place: &ScorePlace<'_>, drive: &Drive, name: &str, recording: &Path, offset: usize) -> Result<Value> {
    let settings = drive.settings.iter().copied().chain(place.settings.iter().map(String::as_str));
    let values = preset("default", settings)?;
    let main = later(&drive.sound, offset);
    let played = play(&Request {
        format: Format::Clap,
        values: &values,
        automation: &Automation::default(),
        main: &main,
        sidechain: &[],
        training: Some(reference_to(recording)?),
        learned: None,
        block: BlockSize::Fixed(BLOCK),
        offline: false,
        reference_padding: false,
        output_channels: load(recording, None)?.channels.len().clamp(main.channels.len(), 2),
    })?;
    let stem = format!("{}-on-{name}-{offset}", drive.name);
    let file = |what: &str| -> PathBuf { place.folder.join(format!("{stem}-{what}.wav")) };
    let (input, output) = (file("input"), file("output"));
    write_wav_f32(&input, &main.channels, main.sample_rate_hz)?;
    write_wav_f32(&output, &played.channels, main.sample_rate_hz)?;
    let [score, crackle] = place.programs;
    let paths = [input, recording.to_owned()];
    Ok(serde_json::json!({
        "score": python::score(place.python, score, &output, &paths)?,
        "crackle": python::crackle(place.python, crackle, &output, recording)?,
    }))
}

fn cell(column: &Column, draws: &[Value]) -> String {
    let figures = |path: &str| -> Vec<f64> { draws.iter().filter_map(|draw| figure(draw, path)).collect() };
    let found = figures(column.path);
    if found.is_empty() {
        return "–".to_owned();
    }
    let mean = |figures: &[f64]| figures.iter().sum::<f64>() / figures.len() as f64;
    let range = found.iter().fold(f64::MIN, |a, b| a.max(*b)) - found.iter().fold(f64::MAX, |a, b| a.min(*b));
    let own = column.own.map(&figures).filter(|own| !own.is_empty());
    let own = own.map_or_else(String::new, |own| format!(" / {:.2}", mean(&own)));
    format!("{:.2} ±{:.2}{own}", mean(&found), 0.5 * range)
}

fn figure(scores: &Value, path: &str) -> Option<f64> {
    path.split('.').try_fold(scores, |value, key| value.get(key))?.as_f64()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_mean_spread_and_the_recordings_own() {
        let draw = |texture: f64, rate: f64| {
            serde_json::json!({
                "score": {"texture_distance": {"overall_fixed": texture}},
                "crackle": {"output": {"rate": rate}, "training": {"rate": 8.0}},
            })
        };
        let draws = [draw(1.0, 10.0), draw(1.5, 11.0), draw(1.1, 9.0)];
        let cell_of = |title: &str| cell(COLUMNS.iter().find(|column| column.title == title).unwrap(), &draws);
        assert_eq!(cell_of("texture"), "1.20 ±0.25");
        assert_eq!(cell_of("crackles a second"), "10.00 ±1.00 / 8.00");
        assert_eq!(cell_of("sync"), "–");
    }
}
