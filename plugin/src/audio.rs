//! The audio thread's part: the engines, and their ends of the rings to the loader. Nothing here allocates, locks,
//! frees or waits, except what belongs to an activation: [`Audio::run`], [`Audio::rerun`], [`Audio::pass_through`] and
//! [`Audio::stop_gas`].

pub mod audition;
pub mod burst;
pub mod engines;
pub mod note_bursts;

use std::sync::atomic::Ordering;

use pyrophone_settings::Values;
use pyrophone_synthesis::chain::{Chain, Channels, Meters, Transport};

use crate::channels::MAX_CHANNELS;
use crate::loader::Engine;
use crate::loader::link::{AudioLink, Retired, Update, fingerprint};
use crate::probe::ProbeIn;
use engines::{Built, Engines, Pending};
use note_bursts::NoteBursts;

/// Longest piece given to the engines at once.
const LONGEST_PIECE: usize = 8192;

/// The engines of one instance.
pub struct Audio {
    link: AudioLink,
    probe: ProbeIn,
    engines: Option<Box<Engines>>,
    /// Engines that are still being built; until they arrive the output is silent.
    pending: Option<Pending>,
    /// Input channels; they pass through while no engines run.
    input_channels: usize,
    /// Substitute for a missing sidechain; as long as the longest piece processed at once.
    silence: Vec<f32>,
    /// The sidechain with a burst in it, channel by channel.
    burning: Vec<Vec<f32>>,
}

/// Duration of the sound after the input has fallen silent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tail {
    /// Nothing.
    Over,
    /// At most this many samples.
    Samples(u32),
    /// Endless: the gate is off, or the engines are still being built.
    Endless,
}

impl Audio {
    /// The state without engines.
    pub fn new(link: AudioLink, probe: ProbeIn) -> Self {
        let (silence, burning) = (Vec::new(), Vec::new());
        Self { link, probe, engines: None, pending: None, input_channels: 0, silence, burning }
    }

    /// Exchanges the engines, or awaits those that are still being built; not real-time safe.
    pub fn run(&mut self, built: Built, channels: Channels, max_block: usize) {
        self.make_room(channels, max_block);
        (self.engines, self.pending) = match built {
            Built::Ready(engines) => (Some(engines), None),
            Built::Pending(pending) => (None, Some(pending)),
        };
        self.receive_updates();
    }

    /// Runs the engines of the last activation again, as if they were new, if they fit; returns whether they do. Not
    /// real-time safe.
    pub fn rerun(&mut self, engine: &Engine, is_offline: bool, max_block: usize) -> bool {
        self.receive_engines();
        let Some(engines) = self.engines.as_mut().filter(|engines| engines.engine() == engine) else { return false };
        engines.reset();
        engines.start_gas(is_offline);
        self.make_room(engine.channels, max_block);
        self.receive_updates();
        true
    }

    /// Runs no engines: the input passes through. Not real-time safe.
    pub fn pass_through(&mut self, channels: Channels, max_block: usize) {
        self.make_room(channels, max_block);
        (self.engines, self.pending) = (None, None);
    }

    fn make_room(&mut self, channels: Channels, max_block: usize) {
        let piece = max_block.clamp(1, LONGEST_PIECE);
        self.silence = vec![0.0; piece];
        self.burning = vec![vec![0.0; piece]; channels.sidechain.min(MAX_CHANNELS)];
        self.input_channels = channels.input;
    }

    /// Ends the simulation of gas; not real-time safe.
    pub fn stop_gas(&mut self) {
        if let Some(engines) = &mut self.engines {
            engines.stop_gas();
        }
    }

    fn receive_engines(&mut self) {
        if let Some(engines) = self.pending.as_mut().and_then(Pending::receive) {
            self.engines = Some(engines);
        }
    }

    /// Takes over engines that have been built meanwhile, and updates from the loader; hands back the things they replace.
    pub fn receive_updates(&mut self) {
        self.receive_engines();
        let Some(running) = &mut self.engines else { return };
        while let Some(update) = self.link.receive() {
            let retired = match update {
                Update::Dictionary(slot, new) => running.chain.swap_slot(slot, new).map(Retired::Dictionary),
                Update::Distribution(new) => running.chain.swap_distribution(new).map(Retired::Distribution),
                Update::Field(new) => running.chain.swap_field(new).map(Retired::Field),
                Update::Clip(new) => running.audition.swap_clip(new).map(Retired::Clip),
            };
            if let Some(retired) = retired {
                self.link.retire(retired);
            }
        }
    }

    /// True if the host should be asked for a restart: once, when the parameters call for a structure other than the
    /// running one and everything is ready for it.
    pub fn wants_restart(&mut self, values: &Values) -> bool {
        let Some(running) = &mut self.engines else { return false };
        let wanted = fingerprint(&values.structure());
        if wanted == running.structure {
            running.restart_asked = wanted;
            return false;
        }
        if wanted == running.restart_asked || self.link.shared.prepared_latency_samples(wanted).is_none() {
            return false;
        }
        running.restart_asked = wanted;
        true
    }

    /// Latency in samples of the engines that run.
    pub fn latency_samples(&self) -> Option<u32> {
        self.engines.as_ref().map(|engines| engines.latency_samples)
    }

    /// Restores the state of a fresh activation.
    pub fn reset(&mut self) {
        if let Some(engines) = &mut self.engines {
            engines.reset();
        }
    }

