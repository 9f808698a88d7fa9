//! Scaling alpha that yields to a buzz, on the reference pairs in the paper's mode.

use std::sync::Arc;

use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain::{Chain, Channels, Transport, learn};
use pyrophone_synthesis::controls::{Controls, DynamicRange, MixControls, Quality};
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::buzz::Buzz;
use pyrophone_synthesis::texture::{Dictionary, PyramidConfig};

const RATE_HZ: f64 = 44_100.0;
const MONO: Channels = Channels { input: 1, sidechain: 0, output: 1 };

/// The output, the latency cut off, and what is left of scaling alpha along it.
fn run(folder: &std::path::Path, name: &str, is_auto: bool) -> (Vec<f64>, Vec<f32>) {
    let read = |kind: &str| crate::common::read_wav(&folder.join(kind).join(format!("{name}.wav"))).0.remove(0);
    let structure = EngineConfig { dynamics: MatchingMode::Paper, ..EngineConfig::default() };
    let shape = PyramidConfig::at_rate(&structure, RATE_HZ);
    let mut controls =
        Controls { mix: MixControls { low: 0.0, extension: 0.0, ..MixControls::default() }, ..Controls::default() };
    controls.drive.high_pass_hz = 0.0;
    controls.texture.dynamic_range = DynamicRange::Learned;
    controls.texture.quality = Quality::Exact;
    controls.texture.scaling_auto = is_auto;
    let mut drive: Vec<f32> = read("signals").iter().map(|x| *x as f32).collect();
    let mut chain = Chain::new(RATE_HZ, MONO, &structure).unwrap();
    let dictionary = Dictionary::new(&[read("training")], RATE_HZ, &shape, &|_| true).unwrap();
    chain.swap_dictionary(Some(Arc::new(dictionary.into())));
    let learned = learn(RATE_HZ, &structure, &controls, std::slice::from_ref(&drive), &[]).unwrap();
    chain.swap_distribution(Some(Arc::new(learned)));
    let latency = chain.latency_samples();
    drive.resize(drive.len() + latency, 0.0);
    let mut told = vec![];
    for (index, block) in drive.chunks_mut(512).enumerate() {
        let transport = Transport { playing: true, position: Some(512 * index as i64) };
        chain.process(&mut [block], &[], &controls, transport);
        told.push(chain.take_meters().scaling_alpha);
    }
    (drive[latency..].iter().map(|x| f64::from(*x)).collect(), told)
}

/// What is left of the share after listening to a whole sound.
fn least_share(sound: &[f64]) -> f64 {
    let mut buzz = Buzz::new(64, RATE_HZ);
    let listen = |least: f64, x: &f64| {
        buzz.push(*x);
        least.min(buzz.share())
    };
    sound.iter().fold(1.0, listen)
}

#[test]
fn torch_yields_until_the_buzz_is_gone_and_burning_brick_keeps_its_scaling() {
    let Some(folder) = crate::common::reference_dir() else { return };
    let (buzzing, full) = run(&folder, "torch", false);
    assert!(full.iter().all(|told| *told == 1.0));
    assert!(least_share(&buzzing[110_250..]) < 0.2, "without it, it buzzes to the end");
    let (calm, told) = run(&folder, "torch", true);
    let half = told.len() / 2;
    assert!(told[half] < 0.5, "{}", told[half]);
    assert!(told.windows(2).all(|x| (x[1] - x[0]).abs() < 0.02), "it moves smoothly");
    assert!(least_share(&calm[110_250..]) > 0.9, "{}", least_share(&calm[110_250..]));
    let (_, told) = run(&folder, "burning_brick", true);
    let least = told.iter().fold(1.0f32, |least, told| least.min(*told));
    assert!(least > 0.9, "{least}");
}
