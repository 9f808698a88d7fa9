//! What the window sees of the sound: drive and output, sample by sample, through a ring that the audio thread fills only
//! while a window looks; and which layers it wants silent meanwhile.

use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use pyrophone_synthesis::controls::MixControls;
use pyrophone_synthesis::texture::Match;
use ringbuf::traits::{Consumer, Observer, Producer, Split};
use ringbuf::{HeapCons, HeapProd, HeapRb};

/// Frames under way: two thirds of a second at 96 kHz, should the window be late.
const FRAMES: usize = 1 << 16;
/// Matches under way: several seconds' worth.
const MATCHES: usize = 1 << 12;

/// Drive and output, as means of their channels, at one sample; the drive is ahead by the latency.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Frame {
    /// Drive.
    pub drive: f32,
    /// Output.
    pub output: f32,
}

/// Layers, in the order of the mix: low, extension, texture, vortex.
pub const LAYERS: usize = 4;

#[derive(Debug, Default)]
struct Shared {
    is_watched: AtomicBool,
    /// Layers that are silent, a bit each.
    silenced: AtomicU8,
    /// What the engines need of the time that they have: of the last blocks, and the most since it was asked.
    load: AtomicU32,
    worst_load: AtomicU32,
}

/// The audio thread's end.
pub struct ProbeIn {
    frames: HeapProd<Frame>,
    matches: HeapProd<Match>,
    shared: Arc<Shared>,
}

/// The window's end; windows come and go.
#[derive(Clone)]
pub struct ProbeOut {
    frames: Arc<Mutex<HeapCons<Frame>>>,
    matches: Arc<Mutex<HeapCons<Match>>>,
    shared: Arc<Shared>,
}

/// Both ends of a new probe.
pub fn pair() -> (ProbeIn, ProbeOut) {
    let (frames_in, frames_out) = HeapRb::new(FRAMES).split();
    let (matches, matches_out) = HeapRb::new(MATCHES).split();
    let shared = Arc::new(Shared::default());
    let out = ProbeOut {
        frames: Arc::new(Mutex::new(frames_out)),
        matches: Arc::new(Mutex::new(matches_out)),
        shared: shared.clone(),
    };
    (ProbeIn { frames: frames_in, matches, shared }, out)
}

impl ProbeIn {
    /// Whether a window looks; real-time safe.
    pub fn is_watched(&self) -> bool {
        self.shared.is_watched.load(Ordering::Relaxed)
    }

    /// Takes the layers out that the window wants silent; real-time safe.
    pub fn hush(&self, mix: &mut MixControls) {
        let silenced = self.shared.silenced.load(Ordering::Relaxed);
        let layers = [&mut mix.low, &mut mix.extension, &mut mix.texture, &mut mix.vortex];
        for (index, level) in layers.into_iter().enumerate() {
            if silenced & (1 << index) != 0 {
                *level = 0.0;
            }
        }
    }

    /// Passes on one block, as much of it as there is room for; real-time safe.
    pub fn send(&mut self, drive: &[f32], output: &[&mut [f32]]) {
        let Some(first) = output.first() else { return };
        let share = 1.0 / output.len() as f32;
        let frames = drive.iter().zip(first.iter()).enumerate().map(|(at, (drive, first))| {
            let others: f32 = output[1..].iter().map(|channel| channel.get(at).copied().unwrap_or(0.0)).sum();
            Frame { drive: *drive, output: share * (first + others) }
        });
        let room = self.frames.vacant_len();
        self.frames.push_iter(frames.take(room));
    }

    /// Passes on where the texture was found; real-time safe.
    pub fn send_match(&mut self, found: Match) {
        // Where there is no room, nobody looks.
        let _ = self.matches.try_push(found);
    }

    /// Tells which part of its time a block has taken; real-time safe.
    pub fn tell_load(&self, load: f32) {
        if load.is_finite() && load >= 0.0 {
            // A second or so of blocks.
            let before = f32::from_bits(self.shared.load.load(Ordering::Relaxed));
            self.shared.load.store((before + 0.02 * (load - before)).to_bits(), Ordering::Relaxed);
            self.shared.worst_load.fetch_max(load.to_bits(), Ordering::Relaxed);
        }
    }
}

