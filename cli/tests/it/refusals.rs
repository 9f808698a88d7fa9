//! Refusals: exit code, one line with a reason, and nothing left behind.

use crate::common::{hiss, refuses, rumble, write};
use tempfile::TempDir;

/// A folder with one good input, one good recording, and bad ones.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "good.wav", &[rumble(22_050, 44_100)], 44_100);
    write(at, "fire.wav", &[hiss(22_050, 1)], 44_100);
    write(at, "short.wav", &[rumble(20, 44_100)], 44_100);
    write(at, "slow.wav", &[rumble(2000, 4000)], 4000);
    write(at, "nan.wav", &[vec![0.5, f32::NAN, 0.5]], 44_100);
    write(at, "stereo.wav", &[rumble(22_050, 44_100), rumble(22_050, 44_100)], 44_100);
    std::fs::write(at.join("empty.wav"), b"").unwrap();
    std::fs::write(at.join("text.wav"), b"this is not a sound\n".repeat(100)).unwrap();
    let whole = std::fs::read(at.join("good.wav")).unwrap();
    std::fs::write(at.join("truncated.wav"), &whole[..whole.len() / 2]).unwrap();
    std::fs::create_dir(at.join("folder.wav")).unwrap();
    folder
}

const BAD: &[(&str, &[&str])] = &[
    ("none.wav", &["none.wav", "no such file"]),
    ("folder.wav", &["folder.wav", "folder"]),
    ("empty.wav", &["empty.wav", "0 bytes"]),
    ("text.wav", &["text.wav", "not a sound file", "text"]),
    ("truncated.wav", &["truncated.wav", "truncated", "of 88200 bytes"]),
    ("nan.wav", &["nan.wav", "sample 1", "NaN"]),
    ("short.wav", &["short.wav", "20 "]),
];

#[test]
fn bad_inputs() {
    let folder = folder();
    for (file, says) in BAD {
        for command in [
            format!("texture --input {file} --training fire.wav --output out.wav"),
            format!("texture --input good.wav --training {file} --output out.wav"),
            format!("extend --input {file} --output out.wav --betas betas.csv"),
            format!("extend --reference --input {file} --output out.wav --betas betas.csv"),
            format!("render --preset default --input good.wav --training {file} --output out.wav"),
            format!(
                "render --preset texture --dynamic-range learned --input {file} --training fire.wav --output out.wav"
            ),
            format!("render --preset texture --input good.wav --training fire.wav --learn {file} --output out.wav"),
        ] {
            refuses(folder.path(), &command, 1, says);
        }
    }
    for (file, says) in BAD.iter().filter(|(file, _)| *file != "short.wav") {
        let command = format!("render --preset extend --input good.wav --sidechain {file} --output out.wav");
        refuses(folder.path(), &command, 1, says);
    }
    refuses(folder.path(), "extend --input slow.wav --output out.wav", 1, &["slow.wav", "4000 Hz", "8000", "convert"]);
}

#[test]
fn options_out_of_range() {
    let folder = folder();
    for (options, says) in [
        ("--levels 2", ["levels", "2", "3", "8"]),
        ("--levels 9", ["levels", "9", "3", "8"]),
        ("--window 1", ["window", "1", "2", "16"]),
        ("--feature 7", ["feature", "7", "1", "6"]),
        ("--falloff -0.5", ["falloff", "-0.5", "0", "1"]),
        ("--scaling-alpha 1.5", ["--scaling-alpha", "1.5", "0", "1"]),
        ("--scaling-alpha nan", ["--scaling-alpha", "NaN", "0", "1"]),
        ("--eps -1", ["--eps", "-1", "0", "1000"]),
    ] {
        let command = format!("texture --input good.wav --training fire.wav --output out.wav {options}");
        refuses(folder.path(), &command, 1, &says);
    }
    for (options, says) in [
        ("--alpha 7", ["alpha", "7", "0", "6"]),
        ("--alpha inf", ["alpha", "inf", "0", "6"]),
        ("--cutoff 20", ["cutoff", "20", "40", "1000"]),
        ("--half-width 20", ["half-width", "20", "100", "2000"]),
        ("--fit-width 0", ["fit width", "0", "3", "120"]),
        ("--blend-start 190 --blend-end 170", ["--blend-start", "190", "170", "lower"]),
        ("--noise-amplitude -1", ["noise-amplitude", "-1", "0", "4"]),
        ("--cutoff 200 --fit-center 180", ["180 Hz", "200 Hz", "--reference", "same value"]),
    ] {
        refuses(folder.path(), &format!("extend --input good.wav --output out.wav {options}"), 1, &says);
    }
    for options in
        ["--alpha 7", "--cutoff 0", "--half-width 0", "--fit-width 0", "--blend-start 200", "--noise-amplitude -1"]
    {
        let command = format!("extend --reference --input good.wav --output out.wav {options}");
        refuses(folder.path(), &command, 1, &["must lie between"]);
    }
    for (options, says) in [
        ("--set alpha=9", &["alpha", "9", "6"][..]),
        ("--set alpa=3", &["alpa", "did you mean `alpha`"]),
        ("--set alpha", &["--set alpha", "no '='", "alpha=3.0"]),
        ("--set levels=20", &["levels", "20", "8"]),
        ("--channels 0", &["--channels", "0", "1"]),
        ("--channels 11", &["--channels", "11", "10"]),
        ("--preset no-such", &["no-such", "factory preset"]),
        ("--speed-field good.wav", &["good.wav", "not a speed field"]),
        ("--speed-field none.field", &["none.field"]),
        ("--automation none.csv", &["none.csv"]),
        ("--dynamic-range off --learn good.wav", &["--learn", "--dynamic-range"]),
    ] {
        let preset = if options.contains("--preset") { "" } else { "--preset extend" };
        refuses(folder.path(), &format!("render {preset} --input good.wav --output out.wav {options}"), 1, says);
    }
}

