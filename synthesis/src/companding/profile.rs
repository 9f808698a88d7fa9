//! The recording's side: its loudness, removed once when it is loaded.

use super::bands::Power;
use super::equalizer::design_low_pass;
use super::frames::frame_samples;
use crate::dsp::{Svf, mean_of, section_gain};
use crate::texture::RemovedLoudness;
use bitcode::{Decode, Encode};

/// Exponent with which both loudnesses are removed before matching. Removing all of it (1) was tried, and doubled the
/// texture distance of the torch (docs/sound.md).
pub const MATCH_EXPONENT: f64 = 0.6;
/// Approximate upper frequency in Hz of texture's top level, whose loudness counts.
pub(super) const MATCHED_HZ: f64 = 600.0;
/// Corner in Hz of the removed loudness.
const LOUDNESS_HZ: f64 = 8.0;
/// Corners in Hz between which loudness weights the signal up by 6 dB an octave, 20 dB in all. A low end much louder than the
/// rest sways independently, and highs divided by its loudness would be made to sway with it.
const RISE_HZ: [f64; 2] = [300.0, 3000.0];
/// Highest frequency used, as a share of the sample rate.
const HIGHEST: f64 = 0.45;
/// Share of the loudest below which loudness is not followed: -50 dB.
const FLOOR: f64 = 3.162e-3;
/// Frequency in Hz below which sound is wind at the microphone: it is inaudible, and must not count towards the level
/// of the low end.
const INFRASOUND_HZ: f64 = 25.0;
/// Largest change of a recording's level towards a loudness, in dB: anything softer is noise.
const MOST_GAIN_DB: f64 = 40.0;
/// Spacing in Hz of the crossovers for which the level below is known, and their number: up to the highest crossover.
const LOW_STEP_HZ: f64 = 20.0;
const LOW_STEPS: usize = 20;

/// Data about a recording in addition to its flattened form and the loudness that was removed from it.
#[derive(Debug, Clone, Encode, Decode)]
pub struct Profile {
    /// Root mean square of the flat form below [`MATCHED_HZ`].
    pub(super) matched_rms: f64,
    /// Root mean square between [`INFRASOUND_HZ`] and multiples of [`LOW_STEP_HZ`].
    below: Vec<f64>,
    /// Factor that brings texture made from it to its own level.
    pub(super) level: f64,
    /// The recording's integrated loudness in LUFS; none for silence.
    lufs: Option<f64>,
    /// Taps of the equaliser towards its spectrum; empty if that would not improve the match.
    pub(super) taps: Vec<f64>,
    /// Taps that bring the difference of two channels to its level in the recording; empty if there is no difference.
    pub(super) side_taps: Vec<f64>,
    /// Taps of the low-pass, if the recording is band-limited; otherwise empty.
    pub(super) limit_taps: Vec<f64>,
    /// Root mean square of white noise as dense as the recording's noise floor above the low-pass; 0 if there is none.
    pub(super) floor: f64,
}

impl Profile {
    /// Removes the loudness from `channels`, at least one and all equally long, and returns it with the profile.
    pub fn compress(channels: &mut [Vec<f64>], sample_rate_hz: f64) -> (RemovedLoudness, Self) {
        let power = Power::of_signal(&mean_of(channels), sample_rate_hz);
        Self::compress_with(channels, &power, sample_rate_hz)
    }

    /// The same where the `power` of the channels' mean is known already.
    pub(crate) fn compress_with(
        channels: &mut [Vec<f64>],
        power: &Power,
        sample_rate_hz: f64,
    ) -> (RemovedLoudness, Self) {
        let frame_samples = frame_samples(sample_rate_hz);
        let mut relative = loudness(channels, frame_samples, sample_rate_hz);
        let whole = (relative.iter().map(|x| x * x).sum::<f64>() / relative.len().max(1) as f64).sqrt();
        let floor = FLOOR * relative.iter().fold(0.0f64, |most, x| most.max(*x));
        let is_audible = whole > 0.0;
        relative.iter_mut().for_each(|x| *x = if is_audible { x.max(floor) / whole } else { 1.0 });
        let removed = RemovedLoudness::divide_out(channels, relative, frame_samples, MATCH_EXPONENT);
        let limit_hz = power.band_limit_hz();
        let profile = Self {
            matched_rms: rms_below(&mean_of(channels), MATCHED_HZ, sample_rate_hz),
            below: (0..=LOW_STEPS).map(|step| power.rms_between(INFRASOUND_HZ, LOW_STEP_HZ * step as f64)).collect(),
            level: 1.0,
            lufs: None,
            taps: Vec::new(),
            side_taps: Vec::new(),
            limit_taps: limit_hz.map_or_else(Vec::new, |hz| design_low_pass(hz, sample_rate_hz)),
            floor: limit_hz.map_or(0.0, |hz| power.floor_above(hz)),
        };
        (removed, profile)
    }

