//! The CLAP entry, and everything a host finds in the library.
//!
//! | module | content |
//! |---|---|
//! | [`plugin`], [`guard`] | the effect as the host sees it, and the starting point of every extension |
//! | [`params`], [`events`] | parameters, and the events with their values |
//! | [`scale`], [`scratch`] | the host's scale of their values, and memory for our own events |
//! | [`controllers`] | MIDI controllers that move them |
//! | [`ports`] | layouts and loudspeakers |
//! | [`saving`] | states, and presets loaded by a host |
//! | [`discovery`] | presets for a host's browser |
//! | [`extras`] | indications and context menus |
//! | [`host_menu`] | the host's own entries in the window's menus |

mod controllers;
mod discovery;
mod events;
mod extras;
mod guard;
mod host_menu;
mod params;
mod plugin;
mod ports;
mod saving;
mod scale;
mod scratch;

use std::ffi::{CStr, c_char, c_void};
use std::sync::OnceLock;

use clap_sys::entry::clap_plugin_entry;
use clap_sys::factory::plugin_factory::{CLAP_PLUGIN_FACTORY_ID, clap_plugin_factory};
use clap_sys::factory::preset_discovery::{CLAP_PRESET_DISCOVERY_FACTORY_ID, CLAP_PRESET_DISCOVERY_FACTORY_ID_COMPAT};
use clap_sys::host::clap_host;
use clap_sys::plugin::{clap_plugin, clap_plugin_descriptor};
use clap_sys::version::CLAP_VERSION;
use nice_plug::wrapper::clap::PluginDescriptor;
use nice_plug::wrapper::setup_logger;

use crate::Pyrophone;

/// Symbol that hosts look up first.
#[unsafe(no_mangle)]
#[used]
#[allow(non_upper_case_globals, reason = "CLAP's name for it")]
pub static clap_entry: clap_plugin_entry = clap_plugin_entry {
    clap_version: CLAP_VERSION,
    init: Some(init),
    deinit: Some(deinit),
    get_factory: Some(get_factory),
};

static FACTORY: clap_plugin_factory = clap_plugin_factory {
    get_plugin_count: Some(count),
    get_plugin_descriptor: Some(descriptor_at),
    create_plugin: Some(create),
};

fn descriptor() -> &'static PluginDescriptor {
    static DESCRIPTOR: OnceLock<PluginDescriptor> = OnceLock::new();
    DESCRIPTOR.get_or_init(PluginDescriptor::for_plugin::<Pyrophone>)
}

unsafe extern "C" fn init(_path: *const c_char) -> bool {
    setup_logger::<Pyrophone>();
    true
}

unsafe extern "C" fn deinit() {}

unsafe extern "C" fn get_factory(id: *const c_char) -> *const c_void {
    if id.is_null() {
        return std::ptr::null();
    }
    // SAFETY: a text of the host's.
    let id = unsafe { CStr::from_ptr(id) };
    if id == CLAP_PLUGIN_FACTORY_ID {
        return std::ptr::from_ref(&FACTORY).cast();
    }
    if id == CLAP_PRESET_DISCOVERY_FACTORY_ID || id == CLAP_PRESET_DISCOVERY_FACTORY_ID_COMPAT {
        return std::ptr::from_ref(&discovery::PROVIDERS).cast();
    }
    std::ptr::null()
}

unsafe extern "C" fn count(_factory: *const clap_plugin_factory) -> u32 {
    1
}

unsafe extern "C" fn descriptor_at(_factory: *const clap_plugin_factory, index: u32) -> *const clap_plugin_descriptor {
    if index == 0 { descriptor().clap_plugin_descriptor() } else { std::ptr::null() }
}

unsafe extern "C" fn create(
    _factory: *const clap_plugin_factory,
    host: *const clap_host,
    id: *const c_char,
) -> *const clap_plugin {
    // SAFETY: null or a text of the host's.
    if host.is_null() || id.is_null() || unsafe { CStr::from_ptr(id) } != descriptor().clap_id() {
        return std::ptr::null();
    }
    // SAFETY: the host outlives its plug-ins.
    unsafe { plugin::create(host) }
}
