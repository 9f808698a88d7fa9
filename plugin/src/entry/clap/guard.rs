//! The guard of the framework's plug-in: the starting point of every extension.

use std::ffi::CStr;
use std::sync::Mutex;

use clap_sys::ext::audio_ports::{CLAP_EXT_AUDIO_PORTS, clap_plugin_audio_ports};
use clap_sys::ext::audio_ports_config::{CLAP_EXT_AUDIO_PORTS_CONFIG, clap_plugin_audio_ports_config};
use clap_sys::ext::params::{CLAP_EXT_PARAMS, clap_plugin_params};
use clap_sys::ext::state::{CLAP_EXT_STATE, clap_plugin_state};
use clap_sys::host::clap_host;
use clap_sys::plugin::clap_plugin;

use super::scratch::Scratch;
use crate::entry::buses::Buses;
use crate::entry::instance::Instance;

/// Guard of the framework's plug-in. It has the same data pointer, by which the framework's functions find their own
/// object, so functions that need no guard are called with it directly.
#[repr(C)]
pub struct Guard {
    /// The plug-in as called by the host. It comes first: a pointer to it is a pointer to the guard.
    pub(super) clap: clap_plugin,
    /// The framework's functions.
    pub(super) inner: clap_plugin,
    pub(super) host: *const clap_host,
    pub(super) instance: Instance,
    pub(super) events: Mutex<Scratch>,
    /// Used by the audio thread while active, exchanged by the main thread while not: never waited for.
    pub(super) buses: Mutex<Option<Buses>>,
}

impl Guard {
    /// The guard of a plug-in.
    ///
    /// # Safety
    /// `plugin` is null or was made by [`create`](super::plugin::create) and is not destroyed.
    pub unsafe fn of<'a>(plugin: *const clap_plugin) -> Option<&'a Self> {
        // SAFETY: guaranteed by the caller; the guard begins with the host's plug-in.
        unsafe { plugin.cast::<Self>().as_ref() }
    }

    /// The pointer that the framework's functions are called with.
    pub fn plugin(&self) -> *const clap_plugin {
        &self.clap
    }

    /// An extension of the framework's.
    ///
    /// # Safety
    /// `T` is the extension's type.
    unsafe fn inner_extension<T>(&self, id: &CStr) -> Option<&T> {
        let get = self.inner.get_extension?;
        // SAFETY: a live plug-in; guaranteed by the caller.
        unsafe { get(self.plugin(), id.as_ptr()).cast::<T>().as_ref() }
    }

    /// The framework's parameters.
    pub fn params(&self) -> Option<&clap_plugin_params> {
        // SAFETY: the id's type.
        unsafe { self.inner_extension(CLAP_EXT_PARAMS) }
    }

    /// The framework's states.
    pub fn state(&self) -> Option<&clap_plugin_state> {
        // SAFETY: the id's type.
        unsafe { self.inner_extension(CLAP_EXT_STATE) }
    }

    /// The framework's ports.
    pub fn audio_ports(&self) -> Option<&clap_plugin_audio_ports> {
        // SAFETY: the id's type.
        unsafe { self.inner_extension(CLAP_EXT_AUDIO_PORTS) }
    }

    /// The framework's layouts.
    pub fn audio_ports_config(&self) -> Option<&clap_plugin_audio_ports_config> {
        // SAFETY: the id's type.
        unsafe { self.inner_extension(CLAP_EXT_AUDIO_PORTS_CONFIG) }
    }

    /// An extension of the host's.
    ///
    /// # Safety
    /// `T` is the extension's type, and the plug-in is initialised.
    pub unsafe fn host_extension<T>(&self, id: &CStr) -> Option<&T> {
        // SAFETY: the host outlives its plug-ins; guaranteed by the caller.
        unsafe { ((*self.host).get_extension?)(self.host, id.as_ptr()).cast::<T>().as_ref() }
    }

    /// Latency in samples that the last activation has decided; 0 before the first.
    pub fn latency_samples(&self) -> u32 {
        self.instance.meters.engine().map_or(0, |(latency_samples, _)| latency_samples)
    }
}
