//! Controls of crackle.

use super::fuel::Fuel;

/// Controls of [`crate::crackle`]. Values out of range are clamped; NaN counts as the lowest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrackleControls {
    /// Slot of the recording that crackles.
    pub slot: usize,
    /// Fuel that crackles if no recording does.
    pub fuel: Fuel,
    /// Crackles relative to the recording's, 0-4.
    pub density: f64,
    /// -1 = dull, 0 = as recorded, 1 = bright and short.
    pub sharpness: f64,
    /// Exponent of the distance of the crackles' levels from their median: 0 = all alike, 1 = as recorded, 2 = twice as
    /// far in dB.
    pub spread: f64,
    /// Degree to which density and level follow the drive's loudness: 0 = not at all, 1 = as in a fire, 2 = twice as
    /// far in dB.
    pub follow: f64,
    /// Seed of their order and variation.
    pub seed: u32,
    /// Highest peak of a crackle, as an amplitude: louder ones are turned down as wholes. [`crate::chain::Chain`] lowers it so
    /// that none reaches the ceiling.
    pub highest_peak: f64,
}

impl Default for CrackleControls {
    fn default() -> Self {
        Self {
            slot: 0,
            fuel: Fuel::Off,
            density: 1.0,
            sharpness: 0.0,
            spread: 1.0,
            follow: 1.0,
            seed: 42,
            highest_peak: f64::INFINITY,
        }
    }
}
