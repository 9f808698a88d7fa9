//! Instances come and go, under automation and with loads under way, and the host survives.

use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use pyrophone_host::bounce::{AutomationPoint, BlockSize, BounceOptions};
use pyrophone_host::{Configuration, Format, numeric_id};
use pyrophone_tests::live::{Clock, Live};
use pyrophone_tests::{
    MONO, RATE_HZ, STEREO, assert_same, assert_sounds, await_recording, flame, in_a_process_of_its_own, load_session,
    open, part, peak, play, preset, recording, rounds, session, set,
};

fn recordings(folder: &Path, count: usize, samples: usize) -> Vec<PathBuf> {
    (0..count).map(|number| recording(folder, &format!("{number}.wav"), 1, samples + number)).collect()
}

/// Creates `size` instances, plays each on a thread of its own with automation while the main thread changes parameters
/// and starts loads in some, and destroys them together.
fn group(format: Format, size: usize, round: usize, recordings: &[PathBuf]) {
    let input = flame(round as u64, 1, 64 * 60);
    let values = preset("default", &[]);
    let mut lives: Vec<Live> = (0..size).map(|_| Live::start(open(format), RATE_HZ, MONO)).collect();
    let automation: Vec<AutomationPoint> = (0..120)
        .map(|step| {
            let id = numeric_id(["alpha", "texture_level", "scaling_alpha", "cutoff"][step % 4]);
            AutomationPoint { sample: 32 * step as i64 + 5, id, value: ((step * 7 + round) % 13) as f64 / 12.0 }
        })
        .collect();
    thread::scope(|scope| {
        let mut mains = Vec::new();
        let mut players = Vec::new();
        for live in &mut lives {
            let (main, player) = live.halves();
            mains.push(main);
            let (input, automation) = (&input, &automation);
            players.push(scope.spawn(move || player.play_automated(input, Clock::Playing(0), 64, automation)));
        }
        for (index, main) in mains.iter_mut().enumerate() {
            if (round + index).is_multiple_of(3) {
                let path = &recordings[(round + index) % recordings.len()];
                load_session(*main, &values, &session(Some(path), None));
            }
            set(*main, "release", "100");
            main.run_callbacks();
        }
        for player in players {
            let output = player.join().expect("the player lives");
            assert!(peak(&output[0]).is_finite(), "{format}, round {round}");
        }
    });
    match round % 3 {
        // Each goes as soon as it is inactive: nothing gives the framework's thread time to finish with it.
        0 | 1 => lives.into_iter().for_each(|live| drop(live.stop())),
        _ => drop(lives.into_iter().map(Live::stop).collect::<Vec<_>>()),
    }
}

#[test]
fn clap_instances_come_and_go() {
    in_a_process_of_its_own("lifecycle::clap_instances_come_and_go", &[], || instances_come_and_go(Format::Clap));
}

#[test]
fn vst3_instances_come_and_go() {
    in_a_process_of_its_own("lifecycle::vst3_instances_come_and_go", &[], || instances_come_and_go(Format::Vst3));
}

fn instances_come_and_go(format: Format) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let recordings = recordings(folder.path(), 4, 80_000);
    for round in 0..rounds(12, 60) {
        group(format, 5, round, &recordings);
    }
    // The process is still there, and so is the sound.
    let mut plugin = open(format);
    let output = play(plugin.as_mut(), &flame(1, 1, 20_000), &BounceOptions::new(RATE_HZ, MONO));
    assert_sounds(&part(&output, 2000..20_000), 2000, "after all");
}

#[test]
fn every_activation_starts_afresh() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = recording(folder.path(), "fire.wav", 2, 20_000);
    let rates = [44_100.0, 48_000.0, 96_000.0];
    for format in Format::ALL {
        let mut plugin = open(format);
        load_session(plugin.as_mut(), &preset("default", &[]), &session(Some(&path), None));
        let mut first: Vec<Option<Vec<Vec<f32>>>> = vec![None; 6];
        for cycle in 0..rounds(8, 30) {
            let (rate, layout) = (rates[cycle % 3], [MONO, STEREO][cycle % 2]);
            let input = flame(3, layout.input as usize, 15_000);
            let blocks = BlockSize::Fixed([64, 4096, 333, 1000][cycle % 4]);
            let options = BounceOptions { block: blocks, ..BounceOptions::new(rate, layout) };
            let output = play(plugin.as_mut(), &input, &options);
            let known = &mut first[cycle % 6];
            match known {
                Some(known) => assert_same(&output, known, &format!("{format}, cycle {cycle}")),
                None => *known = Some(output),
            }
        }
    }
}

