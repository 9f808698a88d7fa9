//! The effect as a CLAP host sees it.

use std::ffi::{CStr, c_char, c_void};
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::TryLockError;

use clap_sys::audio_buffer::clap_audio_buffer;
use clap_sys::ext::audio_ports::CLAP_EXT_AUDIO_PORTS;
use clap_sys::ext::audio_ports_config::CLAP_EXT_AUDIO_PORTS_CONFIG;
use clap_sys::ext::configurable_audio_ports::{
    CLAP_EXT_CONFIGURABLE_AUDIO_PORTS, CLAP_EXT_CONFIGURABLE_AUDIO_PORTS_COMPAT,
};
use clap_sys::ext::context_menu::{CLAP_EXT_CONTEXT_MENU, CLAP_EXT_CONTEXT_MENU_COMPAT};
use clap_sys::ext::latency::{CLAP_EXT_LATENCY, clap_host_latency, clap_plugin_latency};
use clap_sys::ext::param_indication::{CLAP_EXT_PARAM_INDICATION, CLAP_EXT_PARAM_INDICATION_COMPAT};
use clap_sys::ext::params::CLAP_EXT_PARAMS;
use clap_sys::ext::preset_load::{CLAP_EXT_PRESET_LOAD, CLAP_EXT_PRESET_LOAD_COMPAT};
use clap_sys::ext::state::CLAP_EXT_STATE;
use clap_sys::ext::state_context::CLAP_EXT_STATE_CONTEXT;
use clap_sys::ext::surround::{CLAP_EXT_SURROUND, CLAP_EXT_SURROUND_COMPAT};
use clap_sys::host::clap_host;
use clap_sys::plugin::clap_plugin;
use clap_sys::process::{CLAP_PROCESS_ERROR, clap_process, clap_process_status};
use nice_plug::wrapper::clap::Wrapper;

use super::guard::Guard;
use super::host_menu::ClapMenu;
use super::{events, extras, params, ports, saving};
use crate::Pyrophone;
use crate::entry::buses::{Buses, MAX_INPUTS};
use crate::entry::instance;

/// A new plug-in; null where the framework creates none.
///
/// # Safety
/// The host outlives the plug-in.
pub unsafe fn create(host: *const clap_host) -> *const clap_plugin {
    // SAFETY: guaranteed by the caller.
    let wrapper = unsafe { Wrapper::<Pyrophone>::new(host) };
    let Some(instance) = instance::take_announced() else { return std::ptr::null() };
    // The framework's `destroy` releases this reference.
    let wrapper = Arc::into_raw(wrapper);
    // SAFETY: alive until it is destroyed; its functions and data pointer no longer change.
    let inner = unsafe { *(*wrapper).clap_plugin.as_ptr() };
    let clap = clap_plugin {
        desc: super::descriptor().clap_plugin_descriptor(),
        destroy: Some(destroy),
        activate: Some(activate),
        process: Some(process),
        get_extension: Some(get_extension),
        ..inner
    };
    let (events, buses) = (Mutex::default(), Mutex::new(None));
    // SAFETY: it is removed before the plug-in is destroyed, which the host outlives.
    instance.params.host_menu.set_provider(Some(Box::new(unsafe { ClapMenu::new(host) })));
    let guard = Box::new(Guard { clap, inner, host, instance, events, buses });
    std::ptr::from_ref(&Box::leak(guard).clap)
}

unsafe extern "C" fn destroy(plugin: *const clap_plugin) {
    // SAFETY: hosts destroy a plug-in once.
    let Some(guard) = (unsafe { Guard::of(plugin) }) else { return };
    guard.instance.params.host_menu.set_provider(None);
    let inner = guard.inner;
    if let Some(destroy) = inner.destroy {
        // SAFETY: the framework's own plug-in, destroyed once.
        unsafe { destroy(&inner) };
    }
    // SAFETY: made by `Box` in `create`, and not used after this.
    drop(unsafe { Box::from_raw(plugin.cast::<Guard>().cast_mut()) });
}

