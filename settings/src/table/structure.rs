//! Sizes of the engines and of dictionaries: they decide the latency, so they are fixed during playback.

use super::base::{CONTROL, float};
use crate::group::Group;
use crate::id::Id;
use crate::parameter::{
    Parameter,
    ParameterKind::{Choice, Int},
};

/// Names of the values of `dynamics_mode`.
pub const DYNAMICS_MODES: &[&str] = &["paper", "companded"];

const STRUCTURE: Parameter = Parameter { group: Group::Structure, automatable: false, structure: true, ..CONTROL };

/// Rows of the group.
pub const ROWS: &[Parameter] = &[
    Parameter {
        index: Id::Levels,
        id: "levels",
        name: "Pyramid levels",
        kind: Int { low: 3, high: 8, default: 6 },
        paper: Some(6.0),
        help: "Levels of the texture pyramid: more follow the input in a lower, slower band.",
        ..STRUCTURE
    },
    Parameter {
        index: Id::Window,
        id: "window",
        name: "Window",
        unit: "samples",
        kind: Int { low: 2, high: 16, default: 4 },
        paper: Some(4.0),
        help: "Half-width of a texture window: longer ones keep more of the recording together.",
        ..STRUCTURE
    },
    Parameter {
        index: Id::Feature,
        id: "feature",
        name: "Feature",
        unit: "windows",
        kind: Int { low: 1, high: 6, default: 3 },
        paper: Some(3.0),
        help: "Number of windows to each side that a search compares: more is smoother, fewer follow more closely.",
        ..STRUCTURE
    },
    Parameter {
        index: Id::Falloff,
        id: "falloff",
        name: "Falloff",
        kind: float(0.0, 1.0, 0.025, 1.0, 3),
        paper: Some(0.0),
        help: "Degree to which distant samples count less in a search.",
        ..STRUCTURE
    },
    Parameter {
        index: Id::HalfWidth,
        id: "half_width",
        name: "Half-width",
        unit: "samples",
        kind: Int { low: 100, high: 2000, default: 500 },
        paper: Some(500.0),
        help: "Half-width of an extension window, at 44.1 kHz: shorter ones follow the input faster.",
        ..STRUCTURE
    },
    Parameter {
        index: Id::FitWidth,
        id: "fit_width",
        name: "Fit width",
        unit: "Hz",
        kind: float(3.0, 120.0, 30.0, 1.0, 1),
        paper: Some(30.0),
        help: "Width of the band around the cutoff in which the noise's level is fitted.",
        ..STRUCTURE
    },
    Parameter {
        index: Id::DynamicsMode,
        id: "dynamics_mode",
        name: "Dynamics mode",
        kind: Choice { names: DYNAMICS_MODES, default: 1 },
        paper: Some(0.0),
        help: "Companded: matched without slow loudness changes, which are then restored from the input; paper: matched at its own loudness.",
        ..STRUCTURE
    },
];
