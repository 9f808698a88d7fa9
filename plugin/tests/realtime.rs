//! The audio thread's promise, over the plugin's whole `process`: no allocation, no free, no lock,
//! no system call; under automation of every parameter, with recordings swapped and states loaded
//! while it plays.
//!
//! Run plainly it counts allocations. Built with the realtime sanitizer and `--cfg
//! sanitize_realtime`, the first forbidden call beneath `process` ends the run with its stack. The
//! context that calls is our own: what a plugin format's wrapper does around `process` is not ours
//! to promise.

#![cfg_attr(sanitize_realtime, feature(sanitize))]

mod common;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use common::Context;
use nice_plug::prelude::*;
use pyrophone::Pyrophone;
use pyrophone::probe::Listen;
use pyrophone_settings::COUNT;
use pyrophone_settings::session::{FIELD, FieldReference, RecordingReference, Session};
use pyrophone_synthesis::vortex::{End, SpeedField};

const RATE_HZ: f32 = 48_000.0;
const BLOCKS: [usize; 8] = [0, 1, 17, 64, 480, 1024, 4096, 8192];

#[cfg_attr(sanitize_realtime, sanitize(realtime = "nonblocking"))]
fn process(plugin: &mut Pyrophone, main: &mut Buffer<'_>, aux: &mut AuxiliaryBuffers<'_>, context: &mut Context) {
    plugin.process(main, aux, context);
}

#[cfg_attr(sanitize_realtime, sanitize(realtime = "nonblocking"))]
fn reset(plugin: &mut Pyrophone) {
    plugin.reset();
}

fn noise(samples: usize, seed: u32) -> Vec<f32> {
    let mut state = seed | 1;
    let mut low = 0.0;
    let next = |_| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        low += 0.02 * (state as i32 as f32 / i32::MAX as f32 - low);
        low * 4.0
    };
    (0..samples).map(next).collect()
}

/// The field of a state that names this recording.
fn session(folder: &Path, name: &str) -> String {
    let path: PathBuf = folder.join(name);
    pyrophone_recording::write_wav_f32(&path, &[noise(60_000, name.len() as u32)], RATE_HZ as u32).unwrap();
    let content_hash = pyrophone_recording::content_hash(&pyrophone_recording::read(&path).unwrap());
    let path = path.to_str().unwrap().to_owned();
    let recording = Some(RecordingReference { path, content_hash, embedded: None });
    // A speed field of its own for each.
    let places = vec![[0.5, 1.0, 0.0]; name.len()];
    let speeds = vec![name.len() as f32; 7 * name.len()];
    let field = SpeedField::new(30.0, name.len(), places, speeds, End::Periodic).unwrap();
    let field = Some(FieldReference { path: name.to_owned(), bytes: field.to_bytes() });
    serde_json::to_string(&Session { recording, field, ..Session::default() }.to_json()).unwrap()
}

