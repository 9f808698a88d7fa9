//! Removal of inaudible low frequencies: an offset, and the rumble of wind and microphone stands.
//!
//! They carry no sound, but affect every peak and every match: an offset of 2 % of full scale equals the whole sound of
//! a quiet fire. They are filtered out forwards and backwards, so that nothing above them moves in time.

use std::f64::consts::PI;

/// Corner in Hz. Both passes together attenuate by 6 dB here, 0.03 dB an octave above and 48 dB an octave below.
const CORNER_HZ: f64 = 10.0;

/// Damping of the two sections that make up a Butterworth filter of fourth order: 1 / Q.
const DAMPINGS: [f64; 2] = [0.765_366_864_730_179_6, 1.847_759_065_022_573_5];

/// Seconds of mirror image with which both ends are extended, and in which the filter settles.
const MIRROR_S: f64 = 0.3;

/// Shorter sounds have no such frequencies, but they can have an offset.
const LEAST_S: f64 = 0.2;

/// Power below the corner, as a share of the total, from which it is removed: -60 dB. Recordings with less are
/// unchanged, bit for bit.
const LEAST_SHARE: f64 = 1e-6;

/// Samples smaller than this cannot be sound from any medium, and slow down all computation.
const LEAST_SAMPLE: f32 = f32::MIN_POSITIVE;

/// Removes inaudible low frequencies from every channel, if there is enough of them to matter.
pub(crate) fn remove(channels: &mut [Vec<f32>], sample_rate_hz: u32) {
    for samples in channels {
        remove_from(samples, f64::from(sample_rate_hz));
        for sample in samples.iter_mut().filter(|sample| sample.abs() < LEAST_SAMPLE) {
            *sample = 0.0;
        }
    }
}

fn remove_from(samples: &mut [f32], rate_hz: f64) {
    let filtered = filtered(samples, rate_hz);
    // At both ends, the filter does not know how the sound continues: what it finds there may be its own.
    let end = (MIRROR_S * rate_hz) as usize;
    let end = if samples.len() > 4 * end { end } else { 0 };
    let judged = end..samples.len() - end;
    let (mut power, mut removed) = (0.0, 0.0);
    for (sample, left) in samples[judged.clone()].iter().zip(&filtered[judged]) {
        power += maths::square(f64::from(*sample));
        removed += maths::square(f64::from(*sample) - left);
    }
    if removed > LEAST_SHARE * power {
        samples.iter_mut().zip(filtered).for_each(|(sample, left)| *sample = left as f32);
    }
}

fn filtered(samples: &[f32], rate_hz: f64) -> Vec<f64> {
    let mean = samples.iter().map(|sample| f64::from(*sample)).sum::<f64>() / samples.len().max(1) as f64;
    let centred = samples.iter().map(|sample| f64::from(*sample) - mean);
    if (samples.len() as f64) < LEAST_S * rate_hz {
        return centred.collect();
    }
    let centred: Vec<f64> = centred.collect();
    let mirror = ((MIRROR_S * rate_hz) as usize).min(centred.len() - 1);
    // A mirror image turned about its value at the end, as is usual, would introduce an offset.
    let before = centred[1..=mirror].iter().rev().copied();
    let after = centred.iter().rev().skip(1).take(mirror).copied();
    let mut all: Vec<f64> = before.chain(centred.iter().copied()).chain(after).collect();
    for _ in 0..2 {
        DAMPINGS.iter().for_each(|damping| high_pass(&mut all, *damping, rate_hz));
        all.reverse();
    }
    all.drain(..mirror);
    all.truncate(samples.len());
    all
}

/// A state-variable filter, which remains exact at corners far below the rate.
fn high_pass(samples: &mut [f64], damping: f64, rate_hz: f64) {
    let g = maths::tan(PI * CORNER_HZ / rate_hz);
    let scale = 1.0 / (1.0 + g * (g + damping));
    let (mut band, mut low) = (0.0, 0.0);
    for sample in samples {
        let high = (*sample - (g + damping) * band - low) * scale;
        let middle = g * high + band;
        band = g * high + middle;
        let deep = g * middle + low;
        low = g * middle + deep;
        *sample = high;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: u32 = 48_000;

    fn tone(frequency_hz: f64, samples: usize) -> Vec<f32> {
        let step = 2.0 * PI * frequency_hz / f64::from(RATE_HZ);
        (0..samples).map(|n| (0.1 * (step * n as f64 + 0.4).sin()) as f32).collect()
    }

    fn removed(samples: &[f32]) -> Vec<f32> {
        let mut channels = [samples.to_vec()];
        remove(&mut channels, RATE_HZ);
        channels[0].clone()
    }

    fn level_db(samples: &[f32]) -> f64 {
        let power = samples.iter().map(|sample| f64::from(*sample).powi(2)).sum::<f64>() / samples.len() as f64;
        10.0 * power.log10()
    }

    #[test]
    fn tones_pass_above_the_corner_and_end_below() {
        for (frequency_hz, low_db, high_db) in
            [(1000.0, -0.001, 0.001), (40.0, -0.01, 0.01), (20.0, -0.1, 0.0), (10.0, -7.0, -5.0), (5.0, -60.0, -40.0)]
        {
            let tone = tone(frequency_hz, 96_000);
            let change_db = level_db(&removed(&tone)[20_000..76_000]) - level_db(&tone[20_000..76_000]);
            assert!((low_db..=high_db).contains(&change_db), "{frequency_hz} Hz: {change_db} dB");
        }
    }

    #[test]
    fn an_offset_goes_and_the_sound_stays_in_its_place() {
        let sound = tone(300.0, 48_000);
        let offset: Vec<f32> = sound.iter().map(|sample| sample + 0.5).collect();
        let left = removed(&offset);
        let error = sound.iter().zip(&left).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(error < 3e-3, "an error of {error}");
        let mean = left.iter().sum::<f32>() / 48_000.0;
        assert!(mean.abs() < 1e-5, "an offset of {mean}");
    }

    #[test]
    fn a_sound_without_low_frequencies_stays_bit_for_bit() {
        let sound = tone(480.0, 96_000);
        assert_eq!(removed(&sound), sound);
    }

    #[test]
    fn short_sounds_lose_their_offset_only() {
        assert_eq!(removed(&[0.75, 0.25]), [0.25, -0.25]);
        assert_eq!(removed(&[0.5]), [0.0]);
        assert_eq!(removed(&[]), []);
    }

    #[test]
    fn denormal_samples_become_silence() {
        assert_eq!(removed(&[1e-42, -1e-42, 0.0, 1e-39]), [0.0; 4]);
    }
}
