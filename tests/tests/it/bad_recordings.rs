//! Recordings that cannot be used, named by a session: the host survives, extension plays on, the session keeps the name.
//! (What the user is told is tested where it is said: in `recording` and in the plugin's loader.)

use std::path::{Path, PathBuf};

use crate::files::{FLOAT, INTEGER, wav, wav_f32, wav_format};
use pyrophone_host::Format;
use pyrophone_host::bounce::BounceOptions;
use pyrophone_host::state::State;
use pyrophone_settings::Session;
use pyrophone_settings::session::{FIELD, RecordingReference};
use pyrophone_tests::live::{Clock, Live};
use pyrophone_tests::{
    MONO, RATE_HZ, assert_same, assert_sounds, await_recording, differing, flame, load_session, open, part, play,
    preset, recording, session,
};

/// Makes the bad recordings and names what is wrong with each.
fn bad_recordings(folder: &Path) -> Vec<(&'static str, PathBuf)> {
    let good = wav_f32(&vec![0.1; 20_000], 44_100);
    let mut not_a_number = vec![0.1f32; 20_000];
    not_a_number[9_999] = f32::NAN;
    let mut infinite = vec![0.1f32; 20_000];
    infinite[3] = f32::INFINITY;
    let mut backwards = good.clone();
    backwards[16..20].copy_from_slice(&0x7fff_fff0u32.to_le_bytes());
    let mut picture = b"\x89PNG\r\n\x1a\n".to_vec();
    picture.extend([7; 3000]);
    let eleven_channels = wav(&wav_format(INTEGER, 11, 44_100, 16), &vec![1; 22 * 5000]);
    let no_channels = wav(&wav_format(INTEGER, 0, 44_100, 16), &[1; 2000]);
    let bytes: Vec<(&str, &str, Vec<u8>)> = vec![
        ("empty", "empty.wav", vec![]),
        ("text", "text.wav", b"time,beta\n0.0,1.0\n".repeat(500)),
        ("truncated", "truncated.wav", good[..good.len() / 2].to_vec()),
        ("ends in its header", "header.wav", good[..30].to_vec()),
        ("has a chunk of 2 GB", "backwards.wav", backwards),
        ("no channels", "no_channels.wav", no_channels),
        ("eleven channels", "eleven_channels.wav", eleven_channels),
        ("NaN", "nan.wav", wav_f32(&not_a_number, 44_100)),
        ("infinity", "infinite.wav", wav_f32(&infinite, 44_100)),
        ("no samples", "no_samples.wav", wav_f32(&[], 44_100)),
        ("one sample", "one_sample.wav", wav_f32(&[0.5], 44_100)),
        ("too short to search", "short.wav", wav_f32(&[0.5; 30], 44_100)),
        ("0 Hz", "zero_hz.wav", wav_f32(&[0.5; 20_000], 0)),
        ("4 GHz", "four_ghz.wav", wav_f32(&[0.5; 20_000], u32::MAX)),
        ("unknown coding", "adpcm.wav", wav(&wav_format(2, 1, 44_100, 4), &[0; 4000])),
        ("zeros for a header", "zeros.wav", vec![0; 40_000]),
        ("a picture", "fire.png", picture),
        ("a broken FLAC", "broken.flac", b"fLaC\x80\0\0\x22garbage".repeat(100)),
    ];
    let mut all: Vec<(&'static str, PathBuf)> = bytes
        .into_iter()
        .map(|(name, file, bytes)| {
            let path = folder.join(file);
            std::fs::write(&path, bytes).expect("written");
            (name, path)
        })
        .collect();
    // More than an hour that takes no room on the disk.
    let sparse = folder.join("sparse.wav");
    let size = 3 * 1_000_000_000u32;
    let mut header = wav(&wav_format(FLOAT, 1, 44_100, 32), &[]);
    header[4..8].copy_from_slice(&(size + 36).to_le_bytes());
    header[40..44].copy_from_slice(&size.to_le_bytes());
    std::fs::write(&sparse, &header).expect("written");
    let file = std::fs::File::options().write(true).open(&sparse).expect("opened");
    if file.set_len(u64::from(size) + 44).is_ok() {
        all.push(("hours long", sparse));
    }
    let folder_path = folder.join("a folder.wav");
    std::fs::create_dir(&folder_path).expect("made");
    all.push(("a folder", folder_path));
    all.push(("missing", folder.join("missing.wav")));
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let locked = folder.join("locked.wav");
        std::fs::write(&locked, &good).expect("written");
        std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o000)).expect("locked");
        if std::fs::File::open(&locked).is_err() {
            all.push(("not readable", locked));
        } else {
            eprintln!("skipped: a file that may not be read, which this user may");
        }
    }
    all
}

