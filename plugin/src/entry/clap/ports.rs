//! Layouts and loudspeakers as CLAP hosts see them.

use std::ffi::{CStr, c_char};

use clap_sys::ext::audio_ports::{CLAP_PORT_MONO, CLAP_PORT_STEREO, clap_audio_port_info, clap_plugin_audio_ports};
use clap_sys::ext::audio_ports_config::{clap_audio_ports_config, clap_plugin_audio_ports_config};
use clap_sys::ext::configurable_audio_ports::{
    clap_audio_port_configuration_request, clap_plugin_configurable_audio_ports,
};
use clap_sys::ext::surround::{
    CLAP_PORT_SURROUND, CLAP_SURROUND_FC, CLAP_SURROUND_FL, CLAP_SURROUND_FR, CLAP_SURROUND_LFE, CLAP_SURROUND_SL,
    CLAP_SURROUND_SR, clap_plugin_surround,
};
use clap_sys::id::clap_id;
use clap_sys::plugin::clap_plugin;
use nice_plug::prelude::{AudioIOLayout, NonZeroU32, Plugin};

use super::guard::Guard;
use crate::Pyrophone;
use crate::entry::buses::{Declared, MAX_INPUTS};

const LAYOUTS: &[AudioIOLayout] = Pyrophone::AUDIO_IO_LAYOUTS;

/// Loudspeakers of 5.0 and 5.1, in the order of the channels.
const SURROUND_50: [u32; 5] =
    [CLAP_SURROUND_FL, CLAP_SURROUND_FR, CLAP_SURROUND_FC, CLAP_SURROUND_SL, CLAP_SURROUND_SR];
const SURROUND_51: [u32; 6] =
    [CLAP_SURROUND_FL, CLAP_SURROUND_FR, CLAP_SURROUND_FC, CLAP_SURROUND_LFE, CLAP_SURROUND_SL, CLAP_SURROUND_SR];

/// Ports, with their types.
pub static AUDIO_PORTS: clap_plugin_audio_ports = clap_plugin_audio_ports { count: Some(count), get: Some(port) };
/// Layouts, with their ports' types.
pub static AUDIO_PORTS_CONFIG: clap_plugin_audio_ports_config =
    clap_plugin_audio_ports_config { count: Some(layout_count), get: Some(layout), select: Some(select) };
/// Layouts by the host's requested numbers of channels.
pub static CONFIGURABLE: clap_plugin_configurable_audio_ports =
    clap_plugin_configurable_audio_ports { can_apply_configuration: Some(can_apply), apply_configuration: Some(apply) };
/// Loudspeakers.
pub static SURROUND: clap_plugin_surround =
    clap_plugin_surround { is_channel_mask_supported: Some(is_mask_known), get_channel_map: Some(channel_map) };

fn port_type(channels: u32) -> *const c_char {
    match channels {
        1 => CLAP_PORT_MONO.as_ptr(),
        2 => CLAP_PORT_STEREO.as_ptr(),
        5 | 6 => CLAP_PORT_SURROUND.as_ptr(),
        _ => std::ptr::null(),
    }
}

fn loudspeakers(channels: u32) -> &'static [u32] {
    match channels {
        5 => &SURROUND_50,
        6 => &SURROUND_51,
        _ => &[],
    }
}

unsafe extern "C" fn count(plugin: *const clap_plugin, is_input: bool) -> u32 {
    // SAFETY: a live plug-in.
    let guard = unsafe { Guard::of(plugin) };
    // SAFETY: as above.
    guard.and_then(|guard| guard.audio_ports()?.count).map_or(0, |count| unsafe { count(plugin, is_input) })
}

unsafe extern "C" fn port(
    plugin: *const clap_plugin,
    index: u32,
    is_input: bool,
    info: *mut clap_audio_port_info,
) -> bool {
    // SAFETY: a live plug-in.
    if info.is_null() || index >= unsafe { count(plugin, is_input) } {
        return false;
    }
    // SAFETY: a live plug-in.
    let Some(get) = (unsafe { Guard::of(plugin) }).and_then(|guard| guard.audio_ports()?.get) else { return false };
    // SAFETY: a live plug-in and a writable location.
    if !unsafe { get(plugin, index, is_input, info) } {
        return false;
    }
    // SAFETY: just written.
    let info = unsafe { &mut *info };
    info.port_type = port_type(info.channel_count);
    true
}

/// Current channels of a port; none for a port that does not exist.
fn channels(guard: &Guard, index: u32, is_input: bool) -> Option<u32> {
    // SAFETY: all fields are numbers or null pointers, for which zero is valid.
    let mut info: clap_audio_port_info = unsafe { std::mem::zeroed() };
    // SAFETY: a live plug-in and a writable location.
    unsafe { port(guard.plugin(), index, is_input, &mut info) }.then_some(info.channel_count)
}

/// Channels of all ports at present.
pub fn declared(guard: &Guard) -> Declared {
    let of = |index: usize, is_input| channels(guard, index as u32, is_input).unwrap_or(0) as usize;
    let mut inputs = [0; MAX_INPUTS];
    for (index, channels) in inputs.iter_mut().enumerate() {
        *channels = of(index, true);
    }
    Declared { inputs, output: of(0, false) }
}

unsafe extern "C" fn layout_count(_plugin: *const clap_plugin) -> u32 {
    LAYOUTS.len() as u32
}

