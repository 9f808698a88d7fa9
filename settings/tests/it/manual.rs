//! The manual's list of parameters is that of the table. `PYROPHONE_UPDATE=1` writes it anew.

use std::fmt::Write;
use std::path::Path;

use pyrophone_settings::macros::MACROS;
use pyrophone_settings::{Group, PARAMETERS, Parameter, ParameterKind};

const BEGIN: &str = "<!-- parameters -->\n";
const END: &str = "<!-- end of parameters -->";
/// As the window has them.
const GROUPS: [Group; 10] = [
    Group::Character,
    Group::Drive,
    Group::Levels,
    Group::Extension,
    Group::Texture,
    Group::Crackle,
    Group::Fuel,
    Group::Flame,
    Group::Vortex,
    Group::Structure,
];

fn range(parameter: &Parameter) -> String {
    match parameter.kind {
        ParameterKind::Choice { names, .. } => names.join(", "),
        ParameterKind::Toggle { .. } => "off, on".to_owned(),
        ParameterKind::Float { off_at_low: true, .. } => {
            let [low, high] = [parameter.low(), parameter.high()];
            format!("off ({low}) to {high} {}", parameter.unit).trim_end().to_owned()
        }
        ParameterKind::Float { .. } | ParameterKind::Int { .. } => {
            format!("{} to {} {}", parameter.low(), parameter.high(), parameter.unit).trim_end().to_owned()
        }
    }
}

fn list() -> String {
    let mut text = String::new();
    for group in GROUPS {
        let members = PARAMETERS.iter().filter(|parameter| parameter.group == group);
        writeln!(
            text,
            "\n### {}\n\n| name | id | range | default | the paper's | what it does |\n|---|---|---|---|---|---|",
            group.name()
        )
        .unwrap();
        for parameter in members {
            let fixed = if parameter.automatable { "" } else { " *Fixed.*" };
            let paper = parameter.paper.map_or_else(String::new, |paper| parameter.to_text(paper));
            let default = parameter.to_text(parameter.default_value());
            let (name, id, help) = (parameter.name, parameter.id, parameter.help);
            writeln!(text, "| {name} | `{id}` | {} | {default} | {paper} | {help}{fixed} |", range(parameter)).unwrap();
        }
    }
    text + "\n"
}

const MACROS_BEGIN: &str = "<!-- macros -->\n";
const MACROS_END: &str = "<!-- end of macros -->";

fn macros() -> String {
    let mut text = "\n| macro | raises | moves, from -100 % to 100 % |\n|---|---|---|\n".to_owned();
    for line in MACROS {
        writeln!(text, "| {} | {} | {} |", line.name, line.figure, line.effects_in_words()).unwrap();
    }
    text + "\n"
}

#[test]
fn the_manual_has_every_macro_as_it_is() {
    check(MACROS_BEGIN, MACROS_END, &macros());
}

#[test]
fn the_manual_has_every_parameter_as_it_is() {
    let groups: Vec<Group> = PARAMETERS.iter().map(|parameter| parameter.group).collect();
    assert!(groups.iter().all(|group| GROUPS.contains(group)), "a group is missing here: {groups:?}");
    check(BEGIN, END, &list());
}

/// Compares what stands between two marks of the manual, or writes it.
fn check(begin: &str, end: &str, list: &str) {
    // Both tests may write the same file.
    static ONE_AT_A_TIME: std::sync::Mutex<()> = std::sync::Mutex::new(());
    let _guard = ONE_AT_A_TIME.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/manual.md");
    let manual = std::fs::read_to_string(&path).expect("a manual");
    // Wherever it was checked out, lines end as here.
    let manual = manual.replace("\r\n", "\n");
    let (before, rest) = manual.split_once(begin).expect("the list's begin");
    let (found, after) = rest.split_once(end).expect("the list's end");
    if std::env::var_os("PYROPHONE_UPDATE").is_some() {
        std::fs::write(&path, [before, begin, list, end, after].concat()).expect("a manual that can be written");
        return;
    }
    assert_eq!(found, list, "PYROPHONE_UPDATE=1 writes it anew");
}
