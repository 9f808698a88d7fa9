//! The drive's own low end, in place of texture's.

use std::ops::Range;

use crate::dsp::{Bands, Coefficients, Section, section_gain};
use crate::error::within;

/// Duration in seconds of a change of the crossover.
const GLIDE_S: f64 = 0.03;
/// The lowest and the highest crossover in Hz; the parameter `low_end` goes up to the highest.
pub const LOWEST_HZ: f64 = 20.0;
/// See [`LOWEST_HZ`].
pub const HIGHEST_HZ: f64 = 400.0;

/// Dampings of the sections of a Butterworth filter of order 4.
const DAMPINGS: [f64; 2] = [1.847_759_065_022_573_5, 0.765_366_864_730_179_6];
/// Samples from one check whether a filter has fallen silent to the next. Counted since reset, so that blocks do not matter.
const CHECKED_SAMPLES: usize = 64;
/// Level below which a drive counts as silence, and at which a filter whose input has ended stops ringing: -200 dBFS. Behind
/// the drive's own high-pass, which rings at a few hertz, and of so high an order, the crossover would otherwise ring for
/// half a second down to where a single section ends.
const SILENCE: f64 = 1e-10;

/// Channels filtered together, as vectors.
const LANES: usize = 2;

/// Filters of order 8, one for each lane: that of order 4, twice.
#[derive(Debug, Clone, Copy)]
struct Half<const LANES: usize>([[Section<LANES>; DAMPINGS.len()]; 2]);

impl<const LANES: usize> Default for Half<LANES> {
    fn default() -> Self {
        Self([[Section::default(); DAMPINGS.len()]; 2])
    }
}

impl<const LANES: usize> Half<LANES> {
    /// Filters one sample of each lane; `band` chooses the output of each section.
    #[inline]
    fn process(
        &mut self,
        coefficients: &[Coefficients; DAMPINGS.len()],
        inputs: [f64; LANES],
        band: fn(Bands<[f64; LANES]>) -> [f64; LANES],
    ) -> [f64; LANES] {
        let sections = self.0.iter_mut().flat_map(|half| half.iter_mut().zip(coefficients));
        sections.fold(inputs, |values, (section, coefficients)| band(section.process(coefficients, values)))
    }

    /// Ends the sound of each lane whose input has ended, and of which nothing more is heard.
    fn end_if_silent(&mut self, inputs: [f64; LANES]) {
        for (lane, input) in inputs.into_iter().enumerate() {
            if self.0.iter().flatten().all(|section| section.is_below(SILENCE, input, lane)) {
                self.0.iter_mut().flatten().for_each(|section| section.reset_lane(lane));
            }
        }
    }
}

/// A crossover of Linkwitz and Riley, order 8: its two bands are in phase with one another, so that they add up without a
/// dip. Of a lower order, texture would disturb the drive far below the crossover: with order 4 and 150 Hz, the output's
/// coherence with the drive was 0.87 at 120 Hz. Glides to a new corner; switched off it passes texture as it is.
#[derive(Debug)]
pub struct LowEnd {
    sample_rate_hz: f64,
    /// Most that the wet share, and the gain, change in a sample.
    wet_step: f64,
    gain_step: f64,
    drive: Half<1>,
    /// Texture's channels, [`LANES`] at a time.
    texture: Vec<Half<LANES>>,
    gain: f64,
    coefficients: [Coefficients; DAMPINGS.len()],
    /// Samples until the next check for silence.
    unchecked: usize,
    /// Share of the crossover in the result, 0-1.
    wet: f64,
    asked_hz: Option<f64>,
    target_gain: f64,
    target_wet: f64,
}

impl LowEnd {
    /// A crossover for `channels` of texture.
    pub fn new(sample_rate_hz: f64, channels: usize) -> Self {
        let wet_step = 1.0 / (GLIDE_S * sample_rate_hz);
        Self {
            sample_rate_hz,
            wet_step,
            gain_step: wet_step * section_gain(HIGHEST_HZ, sample_rate_hz),
            drive: Default::default(),
            texture: vec![Default::default(); channels.div_ceil(LANES)],
            gain: 0.0,
            coefficients: Default::default(),
            unchecked: CHECKED_SAMPLES,
            wet: 0.0,
            asked_hz: None,
            target_gain: 0.0,
            target_wet: 0.0,
        }
    }

    /// Restores the state of a fresh instance.
    pub fn reset(&mut self) {
        self.asked_hz = None;
        self.drive = Default::default();
        self.texture.fill(Default::default());
        self.unchecked = CHECKED_SAMPLES;
    }

