//! Loudness of the page's sounds (ITU-R BS.1770), so that a comparison is not one of levels.

use anyhow::Result;
use ebur128::{EbuR128, Mode};

/// Loudness of every player in LUFS, and the highest peak in dB of full scale: a sound whose peaks would be higher is quieter.
const TARGET_LUFS: f64 = -20.0;
const HIGHEST_PEAK_DB: f64 = -1.0;
/// The quietest loudness that is believed, in LUFS: below it BS.1770 has no gate.
const QUIETEST_LUFS: f64 = -70.0;

/// Gain of a sound for listening, and the resulting loudness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Listening {
    /// Gain in dB.
    pub gain_db: f64,
    /// Loudness with that gain in LUFS; none for a sound too short or too quiet to have one.
    pub lufs: Option<f64>,
}

/// Gains that match the loudness of all `sounds`: at [the target](TARGET_LUFS), or the highest at which no peak is too
/// high.
///
/// # Errors
/// If a sound has no channels, or more than there are names for.
pub fn matched(sounds: &[(&[Vec<f32>], u32)]) -> Result<Vec<Listening>> {
    let own: Vec<(Option<f64>, f64)> = sounds
        .iter()
        .map(|(channels, rate_hz)| Ok((lufs(channels, *rate_hz)?, peak_db(channels))))
        .collect::<Result<_>>()?;
    let highest = |(lufs, peak_db): &(Option<f64>, f64)| lufs.map(|lufs| lufs + HIGHEST_PEAK_DB - peak_db);
    let target = own.iter().filter_map(highest).fold(TARGET_LUFS, f64::min);
    let listening = own.iter().map(|(lufs, peak_db)| match lufs {
        Some(lufs) => Listening { gain_db: target - lufs, lufs: Some(target) },
        None => Listening { gain_db: HIGHEST_PEAK_DB - peak_db, lufs: None },
    });
    Ok(listening.collect())
}

fn lufs(channels: &[Vec<f32>], rate_hz: u32) -> Result<Option<f64>> {
    let mut meter = EbuR128::new(channels.len() as u32, rate_hz, Mode::I)?;
    let planes: Vec<&[f32]> = channels.iter().map(Vec::as_slice).collect();
    meter.add_frames_planar_f32(&planes)?;
    let lufs = meter.loudness_global()?;
    Ok((lufs >= QUIETEST_LUFS).then_some(lufs))
}

/// Peak in dB of full scale; that of silence is low, not infinite, so that gains stay numbers.
fn peak_db(channels: &[Vec<f32>]) -> f64 {
    let peak = channels.iter().flatten().fold(0.0, |peak, x| f64::from(x.abs()).max(peak));
    20.0 * peak.max(1e-9).log10()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: u32 = 48_000;

    fn tone(amplitude: f32) -> Vec<Vec<f32>> {
        vec![(0..96_000).map(|n| amplitude * (n as f32 * 0.13).sin()).collect()]
    }

    fn played(sound: &[Vec<f32>], gain_db: f64) -> Vec<Vec<f32>> {
        let gain = 10f64.powf(gain_db / 20.0) as f32;
        sound.iter().map(|channel| channel.iter().map(|x| gain * x).collect()).collect()
    }

    #[test]
    fn a_pair_is_equally_loud_and_does_not_clip() {
        let mut spiky = tone(0.01);
        spiky[0][40_000] = 0.5;
        let sounds = [tone(0.9), spiky];
        let found = matched(&[(&sounds[0], RATE_HZ), (&sounds[1], RATE_HZ)]).expect("measured");
        assert!(found[0].lufs < Some(TARGET_LUFS), "the spike does not let it be louder: {found:?}");
        for (sound, listening) in sounds.iter().zip(&found) {
            let played = played(sound, listening.gain_db);
            let difference = lufs(&played, RATE_HZ).expect("measured").expect("loud") - listening.lufs.expect("loud");
            assert!(difference.abs() < 0.05, "{difference}");
            assert!(peak_db(&played) <= HIGHEST_PEAK_DB + 1e-3);
        }
    }

    #[test]
    fn a_sound_alone_has_the_target_and_silence_has_none() {
        let found = matched(&[(&tone(0.001), RATE_HZ)]).expect("measured");
        assert_eq!(found[0].lufs, Some(TARGET_LUFS));
        let silence = matched(&[(&[vec![0.0; 96_000]], RATE_HZ)]).expect("measured");
        assert!(silence[0].lufs.is_none() && silence[0].gain_db.is_finite());
    }
}
