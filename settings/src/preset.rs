//! Presets: readable text, the same for plug-in and command line.
//!
//! ```toml
//! version = 2
//! name = "extend"
//! title = "Low flame, extended"
//! author = "Pyrophone"
//! description = "Spectral extension alone."
//! tags = ["extension"]
//!
//! [recording]
//! file = "campfire.wav"
//!
//! [parameters]
//! texture_level = "off"
//! alpha = 2.5
//! drive_mode = "pressure"
//! gate = true
//! ```
//!
//! Parameters that are not listed have their defaults. A preset without a recording leaves the present one.

use std::path::Path;

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use crate::names::{folded, nearest};
use crate::preset_recording::{Packed, PresetRecording};
use crate::{Error, Library, PARAMETERS, Parameter, ParameterKind, Values, index_of};

/// The version that [`Preset::to_toml`] writes.
pub const VERSION: i64 = 3;

/// Size from which a file is not accepted as a preset.
pub const LARGEST_BYTES: u64 = 1 << 20;

/// Longest parser message shown: it quotes the line, which may be anything.
const LONGEST_MESSAGE: usize = 300;

/// Conversions of a preset's parameters from version `index + 1` to the next version.
const MIGRATIONS: &[fn(&mut Table)] = &[name_the_defaults_of_version_1, name_the_defaults_of_version_2];

/// Version 2 introduced the companded mode, whose settings became the defaults.
fn name_the_defaults_of_version_1(parameters: &mut Table) {
    let defaults: [(&str, Value); 6] = [
        ("dynamics_mode", Value::String("paper".to_owned())),
        ("low_level", Value::Float(-12.0)),
        ("extension_level", Value::Float(-24.0)),
        ("scaling_alpha", Value::Float(0.5)),
        ("high_pass", Value::Float(30.0)),
        ("falloff", Value::Float(0.0)),
    ];
    for (id, value) in defaults {
        parameters.entry(id).or_insert(value);
    }
}

/// Version 3 introduced averaging, by which the drive's envelope follows by default.
fn name_the_defaults_of_version_2(parameters: &mut Table) {
    parameters.entry("averaging").or_insert(Value::Float(0.0));
}

const _: () = assert!(MIGRATIONS.len() as i64 == VERSION - 1, "each version needs its way to the next");

/// Names and texts of the factory presets.
pub const FACTORY: &[(&str, &str)] = pyrophone_assets::PRESETS;

/// A named set of values.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Preset {
    /// Name by which it is found.
    pub name: String,
    /// Display name; empty if it is the same.
    pub title: String,
    /// Author; may be empty.
    pub author: String,
    /// Purpose of the preset.
    pub description: String,
    /// Words that it is found by.
    pub tags: Vec<String>,
    /// Its values.
    pub values: Values,
    /// The recording that it brings, if any.
    pub recording: Option<PresetRecording>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    version: i64,
    name: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    title: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    author: String,
    #[serde(default)]
    description: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    tags: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    recording: Option<Packed>,
    #[serde(default)]
    parameters: Table,
}

impl Preset {
    /// Display name of the preset.
    pub fn title(&self) -> &str {
        if self.title.is_empty() { &self.name } else { &self.title }
    }

    /// The preset meant by `name_or_path`: the factory preset of this name, otherwise the file at this path, otherwise
    /// the user's preset of this name; otherwise the factory or user preset whose name, and finally whose title,
    /// differs only in case or Unicode form.
    ///
    /// # Errors
    /// If there is none, or if its file cannot be read as a preset.
    pub fn find(name_or_path: &str) -> Result<Self, Error> {
        if let Some(found) = Self::find_factory(|name| name == name_or_path) {
            return found;
        }
        let path = Path::new(name_or_path);
        if path.exists() {
            return Self::load(path);
        }
        let library = Library::of_user();
        let name = folded(name_or_path);
        library
            .as_ref()
            .and_then(|library| library.find(name_or_path))
            .or_else(|| Self::find_factory(|found| folded(found) == name))
            .or_else(|| library.as_ref()?.find_folded(name_or_path))
            .or_else(|| Self::find_titled(&name, library.as_ref()))
            .unwrap_or_else(|| Err(unknown(name_or_path, library.as_ref())))
    }

    fn find_factory(is_named: impl Fn(&str) -> bool) -> Option<Result<Self, Error>> {
        let (name, text) = FACTORY.iter().find(|(name, _)| is_named(name))?;
        Some(Self::from_toml(text, name))
    }

    /// The first preset with this folded title, the factory's before the user's.
    fn find_titled(title: &str, library: Option<&Library>) -> Option<Result<Self, Error>> {
        let stored = || library.map_or_else(Vec::new, |library| library.list().0);
        let factory = Self::factory().unwrap_or_default().into_iter();
        let mut all = factory.chain(stored().into_iter().map(|stored| stored.preset));
        all.find(|preset| folded(preset.title()) == title).map(Ok)
    }

