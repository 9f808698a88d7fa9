//! The loader: latest wins, the old sound stays, sharing, sessions, learning. Without a host.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use nice_plug::prelude::Params;
use nice_plug_egui::RepaintNotifier;
use pyrophone::audio::audition::AuditionClip;
use pyrophone::loader::link::{AudioLink, Update};
use pyrophone::loader::status::View;
use pyrophone::loader::{Engine, Loader};
use pyrophone::parameters::EffectParams;
use pyrophone::persist;
use pyrophone_settings::session::{Cut, FieldReference, Learned, RecordingReference};
use pyrophone_settings::{Recent, Session, session};
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain::Channels;
use pyrophone_synthesis::texture::{Dictionary, Distribution};
use pyrophone_synthesis::vortex::{End, SpeedField};

const RATE_HZ: f64 = 44_100.0;

struct Instance {
    loader: Loader,
    params: Arc<EffectParams>,
    link: AudioLink,
}

impl Instance {
    fn new() -> Self {
        Self::with_recent(None)
    }

    fn with_recent(recent: Option<Recent>) -> Self {
        let (loader, params, link) = Loader::start(RepaintNotifier::new(), recent);
        Self { loader, params, link }
    }

    fn running() -> Self {
        let instance = Self::new();
        instance.activate(RATE_HZ);
        instance
    }

    /// Activates and waits.
    fn activate(&self, sample_rate_hz: f64) {
        let channels = Channels { input: 2, sidechain: 0, output: 2 };
        let structure = self.params.values().structure();
        let ticket = self.loader.set_engine(Engine { sample_rate_hz, structure, channels });
        assert!(self.loader.wait(ticket, Some(Duration::from_secs(60))));
    }

    fn view(&self) -> View {
        self.loader.handle().status.view()
    }

