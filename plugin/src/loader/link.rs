//! Rings between the loader's thread and the audio thread. Objects that the audio thread no longer needs go back
//! through a ring and are freed by the loader.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};

use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::texture::Distribution;
use pyrophone_synthesis::vortex::SpeedField;
use ringbuf::traits::{Consumer, Observer, Producer, Split};
use ringbuf::{HeapCons, HeapProd, HeapRb};

use super::exchange::{Pop, Push, Receiver, Sender};
use crate::audio::audition::AuditionClip;

/// New object for the engines.
pub enum Update {
    /// The dictionary of a slot's recording, or none.
    Dictionary(usize, Option<Arc<RecordingDictionary>>),
    /// The learned distribution, or none.
    Distribution(Option<Arc<Distribution>>),
    /// The speed field, or none.
    Field(Option<Arc<SpeedField>>),
    /// The recording for monitoring, or none.
    Clip(Option<AuditionClip>),
}

/// Object that the audio thread no longer needs.
pub enum Retired {
    /// A dictionary.
    Dictionary(Arc<RecordingDictionary>),
    /// A distribution.
    Distribution(Arc<Distribution>),
    /// A speed field.
    Field(Arc<SpeedField>),
    /// A recording.
    Clip(AuditionClip),
}

/// Maximum number of pending updates; a few suffice, since the loader tries again.
const UPDATES: usize = 16;
/// Maximum number of pending retired objects.
const RETIRED: usize = 32;
/// Maximum number of pending magnitudes: three quarters of a minute at 44.1 kHz and six levels, for a host that renders
/// faster than the loader polls.
const MAGNITUDES: usize = 1 << 16;

impl<T> Push<T> for HeapProd<T> {
    fn push(&mut self, item: T) -> Result<(), T> {
        self.try_push(item)
    }

    fn is_full(&self) -> bool {
        Observer::is_full(self)
    }
}

impl<T> Pop<T> for HeapCons<T> {
    fn pop(&mut self) -> Option<T> {
        self.try_pop()
    }
}

/// Switches read by both threads.
#[derive(Debug, Default)]
pub struct Shared {
    /// True if passing amplitudes are to be learned.
    pub learning: AtomicBool,
    /// Number of samples learned from so far.
    pub learned_samples: AtomicU64,
    /// True if some of them were lost in transit.
    pub magnitudes_lost: AtomicBool,
    /// True while a window is open: pictures of a recording are drawn for it alone.
    pub is_watched: AtomicBool,
    prepared: AtomicU64,
    prepared_latency_samples: AtomicU32,
}

impl Shared {
    /// Announces that everything is ready for engines of this structure.
    pub fn set_prepared(&self, structure: &EngineConfig, latency_samples: u32) {
        self.prepared_latency_samples.store(latency_samples, Ordering::Relaxed);
        self.prepared.store(fingerprint(structure), Ordering::Release);
    }

    /// The latency in samples of engines of this structure, if everything is ready for them.
    pub fn prepared_latency_samples(&self, structure: u64) -> Option<u32> {
        let is_ready = self.prepared.load(Ordering::Acquire) == structure;
        is_ready.then(|| self.prepared_latency_samples.load(Ordering::Relaxed))
    }
}

/// A number that identifies a structure; never 0.
pub fn fingerprint(structure: &EngineConfig) -> u64 {
    let EngineConfig { levels, window, feature, falloff, half_width, fit_width_hz, dynamics } = *structure;
    let fields = [
        levels as u64,
        window as u64,
        feature as u64,
        falloff.to_bits(),
        half_width as u64,
        fit_width_hz.to_bits(),
        dynamics as u64,
    ];
    // FNV-1a over words.
    fields.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, field| (hash ^ field).wrapping_mul(0x0100_0000_01b3)) | 1
}

/// The loader's ends.
pub struct LoaderLink {
    exchange: Sender<HeapProd<Update>, HeapCons<Retired>>,
    magnitudes: HeapCons<f64>,
    /// Switches.
    pub shared: Arc<Shared>,
}

/// The audio thread's ends.
pub struct AudioLink {
    exchange: Receiver<HeapCons<Update>, HeapProd<Retired>>,
    magnitudes: HeapProd<f64>,
    /// Switches.
    pub shared: Arc<Shared>,
}

/// Both ends of new rings.
pub fn pair() -> (LoaderLink, AudioLink) {
    let (updates_in, updates_out) = HeapRb::new(UPDATES).split();
    let (retired_in, retired_out) = HeapRb::new(RETIRED).split();
    let (magnitudes_in, magnitudes_out) = HeapRb::new(MAGNITUDES).split();
    let shared = Arc::new(Shared::default());
    let giver = Sender::new(updates_in, retired_out);
    let taker = Receiver::new(updates_out, retired_in);
    let loader = LoaderLink { exchange: giver, magnitudes: magnitudes_out, shared: shared.clone() };
    let audio = AudioLink { exchange: taker, magnitudes: magnitudes_in, shared };
    (loader, audio)
}

impl LoaderLink {
    /// Sends an update; returns false if there was no room.
    pub fn send(&mut self, update: Update) -> bool {
        self.exchange.send(update)
    }

    /// Frees the objects returned by the audio thread.
    pub fn free_retired(&mut self) {
        self.exchange.free_retired();
    }

    /// Moves the magnitudes that have arrived to the end of `values`.
    pub fn take_magnitudes(&mut self, values: &mut Vec<f64>) {
        values.extend(self.magnitudes.pop_iter());
    }
}

impl AudioLink {
    /// The next update, as long as there is room to return what it replaces; real-time safe.
    pub fn receive(&mut self) -> Option<Update> {
        self.exchange.receive()
    }

    /// Returns an object after a [`receive`](Self::receive); real-time safe.
    pub fn retire(&mut self, retired: Retired) {
        self.exchange.retire(retired);
    }

    /// Passes on magnitudes to be learned; real-time safe.
    pub fn send_magnitudes(&mut self, magnitudes: &[f64]) {
        if self.magnitudes.push_slice(magnitudes) < magnitudes.len() {
            self.shared.magnitudes_lost.store(true, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use pyrophone_synthesis::structure::MatchingMode;

    use super::*;

    #[test]
    fn fingerprints_tell_structures_apart() {
        let base = EngineConfig::default();
        let others = [
            EngineConfig { levels: 5, ..base },
            EngineConfig { window: 5, ..base },
            EngineConfig { feature: 4, ..base },
            EngineConfig { falloff: 0.001, ..base },
            EngineConfig { half_width: 501, ..base },
            EngineConfig { fit_width_hz: 30.1, ..base },
            EngineConfig { dynamics: MatchingMode::Companded, ..base },
        ];
        for other in others {
            assert_ne!(fingerprint(&base), fingerprint(&other), "{other:?}");
        }
        assert_ne!(fingerprint(&base), 0);
    }

    #[test]
    fn lost_magnitudes_are_noticed() {
        let (mut loader, mut audio) = pair();
        audio.send_magnitudes(&vec![0.5; MAGNITUDES]);
        assert!(!audio.shared.magnitudes_lost.load(Ordering::Relaxed));
        audio.send_magnitudes(&[0.5]);
        assert!(audio.shared.magnitudes_lost.load(Ordering::Relaxed));
        let mut values = Vec::new();
        loader.take_magnitudes(&mut values);
        assert_eq!(values.len(), MAGNITUDES);
    }
}
