//! Plain samples: stored one after the other, without compression.

use crate::format::described::Described;
use crate::g711::{from_a_law, from_mu_law};
use crate::{Error, Progress};

/// Storage of one sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Coding {
    /// Eight bits about 128.
    Unsigned8,
    /// Two's complement of 1 to 4 bytes, of which `bits` correspond to full scale.
    Integer {
        /// Bytes of one sample.
        bytes: usize,
        /// Bits below and with the sign.
        bits: u32,
    },
    Float32,
    Float64,
    MuLaw,
    ALaw,
}

impl Coding {
    /// Bytes of one sample.
    pub fn bytes(self) -> usize {
        match self {
            Self::Unsigned8 | Self::MuLaw | Self::ALaw => 1,
            Self::Integer { bytes, .. } => bytes,
            Self::Float32 => 4,
            Self::Float64 => 8,
        }
    }

    /// Integers of `bits` in the upper bits of as few bytes as possible: the usual form in WAV and AIFF.
    pub fn integer(bits: usize) -> Self {
        let bytes = bits.div_ceil(8);
        Self::Integer { bytes, bits: 8 * bytes as u32 }
    }
}

/// Plain samples, channels interleaved.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pcm<'a> {
    pub coding: Coding,
    pub is_big_endian: bool,
    /// The data; only whole frames count.
    pub data: &'a [u8],
}

/// Frames between two reports of progress.
const BLOCK_FRAMES: usize = 8192;

impl Pcm<'_> {
    /// Number of whole frames of `channels`.
    pub fn frames(&self, channels: usize) -> usize {
        self.data.len() / (self.coding.bytes() * channels.max(1))
    }

    /// The samples of every channel.
    pub fn decode(&self, of: &Described, name: &str, progress: Progress) -> Result<Vec<Vec<f32>>, Error> {
        let frames = self.frames(of.channels);
        if frames == 0 {
            return Err(Error::NoSamples { name: name.into() });
        }
        of.check_length(frames as u64, name)?;
        // The kind of sample is decided once: deciding it for each takes ten times as long as the conversion.
        match self.coding {
            Coding::Unsigned8 => self.convert(frames, of, progress, |[byte]| (f32::from(byte) - 128.0) / 128.0),
            Coding::MuLaw => self.convert(frames, of, progress, |[byte]| from_mu_law(byte)),
            Coding::ALaw => self.convert(frames, of, progress, |[byte]| from_a_law(byte)),
            Coding::Float32 => self.convert(frames, of, progress, f32::from_le_bytes),
            Coding::Float64 => self.convert(frames, of, progress, |bytes| f64::from_le_bytes(bytes) as f32),
            Coding::Integer { bytes: 1, bits } => self.convert::<1>(frames, of, progress, integer(bits)),
            Coding::Integer { bytes: 2, bits } => self.convert::<2>(frames, of, progress, integer(bits)),
            Coding::Integer { bytes: 3, bits } => self.convert::<3>(frames, of, progress, integer(bits)),
            Coding::Integer { bits, .. } => self.convert::<4>(frames, of, progress, integer(bits)),
        }
    }

    /// Samples of every channel, of `N` bytes each, which are passed to `value` lowest first.
    fn convert<const N: usize>(
        &self,
        frames: usize,
        of: &Described,
        progress: Progress,
        value: impl Fn([u8; N]) -> f32,
    ) -> Result<Vec<Vec<f32>>, Error> {
        let mut channels = vec![Vec::with_capacity(frames); of.channels];
        let samples = &self.data.as_chunks().0[..frames * of.channels];
        for block in samples.chunks(BLOCK_FRAMES * of.channels) {
            for (index, channel) in channels.iter_mut().enumerate() {
                let own = block.iter().skip(index).step_by(of.channels).copied();
                if self.is_big_endian {
                    let reversed = |mut bytes: [u8; N]| {
                        bytes.reverse();
                        bytes
                    };
                    channel.extend(own.map(|bytes| value(reversed(bytes))));
                } else {
                    channel.extend(own.map(&value));
                }
            }
            if !progress(channels[0].len() as f32 / frames as f32) {
                return Err(Error::Cancelled);
            }
        }
        Ok(channels)
    }
}

/// Value of an integer of `N` bytes, of which `bits` correspond to full scale.
fn integer<const N: usize>(bits: u32) -> impl Fn([u8; N]) -> f32 {
    // A power of two: multiplying by it is as exact as dividing by full scale.
    let step = maths::powi(0.5, bits as i32 - 1);
    move |bytes| {
        // The sign bit at the top of a word, and back: that extends it.
        let mut word = [0; 4];
        word[4 - N..].copy_from_slice(&bytes);
        let value = i32::from_le_bytes(word) >> (32 - 8 * N);
        (f64::from(value) * step) as f32
    }
}

/// Integers of `bits` in wider containers than necessary, as some editors write 24 bits into 4 bytes.
///
/// If the format does not state whether they fill the upper or the lower bits, the samples decide: those in the lower
/// bits never leave them, and a whole recording 48 dB below full scale is the less likely reading.
pub(crate) fn padded(bits: usize, bytes: usize, is_big_endian: bool, data: &[u8]) -> Coding {
    let whole = |sample: &[u8]| {
        let join = |word: u64, byte: &u8| word << 8 | u64::from(*byte);
        let word = if is_big_endian { sample.iter().fold(0, join) } else { sample.iter().rev().fold(0, join) };
        // The sign bit at the top of a word, and back: that extends it.
        let shift = 64 - 8 * bytes as u32;
        (word << shift) as i64 >> shift
    };
    let most = 1i64 << (bits - 1);
    let is_low = data.chunks_exact(bytes).all(|sample| (-most..=most).contains(&whole(sample)));
    Coding::Integer { bytes, bits: if is_low { bits as u32 } else { 8 * bytes as u32 } }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(coding: Coding, is_big_endian: bool, data: &[u8]) -> Vec<f32> {
        let of = Described { channels: 1, sample_rate_hz: 48_000, notes: vec![] };
        Pcm { coding, is_big_endian, data }.decode(&of, "test", &|_| true).unwrap()[0].clone()
    }

    #[test]
    fn both_byte_orders_give_the_same_samples() {
        let little = [0x00, 0x40, 0x00, 0xc0];
        let big = [0x40, 0x00, 0xc0, 0x00];
        assert_eq!(samples(Coding::integer(16), false, &little), [0.5, -0.5]);
        assert_eq!(samples(Coding::integer(16), true, &big), [0.5, -0.5]);
        assert_eq!(samples(Coding::Float64, true, &0.75f64.to_be_bytes()), [0.75]);
    }

    #[test]
    fn twenty_four_bits_in_four_bytes_are_found_at_either_end() {
        let low: Vec<u8> = [0x40_0000i32, -0x20_0000].iter().flat_map(|sample| sample.to_le_bytes()).collect();
        let high: Vec<u8> = [0x4000_0000i32, -0x2000_0000].iter().flat_map(|sample| sample.to_le_bytes()).collect();
        for data in [low, high] {
            assert_eq!(samples(padded(24, 4, false, &data), false, &data), [0.5, -0.25]);
        }
    }
}
