//! CPU time of vortex sound per second of sound and per source, and the number of sources that one core renders.

use std::sync::Arc;
use std::time::{Duration, Instant};

use pyrophone_synthesis::controls::{Flow, VortexControls};
use pyrophone_synthesis::dsp::White;
use pyrophone_synthesis::vortex::texture::Row;
use pyrophone_synthesis::vortex::{Bank, End, SpeakerLayout, SpeedField, Vortex, VortexTexture};

const SECONDS: usize = 5;
const SOURCES: usize = 500;
/// Rows of 4 s at 4 kHz.
const ROWS: usize = 16;
const STEPS: usize = 16_384;

fn main() {
    let texture = texture();
    println!("{SOURCES} sources, {ROWS} rows of {STEPS} steps");
    println!(
        "rate_hz  layout       flow      cpu_s per s  by median hop  us per source  sources per core  slowest hop"
    );
    for rate_hz in [44_100.0, 48_000.0, 96_000.0] {
        let start = Instant::now();
        let bank = Arc::new(Bank::new(&texture, rate_hz).expect("a bank"));
        println!("bank of {:.1} MB in {:.2} s", bank.bytes() as f64 / 1e6, start.elapsed().as_secs_f64());
        for layout in [SpeakerLayout::Mono, SpeakerLayout::Stereo, SpeakerLayout::Surround712] {
            for drive in [Driven::Steadily, Driven::Moving, Driven::ByField] {
                let Figures { cpu_s, undisturbed_s, slowest } = measure(rate_hz, layout, drive, bank.clone());
                let each = 1e6 * undisturbed_s / SOURCES as f64;
                println!(
                    "{rate_hz:7}  {:11}  {:8}  {cpu_s:11.4}  {undisturbed_s:13.4}  {each:13.1}  {:16.0}  {slowest:?}",
                    format!("{layout:?}"),
                    format!("{drive:?}"),
                    1e6 / each,
                );
            }
        }
    }
}

/// Source of the flow speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Driven {
    Steadily,
    Moving,
    ByField,
}

fn texture() -> VortexTexture {
    let row = |index: usize| Row {
        speed_m_s: 16f64.powf(index as f64 / (ROWS - 1) as f64),
        gain: 10f64.powf(0.3 * index as f64 - 4.0),
        components: std::array::from_fn(|component| {
            let noise = White::new(index as u32, component as u32);
            (0..STEPS).map(|step| 0.4 * noise.sample_at(step as i64) as f32).collect()
        }),
    };
    VortexTexture::new(4000.0, (0..ROWS).map(row).collect()).expect("a texture")
}

fn field() -> SpeedField {
    let steps = 60;
    let wave = |step: usize, source: usize, which: usize| {
        (0.1 * step as f64 * std::f64::consts::TAU / 6.0 + source as f64 * (1.0 + which as f64)).sin()
    };
    let each = |step: usize| (0..SOURCES).map(move |source| (step, source));
    let positions = (0..steps).flat_map(each).map(|(step, source)| [0, 1, 2].map(|k| wave(step, source, k) as f32));
    let speeds = (0..steps).flat_map(each).map(|(step, source)| (8.0 + 7.0 * wave(step, source, 3)) as f32);
    SpeedField::new(30.0, SOURCES, positions.collect(), speeds.collect(), End::Periodic).expect("a field")
}

fn measure(rate_hz: f64, layout: SpeakerLayout, driven: Driven, bank: Arc<Bank>) -> Figures {
    let mut engine = Vortex::new(rate_hz, layout, SOURCES).expect("a renderer");
    engine.swap_bank(Some(bank));
    engine.swap_field(Some(Arc::new(field())));
    let flow = if driven == Driven::ByField { Flow::Field } else { Flow::Envelope };
    let controls = VortexControls { count: SOURCES, flow, ..VortexControls::default() };
    let block = engine.hop_samples();
    let white = White::new(1, 99);
    let mut drive = vec![1.0; block];
    let mut out = vec![vec![0.0; block]; layout.channels()];
    let mut slowest = Duration::ZERO;
    let mut hops = Vec::new();
    let (begin, cpu_begin) = (Instant::now(), cpu_time());
    for hop in 0..SECONDS * rate_hz as usize / block {
        if driven == Driven::Moving {
            let swell = 0.5 + 0.5 * (hop as f64 * 0.01).sin();
            for (i, sample) in drive.iter_mut().enumerate() {
                *sample = swell * white.sample_at((hop * block + i) as i64);
            }
        }
        let mut outputs: Vec<&mut [f64]> = out.iter_mut().map(Vec::as_mut_slice).collect();
        let start = Instant::now();
        engine.process(&drive, &controls, &mut outputs);
        let spent = start.elapsed();
        slowest = slowest.max(spent);
        hops.push(spent);
    }
    hops.sort();
    Figures {
        cpu_s: (cpu_time().unwrap_or(begin.elapsed()) - cpu_begin.unwrap_or_default()).as_secs_f64() / SECONDS as f64,
        undisturbed_s: hops[hops.len() / 2].as_secs_f64() * rate_hz / block as f64,
        slowest,
    }
}

/// Measurements of one run.
struct Figures {
    /// CPU time per second of sound.
    cpu_s: f64,
    /// The same computed from the median hop's time, which other programs disturb less.
    undisturbed_s: f64,
    /// The slowest hop.
    slowest: Duration,
}

/// CPU time of this thread, if the system reports it: load from other programs does not count.
fn cpu_time() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
}
