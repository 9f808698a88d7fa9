//! Opens a bundle's editor in a window for a while: `cargo run --example window -- Pyrophone.clap 20`.

use std::error::Error;
use std::path::PathBuf;
use std::time::Duration;

use pyrophone_host::editor::EditorWindow;
use pyrophone_host::{BusLayout, Configuration, Format, load};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let bundle = PathBuf::from(arguments.next().ok_or("which bundle?")?);
    let seconds: u64 = arguments.next().map_or(Ok(10), |text| text.parse())?;
    let format = match bundle.extension().and_then(|extension| extension.to_str()) {
        Some("clap") => Format::Clap,
        _ => Format::Vst3,
    };
    let mut plugin = load(&bundle, format)?;
    let layout = BusLayout { input: 2, sidechain: 0, output: 2 };
    let processor =
        plugin.activate(&Configuration { sample_rate: 48_000.0, max_block: 512, layout, offline: false })?;
    let mut window = EditorWindow::open(plugin.as_mut(), "Pyrophone")?;
    println!("window {:#x}, {:?} pixels", window.id(), window.size());
    window.run_for(plugin.as_mut(), Duration::from_secs(seconds));
    window.close(plugin.as_mut());
    plugin.deactivate(processor)?;
    Ok(())
}
