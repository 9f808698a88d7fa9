//! The outer chunks of WAV, AIFF and CAF files, checked before anything is decoded: sizes against
//! the bytes that are there, and the format against what can be played.

use crate::Error;

/// Refuses a file whose header is of no use or promises more than the file holds. Files of other
/// kinds pass: their decoders find out.
pub(crate) fn check(bytes: &[u8], name: &str) -> Result<(), Error> {
    match (bytes.get(..4), bytes.get(8..12)) {
        (Some(b"RIFF"), Some(b"WAVE")) => check_wav(bytes, name),
        (Some(b"RF64" | b"BW64"), _) => Err(unsupported(name, "WAV with 64-bit sizes (RF64)".into())),
        (Some(b"RIFX"), _) => Err(unsupported(name, "big-endian WAV (RIFX)".into())),
        (Some(b"RIFF"), None) | (Some(b"FORM"), None) => Err(damaged(name, "the header breaks off".into())),
        (Some(b"FORM"), Some(b"AIFF" | b"AIFC")) => check_aiff(bytes, name),
        (Some(b"caff"), _) => check_caf(bytes, name),
        _ => Ok(()),
    }
}

/// Sets a WAV file's outer size, which many programs leave wrong and players ignore, so that the
/// decoder does not stumble over it.
pub(crate) fn repair(bytes: &mut [u8]) {
    let size = u32::try_from(bytes.len().saturating_sub(8)).unwrap_or(u32::MAX);
    if bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WAVE") {
        bytes[4..8].copy_from_slice(&size.to_le_bytes());
    }
    if bytes.starts_with(b"FORM") && matches!(bytes.get(8..12), Some(b"AIFF" | b"AIFC")) {
        bytes[4..8].copy_from_slice(&size.to_be_bytes());
    }
}

/// A chunk: its name, the bytes of it that are there, and the size that its header declares.
struct Chunk<'a> {
    id: [u8; 4],
    body: &'a [u8],
    declared: u64,
}

impl Chunk<'_> {
    fn complete(&self, name: &str) -> Result<(), Error> {
        if (self.body.len() as u64) < self.declared {
            return Err(Error::Truncated {
                name: name.into(),
                found: self.body.len() as u64,
                declared: self.declared,
                unit: if matches!(&self.id, b"data" | b"SSND") { "bytes of sound" } else { "bytes of header" },
            });
        }
        Ok(())
    }
}

/// Chunks from `start` on; `header` reads a chunk header's length and the size it declares.
fn chunks<'a>(
    bytes: &'a [u8],
    start: usize,
    padded: bool,
    header: impl Fn(&'a [u8]) -> Option<(usize, u64)> + 'a,
) -> impl Iterator<Item = Chunk<'a>> + 'a {
    let mut rest = bytes.get(start..).unwrap_or_default();
    std::iter::from_fn(move || {
        let id = *rest.first_chunk::<4>()?;
        let (header_len, declared) = header(rest)?;
        let available = &rest[header_len..];
        let size = usize::try_from(declared).unwrap_or(usize::MAX).min(available.len());
        let (body, after) = available.split_at(size);
        rest = if padded && size % 2 == 1 { after.get(1..).unwrap_or_default() } else { after };
        Some(Chunk { id, body, declared })
    })
}

fn check_wav(bytes: &[u8], name: &str) -> Result<(), Error> {
    let le_u32 = |rest: &[u8]| Some((8, u64::from(u32::from_le_bytes(*rest.get(4..)?.first_chunk()?))));
    let mut format_seen = false;
    for chunk in chunks(bytes, 12, true, le_u32) {
        match &chunk.id {
            b"fmt " => {
                check_wav_format(&chunk, name)?;
                format_seen = true;
            }
            b"data" if !format_seen => return Err(damaged(name, "its sound comes before its format".into())),
            b"data" if chunk.declared == 0 => return Err(Error::NoSamples { name: name.into() }),
            b"data" => return chunk.complete(name),
            _ => chunk.complete(name)?,
        }
    }
    let missing = if format_seen { "data" } else { "fmt" };
    Err(damaged(name, format!("no {missing} chunk")))
}

