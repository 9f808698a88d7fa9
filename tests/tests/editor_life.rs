//! Editors come and go while it plays, several at once, and plugins go with their editors open: the host survives, and nothing is
//! left behind.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use pyrophone_host::editor::EditorWindow;
use pyrophone_host::{Format, Plugin};
use pyrophone_tests::desk::{PATIENCE, Picture, TestDisplay};
use pyrophone_tests::live::{Clock, Live, Player};
use pyrophone_tests::{
    RATE_HZ, STEREO, await_recording, flame, in_a_process_of_its_own, load_session, open, peak, preset, recording,
    rounds, session, set,
};

const CYCLES: (usize, usize) = (28, 100);
/// From this one on nothing more is kept than before: caches are full.
const SETTLED: usize = 16;
/// How much more memory in bytes may be held after the last cycle: less than a keyboard map for each of the fewest windows.
const GROWTH: usize = 640 << 10;
/// The same for the process as a whole, in which there are windows' pictures too; a little of what was freed stays in it.
const RESIDENT_GROWTH: usize = 10 << 20;

#[test]
fn editors_come_and_go() {
    // With a heap for every thread, what windows' threads have freed stays in so many places that nothing can be told from
    // the size of the process.
    in_a_process_of_its_own("editors_come_and_go", &[("MALLOC_ARENA_MAX", "1")], || {
        let Some(desk) = TestDisplay::set_up() else { return };
        for format in Format::ALL {
            while_it_plays(&desk, format);
            two_at_once(&desk, format);
            gone_with_their_editors(&desk, format);
        }
    });
}

fn instance(format: Format, folder: &Path) -> Live {
    let path = recording(folder, "campfire.wav", 1, 30_000);
    let mut plugin = open(format);
    load_session(plugin.as_mut(), &preset("default", &[]), &session(Some(&path), None));
    await_recording(plugin.as_mut(), RATE_HZ, STEREO);
    Live::start(plugin, RATE_HZ, STEREO)
}

fn play_until(player: &mut Player, is_over: &AtomicBool) {
    let input = flame(82, 2, 1024);
    let mut position = 0;
    while !is_over.load(Ordering::Relaxed) {
        let output = player.play(&input, Clock::Playing(position), 256);
        assert!(peak(&output[0]).is_finite());
        position += 1024;
        // Not far from real time, so that the window has its share of the machine.
        thread::sleep(Duration::from_millis(10));
    }
}

/// Resources held by a process.
#[derive(Debug, Clone, Copy)]
struct Holdings {
    /// Bytes that were asked for and not freed.
    allocated: usize,
    /// Bytes in memory; what was freed may be among them.
    resident: usize,
    threads: usize,
    files: usize,
}

impl Holdings {
    /// At present.
    fn now() -> Self {
        // SAFETY: calls that count, and hand back whole pages of what was freed.
        let heap = unsafe {
            libc::malloc_trim(0);
            libc::mallinfo2()
        };
        let count = |folder: &str| std::fs::read_dir(folder).expect("a process to look at").count();
        let pages = std::fs::read_to_string("/proc/self/statm").expect("a process to look at");
        let pages: usize = pages.split(' ').nth(1).expect("resident pages").parse().expect("a number");
        let allocated = heap.uordblks + heap.hblkhd;
        Self { allocated, resident: pages * 4096, threads: count("/proc/self/task"), files: count("/proc/self/fd") }
    }
}

/// Many windows come and go while another thread plays.
fn while_it_plays(desk: &TestDisplay, format: Format) {
    let cycles = rounds(CYCLES.0, CYCLES.1);
    let mut live = instance(format, desk.folder());
    let is_over = AtomicBool::new(false);
    let (plugin, player) = live.halves();
    let began = Instant::now();
    let (settled, at_last) = thread::scope(|scope| {
        scope.spawn(|| play_until(player, &is_over));
        let mut settled = None;
        for cycle in 1..=cycles {
            match cycle % 4 {
                // Some are seen, others gone before they have drawn.
                0 => desk.open_drawn(plugin, || {}).close(plugin),
                rest => {
                    let mut window = desk.open(plugin);
                    window.run_for(plugin, Duration::from_millis(15 * (rest as u64 - 1)));
                    window.close(plugin);
                }
            }
            if cycle == SETTLED {
                settled = Some(quiet(plugin));
            }
        }
        let at_last = quiet(plugin);
        is_over.store(true, Ordering::Relaxed);
        (settled.expect("enough cycles"), at_last)
    });
    println!(
        "figure: {format}, {cycles} cycles in {:.1} s: {settled:?}, then {at_last:?}",
        began.elapsed().as_secs_f64()
    );
    let grown = at_last.allocated.saturating_sub(settled.allocated);
    assert!(grown < GROWTH, "{format}: {grown} bytes more after the last cycle: {settled:?}, {at_last:?}");
    let grown = at_last.resident.saturating_sub(settled.resident);
    assert!(grown < RESIDENT_GROWTH, "{format}: {grown} bytes larger after the last cycle: {settled:?}, {at_last:?}");
    assert!(at_last.threads <= settled.threads, "{format}: threads stay: {settled:?}, {at_last:?}");
    assert!(at_last.files <= settled.files, "{format}: files stay open: {settled:?}, {at_last:?}");
    live.stop();
}

