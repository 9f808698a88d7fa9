//! Vortex sound: the whoosh of turbulent flow (Dobashi, Yamamoto & Nishita 2004).
//!
//! p(t) = sum over sources of Q(u_i, t - r_i/c0) / r_i^n (eq. 5): every source reads the texture Q of what a small
//! turbulent region radiates, by its flow speed u_i and as late as its distance r_i tells. All that moves, moves
//! linearly from hop to hop on the host's timeline.
//!
//! | module | does |
//! |---|---|
//! | [`texture`] | what a region radiates, by flow speed |
//! | [`bank`] | a texture made ready for an output rate |
//! | `level` | the rows and the level of a speed |
//! | [`field`] | places and speeds that a simulation told; `field_file`: as bytes |
//! | [`live`] | a flow that is simulated while it sounds |
//! | `source` | what a seed decides of a source |
//! | `motion` | which of these two tells the sources |
//! | `moving` | controls without jumps |
//! | `read` | the inner loop |
//! | [`layout`] | receivers and channels |
//! | `microphone` | the largest pressure |
//! | [`shipped`] | the textures that come with the engines |

pub mod bank;
pub mod field;
mod field_file;
pub mod layout;
mod level;
pub mod live;
mod microphone;
mod motion;
mod moving;
mod read;
pub mod shipped;
mod source;
pub mod texture;

pub use bank::Bank;
pub use field::{End, SpeedField};
pub use layout::Layout;
pub use live::{Asked, Simulator};
pub use shipped::TEXTURES;
pub use texture::VortexTexture;

use std::sync::Arc;

use crate::controls::{DriveControls, Flow, VortexControls};
use crate::drive::envelope::Envelope;
use crate::error::{Error, in_range, within};
use layout::{MOST_CHANNELS, Panner};
use level::Blend;
use live::Live;
use microphone::limited;
use motion::Motion;
use moving::{Frame, Moving, Stand};
use read::{Gain, Part, Reader};
use source::{Edge, Identity, Source};

/// Speed of sound in m/s.
pub const SPEED_OF_SOUND_M_S: f64 = 343.0;

/// Radius in m of the near field: pressure falls with sqrt(r^2 + `NEAR_M`^2) instead of r, so that it stays finite at
/// the source. From 2 m on that is less than 0.07 dB.
pub const NEAR_M: f64 = 0.25;

/// Most sources of a renderer.
pub const MOST_SOURCES: usize = 16_384;

/// Samples of a hop at about 48 kHz; at other rates it lasts about as long.
const HOP: f64 = 64.0;

/// Part of the speed of sound at which a source's distance follows a jump at most.
const FASTEST: f64 = 0.5;

/// Hops over which what sounded before an exchange dies away.
const FAREWELL_HOPS: usize = 4;

/// Drive beyond this magnitude is a broken signal.
const LARGEST_DRIVE: f64 = 1e4;

/// What is left of a full-scale drive, in nepers, where there is no threshold: the envelope's own end.
const SILENCE_NEPERS: f64 = 27.7;

/// The renderer of vortex sound.
///
/// It has no latency. Hops stand on multiples of their length on the host's timeline, each rendered when its first
/// sample is asked for; so output does not depend on how blocks are cut, and, given constant controls and flow, is a
/// function of the position. Speeds by envelope follow it one hop (1.3 ms) late.
#[derive(Debug)]
pub struct Vortex {
    sample_rate_hz: f64,
    hop: usize,
    channels: usize,
    panner: Panner,
    bank: Option<Arc<Bank>>,
    field: Option<Arc<SpeedField>>,
    live: Option<Live>,
    sources: Vec<Source>,
    envelope: Envelope,
    /// The envelope after the last sample.
    envelope_now: f64,
    follow: Vec<f64>,
    moving: Moving,
    reader: Reader,
    /// Pressures of the hop by channel.
    pressures: Vec<Vec<f32>>,
    /// The hop's output by channel.
    ready: Vec<Vec<f64>>,
    /// Position of the next sample.
    position: i64,
    /// Whether nothing has been rendered since reset.
    is_fresh: bool,
    /// What told the speeds in the last hop.
    flow: Flow,
    /// Whether a bank or field that is heard was exchanged during the last hop.
    is_exchanged: bool,
    /// Last outputs before an exchange and their slopes per sample; hops since.
    farewell: Vec<[f64; 2]>,
    farewell_hop: usize,
}

