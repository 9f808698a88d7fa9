//! Recordings in slots: each is loaded into the slot that sounds, all are kept ready, and a session keeps them.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use nice_plug::prelude::Params;
use nice_plug_egui::RepaintNotifier;
use pyrophone::loader::link::{AudioLink, Update};
use pyrophone::loader::status::View;
use pyrophone::loader::{Engine, Loader};
use pyrophone::parameters::EffectParams;
use pyrophone::persist;
use pyrophone_recording::write_wav_f32;
use pyrophone_settings::session::{self, Cut};
use pyrophone_settings::{Id, Session};
use pyrophone_synthesis::chain::Channels;
use pyrophone_synthesis::controls::SLOTS;

const RATE_HZ: f64 = 44_100.0;

struct Instance {
    loader: Loader,
    params: Arc<EffectParams>,
    link: AudioLink,
    /// Seconds of the dictionaries that the engines would have, by slot.
    engines: [Option<f64>; SLOTS],
}

impl Instance {
    fn running() -> Self {
        let (loader, params, link) = Loader::start(RepaintNotifier::new(), None);
        let instance = Self { loader, params, link, engines: [None; SLOTS] };
        instance.activate();
        instance
    }

    fn activate(&self) {
        let channels = Channels { input: 1, sidechain: 0, output: 1 };
        let structure = self.params.values().structure();
        let ticket = self.loader.set_engine(Engine { sample_rate_hz: RATE_HZ, structure, channels });
        assert!(self.loader.wait(ticket, Some(Duration::from_secs(60))));
    }

    fn wait_for(&self, what: &str, is_so: impl Fn(&View) -> bool) -> View {
        let began = Instant::now();
        loop {
            let view = self.loader.handle().status.view();
            if is_so(&view) {
                return view;
            }
            assert!(began.elapsed() < Duration::from_secs(60), "waited in vain for {what}: {view:?}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Lets another slot sound.
    fn turn_to(&self, slot: usize) {
        self.params.slot(Id::RecordingSlot as usize).set_without_host(slot as f64);
        self.wait_for("another slot", |view| view.slot == slot);
    }

    fn load(&self, path: &Path) {
        self.loader.handle().load(path.to_owned());
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        self.wait_for(&name, |view| view.recording.as_ref().is_some_and(|shown| shown.starts_with(&name)));
    }

    fn session(&self) -> Session {
        persist::decode(&self.params.serialize_fields()[session::FIELD]).expect("a session")
    }

    /// Hundredths of a second of what the engines have, by slot.
    fn engines(&mut self) -> [Option<u32>; SLOTS] {
        while let Some(update) = self.link.receive() {
            if let Update::Dictionary(slot, dictionary) = update {
                self.engines[slot] = dictionary.map(|dictionary| dictionary.windows().seconds());
            }
        }
        self.engines.map(|seconds| seconds.map(|seconds| (100.0 * seconds).round() as u32))
    }
}

fn wav(folder: &tempfile::TempDir, name: &str, seconds: f64) -> PathBuf {
    let path = folder.path().join(name);
    let mut state = 1u32 + name.len() as u32;
    let next = |_| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        0.5 * state as i32 as f32 / i32::MAX as f32
    };
    write_wav_f32(&path, &[(0..(seconds * RATE_HZ) as usize).map(next).collect::<Vec<f32>>()], 44_100)
        .expect("written");
    path
}

#[test]
fn a_recording_goes_into_the_slot_that_sounds_and_all_stay_ready() {
    let folder = tempfile::tempdir().expect("a folder");
    let (first, third) = (wav(&folder, "first.wav", 0.5), wav(&folder, "third one.wav", 0.75));
    let mut instance = Instance::running();
    instance.load(&first);
    instance.turn_to(2);
    let view = instance.wait_for("an empty slot", |view| view.recording.is_none());
    assert!(view.slots[0].as_ref().is_some_and(|words| words.starts_with("first.wav")), "{view:?}");
    instance.load(&third);
    instance.loader.handle().set_cut(Cut { gain_db: -6.0, ..Cut::default() });
    let view = instance.wait_for("a gain", |view| view.cut.gain_db == -6.0);
    assert!(view.slots[1].is_none() && view.slots[2].is_some() && view.slot == 2, "{view:?}");
    instance.activate();
    assert_eq!(instance.engines(), [Some(50), None, Some(75), None], "both are kept ready");
    let session = instance.session();
    assert_eq!(session.recording_in(0).map(|found| Path::new(&found.path)), Some(first.as_path()));
    assert_eq!(session.recording_in(2).map(|found| Path::new(&found.path)), Some(third.as_path()));
    assert_eq!((session.cut_in(0).gain_db, session.cut_in(2).gain_db), (0.0, -6.0));

    instance.turn_to(0);
    let view = instance.wait_for("the first again", |view| view.recording.is_some());
    assert!(view.recording.as_ref().is_some_and(|words| words.starts_with("first.wav")) && view.cut.gain_db == 0.0);
    instance.loader.handle().unload();
    instance.wait_for("nothing", |view| view.recording.is_none());
    instance.activate();
    assert_eq!(instance.engines(), [None, None, Some(75), None], "the other one stays");
    assert!(instance.session().recording_in(2).is_some());
}

#[test]
fn a_session_brings_all_slots_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let saved = {
        let instance = Instance::running();
        instance.load(&wav(&folder, "one.wav", 0.5));
        instance.turn_to(3);
        instance.load(&wav(&folder, "four.wav", 1.0));
        instance.session()
    };
    let mut other = Instance::running();
    let field = serde_json::to_string(&saved.to_json()).expect("JSON");
    other.params.deserialize_fields(&[(session::FIELD.to_owned(), field)].into());
    other.activate();
    assert_eq!(other.engines(), [Some(50), None, None, Some(100)]);
    assert_eq!(other.session(), saved);

    // One that is gone is named, and does not take the others with it.
    std::fs::remove_file(folder.path().join("one.wav")).expect("removed");
    let mut third = Instance::running();
    let field = serde_json::to_string(&saved.to_json()).expect("JSON");
    third.params.deserialize_fields(&[(session::FIELD.to_owned(), field)].into());
    third.activate();
    assert_eq!(third.engines(), [None, None, None, Some(100)]);
    let view = third.wait_for("what is missing", |view| view.error.is_some());
    assert!(view.error.as_ref().is_some_and(|error| error.contains("one.wav")), "{view:?}");
    assert_eq!((view.is_named, view.slots[0].clone()), ([true, false, false, true], None));
    assert_eq!(third.session(), saved, "it is kept for the day when it is found again");
}
