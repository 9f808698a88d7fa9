//! From the texture of one recording to its audible output: its band limit, its equaliser, its stereo image.

use std::ops::Range;

use super::equalizer::Equalizer;
use super::image::Image;
use super::recorded::Recorded;
use crate::dsp::White;

/// Factor per sample with which the rest of a removed recording fades out.
const FADE: f64 = 0.99;

/// Seed and, for the first slot, stream of the noise floor; no other stage uses them.
const FLOOR_SEED: u32 = 0x464C_4F52;
const FLOOR_STREAM: u32 = 0x4849_5300;

/// Filters of one recording.
#[derive(Debug)]
pub(super) struct RecordingFilters {
    /// Removes the energy that changing windows leave above a band-limited recording's limit; its noise floor is added back.
    band_limit: Equalizer,
    equalizer: Equalizer,
    /// Image matching, for two channels only.
    image: Option<Image>,
    /// Samples for which it has been silent, and those skipped meanwhile.
    silent_samples: usize,
    left_out: usize,
    /// Samples of silence after which no filter retains anything of the past.
    forgets_after: usize,
    /// The recording's own level.
    level: f64,
    /// The noise floor above a band limit, and its factor for each sample of the block.
    floor: White,
    floor_gains: Vec<f64>,
}

impl RecordingFilters {
    /// The filters of the recording in `slot`, with `channels` in blocks of up to `block` samples.
    pub fn new(slot: usize, sample_rate_hz: f64, channels: usize, block: usize) -> Self {
        let mut filters = Self {
            band_limit: Equalizer::new(sample_rate_hz, channels),
            equalizer: Equalizer::new(sample_rate_hz, channels),
            image: (channels == 2).then(|| Image::new(sample_rate_hz, block)),
            silent_samples: 0,
            left_out: 0,
            forgets_after: 0,
            level: 0.0,
            floor: White::new(FLOOR_SEED, FLOOR_STREAM + slot as u32),
            floor_gains: vec![0.0; block],
        };
        let memory_samples = filters.band_limit.memory_samples() + filters.equalizer.memory_samples();
        filters.forgets_after = memory_samples + filters.tail_samples();
        filters.reset();
        filters
    }

    /// Resets to silence.
    pub fn reset(&mut self) {
        self.band_limit.reset();
        self.equalizer.reset();
        self.image.iter_mut().for_each(Image::reset);
        self.silent_samples = self.forgets_after;
        self.left_out = 0;
    }

    /// Samples for which it continues to sound.
    pub fn tail_samples(&self) -> usize {
        2 * self.equalizer.tail_samples() + self.image.as_ref().map_or(0, Image::tail_samples)
    }

    /// True if it is or may be audible.
    pub fn is_on(&self, recorded: &Recorded<'_>) -> bool {
        recorded.profile.is_some() || self.silent_samples < self.forgets_after
    }

    /// The recording's own level at the next sample.
    #[inline]
    pub fn level(&mut self, recorded: &Recorded<'_>) -> f64 {
        self.level = recorded.profile.map_or(FADE * self.level, |profile| profile.level);
        self.level
    }

    /// Sets the factor of the noise floor at sample `i` of the block, for a recording at level 1.
    #[inline]
    pub fn set_floor_gain(&mut self, i: usize, gain: f64) {
        self.floor_gains[i] = gain;
    }

