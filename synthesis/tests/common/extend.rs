//! Running the extension, and measuring what comes out.
#![allow(dead_code)]

use std::f64::consts::{PI, TAU};

use maths::fft::{Complex64, ComplexTransform};
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::controls::{DriveControls, DriveMode, ExtendControls};
use pyrophone_synthesis::drive::Drive;
use pyrophone_synthesis::extend::Extend;
use pyrophone_synthesis::extend::beta::Fit;
use pyrophone_synthesis::extend::noise::NoiseSource;

/// Outputs with the latency trimmed, and the fits of the first channel, window 0 first.
pub struct Run {
    pub low: Vec<f64>,
    pub noise: Vec<Vec<f64>>,
    pub fits: Vec<Fit>,
}

impl Run {
    /// Low part and first channel's noise together.
    pub fn sum(&self) -> Vec<f64> {
        self.low.iter().zip(&self.noise[0]).map(|(low, noise)| low + noise).collect()
    }
}

/// Runs `engine` from its present position over the whole of `drive`, controls by position.
pub fn run<N: NoiseSource>(
    engine: &mut Extend<N>,
    channels: usize,
    drive: &[f64],
    controls: impl Fn(usize) -> ExtendControls,
    blocks: impl IntoIterator<Item = usize>,
) -> Run {
    let latency = engine.latency_samples();
    let mut input = drive.to_vec();
    input.resize(drive.len() + latency, 0.0);
    let mut low = vec![0.0; input.len()];
    let mut noise = vec![vec![0.0; input.len()]; channels];
    let mut fits = Vec::new();
    let mut at = 0;
    for block in blocks {
        let end = (at + block).min(input.len());
        let mut outputs: Vec<&mut [f64]> = noise.iter_mut().map(|channel| &mut channel[at..end]).collect();
        engine.process(&input[at..end], &controls(at), &mut low[at..end], &mut outputs);
        let fit = engine.last_fit(0);
        if fit.window as usize == fits.len() && at > 0 {
            fits.push(fit);
        }
        at = end;
        if at == input.len() {
            break;
        }
    }
    assert_eq!(at, input.len(), "blocks ended early");
    low.drain(..latency);
    noise.iter_mut().for_each(|channel| drop(channel.drain(..latency)));
    Run { low, noise, fits }
}

/// A mono run in blocks of one hop, from a new engine.
pub fn run_simply(drive: &[f64], rate_hz: f64, controls: ExtendControls) -> Run {
    let mut engine = Extend::new(&EngineConfig::default(), 1, rate_hz).expect("engine");
    let hop = engine.hop_samples();
    run(&mut engine, 1, drive, |_| controls, std::iter::repeat(hop))
}

/// Steady noise of 40-150 Hz.
pub fn steady_drive(samples: usize, rate_hz: f64) -> Vec<f64> {
    let controls = DriveControls {
        mode: DriveMode::Envelope,
        threshold: 0.0,
        attack_s: 1e-4,
        high_pass_hz: 0.0,
        ..DriveControls::default()
    };
    let sidechain = vec![0.1; samples];
    let mut drive = vec![0.0; samples];
    Drive::new(rate_hz).expect("drive").process(&[&sidechain], &[&sidechain], &controls, &mut drive);
    drive
}

/// Power density (not scaled) and bin distance in Hz by Welch's method: Hann windows of `len`
/// samples, half overlapped.
pub fn welch(signal: &[f64], len: usize, rate_hz: f64) -> (Vec<f64>, f64) {
    let fft = ComplexTransform::new(len);
    let hann: Vec<f64> = (0..len).map(|i| 0.5 - 0.5 * (TAU * i as f64 / len as f64).cos()).collect();
    let mut power = vec![0.0; len / 2 + 1];
    let mut start = 0;
    while start + len <= signal.len() {
        let mut bins: Vec<Complex64> =
            signal[start..start + len].iter().zip(&hann).map(|(x, w)| (x * w).into()).collect();
        fft.forward(&mut bins);
        power.iter_mut().zip(&bins).for_each(|(sum, bin)| *sum += bin.norm_sqr());
        start += len / 2;
    }
    (power, rate_hz / len as f64)
}

/// Slope of log power over log frequency, 500 Hz - 10 kHz, equal weight per logarithmic interval.
pub fn slope(signal: &[f64], rate_hz: f64) -> f64 {
    let len = 1 << ((rate_hz * 0.19).log2() as u32);
    let (power, bin_hz) = welch(signal, len, rate_hz);
    let edge = |i: i32| 500.0 * 20f64.powf(f64::from(i) / 26.0);
    let mut points = Vec::new();
    for band in 0..26 {
        let bins: Vec<usize> =
            (1..power.len()).filter(|bin| (edge(band)..edge(band + 1)).contains(&(*bin as f64 * bin_hz))).collect();
        if !bins.is_empty() {
            let mean =
                |value: &dyn Fn(usize) -> f64| bins.iter().map(|bin| value(*bin)).sum::<f64>() / bins.len() as f64;
            points.push((mean(&|bin| (bin as f64 * bin_hz).log10()), mean(&|bin| power[bin].log10())));
        }
    }
    let count = points.len() as f64;
    let mean_x = points.iter().map(|point| point.0).sum::<f64>() / count;
    let mean_y = points.iter().map(|point| point.1).sum::<f64>() / count;
    let covariance: f64 = points.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    covariance / points.iter().map(|(x, _)| (x - mean_x).powi(2)).sum::<f64>()
}

/// Levels in dB of the third octaves 250 Hz - 16 kHz, one row per whole second.
pub fn third_octaves(signal: &[f64], rate: usize) -> Vec<Vec<f64>> {
    let fft = ComplexTransform::new(rate);
    let rows = signal.chunks_exact(rate).map(|second| {
        let mut bins: Vec<Complex64> =
            second.iter().enumerate().map(|(i, x)| (x * (PI * i as f64 / rate as f64).sin().powi(2)).into()).collect();
        fft.forward(&mut bins);
        let band = |third: i32| {
            let center = 1000.0 * 2f64.powf(f64::from(third) / 3.0);
            let (low, high) = (center * 2f64.powf(-1.0 / 6.0), center * 2f64.powf(1.0 / 6.0));
            let power: f64 = (low.ceil() as usize..high.ceil() as usize).map(|bin| bins[bin].norm_sqr()).sum();
            10.0 * (power + 1e-30).log10()
        };
        (-6..=12).map(band).collect()
    });
    rows.collect()
}

/// Mean and mean absolute difference of two tables of levels.
pub fn level_difference(found: &[Vec<f64>], expected: &[Vec<f64>]) -> (f64, f64) {
    let differences: Vec<f64> =
        found.iter().zip(expected).flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b)).collect();
    assert!(!differences.is_empty(), "no whole second");
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / differences.len() as f64;
    (mean(&mut differences.iter().copied()), mean(&mut differences.iter().map(|x| x.abs())))
}

/// Largest value over median.
pub fn spread(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() - 1] / sorted[sorted.len() / 2]
}
