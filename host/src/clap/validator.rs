//! Checks of a CLAP bundle, see [`validator`](crate::validator). They use the C interface directly, since a host that
//! breaks the rules cannot be built on bindings that enforce them.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::ffi::{CStr, CString, c_char, c_void};
use std::path::Path;

use clap_sys::audio_buffer::clap_audio_buffer;
use clap_sys::entry::clap_plugin_entry;
use clap_sys::events::{
    CLAP_CORE_EVENT_SPACE_ID, CLAP_EVENT_PARAM_VALUE, clap_event_header, clap_event_param_value, clap_input_events,
    clap_output_events,
};
use clap_sys::ext::audio_ports::{CLAP_EXT_AUDIO_PORTS, clap_audio_port_info, clap_plugin_audio_ports};
use clap_sys::ext::configurable_audio_ports::{
    CLAP_EXT_CONFIGURABLE_AUDIO_PORTS, clap_audio_port_configuration_request, clap_plugin_configurable_audio_ports,
};
use clap_sys::ext::context_menu::{
    CLAP_CONTEXT_MENU_TARGET_KIND_PARAM, CLAP_EXT_CONTEXT_MENU, clap_context_menu_builder, clap_context_menu_target,
    clap_plugin_context_menu,
};
use clap_sys::ext::latency::{CLAP_EXT_LATENCY, clap_host_latency, clap_plugin_latency};
use clap_sys::ext::param_indication::{CLAP_EXT_PARAM_INDICATION, clap_plugin_param_indication};
use clap_sys::ext::params::{
    CLAP_EXT_PARAMS, CLAP_PARAM_IS_BYPASS, CLAP_PARAM_IS_ENUM, CLAP_PARAM_IS_MODULATABLE, CLAP_PARAM_IS_STEPPED,
    clap_param_info, clap_plugin_params,
};
use clap_sys::ext::preset_load::{CLAP_EXT_PRESET_LOAD, clap_plugin_preset_load};
use clap_sys::ext::remote_controls::{
    CLAP_EXT_REMOTE_CONTROLS, clap_plugin_remote_controls, clap_remote_controls_page,
};
use clap_sys::ext::state::{CLAP_EXT_STATE, clap_plugin_state};
use clap_sys::ext::state_context::{CLAP_EXT_STATE_CONTEXT, CLAP_STATE_CONTEXT_FOR_PRESET, clap_plugin_state_context};
use clap_sys::ext::surround::{CLAP_EXT_SURROUND, clap_plugin_surround};
use clap_sys::factory::plugin_factory::{CLAP_PLUGIN_FACTORY_ID, clap_plugin_factory};
use clap_sys::factory::preset_discovery::{
    CLAP_PRESET_DISCOVERY_FACTORY_ID, CLAP_PRESET_DISCOVERY_LOCATION_PLUGIN, clap_preset_discovery_factory,
    clap_preset_discovery_filetype, clap_preset_discovery_indexer, clap_preset_discovery_location,
    clap_preset_discovery_metadata_receiver,
};
use clap_sys::host::clap_host;
use clap_sys::plugin::clap_plugin;
use clap_sys::process::{CLAP_PROCESS_ERROR, clap_process};
use clap_sys::stream::{clap_istream, clap_ostream};
use clap_sys::version::CLAP_VERSION;
use libloading::Library;

use crate::numeric_id;
use crate::validator::{Check, ODD_RATES_HZ, duplicate, ensure};

const BLOCK: usize = 64;

/// Pages of remote controls that a controller can count on.
const LEAST_PAGES: u32 = 4;

/// All checks.
pub(crate) const CHECKS: &[Check] = &[
    Check { name: "null_and_missing_buffers_are_survived_and_silent", run: null_and_missing_buffers },
    Check { name: "saved_bytes_do_not_change_by_load_and_save", run: bytes_stay },
    Check { name: "latency_is_announced_within_activate_only", run: latency_within_activate },
    Check { name: "odd_rates_activate_and_pass_sound_through", run: odd_rates },
    Check { name: "names_and_flags_of_parameters_are_sound", run: parameters_are_sound },
    Check { name: "whole_numbers_have_their_plain_values", run: plain_whole_numbers },
    Check { name: "presets_are_discovered_and_loaded", run: presets },
    Check { name: "extensions_that_hosts_ask_for_answer", run: extensions },
    Check { name: "ports_are_configured_as_asked", run: ports },
];

/// Calls that the plug-in made to its host.
#[derive(Default)]
struct Notices {
    is_activating: Cell<bool>,
    announced: Cell<u32>,
    misplaced: Cell<u32>,
    restarts: Cell<u32>,
    callbacks: Cell<u32>,
}

/// An instance without a host's usual safeguards.
struct Raw {
    _library: Library,
    entry: *const clap_plugin_entry,
    plugin: *const clap_plugin,
    host: Box<clap_host>,
    is_active: bool,
}

