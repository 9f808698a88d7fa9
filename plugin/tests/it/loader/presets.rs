//! Recordings that presets name: loaded with their part, undone, missing.

use std::time::{Duration, Instant};

use pyrophone_settings::PresetRecording;
use pyrophone_settings::session::{Cut, Slot};
use pyrophone_synthesis::recording::RecordingDictionary;

use super::{Instance, RATE_HZ, Sounds};

const PART: Cut = Cut { region_s: Some([0.25, 1.0]), gain_db: -3.0, normalise: false };

/// Length in seconds of the dictionary that arrives next at the engine, which keeps running.
fn arriving_s(instance: &mut Instance) -> Option<f64> {
    let began = Instant::now();
    loop {
        if let Some(found) = instance.dictionary() {
            return found.as_deref().map(RecordingDictionary::windows).map(|windows| windows.seconds());
        }
        assert!(began.elapsed() < Duration::from_secs(60), "no dictionary arrives");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn is_about(found_s: Option<f64>, expected_s: f64) -> bool {
    found_s.is_some_and(|found_s| (found_s - expected_s).abs() < 1e-3)
}

#[test]
fn a_recording_loaded_while_the_engine_runs_reaches_it() {
    let (sounds, mut instance) = (Sounds::new(), Instance::running());
    instance.load(&sounds.wav("first.wav", 0.5, 91));
    assert!(is_about(arriving_s(&mut instance), 0.5));
    instance.load(&sounds.wav("second.wav", 0.75, 92));
    assert!(is_about(arriving_s(&mut instance), 0.75));
}

#[test]
fn a_presets_recording_is_loaded_with_its_part_and_undone() {
    let (sounds, mut instance) = (Sounds::new(), Instance::running());
    let old = sounds.wav("old.wav", 0.5, 93);
    instance.load(&old);
    assert!(is_about(arriving_s(&mut instance), 0.5));
    let before = instance.saved();
    let file = sounds.wav("Öl, nah — 火.wav", 2.0, 94);
    let recording = PresetRecording { file: file.clone(), cut: PART };
    instance.loader.handle().load_preset(0, recording.clone());
    assert!(is_about(arriving_s(&mut instance), 0.75), "its part alone");
    let saved = instance.saved();
    assert_eq!((saved.recording.as_ref().unwrap().path.as_str(), saved.cut), (file.to_str().unwrap(), PART));
    // The same recording, all of it.
    instance.loader.handle().load_preset(0, PresetRecording { cut: Cut::default(), ..recording });
    assert!(is_about(arriving_s(&mut instance), 2.0));
    instance.loader.handle().restore(0, Slot { recording: before.recording.clone(), cut: before.cut });
    assert!(is_about(arriving_s(&mut instance), 0.5));
    assert_eq!(instance.saved(), before);
    // Another slot has its own.
    instance.loader.handle().load_preset(2, PresetRecording { file, cut: PART });
    instance.wait_for("the third slot", |view| view.slots[2].is_some());
    let saved = instance.saved();
    assert_eq!((saved.recording_in(0), saved.cut_in(2)), (before.recording_in(0), PART));
    instance.loader.handle().restore(2, Slot::default());
    instance.wait_for("an empty slot", |view| view.slots[2].is_none() && !view.is_named[2]);
    assert_eq!(instance.saved(), before);
}

#[test]
fn a_presets_missing_recording_is_said_and_the_present_one_stays() {
    let (sounds, mut instance) = (Sounds::new(), Instance::running());
    instance.load(&sounds.wav("present.wav", 0.5, 95));
    arriving_s(&mut instance);
    let saved = instance.saved();
    let file = sounds.0.path().join("gone.wav");
    instance.loader.handle().load_preset(0, PresetRecording { file, cut: PART });
    let view = instance.wait_for("a message", |view| view.error.is_some());
    let error = view.error.unwrap();
    assert!(error.contains("gone.wav: there is no such file") && error.contains("the present one stays"), "{error}");
    assert!(view.recording.unwrap().starts_with("present.wav"));
    assert_eq!((view.cut, instance.saved()), (saved.cut, saved));
    instance.activate(RATE_HZ);
    assert!(is_about(arriving_s(&mut instance), 0.5));
}
