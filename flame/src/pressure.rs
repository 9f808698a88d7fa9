//! From flux at the simulation's steps to sound pressure at audio rate (Chadwick & James 2011, §3, eq. 9-11).

use pyrophone_synthesis::controls::{DriveControls, DriveMode};
use pyrophone_synthesis::{drive::Drive, dsp::mitchell_netravali};

use crate::error::{Error, in_range};

/// Corner of the paper's high-pass (§6) in Hz.
pub const HIGH_PASS_HZ: f64 = 30.0;

/// Frequency above which spectral extension takes over in the paper (§4), in Hz.
pub const CUTOFF_HZ: f64 = 180.0;

/// Longest sound in seconds.
const MAX_SECONDS: f64 = 3600.0;

/// Result to compute from a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PressureKind {
    /// The flux's derivative, high-passed: a sound.
    #[default]
    Pressure,
    /// The flux's magnitude, smoothed: an envelope.
    Envelope,
}

/// Options for turning a series of flux into sound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Steps per second, 1-768,000.
    pub rate_hz: f64,
    /// Sample rate of the sound in Hz, 8,000-384,000.
    pub sample_rate_hz: u32,
    /// Pressure or envelope.
    pub kind: PressureKind,
    /// Corner of the high-pass in Hz, 0-1000; 0 turns it off. Envelopes have none.
    pub high_pass_hz: f64,
    /// Level of the loudest sample in dB of full scale, -100 to 0.
    pub peak_db: f64,
    /// Factor applied to the pressure or envelope regardless of its peak, above 0; none to follow `peak_db`.
    pub scale: Option<f64>,
}

impl Default for Options {
    /// The paper's step rate and high-pass; a peak of -6 dB.
    fn default() -> Self {
        Self {
            rate_hz: 360.0,
            sample_rate_hz: 44_100,
            kind: PressureKind::Pressure,
            high_pass_hz: HIGH_PASS_HZ,
            peak_db: -6.0,
            scale: None,
        }
    }
}

impl Options {
    /// Checks all options.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming the first option outside its range.
    pub fn validate(&self) -> Result<(), Error> {
        in_range("the step rate in Hz", self.rate_hz, 1.0, 768_000.0)?;
        in_range("the sample rate in Hz", f64::from(self.sample_rate_hz), 8_000.0, 384_000.0)?;
        in_range("the high-pass in Hz", self.high_pass_hz, 0.0, 1_000.0)?;
        in_range("the scale", self.scale.unwrap_or(1.0), f64::MIN_POSITIVE, f64::MAX)?;
        in_range("the peak in dB", self.peak_db, -100.0, 0.0)
    }
}

/// Assessment of a step rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Advice {
    /// The steps cover all that the paper's cutoff leaves to the simulation.
    Full,
    /// The steps end below the paper's cutoff: spectral extension should take over at the Nyquist frequency.
    Narrow {
        /// Half the step rate in Hz.
        nyquist_hz: f64,
    },
    /// The steps end below the high-pass: they contain only an envelope, no pressure.
    EnvelopeOnly {
        /// Half the step rate in Hz.
        nyquist_hz: f64,
    },
}

impl Advice {
    /// Assessment of `rate_hz` steps per second.
    pub fn on(rate_hz: f64) -> Self {
        match 0.5 * rate_hz {
            nyquist_hz if nyquist_hz <= HIGH_PASS_HZ => Self::EnvelopeOnly { nyquist_hz },
            nyquist_hz if nyquist_hz < CUTOFF_HZ => Self::Narrow { nyquist_hz },
            _ => Self::Full,
        }
    }
}

impl std::fmt::Display for Advice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Full => write!(f, "the steps hold frequencies up to {CUTOFF_HZ} Hz and beyond"),
            Self::Narrow { nyquist_hz } => write!(
                f,
                "the steps hold frequencies up to {nyquist_hz} Hz only; set the cutoff of spectral extension there, or simulate {} steps per second",
                2.0 * CUTOFF_HZ
            ),
            Self::EnvelopeOnly { nyquist_hz } => write!(
                f,
                "the steps hold frequencies up to {nyquist_hz} Hz only, below the high-pass at {HIGH_PASS_HZ} Hz: they yield an envelope, not a pressure; use the envelope, or simulate {} steps per second",
                2.0 * CUTOFF_HZ
            ),
        }
    }
}

/// A rendered series.
#[derive(Debug, Clone, PartialEq)]
pub struct Sound {
    /// Samples; the first is at the first step.
    pub samples: Vec<f32>,
    /// Factor applied to the pressure (flux per second) or envelope.
    pub scale: f64,
}

