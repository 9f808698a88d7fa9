//! Noise above the cutoff.

use super::base::{CONTROL, float};
use crate::group::Group;
use crate::id::Id;
use crate::parameter::{Parameter, ParameterKind::Int};

const EXTENSION: Parameter = Parameter { group: Group::Extension, ..CONTROL };

/// Rows of the group.
pub const ROWS: &[Parameter] = &[
    Parameter {
        index: Id::Alpha,
        id: "alpha",
        name: "Alpha",
        kind: float(0.0, 6.0, 2.5, 1.0, 3),
        paper: Some(2.5),
        help: "Slope of the noise: low values hiss, high values rumble.",
        ..EXTENSION
    },
    Parameter {
        index: Id::Cutoff,
        id: "cutoff",
        name: "Cutoff",
        unit: "Hz",
        kind: float(40.0, 1000.0, 180.0, 0.5, 1),
        paper: Some(180.0),
        help: "Frequency where the input ends and the added noise begins.",
        ..EXTENSION
    },
    Parameter {
        index: Id::BlendWidth,
        id: "blend_width",
        name: "Blend width",
        unit: "Hz",
        kind: float(2.0, 400.0, 30.0, 0.5, 1),
        paper: Some(30.0),
        help: "Width of the band around the cutoff in which the input is blended into the noise.",
        ..EXTENSION
    },
    Parameter {
        index: Id::NoiseAmount,
        id: "noise_amount",
        name: "Noise amount",
        kind: float(0.0, 4.0, 1.0, 1.0, 3),
        paper: Some(1.0),
        help: "Gain factor of the fitted noise: 1 continues the input's spectrum, less is softer, more is harsher.",
        ..EXTENSION
    },
    Parameter {
        index: Id::ExtensionSeed,
        id: "extension_seed",
        name: "Noise seed",
        kind: Int { low: 0, high: 65_535, default: 42 },
        help: "Seed of the noise: another number gives different noise of the same character.",
        ..EXTENSION
    },
    Parameter {
        index: Id::ExtensionWidth,
        id: "extension_width",
        name: "Extension width",
        kind: float(0.0, 1.0, 1.0, 1.0, 3),
        help: "0: the same noise in all channels; 1: independent noise in each.",
        ..EXTENSION
    },
];
