//! From a hop's pressures to its output: the output's rate, the microphone and the level.

use super::microphone::limited;
use super::moving::HopControls;
use super::upsampler::Upsampler;

/// A hop as it is summed, and the one before as it is heard.
#[derive(Debug)]
pub(super) struct HopOutput {
    /// Pressures of the hop by channel, at the rate that sources are summed at.
    pub pressures: Vec<Vec<f32>>,
    upsampler: Upsampler,
    /// Pressures of a channel at the output's rate.
    raised: Vec<f32>,
    /// The last hop's output by channel.
    pub ready: Vec<Vec<f64>>,
}

impl HopOutput {
    /// Silence, for hops of `hop` samples that are summed at a `factor`-th of the output's rate.
    pub fn new(channels: usize, hop: usize, factor: usize) -> Self {
        let summed = hop / factor;
        Self {
            pressures: vec![vec![0.0; summed]; channels],
            upsampler: Upsampler::new(factor, channels, summed),
            raised: vec![0.0; hop],
            ready: vec![vec![0.0; hop]; channels],
        }
    }

    /// Delay in samples beside the hop itself.
    pub fn latency_samples(&self) -> usize {
        self.upsampler.latency_samples()
    }

    /// Resets to silence; the pressures are cleared with the next hop.
    pub fn reset(&mut self) {
        self.ready.iter_mut().for_each(|channel| channel.fill(0.0));
        self.upsampler.reset();
    }

    /// Clears the pressures for another hop.
    pub fn clear(&mut self) {
        self.pressures.iter_mut().for_each(|channel| channel.fill(0.0));
    }

    /// Converts the pressures; the controls go from those of one frame to those of the other.
    pub fn finish(&mut self, from: &HopControls, to: &HopControls) {
        let per_sample = 1.0 / self.raised.len() as f64;
        for (channel, (pressures, ready)) in self.pressures.iter().zip(&mut self.ready).enumerate() {
            self.upsampler.process(channel, pressures, &mut self.raised);
            for (n, (pressure, out)) in self.raised.iter().zip(ready.iter_mut()).enumerate() {
                let part = n as f64 * per_sample;
                let level = from.level + part * (to.level - from.level);
                let most = from.max_pressure_pa + part * (to.max_pressure_pa - from.max_pressure_pa);
                *out = level * limited(f64::from(*pressure), most);
            }
        }
    }
}
