//! Headers of FLAC frames, and both checksums.

/// Header of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FrameHeader {
    /// Sample rate; none if the stream states it.
    pub sample_rate_hz: Option<u32>,
    pub channels: usize,
    /// Samples per channel.
    pub samples: u64,
    /// The frame number, or the number of its first sample if blocks vary in size.
    pub number: u64,
    has_varying_blocks: bool,
}

impl FrameHeader {
    /// The header at the start of `bytes`, including its checksum.
    pub fn read(bytes: &[u8]) -> Option<Self> {
        let [sync, kind, codes, layout] = *bytes.first_chunk::<4>()?;
        if sync != 0xff || kind & 0xfe != 0xf8 || layout & 1 != 0 {
            return None;
        }
        let (number, mut at) = number(bytes, 4)?;
        let mut take = |count: usize| {
            let field = bytes.get(at..at + count)?;
            at += count;
            Some(field.iter().fold(0, |sum, byte| sum << 8 | u32::from(*byte)))
        };
        let samples = match codes >> 4 {
            0 => return None,
            1 => 192,
            code @ 2..=5 => 576 << (code - 2),
            6 => take(1)? + 1,
            7 => take(2)? + 1,
            code => 256 << (code - 8),
        };
        const RATES_HZ: [u32; 11] =
            [88_200, 176_400, 192_000, 8_000, 16_000, 22_050, 24_000, 32_000, 44_100, 48_000, 96_000];
        let sample_rate_hz = match codes & 15 {
            0 => None,
            code @ 1..=11 => Some(RATES_HZ[usize::from(code) - 1]),
            12 => Some(1000 * take(1)?),
            13 => Some(take(2)?),
            14 => Some(10 * take(2)?),
            _ => return None,
        };
        let channels = match layout >> 4 {
            code @ 0..=7 => usize::from(code) + 1,
            8..=10 => 2,
            _ => return None,
        };
        if layout >> 1 & 7 == 3 || crc8(&bytes[..at]) != *bytes.get(at)? {
            return None;
        }
        Some(Self { sample_rate_hz, channels, samples: samples.into(), number, has_varying_blocks: kind & 1 != 0 })
    }

    /// Number of the next frame.
    pub fn number_of_next(&self) -> u64 {
        self.number + if self.has_varying_blocks { self.samples } else { 1 }
    }
}

/// A number coded as in UTF-8, extended to seven bytes, and its end.
fn number(bytes: &[u8], at: usize) -> Option<(u64, usize)> {
    let first = *bytes.get(at)?;
    let length = match first.leading_ones() {
        0 => return Some((first.into(), at + 1)),
        1 | 8 => return None,
        length => length as usize,
    };
    let rest = bytes.get(at + 1..at + length)?;
    let start = u64::from(first & (0x7f >> length));
    let add = |sum: u64, byte: &u8| (byte & 0xc0 == 0x80).then(|| sum << 6 | u64::from(byte & 0x3f));
    Some((rest.iter().try_fold(start, add)?, at + length))
}

fn crc8(bytes: &[u8]) -> u8 {
    let bit = |crc: u8, _| if crc & 0x80 != 0 { crc << 1 ^ 7 } else { crc << 1 };
    bytes.iter().fold(0, |crc, byte| (0..8).fold(crc ^ byte, bit))
}

/// The checksum over a whole frame (x^16 + x^15 + x^2 + 1), which is zero after the frame's own checksum.
#[derive(Default)]
pub(super) struct Crc16(u16);

const CRC16: [u16; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let (mut crc, mut bit) = ((byte as u16) << 8, 0);
        while bit < 8 {
            crc = if crc & 0x8000 != 0 { crc << 1 ^ 0x8005 } else { crc << 1 };
            bit += 1;
        }
        table[byte] = crc;
        byte += 1;
    }
    table
};

impl Crc16 {
    pub fn add(&mut self, byte: u8) {
        self.0 = self.0 << 8 ^ CRC16[usize::from((self.0 >> 8) as u8 ^ byte)];
    }

    pub fn is_clean(&self) -> bool {
        self.0 == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_tell_their_frames() {
        // Frame 0 of the example in RFC 9639, appendix D.1: one sample of two channels at 44.1 kHz.
        let bytes = [0xff, 0xf8, 0x69, 0x18, 0x00, 0x00, 0xbf];
        let header = FrameHeader::read(&bytes).unwrap();
        assert_eq!((header.sample_rate_hz, header.channels, header.samples), (Some(44_100), 2, 1));
        assert_eq!((header.number, header.number_of_next()), (0, 1));
        assert_eq!(FrameHeader::read(&[0xff, 0xf8, 0x69, 0x18, 0x00, 0x00, 0xbe]), None, "the checksum");
    }

    #[test]
    fn numbers_take_up_to_seven_bytes() {
        assert_eq!(number(&[0x7f], 0), Some((127, 1)));
        assert_eq!(number(&[0xc2, 0x80], 0), Some((128, 2)));
        assert_eq!(number(&[0xfe, 0xbf, 0xbf, 0xbf, 0xbf, 0xbf, 0xbf], 0), Some(((1 << 36) - 1, 7)));
        assert_eq!(number(&[0xc2, 0x00], 0), None);
        assert_eq!(number(&[0xff], 0), None);
    }
}
