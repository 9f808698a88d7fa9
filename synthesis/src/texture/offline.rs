//! Texture synthesis of a whole signal, as in the paper: padded with zeros, with the drive's distribution known in
//! advance, no gate, and exact search.

use std::sync::Arc;

use super::dictionary::{Dictionary, Progress};
use super::distribution::Distribution;
use super::engine::Texture;
use super::pyramid::Pyramid;
use crate::Error;
use crate::controls::{DynamicRange, Quality, TextureControls};

/// The paper's settings of one run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// True if the recording's dynamic range is mapped onto the input's (§5.3).
    pub dynamic_range: bool,
    /// Degree of mapping, 0-1.
    pub scaling_alpha: f64,
    /// The window found is at most (1 + eps) times as far as the nearest; 0 or more, 0 = exact.
    pub eps: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { dynamic_range: true, scaling_alpha: 1.0, eps: 0.0 }
    }
}

/// Samples between two calls of the progress callback.
const BLOCK: usize = 4096;

/// Synthesizes the sound of `dictionary`'s recording that follows `input`: one output for every channel of the
/// recording, each as long as the input. Fails if the input is too short for the levels or contains values that are not
/// finite, if an option is out of range, or if `progress` cancels the work.
pub fn synthesize(
    input: &[f64],
    dictionary: &Arc<Dictionary>,
    options: &Options,
    progress: Progress<'_>,
) -> Result<Vec<Vec<f64>>, Error> {
    crate::error::in_range("scaling alpha", options.scaling_alpha, 0.0, 1.0)?;
    crate::error::in_range("eps", options.eps, 0.0, 1e6)?;
    if let Some(at) = input.iter().position(|x| !x.is_finite()) {
        return Err(Error::NotFinite { what: "input", at });
    }
    let pyramid = Pyramid::of_input(input, dictionary.shape())?;
    let mut engine = Texture::new(dictionary.shape(), dictionary.channels(), dictionary.sample_rate_hz())?;
    engine.swap_dictionary(Some(Arc::clone(dictionary)));
    engine.swap_distribution(Some(Arc::new(Distribution::from_magnitudes(pyramid.top_magnitudes()))));
    engine.reset_for_arrays(&pyramid.padding.size, options.eps);
    let controls = TextureControls {
        scaling_alpha: options.scaling_alpha,
        dynamic_range: if options.dynamic_range { DynamicRange::Learned } else { DynamicRange::Off },
        gate: 0.0,
        quality: Quality::Exact,
        ..TextureControls::default()
    };

    let mut drive = pyramid.levels[0].clone();
    let padded = drive.len();
    let latency = engine.latency_samples();
    drive.resize(padded + latency, 0.0);
    let mut outputs = vec![vec![0.0; drive.len()]; dictionary.channels()];
    for start in (0..drive.len()).step_by(BLOCK) {
        let end = drive.len().min(start + BLOCK);
        let mut blocks: Vec<&mut [f64]> = outputs.iter_mut().map(|x| &mut x[start..end]).collect();
        engine.process(&drive[start..end], None, &controls, &mut blocks);
        if !progress(end as f32 / drive.len() as f32) {
            return Err(Error::Cancelled);
        }
    }
    let (start, end) = (pyramid.padding.start[0] + latency, pyramid.padding.end[0] + latency);
    Ok(outputs.into_iter().map(|x| x[start..end].to_vec()).collect())
}

/// The distribution of a drive's amplitudes (§5.3), as in texture synthesis of the whole drive.
pub fn learn(drive: &[f64], shape: &super::PyramidConfig) -> Result<Distribution, Error> {
    Ok(Distribution::from_magnitudes(Pyramid::of_input(drive, shape)?.top_magnitudes()))
}
