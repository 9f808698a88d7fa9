//! The host, its handler of requests, and the menus that it fills.

use std::ffi::c_void;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::sync::{Arc, Mutex};

use ::vst3::Steinberg::Vst::{
    IComponentHandler, IComponentHandler3, IComponentHandler3Trait, IComponentHandlerTrait, IContextMenu,
    IContextMenu_::Item, IContextMenuItem, IContextMenuItem_::Flags_, IContextMenuTarget, IContextMenuTargetTrait,
    IContextMenuTrait, IHostApplication, IHostApplicationTrait, ParamID, ParamValue, RestartFlags_, String128,
};
use ::vst3::Steinberg::{IPlugView, TUID, UCoord, int32, kInvalidArgument, kNotImplemented, kResultOk, tresult};
use ::vst3::{Class, ComPtr, ComWrapper};

use crate::lock::lock;
use crate::{Event, MENU, Requests, SUBMENU};

/// Identifies the host to the plug-in.
pub struct HostApplication;

impl Class for HostApplication {
    type Interfaces = (IHostApplication,);
}

impl IHostApplicationTrait for HostApplication {
    unsafe fn getName(&self, name: *mut String128) -> tresult {
        let mut text: String128 = [0; 128];
        for (to, from) in text.iter_mut().zip("pyrophone-host".encode_utf16()) {
            *to = from;
        }
        // SAFETY: the plug-in provides space for a whole `String128`.
        unsafe { name.write(text) };
        kResultOk
    }

    unsafe fn createInstance(&self, _: *mut TUID, _: *mut TUID, _: *mut *mut c_void) -> tresult {
        kNotImplemented
    }
}

/// Receives the plug-in's requests to its host, from any thread.
pub struct Handler {
    restart_flags: AtomicI32,
    /// Changes that go to the plug-in with the next block.
    pending: Arc<Mutex<Vec<Event>>>,
    active: AtomicBool,
    /// Parameters and entries that were chosen of menus.
    chosen: Arc<Mutex<Vec<(u32, i32)>>>,
}

impl Handler {
    pub fn new(pending: Arc<Mutex<Vec<Event>>>) -> Self {
        Self { restart_flags: AtomicI32::new(0), pending, active: AtomicBool::new(false), chosen: Arc::default() }
    }

    /// Menu choices since the last call.
    pub fn take_chosen(&self) -> Vec<(u32, i32)> {
        std::mem::take(&mut *lock(&self.chosen))
    }

    /// Sets whether there are blocks with which changes can be sent.
    pub fn set_active(&self, active: bool) {
        self.active.store(active, Ordering::Release);
    }

    pub fn take_requests(&self) -> Requests {
        let flags = self.restart_flags.swap(0, Ordering::AcqRel);
        let has = |flag| flags & flag != 0;
        Requests {
            restart: has(RestartFlags_::kReloadComponent | RestartFlags_::kIoChanged),
            latency_changed: has(RestartFlags_::kLatencyChanged),
            values_changed: has(RestartFlags_::kParamValuesChanged),
        }
    }
}

impl Class for Handler {
    type Interfaces = (IComponentHandler, IComponentHandler3);
}

impl IComponentHandler3Trait for Handler {
    unsafe fn createContextMenu(&self, view: *mut IPlugView, id: *const ParamID) -> *mut IContextMenu {
        // SAFETY: null or the plug-in's id.
        let Some(id) = (unsafe { id.as_ref() }).filter(|_| !view.is_null()) else { return std::ptr::null_mut() };
        let target = ComWrapper::new(MenuTarget { id: *id, chosen: self.chosen.clone() });
        ComWrapper::new(Menu(target)).to_com_ptr::<IContextMenu>().map_or(std::ptr::null_mut(), ComPtr::into_raw)
    }
}

/// Receives choices from a parameter's menu.
struct MenuTarget {
    id: ParamID,
    chosen: Arc<Mutex<Vec<(u32, i32)>>>,
}

impl Class for MenuTarget {
    type Interfaces = (IContextMenuTarget,);
}

impl IContextMenuTargetTrait for MenuTarget {
    unsafe fn executeMenuItem(&self, tag: int32) -> tresult {
        lock(&self.chosen).push((self.id, tag));
        kResultOk
    }
}

/// A parameter's menu, which the plug-in shows.
struct Menu(ComWrapper<MenuTarget>);

impl Class for Menu {
    type Interfaces = (IContextMenu,);
}

impl IContextMenuTrait for Menu {
    unsafe fn getItemCount(&self) -> int32 {
        5
    }

    unsafe fn getItem(&self, index: int32, item: *mut Item, target: *mut *mut IContextMenuTarget) -> tresult {
        let [first, second] = MENU;
        let (words, tag, flags) = match index {
            0 => (first.1, first.0, 0),
            1 => ("", 0, Flags_::kIsSeparator),
            2 => (SUBMENU, 0, Flags_::kIsGroupStart),
            3 => (second.1, second.0, 0),
            4 => ("", 0, Flags_::kIsGroupEnd),
            _ => return kInvalidArgument,
        };
        let mut name: String128 = [0; 128];
        name.iter_mut().zip(words.encode_utf16()).for_each(|(to, from)| *to = from);
        let own = self.0.as_com_ref::<IContextMenuTarget>().map_or(std::ptr::null_mut(), |target| target.as_ptr());
        // SAFETY: writable locations.
        unsafe {
            item.write(IContextMenuItem { name, tag, flags: flags as int32 });
            target.write(own);
        }
        kResultOk
    }

    unsafe fn addItem(&self, _: *const Item, _: *mut IContextMenuTarget) -> tresult {
        kNotImplemented
    }

    unsafe fn removeItem(&self, _: *const Item, _: *mut IContextMenuTarget) -> tresult {
        kNotImplemented
    }

    unsafe fn popup(&self, _: UCoord, _: UCoord) -> tresult {
        kNotImplemented
    }
}

impl IComponentHandlerTrait for Handler {
    unsafe fn beginEdit(&self, _: ParamID) -> tresult {
        kResultOk
    }

    unsafe fn performEdit(&self, id: ParamID, value: ParamValue) -> tresult {
        // The controller already has the value; the host sends it to the component.
        if self.active.load(Ordering::Acquire) {
            lock(&self.pending).push(Event { offset: 0, id, value });
        }
        kResultOk
    }

    unsafe fn endEdit(&self, _: ParamID) -> tresult {
        kResultOk
    }

    unsafe fn restartComponent(&self, flags: int32) -> tresult {
        self.restart_flags.fetch_or(flags, Ordering::AcqRel);
        kResultOk
    }
}
