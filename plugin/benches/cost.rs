//! Row of the table of costs: how long an activation in real-time mode keeps the host's main thread.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use common::Context as Host;
use nice_plug::prelude::*;
use pyrophone::Pyrophone;
use pyrophone_settings::Session;
use pyrophone_settings::session::{FIELD, RecordingReference};
use pyrophone_synthesis::dsp::White;
use pyrophone_training::store::FOLDER_VARIABLE;

#[path = "../tests/common/mod.rs"]
mod common;

const RATES_HZ: [f32; 3] = [48_000.0, 96_000.0, 192_000.0];
/// Length of the recording in seconds: learning takes far longer than an activation may.
const RECORDING_S: f32 = 60.0;
const RECORDING_RATE_HZ: f32 = 48_000.0;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[1..] {
        ["activate", rate_hz, recording] => activate(rate_hz.parse().expect("a rate"), Path::new(recording)),
        _ => row(),
    }
}

/// Prints the row; every rate is measured in a process of its own, without a dictionary cache.
fn row() {
    let folder = tempfile::tempdir().expect("a folder");
    let recording = folder.path().join("fire.wav");
    let noise = White::new(1, 0);
    let samples = (0..(RECORDING_S * RECORDING_RATE_HZ) as i64).map(|at| 0.1 * noise.sample_at(at) as f32).collect();
    pyrophone_recording::write_wav_f32(&recording, &[samples], RECORDING_RATE_HZ as u32).expect("a file");
    let found = RATES_HZ.map(|rate_hz| {
        let mut command = Command::new(std::env::current_exe().expect("this program"));
        command.arg("activate").arg(rate_hz.to_string()).arg(&recording);
        let output = command.env(FOLDER_VARIABLE, "").stderr(Stdio::inherit()).output().expect("it starts");
        assert!(output.status.success());
        format!("{} kHz {}", rate_hz / 1000.0, String::from_utf8_lossy(&output.stdout).trim())
    });
    println!("| row | goal | found |\n|---|---|---|");
    println!(
        "| activation in real-time mode while a recording is learnt, ms of the host's main thread: first; again | 50 | {} |",
        found.join(", ")
    );
}

/// Activates a plug-in whose recording is not yet learnt, twice; prints the milliseconds.
fn activate(sample_rate: f32, recording: &Path) {
    let content_hash = pyrophone_recording::content_hash(&pyrophone_recording::read(recording).expect("a recording"));
    let path = recording.to_string_lossy().into_owned();
    let session =
        Session { recording: Some(RecordingReference { path, content_hash, embedded: None }), ..Session::default() };
    let field = serde_json::to_string(&session.to_json()).expect("a session");
    let mut plugin = Pyrophone::default();
    plugin.params().deserialize_fields(&[(FIELD.to_owned(), field)].into());
    let mut host = Host { transport: Transport::new(sample_rate) };
    let config =
        BufferConfig { sample_rate, min_buffer_size: None, max_buffer_size: 512, process_mode: ProcessMode::Realtime };
    let figures = [(); 2].map(|()| {
        let began = Instant::now();
        assert!(plugin.activate(&Pyrophone::AUDIO_IO_LAYOUTS[0], &config, &mut host));
        let milliseconds = 1e3 * began.elapsed().as_secs_f64();
        plugin.deactivate();
        format!("{milliseconds:.0}")
    });
    println!("{}", figures.join("; "));
}
