//! Third-party validators on the built bundles, where installed. Our own (`pyrophone_host::validator`) also checks for
//! everything they have found, and always runs.

use std::path::Path;
use std::process::Command;

use anyhow::{Result, ensure};

use crate::tally::Tally;
use crate::{bundle, project, setup};

/// Environment variable with the plug-in's data folder.
const CACHE: &str = "PYROPHONE_CACHE";

/// A validator: its program, its description, its source, and its arguments before the bundle.
struct Validator {
    program: &'static str,
    from: &'static str,
    is_vst3: bool,
    before: &'static [&'static str],
}

const VALIDATORS: [Validator; 3] = [
    Validator {
        program: "clap-validator",
        from: "github.com/free-audio/clap-validator, built by cargo",
        is_vst3: false,
        before: &["validate", "--only-failed"],
    },
    Validator {
        program: "pluginval",
        from: "github.com/Tracktion/pluginval",
        is_vst3: true,
        before: &["--strictness-level", "10", "--validate-in-process", "--skip-gui-tests", "--validate"],
    },
    Validator {
        program: "validator",
        from: "Steinberg's VST3 SDK, public.sdk/samples/vst-hosting/validator",
        is_vst3: true,
        // Ten times as many tests, in seconds.
        before: &["-e"],
    },
];

/// Runs those that are in PATH; the others are counted as skipped.
pub fn run(tally: &mut Tally) -> Result<()> {
    let [clap, vst3] = bundle::paths();
    for validator in &VALIDATORS {
        let bundle = if validator.is_vst3 { &vst3 } else { &clap };
        if setup::is_program(validator.program) {
            tally.step(validator.program, || validate(validator, bundle));
        } else {
            tally.skip(validator.program, &format!("it is not in PATH; it comes from {}", validator.from));
        }
    }
    Ok(())
}

fn validate(validator: &Validator, bundle: &Path) -> Result<()> {
    // The plug-in's presets and dictionaries must be those of this build and not the user's.
    let cache = project::target_dir().join("validators");
    let status = Command::new(validator.program).args(validator.before).arg(bundle).env(CACHE, cache).status()?;
    ensure!(status.success(), "{} has found something; see above", validator.program);
    Ok(())
}
