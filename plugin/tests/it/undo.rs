//! Undo, A and B: what the user did is taken back, and what the host automates stays.

use std::sync::Arc;

use nice_plug::prelude::*;
use nice_plug_egui::RepaintNotifier;
use pyrophone::editor::history::{Entry, UndoHistory};
use pyrophone::editor::inert::Reasons;
use pyrophone::editor::param_editor::ParamEditor;
use pyrophone::loader::Loader;
use pyrophone::parameters::EffectParams;
use pyrophone::persist;
use pyrophone_settings::session::{Cut, FIELD};
use pyrophone_settings::{COUNT, Id, Preset, PresetRecording, Session};

use crate::screen::deaf_host;

/// Does something by hand.
fn by_hand<T>(
    (loader, params): &(Loader, Arc<EffectParams>),
    history: &mut UndoHistory,
    work: impl FnOnce(&mut ParamEditor<'_>) -> T,
) -> T {
    let host = deaf_host::obedient_context();
    let (setter, inert): (_, Reasons) = (host.param_setter(), [None; COUNT]);
    work(&mut ParamEditor { params, setter: &setter, loader: &loader.handle(), history, inert: &inert })
}

fn instance() -> (Loader, Arc<EffectParams>) {
    let (loader, params, _) = Loader::start(RepaintNotifier::new(), None);
    (loader, params)
}

fn factory(name: &str) -> Option<Arc<Entry>> {
    Some(Arc::new(Entry { preset: Preset::find(name).expect("a preset"), path: None }))
}

#[test]
fn undo_leaves_alone_what_the_host_automates() {
    let (instance, mut history) = (instance(), UndoHistory::default());
    let params = &instance.1;
    let value = |id: Id| params.value(id as usize);
    by_hand(&instance, &mut history, |hand| hand.set_once(Id::Alpha as usize, 3.0));
    params.slot(Id::Cutoff as usize).set_without_host(300.0);
    by_hand(&instance, &mut history, |hand| hand.undo());
    assert_eq!((value(Id::Alpha), value(Id::Cutoff)), (2.5, 300.0));
    by_hand(&instance, &mut history, |hand| hand.redo());
    assert_eq!((value(Id::Alpha), value(Id::Cutoff)), (3.0, 300.0));
    // Nor does a gesture take with it what the host moves meanwhile.
    by_hand(&instance, &mut history, |hand| {
        hand.begin(Id::Alpha as usize);
        hand.params.slot(Id::Cutoff as usize).set_without_host(400.0);
        hand.set(Id::Alpha as usize, 4.0);
        hand.end(Id::Alpha as usize);
        hand.undo();
    });
    assert_eq!((value(Id::Alpha), value(Id::Cutoff)), (3.0, 400.0));
}

#[test]
fn undo_of_a_preset_brings_its_name_back() {
    let (instance, mut history) = (instance(), UndoHistory::default());
    let params = &instance.1;
    by_hand(&instance, &mut history, |hand| hand.choose(factory("extend")));
    by_hand(&instance, &mut history, |hand| hand.choose(factory("campfire")));
    let name = |history: &UndoHistory| history.chosen.as_ref().map(|entry| entry.preset.name.clone());
    assert_eq!(name(&history).as_deref(), Some("campfire"));
    by_hand(&instance, &mut history, |hand| hand.undo());
    assert_eq!(name(&history).as_deref(), Some("extend"));
    assert_eq!(params.values(), Preset::find("extend").expect("a preset").values);
    by_hand(&instance, &mut history, |hand| hand.redo());
    assert_eq!(name(&history).as_deref(), Some("campfire"));
    by_hand(&instance, &mut history, |hand| hand.undo());
    by_hand(&instance, &mut history, |hand| hand.undo());
    assert_eq!(name(&history), None);
}

#[test]
fn history_survives_a_and_b_and_the_copy_can_be_undone() {
    let (instance, mut history) = (instance(), UndoHistory::default());
    let params = &instance.1;
    let alpha = || params.value(Id::Alpha as usize);
    let set = |history: &mut UndoHistory, plain: f64| {
        by_hand(&instance, history, |hand| hand.set_once(Id::Alpha as usize, plain));
    };
    set(&mut history, 3.0);
    by_hand(&instance, &mut history, |hand| hand.exchange());
    assert!(history.is_b() && alpha() == 3.0);
    set(&mut history, 5.0);
    by_hand(&instance, &mut history, |hand| hand.exchange());
    assert_eq!((history.is_b(), alpha()), (false, 3.0));
    // B becomes as A is; undone, it has its own again.
    by_hand(&instance, &mut history, |hand| hand.copy());
    by_hand(&instance, &mut history, |hand| hand.undo());
    by_hand(&instance, &mut history, |hand| hand.exchange());
    assert_eq!((history.is_b(), alpha()), (true, 5.0));
    // Step by step to the very beginning: the exchanges are steps too.
    for expected in [(false, 3.0), (true, 5.0), (true, 3.0), (false, 3.0), (false, 2.5)] {
        by_hand(&instance, &mut history, |hand| hand.undo());
        assert_eq!((history.is_b(), alpha()), expected);
    }
    assert!(!history.can_undo() && history.can_redo());
}

/// The session that the host would save.
fn saved(params: &EffectParams) -> Session {
    persist::decode(&params.serialize_fields()[FIELD]).expect("a session")
}

#[test]
fn preset_and_its_recording_are_one_step() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("fire.wav");
    let samples: Vec<f32> = (0..48_000).map(|n| 0.3 * (0.1 * n as f32).sin()).collect();
    pyrophone_recording::write_wav_f32(&file, &[samples], 48_000).expect("a file");
    let cut = Cut { region_s: Some([0.25, 0.75]), gain_db: -6.0, normalise: true };
    let recording = Some(PresetRecording { file: file.clone(), cut });
    let preset = Preset { recording, ..Preset::find("extend").expect("a preset") };
    let entry = Some(Arc::new(Entry { preset, path: None }));
    let (instance, mut history) = (instance(), UndoHistory::default());
    let (loader, params) = &instance;
    by_hand(&instance, &mut history, |hand| hand.set_once(Id::RecordingSlot as usize, 1.0));
    let settled = |is_loaded: bool| {
        assert!(loader.wait_for_all());
        let session = saved(params);
        let path = session.recording_in(1).map(|found| found.path.clone());
        let expected = if is_loaded { (file.to_str(), cut) } else { (None, Cut::default()) };
        assert_eq!((path.as_deref(), session.cut_in(1)), expected);
        assert_eq!(session.recording_in(0), None);
    };
    by_hand(&instance, &mut history, |hand| hand.choose(entry.clone()));
    settled(true);
    // It is there already, so nothing changes.
    by_hand(&instance, &mut history, |hand| hand.choose(entry.clone()));
    by_hand(&instance, &mut history, |hand| hand.undo());
    settled(false);
    assert_eq!(params.value(Id::RecordingSlot as usize), 1.0, "one step alone");
    by_hand(&instance, &mut history, |hand| hand.redo());
    settled(true);
    // A preset without a recording leaves the present one.
    by_hand(&instance, &mut history, |hand| hand.choose(factory("campfire")));
    settled(true);
}
