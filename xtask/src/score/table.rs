//! The figures as a page.

use std::fmt::Write;
use std::path::Path;

use anyhow::{Context, Result};
use serde_json::Value;

/// One result and its figures.
pub struct Scored {
    /// The flame signal's name.
    pub input: String,
    /// The recording's name.
    pub training: String,
    /// The dynamics mode.
    pub mode: &'static str,
    /// Output of the scoring program for each draw.
    pub draws: Vec<Value>,
}

/// A figure of the table.
struct Column {
    title: &'static str,
    /// Key in the scoring program's output.
    path: &'static str,
    /// Range allowed on straight pairs and on all.
    straight: [f64; 2],
    all: [f64; 2],
}

const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
const fn most(high: f64) -> [f64; 2] {
    [f64::NEG_INFINITY, high]
}
const fn least(low: f64) -> [f64; 2] {
    [low, f64::INFINITY]
}

/// The columns, with the targets of the companded mode.
const COLUMNS: [Column; 10] = [
    column("texture", "texture_distance.overall_fixed", ANY, ANY),
    column("spectrum, dB", "log_spectral_distance.db", most(2.0), ANY),
    column("dB sync", "follow.envelope_sync_log", least(0.92), least(0.88)),
    column("sync", "follow.envelope_sync", least(0.85), least(0.78)),
    column("coherence", "follow.low_frequency_coherence", least(0.95), least(0.95)),
    column("grid line, dB", "tonal_buzz.max_db", most(5.0), most(5.0)),
    column("lines, dB", "tonal_buzz.lines_p99_db", most(3.5), most(3.5)),
    column("copy, s", "copied_run.longest_s", most(0.1), most(0.1)),
    column("kurtosis", "crackle.kurtosis_ratio", [0.7, 2.0], [0.7, 2.0]),
    column("onsets", "crackle.rate_ratio", most(2.0), most(2.0)),
];

const fn column(title: &'static str, path: &'static str, straight: [f64; 2], all: [f64; 2]) -> Column {
    Column { title, path, straight, all }
}

/// Most texture distance on straight pairs.
const TEXTURE: [(&str, f64); 3] = [("burning_brick", 1.7), ("dragon", 1.4), ("torch", 1.8)];

impl Scored {
    /// The mean of all draws, and half their range.
    fn figure(&self, column: &Column) -> Option<(f64, f64)> {
        let of = |draw: &Value| column.path.split('.').try_fold(draw, |value, key| value.get(key))?.as_f64();
        let figures: Vec<f64> = self.draws.iter().filter_map(of).collect();
        let mean = figures.iter().sum::<f64>() / figures.len() as f64;
        let [low, high] = [f64::min, f64::max].map(|pick| figures.iter().copied().reduce(pick));
        Some((mean, 0.5 * (high? - low?)))
    }

    fn range(&self, column: &Column) -> [f64; 2] {
        if self.input != self.training {
            return column.all;
        }
        let texture = TEXTURE.iter().find(|(name, _)| *name == self.input && column.title == "texture");
        texture.map_or(column.straight, |(_, high)| most(*high))
    }
}

/// A Markdown table for each mode with the means of all draws; figures that miss their targets are bold.
pub fn report(scored: &[Scored]) -> String {
    let mut text = String::new();
    let mut missed = Vec::new();
    for mode in ["companded", "paper"] {
        let _ = writeln!(text, "\n### {}\n", if mode == "paper" { "Paper" } else { "Companded" });
        let titles: Vec<&str> = COLUMNS.iter().map(|column| column.title).collect();
        let _ = writeln!(text, "| flame on recording | {} |", titles.join(" | "));
        let _ = writeln!(text, "|---|{}", "---|".repeat(COLUMNS.len()));
        for result in scored.iter().filter(|result| result.mode == mode) {
            let _ = write!(text, "| {} on {} ", result.input, result.training);
            for column in &COLUMNS {
                let [low, high] = result.range(column);
                let Some((figure, spread)) = result.figure(column) else {
                    let _ = write!(text, "| – ");
                    continue;
                };
                let paper = |other: &&Scored| {
                    other.mode == "paper" && (&other.input, &other.training) == (&result.input, &result.training)
                };
                let nearer = column.title != "texture"
                    || scored
                        .iter()
                        .find(paper)
                        .and_then(|paper| paper.figure(column))
                        .is_none_or(|(paper, _)| figure < paper);
                let spread = if result.draws.len() > 1 { format!(" ±{spread:.2}") } else { String::new() };
                if mode == "companded" && !(figure >= low && figure <= high && nearer) {
                    missed.push(format!("{} on {}: {} {figure:.3}", result.input, result.training, column.title));
                    let _ = write!(text, "| **{figure:.2}**{spread} ");
                } else {
                    let _ = write!(text, "| {figure:.2}{spread} ");
                }
            }
            let _ = writeln!(text, "|");
        }
    }
    let _ = match missed.as_slice() {
        [] => writeln!(text, "\nEvery score of the companded mode meets its target."),
        missed => writeln!(text, "\nShort of their targets: {}.", missed.join("; ")),
    };
    text
}

const BEGIN: &str = "<!-- figures -->";
const END: &str = "<!-- end of figures -->";

/// Writes the figures into the page.
pub fn write_between_markers(page: &Path, figures: &str) -> Result<()> {
    let text = std::fs::read_to_string(page).with_context(|| page.display().to_string())?;
    let (before, rest) = text.split_once(BEGIN).with_context(|| format!("{}: no {BEGIN}", page.display()))?;
    let (_, after) = rest.split_once(END).with_context(|| format!("{}: no {END}", page.display()))?;
    std::fs::write(page, format!("{before}{BEGIN}\n{figures}\n{END}{after}"))
        .with_context(|| page.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missed_targets_are_named() {
        let scored = |mode, texture: f64, sync: f64| Scored {
            input: "dragon".into(),
            training: "dragon".into(),
            mode,
            draws: [-0.1, 0.1]
                .map(|change| {
                    serde_json::json!({
                        "texture_distance": {"overall_fixed": texture + change},
                        "follow": {"envelope_sync": sync},
                    })
                })
                .to_vec(),
        };
        let report_of = |texture, sync| report(&[scored("companded", texture, sync), scored("paper", 1.3, 0.1)]);
        assert!(report_of(1.2, 0.9).contains("Every score"));
        assert!(report_of(1.5, 0.9).contains("Short of their targets: dragon on dragon: texture 1.500."));
        assert!(report_of(1.35, 0.9).contains("texture 1.350"), "no nearer than the paper");
        assert!(report_of(1.2, 0.5).contains("| **0.50** ±0.00 |"));
        assert!(report_of(1.2, 0.9).contains("| 1.20 ±0.10 |"));
    }
}
