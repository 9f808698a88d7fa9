//! Levels in third octaves.

use std::f64::consts::PI;

use maths::fft::Complex64;

use crate::dsp::Transform;

/// Length of an analysis window in seconds; rounded down to a power of two. At 44.1 and 48 kHz that is 8192 samples,
/// whose bins are narrow enough for the lowest third octave (23 Hz).
const WINDOW_S: f64 = 0.19;
/// Numbers of the third octaves, 10^(k/10) Hz: 100 Hz to 20 kHz.
const NUMBERS: std::ops::RangeInclusive<i32> = 20..=43;
/// Power, relative to that an octave lower, that counts as empty; and the number of steps of a twenty-fourth of an
/// octave to search: three octaves down from the highest frequency, as far as lossy formats and lower rates go.
const EMPTY: f64 = 1e-4;
const LIMIT_STEPS: i32 = 72;
/// Octaves above a band limit at which the slope of the low-pass has ended: 80 dB at 180 dB per octave.
const SLOPE_OCTAVES: f64 = 0.45;
/// Highest frequency used, as a share of the sample rate.
const HIGHEST: f64 = 0.45;

/// Centres in Hz of the third octaves from 100 Hz to 20 kHz, as far as the sample rate goes.
pub fn centres_hz(sample_rate_hz: f64) -> Vec<f64> {
    NUMBERS.map(|k| maths::pow(10.0, f64::from(k) / 10.0)).take_while(|hz| *hz < HIGHEST * sample_rate_hz).collect()
}

/// A signal's mean power by frequency: windows of Hann, half overlapping (Welch 1967).
#[derive(Debug)]
pub struct Power {
    /// Power in every bin; the bins' sum is the signal's mean power.
    bins: Vec<f64>,
    bin_hz: f64,
}

/// Analysis state: making it takes longer than using it once.
struct Analyser {
    sample_rate_hz: f64,
    transform: Transform,
    window: Vec<f64>,
}

impl Analyser {
    fn new(sample_rate_hz: f64) -> Self {
        let longest = maths::log2(WINDOW_S * sample_rate_hz).floor() as u32;
        let transform = Transform::new(1 << longest.clamp(6, 20));
        let len = transform.len();
        let window = (0..len).map(|i| 0.5 - 0.5 * maths::cos(2.0 * PI * i as f64 / len as f64)).collect();
        Self { sample_rate_hz, transform, window }
    }

    fn power(&mut self, signal: &[f64]) -> Power {
        let Self { sample_rate_hz, transform, window } = self;
        let len = transform.len();
        let mut bins = vec![0.0; transform.bins()];
        let mut count = 0.0;
        for start in (0..signal.len().saturating_sub(len / 2).max(1)).step_by(len / 2) {
            transform.time.fill(0.0);
            for ((time, x), weight) in transform.time.iter_mut().zip(&signal[start..]).zip(&*window) {
                *time = x * weight;
            }
            transform.forward();
            bins.iter_mut().zip(&transform.spectrum).for_each(|(power, bin)| *power += Complex64::norm_sqr(bin));
            count += 1.0;
        }
        // A Hann window's mean square is 3/8; all bins except the outermost represent two.
        let scale = 2.0 / (0.375 * maths::square(len as f64) * count);
        bins.iter_mut().for_each(|power| *power *= scale);
        Power { bins, bin_hz: *sample_rate_hz / len as f64 }
    }
}

impl Power {
    /// Powers of `signal`. A signal shorter than a window is padded with silence.
    pub fn of_signal(signal: &[f64], sample_rate_hz: f64) -> Self {
        Analyser::new(sample_rate_hz).power(signal)
    }

    /// The spectra of single windows, overlapping by half, whose mean is [`of_signal`](Self::of_signal).
    fn windows(signal: &[f64], sample_rate_hz: f64) -> impl Iterator<Item = Self> {
        let mut analyser = Analyser::new(sample_rate_hz);
        let len = analyser.window.len();
        let starts = (0..signal.len().saturating_sub(len / 2).max(1)).step_by(len / 2);
        starts.map(move |start| analyser.power(&signal[start..signal.len().min(start + len)]))
    }

