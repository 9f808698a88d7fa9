//! Ogg (RFC 3533): pages, and the packets of Vorbis or FLAC that they carry.
//!
//! Pages are checked by checksum and number, so that nothing is lost silently. A stream after the end of another begins
//! a new link; parallel streams are left out.

use std::borrow::Cow;

use super::described::{Described, check_layout, damaged, unsupported};
use super::ogg_page::{Page, pages};
use super::sound::{Link, Sound, SoundBounds};
use super::vorbis;
use super::vorbis_clock::Clock;
use crate::format::flac::StreamInfo;
use crate::{Error, Note};

/// First bytes of the first packet, for codings that are not supported.
const UNSUPPORTED: &[(&[u8], &str)] = &[
    (b"OpusHead", "Ogg with Opus coding"),
    (b"Speex   ", "Ogg with Speex coding"),
    (b"\x80theora", "a video (Theora)"),
];

/// Codings that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Coding {
    Vorbis,
    Flac,
}

/// One logical stream.
struct Stream<'a> {
    serial: u32,
    coding: Coding,
    next_page: u32,
    packets: Vec<Cow<'a, [u8]>>,
    /// The start of a packet that continues on the next page.
    open: Option<Vec<u8>>,
    clock: Clock,
    has_ended: bool,
}

/// Reads all pages.
pub(super) fn read<'a>(bytes: &'a [u8], name: &str) -> Result<(Described, Sound<'a>), Error> {
    let mut streams: Vec<Stream> = vec![];
    let (mut notes, mut refused) = (vec![], None);
    for page in pages(bytes) {
        let page = match page {
            Ok(page) => page,
            Err(fault) if fault.is_at_end => {
                notes.push(Note::BreaksOff { what: "page" });
                break;
            }
            Err(fault) => return Err(damaged(name, format!("the page at byte {} has a wrong checksum", fault.at))),
        };
        let has_open = streams.last().is_some_and(|stream| !stream.has_ended && stream.packets.len() <= 1);
        match coding(&page) {
            Some(_) if has_open => notes.push(Note::LeftOut { what: "a second stream of sound beside the first" }),
            Some(coding) => streams.push(Stream::new(&page, coding)),
            None if page.is_first => refused = refused.or_else(|| Some(refusal(page.body))),
            None => {}
        }
        if let Some(stream) = streams.last_mut().filter(|stream| stream.serial == page.serial) {
            stream.add(&page, name)?;
        }
    }
    if streams.is_empty() {
        let found = refused.unwrap_or("Ogg without its first page");
        return Err(if refused.is_some() {
            unsupported(name, found)
        } else {
            damaged(name, "its Ogg header is truncated")
        });
    }
    if streams.iter().any(|stream| !stream.has_ended) && notes.is_empty() {
        notes.push(Note::BreaksOff { what: "page" });
    }
    join(streams, notes, name)
}

fn coding(page: &Page) -> Option<Coding> {
    match page.body {
        body if !page.is_first || body.is_empty() => None,
        body if body.starts_with(b"\x01vorbis") => Some(Coding::Vorbis),
        body if body.starts_with(b"\x7fFLAC") => Some(Coding::Flac),
        _ => None,
    }
}

fn refusal(body: &[u8]) -> &'static str {
    let found = UNSUPPORTED.iter().find(|(mark, _)| body.starts_with(mark));
    found.map_or("Ogg with an unknown coding", |(_, found)| found)
}

impl<'a> Stream<'a> {
    fn new(page: &Page<'a>, coding: Coding) -> Self {
        let clock = Clock::default();
        let (serial, next_page) = (page.serial, page.number);
        Self { serial, coding, next_page, packets: vec![], open: None, clock, has_ended: false }
    }

    fn add(&mut self, page: &Page<'a>, name: &str) -> Result<(), Error> {
        if page.number != self.next_page {
            let (found, expected) = (page.number, self.next_page);
            return Err(damaged(name, format!("page {found} follows where page {expected} is expected")));
        }
        self.next_page = page.number.wrapping_add(1);
        let mut is_continued = page.is_continued;
        for (piece, is_whole) in page.pieces() {
            let open = self.open.take().filter(|_| is_continued);
            // The continuation of a page from before the start is not a packet.
            let has_start = !is_continued || open.is_some();
            is_continued = false;
            let packet = match open {
                Some(mut open) => {
                    open.extend(piece);
                    Cow::Owned(open)
                }
                None => Cow::Borrowed(piece),
            };
            match is_whole {
                true if has_start => self.packets.push(packet),
                true => {}
                false => self.open = has_start.then(|| packet.into_owned()),
            }
        }
        if let Some(position) = page.position {
            self.clock.set(self.packets.len(), position);
        }
        self.has_ended |= page.is_last;
        Ok(())
    }

    /// Rate, channels and packets.
    fn link(self, name: &str) -> Result<(u32, usize, Link<'a>), Error> {
        let broken = || damaged(name, "its Ogg header is truncated");
        match self.coding {
            Coding::Vorbis => {
                let (rate_hz, channels) =
                    self.packets.first().and_then(|head| vorbis::layout(head)).ok_or_else(broken)?;
                let link = vorbis::link(self.packets, self.clock).ok_or_else(broken)?;
                Ok((rate_hz, channels, link))
            }
            Coding::Flac => {
                // After the mark and the versions come a native stream's mark and its first block with a header.
                let info =
                    self.packets.first().and_then(|head| StreamInfo::read(head.get(17..)?)).ok_or_else(broken)?;
                let is_frame = |packet: &Cow<[u8]>| packet.first() == Some(&0xff);
                let packets = self.packets.into_iter().filter(is_frame).collect();
                let (parameters, declared_samples) = (info.parameters(), info.samples);
                let link = Link { parameters, packets, ends: SoundBounds::default(), declared_samples };
                Ok((info.sample_rate_hz, info.channels, link))
            }
        }
    }
}

/// The streams in sequence, which must all have one layout.
fn join<'a>(streams: Vec<Stream<'a>>, notes: Vec<Note>, name: &str) -> Result<(Described, Sound<'a>), Error> {
    let mut links = vec![];
    let mut layout: Option<(u32, usize)> = None;
    for stream in streams {
        let (rate_hz, channels, link) = stream.link(name)?;
        check_layout(channels, Some(rate_hz), name)?;
        let (first_rate_hz, first_channels) = *layout.get_or_insert((rate_hz, channels));
        let changes = [
            ("sample rate in Hz", first_rate_hz, rate_hz),
            ("number of channels", first_channels as u32, channels as u32),
        ];
        if let Some((what, from, to)) = changes.into_iter().find(|(_, from, to)| from != to) {
            // The position of the second stream is unknown before the first is decoded.
            return Err(Error::ChangesBetween { name: name.into(), what, from, to });
        }
        links.push(link);
    }
    let (sample_rate_hz, channels) = layout.ok_or_else(|| damaged(name, "its Ogg header is truncated"))?;
    Ok((Described { channels, sample_rate_hz, notes }, Sound::Packets(links)))
}
