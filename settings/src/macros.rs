//! The eight macros: one table that engine, window and manual share.
//!
//! A macro moves several engine controls at once, as an offset: the parameters behind them keep the values set by user
//! and host. At 0 % it changes nothing, bit for bit. An effect is a straight line, in its own unit, from nothing at 0 %
//! to the limits that the table states for -100 % and 100 %. Effects of several macros on one control add up, within
//! the control's range.

mod target;

pub use target::{Target, Unit};

use pyrophone_synthesis::Controls;

use crate::{Id, Values};

/// One line of the [table](MACROS).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Macro {
    /// Its parameter, -100 % to 100 %.
    pub id: Id,
    /// Short name, without the word "macro".
    pub name: &'static str,
    /// Measure that rises as the macro is turned up.
    pub figure: &'static str,
    /// Effects on the engine controls.
    pub effects: &'static [Effect],
}

/// Effect of a macro on one engine control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// The control.
    pub target: Target,
    /// Offset at -100 %, in the target's unit.
    pub low: f64,
    /// Offset at 100 %.
    pub high: f64,
}

const fn effect(target: Target, low: f64, high: f64) -> Effect {
    Effect { target, low, high }
}

/// All macros, in display order.
pub const MACROS: &[Macro] = &[
    Macro {
        id: Id::MacroSize,
        name: "Size",
        figure: "low end: the spectrum's centroid falls",
        effects: &[
            effect(Target::Tilt, -12.0, 12.0),
            effect(Target::CrackleSharpness, 0.0, -0.4),
            effect(Target::CrackleSpread, 0.0, 0.3),
            effect(Target::VortexSpeed, 0.4, -0.4),
            effect(Target::EnvelopeTimes, -1.0, 1.0),
        ],
    },
    Macro {
        id: Id::MacroFury,
        name: "Fury",
        figure: "variance of the level",
        effects: &[
            effect(Target::Swell, -0.8, 1.0),
            effect(Target::VortexRange, -0.3, 0.3),
            effect(Target::FlameWind, -0.5, 0.5),
        ],
    },
    Macro {
        id: Id::MacroCrackle,
        name: "Crackle",
        figure: "crackles per second",
        effects: &[effect(Target::CrackleDensity, -4.0, 2.0), effect(Target::CrackleLevel, -9.0, 3.0)],
    },
    Macro {
        id: Id::MacroSharpness,
        name: "Sharpness",
        figure: "kurtosis above 4 kHz",
        effects: &[
            effect(Target::CrackleSharpness, -1.0, 1.0),
            effect(Target::CrackleSpread, -0.5, 0.5),
            effect(Target::CrackleLevel, -6.0, 4.0),
        ],
    },
    Macro {
        id: Id::MacroHiss,
        name: "Hiss",
        figure: "share of 6 to 16 kHz in the sound",
        effects: &[effect(Target::Hiss, -15.0, 12.0), effect(Target::ExtensionSlope, 0.5, -0.5)],
    },
    Macro {
        id: Id::MacroWhoosh,
        name: "Whoosh",
        figure: "share of vortex sound",
        effects: &[effect(Target::Vortex, -36.0, 0.0), effect(Target::VortexSpeed, -0.3, 0.3)],
    },
    Macro {
        id: Id::MacroTightness,
        name: "Tightness",
        figure: "correlation of the level with the flame's",
        effects: &[
            effect(Target::Dynamics, -0.6, 0.25),
            effect(Target::ScalingAlpha, -0.5, 0.3),
            effect(Target::CrackleFollow, -0.8, 0.6),
            effect(Target::EnvelopeTimes, 1.5, -1.5),
        ],
    },
    Macro {
        id: Id::MacroDistance,
        name: "Distance",
        figure: "distance: softer, duller and narrower",
        effects: &[
            effect(Target::Output, 6.0, -18.0),
            effect(Target::Air, 3.0, -18.0),
            effect(Target::Width, 0.0, -0.7),
        ],
    },
];

impl Effect {
    /// The offset at `amount`, -1 to 1.
    pub fn offset(&self, amount: f64) -> f64 {
        amount.abs() * if amount < 0.0 { self.low } else { self.high }
    }
}

impl Macro {
    /// The macro of a parameter.
    pub fn of_id(id: Id) -> Option<&'static Self> {
        MACROS.iter().find(|line| line.id == id)
    }

    /// Effects in words: `tilt -12 to 12 dB, ...`.
    pub fn effects_in_words(&self) -> String {
        let words = self.effects.iter().map(|effect| {
            let (target, unit) = (effect.target, effect.target.unit());
            format!("{} {}", target.name(), unit.range(effect.low, effect.high))
        });
        words.collect::<Vec<_>>().join(", ")
    }
}

/// Moves `controls` by the macros' offsets.
pub(crate) fn apply(values: &Values, controls: &mut Controls) {
    let mut offsets = [0.0; Target::COUNT];
    let mut is_neutral = true;
    for line in MACROS {
        let amount = values.get(line.id) / 100.0;
        if amount != 0.0 {
            is_neutral = false;
            for effect in line.effects {
                offsets[effect.target as usize] += effect.offset(amount);
            }
        }
    }
    if is_neutral {
        return;
    }
    for target in Target::ALL {
        let offset = offsets[target as usize];
        if offset != 0.0 {
            target.apply(offset, controls);
        }
    }
    let whoosh = values.get(Id::MacroWhoosh) / 100.0;
    controls.mix.vortex += target::added_vortex(whoosh);
}
