//! Dictionaries: shared, for the rate and structure that run, of a part.

use std::sync::Arc;
use std::time::{Duration, Instant};

use nice_plug::prelude::Params;
use pyrophone::loader::Engine;
use pyrophone_settings::session::Cut;
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain::Channels;
use pyrophone_synthesis::recording::RecordingDictionary;

use super::{Instance, RATE_HZ, Sounds};

#[test]
fn instances_share_and_nothing_is_kept_after_the_last() {
    let sounds = Sounds::new();
    let path = sounds.wav("shared.wav", 0.7, 77);
    let (mut first, mut second) = (Instance::running(), Instance::running());
    first.load(&path);
    second.load(&path);
    let mut dictionaries: Vec<Arc<RecordingDictionary>> = Vec::new();
    for instance in [&mut first, &mut second] {
        instance.wait_for("shared", |view| view.recording.is_some() && view.progress.is_none());
        instance.activate(RATE_HZ);
        dictionaries.push(instance.dictionary().unwrap().unwrap());
    }
    assert!(Arc::ptr_eq(&dictionaries[0], &dictionaries[1]));
    let weak = Arc::downgrade(&dictionaries[0]);
    drop((dictionaries, first, second));
    assert!(weak.upgrade().is_none());
}

#[test]
fn a_dictionary_is_of_the_rate_that_runs() {
    let (sounds, mut instance) = (Sounds::new(), Instance::new());
    instance.load_and_wait(&sounds.wav("rate.wav", 0.5, 8));
    for rate_hz in [44_100.0, 96_000.0, 48_000.0] {
        instance.activate(rate_hz);
        let dictionary = instance.dictionary().unwrap().unwrap();
        assert_eq!(dictionary.windows().sample_rate_hz(), rate_hz);
        assert_eq!(dictionary.windows().shape().levels, EngineConfig::default().levels_at(rate_hz));
        assert!((dictionary.windows().seconds() - 0.5).abs() < 2e-3);
    }
}

#[test]
fn a_new_structure_is_prepared_before_the_restart() {
    let (sounds, mut instance) = (Sounds::new(), Instance::running());
    instance.load_and_wait(&sounds.wav("structure.wav", 0.5, 9));
    instance.activate(RATE_HZ);
    instance.dictionary();
    let map = instance.params.param_map();
    let (_, levels, _) = map.iter().find(|(id, _, _)| id == "levels").unwrap();
    // SAFETY: the parameters are alive.
    unsafe { levels._internal_set_normalized_value(levels.preview_normalized(5.0)) };
    let wanted = pyrophone::loader::link::fingerprint(&instance.params.values().structure());
    let began = Instant::now();
    while instance.link.shared.prepared_latency_samples(wanted).is_none() {
        assert!(began.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(instance.dictionary().is_none(), "the running engines keep theirs");
    instance.activate(RATE_HZ);
    assert_eq!(instance.dictionary().unwrap().unwrap().windows().shape().levels, 5);
}

#[test]
fn many_instances_come_and_go_with_loads_under_way() {
    let sounds = Sounds::new();
    let path = sounds.wav("busy.wav", 3.0, 61);
    for round in 0..40 {
        let instance = Instance::new();
        instance.load(&path);
        if round % 2 == 0 {
            let channels = Channels { input: 1, sidechain: 0, output: 1 };
            instance.loader.set_engine(Engine {
                sample_rate_hz: RATE_HZ,
                structure: EngineConfig::default(),
                channels,
            });
        }
        std::thread::sleep(Duration::from_millis(round % 7));
    }
}

#[test]
fn a_part_of_the_recording_is_learnt_from_and_kept() {
    let sounds = Sounds::new();
    let path = sounds.wav("long.wav", 2.0, 51);
    let mut first = Instance::running();
    first.load_and_wait(&path);
    first.activate(RATE_HZ);
    let whole = first.dictionary().unwrap().unwrap();
    assert!((whole.windows().seconds() - 2.0).abs() < 1e-3);
    let cut = Cut { region_s: Some([0.5, 1.25]), gain_db: -6.0, normalise: true };
    let loader = first.loader.handle();
    loader.set_cut(cut);
    first.activate(RATE_HZ);
    let part = first.dictionary().unwrap().unwrap();
    assert!((part.windows().seconds() - 0.75).abs() < 1e-3, "{}", part.windows().seconds());
    assert_eq!(first.view().cut, cut);
    assert_eq!(first.saved().cut, cut);

    // Another instance gets it with the session, and the same dictionary.
    let mut second = Instance::new();
    second.load_session(&first.saved());
    assert!(Arc::ptr_eq(&second.dictionary().unwrap().unwrap(), &part));

    // The same file from another place keeps its part, another recording does not.
    let moved = sounds.0.path().join("moved.wav");
    std::fs::copy(&path, &moved).unwrap();
    second.load_and_wait(&moved);
    assert_eq!(second.saved().cut, cut);
    second.load_and_wait(&sounds.wav("other.wav", 0.5, 52));
    assert_eq!(second.saved().cut, Cut { region_s: None, ..cut });

    let saved_at = sounds.0.path().join("part.wav");
    loader.save_part(saved_at.clone());
    first.wait_for("saving", |view| view.notice.as_ref().is_some_and(|notice| notice.contains("part.wav")));
    let saved = pyrophone_recording::decode(&saved_at, &|_| true).unwrap();
    let peak = saved.channels[0].iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
    assert_eq!(saved.len_samples(), 33_075);
    assert!((peak - 0.501).abs() < 1e-3, "6 dB below full scale: {peak}");
    loader.save_part(path.clone());
    first.wait_for("refusal", |view| view.error.as_ref().is_some_and(|error| error.contains("long.wav")));
    assert_eq!(pyrophone_recording::decode(&path, &|_| true).unwrap().len_samples(), 88_200, "not overwritten");
}
