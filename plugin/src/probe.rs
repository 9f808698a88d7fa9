//! The sound as seen by the window: drive and output, sample by sample, and the engines' telemetry, through rings that
//! the audio thread fills only while a window watches; and the window's requests for monitoring.

use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use atomic_float::AtomicF32;
use pyrophone_synthesis::chain::Telemetry;
use pyrophone_synthesis::controls::MixControls;
use ringbuf::traits::{Consumer, Observer, Producer, Split};
use ringbuf::{HeapCons, HeapProd, HeapRb};

use crate::channels::MAX_CHANNELS;

/// Maximum number of pending frames: two thirds of a second at 96 kHz, should the window be late.
const FRAMES: usize = 1 << 16;
/// Maximum number of pending telemetry records: several seconds' worth.
const TRACES: usize = 1 << 13;

/// Drive and output at one sample; the drive is ahead by the latency.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ProbeFrame {
    /// Drive, one channel.
    pub drive: f32,
    /// Output by channel; [`ProbeOut::channels`] gives their number.
    pub output: [f32; MAX_CHANNELS],
}

impl ProbeFrame {
    /// Mean of the first `channels` channels of the output.
    pub fn mean(&self, channels: usize) -> f32 {
        let channels = channels.clamp(1, MAX_CHANNELS);
        self.output[..channels].iter().sum::<f32>() / channels as f32
    }
}

/// Monitored sound, while a window watches.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum Listen {
    /// The output, as always.
    #[default]
    Output,
    /// The signal that drives the engines, delayed by the output's latency.
    Drive,
    /// The part of the recording used for learning, in a loop.
    Recording,
}

/// Layers, in the order of the mix: low, extension, texture, vortex, crackle, hiss, body.
pub const LAYERS: usize = 7;

#[derive(Debug, Default)]
struct Shared {
    is_watched: AtomicBool,
    /// Layers that are silent, a bit each.
    silenced: AtomicU8,
    /// A [`Listen`].
    listen: AtomicU8,
    is_burst_wanted: AtomicBool,
    channels: AtomicU8,
    /// Frames that found no room since a window began to watch.
    lost: AtomicU32,
    /// Share of their time that the engines use: over the last blocks, and the maximum since it was read.
    load: AtomicF32,
    worst_load: AtomicF32,
}

impl Shared {
    fn listen(&self) -> Listen {
        let listens = [Listen::Output, Listen::Drive, Listen::Recording];
        listens.get(usize::from(self.listen.load(Ordering::Relaxed))).copied().unwrap_or_default()
    }
}

/// The audio thread's end.
pub struct ProbeIn {
    frames: HeapProd<ProbeFrame>,
    traces: HeapProd<Telemetry>,
    shared: Arc<Shared>,
}

/// The window's end; windows come and go.
#[derive(Clone)]
pub struct ProbeOut {
    frames: Arc<Mutex<HeapCons<ProbeFrame>>>,
    traces: Arc<Mutex<HeapCons<Telemetry>>>,
    shared: Arc<Shared>,
}

/// Both ends of a new probe.
pub fn pair() -> (ProbeIn, ProbeOut) {
    let (frames_in, frames_out) = HeapRb::new(FRAMES).split();
    let (traces, traces_out) = HeapRb::new(TRACES).split();
    let shared = Arc::new(Shared::default());
    let out = ProbeOut {
        frames: Arc::new(Mutex::new(frames_out)),
        traces: Arc::new(Mutex::new(traces_out)),
        shared: shared.clone(),
    };
    (ProbeIn { frames: frames_in, traces, shared }, out)
}

impl ProbeIn {
    /// True if a window watches; real-time safe.
    pub fn is_watched(&self) -> bool {
        self.shared.is_watched.load(Ordering::Relaxed)
    }

