//! Separation of a recording into its stationary bed and its crackles.

use rayon::prelude::*;

use super::background::Background;
use super::detect::{Found, crackles};
use super::event::Crackles;
use super::stft::Stft;
use crate::dsp::{Svf, White, section_gain};
use maths::fft;

/// Ratio to the background's root mean square above which a magnitude does not belong to the bed; one in fifty
/// magnitudes of Gaussian noise exceeds it.
const EXCESS: f64 = 2.0;
/// Frequencies in Hz between which crackles fade in: anything lower is the fire's own rumble.
const LOWEST_HZ: [f64; 2] = [250.0, 500.0];
/// Frequency in Hz below which sound is wind at the microphone: inaudible, but louder than many a fire, so that a bed
/// would be as loud as its wind.
const INFRASOUND_HZ: f64 = 25.0;
/// White-noise stream that fills the bed in place of crackles; no other stage uses it.
const FILL_SEED: u32 = 0x4649_4C4C;
const FILL_STREAM: u32 = 0x4245_4421;

/// A recording's two parts.
#[derive(Debug)]
pub struct Split {
    /// The recording without its crackles; the recording itself if it has none.
    pub bed: Vec<Vec<f64>>,
    /// The crackles; none if they are too few, or too soft, to be audible as such.
    pub crackles: Option<Crackles>,
}

/// Separates a recording: `channels` of equal length, with finite samples.
///
/// In a short-time spectrum, energy above the running background belongs to the crackle wherever one was found, and is
/// replaced by noise at the background's level.
pub fn split(channels: &[Vec<f64>], sample_rate_hz: f64) -> Split {
    let found = crackles(channels, sample_rate_hz);
    let samples = channels.first().map_or(0, Vec::len);
    if !Crackles::are_audible(&found, samples, sample_rate_hz) {
        return Split { bed: channels.to_vec(), crackles: None };
    }
    let (bed, waves): (Vec<_>, Vec<_>) =
        channels.par_iter().map(|channel| take_apart(channel, &found, sample_rate_hz)).unzip();
    Split { bed, crackles: Some(Crackles::new(&found, &waves, sample_rate_hz)) }
}

/// True if a recording has crackles; `channels` as in [`split`].
pub(crate) fn is_impulsive(channels: &[Vec<f64>], sample_rate_hz: f64) -> bool {
    let samples = channels.first().map_or(0, Vec::len);
    Crackles::are_audible(&crackles(channels, sample_rate_hz), samples, sample_rate_hz)
}

/// The bed of one channel, and the parts that exceed it.
fn take_apart(signal: &[f64], found: &[Found], sample_rate_hz: f64) -> (Vec<f64>, Vec<f64>) {
    let mut stft = Stft::new(sample_rate_hz);
    let background = Background::of_signal(signal, &mut stft, sample_rate_hz);
    let mut noise = vec![0.0; signal.len()];
    White::new(FILL_SEED, FILL_STREAM).fill(0, &mut noise);
    let white_rms = stft.white_rms();
    let (mut bed, mut wave) = (signal.to_vec(), vec![0.0; signal.len()]);
    let shares: Vec<f64> = (0..stft.bins())
        .map(|bin| {
            let hz = bin as f64 * sample_rate_hz / stft.len() as f64;
            ((hz - LOWEST_HZ[0]) / (LOWEST_HZ[1] - LOWEST_HZ[0])).clamp(0.0, 1.0)
        })
        .collect();
    let mut taken = stft.spectrum().to_vec();
    let mut filled = taken.clone();
    for frame in frames_of(found, &stft) {
        stft.analyse(&noise, frame);
        filled.copy_from_slice(stft.spectrum());
        stft.analyse(signal, frame);
        for (bin, share) in shares.iter().enumerate() {
            let (value, rms) = (stft.spectrum()[bin], background.power_at(frame, bin));
            let magnitude = fft::magnitude(value);
            if *share == 0.0 || magnitude <= EXCESS * rms {
                taken[bin] = Default::default();
                filled[bin] = Default::default();
            } else {
                // Powers add: the extracted part and the filling together are as loud as the original.
                taken[bin] = value * (share * (1.0 - maths::square(rms / magnitude)).sqrt());
                filled[bin] = (filled[bin] * (rms / white_rms) - value) * *share;
            }
        }
        stft.add(&taken, frame, &mut wave);
        stft.add(&filled, frame, &mut bed);
    }
    remove_infrasound(&mut bed, sample_rate_hz);
    (bed, wave)
}

fn remove_infrasound(signal: &mut [f64], sample_rate_hz: f64) {
    let gain = section_gain(INFRASOUND_HZ, sample_rate_hz);
    let [mut first, mut second] = [Svf::default(); 2];
    for sample in signal {
        *sample = second.process(gain, first.process(gain, *sample).high).high;
    }
}

/// The frames that see a crackle, in order.
fn frames_of<'a>(found: &'a [Found], stft: &Stft) -> impl Iterator<Item = usize> + 'a {
    let (hop, half) = (stft.hop(), stft.len() / 2);
    let mut next = 0;
    found.iter().flat_map(move |crackle| {
        let first = crackle.start.saturating_sub(half).div_ceil(hop).max(next);
        let end = ((crackle.end + half) / hop + 1).max(first);
        next = end;
        first..end
    })
}
