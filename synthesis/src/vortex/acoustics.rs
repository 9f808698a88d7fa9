//! Constants of sound in air.

/// Speed of sound in m/s.
pub const SPEED_OF_SOUND_M_S: f64 = 343.0;

/// Radius in m of the near field: pressure falls with sqrt(r^2 + `NEAR_M`^2) instead of r, so that it stays finite at
/// the source. From 2 m on that is less than 0.07 dB.
pub const NEAR_M: f64 = 0.25;
