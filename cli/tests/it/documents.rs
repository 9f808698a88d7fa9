//! Commands in the documents: the command line understands every one of them.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The project's folder.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The documents that users read.
fn documents() -> Vec<PathBuf> {
    let pages = std::fs::read_dir(root().join("docs")).expect("the documents").map(|entry| entry.expect("one").path());
    let pages = pages.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    pages.chain([root().join("README.md")]).collect()
}

/// The arguments of every `pyrophone` command in a document's blocks of shell code.
fn commands(text: &str) -> Vec<Vec<String>> {
    let blocks = text.split("```").skip(1).step_by(2).filter_map(|block| block.strip_prefix("sh\n"));
    let lines = blocks.flat_map(|block| block.lines().map(str::trim_start));
    lines.filter_map(|line| line.strip_prefix("pyrophone ")).map(words).collect()
}

/// The words of a line of shell code: quotes hold words together, and a comment ends them.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (vec![], None::<String>, None);
    for letter in line.chars() {
        match (quote, letter) {
            (Some(mark), letter) if mark == letter => quote = None,
            (None, '"' | '\'') => {
                quote = Some(letter);
                word.get_or_insert_default();
            }
            (None, '#') if word.is_none() => break,
            (None, letter) if letter.is_whitespace() => words.extend(word.take()),
            (_, letter) => word.get_or_insert_default().push(letter),
        }
    }
    words.extend(word);
    words
}

/// What the command line says against a command that it does not understand. With `--help` nothing is done: options and
/// their values before it are read all the same.
fn complaint(arguments: &[String]) -> Option<String> {
    let options = arguments.iter().position(|argument| argument == "--").unwrap_or(arguments.len());
    let output = Command::new(env!("CARGO_BIN_EXE_pyrophone"))
        .args(&arguments[..options])
        .arg("--help")
        .output()
        .expect("the command line runs");
    (!output.status.success()).then(|| String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn every_command_in_the_documents_is_understood() {
    let mut found = 0;
    let mut complaints = vec![];
    for document in documents() {
        for command in commands(&std::fs::read_to_string(&document).expect("a document")) {
            found += 1;
            let name = document.file_name().unwrap_or_default().to_string_lossy().into_owned();
            complaints.extend(complaint(&command).map(|why| format!("{name}: pyrophone {}\n{why}", command.join(" "))));
        }
    }
    assert!(found >= 30, "{found} commands were found: are these the documents?");
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn a_wrong_command_is_found() {
    let text = "```sh\n  pyrophone render --preset 'my own' --no-such-option   # a comment\n```\n```\npyrophone x\n```";
    let commands = commands(text);
    assert_eq!(commands, [["render", "--preset", "my own", "--no-such-option"]]);
    assert!(complaint(&commands[0]).is_some());
    assert!(complaint(&["extend".into(), "--alpha".into(), "steep".into()]).is_some());
    assert_eq!(complaint(&["extend".into(), "--alpha".into(), "2".into()]), None);
}