unsafe extern "C" fn extension(_host: *const clap_host, id: *const c_char) -> *const c_void {
    static LATENCY: clap_host_latency = clap_host_latency { changed: Some(latency_changed) };
    // SAFETY: a text of the plug-in's.
    if unsafe { CStr::from_ptr(id) } == CLAP_EXT_LATENCY { (&raw const LATENCY).cast() } else { std::ptr::null() }
}

/// # Safety
/// The host of a [`Raw`].
unsafe fn notices<'a>(host: *const clap_host) -> &'a Notices {
    // SAFETY: guaranteed by the caller.
    unsafe { &*(*host).host_data.cast::<Notices>() }
}

unsafe extern "C" fn latency_changed(host: *const clap_host) {
    // SAFETY: the plug-in's host.
    let notices = unsafe { notices(host) };
    let count = if notices.is_activating.get() { &notices.announced } else { &notices.misplaced };
    count.set(count.get() + 1);
}

unsafe extern "C" fn restart(host: *const clap_host) {
    // SAFETY: the plug-in's host.
    let restarts = unsafe { &notices(host).restarts };
    restarts.set(restarts.get() + 1);
}

unsafe extern "C" fn nothing(_host: *const clap_host) {}

unsafe extern "C" fn callback(host: *const clap_host) {
    // SAFETY: the plug-in's host.
    let callbacks = unsafe { &notices(host).callbacks };
    callbacks.set(callbacks.get() + 1);
}

impl Raw {
    fn load(bundle: &Path) -> Result<Self, String> {
        let path = CString::new(bundle.as_os_str().as_encoded_bytes()).map_err(|error| error.to_string())?;
        let notices = Box::into_raw(Box::<Notices>::default());
        let host = Box::new(clap_host {
            clap_version: CLAP_VERSION,
            host_data: notices.cast(),
            name: c"pyrophone-validator".as_ptr(),
            vendor: c"Pyrophone".as_ptr(),
            url: c"".as_ptr(),
            version: c"1".as_ptr(),
            get_extension: Some(extension),
            request_restart: Some(restart),
            request_process: Some(nothing),
            request_callback: Some(callback),
        });
        // SAFETY: loading runs code of the bundle, as the caller requested; the functions are CLAP's.
        unsafe {
            let library = Library::new(bundle).map_err(|error| error.to_string())?;
            let entry = *library.get::<*const clap_plugin_entry>(b"clap_entry\0").map_err(|error| error.to_string())?;
            ((*entry).init.ok_or("no init")?)(path.as_ptr());
            let factory = ((*entry).get_factory.ok_or("no get_factory")?)(CLAP_PLUGIN_FACTORY_ID.as_ptr());
            let factory = factory.cast::<clap_plugin_factory>().as_ref().ok_or("no factory")?;
            let descriptor = (factory.get_plugin_descriptor.ok_or("no descriptor")?)(factory, 0);
            let id = descriptor.as_ref().ok_or("no plug-in")?.id;
            let plugin = (factory.create_plugin.ok_or("no create_plugin")?)(factory, &*host, id);
            ensure(!plugin.is_null(), || "it makes no plug-in".to_owned())?;
            ensure(((*plugin).init.ok_or("no init")?)(plugin), || "it does not initialise".to_owned())?;
            Ok(Self { _library: library, entry, plugin, host, is_active: false })
        }
    }

    fn notices(&self) -> &Notices {
        // SAFETY: made in `load`.
        unsafe { notices(&*self.host) }
    }

    /// An extension of the plug-in's.
    ///
    /// # Safety
    /// `T` is the extension's type.
    unsafe fn extension<T>(&self, id: &CStr) -> Result<&T, String> {
        // SAFETY: a live plug-in; guaranteed by the caller.
        let found = unsafe { (*self.plugin).get_extension.map(|get| get(self.plugin, id.as_ptr()).cast::<T>()) };
        // SAFETY: as above.
        found.and_then(|found| unsafe { found.as_ref() }).ok_or_else(|| format!("it has no {}", id.to_string_lossy()))
    }

    fn activate(&mut self, sample_rate: f64) -> Result<(), String> {
        self.notices().is_activating.set(true);
        // SAFETY: a live plug-in that is not active.
        let is_active = unsafe {
            (*self.plugin).activate.is_some_and(|activate| activate(self.plugin, sample_rate, 1, BLOCK as u32))
        };
        self.notices().is_activating.set(false);
        ensure(is_active, || format!("it does not activate at {sample_rate} Hz"))?;
        self.is_active = true;
        // SAFETY: a live, active plug-in.
        let is_started = unsafe { (*self.plugin).start_processing.is_some_and(|start| start(self.plugin)) };
        ensure(is_started, || "it does not start".to_owned())
    }

    fn deactivate(&mut self) {
        if std::mem::take(&mut self.is_active) {
            // SAFETY: a live, active plug-in.
            unsafe {
                if let Some(stop) = (*self.plugin).stop_processing {
                    stop(self.plugin);
                }
                if let Some(deactivate) = (*self.plugin).deactivate {
                    deactivate(self.plugin);
                }
            }
        }
    }

