//! A recording's crackles.

use super::base::{CONTROL, float};
use crate::group::Group;
use crate::id::Id;
use crate::parameter::{Parameter, ParameterKind::Int};

const CRACKLE: Parameter = Parameter { group: Group::Crackle, ..CONTROL };

/// Rows of the group.
pub const ROWS: &[Parameter] = &[
    Parameter {
        index: Id::CrackleDensity,
        id: "crackle_density",
        name: "Density",
        kind: float(0.0, 4.0, 1.0, 0.5, 3),
        help: "Number of crackles: 1 as many as in the recording, 2 twice as many.",
        ..CRACKLE
    },
    Parameter {
        index: Id::CrackleSharpness,
        id: "crackle_sharpness",
        name: "Sharpness",
        kind: float(-1.0, 1.0, 0.0, 1.0, 3),
        help: "Tone of crackles: -1 is dull, 0 as recorded, 1 bright and short.",
        ..CRACKLE
    },
    Parameter {
        index: Id::CrackleSpread,
        id: "crackle_spread",
        name: "Size spread",
        kind: float(0.0, 2.0, 1.0, 1.0, 3),
        help: "Difference between small and large crackles: 0 makes all alike, 1 is as recorded, 2 doubles it in decibels.",
        ..CRACKLE
    },
    Parameter {
        index: Id::CrackleFollow,
        id: "crackle_follow",
        name: "Follow",
        kind: float(0.0, 2.0, 1.0, 1.0, 3),
        help: "Degree to which crackles become more frequent and louder with the input: 0 keeps them even.",
        ..CRACKLE
    },
    Parameter {
        index: Id::CrackleSeed,
        id: "crackle_seed",
        name: "Seed",
        kind: Int { low: 0, high: 65_535, default: 42 },
        help: "Seed of the crackles: another number plays the same crackles in a different order.",
        ..CRACKLE
    },
];