    /// Processes one block in place. `main` has the output's channels, the first of which hold the input; `sidechain`
    /// channels shorter than the block count as silent; `bursts` are added to both.
    pub fn process(
        &mut self,
        main: &mut [&mut [f32]],
        sidechain: &[&mut [f32]],
        values: &Values,
        bursts: &NoteBursts,
        transport: Transport,
    ) {
        let Some(running) = &mut self.engines else {
            return match self.pending {
                Some(_) => main.iter_mut().for_each(|channel| channel.fill(0.0)),
                None => pass_through(main, self.input_channels),
            };
        };
        let mut controls = values.controls();
        running.set_gas_used(values.is_live());
        self.probe.apply_mutes(&mut controls.mix);
        let samples = main.first().map_or(0, |channel| channel.len());
        let learns = learns(&self.link, transport, samples);
        let is_watched = self.probe.is_watched();
        let listen = self.probe.listen();
        if self.probe.is_burst_wanted() {
            running.burst.start(1.0);
        }
        let channels = main.len().min(MAX_CHANNELS);
        let mut start = 0;
        while start < samples {
            if let Some(level) = bursts.level_at(start) {
                running.burst.start(level);
            }
            let end = samples.min(start + self.silence.len()).min(bursts.next_after(start).unwrap_or(samples));
            let mut pieces: [&mut [f32]; MAX_CHANNELS] = Default::default();
            for (piece, channel) in pieces.iter_mut().zip(main.iter_mut()) {
                *piece = &mut channel[start..end];
            }
            let mut side: [&[f32]; MAX_CHANNELS] = [&self.silence[..end - start]; MAX_CHANNELS];
            for (piece, channel) in side.iter_mut().zip(sidechain) {
                *piece = channel.get(start..end).unwrap_or(piece);
            }
            let level = running.burst.level();
            let burst = running.burst.next(end - start);
            if !burst.is_empty() {
                let inputs = self.input_channels.min(channels);
                add_burst(burst, level, &mut pieces[..inputs], &mut self.burning, &mut side);
            }
            let position = transport.position.map(|position| position.wrapping_add(start as i64));
            running.chain.process(
                &mut pieces[..channels],
                &side[..running.engine().channels.sidechain.min(MAX_CHANNELS)],
                &controls,
                Transport { position, ..transport },
            );
            if is_watched {
                self.probe.send(running.chain.drive(), &pieces[..channels]);
            }
            send_traces(&mut self.probe, &mut running.chain, is_watched);
            running.audition.process(listen, running.chain.drive(), &mut pieces[..channels]);
            if learns {
                self.link.send_magnitudes(running.chain.top_level());
            }
            start = end;
        }
    }

    /// Reports to the window, if there is one, the share of its time that a block has used.
    pub fn report_load(&self, load: f32) {
        self.probe.report_load(load);
    }

    /// True if a window is watching.
    pub fn is_watched(&self) -> bool {
        self.probe.is_watched()
    }

    /// The meters since the last call.
    pub fn take_meters(&mut self) -> Meters {
        self.engines.as_mut().map(|engines| engines.chain.take_meters()).unwrap_or_default()
    }

    /// The possible duration of the sound after the input has fallen silent.
    pub fn tail(&self) -> Tail {
        let Some(engines) = &self.engines else {
            // The host must go on calling until the engines are here: they may sound without any input.
            return if self.pending.is_some() { Tail::Endless } else { Tail::Over };
        };
        let chain = &engines.chain;
        match chain.tail_samples() {
            _ if chain.is_silent() => Tail::Over,
            Some(samples) => Tail::Samples(samples.min(u32::MAX as usize - 1) as u32),
            None => Tail::Endless,
        }
    }
}

/// Returns whether the block is learnt from, and counts its samples if so.
fn learns(link: &AudioLink, transport: Transport, samples: usize) -> bool {
    let learns = link.shared.learning.load(Ordering::Relaxed) && (transport.playing || transport.position.is_none());
    if learns {
        link.shared.learned_samples.fetch_add(samples as u64, Ordering::Relaxed);
    }
    learns
}

/// Sends what the engines have noted about the last piece. It is drained even unwatched, so that a window opened later
/// shows no outdated data.
fn send_traces(probe: &mut ProbeIn, chain: &mut Chain, is_watched: bool) {
    chain.take_traces(|trace| {
        if is_watched {
            probe.send_trace(trace);
        }
    });
}

/// The unprocessed input: one channel goes to both sides, others to their own loudspeakers.
fn pass_through(main: &mut [&mut [f32]], input_channels: usize) {
    if input_channels == 1
        && let [left, right, ..] = main
    {
        right.copy_from_slice(left);
    }
}

/// Adds a burst to the input; the sidechain is copied first, since it belongs to the host.
fn add_burst<'a>(
    burst: &[f32],
    level: f32,
    inputs: &mut [&mut [f32]],
    burning: &'a mut [Vec<f32>],
    side: &mut [&'a [f32]],
) {
    let add = |samples: &mut [f32]| samples.iter_mut().zip(burst).for_each(|(sample, burst)| *sample += level * burst);
    inputs.iter_mut().for_each(|input| add(input));
    for (burning, side) in burning.iter_mut().zip(side) {
        let burning = &mut burning[..side.len()];
        burning.copy_from_slice(side);
        add(burning);
        *side = burning;
    }
}