#[test]
fn bad_recordings_do_no_harm() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let bad = bad_recordings(folder.path());
    assert!(bad.len() >= 15);
    let good = session(Some(&recording(folder.path(), "good.wav", 1, 30_000)), None);
    let values = preset("default", &[]);
    let input = flame(51, 1, 18_000);
    let options = BounceOptions::new(RATE_HZ, MONO);
    for format in Format::ALL {
        let mut plugin = open(format);
        let extension = play(plugin.as_mut(), &input, &options);
        load_session(plugin.as_mut(), &values, &good);
        // While it has the good one, that need not be learnt from anew after every bad one.
        let mut keeper = open(format);
        load_session(keeper.as_mut(), &values, &good);
        await_recording(keeper.as_mut(), RATE_HZ, MONO);
        let with_recording = play(plugin.as_mut(), &input, &options);
        assert!(differing(&extension[0], &with_recording[0]) > 5_000, "{format}: the recording is heard");
        for (name, path) in &bad {
            let context = format!("{format}, {name}");
            let reference = RecordingReference {
                path: path.to_str().expect("UTF-8").to_owned(),
                content_hash: "5c".repeat(32),
                embedded: None,
            };
            let session = Session { recording: Some(reference), ..Session::default() };
            // It arrives while the good one plays.
            let mut live = Live::start(plugin, RATE_HZ, MONO);
            live.play(&part(&input, 0..8000), Clock::Playing(0), 512);
            load_session(live.plugin(), &values, &session);
            let output = live.play(&part(&input, 8000..18_000), Clock::Playing(8000), 512);
            assert_sounds(&output, 2000, &context);
            plugin = live.stop();
            // Once the loader has given up, extension plays alone, and the session still names the file.
            await_recording(plugin.as_mut(), RATE_HZ, MONO);
            assert_same(&play(plugin.as_mut(), &input, &options), &extension, &context);
            let state = State::from_bytes(format, &plugin.state().expect("a state")).expect("a state");
            let text: String = serde_json::from_str(&state.fields[FIELD]).expect("a string");
            assert_eq!(Session::from_json(&text).expect("a session"), session, "{context}");
            // A good one makes all good again.
            load_session(plugin.as_mut(), &values, &good);
            assert_same(&play(plugin.as_mut(), &input, &options), &with_recording, &format!("{context}, after it"));
        }
    }
}

#[test]
fn a_wrong_extension_is_no_obstacle() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let right = recording(folder.path(), "fire.wav", 1, 30_000);
    let wrong = folder.path().join("fire.mp3");
    std::fs::copy(&right, &wrong).expect("copied");
    let input = flame(52, 1, 30_000);
    for format in Format::ALL {
        let outputs = [&right, &wrong].map(|path| {
            let mut plugin = open(format);
            load_session(plugin.as_mut(), &preset("texture", &[]), &session(Some(path), None));
            play(plugin.as_mut(), &input, &BounceOptions::new(RATE_HZ, MONO))
        });
        assert_same(&outputs[1], &outputs[0], &format!("{format}"));
    }
}
