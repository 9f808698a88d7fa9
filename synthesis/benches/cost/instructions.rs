//! One fixed second of each engine, on generated sound, for an instruction counter.

use std::sync::Arc;

use pyrophone_synthesis::chain::{Chain, Channels, Transport};
use pyrophone_synthesis::controls::{ExtendControls, Quality, TextureControls};
use pyrophone_synthesis::extend::Extend;
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::{Dictionary, PyramidConfig, Texture};
use pyrophone_synthesis::{Controls, EngineConfig};

use crate::signals::{Random, signal};

const RATE_HZ: f64 = 48_000.0;
const SAMPLES: usize = 48_000;
const BLOCK: usize = 64;
/// Samples of the generated recording.
const RECORDING: usize = 150_000;
/// Samples of the recording that is loaded, 14 s.
const LOADED: usize = 672_000;
/// Level of the quiet recording's noise floor.
const FLOOR: f64 = 1e-3;

/// Runs a second of the engine of this name.
pub fn run(engine: &str) {
    let drive = signal(&mut Random::new(1), 0, SAMPLES);
    match engine {
        "exact" => texture(&bursts(1.0), &drive, Quality::Exact),
        "bounded" => texture(&bursts(1.0), &drive, Quality::default()),
        "quiet" => texture(&bursts(0.5), &vec![0.0; SAMPLES], Quality::Exact),
        "extension" => extension(&drive),
        "default" => default_preset(&drive),
        "load" => load(),
        "activation" => activation(),
        other => panic!("no engine is called {other}"),
    }
}

/// Bursts over a noise floor; only `share` of the recording has bursts.
fn bursts(share: f64) -> Vec<f64> {
    let mut random = Random::new(2);
    let bursts = signal(&mut random, 1, RECORDING);
    let is_burst = |i: usize| ((i % 30_000) as f64) < share * 30_000.0;
    (0..RECORDING).map(|i| FLOOR * (2.0 * random.unit() - 1.0) + if is_burst(i) { bursts[i] } else { 0.0 }).collect()
}

fn texture(recording: &[f64], drive: &[f64], quality: Quality) {
    let shape = PyramidConfig::default();
    let dictionary = Dictionary::new(&[recording.to_vec()], RATE_HZ, &shape, &|_| true).unwrap();
    let mut engine = Texture::new(&shape, 1, RATE_HZ).unwrap();
    engine.swap_dictionary(Some(Arc::new(dictionary)));
    let controls = TextureControls { gate: 0.0, quality, ..TextureControls::default() };
    let mut out = [0.0; BLOCK];
    counted_second(|| {
        for block in drive.chunks_exact(BLOCK) {
            engine.process(block, None, &controls, &mut [&mut out[..]]);
        }
    });
}

fn extension(drive: &[f64]) {
    let mut engine = Extend::new(&EngineConfig::default(), 2, RATE_HZ).unwrap();
    let (mut low, mut noise) = ([0.0; BLOCK], [[0.0; BLOCK]; 2]);
    counted_second(|| {
        for (number, block) in drive.chunks_exact(BLOCK).enumerate() {
            let controls = ExtendControls { cutoff_hz: 120.0 + 0.2 * number as f64, ..ExtendControls::default() };
            let [left, right] = &mut noise;
            engine.process(block, &controls, &mut low, &mut [&mut left[..], &mut right[..]]);
        }
    });
}

/// The default preset's.
fn companded() -> EngineConfig {
    EngineConfig { dynamics: MatchingMode::Companded, falloff: 0.025, ..EngineConfig::default() }
}

fn default_preset(drive: &[f64]) {
    let structure = companded();
    let shape = PyramidConfig::at_rate(&structure, RATE_HZ);
    let dictionary = RecordingDictionary::companded(&[bursts(0.9)], RATE_HZ, &shape, &|_| true).unwrap();
    let mut chain = Chain::new(RATE_HZ, Channels { input: 2, sidechain: 0, output: 2 }, &structure).unwrap();
    chain.swap_dictionary(Some(Arc::new(dictionary)));
    let mut controls = Controls::default();
    (controls.mix.low, controls.mix.extension) = (0.0, 0.0);
    let mut buffers = [[0.0f32; BLOCK]; 2];
    counted_second(|| {
        for (number, block) in drive.chunks_exact(BLOCK).enumerate() {
            buffers = [std::array::from_fn(|i| block[i] as f32); 2];
            let [left, right] = &mut buffers;
            let transport = Transport { playing: true, position: Some((number * BLOCK) as i64) };
            chain.process(&mut [&mut left[..], &mut right[..]], &[], &controls, transport);
        }
    });
}

/// From fourteen seconds of a recording to the default preset's dictionary.
fn load() {
    let signal = signal(&mut Random::new(2), 1, LOADED);
    let shape = PyramidConfig::at_rate(&companded(), RATE_HZ);
    counted_on_one_thread(|| {
        std::hint::black_box(
            RecordingDictionary::companded(std::slice::from_ref(&signal), RATE_HZ, &shape, &|_| true).unwrap(),
        );
    });
}

/// The first activation at a rate.
fn activation() {
    counted_on_one_thread(|| {
        let channels = Channels { input: 2, sidechain: 0, output: 2 };
        std::hint::black_box(Chain::new(RATE_HZ, channels, &companded()).unwrap());
    });
}

/// The same for work that is shared among threads: only one thread is counted.
fn counted_on_one_thread(work: impl FnMut() + Send) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| counted_second(work));
}

/// The counted section: callgrind finds it by its name.
#[inline(never)]
fn counted_second(mut work: impl FnMut()) {
    work();
    std::hint::black_box(());
}