    /// Sets out for a crossover in Hz; 0 switches off.
    pub fn aim(&mut self, crossover_hz: f64) {
        if self.asked_hz == Some(crossover_hz) {
            return;
        }
        let fresh = self.asked_hz.is_none();
        self.asked_hz = Some(crossover_hz);
        self.target_wet = if crossover_hz > 0.0 { 1.0 } else { 0.0 };
        if crossover_hz > 0.0 {
            self.target_gain = section_gain(within(crossover_hz, LOWEST_HZ, HIGHEST_HZ), self.sample_rate_hz);
        }
        if fresh || self.wet == 0.0 {
            self.set_gain(self.target_gain);
        }
        if fresh {
            self.wet = self.target_wet;
        }
    }

    fn set_gain(&mut self, gain: f64) {
        self.gain = gain;
        self.coefficients = DAMPINGS.map(|damping| Coefficients::new(gain, damping));
    }

    /// Mixes `drive` below the crossover into the samples in `range` of every channel; all are as long as the block.
    pub fn process(&mut self, drive: &[f64], channels: &mut [&mut [f64]], range: Range<usize>) {
        let mut start = range.start;
        while start < range.end {
            let is_settled = self.wet == self.target_wet && self.gain == self.target_gain;
            if is_settled && self.wet == 0.0 {
                return;
            }
            // A gliding corner changes the coefficients at every sample.
            let samples = if is_settled { self.unchecked.min(range.end - start) } else { 1 };
            self.wet = approach(self.wet, self.target_wet, self.wet_step);
            if self.gain != self.target_gain {
                // It glides as the filters' coefficient, which takes no tangent for each sample.
                self.set_gain(approach(self.gain, self.target_gain, self.gain_step));
            }
            self.unchecked -= samples;
            self.mix(&drive[start..start + samples], channels, start);
            start += samples;
        }
    }

    /// The same for a few samples from `start` on, during which nothing glides.
    fn mix(&mut self, drive: &[f64], channels: &mut [&mut [f64]], start: usize) {
        let is_checked = self.unchecked == 0;
        if is_checked {
            self.unchecked = CHECKED_SAMPLES;
        }
        let audible = |drive: f64| if drive.abs() < SILENCE { 0.0 } else { drive };
        let mut low = [0.0; CHECKED_SAMPLES];
        for (low, drive) in low.iter_mut().zip(drive) {
            [*low] = self.drive.process(&self.coefficients, [audible(*drive)], |bands| bands.low);
        }
        if let (true, Some(last)) = (is_checked, drive.last()) {
            self.drive.end_if_silent([audible(*last)]);
        }
        let (low, wet) = (&low[..drive.len()], self.wet);
        for (channels, filter) in channels.chunks_mut(LANES).zip(&mut self.texture) {
            let mut textures = [0.0; LANES];
            let mut mixed = |textures: [f64; LANES], low: f64| {
                let high = filter.process(&self.coefficients, textures, |bands| bands.high);
                std::array::from_fn::<f64, LANES, _>(|lane| textures[lane] + wet * (low + high[lane] - textures[lane]))
            };
            match channels {
                [left, right] => {
                    let pairs = left[start..].iter_mut().zip(&mut right[start..]);
                    for ((left, right), low) in pairs.zip(low) {
                        textures = [*left, *right];
                        [*left, *right] = mixed(textures, *low);
                    }
                }
                [single, ..] => {
                    for (single, low) in single[start..].iter_mut().zip(low) {
                        textures = [*single, 0.0];
                        [*single, _] = mixed(textures, *low);
                    }
                }
                [] => {}
            }
            if is_checked {
                filter.end_if_silent(textures);
            }
        }
    }
}

