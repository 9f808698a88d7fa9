//! Differences between hiss and body.

use super::kind::{Tone, tones};
use crate::controls::FuelControls;
use crate::error::within;

/// The layers of noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoiseKind {
    Hiss,
    Body,
}

/// Recipe of a layer.
#[derive(Debug)]
pub(super) struct Recipe {
    /// Middles of the octaves in Hz.
    pub octaves_hz: &'static [f64],
    /// Exponents of the amplitude of octaves over frequency, below the hump and above.
    pub slopes: [f64; 2],
    /// Share of the power that all channels have in common.
    pub common: f64,
    /// Fastest changes of the unevenness in Hz, and its depth in nepers at a flutter of 1.
    pub flutter_hz: [f64; 2],
    pub flutter_nepers: f64,
    /// Exponent of the drive's loudness.
    pub exponent: f64,
    /// Root mean square at a level of 1, for the loudness that [`LOUDNESS_LUFS`](super::LOUDNESS_LUFS) states.
    pub rms: f64,
    /// First of its white-noise streams, which no other stage uses.
    pub stream: u32,
}

/// A jet's power spectrum rises with the square of frequency and falls with its inverse square; an octave has one more
/// power of frequency. Steam comes from many places, so channels have little in common.
const HISS: Recipe = Recipe {
    octaves_hz: &[1400.0, 2800.0, 5600.0, 11_200.0],
    slopes: [1.5, -0.5],
    common: 0.3,
    flutter_hz: [3.0, 17.0],
    flutter_nepers: 1.2,
    exponent: 0.5,
    rms: 0.0174,
    stream: 0x4846_0000,
};

/// Power falls by f^-3.5, at the steep end of the range for flames, as in the beds of recorded wood fires; an octave's
/// amplitude then falls by f^-1.25.
const BODY: Recipe = Recipe {
    octaves_hz: &[55.0, 110.0, 220.0, 440.0, 880.0, 1760.0],
    slopes: [1.0, -1.25],
    common: 0.6,
    flutter_hz: [4.0, 11.0],
    flutter_nepers: 0.6,
    exponent: 0.77,
    rms: 0.0279,
    stream: 0x4846_0200,
};

impl NoiseKind {
    pub fn recipe(self) -> &'static Recipe {
        match self {
            Self::Hiss => &HISS,
            Self::Body => &BODY,
        }
    }

    /// Depth of the unevenness in nepers.
    pub fn flutter_nepers(self, controls: &FuelControls) -> f64 {
        let flutter = match self {
            Self::Hiss => controls.hiss_flutter,
            Self::Body => controls.body_flutter,
        };
        within(flutter, 0.0, 1.0) * self.recipe().flutter_nepers
    }

    /// Frequency in Hz of the hump, and the root mean square at a level of 1.
    pub fn hump(self, controls: &FuelControls) -> (f64, f64) {
        let [hiss, body] = tones(controls.fuel);
        let (Tone { hump_hz, level_db }, shift) = match self {
            Self::Hiss => (hiss, controls.hiss_tone),
            Self::Body => (body, controls.body_tone),
        };
        (hump_hz * maths::exp2(within(shift, -1.0, 1.0)), self.recipe().rms * maths::pow(10.0, level_db / 20.0))
    }
}
