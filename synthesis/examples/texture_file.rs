//! Texture synthesis as published, from two WAV files to a third: the flame's signal, a recording of fire, the result.
//!
//! `cargo run --release -p pyrophone-synthesis --example texture_file -- flame.wav fire.wav out.wav`
//!
//! Both files must have the same sample rate: this crate does not resample (`pyrophone texture` does).

use std::sync::Arc;

use pyrophone_synthesis::texture::offline::{Options, synthesize};
use pyrophone_synthesis::texture::{Dictionary, PyramidConfig};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let [flame, fire, output] = paths.as_slice() else { return Err("give three files: flame, fire, output".into()) };
    let (flame, flame_rate_hz) = mono(flame)?;
    let (fire, fire_rate_hz) = mono(fire)?;
    if flame_rate_hz != fire_rate_hz {
        return Err(format!("the flame has {flame_rate_hz} Hz and the fire {fire_rate_hz} Hz; resample one").into());
    }

    // Analysis of the recording: pyramid, feature vectors, index. It can serve any number of flames.
    let dictionary = Arc::new(Dictionary::new(&[fire], f64::from(fire_rate_hz), &PyramidConfig::default(), &|_| true)?);
    let made = synthesize(&flame, &dictionary, &Options::default(), &|_| true)?;

    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: flame_rate_hz,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(output, spec)?;
    for sample in &made[0] {
        writer.write_sample(*sample as f32)?;
    }
    writer.finalize()?;
    Ok(())
}

/// The mean of a file's channels, full scale at ±1, and its sample rate in Hz.
fn mono(path: &str) -> Result<(Vec<f64>, u32), hound::Error> {
    let mut reader = hound::WavReader::open(path)?;
    let spec = reader.spec();
    let samples: Vec<f64> = match spec.sample_format {
        hound::SampleFormat::Float => reader.samples::<f32>().map(|x| x.map(f64::from)).collect::<Result<_, _>>()?,
        hound::SampleFormat::Int => {
            let full_scale = f64::from(1u32 << (spec.bits_per_sample - 1));
            reader.samples::<i32>().map(|x| x.map(|x| f64::from(x) / full_scale)).collect::<Result<_, _>>()?
        }
    };
    let channels = usize::from(spec.channels.max(1));
    let mean = samples.chunks_exact(channels).map(|frame| frame.iter().sum::<f64>() / channels as f64).collect();
    Ok((mean, spec.sample_rate))
}
