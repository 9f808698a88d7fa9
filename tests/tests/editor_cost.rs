//! Cost of drawing the editor. It measures and judges nothing, so it only runs when named:
//! `cargo test --package pyrophone-tests --test editor_cost -- --ignored --nocapture`. With `GALLIUM_NOOP=1` in the environment Mesa
//! draws nothing, so that what is left is the editor's own part and the driver's.

use std::collections::HashMap;
use std::time::{Duration, Instant};

use pyrophone_host::Format;
use pyrophone_tests::desk::TestDisplay;
use pyrophone_tests::live::{Clock, Live};
use pyrophone_tests::{RATE_HZ, STEREO, await_recording, flame, load_session, open, preset, recording, session};

/// The window's size, and how long it is watched.
const SIZE: (u32, u32) = (1000, 700);
const WATCHED: Duration = Duration::from_secs(10);

/// Processor time of each thread of this process, by its number, with its name.
fn threads() -> HashMap<String, (String, Duration)> {
    let folder = std::fs::read_dir("/proc/self/task").expect("a process to look at");
    let figures = folder.flatten().filter_map(|entry| {
        let name = std::fs::read_to_string(entry.path().join("comm")).ok()?;
        let spent = std::fs::read_to_string(entry.path().join("schedstat")).ok()?;
        let spent = Duration::from_nanos(spent.split(' ').next()?.parse().ok()?);
        Some((entry.file_name().to_string_lossy().into_owned(), (name.trim().to_owned(), spent)))
    });
    figures.collect()
}

#[test]
#[ignore = "a measurement"]
fn cost_of_drawing() {
    let Some(desk) = TestDisplay::set_up() else { return };
    let path = recording(desk.folder(), "campfire.wav", 2, 150_000);
    let mut plugin = open(Format::Clap);
    load_session(plugin.as_mut(), &preset("default", &[]), &session(Some(&path), None));
    await_recording(plugin.as_mut(), RATE_HZ, STEREO);
    let mut live = Live::start(plugin, RATE_HZ, STEREO);
    let before = threads();
    let mut window = desk.open(live.plugin());
    window.resize(live.plugin(), SIZE).unwrap_or_else(|error| panic!("{error}"));
    let input = flame(87, 2, 735);
    let mut position = 0;
    let mut play = |live: &mut Live, duration: Duration| {
        let began = Instant::now();
        let mut block = 0;
        while began.elapsed() < duration {
            live.play(&input, Clock::Playing(position), 735);
            position += 735;
            block += 1;
            let due = Duration::from_secs_f64(f64::from(block) * 735.0 / RATE_HZ);
            window.run_for(live.plugin(), due.saturating_sub(began.elapsed()));
        }
    };
    play(&mut live, Duration::from_secs(3));
    let (threads_then, map_then) = (threads(), desk.map().expect("drawn"));
    let began = Instant::now();
    play(&mut live, WATCHED);
    let watched_s = began.elapsed().as_secs_f64();
    let (threads_now, map_now) = (threads(), desk.map().expect("drawn"));

    let frames = (map_now.frames - map_then.frames) as f64;
    let ui_ms = 1000.0 * (map_now.spent - map_then.spent).as_secs_f64() / frames;
    println!("{:?} pixels, {frames} frames in {watched_s:.1} s", map_now.size);
    println!("laying out and drawing: {ui_ms:.3} ms a frame, {:.1} % of a core at 60 frames a second", 6.0 * ui_ms);
    for (number, (name, spent)) in &threads_now {
        if before.contains_key(number) {
            continue;
        }
        let earlier = threads_then.get(number).map_or(Duration::ZERO, |(_, spent)| *spent);
        let ms = 1000.0 * spent.saturating_sub(earlier).as_secs_f64() / frames;
        println!("thread {name}: {ms:.3} ms a frame, {:.1} % of a core at 60 frames a second", 6.0 * ms);
    }
    window.close(live.plugin());
}
