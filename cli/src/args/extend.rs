//! Options of `pyrophone extend`.

use std::path::PathBuf;

use clap::Args;

/// Options of `pyrophone extend`.
#[derive(Debug, Args)]
pub struct ExtendArgs {
    /// Flame signal; its channels are averaged, and the output has the same number
    #[arg(long, value_name = "IN.wav")]
    pub input: PathBuf,
    /// File to write
    #[arg(long, value_name = "OUT.wav")]
    pub output: PathBuf,
    /// Slope of the noise, whose power falls as frequency^(-alpha), 0-6
    #[arg(long, value_name = "X", default_value_t = 2.5, allow_negative_numbers = true)]
    pub alpha: f64,
    /// Corner frequency of the envelope's low-pass [default: 180]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub cutoff: Option<f64>,
    /// Half-width of a window in samples (without --reference: at 44.1 kHz, 100-2000)
    #[arg(long, value_name = "N", default_value_t = 500, allow_negative_numbers = true)]
    pub half_width: usize,
    /// Centre of the band in which the noise is fitted [default: 180 with --reference, else the cutoff]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub fit_center: Option<f64>,
    /// Width of that band, three standard deviations
    #[arg(long, value_name = "HZ", default_value_t = 30.0, allow_negative_numbers = true)]
    pub fit_width: f64,
    /// Frequency where the input starts to fade [default: 165 with --reference, else the cutoff - 15]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub blend_start: Option<f64>,
    /// Frequency where the input has faded out [default: 195 with --reference, else the cutoff + 15]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub blend_end: Option<f64>,
    /// Gain factor of the fitted noise
    #[arg(long, value_name = "X", default_value_t = 1.0, allow_negative_numbers = true)]
    pub noise_amplitude: f64,
    /// Noise seed
    #[arg(long, value_name = "N", default_value_t = 42, allow_negative_numbers = true)]
    pub seed: u64,
    /// Also write each window's fitted factor, as window,time_s,beta
    #[arg(long, value_name = "FILE.csv")]
    pub betas: Option<PathBuf>,
    /// Compute as published: over the whole signal at once, 6.02 dB lower
    #[arg(long)]
    pub reference: bool,
}
