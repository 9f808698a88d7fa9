//! Events with values of parameters, converted between the host's scale and the framework's.
//!
//! The framework counts whole numbers from 0. Those that are never automated are shown to hosts with their plain values
//! ([`params`](super::params)), so their values are shifted on the way in and out. Messages of MIDI controllers become
//! values on the way in ([`controllers`](super::controllers)).

use std::ffi::c_void;

use clap_sys::events::{
    CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_PARAM_VALUE, clap_event_header, clap_event_param_value, clap_input_events,
    clap_output_events,
};

use super::controllers::{EventSource, event_of};
use super::guard::Guard;
use super::scale::shift;
use super::scratch::{IN_USE, Scratch};
use crate::controllers::Controllers;

struct Incoming<'a> {
    host: &'a clap_input_events,
    controllers: &'a Controllers,
    scratch: *mut Scratch,
}

impl Incoming<'_> {
    fn count(&self) -> u32 {
        // SAFETY: the host's own list.
        self.host.size.map_or(0, |size| unsafe { size(self.host) })
    }

    fn event(&self, place: u32) -> *const clap_event_header {
        // SAFETY: the host's own list.
        self.host.get.map_or(std::ptr::null(), |get| unsafe { get(self.host, place) })
    }
}

/// The event, if it sets a parameter whose values are shifted, and the size of the shift.
///
/// # Safety
/// `event` is null or a live event.
unsafe fn shifted(event: *const clap_event_header) -> Option<(clap_event_param_value, f64)> {
    // SAFETY: guaranteed by the caller.
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
    // SAFETY: `translated` holds it for this call alone.
    incoming.count() + unsafe { &(*incoming.scratch).messages }.added()
}

unsafe extern "C" fn get(list: *const clap_input_events, index: u32) -> *const clap_event_header {
    // SAFETY: made in `translated`, and used only within it.
    let incoming = unsafe { &*(*list).ctx.cast::<Incoming<'_>>() };
    // SAFETY: `translated` holds it for this call alone.
    let scratch = unsafe { &mut *incoming.scratch };
    let own = match scratch.messages.event_at(incoming.controllers, index) {
        EventSource::Value { index, share, time } => event_of(index, share, time),
        EventSource::Host(place) => {
            let event = incoming.event(place);
            // SAFETY: null or a live event.
            let Some((mut own, shift)) = (unsafe { shifted(event) }) else { return event };
            own.value -= shift;
            own
        }
    };
    // Events older than the framework's lookahead are overwritten.
    std::ptr::from_ref(&scratch.events[index as usize % IN_USE].insert(own).header)
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

/// Calls `work` with lists that shift values and follow MIDI controllers, in place of the host's; real-time safe. Null
/// lists stay null.
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
    // SAFETY: guaranteed by the caller.
    let (host_in, host_out) = unsafe { (incoming.as_ref(), outgoing.as_ref()) };
    let controllers = &guard.instance.params.controllers;
    let context = host_in.map(|host| Incoming { host, controllers, scratch: &raw mut *scratch });
    if let Some(context) = &context {
        // SAFETY: the host's events, and the scratch locked above.
        unsafe { (*context.scratch).messages.read(controllers, context.count(), |place| context.event(place)) };
        // Before all other events that go out, because a list is in order of time.
        if let Some((host, push)) = host_out.and_then(|host| Some((host, host.try_push?))) {
            // SAFETY: the scratch locked above.
            for moved in unsafe { &(*context.scratch).messages }.moved(controllers) {
                // SAFETY: the host's own list, which copies the event.
                unsafe { push(host, &moved.header) };
            }
        }
    }
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
