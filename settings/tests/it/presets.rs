//! Presets: the factory's, their text, and what is wrong with bad ones.

use std::collections::BTreeSet;
use std::path::Path;

use proptest::prelude::*;
use pyrophone_settings::session::Cut;
use pyrophone_settings::{COUNT, Error, Id, PARAMETERS, Preset, Values, preset};
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::controls::{DynamicRange, Quality};

#[test]
fn every_file_is_a_factory_preset_under_its_name() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../presets");
    let files: BTreeSet<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    assert!(!files.is_empty(), "no presets found");
    let names: BTreeSet<String> = Preset::factory().unwrap().into_iter().map(|preset| preset.name).collect();
    assert_eq!(files, names);
    for (name, _) in preset::FACTORY {
        let preset = Preset::find(name).unwrap();
        assert_eq!(preset.name, *name);
        assert!(!preset.description.is_empty());
        preset.values.structure().validate().unwrap();
    }
}

#[test]
fn default_is_what_a_fresh_instance_has() {
    assert_eq!(Preset::find("default").unwrap().values, Values::default());
}

#[test]
fn texture_paper_is_the_paper_and_nothing_else() {
    let values = Preset::find("texture-paper").unwrap().values;
    let controls = values.controls();
    assert_eq!((controls.mix.low, controls.mix.extension), (0.0, 0.0));
    assert_eq!((controls.mix.texture, controls.mix.output, controls.mix.width), (1.0, 1.0, 1.0));
    assert_eq!((controls.drive.gain, controls.drive.high_pass_hz), (1.0, 0.0));
    assert_eq!((controls.texture.gate, controls.texture.scaling_alpha), (0.0, 1.0));
    assert_eq!(controls.texture.quality, Quality::Exact);
    assert_eq!(controls.texture.dynamic_range, DynamicRange::Learned);
    assert_eq!(values.structure(), EngineConfig::default());
}

#[test]
fn single_engine_presets_silence_the_other() {
    let extend = Preset::find("extend").unwrap().values.controls().mix;
    assert_eq!((extend.low, extend.extension, extend.texture), (1.0, 1.0, 0.0));
    let texture = Preset::find("texture").unwrap().values.controls().mix;
    assert_eq!((texture.low, texture.extension, texture.texture), (0.0, 0.0, 1.0));
}

fn with(parameters: &str) -> Result<Preset, Error> {
    let text = format!("version = 3\nname = \"x\"\n[parameters]\n{parameters}\n");
    Preset::from_toml(&text, "x.toml")
}

#[test]
fn bad_values_are_named() {
    let source = |parameters: &str| match with(parameters).unwrap_err() {
        Error::PresetValue { source, .. } => *source,
        other => panic!("{other}"),
    };
    assert!(matches!(source("alpa = 1"), Error::UnknownParameter { nearest: Some("alpha"), .. }));
    assert!(matches!(source("alpha = 7.0"), Error::OutOfRange { id: "alpha", .. }));
    assert!(matches!(source("levels = 99999999999999"), Error::OutOfRange { id: "levels", .. }));
    for wrong in [
        "alpha = \"2.5\"",
        "alpha = nan",
        "alpha = inf",
        "alpha = -inf",
        "levels = 6.0",
        "gate = 1",
        "gate = \"on\"",
        "quality = 3",
        "quality = \"Best\"",
        "alpha = [1]",
        "low_level = true",
    ] {
        assert!(matches!(source(wrong), Error::WrongKind { .. }), "{wrong}");
    }
    assert_eq!(with("low_level = -inf").unwrap().values.controls().mix.low, 0.0);
    assert_eq!(with("low_level = \"off\"").unwrap().values.controls().mix.low, 0.0);
}

#[test]
fn a_preset_of_version_1_sounds_as_it_did() {
    let text = "version = 1\nname = \"old\"\n[parameters]\nalpha = 3.0\nlow_level = -3.0\n";
    let values = Preset::from_toml(text, "old.toml").unwrap().values;
    assert_eq!(values.structure(), EngineConfig::default());
    let expected =
        [("alpha", 3.0), ("low_level", -3.0), ("extension_level", -24.0), ("scaling_alpha", 0.5), ("high_pass", 30.0)];
    for (id, plain) in expected {
        assert_eq!(values.as_slice()[pyrophone_settings::index_of(id).unwrap()], plain, "{id}");
    }
}

