//! A plugin that plays with a recording, for its window.

use std::path::Path;

use nice_plug::prelude::*;
use pyrophone::Pyrophone;
use pyrophone_settings::Session;
use pyrophone_settings::session::{FIELD, RecordingReference};

use crate::common::Context as Host;

/// Sample rate in Hz.
pub const RATE_HZ: f32 = 48_000.0;
/// Samples of a block: sixty a second.
pub const BLOCK: usize = 800;

/// Noise whose loudness comes and goes, with little above `low` (0-1).
fn noise(samples: usize, low: f32) -> Vec<f32> {
    let (mut state, mut slow) = (1u32, 0.0);
    let next = |n: usize| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        slow += low * (state as i32 as f32 / i32::MAX as f32 - slow);
        let swell = (n as f32 / RATE_HZ * 4.0).sin();
        0.5 * (0.2 + swell * swell) * slow / low.sqrt()
    };
    (0..samples).map(next).collect()
}

/// A plugin that plays with a recording.
pub struct Playing {
    /// The plugin.
    pub plugin: Pyrophone,
    host: Host,
    input: Vec<f32>,
    at: usize,
}

impl Playing {
    /// A plugin that has learnt from a recording in `folder`.
    pub fn new(folder: &Path) -> Self {
        let path = folder.join("fire.wav");
        pyrophone_recording::write_wav_f32(&path, &[noise(500_000, 0.5)], RATE_HZ as u32).expect("a file");
        let content_hash =
            pyrophone_recording::content_hash(&pyrophone_recording::read(&path).expect("what was written"));
        let path = path.to_string_lossy().into_owned();
        let recording = Some(RecordingReference { path, content_hash, embedded: None });
        let session = Session { recording, ..Session::default() }.to_json();
        let mut plugin = Pyrophone::default();
        let field = serde_json::to_string(&session).expect("a session");
        plugin.params().deserialize_fields(&[(FIELD.to_owned(), field)].into());
        let mut host = Host { transport: Transport::new(RATE_HZ) };
        // Offline: until the recording is there.
        let config = BufferConfig {
            sample_rate: RATE_HZ,
            min_buffer_size: None,
            max_buffer_size: BLOCK as u32,
            process_mode: ProcessMode::Offline,
        };
        let is_stereo = |layout: &&AudioIOLayout| {
            layout.main_input_channels == NonZeroU32::new(2) && layout.aux_input_ports.is_empty()
        };
        let layout = Pyrophone::AUDIO_IO_LAYOUTS.iter().find(is_stereo).expect("stereo");
        assert!(plugin.activate(layout, &config, &mut host));
        plugin.reset();
        host.transport.playing = true;
        Self { plugin, host, input: noise(10 * RATE_HZ as usize, 0.02), at: 0 }
    }

    /// Plays one block.
    pub fn play_a_block(&mut self) {
        let from = self.at % (self.input.len() - BLOCK);
        let mut channels = [self.input[from..from + BLOCK].to_vec(), self.input[from..from + BLOCK].to_vec()];
        let mut main = Buffer::default();
        // SAFETY: the slices outlive the buffer, and all are of one length.
        unsafe { main.set_slices(BLOCK, |slices| *slices = channels.iter_mut().map(Vec::as_mut_slice).collect()) };
        let mut aux = AuxiliaryBuffers { inputs: &mut [], outputs: &mut [] };
        self.host.transport.pos_samples = Some(self.at as i64);
        self.plugin.process(&mut main, &mut aux, &mut self.host);
        self.at += BLOCK;
    }
}
