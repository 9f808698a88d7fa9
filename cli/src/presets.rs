//! `pyrophone presets`: the factory presets and the user's own.

use pyrophone_settings::{Id, Library, Preset};
use serde::Serialize;

use crate::error::Error;
use crate::notes::{note, take_notes};
use crate::summary::{json, print};

/// A preset as printed by `--json`.
#[derive(Serialize)]
struct Listed {
    name: String,
    /// Its display name.
    title: String,
    /// Its author; may be empty.
    author: String,
    /// `factory` or `user`.
    origin: &'static str,
    /// Its file, for a user preset.
    path: Option<String>,
    description: String,
    tags: Vec<String>,
    /// Its drive mode; `flame` needs no input.
    drive_mode: String,
}

#[derive(Serialize)]
struct List {
    command: &'static str,
    presets: Vec<Listed>,
    notes: Vec<String>,
}

/// Lists all presets on standard output.
pub fn run(as_json: bool) -> Result<(), Error> {
    let mut presets: Vec<Listed> =
        Preset::factory()?.into_iter().map(|preset| Listed::new(preset, "factory", None)).collect();
    if let Some(library) = Library::of_user() {
        let (stored, errors) = library.list();
        presets.extend(stored.into_iter().map(|stored| {
            let path = stored.path.display().to_string();
            Listed::new(stored.preset, "user", Some(path))
        }));
        errors.iter().for_each(|error| note(&error.to_string().replace(['\n', '\r'], " ")));
    }
    if as_json {
        print(&json(&List { command: "presets", presets, notes: take_notes() }));
        return Ok(());
    }
    let widest = presets.iter().map(|preset| preset.name.chars().count()).max().unwrap_or(0);
    let line = |preset: &Listed| {
        let mark = if preset.path.is_some() { "yours: " } else { "" };
        let title = if preset.title == preset.name { String::new() } else { format!("{}: ", preset.title) };
        let text = format!("{mark}{title}{}", preset.description).replace(['\n', '\r'], " ");
        format!("{:widest$}  {text}\n", preset.name)
    };
    print(&presets.iter().map(line).collect::<String>());
    Ok(())
}

impl Listed {
    fn new(preset: Preset, origin: &'static str, path: Option<String>) -> Self {
        let drive_mode = Id::DriveMode.parameter().to_text(preset.values.get(Id::DriveMode));
        let title = preset.title().to_owned();
        let Preset { name, author, description, tags, .. } = preset;
        Self { name, title, author, origin, path, description, tags, drive_mode }
    }
}
