//! The whole effect, played through in blocks.
#![allow(dead_code)]

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain::{Chain, Channels, Transport};
use pyrophone_synthesis::controls::{
    CompandingControls, Controls, CrackleControls, DriveControls, DriveMode, DynamicRange, ExtendControls,
    FlameControls, Flow, Fuel, FuelControls, MixControls, Quality, RecordingControls, TextureControls, ToneControls,
    VortexControls,
};
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::{Distribution, PyramidConfig};

use crate::signals::{Random, signal};

pub const STEREO: Channels = Channels { input: 2, sidechain: 1, output: 2 };

/// A made-up recording for a rate and structure.
pub fn dictionary(rate_hz: f64, structure: &EngineConfig, channels: usize) -> Arc<RecordingDictionary> {
    dictionary_of(11, rate_hz, structure, channels)
}

/// The same, of another seed. Learning takes longer than most tests: each is learnt once by a process.
pub fn dictionary_of(seed: u64, rate_hz: f64, structure: &EngineConfig, channels: usize) -> Arc<RecordingDictionary> {
    static LEARNT: Mutex<BTreeMap<String, Arc<RecordingDictionary>>> = Mutex::new(BTreeMap::new());
    let key = format!("{seed} {rate_hz} {structure:?} {channels}");
    let mut learnt = LEARNT.lock().unwrap_or_else(PoisonError::into_inner);
    Arc::clone(learnt.entry(key).or_insert_with(|| learn(seed, rate_hz, structure, channels)))
}

fn learn(seed: u64, rate_hz: f64, structure: &EngineConfig, channels: usize) -> Arc<RecordingDictionary> {
    let mut random = Random::new(seed);
    let recording: Vec<Vec<f64>> = (0..channels).map(|_| signal(&mut random, 1, 30_000)).collect();
    let shape = PyramidConfig::at_rate(structure, rate_hz);
    Arc::new(RecordingDictionary::new(structure.dynamics, &recording, rate_hz, &shape, &|_| true).unwrap())
}

/// Both ways of following a drive's loudness.
pub const MODES: [MatchingMode; 2] = [MatchingMode::Paper, MatchingMode::Companded];

/// A chain with two recordings and a learned distribution.
pub fn chain(rate_hz: f64, channels: Channels, dynamics: MatchingMode) -> Chain {
    let structure = EngineConfig { dynamics, ..EngineConfig::default() };
    let mut chain = Chain::new(rate_hz, channels, &structure).unwrap();
    chain.swap_dictionary(Some(dictionary(rate_hz, &structure, channels.output)));
    chain.swap_slot(1, Some(dictionary_of(12, rate_hz, &structure, 1)));
    let learned = Distribution::from_magnitudes((0..500).map(|i| f64::from(i) * 1e-3).collect());
    chain.swap_distribution(Some(Arc::new(learned)));
    chain
}

/// A tone, or none.
fn any_tone(random: &mut Random) -> ToneControls {
    if random.below(3) == 0 {
        return ToneControls::default();
    }
    let mut factor = || 3.0 * random.unit();
    ToneControls { low: factor(), high: factor(), air: factor(), hiss: factor() }
}

/// One recording, or two, or none: [`chain`] has two.
fn any_recordings(random: &mut Random) -> RecordingControls {
    let blend = if random.below(2) == 0 { 0.0 } else { random.unit() };
    RecordingControls { slot: [0, 0, 1, 3][random.below(4)], second: random.below(2), blend }
}