/// Format tags and sample layouts: Microsoft's `WAVEFORMATEX` and `WAVEFORMATEXTENSIBLE`.
fn check_wav_format(chunk: &Chunk, name: &str) -> Result<(), Error> {
    chunk.complete(name)?;
    let body = chunk.body;
    if body.len() < 16 {
        return Err(damaged(name, format!("a format chunk of {} bytes, at least 16 are needed", body.len())));
    }
    let u16_at = |at: usize| u16::from_le_bytes([body[at], body[at + 1]]);
    let channels = usize::from(u16_at(2));
    let rate_hz = u32::from_le_bytes([body[4], body[5], body[6], body[7]]);
    let (frame_bytes, bits) = (usize::from(u16_at(12)), usize::from(u16_at(14)));
    check_layout(channels, Some(rate_hz), name)?;
    let tag = match u16_at(0) {
        0xfffe if body.len() >= 40 => u16_at(24),
        0xfffe => return Err(damaged(name, "an extensible format chunk that breaks off".into())),
        tag => tag,
    };
    let allowed: &[usize] = match tag {
        1 => &[8, 16, 24, 32],
        3 => &[32, 64],
        6 | 7 => &[8],
        2 | 0x11 => return Err(unsupported(name, "WAV with ADPCM coding".into())),
        other => return Err(unsupported(name, format!("WAV with coding 0x{other:04x}"))),
    };
    if !allowed.contains(&bits) {
        return Err(unsupported(name, format!("WAV with {bits} bits per sample in coding {tag}")));
    }
    if frame_bytes != channels * bits / 8 {
        let expected = channels * bits / 8;
        return Err(damaged(name, format!("frames of {frame_bytes} bytes where {expected} are expected")));
    }
    Ok(())
}

/// AIFF: big-endian chunks, padded to even sizes; the layout in `COMM`, the sound in `SSND`.
fn check_aiff(bytes: &[u8], name: &str) -> Result<(), Error> {
    let be_u32 = |rest: &[u8]| Some((8, u64::from(u32::from_be_bytes(*rest.get(4..)?.first_chunk()?))));
    let mut format_seen = false;
    let mut sound_bytes = 0;
    for chunk in chunks(bytes, 12, true, be_u32) {
        chunk.complete(name)?;
        match &chunk.id {
            b"COMM" if chunk.body.len() < 18 => return Err(damaged(name, "a format chunk that breaks off".into())),
            b"COMM" => {
                let body = chunk.body;
                let channels = usize::from(u16::from_be_bytes([body[0], body[1]]));
                check_layout(channels, None, name)?;
                check_aiff_rate(body, name)?;
                let frames = u64::from(u32::from_be_bytes([body[2], body[3], body[4], body[5]]));
                let bits = u64::from(u16::from_be_bytes([body[6], body[7]]));
                sound_bytes = frames * channels as u64 * bits.div_ceil(8);
                if sound_bytes == 0 {
                    return Err(Error::NoSamples { name: name.into() });
                }
                format_seen = true;
            }
            b"SSND" if chunk.body.len() <= 8 => return Err(Error::NoSamples { name: name.into() }),
            b"SSND" if format_seen => {
                // Eight bytes of offset and block size stand before the sound.
                let found = chunk.body.len() as u64 - 8;
                return if found < sound_bytes {
                    let (name, unit) = (name.into(), "bytes of sound");
                    Err(Error::Truncated { name, found, declared: sound_bytes, unit })
                } else {
                    Ok(())
                };
            }
            _ => {}
        }
    }
    Err(damaged(name, if format_seen { "no SSND chunk" } else { "no COMM chunk before the sound" }.into()))
}

