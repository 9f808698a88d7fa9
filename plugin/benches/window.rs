//! What the window costs while sound plays through it: contents laid out and drawn, and made into triangles, without a graphics card's
//! part. Sixty frames a second at 1000×700 points; a page of parameters each. `-- instructions` draws a few frames of the first page, for
//! callgrind.

#[path = "../tests/common/mod.rs"]
mod common;

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use common::Context as Host;
use egui::{Context, Pos2, RawInput, Rect, Vec2};
use nice_plug::prelude::*;
use nice_plug_core::context::gui::{GuiContext, GuiContextInner};
use pyrophone::Pyrophone;
use pyrophone::editor::Window;
use pyrophone::editor::controls::Page;
use pyrophone_settings::Session;
use pyrophone_settings::session::{FIELD, RecordingReference};

const RATE_HZ: f32 = 48_000.0;
const FRAMES_HZ: f64 = 60.0;
const BLOCK: usize = 800;
const SIZE: Vec2 = Vec2::new(1000.0, 700.0);
/// Frames before those that count, and those.
const BEFORE: usize = 300;
const COUNTED: usize = 600;
const COUNTED_INSTRUCTIONS: usize = 60;

/// The same host, as the window knows it.
struct Ear;

impl GuiContextInner for Ear {
    fn plugin_api(&self) -> PluginApi {
        PluginApi::Clap
    }
    unsafe fn raw_begin_set_parameter(&self, _: ParamPtr) {}
    unsafe fn raw_set_parameter_normalized(&self, _: ParamPtr, _: f32) {}
    unsafe fn raw_end_set_parameter(&self, _: ParamPtr) {}
    fn get_state(&self) -> PluginState {
        PluginState { version: String::new(), params: Default::default(), fields: Default::default() }
    }
    fn set_state(&self, _: PluginState) {}
    fn request_restart(&self) {}
}

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
struct Playing {
    plugin: Pyrophone,
    host: Host,
    input: Vec<f32>,
    at: usize,
}

impl Playing {
    fn new(folder: &Path) -> Self {
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

    fn play_a_block(&mut self) {
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

/// The window without a screen.
struct Screen {
    window: Window,
    context: Context,
    frame: usize,
}

impl Screen {
    fn new(window: Window) -> Self {
        let mut screen = Self { window, context: Context::default(), frame: 0 };
        screen.window.open(&screen.context, GuiContext::new(Arc::new(Ear)));
        screen
    }

    /// Draws a frame: the time for contents, and for triangles, and how many of these there are.
    #[inline(never)]
    fn counted_frame(&mut self) -> (Duration, Duration, usize) {
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, SIZE)),
            time: Some(self.frame as f64 / FRAMES_HZ),
            focused: true,
            ..RawInput::default()
        };
        self.frame += 1;
        let began = Instant::now();
        let output = self.context.run_ui(input, |ui| self.window.show(ui));
        let drawn = Instant::now();
        let shapes = self.context.tessellate(output.shapes, output.pixels_per_point);
        let done = Instant::now();
        let vertices = shapes.iter().map(|shape| match &shape.primitive {
            egui::epaint::Primitive::Mesh(mesh) => mesh.vertices.len(),
            egui::epaint::Primitive::Callback(_) => 0,
        });
        (drawn - began, done - drawn, vertices.sum())
    }
}

/// A line of the table: milliseconds of a frame, the middle one of all, and the part of a core that sixty a second take.
fn print(name: &str, mut times: Vec<Duration>) -> f64 {
    times.sort();
    let (middle, mean) = (times[times.len() / 2], times.iter().sum::<Duration>() / times.len() as u32);
    let percent = 100.0 * mean.as_secs_f64() * FRAMES_HZ;
    println!("| {name} | {:.3} | {:.3} | {percent:.1} % |", 1e3 * middle.as_secs_f64(), 1e3 * mean.as_secs_f64());
    percent
}

fn main() {
    let counts_instructions = std::env::args().any(|argument| argument == "instructions");
    let folder = tempfile::tempdir().expect("a folder");
    let mut playing = Playing::new(folder.path());
    let mut screen = Screen::new(playing.plugin.window());
    for _ in 0..if counts_instructions { 60 } else { BEFORE } {
        playing.play_a_block();
        screen.counted_frame();
    }
    if counts_instructions {
        for _ in 0..COUNTED_INSTRUCTIONS {
            playing.play_a_block();
            screen.counted_frame();
        }
        println!("{COUNTED_INSTRUCTIONS}");
        return;
    }
    println!("### The window, {}×{} points, {FRAMES_HZ} frames a second\n", SIZE.x, SIZE.y);
    println!("| page | median, ms | mean, ms | of a core |\n|---|---|---|---|");
    let (mut engine, mut vertices) = (Duration::ZERO, 0);
    for page in Page::ALL {
        screen.window.turn_to(page);
        let (mut contents, mut triangles) = (vec![], vec![]);
        for _ in 0..COUNTED {
            let began = Instant::now();
            playing.play_a_block();
            engine += began.elapsed();
            let (drawn, made, count) = screen.counted_frame();
            contents.push(drawn);
            triangles.push(made);
            vertices = count;
        }
        print(&format!("{page:?}: contents"), contents);
        print(&format!("{page:?}: triangles"), triangles);
    }
    println!(
        "\n{vertices} vertices. The engines beside it: {:.1} % of a core.",
        100.0 * engine.as_secs_f64() / (Page::ALL.len() * COUNTED) as f64 * FRAMES_HZ
    );
}
