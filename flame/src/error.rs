//! What can be wrong with a simulation, or with what is asked of it.

/// Why a flame could not be read, measured or simulated.
///
/// Every message is one line: what was found, what is allowed, what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A grid's transform has no inverse or no sensible voxel size.
    #[error(
        "the grid's transform {rows:?} + {translation:?} cannot be used; voxels must have a volume and edges between 1e-9 and 1e9"
    )]
    Transform {
        /// The matrix, row after row.
        rows: [[f64; 3]; 3],
        /// The translation.
        translation: [f64; 3],
    },
    /// An array does not have as many values as its shape says.
    #[error("an array of shape {shape:?} has {found} values; they must be as many as the shape's product")]
    Shape {
        /// Voxels along x, y, z.
        shape: [usize; 3],
        /// Values found.
        found: usize,
    },
    /// A setting lies outside its range.
    #[error("{what} is {found}, but must lie between {low} and {high}; choose a value in that range")]
    OutOfRange {
        /// The setting, in the user's words.
        what: &'static str,
        /// The value found.
        found: f64,
        /// The smallest value allowed.
        low: f64,
        /// The largest value allowed.
        high: f64,
    },
    /// Work was called off by its progress callback.
    #[error("cancelled")]
    Cancelled,
}

/// Fails unless `low <= found <= high`; NaN fails too.
pub(crate) fn in_range(what: &'static str, found: f64, low: f64, high: f64) -> Result<(), Error> {
    if found >= low && found <= high { Ok(()) } else { Err(Error::OutOfRange { what, found, low, high }) }
}
