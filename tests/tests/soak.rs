//! The long ones: `cargo xtask soak`, or `PYROPHONE_SOAK=1`.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use pyrophone_host::bounce::{AutomationPoint, BounceOptions};
use pyrophone_host::{Format, numeric_id};
use pyrophone_settings::PARAMETERS;
use pyrophone_tests::live::{Clock, Live};
use pyrophone_tests::signals::Random;
use pyrophone_tests::skip::skip;
use pyrophone_tests::{
    MONO, RATE_HZ, STEREO, assert_same, await_recording, flame, load_session, open, peak, play, preset, recording,
    session,
};

fn is_wanted() -> bool {
    let is_wanted = pyrophone_tests::is_soak();
    if !is_wanted {
        skip("set PYROPHONE_SOAK=1");
    }
    is_wanted
}

/// Automation of every parameter that can be, at random.
fn automation(random: &mut Random, samples: usize) -> Vec<AutomationPoint> {
    let automatable: Vec<&str> =
        PARAMETERS.iter().filter(|parameter| parameter.automatable).map(|parameter| parameter.id).collect();
    let mut points: Vec<AutomationPoint> = (0..random.below(40))
        .map(|_| {
            let id = automatable[random.below(automatable.len())];
            // Exact search may take longer than the sound; it is chosen now and then.
            let highest = if id == "quality" && random.below(20) > 0 { 0.6 } else { 1.0 };
            AutomationPoint { sample: random.below(samples) as i64, id: numeric_id(id), value: highest * random.unit() }
        })
        .collect();
    points.sort_by_key(|point| point.sample);
    points
}

/// Ten minutes of sound that jumps, loops and stops, every parameter automated, sessions loaded meanwhile.
#[test]
fn ten_minutes_of_jumps_with_random_automation() {
    if !is_wanted() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let recordings: Vec<PathBuf> =
        (0..3).map(|index| recording(folder.path(), &format!("{index}.wav"), 2, 60_000 + index)).collect();
    for format in Format::ALL {
        let mut plugin = open(format);
        load_session(plugin.as_mut(), &preset("default", &[]), &session(Some(&recordings[0]), None));
        await_recording(plugin.as_mut(), RATE_HZ, STEREO);
        let mut live = Live::start(plugin, RATE_HZ, STEREO);
        let has_ended = AtomicBool::new(false);
        let (main, player) = live.halves();
        thread::scope(|scope| {
            let playing = scope.spawn(|| {
                let mut random = Random::new(91);
                let input = flame(92, 2, 30_000);
                let (mut played, mut position, mut loudest) = (0, 0i64, 0.0f32);
                while played < 600 * RATE_HZ as usize {
                    let samples = 1 + random.below(30_000);
                    let piece = pyrophone_tests::part(&input, 0..samples);
                    match random.below(4) {
                        0 => position = 0,
                        1 => position = random.below(2_000_000) as i64 - 1_000_000,
                        _ => {}
                    }
                    let clock = match random.below(8) {
                        0 => Clock::Stopped(position),
                        1 => Clock::Absent,
                        2 => Clock::WithoutTempo(position),
                        _ => Clock::Playing(position),
                    };
                    let block = 1 + random.below(2000);
                    let points = automation(&mut random, samples);
                    for channel in player.play_automated(&piece, clock, block, &points) {
                        loudest = loudest.max(peak(&channel));
                    }
                    assert!(loudest.is_finite(), "{format}: after {played} samples");
                    position += samples as i64;
                    played += samples;
                }
                has_ended.store(true, Ordering::Release);
                loudest
            });
            let mut turn = 0;
            while !has_ended.load(Ordering::Acquire) && !playing.is_finished() {
                turn += 1;
                let names = ["default", "texture", "extend"];
                let path = &recordings[turn % 3];
                load_session(main, &preset(names[turn % 3], &[]), &session((turn % 4 > 0).then_some(path), None));
                for _ in 0..50 {
                    main.run_callbacks();
                    thread::sleep(std::time::Duration::from_millis(10));
                }
            }
            let loudest = playing.join().expect("the player lives");
            println!("{format}: {turn} sessions, peak {loudest}");
            assert!(loudest > 1e-3, "{format}: silent");
        });
        // Nothing of it lingers.
        let mut worn = live.stop();
        let input = flame(93, 2, 40_000);
        let options = BounceOptions::new(RATE_HZ, STEREO);
        let mut outputs = [&mut worn, &mut open(format)].map(|plugin| {
            load_session(plugin.as_mut(), &preset("default", &[]), &session(Some(&recordings[1]), None));
            play(plugin.as_mut(), &input, &options)
        });
        let fresh = outputs[1].split_off(0);
        assert_same(&outputs[0], &fresh, &format!("{format}, worn"));
    }
}

#[test]
fn three_thousand_instances_come_and_go() {
    if !is_wanted() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let recordings: Vec<PathBuf> =
        (0..4).map(|index| recording(folder.path(), &format!("{index}.wav"), 1, 100_000 + index)).collect();
    for format in Format::ALL {
        for round in 0..500u64 {
            let input = flame(round, 1, 64 * 40);
            let size = 2 + round as usize % 9;
            let mut lives: Vec<Live> = (0..size).map(|_| Live::start(open(format), RATE_HZ, MONO)).collect();
            thread::scope(|scope| {
                for (index, live) in lives.iter_mut().enumerate() {
                    let (main, player) = live.halves();
                    let input = &input;
                    scope.spawn(move || {
                        let mut random = Random::new(round);
                        let points = automation(&mut random, 64 * 40);
                        player.play_automated(input, Clock::Playing(0), 64, &points)
                    });
                    if index % 2 == 0 {
                        let path = &recordings[(round as usize + index) % 4];
                        load_session(main, &preset("default", &[]), &session(Some(path), None));
                    }
                    main.run_callbacks();
                }
            });
            let mut plugins: Vec<_> = lives.into_iter().map(Live::stop).collect();
            while !plugins.is_empty() {
                drop(plugins.swap_remove((round as usize * 7) % plugins.len()));
            }
        }
    }
}
