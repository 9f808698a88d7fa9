//! The whole effect in an audio callback, without a host: ten seconds of the built-in campfire in blocks of 512 samples.
//!
//! `cargo run -p pyrophone-synthesis --example callback -- campfire.wav`

use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain::{Chain, Channels, Transport};
use pyrophone_synthesis::controls::{Controls, DriveControls, DriveMode, MixControls};
use pyrophone_synthesis::structure::MatchingMode;

const SAMPLE_RATE_HZ: u32 = 48_000;
const BLOCK: usize = 512;
const SECONDS: usize = 10;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("give the path of the WAV file to write")?;

    // Before playing, and not on the audio thread: everything that allocates.
    let structure = EngineConfig { dynamics: MatchingMode::Companded, ..EngineConfig::default() };
    let channels = Channels { input: 2, sidechain: 0, output: 2 };
    let mut chain = Chain::new(f64::from(SAMPLE_RATE_HZ), channels, &structure)?;
    let controls = Controls {
        drive: DriveControls { mode: DriveMode::Flame, ..DriveControls::default() },
        mix: MixControls { ceiling: true, ..MixControls::default() },
        ..Controls::default()
    };

    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: SAMPLE_RATE_HZ,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(path, spec)?;
    let mut block = vec![vec![0.0f32; BLOCK]; 2];
    let blocks = (SECONDS * SAMPLE_RATE_HZ as usize + chain.latency_samples()).div_ceil(BLOCK);
    for index in 0..blocks {
        // In the callback: the block contains the input (silence, since a built-in flame burns) and becomes the output.
        block.iter_mut().for_each(|channel| channel.fill(0.0));
        let mut outputs: Vec<&mut [f32]> = block.iter_mut().map(Vec::as_mut_slice).collect();
        let transport = Transport { playing: true, position: Some((index * BLOCK) as i64) };
        chain.process(&mut outputs, &[], &controls, transport);
        for (left, right) in block[0].iter().zip(&block[1]) {
            writer.write_sample(*left)?;
            writer.write_sample(*right)?;
        }
    }
    writer.finalize()?;
    Ok(())
}
