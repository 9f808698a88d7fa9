//! Headers of MPEG audio frames (ISO 11172-3, 13818-3, and the half rates that are called MPEG 2.5).

/// Bytes of a header.
pub(super) const HEADER_BYTES: usize = 4;

/// Number of consecutive frames that must match before bytes count as MPEG audio.
const CERTAIN_FRAMES: usize = 4;

/// Bytes that are searched for the first frame.
const MOST_JUNK_BYTES: usize = 1 << 16;

/// kbit/s by index, for layers 1, 2, 3 of MPEG 1, then for layer 1 and for layers 2 and 3 of MPEG 2.
const BIT_RATES: [[u32; 14]; 5] = [
    [32, 64, 96, 128, 160, 192, 224, 256, 288, 320, 352, 384, 416, 448],
    [32, 48, 56, 64, 80, 96, 112, 128, 160, 192, 224, 256, 320, 384],
    [32, 40, 48, 56, 64, 80, 96, 112, 128, 160, 192, 224, 256, 320],
    [32, 48, 56, 64, 80, 96, 112, 128, 144, 160, 176, 192, 224, 256],
    [8, 16, 24, 32, 40, 48, 56, 64, 80, 96, 112, 128, 144, 160],
];

/// Header of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Header {
    /// 1 to 3.
    pub layer: u32,
    pub sample_rate_hz: u32,
    pub channels: usize,
    /// Bytes of the frame, header included.
    pub frame_bytes: usize,
    /// Samples per channel.
    pub samples: usize,
    /// Bytes of side information after the header.
    pub side_bytes: usize,
}

impl Header {
    /// The header at the start of `bytes`. Frames of free bit rate are not accepted: nobody makes them.
    pub fn read(bytes: &[u8]) -> Option<Self> {
        let [sync, kind, rates, mode] = *bytes.first_chunk::<HEADER_BYTES>()?;
        if sync != 0xff || kind & 0xe0 != 0xe0 {
            return None;
        }
        let (version, layer) = (kind >> 3 & 3, kind >> 1 & 3);
        let is_first = version == 3;
        let halving = match version {
            0 => 4,
            2 => 2,
            3 => 1,
            _ => return None,
        };
        let layer = match layer {
            1..=3 => 4 - u32::from(layer),
            _ => return None,
        };
        let table = match (is_first, layer) {
            (true, layer) => layer as usize - 1,
            (false, 1) => 3,
            (false, _) => 4,
        };
        let bit_rate = 1000 * BIT_RATES[table].get(usize::from(rates >> 4).checked_sub(1)?)?;
        let sample_rate_hz = [44_100, 48_000, 32_000].get(usize::from(rates >> 2 & 3))? / halving;
        let pad = u32::from(rates >> 1 & 1);
        let samples = match layer {
            1 => 384,
            3 if !is_first => 576,
            _ => 1152,
        };
        let frame_bytes = match layer {
            1 => (12 * bit_rate / sample_rate_hz + pad) * 4,
            _ => samples / 8 * bit_rate / sample_rate_hz + pad,
        };
        let channels = if mode >> 6 == 3 { 1 } else { 2 };
        let side_bytes = match (is_first, channels) {
            (true, 2) => 32,
            (true, _) | (false, 2) => 17,
            (false, _) => 9,
        };
        let (frame_bytes, samples) = (frame_bytes as usize, samples as usize);
        Some(Self { layer, sample_rate_hz, channels, frame_bytes, samples, side_bytes })
    }

    /// True if one stream can contain both.
    pub fn is_like(&self, other: &Self) -> bool {
        (self.layer, self.sample_rate_hz, self.channels) == (other.layer, other.sample_rate_hz, other.channels)
    }

    /// True if `count` consecutive frames begin here, or as many as there are up to the end.
    pub fn is_followed(&self, bytes: &[u8], at: usize, count: usize) -> bool {
        let mut at = at + self.frame_bytes;
        for _ in 1..count {
            match bytes.get(at..).and_then(Self::read) {
                Some(next) if self.is_like(&next) => at += next.frame_bytes,
                Some(_) => return false,
                None => return at == bytes.len(),
            }
        }
        true
    }
}

