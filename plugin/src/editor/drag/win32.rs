//! Dragging a sound out of the window under Windows.
//!
//! A drag is a loop of messages (`DoDragDrop`) that must run on the window's thread, but not within a call of the window
//! library, which borrows its state meanwhile. So a message is posted to an invisible window within the editor's, which
//! ends with it.

use std::os::windows::ffi::OsStrExt;
use std::path::PathBuf;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, AtomicPtr, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use raw_window_handle::{HasWindowHandle, RawWindowHandle};
use windows::Win32::Foundation::{
    DRAGDROP_S_CANCEL, DRAGDROP_S_DROP, DRAGDROP_S_USEDEFAULTCURSORS, HWND, LPARAM, LRESULT, S_OK, WPARAM,
};
use windows::Win32::System::Com::IDataObject;
use windows::Win32::System::Ole::{
    DROPEFFECT, DROPEFFECT_COPY, DROPEFFECT_NONE, DoDragDrop, IDropSource, IDropSource_Impl,
};
use windows::Win32::System::SystemServices::{MK_LBUTTON, MODIFIERKEYS_FLAGS};
use windows::Win32::UI::Shell::{BHID_DataObject, IShellItem, SHCreateItemFromParsingName};
use windows::Win32::UI::WindowsAndMessaging::{
    CreateWindowExW, DefWindowProcW, GWLP_USERDATA, GWLP_WNDPROC, GetParent, GetWindowLongPtrW, PostMessageW,
    SendMessageW, SetWindowLongPtrW, WINDOW_EX_STYLE, WM_APP, WM_LBUTTONUP, WM_NCDESTROY, WNDPROC, WS_CHILD,
};
use windows::core::{BOOL, HRESULT, PCWSTR, Result, implement, w};

use super::Outcome;

/// The message that starts a drag.
const WM_DRAG: u32 = WM_APP;
/// Interval at which a waiting drag looks whether it was called off.
const PERIOD: Duration = Duration::from_millis(20);

/// The window from which something is being dragged: there is one mouse.
static DRAGGED_FROM: AtomicPtr<core::ffi::c_void> = AtomicPtr::new(null_mut());

/// True if a file is being dragged out of this window, which is no target then: it would load the sound it has made.
pub fn is_dragged_from(window: HWND) -> bool {
    !window.is_invalid() && DRAGGED_FROM.load(Ordering::Relaxed) == window.0
}

/// A drag to be started by the window's thread.
struct Request {
    path: PathBuf,
    is_called_off: Arc<AtomicBool>,
    outcome: Sender<Outcome>,
}

/// The drag that the window's thread has to start next.
type Next = Mutex<Option<Request>>;

/// The window within the editor's that starts drags, and what it has to start.
pub struct Native {
    starter: isize,
    next: Arc<Next>,
}

impl Native {
    /// A starter within this window; none if the system refuses it. To be called on the window's thread.
    pub fn of(window: &impl HasWindowHandle) -> Option<Self> {
        let RawWindowHandle::Win32(handle) = window.window_handle().ok()?.as_raw() else { return None };
        let next = Arc::new(Next::default());
        let starter = starter(handle_of(handle.hwnd.get()), next.clone()).ok()?;
        Some(Self { starter: starter.0 as isize, next })
    }

    /// What drags an existing file, on any thread, until the button is released.
    pub fn drag(&self, path: PathBuf, is_called_off: Arc<AtomicBool>) -> impl FnOnce() -> Outcome + Send + use<> {
        let (starter, next) = (self.starter, self.next.clone());
        move || {
            let (sender, outcome) = channel();
            let request = Request { path, is_called_off: is_called_off.clone(), outcome: sender };
            *next.lock().unwrap_or_else(PoisonError::into_inner) = Some(request);
            // SAFETY: only numbers are passed on; a window that is gone is an error.
            if let Err(error) = unsafe { PostMessageW(Some(handle_of(starter)), WM_DRAG, WPARAM(0), LPARAM(0)) } {
                return failed(&error);
            }
            loop {
                match outcome.recv_timeout(PERIOD) {
                    Ok(outcome) => return outcome,
                    Err(RecvTimeoutError::Disconnected) => return Outcome::Dropped,
                    // The window may be closing, and then nobody starts the drag.
                    Err(RecvTimeoutError::Timeout) if is_called_off.load(Ordering::Relaxed) => return Outcome::Dropped,
                    Err(RecvTimeoutError::Timeout) => {}
                }
            }
        }
    }
}

/// Window handles are numbers, which threads may share; the type does not say so.
fn handle_of(window: isize) -> HWND {
    HWND(window as *mut _)
}

fn failed(error: &windows::core::Error) -> Outcome {
    Outcome::Failed(format!("the sound cannot be dragged: {error}; save it instead"))
}

