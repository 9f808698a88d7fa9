//! The level, the equalisers and the stereo image of a recording, found by a trial run with a drive that is like flames.

use std::f64::consts::PI;
use std::sync::Arc;

use rayon::prelude::*;

use super::bands::{Power, distance_db, typical_third_octaves_db};
use super::equalizer::{Equalizer, LIMIT_DB, design};
use super::image::{Levels, side_of, side_taps};
use super::level::NOMINAL;
use super::loudness_meter::MATCH_FUTURE_S;
use super::profile::Profile;
use super::{Companding, DriveBlock};
use crate::Error;
use crate::controls::{CompandingControls, DynamicRange, TextureControls};
use crate::crackle::Crackles;
use crate::dsp::{Svf, White, mean_of, section_gain};
use crate::texture::dictionary::{Dictionary, Progress};
use crate::texture::engine::Texture;

/// Length of a trial in seconds; with shorter ones, levels differed by up to 1.7 dB (docs/performance.md). The first
/// trial finds the equaliser. The second verifies that it helps, over different noise, to which it was not fitted.
const TRIAL_S: f64 = 6.0;
const SEEDS: [u32; 2] = [17, 18];
/// Rates of the trial flame's swells per second, which repeat together after 10 s only, later than a trial ends; and
/// their extent in nepers.
const SWELLS_HZ: [f64; 4] = [0.7, 1.9, 3.1, 5.3];
const SWELL_NEPERS: f64 = 0.5;
/// Above this frequency, in Hz, a flame's pressure falls by 12 dB an octave.
const FLAME_HZ: f64 = 200.0;
/// White-noise stream that no other stage uses.
const STREAM: u32 = 0x464C_414D;
/// Samples processed at a time.
const BLOCK: usize = 1024;

/// Target of the trials: figures of a recording's bed, so that the bed itself need not be held while it is indexed.
pub struct Goal {
    is_crackling: bool,
    is_silent: bool,
    rms: f64,
    /// Third octaves of the mean of the channels in dB, and those of its difference, where it has two.
    mean_db: Vec<f64>,
    side: Option<Levels>,
}

impl Goal {
    /// The target for a recording's `bed`; `is_crackling` if crackles were split off. `power` is that of its mean.
    pub fn of_bed(bed: &[Vec<f64>], power: &Power, sample_rate_hz: f64, is_crackling: bool) -> Self {
        let mean = mean_of(bed);
        let mean_db = match is_crackling {
            true => typical_third_octaves_db(&mean, sample_rate_hz),
            false => power.third_octaves_db(sample_rate_hz),
        };
        Self {
            is_crackling,
            is_silent: power.rms_below(sample_rate_hz) == 0.0,
            rms: rms(&mean),
            side: side_levels(bed, &mean_db, sample_rate_hz, is_crackling),
            mean_db,
        }
    }
}

/// Third octaves of a signal in dB. For the bed of a crackling recording they are medians: remains of crackles, and
/// passages of different level, would raise a mean.
fn levels_db(signal: &[f64], sample_rate_hz: f64, is_crackling: bool) -> Vec<f64> {
    match is_crackling {
        true => typical_third_octaves_db(signal, sample_rate_hz),
        false => Power::of_signal(signal, sample_rate_hz).third_octaves_db(sample_rate_hz),
    }
}

fn side_levels(channels: &[Vec<f64>], mean_db: &[f64], sample_rate_hz: f64, is_crackling: bool) -> Option<Levels> {
    let side = side_of(channels)?;
    Some(Levels { mean_db: mean_db.to_vec(), side_db: levels_db(&side, sample_rate_hz, is_crackling) })
}

/// Completes the `profile` of a companded `dictionary` and its `crackles`, so that its texture comes near to `goal`.
///
/// # Errors
/// Only [`Error::Cancelled`], if `progress` cancels it.
pub fn calibrate(
    dictionary: &Arc<Dictionary>,
    profile: &mut Profile,
    crackles: Option<&mut Crackles>,
    goal: &Goal,
    progress: Progress<'_>,
) -> Result<(), Error> {
    let rate_hz = dictionary.sample_rate_hz();
    let levels_db = |signal: &[f64]| levels_db(signal, rate_hz, goal.is_crackling);
    let goal_db = &goal.mean_db;
    let plain_profile = &*profile;
    let trials: Vec<Trial> =
        SEEDS.par_iter().map(|seed| trial(dictionary, plain_profile, *seed, progress)).collect::<Result<_, Error>>()?;
    let swell = trials.last().map_or(1.0, |trial| trial.swell);
    let channels: Vec<Vec<Vec<f64>>> = trials.into_iter().map(|trial| trial.channels).collect();
    let mut trials: Vec<Vec<f64>> = channels.iter().map(|channels| mean_of(channels).into_owned()).collect();
    let is_silent = |signal: &Vec<f64>| signal.iter().all(|x| *x == 0.0);
    if trials.iter().any(is_silent) || goal.is_silent {
        return Ok(());
    }
    let found_db = levels_db(&trials[0]);
    let mean = goal_db.iter().zip(&found_db).map(|(a, b)| a - b).sum::<f64>() / goal_db.len() as f64;
    let gains: Vec<f64> =
        goal_db.iter().zip(&found_db).map(|(a, b)| (a - b - mean).clamp(-LIMIT_DB, LIMIT_DB)).collect();
    let taps = design(&gains, rate_hz);
    let found = side_levels(&channels[0], &found_db, rate_hz, goal.is_crackling);
    let side_taps = match (&goal.side, found) {
        (Some(goal), Some(found)) => side_taps(goal, &found, rate_hz),
        _ => Vec::new(),
    };
    let plain = trials.pop().unwrap_or_default();
    let mut equalized = plain.clone();
    let mut equalizer = Equalizer::new(rate_hz, 1);
    let samples = equalized.len();
    equalizer.process(&taps, 1.0, &mut [&mut equalized], 0..samples);
    let distance = |signal: &[f64]| distance_db(&levels_db(signal), goal_db);
    let helps = distance(&equalized) < distance(&plain);
    let (output, taps) = if helps { (equalized, taps) } else { (plain, Vec::new()) };
    let level = match goal.is_crackling {
        true => typical_level(goal_db, &output, swell, rate_hz),
        false => goal.rms / rms(&output),
    };
    let level = if level.is_finite() { level } else { 1.0 };
    profile.set_calibration(level, taps, side_taps);
    if let Some(crackles) = crackles {
        let bed: Vec<f64> = output.iter().map(|sample| sample * level / swell).collect();
        crackles.calibrate(&bed, rate_hz);
    }
    Ok(())
}

