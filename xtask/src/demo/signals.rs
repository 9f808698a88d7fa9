//! A generated fire recording for users without a real one, always labelled as generated.

use std::f64::consts::{PI, TAU};

use pyrophone_synthesis::dsp::White;

/// Sample rate in Hz.
pub const RATE_HZ: u32 = 48_000;
/// Its length in seconds.
const SECONDS: usize = 10;
/// Its peak.
const PEAK: f64 = 0.7;

/// A fire, stereo: roar, hiss, and bursts of crackle.
pub fn fire() -> Vec<Vec<f32>> {
    let samples = SECONDS * RATE_HZ as usize;
    let activity: Vec<f64> = low_passed(&White::new(3, 0), SECONDS, 1.5).iter().map(|x| (0.7 * x).exp()).collect();
    let mut channels: Vec<Vec<f64>> = (0..2).map(|channel| bed(&activity, channel)).collect();
    let mut draw = Draw::new(4);
    let mut at_s = 0.0;
    loop {
        at_s += draw.waiting_time(45.0);
        let start = (at_s * f64::from(RATE_HZ)) as usize;
        if start >= samples {
            break;
        }
        // Hot wood bursts more often and more loudly.
        if draw.uniform() > 0.35 * activity[start] {
            continue;
        }
        let strength = 0.12 * (0.75 * draw.normal()).exp() * activity[start].sqrt();
        add_crackle(&mut channels, start, strength, &mut draw);
    }
    normalised(channels)
}

/// Roar and hiss of one channel. Most of the roar is common to both channels, so that it survives in their mean, which
/// the texture engine searches.
fn bed(activity: &[f64], channel: u32) -> Vec<f64> {
    let shared = White::new(5, 0);
    let own = White::new(6, channel);
    let hissing = White::new(7, channel);
    let mut roar_filter = [OnePole::low_pass(90.0), OnePole::low_pass(500.0)];
    let mut rumble = OnePole::low_pass(25.0);
    let mut hiss_low = OnePole::low_pass(2_500.0);
    let mut hiss_high = OnePole::low_pass(9_000.0);
    let mut flicker = OnePole::low_pass(12.0);
    activity
        .iter()
        .enumerate()
        .map(|(n, activity)| {
            let n = n as i64;
            let source = 0.9 * shared.sample_at(n) + 0.4 * own.sample_at(n);
            let roar = roar_filter.iter_mut().fold(source, |x, filter| filter.process(x));
            let roar = roar - rumble.process(roar);
            // The hiss flickers with the power of the roar.
            let glow = flicker.process(roar * roar).sqrt();
            let white = hissing.sample_at(n);
            let hiss = hiss_high.process(white - hiss_low.process(white));
            activity * roar + 0.6 * activity * glow * hiss
        })
        .collect()
}

/// A bursting splinter: a click, and the resonance it excites.
fn add_crackle(channels: &mut [Vec<f64>], start: usize, strength: f64, draw: &mut Draw) {
    let pan = 0.25 * PI * (1.0 + 0.8 * (2.0 * draw.uniform() - 1.0));
    let gains = [pan.cos(), pan.sin()];
    let click_s = 0.000_2 + 0.000_6 * draw.uniform();
    let rings: [(f64, f64, f64); 3] = std::array::from_fn(|_| {
        let frequency_hz = 700.0 * 12f64.powf(draw.uniform());
        // High resonances in wood die sooner.
        let decay_s = (0.4 + 1.2 * draw.uniform()) * 4.0 / frequency_hz;
        (frequency_hz, decay_s, 0.3 + 0.7 * draw.uniform())
    });
    // The released gas also gives one slow push.
    let thump_hz = 60.0 + 120.0 * draw.uniform();
    for n in 0..(0.04 * f64::from(RATE_HZ)) as usize {
        let t = n as f64 / f64::from(RATE_HZ);
        let click = draw.normal() * (-t / click_s).exp();
        let ring: f64 = rings.iter().map(|(f, decay, level)| level * (TAU * f * t).sin() * (-t / decay).exp()).sum();
        let thump = 0.5 * (TAU * thump_hz * t).sin() * (-t * thump_hz / 1.2).exp();
        let x = strength * (click + ring + thump);
        for (channel, gain) in channels.iter_mut().zip(gains) {
            if let Some(sample) = channel.get_mut(start + n) {
                *sample += gain * x;
            }
        }
    }
}