/// Renders a series of flux: `values.len() / rate_hz` seconds. A series that is constant apart from rounding gives
/// silent pressure.
///
/// # Errors
/// If the series is empty, not finite or longer than an hour, or if an option is out of range.
pub fn render(values: &[f64], options: &Options) -> Result<Sound, Error> {
    options.validate()?;
    if values.is_empty() {
        return Err(Error::NoFrames);
    }
    if !values.iter().all(|value| value.is_finite()) {
        return Err(Error::NotFinite { what: "flux" });
    }
    let seconds = values.len() as f64 / options.rate_hz;
    in_range("the sound's length in seconds", seconds, 0.0, MAX_SECONDS)?;
    let sample_rate_hz = f64::from(options.sample_rate_hz);
    let still;
    let values = if is_still(values) {
        still = vec![values[0]; values.len()];
        &still
    } else {
        values
    };
    let samples = match options.kind {
        PressureKind::Pressure => high_passed(&derivative(values, options.rate_hz, sample_rate_hz), options)?,
        PressureKind::Envelope => {
            let sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
            // The kernel's negative lobes may lead below zero, which no envelope may be.
            smooth(&sizes, options.rate_hz, sample_rate_hz).into_iter().map(|value| value.max(0.0)).collect()
        }
    };
    let peak = samples.iter().fold(0.0f64, |peak, sample| peak.max(sample.abs()));
    if !peak.is_finite() {
        return Err(Error::NotFinite { what: "flux" });
    }
    // Anything smaller is rounding, or nothing.
    let to_peak = if peak > f64::MIN_POSITIVE { maths::pow(10.0, options.peak_db / 20.0) / peak } else { 1.0 };
    let scale = options.scale.unwrap_or(to_peak);
    Ok(Sound { samples: samples.into_iter().map(|sample| (sample * scale) as f32).collect(), scale })
}

/// Changes of a series up to this share of its values are rounding.
const ROUNDING: f64 = 1e-10;

/// True if a series changes only by rounding, which would be audible as noise when scaled to a peak.
fn is_still(values: &[f64]) -> bool {
    let (low, high) =
        values.iter().fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(*value), high.max(*value)));
    high - low <= ROUNDING * high.abs().max(low.abs())
}

/// dI/dt at audio rate: the sum over the steps of psi'((t - t_i) / dt) / dt times I(t_i) (eq. 11), psi the cubic of
/// Mitchell & Netravali with B = C = 1/3. The series continues with its end values beyond both ends.
pub fn derivative(values: &[f64], rate_hz: f64, sample_rate_hz: f64) -> Vec<f64> {
    convolved(values, rate_hz, sample_rate_hz, |taps| {
        // If the steps are denser than the samples, the sum of the weights fluctuates around one, and its slope around
        // zero.
        taps.rate_hz * (taps.slope * taps.weight - taps.value * taps.weight_slope) / (taps.weight * taps.weight)
    })
}

/// I(t) at audio rate, with the same cubic between the steps.
fn smooth(values: &[f64], rate_hz: f64, sample_rate_hz: f64) -> Vec<f64> {
    convolved(values, rate_hz, sample_rate_hz, |taps| taps.nearest + taps.value / taps.weight)
}

/// Sums over the steps near one time. Values are differences from the nearest step, so that constants cancel exactly.
struct Taps {
    nearest: f64,
    value: f64,
    slope: f64,
    weight: f64,
    weight_slope: f64,
    /// Kernel widths per second.
    rate_hz: f64,
}

fn convolved(values: &[f64], rate_hz: f64, sample_rate_hz: f64, result: impl Fn(&Taps) -> f64) -> Vec<f64> {
    let Some(last) = values.len().checked_sub(1) else { return vec![] };
    // Steps denser than the samples are low-passed by a kernel as wide as the samples need.
    let width_steps = (rate_hz / sample_rate_hz).max(1.0);
    let value_at = |step: i64| values[step.clamp(0, last as i64) as usize];
    let count = (values.len() as f64 / rate_hz * sample_rate_hz).round() as usize;
    (0..count)
        .map(|sample| {
            let at = sample as f64 / sample_rate_hz * rate_hz;
            let nearest = value_at(at.round() as i64);
            let reach = 2.0 * width_steps;
            let mut taps = Taps {
                nearest,
                value: 0.0,
                slope: 0.0,
                weight: 0.0,
                weight_slope: 0.0,
                rate_hz: rate_hz / width_steps,
            };
            for step in (at - reach).floor() as i64..=(at + reach).ceil() as i64 {
                let (weight, slope) = mitchell_netravali((at - step as f64) / width_steps);
                let value = value_at(step) - nearest;
                taps.value += weight * value;
                taps.slope += slope * value;
                taps.weight += weight;
                taps.weight_slope += slope;
            }
            result(&taps)
        })
        .collect()
}

/// Applies the plug-in's own high-pass, so that both sound the same.
fn high_passed(pressure: &[f64], options: &Options) -> Result<Vec<f64>, Error> {
    let rate_hz = f64::from(options.sample_rate_hz);
    let out_of_range = |_| Error::OutOfRange { what: "the sample rate in Hz", found: rate_hz, low: 8e3, high: 384e3 };
    let mut drive = Drive::new(rate_hz).map_err(out_of_range)?;
    let controls = DriveControls {
        mode: DriveMode::Pressure,
        gain: 1.0,
        high_pass_hz: options.high_pass_hz,
        ..DriveControls::default()
    };
    let mut out = vec![0.0; pressure.len()];
    drive.process(&[pressure], &[], &controls, &mut out);
    Ok(out)
}
