//! Options of `pyrophone texture`.

use std::path::PathBuf;

use clap::Args;

/// Options of `pyrophone texture`.
#[derive(Debug, Args)]
pub struct TextureArgs {
    /// Flame signal; several channels are averaged
    #[arg(long, value_name = "IN.wav")]
    pub input: PathBuf,
    /// Fire recording to learn from, resampled to the input's rate; it also sets the number of output channels
    #[arg(long, visible_alias = "recording", value_name = "T.wav")]
    pub training: PathBuf,
    /// File to write
    #[arg(long, value_name = "OUT.wav")]
    pub output: PathBuf,
    /// Pyramid levels, 3-8
    #[arg(long, value_name = "N", default_value_t = 6, allow_negative_numbers = true)]
    pub levels: usize,
    /// Half-width of a window in samples of its level, 2-16
    #[arg(long, value_name = "N", default_value_t = 4, allow_negative_numbers = true)]
    pub window: usize,
    /// Half-width of a feature in windows, 1-6
    #[arg(long, value_name = "N", default_value_t = 3, allow_negative_numbers = true)]
    pub feature: usize,
    /// Falloff of the weights exp(-falloff * distance) of a feature's samples, 0-1
    #[arg(long, value_name = "X", default_value_t = 0.0, allow_negative_numbers = true)]
    pub falloff: f64,
    /// Leave the recording's dynamic range unchanged
    #[arg(long)]
    pub no_dynamic_range: bool,
    /// Degree to which the recording's dynamic range is mapped onto the input's, 0-1
    #[arg(long, value_name = "X", default_value_t = 1.0, allow_negative_numbers = true)]
    pub scaling_alpha: f64,
    /// Tolerance of the search: accepts windows up to (1 + eps) times as distant as the nearest; 0 is exact
    #[arg(long, value_name = "X", default_value_t = 0.0, allow_negative_numbers = true)]
    pub eps: f64,
}
