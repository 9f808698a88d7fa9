//! Vortex sound that follows a simulation while it runs: requests, the time at which results are heard, and late ones.

use std::sync::{Arc, Mutex};

use crate::rendering::*;
use pyrophone_synthesis::controls::{Flow, VortexControls};
use pyrophone_synthesis::vortex::{Simulator, SpeakerLayout, StepRequest, Vortex};

const RATE_HZ: f64 = 48_000.0;

/// Answers with a speed by step, and keeps the requests.
struct ScriptedSimulator {
    requests: Arc<Mutex<Vec<StepRequest>>>,
    speed: fn(u64) -> Option<f32>,
}

impl Simulator for ScriptedSimulator {
    fn request(&mut self, request: StepRequest) {
        self.requests.lock().unwrap().push(request);
    }

    fn answer(&mut self, run: u64, step: u64, speeds_m_s: &mut [f32]) -> bool {
        let requests = self.requests.lock().unwrap();
        assert!(
            requests.iter().any(|request| (request.run, request.step) == (run, step)),
            "{step} was never asked for"
        );
        (self.speed)(step).inspect(|speed| speeds_m_s.fill(*speed)).is_some()
    }
}

/// A renderer with a simulation with these speeds, and its requests; the samples of a step.
fn live(speed: fn(u64) -> Option<f32>) -> (Vortex, Arc<Mutex<Vec<StepRequest>>>, usize) {
    let mut engine = engine(RATE_HZ, SpeakerLayout::Stereo, &noise_texture(4, 4000), 8);
    let requests = Arc::new(Mutex::new(vec![]));
    let places: Vec<[f32; 3]> = (0..5).map(|n| [0.1 * n as f32, 0.2, 0.3]).collect();
    engine.set_simulator(Box::new(ScriptedSimulator { requests: requests.clone(), speed }), &places).unwrap();
    engine.reset(0);
    let step_samples = (engine.live_step_s() * RATE_HZ).round() as usize;
    assert!((0.9 / 60.0..1.1 / 60.0).contains(&engine.live_step_s()));
    (engine, requests, step_samples)
}

fn controls() -> VortexControls {
    VortexControls { flow: Flow::Live, speed_m_s: 6.0, curve: 1.0, threshold: 0.0, ..VortexControls::default() }
}

fn run(engine: &mut Vortex, samples: usize, block: usize) -> Vec<Vec<f64>> {
    play(engine, &vec![0.5; samples], &|_| controls(), std::iter::repeat(block))
}

#[test]
fn step_is_heard_two_steps_after_its_request() {
    let (mut engine, requests, step) = live(|step| Some(if step == 5 { 4.0 } else { 0.0 }));
    let out = run(&mut engine, 12 * step, 500);
    // The filter that raises the rate still has some of the step before.
    let late = 2 * engine.latency_samples();
    let rms_of = |from: usize| rms(&out[0][from * step + late..(from + 1) * step]);
    for at in 0..12 {
        // It comes up during step 7 and goes during step 8.
        assert_eq!(rms_of(at) > 0.0, at == 7 || at == 8, "step {at}: {}", rms_of(at));
    }
    let requests = requests.lock().unwrap();
    let steps: Vec<u64> = requests.iter().map(|request| request.step).collect();
    assert_eq!(steps, (0..11).collect::<Vec<u64>>());
    // The envelope of a constant 0.5 rises within the first steps, and stays.
    assert!(requests.windows(2).all(|w| w[1].speed_m_s >= w[0].speed_m_s - 1e-9));
    assert!((requests[10].speed_m_s - 3.0).abs() < 0.05, "{}", requests[10].speed_m_s);
    assert!(requests[0].speed_m_s < requests[10].speed_m_s);
}

#[test]
fn a_late_step_holds_the_one_before_and_is_counted() {
    let (mut late, _, step) = live(|step| (step != 5).then_some(if step < 5 { 4.0 } else { 0.0 }));
    let (mut held, ..) = live(|step| Some(if step <= 5 { 4.0 } else { 0.0 }));
    let out = run(&mut late, 12 * step, 512);
    assert!(out == run(&mut held, 12 * step, 512), "a late step is as the one before");
    assert_eq!((late.take_late_steps(), late.take_late_steps(), held.take_late_steps()), (1, 0, 0));
}

#[test]
fn every_start_is_a_run_of_its_own_and_all_sound_alike() {
    let (mut engine, requests, step) = live(|step| Some(2.0 + (step as f32).sin()));
    let samples = 9 * step + 77;
    let first = run(&mut engine, samples, 4096);
    assert!(rms(&first[0]) > 0.0);
    for block in [1, 64, 333, 8192] {
        engine.reset(0);
        assert!(run(&mut engine, samples, block) == first, "blocks of {block}");
    }
    // Anywhere on the timeline, and where the flow is chosen only later.
    engine.reset(-(1 << 30));
    run(&mut engine, samples, 512);
    engine.reset(0);
    let chosen = 5 * step;
    let flow = |at: usize| if at < chosen { Flow::Envelope } else { Flow::Live };
    play(
        &mut engine,
        &vec![0.5; samples],
        &|at| VortexControls { flow: flow(at), ..controls() },
        std::iter::repeat(64),
    );
    let requests = requests.lock().unwrap();
    let runs: Vec<u64> = requests.iter().map(|request| request.run).collect();
    assert!(runs.is_sorted() && runs.last() == Some(&7));
    for run in 1..=7 {
        let steps: Vec<u64> =
            requests.iter().filter(|request| request.run == run).map(|request| request.step).collect();
        let expected = if run == 7 { 4 } else { 9 };
        assert!(steps == (0..expected).collect::<Vec<u64>>(), "run {run}: {steps:?}");
    }
}

#[test]
fn nan_and_negative_speeds_are_calm_and_infinite_ones_clamped() {
    for (speed, sounds) in [
        ((|_| Some(f32::NAN)) as fn(u64) -> Option<f32>, false),
        (|_| Some(f32::NEG_INFINITY), false),
        (|_| Some(-1.0), false),
        (|_| Some(0.2), false),
        (|_| Some(f32::INFINITY), true),
        (|_| None, false),
    ] {
        let (mut engine, _, step) = live(speed);
        let out = run(&mut engine, 8 * step, 512);
        assert!(out.iter().flatten().all(|x| x.is_finite()));
        assert_eq!(rms(&out[0]) > 0.0, sounds);
    }
}

#[test]
fn a_simulation_without_places_is_refused() {
    let mut engine = engine(RATE_HZ, SpeakerLayout::Mono, &noise_texture(2, 2000), 4);
    let simulator = || Box::new(ScriptedSimulator { requests: Arc::default(), speed: |_| None });
    assert!(engine.set_simulator(simulator(), &[]).is_err());
    assert!(engine.set_simulator(simulator(), &[[0.0, f32::NAN, 0.0]]).is_err());
    // Without one, such a flow is silent.
    engine.reset(0);
    assert!(rms(&run(&mut engine, 5000, 100)[0]) == 0.0);
}
