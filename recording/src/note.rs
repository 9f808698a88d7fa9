//! Notes on recordings that are odd but usable.

/// A finding about a sound file, one line of text without the file's name.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Note {
    /// The header leaves the length open, as in files that were written to a pipe or never closed.
    UnknownLength {
        /// Seconds up to the end of the file.
        found_s: f64,
    },
    /// The header's count differs from the contents, but does not decide the end of the sound.
    CountDiffers {
        /// Samples or frames that the header declares.
        declared: u64,
        /// Number present.
        found: u64,
        /// Unit of the counts.
        unit: &'static str,
    },
    /// The last frame, packet or page breaks off.
    BreaksOff {
        /// The unit that is truncated.
        what: &'static str,
    },
    /// Packets in the middle of the stream could not be decoded.
    Undecoded {
        /// Their number.
        packets: usize,
    },
    /// Bytes between the packets that are none.
    Skipped {
        /// Their number.
        bytes: usize,
    },
    /// Sound in addition to that which is read.
    LeftOut {
        /// The part left out.
        what: &'static str,
    },
    /// All samples are silent.
    Silent,
    /// The channels cancel in their mean.
    ChannelsCancel,
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::UnknownLength { found_s } => {
                write!(f, "its header does not state its length; all {found_s:.3} s up to the end of the file are used")
            }
            Self::CountDiffers { declared, found, unit } => {
                write!(f, "its header states {declared} {unit}, but there are {found}; all of them are used")
            }
            Self::BreaksOff { what } => write!(f, "its last {what} is truncated; everything before it is used"),
            Self::Undecoded { packets } => {
                write!(f, "{packets} damaged packets are left out; export or copy the file again to include them")
            }
            Self::Skipped { bytes } => write!(f, "{bytes} bytes that are neither sound nor a tag are skipped"),
            Self::LeftOut { what } => write!(f, "{what} is left out"),
            Self::Silent => write!(f, "it is silent throughout"),
            Self::ChannelsCancel => {
                write!(f, "its channels cancel when averaged, and matching uses their average; invert one of them")
            }
        }
    }
}
