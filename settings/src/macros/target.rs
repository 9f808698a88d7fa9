//! Engine controls that macros can move.

use pyrophone_synthesis::Controls;

/// Application of an offset to a control.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Added, as it is.
    Plain,
    /// A factor, in dB.
    Decibels,
    /// A factor, in powers of two.
    Octaves,
}

impl Unit {
    /// Both limits of an offset, in words.
    pub fn range(self, low: f64, high: f64) -> String {
        match self {
            Self::Plain => format!("{low:+} to {high:+}"),
            Self::Decibels => format!("{low:+} to {high:+} dB"),
            Self::Octaves => format!("×{} to ×{}", rounded(low), rounded(high)),
        }
    }
}

/// Two to this power, with two significant decimals.
fn rounded(octaves: f64) -> f64 {
    let factor = maths::exp2(octaves);
    let decimals = if factor < 0.995 { 100.0 } else { 10.0 };
    (factor * decimals).round() / decimals
}

/// An engine control that a macro moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "each is described by its name")]
pub enum Target {
    Tilt,
    Air,
    Hiss,
    Output,
    Width,
    Swell,
    EnvelopeTimes,
    FlameWind,
    ExtensionSlope,
    Dynamics,
    ScalingAlpha,
    Vortex,
    VortexSpeed,
    VortexRange,
    CrackleDensity,
    CrackleLevel,
    CrackleSharpness,
    CrackleSpread,
    CrackleFollow,
}

impl Target {
    /// Every target, in the order of their numbers.
    pub const ALL: [Self; 19] = [
        Self::Tilt,
        Self::Air,
        Self::Hiss,
        Self::Output,
        Self::Width,
        Self::Swell,
        Self::EnvelopeTimes,
        Self::FlameWind,
        Self::ExtensionSlope,
        Self::Dynamics,
        Self::ScalingAlpha,
        Self::Vortex,
        Self::VortexSpeed,
        Self::VortexRange,
        Self::CrackleDensity,
        Self::CrackleLevel,
        Self::CrackleSharpness,
        Self::CrackleSpread,
        Self::CrackleFollow,
    ];
    /// Number of targets.
    pub const COUNT: usize = Self::ALL.len();

    /// Name within a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tilt => "lows over highs about 700 Hz",
            Self::Air => "above 2.5 kHz",
            Self::Hiss => "above 6 kHz",
            Self::Output => "output",
            Self::Width => "width",
            Self::Swell => "exponent of the flame's swells",
            Self::EnvelopeTimes => "attack, release and averaging",
            Self::FlameWind => "wind",
            Self::ExtensionSlope => "extension's alpha",
            Self::Dynamics => "dynamics",
            Self::ScalingAlpha => "scaling alpha",
            Self::Vortex => "vortex level (from 0 % up it is added, up to 0 dB)",
            Self::VortexSpeed => "vortex speed",
            Self::VortexRange => "vortex range",
            Self::CrackleDensity => "crackle density",
            Self::CrackleLevel => "crackle level",
            Self::CrackleSharpness => "crackle sharpness",
            Self::CrackleSpread => "crackle size spread",
            Self::CrackleFollow => "crackle follow",
        }
    }

    /// Application of its offsets.
    pub fn unit(self) -> Unit {
        match self {
            Self::Tilt | Self::Air | Self::Hiss | Self::Output | Self::CrackleLevel | Self::Vortex => Unit::Decibels,
            Self::EnvelopeTimes | Self::VortexSpeed | Self::CrackleDensity => Unit::Octaves,
            _ => Unit::Plain,
        }
    }

    /// Moves the control by `offset`, within its range.
    pub(super) fn apply(self, offset: f64, controls: &mut Controls) {
        let add = |value: &mut f64, low: f64, high: f64| *value = (*value + offset).clamp(low, high);
        let Controls { drive, extend, texture, vortex, crackle, fuel: _, mix } = controls;
        match self {
            Self::Tilt => {
                mix.tone.low *= factor(0.5 * offset);
                mix.tone.high *= factor(-0.5 * offset);
            }
            Self::Air => mix.tone.air *= factor(offset),
            Self::Hiss => mix.tone.hiss *= factor(offset),
            Self::Output => mix.output *= factor(offset),
            Self::Width => {
                add(&mut mix.width, 0.0, 1.0);
                add(&mut extend.width, 0.0, 1.0);
            }
            Self::Swell => drive.swell += offset,
            Self::EnvelopeTimes => {
                drive.averaging_s = (drive.averaging_s * maths::exp2(offset)).min(1.0);
                for (attack_s, release_s) in
                    [(&mut drive.attack_s, &mut drive.release_s), (&mut vortex.attack_s, &mut vortex.release_s)]
                {
                    *attack_s = (*attack_s * maths::exp2(offset)).clamp(1e-4, 1.0);
                    *release_s = (*release_s * maths::exp2(offset)).clamp(1e-3, 5.0);
                }
            }
            Self::FlameWind => add(&mut drive.flame.wind, 0.0, 1.0),
            Self::ExtensionSlope => add(&mut extend.alpha, 0.0, 6.0),
            Self::Dynamics => add(&mut texture.companding.dynamics, 0.0, 1.0),
            Self::ScalingAlpha => add(&mut texture.scaling_alpha, 0.0, 1.0),
            // Turned up it is added instead, so that it is audible even if the layer was off.
            Self::Vortex => mix.vortex *= factor(offset.min(0.0)),
            Self::VortexSpeed => {
                vortex.speed_m_s *= maths::exp2(offset);
                vortex.field_speed *= maths::exp2(offset);
            }
            Self::VortexRange => add(&mut vortex.range, 0.0, 1.0),
            Self::CrackleDensity => crackle.density = (crackle.density * maths::exp2(offset)).clamp(0.0, 4.0),
            Self::CrackleLevel => mix.crackle *= factor(offset),
            Self::CrackleSharpness => add(&mut crackle.sharpness, -1.0, 1.0),
            Self::CrackleSpread => add(&mut crackle.spread, 0.0, 2.0),
            Self::CrackleFollow => add(&mut crackle.follow, 0.0, 2.0),
        }
    }
}

/// Level of vortex sound that Whoosh adds when turned up by `amount`, -1 to 1: none at 0, 0 dB at 1, without a step.
pub(super) fn added_vortex(amount: f64) -> f64 {
    maths::square(amount.max(0.0))
}

fn factor(db: f64) -> f64 {
    maths::pow(10.0, db / 20.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn targets_are_numbered_in_order() {
        for (number, target) in Target::ALL.into_iter().enumerate() {
            assert_eq!(target as usize, number, "{}", target.name());
        }
    }

    #[test]
    fn ranges_are_told_in_their_units() {
        assert_eq!(Unit::Decibels.range(-6.0, 4.5), "-6 to +4.5 dB");
        assert_eq!(Unit::Plain.range(0.4, -0.4), "+0.4 to -0.4");
        assert_eq!(Unit::Octaves.range(-4.0, 2.0), "×0.06 to ×4");
    }
}
