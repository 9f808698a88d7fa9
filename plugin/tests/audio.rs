//! The audio thread's part: long blocks, missing sidechains, restarts, and no allocation.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::time::{Duration, Instant};

use nice_plug::prelude::Params;
use nice_plug_egui::RepaintNotifier;
use pyrophone::audio::Audio;
use pyrophone::loader::{Engine, Loader};
use pyrophone_settings::{COUNT, PARAMETERS, Preset, Values};
use pyrophone_synthesis::chain::{Chain, Channels, Transport};

thread_local! {
    static WATCHED: Cell<bool> = const { Cell::new(false) };
    static COUNT_OF_CALLS: Cell<usize> = const { Cell::new(0) };
}

/// The system's allocator; counts calls on a watched thread.
struct Counting;

fn count() {
    if WATCHED.get() {
        COUNT_OF_CALLS.set(COUNT_OF_CALLS.get() + 1);
    }
}

// SAFETY: all is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count();
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations and releases of this thread during `work`.
fn calls_during(work: impl FnOnce()) -> usize {
    COUNT_OF_CALLS.set(0);
    WATCHED.set(true);
    work();
    WATCHED.set(false);
    COUNT_OF_CALLS.get()
}

const RATE_HZ: f64 = 44_100.0;

fn channels(sidechain: usize) -> Channels {
    Channels { input: 2, sidechain, output: 2 }
}

fn chain(values: &Values, sidechain: usize) -> Chain {
    Chain::new(RATE_HZ, channels(sidechain), &values.structure()).unwrap()
}

/// An `Audio` that runs, with the loader that feeds it.
fn audio(values: &Values, sidechain: usize, max_block: usize) -> (Loader, Audio) {
    let (loader, _, link) = Loader::start(RepaintNotifier::new());
    let mut audio = Audio::new(link);
    audio.set_chain(Some(chain(values, sidechain)), sidechain, max_block, values);
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
    audio.process(&mut [x, y], &[], &values, PLAYING);
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
        audio.process(&mut [x, y], side, &values, PLAYING);
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
fn without_engines_there_is_silence() {
    let (_loader, _, link) = Loader::start(RepaintNotifier::new());
    let mut audio = Audio::new(link);
    let mut channel = noise(100, 1);
    audio.process(&mut [&mut channel], &[], &Values::default(), PLAYING);
    assert!(channel.iter().all(|sample| *sample == 0.0));
    assert_eq!((audio.tail_samples(), audio.latency_samples()), (None, None));
}

#[test]
fn a_restart_is_asked_for_once_and_when_all_is_ready() {
    let (loader, params, link) = Loader::start(RepaintNotifier::new());
    let old = params.values();
    let mut audio = Audio::new(link);
    audio.set_chain(Some(chain(&old, 0)), 0, 64, &old);
    let ticket =
        loader.set_engine(Engine { sample_rate_hz: RATE_HZ, structure: old.structure(), channels: channels(0) });
    assert!(loader.wait(ticket, None));
    assert_eq!(audio.wanted_restart(&old), None);
    let map = params.param_map();
    let (_, window, _) = map.iter().find(|(id, _, _)| id == "window").unwrap();
    // SAFETY: the parameters are alive.
    unsafe { window._internal_set_normalized_value(window.preview_normalized(16.0)) };
    let new = params.values();
    let began = Instant::now();
    let restart = loop {
        if let Some(restart) = audio.wanted_restart(&new) {
            break restart;
        }
        assert!(began.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(5));
    };
    assert_eq!(restart.latency_samples as usize, chain(&new, 0).latency_samples());
    assert_eq!(audio.wanted_restart(&new), None, "once");
    assert_eq!(audio.wanted_restart(&old), None, "and not when it was taken back");
}

#[test]
fn nothing_allocates_while_sound_runs() {
    let folder = tempfile::tempdir().unwrap();
    let (loader, params, link) = Loader::start(RepaintNotifier::new());
    let mut audio = Audio::new(link);
    let old = params.values();
    audio.set_chain(Some(chain(&old, 2)), 2, 512, &old);
    loader.set_engine(Engine { sample_rate_hz: RATE_HZ, structure: old.structure(), channels: channels(2) });
    let recordings: Vec<_> = (0..2)
        .map(|index| {
            let path = folder.path().join(format!("{index}.wav"));
            let spec = hound::WavSpec {
                channels: 1,
                sample_rate: 44_100,
                bits_per_sample: 32,
                sample_format: hound::SampleFormat::Float,
            };
            let mut writer = hound::WavWriter::create(&path, spec).unwrap();
            noise(44_100, 7 + index).into_iter().for_each(|sample| writer.write_sample(sample).unwrap());
            writer.finalize().unwrap();
            path
        })
        .collect();
    let map = params.param_map();
    let (left, right) = (noise(512, 1), noise(512, 2));
    let (mut x, mut y) = (left.clone(), right.clone());
    let (mut side_x, mut side_y) = (noise(512, 3), noise(512, 4));
    let mut swaps = 0;
    let mut heard = 0.0f32;
    loader.handle().shared.learning.store(true, std::sync::atomic::Ordering::Relaxed);
    for block in 0..600usize {
        if block % 150 == 0 {
            loader.handle().load(recordings[block / 150 % 2].clone());
            std::thread::sleep(Duration::from_millis(200));
        }
        // A control is automated to another value in every block.
        let index = block % COUNT;
        if PARAMETERS[index].automatable && PARAMETERS[index].id != "bypass" {
            let share = (block as f32 * 0.618).fract();
            // SAFETY: the parameters are alive.
            unsafe { map[index].1._internal_set_normalized_value(share) };
        }
        let samples = [1, 17, 64, 480, 512][block % 5];
        x.copy_from_slice(&left);
        y.copy_from_slice(&right);
        let transport = Transport { playing: true, position: Some((block * 512) as i64) };
        let calls = calls_during(|| {
            audio.receive_updates();
            let values = params.values();
            let side = [&mut side_x[..samples], &mut side_y[..samples]];
            audio.process(&mut [&mut x[..samples], &mut y[..samples]], &side, &values, transport);
            audio.wanted_restart(&values);
            if !audio.take_meters().no_recording {
                swaps += 1;
            }
            audio.tail_samples();
            if block % 97 == 0 {
                audio.reset();
            }
        });
        assert_eq!(calls, 0, "block {block} of {samples} samples");
        heard = x[..samples].iter().fold(heard, |peak, sample| peak.max(sample.abs()));
    }
    assert!(swaps > 0, "a recording has arrived");
    assert!(heard > 1e-5, "something was heard");
}
