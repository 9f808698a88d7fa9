//! The audio thread's promise: no allocation, no free, no lock, no system call.
//!
//! Run plainly (release mode too) it counts allocations and frees. Built with the realtime
//! sanitizer and `--cfg sanitize_realtime`, the first forbidden call anywhere beneath `process` ends
//! the run with its stack.

#![cfg_attr(sanitize_realtime, feature(sanitize))]

#[path = "common/effect.rs"]
mod effect;
#[path = "common/signals.rs"]
mod signals;

use effect::{MODES, STEREO, any_controls, chain, channels, dictionary};
use pyrophone_synthesis::chain::{Chain, Channels, Transport};
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::Distribution;
use pyrophone_synthesis::{Controls, EngineConfig};
use signals::Random;
use std::sync::Arc;

#[cfg_attr(sanitize_realtime, sanitize(realtime = "nonblocking"))]
fn process(
    chain: &mut Chain,
    main: &mut [&mut [f32]],
    sidechain: &[&[f32]],
    controls: &Controls,
    transport: Transport,
) {
    chain.process(main, sidechain, controls, transport);
}

#[cfg_attr(sanitize_realtime, sanitize(realtime = "nonblocking"))]
fn exchange(chain: &mut Chain, new: &mut Recording, old: &mut Recording) {
    old.0 = chain.swap_slot(new.2, new.0.take());
    old.1 = chain.swap_distribution(new.1.take());
}

#[cfg_attr(sanitize_realtime, sanitize(realtime = "nonblocking"))]
fn reset(chain: &mut Chain) {
    chain.reset();
    let _ = (chain.take_meters(), chain.is_silent(), chain.tail_samples());
}

/// A dictionary, a distribution, and the slot of the dictionary.
type Recording = (Option<Arc<pyrophone_synthesis::recording::RecordingDictionary>>, Option<Arc<Distribution>>, usize);

/// Every block size eight times, and all that happens now and then at least once with each; more of it in the long tests.
fn rounds() -> usize {
    if std::env::var("PYROPHONE_SOAK").as_deref() == Ok("1") { 640 } else { 64 }
}

/// Everything that may happen on the audio thread, at every block size.
fn everything(rate_hz: f64, layout: Channels, dynamics: MatchingMode) {
    let mut random = Random::new(3);
    let mut chain = chain(rate_hz, layout, dynamics);
    let input = channels(1, layout.output, 8192);
    let sidechain = channels(2, layout.sidechain, 8192);
    let structure = EngineConfig { dynamics, ..EngineConfig::default() };
    for round in 0..rounds() {
        let block = [0, 1, 17, 64, 480, 1024, 4096, 8192][round % 8];
        let mut block_data: Vec<Vec<f32>> = input.iter().map(|x| x[..block].to_vec()).collect();
        if round % 11 == 0 {
            block_data.iter_mut().flatten().for_each(|x| *x = f32::NAN);
        }
        let mut main: Vec<&mut [f32]> = block_data.iter_mut().map(Vec::as_mut_slice).collect();
        let side: Vec<&[f32]> = sidechain.iter().map(|x| &x[..block]).collect();
        let controls = any_controls(&mut random);
        let position = (round % 3 == 0).then(|| random.below(1_000_000) as i64);
        let transport = Transport { playing: true, position };
        let mut new: Recording = (None, None, round % 5);
        if round % 7 == 0 {
            new.0 = (round % 21 != 0).then(|| dictionary(rate_hz, &structure, 1 + round % 2));
            new.1 = Some(Arc::new(Distribution::from_magnitudes(vec![0.1, 0.2, 0.3])));
        }
        let mut old: Recording = (None, None, 0);
        let seen = allocation_counter::measure(|| {
            process(&mut chain, &mut main, &side, &controls, transport);
            if round % 7 == 0 {
                exchange(&mut chain, &mut new, &mut old);
            }
            if round % 50 == 49 {
                reset(&mut chain);
            }
        });
        // Allocations ever made, and what freeing leaves behind.
        assert_eq!((seen.count_total, seen.count_current), (0, 0), "round {round}, block of {block}");
    }
}

#[test]
fn stereo_with_sidechain() {
    MODES.into_iter().for_each(|dynamics| everything(48_000.0, STEREO, dynamics));
}

#[test]
fn mono_at_96_khz() {
    let mono = Channels { input: 1, sidechain: 0, output: 1 };
    MODES.into_iter().for_each(|dynamics| everything(96_000.0, mono, dynamics));
}

#[test]
fn the_counter_sees_an_allocation_and_a_free() {
    let kept = std::hint::black_box(vec![1u8; 100]);
    let seen = allocation_counter::measure(|| drop(kept));
    assert_eq!(seen.count_current, -1);
    let seen = allocation_counter::measure(|| std::mem::forget(std::hint::black_box(vec![1u8; 100])));
    assert_eq!(seen.count_total, 1);
}

/// The sanitizer must be able to fail: a child process that allocates where it must not.
#[cfg(sanitize_realtime)]
#[test]
fn the_sanitizer_stops_at_an_allocation() {
    #[sanitize(realtime = "nonblocking")]
    fn allocate() -> Vec<u8> {
        std::hint::black_box(vec![1u8; std::hint::black_box(100)])
    }
    const FLAG: &str = "PYROPHONE_ALLOCATE";
    if std::env::var_os(FLAG).is_some() {
        drop(allocate());
        return;
    }
    let this_test = ["--exact", "the_sanitizer_stops_at_an_allocation"];
    let program = std::env::current_exe().unwrap();
    let child = std::process::Command::new(program).args(this_test).env(FLAG, "1").output().unwrap();
    let said = String::from_utf8_lossy(&child.stderr);
    assert!(!child.status.success() && said.contains("RealtimeSanitizer"), "{said}");
}
