//! Key of a dictionary: all of its inputs.

use pyrophone_recording::Cut;
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::PyramidConfig;

/// Key of a dictionary: content, part, sample rate and structure.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct DictionaryKey {
    content_hash: String,
    /// Start, end and gain of the part, and whether it is normalised.
    cut: (Option<[u64; 2]>, u64, bool),
    rate_bits: u64,
    sizes: [usize; 3],
    falloff_bits: u64,
    dynamics: MatchingMode,
}

impl DictionaryKey {
    /// The key as text: equal keys have equal texts, and different keys different texts.
    pub fn text(&self) -> String {
        format!("{self:?}")
    }

    /// The key of a part of a recording at a sample rate, for engines of a structure.
    pub fn new(content_hash: &str, cut: &Cut, sample_rate_hz: f64, structure: &EngineConfig) -> Self {
        let shape = PyramidConfig::at_rate(structure, sample_rate_hz);
        Self {
            dynamics: structure.dynamics,
            content_hash: content_hash.to_owned(),
            cut: (cut.region_s.map(|region_s| region_s.map(f64::to_bits)), cut.gain_db.to_bits(), cut.normalise),
            rate_bits: sample_rate_hz.to_bits(),
            sizes: [shape.levels, shape.window, shape.feature],
            falloff_bits: shape.falloff.to_bits(),
        }
    }
}
