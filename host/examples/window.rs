//! Opens a bundle's editor in a window for a while, and plays silence to the plug-in meanwhile, as a stopped host does:
//! `cargo run --example window -- Pyrophone.clap 20`. A title may follow.

use std::error::Error;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use pyrophone_host::editor::EditorWindow;
use pyrophone_host::{Block, BusLayout, Configuration, Format, HostError, Processor, load};

const SAMPLE_RATE_HZ: f64 = 48_000.0;
/// Samples in a block.
const BLOCK: usize = 512;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let bundle = PathBuf::from(arguments.next().ok_or("which bundle?")?);
    let seconds: u64 = arguments.next().map_or(Ok(10), |text| text.parse())?;
    let title = arguments.next().unwrap_or_else(|| "Pyrophone".to_owned());
    let format = match bundle.extension().and_then(|extension| extension.to_str()) {
        Some("clap") => Format::Clap,
        _ => Format::Vst3,
    };
    let mut plugin = load(&bundle, format)?;
    let layout = BusLayout { input: 2, sidechain: 0, output: 2 };
    let mut processor =
        plugin.activate(&Configuration { sample_rate: SAMPLE_RATE_HZ, max_block: BLOCK, layout, offline: false })?;
    let mut window = EditorWindow::open(plugin.as_mut(), &title)?;
    println!("window {:#x}, {:?} pixels", window.id(), window.size());
    let is_open = AtomicBool::new(true);
    thread::scope(|scope| {
        scope.spawn(|| match play(processor.as_mut(), &is_open) {
            Ok(()) => {}
            Err(error) => eprintln!("no sound: {error}"),
        });
        window.run_for(plugin.as_mut(), Duration::from_secs(seconds));
        is_open.store(false, Ordering::Relaxed);
    });
    window.close(plugin.as_mut());
    plugin.deactivate(processor)?;
    Ok(())
}

/// Plays silence, about as fast as it would sound.
fn play(processor: &mut dyn Processor, is_open: &AtomicBool) -> Result<(), HostError> {
    let silence = [0.0; BLOCK];
    let mut sounds = [[0.0; BLOCK]; 2];
    processor.start()?;
    while is_open.load(Ordering::Relaxed) {
        let [left, right] = &mut sounds;
        processor.process(&mut Block {
            input: &[&silence[..]; 2],
            sidechain: None,
            output: &mut [left, right],
            events: &[],
            transport: None,
            in_place: false,
        })?;
        thread::sleep(Duration::from_secs_f64(BLOCK as f64 / SAMPLE_RATE_HZ));
    }
    processor.stop();
    Ok(())
}