    /// Mean power between two frequencies in Hz, per bin; interpolated if no bin lies between them.
    fn density(&self, low_hz: f64, high_hz: f64) -> f64 {
        let (first, last) = ((low_hz / self.bin_hz).ceil() as usize, (high_hz / self.bin_hz).ceil() as usize);
        let inside = self.bins.get(first..last.min(self.bins.len())).unwrap_or(&[]);
        if inside.is_empty() {
            return self.bins.get(first).copied().unwrap_or(0.0);
        }
        inside.iter().sum::<f64>() / inside.len() as f64
    }

    /// The frequency in Hz above which there is at most a noise floor, 40 dB below the level an octave lower: the limit set
    /// by a lossy format or a lower rate. None if the recording has no such limit.
    pub fn band_limit_hz(&self) -> Option<f64> {
        let highest = HIGHEST * 2.0 * self.bin_hz * (self.bins.len() - 1) as f64;
        let step = maths::pow(2.0, 1.0 / 24.0);
        let density = |hz: f64| self.density(hz / step, hz * step);
        let candidates = (0..LIMIT_STEPS).map(|i| highest / maths::powi(step, i));
        // From the top down, the first step that is not empty below one that is. Far above the limit both may be noise floor,
        // which does not count as empty.
        let (mut loudest, mut was_empty, mut limit) = (0.0f64, false, None);
        for hz in candidates {
            loudest = loudest.max(density(hz));
            let is_empty = loudest <= EMPTY * density(hz / 2.0);
            if was_empty && !is_empty {
                limit = Some(hz);
            }
            was_empty = is_empty;
        }
        limit
    }

    /// Root mean square of white noise as dense as the noise floor: what lies above a band limit in Hz once its slope has
    /// ended. 0 if nothing is left above it.
    pub fn floor_above(&self, limit_hz: f64) -> f64 {
        let highest = HIGHEST * 2.0 * self.bin_hz * (self.bins.len() - 1) as f64;
        let lowest = limit_hz * maths::pow(2.0, SLOPE_OCTAVES);
        if lowest >= highest { 0.0 } else { (self.density(lowest, highest) * self.bins.len() as f64).sqrt() }
    }

    /// Root mean square below a frequency in Hz.
    pub fn rms_below(&self, frequency_hz: f64) -> f64 {
        let end = ((frequency_hz / self.bin_hz) as usize + 1).min(self.bins.len());
        self.bins[..end].iter().sum::<f64>().sqrt()
    }

    /// Root mean square between two frequencies in Hz.
    pub fn rms_between(&self, low_hz: f64, high_hz: f64) -> f64 {
        (maths::square(self.rms_below(high_hz)) - maths::square(self.rms_below(low_hz))).max(0.0).sqrt()
    }

    /// Levels in dB of the third octaves at [`centres_hz`]; no lower than 120 dB below the highest.
    pub fn third_octaves_db(&self, sample_rate_hz: f64) -> Vec<f64> {
        let half = maths::pow(10.0, 0.05);
        let level = |centre: &f64| 10.0 * maths::log10(self.density(centre / half, centre * half).max(1e-30));
        let mut levels: Vec<f64> = centres_hz(sample_rate_hz).iter().map(level).collect();
        let floor = levels.iter().fold(f64::NEG_INFINITY, |most, x| most.max(*x)) - 120.0;
        levels.iter_mut().for_each(|x| *x = x.max(floor));
        levels
    }
}

/// Distance below the loudest, in dB, at which a window's third octaves still count on average: silence is not typical.
const AUDIBLE_DB: f64 = 60.0;