#[test]
fn idle_activations_do_no_harm() {
    for format in Format::ALL {
        let mut plugin = open(format);
        for cycle in 0..rounds(8, 60) {
            let sample_rate = [44_100.0, 96_000.0, 8_000.0, 192_000.0][cycle % 4];
            let configuration =
                Configuration { sample_rate, max_block: 1 + cycle * 100, layout: STEREO, offline: false };
            let mut processor = plugin.activate(&configuration).expect("active");
            if cycle % 2 == 0 {
                processor.start().expect("started");
            }
            if cycle % 3 == 0 {
                processor.stop();
            }
            plugin.run_callbacks();
            plugin.deactivate(processor).expect("inactive");
        }
        let output = play(plugin.as_mut(), &flame(1, 2, 20_000), &BounceOptions::new(RATE_HZ, STEREO));
        assert_sounds(&part(&output, 2000..20_000), 2000, "after all");
    }
}

#[test]
fn the_recording_follows_the_sample_rate() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = recording(folder.path(), "fire.wav", 1, 60_000);
    let values = preset("texture", &[]);
    for format in Format::ALL {
        let mut plugin = open(format);
        load_session(plugin.as_mut(), &values, &session(Some(&path), None));
        for rate in [44_100.0, 96_000.0, 48_000.0, 44_100.0] {
            let input = flame(4, 1, rate as usize);
            let options = BounceOptions { offline: false, ..BounceOptions::new(rate, MONO) };
            await_recording(plugin.as_mut(), rate, MONO);
            let output = play(plugin.as_mut(), &input, &options);
            assert_sounds(&part(&output, 8000..input[0].len()), 8000, &format!("{format} at {rate} Hz"));
            let mut fresh = open(format);
            load_session(fresh.as_mut(), &values, &session(Some(&path), None));
            await_recording(fresh.as_mut(), rate, MONO);
            assert_same(&output, &play(fresh.as_mut(), &input, &options), &format!("{format} at {rate} Hz"));
        }
    }
}

#[test]
fn a_rate_changed_while_loading_gets_its_own_dictionary() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = recording(folder.path(), "fire.wav", 1, 300_000);
    for format in Format::ALL {
        let mut live = Live::start(open(format), 44_100.0, MONO);
        load_session(live.plugin(), &preset("texture", &[]), &session(Some(&path), None));
        // Not waited for: the load is called off by the next rate.
        let mut plugin = live.stop();
        let options = BounceOptions::new(96_000.0, MONO);
        let output = play(plugin.as_mut(), &flame(5, 1, 60_000), &options);
        assert_sounds(&part(&output, 10_000..60_000), 10_000, &format!("{format}"));
    }
}

#[test]
fn destroyed_while_loading() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let recordings = recordings(folder.path(), 3, 500_000);
    for format in Format::ALL {
        for round in 0..rounds(12, 45) as u64 {
            let path = &recordings[round as usize % 3];
            let session = session(Some(path), None);
            let mut plugin = open(format);
            match round % 3 {
                // Never active.
                0 => load_session(plugin.as_mut(), &preset("default", &[]), &session),
                // Active once, inactive when it goes.
                1 => {
                    let mut live = Live::start(plugin, RATE_HZ, MONO);
                    load_session(live.plugin(), &preset("default", &[]), &session);
                    thread::sleep(Duration::from_millis(3 * round));
                    plugin = live.stop();
                }
                // Another load supersedes the first.
                _ => {
                    let mut live = Live::start(plugin, RATE_HZ, MONO);
                    load_session(live.plugin(), &preset("default", &[]), &session);
                    let other = &recordings[(round as usize + 1) % 3];
                    load_session(live.plugin(), &preset("texture", &[]), &pyrophone_tests::session(Some(other), None));
                    thread::sleep(Duration::from_millis(3 * round));
                    plugin = live.stop();
                }
            }
            drop(plugin);
        }
    }
}
