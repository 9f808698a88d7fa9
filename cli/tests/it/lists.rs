//! Commands about the program itself: presets, parameters, completions, manual pages, version.

use std::path::Path;
use std::process::Command;

use crate::common::pyrophone;
use pyrophone_settings::PARAMETERS;
use pyrophone_settings::preset::FACTORY;
use serde_json::Value;

const COMMANDS: [&str; 12] = [
    "texture",
    "extend",
    "render",
    "flux",
    "flux-merge",
    "flux-plan",
    "simulate",
    "vortex-texture",
    "presets",
    "parameters",
    "completions",
    "man",
];

#[track_caller]
fn printed(arguments: &str) -> String {
    let output = pyrophone(Path::new("."), arguments);
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn presets_lists_the_factory_s_and_the_user_s() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("mine.toml"), "version = 2\nname = \"Mein Glutofen\"\ntags = [\"a\"]\n").unwrap();
    std::fs::write(folder.path().join("broken.toml"), "version = 99\nname = \"x\"\n").unwrap();
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pyrophone"));
        let output = command.env("PYROPHONE_PRESETS", folder.path()).args(arguments).output().unwrap();
        assert!(output.status.success());
        (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let (plain, notes) = run(&["presets"]);
    assert_eq!(plain.lines().count(), FACTORY.len() + 1);
    assert!(plain.contains("swinging-torch") && plain.contains("Mein Glutofen"));
    assert!(plain.contains("Hearth, evening: "), "titles are listed: {plain}");
    assert!(notes.starts_with("note: ") && notes.contains("broken.toml"), "{notes}");
    let (json, _) = run(&["presets", "--json", "-q"]);
    let json: Value = serde_json::from_str(&json).unwrap();
    let presets = json["presets"].as_array().unwrap();
    assert_eq!(presets.len(), FACTORY.len() + 1);
    let flame = presets.iter().find(|preset| preset["name"] == "flame").unwrap();
    assert_eq!((flame["origin"].as_str(), flame["drive_mode"].as_str()), (Some("factory"), Some("flame")));
    let own = presets.last().unwrap();
    assert_eq!((own["origin"].as_str(), own["tags"][0].as_str()), (Some("user"), Some("a")));
    assert!(own["path"].as_str().unwrap().ends_with("mine.toml"));
    assert!(json["notes"][0].as_str().unwrap().contains("broken.toml"));
    // And it is found however its name is typed.
    let found = Command::new(env!("CARGO_BIN_EXE_pyrophone"))
        .env("PYROPHONE_PRESETS", folder.path())
        .current_dir(folder.path())
        .args(["render", "--preset", "mein GLUTOFEN", "--input", "none.wav", "--output", "out.wav"])
        .output()
        .unwrap();
    assert!(String::from_utf8_lossy(&found.stderr).contains("none.wav: there is no such file"));
}

#[test]
fn parameters_lists_all_with_their_ranges() {
    let plain = printed("parameters");
    let json: Value = serde_json::from_str(&printed("parameters --json")).unwrap();
    let listed = json["parameters"].as_array().unwrap();
    assert_eq!(listed.len(), PARAMETERS.len());
    for (listed, parameter) in listed.iter().zip(PARAMETERS) {
        assert!(plain.contains(parameter.id) && plain.contains(parameter.help), "{}", parameter.id);
        assert_eq!(listed["id"], parameter.id);
        assert_eq!((listed["low"].as_f64(), listed["high"].as_f64()), (Some(parameter.low()), Some(parameter.high())));
        let default = listed["default"].as_str().unwrap();
        assert_eq!(parameter.parse(default).unwrap(), parameter.default_value());
        assert_eq!(listed["automatable"], parameter.automatable);
    }
}

#[test]
fn completions_know_every_command_in_every_shell() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = printed(&format!("completions {shell}"));
        for word in COMMANDS.iter().chain(&["training", "json"]) {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    // What is there to read it says whether it is right.
    let script = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(script.path(), printed("completions bash")).unwrap();
    match Command::new("bash").arg("-n").arg(script.path()).output() {
        Ok(checked) => assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr)),
        Err(_) => eprintln!("skipped: there is no bash"),
    }
}

#[test]
fn man_writes_a_page_for_every_command() {
    let folder = tempfile::tempdir().unwrap();
    let output = pyrophone(folder.path(), "man --output new/pages");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let pages = folder.path().join("new/pages");
    let page = |name: &str| std::fs::read_to_string(pages.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let program = page("pyrophone.1");
    assert!(program.contains("Exit codes") && program.contains("pyrophone\\-render"), "{program}");
    for command in COMMANDS {
        let page = page(&format!("pyrophone-{command}.1"));
        for part in [".TH", ".SH NAME", ".SH SYNOPSIS", ".SH OPTIONS", "\\-\\-quiet"] {
            assert!(page.contains(part), "{command}: {part}");
        }
    }
    assert_eq!(std::fs::read_dir(&pages).unwrap().count(), COMMANDS.len() + 1);
}

#[test]
fn version_tells_the_commit_where_there_is_one() {
    let version = printed("--version");
    let plain = concat!("pyrophone ", env!("CARGO_PKG_VERSION"));
    let git =
        Command::new("git").args(["rev-parse", "--short=12", "HEAD"]).current_dir(env!("CARGO_MANIFEST_DIR")).output();
    let is_checkout = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.git").exists();
    match git.ok().filter(|git| git.status.success() && is_checkout) {
        Some(git) => assert_eq!(version.trim(), format!("{plain} ({})", String::from_utf8(git.stdout).unwrap().trim())),
        None => assert_eq!(version.trim(), plain),
    }
}

#[test]
fn exit_codes_are_in_the_help() {
    let help = printed("--help");
    for code in ["0:", "1:", "2:", "130", "143"] {
        assert!(help.contains(code), "{code}");
    }
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_is_no_error() {
    for arguments in ["presets --json", "parameters", "parameters --json", "completions zsh", "--help"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pyrophone"));
        command.args(arguments.split(' ')).stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let printed = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && printed.is_empty(), "{arguments}: {printed}");
    }
}