/// The factor that brings the median level of the `output` of a trial, at a steady drive, to the recording's median level.
fn typical_level(goal_db: &[f64], output: &[f64], swell: f64, rate_hz: f64) -> f64 {
    let output_db = typical_third_octaves_db(output, rate_hz);
    let mean_db = goal_db.iter().zip(&output_db).map(|(a, b)| a - b).sum::<f64>() / goal_db.len().max(1) as f64;
    swell * maths::pow(10.0, mean_db / 20.0)
}

/// Results of a trial.
struct Trial {
    channels: Vec<Vec<f64>>,
    /// The median of the factor that the drive's loudness had.
    swell: f64,
}

/// Companded texture of a flame-like drive, without equaliser and low end.
fn trial(dictionary: &Arc<Dictionary>, profile: &Profile, seed: u32, progress: Progress<'_>) -> Result<Trial, Error> {
    let rate_hz = dictionary.sample_rate_hz();
    let drive = flame(rate_hz, seed);
    // With more than two channels, no image is matched.
    let outputs = if dictionary.channels() == 2 { 2 } else { 1 };
    let mut texture = Texture::new(dictionary.shape(), outputs, rate_hz)?;
    texture.swap_dictionary(Some(Arc::clone(dictionary)));
    let wait = (MATCH_FUTURE_S * rate_hz) as usize;
    let latency = wait + texture.latency_samples();
    let mut companding = Companding::new(rate_hz, outputs, wait, latency, BLOCK);
    let controls = TextureControls {
        scaling_alpha: 0.0,
        dynamic_range: DynamicRange::Off,
        gate: 0.0,
        companding: CompandingControls { low_end_hz: 0.0, spectrum_match: 0.0, ..CompandingControls::default() },
        ..TextureControls::default()
    };
    texture.reset(0);
    let mut channels = vec![vec![0.0; drive.len()]; outputs];
    let (mut flat, mut loudness) = (vec![0.0; BLOCK], vec![0.0; BLOCK]);
    let mut swells = Vec::with_capacity(drive.len() / BLOCK + 1);
    for (number, drive) in drive.chunks(BLOCK).enumerate() {
        let samples = drive.len();
        let (flat, loudness) = (&mut flat[..samples], &mut loudness[..samples]);
        companding.compress(DriveBlock::of(drive), &controls, Some(profile), flat, loudness);
        let mut blocks: Vec<&mut [f64]> =
            channels.iter_mut().map(|channel| &mut channel[number * BLOCK..][..samples]).collect();
        texture.process(flat, Some(loudness), &controls, &mut blocks);
        companding.expand_one(Some(profile), &mut blocks);
        swells.extend(companding.relative_loudness(samples).first().filter(|loudness| **loudness > 0.0));
        if !progress((number * BLOCK) as f32 / (TRIAL_S * rate_hz) as f32) {
            return Err(Error::Cancelled);
        }
    }
    channels.iter_mut().for_each(|channel| drop(channel.drain(..latency.min(channel.len()))));
    swells.sort_by(f64::total_cmp);
    let median = swells.get(swells.len() / 2).copied().unwrap_or(1.0);
    Ok(Trial { channels, swell: maths::pow(median, controls.companding.dynamics) })
}

/// Noise with the spectrum of a flame's pressure, swelling as flames do, at the nominal level.
fn flame(rate_hz: f64, seed: u32) -> Vec<f64> {
    let mut flame = vec![0.0; (TRIAL_S * rate_hz) as usize];
    White::new(seed, STREAM).fill(0, &mut flame);
    let (mut section, gain) = (Svf::default(), section_gain(FLAME_HZ, rate_hz));
    for (i, sample) in flame.iter_mut().enumerate() {
        let time_s = i as f64 / rate_hz + f64::from(seed);
        let nepers: f64 = SWELLS_HZ.iter().map(|hz| maths::sin(2.0 * PI * hz * time_s)).sum();
        *sample = section.process(gain, *sample).low * maths::exp(SWELL_NEPERS * nepers);
    }
    let scale = NOMINAL / rms(&flame);
    flame.iter_mut().for_each(|sample| *sample *= scale);
    flame
}

fn rms(signal: &[f64]) -> f64 {
    (signal.iter().map(|x| x * x).sum::<f64>() / signal.len().max(1) as f64).sqrt()
}