/// What is held when windows that were closed have ended: baseview 0.4.2 does not always wait for their threads.
fn quiet(plugin: &mut dyn Plugin) -> Holdings {
    let mut last = Holdings::now();
    let mut since = Instant::now();
    let began = since;
    while since.elapsed() < Duration::from_millis(500) && began.elapsed() < PATIENCE {
        thread::sleep(Duration::from_millis(20));
        plugin.run_callbacks();
        let now = Holdings::now();
        if (now.threads, now.files) != (last.threads, last.files) {
            since = Instant::now();
        }
        last = now;
    }
    last
}

/// Two instances of one bundle with their windows open, each drawn, each with its own values.
fn two_at_once(desk: &TestDisplay, format: Format) {
    let mut lives = [instance(format, desk.folder()), instance(format, desk.folder())];
    let input = flame(83, 2, 1024);
    let mut position = 0;
    let mut windows: Vec<EditorWindow> = Vec::new();
    for live in &mut lives {
        windows.push(desk.open(live.plugin()));
    }
    set(lives[1].plugin(), "alpha", "5");
    let mut pass = |lives: &mut [Live], windows: &mut [EditorWindow]| {
        for (live, window) in lives.iter_mut().zip(windows) {
            live.play(&input, Clock::Playing(position), 512);
            window.run_for(live.plugin(), Duration::from_millis(5));
        }
        position += 1024;
    };
    for shown in [0, 1, 0] {
        windows[shown].raise().unwrap_or_else(|error| panic!("{error}"));
        let began = Instant::now();
        loop {
            pass(&mut lives, &mut windows);
            if Picture::of_window(&windows[shown]).is_drawn() {
                break;
            }
            assert!(began.elapsed() < PATIENCE, "{format}: window {shown} of two is not drawn");
        }
    }
    TestDisplay::screenshot(&windows[0], &format!("{format}-one-of-two"));
    let values =
        lives.each_mut().map(|live| live.plugin().value(pyrophone_host::numeric_id("alpha")).expect("a value"));
    assert!(values[1] > values[0], "{format}: {values:?}");
    // The second goes on without the first.
    let [mut first, mut second] = lives;
    let [window, mut other] = <[EditorWindow; 2]>::try_from(windows).unwrap_or_else(|_| panic!("two windows"));
    window.close(first.plugin());
    drop(first.stop());
    let _ = other.raise();
    let frames = desk.map().map_or(0, |map| map.frames);
    let began = Instant::now();
    while desk.map().map_or(0, |map| map.frames) < frames + 3 {
        second.play(&input, Clock::Playing(0), 512);
        other.run_for(second.plugin(), Duration::from_millis(20));
        assert!(began.elapsed() < PATIENCE, "{format}: the window that is left draws no more");
    }
    other.close(second.plugin());
}

/// Plugin, editor and window go in any order a host can think of.
fn gone_with_their_editors(desk: &TestDisplay, format: Format) {
    let seen = |live: &mut Live, is_drawn: bool| {
        let (plugin, player) = live.halves();
        let input = flame(84, 2, 2048);
        let mut play = || {
            player.play(&input, Clock::Absent, 512);
        };
        if is_drawn {
            return desk.open_drawn(plugin, play);
        }
        let window = desk.open(plugin);
        play();
        window
    };
    for is_drawn in [true, false] {
        // The plugin before the window around its editor.
        let mut live = instance(format, desk.folder());
        let window = seen(&mut live, is_drawn);
        drop(live.stop());
        drop(window);

        // The window before the editor, and that before the plugin, which goes on meanwhile.
        let mut live = instance(format, desk.folder());
        let mut window = seen(&mut live, is_drawn);
        window.destroy_window().unwrap_or_else(|error| panic!("{error}"));
        let input = flame(85, 2, 2048);
        for _ in 0..10 {
            live.play(&input, Clock::Absent, 512);
            window.run_for(live.plugin(), Duration::from_millis(20));
        }
        window.close(live.plugin());
        // It can be opened again.
        let window = seen(&mut live, true);
        // The window before the plugin, and the editor with that.
        window.destroy_window().unwrap_or_else(|error| panic!("{error}"));
        drop(live.stop());

        // The plugin alone, whose host never closes the editor.
        let mut live = instance(format, desk.folder());
        let window = seen(&mut live, is_drawn);
        let mut plugin = live.stop();
        plugin.forget_editor();
        drop(plugin);
        drop(window);
    }
}
