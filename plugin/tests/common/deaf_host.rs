//! A host for windows that takes no notice of what they say.

use std::sync::Arc;

use nice_plug::prelude::*;
use nice_plug_core::context::gui::{GuiContext, GuiContextInner};

struct DeafHost;

impl GuiContextInner for DeafHost {
    fn plugin_api(&self) -> PluginApi {
        PluginApi::Clap
    }
    unsafe fn raw_begin_set_parameter(&self, _: ParamPtr) {}
    unsafe fn raw_set_parameter_normalized(&self, _: ParamPtr, _: f32) {}
    unsafe fn raw_end_set_parameter(&self, _: ParamPtr) {}
    fn get_state(&self) -> PluginState {
        PluginState { version: String::new(), params: Default::default(), fields: Default::default() }
    }
    fn set_state(&self, _: PluginState) {}
    fn request_restart(&self) {}
}

/// What a window is given to speak to such a host.
pub fn context() -> GuiContext {
    GuiContext::new(Arc::new(DeafHost))
}
