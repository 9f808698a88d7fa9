//! What tests and benches of the whole effect share.

use nice_plug::prelude::*;
use nice_plug_core::context::process::SendEventError;
use pyrophone::Pyrophone;
use pyrophone::effect::EffectTask;

/// A host that listens and answers nothing.
pub struct Context {
    /// What it says of the timeline.
    pub transport: Transport,
}

impl ProcessContext<Pyrophone> for Context {
    fn plugin_api(&self) -> PluginApi {
        PluginApi::Clap
    }
    fn execute_background(&self, _: EffectTask) {}
    fn execute_gui(&self, _: EffectTask) {}
    fn transport(&self) -> &Transport {
        &self.transport
    }
    fn next_event(&mut self) -> Option<PluginNoteEvent<Pyrophone>> {
        None
    }
    fn try_send_event(
        &mut self,
        event: PluginNoteEvent<Pyrophone>,
    ) -> Result<(), (PluginNoteEvent<Pyrophone>, SendEventError)> {
        Err((event, SendEventError::NoOutputBuffer))
    }
    fn set_latency_samples(&self, _: u32) {}
    fn request_restart(&self) {}
    fn set_current_voice_capacity(&self, _: u32) {}
}

impl ActivateContext<Pyrophone> for Context {
    fn plugin_api(&self) -> PluginApi {
        PluginApi::Clap
    }
    fn execute(&self, _: EffectTask) {}
    fn set_latency_samples(&self, _: u32) {}
    fn set_current_voice_capacity(&self, _: u32) {}
}