fn run(sidechain_channels: usize) {
    let folder = tempfile::tempdir().unwrap();
    let sessions = [session(folder.path(), "a.wav"), session(folder.path(), "other.wav")];
    let mut plugin = Pyrophone::default();
    let params = plugin.params();
    let layout = Pyrophone::AUDIO_IO_LAYOUTS.iter().find(|layout| {
        let sidechain = layout.aux_input_ports.first().map_or(0, |port| port.get() as usize);
        layout.main_input_channels == NonZeroU32::new(2) && sidechain == sidechain_channels
    });
    let config = BufferConfig {
        sample_rate: RATE_HZ,
        min_buffer_size: None,
        max_buffer_size: 8192,
        process_mode: ProcessMode::Realtime,
    };
    let mut context = Context { transport: Transport::new(RATE_HZ) };
    // Offline at first, which waits for the engines.
    for process_mode in [ProcessMode::Offline, ProcessMode::Realtime] {
        assert!(plugin.activate(layout.unwrap(), &BufferConfig { process_mode, ..config }, &mut context));
        if process_mode == ProcessMode::Offline {
            plugin.deactivate();
        }
    }
    plugin.reset();

    // States arrive on another thread, as hosts load them.
    let done = Arc::new(AtomicBool::new(false));
    let loading = std::thread::spawn({
        let (params, done) = (params.clone(), done.clone());
        move || {
            let mut turn = 0;
            while !done.load(Ordering::Relaxed) {
                let state = [(FIELD.to_owned(), sessions[turn / 40 % 2].clone())];
                params.deserialize_fields(&state.into());
                turn += 1;
                std::thread::sleep(Duration::from_millis(5));
            }
            turn
        }
    });

    let probe = plugin.probe();
    let (mut watched_frames, mut traces) = (0, 0);
    let map = params.param_map();
    let (left, right, side) = (noise(8192, 1), noise(8192, 2), noise(8192, 3));
    let mut heard = 0.0f32;
    // Every parameter is moved several times, and a window comes and goes six times.
    let rounds = if std::env::var("PYROPHONE_SOAK").as_deref() == Ok("1") { 3200 } else { 360usize };
    for round in 0..rounds {
        let index = round % COUNT;
        if map[index].0 != "bypass" {
            // SAFETY: the parameters are alive.
            unsafe { map[index].1._internal_set_normalized_value((round as f32 * 0.618).fract()) };
        }
        let samples = BLOCKS[round % BLOCKS.len()];
        // A window comes and goes; at times it is too slow to take what there is.
        match round % 60 {
            0 => probe.watch(true),
            10 => probe.listen_to(Listen::Drive),
            20 => probe.listen_to(Listen::Recording),
            30 => probe.burst(),
            40 => probe.watch(false),
            _ if round % 7 == 0 => {
                probe.drain(|_| watched_frames += 1);
                probe.take_traces(|_| traces += 1);
            }
            _ => {}
        }
        let (mut x, mut y) = (left[..samples].to_vec(), right[..samples].to_vec());
        let mut sidechain: Vec<Vec<f32>> = (0..sidechain_channels).map(|_| side[..samples].to_vec()).collect();
        let mut main = Buffer::default();
        // SAFETY: the slices outlive the buffer, and all are `samples` long.
        unsafe { main.set_slices(samples, |slices| *slices = vec![&mut x, &mut y]) };
        let mut side = Buffer::default();
        let slices: Vec<&mut [f32]> = sidechain.iter_mut().map(Vec::as_mut_slice).collect();
        // SAFETY: as above.
        unsafe { side.set_slices(samples, |all| *all = slices) };
        let mut inputs = [side];
        let count = usize::from(sidechain_channels > 0);
        let mut aux = AuxiliaryBuffers { inputs: &mut inputs[..count], outputs: &mut [] };
        context.transport.playing = round % 5 != 0;
        context.transport.pos_samples = (round % 7 != 0).then_some((round * 5000 % 90_000) as i64 - 1000);
        let seen = allocation_counter::measure(|| process(&mut plugin, &mut main, &mut aux, &mut context));
        assert_eq!((seen.count_total, seen.count_current), (0, 0), "round {round}, {samples} samples");
        if round % 90 == 89 {
            reset(&mut plugin);
        }
        heard = x.iter().fold(heard, |peak, sample| peak.max(sample.abs()));
        assert!(x.iter().chain(&y).all(|sample| sample.is_finite()));
    }
    done.store(true, Ordering::Relaxed);
    assert!(loading.join().unwrap() > 20, "states were loaded");
    assert!(heard > 1e-5, "something was heard");
    assert!(watched_frames > 10_000 && traces > 100, "something was seen: {watched_frames} frames, {traces} traces");
    plugin.deactivate();
}

#[test]
fn stereo() {
    run(0);
}

#[test]
fn stereo_with_sidechain() {
    run(2);
}