    fn run_callbacks(&self) {
        while self.notices().callbacks.replace(0) > 0 {
            // SAFETY: a live plug-in, on its main thread.
            unsafe {
                if let Some(run) = (*self.plugin).on_main_thread {
                    run(self.plugin);
                }
            };
        }
    }

    fn process(
        &self,
        inputs: &[clap_audio_buffer],
        outputs: &mut [clap_audio_buffer],
        events: &[clap_event_param_value],
    ) -> i32 {
        let list = Events(events);
        let (in_events, out_events) = (list.as_clap(), no_output());
        let block = clap_process {
            steady_time: -1,
            frames_count: BLOCK as u32,
            transport: std::ptr::null(),
            audio_inputs: if inputs.is_empty() { std::ptr::null() } else { inputs.as_ptr() },
            audio_outputs: if outputs.is_empty() { std::ptr::null_mut() } else { outputs.as_mut_ptr() },
            audio_inputs_count: inputs.len() as u32,
            audio_outputs_count: outputs.len() as u32,
            in_events: &in_events,
            out_events: &out_events,
        };
        // SAFETY: a live, started plug-in; pointers are null or to channels of a block's length.
        unsafe { (*self.plugin).process.map_or(CLAP_PROCESS_ERROR, |process| process(self.plugin, &block)) }
    }

    fn flush(&self, events: &[clap_event_param_value]) -> Result<(), String> {
        // SAFETY: the id's type.
        let params: &clap_plugin_params = unsafe { self.extension(CLAP_EXT_PARAMS)? };
        let list = Events(events);
        let (incoming, outgoing) = (list.as_clap(), no_output());
        // SAFETY: a live plug-in that is not processing.
        unsafe { (params.flush.ok_or("no flush")?)(self.plugin, &incoming, &outgoing) };
        Ok(())
    }

    fn value(&self, id: &str) -> Result<f64, String> {
        // SAFETY: the id's type.
        let params: &clap_plugin_params = unsafe { self.extension(CLAP_EXT_PARAMS)? };
        let mut value = f64::NAN;
        // SAFETY: a live plug-in and a writable location.
        let is_known = unsafe { (params.get_value.ok_or("no get_value")?)(self.plugin, numeric_id(id), &mut value) };
        ensure(is_known, || format!("there is no {id}"))?;
        Ok(value)
    }

    fn parameters(&self) -> Result<Vec<clap_param_info>, String> {
        // SAFETY: the id's type.
        let params: &clap_plugin_params = unsafe { self.extension(CLAP_EXT_PARAMS)? };
        let get = params.get_info.ok_or("no get_info")?;
        // SAFETY: a live plug-in, and writable locations whose fields are numbers and null pointers.
        unsafe {
            let count = (params.count.ok_or("no count")?)(self.plugin);
            let mut beyond: clap_param_info = std::mem::zeroed();
            ensure(!get(self.plugin, count, &mut beyond), || "it describes a parameter beyond the last".to_owned())?;
            let read = |index| {
                let mut info: clap_param_info = std::mem::zeroed();
                get(self.plugin, index, &mut info).then_some(info)
            };
            Ok((0..count).filter_map(read).collect())
        }
    }

    fn save(&self) -> Result<Vec<u8>, String> {
        // SAFETY: the id's type.
        let state: &clap_plugin_state = unsafe { self.extension(CLAP_EXT_STATE)? };
        saved(|stream| {
            // SAFETY: a live plug-in and a live stream.
            state.save.is_some_and(|save| unsafe { save(self.plugin, stream) })
        })
    }

    fn load_state(&self, bytes: &[u8]) -> Result<(), String> {
        // SAFETY: the id's type.
        let state: &clap_plugin_state = unsafe { self.extension(CLAP_EXT_STATE)? };
        loaded(bytes, |stream| {
            // SAFETY: a live plug-in and a live stream.
            state.load.is_some_and(|load| unsafe { load(self.plugin, stream) })
        })
    }
}

impl Drop for Raw {
    fn drop(&mut self) {
        self.deactivate();
        // SAFETY: a live plug-in, destroyed once; its host's notices were made by `Box` in `load`.
        unsafe {
            if let Some(destroy) = (*self.plugin).destroy {
                destroy(self.plugin);
            }
            if let Some(deinit) = (*self.entry).deinit {
                deinit();
            }
            drop(Box::from_raw(self.host.host_data.cast::<Notices>()));
        }
    }
}

