//! The loader: latest wins, the old sound stays, sharing, sessions, presets' recordings, learning. Without a host.

mod dictionaries;
mod learning;
mod presets;
mod requests;
mod sessions;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use nice_plug::prelude::Params;
use nice_plug_egui::RepaintNotifier;
use pyrophone::audio::audition::AuditionClip;
use pyrophone::loader::link::{AudioLink, Update};
use pyrophone::loader::status::View;
use pyrophone::loader::{Engine, Loader};
use pyrophone::parameters::EffectParams;
use pyrophone::persist;
use pyrophone_settings::{Recent, Session, session};
use pyrophone_synthesis::chain::Channels;
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::texture::Distribution;
use pyrophone_synthesis::vortex::SpeedField;

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

    fn clip(&mut self) -> Option<Option<AuditionClip>> {
        self.last(|update| if let Update::Clip(clip) = update { Some(clip) } else { None })
    }

    fn distribution(&mut self) -> Option<Option<Arc<Distribution>>> {
        self.last(|update| if let Update::Distribution(found) = update { Some(found) } else { None })
    }

    fn dictionary(&mut self) -> Option<Option<Arc<RecordingDictionary>>> {
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
