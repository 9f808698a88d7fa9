//! Undo, A and B: what the user did is taken back, and what the host automates stays.

use std::sync::Arc;

use nice_plug::prelude::*;
use nice_plug_core::context::gui::{GuiContext, GuiContextInner};
use pyrophone::editor::history::{Entry, UndoHistory};
use pyrophone::editor::inert::Reasons;
use pyrophone::editor::param_editor::ParamEditor;
use pyrophone::parameters::EffectParams;
use pyrophone::persist::SessionStore;
use pyrophone_settings::{COUNT, Id, Preset};

/// A host that does at once what the window asks.
struct Host;

impl GuiContextInner for Host {
    fn plugin_api(&self) -> PluginApi {
        PluginApi::Clap
    }
    unsafe fn raw_begin_set_parameter(&self, _: ParamPtr) {}
    unsafe fn raw_set_parameter_normalized(&self, parameter: ParamPtr, normalised: f32) {
        // SAFETY: the parameters outlive the window.
        unsafe { parameter._internal_set_normalized_value(normalised) };
    }
    unsafe fn raw_end_set_parameter(&self, _: ParamPtr) {}
    fn get_state(&self) -> PluginState {
        PluginState { version: String::new(), params: Default::default(), fields: Default::default() }
    }
    fn set_state(&self, _: PluginState) {}
    fn request_restart(&self) {}
}

/// Does something by hand.
fn by_hand<T>(params: &EffectParams, history: &mut UndoHistory, work: impl FnOnce(&mut ParamEditor<'_>) -> T) -> T {
    let host = GuiContext::new(Arc::new(Host));
    let (setter, inert): (_, Reasons) = (host.param_setter(), [None; COUNT]);
    work(&mut ParamEditor { params, setter: &setter, history, inert: &inert })
}

fn params() -> EffectParams {
    EffectParams::new(Arc::new(SessionStore::new(|| {})))
}

fn factory(name: &str) -> Option<Arc<Entry>> {
    Some(Arc::new(Entry { preset: Preset::find(name).expect("a preset"), path: None }))
}

#[test]
fn undo_leaves_alone_what_the_host_automates() {
    let (params, mut history) = (params(), UndoHistory::default());
    let value = |id: Id| params.value(id as usize);
    by_hand(&params, &mut history, |hand| hand.set_once(Id::Alpha as usize, 3.0));
    params.slot(Id::Cutoff as usize).set_without_host(300.0);
    by_hand(&params, &mut history, |hand| hand.undo());
    assert_eq!((value(Id::Alpha), value(Id::Cutoff)), (2.5, 300.0));
    by_hand(&params, &mut history, |hand| hand.redo());
    assert_eq!((value(Id::Alpha), value(Id::Cutoff)), (3.0, 300.0));
    // Nor does a gesture take with it what the host moves meanwhile.
    by_hand(&params, &mut history, |hand| {
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
    let (params, mut history) = (params(), UndoHistory::default());
    by_hand(&params, &mut history, |hand| hand.choose(factory("extend")));
    by_hand(&params, &mut history, |hand| hand.choose(factory("campfire")));
    let name = |history: &UndoHistory| history.chosen.as_ref().map(|entry| entry.preset.name.clone());
    assert_eq!(name(&history).as_deref(), Some("campfire"));
    by_hand(&params, &mut history, |hand| hand.undo());
    assert_eq!(name(&history).as_deref(), Some("extend"));
    assert_eq!(params.values(), Preset::find("extend").expect("a preset").values);
    by_hand(&params, &mut history, |hand| hand.redo());
    assert_eq!(name(&history).as_deref(), Some("campfire"));
    by_hand(&params, &mut history, |hand| hand.undo());
    by_hand(&params, &mut history, |hand| hand.undo());
    assert_eq!(name(&history), None);
}

#[test]
fn history_survives_a_and_b_and_the_copy_can_be_undone() {
    let (params, mut history) = (params(), UndoHistory::default());
    let alpha = || params.value(Id::Alpha as usize);
    let set = |history: &mut UndoHistory, plain: f64| {
        by_hand(&params, history, |hand| hand.set_once(Id::Alpha as usize, plain));
    };
    set(&mut history, 3.0);
    by_hand(&params, &mut history, |hand| hand.exchange());
    assert!(history.is_b() && alpha() == 3.0);
    set(&mut history, 5.0);
    by_hand(&params, &mut history, |hand| hand.exchange());
    assert_eq!((history.is_b(), alpha()), (false, 3.0));
    // B becomes as A is; undone, it has its own again.
    by_hand(&params, &mut history, |hand| hand.copy());
    by_hand(&params, &mut history, |hand| hand.undo());
    by_hand(&params, &mut history, |hand| hand.exchange());
    assert_eq!((history.is_b(), alpha()), (true, 5.0));
    // Step by step to the very beginning: the exchanges are steps too.
    for expected in [(false, 3.0), (true, 5.0), (true, 3.0), (false, 3.0), (false, 2.5)] {
        by_hand(&params, &mut history, |hand| hand.undo());
        assert_eq!((history.is_b(), alpha()), expected);
    }
    assert!(!history.can_undo() && history.can_redo());
}