    /// Mutes the layers that the window wants silent; real-time safe.
    pub fn apply_mutes(&self, mix: &mut MixControls) {
        let silenced = self.shared.silenced.load(Ordering::Relaxed);
        let first = [&mut mix.low, &mut mix.extension, &mut mix.texture, &mut mix.vortex];
        let layers = first.into_iter().chain([&mut mix.crackle, &mut mix.hiss, &mut mix.body]);
        for (index, level) in layers.enumerate() {
            if silenced & (1 << index) != 0 {
                *level = 0.0;
            }
        }
    }

    /// The sound to be monitored; real-time safe.
    pub fn listen(&self) -> Listen {
        self.shared.listen()
    }

    /// True once if a burst is to start; real-time safe.
    pub fn is_burst_wanted(&self) -> bool {
        self.shared.is_burst_wanted.swap(false, Ordering::Relaxed)
    }

    /// Passes on one block, as much of it as there is room for; real-time safe.
    pub fn send(&mut self, drive: &[f32], output: &[&mut [f32]]) {
        self.shared.channels.store(output.len().min(MAX_CHANNELS) as u8, Ordering::Relaxed);
        let frames = drive.iter().enumerate().map(|(at, drive)| {
            let mut frame = ProbeFrame { drive: *drive, ..ProbeFrame::default() };
            for (sample, channel) in frame.output.iter_mut().zip(output) {
                *sample = channel.get(at).copied().unwrap_or(0.0);
            }
            frame
        });
        let room = self.frames.vacant_len();
        let lost = drive.len().saturating_sub(room);
        self.frames.push_iter(frames.take(room));
        if lost > 0 {
            self.shared.lost.fetch_add(lost as u32, Ordering::Relaxed);
        }
    }

    /// Passes on a record of the engines' telemetry; real-time safe.
    pub fn send_trace(&mut self, trace: Telemetry) {
        // A full ring means that nobody reads it.
        let _ = self.traces.try_push(trace);
    }

    /// Reports the share of its time that a block has used; real-time safe.
    pub fn report_load(&self, load: f32) {
        if load.is_finite() && load >= 0.0 {
            // A second or so of blocks.
            let before = self.shared.load.load(Ordering::Relaxed);
            self.shared.load.store(before + 0.02 * (load - before), Ordering::Relaxed);
            self.shared.worst_load.fetch_max(load, Ordering::Relaxed);
        }
    }
}

impl ProbeOut {
    /// Sets the layers that are silent while a window watches.
    pub fn silence(&self, layers: [bool; LAYERS]) {
        let bits = layers.iter().enumerate().fold(0, |bits, (index, silent)| bits | u8::from(*silent) << index);
        self.shared.silenced.store(bits, Ordering::Relaxed);
    }

    /// Sets the sound monitored while a window watches.
    pub fn listen_to(&self, listen: Listen) {
        self.shared.listen.store(listen as u8, Ordering::Relaxed);
    }

    /// The monitored sound.
    pub fn listen(&self) -> Listen {
        self.shared.listen()
    }

    /// Adds a burst to the input.
    pub fn burst(&self) {
        self.shared.is_burst_wanted.store(true, Ordering::Relaxed);
    }

    /// Channels of the output.
    pub fn channels(&self) -> usize {
        usize::from(self.shared.channels.load(Ordering::Relaxed))
    }

    /// Frames lost since the last call, because the host was too fast for the window.
    pub fn take_lost(&self) -> u32 {
        self.shared.lost.swap(0, Ordering::Relaxed)
    }

    /// Starts or stops watching; pending data is dropped, all layers sound, and the output is monitored.
    pub fn watch(&self, watched: bool) {
        self.shared.is_watched.store(watched, Ordering::Relaxed);
        self.silence([false; LAYERS]);
        self.listen_to(Listen::Output);
        self.shared.is_burst_wanted.store(false, Ordering::Relaxed);
        self.take_lost();
        self.frames.lock().unwrap_or_else(PoisonError::into_inner).clear();
        self.traces.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }

