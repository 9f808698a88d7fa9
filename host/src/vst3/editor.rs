//! A VST3 editor: the plugin's view, and the frame with a run loop that the host gives it.

use std::cell::{Cell, RefCell};
use std::ffi::c_void;
use std::time::{Duration, Instant};

use ::vst3::Steinberg::Linux::{
    FileDescriptor, IEventHandler, IEventHandlerTrait, IRunLoop, IRunLoopTrait, ITimerHandler, ITimerHandlerTrait,
    TimerInterval,
};
use ::vst3::Steinberg::Vst::{IEditController, IEditControllerTrait, ViewType};
use ::vst3::Steinberg::{
    IPlugFrame, IPlugFrameTrait, IPlugView, IPlugViewContentScaleSupport, IPlugViewContentScaleSupportTrait,
    IPlugViewTrait, ViewRect, kInvalidArgument, kResultOk, tresult,
};
use ::vst3::{Class, ComPtr, ComRef, ComWrapper};

use crate::HostError;

#[cfg(windows)]
use ::vst3::Steinberg::kPlatformTypeHWND as PLATFORM;
/// The kind of windows on this system.
#[cfg(not(windows))]
use ::vst3::Steinberg::kPlatformTypeX11EmbedWindowID as PLATFORM;

/// An open editor.
pub(super) struct Editor {
    view: ComPtr<IPlugView>,
    frame: ComWrapper<PlugFrame>,
    is_forgotten: bool,
}

impl Editor {
    /// Opens the editor in a window of the system's and gives its size in pixels.
    pub fn open(controller: &ComPtr<IEditController>, window: u32) -> Result<(Self, (u32, u32)), HostError> {
        // SAFETY: a live controller, which returns a view with one reference to it, or null.
        let view = unsafe { ComPtr::from_raw(controller.createView(ViewType::kEditor)) }
            .ok_or_else(|| HostError::Unsupported("the plugin has no editor".to_owned()))?;
        // SAFETY: a live view.
        if unsafe { view.isPlatformTypeSupported(PLATFORM) } != kResultOk {
            return Err(failed("created for this system's windows"));
        }
        // From here on, `drop` undoes what was set up.
        let editor = Self { view, frame: ComWrapper::new(PlugFrame::default()), is_forgotten: false };
        let frame = editor.frame.as_com_ref::<IPlugFrame>().map_or(std::ptr::null_mut(), |frame| frame.as_ptr());
        // SAFETY: a live view; the frame is removed from it before the frame is dropped.
        if unsafe { editor.view.setFrame(frame) } != kResultOk {
            return Err(failed("given a frame"));
        }
        let parent = window as usize as *mut c_void;
        // SAFETY: the window is the caller's, and an id instead of memory; if it no longer exists, the system reports
        // that.
        if unsafe { editor.view.attached(parent, PLATFORM) } != kResultOk {
            return Err(failed("embedded"));
        }
        let size = editor.size()?;
        Ok((editor, size))
    }

    fn size(&self) -> Result<(u32, u32), HostError> {
        let mut rect = ViewRect { left: 0, top: 0, right: 0, bottom: 0 };
        // SAFETY: a live view and a writable location.
        let result = unsafe { self.view.getSize(&mut rect) };
        if result == kResultOk { Ok(size_of_rect(&rect)) } else { Err(failed("asked for its size")) }
    }

    /// Sets the number of pixels per point, and returns the view's resulting size in pixels.
    pub fn scale(&self, scale: f64) -> Result<(u32, u32), HostError> {
        let scaled = self.view.cast::<IPlugViewContentScaleSupport>().ok_or_else(|| failed("scaled"))?;
        // SAFETY: a live view.
        if unsafe { scaled.setContentScaleFactor(scale as f32) } != kResultOk {
            return Err(failed("scaled"));
        }
        self.size()
    }

    /// Resizes the view to the nearest size that it accepts, and returns that size.
    pub fn resize(&self, (width, height): (u32, u32)) -> Result<(u32, u32), HostError> {
        // SAFETY: a live view.
        if unsafe { self.view.canResize() } != kResultOk {
            return Err(failed("resized"));
        }
        let edge = |length: u32| i32::try_from(length).unwrap_or(i32::MAX);
        let mut rect = ViewRect { left: 0, top: 0, right: edge(width), bottom: edge(height) };
        // SAFETY: a live view and a rectangle to read and write.
        let result = unsafe {
            match self.view.checkSizeConstraint(&mut rect) {
                result if result == kResultOk => self.view.onSize(&mut rect),
                refused => refused,
            }
        };
        if result == kResultOk { Ok(size_of_rect(&rect)) } else { Err(failed("resized")) }
    }

    /// Size that the view has requested since the last call.
    pub fn take_wanted_size(&self) -> Option<(u32, u32)> {
        self.frame.wanted_size.take()
    }

    /// Releases the view without removing it.
    pub fn forget(mut self) {
        self.is_forgotten = true;
    }

