//! Levels of the layers and of the output, and what protects it.

use super::base::{CONTROL, float_or_off, level};
use crate::group::Group;
use crate::id::Id;
use crate::parameter::{Parameter, ParameterKind::Toggle};

const LEVELS: Parameter = Parameter { group: Group::Levels, ..CONTROL };

/// Rows of the group.
pub const ROWS: &[Parameter] = &[
    Parameter {
        index: Id::LowLevel,
        id: "low_level",
        name: "Low level",
        unit: "dB",
        kind: level(-72.0),
        help: "Level of the flame's own low-frequency part.",
        ..LEVELS
    },
    Parameter {
        index: Id::ExtensionLevel,
        id: "extension_level",
        name: "Extension level",
        unit: "dB",
        kind: level(-72.0),
        help: "Level of the noise that spectral extension adds above the cutoff.",
        ..LEVELS
    },
    Parameter {
        index: Id::TextureLevel,
        id: "texture_level",
        name: "Texture level",
        unit: "dB",
        kind: level(0.0),
        help: "Level of the fire matched from the recording.",
        ..LEVELS
    },
    Parameter {
        index: Id::OutputLevel,
        id: "output_level",
        name: "Output level",
        unit: "dB",
        kind: level(0.0),
        help: "Level of the whole output.",
        ..LEVELS
    },
    Parameter {
        index: Id::Bypass,
        id: "bypass",
        name: "Bypass",
        kind: Toggle { default: false },
        help: "Passes the input through unchanged, delayed by the latency.",
        ..LEVELS
    },
    Parameter {
        index: Id::VortexLevel,
        id: "vortex_level",
        name: "Vortex level",
        unit: "dB",
        kind: level(-72.0),
        help: "Level of the whoosh: the sound that turbulent gas makes without burning.",
        ..LEVELS
    },
    Parameter {
        index: Id::CrackleLevel,
        id: "crackle_level",
        name: "Crackle level",
        unit: "dB",
        kind: level(0.0),
        help: "Companded mode: level of the recording's crackles, which are separated and played alongside the texture.",
        ..LEVELS
    },
    Parameter {
        index: Id::Ceiling,
        id: "ceiling",
        name: "Ceiling",
        kind: Toggle { default: true },
        paper: Some(0.0),
        help: "Keeps the output below full scale: soft-clips peaks above -1 dBFS and changes nothing else.",
        ..LEVELS
    },
    Parameter {
        index: Id::Loudness,
        id: "loudness",
        name: "Loudness",
        unit: "LUFS",
        kind: float_or_off(-60.0, -6.0, -32.0, 1.0, 1),
        help: "Companded mode: loudness to which every recording is adjusted; off keeps the recording's own.",
        ..LEVELS
    },
    Parameter {
        index: Id::HissLevel,
        id: "hiss_level",
        name: "Hiss level",
        unit: "dB",
        kind: level(-72.0),
        help: "Companded mode: level of the hiss of steam and small jets of gas, made without a recording.",
        ..LEVELS
    },
    Parameter {
        index: Id::BodyLevel,
        id: "body_level",
        name: "Body level",
        unit: "dB",
        kind: level(-72.0),
        help: "Companded mode: level of the roar of the flames, made without a recording.",
        ..LEVELS
    },
];
