//! Drives for the real recordings: a steady rumble, the reference flames, speech and drums.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};
use pyrophone_recording::{Recording, write_wav_f32};
use pyrophone_synthesis::dsp::White;

use super::sounds;
use crate::bounce::load;

/// A sound that drives the effect.
pub struct Drive {
    /// Its name in the table.
    pub name: String,
    /// Its sound, in one channel.
    pub sound: Recording,
    /// Settings that it needs beyond the preset's.
    pub settings: &'static [&'static str],
}

/// Rate in Hz and length in seconds of generated drives.
const RATE_HZ: u32 = 44_100;
const SECONDS: f64 = 17.0;
/// Band in Hz and root mean square of the rumble.
const RUMBLE_HZ: [f64; 2] = [30.0, 180.0];
const RUMBLE_RMS: f64 = 0.085;
/// Setting for speech and drums: their envelope makes a rumble.
const ENVELOPE: &[&str] = &["drive_mode=input envelope"];
const SPEECH: &str = "The fire was lit at noon. By evening the whole hill was burning, and nobody could say who had begun it. \
    Stand back from the door! It is hotter than it looks, and the wind is turning. Listen: that is the roof.";

/// All drives that can be made here; prints which are left out.
pub fn drives(reference: &Path, folder: &Path) -> Result<Vec<Drive>> {
    let mut all = vec![steady(folder)?];
    for (name, path) in sounds(&reference.join("signals"))? {
        all.push(Drive { name, sound: load(&path, None)?, settings: &[] });
    }
    for (name, made) in [("speech", speech(folder)), ("drums", drums(folder))] {
        match made {
            Ok(sound) => all.push(Drive { name: name.to_owned(), sound, settings: ENVELOPE }),
            Err(error) => eprintln!("  left out: {name} ({error:#})"),
        }
    }
    Ok(all)
}

/// Noise in a band, by one-pole filters four deep to each side.
fn steady(folder: &Path) -> Result<Drive> {
    let white = White::new(1, 7);
    let samples = (SECONDS * f64::from(RATE_HZ)) as i64;
    let steps = RUMBLE_HZ.map(|hz| 1.0 - (-2.0 * std::f64::consts::PI * hz / f64::from(RATE_HZ)).exp());
    let mut poles = [[0.0f64; 4]; 2];
    let mut rumble: Vec<f64> = (0..samples)
        .map(|at| {
            let mut value = white.sample_at(at);
            for low in &mut poles[0] {
                *low += steps[0] * (value - *low);
                value -= *low;
            }
            for low in &mut poles[1] {
                *low += steps[1] * (value - *low);
                value = *low;
            }
            value
        })
        .collect();
    let rms = (rumble.iter().map(|x| x * x).sum::<f64>() / samples as f64).sqrt();
    rumble.iter_mut().for_each(|x| *x *= RUMBLE_RMS / rms);
    let path = folder.join("drive-steady.wav");
    write_wav_f32(&path, &[rumble.iter().map(|x| *x as f32).collect()], RATE_HZ)?;
    Ok(Drive { name: "steady".to_owned(), sound: load(&path, None)?, settings: &[] })
}

fn speech(folder: &Path) -> Result<Recording> {
    let path = folder.join("drive-speech.wav");
    made_by(Command::new("espeak-ng").args(["-v", "en", "-s", "150", "-w"]).arg(&path).arg(SPEECH))?;
    load(&path, Some(RATE_HZ))
}

/// A loop of bass drum, snare and hi-hat at 100 beats a minute, made of sox's own noise and tones.
fn drums(folder: &Path) -> Result<Recording> {
    let part = |name: &str| folder.join(format!("drive-drums-{name}.wav"));
    let made = |name: &str, arguments: &str| -> Result<()> {
        made_by(
            Command::new("sox").args(["-R", "-n", "-r", "44100", "-c", "1"]).arg(part(name)).args(arguments.split(' ')),
        )
    };
    made("bass", "synth 0.3 sine 90-45 fade h 0 0.3 0.28 gain -3")?;
    made("snare", "synth 0.3 whitenoise band 1800 1500 fade h 0 0.3 0.29 gain -6")?;
    made("hat", "synth 0.3 whitenoise highpass 7000 fade h 0 0.06 0.05 pad 0 0.24 gain -10")?;
    let whole = part("loop");
    let bar = ["bass", "hat", "snare", "hat"].map(part);
    made_by(Command::new("sox").arg("-R").args(&bar).arg(&whole).args(["repeat", "11"]))?;
    load(&whole, Some(RATE_HZ))
}

fn made_by(command: &mut Command) -> Result<()> {
    let program = command.get_program().to_string_lossy().into_owned();
    let printed = command.output().with_context(|| format!("{program} is not installed"))?;
    ensure!(printed.status.success(), "{program}: {}", String::from_utf8_lossy(&printed.stderr).trim());
    Ok(())
}