/// The rate stands as an 80-bit float: sign and exponent (bias 16383), then a 64-bit mantissa with
/// its leading one.
fn check_aiff_rate(comm: &[u8], name: &str) -> Result<(), Error> {
    let exponent = i32::from(u16::from_be_bytes([comm[8], comm[9]]) & 0x7fff) - 16383;
    let mantissa = comm[10..18].iter().fold(0u64, |sum, byte| sum << 8 | u64::from(*byte));
    let rate_hz = mantissa as f64 * 2f64.powi(exponent - 63);
    let negative = comm[8] & 0x80 != 0;
    check_layout(1, Some(if negative { 0 } else { rate_hz.round() as u32 }), name)
}

/// CAF (Apple's Core Audio Format): 64-bit big-endian sizes; -1 for sound up to the end of the file.
fn check_caf(bytes: &[u8], name: &str) -> Result<(), Error> {
    let be_i64 = |rest: &[u8]| Some((12, i64::from_be_bytes(*rest.get(4..)?.first_chunk()?) as u64));
    let mut format_seen = false;
    for chunk in chunks(bytes, 8, false, be_i64) {
        let open_ended = &chunk.id == b"data" && chunk.declared == u64::MAX;
        if !open_ended {
            chunk.complete(name)?;
        }
        match &chunk.id {
            b"desc" if chunk.body.len() < 32 => return Err(damaged(name, "a format chunk that breaks off".into())),
            b"desc" => {
                let body = chunk.body;
                if &body[8..12] != b"lpcm" {
                    let coding: String = body[8..12].iter().map(|byte| char::from(*byte)).collect();
                    return Err(unsupported(name, format!("CAF with coding '{}'", coding.escape_default())));
                }
                let u32_at = |at: usize| u32::from_be_bytes([body[at], body[at + 1], body[at + 2], body[at + 3]]);
                let rate_hz = f64::from_be_bytes(*body.first_chunk().unwrap_or(&[0; 8]));
                let (channels, bits) = (u32_at(24) as usize, u32_at(28) as usize);
                check_layout(channels, Some(rate_hz as u32), name)?;
                let (packet_bytes, packet_frames) = (u32_at(16) as usize, u32_at(20));
                if packet_frames != 1 || packet_bytes != channels * bits / 8 || !matches!(bits, 8 | 16 | 24 | 32 | 64) {
                    let found = format!("CAF with {bits} bits per sample in packets of {packet_bytes} bytes");
                    return Err(unsupported(name, found));
                }
                format_seen = true;
            }
            b"data" if chunk.body.len() <= 4 => return Err(Error::NoSamples { name: name.into() }),
            // An edit count of four bytes stands before the sound.
            b"data" if format_seen => return Ok(()),
            // A table of packets belongs to compressed sound only, and its count is not to be trusted.
            b"pakt" => return Err(unsupported(name, "CAF with a packet table".into())),
            _ => {}
        }
    }
    Err(damaged(name, if format_seen { "no data chunk" } else { "no desc chunk before the sound" }.into()))
}

/// Refuses channel counts and rates that no engine takes.
pub(crate) fn check_layout(channels: usize, rate_hz: Option<u32>, name: &str) -> Result<(), Error> {
    let name = || name.to_string();
    match (channels, rate_hz) {
        (0, _) => Err(Error::NoChannels { name: name() }),
        (found, _) if found > crate::MAX_CHANNELS => Err(Error::TooManyChannels { name: name(), found }),
        (_, Some(found_hz)) if !(crate::MIN_SAMPLE_RATE_HZ..=crate::MAX_SAMPLE_RATE_HZ).contains(&found_hz) => {
            Err(Error::SampleRate { name: name(), found_hz })
        }
        _ => Ok(()),
    }
}

fn damaged(name: &str, reason: String) -> Error {
    Error::Damaged { name: name.into(), reason }
}

fn unsupported(name: &str, found: String) -> Error {
    Error::Unsupported { name: name.into(), found }
}