    /// Filters the samples in `range` of every channel. After its recording is removed, it ends once it is silent. The
    /// block's first sample is at `position` on the host's timeline.
    pub fn process(
        &mut self,
        recorded: &Recorded<'_>,
        spectrum_match: f64,
        channels: &mut [&mut [f64]],
        range: Range<usize>,
        position: i64,
    ) {
        if !self.is_on(recorded) {
            self.left_out += range.len();
            return;
        }
        let left_out = std::mem::take(&mut self.left_out);
        // The filters count skipped samples too, so that their blocks stay where they would be without a pause.
        if left_out > 0 {
            self.band_limit.skip(left_out);
            self.equalizer.skip(left_out);
            self.image.iter_mut().for_each(|image| image.skip(left_out));
        }
        let [limit_taps, taps, side_taps] = match recorded.profile {
            Some(profile) => [&profile.limit_taps[..], &profile.taps, &profile.side_taps],
            None => [&[] as &[f64]; 3],
        };
        self.count_silence(channels, range.clone());
        self.band_limit.process(limit_taps, 1.0, channels, range.clone());
        self.equalizer.process(taps, spectrum_match, channels, range.clone());
        if let Some(image) = &mut self.image {
            image.process(side_taps, channels, range.clone());
        }
        if let Some(profile) = recorded.profile.filter(|profile| profile.floor > 0.0) {
            for i in range {
                let noise = profile.floor * self.floor_gains[i] * self.floor.sample_at(position.wrapping_add(i as i64));
                channels.iter_mut().for_each(|channel| channel[i] += noise);
            }
        }
    }

    fn count_silence(&mut self, channels: &[&mut [f64]], range: Range<usize>) {
        let is_heard = |i: &usize| channels.iter().any(|channel| channel[*i] != 0.0);
        self.silent_samples = match range.clone().rev().find(is_heard) {
            Some(last) => range.end - 1 - last,
            None => self.silent_samples.saturating_add(range.len()),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::companding::equalizer::design;
    use crate::companding::profile::Profile;
    use crate::dsp::White;

    const RATE_HZ: f64 = 44_100.0;

    /// A recording is heard, taken away, and loaded again; `cut` says how the sound is cut.
    fn run(cut: usize, always: bool) -> Vec<f64> {
        let mut noise = vec![0.0; 24_000];
        White::new(5, 6).fill(0, &mut noise);
        noise[6_000..18_000].fill(0.0);
        let (_, mut profile) = Profile::compress(&mut [noise.clone()], RATE_HZ);
        profile.set_calibration(1.0, design(&[6.0; 23], RATE_HZ), Vec::new());
        let mut filters = RecordingFilters::new(0, RATE_HZ, 1, 1000);
        let mut at = 0;
        while at < noise.len() {
            let end = (at + cut).min((at / 1000 + 1) * 1000);
            let is_there = always || !(6_000..18_000).contains(&at);
            let recorded = Recorded { profile: is_there.then_some(&profile), gain: 1.0 };
            filters.process(&recorded, 1.0, &mut [&mut noise], at..end, 0);
            at = end;
        }
        noise
    }

    #[test]
    fn a_noise_floor_comes_with_the_recording_however_it_is_cut() {
        let mut noise = vec![0.0; 100_000];
        White::new(5, 6).fill(0, &mut noise);
        let (_, mut profile) = Profile::compress(&mut [noise], RATE_HZ);
        let mut output = |floor: f64, cut: usize| {
            profile.floor = floor;
            let recorded = Recorded { profile: Some(&profile), gain: 1.0 };
            let (mut filters, mut silence) = (RecordingFilters::new(1, RATE_HZ, 1, 1000), vec![0.0; 1000]);
            (0..1000).for_each(|i| filters.set_floor_gain(i, 0.5));
            for start in (0..1000).step_by(cut) {
                filters.process(&recorded, 1.0, &mut [&mut silence], start..(start + cut).min(1000), 77);
            }
            silence
        };
        assert!(output(0.0, 1000).iter().all(|x| *x == 0.0));
        let whole = output(1e-2, 1000);
        let rms = (whole.iter().map(|x| x * x).sum::<f64>() / 1000.0).sqrt();
        assert!((rms - 0.5e-2).abs() < 0.5e-3, "{rms}");
        assert!(output(1e-2, 7) == whole);
    }

    #[test]
    fn skipping_silence_does_not_change_the_output() {
        let whole = run(1000, false);
        assert!([1, 7, 333].iter().all(|cut| run(*cut, false) == whole), "however it is cut");
        assert!(whole[7_500..18_000].iter().all(|x| *x == 0.0));
        // Its filters begin with the next of their blocks.
        assert!(whole[18_100..] == run(1000, true)[18_100..], "then as if it had gone on");
    }
}
