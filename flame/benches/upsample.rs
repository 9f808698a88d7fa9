//! Fidelity of the steps between frames: scenes, and the reference cache, at 360 steps a second, against a
//! reconstruction from a few of these frames.
//!
//! `cargo xtask bench upsample`. Scenes burst once or twice a second, so figures of less than some six seconds say more
//! about single bursts than about the method. Arguments (behind `--`): scenes' names; `resolution=32`, `seconds=6`.

use std::path::{Path, PathBuf};

use pyrophone_flame::flux::Changes;
use pyrophone_flame::import::{Selection, Sequence};
use pyrophone_flame::scenes::{Options, STEP_RATE_HZ, Scene, Simulation};
use pyrophone_flame::upsample::{Method, Upsampler, VoxelSources};
use pyrophone_flame::{Frame, Front};

/// Value at the front.
const ISO: f64 = 0.5;

/// Frame rates to which the steps are thinned out.
const RATES_HZ: [usize; 4] = [24, 30, 60, 120];

/// Bands in Hz.
const BANDS_HZ: [(f64, f64); 3] = [(30.0, 60.0), (60.0, 120.0), (120.0, 175.0)];

/// Window of an envelope in seconds.
const ENVELOPE_S: f64 = 0.1;

/// A flame at every step.
struct Truth {
    name: String,
    flux: Vec<f64>,
    sources: Vec<VoxelSources>,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let number = |key: &str, otherwise: f64| {
        arguments.iter().find_map(|a| a.strip_prefix(key)?.strip_prefix('=')?.parse().ok()).unwrap_or(otherwise)
    };
    let (resolution, seconds) = (number("resolution", 32.0) as usize, number("seconds", 6.0));
    let names: Vec<&String> = arguments.iter().filter(|argument| !argument.contains('=')).collect();
    let is_wanted = |name: &str| names.is_empty() || names.iter().any(|wanted| *wanted == name);
    println!("### Steps between frames\n");
    println!(
        "Against the true {STEP_RATE_HZ} steps a second: level errors in dB at 30-60, 60-120 and 120-175 Hz; correlation of"
    );
    println!(
        "the envelopes ({ENVELOPE_S} s); strongest line at a multiple of the frame rate over its surroundings in dB; kurtosis.\n"
    );
    println!("| flame | fps | method | 30-60 | 60-120 | 120-175 | envelope | line | true | kurtosis | true |");
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    let mut sums = vec![];
    for scene in Scene::ALL.into_iter().filter(|scene| is_wanted(scene.name())) {
        report(&simulated(scene, resolution, seconds), &mut sums);
    }
    if let Some(truth) = reference().filter(|_| is_wanted("reference")) {
        // Half a second of one flame does not count as much as a scene.
        report(&truth, &mut vec![]);
    }
    means(&sums);
}

fn simulated(scene: Scene, resolution: usize, seconds: f64) -> Truth {
    let options = Options { resolution, ..Options::default() };
    let mut simulation = Simulation::new(scene, options).expect("options in range");
    let steps = |seconds: f64| (seconds * STEP_RATE_HZ).round() as u64;
    let pre_roll = steps(scene.default_pre_roll_s());
    let mut truth = Truth { name: scene.name().into(), flux: vec![], sources: vec![] };
    while simulation.steps() < pre_roll + steps(seconds) {
        simulation.step();
        if simulation.steps() > pre_roll {
            truth.add(&simulation.frame().expect("a frame"));
        }
    }
    truth
}

/// The reference cache, beside the project or where the environment says that it is.
fn reference() -> Option<Truth> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/reference");
    let folder = std::env::var_os("PYROPHONE_REFERENCE").map_or_else(beside, PathBuf::from).join("flame_cache");
    let cache = Sequence::open(&folder).ok()?;
    let mut truth = Truth { name: "reference".into(), flux: vec![], sources: vec![] };
    for index in 0..cache.len() {
        truth.add(&cache.read(index, &Selection::default()).ok()?);
    }
    Some(truth)
}

