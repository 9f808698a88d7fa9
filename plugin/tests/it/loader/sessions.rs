//! Sessions: saved, restored, damaged.

use std::time::{Duration, Instant};

use nice_plug::prelude::Params;
use pyrophone_settings::session::{Learned, RecordingReference};
use pyrophone_settings::{Recent, Session, session};

use super::{Instance, RATE_HZ, Sounds};

#[test]
fn session_is_restored_with_its_recording() {
    let sounds = Sounds::new();
    let path = sounds.wav("session.wav", 0.5, 21);
    let first = Instance::running();
    first.loader.handle().set_embed(true);
    first.load_and_wait(&path);
    let saved = first.saved();
    assert!(saved.embed && saved.recording.as_ref().unwrap().embedded.is_some());
    std::fs::remove_file(&path).unwrap();
    // The file is gone, but the session holds it.
    let mut second = Instance::new();
    second.load_session(&saved);
    assert!(second.dictionary().unwrap().is_some());
    assert_eq!((second.view().error, second.saved()), (None, saved.clone()));
    second.loader.handle().set_embed(false);
    let began = Instant::now();
    while second.saved().recording.unwrap().embedded.is_some() {
        assert!(began.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_missing_recording_is_named_and_the_session_saved_unharmed() {
    let sounds = Sounds::new();
    let mut instance = Instance::running();
    instance.load_and_wait(&sounds.wav("old.wav", 0.5, 31));
    let session = Session {
        recording: Some(RecordingReference {
            path: "/no/such/folder/lost.wav".into(),
            content_hash: "12".repeat(32),
            embedded: None,
        }),
        embed: true,
        learned: Some(Learned { sample_rate_hz: RATE_HZ, levels: 6, companded: true, quantiles: vec![0.0, 0.5, 1.0] }),
        ..Session::default()
    };
    instance.load_session(&session);
    let view = instance.view();
    assert!(view.error.unwrap().contains("/no/such/folder/lost.wav"));
    assert_eq!((view.recording, view.path.as_deref()), (None, Some("/no/such/folder/lost.wav")));
    assert!(instance.dictionary().unwrap().is_none(), "extension plays alone");
    assert_eq!(instance.saved(), session);
    // The user points to its new place.
    instance.load_and_wait(&sounds.wav("found.wav", 0.5, 32));
    let saved = instance.saved();
    assert!(saved.recording.unwrap().path.ends_with("found.wav"));
    assert_eq!(saved.learned, session.learned);
}

#[test]
fn a_changed_file_plays_with_a_warning() {
    let sounds = Sounds::new();
    let path = sounds.wav("changed.wav", 0.5, 41);
    let first = Instance::running();
    first.load_and_wait(&path);
    let saved = first.saved();
    sounds.wav("changed.wav", 0.6, 42);
    let mut second = Instance::new();
    second.load_session(&saved);
    assert!(second.view().error.unwrap().contains("changed"));
    assert!((second.dictionary().unwrap().unwrap().windows().seconds() - 0.6).abs() < 1e-3);
    assert_eq!(second.saved(), saved);
}

#[test]
fn bad_sessions_leave_the_sound_and_say_why() {
    let sounds = Sounds::new();
    let mut instance = Instance::running();
    instance.load_and_wait(&sounds.wav("stays.wav", 0.5, 51));
    instance.activate(RATE_HZ);
    instance.dictionary();
    let saved = instance.saved();
    let good = saved.to_json();
    let texts = [
        String::new(),
        "x".into(),
        "null".into(),
        "true".into(),
        "0".into(),
        "[]".into(),
        "{}".into(),
        "\"\"".into(),
        "{\"version\":null}".into(),
        "{\"version\":\"1\"}".into(),
        "{\"version\":0}".into(),
        "{\"version\":1,\"recording\":7}".into(),
        "{\"version\":1,\"recording\":{}}".into(),
        "{\"version\":1,\"learned\":{\"levels\":6}}".into(),
        "{\"version\":1,\"learned\":{\"levels\":6,\"sample_rate_hz\":44100,\"quantiles\":\"??\"}}".into(),
        "{\"version\":1,\"learned\":{\"levels\":6,\"sample_rate_hz\":44100,\"quantiles\":\"\"}}".into(),
        good[..good.len() - 3].to_owned(),
        good.replace(':', ";"),
        "[".repeat(100_000),
        format!("{{\"version\":1,\"embed\":\"{}\"}}", "é\u{1F525}".repeat(1000)),
    ];
    assert_eq!(texts.len(), 20);
    let mut fields: Vec<String> = texts.iter().map(|text| serde_json::to_string(text).unwrap()).collect();
    fields.extend(["".into(), "{".into(), "7".into(), "\"\\ud800\"".into()]);
    for field in fields {
        instance.loader.handle().status.update(|view| view.error = None);
        instance.load_field(&field);
        let message = instance.view().error.unwrap_or_else(|| panic!("no message for {field:.60}"));
        assert_eq!(message.lines().count(), 1, "{message}");
        let dictionary = instance.dictionary();
        assert!(dictionary.is_none_or(|dictionary| dictionary.is_some()), "the sound goes on after {field:.60}");
        assert!(instance.view().recording.unwrap().starts_with("stays.wav"));
        if !message.contains("newer") {
            assert_eq!(instance.saved(), saved, "after {field:.60}");
        }
    }
    // A later version's session is kept for saving as it is.
    let later = "\"{\\\"version\\\":99,\\\"magic\\\":1}\"";
    instance.load_field(later);
    assert!(instance.view().error.unwrap().contains("newer Pyrophone"));
    assert_eq!(instance.params.serialize_fields()[session::FIELD], later);
}

#[test]
fn recordings_that_were_loaded_are_listed_for_all_instances() {
    let sounds = Sounds::new();
    let recent = Recent::new(&sounds.0.path().join("settings"));
    let first = Instance::with_recent(Some(recent.clone()));
    for name in ["a.wav", "b.wav"] {
        first.load_and_wait(&sounds.wav(name, 0.5, 91));
    }
    first.wait_for("a list", |view| view.recent.len() == 2 && view.recent[0].ends_with("b.wav"));
    let second = Instance::with_recent(Some(recent));
    second.wait_for("the same list", |view| view.recent.len() == 2 && view.recent[1].ends_with("a.wav"));
}
