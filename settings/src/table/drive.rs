//! The signal that drives the fire.

use super::base::{CONTROL, float, float_or_off};
use crate::group::Group;
use crate::id::Id;
use crate::parameter::{Parameter, ParameterKind::Choice};

/// Names of the values of `drive_mode`.
pub const DRIVE_MODES: &[&str] = &["pressure", "flux", "envelope", "input envelope", "flame"];

const DRIVE: Parameter = Parameter { group: Group::Drive, ..CONTROL };

/// Rows of the group.
pub const ROWS: &[Parameter] = &[
    Parameter {
        index: Id::DriveMode,
        id: "drive_mode",
        name: "Drive",
        kind: Choice { names: DRIVE_MODES, default: 0 },
        paper: Some(0.0),
        help: "Source that drives the fire: a flame's pressure or flux, the envelope of the sidechain or of the input, or a built-in flame that needs no input.",
        ..DRIVE
    },
    Parameter {
        index: Id::DriveGain,
        id: "drive_gain",
        name: "Drive gain",
        unit: "dB",
        kind: float(-48.0, 48.0, 0.0, 1.0, 2),
        help: "Gain of the input before the engines; matching and fitting follow it.",
        ..DRIVE
    },
    Parameter {
        index: Id::Attack,
        id: "attack",
        name: "Attack",
        unit: "ms",
        kind: float(0.1, 1000.0, 5.0, 0.3, 2),
        help: "Rise time of the envelope.",
        ..DRIVE
    },
    Parameter {
        index: Id::Release,
        id: "release",
        name: "Release",
        unit: "ms",
        kind: float(1.0, 5000.0, 80.0, 0.3, 1),
        help: "Fall time of the envelope.",
        ..DRIVE
    },
    Parameter {
        index: Id::Threshold,
        id: "threshold",
        name: "Threshold",
        unit: "dB",
        kind: float_or_off(-100.0, 0.0, -60.0, 1.0, 1),
        help: "Level below which the envelope is zero.",
        ..DRIVE
    },
    Parameter {
        index: Id::HighPass,
        id: "high_pass",
        name: "High-pass",
        unit: "Hz",
        kind: float_or_off(0.0, 200.0, 5.0, 0.5, 1),
        paper: Some(30.0),
        help: "Removes everything below this frequency ahead of the engines; 0 is off.",
        ..DRIVE
    },
    Parameter {
        index: Id::Averaging,
        id: "averaging",
        name: "Averaging",
        unit: "ms",
        kind: float_or_off(0.0, 100.0, 14.0, 0.4, 1),
        help: "Time over which the drive's envelope averages the sound that it follows; off: it rises by attack and falls by release.",
        ..DRIVE
    },
];
