//! Host side of VST3: interfaces that a plug-in may call.

use std::cell::{Cell, RefCell};
use std::ffi::c_void;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::sync::{Arc, Mutex};

use ::vst3::Steinberg::IBStream_::IStreamSeekMode_::{kIBSeekCur, kIBSeekEnd, kIBSeekSet};
use ::vst3::Steinberg::Vst::{
    IComponentHandler, IComponentHandler3, IComponentHandler3Trait, IComponentHandlerTrait, IContextMenu,
    IContextMenu_::Item, IContextMenuItem, IContextMenuItem_::Flags_, IContextMenuTarget, IContextMenuTargetTrait,
    IContextMenuTrait, IHostApplication, IHostApplicationTrait, IParamValueQueue, IParamValueQueueTrait,
    IParameterChanges, IParameterChangesTrait, ParamID, ParamValue, RestartFlags_, String128,
};
use ::vst3::Steinberg::{
    IBStream, IBStreamTrait, IPlugView, TUID, UCoord, int32, int64, kInvalidArgument, kNotImplemented, kResultFalse,
    kResultOk, tresult,
};
use ::vst3::{Class, ComPtr, ComWrapper};

use crate::lock::lock;
use crate::{Event, MENU, Requests, SUBMENU};

/// Identifies the host to the plug-in.
pub(super) struct HostApplication;

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
pub(super) struct Handler {
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

/// A stream in memory, for states, used only by the thread that created it.
pub(super) struct MemoryStream {
    bytes: RefCell<Vec<u8>>,
    position: Cell<usize>,
}

impl MemoryStream {
    pub const fn new(bytes: Vec<u8>) -> Self {
        Self { bytes: RefCell::new(bytes), position: Cell::new(0) }
    }

    pub fn bytes(&self) -> Vec<u8> {
        self.bytes.borrow().clone()
    }

    pub fn rewind(&self) {
        self.position.set(0);
    }
}

impl Class for MemoryStream {
    type Interfaces = (IBStream,);
}

impl IBStreamTrait for MemoryStream {
    unsafe fn read(&self, buffer: *mut c_void, count: int32, done: *mut int32) -> tresult {
        let bytes = self.bytes.borrow();
        let rest = bytes.get(self.position.get()..).unwrap_or_default();
        let length = rest.len().min(usize::try_from(count).unwrap_or(0));
        // SAFETY: the plug-in provides space for `count` bytes, and `done` is null or a writable location.
        unsafe {
            buffer.cast::<u8>().copy_from_nonoverlapping(rest.as_ptr(), length);
            write_if_wanted(done, length as int32);
        }
        self.position.set(self.position.get() + length);
        kResultOk
    }

    unsafe fn write(&self, buffer: *mut c_void, count: int32, done: *mut int32) -> tresult {
        let Ok(length) = usize::try_from(count) else {
            return kInvalidArgument;
        };
        let mut bytes = self.bytes.borrow_mut();
        let start = self.position.get();
        let end = start + length;
        if bytes.len() < end {
            bytes.resize(end, 0);
        }
        // SAFETY: the plug-in passes `count` bytes, and `done` is null or a writable location.
        unsafe {
            bytes[start..end].as_mut_ptr().copy_from_nonoverlapping(buffer.cast::<u8>(), length);
            write_if_wanted(done, count);
        }
        self.position.set(end);
        kResultOk
    }

    unsafe fn seek(&self, offset: int64, mode: int32, result: *mut int64) -> tresult {
        let from = match mode {
            m if m == kIBSeekSet as int32 => 0,
            m if m == kIBSeekCur as int32 => self.position.get(),
            m if m == kIBSeekEnd as int32 => self.bytes.borrow().len(),
            _ => return kInvalidArgument,
        };
        let Some(position) = from.checked_add_signed(offset as isize) else {
            return kResultFalse;
        };
        self.position.set(position);
        // SAFETY: `result` is null or a writable location.
        unsafe { write_if_wanted(result, position as int64) };
        kResultOk
    }

    unsafe fn tell(&self, position: *mut int64) -> tresult {
        // SAFETY: `position` is null or a writable location.
        unsafe { write_if_wanted(position, self.position.get() as int64) };
        kResultOk
    }
}

/// # Safety
/// `place` is null or valid for a write.
unsafe fn write_if_wanted<T>(place: *mut T, value: T) {
    if !place.is_null() {
        // SAFETY: guaranteed by the caller.
        unsafe { place.write(value) };
    }
}

/// The changes of one parameter within a block.
struct Queue {
    id: ParamID,
    points: Vec<(int32, ParamValue)>,
}

impl Class for Queue {
    type Interfaces = (IParamValueQueue,);
}

impl IParamValueQueueTrait for Queue {
    unsafe fn getParameterId(&self) -> ParamID {
        self.id
    }

    unsafe fn getPointCount(&self) -> int32 {
        self.points.len() as int32
    }

