//! Sound files made by hand, byte by byte.
#![allow(dead_code, missing_docs)]

/// Format tags of WAV.
pub const INTEGER: u16 = 1;
pub const FLOAT: u16 = 3;

/// A format chunk's 16 bytes.
pub fn wav_format(tag: u16, channels: u16, rate_hz: u32, bits: u16) -> Vec<u8> {
    let frame_bytes = (u32::from(channels) * u32::from(bits) / 8) as u16;
    let mut body = vec![];
    body.extend(tag.to_le_bytes());
    body.extend(channels.to_le_bytes());
    body.extend(rate_hz.to_le_bytes());
    body.extend((rate_hz.wrapping_mul(u32::from(frame_bytes))).to_le_bytes());
    body.extend(frame_bytes.to_le_bytes());
    body.extend(bits.to_le_bytes());
    body
}

/// The 40 bytes of an extensible format chunk.
pub fn wav_format_extensible(tag: u16, channels: u16, rate_hz: u32, bits: u16, valid_bits: u16) -> Vec<u8> {
    let mut body = wav_format(0xfffe, channels, rate_hz, bits);
    body.extend(22u16.to_le_bytes());
    body.extend(valid_bits.to_le_bytes());
    body.extend(((1u32 << channels) - 1).to_le_bytes());
    body.extend(tag.to_le_bytes());
    body.extend([0, 0, 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71]);
    body
}

/// A WAV file of a format chunk's body and the bytes of its sound.
pub fn wav(format: &[u8], sound: &[u8]) -> Vec<u8> {
    let mut file = b"RIFF\0\0\0\0WAVE".to_vec();
    for (id, body) in [(b"fmt ", format), (b"data", sound)] {
        file.extend(id);
        file.extend((body.len() as u32).to_le_bytes());
        file.extend(body);
        if body.len() % 2 == 1 {
            file.push(0);
        }
    }
    let size = file.len() as u32 - 8;
    file[4..8].copy_from_slice(&size.to_le_bytes());
    file
}

/// Mono float WAV.
pub fn wav_f32(samples: &[f32], rate_hz: u32) -> Vec<u8> {
    let sound: Vec<u8> = samples.iter().flat_map(|sample| sample.to_le_bytes()).collect();
    wav(&wav_format(FLOAT, 1, rate_hz, 32), &sound)
}

/// 16-bit AIFF of interleaved samples; `rate` as the 80-bit float's exponent and upper mantissa.
pub fn aiff_16(channels: u16, interleaved: &[i16], exponent: u16, mantissa: u16) -> Vec<u8> {
    let mut file = b"FORM\0\0\0\0AIFF".to_vec();
    file.extend(b"COMM\0\0\0\x12");
    file.extend(channels.to_be_bytes());
    file.extend((interleaved.len() as u32 / u32::from(channels.max(1))).to_be_bytes());
    file.extend(16u16.to_be_bytes());
    file.extend(exponent.to_be_bytes());
    file.extend(mantissa.to_be_bytes());
    file.extend([0; 6]);
    file.extend(b"SSND");
    file.extend((8 + 2 * interleaved.len() as u32).to_be_bytes());
    file.extend([0; 8]);
    file.extend(interleaved.iter().flat_map(|sample| sample.to_be_bytes()));
    let size = file.len() as u32 - 8;
    file[4..8].copy_from_slice(&size.to_be_bytes());
    file
}

/// 44.1 kHz as an 80-bit float.
pub const AIFF_44100: (u16, u16) = (0x400e, 0xac44);

/// CAF of little-endian 32-bit floats, mono.
pub fn caf_f32(samples: &[f32], rate_hz: f64) -> Vec<u8> {
    let mut file = b"caff\0\x01\0\0desc".to_vec();
    file.extend(32i64.to_be_bytes());
    file.extend(rate_hz.to_be_bytes());
    file.extend(b"lpcm");
    // Flags: float, little-endian; then bytes per packet, frames per packet, channels, bits.
    for value in [3u32, 4, 1, 1, 32] {
        file.extend(value.to_be_bytes());
    }
    file.extend(b"data");
    file.extend((4 + 4 * samples.len() as i64).to_be_bytes());
    file.extend([0; 4]);
    file.extend(samples.iter().flat_map(|sample| sample.to_le_bytes()));
    file
}

/// FLAC (RFC 9639) of verbatim subframes: mono, 16 bits, 44.1 kHz, blocks of 4096; whole blocks only.
pub fn flac_16(samples: &[i16]) -> Vec<u8> {
    const BLOCK: usize = 4096;
    assert_eq!(samples.len() % BLOCK, 0);
    let mut file = b"fLaC\x80\0\0\x22".to_vec();
    file.extend([BLOCK as u16; 2].iter().flat_map(|size| size.to_be_bytes()));
    file.extend([0; 6]);
    // 20 bits of rate, 3 of channels - 1, 5 of bits - 1, 36 of length.
    let packed = 44_100u64 << 44 | 15 << 36 | samples.len() as u64;
    file.extend(packed.to_be_bytes());
    file.extend([0; 16]);
    for (number, block) in samples.chunks(BLOCK).enumerate() {
        let mut frame = vec![0xff, 0xf8, 0xc9, 0x08, number as u8];
        frame.push(crc(&frame, 8, 0x07) as u8);
        frame.push(0x02);
        frame.extend(block.iter().flat_map(|sample| sample.to_be_bytes()));
        frame.extend((crc(&frame, 16, 0x8005) as u16).to_be_bytes());
        file.extend(frame);
    }
    file
}

fn crc(bytes: &[u8], bits: u32, polynomial: u32) -> u32 {
    let top = 1u32 << (bits - 1);
    let mask = u32::MAX >> (32 - bits);
    bytes.iter().fold(0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte) << (bits - 8), |crc, _| {
            if crc & top != 0 { (crc << 1 ^ polynomial) & mask } else { crc << 1 & mask }
        })
    })
}
