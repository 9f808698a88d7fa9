//! The systems with packages.

use clap::ValueEnum;

use crate::setup::{self, Need};

/// A system that can be built for here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum System {
    /// Linux on x86-64 with glibc 2.31 or later
    Linux,
    /// Windows on x86-64
    Windows,
}

impl System {
    /// Rust's name of it.
    pub fn triple(self) -> &'static str {
        match self {
            Self::Linux => "x86_64-unknown-linux-gnu",
            Self::Windows => "x86_64-pc-windows-gnu",
        }
    }

    /// Its name in file names of packages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linux => "linux-x86_64",
            Self::Windows => "windows-x86_64",
        }
    }

    /// The folder for its libraries in a VST3 bundle.
    pub fn vst3_folder(self) -> &'static str {
        match self {
            Self::Linux => "x86_64-linux",
            Self::Windows => "x86_64-win",
        }
    }

    /// The library in a VST3 bundle.
    pub fn vst3_library(self) -> &'static str {
        match self {
            Self::Linux => "Pyrophone.so",
            Self::Windows => "Pyrophone.vst3",
        }
    }

    /// The plugin's library as Cargo names it.
    pub fn library(self) -> &'static str {
        match self {
            Self::Linux => "libpyrophone.so",
            Self::Windows => "pyrophone.dll",
        }
    }

    /// The command line.
    pub fn program(self) -> &'static str {
        match self {
            Self::Linux => "pyrophone",
            Self::Windows => "pyrophone.exe",
        }
    }

    /// Requirements on the build machine.
    pub fn needs(self) -> &'static [Need] {
        match self {
            Self::Linux => &setup::LINUX_PACKAGE,
            Self::Windows => &setup::WINDOWS_PACKAGE,
        }
    }
}
