//! What rows have in common.

use crate::group::Group;
use crate::id::Id;
use crate::parameter::{Parameter, ParameterKind};

/// Basis of every row: a parameter that may change during playback, without unit or value in the paper.
pub const CONTROL: Parameter = Parameter {
    index: Id::LowLevel,
    id: "",
    name: "",
    group: Group::Levels,
    unit: "",
    kind: ParameterKind::Toggle { default: false },
    automatable: true,
    structure: false,
    paper: None,
    help: "",
};

/// A continuous value.
pub const fn float(low: f64, high: f64, default: f64, skew: f64, decimals: u32) -> ParameterKind {
    ParameterKind::Float { low, high, default, skew, decimals, off_at_low: false }
}

/// A continuous value whose lowest means "off".
pub const fn float_or_off(low: f64, high: f64, default: f64, skew: f64, decimals: u32) -> ParameterKind {
    ParameterKind::Float { low, high, default, skew, decimals, off_at_low: true }
}

/// Level of a layer, in dB.
pub const fn level(default: f64) -> ParameterKind {
    float_or_off(-72.0, 24.0, default, 1.0, 2)
}
