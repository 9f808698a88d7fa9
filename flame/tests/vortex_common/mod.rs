//! Measures of vortex-sound textures' rows.
#![allow(dead_code, missing_docs)]

use std::f64::consts::{PI, TAU};

use pyrophone_synthesis::vortex::texture::COMPONENTS;

/// Samples of a frame; every half of them one begins.
const FRAME: usize = 128;

/// Spectral flux from each frame to the next, all round a period: how much the spectra of all components rise or fall.
/// The last two are those across the period's end.
pub fn flux(components: [&[f32]; COMPONENTS]) -> Vec<f64> {
    let samples = components[0].len();
    let hop = FRAME / 2;
    let window: Vec<f64> = (0..FRAME).map(|n| (PI * (n as f64 + 0.5) / FRAME as f64).sin().powi(2)).collect();
    let turns: Vec<(f64, f64)> = (0..FRAME).map(|n| (TAU * n as f64 / FRAME as f64).sin_cos()).collect();
    let spectrum = |start: usize| -> Vec<f64> {
        let mut magnitudes = vec![];
        for series in components {
            let frame: Vec<f64> = (0..FRAME).map(|n| window[n] * f64::from(series[(start + n) % samples])).collect();
            for bin in 0..FRAME / 2 {
                let sum = frame.iter().enumerate().fold((0.0, 0.0), |(re, im), (n, value)| {
                    let (sin, cos) = turns[bin * n % FRAME];
                    (re + value * cos, im + value * sin)
                });
                magnitudes.push(sum.0.hypot(sum.1));
            }
        }
        magnitudes
    };
    // The last frame begins half of one before the end, so that its middle is there.
    let frames: Vec<Vec<f64>> = (0..samples / hop).map(|frame| spectrum(frame * hop + samples % hop)).collect();
    let between = |frame: usize| {
        let (one, next) = (&frames[frame], &frames[(frame + 1) % frames.len()]);
        one.iter().zip(next).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    };
    (0..frames.len()).map(between).collect()
}

/// The largest spectral flux across a period's end, and the 99th percentile of all.
pub fn seam(components: [&[f32]; COMPONENTS]) -> (f64, f64) {
    let mut all = flux(components);
    let across = all[all.len() - 2..].iter().copied().fold(0.0, f64::max);
    all.sort_by(f64::total_cmp);
    (across, all[(0.99 * (all.len() - 1) as f64).floor() as usize])
}

/// Mean frequency in Hz of all components' power.
pub fn centroid_hz(components: [&[f32]; COMPONENTS], rate_hz: f64) -> f64 {
    const LONG: usize = 2048;
    let samples = components[0].len();
    let window: Vec<f64> = (0..LONG).map(|n| (PI * (n as f64 + 0.5) / LONG as f64).sin().powi(2)).collect();
    let turns: Vec<(f64, f64)> = (0..LONG).map(|n| (TAU * n as f64 / LONG as f64).sin_cos()).collect();
    let (mut weighted, mut sum) = (0.0, 0.0);
    for series in components {
        for start in (0..samples).step_by(LONG) {
            let frame: Vec<f64> = (0..LONG).map(|n| window[n] * f64::from(series[(start + n) % samples])).collect();
            for bin in 1..LONG / 2 {
                let (re, im) = frame.iter().enumerate().fold((0.0, 0.0), |(re, im), (n, value)| {
                    let (sin, cos) = turns[bin * n % LONG];
                    (re + value * cos, im + value * sin)
                });
                let power = re * re + im * im;
                weighted += bin as f64 * rate_hz / LONG as f64 * power;
                sum += power;
            }
        }
    }
    weighted / sum
}

/// Spearman's rank correlation of values with their order.
pub fn rank_correlation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let rank = |value: f64| values.iter().filter(|other| **other < value).count() as f64;
    let squares: f64 = values.iter().enumerate().map(|(index, value)| (index as f64 - rank(*value)).powi(2)).sum();
    1.0 - 6.0 * squares / (count * (count * count - 1.0))
}
