//! States, and presets that a host loads.

use std::ffi::{CStr, CString, c_char, c_void};
use std::path::Path;

use clap_sys::ext::params::{CLAP_EXT_PARAMS, CLAP_PARAM_RESCAN_VALUES, clap_host_params};
use clap_sys::ext::preset_load::{
    CLAP_EXT_PRESET_LOAD, CLAP_EXT_PRESET_LOAD_COMPAT, clap_host_preset_load, clap_plugin_preset_load,
};
use clap_sys::ext::state::clap_plugin_state;
use clap_sys::ext::state_context::{clap_plugin_state_context, clap_plugin_state_context_type};
use clap_sys::factory::preset_discovery::{
    CLAP_PRESET_DISCOVERY_LOCATION_FILE, CLAP_PRESET_DISCOVERY_LOCATION_PLUGIN, clap_preset_discovery_location_kind,
};
use clap_sys::plugin::clap_plugin;
use clap_sys::stream::{clap_istream, clap_ostream};
use pyrophone_settings::{Id, Preset};

use super::guard::Guard;
use crate::entry::state;

/// States.
pub static STATE: clap_plugin_state = clap_plugin_state { save: Some(save), load: Some(load) };
/// Extension for states with a purpose: they are the same for presets, copies and projects.
pub static STATE_CONTEXT: clap_plugin_state_context =
    clap_plugin_state_context { save: Some(save_for), load: Some(load_for) };
/// Presets that a host loads.
pub static PRESET_LOAD: clap_plugin_preset_load = clap_plugin_preset_load { from_location: Some(from_location) };

/// Bytes before the JSON: its length.
const HEADER: usize = 8;

unsafe extern "C" fn append(stream: *const clap_ostream, bytes: *const c_void, count: u64) -> i64 {
    // SAFETY: made in `saved`, and used only within it.
    let to = unsafe { &mut *(*stream).ctx.cast::<Vec<u8>>() };
    // SAFETY: the framework gives `count` bytes.
    to.extend_from_slice(unsafe { std::slice::from_raw_parts(bytes.cast::<u8>(), count as usize) });
    count as i64
}

unsafe extern "C" fn take(stream: *const clap_istream, to: *mut c_void, count: u64) -> i64 {
    // SAFETY: made in `load_bytes`, and used only within it.
    let from = unsafe { &mut *(*stream).ctx.cast::<&[u8]>() };
    let length = from.len().min(count as usize);
    // SAFETY: the framework gives room for `count` bytes.
    unsafe { to.cast::<u8>().copy_from_nonoverlapping(from.as_ptr(), length) };
    *from = &from[length..];
    length as i64
}

/// The framework's JSON, on the grid.
fn saved(guard: &Guard) -> Option<Vec<u8>> {
    let save = guard.state()?.save?;
    let mut bytes: Vec<u8> = Vec::new();
    let stream = clap_ostream { ctx: (&raw mut bytes).cast(), write: Some(append) };
    // SAFETY: a live plug-in and a stream that lives as long as the call.
    let json = unsafe { save(guard.plugin(), &stream) }.then(|| bytes.get(HEADER..)).flatten()?;
    Some(state::normalise(json, &[]))
}

/// Loads JSON as the framework writes it.
fn load_json(guard: &Guard, json: &[u8]) -> bool {
    let Some(load) = guard.state().and_then(|state| state.load) else { return false };
    let bytes = [&(json.len() as u64).to_le_bytes()[..], json].concat();
    let mut rest: &[u8] = &bytes;
    let stream = clap_istream { ctx: (&raw mut rest).cast(), read: Some(take) };
    // SAFETY: a live plug-in and a stream that lives as long as the call.
    unsafe { load(guard.plugin(), &stream) }
}

/// # Safety
/// `stream` is a live stream of the host.
unsafe fn write_all(stream: *const clap_ostream, mut bytes: &[u8]) -> bool {
    // SAFETY: guaranteed by the caller.
    let Some(write) = (unsafe { stream.as_ref() }).and_then(|stream| stream.write) else { return false };
    while !bytes.is_empty() {
        // SAFETY: a live stream, and bytes to read.
        let written = unsafe { write(stream, bytes.as_ptr().cast(), bytes.len() as u64) };
        match usize::try_from(written) {
            Ok(written @ 1..) if written <= bytes.len() => bytes = &bytes[written..],
            _ => return false,
        }
    }
    true
}

unsafe extern "C" fn save(plugin: *const clap_plugin, stream: *const clap_ostream) -> bool {
    // SAFETY: a live plug-in.
    let Some(json) = (unsafe { Guard::of(plugin) }).and_then(saved) else { return false };
    // SAFETY: a live stream of the host.
    unsafe { write_all(stream, &(json.len() as u64).to_le_bytes()) && write_all(stream, &json) }
}

