//! Tone of the whole effect: a tilt and two high shelves, of first order, so that they add no latency.
//!
//! Every stage splits the sound into the part below its corner and the rest, which add up to the sound again
//! (Zavalishin, "The Art of VA Filter Design", §3). A stage with factors of 1 passes the sound bit for bit.

use std::f64::consts::PI;

use crate::controls::ToneControls;
use crate::dsp::Smoothed;

/// Frequency in Hz about which the tone tilts.
pub const TILT_HZ: f64 = 700.0;
/// Frequency in Hz above which distance reduces the highs.
pub const AIR_HZ: f64 = 2500.0;
/// Corner of hiss in Hz.
pub const HISS_HZ: f64 = 6000.0;

const STAGES: usize = 3;
const FACTORS: usize = 4;
/// Time constant in seconds with which factors follow their controls.
const SMOOTHING_S: f64 = 0.02;
/// Largest corner as a share of the sample rate.
const HIGHEST: f64 = 0.45;
/// Level at which a filter that receives silence ends: -300 dBFS.
const SILENCE: f64 = 1e-15;
/// Seconds after which the lowest stage has fallen from full scale to [`SILENCE`].
const TAIL_S: f64 = 0.01;
/// Most channels.
const MAX_CHANNELS: usize = 10;

/// The filters of all channels.
#[derive(Debug, Clone)]
pub(crate) struct Tone {
    coefficients: [f64; STAGES],
    /// Factors less 1.
    factors: [Smoothed; FACTORS],
    states: [[f64; STAGES]; MAX_CHANNELS],
    /// True if any factor differs from 1.
    is_on: bool,
    tail_samples: usize,
}

impl Tone {
    /// Neutral filters.
    pub fn new(sample_rate_hz: f64) -> Self {
        let coefficient = |corner_hz: f64| {
            let g = maths::tan(PI * (corner_hz / sample_rate_hz).min(HIGHEST));
            g / (1.0 + g)
        };
        Self {
            coefficients: [TILT_HZ, AIR_HZ, HISS_HZ].map(coefficient),
            factors: [Smoothed::new(SMOOTHING_S, sample_rate_hz); FACTORS],
            states: [[0.0; STAGES]; MAX_CHANNELS],
            is_on: false,
            tail_samples: (TAIL_S * sample_rate_hz).ceil() as usize,
        }
    }

    /// Resets to silence, with the factors of `controls` at once.
    pub fn reset(&mut self, controls: &ToneControls) {
        self.states = [[0.0; STAGES]; MAX_CHANNELS];
        let targets = targets(controls);
        self.factors.iter_mut().zip(targets).for_each(|(factor, target)| factor.value = target);
        self.is_on = targets != [0.0; FACTORS];
    }

    /// True if it passes the sound bit for bit, and will with these controls.
    pub fn is_neutral(&self, controls: &ToneControls) -> bool {
        !self.is_on && targets(controls) == [0.0; FACTORS]
    }

    /// Samples for which it continues after its input has ended.
    pub fn tail_samples(&self, controls: &ToneControls) -> usize {
        if targets(controls) == [0.0; FACTORS] { 0 } else { self.tail_samples }
    }

    /// Moves the factors by one sample; called once for all channels, before they are processed.
    #[inline]
    pub fn step(&mut self, controls: &ToneControls) {
        let targets = targets(controls);
        if targets == [0.0; FACTORS] {
            if !self.is_on {
                return;
            }
            if self.factors.iter().all(|factor| factor.value == 0.0) {
                // Next time, it begins as a fresh one does.
                self.reset(controls);
                return;
            }
        }
        self.is_on = true;
        for (factor, target) in self.factors.iter_mut().zip(targets) {
            factor.next(target);
        }
    }

