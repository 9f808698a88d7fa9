//! Slots and a second recording in both formats, and on the command line: the same sound, sample by sample.

use std::path::PathBuf;
use std::process::Command;

use pyrophone_host::bounce::AutomationPoint;
use pyrophone_host::{Format, Plugin, numeric_id};
use pyrophone_settings::Session;
use pyrophone_settings::session::Slot;
use pyrophone_tests::live::{Clock, Live};
use pyrophone_tests::{
    RATE_HZ, STEREO, assert_same, await_recording, command_line, flame, load_session, open, preset, recording, session,
};

struct Studio {
    folder: tempfile::TempDir,
    session: Session,
}

impl Studio {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let first = recording(folder.path(), "fire.wav", 2, 90_000);
        let second = recording(folder.path(), "embers.wav", 1, 70_000);
        let mut session = session(Some(&first), None);
        let other = self::session(Some(&second), None).recording;
        session.others[0] = Slot { recording: other, ..Slot::default() };
        Self { folder, session }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn instance(&self, format: Format, changes: &[(&str, &str)]) -> Box<dyn Plugin> {
        let mut plugin = open(format);
        load_session(plugin.as_mut(), &preset("default", changes), &self.session);
        await_recording(plugin.as_mut(), RATE_HZ, STEREO);
        plugin
    }
}

#[test]
fn slots_are_automated_at_their_samples_in_both_formats() {
    let studio = Studio::new();
    let input = flame(41, 2, 40_000);
    let points: Vec<AutomationPoint> = [("recording_slot", 12_001, 1.0 / 3.0), ("recording_blend", 25_003, 0.5)]
        .map(|(id, sample, value)| AutomationPoint { sample, id: numeric_id(id), value })
        .into();
    let play = |format: Format, block: usize| {
        let mut live = Live::start(studio.instance(format, &[("recording_second", "1")]), RATE_HZ, STEREO);
        live.play_automated(&input, Clock::Playing(0), block, &points)
    };
    let expected = play(Format::Clap, 512);
    for (format, block) in [(Format::Vst3, 512), (Format::Clap, 97), (Format::Vst3, 4096)] {
        assert_same(&play(format, block), &expected, &format!("{format} in blocks of {block}"));
    }
    let mut still = Live::start(studio.instance(Format::Clap, &[]), RATE_HZ, STEREO);
    let unmoved = still.play(&input, Clock::Playing(0), 512);
    let heard = still.plugin().latency_samples() as usize;
    assert_same(
        &expected.iter().map(|channel| channel[..11_600 + heard].to_vec()).collect::<Vec<_>>(),
        &unmoved.iter().map(|channel| channel[..11_600 + heard].to_vec()).collect::<Vec<_>>(),
        "nothing changes before its sample",
    );
    assert!(expected[0][20_000..] != unmoved[0][20_000..], "another recording is heard");
}

#[test]
fn the_command_line_renders_what_the_plug_in_plays() {
    let studio = Studio::new();
    let input = flame(42, 2, 50_000);
    pyrophone_recording::write_wav_f32(&studio.path("flame.wav"), &input, RATE_HZ as u32).expect("written");
    let output = studio.path("out.wav");
    let done = Command::new(command_line())
        .args(["render", "--input"])
        .arg(studio.path("flame.wav"))
        .arg("--recording")
        .arg(studio.path("fire.wav"))
        .arg("--recording-b")
        .arg(studio.path("embers.wav"))
        .args(["--preset", "default", "--set", "recording_blend=40", "--output"])
        .arg(&output)
        .output()
        .expect("the command line runs");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let rendered = pyrophone_recording::decode(&output, &|_| true).expect("a sound").channels;
    let mut live = Live::start(studio.instance(Format::Clap, &[("recording_blend", "40")]), RATE_HZ, STEREO);
    let latency = live.plugin().latency_samples() as usize;
    let mut longer = input.clone();
    longer.iter_mut().for_each(|channel| channel.resize(50_000 + latency, 0.0));
    let played = live.play(&longer, Clock::Playing(0), 512);
    let played: Vec<Vec<f32>> = played.iter().map(|channel| channel[latency..].to_vec()).collect();
    assert_same(&rendered, &played, "the command line and the plug-in");
}
