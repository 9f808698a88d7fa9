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
    let mut file = flac_header(samples.len() as u64, &[]);
    file.extend(flac_frames(samples, 0, FLAC_44100));
    file
}

/// Codes of sample rates in FLAC's frames.
pub const FLAC_44100: u8 = 9;
pub const FLAC_48000: u8 = 10;

const FLAC_BLOCK: usize = 4096;

/// The 34 bytes that describe a stream of mono at 44.1 kHz; a length of 0 is an unknown one.
pub fn flac_stream_info(samples: u64) -> Vec<u8> {
    let mut info: Vec<u8> = [FLAC_BLOCK as u16; 2].iter().flat_map(|size| size.to_be_bytes()).collect();
    info.extend([0; 6]);
    // 20 bits of rate, 3 of channels - 1, 5 of bits - 1, 36 of length.
    info.extend((44_100u64 << 44 | 15 << 36 | samples).to_be_bytes());
    info.extend([0; 16]);
    info
}

/// Mark and blocks of metadata: the description, then blocks of a type, a declared length and a body.
pub fn flac_header(samples: u64, blocks: &[(u8, u32, &[u8])]) -> Vec<u8> {
    let info = flac_stream_info(samples);
    let mut file = b"fLaC".to_vec();
    let all = [(0, 34, info.as_slice())].into_iter().chain(blocks.iter().copied());
    for (index, (kind, length, body)) in all.enumerate() {
        let last = if index == blocks.len() { 0x80 } else { 0 };
        file.push(kind | last);
        file.extend(&length.to_be_bytes()[1..]);
        file.extend(body);
    }
    file
}

/// Verbatim frames from a number on.
pub fn flac_frames(samples: &[i16], first_number: u8, rate_code: u8) -> Vec<u8> {
    assert_eq!(samples.len() % FLAC_BLOCK, 0);
    let mut frames = vec![];
    for (number, block) in samples.chunks(FLAC_BLOCK).enumerate() {
        let mut frame = vec![0xff, 0xf8, 0xc0 | rate_code, 0x08, first_number + number as u8];
        frame.push(crc(&frame, 8, 0x07) as u8);
        frame.push(0x02);
        frame.extend(block.iter().flat_map(|sample| sample.to_be_bytes()));
        frame.extend((crc(&frame, 16, 0x8005) as u16).to_be_bytes());
        frames.extend(frame);
    }
    frames
}

/// Silent MPEG 1 layer 3 at 48 kHz and 128 kbit/s, mono: frames of 384 bytes and 1152 samples.
pub fn mp3_frames(count: usize) -> Vec<u8> {
    let mut frame = vec![0xff, 0xfb, 0x94, 0xc4];
    frame.resize(384, 0);
    frame.repeat(count)
}

/// An encoder's header frame that counts so many frames, and takes so many samples off both ends.
pub fn mp3_info(frames: u32, delay: u32, padding: u32) -> Vec<u8> {
    let mut frame = mp3_frames(1);
    frame[21..25].copy_from_slice(b"Info");
    frame[28] = 1;
    frame[29..33].copy_from_slice(&frames.to_be_bytes());
    frame[33..37].copy_from_slice(b"LAME");
    frame[54..57].copy_from_slice(&(delay << 12 | padding).to_be_bytes()[1..]);
    frame
}

/// An ID3v2 tag of a body.
pub fn id3v2(flags: u8, body: &[u8]) -> Vec<u8> {
    let length = body.len() as u32;
    let sizes = [21, 14, 7, 0].map(|shift| (length >> shift & 0x7f) as u8);
    [&b"ID3\x03\0"[..], &[flags], &sizes, body].concat()
}

/// An Ogg page of whole packets; flags: 2 for the first page of a stream, 4 for the last.
pub fn ogg_page(flags: u8, position: i64, serial: u32, number: u32, packets: &[&[u8]]) -> Vec<u8> {
    let mut page = [&b"OggS\0"[..], &[flags], &position.to_le_bytes()].concat();
    page.extend([serial, number, 0].iter().flat_map(|value| value.to_le_bytes()));
    let sizes: Vec<u8> = packets
        .iter()
        .flat_map(|packet| [vec![255; packet.len() / 255], vec![(packet.len() % 255) as u8]].concat())
        .collect();
    page.push(u8::try_from(sizes.len()).unwrap());
    page.extend(sizes);
    page.extend(packets.concat());
    let sum = crc(&page, 32, 0x04c1_1db7);
    page[22..26].copy_from_slice(&sum.to_le_bytes());
    page
}

