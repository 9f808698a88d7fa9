//! CPU time of the extension per second of sound, and its slowest block.

use std::time::{Duration, Instant};

use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::controls::ExtendControls;
use pyrophone_synthesis::dsp::White;
use pyrophone_synthesis::extend::Extend;

const SECONDS: usize = 20;
const BLOCK: usize = 64;

fn main() {
    println!("rate_hz  channels  alpha   cpu_s per s of sound  by median window  slowest block of {BLOCK}");
    for rate_hz in [44_100.0, 48_000.0, 96_000.0] {
        for channels in [1, 2] {
            for moving in [false, true] {
                let Figures { cpu_s, undisturbed_s, slowest } = measure(rate_hz, channels, moving);
                let alpha = if moving { "moving" } else { "still" };
                println!("{rate_hz:7}  {channels:8}  {alpha:6}  {cpu_s:20.4}  {undisturbed_s:16.4}  {slowest:?}");
            }
        }
    }
}

fn measure(rate_hz: f64, channels: usize, moving: bool) -> Figures {
    let mut engine = Extend::new(&EngineConfig::default(), channels, rate_hz).expect("the paper's structure");
    let white = White::new(1, 99);
    let mut state = 0.0;
    let mut drive = [0.0; BLOCK];
    let mut low = [0.0; BLOCK];
    let mut noise = vec![[0.0; BLOCK]; channels];
    let (mut slowest, mut hop_time, mut into_hop) = (Duration::ZERO, Duration::ZERO, 0);
    let mut hops = Vec::new();
    let (begin, cpu_begin) = (Instant::now(), cpu_time());
    for block in 0..SECONDS * rate_hz as usize / BLOCK {
        for (i, sample) in drive.iter_mut().enumerate() {
            state += 0.01 * (white.sample_at((block * BLOCK + i) as i64) - state);
            *sample = state;
        }
        let alpha = if moving { 2.0 + (block % 1000) as f64 / 500.0 } else { 2.5 };
        let controls = ExtendControls { alpha, ..ExtendControls::default() };
        let mut outputs: Vec<&mut [f64]> = noise.iter_mut().map(|channel| &mut channel[..]).collect();
        let start = Instant::now();
        engine.process(&drive, &controls, &mut low, &mut outputs);
        let spent = start.elapsed();
        slowest = slowest.max(spent);
        hop_time += spent;
        into_hop += BLOCK;
        if into_hop >= engine.hop_samples() {
            into_hop -= engine.hop_samples();
            hops.push(std::mem::take(&mut hop_time));
        }
    }
    hops.sort();
    let per_second = rate_hz / engine.hop_samples() as f64;
    Figures {
        cpu_s: (cpu_time().unwrap_or(begin.elapsed()) - cpu_begin.unwrap_or_default()).as_secs_f64() / SECONDS as f64,
        undisturbed_s: hops[hops.len() / 2].as_secs_f64() * per_second,
        slowest,
    }
}

/// Measurements of one run.
struct Figures {
    /// CPU time per second of sound.
    cpu_s: f64,
    /// The same computed from the median window's time, which other programs disturb less.
    undisturbed_s: f64,
    /// The slowest block.
    slowest: Duration,
}

/// CPU time of this thread, if the system reports it: load from other programs does not count.
fn cpu_time() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
}
