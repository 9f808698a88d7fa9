//! States that no version of Pyrophone has written: the host survives, the sound goes on, and nothing is lost.

use std::path::Path;

use pyrophone_host::bounce::BounceOptions;
use pyrophone_host::state::{State, StateValue, wrap};
use pyrophone_host::{Format, Plugin, numeric_id};
use pyrophone_settings::session::{FIELD, Learned, RecordingReference, plugin_state};
use pyrophone_settings::{PARAMETERS, Session};
use pyrophone_tests::live::{Clock, Live};
use pyrophone_tests::{
    MONO, RATE_HZ, assert_same, assert_sounds, await_recording, flame, load_session, open, part, play, preset,
    recording, session,
};

/// A good state with other values, other fields.
fn changed(good: &str, change: impl FnOnce(&mut State)) -> Vec<u8> {
    let mut state = State::from_bytes(Format::Vst3, good.as_bytes()).expect("a good state");
    change(&mut state);
    state.to_bytes(Format::Vst3).expect("it can be written")
}

/// A good state with another session text.
fn with_session(good: &str, text: &str) -> Vec<u8> {
    let field = serde_json::to_string(text).expect("JSON");
    changed(good, |state| drop(state.fields.insert(FIELD.to_owned(), field)))
}

/// Bad states by name, as bare JSON (or not).
fn bad_states(good: &str, good_session: &Session) -> Vec<(&'static str, Vec<u8>)> {
    let bytes = good.as_bytes();
    let text = |text: &str| text.as_bytes().to_vec();
    let all = |value: fn(&str) -> StateValue| {
        changed(good, |state| state.params.iter_mut().for_each(|(id, place)| *place = value(id)))
    };
    let own = good_session.to_json();
    let learned = |quantiles: &str| {
        format!(
            "{{\"version\":1,\"learned\":{{\"levels\":6,\"sample_rate_hz\":44100.0,\"quantiles\":\"{quantiles}\"}}}}"
        )
    };
    vec![
        ("empty", vec![]),
        ("garbage", (0..3000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect()),
        ("zeros", vec![0; 4096]),
        ("truncated", bytes[..bytes.len() / 2].to_vec()),
        ("last byte missing", bytes[..bytes.len() - 1].to_vec()),
        ("not UTF-8", good.replace("alpha", "alph\u{e9}").chars().map(|c| c as u8).collect()),
        ("null", text("null")),
        ("no parameters", text(r#"{"version":"0.1.0","fields":{}}"#)),
        ("no fields", text(r#"{"version":"0.1.0","params":{}}"#)),
        ("of no version", text(r#"{"params":{},"fields":{}}"#)),
        ("of a later version", text(&good.replace("\"version\":\"0.1.0\"", "\"version\":\"999.9.9\""))),
        ("parameters are a list", text(r#"{"version":"0.1.0","params":[1,2],"fields":{}}"#)),
        ("strings for numbers", all(|_| StateValue::String("much".to_owned()))),
        ("booleans for numbers", all(|_| StateValue::Bool(true))),
        ("whole numbers for all", all(|_| StateValue::I32(-7))),
        ("NaN", text(&good.replace("{\"f32\":2.5}", "{\"f32\":NaN}"))),
        ("null for a number", text(&good.replace("{\"f32\":2.5}", "{\"f32\":null}"))),
        ("1e300", text(&good.replace("{\"f32\":2.5}", "{\"f32\":1e300}"))),
        ("-1e300", text(&good.replace("{\"f32\":180.0}", "{\"f32\":-1e300}"))),
        ("beyond any number", text(&good.replace("{\"f32\":2.5}", "{\"f32\":1e999}"))),
        (
            "values far out of range",
            changed(good, |state| {
                for (id, value) in &mut state.params {
                    match value {
                        // Levels may not vanish, or there would be nothing to hear.
                        StateValue::F32(plain) => *plain = if id.ends_with("level") { 1e30 } else { -5e9 },
                        StateValue::I32(plain) => *plain = i32::MAX,
                        StateValue::Bool(_) | StateValue::String(_) => {}
                    }
                }
                state.params.insert("threshold".to_owned(), StateValue::F32(-1e9));
                // The highest level of everything is more than any ear wants.
                state.params.insert("output_level".to_owned(), StateValue::F32(-60.0));
                // The envelope of a sidechain that is not there is silence.
                state.params.insert("drive_mode".to_owned(), StateValue::I32(0));
                state.params.insert("noise_amount".to_owned(), StateValue::F32(1e9));
            }),
        ),
        (
            "unknown parameters",
            changed(good, |state| {
                state.params.clear();
                state.params.insert("louder".to_owned(), StateValue::F32(11.0));
                state.params.insert(String::new(), StateValue::Bool(true));
            }),
        ),
        ("field is no JSON", changed(good, |state| drop(state.fields.insert(FIELD.to_owned(), "{{{".to_owned())))),
        ("field is a number", changed(good, |state| drop(state.fields.insert(FIELD.to_owned(), "17".to_owned())))),
        ("no field at all", changed(good, |state| state.fields.clear())),
        ("session is empty", with_session(good, "")),
        ("session is truncated", with_session(good, &own[..own.len() - 5])),
        ("session of no version", with_session(good, "{}")),
        ("session of a later version", with_session(good, r#"{"version":7,"recordings":[{"uri":"x"}]}"#)),
        ("session with a wrong type", with_session(good, r#"{"version":1,"recording":{"path":5,"content_hash":[]}}"#)),
        ("session too deep", with_session(good, &"[".repeat(50_000))),
        ("learned is no Base64", with_session(good, &learned("***"))),
        ("learned holds NaN", with_session(good, &learned("AAAAAAAA+H8="))),
        ("learned is huge", with_session(good, &learned(&"AAAA".repeat(400_000)))),
        (
            "learned for 1000000 levels",
            with_session(good, &learned("AAAAAAAA8D8=").replace("\"levels\":6", "\"levels\":1000000")),
        ),
    ]
}

#[test]
fn bad_states_do_no_harm() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = recording(folder.path(), "fire.wav", 1, 30_000);
    let good_session = session(Some(&path), None);
    let good = plugin_state(&preset("default", &[]), &good_session);
    let bad = bad_states(&good, &good_session);
    assert!(bad.len() >= 20);
    let input = flame(41, 1, 18_000);
    for format in Format::ALL {
        let mut plugin = open(format);
        load_session(plugin.as_mut(), &preset("default", &[]), &good_session);
        await_recording(plugin.as_mut(), RATE_HZ, MONO);
        let options = BounceOptions::new(RATE_HZ, MONO);
        let unharmed = play(plugin.as_mut(), &input, &options);
        // While it has the recording, that need not be learnt from anew after every bad state.
        let mut keeper = open(format);
        load_session(keeper.as_mut(), &preset("default", &[]), &good_session);
        await_recording(keeper.as_mut(), RATE_HZ, MONO);
        for (name, bytes) in &bad {
            let context = format!("{format}, {name}");
            // Loaded while it plays: no gap, and nothing but numbers.
            let mut live = Live::start(plugin, RATE_HZ, MONO);
            live.play(&part(&input, 0..8000), Clock::Playing(0), 512);
            let taken = live.plugin().set_state(&wrap(format, bytes)).is_ok();
            let output = live.play(&part(&input, 8000..18_000), Clock::Playing(8000), 512);
            assert_sounds(&output, 2000, &context);
            // And while it does not: the next activation works, whatever it asks for.
            plugin = live.stop();
            let _ = plugin.set_state(&wrap(format, bytes));
            let output = play(plugin.as_mut(), &input, &options);
            assert_sounds(&part(&output, 4000..18_000), 2000, &context);
            for parameter in PARAMETERS {
                let id = numeric_id(parameter.id);
                let value = plugin.value(id).expect("a value");
                assert!((0.0..=1.0).contains(&value), "{context}: {} is {value}", parameter.id);
                let text = plugin.text(id, value).expect("a text");
                assert!(parameter.parse(&text).is_ok(), "{context}: {} is {text}", parameter.id);
            }
            // What is saved then can be loaded again.
            let saved = plugin.state().unwrap_or_else(|error| panic!("{context}: {error}"));
            let mut other = open(format);
            other.set_state(&saved).unwrap_or_else(|error| panic!("{context}: saved, but {error}"));
            // And the good state is as good as ever.
            plugin.set_state(&wrap(format, good.as_bytes())).expect("a good state");
            await_recording(plugin.as_mut(), RATE_HZ, MONO);
            assert_same(&play(plugin.as_mut(), &input, &options), &unharmed, &format!("{context}, after it"));
            println!("{context}: {}", if taken { "taken" } else { "refused" });
        }
    }
}

#[test]
fn bad_envelopes_of_clap_do_no_harm() {
    let input = flame(42, 1, 20_000);
    let good = wrap(Format::Clap, plugin_state(&preset("extend", &[]), &Session::default()).as_bytes());
    let json = &good[8..];
    let envelopes: [Vec<u8>; 6] = [
        vec![],
        vec![1, 2, 3],
        vec![0; 8],
        [&(json.len() as u64 + 1).to_le_bytes(), json].concat(),
        [&7u64.to_le_bytes(), json].concat(),
        good[..good.len() - 10].to_vec(),
    ];
    for bytes in envelopes {
        let mut plugin = open(Format::Clap);
        let _ = plugin.set_state(&bytes);
        let output = play(plugin.as_mut(), &input, &BounceOptions::new(RATE_HZ, MONO));
        assert_sounds(&part(&output, 2000..20_000), 2000, &format!("{} bytes", bytes.len()));
    }
}

#[test]
fn structure_out_of_range_is_brought_into_range() {
    let good = plugin_state(&preset("default", &[]), &Session::default());
    for format in Format::ALL {
        for (wild, levels, window, half_width) in
            [(i32::MAX, "8", "16 samples", "2000 samples"), (i32::MIN, "3", "2 samples", "100 samples")]
        {
            let bytes = changed(&good, |state| {
                for id in ["levels", "window", "feature", "half_width"] {
                    state.params.insert(id.to_owned(), StateValue::I32(wild));
                }
                state.params.insert("fit_width".to_owned(), StateValue::F32(wild as f32));
                state.params.insert("falloff".to_owned(), StateValue::F32(wild as f32));
            });
            let mut plugin = open(format);
            plugin.set_state(&wrap(format, &bytes)).expect("taken");
            for (id, expected) in [("levels", levels), ("window", window), ("half_width", half_width)] {
                let id = numeric_id(id);
                let value = plugin.value(id).expect("a value");
                // VST3 hosts put the unit behind it themselves.
                let expected = if format == Format::Vst3 { expected.trim_end_matches(" samples") } else { expected };
                assert_eq!(plugin.text(id, value).expect("a text"), expected, "{format}");
            }
            let output = play(plugin.as_mut(), &flame(43, 1, 60_000), &BounceOptions::new(RATE_HZ, MONO));
            assert_sounds(&part(&output, 6000..60_000), 6000, &format!("{format}, {wild}"));
        }
    }
}

/// The session that an instance would save.
fn saved_session(plugin: &mut dyn Plugin) -> Session {
    let bytes = plugin.state().expect("a state");
    let state = State::from_bytes(plugin.format(), &bytes).expect("a state of this plugin");
    let text: String = serde_json::from_str(&state.fields[FIELD]).expect("a string");
    Session::from_json(&text).expect("a session")
}

#[test]
fn a_session_whose_recording_is_not_found_is_saved_unharmed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = recording(folder.path(), "fire.wav", 1, 30_000);
    let packed = pyrophone_recording::embed(&std::fs::read(&path).expect("read")).expect("small enough");
    let learned = Learned { sample_rate_hz: RATE_HZ, levels: 6, companded: false, quantiles: vec![0.0, 0.25, 1.0] };
    let reference = |path: &Path, content_hash: String, embedded: Option<String>| RecordingReference {
        path: path.to_str().expect("UTF-8").to_owned(),
        content_hash,
        embedded,
    };
    let lost = Path::new("/no/such/folder/fire.wav");
    let nowhere = reference(lost, "ab".repeat(32), None);
    let damaged = reference(lost, "ab".repeat(32), Some("Zm9vYmFy".to_owned()));
    let other = reference(lost, "ab".repeat(32), Some(packed.clone()));
    let no_hash = reference(lost, "\u{1f525}".to_owned(), None);
    let no_path = reference(Path::new(""), String::new(), Some(String::new()));
    let input = flame(44, 1, 30_000);
    for format in Format::ALL {
        let mut extension = open(format);
        load_session(extension.as_mut(), &preset("default", &[]), &Session::default());
        let options = BounceOptions::new(RATE_HZ, MONO);
        let expected = play(extension.as_mut(), &input, &options);
        for recording in [&nowhere, &damaged, &other, &no_hash, &no_path] {
            let session = Session {
                recording: Some(recording.clone()),
                embed: true,
                learned: Some(learned.clone()),
                ..Session::default()
            };
            let mut plugin = open(format);
            load_session(plugin.as_mut(), &preset("default", &[]), &session);
            let context = format!("{format}, {:.80}", format!("{recording:?}"));
            assert_eq!(saved_session(plugin.as_mut()), session, "{context}, at once");
            // Extension plays alone.
            assert_same(&play(plugin.as_mut(), &input, &options), &expected, &context);
            assert_eq!(saved_session(plugin.as_mut()), session, "{context}, after playing");
        }
        // Where the file is gone but the session holds it, it is heard.
        let hash = pyrophone_recording::content_hash(&std::fs::read(&path).expect("read"));
        let whole = reference(lost, hash, Some(packed.clone()));
        let session = Session { recording: Some(whole), embed: true, ..Session::default() };
        let mut plugin = open(format);
        load_session(plugin.as_mut(), &preset("default", &[]), &session);
        let found = play(plugin.as_mut(), &input, &options);
        load_session(plugin.as_mut(), &preset("default", &[]), &pyrophone_tests::session(Some(&path), None));
        assert_same(&found, &play(plugin.as_mut(), &input, &options), &format!("{format}, embedded"));
        assert_ne!(found, expected, "{format}");
    }
}

#[test]
fn a_later_versions_session_is_saved_as_it_was() {
    let later = "{\"version\":99,\"magic\":[1,2,3]}";
    for format in Format::ALL {
        let good = plugin_state(&preset("default", &[]), &Session::default());
        let mut plugin = open(format);
        plugin.set_state(&wrap(format, &with_session(&good, later))).expect("taken");
        await_recording(plugin.as_mut(), RATE_HZ, MONO);
        let saved = State::from_bytes(format, &plugin.state().expect("a state")).expect("a state");
        let text: String = serde_json::from_str(&saved.fields[FIELD]).expect("a string");
        assert_eq!(text, later, "{format}");
    }
}