    /// Filters one sample of a channel.
    #[inline]
    pub fn process(&mut self, channel: usize, input: f64) -> f64 {
        if !self.is_on {
            return input;
        }
        let Some(states) = self.states.get_mut(channel) else { return input };
        if input.abs() < SILENCE && states.iter().all(|state| state.abs() < SILENCE) {
            *states = [0.0; STAGES];
            return 0.0;
        }
        let [low, high, air, hiss] = self.factors.map(|factor| factor.value);
        let mut value = input;
        for (stage, (state, coefficient)) in states.iter_mut().zip(self.coefficients).enumerate() {
            let step = coefficient * (value - *state);
            let below = *state + step;
            *state = below + step;
            let above = value - below;
            value += match stage {
                0 => low * below + high * above,
                1 => air * above,
                _ => hiss * above,
            };
        }
        if !value.is_finite() {
            // A single broken sample must not affect the following ones.
            *states = [0.0; STAGES];
        }
        value
    }
}

/// Factors minus 1; NaN is neutral.
fn targets(controls: &ToneControls) -> [f64; FACTORS] {
    [controls.low, controls.high, controls.air, controls.hiss]
        .map(|factor| if factor.is_finite() { factor.max(0.0) - 1.0 } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 48_000.0;

    /// Gain in dB at a frequency, once it has settled.
    fn gain_db(controls: &ToneControls, frequency_hz: f64) -> f64 {
        let mut tone = Tone::new(RATE_HZ);
        tone.reset(controls);
        let (mut input, mut output) = (0.0, 0.0);
        for n in 0..48_000 {
            let x = (2.0 * PI * frequency_hz * f64::from(n) / RATE_HZ).sin();
            tone.step(controls);
            let y = tone.process(0, x);
            if n >= 4800 {
                (input, output) = (input + x * x, output + y * y);
            }
        }
        10.0 * (output / input).log10()
    }

    #[test]
    fn each_factor_acts_on_its_own_band() {
        let neutral = ToneControls::default();
        assert!(gain_db(&neutral, 1000.0).abs() < 1e-9);
        let tilted = ToneControls { low: 2.0, high: 0.5, ..neutral };
        assert!((gain_db(&tilted, 40.0) - 6.0).abs() < 0.2 && (gain_db(&tilted, 15_000.0) + 6.0).abs() < 0.3);
        let hissing = ToneControls { hiss: 4.0, ..neutral };
        assert!(gain_db(&hissing, 300.0).abs() < 0.3 && gain_db(&hissing, 18_000.0) > 10.0);
        let far = ToneControls { air: 0.1, ..neutral };
        assert!(gain_db(&far, 100.0).abs() < 0.3 && gain_db(&far, 15_000.0) < -13.0);
    }

    #[test]
    fn neutral_is_bit_exact_and_comes_back_without_a_click() {
        let (neutral, bright) = (ToneControls::default(), ToneControls { hiss: 4.0, ..ToneControls::default() });
        let mut tone = Tone::new(RATE_HZ);
        tone.reset(&neutral);
        let input = |n: usize| (0.03 * n as f64).sin();
        let mut before = 0.0;
        for n in 0..60_000 {
            tone.step(if (10_000..20_000).contains(&n) { &bright } else { &neutral });
            let y = tone.process(0, input(n));
            assert!((y - before).abs() < 0.2, "sample {n} jumps from {before} to {y}");
            before = y;
            if !(10_000..50_000).contains(&n) {
                assert_eq!(y.to_bits(), input(n).to_bits(), "sample {n}");
            }
        }
    }

    #[test]
    fn silence_ends_exactly_within_the_tail() {
        let controls = ToneControls { low: 3.0, high: 0.2, air: 0.5, hiss: 2.0 };
        let mut tone = Tone::new(RATE_HZ);
        tone.reset(&controls);
        for _ in 0..100 {
            tone.step(&controls);
            tone.process(0, 1.0);
        }
        let tail = tone.tail_samples(&controls);
        for n in 0..tail + 10 {
            tone.step(&controls);
            let y = tone.process(0, 0.0);
            assert!(n < tail || y == 0.0, "{y} after {n} samples");
        }
        assert_eq!(tone.tail_samples(&ToneControls { low: f64::NAN, ..ToneControls::default() }), 0);
    }
}
