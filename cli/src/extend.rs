//! `pyrophone extend`: spectral bandwidth extension, by the streaming engine or as published.

use std::io::Write;

use pyrophone_recording::{check_finite, check_not_among, write_file};
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::controls::ExtendControls;
use pyrophone_synthesis::extend::beta::Fit;
use pyrophone_synthesis::extend::{Extend, reference};

use crate::args::ExtendArgs;
use crate::error::Error;
use crate::input::{self, in_range};
use crate::output;
use crate::progress::Work;
use crate::summary::Outcome;

/// The paper's cutoff (§4) in Hz.
const CUTOFF_HZ: f64 = 180.0;
/// Half of the paper's blend (§4) in Hz.
const BLEND_HALF_WIDTH_HZ: f64 = 15.0;

/// One signal per channel, and the factor of every window.
struct Extended {
    channels: Vec<Vec<f32>>,
    betas: Vec<f64>,
    hop_samples: usize,
    /// Latency of the engine; the published program has none.
    latency_samples: Option<usize>,
}

/// Writes `input` with its spectrum extended, and its betas on request.
pub fn run(args: &ExtendArgs, work: &Work) -> Result<Outcome, Error> {
    check(args)?;
    let (signal, broadcast) = input::load_with_time_reference(&args.input, work)?;
    input::check_rate(&signal, &args.input)?;
    output::check_format(&args.output, signal.channels.len(), signal.sample_rate_hz)?;
    let rate_hz = f64::from(signal.sample_rate_hz);
    let drive = input::mean(&signal);
    let extended = if args.reference {
        as_published(args, &drive, rate_hz, signal.channels.len(), work)?
    } else {
        streaming(args, &drive, rate_hz, signal.channels.len(), work)?
    };
    work.check()?;
    check_finite(&args.output, &extended.channels)?;
    if let Some(path) = &args.betas {
        write_file(path, |file| write_betas(file, &extended, rate_hz))?;
    }
    let written = output::write(&args.output, extended.channels, signal.sample_rate_hz, broadcast.as_ref());
    if let (Err(_), Some(path)) = (&written, &args.betas) {
        // No partial results: the CSV goes too, and the sound's error is the one reported.
        let _ = std::fs::remove_file(path);
    }
    let files = args.betas.iter().cloned().collect();
    let done = Outcome::with_sound(&args.output, written?);
    Ok(Outcome { files, latency_samples: extended.latency_samples, ..done })
}

/// Rejects options out of range before any file is read.
fn check(args: &ExtendArgs) -> Result<(), Error> {
    if let Some(betas) = &args.betas {
        if *betas == args.output {
            let message =
                format!("{}: --output and --betas name the same file; choose different names", args.output.display());
            return Err(Error::Conflict(message));
        }
        check_not_among(betas, &[&args.input])?;
        output::check_file(betas)?;
    }
    output::check(&args.output, &[&args.input])?;
    if args.reference {
        // No input has a higher rate than this; its own is checked with the signal.
        return reference_settings(args, 384_000.0).validate().map_err(Error::Option);
    }
    controls(args)?;
    structure(args).validate().map_err(Error::Option)
}

fn reference_settings(args: &ExtendArgs, sample_rate_hz: f64) -> reference::Settings {
    let cutoff_hz = args.cutoff.unwrap_or(CUTOFF_HZ);
    reference::Settings {
        sample_rate_hz,
        alpha: args.alpha,
        cutoff_hz,
        half_width: args.half_width,
        fit_centre_hz: args.fit_center.unwrap_or(CUTOFF_HZ),
        fit_width_hz: args.fit_width,
        blend_start_hz: args.blend_start.unwrap_or(CUTOFF_HZ - BLEND_HALF_WIDTH_HZ),
        blend_end_hz: args.blend_end.unwrap_or(CUTOFF_HZ + BLEND_HALF_WIDTH_HZ),
        noise_amplitude: args.noise_amplitude,
        seed: args.seed,
    }
}

fn structure(args: &ExtendArgs) -> EngineConfig {
    EngineConfig { half_width: args.half_width, fit_width_hz: args.fit_width, ..EngineConfig::default() }
}

