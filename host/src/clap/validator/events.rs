//! Lists of events, and buses, as the C interface has them.

use clap_sys::audio_buffer::clap_audio_buffer;
use clap_sys::events::{
    CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_PARAM_VALUE, clap_event_header, clap_event_param_value, clap_input_events,
    clap_output_events,
};

/// Events of one block or flush.
pub(super) struct Events<'a>(pub &'a [clap_event_param_value]);

impl Events<'_> {
    /// The list as a plug-in reads it.
    pub fn as_clap(&self) -> clap_input_events {
        unsafe extern "C" fn size(list: *const clap_input_events) -> u32 {
            // SAFETY: made below.
            let events = unsafe { &*(*list).ctx.cast::<Events<'_>>() };
            events.0.len() as u32
        }
        unsafe extern "C" fn get(list: *const clap_input_events, index: u32) -> *const clap_event_header {
            // SAFETY: made below.
            let events = unsafe { &*(*list).ctx.cast::<Events<'_>>() };
            events.0.get(index as usize).map_or(std::ptr::null(), |event| &raw const event.header)
        }
        clap_input_events { ctx: std::ptr::from_ref(self).cast_mut().cast(), size: Some(size), get: Some(get) }
    }
}

/// A list that accepts any event and keeps none.
pub(super) fn no_output() -> clap_output_events {
    unsafe extern "C" fn push(_list: *const clap_output_events, _event: *const clap_event_header) -> bool {
        true
    }
    clap_output_events { ctx: std::ptr::null_mut(), try_push: Some(push) }
}

/// A parameter set to a plain value, at the first sample.
pub(super) fn event(id: u32, value: f64) -> clap_event_param_value {
    clap_event_param_value {
        header: clap_event_header {
            size: size_of::<clap_event_param_value>() as u32,
            time: 0,
            space_id: CLAP_CORE_EVENT_SPACE_ID,
            type_: CLAP_EVENT_PARAM_VALUE,
            flags: 0,
        },
        param_id: id,
        cookie: std::ptr::null_mut(),
        note_id: -1,
        port_index: -1,
        channel: -1,
        key: -1,
        value,
    }
}

/// A bus with these channels.
pub(super) fn bus(channels: &mut [*mut f32]) -> clap_audio_buffer {
    clap_audio_buffer {
        data32: channels.as_mut_ptr(),
        data64: std::ptr::null_mut(),
        channel_count: channels.len() as u32,
        latency: 0,
        constant_mask: 0,
    }
}

/// A bus that claims channels without even having pointers.
pub(super) fn null_channels(channels: u32) -> clap_audio_buffer {
    clap_audio_buffer {
        data32: std::ptr::null_mut(),
        data64: std::ptr::null_mut(),
        channel_count: channels,
        latency: 0,
        constant_mask: 0,
    }
}