    /// Waits until the loader shows what is asked for.
    fn wait_for(&self, what: &str, is_so: impl Fn(&View) -> bool) -> View {
        let began = Instant::now();
        loop {
            let view = self.view();
            if is_so(&view) {
                return view;
            }
            assert!(began.elapsed() < Duration::from_secs(60), "waited in vain for {what}: {view:?}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn load(&self, path: &Path) {
        self.loader.handle().load(path.to_owned());
    }

    fn load_and_wait(&self, path: &Path) {
        self.load(path);
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        self.wait_for(&name, |view| view.recording.as_ref().is_some_and(|shown| shown.starts_with(&name)));
    }

    /// Loads a session as a host would, and waits until it is worked off.
    fn load_field(&self, field: &str) {
        self.params.deserialize_fields(&[(session::FIELD.to_owned(), field.to_owned())].into());
        self.activate(RATE_HZ);
    }

    fn load_session(&self, session: &Session) {
        self.load_field(&serde_json::to_string(&session.to_json()).unwrap());
    }

    fn saved(&self) -> Session {
        persist::decode(&self.params.serialize_fields()[session::FIELD]).unwrap()
    }

    /// What the audio thread would have: of the updates that have arrived the last that is picked.
    fn last<T>(&mut self, pick: impl Fn(Update) -> Option<T>) -> Option<T> {
        std::iter::from_fn(|| self.link.receive()).filter_map(pick).last()
    }

    fn field(&mut self) -> Option<Option<Arc<SpeedField>>> {
        self.last(|update| if let Update::Field(field) = update { Some(field) } else { None })
    }

    fn tape(&mut self) -> Option<Option<AuditionClip>> {
        self.last(|update| if let Update::Tape(tape) = update { Some(tape) } else { None })
    }

    fn distribution(&mut self) -> Option<Option<Arc<Distribution>>> {
        self.last(|update| if let Update::Distribution(found) = update { Some(found) } else { None })
    }

    fn dictionary(&mut self) -> Option<Option<Arc<Dictionary>>> {
        self.last(|update| if let Update::Dictionary(0, dictionary) = update { Some(dictionary) } else { None })
    }
}

struct Sounds(tempfile::TempDir);

impl Sounds {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn wav(&self, name: &str, seconds: f64, seed: u32) -> PathBuf {
        let path = self.0.path().join(name);
        let spec = hound::WavSpec {
            channels: 1,
            sample_rate: 44_100,
            bits_per_sample: 32,
            sample_format: hound::SampleFormat::Float,
        };
        let mut writer = hound::WavWriter::create(&path, spec).unwrap();
        let mut state = seed.wrapping_mul(2_654_435_761) | 1;
        for _ in 0..(seconds * RATE_HZ) as usize {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            writer.write_sample(state as i32 as f32 / i32::MAX as f32 * 0.5).unwrap();
        }
        writer.finalize().unwrap();
        path
    }
}

#[test]
fn the_latest_request_wins() {
    let (sounds, mut instance) = (Sounds::new(), Instance::running());
    for index in 0..6 {
        instance.load(&sounds.wav(&format!("long{index}.wav"), 4.0, 10 + index));
    }
    let last = sounds.wav("last.wav", 0.5, 3);
    instance.load_and_wait(&last);
    instance.activate(RATE_HZ);
    let dictionary = instance.dictionary().unwrap().unwrap();
    assert!((dictionary.seconds() - 0.5).abs() < 1e-3, "{} s", dictionary.seconds());
    assert_eq!(instance.saved().recording.unwrap().path, last.to_string_lossy());
    std::thread::sleep(Duration::from_millis(300));
    assert!(instance.dictionary().is_none(), "nothing arrives after the last one");
}

#[test]
fn a_failed_load_leaves_the_old_sound_and_says_why() {
    let (sounds, mut instance) = (Sounds::new(), Instance::running());
    let good = sounds.wav("good.wav", 0.5, 1);
    instance.load_and_wait(&good);
    instance.activate(RATE_HZ);
    assert!(instance.dictionary().unwrap().is_some());
    let saved = instance.saved();
    let text = sounds.0.path().join("text.wav");
    std::fs::write(&text, "not a sound at all").unwrap();
    for (path, part) in [
        (sounds.0.path().join("none.wav"), "no such file"),
        (sounds.0.path().to_owned(), "folder"),
        (text, "not a sound file"),
        (sounds.wav("short.wav", 0.0005, 1), "short"),
    ] {
        instance.load(&path);
        instance.wait_for(part, |view| view.error.as_ref().is_some_and(|error| error.contains(part)));
        assert!(instance.dictionary().is_none(), "{}: the old one stays", path.display());
        assert_eq!(instance.saved(), saved);
        assert!(instance.view().recording.unwrap().starts_with("good.wav"));
    }
    instance.load_and_wait(&sounds.wav("better.wav", 0.5, 2));
    assert_eq!(instance.view().error, None, "the message goes when something goes right");
}

#[test]
fn dropping_calls_off_the_work() {
    let sounds = Sounds::new();
    let long = sounds.wav("long.wav", 60.0, 5);
    let instance = Instance::running();
    instance.load(&long);
    instance.wait_for("progress", |view| view.progress.is_some());
    // Joins the thread: it has ended when this returns.
    drop(instance);
}

#[test]
fn instances_share_and_nothing_is_kept_after_the_last() {
    let sounds = Sounds::new();
    let path = sounds.wav("shared.wav", 0.7, 77);
    let (mut first, mut second) = (Instance::running(), Instance::running());
    first.load(&path);
    second.load(&path);
    let mut dictionaries: Vec<Arc<Dictionary>> = Vec::new();
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
        assert_eq!(dictionary.sample_rate_hz(), rate_hz);
        assert_eq!(dictionary.shape().levels, EngineConfig::default().levels_at(rate_hz));
        assert!((dictionary.seconds() - 0.5).abs() < 2e-3);
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
    assert_eq!(instance.dictionary().unwrap().unwrap().shape().levels, 5);
}

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
    assert!((second.dictionary().unwrap().unwrap().seconds() - 0.6).abs() < 1e-3);
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

#[test]
fn a_recording_is_drawn_for_a_window_alone() {
    let sounds = Sounds::new();
    let instance = Instance::running();
    instance.load_and_wait(&sounds.wav("long.wav", 2.0, 53));
    instance.activate(RATE_HZ);
    assert_eq!(instance.view().portrait, None, "nobody looks");
    let handle = instance.loader.handle();
    handle.shared.is_watched.store(true, Ordering::Relaxed);
    let drawn = instance.wait_for("a picture", |view| view.portrait.is_some());
    assert_eq!(drawn.portrait.unwrap().start_s, 0.0);
    let cut = Cut { region_s: Some([0.5, 1.25]), gain_db: 0.0, normalise: false };
    handle.set_cut(cut);
    instance.wait_for("a picture of the part", |view| view.portrait.as_ref().is_some_and(|drawn| drawn.start_s == 0.5));
    handle.shared.is_watched.store(false, Ordering::Relaxed);
    instance.load_and_wait(&sounds.wav("other.wav", 0.5, 54));
    instance.activate(RATE_HZ);
    assert_eq!(instance.view().portrait, None, "another recording's picture is not shown for this one");
}

#[test]
fn a_part_of_the_recording_is_learnt_from_and_kept() {
    let sounds = Sounds::new();
    let path = sounds.wav("long.wav", 2.0, 51);
    let mut first = Instance::running();
    first.load_and_wait(&path);
    first.activate(RATE_HZ);
    let whole = first.dictionary().unwrap().unwrap();
    assert!((whole.seconds() - 2.0).abs() < 1e-3);
    let cut = Cut { region_s: Some([0.5, 1.25]), gain_db: -6.0, normalise: true };
    let loader = first.loader.handle();
    loader.set_cut(cut);
    first.activate(RATE_HZ);
    let part = first.dictionary().unwrap().unwrap();
    assert!((part.seconds() - 0.75).abs() < 1e-3, "{}", part.seconds());
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

#[test]
fn a_recording_is_there_to_be_listened_to_as_long_as_that_is_wanted() {
    let sounds = Sounds::new();
    let mut instance = Instance::running();
    let loader = instance.loader.handle();
    instance.load_and_wait(&sounds.wav("tape.wav", 1.0, 61));
    instance.activate(RATE_HZ);
    assert!(instance.tape().flatten().is_none(), "nobody has asked for it");
    loader.audition(true);
    instance.wait_for("a tape", |view| view.has_tape);
    let tape = instance.tape().unwrap().unwrap();
    assert_eq!((tape.len(), tape[0].len()), (1, 44_100));
    loader.set_cut(Cut { region_s: Some([0.0, 0.5]), ..Cut::default() });
    instance.activate(RATE_HZ);
    assert_eq!(instance.tape().unwrap().unwrap()[0].len(), 22_050);
    instance.activate(2.0 * RATE_HZ);
    assert_eq!(instance.tape().unwrap().unwrap()[0].len(), 44_100, "at the engine's rate");
    loader.audition(false);
    instance.wait_for("no tape", |view| !view.has_tape);
    assert!(instance.tape().unwrap().is_none());
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
fn cancelled_work_leaves_the_previous_sound() {
    let sounds = Sounds::new();
    let mut instance = Instance::running();
    instance.load_and_wait(&sounds.wav("short.wav", 0.5, 81));
    instance.activate(RATE_HZ);
    let old = instance.dictionary().unwrap().unwrap();
    let long = sounds.wav("endless.wav", 120.0, 82);
    let loader = instance.loader.handle();
    loader.load(long);
    instance.wait_for("progress", |view| view.progress.is_some());
    loader.cancel();
    instance.wait_for("a message", |view| {
        view.progress.is_none() && view.error.as_ref().is_some_and(|error| error.contains("endless.wav"))
    });
    assert!(instance.view().recording.unwrap().starts_with("short.wav"));
    assert!(instance.saved().recording.unwrap().path.ends_with("short.wav"));
    instance.activate(RATE_HZ);
    assert!(Arc::ptr_eq(&instance.dictionary().unwrap().unwrap(), &old));
    loader.cancel();
    instance.activate(RATE_HZ);
    assert!(instance.view().recording.unwrap().starts_with("short.wav"), "there was nothing left to cancel");
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