unsafe extern "C" fn activate(plugin: *const clap_plugin, sample_rate: f64, least: u32, most: u32) -> bool {
    // SAFETY: a live plug-in.
    let Some(guard) = (unsafe { Guard::of(plugin) }) else { return false };
    let Some(activate) = guard.inner.activate else { return false };
    if !(sample_rate.is_finite() && sample_rate > 0.0) || most == 0 {
        return false;
    }
    let before = guard.instance.meters.engine().map(|(latency_samples, _)| latency_samples);
    *guard.buses.lock().unwrap_or_else(std::sync::PoisonError::into_inner) =
        Some(Buses::new(ports::declared(guard), most as usize));
    // SAFETY: a live plug-in that is not active.
    if !unsafe { activate(plugin, sample_rate, least, most) } {
        return false;
    }
    // CLAP allows a plug-in to report this only here. A host that has never asked needs no report.
    if before.is_some_and(|before| before != guard.latency_samples()) {
        // SAFETY: the id's type; active plug-ins are initialised.
        let host_latency = unsafe { guard.host_extension::<clap_host_latency>(CLAP_EXT_LATENCY) };
        if let Some(changed) = host_latency.and_then(|latency| latency.changed) {
            // SAFETY: a live host, on its main thread, within `activate`.
            unsafe { changed(guard.host) };
        }
    }
    true
}

/// A channel of a bus, null where it is missing.
///
/// # Safety
/// `buses` is null or has `count` entries.
unsafe fn channel(buses: *const clap_audio_buffer, count: u32, bus: usize, channel: usize) -> *mut f32 {
    if buses.is_null() || bus >= count as usize {
        return std::ptr::null_mut();
    }
    // SAFETY: guaranteed by the caller.
    let bus = unsafe { &*buses.add(bus) };
    if bus.data32.is_null() || channel >= bus.channel_count as usize {
        return std::ptr::null_mut();
    }
    // SAFETY: a bus has as many pointers as channels.
    unsafe { *bus.data32.add(channel) }
}

fn bus_of(pointers: &mut [*mut f32]) -> clap_audio_buffer {
    clap_audio_buffer {
        data32: pointers.as_mut_ptr(),
        data64: std::ptr::null_mut(),
        channel_count: pointers.len() as u32,
        latency: 0,
        constant_mask: 0,
    }
}

/// Silences the channels of the host's outputs from `first` of the main one on.
///
/// # Safety
/// A block of the host's.
unsafe fn silence_rest(block: &clap_process, first: usize) {
    for bus in 0..block.audio_outputs_count as usize {
        if block.audio_outputs.is_null() {
            return;
        }
        // SAFETY: the host's bus.
        let outputs = unsafe { &mut *block.audio_outputs.add(bus) };
        outputs.constant_mask = 0;
        for of in if bus == 0 { first } else { 0 }..outputs.channel_count as usize {
            // SAFETY: the host's buses.
            let pointer = unsafe { channel(block.audio_outputs, block.audio_outputs_count, bus, of) };
            if !pointer.is_null() {
                // SAFETY: a channel as long as the block.
                unsafe { pointer.write_bytes(0, block.frames_count as usize) };
            }
        }
    }
}

