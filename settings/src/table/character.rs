//! The fire as a whole: macros and takes.

use super::base::{CONTROL, float};
use crate::group::Group;
use crate::id::Id;
use crate::parameter::{Parameter, ParameterKind::Int};

const CHARACTER: Parameter = Parameter { group: Group::Character, ..CONTROL };
const MACRO: Parameter = Parameter { unit: "%", kind: float(-100.0, 100.0, 0.0, 1.0, 1), ..CHARACTER };

/// Rows of the group.
pub const ROWS: &[Parameter] = &[
    Parameter {
        index: Id::MacroSize,
        id: "macro_size",
        name: "Macro: Size",
        help: "Size of the fire: large ones are deeper and slower. 0 % changes nothing.",
        ..MACRO
    },
    Parameter {
        index: Id::MacroFury,
        id: "macro_fury",
        name: "Macro: Fury",
        help: "Wildness of the fire: the swing of its loudness. 0 % changes nothing.",
        ..MACRO
    },
    Parameter {
        index: Id::MacroCrackle,
        id: "macro_crackle",
        name: "Macro: Crackle",
        help: "Amount of crackling: number and level of crackles. 0 % changes nothing.",
        ..MACRO
    },
    Parameter {
        index: Id::MacroSharpness,
        id: "macro_sharpness",
        name: "Macro: Sharpness",
        help: "Sharpness of crackles: from dull thuds of wet wood to dry snaps. 0 % changes nothing.",
        ..MACRO
    },
    Parameter {
        index: Id::MacroHiss,
        id: "macro_hiss",
        name: "Macro: Hiss",
        help: "Amount of hiss: the sound of steam and small jets, above 6 kHz. 0 % changes nothing.",
        ..MACRO
    },
    Parameter {
        index: Id::MacroWhoosh,
        id: "macro_whoosh",
        name: "Macro: Whoosh",
        help: "Amount of whoosh: the vortex sound of moving gas, added if its level is off. 0 % changes nothing.",
        ..MACRO
    },
    Parameter {
        index: Id::MacroTightness,
        id: "macro_tightness",
        name: "Macro: Tightness",
        help: "Accuracy with which the sound follows the flame's loudness, moment by moment. 0 % changes nothing.",
        ..MACRO
    },
    Parameter {
        index: Id::MacroDistance,
        id: "macro_distance",
        name: "Macro: Distance",
        help: "Distance of the fire: far ones are softer, duller and narrower. 0 % changes nothing.",
        ..MACRO
    },
    Parameter {
        index: Id::Take,
        id: "take",
        name: "Take",
        kind: Int { low: 0, high: 65_535, default: 0 },
        help: "Take number: every take has the same character and different events; 0 uses the seeds that are set.",
        ..CHARACTER
    },
    Parameter {
        index: Id::TakeAmount,
        id: "take_amount",
        name: "Take amount",
        unit: "%",
        kind: float(0.0, 100.0, 50.0, 1.0, 1),
        help: "Degree to which a take's texture may stray from the best-matching moments; noise, crackles and gas differ in every take.",
        ..CHARACTER
    },
];