fn normalised(channels: Vec<Vec<f64>>) -> Vec<Vec<f32>> {
    let peak = channels.iter().flatten().fold(0.0f64, |peak, x| peak.max(x.abs()));
    channels.into_iter().map(|x| x.into_iter().map(|x| (x * PEAK / peak) as f32).collect()).collect()
}

/// Noise of unit variance below a frequency (second order).
fn low_passed(noise: &White, seconds: usize, cutoff_hz: f64) -> Vec<f64> {
    let mut filters = [OnePole::low_pass(cutoff_hz), OnePole::low_pass(cutoff_hz)];
    let samples = (seconds * RATE_HZ as usize) as i64;
    // A second of run-in, so that it does not begin at zero.
    let filtered: Vec<f64> = (-i64::from(RATE_HZ)..samples)
        .map(|n| filters.iter_mut().fold(noise.sample_at(n), |x, filter| filter.process(x)))
        .skip(RATE_HZ as usize)
        .collect();
    let power = filtered.iter().map(|x| x * x).sum::<f64>() / filtered.len() as f64;
    filtered.into_iter().map(|x| x / power.sqrt()).collect()
}

/// y += a (x - y)
struct OnePole {
    coefficient: f64,
    state: f64,
}

impl OnePole {
    fn low_pass(cutoff_hz: f64) -> Self {
        Self { coefficient: 1.0 - (-TAU * cutoff_hz / f64::from(RATE_HZ)).exp(), state: 0.0 }
    }

    fn process(&mut self, x: f64) -> f64 {
        self.state += self.coefficient * (x - self.state);
        self.state
    }
}

/// Random numbers, always the same for a seed.
struct Draw {
    noise: White,
    position: i64,
}

impl Draw {
    fn new(seed: u32) -> Self {
        Self { noise: White::new(seed, 1), position: 0 }
    }

    /// 0-1.
    fn uniform(&mut self) -> f64 {
        self.position += 1;
        0.5 + 0.5 * self.noise.sample_at(self.position) / 3f64.sqrt()
    }

    /// Mean 0, variance 1 (Irwin-Hall of 12).
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    /// Seconds to the next event of a Poisson process with this rate.
    fn waiting_time(&mut self, per_second: f64) -> f64 {
        -self.uniform().max(1e-12).ln() / per_second
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pyrophone_analysis::Spectrum;

    #[test]
    fn the_fire_has_all_bands_and_crackles() {
        let fire = fire();
        let spectrum = Spectrum::of_channels(&fire, RATE_HZ);
        for (low, high) in [(50.0, 200.0), (200.0, 1000.0), (1000.0, 5000.0), (5000.0, 15_000.0)] {
            assert!(spectrum.power(low, high) > 1e-5 * spectrum.power(20.0, 20_000.0), "{low}-{high} Hz");
        }
        // Differencing leaves the high frequencies; noise has a kurtosis of 3 there, crackle far more.
        let high: Vec<f64> = fire[0].windows(2).map(|x| f64::from(x[1] - x[0])).collect();
        let moment = |k: i32| high.iter().map(|x| x.powi(k)).sum::<f64>() / high.len() as f64;
        assert!(moment(4) / moment(2).powi(2) > 10.0, "{}", moment(4) / moment(2).powi(2));
    }

    #[test]
    fn it_is_always_the_same() {
        assert_eq!(fire(), fire());
    }
}
