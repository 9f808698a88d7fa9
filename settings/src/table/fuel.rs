//! Crackle, hiss and body of a fire without a recording.

use super::base::{CONTROL, float};
use crate::group::Group;
use crate::id::Id;
use crate::parameter::{Parameter, ParameterKind::Choice};

/// Names of the values of `fuel`.
pub const FUELS: &[&str] = pyrophone_synthesis::controls::Fuel::NAMES;

const FUEL: Parameter = Parameter { group: Group::Fuel, ..CONTROL };

/// Rows of the group.
pub const ROWS: &[Parameter] = &[
    Parameter {
        index: Id::Fuel,
        id: "fuel",
        name: "Fuel",
        kind: Choice { names: FUELS, default: 0 },
        help: "Companded mode: fuel whose crackle is made when no recording crackles; it also sets the tone of hiss and body.",
        ..FUEL
    },
    Parameter {
        index: Id::HissTone,
        id: "hiss_tone",
        name: "Hiss tone",
        kind: float(-1.0, 1.0, 0.0, 1.0, 3),
        help: "Pitch of the hiss in octaves around the fuel's own: -1 is dark, 1 bright.",
        ..FUEL
    },
    Parameter {
        index: Id::HissFlutter,
        id: "hiss_flutter",
        name: "Hiss flutter",
        kind: float(0.0, 1.0, 0.5, 1.0, 3),
        help: "Unevenness of the hiss: 0 is steady, 1 comes in spurts.",
        ..FUEL
    },
    Parameter {
        index: Id::BodyTone,
        id: "body_tone",
        name: "Body tone",
        kind: float(-1.0, 1.0, 0.0, 1.0, 3),
        help: "Pitch of the body in octaves around the fuel's own: -1 is a large fire, 1 a small one.",
        ..FUEL
    },
    Parameter {
        index: Id::BodyFlutter,
        id: "body_flutter",
        name: "Body flutter",
        kind: float(0.0, 1.0, 0.5, 1.0, 3),
        help: "Unevenness of the body: 0 is steady, 1 flaps.",
        ..FUEL
    },
    Parameter {
        index: Id::FuelFollow,
        id: "fuel_follow",
        name: "Fuel follow",
        kind: float(0.0, 2.0, 1.0, 1.0, 3),
        help: "Degree to which hiss and body grow louder with the input: 0 keeps them even.",
        ..FUEL
    },
];
