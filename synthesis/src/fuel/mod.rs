//! Fire without a recording: the crackle, hiss and body of a fuel.
//!
//! ```text
//! fuel ── ruptures, in bursts ── crackles ── the crackle layer ── crackle
//!    ├─── steam and jets: octaves of noise, in spurts ─────────── hiss
//!    └─── turbulent combustion: octaves of noise, flapping ────── body
//! drive's loudness ────────────────────────── rate, levels
//! ```
//!
//! | module | content |
//! |---|---|
//! | `kind` | properties of each fuel |
//! | `draws` | random numbers for material made in advance |
//! | `bursts` | times of ruptures |
//! | `rupture` | sound of one rupture |
//! | `bank` | crackles of all fuels, made once for a sample rate |
//! | `octave` | an octave of noise as a function of position |
//! | `recipe` | differences between hiss and body |
//! | `layer` | one layer of noise |
//! | `noise` | both layers |
//!
//! **Crackle.** Heat turns the water and resin in plant cells to vapour until the tissue ruptures; the sound is a
//! sudden release of pressure, and the piece of fuel that it sets ringing. The band of 6-15 kHz distinguishes species
//! and water content (Yedinak, Anderson, Apostol & Smith 2017, "Vegetation effects on impulsive events in the acoustic
//! signature of fires", J. Acoust. Soc. Am. 141, 557). Energies spread over many decades, as in other crackling noise
//! (Houle & Sethna 1996, "Acoustic emission from crumpling paper", Phys. Rev. E 54, 278): here peaks are log-normal
//! within 40 dB. One rupture relieves its surroundings and starts others, so they come in bursts (a Neyman-Scott
//! process).
//!
//! **Hiss.** Steam leaves pores as small jets, whose noise has a broad hump at a Strouhal number of about 0.2 (Lighthill
//! 1952, "On sound generated aerodynamically", Proc. R. Soc. A 211, 564): 50 m/s through 2 mm give 5 kHz.
//!
//! **Body.** The roar of turbulent flames has a hump at some 100-300 Hz and falls above with frequency to a power of
//! -2.5 (Clavin & Siggia 1991, "Turbulent premixed flames and sound generation", Combust. Sci. Technol. 78, 147) to -3.5
//! (Chadwick & James 2011, §4).
//!
//! The division into lapping, crackling and hissing is Farnell's ("Designing Sound", MIT Press 2010, chapter 34). The
//! properties of the fuels are this project's choice within these sources.

mod bank;
mod bursts;
mod draws;
mod kind;
mod layer;
mod noise;
mod octave;
mod recipe;
mod rupture;

pub use bank::bank;
pub use noise::{FuelNoise, NoiseLevels};

/// Loudness in LUFS of hiss, and of body, at a level of 1 while the drive is at its overall loudness.
pub const LOUDNESS_LUFS: f64 = -32.0;

/// Most that a fuel is raised or lowered towards a loudness, in dB.
const MOST_GAIN_DB: f64 = 40.0;

/// The factor that brings a fuel to a loudness in LUFS, by at most 40 dB; 1 if none is requested.
pub fn gain_to(target_lufs: Option<f64>) -> f64 {
    let gain_db = |target: f64| (target - LOUDNESS_LUFS).clamp(-MOST_GAIN_DB, MOST_GAIN_DB);
    target_lufs.map_or(1.0, |target| maths::pow(10.0, gain_db(target) / 20.0))
}
