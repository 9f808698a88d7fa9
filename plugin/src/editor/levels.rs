//! Levels of input, drive, layers and output: falling meters, held peaks, solo and mute of the layers.

use crate::meters::Meters;
use crate::probe::LAYERS;

/// The lowest level shown, in dB.
pub const FLOOR_DB: f32 = -72.0;
/// Fall rate of a meter, in dB per second, and hold time of a peak, in seconds.
const FALL_DB_PER_S: f64 = 40.0;
const HOLD_S: f64 = 2.0;

/// Metered signals, in order of display.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meter {
    /// Main input.
    Input,
    /// Drive.
    Drive,
    /// A layer, by its index in the mix.
    Layer(usize),
    /// Output.
    Output,
    /// Sidechain.
    Sidechain,
}

/// Short names of the layers, and their names in full, in the order of the mix.
pub const LAYER_NAMES: [(&str, &str); LAYERS] = [
    ("low", "the low layer"),
    ("ext", "extension"),
    ("tex", "texture"),
    ("vtx", "vortex sound"),
    ("crk", "crackle"),
    ("hiss", "hiss"),
    ("body", "body"),
];

const METERS: usize = LAYERS + 4;

impl Meter {
    /// All except the sidechain, in the order of the signal path.
    pub fn all() -> impl Iterator<Item = Self> {
        [Self::Input, Self::Drive].into_iter().chain((0..LAYERS).map(Self::Layer)).chain([Self::Output])
    }

    /// Its short name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Input => "in",
            Self::Drive => "drive",
            Self::Layer(layer) => LAYER_NAMES.get(layer).map_or("", |(short, _)| short),
            Self::Output => "out",
            Self::Sidechain => "side",
        }
    }

    fn index(self) -> usize {
        match self {
            Self::Input => 0,
            Self::Drive => 1,
            Self::Layer(layer) => 2 + layer.min(LAYERS - 1),
            Self::Output => METERS - 2,
            Self::Sidechain => METERS - 1,
        }
    }
}

/// One meter.
#[derive(Debug, Clone, Copy)]
pub struct Level {
    /// Displayed level with its fall, in dB.
    pub shown_db: f32,
    /// Held peak, in dB.
    pub held_db: f32,
    held_s: f64,
}

impl Default for Level {
    fn default() -> Self {
        Self { shown_db: FLOOR_DB, held_db: FLOOR_DB, held_s: 0.0 }
    }
}

impl Level {
    fn follow(&mut self, magnitude: f32, fall_db: f32, now_s: f64) {
        let level_db = 20.0 * magnitude.max(1e-9).log10();
        self.shown_db = level_db.max(self.shown_db - fall_db).clamp(FLOOR_DB, 60.0);
        if self.shown_db >= self.held_db || now_s - self.held_s > HOLD_S {
            (self.held_db, self.held_s) = (self.shown_db, now_s);
        }
    }
}

/// All meters, and the solo and mute switches of the layers.
#[derive(Debug, Default)]
pub struct Levels {
    meters: [Level; METERS],
    last_s: f64,
    /// True if the output has reached full scale since the lamp was reset.
    has_clipped: bool,
    /// Soloed layers.
    pub soloed: [bool; LAYERS],
    /// Muted layers.
    pub muted: [bool; LAYERS],
}

impl Levels {
    /// Takes over the levels since the last call; `now_s` is the window's clock.
    pub fn follow(&mut self, meters: &Meters, now_s: f64) {
        let fall_db = ((now_s - self.last_s).clamp(0.0, 1.0) * FALL_DB_PER_S) as f32;
        self.last_s = now_s;
        let layers = [&meters.low, &meters.extension, &meters.texture, &meters.vortex];
        let layers = layers.into_iter().chain([&meters.crackle, &meters.hiss, &meters.body]);
        let peaks = [&meters.input, &meters.drive].into_iter().chain(layers).chain([&meters.output, &meters.sidechain]);
        for (level, peak) in self.meters.iter_mut().zip(peaks) {
            let magnitude = peak.take_peak();
            level.follow(magnitude, fall_db, now_s);
            self.has_clipped |= std::ptr::eq(peak, &meters.output) && magnitude >= 1.0;
        }
    }

    /// A meter.
    pub fn get(&self, meter: Meter) -> Level {
        self.meters[meter.index()]
    }

    /// True if the output has reached full scale, until [`forgive`](Self::forgive).
    pub fn has_clipped(&self) -> bool {
        self.has_clipped
    }

    /// Resets the clip lamp.
    pub fn forgive(&mut self) {
        self.has_clipped = false;
    }

    /// Silenced layers: those that are muted, and with a solo all others.
    pub fn silenced(&self) -> [bool; LAYERS] {
        let is_solo = self.soloed.contains(&true);
        std::array::from_fn(|layer| self.muted[layer] || is_solo && !self.soloed[layer])
    }

    /// Clears all solo and mute switches.
    pub fn clear(&mut self) {
        (self.soloed, self.muted) = Default::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_are_held_meters_fall_and_the_clip_lamp_stays_on() {
        let (mut levels, meters) = (Levels::default(), Meters::default());
        meters.output.raise(1.5);
        meters.crackle.raise(0.1);
        levels.follow(&meters, 10.0);
        let crackle = levels.get(Meter::Layer(4));
        assert!((crackle.shown_db + 20.0).abs() < 1e-3 && levels.has_clipped());
        levels.follow(&meters, 10.5);
        let crackle = levels.get(Meter::Layer(4));
        assert!((crackle.shown_db + 40.0).abs() < 1e-3 && (crackle.held_db + 20.0).abs() < 1e-3);
        levels.follow(&meters, 13.0);
        assert_eq!(levels.get(Meter::Layer(4)).held_db, FLOOR_DB);
        assert!(levels.has_clipped(), "until somebody has looked");
        levels.forgive();
        levels.follow(&meters, 14.0);
        assert!(!levels.has_clipped());
    }

    #[test]
    fn a_solo_silences_all_others() {
        let mut levels = Levels::default();
        levels.soloed[1] = true;
        levels.muted[2] = true;
        assert_eq!(levels.silenced(), [true, false, true, true, true, true, true]);
        levels.clear();
        assert_eq!(levels.silenced(), [false; LAYERS]);
    }
}
