//! Bounces of whole signals through a plug-in.

use std::thread;
use std::time::Duration;

use crate::{Block, BusLayout, Configuration, Event, HostError, Plugin, Processor, Requests, Transport};

/// Division of the signal into blocks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BlockSize {
    /// Blocks of this many frames, except the last.
    Fixed(usize),
    /// Each of 0 to `max` frames, drawn from `seed`.
    Random {
        /// Seed of the draw.
        seed: u64,
        /// Longest block, in frames.
        max: usize,
    },
    /// These, over and over.
    Cycle(Vec<usize>),
}

/// A parameter's new value at a sample of the input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AutomationPoint {
    /// Sample of the input, counted from its first. Points before the first sample that is played act on that one.
    pub sample: i64,
    /// Numeric id of the parameter.
    pub id: u32,
    /// New value, normalised.
    pub value: f64,
}

/// Options of a bounce.
#[derive(Debug, Clone, PartialEq)]
pub struct BounceOptions {
    /// Sample rate in Hz.
    pub sample_rate: f64,
    /// Channels; the input and the sidechain must have as many.
    pub layout: BusLayout,
    /// Cutting into blocks.
    pub block: BlockSize,
    /// Zeros played before the input, in samples. They are cut off the output again.
    pub pad_before: usize,
    /// Extra length of the output after the end of the input, in samples.
    pub extra_after: usize,
    /// The host's position at the first sample played, padding included.
    pub start_position: i64,
    /// Automation, in any order.
    pub automation: Vec<AutomationPoint>,
    /// True if the host renders offline.
    pub offline: bool,
    /// True if input and output share their memory.
    pub in_place: bool,
}

impl BounceOptions {
    /// Blocks of 512 frames from position 0, offline, without padding or automation.
    #[must_use]
    pub const fn new(sample_rate: f64, layout: BusLayout) -> Self {
        Self {
            sample_rate,
            layout,
            block: BlockSize::Fixed(512),
            pad_before: 0,
            extra_after: 0,
            start_position: 0,
            automation: Vec::new(),
            offline: true,
            in_place: false,
        }
    }
}

/// Result of a bounce.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounce {
    /// Channels of the output; its first sample belongs to the input's first.
    pub channels: Vec<Vec<f32>>,
    /// The latency that was compensated, in samples.
    pub latency_samples: u32,
    /// Requests made during playback. A change of latency among them means that the compensation was wrong.
    pub requests: Requests,
}

/// Activates offline and deactivates again: a plug-in that renders offline must wait for its recording, however long
/// that takes, whereas one that plays in real time must not keep its host waiting.
///
/// # Errors
/// As [`Plugin::activate`] and [`Plugin::deactivate`].
pub fn await_ready(plugin: &mut dyn Plugin, configuration: &Configuration) -> Result<(), HostError> {
    let processor = plugin.activate(&Configuration { offline: true, ..*configuration })?;
    let _ = plugin.run_callbacks();
    plugin.deactivate(processor)
}

/// Plays a signal through an inactive plug-in on a separate thread, compensates the latency, and leaves the plug-in
/// inactive. In real-time mode it first waits until the plug-in is ready ([`await_ready`]).
///
/// # Errors
/// As [`Plugin::activate`] and [`Processor::process`]; [`HostError::Channels`] if input or sidechain do not fit the
/// layout; [`HostError::Activate`] if the block size allows no frame at all.
pub fn bounce(
    plugin: &mut dyn Plugin,
    input: &[Vec<f32>],
    sidechain: Option<&[Vec<f32>]>,
    options: &BounceOptions,
) -> Result<Bounce, HostError> {
    let input_samples = input.first().map_or(0, Vec::len);
    check_signal("main input", input, options.layout.input, input_samples)?;
    if let Some(sidechain) = sidechain {
        check_signal("sidechain", sidechain, options.layout.sidechain, input_samples)?;
    }
    let mut sizes = BlockSizes::new(&options.block)?;
    let configuration = Configuration {
        sample_rate: options.sample_rate,
        max_block: sizes.longest,
        layout: options.layout,
        offline: options.offline,
    };
    if !options.offline {
        await_ready(plugin, &configuration)?;
    }
    let mut processor = plugin.activate(&configuration)?;
    // Requests made during activation (a latency that was 0 before) are settled by reading the latency afterwards.
    let _ = plugin.run_callbacks();
    let latency_samples = plugin.latency_samples();
    let skip = options.pad_before + latency_samples as usize;
    let total = skip + input_samples + options.extra_after;

    let pad = |signal: &[Vec<f32>]| padded(signal, options.pad_before, total);
    let stream = Stream {
        input: pad(input),
        sidechain: sidechain.map(pad),
        output_channels: options.layout.output as usize,
        events: absolute_events(options, total),
        start_position: options.start_position,
        in_place: options.in_place,
        total,
    };

    let mut requests = Requests::default();
    let played = thread::scope(|scope| {
        let player = scope.spawn(|| play(processor.as_mut(), &stream, &mut sizes));
        while !player.is_finished() {
            requests = requests.or(plugin.run_callbacks());
            thread::sleep(Duration::from_millis(1));
        }
        player.join().unwrap_or(Err(HostError::Process))
    });
    plugin.deactivate(processor)?;
    requests = requests.or(plugin.run_callbacks());
    let mut channels = played?;
    for channel in &mut channels {
        channel.drain(..skip);
    }
    Ok(Bounce { channels, latency_samples, requests })
}

