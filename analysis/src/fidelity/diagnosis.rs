//! What is wrong with the output, and what to change.

/// Fault of the output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Diagnosis {
    /// Tones are prominent.
    Buzzes,
    /// Tones are likely: loudness is matched over a large range.
    MayBuzz,
    /// Its loudness does not follow the drive.
    Wanders,
    /// It is more sudden than the recording.
    Sudden,
    /// It is less sudden than the recording.
    Dull,
}

impl Diagnosis {
    /// The suggested change, in plain words; `is_calm` if none of the texture's controls has room left for it.
    pub fn advice(self, is_calm: bool) -> &'static str {
        match self {
            Self::Buzzes if is_calm => {
                "It has tones that the recording does not have: try a longer, livelier recording."
            }
            Self::Buzzes => "It buzzes: turn Scaling auto on, Scaling alpha down, or Dynamics mode to companded.",
            Self::MayBuzz => {
                "Drive and recording differ so much in loudness that this may buzz: turn Scaling auto on, or Scaling alpha down."
            }
            Self::Wanders if is_calm => "It does not follow the drive: turn a steady layer down.",
            Self::Wanders => "It does not follow the drive: turn Dynamics up, or a steady layer down.",
            Self::Sudden if is_calm => "It crackles more than the recording.",
            Self::Sudden => "It crackles more than the recording: turn Drive match down.",
            Self::Dull if is_calm => "It crackles less than the recording: turn extension and vortex down.",
            Self::Dull => "It crackles less than the recording: turn Drive match up, or extension and vortex down.",
        }
    }
}
