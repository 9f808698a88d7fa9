//! Calls to Cargo.

use std::ffi::OsString;
use std::process::{Command, ExitCode, ExitStatus};

use anyhow::Result;

use crate::project;

/// The Cargo that runs this program.
pub fn command() -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(project::root());
    cargo
}

/// A child's exit code as one's own.
pub fn exit_code(status: ExitStatus) -> ExitCode {
    match status.code() {
        Some(code) => ExitCode::from(u8::try_from(code).unwrap_or(1)),
        None => ExitCode::FAILURE,
    }
}

/// Builds `xtask-sound` and runs it.
pub fn sound(name: &str, arguments: &[OsString]) -> Result<ExitCode> {
    Ok(exit_code(sound_command(name, arguments).status()?))
}

/// The command that builds `xtask-sound` and runs it.
pub fn sound_command(name: &str, arguments: &[OsString]) -> Command {
    let mut sound = command();
    sound.args(["run", "--release", "--package", "xtask", "--bin", "xtask-sound", "--", name]);
    if name == "demo" && std::env::var_os("NICE_LOG").is_none() {
        // The plugin's log messages are only noise between the demo's lines.
        sound.env("NICE_LOG", project::target_dir().join("demo.log"));
    }
    sound.args(arguments);
    sound
}
