//! The window's view: the framework's, with a frame that is signed off.

use std::ffi::c_void;
use std::sync::atomic::{AtomicPtr, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use vst3::Steinberg::{
    FIDString, IPlugFrame, IPlugView, IPlugViewContentScaleSupport, IPlugViewContentScaleSupport_::ScaleFactor,
    IPlugViewContentScaleSupportTrait, IPlugViewTrait, TBool, ViewRect, char16, int16, kInvalidArgument,
    kNotImplemented, kResultOk, tresult,
};
use vst3::{Class, ComPtr, ComRef, ComWrapper};

use super::frame::GuardedPlugFrame;
use super::host_menu::OpenView;

/// Guard of the framework's view.
pub struct View {
    inner: ComPtr<IPlugView>,
    /// The address that the host knows this view by.
    address: AtomicPtr<IPlugView>,
    frame: Mutex<Option<ComWrapper<GuardedPlugFrame>>>,
    /// Holder of the address while the view is open.
    open: OpenView,
}

// SAFETY: views are used on the host's main thread only; shared data is behind a lock.
unsafe impl Send for View {}
// SAFETY: as above.
unsafe impl Sync for View {}

impl View {
    /// Guards the framework's view.
    pub fn new(inner: ComPtr<IPlugView>, open: OpenView) -> ComWrapper<Self> {
        let view = ComWrapper::new(Self { inner, address: AtomicPtr::default(), frame: Mutex::default(), open });
        if let Some(address) = view.as_com_ref::<IPlugView>() {
            view.address.store(address.as_ptr(), Ordering::Relaxed);
        }
        view
    }

    fn frame(&self) -> MutexGuard<'_, Option<ComWrapper<GuardedPlugFrame>>> {
        self.frame.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Removes the address, unless it is another view's.
    fn close(&self) {
        let (own, none) = (self.address.load(Ordering::Relaxed), std::ptr::null_mut());
        let _ = self.open.compare_exchange(own, none, Ordering::AcqRel, Ordering::Relaxed);
    }

    fn release_frame(&self) {
        let frame = self.frame().take();
        if let Some(frame) = frame {
            // SAFETY: a live view.
            unsafe { self.inner.setFrame(std::ptr::null_mut()) };
            frame.sign_off();
        }
    }
}

impl Drop for View {
    fn drop(&mut self) {
        self.close();
        self.release_frame();
    }
}

impl Class for View {
    type Interfaces = (IPlugView, IPlugViewContentScaleSupport);
}

impl IPlugViewTrait for View {
    unsafe fn isPlatformTypeSupported(&self, kind: FIDString) -> tresult {
        if kind.is_null() {
            return kInvalidArgument;
        }
        // SAFETY: a live view and a text.
        unsafe { self.inner.isPlatformTypeSupported(kind) }
    }

    unsafe fn attached(&self, parent: *mut c_void, kind: FIDString) -> tresult {
        if kind.is_null() {
            return kInvalidArgument;
        }
        self.open.store(self.address.load(Ordering::Relaxed), Ordering::Release);
        // SAFETY: a live view; the window and the text are the host's.
        unsafe { self.inner.attached(parent, kind) }
    }

    unsafe fn removed(&self) -> tresult {
        self.close();
        // SAFETY: a live view.
        unsafe { self.inner.removed() }
    }

    unsafe fn onWheel(&self, _distance: f32) -> tresult {
        kNotImplemented
    }

    unsafe fn onKeyDown(&self, key: char16, code: int16, modifiers: int16) -> tresult {
        // SAFETY: a live view.
        unsafe { self.inner.onKeyDown(key, code, modifiers) }
    }

    unsafe fn onKeyUp(&self, key: char16, code: int16, modifiers: int16) -> tresult {
        // SAFETY: a live view.
        unsafe { self.inner.onKeyUp(key, code, modifiers) }
    }

    unsafe fn getSize(&self, size: *mut ViewRect) -> tresult {
        // SAFETY: a live view; the function rejects null.
        unsafe { self.inner.getSize(size) }
    }

    unsafe fn onSize(&self, size: *mut ViewRect) -> tresult {
        // SAFETY: a live view; the function rejects null.
        unsafe { self.inner.onSize(size) }
    }

    unsafe fn onFocus(&self, state: TBool) -> tresult {
        // SAFETY: a live view.
        unsafe { self.inner.onFocus(state) }
    }

    unsafe fn setFrame(&self, frame: *mut IPlugFrame) -> tresult {
        self.release_frame();
        // SAFETY: null or a live frame.
        let Some(host) = (unsafe { ComRef::from_raw(frame) }) else { return kResultOk };
        let guard = ComWrapper::new(GuardedPlugFrame::new(host.to_com_ptr(), self.address.load(Ordering::Relaxed)));
        let pointer = guard.as_com_ref::<IPlugFrame>().map_or(std::ptr::null_mut(), |frame| frame.as_ptr());
        // SAFETY: a live view, which keeps its own reference.
        let result = unsafe { self.inner.setFrame(pointer) };
        *self.frame() = Some(guard);
        result
    }

    unsafe fn canResize(&self) -> tresult {
        // SAFETY: a live view.
        unsafe { self.inner.canResize() }
    }

    unsafe fn checkSizeConstraint(&self, size: *mut ViewRect) -> tresult {
        // SAFETY: a live view; the function rejects null.
        unsafe { self.inner.checkSizeConstraint(size) }
    }
}

impl IPlugViewContentScaleSupportTrait for View {
    unsafe fn setContentScaleFactor(&self, factor: ScaleFactor) -> tresult {
        match self.inner.cast::<IPlugViewContentScaleSupport>() {
            // SAFETY: a live view.
            Some(inner) => unsafe { inner.setContentScaleFactor(factor) },
            None => kNotImplemented,
        }
    }
}
