//! Vorbis I: the packets that are headers, and the samples that its clock leaves out.

use std::borrow::Cow;

use symphonia::core::codecs::audio::AudioCodecParameters;
use symphonia::core::codecs::audio::well_known::CODEC_ID_VORBIS;

use super::sound::{Link, SoundBounds};
use super::vorbis_clock::Clock;

/// Identification, comment and set-up precede the sound.
const HEADERS: usize = 3;

/// Rate in Hz and channels, from the identification.
pub(super) fn layout(head: &[u8]) -> Option<(u32, usize)> {
    let head = head.first_chunk::<30>()?;
    Some((u32::from_le_bytes(*head[12..].first_chunk()?), usize::from(head[11])))
}

/// The packets of sound; the comment is not examined.
pub(super) fn link(mut packets: Vec<Cow<'_, [u8]>>, clock: Clock) -> Option<Link<'_>> {
    let sound = packets.split_off(HEADERS.min(packets.len()));
    let [identification, _comment, set_up] = packets.as_slice() else { return None };
    let extra_data = [identification.as_ref(), set_up.as_ref()].concat();
    let mut parameters = AudioCodecParameters::new();
    parameters.for_codec(CODEC_ID_VORBIS).with_extra_data(extra_data.into());
    let ends = SoundBounds { clock: Some(clock.behind(HEADERS)), ..SoundBounds::default() };
    Some(Link { parameters, packets: sound, ends, declared_samples: None })
}
