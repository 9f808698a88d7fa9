//! Steps between the frames of a simulation that has too few for sound.
//!
//! ```text
//! frames ─ flux ─┬────────── natural cubic spline ─┬─ steps
//!   │            └─ loudness ─┐                     │
//!   └─ sources ─ flips ───────┴─────────────────────┘
//!             (or noise)
//! ```
//!
//! Frames at 24 per second contain nothing certain above 12 Hz. The timbre there is taken from what changes between two
//! of them, and in how many parts; the loudness from the flux at the frames. A pair's change is a function of its two
//! frames, their number and a seed, so the shards of a farm give the same result as a single run.

mod filter;
mod flips;
mod loudness;
mod noise;
mod source;
mod spline;

pub use source::VoxelSources;

use crate::error::{Error, in_range};
use crate::flux::Changes;

/// Largest number of steps made from one.
const MOST_SUBSTEPS: usize = 512;

/// Method of making steps between two frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Every part of the flame changes from one frame to the next at a random time.
    Flips,
    /// As flips, but from the burning field alone.
    Release,
    /// Noise whose power falls with frequency.
    Noise,
    /// Only a smooth curve through the frames.
    Cubic,
}

impl Method {
    const ALL: [Self; 4] = [Self::Flips, Self::Release, Self::Noise, Self::Cubic];

    /// Name in options and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Flips => "flips",
            Self::Release => "release",
            Self::Noise => "noise",
            Self::Cubic => "cubic",
        }
    }
}

/// Converter from one step to several.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Upsampler {
    method: Method,
    substeps: usize,
    seed: u64,
}

impl Upsampler {
    /// An upsampler that makes `substeps` (1-512) steps from each.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if `substeps` is out of range.
    pub fn new(method: Method, substeps: usize, seed: u64) -> Result<Self, Error> {
        in_range("the number of steps made of one", substeps as f64, 1.0, MOST_SUBSTEPS as f64)?;
        Ok(Self { method, substeps, seed })
    }

    /// The upsampler named at the end of a part's settings, in the form of its text.
    pub fn of_settings(settings: &str) -> Option<Self> {
        let (_, text) = settings.rsplit_once("upsample ")?;
        let mut words = text.split(' ').map(|word| word.trim_end_matches(','));
        let name = words.next()?;
        let method = Method::ALL.into_iter().find(|method| name == method.name())?;
        let mut number = || words.find_map(|word| word.parse::<u64>().ok());
        let substeps = usize::try_from(number()?).ok()?;
        Self::new(method, substeps, number()?).ok()
    }

    /// Steps made of one.
    pub fn substeps(&self) -> usize {
        self.substeps
    }

    /// Seed of all randomness.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// True if it needs the change from each frame to the next.
    pub fn needs_changes(&self) -> bool {
        matches!(self.method, Method::Flips | Method::Release)
    }

    /// True if it uses the burning field alone, without the flow.
    pub fn needs_field_only(&self) -> bool {
        self.method == Method::Release
    }

    /// The data about the change from step `number` to the next that [`series`](Self::series) needs.
    pub fn change(&self, number: i64, before: &VoxelSources, after: &VoxelSources) -> Vec<f64> {
        flips::change(number, [before, after], self.substeps, self.seed)
    }

    /// A series with `substeps` times as many steps as `values`, of which the first is step `first`. If a pair's change
    /// is unknown, nothing is added to the curve through the steps.
    pub fn series(&self, values: &[f64], first: i64, changes: &Changes) -> Vec<f64> {
        let smooth = spline::natural_cubic(values, self.substeps);
        if self.substeps == 1 || self.method == Method::Cubic {
            return smooth;
        }
        let carrier = match self.method {
            Method::Noise => noise::pressure(smooth.len(), self.seed),
            _ => self.flips(values.len(), first, changes),
        };
        let added = loudness::shaped(values, &carrier, self.substeps);
        smooth.iter().zip(added).map(|(smooth, added)| smooth + added).collect()
    }

    /// The pressure (flux per step) of `count` frames' flips.
    fn flips(&self, count: usize, first: i64, changes: &Changes) -> Vec<f64> {
        let known = |frame: usize| changes.get(&first.saturating_add(frame as i64)).map(Vec::as_slice);
        let flux = flips::deviations(&(0..count).map(known).collect::<Vec<_>>(), self.substeps);
        let before = std::iter::once(0.0).chain(flux.iter().copied());
        flux.iter().zip(before).map(|(flux, before)| flux - before).collect()
    }
}

impl std::fmt::Display for Upsampler {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}, {} steps, seed {}", self.method.name(), self.substeps, self.seed)
    }
}
