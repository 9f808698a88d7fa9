//! Noise in place of the changes.

use crate::solver::Random;

/// Slope of the power of the noise's pressure, in dB per decade.
const SLOPE_DB: f64 = -7.0;

/// Number of poles and zeros, an octave apart, in the filter that gives white noise this slope.
const STAGES: usize = 8;

/// The pressure of `count` steps: noise whose power falls with frequency.
pub fn pressure(count: usize, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    let white: Vec<f64> = (0..count).map(|_| random.normal()).collect();
    fallen(&white, SLOPE_DB)
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