unsafe extern "C" fn load(plugin: *const clap_plugin, stream: *const clap_istream) -> bool {
    if stream.is_null() {
        return false;
    }
    // SAFETY: a live plug-in.
    let load = unsafe { Guard::of(plugin) }.and_then(|guard| guard.state()?.load);
    // SAFETY: a live plug-in and a live stream of the host.
    load.is_some_and(|load| unsafe { load(plugin, stream) })
}

unsafe extern "C" fn save_for(
    plugin: *const clap_plugin,
    stream: *const clap_ostream,
    _context: clap_plugin_state_context_type,
) -> bool {
    // SAFETY: as the host's word is for `save`.
    unsafe { save(plugin, stream) }
}

unsafe extern "C" fn load_for(
    plugin: *const clap_plugin,
    stream: *const clap_istream,
    _context: clap_plugin_state_context_type,
) -> bool {
    // SAFETY: as the host's word is for `load`.
    unsafe { load(plugin, stream) }
}

/// The preset at a location given by the host, or the reason for its absence.
///
/// # Safety
/// The texts are null or live.
unsafe fn preset_at(
    kind: clap_preset_discovery_location_kind,
    location: *const c_char,
    key: *const c_char,
) -> Result<Preset, String> {
    let text = |text: *const c_char| {
        // SAFETY: guaranteed by the caller.
        (!text.is_null()).then(|| unsafe { CStr::from_ptr(text) }.to_str().ok()).flatten()
    };
    match (kind, text(location), text(key)) {
        (CLAP_PRESET_DISCOVERY_LOCATION_PLUGIN, _, Some(name)) => {
            let presets = Preset::factory().map_err(|error| error.to_string())?;
            let found = presets.into_iter().find(|preset| preset.name == name);
            found.ok_or_else(|| format!("there is no factory preset {name:?}"))
        }
        (CLAP_PRESET_DISCOVERY_LOCATION_FILE, Some(path), _) => {
            Preset::load(Path::new(path)).map_err(|error| error.to_string())
        }
        _ => Err("the host names no preset: give a factory preset's key, or the path of a preset file".to_owned()),
    }
}

/// Sets the parameters to a preset's values, and loads its recording if it names one; otherwise the recording stays, as
/// the window does.
fn apply(guard: &Guard, preset: &Preset) -> Option<()> {
    let present: serde_json::Value = serde_json::from_slice(&saved(guard)?).ok()?;
    let session = pyrophone_settings::Session::default();
    let values = preset.values.chosen_over(&guard.instance.params.values());
    let text = pyrophone_settings::session::plugin_state(&values, &session);
    let mut wanted: serde_json::Value = serde_json::from_str(&text).ok()?;
    wanted["fields"] = present["fields"].clone();
    let is_loaded = load_json(guard, &serde_json::to_vec(&wanted).ok()?);
    if let (true, Some(recording)) = (is_loaded, &preset.recording) {
        // Posted after the state, which names the present recording once more.
        let slot = values.get(Id::RecordingSlot) as usize;
        guard.instance.loader.load_preset(slot, recording.clone());
    }
    is_loaded.then_some(())
}

unsafe extern "C" fn from_location(
    plugin: *const clap_plugin,
    kind: clap_preset_discovery_location_kind,
    location: *const c_char,
    key: *const c_char,
) -> bool {
    // SAFETY: a live plug-in.
    let Some(guard) = (unsafe { Guard::of(plugin) }) else { return false };
    // SAFETY: the ids' types, and a plug-in that is initialised before anything is loaded.
    let host: Option<&clap_host_preset_load> = unsafe {
        guard.host_extension(CLAP_EXT_PRESET_LOAD).or_else(|| guard.host_extension(CLAP_EXT_PRESET_LOAD_COMPAT))
    };
    // SAFETY: the host's texts.
    let loaded = unsafe { preset_at(kind, location, key) }
        .and_then(|preset| apply(guard, &preset).ok_or_else(|| format!("{}: it cannot be loaded", preset.name)));
    match loaded {
        Ok(()) => {
            // SAFETY: the id's type.
            let params: Option<&clap_host_params> = unsafe { guard.host_extension(CLAP_EXT_PARAMS) };
            if let Some(rescan) = params.and_then(|params| params.rescan) {
                // SAFETY: a live host, on its main thread.
                unsafe { rescan(guard.host, CLAP_PARAM_RESCAN_VALUES) };
            }
            if let Some(callback) = host.and_then(|host| host.loaded) {
                // SAFETY: a live host and its own texts.
                unsafe { callback(guard.host, kind, location, key) };
            }
            true
        }
        Err(reason) => {
            let reason = CString::new(reason).unwrap_or_default();
            if let Some(callback) = host.and_then(|host| host.on_error) {
                // SAFETY: a live host, its own texts, and one that lives as long as the call.
                unsafe { callback(guard.host, kind, location, key, 0, reason.as_ptr()) };
            }
            false
        }
    }
}
