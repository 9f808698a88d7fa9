//! One step of a simulation, as far as its sound needs it.

use crate::grid::{Grid, Transform};
use crate::velocity::{Placement, Velocity};

/// The burning field and the flow at one step.
#[derive(Debug, Clone)]
pub struct Frame {
    /// The step's number, as its file names it.
    pub number: i64,
    /// The field whose iso-surface is the flame front; larger where it burns.
    pub field: Grid<1>,
    /// The flow, in the world's units per second.
    pub velocity: Velocity,
}

impl Frame {
    /// A step before ignition, in which there is neither flame nor flow.
    pub fn unlit(number: i64) -> Self {
        let transform = Transform::identity();
        let velocity = Velocity::Vectors(Grid::new([0.0; 3], transform), Placement::Collocated);
        Self { number, field: Grid::new([0.0], transform), velocity }
    }
}
