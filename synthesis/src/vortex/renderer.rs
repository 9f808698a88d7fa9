//! The renderer: state, exchanges, and hops on the host's timeline.

use std::sync::Arc;

use super::bank::Bank;
use super::declick::{self, Declick};
use super::field::SpeedField;
use super::follower::Follower;
use super::hop::Hop;
use super::layout::{Panner, SpeakerLayout};
use super::live::{Live, Simulator, hops_per_step};
use super::moving::ControlSnapshot;
use super::output::HopOutput;
use super::read::Reader;
use super::source::VortexSource;
use super::upsampler;
use crate::controls::{Flow, VortexControls};
use crate::error::{Error, in_range, within};

/// Most sources of a renderer.
pub const MOST_SOURCES: usize = 16_384;

/// Samples of a hop at about 48 kHz; at other rates it lasts about as long.
const HOP: f64 = 128.0;

/// Decay of a full-scale drive, in nepers, without a threshold: the envelope's own end, -240 dBFS.
const SILENCE_NEPERS: f64 = 27.7;

/// The renderer of vortex sound.
///
/// Hops are aligned with multiples of their length on the host's timeline. The sound of a hop is decided at its first
/// sample; its sources are then summed a few at a time during the hop, and heard in the next one. So the load is as
/// even as blocks are. Output does not depend on the division into blocks and, with constant controls and flow, is a
/// function of the position. Speeds from the envelope follow it one hop (2.7 ms) late.
#[derive(Debug)]
pub struct Vortex {
    pub(super) sizes: Sizes,
    pub(super) panner: Panner,
    pub(super) bank: Option<Arc<Bank>>,
    pub(super) field: Option<Arc<SpeedField>>,
    pub(super) live: Option<Live>,
    pub(super) sources: Vec<VortexSource>,
    pub(super) follower: Follower,
    pub(super) moving: ControlSnapshot,
    pub(super) reader: Reader,
    pub(super) present: Hop,
    pub(super) output: HopOutput,
    pub(super) state: RenderState,
    pub(super) declick: Declick,
}

/// What sample rate and speaker layout decide.
#[derive(Debug)]
pub(super) struct Sizes {
    pub sample_rate_hz: f64,
    /// Samples of a hop.
    pub hop: usize,
    /// Samples of the output per sample that sources are summed at.
    pub factor: usize,
    pub channels: usize,
}

/// Progress of rendering.
#[derive(Debug)]
pub(super) struct RenderState {
    /// Position of the next sample.
    pub position: i64,
    /// True if nothing has been rendered since the reset.
    pub is_fresh: bool,
    /// Origin of the speeds in the last hop.
    pub flow: Flow,
    /// True if an audible bank or field was exchanged during the last hop.
    pub is_exchanged: bool,
}

impl Vortex {
    /// A renderer at position 0, without bank and field: silent until it has a bank.
    ///
    /// Fails if `sample_rate_hz` is not 8,000-384,000, or `sources`, its capacity, is not 1-16,384.
    pub fn new(sample_rate_hz: f64, layout: SpeakerLayout, sources: usize) -> Result<Self, Error> {
        in_range("sample rate in Hz", sample_rate_hz, 8_000.0, 384_000.0)?;
        in_range("number of sources", sources as f64, 1.0, MOST_SOURCES as f64)?;
        let hop = (HOP * maths::pow(2.0, maths::log2(sample_rate_hz / 48_000.0).round())) as usize;
        let factor = upsampler::factor(sample_rate_hz);
        let channels = layout.channels();
        Ok(Self {
            sizes: Sizes { sample_rate_hz, hop, factor, channels },
            panner: Panner::new(layout),
            bank: None,
            field: None,
            live: None,
            sources: vec![VortexSource::default(); sources],
            follower: Follower::new(sample_rate_hz, hop),
            moving: ControlSnapshot::new(sample_rate_hz / hop as f64),
            reader: Reader::new(hop / factor),
            present: Hop::default(),
            output: HopOutput::new(channels, hop, factor),
            state: RenderState { position: 0, is_fresh: true, flow: Flow::Envelope, is_exchanged: false },
            declick: Declick::new(channels),
        })
    }

    /// Delay of the output in samples, a function of the sample rate alone: a hop, and the filter of the upsampler.
    pub fn latency_samples(&self) -> usize {
        self.sizes.hop + self.output.latency_samples()
    }

    /// Samples for which output may differ from 0 after a full-scale drive has ended: the envelope's release down to
    /// its threshold, and sound that is still on its way. None if a field drives the sources, which never ends.
    pub fn tail_samples(&self, controls: &VortexControls) -> Option<usize> {
        let release_s = within(controls.release_s, 1e-3, 5.0);
        let nepers = (-maths::ln(within(controls.threshold, 0.0, 1.0))).clamp(0.0, SILENCE_NEPERS);
        let release = (release_s * nepers * self.sizes.sample_rate_hz).ceil() as usize;
        (controls.flow == Flow::Envelope)
            .then_some(release + (2 + declick::HOPS) * self.sizes.hop + 2 * self.latency_samples())
    }

