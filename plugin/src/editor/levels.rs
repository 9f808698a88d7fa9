//! Level meters; solo and mute of the layers.

use egui::{Align2, Button, Pos2, Rect, RichText, Ui, Vec2};

use super::{map, theme};
use crate::meters::Meters;
use crate::probe::LAYERS;

/// The lowest level shown, in dB, and the highest.
const FLOOR_DB: f32 = -60.0;
const TOP_DB: f32 = 6.0;
/// How fast a meter falls, in dB per second.
const FALL_DB_PER_S: f64 = 40.0;

const NAMES: [&str; 10] = ["in", "drive", "low", "ext", "tex", "vtx", "crk", "hiss", "body", "out"];
/// The first of the layers, and their names in full.
const FIRST_LAYER: usize = 2;
const LAYER_NAMES: [&str; LAYERS] =
    ["the low layer", "extension", "texture", "vortex sound", "crackle", "hiss", "body"];
/// Height of a button below a meter, in points.
const BUTTON: f32 = 15.0;

/// The meters' falling levels.
pub struct Levels {
    shown_db: [f32; NAMES.len()],
    last_s: f64,
    soloed: [bool; LAYERS],
    muted: [bool; LAYERS],
}

impl Default for Levels {
    fn default() -> Self {
        Self { shown_db: [FLOOR_DB; NAMES.len()], last_s: 0.0, soloed: [false; LAYERS], muted: [false; LAYERS] }
    }
}

impl Levels {
    /// Layers that are not to be heard: those that are muted, and beside a solo all others.
    pub fn silenced(&self) -> [bool; LAYERS] {
        let is_solo = self.soloed.contains(&true);
        std::array::from_fn(|layer| self.muted[layer] || is_solo && !self.soloed[layer])
    }

    /// All layers are heard.
    pub fn clear(&mut self) {
        (self.soloed, self.muted) = Default::default();
    }

    /// The meters, side by side, and below those of layers their switches.
    pub fn show(&mut self, ui: &mut Ui, rect: Rect, meters: &Meters) {
        self.bars(ui, rect.with_max_y(rect.bottom() - 2.0 * BUTTON - 3.0), meters);
        let step = rect.width() / NAMES.len() as f32;
        let ui = &mut ui.new_child(egui::UiBuilder::new().id_salt("layers").max_rect(rect));
        ui.spacing_mut().button_padding = Vec2::ZERO;
        ui.spacing_mut().interact_size = Vec2::new(step - 2.0, BUTTON);
        for (layer, name) in LAYER_NAMES.iter().enumerate() {
            let left = rect.left() + (FIRST_LAYER + layer) as f32 * step;
            let switches = [(&mut self.soloed[layer], "S", "alone"), (&mut self.muted[layer], "M", "not at all")];
            for (row, (is_on, letter, how)) in switches.into_iter().enumerate() {
                let top = rect.bottom() - (2 - row) as f32 * (BUTTON + 1.0);
                let place = Rect::from_min_size(Pos2::new(left + 1.0, top), Vec2::new(step - 2.0, BUTTON));
                let text = RichText::new(letter).font(theme::small());
                let button = ui.put(place, Button::new(text).selected(*is_on).min_size(place.size()));
                map::note(ui, format_args!("button.{letter} {}", NAMES[FIRST_LAYER + layer]), place);
                let hint = format!("Hear {name} {how}, until the window closes. Not saved, not automated.");
                if button.on_hover_text(hint).clicked() {
                    *is_on = !*is_on;
                }
            }
        }
    }

    fn bars(&mut self, ui: &Ui, rect: Rect, meters: &Meters) {
        let now_s = ui.input(|input| input.time);
        let fall_db = ((now_s - self.last_s).clamp(0.0, 1.0) * FALL_DB_PER_S) as f32;
        self.last_s = now_s;
        let fire = [&meters.low, &meters.extension, &meters.texture, &meters.vortex];
        let fire = fire.into_iter().chain([&meters.crackle, &meters.hiss, &meters.body]);
        let peaks = [&meters.input, &meters.drive].into_iter().chain(fire).chain([&meters.output]);
        let painter = ui.painter();
        let silenced = self.silenced();
        painter.rect_filled(rect, 3.0, theme::WELL);
        let step = rect.width() / NAMES.len() as f32;
        let (top, bottom) = (rect.top() + 18.0, rect.bottom() - 16.0);
        let place =
            |level_db: f32| bottom + (top - bottom) * ((level_db - FLOOR_DB) / (TOP_DB - FLOOR_DB)).clamp(0.0, 1.0);
        for (index, (name, peak)) in NAMES.iter().zip(peaks).enumerate() {
            let shown_db = &mut self.shown_db[index];
            let peak_db = 20.0 * peak.take().max(1e-9).log10();
            *shown_db = peak_db.max(*shown_db - fall_db).clamp(FLOOR_DB, 40.0);
            let middle = rect.left() + (index as f32 + 0.5) * step;
            let bar = |from: f32, to: f32| {
                Rect::from_min_max(Pos2::new(middle - 0.3 * step, to), Pos2::new(middle + 0.3 * step, from))
            };
            painter.rect_filled(bar(bottom, top), 1.0, theme::PANEL);
            let is_silenced = index >= FIRST_LAYER && silenced.get(index - FIRST_LAYER) == Some(&true);
            let color = match index {
                _ if is_silenced => theme::WEAK,
                _ if *shown_db > 0.0 => theme::ALARM,
                0 | 1 => theme::BLUE,
                _ => theme::EMBER,
            };
            painter.rect_filled(bar(bottom, place(*shown_db)), 1.0, color);
            painter.text(Pos2::new(middle, bottom + 2.0), Align2::CENTER_TOP, *name, theme::small(), theme::WEAK);
            if *shown_db > FLOOR_DB {
                let text = format!("{shown_db:.0}");
                painter.text(
                    Pos2::new(middle, rect.top() + 2.0),
                    Align2::CENTER_TOP,
                    text,
                    theme::small(),
                    theme::TEXT,
                );
            }
        }
        let y = place(0.0);
        let line = Rect::from_min_size(Pos2::new(rect.left(), y), Vec2::new(rect.width(), 1.0));
        painter.rect_filled(line, 0.0, theme::TEXT.gamma_multiply(0.2));
    }
}