/// What is the same for all sources in a hop.
struct Hop<'a> {
    bank: &'a Bank,
    motion: Motion<'a>,
    frame: Frame,
    stand: Stand,
    index: i64,
    /// Position of the hop's first sample.
    start: f64,
    /// Logarithms of the envelope's speed and of the reference's gain.
    ln_speed: f32,
    ln_reference: f32,
    /// Whether the sources of an envelope stand where they stood.
    stays: bool,
}

impl Vortex {
    /// A renderer at position 0, without bank and field: it is silent until it gets a bank.
    ///
    /// Fails where `sample_rate_hz` is not 8,000-384,000, or `sources`, the most that it will render, not 1-16,384.
    pub fn new(sample_rate_hz: f64, layout: Layout, sources: usize) -> Result<Self, Error> {
        in_range("sample rate in Hz", sample_rate_hz, 8_000.0, 384_000.0)?;
        in_range("number of sources", sources as f64, 1.0, MOST_SOURCES as f64)?;
        let hop = (HOP * 2f64.powf((sample_rate_hz / 48_000.0).log2().round())) as usize;
        let channels = layout.channels();
        Ok(Self {
            sample_rate_hz,
            hop,
            channels,
            panner: Panner::new(layout),
            bank: None,
            field: None,
            live: None,
            sources: vec![Source::default(); sources],
            envelope: Envelope::new(sample_rate_hz),
            envelope_now: 0.0,
            follow: vec![0.0; hop],
            moving: Moving::new(sample_rate_hz / hop as f64),
            reader: Reader::new(hop),
            pressures: vec![vec![0.0; hop]; channels],
            ready: vec![vec![0.0; hop]; channels],
            position: 0,
            is_fresh: true,
            flow: Flow::Envelope,
            is_exchanged: false,
            farewell: vec![[0.0; 2]; channels],
            farewell_hop: FAREWELL_HOPS,
        })
    }

    /// The output is not delayed.
    pub fn latency_samples(&self) -> usize {
        0
    }

    /// Samples for which output may differ from 0 after a full-scale drive has ended: the envelope's release down to
    /// its threshold, and two hops. None where a field drives the sources, which ends never.
    pub fn tail_samples(&self, controls: &VortexControls) -> Option<usize> {
        let release_s = within(controls.release_s, 1e-3, 5.0);
        let nepers = (-within(controls.threshold, 0.0, 1.0).ln()).clamp(0.0, SILENCE_NEPERS);
        let release = (release_s * nepers * self.sample_rate_hz).ceil() as usize;
        (controls.flow == Flow::Envelope).then_some(release + 2 * self.hop + FAREWELL_HOPS * self.hop)
    }

    /// Samples of a hop, a function of the sample rate alone.
    pub fn hop_samples(&self) -> usize {
        self.hop
    }

    /// Number of channels.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Most sources that are rendered.
    pub fn sources(&self) -> usize {
        self.sources.len()
    }

    /// Exchanges the bank and returns the one before. From the next hop on the new one fades in; one of another sample
    /// rate stays silent.
    pub fn swap_bank(&mut self, bank: Option<Arc<Bank>>) -> Option<Arc<Bank>> {
        self.is_exchanged = true;
        std::mem::replace(&mut self.bank, bank)
    }

    /// Exchanges the speed field and returns the one before. From the next hop on the new one fades in.
    pub fn swap_field(&mut self, field: Option<Arc<SpeedField>>) -> Option<Arc<SpeedField>> {
        self.is_exchanged |= self.flow == Flow::Field;
        std::mem::replace(&mut self.field, field)
    }

