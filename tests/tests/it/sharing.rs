//! Instances that share a recording, recordings exchanged in mid-play, sessions loaded in mid-play.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use pyrophone_host::bounce::BounceOptions;
use pyrophone_host::{Format, Plugin};
use pyrophone_settings::Session;
use pyrophone_tests::live::{Clock, Live};
use pyrophone_tests::{
    RATE_HZ, STEREO, assert_same, assert_sounds, await_recording, flame, load_session, one_sided_recording, open, peak,
    play, preset, recording, session, wait_until,
};

const BLOCK: usize = 512;

fn loaded(format: Format, preset_name: &str, path: &Path) -> Box<dyn Plugin> {
    let mut plugin = open(format);
    load_session(plugin.as_mut(), &preset(preset_name, &[]), &session(Some(path), None));
    await_recording(plugin.as_mut(), RATE_HZ, STEREO);
    plugin
}

#[test]
fn instances_that_share_a_recording_sound_as_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = recording(folder.path(), "shared.wav", 2, 60_000);
    let input = flame(31, 2, 60_000);
    for format in Format::ALL {
        let alone = {
            let mut plugin = loaded(format, "default", &path);
            play(plugin.as_mut(), &input, &BounceOptions::new(RATE_HZ, STEREO))
        };
        // All live at once and play at the same time.
        let mut lives: Vec<Live> =
            (0..3).map(|_| Live::start(loaded(format, "default", &path), RATE_HZ, STEREO)).collect();
        let latency = lives[0].plugin().latency_samples() as usize;
        let outputs: Vec<_> = thread::scope(|scope| {
            let players: Vec<_> = lives
                .iter_mut()
                .map(|live| {
                    let (_, player) = live.halves();
                    let input = &input;
                    scope.spawn(move || player.play(input, Clock::Playing(0), BLOCK))
                })
                .collect();
            players.into_iter().map(|player| player.join().expect("the player lives")).collect()
        });
        let samples = input[0].len() - latency;
        let expected = pyrophone_tests::part(&alone, 0..samples);
        for (index, output) in outputs.iter().enumerate() {
            let aligned = pyrophone_tests::part(output, latency..input[0].len());
            assert_same(&aligned, &expected, &format!("{format}, instance {index}"));
        }
        // When the others go, the last one plays on.
        let mut last = lives.pop().expect("an instance");
        lives.into_iter().for_each(|live| drop(live.stop()));
        let output = last.play(&input, Clock::Playing(60_000), BLOCK);
        assert_sounds(&output, 6000, &format!("{format}, the last one"));
        drop(last.stop());
    }
}

#[test]
fn one_may_change_its_recording_without_the_others_hearing_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let left = one_sided_recording(folder.path(), "left.wav", 0, 60_000);
    let right = one_sided_recording(folder.path(), "right.wav", 1, 60_000);
    let input = flame(32, 2, 40_000);
    for format in Format::ALL {
        let mut keeps = loaded(format, "texture", &left);
        let mut changes = loaded(format, "texture", &left);
        let options = BounceOptions::new(RATE_HZ, STEREO);
        let before = play(keeps.as_mut(), &input, &options);
        load_session(changes.as_mut(), &preset("texture", &[]), &session(Some(&right), None));
        await_recording(changes.as_mut(), RATE_HZ, STEREO);
        let changed = play(changes.as_mut(), &input, &options);
        assert_eq!((peak(&changed[0]), peak(&before[1])), (0.0, 0.0), "{format}");
        assert!(peak(&changed[1]) > 1e-3, "{format}");
        let after = play(keeps.as_mut(), &input, &options);
        assert_same(&after[..1], &before[..1], &format!("{format}"));
    }
}