impl ProbeOut {
    /// Which layers are to be silent, as long as a window looks.
    pub fn silence(&self, layers: [bool; LAYERS]) {
        let bits = layers.iter().enumerate().fold(0, |bits, (index, silent)| bits | u8::from(*silent) << index);
        self.shared.silenced.store(bits, Ordering::Relaxed);
    }

    /// Starts or stops watching; what was under way is forgotten, and all layers sound.
    pub fn watch(&self, watched: bool) {
        self.shared.is_watched.store(watched, Ordering::Relaxed);
        self.silence([false; LAYERS]);
        self.frames.lock().unwrap_or_else(PoisonError::into_inner).clear();
        self.matches.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }

    /// Hands over what has arrived, oldest first.
    pub fn take(&self, mut with: impl FnMut(Frame)) {
        let mut frames = self.frames.lock().unwrap_or_else(PoisonError::into_inner);
        // No more than was there at first, or a fast host would never let it end.
        for _ in 0..frames.occupied_len() {
            if let Some(frame) = frames.try_pop() {
                with(frame);
            }
        }
    }

    /// Hands over where the texture was found, oldest first.
    pub fn take_matches(&self, with: impl FnMut(Match)) {
        let mut matches = self.matches.lock().unwrap_or_else(PoisonError::into_inner);
        matches.pop_iter().take(MATCHES).for_each(with);
    }

    /// Part of their time that blocks take, smoothed, and the most since the last call.
    pub fn load(&self) -> (f32, f32) {
        let worst = self.shared.worst_load.swap(0, Ordering::Relaxed);
        (f32::from_bits(self.shared.load.load(Ordering::Relaxed)), f32::from_bits(worst))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_silent_while_a_window_wants_it() {
        let (audio, window) = pair();
        let heard = || {
            let mut mix = MixControls { low: 0.1, extension: 0.2, texture: 0.3, vortex: 0.4, ..MixControls::default() };
            audio.hush(&mut mix);
            [mix.low, mix.extension, mix.texture, mix.vortex]
        };
        assert_eq!(heard(), [0.1, 0.2, 0.3, 0.4]);
        window.watch(true);
        window.silence([true, false, true, false]);
        assert_eq!(heard(), [0.0, 0.2, 0.0, 0.4]);
        window.watch(false);
        assert_eq!(heard(), [0.1, 0.2, 0.3, 0.4], "the window has gone");
    }

    #[test]
    fn frames_arrive_in_order_and_what_has_no_room_is_lost() {
        let (mut sent, seen) = pair();
        assert!(!sent.is_watched());
        seen.watch(true);
        assert!(sent.is_watched());
        let drive: Vec<f32> = (0..100).map(|n| n as f32).collect();
        let (mut left, mut right) = (vec![1.0; 100], vec![3.0; 100]);
        sent.send(&drive, &[&mut left, &mut right]);
        let mut frames = vec![];
        seen.take(|frame| frames.push(frame));
        assert_eq!(frames.len(), 100);
        assert!(frames.iter().enumerate().all(|(n, frame)| *frame == Frame { drive: n as f32, output: 2.0 }));
        for _ in 0..2 * FRAMES / 100 {
            sent.send(&drive, &[&mut left]);
        }
        let mut count = 0;
        seen.take(|_| count += 1);
        assert_eq!(count, FRAMES);
        sent.send(&drive, &[&mut left]);
        seen.watch(true);
        seen.take(|_| panic!("what was under way is forgotten"));
    }

    #[test]
    fn loads_are_smoothed_and_the_worst_is_told_once() {
        let (sent, seen) = pair();
        for load in [0.5, f32::NAN, 0.25, f32::INFINITY, -1.0] {
            sent.tell_load(load);
        }
        let (smooth, worst) = seen.load();
        assert!((0.01..0.02).contains(&smooth) && worst == 0.5, "{smooth} {worst}");
        assert_eq!(seen.load().1, 0.0);
    }
}