/// The signal with `before` samples of silence ahead of it, and silence after it up to a length of `total`.
fn padded(signal: &[Vec<f32>], before: usize, total: usize) -> Vec<Vec<f32>> {
    let pad = |channel: &Vec<f32>| {
        let mut padded = vec![0.0; total];
        padded[before..][..channel.len()].copy_from_slice(channel);
        padded
    };
    signal.iter().map(pad).collect()
}

/// Data for the playing thread, padded to its whole length.
struct Stream {
    input: Vec<Vec<f32>>,
    sidechain: Option<Vec<Vec<f32>>>,
    output_channels: usize,
    /// Events with their sample of the stream, in order.
    events: Vec<(usize, Event)>,
    start_position: i64,
    in_place: bool,
    total: usize,
}

fn play(processor: &mut dyn Processor, stream: &Stream, sizes: &mut BlockSizes) -> Result<Vec<Vec<f32>>, HostError> {
    let mut output = vec![vec![0.0; stream.total]; stream.output_channels];
    let mut events = stream.events.iter().copied().peekable();
    let mut due = Vec::new();
    processor.start()?;
    let mut at = 0;
    while at < stream.total {
        let range = at..at + sizes.next().min(stream.total - at);
        due.clear();
        while let Some((sample, event)) = events.next_if(|(sample, _)| *sample < range.end) {
            due.push(Event { offset: u32::try_from(sample - at).unwrap_or(u32::MAX), ..event });
        }
        let input: Vec<&[f32]> = stream.input.iter().map(|c| &c[range.clone()]).collect();
        let sidechain: Option<Vec<&[f32]>> =
            stream.sidechain.as_ref().map(|channels| channels.iter().map(|c| &c[range.clone()]).collect());
        let mut out: Vec<&mut [f32]> = output.iter_mut().map(|c| &mut c[range.clone()]).collect();
        let played = processor.process(&mut Block {
            input: &input,
            sidechain: sidechain.as_deref(),
            output: &mut out,
            events: &due,
            transport: Some(Transport::playing_at(stream.start_position.saturating_add_unsigned(at as u64))),
            in_place: stream.in_place,
        });
        if let Err(error) = played {
            processor.stop();
            return Err(error);
        }
        at = range.end;
    }
    processor.stop();
    Ok(output)
}

fn absolute_events(options: &BounceOptions, total: usize) -> Vec<(usize, Event)> {
    let pad_before = i64::try_from(options.pad_before).unwrap_or(i64::MAX);
    let mut events: Vec<(usize, Event)> = options
        .automation
        .iter()
        .filter_map(|point| {
            let sample = usize::try_from(point.sample.saturating_add(pad_before).max(0)).ok()?;
            (sample < total).then_some((sample, Event { offset: 0, id: point.id, value: point.value }))
        })
        .collect();
    events.sort_by_key(|(sample, _)| *sample);
    events
}

fn check_signal(bus: &'static str, signal: &[Vec<f32>], channels: u32, samples: usize) -> Result<(), HostError> {
    let lengths: Vec<usize> = signal.iter().map(Vec::len).collect();
    if lengths.len() == channels as usize && lengths.iter().all(|&length| length == samples) {
        return Ok(());
    }
    Err(HostError::Channels {
        bus,
        found: format!("channels of {lengths:?} samples"),
        needed: format!("{channels} channels of {samples} samples"),
    })
}

struct BlockSizes {
    block: BlockSize,
    longest: usize,
    turn: u64,
}

impl BlockSizes {
    fn new(block: &BlockSize) -> Result<Self, HostError> {
        let longest = match block {
            BlockSize::Fixed(size) => *size,
            BlockSize::Random { max, .. } => *max,
            BlockSize::Cycle(sizes) => sizes.iter().copied().max().unwrap_or(0),
        };
        if longest == 0 {
            return Err(HostError::Activate(format!(
                "no block of {block:?} has a frame; give at least one size above 0"
            )));
        }
        Ok(Self { block: block.clone(), longest, turn: 0 })
    }

    fn next(&mut self) -> usize {
        let turn = self.turn;
        self.turn += 1;
        match &self.block {
            BlockSize::Fixed(size) => *size,
            BlockSize::Cycle(sizes) => sizes[(turn % sizes.len() as u64) as usize],
            BlockSize::Random { seed, max } => (split_mix(seed.wrapping_add(turn)) % (*max as u64 + 1)) as usize,
        }
    }
}

/// The output function of SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014).
const fn split_mix(counter: u64) -> u64 {
    let mut z = counter.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests;
