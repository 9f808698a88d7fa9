//! Level meters and latency.

use crate::meters::Meters;

/// The lowest level shown, in dB.
const FLOOR_DB: f32 = -72.0;
/// How fast a meter falls, in dB per second.
const FALL_DB_PER_S: f64 = 40.0;
const BAR_WIDTH: f32 = 64.0;

const NAMES: [&str; 6] = ["In", "Drive", "Low", "Extension", "Texture", "Out"];

/// The meters' falling levels.
pub struct Levels {
    shown_db: [f32; NAMES.len()],
    last_s: f64,
}

impl Default for Levels {
    fn default() -> Self {
        Self { shown_db: [FLOOR_DB; NAMES.len()], last_s: 0.0 }
    }
}

impl Levels {
    /// The meters in a row.
    pub fn show(&mut self, ui: &mut egui::Ui, meters: &Meters) {
        let now_s = ui.input(|input| input.time);
        let fall_db = ((now_s - self.last_s).clamp(0.0, 1.0) * FALL_DB_PER_S) as f32;
        self.last_s = now_s;
        let peaks = [&meters.input, &meters.drive, &meters.low, &meters.extension, &meters.texture, &meters.output];
        ui.horizontal_wrapped(|ui| {
            for ((name, peak), shown_db) in NAMES.iter().zip(peaks).zip(&mut self.shown_db) {
                let peak_db = 20.0 * peak.take().max(1e-9).log10();
                *shown_db = peak_db.max(*shown_db - fall_db).clamp(FLOOR_DB, 24.0);
                let share = (*shown_db - FLOOR_DB) / -FLOOR_DB;
                let text = if *shown_db <= FLOOR_DB { "-inf".to_owned() } else { format!("{shown_db:.0} dB") };
                let color = if *shown_db > 0.0 {
                    egui::Color32::from_rgb(200, 60, 40)
                } else {
                    egui::Color32::from_rgb(190, 120, 40)
                };
                ui.label(*name);
                ui.add(
                    egui::ProgressBar::new(share.min(1.0))
                        .desired_width(BAR_WIDTH)
                        .corner_radius(1)
                        .fill(color)
                        .text(text),
                );
            }
            match meters.engine() {
                Some((samples, rate_hz)) => {
                    let ms = 1000.0 * samples as f32 / rate_hz;
                    ui.label(format!("Latency {samples} = {ms:.1} ms"))
                }
                None => ui.weak("Latency: not running"),
            };
            if meters.input_cancels() {
                ui.colored_label(
                    egui::Color32::YELLOW,
                    "The input's channels cancel each other: turn one's phase, or use mono.",
                );
            }
        });
    }
}
