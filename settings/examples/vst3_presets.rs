//! Writes the factory's presets as `.vstpreset` files for VST3 hosts.
//!
//! ```sh
//! cargo run -p pyrophone-settings --example vst3_presets -- FOLDER
//! ```

use std::path::Path;
use std::process::ExitCode;

use pyrophone_settings::vst3_preset;

fn main() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(1) else {
        eprintln!("error: name the folder to write to");
        return ExitCode::from(2);
    };
    match vst3_preset::write_factory(Path::new(&folder)) {
        Ok(paths) => {
            println!("{} presets in {}", paths.len(), Path::new(&folder).display());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