#[test]
fn bad_files_are_refused() {
    for text in
        ["", "version = 1", "name = \"x\"", "version = 1\nname = 3", "[[", "version = 1\nname = \"x\"\nother = 1"]
    {
        let error = Preset::from_toml(text, "x.toml").unwrap_err();
        assert!(matches!(error, Error::PresetSyntax { .. }), "{text}");
        assert_eq!(error.to_string().lines().count(), 1, "{error}");
    }
    for version in [0, -1, preset::VERSION + 1] {
        let text = format!("version = {version}\nname = \"x\"");
        assert!(matches!(Preset::from_toml(&text, "x"), Err(Error::PresetVersion { .. })), "{version}");
    }
    let texture = Preset::find("texture-paper").unwrap();
    for spelt in ["Texture-Paper", "TEXTURE-PAPER", " texture-paper "] {
        assert_eq!(Preset::find(spelt).unwrap(), texture, "{spelt}");
    }
    for spelt in ["Hearth, evening", "hearth, EVENING "] {
        assert_eq!(Preset::find(spelt).unwrap().name, "hearth", "{spelt}");
    }
    assert!(matches!(Preset::find("no-such-preset"), Err(Error::UnknownPreset { nearest: None, .. })));
    assert!(matches!(Preset::find("campfir"), Err(Error::UnknownPreset { nearest: Some("campfire"), .. })));
    assert!(matches!(Preset::load(Path::new("/no/such/file")), Err(Error::File { .. })));
}

#[test]
fn a_preset_of_version_2_follows_by_attack_and_release() {
    let averaging = |version: i64, line: &str| {
        let text = format!("version = {version}\nname = \"x\"\n[parameters]\nrelease = 20.0\n{line}");
        Preset::from_toml(&text, "x.toml").unwrap().values.get(Id::Averaging)
    };
    assert_eq!([averaging(2, ""), averaging(2, "averaging = 3.0")], [0.0, 3.0]);
    assert_eq!([averaging(3, ""), averaging(3, "averaging = \"off\"")], [14.0, 0.0]);
}

#[test]
fn a_preset_may_name_a_recording() {
    let read = |recording: &str| Preset::from_toml(&format!("version = 3\nname = \"x\"\n{recording}"), "x.toml");
    assert_eq!(read("").unwrap().recording, None);
    let whole = read("[recording]\nfile = \"fire.wav\"").unwrap().recording.unwrap();
    assert_eq!((whole.file.to_str(), whole.cut), (Some("fire.wav"), Cut::default()));
    let part = read("[recording]\nfile = \"/a.wav\"\nregion_s = [1.5, 4.0]\ngain_db = -6.0\nnormalise = true").unwrap();
    let cut = Cut { region_s: Some([1.5, 4.0]), gain_db: -6.0, normalise: true };
    assert_eq!(part.recording.as_ref().unwrap().cut, cut);
    assert_eq!(Preset::from_toml(&part.to_toml(), "memory").unwrap(), part);
    for wrong in [
        "",
        "file = \" \"",
        "file = 3",
        "file = \"a\"\npart = 1",
        "file = \"a\"\nregion_s = [2.0, 1.0]",
        "file = \"a\"\ngain_db = 61.0",
    ] {
        let error = read(&format!("[recording]\n{wrong}")).unwrap_err();
        assert!(matches!(error, Error::PresetSyntax { .. }), "{wrong}: {error}");
    }
}

#[test]
fn large_files_are_refused_in_few_words() {
    let folder = tempfile::tempdir().unwrap();
    let load = |text: &str| {
        let path = folder.path().join("a.toml");
        std::fs::write(&path, text).unwrap();
        Preset::load(&path).unwrap_err()
    };
    assert!(matches!(load(&"#".repeat(preset::LARGEST_BYTES as usize + 1)), Error::File { .. }));
    let quoted = load(&format!("version = 2\nname = {}", "ü".repeat(100_000)));
    assert!(matches!(&quoted, Error::PresetSyntax { message, .. } if message.chars().count() <= 301), "{quoted}");
}

proptest! {
    /// What is written is read back to the bit.
    #[test]
    fn text_round_trip(shares in prop::collection::vec(0f64..=1.0, COUNT), name in ".{0,20}") {
        let mut values = Values::default();
        for (index, share) in shares.into_iter().enumerate() {
            let parameter = &PARAMETERS[index];
            values.set_nearest(index, parameter.low() + share * (parameter.high() - parameter.low()));
        }
        let tags = vec!["loud".to_owned(), "a \"quoted\" one".to_owned()];
        let title = format!("{name}, in words");
        let description = "a \"quoted\" one".to_owned();
        let recording = None;
        let preset = Preset { name, title, author: "Somebody".to_owned(), description, tags, values, recording };
        prop_assert_eq!(Preset::from_toml(&preset.to_toml(), "memory").unwrap(), preset);
    }
}

#[test]
fn unnamed_parameters_have_their_defaults() {
    let values = with("alpha = 3").unwrap().values;
    let mut expected = Values::default();
    expected.set(Id::Alpha as usize, 3.0).unwrap();
    assert_eq!(values, expected);
}

#[test]
fn no_factory_preset_is_listed_twice() {
    let mut names: Vec<&str> = pyrophone_settings::preset::FACTORY.iter().map(|(name, _)| *name).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
}