    /// Takes a simulation for [`Flow::Live`], whose sources stand at `places`, in m to the right, to the front and up from
    /// where the controls place the middle. Its steps last [`live_step_s`](Self::live_step_s). Not for the audio thread.
    ///
    /// Fails without a place, and where one is no number or farther than 100 km.
    pub fn set_simulator(&mut self, simulator: Box<dyn Simulator>, places: &[[f32; 3]]) -> Result<(), Error> {
        self.live = Some(Live::new(simulator, places, live::hops_per_step(self.sample_rate_hz, self.hop))?);
        Ok(())
    }

    /// Seconds that a step of a live simulation lasts, about 1/60.
    pub fn live_step_s(&self) -> f64 {
        live::hops_per_step(self.sample_rate_hz, self.hop) as f64 * self.hop as f64 / self.sample_rate_hz
    }

    /// Steps of the live simulation that came too late since the last call.
    pub fn take_late(&mut self) -> u64 {
        self.live.as_mut().map_or(0, Live::take_late)
    }

    /// Back to silence; the next sample stands at `position` on the host's timeline. Bank and field stay.
    pub fn reset(&mut self, position: i64) {
        // Room for centuries of sound on either side, whose places in the period are still exact enough.
        self.position = position.clamp(-(1 << 50), 1 << 50);
        self.envelope.reset();
        self.envelope_now = 0.0;
        self.ready.iter_mut().for_each(|channel| channel.fill(0.0));
        self.is_fresh = true;
        self.is_exchanged = false;
        self.farewell_hop = FAREWELL_HOPS;
        if let Some(live) = &mut self.live {
            live.stop();
        }
    }

    /// Renders one block of any length into `outputs`, whose channels are as long as `drive`; channels that the layout
    /// does not have stay silent. A hop works with the `controls` in force at its first sample. Where a field tells the
    /// speeds, `drive` is of no account but for its length.
    pub fn process(&mut self, drive: &[f64], controls: &VortexControls, outputs: &mut [&mut [f64]]) {
        let count = outputs.iter().map(|channel| channel.len()).fold(drive.len(), usize::min);
        let follow = DriveControls {
            attack_s: controls.attack_s,
            release_s: controls.release_s,
            threshold: controls.threshold,
            ..DriveControls::default()
        };
        let mut done = 0;
        while done < count {
            let into = self.position.rem_euclid(self.hop as i64) as usize;
            if into == 0 || self.is_fresh {
                self.render(self.position - into as i64, controls);
            }
            let step = (self.hop - into).min(count - done);
            let envelope = &mut self.follow[..step];
            for (kept, sample) in envelope.iter_mut().zip(&drive[done..]) {
                *kept = if sample.is_nan() { 0.0 } else { sample.clamp(-LARGEST_DRIVE, LARGEST_DRIVE) };
            }
            self.envelope.process(&follow, envelope);
            self.envelope_now = envelope.last().copied().unwrap_or(0.0);
            for (channel, output) in outputs.iter_mut().enumerate() {
                let output = &mut output[done..done + step];
                match self.ready.get(channel) {
                    Some(ready) => output.copy_from_slice(&ready[into..into + step]),
                    None => output.fill(0.0),
                }
            }
            done += step;
            self.position += step as i64;
        }
    }

