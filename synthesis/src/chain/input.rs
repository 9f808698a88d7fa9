//! The effect's input: cleared of what could harm an engine, in double precision, and delayed for the dry signal.

use super::bus::{CHUNK, Channels};
use crate::dsp::Delay;

/// Input beyond this magnitude (+80 dBFS) is a broken signal and is cut there.
const LARGEST_INPUT: f32 = 1e4;
/// Input below this magnitude is silence, which keeps denormals out of every engine.
const SMALLEST_INPUT: f32 = 1e-15;

/// Buffers of one chunk.
pub(super) struct Input {
    /// The main input by channel.
    pub main: Vec<Vec<f64>>,
    /// The sidechain by channel.
    pub sidechain: Vec<Vec<f64>>,
    /// The input as late as the effect, by channel of the output.
    pub dry: Vec<Vec<f32>>,
    delays: Vec<Delay<f32>>,
}

impl Input {
    /// Buffers for these channels, and a dry signal that is `latency_samples` late.
    pub fn new(channels: Channels, latency_samples: usize) -> Self {
        let block = |count: usize| vec![vec![0.0; CHUNK]; count];
        Self {
            main: block(channels.input),
            sidechain: block(channels.sidechain),
            dry: vec![vec![0.0; CHUNK]; channels.output],
            delays: vec![Delay::new(latency_samples); channels.input],
        }
    }

    /// Resets to silence.
    pub fn reset(&mut self) {
        self.delays.iter_mut().for_each(Delay::reset);
    }

    /// Takes the samples from `start` to `end` of a call, at most a chunk; returns their largest magnitude.
    pub fn read_chunk(&mut self, main: &[&mut [f32]], sidechain: &[&[f32]], start: usize, end: usize) -> f32 {
        let samples = end - start;
        let mut peak = 0.0f32;
        for (channel, delay) in self.delays.iter_mut().enumerate() {
            let dry = &mut self.dry[channel][..samples];
            for ((x, wide), dry) in main[channel][start..end].iter().zip(&mut self.main[channel]).zip(dry.iter_mut()) {
                let x = clean(*x);
                peak = peak.max(x.abs());
                *wide = f64::from(x);
                *dry = x;
            }
            delay.process(dry);
        }
        let (inputs, others) = self.dry.split_at_mut(self.main.len());
        // A single channel is sent to both sides; the others receive nothing.
        if let ([only], [right, ..]) = (inputs, others) {
            right[..samples].copy_from_slice(&only[..samples]);
        }
        for (channel, buffer) in self.sidechain.iter_mut().enumerate() {
            let buffer = &mut buffer[..samples];
            match sidechain.get(channel).and_then(|x| x.get(start..end)) {
                Some(input) => buffer.iter_mut().zip(input).for_each(|(out, x)| *out = f64::from(clean(*x))),
                None => buffer.fill(0.0),
            }
            peak = buffer.iter().fold(peak, |peak, x| peak.max(x.abs() as f32));
        }
        peak
    }
}

/// A sample that no engine can be harmed by.
pub(super) fn clean(x: f32) -> f32 {
    if !x.is_finite() || x.abs() < SMALLEST_INPUT { 0.0 } else { x.clamp(-LARGEST_INPUT, LARGEST_INPUT) }
}
