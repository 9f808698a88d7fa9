//! The audio thread's part: long blocks, missing sidechains, restarts.

use std::time::{Duration, Instant};

use nice_plug::prelude::Params;
use nice_plug_egui::RepaintNotifier;
use pyrophone::audio::engines::{Builder, Built, Engines, Pending};
use pyrophone::audio::note_bursts::NoteBursts;
use pyrophone::audio::{Audio, Tail};
use pyrophone::loader::{Engine, Loader};
use pyrophone::probe::{self, Listen};
use pyrophone_settings::{Preset, Values};
use pyrophone_synthesis::chain::{Chain, Channels, Transport};
use ringbuf::traits::Producer;

const RATE_HZ: f64 = 44_100.0;

fn channels(sidechain: usize) -> Channels {
    Channels { input: 2, sidechain, output: 2 }
}

fn engine(values: &Values, sidechain: usize) -> Engine {
    Engine { sample_rate_hz: RATE_HZ, structure: values.structure(), channels: channels(sidechain) }
}

fn chain(values: &Values, sidechain: usize) -> Chain {
    Chain::new(RATE_HZ, channels(sidechain), &values.structure()).unwrap()
}

/// Has `audio` run new engines.
fn run(audio: &mut Audio, values: &Values, sidechain: usize, max_block: usize) {
    let engines = Engines::new(engine(values, sidechain)).unwrap();
    audio.run(Built::Ready(Box::new(engines)), channels(sidechain), max_block);
}

/// An `Audio` that runs, with the loader that feeds it.
fn audio(values: &Values, sidechain: usize, max_block: usize) -> (Loader, Audio) {
    let (loader, _, link) = Loader::start(RepaintNotifier::new(), None);
    let mut audio = Audio::new(link, probe::pair().0);
    run(&mut audio, values, sidechain, max_block);
    (loader, audio)
}

fn noise(samples: usize, seed: u32) -> Vec<f32> {
    let mut state = seed | 1;
    let mut low = 0.0;
    (0..samples)
        .map(|_| {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            low += 0.02 * (state as i32 as f32 / i32::MAX as f32 - low);
            low * 4.0
        })
        .collect()
}

const PLAYING: Transport = Transport { playing: true, position: Some(1000) };

#[test]
fn blocks_longer_than_announced_come_out_the_same() {
    let values = Preset::find("extend").unwrap().values;
    let (_loader, mut audio) = audio(&values, 0, 64);
    let mut direct = chain(&values, 0);
    let (left, right) = (noise(10_000, 1), noise(10_000, 2));
    let (mut a, mut b) = ([left.clone(), right.clone()], [left, right]);
    let [x, y] = &mut a;
    audio.process(&mut [x, y], &[], &values, &NoteBursts::default(), PLAYING);
    let [x, y] = &mut b;
    direct.process(&mut [x, y], &[], &values.controls(), PLAYING);
    assert_eq!(a, b);
    assert!(a[0].iter().any(|sample| sample.abs() > 1e-4), "the comparison is not of silence");
}

#[test]
fn a_sidechain_of_another_length_is_silent() {
    let mut values = Values::default();
    values.set_text("drive_mode", "envelope").unwrap();
    let run = |side: &mut [&mut [f32]]| {
        let (_loader, mut audio) = audio(&values, 2, 512);
        let mut main = [noise(6000, 1), noise(6000, 2)];
        let [x, y] = &mut main;
        audio.process(&mut [x, y], side, &values, &NoteBursts::default(), PLAYING);
        main
    };
    let (mut zero, mut short, mut full) = (vec![0.0; 6000], vec![0.5; 17], noise(6000, 3));
    let mut other = full.clone();
    let silent = run(&mut [&mut zero.clone(), &mut zero]);
    assert_eq!(run(&mut []), silent);
    assert_eq!(run(&mut [&mut short.clone(), &mut short]), silent);
    assert_ne!(run(&mut [&mut full, &mut other]), silent, "a real sidechain is heard");
}

#[test]
fn without_engines_the_input_passes_through() {
    let (_loader, _, link) = Loader::start(RepaintNotifier::new(), None);
    let mut audio = Audio::new(link, probe::pair().0);
    let (input, values) = (noise(100, 1), Values::default());
    for inputs in [1, 2] {
        audio.pass_through(Channels { input: inputs, sidechain: 0, output: 2 }, 64);
        let (mut left, mut right) = (input.clone(), vec![0.0; 100]);
        audio.process(&mut [&mut left, &mut right], &[], &values, &NoteBursts::default(), PLAYING);
        assert_eq!(left, input);
        // One channel is heard on both sides; of two, the second was silent.
        assert_eq!(right, if inputs == 1 { input.clone() } else { vec![0.0; 100] });
    }
    assert_eq!((audio.tail(), audio.latency_samples()), (Tail::Over, None));
}

/// What `audio` makes of a flame, in 100 blocks of 512.
fn played(audio: &mut Audio, values: &Values) -> Vec<f32> {
    let mut all = vec![];
    for block in 0..100 {
        let (mut left, mut right) = (noise(512, block as u32), noise(512, block as u32 + 7));
        let transport = Transport { playing: true, position: Some(block * 512) };
        audio.process(&mut [&mut left, &mut right], &[], values, &NoteBursts::default(), transport);
        all.extend(left);
    }
    all
}

