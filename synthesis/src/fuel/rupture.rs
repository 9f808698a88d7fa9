//! Sound of one rupture: a click, and the piece of fuel that it sets ringing.

use std::f64::consts::PI;

use super::draws::Draws;
use super::kind::Rupture;
use crate::dsp::{Svf, section_gain};

/// Modes of a free bar, relative to the lowest (Euler and Bernoulli; Fletcher & Rossing, "The Physics of Musical
/// Instruments", §2.16), and the deviation of those of a broken piece.
const MODES: [f64; 3] = [1.0, 2.756, 5.404];
const IRREGULAR: f64 = 0.08;
/// Rise time of the pressure in seconds: that of a shock.
const RISE_S: f64 = 0.000_05;
/// Number of time constants after which a wave ends (-52 dB), its greatest length in seconds, and its fade-out.
const TIME_CONSTANTS: f64 = 6.0;
const LONGEST_S: f64 = 0.050;
const FADE_S: f64 = 0.001;
/// Share of noise in the click; the rest is the shock itself.
const NOISE: f64 = 0.7;
/// The click's band: corners relative to its middle.
const BAND: [f64; 2] = [0.6, 1.6];
/// Dependence of a rupture's duration and pitch on its size: large cells ring longer and lower.
const BY_SIZE: f64 = 0.6;

impl Rupture {
    /// A wave, and its peak over the softest one in dB.
    pub fn make(&self, draws: &mut Draws, sample_rate_hz: f64) -> (Vec<f64>, f64) {
        let deviations = draws.normal();
        let peak = maths::pow(10.0, (self.median_db + self.deviation_db * deviations) / 20.0);
        let size = 0.5 + 0.25 * deviations;
        let mut between = |[low, high]: [f64; 2], size: f64| {
            let rank = BY_SIZE * size + (1.0 - BY_SIZE) * draws.share();
            low * maths::pow(high / low, rank)
        };
        let click_s = between(self.click_s, size);
        let click_hz = between(self.click_hz, 1.0 - size);
        let ring_hz = between(self.ring_hz, 1.0 - size);
        let ring_s = between(self.ring_s, size);
        let longest_s = (TIME_CONSTANTS * click_s.max(ring_s)).min(LONGEST_S);
        let samples = ((longest_s * sample_rate_hz) as usize).max(8);
        let release = release(samples, click_s, draws, sample_rate_hz);
        let click = normalised(click(&release, click_hz, sample_rate_hz));
        let ring = normalised(ring(&release, ring_hz, ring_s, draws, sample_rate_hz));
        let ring_level = maths::pow(10.0, self.ring_db / 20.0);
        let sum = click.iter().zip(&ring).map(|(click, ring)| click + ring_level * ring).collect();
        let mut wave = normalised(sum);
        let fade = (FADE_S * sample_rate_hz).max(1.0);
        for (i, sample) in wave.iter_mut().enumerate() {
            *sample *= peak * ((samples - i) as f64 / fade).min(1.0);
        }
        (wave, self.deviation_db * (deviations + 2.0))
    }
}

/// Released pressure: it rises at once and falls with a time constant, partly as noise.
fn release(samples: usize, time_s: f64, draws: &mut Draws, sample_rate_hz: f64) -> Vec<f64> {
    let at = |i: usize| {
        let now_s = i as f64 / sample_rate_hz;
        (now_s / RISE_S).min(1.0) * maths::exp(-now_s / time_s)
    };
    (0..samples).map(|i| at(i) * (1.0 - NOISE + NOISE * draws.unit())).collect()
}

/// Sound radiated at once: a broad band about `centre_hz`.
fn click(release: &[f64], centre_hz: f64, sample_rate_hz: f64) -> Vec<f64> {
    // At a low sample rate, only the lower part of the band remains.
    let [low, high] = BAND.map(|part| section_gain((part * centre_hz).min(0.45 * sample_rate_hz), sample_rate_hz));
    let [mut high_pass, mut low_pass] = [Svf::default(); 2];
    release.iter().map(|x| low_pass.process(high, high_pass.process(low, *x).high).low).collect()
}

/// The modes of the piece, as resonators of two poles; higher ones die away faster.
fn ring(release: &[f64], lowest_hz: f64, time_s: f64, draws: &mut Draws, sample_rate_hz: f64) -> Vec<f64> {
    let mut sum = vec![0.0; release.len()];
    for mode in MODES {
        let frequency_hz = lowest_hz * mode * (1.0 + IRREGULAR * draws.unit());
        let strength = draws.share() / mode;
        if frequency_hz > 0.4 * sample_rate_hz {
            continue;
        }
        let radius = maths::exp(-mode.sqrt() / (time_s * sample_rate_hz));
        let angle = 2.0 * PI * frequency_hz / sample_rate_hz;
        let (first, second) = (2.0 * radius * maths::cos(angle), -radius * radius);
        let mut past = [0.0f64; 2];
        for (sum, x) in sum.iter_mut().zip(release) {
            let y = maths::sin(angle) * x + first * past[0] + second * past[1];
            past = [y, past[0]];
            *sum += strength * y;
        }
    }
    sum
}

/// `wave` with a peak of 1; silence stays.
fn normalised(mut wave: Vec<f64>) -> Vec<f64> {
    let peak = wave.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    if peak > 0.0 {
        wave.iter_mut().for_each(|x| *x /= peak);
    }
    wave
}

#[cfg(test)]
mod tests {
    use super::super::kind::BURNING;
    use super::*;

    #[test]
    fn peaks_spread_over_forty_decibels_and_waves_are_short_and_end_softly() {
        for (fuel, properties) in BURNING.iter().enumerate() {
            let mut draws = Draws::new(7, fuel as u32);
            let mut peaks_db: Vec<f64> = (0..400)
                .map(|_| {
                    let (wave, _) = properties.rupture.make(&mut draws, 48_000.0);
                    assert!(wave.len() as f64 <= LONGEST_S * 48_000.0 && wave.iter().all(|x| x.is_finite()));
                    let peak = wave.iter().fold(0.0f64, |most, x| most.max(x.abs()));
                    assert!(wave[0].abs() < 0.1 * peak && wave[wave.len() - 1].abs() < 0.01 * peak, "fuel {fuel}");
                    20.0 * peak.log10()
                })
                .collect();
            peaks_db.sort_by(f64::total_cmp);
            let (deviation_db, median_db) = (properties.rupture.deviation_db, properties.rupture.median_db);
            let range_db = peaks_db[399] - peaks_db[0];
            assert!((3.6 * deviation_db..=4.01 * deviation_db).contains(&range_db), "fuel {fuel}: {range_db} dB");
            assert!((peaks_db[200] - median_db).abs() < 2.0, "fuel {fuel}: {} dB", peaks_db[200]);
        }
    }

    #[test]
    fn every_rate_makes_waves_that_can_be_played() {
        for rate_hz in [8000.0, 44_100.0, 384_000.0] {
            for properties in BURNING {
                let (wave, _) = properties.rupture.make(&mut Draws::new(1, 1), rate_hz);
                assert!(wave.iter().all(|x| x.is_finite()) && wave.iter().any(|x| x.abs() > 1e-4), "{rate_hz} Hz");
            }
        }
    }
}