impl Truth {
    fn add(&mut self, frame: &Frame) {
        let front = Front::new(ISO, 2).expect("in range");
        self.flux.push(front.measure(frame).expect("a front").flux);
        self.sources.push(VoxelSources::of_front(frame, ISO).expect("finite"));
    }
}

/// Measures of a series that are compared.
struct Figures {
    levels_db: [f64; 3],
    envelope: f64,
    line_db: [f64; 2],
    kurtosis: [f64; 2],
}

fn report(truth: &Truth, sums: &mut Vec<(usize, Method, Figures)>) {
    for rate_hz in RATES_HZ {
        let every = STEP_RATE_HZ as usize / rate_hz;
        let frames: Vec<usize> = (0..truth.flux.len()).step_by(every).collect();
        let values: Vec<f64> = frames.iter().map(|frame| truth.flux[*frame]).collect();
        for method in [Method::Flips, Method::Noise, Method::Cubic] {
            let upsampler = Upsampler::new(method, every, 1).expect("in range");
            let source = |n: usize| frames.get(n).map(|frame| &truth.sources[*frame]);
            let change = |n: usize| Some((n as i64, upsampler.change(n as i64, source(n)?, source(n + 1)?)));
            let changes: Changes = (0..frames.len()).filter_map(change).collect();
            let made = upsampler.series(&values, 0, &changes);
            let end = (frames.len() - 1) * every + 1;
            let figures = compare(&made[..end], &truth.flux[..end], rate_hz as f64);
            let Figures { levels_db: [a, b, c], envelope, line_db, kurtosis } = figures;
            println!(
                "| {} | {rate_hz} | {} | {a:.1} | {b:.1} | {c:.1} | {envelope:.2} | {:.1} | {:.1} | {:.1} | {:.1} |",
                truth.name,
                method.name(),
                line_db[0],
                line_db[1],
                kurtosis[0],
                kurtosis[1]
            );
            sums.push((rate_hz, method, figures));
        }
    }
}

/// Means over all scenes: of the errors' sizes, of the envelopes' correlation, of how much a line exceeds the true one.
fn means(sums: &[(usize, Method, Figures)]) {
    println!("\n| mean | fps | 30-60 | 60-120 | 120-175 | envelope | line over true | kurtosis over true |");
    println!("|---|---|---|---|---|---|---|---|");
    for rate_hz in RATES_HZ {
        for method in [Method::Flips, Method::Noise, Method::Cubic] {
            let those = || sums.iter().filter(|(rate, of, _)| *rate == rate_hz && *of == method).map(|(.., f)| f);
            let count = those().count().max(1) as f64;
            let mean = |of: &dyn Fn(&Figures) -> f64| those().map(of).sum::<f64>() / count;
            let bands: [f64; 3] = std::array::from_fn(|band| mean(&|f: &Figures| f.levels_db[band].abs()));
            println!(
                "| {} | {rate_hz} | {:.1} | {:.1} | {:.1} | {:.2} | {:.1} | {:.2} |",
                method.name(),
                bands[0],
                bands[1],
                bands[2],
                mean(&|f: &Figures| f.envelope),
                mean(&|f: &Figures| f.line_db[0] - f.line_db[1]),
                mean(&|f: &Figures| f.kurtosis[0] / f.kurtosis[1])
            );
        }
    }
}

fn compare(made: &[f64], truth: &[f64], frame_rate_hz: f64) -> Figures {
    let [made, truth] = [made, truth].map(pressure);
    let spectra = [&made, &truth].map(|series| spectrum(series));
    let level = |spectrum: &[f64], (low, high): (f64, f64)| {
        let bins: Vec<f64> = band(spectrum, low, high).map(|(_, power)| power).collect();
        10.0 * (bins.iter().sum::<f64>() / bins.len().max(1) as f64).max(1e-300).log10()
    };
    let envelopes = [&made, &truth].map(|series| envelope(series));
    Figures {
        levels_db: BANDS_HZ.map(|band| level(&spectra[0], band) - level(&spectra[1], band)),
        envelope: correlation(&envelopes[0], &envelopes[1]),
        line_db: spectra.map(|spectrum| line_db(&spectrum, frame_rate_hz)),
        kurtosis: [kurtosis(&made), kurtosis(&truth)],
    }
}

