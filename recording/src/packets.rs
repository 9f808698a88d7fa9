//! From compressed packets to samples.

use symphonia::core::audio::GenericAudioBufferRef;
use symphonia::core::codecs::audio::well_known::CODEC_ID_FLAC;
use symphonia::core::codecs::audio::{AudioDecoder, AudioDecoderOptions};
use symphonia::core::errors::Error as DecoderError;
use symphonia::core::packet::Packet;
use symphonia::core::units::{Duration, Timestamp};

use crate::error::clean;
use crate::format::{Described, Link, damaged};
use crate::{Error, Note, Progress};

/// Decodes consecutive links into one sound; adds notes about anything found on the way.
pub(crate) fn decode(
    links: &[Link],
    of: &mut Described,
    name: &str,
    progress: Progress,
) -> Result<Vec<Vec<f32>>, Error> {
    let total = links.iter().map(|link| link.packets.len()).sum::<usize>().max(1) as f32;
    let mut decoding = Decoding { of, name, channels: vec![], planes: vec![], undecoded: 0, last_fault: None };
    decoding.channels = vec![vec![]; decoding.of.channels];
    let mut done = 0;
    for link in links {
        decoding.link(link, &mut || {
            done += 1;
            progress((done as f32 / total).min(1.0))
        })?;
    }
    decoding.finish()
}

struct Decoding<'a> {
    of: &'a mut Described,
    name: &'a str,
    channels: Vec<Vec<f32>>,
    /// Samples of the last packet.
    planes: Vec<Vec<f32>>,
    undecoded: usize,
    last_fault: Option<&'static str>,
}

impl Decoding<'_> {
    fn link(&mut self, link: &Link, goes_on: &mut dyn FnMut() -> bool) -> Result<(), Error> {
        let is_lossless = link.parameters.codec == CODEC_ID_FLAC;
        let mut decoder = symphonia::default::get_codecs()
            .make_audio_decoder(&link.parameters, &AudioDecoderOptions::default())
            .map_err(|error| self.refuse(error))?;
        let start = self.len();
        let mut samples = Vec::with_capacity(link.packets.len());
        for (index, packet) in link.packets.iter().enumerate() {
            let before = self.len();
            let packet = Packet::new(0, Timestamp::ZERO, Duration::ZERO, packet.as_ref());
            match self.packet(decoder.as_mut(), &packet) {
                Ok(()) => {}
                // A truncated frame is the last one: if the length is known, the sound is shorter by it.
                Err(_) if is_lossless && index + 1 == link.packets.len() => {
                    if link.declared_samples.is_none() {
                        self.of.notes.push(Note::BreaksOff { what: "frame" });
                    }
                }
                Err(PacketFault::Decoder(DecoderError::DecodeError(reason))) if !is_lossless => {
                    self.undecodable(reason)
                }
                Err(PacketFault::Decoder(DecoderError::IoError(_))) if !is_lossless => {
                    self.undecodable("a truncated packet")
                }
                Err(PacketFault::Decoder(error)) => return Err(self.refuse(error)),
                Err(PacketFault::Error(error)) => return Err(error),
            }
            samples.push((self.len() - before) as u64);
            if !goes_on() {
                return Err(Error::Cancelled);
            }
        }
        self.check_count(link, (self.len() - start) as u64)?;
        self.cut_ends(link, start, &samples);
        Ok(())
    }

    fn len(&self) -> usize {
        self.channels.first().map_or(0, Vec::len)
    }

    fn packet(&mut self, decoder: &mut dyn AudioDecoder, packet: &Packet) -> Result<(), PacketFault> {
        let decoded = decoder.decode(packet).map_err(PacketFault::Decoder)?;
        if decoded.frames() == 0 {
            return Ok(());
        }
        self.check_layout(&decoded).map_err(PacketFault::Error)?;
        let length = (self.len() + decoded.frames()) as u64;
        self.of.check_length(length, self.name).map_err(PacketFault::Error)?;
        decoded.copy_to_vecs_planar(&mut self.planes);
        for (channel, plane) in self.channels.iter_mut().zip(&self.planes) {
            channel.extend_from_slice(plane);
        }
        Ok(())
    }

    fn check_layout(&self, decoded: &GenericAudioBufferRef) -> Result<(), Error> {
        let (rate_hz, channels) = (decoded.spec().rate(), decoded.spec().channels().count());
        if (rate_hz, channels) == (self.of.sample_rate_hz, self.of.channels) {
            return Ok(());
        }
        let (declared_hz, declared) = (self.of.sample_rate_hz, self.of.channels);
        let reason = format!("{channels} channels at {rate_hz} Hz where {declared} at {declared_hz} Hz are declared");
        Err(damaged(self.name, reason))
    }

    /// Silence as long as the previous packet keeps the rest in time.
    fn undecodable(&mut self, reason: &'static str) {
        self.undecoded += 1;
        self.last_fault = Some(reason);
        let is_first = self.len() == 0;
        let length = if is_first { 0 } else { self.planes.first().map_or(0, Vec::len) };
        for channel in &mut self.channels {
            channel.resize(channel.len() + length, 0.0);
        }
    }

    /// If a format states its exact length, exactly that much must be decoded.
    fn check_count(&mut self, link: &Link, found: u64) -> Result<(), Error> {
        match link.declared_samples {
            Some(declared) if found < declared => {
                Err(Error::Truncated { name: self.name.into(), found, declared, unit: "samples" })
            }
            Some(declared) if found > declared => {
                self.of.notes.push(Note::CountDiffers { declared, found, unit: "samples" });
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Removes the samples that the coder added.
    fn cut_ends(&mut self, link: &Link, start: usize, samples: &[u64]) {
        let found = self.len() - start;
        let by_clock = link.ends.clock.as_ref().map_or((0, 0), |clock| clock.ends(samples));
        let (skip_start, skip_end) = (link.ends.skip_start + by_clock.0, link.ends.skip_end + by_clock.1);
        let skip_start = usize::try_from(skip_start).unwrap_or(found).min(found);
        let skip_end = usize::try_from(skip_end).unwrap_or(found).min(found - skip_start);
        for channel in &mut self.channels {
            channel.truncate(start + found - skip_end);
            channel.drain(start..start + skip_start);
        }
    }

    fn finish(self) -> Result<Vec<Vec<f32>>, Error> {
        match self.last_fault {
            Some(reason) if self.len() == 0 => return Err(damaged(self.name, clean(reason))),
            None if self.len() == 0 => return Err(Error::NoSamples { name: self.name.into() }),
            _ => {}
        }
        if self.undecoded > 0 {
            self.of.notes.push(Note::Undecoded { packets: self.undecoded });
        }
        Ok(self.channels)
    }

    fn refuse(&self, error: DecoderError) -> Error {
        let name = self.name.to_string();
        match error {
            DecoderError::Unsupported(found) => {
                Error::Unsupported { name, found: format!("its kind of sound ({})", clean(found)) }
            }
            DecoderError::DecodeError(reason) => Error::Damaged { name, reason: clean(reason) },
            other => Error::Damaged { name, reason: clean(&other.to_string()) },
        }
    }
}

/// Reason why a packet gave no samples.
enum PacketFault {
    Decoder(DecoderError),
    Error(Error),
}