/// Offset of the first frame, and its header.
pub(super) fn first(bytes: &[u8]) -> Option<(usize, Header)> {
    (0..bytes.len().min(MOST_JUNK_BYTES)).find_map(|at| {
        let header = Header::read(&bytes[at..])?;
        header.is_followed(bytes, at, CERTAIN_FRAMES).then_some((at, header))
    })
}

/// True if the bytes begin like AAC in ADTS: the same mark, and a layer that does not exist.
pub(super) fn is_adts(bytes: &[u8]) -> bool {
    matches!(bytes, [0xff, kind, rates, ..] if kind & 0xf6 == 0xf0 && rates >> 2 & 15 < 13)
}

/// The header frame of an encoder: no sound, but information about the sound after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Info {
    /// Number of frames that follow, if it counts them.
    pub frames: Option<u32>,
    /// Samples added by the encoder at the start and at the end.
    pub delay: u64,
    pub padding: u64,
}

/// Delay in samples of every decoder of layer 3.
const DECODER_DELAY: u64 = 529;

impl Info {
    /// Reads a frame that is an encoder's header (Xing's, LAME's or Fraunhofer's).
    pub fn read(frame: &[u8], header: &Header) -> Option<Self> {
        if header.layer != 3 {
            return None;
        }
        if frame.get(HEADER_BYTES + 32..)?.starts_with(b"VBRI") {
            let frames = frame.get(HEADER_BYTES + 46..)?.first_chunk().map(|four| u32::from_be_bytes(*four));
            return Some(Self { frames, delay: 0, padding: 0 });
        }
        let tag = frame.get(HEADER_BYTES + header.side_bytes..)?;
        if !tag.starts_with(b"Xing") && !tag.starts_with(b"Info") {
            return None;
        }
        let flags = *tag.get(7)?;
        let frames = tag.get(8..).filter(|_| flags & 1 != 0)?.first_chunk().map(|four| u32::from_be_bytes(*four));
        let fields = [(1, 4), (2, 4), (4, 100), (8, 4)];
        let length: usize = fields.iter().filter(|(flag, _)| flags & flag != 0).map(|(_, bytes)| bytes).sum();
        let (delay, padding) = tag.get(8 + length..).and_then(lame).unwrap_or_default();
        Some(Self { frames, delay, padding })
    }
}

/// Delay and padding, in samples, of the encoders that write them.
fn lame(extension: &[u8]) -> Option<(u64, u64)> {
    let is_known = [b"LAME", b"Lavf", b"Lavc"].iter().any(|name| extension.starts_with(*name));
    let [a, b, c] = *extension.get(21..)?.first_chunk::<3>()?;
    let (delay, padding) = (u64::from(a) << 4 | u64::from(b >> 4), u64::from(b & 15) << 8 | u64::from(c));
    is_known.then(|| (delay + DECODER_DELAY, padding.saturating_sub(DECODER_DELAY)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_tell_their_frames() {
        let header = Header::read(&[0xff, 0xfb, 0x94, 0xc4]).unwrap();
        assert_eq!((header.layer, header.sample_rate_hz, header.channels), (3, 48_000, 1));
        assert_eq!((header.frame_bytes, header.samples, header.side_bytes), (384, 1152, 17));
        let header = Header::read(&[0xff, 0xf3, 0x82, 0x44]).unwrap();
        assert_eq!((header.sample_rate_hz, header.channels, header.frame_bytes), (22_050, 2, 209));
        assert_eq!(Header::read(&[0xff, 0xf1, 0x50, 0x80]), None, "AAC");
        assert_eq!(Header::read(&[0xff, 0xfb, 0x04, 0xc4]), None, "free bit rate");
        assert_eq!(Header::read(&[0xff, 0xfb, 0xf4, 0xc4]), None);
        assert_eq!(Header::read(&[0xff, 0xfb, 0x9c, 0xc4]), None, "no such rate");
    }
}
