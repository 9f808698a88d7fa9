//! An instance of the plug-in over the C interface, and a host that counts what it is told.

use std::cell::Cell;
use std::ffi::{CStr, CString, c_char, c_void};
use std::path::Path;

use clap_sys::audio_buffer::clap_audio_buffer;
use clap_sys::entry::clap_plugin_entry;
use clap_sys::events::clap_event_param_value;
use clap_sys::ext::latency::{CLAP_EXT_LATENCY, clap_host_latency};
use clap_sys::ext::params::{CLAP_EXT_PARAMS, clap_param_info, clap_plugin_params};
use clap_sys::ext::state::{CLAP_EXT_STATE, clap_plugin_state};
use clap_sys::factory::plugin_factory::{CLAP_PLUGIN_FACTORY_ID, clap_plugin_factory};
use clap_sys::host::clap_host;
use clap_sys::plugin::clap_plugin;
use clap_sys::process::{CLAP_PROCESS_ERROR, clap_process};
use clap_sys::stream::{clap_istream, clap_ostream};
use clap_sys::version::CLAP_VERSION;
use libloading::Library;

use crate::numeric_id;
use crate::validator::ensure;

use super::events::{Events, no_output};

/// Samples of a block.
pub(super) const BLOCK: usize = 64;

/// Calls that the plug-in made to its host.
#[derive(Default)]
pub(super) struct Notices {
    pub is_activating: Cell<bool>,
    pub announced: Cell<u32>,
    pub misplaced: Cell<u32>,
    pub restarts: Cell<u32>,
    pub callbacks: Cell<u32>,
}

/// An instance without a host's usual safeguards.
pub(super) struct Raw {
    _library: Library,
    pub entry: *const clap_plugin_entry,
    pub plugin: *const clap_plugin,
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
    /// Loads the bundle and makes an instance.
    pub fn load(bundle: &Path) -> Result<Self, String> {
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

    /// Calls that the plug-in made so far.
    pub fn notices(&self) -> &Notices {
        // SAFETY: made in `load`.
        unsafe { notices(&*self.host) }
    }

    /// An extension of the plug-in's.
    ///
    /// # Safety
    /// `T` is the extension's type.
    pub unsafe fn extension<T>(&self, id: &CStr) -> Result<&T, String> {
        // SAFETY: a live plug-in; guaranteed by the caller.
        let found = unsafe { (*self.plugin).get_extension.map(|get| get(self.plugin, id.as_ptr()).cast::<T>()) };
        // SAFETY: as above.
        found.and_then(|found| unsafe { found.as_ref() }).ok_or_else(|| format!("it has no {}", id.to_string_lossy()))
    }

    /// Activates it and starts processing.
    pub fn activate(&mut self, sample_rate: f64) -> Result<(), String> {
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

    /// Ends processing, if it was started.
    pub fn deactivate(&mut self) {
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

    /// Runs the callbacks on the main thread that the plug-in asked for.
    pub fn run_callbacks(&self) {
        while self.notices().callbacks.replace(0) > 0 {
            // SAFETY: a live plug-in, on its main thread.
            unsafe {
                if let Some(run) = (*self.plugin).on_main_thread {
                    run(self.plugin);
                }
            };
        }
    }

    /// Processes one block; returns CLAP's status.
    pub fn process(
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

    /// Sends events outside processing.
    pub fn flush(&self, events: &[clap_event_param_value]) -> Result<(), String> {
        // SAFETY: the id's type.
        let params: &clap_plugin_params = unsafe { self.extension(CLAP_EXT_PARAMS)? };
        let list = Events(events);
        let (incoming, outgoing) = (list.as_clap(), no_output());
        // SAFETY: a live plug-in that is not processing.
        unsafe { (params.flush.ok_or("no flush")?)(self.plugin, &incoming, &outgoing) };
        Ok(())
    }

    /// Plain value of a parameter.
    pub fn value(&self, id: &str) -> Result<f64, String> {
        // SAFETY: the id's type.
        let params: &clap_plugin_params = unsafe { self.extension(CLAP_EXT_PARAMS)? };
        let mut value = f64::NAN;
        // SAFETY: a live plug-in and a writable location.
        let is_known = unsafe { (params.get_value.ok_or("no get_value")?)(self.plugin, numeric_id(id), &mut value) };
        ensure(is_known, || format!("there is no {id}"))?;
        Ok(value)
    }

    /// Descriptions of all parameters.
    pub fn parameters(&self) -> Result<Vec<clap_param_info>, String> {
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

    /// The state as bytes.
    pub fn save(&self) -> Result<Vec<u8>, String> {
        // SAFETY: the id's type.
        let state: &clap_plugin_state = unsafe { self.extension(CLAP_EXT_STATE)? };
        saved(|stream| {
            // SAFETY: a live plug-in and a live stream.
            state.save.is_some_and(|save| unsafe { save(self.plugin, stream) })
        })
    }

    /// Loads a state.
    pub fn load_state(&self, bytes: &[u8]) -> Result<(), String> {
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

/// What a plug-in saves into a stream, taken piece by piece.
pub(super) fn saved(save: impl FnOnce(&clap_ostream) -> bool) -> Result<Vec<u8>, String> {
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

/// Passes bytes to a plug-in as a stream, piece by piece.
pub(super) fn loaded(mut bytes: &[u8], load: impl FnOnce(&clap_istream) -> bool) -> Result<(), String> {
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