#[test]
fn a_recording_exchanged_in_mid_play() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // Long enough for the index to take a while.
    let left = one_sided_recording(folder.path(), "left.wav", 0, 400_000);
    let right = one_sided_recording(folder.path(), "right.wav", 1, 400_000);
    let input = flame(33, 2, 4096);
    for format in Format::ALL {
        let mut live = Live::start(loaded(format, "texture", &left), RATE_HZ, STEREO);
        let mut position = 0;
        let mut blocks = 0;
        let mut next = |live: &mut Live| {
            let output = live.play(&input, Clock::Playing(position), BLOCK);
            position += 4096;
            blocks += 1;
            let sides = [peak(&output[0]), peak(&output[1])];
            let loudest = sides[0].max(sides[1]);
            assert!(loudest < 100.0, "{format}: {sides:?}");
            // Once the latency is over there is sound in every stretch, whichever recording it is from.
            assert!(blocks <= 3 || loudest > 1e-5, "{format}: silent in stretch {blocks}");
            sides
        };
        for _ in 0..10 {
            next(&mut live);
        }
        for (path, side) in [(&right, 1), (&left, 0), (&right, 1)] {
            let is_heard = |sides: [f32; 2]| sides[side] > 1e-4 && sides[1 - side] == 0.0;
            assert!(!is_heard(next(&mut live)), "{format}: the old recording is still heard");
            load_session(live.plugin(), &preset("texture", &[]), &session(Some(path), None));
            wait_until(&format!("{format}: {}", path.display()), || is_heard(next(&mut live)));
        }
        drop(live.stop());
    }
}

#[test]
fn a_thousand_sessions_loaded_in_mid_play() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let left = one_sided_recording(folder.path(), "left.wav", 0, 30_000);
    let right = one_sided_recording(folder.path(), "right.wav", 1, 30_000);
    let sessions: [Session; 3] = [session(Some(&left), None), session(None, None), session(Some(&right), None)];
    let presets = [
        ("default", "alpha", "4"),
        ("texture", "gate", "off"),
        ("extend", "low_level", "-6"),
        ("texture", "quality", "draft"),
    ];
    let input = flame(34, 2, 4096);
    for format in Format::ALL {
        let mut live = Live::start(loaded(format, "texture", &left), RATE_HZ, STEREO);
        let has_ended = AtomicBool::new(false);
        let (main, player) = live.halves();
        thread::scope(|scope| {
            let playing = scope.spawn(|| {
                let (mut stretches, mut loudest) = (0u32, 0.0f32);
                while !has_ended.load(Ordering::Acquire) {
                    let position = i64::from(stretches) * 4096;
                    let output = player.play(&input, Clock::Playing(position), 64 + stretches as usize % 500);
                    loudest = output.iter().fold(loudest, |loudest, channel| loudest.max(peak(channel)));
                    stretches += 1;
                }
                (stretches, loudest)
            });
            for turn in 0..1000 {
                let (name, id, text) = presets[turn % presets.len()];
                load_session(main, &preset(name, &[(id, text)]), &sessions[turn % sessions.len()]);
                if turn % 50 == 0 {
                    let saved = main.state().expect("a state");
                    main.set_state(&saved).expect("its own state");
                }
                main.run_callbacks();
            }
            has_ended.store(true, Ordering::Release);
            let (stretches, loudest) = playing.join().expect("the player lives");
            println!("{format}: 1000 sessions during {stretches} stretches of 4096 samples, peak {loudest}");
            assert!(stretches > 3 && loudest > 1e-4 && loudest < 100.0, "{format}: {stretches}, {loudest}");
        });
        // The last one counts.
        load_session(live.plugin(), &preset("texture", &[]), &sessions[2]);
        let mut plugin = live.stop();
        await_recording(plugin.as_mut(), RATE_HZ, STEREO);
        let options = BounceOptions::new(RATE_HZ, STEREO);
        let input = flame(35, 2, 30_000);
        let output = play(plugin.as_mut(), &input, &options);
        let mut fresh = loaded(format, "texture", &right);
        assert_same(&output[1..], &play(fresh.as_mut(), &input, &options)[1..], &format!("{format}"));
        assert_eq!(peak(&output[0]), 0.0);
    }
}
