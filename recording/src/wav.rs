//! Float WAV to anything that bytes can be written to.

use std::io::Write;

use crate::broadcast::{BEXT_BYTES, Broadcast, MOST_IXML_BYTES, bext};
use crate::channel_mask::channel_mask;

/// IEEE 754 floats, as `WAVEFORMATEX` numbers them.
const FLOAT: u16 = 3;
/// `WAVEFORMATEXTENSIBLE`, which more than two channels need to state their loudspeakers.
const EXTENSIBLE: u16 = 0xfffe;
/// Rest of a format's GUID, after its number.
const GUID_TAIL: [u8; 14] = [0, 0, 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71];

/// The size of the samples in bytes; fails, with the reason, if a WAV file cannot hold them.
pub(crate) fn data_bytes(channels: &[Vec<f32>]) -> Result<u32, String> {
    let bytes = 4 * channels.iter().map(|samples| samples.len() as u64).sum::<u64>();
    let room = u32::MAX - head_bytes(channels.len(), Some(&Broadcast::default())) - MOST_IXML_BYTES as u32;
    let fits = u32::try_from(bytes).ok().filter(|bytes| *bytes <= room);
    fits.ok_or_else(|| format!("{bytes} bytes of sound do not fit a WAV file"))
}

/// Writes `channels`, 1 to 10 of equal length that [`data_bytes`] has found to fit.
pub(crate) fn write(
    out: &mut impl Write,
    channels: &[Vec<f32>],
    sample_rate_hz: u32,
    broadcast: Option<&Broadcast>,
) -> std::io::Result<()> {
    let samples = channels.first().map_or(0, Vec::len);
    let data_bytes = (4 * samples * channels.len()) as u32;
    out.write_all(b"RIFF")?;
    out.write_all(&(head_bytes(channels.len(), broadcast) - 8 + data_bytes).to_le_bytes())?;
    out.write_all(b"WAVE")?;
    format(out, channels.len() as u16, sample_rate_hz)?;
    chunk(out, b"fact", 4)?;
    out.write_all(&(samples as u32).to_le_bytes())?;
    if let Some(broadcast) = broadcast {
        chunk(out, b"bext", BEXT_BYTES)?;
        out.write_all(&bext(broadcast))?;
        if let Some(ixml) = ixml(broadcast) {
            chunk(out, b"iXML", ixml.len() as u32)?;
            out.write_all(&ixml)?;
        }
    }
    chunk(out, b"data", data_bytes)?;
    for index in 0..samples {
        for samples in channels {
            out.write_all(&samples[index].to_le_bytes())?;
        }
    }
    out.flush()
}

/// Bytes before the samples, from the file's first.
fn head_bytes(channels: usize, broadcast: Option<&Broadcast>) -> u32 {
    let ixml_bytes = broadcast.and_then(ixml).map_or(0, |ixml| 8 + ixml.len() as u32);
    let broadcast_bytes = broadcast.map_or(0, |_| 8 + BEXT_BYTES);
    12 + (8 + format_bytes(channels)) + (8 + 4) + broadcast_bytes + ixml_bytes + 8
}

/// An iXML chunk's bytes, padded to even length by a space, which XML allows at its end; none for a text that is too
/// long.
fn ixml(broadcast: &Broadcast) -> Option<Vec<u8>> {
    let mut bytes = broadcast.ixml.as_ref()?.clone().into_bytes();
    if bytes.len() % 2 == 1 {
        bytes.push(b' ');
    }
    (bytes.len() as u64 <= MOST_IXML_BYTES).then_some(bytes)
}

fn format_bytes(channels: usize) -> u32 {
    if channels > 2 { 40 } else { 18 }
}

fn format(out: &mut impl Write, channels: u16, sample_rate_hz: u32) -> std::io::Result<()> {
    let bytes = format_bytes(usize::from(channels));
    let extra_bytes = bytes as u16 - 18;
    chunk(out, b"fmt ", bytes)?;
    out.write_all(&(if extra_bytes > 0 { EXTENSIBLE } else { FLOAT }).to_le_bytes())?;
    out.write_all(&channels.to_le_bytes())?;
    out.write_all(&sample_rate_hz.to_le_bytes())?;
    out.write_all(&(sample_rate_hz * 4 * u32::from(channels)).to_le_bytes())?;
    out.write_all(&(4 * channels).to_le_bytes())?;
    out.write_all(&32u16.to_le_bytes())?;
    out.write_all(&extra_bytes.to_le_bytes())?;
    if extra_bytes > 0 {
        out.write_all(&32u16.to_le_bytes())?;
        out.write_all(&channel_mask(usize::from(channels)).to_le_bytes())?;
        out.write_all(&FLOAT.to_le_bytes())?;
        out.write_all(&GUID_TAIL)?;
    }
    Ok(())
}

fn chunk(out: &mut impl Write, id: &[u8; 4], bytes: u32) -> std::io::Result<()> {
    out.write_all(id)?;
    out.write_all(&bytes.to_le_bytes())
}
