//! Dropping files on the window under Windows. baseview 0.4.2 registers a target of its own, and egui-baseview 0.9.0
//! discards what arrives there, so ours takes its place. Windows calls it on the window's thread.

use std::ffi::OsString;
use std::os::windows::ffi::OsStringExt;
use std::path::PathBuf;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};

use nice_plug_egui::RepaintNotifier;
use raw_window_handle::{HasWindowHandle, RawWindowHandle};
use windows::Win32::Foundation::{HWND, POINTL, S_OK};
use windows::Win32::System::Com::{DVASPECT_CONTENT, FORMATETC, IDataObject, TYMED_HGLOBAL};
use windows::Win32::System::Ole::{
    CF_HDROP, DROPEFFECT, DROPEFFECT_COPY, DROPEFFECT_NONE, IDropTarget, IDropTarget_Impl, RegisterDragDrop,
    ReleaseStgMedium, RevokeDragDrop,
};
use windows::Win32::System::SystemServices::MODIFIERKEYS_FLAGS;
use windows::core::{Ref, Result, implement};
use windows_sys::Win32::UI::Shell::DragQueryFileW;

use crate::editor::drag::is_dragged_from;

/// Receiver of files dropped on a window. The window library removes the target together with the window.
pub struct DropTarget {
    dropped: Mutex<Receiver<PathBuf>>,
    is_hovered: Arc<AtomicBool>,
}

impl DropTarget {
    /// Starts accepting files for this window; none where that is not possible. `notifier` wakes the window.
    pub fn open(window: &impl HasWindowHandle, notifier: RepaintNotifier) -> Option<Self> {
        let RawWindowHandle::Win32(handle) = window.window_handle().ok()?.as_raw() else { return None };
        let window = HWND(handle.hwnd.get() as *mut _);
        let (sender, dropped) = channel();
        let is_hovered = Arc::new(AtomicBool::new(false));
        let target: IDropTarget = Target { window, dropped: sender, is_hovered: is_hovered.clone(), notifier }.into();
        // SAFETY: a window of this thread, which has initialised OLE, since the library has registered a target.
        unsafe {
            // Fails if there is none, and then there is room for ours.
            let _ = RevokeDragDrop(window);
            RegisterDragDrop(window, &target).ok()?;
        }
        Some(Self { dropped: Mutex::new(dropped), is_hovered })
    }

    /// True if a file is held over the window.
    pub fn is_hovered(&self) -> bool {
        self.is_hovered.load(Ordering::Relaxed)
    }

    /// A file that was dropped.
    pub fn poll(&mut self) -> Option<PathBuf> {
        self.dropped.get_mut().unwrap_or_else(PoisonError::into_inner).try_recv().ok()
    }
}

/// The object that Windows calls.
#[implement(IDropTarget)]
struct Target {
    window: HWND,
    dropped: Sender<PathBuf>,
    is_hovered: Arc<AtomicBool>,
    notifier: RepaintNotifier,
}

impl Target {
    fn hover(&self, is_hovered: bool) {
        self.is_hovered.store(is_hovered, Ordering::Relaxed);
        self.notifier.request_repaint();
    }

    /// Tells the source what happens to its data: `effect` has what it permits.
    fn answer(&self, effect: *mut DROPEFFECT, accepts: bool) {
        // SAFETY: Windows passes a location to read and write, or null.
        if let Some(effect) = unsafe { effect.as_mut() } {
            *effect = if accepts { *effect & DROPEFFECT_COPY } else { DROPEFFECT_NONE };
        }
    }
}

impl IDropTarget_Impl for Target_Impl {
    fn DragEnter(
        &self,
        data: Ref<'_, IDataObject>,
        _keys: MODIFIERKEYS_FLAGS,
        _at: &POINTL,
        effect: *mut DROPEFFECT,
    ) -> Result<()> {
        self.hover(data.as_ref().is_some_and(has_files) && !is_dragged_from(self.window));
        self.answer(effect, self.is_hovered.load(Ordering::Relaxed));
        Ok(())
    }

    fn DragOver(&self, _keys: MODIFIERKEYS_FLAGS, _at: &POINTL, effect: *mut DROPEFFECT) -> Result<()> {
        self.answer(effect, self.is_hovered.load(Ordering::Relaxed));
        Ok(())
    }

    fn DragLeave(&self) -> Result<()> {
        self.hover(false);
        Ok(())
    }

    fn Drop(
        &self,
        data: Ref<'_, IDataObject>,
        _keys: MODIFIERKEYS_FLAGS,
        _at: &POINTL,
        effect: *mut DROPEFFECT,
    ) -> Result<()> {
        let is_welcome = self.is_hovered.load(Ordering::Relaxed);
        let files = data.as_ref().filter(|_| is_welcome).map(files_in).unwrap_or_default();
        self.answer(effect, !files.is_empty());
        // Fails only if the window is closing, and then nobody needs them.
        files.into_iter().for_each(|file| drop(self.dropped.send(file)));
        self.hover(false);
        Ok(())
    }
}

/// A list of files in memory.
fn format() -> FORMATETC {
    FORMATETC {
        cfFormat: CF_HDROP.0,
        ptd: null_mut(),
        dwAspect: DVASPECT_CONTENT.0,
        lindex: -1,
        tymed: TYMED_HGLOBAL.0 as u32,
    }
}

fn has_files(data: &IDataObject) -> bool {
    // SAFETY: a live object and a format to read.
    let found = unsafe { data.QueryGetData(&format()) };
    found == S_OK
}

/// The files that an object names; none if it names none.
fn files_in(data: &IDataObject) -> Vec<PathBuf> {
    // SAFETY: a live object and a format to read.
    let Ok(mut medium) = (unsafe { data.GetData(&format()) }) else { return vec![] };
    // SAFETY: the object has been asked for memory, and so has given that.
    let list = unsafe { medium.u.hGlobal.0 };
    // SAFETY: a list of files, of which this is the number.
    let count = unsafe { DragQueryFileW(list, u32::MAX, null_mut(), 0) };
    let files = (0..count).map(|index| {
        // SAFETY: the same list; without room, the length is returned.
        let length = unsafe { DragQueryFileW(list, index, null_mut(), 0) };
        let mut path = vec![0; length as usize + 1];
        // SAFETY: the room that is named, for the path and the zero at its end.
        let length = unsafe { DragQueryFileW(list, index, path.as_mut_ptr(), length + 1) };
        path.truncate(length as usize);
        PathBuf::from(OsString::from_wide(&path))
    });
    let files = files.collect();
    // SAFETY: the object has passed it on to us, and it is not used afterwards.
    unsafe { ReleaseStgMedium(&mut medium) };
    files
}
