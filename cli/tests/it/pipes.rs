//! Input and output other than WAV files: pipes, FLAC, time stamps, and no input at all.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::common::{hiss, read, refuses, rumble, succeeds, write};
use pyrophone_recording::{Broadcast, decode_bytes, no_progress, write_broadcast_wav_f32};
use tempfile::TempDir;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "hum.wav", &[rumble(24_000, 48_000)], 48_000);
    write(folder.path(), "fire.wav", &[hiss(40_000, 1), hiss(40_000, 2)], 48_000);
    folder
}

/// Runs `pyrophone` with `bytes` on standard input.
fn fed(folder: &Path, arguments: &str, bytes: &[u8]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pyrophone"));
    command.current_dir(folder).args(arguments.split(' '));
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // Where the program refuses at once, nobody reads.
    let _ = child.stdin.take().unwrap().write_all(bytes);
    child.wait_with_output().unwrap()
}

#[test]
fn standard_input_and_output_are_wav_of_unknown_length() {
    let folder = folder();
    let mut hum = std::fs::read(folder.path().join("hum.wav")).unwrap();
    let data = hum.windows(4).position(|id| id == b"data").unwrap();
    hum[data + 4..data + 8].fill(0xff);
    hum[4..8].fill(0xff);
    for command in ["extend", "render --preset extend", "texture --training fire.wav"] {
        let output = fed(folder.path(), &format!("{command} --input - --output -"), &hum);
        let printed = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{command}: {printed}");
        succeeds(folder.path(), &format!("{command} --input hum.wav --output file.wav"));
        let piped = decode_bytes(&output.stdout, "piped", &no_progress).unwrap();
        let file = read(&folder.path().join("file.wav"));
        assert!(piped.channels == file.channels && piped.sample_rate_hz == file.sample_rate_hz, "{command}");
    }
    let summary = fed(folder.path(), "extend --input - --output - --json --quiet", &hum);
    let printed: serde_json::Value = serde_json::from_slice(&summary.stderr).unwrap();
    assert_eq!(printed["output"], "-");
    assert!(summary.stdout.starts_with(b"RIFF"));
}

#[test]
fn bad_pipes_are_refused() {
    let folder = folder();
    let two = "render --preset default --input - --training - --output out.wav";
    let hum = std::fs::read(folder.path().join("hum.wav")).unwrap();
    let broken = hum[..hum.len() / 2].to_vec();
    for (arguments, bytes, says) in [
        (two, &hum, "standard input holds one sound"),
        ("extend --input - --output out.wav", &broken, "truncated"),
        ("extend --input - --output out.wav", &vec![], "standard input: the file is empty"),
    ] {
        let output = fed(folder.path(), arguments, bytes);
        let printed = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(1) && printed.contains(says), "{arguments}: {printed}");
        assert!(!folder.path().join("out.wav").exists());
    }
}

#[test]
fn flac_outputs_are_24_bit_and_other_extensions_are_refused() {
    let folder = folder();
    for command in ["extend --input hum.wav", "texture --input hum.wav --training fire.wav"] {
        succeeds(folder.path(), &format!("{command} --output a.wav"));
        succeeds(folder.path(), &format!("{command} --output a.FLAC"));
        let [wav, flac] = ["a.wav", "a.FLAC"].map(|name| read(&folder.path().join(name)).channels);
        for (wav, flac) in wav.iter().flatten().zip(flac.iter().flatten()) {
            let held = wav.clamp(-1.0, 1.0 - 1.0 / 8_388_608.0);
            assert!((held - flac).abs() <= 0.5 / 8_388_608.0, "{wav} became {flac}");
        }
    }
    for name in ["a.mp3", "a.aiff", "a.wav.txt", "a.ogg"] {
        let extension = name.rsplit('.').next().unwrap();
        let refusal = format!(".{extension} files cannot be written");
        refuses(folder.path(), &format!("extend --input hum.wav --output {name}"), 1, &[&refusal, ".wav", ".flac"]);
    }
    write(folder.path(), "fast.wav", &[rumble(24_000, 192_000)], 192_000);
    refuses(folder.path(), "extend --input fast.wav --output b.flac", 1, &["b.flac", "96000 Hz", "192000 Hz", ".wav"]);
    let wide = "render --preset extend --input hum.wav --channels 10 --output b.flac";
    refuses(folder.path(), wide, 1, &["1 to 8 channels", "10"]);
}