fn saved(save: impl FnOnce(&clap_ostream) -> bool) -> Result<Vec<u8>, String> {
    unsafe extern "C" fn write(stream: *const clap_ostream, bytes: *const c_void, count: u64) -> i64 {
        // Piece by piece, as hosts may.
        let count = count.min(1000);
        // SAFETY: made below; the plug-in passes `count` bytes.
        let (to, bytes) = unsafe {
            (&mut *(*stream).ctx.cast::<Vec<u8>>(), std::slice::from_raw_parts(bytes.cast::<u8>(), count as usize))
        };
        to.extend_from_slice(bytes);
        count as i64
    }
    let mut bytes: Vec<u8> = Vec::new();
    let is_saved = save(&clap_ostream { ctx: (&raw mut bytes).cast(), write: Some(write) });
    if is_saved { Ok(bytes) } else { Err("it does not save".to_owned()) }
}

fn loaded(mut bytes: &[u8], load: impl FnOnce(&clap_istream) -> bool) -> Result<(), String> {
    unsafe extern "C" fn read(stream: *const clap_istream, to: *mut c_void, count: u64) -> i64 {
        // SAFETY: made below; the plug-in provides space for `count` bytes.
        unsafe {
            let rest = &mut *(*stream).ctx.cast::<&[u8]>();
            let length = rest.len().min(count as usize).min(1000);
            to.cast::<u8>().copy_from_nonoverlapping(rest.as_ptr(), length);
            *rest = &rest[length..];
            length as i64
        }
    }
    let is_loaded = load(&clap_istream { ctx: (&raw mut bytes).cast(), read: Some(read) });
    ensure(is_loaded, || "it does not load what it saved".to_owned())
}

struct Events<'a>(&'a [clap_event_param_value]);