/// Ogg FLAC, a frame a page; its last page says so where `is_closed`.
pub fn ogg_flac(samples: &[i16], serial: u32, is_closed: bool) -> Vec<u8> {
    let info = flac_stream_info(0);
    let head = [&b"\x7fFLAC\x01\0\0\x01fLaC\0\0\0\x22"[..], &info].concat();
    let mut file = ogg_page(2, 0, serial, 0, &[&head]);
    file.extend(ogg_page(0, 0, serial, 1, &[b"\x84\0\0\x04junk"]));
    let blocks = samples.chunks(FLAC_BLOCK).count();
    for (index, block) in samples.chunks(FLAC_BLOCK).enumerate() {
        let frame = flac_frames(block, index as u8, FLAC_44100);
        let flags = if is_closed && index + 1 == blocks { 4 } else { 0 };
        file.extend(ogg_page(flags, ((index + 1) * FLAC_BLOCK) as i64, serial, index as u32 + 2, &[&frame]));
    }
    file
}

/// RF64 or BW64: all 32-bit sizes full, the true ones in a chunk of their own.
pub fn wav_64(mark: &[u8; 4], format: &[u8], sound: &[u8]) -> Vec<u8> {
    let mut file = [mark, &b"\xff\xff\xff\xffWAVEds64\x1c\0\0\0"[..]].concat();
    file.extend((72 + sound.len() as u64).to_le_bytes());
    file.extend((sound.len() as u64).to_le_bytes());
    file.extend([0; 12]);
    file.extend(b"fmt ");
    file.extend((format.len() as u32).to_le_bytes());
    file.extend(format);
    file.extend(b"data\xff\xff\xff\xff");
    file.extend(sound);
    file
}

/// Sony's Wave64.
pub fn wave64(format: &[u8], sound: &[u8]) -> Vec<u8> {
    const END: &[u8] = b"\xf3\xac\xd3\x11\x8c\xd1\0\xc0\x4f\x8e\xdb\x8a";
    let mut file = b"riff\x2e\x91\xcf\x11\xa5\xd6\x28\xdb\x04\xc1\0\0\0\0\0\0\0\0\0\0wave".to_vec();
    file.extend(END);
    for (id, body) in [(b"fmt ", format), (b"junk", b"abc"), (b"data", sound)] {
        file.extend(id);
        file.extend(END);
        file.extend((24 + body.len() as u64).to_le_bytes());
        file.extend(body);
        file.resize(file.len().next_multiple_of(8), 0);
    }
    let size = file.len() as u64;
    file[16..24].copy_from_slice(&size.to_le_bytes());
    file
}

/// One chunk of AIFF.
pub fn aiff_chunk(id: &[u8; 4], body: &[u8]) -> Vec<u8> {
    let mut chunk = [id, &(body.len() as u32).to_be_bytes()[..], body].concat();
    if body.len() % 2 == 1 {
        chunk.push(0);
    }
    chunk
}

/// AIFF's common chunk, mono at 44.1 kHz; a coding makes it AIFF-C's.
pub fn aiff_common(frames: u32, bits: u16, coding: &[u8]) -> Vec<u8> {
    let (exponent, mantissa) = AIFF_44100;
    let mut body = 1u16.to_be_bytes().to_vec();
    body.extend(frames.to_be_bytes());
    body.extend([bits, exponent, mantissa].iter().flat_map(|value| value.to_be_bytes()));
    body.extend([0; 6]);
    if !coding.is_empty() {
        body.extend(coding);
        body.extend([0, 0]);
    }
    aiff_chunk(b"COMM", &body)
}

/// AIFF's sound chunk, behind an offset filled with other bytes.
pub fn aiff_sound(offset: u32, sound: &[u8]) -> Vec<u8> {
    let body = [&offset.to_be_bytes(), &[0; 4][..], &vec![0x55; offset as usize], sound].concat();
    aiff_chunk(b"SSND", &body)
}

/// A whole AIFF (`AIFF`, `AIFC`) of chunks.
pub fn aiff(kind: &[u8; 4], chunks: &[Vec<u8>]) -> Vec<u8> {
    let body = chunks.concat();
    [&b"FORM"[..], &(4 + body.len() as u32).to_be_bytes(), kind, &body].concat()
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
