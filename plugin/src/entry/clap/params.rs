//! Parameters as CLAP hosts see them.
//!
//! Choices are enumerations; they, switches and whole numbers are not modulated, because values between two of them
//! make no sense. Whole numbers that are never automated (levels, window, feature, half-width) have their plain values.
//! The other ones (`vortex_sources`) keep the framework's values, counted from 0: hosts have stored automation in them.

use std::ffi::{CStr, c_char};

use clap_sys::events::{clap_input_events, clap_output_events};
use clap_sys::ext::params::{CLAP_PARAM_IS_ENUM, CLAP_PARAM_IS_MODULATABLE, clap_param_info, clap_plugin_params};
use clap_sys::id::clap_id;
use clap_sys::plugin::clap_plugin;
use pyrophone_settings::{PARAMETERS, ParameterKind};

use super::events;
use super::guard::Guard;
use super::scale::shift;
use crate::entry::instance::index_of_numeric;

/// Extension for parameters, on top of the framework's.
pub static PARAMS: clap_plugin_params = clap_plugin_params {
    count: Some(count),
    get_info: Some(get_info),
    get_value: Some(get_value),
    value_to_text: Some(value_to_text),
    text_to_value: Some(text_to_value),
    flush: Some(flush),
};

/// Steps as whole numbers: the framework multiplies 32-bit shares (6.0000001).
fn whole(index: usize, value: f64) -> f64 {
    if matches!(PARAMETERS[index].kind, ParameterKind::Float { .. }) { value } else { value.round() }
}

/// Converts a value from the framework's scale to the host's.
///
/// # Safety
/// `value` is valid for reading and writing.
unsafe fn to_host(id: clap_id, value: *mut f64) {
    if let Some(index) = index_of_numeric(id) {
        // SAFETY: guaranteed by the caller.
        unsafe { *value = whole(index, *value + shift(id).unwrap_or(0.0)) };
    }
}

unsafe extern "C" fn count(plugin: *const clap_plugin) -> u32 {
    // SAFETY: a live plug-in.
    let guard = unsafe { Guard::of(plugin) };
    // SAFETY: as above.
    guard.and_then(|guard| guard.params()?.count).map_or(0, |count| unsafe { count(plugin) })
}

unsafe extern "C" fn get_info(plugin: *const clap_plugin, index: u32, info: *mut clap_param_info) -> bool {
    // The framework panics at the index after the last.
    // SAFETY: a live plug-in.
    if info.is_null() || index >= unsafe { count(plugin) } {
        return false;
    }
    // SAFETY: a live plug-in.
    let Some(get) = (unsafe { Guard::of(plugin) }).and_then(|guard| guard.params()?.get_info) else { return false };
    // SAFETY: a live plug-in and a writable location.
    if !unsafe { get(plugin, index, info) } {
        return false;
    }
    // SAFETY: just written.
    let info = unsafe { &mut *info };
    if let Some(index) = index_of_numeric(info.id) {
        let kind = PARAMETERS[index].kind;
        if !matches!(kind, ParameterKind::Float { .. }) {
            info.flags &= !CLAP_PARAM_IS_MODULATABLE;
        }
        if matches!(kind, ParameterKind::Choice { .. }) {
            info.flags |= CLAP_PARAM_IS_ENUM;
        }
        let shift = shift(info.id).unwrap_or(0.0);
        info.min_value += shift;
        info.max_value += shift;
        info.default_value = whole(index, info.default_value + shift);
    }
    true
}

unsafe extern "C" fn get_value(plugin: *const clap_plugin, id: clap_id, value: *mut f64) -> bool {
    // SAFETY: a live plug-in.
    let Some(get) = (unsafe { Guard::of(plugin) }).and_then(|guard| guard.params()?.get_value) else { return false };
    // SAFETY: a live plug-in; the function rejects null.
    let is_known = unsafe { get(plugin, id, value) };
    if is_known {
        // SAFETY: just written.
        unsafe { to_host(id, value) };
    }
    is_known
}

unsafe extern "C" fn value_to_text(
    plugin: *const clap_plugin,
    id: clap_id,
    value: f64,
    text: *mut c_char,
    size: u32,
) -> bool {
    if size == 0 || !value.is_finite() {
        return false;
    }
    // SAFETY: a live plug-in.
    let Some(get) = (unsafe { Guard::of(plugin) }).and_then(|guard| guard.params()?.value_to_text) else {
        return false;
    };
    // SAFETY: a live plug-in and room for `size` bytes; the function rejects null.
    unsafe { get(plugin, id, value - shift(id).unwrap_or(0.0), text, size) }
}

unsafe extern "C" fn text_to_value(
    plugin: *const clap_plugin,
    id: clap_id,
    text: *const c_char,
    value: *mut f64,
) -> bool {
    // SAFETY: a live plug-in.
    let Some(get) = (unsafe { Guard::of(plugin) }).and_then(|guard| guard.params()?.text_to_value) else {
        return false;
    };
    // SAFETY: a text of the host's, if it is one.
    if text.is_null() || unsafe { CStr::from_ptr(text) }.to_str().is_err() {
        return false;
    }
    // SAFETY: a live plug-in and a text; the function rejects null.
    let is_understood = unsafe { get(plugin, id, text, value) };
    if is_understood {
        // SAFETY: just written.
        unsafe { to_host(id, value) };
    }
    is_understood
}

unsafe extern "C" fn flush(
    plugin: *const clap_plugin,
    incoming: *const clap_input_events,
    outgoing: *const clap_output_events,
) {
    // SAFETY: a live plug-in.
    let Some(guard) = (unsafe { Guard::of(plugin) }) else { return };
    let Some(flush) = guard.params().and_then(|params| params.flush) else { return };
    // SAFETY: a live plug-in; the lists are the host's and live as long as the call.
    unsafe { events::translated(guard, incoming, outgoing, |incoming, outgoing| flush(plugin, incoming, outgoing)) };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entry::instance::numeric_id;

    #[test]
    fn only_whole_numbers_that_nobody_has_automated_are_shifted() {
        let shifted: Vec<&str> = PARAMETERS
            .iter()
            .filter(|parameter| shift(numeric_id(parameter.id)).is_some())
            .map(|parameter| parameter.id)
            .collect();
        assert_eq!(shifted, ["levels", "window", "feature", "half_width"], "a promise to hosts");
    }
}