impl Events<'_> {
    fn as_clap(&self) -> clap_input_events {
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

fn no_output() -> clap_output_events {
    unsafe extern "C" fn push(_list: *const clap_output_events, _event: *const clap_event_header) -> bool {
        true
    }
    clap_output_events { ctx: std::ptr::null_mut(), try_push: Some(push) }
}

fn event(id: u32, value: f64) -> clap_event_param_value {
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

fn bus(channels: &mut [*mut f32]) -> clap_audio_buffer {
    clap_audio_buffer {
        data32: channels.as_mut_ptr(),
        data64: std::ptr::null_mut(),
        channel_count: channels.len() as u32,
        latency: 0,
        constant_mask: 0,
    }
}

/// A bus that claims channels without even having pointers.
fn hollow(channels: u32) -> clap_audio_buffer {
    clap_audio_buffer {
        data32: std::ptr::null_mut(),
        data64: std::ptr::null_mut(),
        channel_count: channels,
        latency: 0,
        constant_mask: 0,
    }
}

fn text(of: &[c_char]) -> String {
    let bytes: Vec<u8> = of.iter().map(|byte| *byte as u8).take_while(|byte| *byte != 0).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

fn null_and_missing_buffers(bundle: &Path) -> Result<(), String> {
    let mut raw = Raw::load(bundle)?;
    raw.activate(48_000.0)?;
    let null = std::ptr::null_mut;
    for inputs in 0..4 {
        for kind in 0..3 {
            let mut output = vec![vec![f32::NAN; BLOCK]; 2];
            let mut out_pointers: Vec<*mut f32> = output.iter_mut().map(|channel| channel.as_mut_ptr()).collect();
            let mut silence = vec![0.0f32; BLOCK];
            let mut pointers = [[null(), null()], [silence.as_mut_ptr(), null()], [null(), silence.as_mut_ptr()]];
            let buses: Vec<clap_audio_buffer> = pointers
                .iter_mut()
                .take(inputs)
                .map(|pointers| if kind == 0 { hollow(2) } else { bus(&mut pointers[..kind]) })
                .collect();
            let status = raw.process(&buses, &mut [bus(&mut out_pointers)], &[]);
            let is_silent = output.iter().flatten().all(|sample| *sample == 0.0);
            ensure(status != CLAP_PROCESS_ERROR && is_silent, || {
                format!("with {inputs} input buses of kind {kind} it answers {status} and is not silent")
            })?;
        }
    }
    for outputs in [vec![], vec![hollow(2)], vec![hollow(0)]] {
        let mut outputs = outputs;
        raw.process(&[], &mut outputs, &[]);
        raw.process(&[hollow(6), hollow(1)], &mut outputs, &[]);
    }
    Ok(())
}

fn bytes_stay(bundle: &Path) -> Result<(), String> {
    let (raw, other) = (Raw::load(bundle)?, Raw::load(bundle)?);
    let parameters = raw.parameters()?;
    for round in 0..8 {
        let values: Vec<clap_event_param_value> = parameters
            .iter()
            .enumerate()
            .map(|(index, info)| {
                let share = (0.137 * (index + 1) as f64 + 0.31 * f64::from(round)).fract();
                let value = info.min_value + share * (info.max_value - info.min_value);
                event(info.id, if info.flags & CLAP_PARAM_IS_STEPPED != 0 { value.round() } else { value })
            })
            .collect();
        raw.flush(&values)?;
        let saved = raw.save()?;
        other.load_state(&saved)?;
        ensure(other.save()? == saved, || format!("in round {round} the bytes differ"))?;
        let differing = parameters.iter().find(|info| {
            let name = |raw: &Raw| {
                // SAFETY: the id's type, and a writable location.
                unsafe {
                    let params: &clap_plugin_params = raw.extension(CLAP_EXT_PARAMS).ok()?;
                    let mut value = 0.0;
                    (params.get_value?)(raw.plugin, info.id, &mut value).then_some(value)
                }
            };
            // Values off the grid are saved on it.
            name(&raw).zip(name(&other)).is_none_or(|(one, other)| (one - other).abs() > 2e-3 * info.max_value.max(1.0))
        });
        if let Some(info) = differing {
            return Err(format!("{} is not what was saved", text(&info.name)));
        }
    }
    Ok(())
}

fn latency_within_activate(bundle: &Path) -> Result<(), String> {
    let mut raw = Raw::load(bundle)?;
    raw.activate(48_000.0)?;
    raw.run_callbacks();
    let restarts = raw.notices().restarts.get();
    ensure(restarts == 0, || "it asks for a restart at its first activation".to_owned())?;
    // SAFETY: the id's type.
    let latency: &clap_plugin_latency = unsafe { raw.extension(CLAP_EXT_LATENCY)? };
    let get = latency.get.ok_or("no latency")?;
    // SAFETY: a live plug-in.
    let before = unsafe { get(raw.plugin) };
    let mut output = vec![vec![0.0f32; BLOCK]; 2];
    let mut pointers: Vec<*mut f32> = output.iter_mut().map(|channel| channel.as_mut_ptr()).collect();
    raw.process(&[], &mut [bus(&mut pointers)], &[event(numeric_id("levels"), 8.0)]);
    for _ in 0..500 {
        raw.process(&[], &mut [bus(&mut pointers)], &[]);
        raw.run_callbacks();
        if raw.notices().restarts.get() > 0 {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    ensure(raw.notices().restarts.get() > 0, || "another structure asks for no restart".to_owned())?;
    raw.deactivate();
    raw.activate(48_000.0)?;
    raw.run_callbacks();
    // SAFETY: a live plug-in.
    let after = unsafe { get(raw.plugin) };
    let (announced, misplaced) = (raw.notices().announced.get(), raw.notices().misplaced.get());
    ensure(after > before && announced == 1 && misplaced == 0, || {
        format!("latency {before} -> {after}, announced {announced} times within activate and {misplaced} elsewhere")
    })
}

fn odd_rates(bundle: &Path) -> Result<(), String> {
    for sample_rate in ODD_RATES_HZ {
        let mut raw = Raw::load(bundle)?;
        raw.activate(sample_rate)?;
        let mut input: Vec<Vec<f32>> = (0..2).map(|of| (0..BLOCK).map(|n| (n + of) as f32 / 100.0).collect()).collect();
        let mut output = vec![vec![f32::NAN; BLOCK]; 2];
        let mut in_pointers: Vec<*mut f32> = input.iter_mut().map(|channel| channel.as_mut_ptr()).collect();
        let mut out_pointers: Vec<*mut f32> = output.iter_mut().map(|channel| channel.as_mut_ptr()).collect();
        raw.process(&[bus(&mut in_pointers)], &mut [bus(&mut out_pointers)], &[]);
        ensure(output == input, || format!("at {sample_rate} Hz the input does not pass through"))?;
    }
    Ok(())
}

fn parameters_are_sound(bundle: &Path) -> Result<(), String> {
    let raw = Raw::load(bundle)?;
    let parameters = raw.parameters()?;
    let names: Vec<String> = parameters.iter().map(|info| text(&info.name)).collect();
    if let Some(name) = duplicate(&names) {
        return Err(format!("two parameters are called {name:?}"));
    }
    let ids: BTreeSet<u32> = parameters.iter().map(|info| info.id).collect();
    ensure(ids.len() == parameters.len(), || "two parameters have one id".to_owned())?;
    let first = parameters.first().is_some_and(|info| info.flags & CLAP_PARAM_IS_BYPASS != 0);
    ensure(first, || "bypass is not the first".to_owned())?;
    for info in &parameters {
        let has = |flag| info.flags & flag != 0;
        let name = text(&info.name);
        ensure(!(has(CLAP_PARAM_IS_STEPPED) && has(CLAP_PARAM_IS_MODULATABLE)), || {
            format!("{name} has steps and can be modulated")
        })?;
        ensure(!has(CLAP_PARAM_IS_ENUM) || has(CLAP_PARAM_IS_STEPPED), || format!("{name} is a list without steps"))?;
        let range = info.min_value..=info.max_value;
        ensure(range.contains(&info.default_value), || format!("the default of {name} is out of its range"))?;
    }
    for id in ["drive_mode", "flame_scene", "quality", "dynamic_range"] {
        let info = parameters.iter().find(|info| info.id == numeric_id(id));
        ensure(info.is_some_and(|info| info.flags & CLAP_PARAM_IS_ENUM != 0), || format!("{id} is not a list"))?;
    }
    Ok(())
}

fn plain_whole_numbers(bundle: &Path) -> Result<(), String> {
    let raw = Raw::load(bundle)?;
    let parameters = raw.parameters()?;
    for (id, low, high, default) in [
        ("levels", 3.0, 8.0, 6.0),
        ("window", 2.0, 16.0, 4.0),
        ("feature", 1.0, 6.0, 3.0),
        ("half_width", 100.0, 2000.0, 500.0),
    ] {
        let info = parameters.iter().find(|info| info.id == numeric_id(id)).ok_or(format!("there is no {id}"))?;
        let found = (info.min_value, info.max_value, info.default_value);
        ensure(found == (low, high, default), || format!("{id} has {found:?}"))?;
        raw.flush(&[event(info.id, low + 1.0)])?;
        let value = raw.value(id)?;
        ensure((value - low - 1.0).abs() < 1e-3, || format!("{id} was set to {} and is {value}", low + 1.0))?;
    }
    Ok(())
}

/// A preset: its name, the kind and path of its location, and its key there.
type Found = (String, u32, Option<CString>, Option<CString>);

#[derive(Default)]
struct Discovered {
    locations: RefCell<Vec<(u32, Option<CString>)>>,
    filetypes: Cell<usize>,
    /// Location of the presets that are being announced.
    at: RefCell<(u32, Option<CString>)>,
    presets: RefCell<Vec<Found>>,
    plugins: Cell<usize>,
    errors: RefCell<Vec<String>>,
}

/// Paths of the preset files in a folder.
fn files_in(folder: &CStr) -> Vec<CString> {
    let entries = std::fs::read_dir(folder.to_string_lossy().as_ref()).into_iter().flatten().flatten();
    let paths = entries.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|end| end == "toml"));
    paths.filter_map(|path| CString::new(path.into_os_string().into_encoded_bytes()).ok()).collect()
}

/// Requests all presets that the bundle's provider knows.
fn discover(raw: &Raw) -> Result<Discovered, String> {
    unsafe extern "C" fn filetype(
        indexer: *const clap_preset_discovery_indexer,
        _filetype: *const clap_preset_discovery_filetype,
    ) -> bool {
        // SAFETY: made below.
        let found = unsafe { &*(*indexer).indexer_data.cast::<Discovered>() };
        found.filetypes.set(found.filetypes.get() + 1);
        true
    }
    unsafe extern "C" fn location(
        indexer: *const clap_preset_discovery_indexer,
        location: *const clap_preset_discovery_location,
    ) -> bool {
        // SAFETY: made below; a live location.
        unsafe {
            let found = &*(*indexer).indexer_data.cast::<Discovered>();
            let path = (*location).location;
            let path = (!path.is_null()).then(|| CStr::from_ptr(path).to_owned());
            found.locations.borrow_mut().push(((*location).kind, path));
        }
        true
    }
    unsafe extern "C" fn failed(
        receiver: *const clap_preset_discovery_metadata_receiver,
        _os_error: i32,
        message: *const c_char,
    ) {
        // SAFETY: made below; a live text.
        unsafe {
            let found = &*(*receiver).receiver_data.cast::<Discovered>();
            found.errors.borrow_mut().push(CStr::from_ptr(message).to_string_lossy().into_owned());
        }
    }
    unsafe extern "C" fn begin(
        receiver: *const clap_preset_discovery_metadata_receiver,
        name: *const c_char,
        key: *const c_char,
    ) -> bool {
        // SAFETY: made below; live texts.
        unsafe {
            let found = &*(*receiver).receiver_data.cast::<Discovered>();
            let key = (!key.is_null()).then(|| CStr::from_ptr(key).to_owned());
            let name = CStr::from_ptr(name).to_string_lossy().into_owned();
            let (kind, path) = found.at.borrow().clone();
            found.presets.borrow_mut().push((name, kind, path, key));
        }
        true
    }
    unsafe extern "C" fn plugin(
        receiver: *const clap_preset_discovery_metadata_receiver,
        _id: *const clap_sys::universal_plugin_id::clap_universal_plugin_id,
    ) {
        // SAFETY: made below.
        let found = unsafe { &*(*receiver).receiver_data.cast::<Discovered>() };
        found.plugins.set(found.plugins.get() + 1);
    }
    let found = Discovered::default();
    let data = std::ptr::from_ref(&found).cast_mut().cast::<c_void>();
    let indexer = clap_preset_discovery_indexer {
        clap_version: CLAP_VERSION,
        name: c"pyrophone-validator".as_ptr(),
        vendor: std::ptr::null(),
        url: std::ptr::null(),
        version: std::ptr::null(),
        indexer_data: data,
        declare_filetype: Some(filetype),
        declare_location: Some(location),
        declare_soundpack: None,
        get_extension: None,
    };
    let receiver = clap_preset_discovery_metadata_receiver {
        receiver_data: data,
        on_error: Some(failed),
        begin_preset: Some(begin),
        add_plugin_id: Some(plugin),
        set_soundpack_id: None,
        set_flags: None,
        add_creator: None,
        set_description: None,
        set_timestamps: None,
        add_feature: None,
        add_extra_info: None,
    };
    // SAFETY: a live entry; all arguments live as long as the provider.
    unsafe {
        let factory = ((*raw.entry).get_factory.ok_or("no get_factory")?)(CLAP_PRESET_DISCOVERY_FACTORY_ID.as_ptr());
        let factory = factory.cast::<clap_preset_discovery_factory>().as_ref().ok_or("no preset discovery")?;
        let descriptor = (factory.get_descriptor.ok_or("no descriptor")?)(factory, 0);
        let id = descriptor.as_ref().ok_or("no provider")?.id;
        let provider = (factory.create.ok_or("no create")?)(factory, &indexer, id);
        let provider_ref = provider.as_ref().ok_or("it makes no provider")?;
        ensure((provider_ref.init.ok_or("no init")?)(provider), || "the provider does not initialise".to_owned())?;
        let get = provider_ref.get_metadata.ok_or("no metadata")?;
        let locations = found.locations.borrow().clone();
        for (kind, path) in locations {
            // A folder is processed file by file, as in hosts.
            let paths: Vec<Option<CString>> = match &path {
                Some(folder) => files_in(folder).into_iter().map(Some).collect(),
                None => vec![None],
            };
            for path in paths {
                let location = path.as_ref().map_or(std::ptr::null(), |path| path.as_ptr());
                found.at.replace((kind, path.clone()));
                ensure(get(provider, kind, location, &receiver), || format!("nothing is reported about {path:?}"))?;
            }
        }
        (provider_ref.destroy.ok_or("no destroy")?)(provider);
    }
    Ok(found)
}

fn presets(bundle: &Path) -> Result<(), String> {
    let raw = Raw::load(bundle)?;
    let found = discover(&raw)?;
    let presets = found.presets.borrow();
    ensure(found.errors.borrow().is_empty(), || format!("{:?}", found.errors.borrow()))?;
    ensure(found.filetypes.get() == 1 && presets.len() >= 10 && found.plugins.get() == presets.len(), || {
        format!("{} file types, {} presets for {} plug-ins", found.filetypes.get(), presets.len(), found.plugins.get())
    })?;
    // SAFETY: the id's type.
    let load: &clap_plugin_preset_load = unsafe { raw.extension(CLAP_EXT_PRESET_LOAD)? };
    let load = load.from_location.ok_or("no from_location")?;
    let mut states = BTreeSet::new();
    for (name, kind, path, key) in presets.iter() {
        let text = |text: &Option<CString>| text.as_ref().map_or(std::ptr::null(), |text| text.as_ptr());
        // SAFETY: a live plug-in and live texts.
        let is_loaded = unsafe { load(raw.plugin, *kind, text(path), text(key)) };
        ensure(is_loaded, || format!("{name} is not loaded"))?;
        states.insert(raw.save()?);
    }
    ensure(states.len() > presets.len() / 2, || "most presets leave the same state".to_owned())?;
    // SAFETY: a live plug-in and a live text.
    let is_loaded = unsafe {
        load(raw.plugin, CLAP_PRESET_DISCOVERY_LOCATION_PLUGIN, std::ptr::null(), c"no such preset".as_ptr())
    };
    ensure(!is_loaded, || "it loads a preset that does not exist".to_owned())
}

fn extensions(bundle: &Path) -> Result<(), String> {
    let raw = Raw::load(bundle)?;
    // SAFETY: the ids' types, a live plug-in, and writable locations whose fields are numbers.
    unsafe {
        let context: &clap_plugin_state_context = raw.extension(CLAP_EXT_STATE_CONTEXT)?;
        let for_preset =
            saved(|stream| context.save.is_some_and(|save| save(raw.plugin, stream, CLAP_STATE_CONTEXT_FOR_PRESET)))?;
        loaded(&for_preset, |stream| {
            context.load.is_some_and(|load| load(raw.plugin, stream, CLAP_STATE_CONTEXT_FOR_PRESET))
        })?;

        let remote: &clap_plugin_remote_controls = raw.extension(CLAP_EXT_REMOTE_CONTROLS)?;
        let pages = (remote.count.ok_or("no count")?)(raw.plugin);
        // The number is up to the plug-in: every new group of parameters may add a page.
        ensure(pages >= LEAST_PAGES, || format!("{pages} remote control pages, at least {LEAST_PAGES} are wanted"))?;
        let ids: BTreeSet<u32> = raw.parameters()?.iter().map(|info| info.id).collect();
        for index in 0..pages {
            let mut page: clap_remote_controls_page = std::mem::zeroed();
            ensure((remote.get.ok_or("no get")?)(raw.plugin, index, &mut page), || format!("no page {index}"))?;
            ensure(page.param_ids.iter().all(|id| ids.contains(id)), || format!("page {index} has a gap"))?;
        }

        let indication: &clap_plugin_param_indication = raw.extension(CLAP_EXT_PARAM_INDICATION)?;
        let id = numeric_id("alpha");
        (indication.set_mapping.ok_or("no mapping")?)(
            raw.plugin,
            id,
            true,
            std::ptr::null(),
            c"knob".as_ptr(),
            std::ptr::null(),
        );
        (indication.set_automation.ok_or("no automation")?)(raw.plugin, id, 2, std::ptr::null());

        menu(&raw, id)
    }
}

/// The context menu of a parameter offers to reset it, and does.
///
/// # Safety
/// A live plug-in.
unsafe fn menu(raw: &Raw, id: u32) -> Result<(), String> {
    unsafe extern "C" fn add(builder: *const clap_context_menu_builder, _kind: u32, _item: *const c_void) -> bool {
        // SAFETY: made below.
        unsafe { *(*builder).ctx.cast::<usize>() += 1 };
        true
    }
    // SAFETY: the id's type; all arguments live as long as the calls.
    unsafe {
        let menu: &clap_plugin_context_menu = raw.extension(CLAP_EXT_CONTEXT_MENU)?;
        let target = clap_context_menu_target { kind: CLAP_CONTEXT_MENU_TARGET_KIND_PARAM, id };
        let mut items = 0usize;
        let builder = clap_context_menu_builder { ctx: (&raw mut items).cast(), add_item: Some(add), supports: None };
        let is_filled = (menu.populate.ok_or("no populate")?)(raw.plugin, &target, &builder);
        ensure(is_filled && items > 0, || "its context menu is empty".to_owned())?;
        let default = raw.value("alpha")?;
        raw.flush(&[event(id, 0.9)])?;
        ensure((menu.perform.ok_or("no perform")?)(raw.plugin, &target, 1), || "it does not reset".to_owned())?;
        let value = raw.value("alpha")?;
        ensure((value - default).abs() < 1e-6, || format!("reset, it is {value} instead of {default}"))
    }
}

fn ports(bundle: &Path) -> Result<(), String> {
    let raw = Raw::load(bundle)?;
    // SAFETY: the ids' types, a live plug-in, and writable locations whose fields are numbers and null pointers.
    unsafe {
        let configurable: &clap_plugin_configurable_audio_ports = raw.extension(CLAP_EXT_CONFIGURABLE_AUDIO_PORTS)?;
        let ports: &clap_plugin_audio_ports = raw.extension(CLAP_EXT_AUDIO_PORTS)?;
        let surround: &clap_plugin_surround = raw.extension(CLAP_EXT_SURROUND)?;
        let request = |is_input, channel_count| clap_audio_port_configuration_request {
            is_input,
            port_index: 0,
            channel_count,
            port_type: std::ptr::null(),
            port_details: std::ptr::null(),
        };
        let apply = configurable.apply_configuration.ok_or("no apply")?;
        let can = configurable.can_apply_configuration.ok_or("no can_apply")?;
        for (input, output, map) in
            [(1, 1, &[][..]), (2, 2, &[]), (5, 5, &[0, 1, 2, 9, 10]), (2, 6, &[0, 1, 2, 3, 9, 10])]
        {
            let requests = [request(true, input), request(false, output)];
            let is_applied = can(raw.plugin, requests.as_ptr(), 2) && apply(raw.plugin, requests.as_ptr(), 2);
            ensure(is_applied, || format!("{input} in, {output} out is not applied"))?;
            let mut info: clap_audio_port_info = std::mem::zeroed();
            (ports.get.ok_or("no get")?)(raw.plugin, 0, false, &mut info);
            ensure(info.channel_count == output, || {
                format!("{output} out were asked, {} are there", info.channel_count)
            })?;
            let mut found = [0u8; 8];
            let count = (surround.get_channel_map.ok_or("no map")?)(raw.plugin, false, 0, found.as_mut_ptr(), 8);
            ensure(&found[..count as usize] == map, || format!("the loudspeakers of {output} are {found:?}"))?;
        }
        // It does not have loudspeakers in another order, or other ones.
        for (map, is_ours) in [([0u8, 1, 2, 3, 9, 10], true), ([0, 1, 2, 3, 4, 5], false), ([0, 2, 1, 9, 10, 3], false)]
        {
            let asked = clap_audio_port_configuration_request {
                port_type: clap_sys::ext::surround::CLAP_PORT_SURROUND.as_ptr(),
                port_details: map.as_ptr().cast(),
                ..request(false, 6)
            };
            ensure(can(raw.plugin, &asked, 1) == is_ours, || format!("loudspeakers {map:?}"))?;
        }
        let absurd = [request(true, 77)];
        ensure(!can(raw.plugin, absurd.as_ptr(), 1), || "77 channels are taken".to_owned())?;
        let known = surround.is_channel_mask_supported.ok_or("no mask")?;
        ensure(known(raw.plugin, 0b110_0000_1111) && !known(raw.plugin, 0b1), || "masks are wrong".to_owned())
    }
}
