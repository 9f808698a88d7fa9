//! Equal loudness of all sounds of a trial (ITU-R BS.1770).

use anyhow::{Context, Result};
use ebur128::{EbuR128, Mode};

/// The loudest that a trial is, in LUFS, and the highest peak.
const LOUDEST_LUFS: f64 = -23.0;
const HIGHEST_PEAK: f64 = 0.89;

/// Matches the loudness of `sounds`: the highest at which none of them clips. Returns it in LUFS.
///
/// # Errors
/// If a sound is silent.
pub fn match_loudness(sounds: &mut [Vec<f32>], rate_hz: u32) -> Result<f64> {
    let own: Vec<f64> = sounds.iter().map(|sound| loudness(sound, rate_hz)).collect::<Result<_>>()?;
    let headroom = |sound: &Vec<f32>| {
        let peak = sound.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
        20.0 * (HIGHEST_PEAK / f64::from(peak)).log10()
    };
    let lufs = sounds.iter().zip(&own).fold(LOUDEST_LUFS, |lufs, (sound, own)| lufs.min(own + headroom(sound)));
    for (sound, own) in sounds.iter_mut().zip(&own) {
        let gain = 10f64.powf((lufs - own) / 20.0) as f32;
        sound.iter_mut().for_each(|x| *x *= gain);
    }
    Ok(lufs)
}

fn loudness(sound: &[f32], rate_hz: u32) -> Result<f64> {
    let mut meter = EbuR128::new(1, rate_hz, Mode::I)?;
    meter.add_frames_f32(sound)?;
    let lufs = meter.loudness_global()?;
    lufs.is_finite()
        .then_some(lufs)
        .context("a sound of the test is silent, so it cannot be made as loud as the others")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sounds_become_equally_loud_and_none_clips() {
        let tone = |amplitude: f32| (0..88_200).map(|n| amplitude * (n as f32 * 0.14).sin()).collect::<Vec<f32>>();
        let mut spiky = tone(0.01);
        spiky[40_000] = 0.5;
        let mut sounds = [tone(0.9), spiky, tone(0.002)];
        let lufs = match_loudness(&mut sounds, 44_100).unwrap();
        assert!(lufs < LOUDEST_LUFS);
        for sound in &sounds {
            assert!((loudness(sound, 44_100).unwrap() - lufs).abs() < 0.05);
            assert!(sound.iter().all(|x| x.abs() <= 0.891));
        }
        assert!(match_loudness(&mut [vec![0.0; 88_200]], 44_100).is_err());
    }
}
