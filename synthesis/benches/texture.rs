//! What texture synthesis costs: seconds of one core per second of sound, by pair and search; and
//! the costliest block of the whole effect. Nothing is asserted: machines differ, and are noisy.
//!
//! Pairs come from the reference folder (`PYROPHONE_REFERENCE`, else `../shared/reference` from the
//! project's root); without it two made-up ones are used.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use pyrophone_synthesis::chain::{Chain, Channels, Transport, learn};
use pyrophone_synthesis::controls::{DynamicRange, Quality, TextureControls};
use pyrophone_synthesis::texture::{Dictionary, Distribution, Shape, Texture, offline, pyramid::Pyramid};
use pyrophone_synthesis::{Controls, Structure};

#[path = "../tests/common/signals.rs"]
mod signals;

const RATE_HZ: f64 = 44_100.0;

struct Pair {
    name: String,
    input: Vec<f64>,
    training: Vec<f64>,
}

fn pairs() -> Vec<Pair> {
    let default = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/reference");
    let folder = std::env::var_os("PYROPHONE_REFERENCE").map_or_else(default, PathBuf::from);
    let read = |path: PathBuf| -> Option<Vec<f64>> {
        let samples = hound::WavReader::open(path).ok()?.into_samples::<f32>();
        samples.map(|x| x.map(f64::from)).collect::<Result<_, _>>().ok()
    };
    let pair = |name: &str| {
        let file = format!("{name}.wav");
        Some(Pair {
            name: name.to_owned(),
            input: read(folder.join("signals").join(&file))?,
            training: read(folder.join("training").join(&file))?,
        })
    };
    let found: Vec<Pair> = ["burning_brick", "dragon", "torch"].into_iter().filter_map(pair).collect();
    if !found.is_empty() {
        return found;
    }
    println!("no reference data at {}: made-up signals", folder.display());
    let made_up = |kind: usize| {
        let mut random = signals::Random::new(kind as u64);
        let input = signals::signal(&mut random, kind, 220_000);
        Pair { name: format!("made-up {kind}"), input, training: signals::signal(&mut random, 1, 400_000) }
    };
    vec![made_up(0), made_up(1)]
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    let done = work();
    (done, start.elapsed())
}

/// Seconds per second of sound, padding included, of a streaming run.
fn streaming(pair: &Pair, dictionary: &Arc<Dictionary>, quality: Quality) -> (f64, u64) {
    let pyramid = Pyramid::of_input(&pair.input, dictionary.shape()).unwrap();
    let drive = &pyramid.levels[0];
    let mut engine = Texture::new(dictionary.shape(), 1, RATE_HZ).unwrap();
    engine.swap_dictionary(Some(Arc::clone(dictionary)));
    engine.swap_distribution(Some(Arc::new(Distribution::from_magnitudes(pyramid.top_magnitudes()))));
    let controls =
        TextureControls { dynamic_range: DynamicRange::Learned, gate: 0.0, quality, ..TextureControls::default() };
    let mut out = vec![0.0; 64];
    let ((), time) = timed(|| {
        for block in drive.chunks(64) {
            engine.process(block, &controls, &mut [&mut out[..block.len()]]);
        }
    });
    (time.as_secs_f64() / (drive.len() as f64 / RATE_HZ), engine.compared())
}

fn engine_table(pairs: &[Pair]) {
    println!("\ntexture, seconds of one core per second of sound (padded), 44.1 kHz mono");
    println!(
        "{:<16}{:>10}{:>10}{:>12}{:>10}{:>10}{:>10}{:>10}{:>14}",
        "pair", "index s", "MB/s", "exact", "eps 1", "4096", "1024", "256", "exact compared"
    );
    for pair in pairs {
        let (dictionary, built) = timed(|| {
            Dictionary::new(std::slice::from_ref(&pair.training), RATE_HZ, &Shape::default(), &|_| true).unwrap()
        });
        let dictionary = Arc::new(dictionary);
        let megabytes = dictionary.bytes() as f64 / 1e6 / dictionary.seconds();
        let (exact, compared) = streaming(pair, &dictionary, Quality::Exact);
        let options = offline::Options { eps: 1.0, ..offline::Options::default() };
        let (_, loose) = timed(|| offline::synthesize(&pair.input, &dictionary, &options, &|_| true).unwrap());
        let padded_s = Pyramid::of_input(&pair.input, &Shape::default()).unwrap().levels[0].len() as f64 / RATE_HZ;
        print!(
            "{:<16}{:>10.3}{:>10.2}{exact:>12.4}{:>10.4}",
            pair.name,
            built.as_secs_f64(),
            megabytes,
            loose.as_secs_f64() / padded_s
        );
        for candidates in [4096, 1024, 256] {
            print!("{:>10.4}", streaming(pair, &dictionary, Quality::Bounded { candidates }).0);
        }
        println!("{:>14.0}", compared as f64 / (padded_s * 21_400.0));
    }
}

/// The whole effect over a minute of one pair, looped: share of the deadline by block.
fn chain_table(pairs: &[Pair]) {
    println!("\nwhole effect (default controls, stereo), share of a block's deadline: median / 99.9 % / largest");
    println!("{:<16}{:>10}{:>8}{:>26}{:>12}", "pair", "rate", "block", "median / 99.9 % / largest", "s per s");
    for pair in pairs {
        for (rate_hz, block) in [(48_000.0, 32), (48_000.0, 64), (48_000.0, 128), (48_000.0, 1024), (96_000.0, 64)] {
            let structure = Structure::default();
            let shape = Shape::at_rate(&structure, rate_hz);
            // The pair is played as if it had been recorded at this rate.
            let dictionary = Dictionary::new(std::slice::from_ref(&pair.training), rate_hz, &shape, &|_| true).unwrap();
            let channels = Channels { input: 2, sidechain: 0, output: 2 };
            let mut chain = Chain::new(rate_hz, channels, &structure).unwrap();
            chain.swap_dictionary(Some(Arc::new(dictionary)));
            let input: Vec<f32> = pair.input.iter().map(|x| *x as f32).collect();
            let controls = Controls::default();
            chain.swap_distribution(
                learn(rate_hz, &structure, &controls, std::slice::from_ref(&input), &[]).ok().map(Arc::new),
            );
            let mut shares = Vec::new();
            let mut buffers = [vec![0.0f32; block], vec![0.0f32; block]];
            let blocks = (60.0 * rate_hz) as usize / block;
            for i in 0..blocks {
                for buffer in &mut buffers {
                    for (k, x) in buffer.iter_mut().enumerate() {
                        *x = input[(i * block + k) % input.len()];
                    }
                }
                let [left, right] = &mut buffers;
                let mut main = [left.as_mut_slice(), right.as_mut_slice()];
                let transport = Transport { playing: true, position: Some((i * block) as i64) };
                let ((), time) = timed(|| chain.process(&mut main, &[], &controls, transport));
                shares.push(time.as_secs_f64() * rate_hz / block as f64);
            }
            let mean = shares.iter().sum::<f64>() / shares.len() as f64;
            shares.sort_by(f64::total_cmp);
            let at = |q: f64| 100.0 * shares[((shares.len() - 1) as f64 * q) as usize];
            let figures = format!("{:.1} % / {:.1} % / {:.1} %", at(0.5), at(0.999), at(1.0));
            println!("{:<16}{rate_hz:>10}{block:>8}{figures:>26}{mean:>12.4}", pair.name);
        }
    }
}

fn main() {
    let pairs = pairs();
    engine_table(&pairs);
    chain_table(&pairs);
}
