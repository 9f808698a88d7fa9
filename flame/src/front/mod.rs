//! The flame front: the surface on which the field, smoothed by cubic B-splines, equals a value.

mod cells;
mod clusters;
mod measure;
mod mesh;
mod refinement;
mod spline;
mod tetrahedra;

pub use clusters::Cluster;
pub use measure::{Front, Measure};
pub use mesh::Mesh;
pub use refinement::Refinement;