unsafe extern "C" fn process(plugin: *const clap_plugin, block: *const clap_process) -> clap_process_status {
    // SAFETY: a live plug-in and a block of the host's.
    let (Some(guard), Some(block)) = (unsafe { (Guard::of(plugin), block.as_ref()) }) else {
        return CLAP_PROCESS_ERROR;
    };
    let Some(process) = guard.inner.process else { return CLAP_PROCESS_ERROR };
    // Uncontended while the plug-in is active, unless a host breaks the rules.
    let mut buses = match guard.buses.try_lock() {
        Ok(buses) => buses,
        Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
        Err(TryLockError::WouldBlock) => return CLAP_PROCESS_ERROR,
    };
    let Some(buses) = buses.as_mut().filter(|buses| block.frames_count as usize <= buses.max_block()) else {
        // SAFETY: a block of the host's.
        unsafe { silence_rest(block, 0) };
        return CLAP_PROCESS_ERROR;
    };
    let declared = buses.declared();
    for bus in 0..MAX_INPUTS {
        // SAFETY: the host's buses.
        buses.set_input(bus, |of| unsafe { channel(block.audio_inputs, block.audio_inputs_count, bus, of) });
    }
    // SAFETY: the host's buses.
    buses.set_output(|of| unsafe { channel(block.audio_outputs, block.audio_outputs_count, 0, of) });
    let [main, sidechain] = &mut buses.inputs;
    let inputs = [bus_of(&mut main[..declared.inputs[0]]), bus_of(&mut sidechain[..declared.inputs[1]])];
    let mut outputs = [bus_of(&mut buses.output[..declared.output])];
    let guarded = clap_process {
        audio_inputs: inputs.as_ptr(),
        audio_inputs_count: declared.inputs.iter().filter(|channels| **channels > 0).count() as u32,
        audio_outputs: outputs.as_mut_ptr(),
        audio_outputs_count: 1,
        ..*block
    };
    // SAFETY: a live, active plug-in; every channel that was declared is there and long enough. The host's events are
    // passed on as long as the call lasts.
    unsafe {
        let status = events::translated(guard, block.in_events, block.out_events, |in_events, out_events| {
            process(plugin, &clap_process { in_events, out_events, ..guarded })
        });
        silence_rest(block, declared.output);
        status
    }
}

unsafe extern "C" fn latency(plugin: *const clap_plugin) -> u32 {
    // SAFETY: a live plug-in.
    unsafe { Guard::of(plugin) }.map_or(0, Guard::latency_samples)
}

static LATENCY: clap_plugin_latency = clap_plugin_latency { get: Some(latency) };

unsafe extern "C" fn get_extension(plugin: *const clap_plugin, id: *const c_char) -> *const c_void {
    // SAFETY: a live plug-in.
    let Some(guard) = (unsafe { Guard::of(plugin) }) else { return std::ptr::null() };
    if id.is_null() {
        return std::ptr::null();
    }
    // SAFETY: a text of the host's.
    let name = unsafe { CStr::from_ptr(id) };
    let own: &[(&[&CStr], *const c_void)] = &[
        (&[CLAP_EXT_LATENCY], std::ptr::from_ref(&LATENCY).cast()),
        (&[CLAP_EXT_PARAMS], std::ptr::from_ref(&params::PARAMS).cast()),
        (&[CLAP_EXT_STATE], std::ptr::from_ref(&saving::STATE).cast()),
        (&[CLAP_EXT_STATE_CONTEXT], std::ptr::from_ref(&saving::STATE_CONTEXT).cast()),
        (&[CLAP_EXT_PRESET_LOAD, CLAP_EXT_PRESET_LOAD_COMPAT], std::ptr::from_ref(&saving::PRESET_LOAD).cast()),
        (&[CLAP_EXT_AUDIO_PORTS], std::ptr::from_ref(&ports::AUDIO_PORTS).cast()),
        (&[CLAP_EXT_AUDIO_PORTS_CONFIG], std::ptr::from_ref(&ports::AUDIO_PORTS_CONFIG).cast()),
        (
            &[CLAP_EXT_CONFIGURABLE_AUDIO_PORTS, CLAP_EXT_CONFIGURABLE_AUDIO_PORTS_COMPAT],
            std::ptr::from_ref(&ports::CONFIGURABLE).cast(),
        ),
        (&[CLAP_EXT_SURROUND, CLAP_EXT_SURROUND_COMPAT], std::ptr::from_ref(&ports::SURROUND).cast()),
        (
            &[CLAP_EXT_PARAM_INDICATION, CLAP_EXT_PARAM_INDICATION_COMPAT],
            std::ptr::from_ref(&extras::INDICATION).cast(),
        ),
        (&[CLAP_EXT_CONTEXT_MENU, CLAP_EXT_CONTEXT_MENU_COMPAT], std::ptr::from_ref(&extras::CONTEXT_MENU).cast()),
    ];
    if let Some((_, extension)) = own.iter().find(|(names, _)| names.contains(&name)) {
        return *extension;
    }
    match guard.inner.get_extension {
        // SAFETY: a live plug-in and a text.
        Some(get) => unsafe { get(plugin, id) },
        None => std::ptr::null(),
    }
}
