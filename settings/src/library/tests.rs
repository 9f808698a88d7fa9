use super::*;
use crate::{Id, Values};

fn preset(name: &str, alpha: f64) -> Preset {
    let mut values = Values::default();
    values.set(Id::Alpha as usize, alpha).expect("in range");
    let (description, tags) = ("one's own".to_owned(), vec!["mine".to_owned()]);
    Preset { name: name.to_owned(), description, tags, values, ..Preset::default() }
}

fn library() -> (tempfile::TempDir, Library) {
    let folder = tempfile::tempdir().expect("a folder");
    let library = Library::new(folder.path().join("not/yet"));
    (folder, library)
}

#[test]
fn saved_preset_is_listed_and_found() {
    let (_folder, library) = library();
    assert_eq!(library.list().0, []);
    for (name, alpha) in [("Zündholz", 3.0), ("  a/b:c*?.toml  ", 2.0), ("nul", 4.0)] {
        let path = library.save(&preset(name, alpha), false).expect("saved");
        assert_eq!(path.parent(), Some(library.folder()), "{name}");
        assert_eq!(Preset::load(&path).expect("read"), preset(name.trim(), alpha));
    }
    fs::write(library.folder().join("notes.txt"), "no preset").expect("written");
    let (listed, errors) = library.list();
    let names: Vec<&str> = listed.iter().map(|stored| stored.preset.name.as_str()).collect();
    assert_eq!(names, ["a/b:c*?.toml", "nul", "Zündholz"]);
    assert!(errors.is_empty());
    let files = fs::read_dir(library.folder()).expect("a folder").count();
    assert_eq!(files, 4, "nothing half-written is left");
}

#[test]
fn chosen_folder_is_made_and_can_be_given_up() {
    let folder = tempfile::tempdir().expect("a folder");
    let home = folder.path().join("Pyrophone");
    let default = (Library::new(home.join("presets")), Origin::Default);
    assert_eq!(Library::located_in(&home), default);
    let chosen = folder.path().join("Feuer, für Filme");
    Library::choose_in(&home, Some(&chosen)).expect("stored");
    assert!(chosen.is_dir());
    assert_eq!(Library::located_in(&home), (Library::new(chosen.clone()), Origin::Chosen));
    fs::write(chosen.join("file"), "").expect("written");
    for wrong in [Path::new("relative"), Path::new(""), &chosen.join("file"), &chosen.join("a\nb")] {
        assert!(Library::choose_in(&home, Some(wrong)).is_err(), "{wrong:?}");
        assert_eq!(Library::located_in(&home).0.folder(), chosen);
    }
    Library::choose_in(&home, None).expect("stored");
    assert_eq!(Library::located_in(&home), default);
}

#[test]
fn names_are_found_without_regard_to_case_and_unicode_form() {
    let (_folder, library) = library();
    library.save(&preset("Zündholz", 3.0), false).expect("saved");
    library.save(&preset("ember", 2.0), false).expect("saved");
    fs::write(library.folder().join("Broken.toml"), "version = 99").expect("written");
    assert!(library.find("zu\u{308}ndholz").is_none(), "the exact name only");
    let found = library.find_folded("zu\u{308}NDHOLZ").expect("a file").expect("a preset");
    assert_eq!(found, preset("Zündholz", 3.0));
    assert!(library.find_folded("BROKEN").expect("a file").is_err());
    assert!(library.find_folded("Zundholz").is_none());
}

#[test]
fn nothing_is_overwritten_unless_asked() {
    let (_folder, library) = library();
    let path = library.save(&preset("one", 2.0), false).expect("saved");
    let error = library.save(&preset("one", 5.0), false).expect_err("exists");
    assert!(matches!(&error, Error::PresetExists { name, .. } if name == "one"), "{error}");
    assert_eq!(Preset::load(&path).expect("read"), preset("one", 2.0));
    library.save(&preset("one", 5.0), true).expect("replaced");
    assert_eq!(Preset::load(&path).expect("read"), preset("one", 5.0));
}

#[test]
fn deleting_takes_presets_of_the_folder_alone() {
    let (folder, library) = library();
    let one = library.save(&preset("one", 2.0), false).expect("saved");
    let outside = folder.path().join("outside.toml");
    fs::write(&outside, "").expect("written");
    let notes = library.folder().join("notes.txt");
    fs::write(&notes, "").expect("written");
    for path in [&outside, &notes] {
        assert!(library.delete(path).is_err() && path.exists());
    }
    library.delete(&one).expect("deleted");
    assert!(!one.exists() && library.delete(&one).is_err());
}