unsafe extern "C" fn layout(plugin: *const clap_plugin, index: u32, config: *mut clap_audio_ports_config) -> bool {
    if config.is_null() || index as usize >= LAYOUTS.len() {
        return false;
    }
    // SAFETY: a live plug-in.
    let get = unsafe { Guard::of(plugin) }.and_then(|guard| guard.audio_ports_config()?.get);
    // SAFETY: a live plug-in and a writable location.
    if !get.is_some_and(|get| unsafe { get(plugin, index, config) }) {
        return false;
    }
    // SAFETY: just written.
    let config = unsafe { &mut *config };
    config.main_input_port_type = port_type(config.main_input_channel_count);
    config.main_output_port_type = port_type(config.main_output_channel_count);
    true
}

unsafe extern "C" fn select(plugin: *const clap_plugin, id: clap_id) -> bool {
    if id as usize >= LAYOUTS.len() {
        return false;
    }
    // SAFETY: a live plug-in.
    let select = unsafe { Guard::of(plugin) }.and_then(|guard| guard.audio_ports_config()?.select);
    // SAFETY: a live plug-in that is not active, by the host's word.
    select.is_some_and(|select| unsafe { select(plugin, id) })
}

/// Channels of main input, sidechain and output.
type Widths = [u32; 3];

fn widths(layout: &AudioIOLayout) -> Widths {
    let count = |channels: Option<NonZeroU32>| channels.map_or(0, NonZeroU32::get);
    let sidechain = layout.aux_input_ports.first().map_or(0, |channels| channels.get());
    [count(layout.main_input_channels), sidechain, count(layout.main_output_channels)]
}

/// True if a request's type fits its number of channels, and its loudspeakers, where given, are ours.
///
/// # Safety
/// Its type is null or a text, and the details of a surround port are null or a loudspeaker for each channel.
unsafe fn is_form_known(request: &clap_audio_port_configuration_request) -> bool {
    let own = port_type(request.channel_count);
    if request.port_type.is_null() || own.is_null() {
        return request.port_type.is_null();
    }
    // SAFETY: guaranteed by the caller, and a text of CLAP's own.
    let (asked, own) = unsafe { (CStr::from_ptr(request.port_type), CStr::from_ptr(own)) };
    if asked != own {
        return false;
    }
    if asked != CLAP_PORT_SURROUND || request.port_details.is_null() {
        return true;
    }
    // SAFETY: guaranteed by the caller.
    let map = unsafe { std::slice::from_raw_parts(request.port_details.cast::<u8>(), request.channel_count as usize) };
    map.iter().map(|loudspeaker| u32::from(*loudspeaker)).eq(loudspeakers(request.channel_count).iter().copied())
}

/// The layout that results from the current one and the requests, by its index in the list.
///
/// # Safety
/// `requests` is null or has `count` entries.
unsafe fn wanted(guard: &Guard, requests: *const clap_audio_port_configuration_request, count: u32) -> Option<clap_id> {
    if requests.is_null() || count == 0 {
        return None;
    }
    let present = declared(guard);
    let mut wanted: Widths = [present.inputs[0] as u32, present.inputs[1] as u32, present.output as u32];
    // SAFETY: guaranteed by the caller.
    for request in unsafe { std::slice::from_raw_parts(requests, count as usize) } {
        let place = match (request.is_input, request.port_index) {
            (true, index @ 0..=1) => index as usize,
            (false, 0) => 2,
            _ => return None,
        };
        // SAFETY: a request of the host's.
        if !unsafe { is_form_known(request) } {
            return None;
        }
        wanted[place] = request.channel_count;
    }
    LAYOUTS.iter().position(|layout| widths(layout) == wanted).map(|index| index as clap_id)
}

unsafe extern "C" fn can_apply(
    plugin: *const clap_plugin,
    requests: *const clap_audio_port_configuration_request,
    count: u32,
) -> bool {
    // SAFETY: a live plug-in and the host's requests.
    unsafe { Guard::of(plugin).is_some_and(|guard| wanted(guard, requests, count).is_some()) }
}

unsafe extern "C" fn apply(
    plugin: *const clap_plugin,
    requests: *const clap_audio_port_configuration_request,
    count: u32,
) -> bool {
    // SAFETY: a live plug-in that is not active, and the host's requests.
    unsafe {
        let wanted = Guard::of(plugin).and_then(|guard| wanted(guard, requests, count));
        wanted.is_some_and(|id| select(plugin, id))
    }
}

unsafe extern "C" fn is_mask_known(_plugin: *const clap_plugin, mask: u64) -> bool {
    [&SURROUND_50[..], &SURROUND_51].iter().any(|map| map.iter().fold(0, |mask, of| mask | 1 << of) == mask)
}

unsafe extern "C" fn channel_map(
    plugin: *const clap_plugin,
    is_input: bool,
    index: u32,
    map: *mut u8,
    capacity: u32,
) -> u32 {
    // SAFETY: a live plug-in.
    let Some(guard) = (unsafe { Guard::of(plugin) }) else { return 0 };
    let loudspeakers = loudspeakers(channels(guard, index, is_input).unwrap_or(0));
    if map.is_null() || capacity < loudspeakers.len() as u32 {
        return 0;
    }
    for (place, loudspeaker) in loudspeakers.iter().enumerate() {
        // SAFETY: room for `capacity` bytes.
        unsafe { map.add(place).write(*loudspeaker as u8) };
    }
    loudspeakers.len() as u32
}