    /// Renders the hop that starts at `start`.
    fn render(&mut self, start: i64, controls: &VortexControls) {
        let was_fresh = std::mem::replace(&mut self.is_fresh, false);
        if std::mem::take(&mut self.is_exchanged) && !was_fresh {
            self.sources.iter_mut().for_each(|source| source.presence = 0.0);
            for (farewell, ready) in self.farewell.iter_mut().zip(&self.ready) {
                if let [.., before, last] = ready[..] {
                    *farewell = [last, last - before];
                }
            }
            self.farewell_hop = 0;
        }
        self.flow = controls.flow;
        // Out of the way of what changes meanwhile; neither takes anything from the heap.
        let (field, mut live) = (self.field.take(), self.live.take());
        let identity = Identity { seed: controls.seed, flow: controls.flow };
        if was_fresh {
            self.moving.jump(controls);
        }
        let before = self.moving.now();
        let frame = self.moving.next(controls);
        let speed_m_s = frame.speed_m_s * self.envelope_now.powf(frame.curve);
        if let Some(live) = &mut live {
            if controls.flow == Flow::Live { live.advance(speed_m_s) } else { live.stop() }
        }
        let ends = [start, start + self.hop as i64];
        let offset_s = within(controls.field_offset_s, -3600.0, 3600.0);
        let place = |field: &SpeedField| ends.map(|at| field.place(at as f64 / self.sample_rate_hz + offset_s));
        let motion = Motion { field: field.as_deref().map(|field| (field, place(field))), live: live.as_ref() };
        let wanted = if controls.flow == Flow::Envelope { controls.count } else { motion.sources(controls.flow) };
        if was_fresh {
            for (index, source) in self.sources.iter_mut().enumerate() {
                *source = Source::new(index, identity);
                source.presence = f32::from(u8::from(index < wanted));
            }
        }
        self.pressures.iter_mut().for_each(|channel| channel.fill(0.0));
        let bank = self.bank.take();
        if let Some(bank) = bank.as_deref().filter(|bank| bank.sample_rate_hz() == self.sample_rate_hz) {
            let hop = Hop {
                bank,
                motion,
                frame,
                stand: frame.place.stand(),
                index: start.div_euclid(self.hop as i64),
                start: start as f64,
                ln_speed: if self.envelope_now > 0.0 { speed_m_s.ln() as f32 } else { f32::NEG_INFINITY },
                ln_reference: bank.levels().ln_gain(frame.ln_reference as f32),
                stays: frame.place == before.place && !was_fresh,
            };
            let mut sources = std::mem::take(&mut self.sources);
            for (index, source) in sources.iter_mut().enumerate() {
                let present = source.turn(index, hop.index, index < wanted, identity);
                if present > 0.0 || source.presence > 0.0 {
                    self.render_source(&hop, index, source, present, was_fresh);
                }
            }
            self.sources = sources;
        }
        self.bank = bank;
        (self.field, self.live) = (field, live);
        self.finish(&before, &frame);
    }

    /// Adds one source, whose presence was `present` at the hop's start.
    fn render_source(&mut self, hop: &Hop<'_>, index: usize, source: &mut Source, present: f32, is_fresh: bool) {
        if is_fresh {
            // Sound starts in its midst.
            source.edge = self.edge(hop, false, index, source, false);
        }
        let heard = present > 0.0 && source.edge.gains.iter().any(|gain| *gain != 0.0);
        let end = self.edge(hop, true, index, source, heard);
        // What was not heard may have stood anywhere.
        let start = if heard { source.edge } else { Edge { gains: [0.0; MOST_CHANNELS], ..end } };
        source.edge = end;

        let mut rows = [(0, 0.0, 0.0); 4];
        let mut count = 0;
        for (row, weight) in start.blend.rows() {
            rows[count] = (row, weight, 0.0);
            count += 1;
        }
        for (row, weight) in end.blend.rows() {
            match rows[..count].iter_mut().find(|(known, ..)| *known == row) {
                Some((_, _, to)) => *to = weight,
                None => {
                    rows[count] = (row, 0.0, weight);
                    count += 1;
                }
            }
        }
        let mut gains = [Gain { channel: 0, from: 0.0, to: 0.0 }; MOST_CHANNELS];
        let mut audible = 0;
        for (channel, (from, to)) in start.gains.iter().zip(end.gains).enumerate() {
            let gain = Gain { channel, from: present * from, to: source.presence * to };
            if gain.from != 0.0 || gain.to != 0.0 {
                gains[audible] = gain;
                audible += 1;
            }
        }
        if count == 0 || audible == 0 {
            return;
        }

        let period = hop.bank.period() as f64;
        let rate_hz = source.pace * hop.bank.rate_hz();
        let steps_per_m = rate_hz / SPEED_OF_SOUND_M_S;
        let begun = hop.start * (rate_hz / self.sample_rate_hz) % period;
        let at = begun + source.offset * period - start.distance_m * steps_per_m;
        let at = at - period * (at / period).floor();
        // Rounding may reach the period itself.
        let first = (at as usize).min(hop.bank.period() - 1);
        let nearer = (start.distance_m - end.distance_m) / self.hop as f64;
        let step = rate_hz / self.sample_rate_hz + nearer * steps_per_m;
        let mut parts = [Part { series: &[], from: 0.0, change: 0.0 }; 4];
        for (part, (row, from, to)) in parts.iter_mut().zip(&rows[..count]) {
            let (scale, series) = hop.bank.series(*row, source.direction, first);
            *part = Part { series, from: scale * from, change: scale * (to - from) };
        }
        let phase = (at - first as f64).max(0.0) as f32;
        self.reader.process(&parts[..count], phase, step as f32, &gains[..audible], &mut self.pressures);
    }