    /// Sets the recording's integrated loudness.
    pub(crate) fn set_loudness(&mut self, lufs: Option<f64>) {
        self.lufs = lufs;
    }

    /// The factor that brings the recording to a loudness in LUFS, by at most 40 dB; 1 if none is requested.
    pub fn gain_to(&self, target_lufs: Option<f64>) -> f64 {
        match (target_lufs, self.lufs) {
            (Some(target), Some(own)) => maths::pow(10.0, (target - own).clamp(-MOST_GAIN_DB, MOST_GAIN_DB) / 20.0),
            _ => 1.0,
        }
    }

    /// Root mean square of the matched signal of the recording.
    pub(crate) fn matched_rms(&self) -> f64 {
        self.matched_rms
    }

    /// Sets the results of a [calibration](super::calibrate).
    pub(super) fn set_calibration(&mut self, level: f64, taps: Vec<f64>, side_taps: Vec<f64>) {
        self.level = level;
        self.taps = taps;
        self.side_taps = side_taps;
    }

    /// Root mean square of the audible sound below a frequency in Hz.
    pub(super) fn rms_below(&self, frequency_hz: f64) -> f64 {
        let position = (frequency_hz / LOW_STEP_HZ).clamp(0.0, LOW_STEPS as f64);
        let step = (position as usize).min(LOW_STEPS - 1);
        self.below[step] + (position - step as f64) * (self.below[step + 1] - self.below[step])
    }

    /// Approximate number of bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let taps = self.taps.len() + self.side_taps.len() + self.limit_taps.len();
        (self.below.len() + taps) * size_of::<f64>()
    }
}

/// The weighting filter of loudness: a shelf of first order, with a zero at the first corner and a pole at the second.
fn highs_raised(sample_rate_hz: f64) -> impl FnMut(f64) -> f64 {
    let [zero, pole] = RISE_HZ.map(|hz| 1.0 / section_gain(hz.min(HIGHEST * sample_rate_hz), sample_rate_hz));
    let (mut before, mut out) = (0.0, 0.0);
    move |sample| {
        out = ((1.0 + zero) * sample + (1.0 - zero) * before - (1.0 - pole) * out) / (1.0 + pole);
        before = sample;
        out
    }
}

/// Loudness by frames: the root of the channels' mean power below [`LOUDNESS_HZ`], zero phase, with the highs raised.
fn loudness(channels: &[Vec<f64>], frame_samples: usize, sample_rate_hz: f64) -> Vec<f64> {
    let frame_rate_hz = sample_rate_hz / frame_samples as f64;
    let samples = channels.first().map_or(0, Vec::len);
    let mut powers = vec![0.0; samples.div_ceil(frame_samples)];
    for channel in channels {
        let mut weighted = highs_raised(sample_rate_hz);
        for (power, frame) in powers.iter_mut().zip(channel.chunks(frame_samples)) {
            frame.iter().for_each(|sample| *power += maths::square(weighted(*sample)));
        }
    }
    for (frame, power) in powers.iter_mut().enumerate() {
        let length = frame_samples.min(samples - frame * frame_samples);
        *power /= (length * channels.len()) as f64;
    }
    // Beyond the ends there is no signal, which differs from silence: the sum of weights accounts for it.
    let mut weights = vec![1.0; powers.len()];
    let keep = maths::exp(-2.0 * std::f64::consts::PI * LOUDNESS_HZ / frame_rate_hz);
    for series in [&mut powers, &mut weights] {
        smooth(series.iter_mut(), keep);
        smooth(series.iter_mut().rev(), keep);
    }
    powers.iter().zip(&weights).map(|(power, weight)| (power / weight).max(0.0).sqrt()).collect()
}

