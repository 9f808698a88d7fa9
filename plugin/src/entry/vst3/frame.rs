//! The window's frame as the framework sees it: the host's, with a run loop that unregisters its handlers.
//!
//! nice-plug 0.4.2 creates an event handler for each view; it holds a reference to itself and would unregister when
//! dropped, which therefore never happens: two descriptors and a view's worth of memory are lost for each window. So
//! the frame keeps the list of handlers; when the view releases the frame, they are unregistered and that reference is
//! released for them.

use std::sync::{Mutex, PoisonError};

use vst3::Steinberg::Linux::{FileDescriptor, IEventHandler, IRunLoop, IRunLoopTrait, ITimerHandler, TimerInterval};
use vst3::Steinberg::{
    IPlugFrame, IPlugFrameTrait, IPlugView, ViewRect, kInvalidArgument, kResultFalse, kResultOk, tresult,
};
use vst3::{Class, ComPtr};

/// Adapter between the framework's view and the host's frame.
pub struct GuardedPlugFrame {
    host: ComPtr<IPlugFrame>,
    run_loop: Option<ComPtr<IRunLoop>>,
    /// The view as the host knows it: the frame belongs to it and does not outlive it.
    view: *mut IPlugView,
    /// Handlers that are signed on, as addresses.
    handlers: Mutex<Vec<usize>>,
}

// SAFETY: hosts and framework use frames on the main thread; the pointer is only handed back to the host.
unsafe impl Send for GuardedPlugFrame {}
// SAFETY: as above; the list is behind a lock.
unsafe impl Sync for GuardedPlugFrame {}

impl GuardedPlugFrame {
    /// A frame for the view that the host knows by `view`.
    pub fn new(host: ComPtr<IPlugFrame>, view: *mut IPlugView) -> Self {
        let run_loop = host.cast::<IRunLoop>();
        Self { host, run_loop, view, handlers: Mutex::default() }
    }

    fn list(&self) -> std::sync::MutexGuard<'_, Vec<usize>> {
        self.handlers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Unregisters all handlers and releases the references that they hold to themselves. To be called once the
    /// framework's view has released the frame.
    pub fn sign_off(&self) {
        let handlers = std::mem::take(&mut *self.list());
        for handler in handlers {
            let handler = handler as *mut IEventHandler;
            if let Some(run_loop) = &self.run_loop {
                // SAFETY: a live run loop, and a handler that was signed on with it and is alive by its own reference.
                unsafe { run_loop.unregisterEventHandler(handler) };
            }
            // SAFETY: this is the reference that the handler's creator has leaked into it; nothing else releases it.
            drop(unsafe { ComPtr::from_raw(handler) });
        }
    }
}

impl Class for GuardedPlugFrame {
    type Interfaces = (IPlugFrame, IRunLoop);
}

impl IPlugFrameTrait for GuardedPlugFrame {
    unsafe fn resizeView(&self, _view: *mut IPlugView, size: *mut ViewRect) -> tresult {
        // SAFETY: a live frame of the host, and the view that it knows.
        unsafe { self.host.resizeView(self.view, size) }
    }
}

impl IRunLoopTrait for GuardedPlugFrame {
    unsafe fn registerEventHandler(&self, handler: *mut IEventHandler, descriptor: FileDescriptor) -> tresult {
        let Some(run_loop) = &self.run_loop else { return kResultFalse };
        if handler.is_null() {
            return kInvalidArgument;
        }
        // SAFETY: a live run loop and a live handler.
        let result = unsafe { run_loop.registerEventHandler(handler, descriptor) };
        if result == kResultOk {
            self.list().push(handler as usize);
        }
        result
    }

    unsafe fn unregisterEventHandler(&self, handler: *mut IEventHandler) -> tresult {
        // A handler unregistered here does so again when it is dropped; that must not reach the host.
        let mut list = self.list();
        let Some(place) = list.iter().position(|known| *known == handler as usize) else { return kResultOk };
        list.remove(place);
        drop(list);
        match &self.run_loop {
            // SAFETY: a live run loop and a live handler.
            Some(run_loop) => unsafe { run_loop.unregisterEventHandler(handler) },
            None => kResultFalse,
        }
    }

    unsafe fn registerTimer(&self, handler: *mut ITimerHandler, milliseconds: TimerInterval) -> tresult {
        match &self.run_loop {
            // SAFETY: a live run loop; the handler is the caller's.
            Some(run_loop) => unsafe { run_loop.registerTimer(handler, milliseconds) },
            None => kResultFalse,
        }
    }

    unsafe fn unregisterTimer(&self, handler: *mut ITimerHandler) -> tresult {
        match &self.run_loop {
            // SAFETY: a live run loop; the handler is the caller's.
            Some(run_loop) => unsafe { run_loop.unregisterTimer(handler) },
            None => kResultFalse,
        }
    }
}