#[test]
fn engines_that_arrive_late_sound_from_then_on() {
    let values = Preset::find("extend").unwrap().values;
    let (_loader, mut audio) = audio(&values, 0, 512);
    let prompt = played(&mut audio, &values);
    let (mut arriving, pending) = Pending::pair();
    audio.run(Built::Pending(pending), channels(0), 512);
    let (mut left, mut right) = (noise(512, 1), noise(512, 2));
    audio.process(&mut [&mut left, &mut right], &[], &values, &NoteBursts::default(), PLAYING);
    assert_eq!((left, audio.tail()), (vec![0.0; 512], Tail::Endless), "until then it is silent, but not over");
    let Built::Ready(late) = Builder::default().build(engine(&values, 0), false, None).unwrap() else {
        panic!("without a limit they are awaited")
    };
    assert!(arriving.try_push(late).is_ok());
    audio.receive_updates();
    assert!(audio.latency_samples().is_some());
    assert!(played(&mut audio, &values) == prompt);
}

#[test]
fn engines_run_again_sound_as_new() {
    let values = Preset::find("extend").unwrap().values;
    let (_loader, mut audio) = audio(&values, 0, 512);
    let first = played(&mut audio, &values);
    assert!(first.iter().any(|x| x.abs() > 1e-4), "the comparison is not of silence");
    assert!(audio.rerun(&engine(&values, 0), false, 512));
    assert!(played(&mut audio, &values) == first);
    assert!(!audio.rerun(&Engine { sample_rate_hz: 48_000.0, ..engine(&values, 0) }, false, 512), "another rate");
}

#[test]
fn a_restart_is_asked_for_once_and_when_all_is_ready() {
    let (loader, params, link) = Loader::start(RepaintNotifier::new(), None);
    let old = params.values();
    let mut audio = Audio::new(link, probe::pair().0);
    run(&mut audio, &old, 0, 64);
    let ticket = loader.set_engine(engine(&old, 0));
    assert!(loader.wait(ticket, None));
    assert!(!audio.wants_restart(&old));
    let map = params.param_map();
    let (_, window, _) = map.iter().find(|(id, _, _)| id == "window").unwrap();
    // SAFETY: the parameters are alive.
    unsafe { window._internal_set_normalized_value(window.preview_normalized(16.0)) };
    let new = params.values();
    let began = Instant::now();
    while !audio.wants_restart(&new) {
        assert!(began.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(!audio.wants_restart(&new), "once");
    assert!(!audio.wants_restart(&old), "and not when it was taken back");
}

#[test]
fn burst_drives_input_and_sidechain_modes() {
    // The input itself, and a sidechain that is not the input.
    for (mode, sidechain) in [("pressure", 0), ("envelope", 2), ("envelope", 0)] {
        let mut values = Preset::find("extend").unwrap().values;
        values.set_text("drive_mode", mode).unwrap();
        let (loader, _, link) = Loader::start(RepaintNotifier::new(), None);
        let (sent, window) = probe::pair();
        let mut audio = Audio::new(link, sent);
        run(&mut audio, &values, sidechain, 512);
        let mut played = |listen: Listen| {
            window.listen_to(listen);
            let mut all = vec![];
            for block in 0..200 {
                let (mut left, mut right) = (vec![0.0; 512], vec![0.0; 512]);
                let (mut x, mut y) = (vec![0.0; 512], vec![0.0; 512]);
                let side: [&mut [f32]; 2] = [&mut x, &mut y];
                let transport = Transport { playing: true, position: Some(block * 512) };
                audio.process(
                    &mut [&mut left, &mut right],
                    &side[..sidechain],
                    &values,
                    &NoteBursts::default(),
                    transport,
                );
                all.extend(left);
            }
            all
        };
        let peak = |samples: &[f32]| samples.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
        window.watch(true);
        assert_eq!(peak(&played(Listen::Output)), 0.0, "silence in, silence out");
        window.burst();
        let output = played(Listen::Output);
        assert!(peak(&output) > 0.01, "{mode}, {sidechain}: {}", peak(&output));
        window.burst();
        let drive = played(Listen::Drive);
        assert!(peak(&drive) > 0.01 && drive != output, "{mode}, {sidechain}: the drive alone");
        drop(loader);
    }
}

#[test]
fn notes_light_bursts_at_their_sample_as_loud_as_they_are_struck() {
    const NOTES: [(usize, f32); 3] = [(1000, 0.5), (5003, 1.0), (11_000, 0.25)];
    let values = Preset::find("extend").unwrap().values;
    let run = |blocks: &[usize], notes: &[(usize, f32)]| {
        let (_loader, mut audio) = audio(&values, 0, 4096);
        let mut sound = [vec![0.0f32; 40_000], vec![0.0; 40_000]];
        let (mut start, mut number) = (0, 0);
        while start < 40_000 {
            let end = (start + blocks[number % blocks.len()]).min(40_000);
            let mut bursts = NoteBursts::default();
            for (at, level) in notes.iter().filter(|(at, _)| (start..end).contains(at)) {
                bursts.push(at - start, *level);
            }
            let [left, right] = &mut sound;
            let transport = Transport { playing: true, position: Some(start as i64) };
            audio.process(&mut [&mut left[start..end], &mut right[start..end]], &[], &values, &bursts, transport);
            (start, number) = (end, number + 1);
        }
        sound
    };
    let whole = run(&[4096], &NOTES);
    let power = |sound: &[Vec<f32>; 2]| sound[0].iter().map(|x| x * x).sum::<f32>();
    assert!(power(&whole) > 1e-3, "a note is heard without any input");
    assert!(run(&[17, 480, 1, 2048], &NOTES) == whole, "however the host cuts its blocks");
    assert_eq!(power(&run(&[4096], &[])), 0.0);
    let [soft, loud] = [0.25, 0.5].map(|level| power(&run(&[512], &[(1000, level)])));
    assert!((10.0 * (loud / soft).log10() - 6.0).abs() < 0.5, "{loud} over {soft}");
}
