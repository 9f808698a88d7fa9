//! Controls of texture and of its companding.

use super::recordings::RecordingControls;

/// Source of the distribution of the drive's amplitudes (§5.3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DynamicRange {
    /// No mapping.
    Off,
    /// From a distribution learned beforehand; no mapping until there is one.
    Learned,
    /// Estimated while it plays.
    #[default]
    Running,
}

/// Number of candidates that one search may examine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quality {
    /// At most this many candidates per window.
    Bounded {
        /// Candidates compared per search, at least 1.
        candidates: u32,
    },
    /// As many as needed to be certain.
    Exact,
}

impl Default for Quality {
    fn default() -> Self {
        Self::Bounded { candidates: 1024 }
    }
}

/// Controls of [`crate::texture`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureControls {
    /// The recordings that it is made from.
    pub recordings: RecordingControls,
    /// Degree to which the recording's amplitudes are mapped onto the drive's, 0-1 (1: the paper).
    pub scaling_alpha: f64,
    /// True if that is lowered while single tones stand out ([`crate::texture::buzz`]).
    pub scaling_auto: bool,
    /// Source of the drive's amplitude distribution.
    pub dynamic_range: DynamicRange,
    /// Amplitude of the pyramid's top level below which, once it lasts longer than the look-ahead, nothing is
    /// synthesized; 0 = no gate.
    pub gate: f64,
    /// Bound on each search.
    pub quality: Quality,
    /// Seed of the noise that [`variety`](Self::variety) adds.
    pub seed: u32,
    /// Degree to which searches are perturbed, 0-1, so that another seed finds other windows of the same kind: noise
    /// added to the feature, relative to its own root mean square. 0 finds the nearest, as in the paper.
    pub variety: f64,
    /// Controls of companding; without effect in the paper's mode.
    pub companding: CompandingControls,
}

impl Default for TextureControls {
    fn default() -> Self {
        Self {
            recordings: RecordingControls::default(),
            scaling_alpha: 1.0,
            scaling_auto: false,
            dynamic_range: DynamicRange::Running,
            gate: 1e-4,
            quality: Quality::default(),
            seed: 0,
            variety: 0.0,
            companding: CompandingControls::default(),
        }
    }
}

/// Controls of [`crate::companding`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompandingControls {
    /// Origin of the audible loudness dynamics, 0-1: 0 = the recording's own, 1 = the drive's only.
    pub dynamics: f64,
    /// Factor on the drive's level in matching, around its automatic value; 0.01-100.
    pub drive_match: f64,
    /// Frequency in Hz below which the drive itself is heard instead of texture, 20-400; 0 = off.
    pub low_end_hz: f64,
    /// Amount of the equaliser towards the recording's spectrum, 0-1.
    pub spectrum_match: f64,
}

impl Default for CompandingControls {
    fn default() -> Self {
        Self { dynamics: 0.77, drive_match: 1.0, low_end_hz: 150.0, spectrum_match: 0.75 }
    }
}
