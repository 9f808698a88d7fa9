//! A flame's pressure and a fire recording for those who have none at hand: generated, and said to be so wherever they
//! are shown.

use std::f64::consts::{PI, TAU};

use pyrophone_synthesis::noise::White;

/// Sample rate of both in Hz.
pub const RATE_HZ: u32 = 48_000;
/// Length of both in seconds.
const SECONDS: usize = 10;
/// Their peak.
const PEAK: f64 = 0.7;

/// Lowest and highest rate of puffing in Hz.
const PUFFS_HZ: (f64, f64) = (30.0, 180.0);
/// Exponent of the pressure's power spectrum in that band: what the paper takes for its fires (§4).
const SLOPE: f64 = 2.5;

/// Pressure of a turbulent flame, 30 to 180 Hz, mono.
///
/// Pockets of gas ignite and burn out. The volume that a pocket adds in a second is a bell over time, and pressure is its
/// derivative (Chadwick & James 2011, §2): a pulse with its spectral peak at 1 / (2 pi sigma), sigma the bell's width.
/// Pockets come as a Poisson process whose rate and strength follow the gusts. The number of pockets per octave grows with
/// their frequency f, their pressure as f^((1 - SLOPE) / 2); so the power spectrum of the sum falls as f^-SLOPE.
pub fn flame() -> Vec<f32> {
    let gusts = gusts();
    let mut pressure = vec![0.0; gusts.len()];
    let mut draw = Draw::new(1);
    let mut at_s = 0.0;
    loop {
        at_s += draw.waiting_time(420.0);
        let centre = (at_s * f64::from(RATE_HZ)) as usize;
        let Some(gust) = gusts.get(centre) else { break };
        if draw.uniform() > *gust {
            continue;
        }
        let (low, high) = PUFFS_HZ;
        // As many per octave as the frequency is high: uniform in frequency.
        let frequency_hz = low + (high - low) * draw.uniform();
        let strength = gust * (frequency_hz / low).powf(0.5 * (1.0 - SLOPE)) * draw.either_sign(0.75);
        add_pulse(&mut pressure, centre, frequency_hz, strength);
    }
    normalised(vec![pressure]).swap_remove(0)
}

/// How hard the flame burns, 0-1: a breeze that breathes, six gusts, and silence at both ends.
fn gusts() -> Vec<f64> {
    const GUSTS: [(f64, f64, f64); 6] =
        [(0.9, 0.55, 0.5), (2.3, 1.0, 0.9), (4.1, 0.45, 0.35), (4.9, 0.75, 0.5), (6.3, 1.0, 0.7), (7.9, 0.6, 0.4)];
    let breeze = low_passed(&White::new(2, 0), SECONDS, 3.0);
    let breathing = breeze.iter().map(|x| 0.12 * (0.8 * x).exp());
    breathing
        .enumerate()
        .map(|(n, breeze)| {
            let t = n as f64 / f64::from(RATE_HZ);
            let gusts = GUSTS.iter().map(|(start, height, decay)| {
                let age = t - start;
                if age > 0.0 { height * (1.0 - (-age / 0.06).exp()) * (-age / decay).exp() } else { 0.0 }
            });
            let ends = ((t - 0.4) / 0.3).clamp(0.0, 1.0) * ((9.1 - t) / 0.6).clamp(0.0, 1.0);
            (ends * (breeze + gusts.sum::<f64>())).min(1.0)
        })
        .collect()
}

/// Adds the derivative of a bell, with peak `strength`.
fn add_pulse(out: &mut [f64], centre: usize, frequency_hz: f64, strength: f64) {
    let sigma = f64::from(RATE_HZ) / (TAU * frequency_hz);
    let reach = (6.0 * sigma) as usize;
    let scale = strength * 0.5f64.exp() / sigma;
    let end = out.len().min(centre + reach);
    for (n, sample) in out.iter_mut().enumerate().take(end).skip(centre.saturating_sub(reach)) {
        let t = n as f64 - centre as f64;
        *sample -= scale * t * (-0.5 * (t / sigma).powi(2)).exp();
    }
}

