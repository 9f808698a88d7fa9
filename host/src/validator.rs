//! Checks of a built bundle by calls that well-behaved hosts do not make, and by requirements that validators verify.
//!
//! Each check has a name, loads its own instance and reports what it found. They repeat the findings of clap-validator,
//! pluginval, Steinberg's validator and real hosts about this plug-in, so that problems appear here first, even where
//! none of those is installed.

use std::path::Path;

use crate::Format;
use crate::{clap, vst3};

/// One check: its name and its function on a bundle.
pub struct Check {
    /// The requirement.
    pub name: &'static str,
    pub(crate) run: fn(&Path) -> Result<(), String>,
}

impl Check {
    /// Runs the check on a bundle.
    ///
    /// # Errors
    /// Finding that contradicts the requirement.
    pub fn run(&self, bundle: &Path) -> Result<(), String> {
        (self.run)(bundle)
    }
}

/// All checks of a format.
#[must_use]
pub fn checks(format: Format) -> &'static [Check] {
    match format {
        Format::Clap => clap::validator::CHECKS,
        Format::Vst3 => vst3::validator::CHECKS,
    }
}

/// Fails with `found` unless `holds`.
pub(crate) fn ensure(holds: bool, found: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(found()) }
}

/// The first name that occurs twice in a list.
pub(crate) fn duplicate(names: &[String]) -> Option<&String> {
    names.iter().enumerate().find(|(index, name)| names[..*index].contains(name)).map(|(_, name)| name)
}

/// Rates beyond those that the engines have, in Hz.
pub(crate) const ODD_RATES_HZ: [f64; 2] = [1234.57, 768_000.0];
