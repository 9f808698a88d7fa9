//! Learning the distribution of the drive's amplitudes from one pass or from a file, and sending it to the engine for
//! which it is valid.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

use pyrophone_recording::{decode, resample};
use pyrophone_settings::Values;
use pyrophone_settings::session::{Learned, Session};
use pyrophone_synthesis::chain::learn;
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::Distribution;

use super::engine::Engine;
use super::job::Job;
use super::link::{LoaderLink, Update};
use super::source::Failure;
use super::status::Status;

/// Most amplitudes of one pass: about an hour and a half at 44.1 kHz and six levels.
const MAX_VALUES: usize = 1 << 23;

/// A pass that is being learned, and the state of the learned distribution.
#[derive(Default)]
pub struct Learner {
    /// The amplitudes so far, while learning.
    values: Option<Vec<f64>>,
    /// True after learning was switched off, while the last amplitudes are awaited.
    is_closing: bool,
    is_sent: bool,
    /// A file to learn from instead of a pass.
    file: Option<PathBuf>,
}

/// Steps of probability in a drawn distribution.
const SHOWN: usize = 65;

/// Points of a distribution for drawing; none for an empty one.
pub fn shown_amplitudes(distribution: &Distribution) -> Option<Arc<[f32]>> {
    let at = |step: usize| distribution.amplitude(step as f64 / (SHOWN - 1) as f64) as f32;
    (!distribution.quantiles().is_empty()).then(|| (0..SHOWN).map(at).collect())
}

impl Learner {
    /// Learns from a file as soon as there is an engine to learn for.
    pub fn learn_from(&mut self, path: PathBuf) {
        self.file = Some(path);
    }

    /// True if a file is still waiting to be learned from.
    pub fn is_awaited(&self) -> bool {
        self.file.is_some()
    }

    /// Does without the file.
    pub fn give_up(&mut self) {
        self.file = None;
    }

    /// Learns from the file, if there is one; returns true if that has changed the session.
    pub fn work(
        &mut self,
        session: &mut Session,
        engine: &Engine,
        values: &Values,
        job: &Job,
    ) -> Result<bool, Failure> {
        let Some(path) = &self.file else { return Ok(false) };
        let learned = learned_from(path, engine, values, job);
        if matches!(learned, Err(Failure::Cancelled)) {
            return Err(Failure::Cancelled);
        }
        self.file = None;
        session.learned = Some(learned?);
        self.is_sent = false;
        Ok(true)
    }

    /// Has the distribution sent again.
    pub fn resend(&mut self) {
        self.is_sent = false;
    }

    /// Takes over new amplitudes; returns true if a pass has ended and changed the session.
    pub fn follow(
        &mut self,
        link: &mut LoaderLink,
        session: &mut Session,
        engine: Option<&Engine>,
        status: &Status,
    ) -> bool {
        let is_on = link.shared.learning.load(Ordering::Relaxed);
        let Some(values) = &mut self.values else {
            if is_on {
                link.shared.magnitudes_lost.store(false, Ordering::Relaxed);
                self.values = Some(Vec::new());
                self.is_closing = false;
                status.update(|view| view.learning = Some(0));
            }
            return false;
        };
        let before = values.len();
        link.take_magnitudes(values);
        if values.len() > MAX_VALUES {
            values.truncate(MAX_VALUES);
        }
        if values.len() != before {
            status.update(|view| view.learning = Some(values.len()));
        }
        if is_on {
            return false;
        }
        // Amplitudes in transit when the switch goes off arrive by the next tick.
        if !std::mem::replace(&mut self.is_closing, true) {
            return false;
        }
        let values = self.values.take().unwrap_or_default();
        status.update(|view| view.learning = None);
        if link.shared.magnitudes_lost.load(Ordering::Relaxed) {
            status.fail("some of the pass was missed, because it was rendered too fast; learn in real time".to_owned());
        }
        match engine {
            Some(engine) if !values.is_empty() => {
                session.learned = Some(Learned {
                    sample_rate_hz: engine.sample_rate_hz,
                    levels: engine.structure.levels,
                    companded: engine.structure.dynamics == MatchingMode::Companded,
                    quantiles: Distribution::from_magnitudes(values).quantiles().to_vec(),
                });
                self.is_sent = false;
                true
            }
            _ => {
                status.fail("nothing was learned; press Learn, play the track, and press it again".to_owned());
                false
            }
        }
    }

    /// Sends the session's distribution to the engine, if it is valid for that engine.
    pub fn send(&mut self, link: &mut LoaderLink, session: &Session, engine: &Engine, status: &Status) {
        if self.is_sent {
            return;
        }
        let (distribution, text) = match &session.learned {
            None => (None, None),
            Some(learned) if learned.companded != (engine.structure.dynamics == MatchingMode::Companded) => {
                (None, Some("learned in the other dynamics mode: learn again".to_owned()))
            }
            Some(learned)
                if learned.sample_rate_hz != engine.sample_rate_hz || learned.levels != engine.structure.levels =>
            {
                let Learned { sample_rate_hz, levels, .. } = learned;
                let text = format!(
                    "learned at {sample_rate_hz} Hz and {levels} levels, unlike the present settings: learn again"
                );
                (None, Some(text))
            }
            Some(learned) => match Distribution::from_quantiles(learned.quantiles.clone()) {
                Ok(distribution) => {
                    (Some(Arc::new(distribution)), Some(format!("{} amplitudes", learned.quantiles.len())))
                }
                Err(error) => (None, Some(error.to_string())),
            },
        };
        let amplitudes = distribution.as_deref().and_then(shown_amplitudes);
        self.is_sent = link.send(Update::Distribution(distribution));
        status.update(|view| {
            view.learned = text;
            view.amplitudes[1] = amplitudes;
        });
    }
}

/// The distribution that one pass of the file through the effect, as currently set, would have given.
fn learned_from(path: &Path, engine: &Engine, values: &Values, job: &Job) -> Result<Learned, Failure> {
    let sound = decode(path, &|done| job.report("Reading", 0.5 * done))?;
    let resampling = |done: f32| job.report("Resampling", 0.5 + 0.3 * done);
    let sound = resample(&sound, engine.sample_rate_hz.round() as u32, &resampling)?;
    if !job.report("Learning", 0.8) {
        return Err(Failure::Cancelled);
    }
    let distribution = learn(engine.sample_rate_hz, &engine.structure, &values.controls(), &sound.channels, &[])
        .map_err(|error| Failure::Message(format!("{}: {error}", sound.name)))?;
    Ok(Learned {
        sample_rate_hz: engine.sample_rate_hz,
        levels: engine.structure.levels,
        companded: engine.structure.dynamics == MatchingMode::Companded,
        quantiles: distribution.quantiles().to_vec(),
    })
}
