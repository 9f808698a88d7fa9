//! A window on the desktop of Windows.

use std::io::Error;
use std::ptr::null;

use windows_sys::Win32::Foundation::HWND;
use windows_sys::Win32::UI::HiDpi::{
    AdjustWindowRectExForDpi, DPI_AWARENESS_CONTEXT_PER_MONITOR_AWARE_V2, GetDpiForWindow,
    SetProcessDpiAwarenessContext,
};
use windows_sys::Win32::UI::WindowsAndMessaging::{
    CreateWindowExW, DestroyWindow, DispatchMessageW, HWND_TOP, MSG, PM_REMOVE, PeekMessageW, SW_SHOWNOACTIVATE,
    SWP_NOACTIVATE, SWP_NOMOVE, SWP_NOSIZE, SWP_NOZORDER, SetWindowPos, ShowWindow, TranslateMessage, WS_CLIPCHILDREN,
    WS_OVERLAPPEDWINDOW,
};

type EditorResult = Result<(), Error>;

/// A window class that every process has; it shows its child windows.
const CLASS: &str = "STATIC";

/// A window with nothing in it.
pub(super) struct NativeWindow(HWND);

fn utf16(text: &str) -> Vec<u16> {
    text.encode_utf16().chain([0]).collect()
}

fn checked(is_done: i32) -> EditorResult {
    if is_done == 0 { Err(Error::last_os_error()) } else { Ok(()) }
}

impl NativeWindow {
    pub fn new(title: &str) -> Result<Self, Error> {
        // Present hosts see pixels; for others Windows enlarges the picture. Fails if the process has chosen already.
        // SAFETY: a value that Windows knows.
        unsafe { SetProcessDpiAwarenessContext(DPI_AWARENESS_CONTEXT_PER_MONITOR_AWARE_V2) };
        let (class, title) = (utf16(CLASS), utf16(title));
        let style = WS_OVERLAPPEDWINDOW | WS_CLIPCHILDREN;
        // SAFETY: both texts end in 0 and live until the call returns; all other pointers may be null.
        let window = unsafe {
            let none = std::ptr::null_mut();
            CreateWindowExW(0, class.as_ptr(), title.as_ptr(), style, 0, 0, 800, 600, none, none, none, null())
        };
        if window.is_null() {
            return Err(Error::last_os_error());
        }
        // SAFETY: a window of this thread.
        unsafe { ShowWindow(window, SW_SHOWNOACTIVATE) };
        Ok(Self(window))
    }

    /// Window handles have 32 significant bits, so that 32-bit and 64-bit processes can share them.
    pub fn id(&self) -> u32 {
        self.0 as usize as u32
    }

    pub fn fit(&self, (width, height): (u32, u32)) -> EditorResult {
        let edge = |length: u32| i32::try_from(length).unwrap_or(i32::MAX);
        let mut outside =
            windows_sys::Win32::Foundation::RECT { left: 0, top: 0, right: edge(width), bottom: edge(height) };
        // SAFETY: a rectangle to read and write, and a window of this thread.
        checked(unsafe { AdjustWindowRectExForDpi(&mut outside, WS_OVERLAPPEDWINDOW, 0, 0, GetDpiForWindow(self.0)) })?;
        let (width, height) = (outside.right - outside.left, outside.bottom - outside.top);
        let flags = SWP_NOMOVE | SWP_NOZORDER | SWP_NOACTIVATE;
        // SAFETY: a window of this thread; if it no longer exists, the system reports that.
        checked(unsafe { SetWindowPos(self.0, std::ptr::null_mut(), 0, 0, width, height, flags) })
    }

    /// Hands messages to this thread's windows, the editor's among them.
    pub fn handle_events(&self) {
        // SAFETY: a message consists of numbers, for which zero is a value, and is filled in before it is read.
        unsafe {
            let mut message: MSG = std::mem::zeroed();
            while PeekMessageW(&mut message, std::ptr::null_mut(), 0, 0, PM_REMOVE) != 0 {
                TranslateMessage(&message);
                DispatchMessageW(&message);
            }
        }
    }

    pub fn raise(&self) -> EditorResult {
        // SAFETY: a window of this thread; if it no longer exists, the system reports that.
        checked(unsafe { SetWindowPos(self.0, HWND_TOP, 0, 0, 0, 0, SWP_NOMOVE | SWP_NOSIZE | SWP_NOACTIVATE) })
    }

    pub fn destroy(&self) -> EditorResult {
        // SAFETY: a window of this thread; if it no longer exists, the system reports that.
        checked(unsafe { DestroyWindow(self.0) })
    }
}
