//! The whole effect, and extension alone, block by block.

use std::sync::Arc;

use pyrophone_synthesis::chain::{Chain, Channels, Transport};
use pyrophone_synthesis::controls::ExtendControls;
use pyrophone_synthesis::dsp::White;
use pyrophone_synthesis::extend::Extend;
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::PyramidConfig;
use pyrophone_synthesis::{Controls, EngineConfig};

use crate::pairs::Pair;
use crate::{Row, row, timed};

const BLOCK: usize = 64;
/// Seconds played.
const SECONDS: f64 = 12.0;
/// Runs; they do the same work, so the shortest time of each block is the one least disturbed.
const RUNS: usize = 3;
/// Falloff of the default preset.
const FALLOFF: f64 = 0.025;

pub fn rows() -> Vec<Row> {
    let default = |name: &'static str, goal: &'static str, rate_hz: f64, channels: usize| {
        row(name, goal, move |pairs| shown(chain(&pairs[0], rate_hz, channels, &default_controls()), rate_hz))
    };
    let extend = |name: &'static str, goal: &'static str, rate_hz: f64| {
        row(name, goal, move |_| shown(extension(rate_hz), rate_hz))
    };
    vec![
        default("default preset, 48 kHz stereo: s per s; largest block of 64", "0.030; 12 %", 48_000.0, 2),
        default("default preset, 96 kHz stereo", "0.06; 25 %", 96_000.0, 2),
        default("default preset, 192 kHz stereo", "0.12; 50 %", 192_000.0, 2),
        default("default preset, 48 kHz, 7.1.2", "0.05", 48_000.0, 10),
        extend("extension, alpha and cutoff moving, 96 kHz stereo", "15 %", 96_000.0),
        extend("extension, alpha and cutoff moving, 192 kHz stereo", "30 %", 192_000.0),
        row("all layers, 500 sources, 7.1.2, 96 kHz", "80 %, none over", |pairs| {
            shown(chain(&pairs[0], 96_000.0, 10, &all_controls()), 96_000.0)
        }),
    ]
}

/// Mean cost and largest block of the blocks' seconds.
fn shown(blocks_s: Vec<f64>, rate_hz: f64) -> String {
    let deadline_s = BLOCK as f64 / rate_hz;
    let mean = blocks_s.iter().sum::<f64>() / blocks_s.len() as f64 / deadline_s;
    let largest = blocks_s.iter().fold(0.0f64, |most, s| most.max(*s)) / deadline_s;
    let over = blocks_s.iter().filter(|s| **s > deadline_s).count();
    format!("{mean:.4}; {:.1} %, {over} of {} over", 100.0 * largest, blocks_s.len())
}

fn default_controls() -> Controls {
    let mut controls = Controls::default();
    controls.mix.low = 0.0;
    controls.mix.extension = 0.0;
    controls.texture.scaling_alpha = 0.0;
    controls
}

fn all_controls() -> Controls {
    let mut controls = Controls::default();
    (controls.mix.low, controls.mix.extension, controls.mix.texture, controls.mix.vortex) = (1.0, 1.0, 1.0, 1.0);
    controls.vortex.count = 500;
    controls
}

/// The shortest time of every block, in seconds.
fn least(blocks: usize, work: impl Fn(&mut dyn FnMut(usize, f64))) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; blocks];
    for _ in 0..RUNS {
        work(&mut |block: usize, seconds: f64| least[block] = least[block].min(seconds));
    }
    least
}

fn chain(pair: &Pair, rate_hz: f64, channels: usize, controls: &Controls) -> Vec<f64> {
    let structure = EngineConfig { dynamics: MatchingMode::Companded, falloff: FALLOFF, ..EngineConfig::default() };
    let shape = PyramidConfig::at_rate(&structure, rate_hz);
    let recording = std::slice::from_ref(&pair.training);
    let dictionary =
        Arc::new(RecordingDictionary::new(structure.dynamics, recording, rate_hz, &shape, &|_| true).unwrap());
    let blocks = (SECONDS * rate_hz) as usize / BLOCK;
    least(blocks, |took| {
        let sizes = Channels { input: channels, sidechain: 0, output: channels };
        let mut chain = Chain::new(rate_hz, sizes, &structure).unwrap();
        chain.swap_dictionary(Some(Arc::clone(&dictionary)));
        let mut buffers = vec![[0.0f32; BLOCK]; channels];
        for block in 0..blocks {
            for buffer in &mut buffers {
                for (k, x) in buffer.iter_mut().enumerate() {
                    *x = pair.input[(block * BLOCK + k) % pair.input.len()] as f32;
                }
            }
            let mut main: Vec<&mut [f32]> = buffers.iter_mut().map(|buffer| &mut buffer[..]).collect();
            let transport = Transport { playing: true, position: Some((block * BLOCK) as i64) };
            let ((), time) = timed(|| chain.process(&mut main, &[], controls, transport));
            took(block, time.as_secs_f64());
        }
    })
}

fn extension(rate_hz: f64) -> Vec<f64> {
    let blocks = (SECONDS * rate_hz) as usize / BLOCK;
    least(blocks, |took| {
        let mut engine = Extend::new(&EngineConfig::default(), 2, rate_hz).unwrap();
        let white = White::new(1, 99);
        let (mut state, mut drive, mut low, mut noise) = (0.0, [0.0; BLOCK], [0.0; BLOCK], [[0.0; BLOCK]; 2]);
        for block in 0..blocks {
            for (i, sample) in drive.iter_mut().enumerate() {
                state += 0.01 * (white.sample_at((block * BLOCK + i) as i64) - state);
                *sample = state;
            }
            let along = (block % 1000) as f64 / 1000.0;
            let controls =
                ExtendControls { alpha: 2.0 + 2.0 * along, cutoff_hz: 120.0 + 200.0 * along, ..Default::default() };
            let [left, right] = &mut noise;
            let ((), time) =
                timed(|| engine.process(&drive, &controls, &mut low, &mut [&mut left[..], &mut right[..]]));
            took(block, time.as_secs_f64());
        }
    })
}