/// An invisible window within the editor's that starts the drags which are left in `next`.
fn starter(editor: HWND, next: Arc<Next>) -> Result<HWND> {
    let procedure: WNDPROC = Some(procedure);
    // SAFETY: the class is the system's, and everything else is left out. The window's share of `next`, which it has up
    // to its end, is there before its procedure, which has the signature that is called.
    unsafe {
        let class = w!("STATIC");
        let plain = WINDOW_EX_STYLE::default();
        let starter = CreateWindowExW(plain, class, None, WS_CHILD, 0, 0, 0, 0, Some(editor), None, None, None)?;
        SetWindowLongPtrW(starter, GWLP_USERDATA, Arc::into_raw(next) as isize);
        SetWindowLongPtrW(starter, GWLP_WNDPROC, procedure.map_or(0, |procedure| procedure as *const () as isize));
        Ok(starter)
    }
}

/// Answers the message that starts a drag.
unsafe extern "system" fn procedure(starter: HWND, message: u32, w: WPARAM, l: LPARAM) -> LRESULT {
    // SAFETY: the window calls this with its own handle.
    let shared = unsafe { GetWindowLongPtrW(starter, GWLP_USERDATA) } as *const Next;
    match message {
        WM_DRAG if !shared.is_null() => {
            // SAFETY: the window's share, which it has up to its end.
            let request = unsafe { &*shared }.lock().unwrap_or_else(PoisonError::into_inner).take();
            // SAFETY: as above.
            let editor = unsafe { GetParent(starter) };
            // The share may be gone when the drag is over, so nothing of it is used afterwards.
            if let (Some(request), Ok(editor)) = (request, editor) {
                request.run(editor);
            }
            return LRESULT(0);
        }
        WM_NCDESTROY if !shared.is_null() => {
            // SAFETY: the window's share, at its end, which nobody sees any more.
            unsafe {
                SetWindowLongPtrW(starter, GWLP_USERDATA, 0);
                drop(Arc::from_raw(shared));
            }
        }
        _ => {}
    }
    // SAFETY: what the system has passed to us.
    unsafe { DefWindowProcW(starter, message, w, l) }
}

impl Request {
    /// Drags out of this window until the button is released.
    fn run(self, window: HWND) {
        // SAFETY: only numbers are passed on. The library thinks that the button is up, and gives back the mouse, which
        // the drag takes; it would not learn of the true release, and would take the mouse back.
        unsafe { SendMessageW(window, WM_LBUTTONUP, None, None) };
        DRAGGED_FROM.store(window.0, Ordering::Relaxed);
        let taken = self.drag();
        DRAGGED_FROM.store(null_mut(), Ordering::Relaxed);
        let outcome = taken.map_or_else(|error| failed(&error), |is_taken| Outcome::of(is_taken, self.path));
        // Fails only if the window is closing, and then nobody needs it.
        let _ = self.outcome.send(outcome);
    }

    /// True if a target accepted the file.
    fn drag(&self) -> Result<bool> {
        let path: Vec<u16> = self.path.as_os_str().encode_wide().chain([0]).collect();
        let source: IDropSource = Source { is_called_off: self.is_called_off.clone() }.into();
        let mut effect = DROPEFFECT_NONE;
        // SAFETY: a text that ends in zero, live objects and an effect to write, on a thread with OLE: the library has
        // registered a target on it.
        let result = unsafe {
            let item: IShellItem = SHCreateItemFromParsingName(PCWSTR(path.as_ptr()), None)?;
            let file: IDataObject = item.BindToHandler(None, &BHID_DataObject)?;
            DoDragDrop(&file, &source, DROPEFFECT_COPY, &mut effect)
        };
        result.ok()?;
        Ok(result == DRAGDROP_S_DROP && effect.contains(DROPEFFECT_COPY))
    }
}

/// Ends the drag with the button, and calls it off with Escape or with the window.
#[implement(IDropSource)]
struct Source {
    is_called_off: Arc<AtomicBool>,
}

impl IDropSource_Impl for Source_Impl {
    fn QueryContinueDrag(&self, escape: BOOL, keys: MODIFIERKEYS_FLAGS) -> HRESULT {
        let is_called_off = escape.as_bool() || self.is_called_off.load(Ordering::Relaxed);
        match (is_called_off, keys.contains(MK_LBUTTON)) {
            (true, _) => DRAGDROP_S_CANCEL,
            (false, true) => S_OK,
            (false, false) => DRAGDROP_S_DROP,
        }
    }

    fn GiveFeedback(&self, _effect: DROPEFFECT) -> HRESULT {
        DRAGDROP_S_USEDEFAULTCURSORS
    }
}
