//! One step of a simulation, reduced to the data that its sound needs.

use crate::grid::{Grid, Transform};
use crate::velocity::{Placement, Velocity};

/// The burning field and the flow at one step.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Number of the step, as in its file name.
    pub number: i64,
    /// Field whose iso-surface is the flame front; larger in the flame.
    pub field: Grid<1>,
    /// The flow, in world units per second.
    pub velocity: Velocity,
}

impl Frame {
    /// A step before ignition, without flame or flow.
    pub fn unlit(number: i64) -> Self {
        let transform = Transform::identity();
        let velocity = Velocity::Vectors(Grid::new([0.0; 3], transform), Placement::Collocated);
        Self { number, field: Grid::new([0.0], transform), velocity }
    }
}
