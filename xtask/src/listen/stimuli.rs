//! Sounds of every method: the effect, the published method, two simple rivals, and the recording itself.

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use pyrophone_host::Format;
use pyrophone_host::bounce::BlockSize;
use pyrophone_settings::Automation;
use pyrophone_synthesis::dsp::White;

use crate::bounce::{Request, load, play, preset, reference};
use crate::score::sounds as sounds_of;

/// Origin of a sound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The effect as it is set by default.
    Default,
    /// The texture synthesis of Chadwick & James 2011, fit for live use.
    Paper,
    /// The recording over and over, as loud as the flame.
    Loop,
    /// White noise, as loud as the flame.
    Noise,
    /// The recording itself: the upper limit of quality.
    Recording,
}

/// All methods; the recording comes last.
pub const METHODS: [Method; 5] = [Method::Default, Method::Paper, Method::Loop, Method::Noise, Method::Recording];

impl Method {
    /// Its name in the key.
    pub fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::Paper => "paper",
            Self::Loop => "loop",
            Self::Noise => "noise",
            Self::Recording => "recording",
        }
    }
}

/// Seconds omitted at the start of every sound, in which the effect adapts to the flame.
const SKIP_S: f64 = 1.0;
/// Length in seconds of a sound's fades.
const FADE_S: f64 = 0.05;
/// Time constant in seconds of the flame's envelope.
const ENVELOPE_S: f64 = 0.02;

/// A flame with a recording.
#[derive(Debug)]
pub struct Pair {
    /// Name of the flame's file.
    pub flame: String,
    /// Name of the recording's file.
    pub recording: String,
    paths: [PathBuf; 2],
}

/// All flames with all recordings of the reference folder.
pub fn pairs(reference: &Path) -> Result<Vec<Pair>> {
    let flames = sounds_of(&reference.join("signals"))?;
    let mut recordings = sounds_of(&reference.join("training"))?;
    recordings.extend(sounds_of(&reference.join("recordings")).unwrap_or_default());
    let pair = |(flame, flame_path): &(String, PathBuf), (recording, recording_path): &(String, PathBuf)| Pair {
        flame: flame.clone(),
        recording: recording.clone(),
        paths: [flame_path.clone(), recording_path.clone()],
    };
    Ok(flames.iter().flat_map(|flame| recordings.iter().map(move |recording| pair(flame, recording))).collect())
}

/// Rate in Hz and mono sounds of a pair, in the order of [`METHODS`], at most `seconds` long.
pub fn sounds(pair: &Pair, seconds: f64) -> Result<(u32, Vec<Vec<f32>>)> {
    let flame = load(&pair.paths[0], None)?;
    let rate_hz = flame.sample_rate_hz;
    let recording = mono(&load(&pair.paths[1], Some(rate_hz))?.channels);
    let drive = mono(&flame.channels);
    let envelope = envelope(&drive, rate_hz);
    let samples = |time_s: f64| (time_s * f64::from(rate_hz)) as usize;
    ensure!(drive.len() > samples(SKIP_S + 1.0) && !recording.is_empty(), "{} is too short", pair.flame);
    let bounced = |name: &str| -> Result<Vec<f32>> {
        let played = play(&Request {
            format: Format::Clap,
            values: &preset(name, [])?,
            automation: &Automation::default(),
            main: &flame,
            sidechain: &[],
            training: Some(reference(&pair.paths[1])?),
            learned: None,
            block: BlockSize::Fixed(512),
            offline: false,
            reference_padding: false,
            output_channels: flame.channels.len(),
        })?;
        Ok(mono(&played.channels))
    };
    let white = White::new(1, 2);
    let all = METHODS.iter().map(|method| {
        Ok(match method {
            Method::Default => bounced("default")?,
            Method::Paper => bounced("texture")?,
            Method::Loop => {
                envelope.iter().zip(recording.iter().cycle()).map(|(level, x)| level * x).collect::<Vec<f32>>()
            }
            Method::Noise => {
                envelope.iter().zip(0i64..).map(|(level, at)| level * white.sample_at(at) as f32).collect()
            }
            Method::Recording => recording.iter().cycle().take(drive.len()).copied().collect(),
        })
    });
    let end = drive.len().min(samples(SKIP_S + seconds));
    let cut = |sound: Vec<f32>| faded(&sound[samples(SKIP_S)..end.min(sound.len())], samples(FADE_S));
    Ok((rate_hz, all.map(|sound| sound.map(cut)).collect::<Result<_>>()?))
}

fn mono(channels: &[Vec<f32>]) -> Vec<f32> {
    let samples = channels.iter().map(Vec::len).min().unwrap_or(0);
    (0..samples).map(|i| channels.iter().map(|x| x[i]).sum::<f32>() / channels.len() as f32).collect()
}

/// The root of the drive's smoothed power.
fn envelope(drive: &[f32], rate_hz: u32) -> Vec<f32> {
    let step = 1.0 - (-1.0 / (ENVELOPE_S * f64::from(rate_hz))).exp();
    let mut power = 0.0;
    drive
        .iter()
        .map(|x| {
            power += step * (f64::from(*x).powi(2) - power);
            power.sqrt() as f32
        })
        .collect()
}

fn faded(sound: &[f32], fade: usize) -> Vec<f32> {
    let fade = fade.max(1) as f32;
    let weight = |i: usize| ((i + 1) as f32 / fade).min((sound.len() - i) as f32 / fade).min(1.0);
    sound.iter().enumerate().map(|(i, x)| x * weight(i)).collect()
}
