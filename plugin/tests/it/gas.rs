//! The live gas: offline renders wait for it and repeat, and are what simulating in line gives.

use pyrophone::gas::Gas;
use pyrophone_flame::live::{Inline, LiveFlow};
use pyrophone_settings::{Preset, Values};
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain::{Chain, Channels, Transport};
use pyrophone_synthesis::vortex::Simulator;

const RATE_HZ: f64 = 48_000.0;
const SAMPLES: usize = 40_000;

fn values() -> Values {
    let mut values = Preset::find("default").unwrap().values;
    for (id, text) in [("vortex_level", "0"), ("vortex_flow", "live"), ("texture_level", "off")] {
        values.set_text(id, text).unwrap();
    }
    assert!(values.is_live());
    values
}

fn chain() -> Chain {
    let channels = Channels { input: 1, sidechain: 0, output: 2 };
    let structure = EngineConfig { ..values().structure() };
    Chain::new(RATE_HZ, channels, &structure).unwrap()
}

/// Plays bursts, with a jump in their midst.
fn play(chain: &mut Chain, block: usize) -> Vec<Vec<f32>> {
    play_for(chain, block, SAMPLES)
}

fn play_for(chain: &mut Chain, block: usize, samples: usize) -> Vec<Vec<f32>> {
    let burst = |at: usize| if (at / 9_000).is_multiple_of(2) { 0.6 * (at as f32 * 0.01).sin() } else { 0.0 };
    let mut out = vec![(0..samples).map(burst).collect::<Vec<f32>>(), vec![0.0; samples]];
    let controls = values().controls();
    let mut at = 0;
    while at < samples {
        let end = samples.min(at + block).min(if at < 15_000 { 15_000 } else { samples });
        let mut main: Vec<&mut [f32]> = out.iter_mut().map(|channel| &mut channel[at..end]).collect();
        let position = if at < 15_000 { at } else { at + 100_000 };
        chain.process(&mut main, &[], &controls, Transport { playing: true, position: Some(position as i64) });
        at = end;
    }
    out
}

#[test]
fn offline_waits_and_is_what_simulating_in_line_gives() {
    let mut inline = chain();
    let flows = [0, 1].map(|_| LiveFlow::new(inline.live_step_s()).unwrap());
    let places = flows[0].places();
    inline.set_simulators(flows.map(|flow| Box::new(Inline::new(flow)) as Box<dyn Simulator>), &places).unwrap();
    let expected = play(&mut inline, 1024);
    assert!(expected[0].iter().any(|x| x.abs() > 1e-5), "it is silent");
    for block in [64, 8192] {
        let mut chain = chain();
        let gas = Gas::start(&mut chain, true).unwrap();
        gas.set_used(true);
        assert!(play(&mut chain, block) == expected, "blocks of {block}");
        assert_eq!(chain.take_meters().late_steps, 0);
        // Many runs whose last answer nobody takes.
        for _ in 0..150 {
            chain.reset();
            play_for(&mut chain, block, 1_500);
        }
        chain.reset();
        assert!(play(&mut chain, block) == expected, "once more");
    }
}

#[test]
fn ended_gas_thread_is_not_awaited_and_late_steps_are_counted() {
    for waits in [true, false] {
        let mut chain = chain();
        drop(Gas::start(&mut chain, waits).unwrap());
        let out = play(&mut chain, 512);
        assert!(out.iter().flatten().all(|x| *x == 0.0));
        assert!(chain.take_meters().late_steps > 20);
    }
}
