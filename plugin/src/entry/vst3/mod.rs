//! The VST3 factory, and everything a host finds in the library.
//!
//! | module | content |
//! |---|---|
//! | [`component`] | the effect as the host sees it |
//! | [`processor`] | arrangements, set-up, blocks |
//! | [`controller`] | parameters and their groups |
//! | [`controllers`] | MIDI controllers that move parameters |
//! | [`pending`] | values set on the main thread that no block has carried yet |
//! | [`host_menu`] | the host's own entries in the window's menus |
//! | [`view`], [`frame`] | the window and the run loop around it |
//! | [`stream`], [`text`] | states and texts in VST3's form |

mod component;
mod controller;
mod controllers;
mod frame;
mod host_menu;
mod pending;
mod processor;
mod stream;
mod text;
mod view;

use std::ffi::c_void;

use nice_plug::wrapper::setup_logger;
use nice_plug::wrapper::vst3::PluginInfo;
use vst3::Steinberg::{
    FIDString, FUnknown, IPluginFactory, IPluginFactory2, IPluginFactory2Trait, IPluginFactory3, IPluginFactory3Trait,
    IPluginFactoryTrait, PClassInfo, PClassInfo2, PClassInfoW, PFactoryInfo, TUID, int32, kInvalidArgument,
    kOutOfMemory, kResultOk, tresult,
};
use vst3::{Class, ComWrapper};

use crate::Pyrophone;
use component::Component;

/// Creator of effects.
struct Factory(PluginInfo);

impl Factory {
    /// Writes the description of the only class.
    ///
    /// # Safety
    /// `place` is null or valid for a write.
    unsafe fn describe<T>(&self, index: int32, place: *mut T, info: impl FnOnce(&PluginInfo) -> T) -> tresult {
        if index != 0 || place.is_null() {
            return kInvalidArgument;
        }
        // SAFETY: guaranteed by the caller.
        unsafe { place.write(info(&self.0)) };
        kResultOk
    }
}

impl Class for Factory {
    type Interfaces = (IPluginFactory, IPluginFactory2, IPluginFactory3);
}

impl IPluginFactoryTrait for Factory {
    unsafe fn getFactoryInfo(&self, info: *mut PFactoryInfo) -> tresult {
        // SAFETY: null or a writable location.
        unsafe { self.describe(0, info, PluginInfo::create_factory_info) }
    }

    unsafe fn countClasses(&self) -> int32 {
        1
    }

    unsafe fn getClassInfo(&self, index: int32, info: *mut PClassInfo) -> tresult {
        // SAFETY: null or a writable location.
        unsafe { self.describe(index, info, PluginInfo::create_class_info) }
    }

    unsafe fn createInstance(&self, class: FIDString, interface: FIDString, object: *mut *mut c_void) -> tresult {
        if class.is_null() || interface.is_null() || object.is_null() {
            return kInvalidArgument;
        }
        // SAFETY: a writable location.
        unsafe { object.write(std::ptr::null_mut()) };
        // SAFETY: ids of classes have sixteen bytes.
        if unsafe { &*class.cast::<[u8; 16]>() } != self.0.cid {
            return kInvalidArgument;
        }
        let Some(component) = Component::new() else { return kOutOfMemory };
        let Some(unknown) = component.as_com_ref::<FUnknown>() else { return kOutOfMemory };
        let unknown = unknown.as_ptr();
        // SAFETY: a live object, an id of sixteen bytes and a writable location.
        unsafe { ((*(*unknown).vtbl).queryInterface)(unknown, interface.cast::<TUID>(), object) }
    }
}

impl IPluginFactory2Trait for Factory {
    unsafe fn getClassInfo2(&self, index: int32, info: *mut PClassInfo2) -> tresult {
        // SAFETY: null or a writable location.
        unsafe { self.describe(index, info, PluginInfo::create_class_info_2) }
    }
}

impl IPluginFactory3Trait for Factory {
    unsafe fn getClassInfoUnicode(&self, index: int32, info: *mut PClassInfoW) -> tresult {
        // SAFETY: null or a writable location.
        unsafe { self.describe(index, info, PluginInfo::create_class_info_unicode) }
    }

    unsafe fn setHostContext(&self, _context: *mut FUnknown) -> tresult {
        kResultOk
    }
}

/// The factory, with one reference to it.
#[unsafe(no_mangle)]
pub extern "system" fn GetPluginFactory() -> *mut c_void {
    ComWrapper::new(Factory(PluginInfo::for_plugin::<Pyrophone>()))
        .to_com_ptr::<IPluginFactory>()
        .map_or(std::ptr::null_mut(), |factory| factory.into_raw().cast())
}

fn enter() -> bool {
    setup_logger::<Pyrophone>();
    true
}

/// Linux: the library has been loaded.
#[cfg(all(target_family = "unix", not(target_os = "macos")))]
#[unsafe(no_mangle)]
pub extern "C" fn ModuleEntry(_library: *mut c_void) -> bool {
    enter()
}

/// Linux: called before the library is unloaded.
#[cfg(all(target_family = "unix", not(target_os = "macos")))]
#[unsafe(no_mangle)]
pub extern "C" fn ModuleExit() -> bool {
    true
}

/// macOS: the bundle has been loaded.
#[cfg(target_os = "macos")]
#[unsafe(no_mangle)]
pub extern "C" fn bundleEntry(_bundle: *mut c_void) -> bool {
    enter()
}

/// macOS: called before the bundle is unloaded.
#[cfg(target_os = "macos")]
#[unsafe(no_mangle)]
pub extern "C" fn bundleExit() -> bool {
    true
}

/// Windows: the library has been loaded.
#[cfg(target_os = "windows")]
#[unsafe(no_mangle)]
pub extern "system" fn InitDll() -> bool {
    enter()
}

/// Windows: called before the library is unloaded.
#[cfg(target_os = "windows")]
#[unsafe(no_mangle)]
pub extern "system" fn ExitDll() -> bool {
    true
}
