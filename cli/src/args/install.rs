//! Options of `pyrophone install` and `pyrophone uninstall`, which the Windows package has.

use clap::Args;

/// Options of both.
#[derive(Debug, Args)]
pub struct InstallArgs {
    /// For all users, from a window opened as administrator, instead of the present one
    #[arg(long)]
    pub system: bool,
}
