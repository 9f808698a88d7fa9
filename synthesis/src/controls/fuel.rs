//! Fuels, and controls of the noise that they make.

/// Fuel whose crackle, hiss and body are made without a recording ([`crate::fuel`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Fuel {
    /// None: nothing crackles but a recording.
    #[default]
    Off,
    /// Seasoned wood.
    DryWood,
    /// Green or damp wood.
    WetWood,
    /// Dry grass and leaves.
    Grass,
    /// Paper and cardboard.
    Paper,
    /// Coal and embers.
    Coal,
}

impl Fuel {
    /// Names in the order of [`ALL`](Self::ALL), to which new ones may only be appended.
    pub const NAMES: &'static [&'static str] = &["off", "dry wood", "wet wood", "grass", "paper", "coal"];
    /// All fuels, in the order of their declaration.
    pub const ALL: [Self; 6] = [Self::Off, Self::DryWood, Self::WetWood, Self::Grass, Self::Paper, Self::Coal];

    /// The fuel at an index of [`NAMES`](Self::NAMES); `Off` beyond its end.
    pub fn from_index(index: usize) -> Self {
        Self::ALL.get(index).copied().unwrap_or_default()
    }

    /// Index among the fuels that burn; none for `Off`.
    pub fn burning_index(self) -> Option<usize> {
        (self as usize).checked_sub(1)
    }
}

/// Controls of the noise of [`crate::fuel`]. Values out of range are clamped; NaN counts as the lowest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FuelControls {
    /// Fuel that decides tone and level.
    pub fuel: Fuel,
    /// Tone of the hiss around the fuel's own: -1 = an octave lower, 1 = an octave higher.
    pub hiss_tone: f64,
    /// Unevenness of the hiss, 0-1: 0 = steady, 1 = in spurts.
    pub hiss_flutter: f64,
    /// Tone of the body around the fuel's own: -1 = an octave lower, 1 = an octave higher.
    pub body_tone: f64,
    /// Unevenness of the body, 0-1: 0 = steady, 1 = flapping.
    pub body_flutter: f64,
    /// Degree to which both follow the drive's loudness: 0 = not at all, 1 = as in a fire, 2 = twice as far in dB.
    pub follow: f64,
    /// Noise seed.
    pub seed: u32,
}

impl Default for FuelControls {
    fn default() -> Self {
        Self {
            fuel: Fuel::Off,
            hiss_tone: 0.0,
            hiss_flutter: 0.5,
            body_tone: 0.0,
            body_flutter: 0.5,
            follow: 1.0,
            seed: 42,
        }
    }
}
