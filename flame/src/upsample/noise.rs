//! Noise in place of the changes.

use super::{Upsampler, filter, flips};
use crate::solver::Random;

/// Slope of the power of the noise's pressure, in dB per decade.
const SLOPE_DB: f64 = -7.0;

/// Lowest frequency of the noise, relative to the frames' rate.
const CORNER: f64 = 0.45;

/// Number of poles and zeros, an octave apart, in the filter that gives white noise this slope.
const STAGES: usize = 8;

/// Signal to add to the curve through the frames: noise whose envelope is the change between them, with the overall
/// loudness of flips of as many parts.
pub fn added(values: &[f64], pairs: &[Option<&[f64]>], upsampler: &Upsampler) -> Vec<f64> {
    let substeps = upsampler.substeps();
    let flipped = flips::added(values, pairs, upsampler);
    let changed: Vec<f64> = pairs.iter().map(|change| change.map_or(0.0, |change| change[2])).collect();
    let mut random = Random::new(upsampler.seed());
    let pressure: Vec<f64> = (0..flipped.len()).map(|_| random.normal()).collect();
    let pressure = fallen(&pressure, SLOPE_DB);
    // The running sum of pressure is flux.
    let mut flux = 0.0;
    let noise: Vec<f64> = pressure
        .iter()
        .map(|pressure| {
            flux += pressure - 0.1 / substeps as f64 * flux;
            flux
        })
        .collect();
    let noise = filter::high_passed(&noise, CORNER / substeps as f64);
    // A change belongs to the mid-point between its frames.
    let size = |step: usize| {
        let at = (step as f64 / substeps as f64 - 0.5).max(0.0);
        let (before, share) = (at as usize, at.fract());
        let after = changed.get(before + 1).or(changed.last()).copied().unwrap_or(0.0);
        changed[before] * (1.0 - share) + after * share
    };
    let noise: Vec<f64> = noise.iter().enumerate().map(|(step, noise)| noise * size(step)).collect();
    let power = |series: &[f64]| series.iter().map(|x| x * x).sum::<f64>();
    let scale = if power(&noise) > 0.0 { (power(&flipped) / power(&noise)).sqrt() } else { 0.0 };
    noise.iter().map(|noise| scale * noise).collect()
}

/// The samples, filtered so that their power falls by `slope_db` per decade over the eight octaves below half their
/// rate.
fn fallen(samples: &[f64], slope_db: f64) -> Vec<f64> {
    let mut out = samples.to_vec();
    // With a pole at f and a zero at f times this, an octave apart each, the stages together have the slope.
    let apart = maths::pow(2.0, -slope_db / 20.0);
    for stage in 0..STAGES {
        let pole = 0.5 * maths::powi(2.0, -(stage as i32) - 1);
        let [low, high] = [pole, pole * apart].map(|corner| maths::exp(-std::f64::consts::TAU * corner));
        let (mut last_in, mut last_out) = (0.0, 0.0);
        for sample in &mut out {
            let passed = *sample - high * last_in + low * last_out;
            (last_in, last_out) = (*sample, passed);
            *sample = passed;
        }
    }
    out
}
