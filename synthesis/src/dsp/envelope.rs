//! Envelope follower.

use std::f64::consts::FRAC_PI_2;

use crate::error::within;

/// Level at which a falling envelope ends: -240 dBFS.
const SILENCE: f64 = 1e-12;

/// How an [`Envelope`] follows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Follow {
    /// Time constant of its rise in seconds, limited to 0.1 ms to 1 s.
    pub attack_s: f64,
    /// Time constant of its fall in seconds, limited to 1 ms to 5 s.
    pub release_s: f64,
    /// Magnitude that is subtracted, 0-1.
    pub threshold: f64,
}

/// Follows a signal's magnitude, rising with the attack and falling with the release.
#[derive(Debug)]
pub(crate) struct Envelope {
    sample_rate_hz: f64,
    state: f64,
}

impl Envelope {
    pub fn new(sample_rate_hz: f64) -> Self {
        Self { sample_rate_hz, state: 0.0 }
    }

    pub fn reset(&mut self) {
        self.state = 0.0;
    }

    /// Replaces the signal by its envelope less the threshold, and not below 0, so that crossing
    /// the threshold does not click.
    pub fn process(&mut self, follow: &Follow, signal: &mut [f64]) {
        let attack = self.step(follow.attack_s, 1e-4, 1.0);
        let release = self.step(follow.release_s, 1e-3, 5.0);
        let threshold = within(follow.threshold, 0.0, 1.0);
        for sample in signal {
            let magnitude = sample.abs();
            let step = if magnitude > self.state { attack } else { release };
            self.state += step * (magnitude - self.state);
            if self.state < SILENCE {
                self.state = 0.0;
            }
            *sample = (self.state - threshold).max(0.0);
        }
    }

    /// Share of the remaining distance covered in one sample, for a time constant in seconds.
    fn step(&self, seconds: f64, shortest: f64, longest: f64) -> f64 {
        -maths::exp_m1(-1.0 / (within(seconds, shortest, longest) * self.sample_rate_hz))
    }
}

/// Stages of an [`Average`]: with two, a step rises smoothly. More were no better: at the same distance of the fire's
/// texture from the recording's, they followed speech no more closely.
const STAGES: usize = 2;
/// Time constants after which a step has risen to one half, with two stages.
const HALF_RISE: f64 = 1.678;

/// Follows a signal's mean magnitude, rising and falling alike.
///
/// Unlike a follower of peaks it is linear in the magnitude, so that it correlates with a sound's loudness: on speech,
/// 0.99 instead of 0.91 for an attack of 5 ms and a release of 80 ms.
#[derive(Debug)]
pub(crate) struct Average {
    sample_rate_hz: f64,
    states: [f64; STAGES],
}

impl Average {
    pub fn new(sample_rate_hz: f64) -> Self {
        Self { sample_rate_hz, states: [0.0; STAGES] }
    }

    pub fn reset(&mut self) {
        self.states = [0.0; STAGES];
    }

    /// Delay in seconds of an average over `time_s`: that of half a step.
    pub fn delay_s(time_s: f64) -> f64 {
        HALF_RISE * within(time_s, 5e-4, 1.0)
    }

    /// Replaces the signal by its average over `time_s` seconds (0.0005-1, the time constant of each stage), scaled so
    /// that a sine's is its peak, less the threshold, and not below 0.
    pub fn process(&mut self, time_s: f64, threshold: f64, signal: &mut [f64]) {
        let step = -maths::exp_m1(-1.0 / (within(time_s, 5e-4, 1.0) * self.sample_rate_hz));
        let threshold = within(threshold, 0.0, 1.0);
        for sample in signal {
            let mut value = sample.abs();
            for state in &mut self.states {
                *state += step * (value - *state);
                if *state < SILENCE {
                    *state = 0.0;
                }
                value = *state;
            }
            *sample = (FRAC_PI_2 * value - threshold).max(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rises_and_falls_by_its_time_constants() {
        let follow = Follow { attack_s: 0.01, release_s: 0.1, threshold: 0.0 };
        let mut envelope = Envelope::new(48_000.0);
        let mut signal = vec![0.5; 480];
        envelope.process(&follow, &mut signal);
        let one = 1.0 - (-1.0f64).exp();
        assert!((signal[479] - 0.5 * one).abs() < 1e-12);
        let mut silence = vec![0.0; 4800];
        envelope.process(&follow, &mut silence);
        assert!((silence[4799] - 0.5 * one * (-1.0f64).exp()).abs() < 1e-12);
    }

    #[test]
    fn an_average_of_a_sine_is_its_peak_and_rises_as_it_falls() {
        let sine = |i: usize| 0.5 * (2.0 * std::f64::consts::PI * 1000.0 * i as f64 / 48_000.0).sin();
        let mut signal: Vec<f64> = (0..9600).map(|i| if i < 4800 { sine(i) } else { 0.0 }).collect();
        let mut average = Average::new(48_000.0);
        average.process(0.004, 0.0, &mut signal);
        assert!((signal[4700] - 0.5).abs() < 0.005, "{}", signal[4700]);
        let half = |samples: &[f64], is_past: fn(f64) -> bool| samples.iter().position(|x| is_past(*x)).unwrap();
        let (rise, fall) = (half(&signal, |x| x > 0.25), half(&signal[4800..], |x| x < 0.25));
        assert!(rise.abs_diff(fall) < 20, "{rise} and {fall} samples");
        let mut silence = vec![0.0; 48_000];
        average.process(0.004, 0.0, &mut silence);
        assert_eq!(silence[47_999], 0.0);
    }

    #[test]
    fn below_the_threshold_and_after_silence_it_is_exactly_zero() {
        let follow = Follow { attack_s: 0.005, release_s: 0.08, threshold: 0.1 };
        let mut envelope = Envelope::new(44_100.0);
        let mut quiet = vec![0.09; 10_000];
        envelope.process(&follow, &mut quiet);
        assert!(quiet.iter().all(|value| *value == 0.0));
        let mut silence = vec![0.0; 200_000];
        envelope.process(&Follow { threshold: 0.0, ..follow }, &mut silence);
        assert_eq!(silence[199_999], 0.0);
    }
}