/// Medians over time of the levels of a signal's third octaves, which bursts do not raise.
pub fn typical_third_octaves_db(signal: &[f64], sample_rate_hz: f64) -> Vec<f64> {
    let mut windows: Vec<Vec<f64>> =
        Power::windows(signal, sample_rate_hz).map(|power| power.third_octaves_db(sample_rate_hz)).collect();
    let mean = |levels: &[f64]| levels.iter().sum::<f64>() / levels.len().max(1) as f64;
    let loudest = windows.iter().fold(f64::NEG_INFINITY, |most, levels| most.max(mean(levels)));
    windows.retain(|levels| mean(levels) > loudest - AUDIBLE_DB);
    let middle = windows.len() / 2;
    (0..centres_hz(sample_rate_hz).len())
        .map(|band| {
            windows.sort_by(|a, b| a[band].total_cmp(&b[band]));
            windows.get(middle).map_or(-300.0, |levels| levels[band])
        })
        .collect()
}

/// The log spectral distance in dB: the root mean square difference of two sets of levels, their mean
/// difference left out.
pub fn distance_db(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().min(b.len()).max(1) as f64;
    let mean = a.iter().zip(b).map(|(a, b)| a - b).sum::<f64>() / count;
    (a.iter().zip(b).map(|(a, b)| maths::square(a - b - mean)).sum::<f64>() / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsp::White;

    #[test]
    fn white_noise_is_flat_and_has_its_power() {
        let mut noise = vec![0.0; 441_000];
        White::new(1, 2).fill(0, &mut noise);
        let power = Power::of_signal(&noise, 44_100.0);
        assert!((power.rms_below(22_050.0) - 1.0).abs() < 0.01);
        assert!((power.rms_below(150.0) - (150.0f64 / 22_050.0).sqrt()).abs() < 0.02);
        let levels = power.third_octaves_db(44_100.0);
        assert_eq!(levels.len(), 23, "to 15.8 kHz");
        let flat = vec![0.0; levels.len()];
        assert!(distance_db(&levels, &flat) < 0.7, "{levels:?}");
    }

    #[test]
    fn a_band_limit_is_found_where_there_is_one() {
        let mut noise = vec![0.0; 200_000];
        White::new(1, 2).fill(0, &mut noise);
        assert_eq!(Power::of_signal(&noise, 44_100.0).band_limit_hz(), None);
        let taps = super::super::equalizer::design_low_pass(11_000.0, 44_100.0);
        let mut low = noise.clone();
        for _ in 0..3 {
            let mut equalizer = super::super::equalizer::Equalizer::new(44_100.0, 1);
            let samples = low.len();
            equalizer.process(&taps, 1.0, &mut [&mut low], 0..samples);
        }
        let found = Power::of_signal(&low, 44_100.0).band_limit_hz().unwrap();
        assert!((10_500.0..12_000.0).contains(&found), "{found} Hz");
        assert_eq!(Power::of_signal(&[0.0; 50_000], 44_100.0).band_limit_hz(), None);
    }

    #[test]
    fn a_noise_floor_above_the_limit_is_found() {
        let mut low = vec![0.0; 200_000];
        White::new(1, 2).fill(0, &mut low);
        let taps = super::super::equalizer::design_low_pass(6_000.0, 44_100.0);
        super::super::equalizer::Equalizer::new(44_100.0, 1).process(&taps, 1.0, &mut [&mut low], 0..200_000);
        let noise = White::new(3, 4);
        low.iter_mut().enumerate().for_each(|(i, x)| *x += 1e-3 * noise.sample_at(i as i64));
        let power = Power::of_signal(&low, 44_100.0);
        let floor = power.floor_above(power.band_limit_hz().unwrap());
        assert!((0.9e-3..1.1e-3).contains(&floor), "{floor}");
        assert_eq!(power.floor_above(19_000.0), 0.0);
    }

    #[test]
    fn distance_is_that_of_the_shape() {
        assert_eq!(distance_db(&[1.0, 2.0], &[3.0, 4.0]), 0.0);
        assert_eq!(distance_db(&[1.0, -1.0], &[0.0, 0.0]), 1.0);
    }

    #[test]
    fn short_and_silent_signals_have_levels() {
        for signal in [vec![], vec![0.5], vec![0.0; 100_000]] {
            assert!(Power::of_signal(&signal, 44_100.0).third_octaves_db(44_100.0).iter().all(|x| x.is_finite()));
        }
    }
}
