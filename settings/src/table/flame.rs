//! The built-in flame.

use super::base::{CONTROL, float};
use crate::group::Group;
use crate::id::Id;
use crate::parameter::{Parameter, ParameterKind::Choice};

/// Names of the values of `flame_scene`.
pub const FLAME_SCENES: &[&str] = pyrophone_synthesis::drive::SCENES;

const FLAME: Parameter = Parameter { group: Group::Flame, ..CONTROL };

/// Rows of the group.
pub const ROWS: &[Parameter] = &[
    Parameter {
        index: Id::FlameScene,
        id: "flame_scene",
        name: "Scene",
        kind: Choice { names: FLAME_SCENES, default: 5 },
        help: "Drive flame: the simulated scene that burns, in a seamless loop.",
        ..FLAME
    },
    Parameter {
        index: Id::FlameIntensity,
        id: "flame_intensity",
        name: "Intensity",
        kind: float(0.0, 2.0, 1.0, 1.0, 3),
        help: "Drive flame: amount of fire; 0 is out, 2 is twice as much as designed.",
        ..FLAME
    },
    Parameter {
        index: Id::FlameWind,
        id: "flame_wind",
        name: "Wind",
        kind: float(0.0, 1.0, 0.0, 1.0, 3),
        help: "Drive flame: wind, turbulence and motion of the flame, in addition to the scene's own; 1 is twice as much.",
        ..FLAME
    },
    Parameter {
        index: Id::FlameOffset,
        id: "flame_offset",
        name: "Offset",
        unit: "s",
        kind: float(0.0, 10.0, 0.0, 1.0, 3),
        help: "Drive flame: the moment of the scene at the timeline's start; two flames side by side need different ones.",
        ..FLAME
    },
];
