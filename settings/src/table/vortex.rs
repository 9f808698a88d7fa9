//! The sound of turbulent gas.

use super::base::{CONTROL, float};
use crate::group::Group;
use crate::id::Id;
use crate::parameter::{
    Parameter,
    ParameterKind::{Choice, Int},
};

/// Names of the values of `vortex_texture`.
pub const VORTEX_TEXTURES: &[&str] = &pyrophone_synthesis::vortex::TEXTURES;

/// Names of the values of `vortex_flow`.
pub const VORTEX_FLOWS: &[&str] = &["envelope", "field", "live"];

const VORTEX: Parameter = Parameter { group: Group::Vortex, ..CONTROL };

/// Rows of the group.
pub const ROWS: &[Parameter] = &[
    Parameter {
        index: Id::VortexTexture,
        id: "vortex_texture",
        name: "Gas",
        kind: Choice { names: VORTEX_TEXTURES, default: 0 },
        help: "Source of the whoosh: hot gas rising from a fire, or a jet.",
        ..VORTEX
    },
    Parameter {
        index: Id::VortexFlow,
        id: "vortex_flow",
        name: "Flow",
        kind: Choice { names: VORTEX_FLOWS, default: 0 },
        help: "Source of the gas's speed: the input's loudness (envelope), a flame's simulated motion (field), or gas simulated during playback and driven by the input (live).",
        ..VORTEX
    },
    Parameter {
        index: Id::VortexSpeed,
        id: "vortex_speed",
        name: "Speed",
        unit: "m/s",
        kind: float(0.0, 40.0, 16.0, 0.5, 2),
        help: "Speed of the gas for an input at full scale: faster is louder and brighter. With a field, 16 m/s is the field's own speed.",
        ..VORTEX
    },
    Parameter {
        index: Id::VortexCurve,
        id: "vortex_curve",
        name: "Curve",
        kind: float(0.1, 4.0, 0.4, 0.5, 3),
        help: "Relation of speed to loudness: low values whoosh in soft passages too, high ones in the loudest only.",
        ..VORTEX
    },
    Parameter {
        index: Id::VortexRange,
        id: "vortex_range",
        name: "Range",
        kind: float(0.0, 1.0, 0.5, 1.0, 3),
        help: "Degree to which fast gas is louder than slow gas: 1 as in nature, which is a lot; 0 not at all.",
        ..VORTEX
    },
    Parameter {
        index: Id::VortexVariation,
        id: "vortex_variation",
        name: "Variation",
        kind: float(0.0, 1.0, 0.25, 1.0, 3),
        help: "Spread of the speeds of the sources.",
        ..VORTEX
    },
    Parameter {
        index: Id::VortexSources,
        id: "vortex_sources",
        name: "Sources",
        kind: Int { low: 1, high: 500, default: 64 },
        help: "Number of sounding regions of gas: few flutter, many roar; doubling them adds 3 dB.",
        ..VORTEX
    },
    Parameter {
        index: Id::VortexDistance,
        id: "vortex_distance",
        name: "Distance",
        unit: "m",
        kind: float(0.0, 100.0, 3.0, 0.4, 2),
        help: "Distance from the listener to the centre of the gas; changing it shifts the pitch (Doppler).",
        ..VORTEX
    },
    Parameter {
        index: Id::VortexSpread,
        id: "vortex_spread",
        name: "Spread",
        unit: "m",
        kind: float(0.0, 20.0, 1.0, 0.5, 2),
        help: "Radius of the ball of gas: larger ones fill more of the space around their direction.",
        ..VORTEX
    },
    Parameter {
        index: Id::VortexAzimuth,
        id: "vortex_azimuth",
        name: "Azimuth",
        unit: "°",
        kind: float(-180.0, 180.0, 0.0, 1.0, 1),
        help: "Direction of the gas: 0 ahead, 90 to the right, -90 to the left, 180 behind.",
        ..VORTEX
    },
    Parameter {
        index: Id::VortexElevation,
        id: "vortex_elevation",
        name: "Elevation",
        unit: "°",
        kind: float(-90.0, 90.0, 0.0, 1.0, 1),
        help: "Elevation of the gas: 0 level, 90 overhead.",
        ..VORTEX
    },
    Parameter {
        index: Id::VortexFalloff,
        id: "vortex_falloff",
        name: "Vortex falloff",
        kind: float(1.0, 3.0, 1.0, 1.0, 3),
        help: "Exponent of the attenuation with distance: 1 as in nature, 3 as printed in Dobashi's paper.",
        ..VORTEX
    },
    Parameter {
        index: Id::VortexLimit,
        id: "vortex_limit",
        name: "Limit",
        unit: "dB",
        kind: float(-48.0, 24.0, 24.0, 1.0, 1),
        help: "Soft-clips the layer at this level, before its own level control, as a microphone overloads near an explosion.",
        ..VORTEX
    },
    Parameter {
        index: Id::VortexSeed,
        id: "vortex_seed",
        name: "Vortex seed",
        kind: Int { low: 0, high: 65_535, default: 42 },
        help: "Seed of the sources: another number places and times them differently.",
        ..VORTEX
    },
];
