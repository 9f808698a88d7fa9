//! What the user should know of a recording that can be used all the same.

/// A finding about a sound file, one line of text without the file's name.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// The header leaves the length open, as it does where a file was written to a pipe or never closed.
    UnknownLength {
        /// Seconds up to the file's end.
        found_s: f64,
    },
    /// The header counts other than what the file holds, and is not what ends the sound.
    CountDiffers {
        /// Samples or frames that the header declares.
        declared: u64,
        /// Those that are there.
        found: u64,
        /// What is counted.
        unit: &'static str,
    },
    /// The last frame, packet or page breaks off.
    BreaksOff {
        /// What breaks off.
        what: &'static str,
    },
    /// Packets in the middle of the stream could not be decoded.
    Undecoded {
        /// How many.
        packets: usize,
    },
    /// Bytes between the packets that are none.
    Skipped {
        /// How many.
        bytes: usize,
    },
    /// Sound beside the one that is read.
    LeftOut {
        /// What is left out.
        what: &'static str,
    },
    /// No sample is more than nothing.
    Silent,
    /// The channels cancel in their mean.
    ChannelsCancel,
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::UnknownLength { found_s } => {
                write!(
                    f,
                    "its header does not say how long it is; all {found_s:.3} s up to the end of the file are used"
                )
            }
            Self::CountDiffers { declared, found, unit } => {
                write!(f, "its header counts {declared} {unit}, but {found} are there; all of them are used")
            }
            Self::BreaksOff { what } => write!(f, "its last {what} breaks off; what comes before it is used"),
            Self::Undecoded { packets } => {
                write!(f, "{packets} packets of it are damaged and left out; export or copy it again to have them")
            }
            Self::Skipped { bytes } => write!(f, "{bytes} bytes in it are neither sound nor a tag, and are skipped"),
            Self::LeftOut { what } => write!(f, "{what} is left out"),
            Self::Silent => write!(f, "it is silent throughout"),
            Self::ChannelsCancel => {
                write!(f, "its channels cancel in their mean, which matching goes by; invert one of them")
            }
        }
    }
}
