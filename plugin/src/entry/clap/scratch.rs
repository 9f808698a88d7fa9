//! Room for events of our own while a call of the host's lasts.

use clap_sys::events::clap_event_param_value;

use super::controllers::Messages;

/// Events that may be in use at once: the framework looks at one and at the next.
pub(super) const IN_USE: usize = 4;

/// Room for events of our own in the call under way.
#[derive(Default)]
pub struct Scratch {
    pub(super) events: [Option<clap_event_param_value>; IN_USE],
    pub(super) messages: Messages,
}

// SAFETY: what an event points to is the host's and only passed through within a call.
unsafe impl Send for Scratch {}
