//! Errors of settings, presets and automation files, with their remedies.

use std::path::PathBuf;

/// Reason why a setting, a preset or an automation file was rejected.
///
/// Every message names the value found, the values allowed, and a remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No parameter has this id.
    #[error("there is no parameter `{id}`{}; `pyrophone parameters` lists the ids", did_you_mean(*.nearest))]
    UnknownParameter {
        /// The id found.
        id: String,
        /// The most similar id, if there is one.
        nearest: Option<&'static str>,
    },
    /// A value lies outside its parameter's range.
    #[error("{id} is {found}, but must lie between {low} and {high}; choose a value in that range")]
    OutOfRange {
        /// The parameter.
        id: &'static str,
        /// The value found, with its unit.
        found: String,
        /// The smallest value allowed, with its unit.
        low: String,
        /// The largest value allowed, with its unit.
        high: String,
    },
    /// A value is of a different kind from its parameter's.
    #[error("{id} is {found}, but must be {expected}; write it as in `{id} = {example}`")]
    WrongKind {
        /// The parameter.
        id: &'static str,
        /// The value found.
        found: String,
        /// Values that the parameter accepts.
        expected: String,
        /// An allowed value.
        example: String,
    },
    /// The parameter decides sizes and latency, so it cannot change while sound runs.
    #[error(
        "{id} cannot be automated, because it changes buffers and latency; set it once, in the preset or with `--set {id}=...`"
    )]
    NotAutomatable {
        /// The parameter.
        id: &'static str,
    },
    /// A preset is not valid TOML, or lacks a field.
    #[error("the preset {origin} cannot be read: {message}; compare it with the ones in presets/")]
    PresetSyntax {
        /// Name or path of the preset.
        origin: String,
        /// The parser's message, with the line.
        message: String,
    },
    /// One setting of a preset is wrong.
    #[error("the preset {origin}: {source}")]
    PresetValue {
        /// Name or path of the preset.
        origin: String,
        /// The fault found.
        source: Box<Error>,
    },
    /// A preset was written by a later version.
    #[error(
        "the preset {origin} has version {found}, but this Pyrophone knows versions 1 to {newest}; install a newer Pyrophone"
    )]
    PresetVersion {
        /// Name or path of the preset.
        origin: String,
        /// The version found.
        found: i64,
        /// The newest version known.
        newest: i64,
    },
    /// Neither a factory preset nor a file.
    #[error(
        "there is no preset `{name}`: it is neither a file, nor a factory preset, nor one of yours in {folder}{}; `pyrophone presets` lists all", did_you_mean(*.nearest)
    )]
    UnknownPreset {
        /// The name found.
        name: String,
        /// The most similar name of a factory preset, if there is one.
        nearest: Option<&'static str>,
        /// Folder of the user's presets.
        folder: String,
    },
    /// There is no factory fire of this name.
    #[error("there is no factory fire `{name}`{}; there are {known}, each after `factory:`", did_you_mean(*.nearest))]
    UnknownFire {
        /// The name found.
        name: String,
        /// The most similar name, if there is one.
        nearest: Option<&'static str>,
        /// All names.
        known: String,
    },
    /// A preset cannot have this name.
    #[error("a preset cannot be called \"{found}\"; give it a name of 1 to {longest} characters, on one line")]
    PresetName {
        /// The name found.
        found: String,
        /// Most characters.
        longest: usize,
    },
    /// There is a preset of this name.
    #[error("a preset \"{name}\" already exists ({}); replace it, or choose another name", .path.display())]
    PresetExists {
        /// The name.
        name: String,
        /// Its file.
        path: PathBuf,
    },
    /// A file could not be written.
    #[error("{} cannot be written: {}", .path.display(), reason_of(source))]
    FileWrite {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A file could not be read.
    #[error("{} cannot be read: {}", .path.display(), reason_of(source))]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A session's text is damaged.
    #[error(
        "the session's recording and learned distribution cannot be read ({message}); load the recording again and save"
    )]
    Session {
        /// The fault found.
        message: String,
    },
    /// A session was written by a later version.
    #[error(
        "the session has version {found}, but this Pyrophone knows versions 1 to {newest}; install a newer Pyrophone"
    )]
    SessionVersion {
        /// The version found.
        found: u64,
        /// The newest version known.
        newest: u64,
    },
    /// The automation's header is none of those known.
    #[error(
        "the automation's first line is `{found}`, but must be `time_s,id,value` or `sample,id,value`, with `,curve` after it for ramps; add one of these as the first line"
    )]
    AutomationHeader {
        /// The line found.
        found: String,
    },
    /// A row's fields are too few, too many, or of the wrong kinds.
    #[error("automation, line {line}: {message}")]
    AutomationRow {
        /// Line of the file, from 1.
        line: u64,
        /// The fault found, and what is allowed.
        message: String,
    },
    /// The value or the id of a row is wrong.
    #[error("automation, line {line}: {source}")]
    AutomationValue {
        /// Line of the file, from 1.
        line: u64,
        /// The fault found.
        source: Box<Error>,
    },
    /// A row is earlier than its predecessor.
    #[error("automation, line {line}: time {found} is earlier than the line above ({previous}); sort the rows by time")]
    AutomationOrder {
        /// Line of the file, from 1.
        line: u64,
        /// The time found, as written.
        found: String,
        /// The time above, as written.
        previous: String,
    },
}

fn did_you_mean(nearest: Option<&'static str>) -> String {
    nearest.map_or_else(String::new, |id| format!(" (did you mean `{id}`?)"))
}

fn reason_of(source: &std::io::Error) -> String {
    if source.kind() == std::io::ErrorKind::InvalidData {
        return "it is not text; choose a text file".to_owned();
    }
    format!("{source}; check its path and permissions")
}