/// A fire, stereo: roar, hiss, and crackle that comes in bursts.
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
        // Wood bursts where it is hot: more often and louder.
        if draw.uniform() > 0.35 * activity[start] {
            continue;
        }
        let strength = 0.12 * (0.75 * draw.normal()).exp() * activity[start].sqrt();
        add_crackle(&mut channels, start, strength, &mut draw);
    }
    normalised(channels)
}

/// Roar and hiss of one channel. The roar is the same in both but for a part, so that their mean, which the texture
/// engine searches in, does not lose it.
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
            let source = 0.9 * shared.at(n) + 0.4 * own.at(n);
            let roar = roar_filter.iter_mut().fold(source, |x, filter| filter.process(x));
            let roar = roar - rumble.process(roar);
            // The hiss flickers with the power of the roar.
            let glow = flicker.process(roar * roar).sqrt();
            let white = hissing.at(n);
            let hiss = hiss_high.process(white - hiss_low.process(white));
            activity * roar + 0.6 * activity * glow * hiss
        })
        .collect()
}

/// A splinter bursts: a click, and what it makes ring.
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
    // The gas that is set free also pushes once, slowly.
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
        .map(|n| filters.iter_mut().fold(noise.at(n), |x, filter| filter.process(x)))
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
        0.5 + 0.5 * self.noise.at(self.position) / 3f64.sqrt()
    }

    /// Mean 0, variance 1 (Irwin-Hall of 12).
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }

    /// Seconds to the next event of a Poisson process of so many per second.
    fn waiting_time(&mut self, per_second: f64) -> f64 {
        -self.uniform().max(1e-12).ln() / per_second
    }

    /// 1 with this probability, else -1.
    fn either_sign(&mut self, positive: f64) -> f64 {
        if self.uniform() < positive { 1.0 } else { -1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::analysis::Spectrum;
    use super::*;

    #[test]
    fn the_flame_puffs_between_30_and_180_hz() {
        let flame = flame();
        let spectrum = Spectrum::of(std::slice::from_ref(&flame), RATE_HZ);
        let share = |low: f64, high: f64| spectrum.power(low, high) / spectrum.power(1.0, 24_000.0);
        assert!(share(20.0, 200.0) > 0.9, "{}", share(20.0, 200.0));
        // A bell's derivative at 180 Hz is 10 dB down at 400 Hz and falls faster than any power from there.
        assert!(share(400.0, 24_000.0) < 1e-3, "{}", share(400.0, 24_000.0));
        assert!(share(1000.0, 24_000.0) < 1e-7, "{}", share(1000.0, 24_000.0));
        let loudness = |range: std::ops::Range<usize>| flame[range].iter().map(|x| f64::from(x * x)).sum::<f64>();
        let rate = RATE_HZ as usize;
        assert!(loudness(0..rate / 4) < 1e-6 * loudness(5 * rate..6 * rate), "it begins in silence");
    }

    #[test]
    fn the_fire_has_all_bands_and_crackles() {
        let fire = fire();
        let spectrum = Spectrum::of(&fire, RATE_HZ);
        for (low, high) in [(50.0, 200.0), (200.0, 1000.0), (1000.0, 5000.0), (5000.0, 15_000.0)] {
            assert!(spectrum.power(low, high) > 1e-5 * spectrum.power(20.0, 20_000.0), "{low}-{high} Hz");
        }
        // Differencing leaves the high frequencies; noise has a kurtosis of 3 there, crackle far more.
        let high: Vec<f64> = fire[0].windows(2).map(|x| f64::from(x[1] - x[0])).collect();
        let moment = |k: i32| high.iter().map(|x| x.powi(k)).sum::<f64>() / high.len() as f64;
        assert!(moment(4) / moment(2).powi(2) > 10.0, "{}", moment(4) / moment(2).powi(2));
    }

    #[test]
    fn they_are_always_the_same() {
        assert_eq!(flame(), flame());
        assert_eq!(fire(), fire());
    }
}
