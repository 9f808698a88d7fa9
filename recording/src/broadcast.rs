//! Sound with a position on the timeline: Broadcast Wave (EBU Tech 3285) and its equivalent in FLAC.

mod read;

/// Originator string.
const ORIGINATOR: &str = "Pyrophone";

/// Length of the `bext` chunk in bytes, without a coding history.
pub(crate) const BEXT_BYTES: u32 = 602;

/// Largest iXML chunk that is preserved, in bytes.
pub(crate) const MOST_IXML_BYTES: u64 = 1 << 16;

/// Metadata of a Broadcast Wave file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Broadcast {
    /// Description; written as ASCII, at most 256 characters of it.
    pub description: String,
    /// Date as `yyyy-mm-dd`; none for a file that is the same whenever it is made.
    pub date: Option<String>,
    /// `hh:mm:ss`.
    pub time: Option<String>,
    /// Position of the first sample on the timeline, in samples since midnight.
    pub time_reference_samples: u64,
    /// Text of an iXML chunk, at most 64 KiB; only in WAV files.
    pub ixml: Option<String>,
}

/// The chunk's fixed part; loudness and UMID are left empty.
pub(crate) fn bext(broadcast: &Broadcast) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(BEXT_BYTES as usize);
    let mut text = |text: &str, size: usize| {
        let ascii = text.bytes().filter(|byte| (0x20..0x7f).contains(byte));
        let mut field: Vec<u8> = ascii.take(size).collect();
        field.resize(size, 0);
        bytes.extend(field);
    };
    text(&broadcast.description, 256);
    text(ORIGINATOR, 32);
    text("", 32);
    text(broadcast.date.as_deref().unwrap_or_default(), 10);
    text(broadcast.time.as_deref().unwrap_or_default(), 8);
    // Low word first, which is how a little-endian u64 is stored.
    bytes.extend(broadcast.time_reference_samples.to_le_bytes());
    bytes.extend(1u16.to_le_bytes());
    bytes.resize(BEXT_BYTES as usize, 0);
    bytes
}
