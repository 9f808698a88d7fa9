//! Events that carry values of parameters, between the host's scale and the framework's.
//!
//! The framework counts whole numbers from 0. Those that are never automated are shown to hosts as they are
//! ([`params`](super::params)), so that their values are shifted on the way in and out.

use std::ffi::c_void;

use clap_sys::events::{
    CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_PARAM_VALUE, clap_event_header, clap_event_param_value, clap_input_events,
    clap_output_events,
};

use super::params::shift;
use super::plugin::Guard;

/// Events that may be in use at once: the framework looks at one and at the next.
const IN_USE: usize = 4;

/// Room for shifted events of the call under way.
pub struct Scratch {
    events: [Option<clap_event_param_value>; IN_USE],
}

// SAFETY: what an event points to is the host's and only passed through within a call.
unsafe impl Send for Scratch {}

impl Default for Scratch {
    fn default() -> Self {
        Self { events: [const { None }; IN_USE] }
    }
}

struct Incoming<'a> {
    host: &'a clap_input_events,
    scratch: *mut Scratch,
}

/// The event as one that sets a parameter whose values are shifted, and by how much.
///
/// # Safety
/// `event` is null or a live event.
unsafe fn shifted(event: *const clap_event_header) -> Option<(clap_event_param_value, f64)> {
    // SAFETY: by the caller's word.
    let header = unsafe { event.as_ref() }?;
    if header.space_id != CLAP_CORE_EVENT_SPACE_ID || header.type_ != CLAP_EVENT_PARAM_VALUE {
        return None;
    }
    // SAFETY: events of this type are of this size.
    let event = unsafe { *event.cast::<clap_event_param_value>() };
    shift(event.param_id).map(|shift| (event, shift))
}

unsafe extern "C" fn size(list: *const clap_input_events) -> u32 {
    // SAFETY: made in `translated`, and used only within it.
    let incoming = unsafe { &*(*list).ctx.cast::<Incoming<'_>>() };
    // SAFETY: the host's own list.
    incoming.host.size.map_or(0, |size| unsafe { size(incoming.host) })
}

unsafe extern "C" fn get(list: *const clap_input_events, index: u32) -> *const clap_event_header {
    // SAFETY: made in `translated`, and used only within it.
    let incoming = unsafe { &*(*list).ctx.cast::<Incoming<'_>>() };
    let Some(get) = incoming.host.get else { return std::ptr::null() };
    // SAFETY: the host's own list.
    let event = unsafe { get(incoming.host, index) };
    // SAFETY: null or a live event.
    let Some((mut own, shift)) = (unsafe { shifted(event) }) else { return event };
    own.value -= shift;
    // SAFETY: held by `translated` for this call alone; older events than the framework looks at are overwritten.
    let place = unsafe { &mut (*incoming.scratch).events[index as usize % IN_USE] };
    std::ptr::from_ref(&place.insert(own).header)
}

unsafe extern "C" fn try_push(list: *const clap_output_events, event: *const clap_event_header) -> bool {
    // SAFETY: made in `translated`, and used only within it.
    let host = unsafe { &*(*list).ctx.cast::<clap_output_events>() };
    let Some(push) = host.try_push else { return false };
    // SAFETY: null or a live event.
    match unsafe { shifted(event) } {
        Some((mut own, shift)) => {
            own.value += shift;
            // SAFETY: the host's own list, which copies the event.
            unsafe { push(host, &own.header) }
        }
        // SAFETY: the host's own list and the framework's event.
        None => unsafe { push(host, event) },
    }
}

/// Calls `work` with lists that shift values, in place of the host's; real-time safe. Lists that are null stay null.
///
/// # Safety
/// The lists are null or live as long as the call.
pub unsafe fn translated<T>(
    guard: &Guard,
    incoming: *const clap_input_events,
    outgoing: *const clap_output_events,
    work: impl FnOnce(*const clap_input_events, *const clap_output_events) -> T,
) -> T {
    // Processing and flushing exclude each other by CLAP's rules; a host that breaks them gets its own lists.
    let Ok(mut scratch) = guard.events.try_lock() else { return work(incoming, outgoing) };
    // SAFETY: by the caller's word.
    let (host_in, host_out) = unsafe { (incoming.as_ref(), outgoing.as_ref()) };
    let context = host_in.map(|host| Incoming { host, scratch: &raw mut *scratch });
    let list_in = context.as_ref().map(|context| clap_input_events {
        ctx: std::ptr::from_ref(context).cast::<c_void>().cast_mut(),
        size: Some(size),
        get: Some(get),
    });
    let list_out = host_out.map(|host| clap_output_events {
        ctx: std::ptr::from_ref(host).cast::<c_void>().cast_mut(),
        try_push: Some(try_push),
    });
    work(
        list_in.as_ref().map_or(std::ptr::null(), std::ptr::from_ref),
        list_out.as_ref().map_or(std::ptr::null(), std::ptr::from_ref),
    )
}