    /// What a source sounds like at the start of the hop, or at its `end`; `heard` tells whether its edge is what it sounded like before.
    fn edge(&self, hop: &Hop<'_>, end: bool, index: usize, source: &Source, heard: bool) -> Edge {
        let place = &hop.stand;
        let (position, ln_speed, presence) = if source.identity.flow == Flow::Envelope {
            let deviation = hop.frame.variation as f32 * source.deviation;
            (None, hop.ln_speed + deviation.ln_1p(), 1.0)
        } else if let Some(told) = hop.motion.at(source.identity.flow, index, end) {
            let speed = hop.frame.field_speed * told.speed_m_s;
            (Some(place.at(told.position)), speed.ln() as f32, told.presence)
        } else {
            return Edge { distance_m: source.edge.distance_m, ..Edge::default() };
        };
        let blend = hop.bank.levels().at(ln_speed, hop.frame.range as f32, hop.ln_reference);
        if heard && source.edge.settled && hop.stays && position.is_none() {
            return Edge { blend, ..source.edge };
        }
        let position = position.unwrap_or_else(|| place.in_ball(source.ball));
        let distance_m = position.iter().map(|x| x * x).sum::<f64>().sqrt();
        let level = (presence * place.attenuation(distance_m)) as f32;
        let gains = self.panner.gains(position).map(|gain| level * gain);
        // A distance that jumps is walked: the time that a source is heard at must go on.
        let walk = FASTEST * SPEED_OF_SOUND_M_S * self.hop as f64 / self.sample_rate_hz;
        let delayed_m = if heard {
            source.edge.distance_m + (distance_m - source.edge.distance_m).clamp(-walk, walk)
        } else {
            distance_m
        };
        Edge { blend, gains, distance_m: delayed_m, settled: delayed_m == distance_m }
    }

    /// From pressures to output: the microphone, the level, and what an exchange left.
    fn finish(&mut self, from: &Frame, to: &Frame) {
        let per_sample = 1.0 / self.hop as f64;
        for ((pressures, ready), [last, slope]) in self.pressures.iter().zip(&mut self.ready).zip(&self.farewell) {
            for (n, (pressure, out)) in pressures.iter().zip(ready.iter_mut()).enumerate() {
                let part = n as f64 * per_sample;
                let level = from.level + part * (to.level - from.level);
                let most = from.max_pressure_pa + part * (to.max_pressure_pa - from.max_pressure_pa);
                *out = level * limited(f64::from(*pressure), most);
                if self.farewell_hop < FAREWELL_HOPS {
                    // It goes on as it went, but not for long.
                    let hops = self.farewell_hop as f64 + part;
                    let went_on = slope * (1.0 + hops * self.hop as f64) * (-8.0 * hops).exp();
                    *out += (last + went_on) * (1.0 - hops / FAREWELL_HOPS as f64).powi(2);
                }
            }
        }
        self.farewell_hop = (self.farewell_hop + 1).min(FAREWELL_HOPS);
    }
}

impl Blend {
    /// The rows that sound, with their amplitudes.
    fn rows(self) -> impl Iterator<Item = (usize, f32)> {
        (self.row..).zip(self.weights).filter(|(_, weight)| *weight > 0.0)
    }
}