    /// Reads a preset's file. A recording is looked for from the file's folder.
    ///
    /// # Errors
    /// If it cannot be read, is larger than [`LARGEST_BYTES`], or does not contain a valid preset.
    pub fn load(path: &Path) -> Result<Self, Error> {
        check_file(path)?;
        let text = std::fs::read_to_string(path).map_err(|source| Error::File { path: path.to_owned(), source })?;
        let preset = Self::from_toml(&text, &path.display().to_string())?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Ok(Self { recording: preset.recording.map(|recording| recording.resolved(folder)), ..preset })
    }

    /// Reads a preset's text; `origin` names it in errors.
    pub fn from_toml(text: &str, origin: &str) -> Result<Self, Error> {
        let syntax =
            |error: toml::de::Error| Error::PresetSyntax { origin: origin.to_owned(), message: one_line(&error) };
        let mut file: File = toml::from_str(text).map_err(syntax)?;
        if !(1..=VERSION).contains(&file.version) {
            return Err(Error::PresetVersion { origin: origin.to_owned(), found: file.version, newest: VERSION });
        }
        for migrate in &MIGRATIONS[file.version as usize - 1..] {
            migrate(&mut file.parameters);
        }
        let in_preset = |source| Error::PresetValue { origin: origin.to_owned(), source: Box::new(source) };
        let mut values = Values::default();
        for (id, value) in &file.parameters {
            let index = index_of(id).map_err(in_preset)?;
            let plain = plain_value(&PARAMETERS[index], value).map_err(in_preset)?;
            values.set(index, plain).map_err(in_preset)?;
        }
        let syntax = |message| Error::PresetSyntax { origin: origin.to_owned(), message };
        let recording = file.recording.map(Packed::unpack).transpose().map_err(syntax)?;
        let File { name, title, author, description, tags, .. } = file;
        Ok(Self { name, title, author, description, tags, values, recording })
    }

    /// The preset as text, every parameter stated.
    pub fn to_toml(&self) -> String {
        let parameters = PARAMETERS
            .iter()
            .zip(self.values.as_slice())
            .map(|(parameter, plain)| (parameter.id.to_owned(), toml_value(parameter, *plain)))
            .collect();
        let Self { name, title, author, description, tags, recording, .. } = self.clone();
        let recording = recording.map(|recording| recording.pack());
        let file = File { version: VERSION, name, title, author, description, tags, recording, parameters };
        // Strings, numbers and booleans in a table always have a TOML form.
        toml::to_string(&file).unwrap_or_default()
    }

    /// All factory presets.
    pub fn factory() -> Result<Vec<Self>, Error> {
        FACTORY.iter().map(|(name, text)| Self::from_toml(text, name)).collect()
    }
}

fn unknown(name: &str, library: Option<&Library>) -> Error {
    let nearest = nearest(&folded(name), FACTORY.iter().map(|(known, _)| *known));
    let folder = library.map_or_else(|| "no folder".to_owned(), |library| library.folder().display().to_string());
    Error::UnknownPreset { name: name.to_owned(), nearest, folder }
}

/// Checks that a file may be read as a preset.
fn check_file(path: &Path) -> Result<(), Error> {
    let refuse = |source| Error::File { path: path.to_owned(), source };
    let metadata = std::fs::metadata(path).map_err(refuse)?;
    // A pipe would be waited for, maybe for ever.
    if !metadata.is_file() {
        return Err(refuse(std::io::Error::other("it is not a file")));
    }
    if metadata.len() > LARGEST_BYTES {
        return Err(refuse(std::io::Error::other("it is larger than 1 MB, so it is not a preset")));
    }
    Ok(())
}

/// The parser's message in one line, without the rest of a line that is longer than any preset's.
fn one_line(error: &toml::de::Error) -> String {
    let words = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    match words.char_indices().nth(LONGEST_MESSAGE) {
        Some((end, _)) => format!("{}…", &words[..end]),
        None => words,
    }
}

/// A TOML value as the parameter's plain value; it may still be out of range.
fn plain_value(parameter: &Parameter, value: &Value) -> Result<f64, Error> {
    match (parameter.kind, value) {
        (ParameterKind::Float { .. }, Value::Float(number)) if number.is_finite() => Ok(*number),
        (ParameterKind::Float { .. } | ParameterKind::Int { .. }, Value::Integer(number)) => Ok(*number as f64),
        (ParameterKind::Float { low, off_at_low: true, .. }, Value::Float(number)) if *number == f64::NEG_INFINITY => {
            Ok(low)
        }
        (ParameterKind::Float { off_at_low: true, .. } | ParameterKind::Choice { .. }, Value::String(text)) => {
            parameter.parse(text)
        }
        (ParameterKind::Toggle { .. }, Value::Boolean(on)) => Ok(f64::from(u8::from(*on))),
        _ => Err(parameter.wrong_kind(value.to_string())),
    }
}

fn toml_value(parameter: &Parameter, plain: f64) -> Value {
    match parameter.kind {
        ParameterKind::Float { .. } if parameter.is_off(plain) => Value::String("off".to_owned()),
        ParameterKind::Float { .. } => Value::Float(plain),
        ParameterKind::Int { .. } => Value::Integer(plain as i64),
        ParameterKind::Choice { .. } => Value::String(parameter.to_text(plain)),
        ParameterKind::Toggle { .. } => Value::Boolean(plain > 0.5),
    }
}