/// `value` moved towards `target` by at most `step`.
fn approach(value: f64, target: f64, step: f64) -> f64 {
    value + (target - value).clamp(-step, step)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const RATE_HZ: f64 = 48_000.0;

    fn sine(frequency_hz: f64) -> Vec<f64> {
        (0..48_000).map(|i| (2.0 * PI * frequency_hz * i as f64 / RATE_HZ).sin()).collect()
    }

    fn rms(signal: &[f64]) -> f64 {
        (signal.iter().map(|x| x * x).sum::<f64>() / signal.len() as f64).sqrt()
    }

    fn run(drive: &[f64], texture: &[f64], crossover_hz: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut low_end = LowEnd::new(RATE_HZ, 1);
        let mut out = texture.to_vec();
        for i in 0..drive.len() {
            low_end.aim(crossover_hz(i));
            low_end.process(drive, &mut [&mut out], i..i + 1);
        }
        out
    }

    #[test]
    fn the_same_signal_on_both_sides_keeps_its_level() {
        for frequency_hz in [40.0, 100.0, 150.0, 250.0, 1000.0] {
            let signal = sine(frequency_hz);
            let out = run(&signal, &signal, |_| 150.0);
            let change_db = 20.0 * (rms(&out[24_000..]) / rms(&signal[24_000..])).log10();
            assert!(change_db.abs() < 0.02, "{frequency_hz} Hz: {change_db} dB");
        }
    }

    #[test]
    fn below_is_the_drive_and_above_is_texture() {
        let silence = vec![0.0; 48_000];
        for (frequency_hz, drive_is_heard) in [(50.0, true), (600.0, false)] {
            let signal = sine(frequency_hz);
            let filtered = [run(&signal, &silence, |_| 150.0), run(&silence, &signal, |_| 150.0)];
            let levels_db = filtered.map(|x| 20.0 * (rms(&x[24_000..]) / rms(&signal[24_000..])).log10());
            let (heard_db, other_db) =
                if drive_is_heard { (levels_db[0], levels_db[1]) } else { (levels_db[1], levels_db[0]) };
            assert!(heard_db > -0.3 && other_db < -35.0, "{frequency_hz} Hz: {levels_db:?}");
        }
    }

    #[test]
    fn texture_hardly_disturbs_the_drive_an_octave_below() {
        let (silence, signal) = (vec![0.0; 48_000], sine(75.0));
        let level_db = 20.0 * (rms(&run(&silence, &signal, |_| 150.0)[24_000..]) / rms(&signal[24_000..])).log10();
        assert!((-50.0..-45.0).contains(&level_db), "{level_db} dB");
    }

    #[test]
    fn off_is_texture_bit_for_bit() {
        let (drive, texture) = (sine(60.0), sine(333.0));
        assert_eq!(run(&drive, &texture, |_| 0.0), texture);
        let switched = run(&drive, &texture, |i| if i < 20_000 { 150.0 } else { 0.0 });
        assert_eq!(switched[24_000..], texture[24_000..]);
    }

    #[test]
    fn a_drive_that_fades_out_ends_exactly() {
        let fading: Vec<f64> = sine(8.0).iter().enumerate().map(|(i, x)| x * (-(i as f64) / 1000.0).exp()).collect();
        let out = run(&fading, &vec![0.0; fading.len()], |_| 150.0);
        let last = out.iter().rposition(|x| *x != 0.0).expect("it sounds");
        // The fade reaches -200 dBFS after 23,000 samples; the filter, 100 ms later.
        assert!((22_000..28_000).contains(&last), "until {last}");
    }

    #[test]
    fn blocks_never_matter() {
        let (drive, left, right) = (sine(60.0), sine(333.0), sine(444.0));
        let corner_hz = |block: usize| [150.0, 150.0, 0.0, 200.0][block / 20 % 4];
        let run = |sizes: &[usize]| {
            let mut low_end = LowEnd::new(RATE_HZ, 3);
            let mut out = [left.clone(), right.clone(), left.clone()];
            let mut start = 0;
            for size in sizes.iter().cycle() {
                let end = (start + size).min(drive.len()).min((start / 500 + 1) * 500);
                low_end.aim(corner_hz(start / 500));
                low_end.process(&drive, &mut out.each_mut().map(Vec::as_mut_slice), start..end);
                start = end;
                if start == drive.len() {
                    return out;
                }
            }
            unreachable!()
        };
        let whole = run(&[500]);
        assert!(whole[0] == whole[2] && whole[0] != whole[1], "each channel by itself");
        assert!(run(&[1]) == whole && run(&[7, 64, 100, 1]) == whole);
    }

    #[test]
    fn changes_do_not_click() {
        let (drive, texture) = (sine(60.0), vec![0.0; 48_000]);
        let steepest = 2.0 * PI * 60.0 / RATE_HZ;
        for (from, to) in [(150.0, 0.0), (0.0, 150.0), (20.0, 400.0), (400.0, 20.0)] {
            let out = run(&drive, &texture, |i| if i < 24_000 { from } else { to });
            let largest = out[2000..].windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
            assert!(largest < 2.0 * steepest, "{from} to {to} Hz: {largest}");
        }
    }
}
