//! Options of `pyrophone completions` and `pyrophone man`.

use std::path::PathBuf;

use clap::Args;

/// Options of `pyrophone completions`.
#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// Shell to write completions for
    #[arg(value_enum)]
    pub shell: clap_complete::Shell,
}

/// Options of `pyrophone man`.
#[derive(Debug, Args)]
pub struct ManArgs {
    /// Folder to write to; created if it does not exist
    #[arg(long, value_name = "DIR")]
    pub output: PathBuf,
}
