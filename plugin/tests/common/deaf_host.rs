//! Hosts for windows: one that takes no notice of what they say, and one that does at once what they ask.

use std::sync::Arc;

use nice_plug::prelude::*;
use nice_plug_core::context::gui::{GuiContext, GuiContextInner};

struct Host {
    obeys: bool,
}

impl GuiContextInner for Host {
    fn plugin_api(&self) -> PluginApi {
        PluginApi::Clap
    }
    unsafe fn raw_begin_set_parameter(&self, _: ParamPtr) {}
    unsafe fn raw_set_parameter_normalized(&self, parameter: ParamPtr, normalised: f32) {
        if self.obeys {
            // SAFETY: the parameters outlive the window.
            unsafe { parameter._internal_set_normalized_value(normalised) };
        }
    }
    unsafe fn raw_end_set_parameter(&self, _: ParamPtr) {}
    fn get_state(&self) -> PluginState {
        PluginState { version: String::new(), params: Default::default(), fields: Default::default() }
    }
    fn set_state(&self, _: PluginState) {}
    fn request_restart(&self) {}
}

/// Connection to a host that takes no notice.
#[allow(dead_code, reason = "not every test has a deaf host")]
pub fn context() -> GuiContext {
    GuiContext::new(Arc::new(Host { obeys: false }))
}

/// Connection to a host that does at once what the window asks.
#[allow(dead_code, reason = "not every test has an obedient host")]
pub fn obedient_context() -> GuiContext {
    GuiContext::new(Arc::new(Host { obeys: true }))
}
