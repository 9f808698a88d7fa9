//! Memory for our own events during a call from the host.

use clap_sys::events::clap_event_param_value;

use super::controllers::Messages;

/// Events that may be in use at once: the framework reads one and the next.
pub(super) const IN_USE: usize = 4;

/// Memory for our own events in the current call.
#[derive(Default)]
pub struct Scratch {
    pub(super) events: [Option<clap_event_param_value>; IN_USE],
    pub(super) messages: Messages,
}

// SAFETY: the pointers in events belong to the host and are only passed on within a call.
unsafe impl Send for Scratch {}
