//! Errors of simulations and their settings.

/// Reason why a flame could not be read, measured or simulated.
///
/// Every message is one line: what was found, what is allowed, what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A grid's transform has no inverse or no sensible voxel size.
    #[error(
        "the grid's transform {rows:?} + {translation:?} is unusable; every voxel must have a volume, and edges between 1e-9 and 1e9"
    )]
    Transform {
        /// The matrix, row after row.
        rows: [[f64; 3]; 3],
        /// The translation.
        translation: [f64; 3],
    },
    /// An array does not have as many values as its shape says.
    #[error("an array of shape {shape:?} has {found} values; the number must be the product of the shape")]
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
    /// A setting has a fraction where only whole numbers are possible.
    #[error("{what} is {found}, but must be a whole number; choose one")]
    NotWhole {
        /// The setting, in the user's words.
        what: &'static str,
        /// The value found.
        found: f64,
    },
    /// A flow to be recorded does not settle to a steady mean.
    #[error(
        "the flow has not settled after {passages} passages: its velocity variance still changes by {change:.2} of its value (0.2 allowed), and its divergence is {divergence:.0e} of speed over voxel size (0.001 allowed); use more voxels"
    )]
    Unsettled {
        /// Passages through the box.
        passages: usize,
        /// Change of the velocity variance over three passages, relative to it.
        change: f64,
        /// Remaining divergence, relative to the largest speed per voxel.
        divergence: f64,
    },
    /// One side of an axis is periodic and the other is not.
    #[error("one side of the box is periodic and the opposite one is not; make both periodic or neither")]
    OneSidedPeriod,
    /// A saved simulation cannot be resumed.
    #[error("the saved simulation is unusable ({reason}); start again without it")]
    Checkpoint {
        /// The fault found.
        reason: &'static str,
    },
    /// The field burns everywhere outside its stored part.
    #[error(
        "the field's background is {background}, above the iso value {iso}, so the flame is unbounded; choose another field or a higher iso value"
    )]
    Unbounded {
        /// The field's background.
        background: f64,
        /// The iso value.
        iso: f64,
    },
    /// A surface too large to be intended.
    #[error(
        "the flame front would have {found} pieces, but at most {allowed} are allowed; check the iso value, or crop the simulation"
    )]
    TooLarge {
        /// Blocks or corners found.
        found: u128,
        /// The most allowed.
        allowed: u128,
    },
    /// A voxel index out of bounds.
    #[error(
        "the field reaches index {index:?}, but indices must lie between -2^30 and 2^30; move or crop the simulation"
    )]
    TooFar {
        /// The index.
        index: [i64; 3],
    },
    /// A value is or became NaN or infinite.
    #[error("the {what} is not a finite number everywhere; simulate or export this step again")]
    NotFinite {
        /// `field`, `velocity` or `flux`.
        what: &'static str,
    },
    /// No frame was measured.
    #[error("no frame could be measured; at least one good frame is needed")]
    NoFrames,
    /// A flux table, whole or partial, cannot be read.
    #[error("{name}, line {line}: {reason}; write the file again with `pyrophone flux`")]
    Table {
        /// The file.
        name: String,
        /// Line from 1.
        line: usize,
        /// The fault found.
        reason: String,
    },
    /// Partial tables were measured with different settings.
    #[error(
        "{first} ({first_settings}) and {second} ({second_settings}) were measured differently; measure one of them again"
    )]
    SettingsDiffer {
        /// A file.
        first: String,
        /// Its settings.
        first_settings: String,
        /// Another file.
        second: String,
        /// Its settings.
        second_settings: String,
    },
    /// Partial tables come from different caches, or from different states of one cache.
    #[error(
        "{first} and {second} were measured from different caches, or from one that was simulated again; measure one of them again"
    )]
    CachesDiffer {
        /// A file.
        first: String,
        /// Another file.
        second: String,
    },
    /// Two partial tables hold the same frame.
    #[error("frame {frame} is in both {first} and {second}; merge parts that do not overlap")]
    Overlap {
        /// The frame.
        frame: i64,
        /// A file.
        first: String,
        /// Another file, or the same.
        second: String,
    },
    /// Frames between the first and the last are in no partial table.
    #[error("frame {frame} is in none of the files, but frames before and after it are; add the part that contains it")]
    Hole {
        /// The first frame missing.
        frame: i64,
    },
    /// The flow does not move.
    #[error("nothing moves in any step, so there is no speed field; check the velocity's grid")]
    NoMotion,
    /// An engine rejected data made for it.
    #[error(transparent)]
    Engine(#[from] pyrophone_synthesis::Error),
    /// Work was cancelled by its progress callback.
    #[error("cancelled")]
    Cancelled,
}

/// Fails unless `low <= found <= high`; NaN fails too.
pub(crate) fn in_range(what: &'static str, found: f64, low: f64, high: f64) -> Result<(), Error> {
    if found >= low && found <= high { Ok(()) } else { Err(Error::OutOfRange { what, found, low, high }) }
}
