//! Learned distributions, and speed fields.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use nice_plug::prelude::Params;
use pyrophone::loader::link::Update;
use pyrophone_settings::session::{FieldReference, RecordingReference};
use pyrophone_settings::{Session, session};
use pyrophone_synthesis::vortex::{End, SpeedField};

use super::{Instance, RATE_HZ, Sounds};

#[test]
fn a_pass_is_learned_and_belongs_to_its_rate() {
    let mut instance = Instance::running();
    let shared = instance.link.shared.clone();
    shared.learning.store(true, Ordering::Relaxed);
    instance.wait_for("learning", |view| view.learning.is_some());
    instance.link.send_magnitudes(&[0.3, 0.1, 0.2]);
    shared.learning.store(false, Ordering::Relaxed);
    instance.wait_for("the end of learning", |view| view.learning.is_none());
    let distribution = |instance: &mut Instance| {
        let mut last = None;
        while let Some(update) = instance.link.receive() {
            if let Update::Distribution(distribution) = update {
                last = Some(distribution);
            }
        }
        last
    };
    instance.activate(RATE_HZ);
    let expected = [0.1, 0.2, 0.3];
    assert_eq!(distribution(&mut instance).unwrap().unwrap().quantiles(), expected);
    let learned = instance.saved().learned.unwrap();
    assert_eq!((learned.sample_rate_hz, learned.levels, learned.quantiles.as_slice()), (RATE_HZ, 6, &expected[..]));
    instance.activate(48_000.0);
    assert!(distribution(&mut instance).unwrap().is_none(), "it does not hold at another rate");
    assert!(instance.view().learned.unwrap().contains("learn again"));
    instance.activate(RATE_HZ);
    assert!(distribution(&mut instance).unwrap().is_some());
    instance.loader.handle().forget_learned();
    instance.wait_for("forgetting", |view| view.learned.is_none());
    assert_eq!(instance.saved().learned, None);
}

#[test]
fn a_drive_is_learned_from_a_file() {
    let sounds = Sounds::new();
    let path = sounds.wav("drive.wav", 1.5, 71);
    let mut instance = Instance::running();
    instance.loader.handle().learn_from(path.clone());
    instance.wait_for("a learned drive", |view| view.learned.is_some());
    let values = instance.params.values();
    let sound = pyrophone_recording::decode(&path, &|_| true).unwrap().channels;
    let expected = pyrophone_synthesis::chain::learn(RATE_HZ, &values.structure(), &values.controls(), &sound, &[]);
    assert_eq!(instance.distribution().unwrap().unwrap().quantiles(), expected.unwrap().quantiles());
    let saved = instance.saved().learned.unwrap();
    assert_eq!((saved.sample_rate_hz, saved.companded), (RATE_HZ, true));
    assert_eq!(instance.view().amplitudes[1].as_ref().map(|shown| shown.len()), Some(65));
    instance.loader.handle().learn_from("/no/such/drive.wav".into());
    instance.wait_for("a message", |view| view.error.as_ref().is_some_and(|error| error.contains("drive.wav")));
    assert_eq!(instance.saved().learned.unwrap(), saved, "what was learned before stays");
}

#[test]
fn a_speed_field_is_loaded_kept_in_the_session_and_taken_away() {
    let sounds = Sounds::new();
    let mut instance = Instance::running();
    let field =
        |speed: f32| SpeedField::new(30.0, 2, vec![[0.0; 3]; 2], vec![speed; 60], End::Clamped).unwrap().to_bytes();
    let path = sounds.0.path().join("torch.field");
    std::fs::write(&path, field(3.0)).unwrap();
    let loader = instance.loader.handle();
    loader.load_field(path.clone());
    let shown = instance.wait_for("the field", |view| view.field.is_some()).field.unwrap();
    assert_eq!(shown, "torch.field: 1.0 s, 2 sources");
    instance.activate(RATE_HZ);
    let saved = instance.saved();
    assert_eq!(saved.field.as_ref().unwrap().bytes, field(3.0));
    let speed = |field: Option<Option<Arc<SpeedField>>>| field.unwrap().map(|field| field.speeds()[0]);
    assert_eq!(speed(instance.field()), Some(3.0));
    // What is no field is named, and the old one stays.
    for (name, bytes) in
        [("empty.field", vec![]), ("cut.field", field(4.0)[..50].to_vec()), ("big.field", vec![0; 5 << 20])]
    {
        let path = sounds.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        loader.load_field(path);
        let view = instance.wait_for(name, |view| view.error.as_ref().is_some_and(|error| error.contains(name)));
        assert!(view.field.is_some());
    }
    loader.load_field("/no/such/lost.field".into());
    instance.wait_for("the missing one", |view| view.error.as_ref().is_some_and(|error| error.contains("lost.field")));
    assert_eq!(instance.saved(), saved);
    // The session alone brings it back, wherever its file is.
    std::fs::remove_file(&path).unwrap();
    let mut other = Instance::running();
    other.load_session(&saved);
    assert_eq!(speed(other.field()), Some(3.0));
    assert_eq!(other.saved(), saved);
    // Also where the session's recording is taken away before it is there.
    let recording = RecordingReference {
        path: sounds.wav("long.wav", 5.0, 9).to_string_lossy().into_owned(),
        content_hash: "34".repeat(32),
        embedded: None,
    };
    let with_both = Session { recording: Some(recording), ..saved.clone() };
    let mut third = Instance::running();
    let field_text = serde_json::to_string(&with_both.to_json()).unwrap();
    third.params.deserialize_fields(&[(session::FIELD.to_owned(), field_text)].into());
    third.loader.handle().unload();
    third.activate(RATE_HZ);
    assert_eq!(speed(third.field()), Some(3.0));
    other.loader.handle().unload_field();
    other.wait_for("no field", |view| view.field.is_none());
    other.activate(RATE_HZ);
    assert_eq!((other.saved().field, speed(other.field())), (None, None));
    // A damaged one in a session is told, and the rest of the session holds.
    let damaged = Session { field: Some(FieldReference { path: "x.field".into(), bytes: vec![1, 2] }), ..saved };
    other.load_session(&damaged);
    assert!(other.view().error.unwrap().contains("speed field"));
}
