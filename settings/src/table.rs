//! The table of all parameters, a promise that presets, states and automation rely on.
//!
//! Ids and the order of choices never change. The rows are in a file for each group, in any order: [`PARAMETERS`] sorts
//! them by their [`Id`].

mod base;
mod character;
mod crackle;
mod drive;
mod extension;
mod flame;
mod fuel;
mod levels;
mod structure;
mod texture;
mod vortex;

use crate::Error;
use crate::id::Id;
use crate::names::nearest;
use crate::parameter::Parameter;

pub use drive::DRIVE_MODES;
pub use flame::FLAME_SCENES;
pub use fuel::FUELS;
pub use structure::DYNAMICS_MODES;
pub use texture::{DYNAMIC_RANGES, QUALITIES, RECORDING_SLOTS};
pub use vortex::{VORTEX_FLOWS, VORTEX_TEXTURES};

/// Rows group by group.
const ROWS: [&[Parameter]; 10] = [
    character::ROWS,
    levels::ROWS,
    drive::ROWS,
    flame::ROWS,
    texture::ROWS,
    crackle::ROWS,
    fuel::ROWS,
    extension::ROWS,
    vortex::ROWS,
    structure::ROWS,
];

/// Number of parameters.
pub const COUNT: usize = count();

/// All parameters, in the order of [`Id`].
pub const PARAMETERS: &[Parameter] = &in_order_of_id();

const fn count() -> usize {
    let mut count = 0;
    let mut group = 0;
    // `for` is not available in constants.
    while group < ROWS.len() {
        count += ROWS[group].len();
        group += 1;
    }
    count
}

const fn in_order_of_id() -> [Parameter; COUNT] {
    let mut table = [base::CONTROL; COUNT];
    let mut group = 0;
    while group < ROWS.len() {
        let mut row = 0;
        while row < ROWS[group].len() {
            let parameter = ROWS[group][row];
            // There are as many rows as places, so no place stays empty if none is taken twice.
            assert!(table[parameter.index as usize].id.is_empty(), "two rows for one id");
            table[parameter.index as usize] = parameter;
            row += 1;
        }
        group += 1;
    }
    table
}

/// Parameters that belong to a session's recordings, and do not change when a preset is chosen.
pub const OF_SESSION: [Id; 3] = [Id::RecordingSlot, Id::RecordingSecond, Id::RecordingBlend];

impl Id {
    /// Its row in the table.
    pub fn parameter(self) -> &'static Parameter {
        &PARAMETERS[self as usize]
    }
}

/// Indices into the table in the order in which hosts show the parameters: by group, bypass first, and within a group
/// as in the table.
pub fn host_order() -> Vec<usize> {
    let mut order: Vec<usize> = (0..COUNT).collect();
    order.sort_by_key(|index| (PARAMETERS[*index].index != Id::Bypass, PARAMETERS[*index].group));
    order
}

/// Index of the parameter with this id in [`PARAMETERS`].
pub fn index_of(id: &str) -> Result<usize, Error> {
    PARAMETERS.iter().position(|parameter| parameter.id == id).ok_or_else(|| Error::UnknownParameter {
        id: id.to_owned(),
        nearest: nearest(id, PARAMETERS.iter().map(|parameter| parameter.id)),
    })
}