    /// Hands over the frames that have arrived, oldest first.
    pub fn drain(&self, mut with: impl FnMut(ProbeFrame)) {
        let mut frames = self.frames.lock().unwrap_or_else(PoisonError::into_inner);
        // Limited to the frames present at the start, or a fast host would never let it end.
        for _ in 0..frames.occupied_len() {
            if let Some(frame) = frames.try_pop() {
                with(frame);
            }
        }
    }

    /// Hands over the engines' telemetry, oldest first.
    pub fn take_traces(&self, with: impl FnMut(Telemetry)) {
        let mut traces = self.traces.lock().unwrap_or_else(PoisonError::into_inner);
        traces.pop_iter().take(TRACES).for_each(with);
    }

    /// Share of their time that blocks use, smoothed, and the maximum since the last call.
    pub fn load(&self) -> (f32, f32) {
        let worst = self.shared.worst_load.swap(0.0, Ordering::Relaxed);
        (self.shared.load.load(Ordering::Relaxed), worst)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_silent_while_a_window_wants_it() {
        let (audio, window) = pair();
        let heard = || {
            let mut mix = MixControls {
                low: 0.1,
                extension: 0.2,
                texture: 0.3,
                vortex: 0.4,
                crackle: 0.5,
                hiss: 0.6,
                body: 0.7,
                ..MixControls::default()
            };
            audio.apply_mutes(&mut mix);
            [mix.low, mix.extension, mix.texture, mix.vortex, mix.crackle, mix.hiss, mix.body]
        };
        assert_eq!(heard(), [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]);
        window.watch(true);
        window.silence([true, false, true, false, false, true, false]);
        assert_eq!(heard(), [0.0, 0.2, 0.0, 0.4, 0.5, 0.0, 0.7]);
        window.watch(false);
        assert_eq!(heard(), [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], "the window has gone");
    }

    #[test]
    fn monitoring_follows_the_window_and_ends_with_it() {
        let (audio, window) = pair();
        window.watch(true);
        for listen in [Listen::Drive, Listen::Recording, Listen::Output, Listen::Recording] {
            window.listen_to(listen);
            assert_eq!((audio.listen(), window.listen()), (listen, listen));
        }
        window.burst();
        assert_eq!([audio.is_burst_wanted(), audio.is_burst_wanted()], [true, false]);
        window.burst();
        window.watch(false);
        assert_eq!((audio.listen(), audio.is_burst_wanted()), (Listen::Output, false), "the window has gone");
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
        assert_eq!(seen.channels(), 2);
        let mut frames = vec![];
        seen.drain(|frame| frames.push(frame));
        assert_eq!(frames.len(), 100);
        let output = [1.0, 3.0, 0.0, 0.0, 0.0, 0.0];
        assert!(frames.iter().enumerate().all(|(n, frame)| *frame == ProbeFrame { drive: n as f32, output }));
        assert_eq!(seen.take_lost(), 0);
        for _ in 0..2 * FRAMES / 100 {
            sent.send(&drive, &[&mut left]);
        }
        let mut count = 0;
        seen.drain(|_| count += 1);
        assert_eq!(count, FRAMES);
        assert_eq!(seen.take_lost() as usize, 2 * FRAMES / 100 * 100 - FRAMES);
        sent.send(&drive, &[&mut left]);
        seen.watch(true);
        seen.drain(|_| panic!("what was under way is forgotten"));
    }

    #[test]
    fn loads_are_smoothed_and_the_worst_is_reported_once() {
        let (sent, seen) = pair();
        for load in [0.5, f32::NAN, 0.25, f32::INFINITY, -1.0] {
            sent.report_load(load);
        }
        let (smooth, worst) = seen.load();
        assert!((0.01..0.02).contains(&smooth) && worst == 0.5, "{smooth} {worst}");
        assert_eq!(seen.load().1, 0.0);
    }
}