fn smooth<'a>(values: impl Iterator<Item = &'a mut f64>, keep: f64) {
    let mut state = 0.0;
    for value in values {
        state = keep * state + (1.0 - keep) * *value;
        *value = state;
    }
}

fn rms_below(signal: &[f64], corner_hz: f64, sample_rate_hz: f64) -> f64 {
    let (mut section, gain) = (Svf::default(), section_gain(corner_hz, sample_rate_hz));
    let sum: f64 = signal.iter().map(|x| maths::square(section.process(gain, *x).low)).sum();
    (sum / signal.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsp::White;

    fn swelling(samples: usize) -> Vec<f64> {
        let mut noise = vec![0.0; samples];
        White::new(3, 4).fill(0, &mut noise);
        let swell = |i: usize| 0.1 * 10f64.powf((i as f64 / 44_100.0 * 2.0 * std::f64::consts::PI * 0.5).sin());
        noise.iter().enumerate().map(|(i, x)| x * swell(i)).collect()
    }

    #[test]
    fn own_gain_restores_the_removed_loudness() {
        let recording = swelling(200_000);
        let mut flat = [recording.clone()];
        let (removed, _) = Profile::compress(&mut flat, 44_100.0);
        for (i, (flat, sample)) in flat[0].iter().zip(&recording).enumerate().step_by(97) {
            let back = flat * removed.gain_at(i as i64, 0.0);
            assert!((back - sample).abs() < 1e-12, "{i}: {back} instead of {sample}");
            assert_eq!(removed.gain_at(i as i64, MATCH_EXPONENT), 1.0);
        }
    }

    #[test]
    fn a_loud_low_end_that_sways_does_not_make_the_highs_sway() {
        let rate_hz = 44_100.0;
        let (mut high, mut low) = (vec![0.0; 200_000], vec![0.0; 200_000]);
        White::new(1, 2).fill(0, &mut high);
        let omega = |hz: f64, i: usize| 2.0 * std::f64::consts::PI * hz * i as f64 / rate_hz;
        low.iter_mut().enumerate().for_each(|(i, x)| *x = 2.0 * (1.0 + omega(2.0, i).sin()) * omega(60.0, i).sin());
        let mut flat = [high.iter().zip(&low).map(|(high, low)| high + low).collect()];
        Profile::compress(&mut flat, rate_hz);
        let (mut section, gain) = (Svf::default(), section_gain(2000.0, rate_hz));
        let highs: Vec<f64> = flat[0].iter().map(|x| section.process(gain, *x).high).collect();
        let levels: Vec<f64> = highs[4410..].chunks_exact(2205).map(|x| x.iter().map(|x| x * x).sum::<f64>()).collect();
        let [most, least] = [f64::max, f64::min].map(|pick| levels.iter().copied().reduce(pick).unwrap());
        let swing_db = 10.0 * (most / least).log10();
        assert!(swing_db < 2.0, "{swing_db} dB");
    }

    #[test]
    fn flat_is_flatter_by_the_exponent() {
        let recording = swelling(400_000);
        let mut flat = [recording.clone()];
        Profile::compress(&mut flat, 44_100.0);
        let range_db = |signal: &[f64]| {
            let level = |part: &[f64]| part.iter().map(|x| x * x).sum::<f64>() / part.len() as f64;
            let levels: Vec<f64> = signal.chunks_exact(4096).map(|part| 10.0 * level(part).log10()).collect();
            levels.iter().fold(f64::MIN, |a, b| a.max(*b)) - levels.iter().fold(f64::MAX, |a, b| a.min(*b))
        };
        let (before, after) = (range_db(&recording), range_db(&flat[0]));
        assert!((after / before - (1.0 - MATCH_EXPONENT)).abs() < 0.05, "{after} of {before} dB");
    }

    #[test]
    fn silence_and_a_single_sample_stay_finite() {
        for recording in [vec![0.0; 5000], vec![0.3], vec![]] {
            let mut flat = [recording];
            let (removed, profile) = Profile::compress(&mut flat, 44_100.0);
            assert!(flat[0].iter().all(|x| x.is_finite()));
            assert!(removed.gain_at(10, 0.2).is_finite() && profile.rms_below(150.0).is_finite());
        }
    }
}