#[test]
fn outputs_that_cannot_be() {
    let folder = folder();
    for command in ["extend", "render --preset extend"] {
        let to = |output: &str| format!("{command} --input good.wav --output {output}");
        refuses(folder.path(), &to("no/folder/out.wav"), 1, &["no/folder/out.wav", "no folder no/folder"]);
        refuses(folder.path(), &to("folder.wav"), 1, &["folder.wav", "cannot be written"]);
        refuses(folder.path(), &to("good.wav"), 1, &["good.wav", "overwrite", "another name"]);
        #[cfg(unix)]
        {
            let pipe = folder.path().join("pipe.wav");
            if !pipe.exists() {
                assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
            }
            refuses(folder.path(), &to("pipe.wav"), 1, &["pipe.wav", "not a file"]);
            let _ = std::os::unix::fs::symlink("good.wav", folder.path().join("link.wav"));
            refuses(folder.path(), &to("link.wav"), 1, &["link.wav", "overwrite"]);
            let _ = std::os::unix::fs::symlink("nowhere.wav", folder.path().join("dangling.wav"));
            refuses(folder.path(), &to("dangling.wav"), 1, &["dangling.wav", "broken link"]);
        }
    }
    for (name, text) in [("own.toml", "version = 1\nname = \"own\"\n"), ("own.csv", "time_s,id,value\n0,alpha,3\n")] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let onto_preset = "render --preset own.toml --input good.wav --output own.toml --set texture_level=off";
    refuses(folder.path(), onto_preset, 1, &["own.toml", "overwrite"]);
    let onto_automation = "render --preset extend --input good.wav --automation own.csv --output own.csv";
    refuses(folder.path(), onto_automation, 1, &["own.csv", "overwrite"]);
    let same = "extend --input good.wav --output out.wav --betas out.wav";
    refuses(folder.path(), same, 1, &["out.wav", "same file"]);
    let betas_only = "extend --input good.wav --output no/out.wav --betas betas.csv";
    refuses(folder.path(), betas_only, 1, &["no/out.wav"]);
}

#[test]
fn texture_alone_without_a_recording() {
    let folder = folder();
    let command = "render --preset texture --input good.wav --output out.wav";
    refuses(folder.path(), command, 1, &["texture", "add --training"]);
}

#[test]
fn bad_automation() {
    let folder = folder();
    for (text, says) in [
        ("alpha,3\n", "first line"),
        ("time_s,id,value\n0.1,alpha,12\n", "line 2"),
        ("time_s,id,value\n0.1,levels,5\n", "levels"),
        ("time_s,id,value\n0.2,alpha,2\n0.1,alpha,3\n", "line 3"),
    ] {
        std::fs::write(folder.path().join("steps.csv"), text).unwrap();
        let command = "render --preset extend --input good.wav --automation steps.csv --output out.wav";
        refuses(folder.path(), command, 1, &[says]);
    }
}

#[test]
fn invalid_command_lines_exit_with_2() {
    let folder = folder();
    for (arguments, says) in [
        ("", "subcommand"),
        ("burn", "burn"),
        ("texture --input good.wav --output out.wav", "--training"),
        ("extend --input good.wav --output out.wav --loud", "--loud"),
        ("extend --input good.wav --output out.wav --alpha much", "much"),
        ("extend --input good.wav --output out.wav --seed -1", "-1"),
        ("render --preset default --input good.wav --output out.wav --dynamic-range wide", "wide"),
    ] {
        refuses(folder.path(), arguments, 2, &[says, "--help"]);
    }
}

/// Each error of the command line names the help of the command that was typed.
#[test]
fn usage_errors_name_the_command_s_own_help() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, says) in [
        ("render --preset hearth --output o.wav", ["--seconds", "see `pyrophone render --help`"]),
        (
            "render --preset hearth --seconds 1 --input a.wav --output o.wav",
            ["--input", "see `pyrophone render --help`"],
        ),
        ("flux --no-such-option", ["--no-such-option", "see `pyrophone flux --help`"]),
        ("no-such-command", ["no-such-command", "see `pyrophone --help`"]),
    ] {
        refuses(folder.path(), arguments, 2, &says);
    }
}

#[test]
fn channels_beyond_the_range_are_refused_without_an_input_too() {
    let folder = tempfile::tempdir().unwrap();
    for channels in ["0", "11"] {
        let arguments = format!("render --preset hearth --seconds 0.1 --channels {channels} --output o.wav");
        refuses(folder.path(), &arguments, 1, &["--channels", channels, "between 1 and 10"]);
    }
}