/// Some controls, every one of them moved.
pub fn any_controls(random: &mut Random) -> Controls {
    let mode = [DriveMode::Pressure, DriveMode::Flux, DriveMode::Envelope, DriveMode::InputEnvelope, DriveMode::Flame]
        [random.below(5)];
    let dynamic_range = [DynamicRange::Off, DynamicRange::Learned, DynamicRange::Running][random.below(3)];
    let quality = [Quality::Exact, Quality::Bounded { candidates: 1 + random.below(4096) as u32 }][random.below(2)];
    let level = |random: &mut Random| if random.below(4) == 0 { 0.0 } else { 2.0 * random.unit() };
    Controls {
        drive: DriveControls {
            mode,
            gain: level(random),
            swell: [0.0, 0.8, -0.6][random.below(3)],
            averaging_s: if random.below(2) == 0 { 0.0 } else { random.unit() * 0.05 },
            attack_s: 0.001 + random.unit() * 0.1,
            release_s: 0.001 + random.unit(),
            threshold: random.unit() * 0.1,
            high_pass_hz: if random.below(2) == 0 { 0.0 } else { 100.0 * random.unit() },
            seed: random.below(100) as u32,
            flame: FlameControls {
                scene: random.below(9),
                intensity: 2.0 * random.unit(),
                wind: random.unit(),
                offset_s: 10.0 * random.unit(),
            },
        },
        extend: ExtendControls {
            alpha: 6.0 * random.unit(),
            cutoff_hz: 40.0 + 500.0 * random.unit(),
            blend_width_hz: 2.0 + 100.0 * random.unit(),
            noise_amount: level(random),
            seed: random.below(100) as u32,
            width: random.unit(),
        },
        texture: TextureControls {
            recordings: any_recordings(random),
            scaling_alpha: random.unit(),
            scaling_auto: random.below(2) == 0,
            dynamic_range,
            gate: if random.below(2) == 0 { 0.0 } else { 1e-3 },
            quality,
            seed: random.below(3) as u32,
            variety: if random.below(2) == 0 { 0.0 } else { random.unit() },
            companding: CompandingControls {
                dynamics: random.unit(),
                drive_match: 0.2 + 3.0 * random.unit(),
                low_end_hz: if random.below(3) == 0 { 0.0 } else { 400.0 * random.unit() },
                spectrum_match: random.unit(),
            },
        },
        vortex: VortexControls {
            texture: random.below(3),
            flow: [Flow::Envelope, Flow::Field, Flow::Live][random.below(3)],
            attack_s: 0.001 + random.unit() * 0.1,
            release_s: 0.001 + random.unit(),
            threshold: random.unit() * 0.1,
            speed_m_s: 20.0 * random.unit(),
            curve: 0.1 + random.unit(),
            variation: random.unit(),
            field_speed: 2.0 * random.unit(),
            field_offset_s: random.unit(),
            count: 1 + random.below(100),
            seed: random.below(100) as u32,
            distance_m: 10.0 * random.unit(),
            spread_m: 3.0 * random.unit(),
            azimuth_deg: 360.0 * random.unit(),
            elevation_deg: 180.0 * random.unit() - 90.0,
            exponent: 1.0 + 2.0 * random.unit(),
            range: random.unit(),
            reference_m_s: 1.0 + 10.0 * random.unit(),
            level: 1000.0 * random.unit(),
            max_pressure_pa: 1e-3,
        },
        crackle: CrackleControls {
            slot: 0,
            fuel: Fuel::from_index(random.below(6)),
            density: 4.0 * random.unit(),
            sharpness: 2.0 * random.unit() - 1.0,
            spread: 2.0 * random.unit(),
            follow: 2.0 * random.unit(),
            seed: random.below(3) as u32,
            highest_peak: f64::INFINITY,
        },
        fuel: FuelControls {
            fuel: Fuel::from_index(random.below(6)),
            hiss_tone: 2.0 * random.unit() - 1.0,
            hiss_flutter: random.unit(),
            body_tone: 2.0 * random.unit() - 1.0,
            body_flutter: random.unit(),
            follow: 2.0 * random.unit(),
            seed: random.below(3) as u32,
        },
        mix: MixControls {
            low: level(random),
            extension: level(random),
            texture: level(random),
            vortex: level(random),
            crackle: level(random),
            hiss: level(random),
            body: level(random),
            width: random.unit(),
            tone: any_tone(random),
            output: level(random),
            loudness_lufs: (random.below(2) == 0).then(|| -40.0 * random.unit()),
            ceiling: random.below(2) == 0,
            bypass: random.below(5) == 0,
        },
    }
}

/// What happens at one sample of a run.
#[derive(Debug, Clone, Copy)]
pub struct Event {
    /// Sample of the run.
    pub at: usize,
    /// Controls from here on.
    pub controls: Controls,
    /// Where the host's timeline jumps to, if it does.
    pub jump: Option<i64>,
}

/// Plays `input` and `sidechain` through, cut into blocks by `next_block` and at events. The host
/// plays from `position`.
pub fn play(
    chain: &mut Chain,
    input: &[Vec<f32>],
    sidechain: &[Vec<f32>],
    outputs: usize,
    events: &[Event],
    position: i64,
    mut next_block: impl FnMut() -> usize,
) -> Vec<Vec<f32>> {
    let samples = input[0].len();
    let mut out: Vec<Vec<f32>> =
        (0..outputs).map(|c| input.get(c).cloned().unwrap_or_else(|| vec![0.0; samples])).collect();
    let mut controls = Controls::default();
    let (mut position, mut start) = (position, 0);
    while start < samples {
        let now = events.iter().filter(|event| event.at == start);
        for event in now {
            controls = event.controls;
            position = event.jump.unwrap_or(position);
        }
        let next_event = events.iter().map(|event| event.at).filter(|at| *at > start).min().unwrap_or(samples);
        let end = samples.min(start + next_block()).min(next_event);
        let mut main: Vec<&mut [f32]> = out.iter_mut().map(|x| &mut x[start..end]).collect();
        let side: Vec<&[f32]> = sidechain.iter().map(|x| &x[start..end]).collect();
        chain.process(&mut main, &side, &controls, Transport { playing: true, position: Some(position) });
        position += (end - start) as i64;
        start = end;
    }
    out
}

/// Flame-like channels of a run.
pub fn channels(seed: u64, count: usize, samples: usize) -> Vec<Vec<f32>> {
    let mut random = Random::new(seed);
    (0..count).map(|_| signal(&mut random, 0, samples).iter().map(|x| *x as f32).collect()).collect()
}