/// Audible part of a flux: its derivative above 30 Hz.
fn pressure(flux: &[f64]) -> Vec<f64> {
    let slope: Vec<f64> = flux.windows(2).map(|pair| (pair[1] - pair[0]) * STEP_RATE_HZ).collect();
    // First order, forwards and backwards, twice: no phase.
    let decay = (-std::f64::consts::TAU * 25.0 / STEP_RATE_HZ).exp();
    let mut passed = slope;
    for _ in 0..4 {
        let (mut last_in, mut last_out) = (passed.first().copied().unwrap_or(0.0), 0.0);
        for sample in &mut passed {
            let out = decay * (last_out + *sample - last_in);
            (last_in, last_out) = (*sample, out);
            *sample = out;
        }
        passed.reverse();
    }
    passed
}

/// Bins of a spectrum: one a hertz, Hann windows of a second, half overlapping.
fn spectrum(series: &[f64]) -> Vec<f64> {
    let size = (STEP_RATE_HZ as usize).min(series.len());
    let mut power = vec![0.0; size / 2];
    for start in (0..=series.len() - size).step_by(size / 2) {
        for (bin, power) in power.iter_mut().enumerate() {
            let (mut real, mut imaginary) = (0.0, 0.0);
            for (n, sample) in series[start..start + size].iter().enumerate() {
                let turn = std::f64::consts::TAU * n as f64 / size as f64;
                let windowed = sample * (1.0 - turn.cos());
                real += windowed * (turn * bin as f64).cos();
                imaginary += windowed * (turn * bin as f64).sin();
            }
            *power += real * real + imaginary * imaginary;
        }
    }
    power
}

fn band(spectrum: &[f64], low_hz: f64, high_hz: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
    let bin_hz = 0.5 * STEP_RATE_HZ / spectrum.len() as f64;
    let bins = spectrum.iter().enumerate().map(move |(bin, power)| (bin as f64 * bin_hz, *power));
    bins.filter(move |(hz, _)| (low_hz..high_hz).contains(hz))
}

/// The strongest line at a multiple of the frame rate, over the median of what surrounds it.
fn line_db(spectrum: &[f64], frame_rate_hz: f64) -> f64 {
    let multiples = (1..=7).map(|n| f64::from(n) * frame_rate_hz).filter(|hz| (30.0..170.0).contains(hz));
    let over = multiples.map(|line_hz| {
        let peak = band(spectrum, line_hz - 1.5, line_hz + 1.5).fold(0.0, |peak: f64, (_, power)| peak.max(power));
        let mut around: Vec<f64> = band(spectrum, line_hz - 8.0, line_hz + 8.0)
            .filter(|(hz, _)| (hz - line_hz).abs() > 2.0)
            .map(|(_, p)| p)
            .collect();
        around.sort_unstable_by(f64::total_cmp);
        10.0 * (peak / around[around.len() / 2].max(1e-300)).log10()
    });
    over.fold(f64::NEG_INFINITY, f64::max)
}

fn envelope(series: &[f64]) -> Vec<f64> {
    let half = (0.5 * ENVELOPE_S * STEP_RATE_HZ) as usize;
    (0..series.len())
        .map(|n| {
            let near = &series[n.saturating_sub(half)..(n + half + 1).min(series.len())];
            (near.iter().map(|x| x * x).sum::<f64>() / near.len() as f64).sqrt()
        })
        .collect()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let sum = |f: &dyn Fn(f64, f64) -> f64| a.iter().zip(b).map(|(a, b)| f(a - mean_a, b - mean_b)).sum::<f64>();
    sum(&|a, b| a * b) / (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt()
}

fn kurtosis(series: &[f64]) -> f64 {
    let moment = |power: i32| series.iter().map(|x| x.powi(power)).sum::<f64>() / series.len() as f64;
    moment(4) / moment(2).powi(2)
}
