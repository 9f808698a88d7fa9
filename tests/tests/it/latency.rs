//! Latency reported is latency measured, and automation acts on the sound it arrived with.

use pyrophone_host::bounce::{AutomationPoint, BlockSize, BounceOptions, await_ready};
use pyrophone_host::{Block, BusLayout, Configuration, Format, Transport, numeric_id};
use pyrophone_settings::Session;
use pyrophone_tests::{MONO, RATE_HZ, STEREO, flame, load_session, open, play, preset};

const MONO_TO_STEREO: BusLayout = BusLayout { input: 1, sidechain: 0, output: 2 };
const WITH_SIDECHAIN: BusLayout = BusLayout { input: 2, sidechain: 2, output: 2 };

/// Plays an impulse, not compensated; answers where the output is largest, and the latency reported.
fn measure(format: Format, layout: BusLayout, sample_rate: f64, changes: &[(&str, &str)]) -> (usize, usize) {
    let mut plugin = open(format);
    load_session(plugin.as_mut(), &preset("extend", changes), &Session::default());
    let configuration = Configuration { sample_rate, max_block: 256, layout, offline: false };
    await_ready(plugin.as_mut(), &configuration).expect("ready");
    let mut processor = plugin.activate(&configuration).expect("activated");
    plugin.run_callbacks();
    let reported = plugin.latency_samples() as usize;
    processor.start().expect("started");
    let at = 1000;
    let mut heard = Vec::new();
    for block in 0..100i64 {
        let mut input = vec![vec![0.0f32; 256]; layout.input as usize];
        let offset = at as i64 - block * 256;
        if (0..256).contains(&offset) {
            input.iter_mut().for_each(|channel| channel[offset as usize] = 1.0);
        }
        let input: Vec<&[f32]> = input.iter().map(Vec::as_slice).collect();
        let mut output = vec![vec![0.0f32; 256]; layout.output as usize];
        let mut outputs: Vec<&mut [f32]> = output.iter_mut().map(Vec::as_mut_slice).collect();
        let transport = Some(Transport::playing_at(block * 256));
        let mut block =
            Block { input: &input, sidechain: None, output: &mut outputs, events: &[], transport, in_place: false };
        processor.process(&mut block).expect("played");
        heard.extend(output.pop().expect("an output"));
    }
    processor.stop();
    plugin.deactivate(processor).expect("deactivated");
    let largest = (0..heard.len()).max_by(|a, b| heard[*a].abs().total_cmp(&heard[*b].abs())).expect("samples");
    (largest - at, reported)
}

#[test]
fn reported_is_measured() {
    let low_only: &[(&str, &str)] = &[("extension_level", "off"), ("high_pass", "off")];
    let bypassed: &[(&str, &str)] = &[("bypass", "on")];
    for format in Format::ALL {
        for sample_rate in [44_100.0, 48_000.0, 96_000.0] {
            for layout in [MONO, MONO_TO_STEREO, STEREO, WITH_SIDECHAIN] {
                for changes in [low_only, bypassed] {
                    let (measured, reported) = measure(format, layout, sample_rate, changes);
                    println!("{format} {sample_rate} {layout}: {measured} measured, {reported} reported");
                    assert_eq!(measured, reported, "{format} {sample_rate} {layout} {changes:?}");
                    assert!(reported > 1000);
                }
            }
        }
    }
}

#[test]
fn a_step_is_heard_at_its_own_sample() {
    let input = flame(3, 1, 30_000);
    for format in Format::ALL {
        // (parameter, before, after, samples of a window)
        let steps = [("low_level", "0", "-20", 1), ("output_level", "0", "-20", 1), ("alpha", "2.5", "4", 2 * 500)];
        for (id, before, after, window) in steps {
            let run = |automated: bool| {
                let mut plugin = open(format);
                load_session(plugin.as_mut(), &preset("extend", &[(id, before)]), &Session::default());
                let value = plugin.parse(numeric_id(id), after).expect("a value");
                let step = AutomationPoint { sample: 12_345, id: numeric_id(id), value };
                let options = BounceOptions {
                    block: BlockSize::Fixed(700),
                    automation: if automated { vec![step] } else { vec![] },
                    ..BounceOptions::new(RATE_HZ, MONO)
                };
                play(plugin.as_mut(), &input, &options).remove(0)
            };
            let (still, stepped) = (run(false), run(true));
            let size = pyrophone_tests::peak(&still);
            let heard = (0..still.len()).find(|i| (still[*i] - stepped[*i]).abs() > 1e-4 * size).expect("heard at all");
            assert!(heard.abs_diff(12_345) <= window + 20, "{format} {id}: heard at {heard}");
        }
    }
}
