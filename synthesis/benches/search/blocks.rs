//! The audio thread: blocks against their deadlines, and the cost of channels.

use std::sync::Arc;

use pyrophone_synthesis::chain::{Chain, Channels, Transport, learn};
use pyrophone_synthesis::controls::Quality;
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::{Dictionary, PyramidConfig};
use pyrophone_synthesis::{Controls, EngineConfig};

use crate::pairs::{Pair, streaming};
use crate::{RATE_HZ, timed};

/// Seconds played of every pair, in a loop.
const SECONDS: f64 = 60.0;
/// Runs; they do the same work, so the shortest time of each block is the one least disturbed.
const RUNS: usize = 3;

/// The whole effect: both engines, stereo, default controls.
pub fn table(pairs: &[Pair]) {
    println!("### Blocks\n");
    println!(
        "The whole effect (extension and texture, stereo, default controls, bounded search) over {SECONDS} s of each pair, \
         looped: each block's time as a share of its deadline. Of every block the shortest of {RUNS} runs, which do the \
         same work, counts.\n"
    );
    println!("| pair | rate, Hz | block | median | 99.9 % | largest | s per s |");
    println!("|---|---|---|---|---|---|---|");
    for pair in pairs {
        for (rate_hz, block) in [(48_000.0, 32), (48_000.0, 64), (48_000.0, 128), (48_000.0, 1024), (96_000.0, 64)] {
            let mut shares = vec![f64::INFINITY; (SECONDS * rate_hz) as usize / block];
            for _ in 0..RUNS {
                play(&pair.input, &pair.training, MatchingMode::Paper, rate_hz, block, &mut shares);
            }
            println!("| {} | {rate_hz} | {block} | {} |", pair.name, summary(shares));
        }
    }
    println!();
}

/// Seconds played, rate in Hz and block of the companded table.
const COMPANDED: (f64, f64, usize) = (20.0, 48_000.0, 64);
/// Falloff of the default preset.
const FALLOFF: f64 = 0.025;

/// The same in the companded mode, for every drive on every recording.
pub fn companded_table(pairs: &[Pair]) {
    let (seconds, rate_hz, block) = COMPANDED;
    println!("### Blocks, companded\n");
    println!(
        "The default preset (companded, texture and low end alone, stereo), {rate_hz} Hz, {block} samples, {seconds} s of every \
         drive on every recording.\n"
    );
    println!("| drive | recording | median | 99.9 % | largest | s per s |");
    println!("|---|---|---|---|---|---|");
    for (drive, recording) in pairs.iter().flat_map(|drive| pairs.iter().map(move |recording| (drive, recording))) {
        let mut shares = vec![f64::INFINITY; (seconds * rate_hz) as usize / block];
        for _ in 0..RUNS {
            play(&drive.input, &recording.training, MatchingMode::Companded, rate_hz, block, &mut shares);
        }
        println!("| {} | {} | {} |", drive.name, recording.name, summary(shares));
    }
    println!();
}

/// Median, 99.9 %, largest and mean of the blocks' shares.
fn summary(mut shares: Vec<f64>) -> String {
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    shares.sort_by(f64::total_cmp);
    let at = |q: f64| 100.0 * shares[((shares.len() - 1) as f64 * q) as usize];
    format!("{:.1} % | {:.1} % | {:.1} % | {mean:.4}", at(0.5), at(0.999), at(1.0))
}

/// Plays a drive with a recording, as if recorded at this rate; `shares` collects the smallest share of each block.
fn play(drive: &[f64], recording: &Vec<f64>, dynamics: MatchingMode, rate_hz: f64, block: usize, shares: &mut [f64]) {
    let falloff = if dynamics == MatchingMode::Companded { FALLOFF } else { 0.0 };
    let structure = EngineConfig { dynamics, falloff, ..EngineConfig::default() };
    let shape = PyramidConfig::at_rate(&structure, rate_hz);
    let recording = std::slice::from_ref(recording);
    let dictionary = RecordingDictionary::new(dynamics, recording, rate_hz, &shape, &|_| true).unwrap();
    let mut chain = Chain::new(rate_hz, Channels { input: 2, sidechain: 0, output: 2 }, &structure).unwrap();
    chain.swap_dictionary(Some(Arc::new(dictionary)));
    let input: Vec<f32> = drive.iter().map(|x| *x as f32).collect();
    let mut controls = Controls::default();
    if dynamics == MatchingMode::Companded {
        // As in the default preset.
        controls.mix.low = 0.0;
        controls.mix.extension = 0.0;
        controls.texture.scaling_alpha = 0.0;
    }
    let learned = learn(rate_hz, &structure, &controls, std::slice::from_ref(&input), &[]);
    chain.swap_distribution(learned.ok().map(Arc::new));
    let mut buffers = [vec![0.0f32; block], vec![0.0f32; block]];
    for (i, share) in shares.iter_mut().enumerate() {
        for buffer in &mut buffers {
            for (k, x) in buffer.iter_mut().enumerate() {
                *x = input[(i * block + k) % input.len()];
            }
        }
        let [left, right] = &mut buffers;
        let mut main = [left.as_mut_slice(), right.as_mut_slice()];
        let transport = Transport { playing: true, position: Some((i * block) as i64) };
        let ((), time) = timed(|| chain.process(&mut main, &[], &controls, transport));
        *share = share.min(time.as_secs_f64() * rate_hz / block as f64);
    }
}

/// One search, whose windows are copied from every channel.
pub fn channels_table(pairs: &[Pair]) {
    println!("### Channels\n");
    println!("The texture engine with the default budget, times mono.\n");
    println!("| pair | stereo | 8 channels |");
    println!("|---|---|---|");
    for pair in pairs {
        let dictionaries = [1, 2, 8].map(|channels| {
            let recording = vec![pair.training.clone(); channels];
            Arc::new(Dictionary::new(&recording, RATE_HZ, &PyramidConfig::default(), &|_| true).unwrap())
        });
        // In turns, so that busy moments of the machine affect all alike.
        let mut costs = [f64::INFINITY; 3];
        for _ in 0..RUNS {
            for (cost, dictionary) in costs.iter_mut().zip(&dictionaries) {
                *cost = cost.min(streaming(&pair.input, dictionary, Quality::default()));
            }
        }
        println!("| {} | {:.2} | {:.2} |", pair.name, costs[1] / costs[0], costs[2] / costs[0]);
    }
    println!();
}