#[test]
fn favourites_are_kept_by_name() {
    let (_folder, library) = library();
    assert!(library.favourites().is_empty());
    let names = ["campfire".to_owned(), "Zündholz, nah".to_owned()];
    library.keep_favourites(&names).expect("kept");
    assert_eq!(library.favourites(), names);
    assert_eq!(library.list().0, [], "they are no preset");
    library.keep_favourites(&[]).expect("kept");
    assert!(library.favourites().is_empty());
}

#[test]
fn renaming_moves_the_file_and_keeps_the_rest() {
    let (_folder, library) = library();
    let one = library.save(&preset("one", 2.0), false).expect("saved");
    library.save(&preset("two", 3.0), false).expect("saved");
    assert!(matches!(library.rename(&one, "two"), Err(Error::PresetExists { .. })));
    assert!(matches!(library.rename(&one, " "), Err(Error::PresetName { .. })));
    assert!(matches!(library.rename(Path::new("no-file"), "three"), Err(Error::File { .. })));
    assert!(one.exists());
    let three = library.rename(&one, "three").expect("renamed");
    assert!(!one.exists());
    assert_eq!(Preset::load(&three).expect("read"), preset("three", 2.0));
    // A name that is spelt differently may be the same file.
    assert_eq!(library.rename(&three, "three ").expect("renamed"), three);
    assert!(three.exists());
}

#[test]
fn recordings_beside_presets_move_with_them() {
    let (folder, library) = library();
    let cut = crate::session::Cut { region_s: Some([0.5, 2.25]), gain_db: -3.0, normalise: true };
    let beside = library.folder().join("Glut/Öl, nah — 火.wav");
    let outside = folder.path().join("campfire.wav");
    for (name, file, written) in [("beside", &beside, "Glut/Öl, nah — 火.wav"), ("outside", &outside, "")] {
        let recording = Some(crate::PresetRecording { file: file.clone(), cut });
        let preset = Preset { recording, ..preset(name, 2.0) };
        let path = library.save(&preset, false).expect("saved");
        assert_eq!(Preset::load(&path).expect("read"), preset, "the file need not exist");
        let written = if written.is_empty() { file.display().to_string() } else { written.to_owned() };
        let text = fs::read_to_string(&path).expect("text");
        assert!(text.contains(&format!("\nfile = {}\n", toml::Value::String(written))), "{text}");
    }
    let renamed = library.rename(&library.folder().join("beside.toml"), "other").expect("renamed");
    assert_eq!(Preset::load(&renamed).expect("read").recording.expect("kept").file, beside);
    let moved = Library::new(folder.path().join("moved"));
    fs::rename(library.folder(), moved.folder()).expect("moved");
    let found = moved.find("other").expect("a file").expect("a preset").recording.expect("kept");
    assert_eq!((found.file, found.cut), (moved.folder().join("Glut/Öl, nah — 火.wav"), cut));
}

#[test]
fn broken_presets_are_reported_and_the_rest_listed() {
    let (_folder, library) = library();
    library.save(&preset("good", 2.0), false).expect("saved");
    for (name, text) in [("empty", String::new()), ("huge", "#".repeat(2 << 20)), ("other", "version = 99".into())] {
        fs::write(library.folder().join(format!("{name}.toml")), text).expect("written");
    }
    fs::create_dir(library.folder().join("folder.toml")).expect("made");
    let wrong = "version = 2\nname = \"mistyped\"\n[parameters]\nalpha = 99.0";
    fs::write(library.folder().join("wrong.toml"), wrong).expect("written");
    for name in ["mistyped", "wrong"] {
        let error = library.find(name).expect("a file").expect_err("out of range");
        assert!(error.to_string().contains("alpha"), "{error}");
    }
    assert!(matches!(library.find("good"), Some(Ok(found)) if found == preset("good", 2.0)));
    assert!(matches!(library.find("huge"), Some(Err(Error::File { .. }))));
    assert!(library.find("none").is_none());
    fs::remove_file(library.folder().join("wrong.toml")).expect("removed");
    #[cfg(unix)]
    {
        let pipe = library.folder().join("pipe.toml");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
        assert!(matches!(library.rename(&pipe, "x"), Err(Error::File { .. })), "nobody writes to it");
        fs::remove_file(pipe).expect("removed");
    }
    let (listed, errors) = library.list();
    assert_eq!(listed.len(), 1);
    assert_eq!(errors.len(), 4, "{errors:?}");
    let file = library.folder().join("good.toml");
    let inside = Library::new(file.clone());
    assert!(matches!(inside.save(&preset("x", 2.0), false), Err(Error::FileWrite { .. })));
    assert_eq!(inside.list().1.len(), 1, "a file is no folder");
    for name in ["", "  ", "a\nb", &"x".repeat(81)] {
        assert!(matches!(library.save(&preset(name, 2.0), false), Err(Error::PresetName { .. })), "{name:?}");
    }
}