#[test]
fn time_stamp_survives_render_extend_and_texture() {
    let folder = folder();
    let stamp = Broadcast {
        description: "take 7".into(),
        date: Some("2026-01-02".into()),
        time: Some("03:04:05".into()),
        time_reference_samples: 172_800_000,
        ixml: None,
    };
    let stamped = folder.path().join("stamped.wav");
    write_broadcast_wav_f32(&stamped, &[rumble(24_000, 48_000)], 48_000, &stamp).unwrap();
    for command in
        ["render --preset extend", "render --preset extend --channels 6", "extend", "texture --training fire.wav"]
    {
        for name in ["out.wav", "out.flac"] {
            succeeds(folder.path(), &format!("{command} --input stamped.wav --output {name}"));
            assert_eq!(Broadcast::of_file(&folder.path().join(name)), Some(stamp.clone()), "{command} {name}");
        }
        succeeds(folder.path(), &format!("{command} --input hum.wav --output out.wav"));
        assert_eq!(Broadcast::of_file(&folder.path().join("out.wav")), None, "{command}");
    }
    // Through pipes as well.
    let output = fed(folder.path(), "extend --input - --output -", &std::fs::read(&stamped).unwrap());
    assert_eq!(Broadcast::read(&mut std::io::Cursor::new(output.stdout)), Some(stamp));
}

#[test]
fn seconds_take_the_place_of_an_input_where_none_is_needed() {
    let folder = folder();
    write(folder.path(), "silence.wav", &[vec![0.0; 24_000], vec![0.0; 24_000]], 48_000);
    for preset in ["flame", "default --set drive_mode=flame"] {
        succeeds(folder.path(), &format!("render --preset {preset} --seconds 0.5 --output a.wav"));
        succeeds(folder.path(), &format!("render --preset {preset} --input silence.wav --output b.wav"));
        let [seconds, silence] = ["a.wav", "b.wav"].map(|name| read(&folder.path().join(name)));
        assert_eq!(seconds.channels, silence.channels, "{preset}");
        assert!(seconds.channels.iter().flatten().any(|sample| sample.abs() > 1e-3), "{preset}: silence");
    }
    succeeds(folder.path(), "render --preset Flame --seconds 0.5 --sample-rate 44100 --channels 1 --output c.wav");
    let mono = read(&folder.path().join("c.wav"));
    assert_eq!((mono.sample_rate_hz, mono.len_samples(), mono.channels.len()), (44_100, 22_050, 1));
    succeeds(
        folder.path(),
        "render --preset extend --set drive_mode=envelope --sidechain fire.wav --seconds 0.5 --output d.wav",
    );
    for (options, code, says) in [
        ("--preset extend --seconds 1", 1, &["--seconds", "extend", "pressure", "--input"][..]),
        ("--preset flame --seconds 0", 1, &["--seconds", "0", "3600"]),
        ("--preset flame --seconds nan", 1, &["--seconds", "NaN"]),
        ("--preset flame --seconds 1 --sample-rate 100", 1, &["--sample-rate", "100", "8000"]),
        ("--preset flame --seconds 3600 --channels 10 --sample-rate 384000", 1, &["at most"]),
        ("--preset flame --seconds 1 --input hum.wav", 2, &["--seconds", "--input"]),
        ("--preset flame", 2, &["--input"]),
    ] {
        refuses(folder.path(), &format!("render {options} --output e.wav"), code, says);
    }
}

#[test]
fn recording_is_another_word_for_training() {
    let folder = folder();
    for [training, recording] in [
        ["texture --input hum.wav --training fire.wav", "texture --input hum.wav --recording fire.wav"],
        [
            "render --preset default --input hum.wav --training fire.wav --training-region 0.1-0.6 --training-gain -3",
            "render --preset default --input hum.wav --recording fire.wav --recording-region 0.1-0.6 --recording-gain -3",
        ],
    ] {
        succeeds(folder.path(), &format!("{training} --output a.wav"));
        succeeds(folder.path(), &format!("{recording} --output b.wav"));
        assert!(read(&folder.path().join("a.wav")).channels == read(&folder.path().join("b.wav")).channels);
    }
}

#[test]
fn a_missing_folder_is_found_before_anything_is_computed() {
    let folder = folder();
    // The input is not even looked for.
    for command in ["extend", "render --preset extend", "texture --training none.wav"] {
        let command = format!("{command} --input none.wav --output no/folder/out.wav");
        refuses(folder.path(), &command, 1, &["no folder no/folder", "create it first"]);
    }
    refuses(folder.path(), "extend --input none.wav --output a.wav --betas no/b.csv", 1, &["no folder no"]);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let locked = folder.path().join("locked");
        std::fs::create_dir(&locked).unwrap();
        std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).unwrap();
        // Who may write everywhere finds no folder locked.
        if std::fs::write(locked.join("probe"), "").is_err() {
            refuses(
                folder.path(),
                "extend --input none.wav --output locked/a.wav",
                1,
                &["cannot be written", "permission"],
            );
        }
    }
}
