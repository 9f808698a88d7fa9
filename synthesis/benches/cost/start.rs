//! From a recording to the first sound, and the memory held by then.

use std::sync::Arc;

use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain::{Chain, Channels};
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::PyramidConfig;

use crate::pairs::Pair;
use crate::{Row, cpu_s, row};

const RATE_HZ: f64 = 48_000.0;
/// Falloff of the default preset.
const FALLOFF: f64 = 0.025;

pub fn rows() -> Vec<Row> {
    vec![
        row(
            "default preset, a 14 s recording to first sound, CPU s; from the dictionary cache",
            "0.25; 0.05",
            |pairs| {
                let recording = looped(&pairs[0], 14.0);
                let (dictionary, made_s) = cpu(|| companded(&recording));
                let mut bytes = Vec::new();
                dictionary.write_to(&mut bytes).unwrap();
                let (_, chain_s) = cpu(|| drop(chain(dictionary)));
                let (_, kept_s) = cpu(|| {
                    drop(chain(RecordingDictionary::read_from(&mut bytes.as_slice(), bytes.len() as u64).unwrap()))
                });
                format!("{:.2}; {kept_s:.2}", made_s + chain_s)
            },
        ),
        row("one instance, 10 s recording; each further of the same; MB held", "40 with its dictionary; 5", |pairs| {
            let dictionary = Arc::new(companded(&looped(pairs.last().unwrap(), 10.0)));
            let with = |count: usize| {
                let begin = memory_mb("VmRSS");
                let instances: Vec<Chain> = (0..count).map(|_| chain_of(Arc::clone(&dictionary))).collect();
                let held = memory_mb("VmRSS") - begin;
                drop(instances);
                held
            };
            // Everything that the first instance makes for all of them exists now.
            let first = with(1);
            let each = with(9) / 9.0;
            format!("{:.1} + dictionary {:.1}; {each:.1}", first, dictionary.bytes() as f64 / 1e6)
        }),
        // The last, for its peak.
        row("a 10-minute recording to first sound, CPU s; peak; held, MB", "6; 1000; 850", |pairs| {
            let recording = looped(&pairs[0], 600.0);
            let begin = memory_mb("VmRSS");
            let (chain, seconds) = cpu(|| chain(companded(&recording)));
            let (peak, held) = (memory_mb("VmHWM") - begin, memory_mb("VmRSS") - begin);
            drop(chain);
            format!("{seconds:.1}; {peak:.0}; {held:.0}")
        }),
    ]
}

/// A recording extended to `seconds` by repetition, a little louder each time, so that nothing repeats exactly.
fn looped(pair: &Pair, seconds: f64) -> Vec<f64> {
    let len = pair.training.len();
    (0..(seconds * RATE_HZ) as usize).map(|i| pair.training[i % len] * (1.0 + 1e-3 * (i / len) as f64)).collect()
}

fn structure() -> EngineConfig {
    EngineConfig { dynamics: MatchingMode::Companded, falloff: FALLOFF, ..EngineConfig::default() }
}

fn companded(recording: &[f64]) -> RecordingDictionary {
    let shape = PyramidConfig::at_rate(&structure(), RATE_HZ);
    RecordingDictionary::new(MatchingMode::Companded, &[recording.to_vec()], RATE_HZ, &shape, &|_| true).unwrap()
}

fn chain(dictionary: RecordingDictionary) -> Chain {
    chain_of(Arc::new(dictionary))
}

fn chain_of(dictionary: Arc<RecordingDictionary>) -> Chain {
    let mut chain = Chain::new(RATE_HZ, Channels { input: 2, sidechain: 0, output: 2 }, &structure()).unwrap();
    chain.swap_dictionary(Some(dictionary));
    chain
}

fn cpu<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begin = cpu_s();
    let done = work();
    (done, cpu_s() - begin)
}

/// Memory in MB as reported by the system: `VmRSS` is the present, `VmHWM` the largest value; 0 if it is not reported.
fn memory_mb(what: &str) -> f64 {
    let text = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix(what)?.strip_prefix(':'));
    line.and_then(|line| line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()).unwrap_or(0.0) / 1e3
}