    unsafe fn getPoint(&self, index: int32, offset: *mut int32, value: *mut ParamValue) -> tresult {
        let point = usize::try_from(index).ok().and_then(|i| self.points.get(i));
        let Some(&(at, to)) = point else {
            return kInvalidArgument;
        };
        // SAFETY: null or writable locations.
        unsafe {
            write_if_wanted(offset, at);
            write_if_wanted(value, to);
        }
        kResultOk
    }

    /// Input queues are the host's to fill.
    unsafe fn addPoint(&self, _: int32, _: ParamValue, _: *mut int32) -> tresult {
        kResultFalse
    }
}

/// A plug-in's output for one parameter.
struct OutputQueue {
    id: ParamID,
    points: RefCell<Vec<(int32, ParamValue)>>,
}

impl Class for OutputQueue {
    type Interfaces = (IParamValueQueue,);
}

impl IParamValueQueueTrait for OutputQueue {
    unsafe fn getParameterId(&self) -> ParamID {
        self.id
    }

    unsafe fn getPointCount(&self) -> int32 {
        self.points.borrow().len() as int32
    }

    unsafe fn getPoint(&self, _: int32, _: *mut int32, _: *mut ParamValue) -> tresult {
        kNotImplemented
    }

    unsafe fn addPoint(&self, offset: int32, value: ParamValue, index: *mut int32) -> tresult {
        let mut points = self.points.borrow_mut();
        // SAFETY: null or a writable location.
        unsafe { write_if_wanted(index, points.len() as int32) };
        points.push((offset, value));
        kResultOk
    }
}

/// A plug-in's output within a block, used only by the thread that plays it.
#[derive(Default)]
pub(super) struct OutputChanges {
    queues: RefCell<Vec<(ComWrapper<OutputQueue>, ComPtr<IParamValueQueue>)>>,
}

impl OutputChanges {
    /// All output events.
    pub fn events(&self) -> Vec<Event> {
        let queues = self.queues.borrow();
        let of = |queue: &OutputQueue| {
            let event = |(offset, value): &(int32, f64)| Event { offset: *offset as u32, id: queue.id, value: *value };
            queue.points.borrow().iter().map(event).collect::<Vec<_>>()
        };
        queues.iter().flat_map(|(queue, _)| of(queue)).collect()
    }
}

impl Class for OutputChanges {
    type Interfaces = (IParameterChanges,);
}

impl IParameterChangesTrait for OutputChanges {
    unsafe fn getParameterCount(&self) -> int32 {
        self.queues.borrow().len() as int32
    }

    unsafe fn getParameterData(&self, _: int32) -> *mut IParamValueQueue {
        std::ptr::null_mut()
    }

    unsafe fn addParameterData(&self, id: *const ParamID, index: *mut int32) -> *mut IParamValueQueue {
        // SAFETY: null or the plug-in's id.
        let Some(id) = (unsafe { id.as_ref() }).copied() else { return std::ptr::null_mut() };
        let mut queues = self.queues.borrow_mut();
        let place = queues.iter().position(|(queue, _)| queue.id == id).unwrap_or(queues.len());
        if place == queues.len() {
            let queue = ComWrapper::new(OutputQueue { id, points: RefCell::default() });
            let Some(pointer) = queue.to_com_ptr() else { return std::ptr::null_mut() };
            queues.push((queue, pointer));
        }
        // SAFETY: null or a writable location.
        unsafe { write_if_wanted(index, place as int32) };
        queues[place].1.as_ptr()
    }
}

/// All changes within a block.
pub(super) struct ParameterChanges {
    queues: Vec<ComPtr<IParamValueQueue>>,
}

impl ParameterChanges {
    /// `events` in order of their offsets.
    pub fn new<'a>(events: impl Iterator<Item = &'a Event>) -> Self {
        let mut queues: Vec<Queue> = Vec::new();
        for event in events {
            let point = (event.offset as int32, event.value.clamp(0.0, 1.0));
            match queues.iter_mut().find(|queue| queue.id == event.id) {
                Some(queue) => queue.points.push(point),
                None => queues.push(Queue { id: event.id, points: vec![point] }),
            }
        }
        Self { queues: queues.into_iter().filter_map(|queue| ComWrapper::new(queue).to_com_ptr()).collect() }
    }
}

impl Class for ParameterChanges {
    type Interfaces = (IParameterChanges,);
}

impl IParameterChangesTrait for ParameterChanges {
    unsafe fn getParameterCount(&self) -> int32 {
        self.queues.len() as int32
    }

    unsafe fn getParameterData(&self, index: int32) -> *mut IParamValueQueue {
        usize::try_from(index).ok().and_then(|i| self.queues.get(i)).map_or(std::ptr::null_mut(), ComPtr::as_ptr)
    }

    /// Input changes are the host's to fill.
    unsafe fn addParameterData(&self, _: *const ParamID, _: *mut int32) -> *mut IParamValueQueue {
        std::ptr::null_mut()
    }
}
