//! Loudspeakers of a file's channels, as `WAVEFORMATEXTENSIBLE` and FLAC's comments number them.

/// The loudspeakers for a number of channels (left, right, centre, LFE, rear, side, top), one bit each; 0 for mono and
/// stereo.
///
/// Without a mask programs assign the channels to loudspeakers in the order of the bits.
pub(crate) fn channel_mask(channels: usize) -> u32 {
    match channels {
        3 => 0x7,
        4 => 0x33,
        5 => 0x37,
        6 => 0x3f,
        7 => 0x637,
        8 => 0x63f,
        9 => 0x5637,
        10 => 0x563f,
        _ => 0,
    }
}
