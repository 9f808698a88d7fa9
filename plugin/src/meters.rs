//! Levels for the editor: written by the audio thread, read and cleared by the window. Every access is relaxed, because no
//! level says anything about another.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use atomic_float::AtomicF32;

use pyrophone_synthesis::chain;

/// Peak level, held until it is read.
#[derive(Debug, Default)]
pub struct Peak(AtomicF32);

impl Peak {
    /// Raises the level to `magnitude`, if that is larger.
    pub fn raise(&self, magnitude: f32) {
        if magnitude > 0.0 {
            self.0.fetch_max(magnitude, Ordering::Relaxed);
        }
    }

    /// The peak since the last call; clears it.
    pub fn take_peak(&self) -> f32 {
        self.0.swap(0.0, Ordering::Relaxed)
    }
}

/// Levels for the editor.
#[derive(Debug, Default)]
pub struct Meters {
    /// Main input.
    pub input: Peak,
    /// Drive, after its high-pass.
    pub drive: Peak,
    /// Low layer.
    pub low: Peak,
    /// Extension layer.
    pub extension: Peak,
    /// Texture layer.
    pub texture: Peak,
    /// Vortex layer.
    pub vortex: Peak,
    /// Crackle layer.
    pub crackle: Peak,
    /// Hiss layer.
    pub hiss: Peak,
    /// Body layer.
    pub body: Peak,
    /// Sidechain.
    pub sidechain: Peak,
    /// Output.
    pub output: Peak,
    cancels: AtomicBool,
    late_steps: AtomicU32,
    scaling_alpha: AtomicF32,
    activation: Activation,
}

/// Facts of the last activation.
#[derive(Debug, Default)]
struct Activation {
    sidechain_channels: AtomicU32,
    latency_samples: AtomicU32,
    sample_rate_hz: AtomicF32,
}

impl Meters {
    /// Publishes the engines' measurements; real-time safe.
    pub fn publish(&self, measured: &chain::Meters) {
        let peaks = [
            (&self.input, measured.input),
            (&self.drive, measured.drive),
            (&self.low, measured.low),
            (&self.extension, measured.extension),
            (&self.texture, measured.texture),
            (&self.vortex, measured.vortex),
            (&self.crackle, measured.crackle),
            (&self.hiss, measured.hiss),
            (&self.body, measured.body),
            (&self.output, measured.output),
        ];
        for (peak, magnitude) in peaks {
            peak.raise(magnitude);
        }
        self.cancels.store(measured.cancels, Ordering::Relaxed);
        self.scaling_alpha.store(measured.scaling_alpha, Ordering::Relaxed);
        self.late_steps.fetch_add(u32::try_from(measured.late_steps).unwrap_or(u32::MAX), Ordering::Relaxed);
    }

    /// True if the input's channels cancel in the mean that drives the engines.
    pub fn input_cancels(&self) -> bool {
        self.cancels.load(Ordering::Relaxed)
    }

    /// Degree to which texture maps amplitudes, 0-1: Scaling alpha after its automatic reduction.
    pub fn scaling_alpha(&self) -> f32 {
        self.scaling_alpha.load(Ordering::Relaxed)
    }

    /// Late steps of the live gas since the activation.
    pub fn late_steps(&self) -> u32 {
        self.late_steps.load(Ordering::Relaxed)
    }

    /// Channels of the host's sidechain bus; 0 if there is none.
    pub fn sidechain_channels(&self) -> u32 {
        self.activation.sidechain_channels.load(Ordering::Relaxed)
    }

    /// Sets the number of sidechain channels of an activation.
    pub fn set_sidechain(&self, channels: u32) {
        self.activation.sidechain_channels.store(channels, Ordering::Relaxed);
    }

    /// Sets the sample rate and latency of an activation.
    pub fn set_engine(&self, sample_rate_hz: f32, latency_samples: u32) {
        self.activation.sample_rate_hz.store(sample_rate_hz, Ordering::Relaxed);
        self.activation.latency_samples.store(latency_samples, Ordering::Relaxed);
        self.late_steps.store(0, Ordering::Relaxed);
    }

    /// Latency in samples and sample rate in Hz, after an activation.
    pub fn engine(&self) -> Option<(u32, f32)> {
        let sample_rate_hz = self.activation.sample_rate_hz.load(Ordering::Relaxed);
        (sample_rate_hz > 0.0).then(|| (self.activation.latency_samples.load(Ordering::Relaxed), sample_rate_hz))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_hold_the_largest_until_taken() {
        let peak = Peak::default();
        for magnitude in [0.25, 0.75, 0.5, f32::NAN, -1.0] {
            peak.raise(magnitude);
        }
        assert_eq!((peak.take_peak(), peak.take_peak()), (0.75, 0.0));
    }
}