/// The streaming engine has one frequency where the published program has three: the corner of the envelope, the centre
/// of the fit and the centre of the blend. Those that are given must agree; the others follow.
fn controls(args: &ExtendArgs) -> Result<ExtendControls, Error> {
    if let Some((start, end)) = args.blend_start.zip(args.blend_end).filter(|(start, end)| start >= end) {
        let message = format!("--blend-start is {start} Hz and --blend-end {end} Hz; the start must be the lower one");
        return Err(Error::Conflict(message));
    }
    let blend_center = args.blend_start.zip(args.blend_end).map(|(start, end)| 0.5 * (start + end));
    let cutoff_hz = args.cutoff.or(args.fit_center).or(blend_center).unwrap_or(CUTOFF_HZ);
    let blend_start = args.blend_start;
    let half_width = match (blend_start, args.blend_end) {
        (Some(start), _) => cutoff_hz - start,
        (None, Some(end)) => end - cutoff_hz,
        (None, None) => BLEND_HALF_WIDTH_HZ,
    };
    in_range("--alpha", args.alpha, 0.0, 6.0)?;
    let cutoff = match (args.cutoff, args.fit_center) {
        (None, Some(_)) => "--fit-center",
        (None, None) if blend_center.is_some() => "centre of the blend in Hz",
        _ => "--cutoff",
    };
    in_range(cutoff, cutoff_hz, 40.0, 1000.0)?;
    in_range("--noise-amplitude", args.noise_amplitude, 0.0, 4.0)?;
    in_range("--seed", args.seed as f64, 0.0, f64::from(u32::MAX))?;
    for (option, found) in [("--fit-center", args.fit_center), ("centre of the blend", blend_center)] {
        if let Some(found) = found.filter(|found| (found - cutoff_hz).abs() > 1e-6) {
            return Err(Error::Conflict(format!(
                "{option} is {found} Hz and the cutoff {cutoff_hz} Hz, but without --reference they are one frequency; give them the same value, or add --reference"
            )));
        }
    }
    let blend = if args.blend_start.is_some() {
        "twice the distance from --blend-start to the cutoff"
    } else {
        "width of the blend"
    };
    in_range(blend, 2.0 * half_width, 2.0, 400.0)?;
    Ok(ExtendControls {
        alpha: args.alpha,
        cutoff_hz,
        blend_width_hz: 2.0 * half_width,
        noise_amount: args.noise_amplitude,
        seed: args.seed as u32,
        width: 1.0,
    })
}

/// Output of the published program over the whole signal; all channels are the same.
fn as_published(
    args: &ExtendArgs,
    drive: &[f64],
    rate_hz: f64,
    channels: usize,
    work: &Work,
) -> Result<Extended, Error> {
    let stage = work.stage("extending");
    let settings = reference_settings(args, rate_hz);
    let extended = reference::extend(drive, &settings, &mut |done| stage.report(done as f32))
        .map_err(Error::of_file(&args.input))?;
    let samples: Vec<f32> = extended.samples.iter().map(|sample| *sample as f32).collect();
    let channels = vec![samples; channels];
    Ok(Extended { channels, betas: extended.betas, hop_samples: args.half_width, latency_samples: None })
}

/// Output of the plug-in's engine, with its latency cut off; each channel has independent noise.
fn streaming(args: &ExtendArgs, drive: &[f64], rate_hz: f64, channels: usize, work: &Work) -> Result<Extended, Error> {
    let stage = work.stage("extending");
    let controls = controls(args)?;
    let mut engine = Extend::new(&structure(args), channels, rate_hz).map_err(Error::of_file(&args.input))?;
    let (hop, latency) = (engine.hop_samples(), engine.latency_samples());
    if drive.len() < hop {
        return Err(Error::of_file(&args.input)(pyrophone_synthesis::Error::TooShort {
            what: "input",
            found: drive.len(),
            least: hop,
            remedy: "a smaller --half-width",
        }));
    }
    let total = drive.len() + latency;
    let mut outputs: Vec<Vec<f32>> = vec![Vec::with_capacity(drive.len()); channels];
    let (mut drive_block, mut low, mut noise) = (vec![0.0; hop], vec![0.0; hop], vec![vec![0.0; hop]; channels]);
    let mut fits = vec![];
    // A block as long as the hop holds the end of exactly one window.
    for start in (0..total).step_by(hop) {
        for (index, sample) in drive_block.iter_mut().enumerate() {
            *sample = drive.get(start + index).copied().unwrap_or(0.0);
        }
        let mut noise: Vec<&mut [f64]> = noise.iter_mut().map(Vec::as_mut_slice).collect();
        engine.process(&drive_block, &controls, &mut low, &mut noise);
        fits.push(engine.last_fit(0));
        let skipped = latency.saturating_sub(start).min(hop);
        let wanted = hop.min(total - start);
        for (output, noise) in outputs.iter_mut().zip(&noise) {
            let sum = low.iter().zip(noise.iter()).map(|(low, noise)| (low + noise) as f32);
            output.extend(sum.take(wanted).skip(skipped));
        }
        if !stage.report(start as f32 / total as f32) {
            return Err(Error::Cancelled);
        }
    }
    let betas = betas_of(&fits, drive.len().div_ceil(hop) + 1);
    Ok(Extended { channels: outputs, betas, hop_samples: hop, latency_samples: Some(latency) })
}

/// The factors of windows 0, 1, ... from the fits after blocks 0, 1, ... of one window each. A silent window does not
/// reveal its number, but its neighbours do.
fn betas_of(fits: &[Fit], windows: usize) -> Vec<f64> {
    let behind = fits.iter().enumerate().find(|(_, fit)| fit.raw != 0.0);
    let behind = behind.map_or(0, |(block, fit)| block as i64 - fit.window);
    (0..windows as i64)
        .map(|window| usize::try_from(window + behind).ok().and_then(|block| fits.get(block)))
        .map(|fit| fit.map_or(0.0, |fit| fit.applied))
        .collect()
}

fn write_betas(file: &mut std::fs::File, extended: &Extended, rate_hz: f64) -> std::io::Result<()> {
    let mut file = std::io::BufWriter::new(file);
    writeln!(file, "window,time_s,beta")?;
    for (window, beta) in extended.betas.iter().enumerate() {
        let time_s = (window * extended.hop_samples) as f64 / rate_hz;
        writeln!(file, "{window},{time_s},{beta}")?;
    }
    file.flush()
}
