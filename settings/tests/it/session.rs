//! What a session keeps: round trips, and damaged ones.

use proptest::prelude::*;
use pyrophone_settings::session::{Cut, FieldReference, Learned, RecordingReference, Session, Slot, plugin_state};
use pyrophone_settings::{Error, Values};

fn full() -> Session {
    Session {
        recording: Some(RecordingReference {
            path: "/sound/\"fire\" 火.wav".to_owned(),
            content_hash: "ab".repeat(32),
            embedded: Some("eJw=".to_owned()),
        }),
        embed: true,
        learned: Some(Learned {
            sample_rate_hz: 48_000.0,
            levels: 6,
            companded: true,
            quantiles: vec![0.0, 1e-300, 0.1, 0.3],
        }),
        field: Some(FieldReference { path: "/caches/flame.field".to_owned(), bytes: vec![0, 255, 7] }),
        cut: Cut { region_s: Some([0.5, 2.25]), gain_db: -3.0, normalise: true },
        others: [Slot::default(), other(), Slot::default()],
    }
}

/// What is in another slot.
fn other() -> Slot {
    let recording =
        RecordingReference { path: "/sound/embers.wav".to_owned(), content_hash: "cd".repeat(32), embedded: None };
    Slot { recording: Some(recording), cut: Cut { gain_db: 6.0, ..Cut::default() } }
}

#[test]
fn slots_are_numbered_from_the_first_recording() {
    let mut session = full();
    assert_eq!(session.recording_in(0), session.recording.as_ref());
    assert_eq!((session.recording_in(1), session.recording_in(2)), (None, other().recording.as_ref()));
    assert_eq!((session.cut_in(0), session.cut_in(2), session.recording_in(4)), (session.cut, other().cut, None));
    *session.recording_in_mut(3) = other().recording;
    session.cut_in_mut(0).gain_db = 1.0;
    assert_eq!((&session.others[2].recording, session.cut.gain_db), (&other().recording, 1.0));
}

#[test]
fn sessions_from_before_there_were_slots_have_one() {
    let mut session = full();
    session.others = Default::default();
    assert!(!session.to_json().contains("others"), "as it was written before");
    assert_eq!(Session::from_json(&session.to_json()).unwrap(), session);
}

#[test]
fn round_trip() {
    for session in [Session::default(), full()] {
        assert_eq!(Session::from_json(&session.to_json()).unwrap(), session);
    }
}

#[test]
fn damaged_texts_are_refused() {
    let good = full().to_json();
    let mut bad: Vec<String> = ["", "{}", "null", "[]", "7", "\"x\"", "{\"version\":\"1\"}", "{\"version\":-1}"]
        .into_iter()
        .map(str::to_owned)
        .collect();
    bad.push(good[..good.len() / 2].to_owned());
    bad.push(good.replace("\"path\"", "\"pfad\""));
    bad.push(good.replace("true", "\"yes\""));
    bad.push(good.replace("AP8H", "A*8H"));
    assert!(good.contains("AP8H"), "a field's bytes are Base64");
    bad.push(good.replace("\"levels\":6", "\"levels\":-6"));
    bad.push(good.replace("\"quantiles\":\"AAAA", "\"quantiles\":\"A*AA"));
    let with = |quantiles: Vec<f64>| {
        let learned = Some(Learned { sample_rate_hz: 48_000.0, levels: 6, companded: true, quantiles });
        Session { learned, ..Session::default() }.to_json()
    };
    bad.extend([with(vec![]), with(vec![0.2, 0.1]), with(vec![f64::NAN]), with(vec![-1.0]), with(vec![0.0; 65_537])]);
    bad.push(good.replace("[0.5,2.25]", "[2.25,0.5]"));
    bad.push(good.replace("[0.5,2.25]", "[0.5]"));
    bad.push(good.replace("\"gain_db\":-3.0", "\"gain_db\":1e9"));
    bad.push(good.replace("\"gain_db\":6.0", "\"gain_db\":61.0"));
    bad.push(good.replace("\"others\":[{},", "\"others\":[{},{},{},{},"));
    assert!(bad.iter().all(|text| *text != good), "every one is damaged");
    for text in bad {
        assert!(matches!(Session::from_json(&text), Err(Error::Session { .. })), "{text:.80}");
    }
    assert!(matches!(Session::from_json("{\"version\":2}"), Err(Error::SessionVersion { found: 2, .. })));
}

#[test]
fn sessions_from_before_there_was_a_cut_take_all_of_the_recording() {
    let whole = Session { cut: Cut::default(), others: Default::default(), ..full() };
    assert!(!whole.to_json().contains("cut"), "and builds of that time can read what is saved");
    assert_eq!(Session::from_json(&whole.to_json()).unwrap(), whole);
}

#[test]
fn plugin_state_nests_the_session() {
    let session = full();
    let state: serde_json::Value = serde_json::from_str(&plugin_state(&Values::default(), &session)).unwrap();
    assert_eq!(state["params"]["alpha"]["f32"], 2.5);
    assert_eq!(state["params"]["levels"]["i32"], 6);
    assert_eq!(state["params"]["gate"]["bool"], true);
    let field: String = serde_json::from_str(state["fields"]["pyrophone"].as_str().unwrap()).unwrap();
    assert_eq!(Session::from_json(&field).unwrap(), session);
}

proptest! {
    #[test]
    fn any_text_is_survived(text in ".*") {
        let _ = Session::from_json(&text);
    }

    #[test]
    fn quantiles_are_exact(mut quantiles in prop::collection::vec(0f64..1e9, 1..50)) {
        quantiles.sort_by(f64::total_cmp);
        let learned = Some(Learned { sample_rate_hz: 44_100.0, levels: 6, companded: true, quantiles });
        let session = Session { learned, ..Session::default() };
        prop_assert_eq!(Session::from_json(&session.to_json()).unwrap(), session);
    }
}
