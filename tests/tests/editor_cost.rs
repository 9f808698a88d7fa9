//! Cost of the editor's window on a screen. It measures and judges nothing, so it only runs when named:
//! `cargo xtask bench window`. With `GALLIUM_NOOP=1` in the environment Mesa rasterises nothing, so that what is left is the editor's own part
//! and the driver's.
//!
//! Every line of a state is one row of a Markdown table. Times are the processor's, by thread, not the clock's: other programs
//! may run beside it.

use std::collections::{HashMap, HashSet};
use std::time::{Duration, Instant};

use pyrophone_host::Format;
use pyrophone_host::editor::EditorWindow;
use pyrophone_tests::desk::TestDisplay;
use pyrophone_tests::live::{Clock, Live};
use pyrophone_tests::{RATE_HZ, STEREO, await_recording, flame, load_session, open, preset, recording, session};

/// The window's size in points.
const SIZE: (u32, u32) = (1000, 700);
/// How long every state is watched, and how long it lasts before.
const WATCHED: Duration = Duration::from_secs(10);
const SETTLING: Duration = Duration::from_secs(3);
/// Pictures move until what they show has passed, 9 s after the last sound.
const COMING_TO_REST: Duration = Duration::from_secs(16);
/// Samples of a block: sixty a second.
const BLOCK: usize = 735;
/// The rate of frames that costs are told for, in Hz.
const FRAMES_HZ: f64 = 60.0;

/// Processor time of this process, by what it went to.
#[derive(Debug, Clone, Copy, Default)]
struct Spent {
    /// The threads that were there before the window: engines, host, loader.
    engines: Duration,
    /// The window's thread, with the driver's part that runs on it.
    window: Duration,
    /// The threads of Mesa's software rasteriser, which a graphics card has no use for.
    rasteriser: Duration,
}

/// Processor time of each thread, by its number, with its name.
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

/// What the process has spent so far; `before` are the threads that were there before the window.
fn spent(before: &HashSet<String>) -> Spent {
    let mut spent = Spent::default();
    for (number, (name, time)) in threads() {
        let part = match () {
            () if before.contains(&number) => &mut spent.engines,
            () if name.contains("llvmpipe") => &mut spent.rasteriser,
            () => &mut spent.window,
        };
        *part += time;
    }
    spent
}

/// A plugin that plays, and the window, while there is one.
struct Stage<'a> {
    desk: &'a TestDisplay,
    live: Live,
    window: Option<EditorWindow>,
    before: HashSet<String>,
    position: i64,
}

impl Stage<'_> {
    /// Plays for so long, at the pace of the clock; `is_playing` is whether the host's transport moves and something comes in.
    fn play(&mut self, duration: Duration, is_playing: bool) {
        let input = if is_playing { flame(87, 2, BLOCK) } else { vec![vec![0.0; BLOCK]; 2] };
        let began = Instant::now();
        for block in 1.. {
            if began.elapsed() >= duration {
                break;
            }
            let clock = if is_playing { Clock::Playing(self.position) } else { Clock::Stopped(self.position) };
            self.live.play(&input, clock, BLOCK);
            self.position += if is_playing { BLOCK as i64 } else { 0 };
            let due = Duration::from_secs_f64(f64::from(block) * BLOCK as f64 / RATE_HZ);
            let pause = due.saturating_sub(began.elapsed());
            match &mut self.window {
                Some(window) => window.run_for(self.live.plugin(), pause),
                None => std::thread::sleep(pause),
            }
        }
    }

    /// Frames that the window has drawn, and the time for laying them out and for analysing the sound.
    fn drawn(&self) -> (u64, Duration, Duration) {
        self.desk.map().map_or_else(Default::default, |map| (map.frames, map.spent - map.analysing, map.analysing))
    }

    /// Watches a state and prints its row.
    fn measure(&mut self, state: &str, is_playing: bool) {
        let ((frames_then, contents_then, analysis_then), then, began) =
            (self.drawn(), spent(&self.before), Instant::now());
        self.play(WATCHED, is_playing);
        let ((frames, contents, analysis), now, seconds) =
            (self.drawn(), spent(&self.before), began.elapsed().as_secs_f64());
        let frames = (frames - frames_then) as f64;
        let share = |then: Duration, now: Duration| 100.0 * now.saturating_sub(then).as_secs_f64() / seconds;
        // At another rate of frames as much sound is analysed a second.
        let analysed = analysis.saturating_sub(analysis_then);
        let at_rate = |then: Duration, now: Duration, analysed: Duration| match frames {
            0.0 => "–".to_owned(),
            _ => {
                let drawn = now.saturating_sub(then).saturating_sub(analysed).as_secs_f64() * FRAMES_HZ / frames;
                format!("{:.1} %", 100.0 * (drawn + analysed.as_secs_f64() / seconds))
            }
        };
        let case = if std::env::var_os("GALLIUM_NOOP").is_some() { ", nothing rasterised" } else { "" };
        println!(
            "| {state}{case} | {:.1} | {:.1} % | {:.1} % | {:.1} % | {} | {} | {} |",
            frames / seconds,
            share(then.engines, now.engines),
            share(then.window, now.window),
            share(then.rasteriser, now.rasteriser),
            at_rate(contents_then, contents + analysed, analysed),
            at_rate(then.window, now.window, analysed),
            at_rate(then.rasteriser, now.rasteriser, Duration::ZERO),
        );
    }
}

#[test]
#[ignore = "a measurement"]
fn cost_of_drawing() {
    // As it draws for users, and without the list of items that other tests need.
    // SAFETY: the only test of its program, and no plugin is there yet; nobody else reads or writes the environment.
    unsafe {
        std::env::set_var("PYROPHONE_FRAMES_PER_SECOND", "64");
        std::env::set_var("PYROPHONE_EDITOR_ITEMS", "0");
    }
    let Some(desk) = TestDisplay::set_up() else { return };
    let path = recording(desk.folder(), "campfire.wav", 2, 150_000);
    let mut plugin = open(Format::Clap);
    load_session(plugin.as_mut(), &preset("default", &[]), &session(Some(&path), None));
    await_recording(plugin.as_mut(), RATE_HZ, STEREO);
    let live = Live::start(plugin, RATE_HZ, STEREO);
    let before = threads().into_keys().collect();
    let mut stage = Stage { desk: &desk, live, window: None, before, position: 0 };
    println!(
        "\n| state | frames a second | engines | window | rasteriser | contents, 60 frames | window, 60 frames | rasteriser, 60 frames |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    stage.play(SETTLING, true);
    stage.measure("no window yet", true);
    let mut window = desk.open(stage.live.plugin());
    window.resize(stage.live.plugin(), SIZE).unwrap_or_else(|error| panic!("{error}"));
    stage.window = Some(window);
    stage.play(SETTLING, true);
    assert_eq!(desk.map().map(|map| map.size), Some(SIZE), "drawn");
    stage.measure("Play page", true);
    stage.play(COMING_TO_REST, false);
    stage.measure("stopped, unchanged", false);
    stage.window.take().expect("still open").close(stage.live.plugin());
    stage.play(SETTLING, true);
    stage.measure("closed", true);
}
