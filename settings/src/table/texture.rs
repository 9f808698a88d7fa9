//! Fire matched from recordings.

use super::base::{CONTROL, float, float_or_off};
use crate::group::Group;
use crate::id::Id;
use crate::parameter::{
    Parameter,
    ParameterKind::{Choice, Toggle},
};

/// Names of the values of `dynamic_range`.
pub const DYNAMIC_RANGES: &[&str] = &["off", "learned", "running"];

/// Names of the values of `quality`.
pub const QUALITIES: &[&str] = &["draft", "normal", "high", "exact"];

/// Names of the values of `recording_slot` and `recording_second`.
pub const RECORDING_SLOTS: &[&str] = &["1", "2", "3", "4"];

const TEXTURE: Parameter = Parameter { group: Group::Texture, ..CONTROL };

/// Rows of the group.
pub const ROWS: &[Parameter] = &[
    Parameter {
        index: Id::ScalingAlpha,
        id: "scaling_alpha",
        name: "Scaling alpha",
        kind: float(0.0, 1.0, 0.0, 1.0, 3),
        paper: Some(1.0),
        help: "Degree to which the loudness of single windows is mapped onto the input's, as in the paper; high values can buzz.",
        ..TEXTURE
    },
    Parameter {
        index: Id::DynamicRange,
        id: "dynamic_range",
        name: "Dynamic range",
        kind: Choice { names: DYNAMIC_RANGES, default: 2 },
        paper: Some(1.0),
        help: "Source of the input's loudness range: off (not mapped), learned beforehand, or estimated during playback.",
        ..TEXTURE
    },
    Parameter {
        index: Id::Gate,
        id: "gate",
        name: "Gate",
        kind: Toggle { default: true },
        paper: Some(0.0),
        help: "Silences the texture while the input is silent; without it the recording's quietest moment plays on.",
        ..TEXTURE
    },
    Parameter {
        index: Id::GateThreshold,
        id: "gate_threshold",
        name: "Gate threshold",
        unit: "dB",
        kind: float(-120.0, -20.0, -80.0, 1.0, 1),
        help: "Level of the input below which the gate closes.",
        ..TEXTURE
    },
    Parameter {
        index: Id::Quality,
        id: "quality",
        name: "Quality",
        kind: Choice { names: QUALITIES, default: 1 },
        paper: Some(3.0),
        help: "Effort of each search: draft, normal and high compare 256, 1024 and 4096 candidates, exact as many as it needs.",
        ..TEXTURE
    },
    Parameter {
        index: Id::TextureWidth,
        id: "texture_width",
        name: "Texture width",
        kind: float(0.0, 1.0, 1.0, 1.0, 3),
        help: "0: the texture in mono; 1: as wide as it was recorded.",
        ..TEXTURE
    },
    Parameter {
        index: Id::Dynamics,
        id: "dynamics",
        name: "Dynamics",
        kind: float(0.0, 1.0, 0.77, 1.0, 3),
        help: "Companded mode: 0 keeps the recording's own swells, 1 leaves only the input's.",
        ..TEXTURE
    },
    Parameter {
        index: Id::DriveMatch,
        id: "drive_match",
        name: "Drive match",
        unit: "dB",
        kind: float(-24.0, 24.0, 0.0, 1.0, 2),
        help: "Companded mode: loudness of the parts of the recording that are sought for the input; high values find its bursts.",
        ..TEXTURE
    },
    Parameter {
        index: Id::LowEnd,
        id: "low_end",
        name: "Low end",
        unit: "Hz",
        kind: float_or_off(0.0, 400.0, 150.0, 0.5, 1),
        paper: Some(0.0),
        help: "Companded mode: below this frequency the input itself is heard in place of texture; 0 is off.",
        ..TEXTURE
    },
    Parameter {
        index: Id::SpectrumMatch,
        id: "spectrum_match",
        name: "Spectrum match",
        kind: float(0.0, 1.0, 0.75, 1.0, 3),
        paper: Some(0.0),
        help: "Companded mode: degree to which the output's spectrum is matched to the recording's.",
        ..TEXTURE
    },
    Parameter {
        index: Id::ScalingAuto,
        id: "scaling_auto",
        name: "Scaling auto",
        kind: Toggle { default: false },
        paper: Some(0.0),
        help: "Turns Scaling alpha down by itself while the texture buzzes, and slowly up again.",
        ..TEXTURE
    },
    Parameter {
        index: Id::RecordingSlot,
        id: "recording_slot",
        name: "Recording slot",
        kind: Choice { names: RECORDING_SLOTS, default: 0 },
        help: "Slot of the recording that texture and crackle are made from; a change takes effect within 50 ms.",
        ..TEXTURE
    },
    Parameter {
        index: Id::RecordingSecond,
        id: "recording_second",
        name: "Second recording",
        kind: Choice { names: RECORDING_SLOTS, default: 1 },
        help: "Slot of a second recording, which is mixed in by the recording blend.",
        ..TEXTURE
    },
    Parameter {
        index: Id::RecordingBlend,
        id: "recording_blend",
        name: "Recording blend",
        unit: "%",
        kind: float(0.0, 100.0, 0.0, 1.0, 1),
        help: "Share of the second recording: the proportion of texture windows taken from it, and of its crackles that are heard.",
        ..TEXTURE
    },
];