    /// Samples of a hop, a function of the sample rate alone.
    pub fn hop_samples(&self) -> usize {
        self.sizes.hop
    }

    /// Number of channels.
    pub fn channels(&self) -> usize {
        self.sizes.channels
    }

    /// Most sources that are rendered.
    pub fn sources(&self) -> usize {
        self.sources.len()
    }

    /// Exchanges the bank and returns the one before. From the next hop on the new one fades in; one of another sample
    /// rate stays silent.
    pub fn swap_bank(&mut self, bank: Option<Arc<Bank>>) -> Option<Arc<Bank>> {
        self.sum_rest();
        self.state.is_exchanged = true;
        std::mem::replace(&mut self.bank, bank)
    }

    /// Exchanges the speed field and returns the one before. From the next hop on the new one fades in.
    pub fn swap_field(&mut self, field: Option<Arc<SpeedField>>) -> Option<Arc<SpeedField>> {
        self.sum_rest();
        self.state.is_exchanged |= self.state.flow == Flow::Field;
        std::mem::replace(&mut self.field, field)
    }

    /// Installs a simulation for [`Flow::Live`], whose sources are at `places`, in m to the right, to the front and up
    /// from the centre set by the controls. Its steps last [`live_step_s`](Self::live_step_s). Not for the audio
    /// thread.
    ///
    /// Fails without positions, and if one is not finite or farther than 100 km.
    pub fn set_simulator(&mut self, simulator: Box<dyn Simulator>, places: &[[f32; 3]]) -> Result<(), Error> {
        self.sum_rest();
        self.live = Some(Live::new(simulator, places, hops_per_step(self.sizes.sample_rate_hz, self.sizes.hop))?);
        Ok(())
    }

    /// Seconds that a step of a live simulation lasts, about 1/60.
    pub fn live_step_s(&self) -> f64 {
        hops_per_step(self.sizes.sample_rate_hz, self.sizes.hop) as f64 * self.sizes.hop as f64
            / self.sizes.sample_rate_hz
    }

    /// Number of steps of the live simulation that came too late since the last call.
    pub fn take_late_steps(&mut self) -> u64 {
        self.live.as_mut().map_or(0, Live::take_late_steps)
    }

    /// Resets to silence; the next sample is at `position` on the host's timeline. Bank and field stay.
    pub fn reset(&mut self, position: i64) {
        // Leaves room for centuries of sound on either side, with positions in the period still accurate enough.
        self.state.position = position.clamp(-(1 << 50), 1 << 50);
        self.follower.reset();
        self.output.reset();
        self.state.is_fresh = true;
        self.state.is_exchanged = false;
        self.declick.reset();
        self.present = Hop::default();
        if let Some(live) = &mut self.live {
            live.reset();
        }
    }

    /// Skips `samples` unheard, at next to no cost; afterwards it begins as after a [`reset`](Self::reset).
    pub fn skip(&mut self, samples: usize) {
        if !self.state.is_fresh {
            self.reset(self.state.position);
        }
        self.state.position += samples as i64;
    }

    /// Renders one block of any length into `outputs`, whose channels are as long as `drive`; channels that the layout
    /// does not have stay silent. A hop uses the `controls` in force at its first sample. If a field sets the speeds,
    /// only the length of `drive` matters.
    pub fn process(&mut self, drive: &[f64], controls: &VortexControls, outputs: &mut [&mut [f64]]) {
        let count = outputs.iter().map(|channel| channel.len()).fold(drive.len(), usize::min);
        let mut done = 0;
        while done < count {
            let into = self.state.position.rem_euclid(self.sizes.hop as i64) as usize;
            if self.state.is_fresh {
                self.start(self.state.position - into as i64, controls);
            } else if into == 0 {
                self.begin(self.state.position, controls);
            }
            let step = (self.sizes.hop - into).min(count - done);
            self.follower.process(&drive[done..done + step], controls);
            for (channel, output) in outputs.iter_mut().enumerate() {
                let output = &mut output[done..done + step];
                match self.output.ready.get(channel) {
                    Some(ready) => output.copy_from_slice(&ready[into..into + step]),
                    None => output.fill(0.0),
                }
            }
            if into + step == self.sizes.hop {
                self.sum_rest();
                self.finish();
            } else {
                self.sum(self.present.sources * (into + step) / self.sizes.hop);
            }
            done += step;
            self.state.position += step as i64;
        }
    }
}