    /// Runs the view's handlers that have been waiting.
    pub fn run(&self) {
        self.frame.run_loop();
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        if !self.is_forgotten {
            // SAFETY: a live view. One that was never attached reports that there is nothing to remove.
            unsafe {
                self.view.removed();
                self.view.setFrame(std::ptr::null_mut());
            }
        }
        // A plug-in that does not unregister its handlers would keep the frame alive, which holds them.
        self.frame.handlers.borrow_mut().clear();
        self.frame.timers.borrow_mut().clear();
    }
}

fn failed(what: &str) -> HostError {
    HostError::Unsupported(format!("the editor cannot be {what}"))
}

fn size_of_rect(rect: &ViewRect) -> (u32, u32) {
    let length = |from: i32, to: i32| u32::try_from(to.saturating_sub(from)).unwrap_or(0);
    (length(rect.left, rect.right), length(rect.top, rect.bottom))
}

struct Timer {
    handler: ComPtr<ITimerHandler>,
    interval: Duration,
    due: Instant,
}

/// Frame around a view, for its requests; on the main thread only.
#[derive(Default)]
struct PlugFrame {
    wanted_size: Cell<Option<(u32, u32)>>,
    handlers: RefCell<Vec<(ComPtr<IEventHandler>, FileDescriptor)>>,
    timers: RefCell<Vec<Timer>>,
}

impl PlugFrame {
    fn run_loop(&self) {
        // Handlers may register or unregister others, so nothing is borrowed while they are called.
        let handlers = self.handlers.borrow().clone();
        for (handler, descriptor) in handlers {
            if is_readable(descriptor) {
                // SAFETY: a live handler, on the thread that it was signed on from.
                unsafe { handler.onFDIsSet(descriptor) };
            }
        }
        let now = Instant::now();
        let mut due = Vec::new();
        for timer in self.timers.borrow_mut().iter_mut().filter(|timer| timer.due <= now) {
            timer.due = now + timer.interval;
            due.push(timer.handler.clone());
        }
        for handler in due {
            // SAFETY: a live handler, on the thread that it was signed on from.
            unsafe { handler.onTimer() };
        }
    }
}

#[cfg(not(unix))]
fn is_readable(_: FileDescriptor) -> bool {
    // No plug-in waits for descriptors if run loops belong to the system.
    false
}

#[cfg(unix)]
fn is_readable(descriptor: FileDescriptor) -> bool {
    let mut asked = libc::pollfd { fd: descriptor, events: libc::POLLIN, revents: 0 };
    // SAFETY: one structure to read and write; a closed descriptor is reported as such.
    unsafe { libc::poll(&mut asked, 1, 0) > 0 && asked.revents & libc::POLLIN != 0 }
}

impl Class for PlugFrame {
    type Interfaces = (IPlugFrame, IRunLoop);
}

impl IPlugFrameTrait for PlugFrame {
    unsafe fn resizeView(&self, _: *mut IPlugView, size: *mut ViewRect) -> tresult {
        // SAFETY: null or a rectangle of the plugin's.
        let Some(size) = (unsafe { size.as_ref() }) else {
            return kInvalidArgument;
        };
        self.wanted_size.set(Some(size_of_rect(size)));
        kResultOk
    }
}

impl IRunLoopTrait for PlugFrame {
    unsafe fn registerEventHandler(&self, handler: *mut IEventHandler, descriptor: FileDescriptor) -> tresult {
        // SAFETY: null or a live handler.
        let Some(handler) = (unsafe { ComRef::from_raw(handler) }) else {
            return kInvalidArgument;
        };
        self.handlers.borrow_mut().push((handler.to_com_ptr(), descriptor));
        kResultOk
    }

    unsafe fn unregisterEventHandler(&self, handler: *mut IEventHandler) -> tresult {
        // The removed item may be the last reference, and is dropped only after the list is free again.
        let gone: Vec<_> = self.handlers.borrow_mut().extract_if(.., |(known, _)| known.as_ptr() == handler).collect();
        if gone.is_empty() { kInvalidArgument } else { kResultOk }
    }

    unsafe fn registerTimer(&self, handler: *mut ITimerHandler, milliseconds: TimerInterval) -> tresult {
        // SAFETY: null or a live handler.
        let Some(handler) = (unsafe { ComRef::from_raw(handler) }) else {
            return kInvalidArgument;
        };
        let interval = Duration::from_millis(milliseconds);
        let timer = Timer { handler: handler.to_com_ptr(), interval, due: Instant::now() + interval };
        self.timers.borrow_mut().push(timer);
        kResultOk
    }

    unsafe fn unregisterTimer(&self, handler: *mut ITimerHandler) -> tresult {
        let is_meant = |timer: &mut Timer| timer.handler.as_ptr() == handler;
        let gone: Vec<_> = self.timers.borrow_mut().extract_if(.., is_meant).collect();
        if gone.is_empty() { kInvalidArgument } else { kResultOk }
    }
}
