//! The source's side of drag and drop under Windows: a window, and a list with one file.

use std::ffi::OsStr;
use std::mem::{ManuallyDrop, size_of, zeroed};
use std::os::windows::ffi::OsStrExt;

use windows::Win32::Foundation::{
    DRAGDROP_S_CANCEL, DRAGDROP_S_DROP, DRAGDROP_S_USEDEFAULTCURSORS, DV_E_FORMATETC, E_NOTIMPL, HGLOBAL,
    OLE_E_ADVISENOTSUPPORTED, S_OK,
};
use windows::Win32::System::Com::{
    FORMATETC, IAdviseSink, IDataObject, IDataObject_Impl, IEnumFORMATETC, IEnumSTATDATA, STGMEDIUM, STGMEDIUM_0,
    TYMED_HGLOBAL,
};
use windows::Win32::System::Memory::{GMEM_MOVEABLE, GMEM_ZEROINIT, GlobalAlloc, GlobalLock, GlobalUnlock};
use windows::Win32::System::Ole::{
    CF_HDROP, DROPEFFECT, DROPEFFECT_COPY, DROPEFFECT_NONE, DoDragDrop, IDropSource, IDropSource_Impl, OleInitialize,
};
use windows::Win32::System::SystemServices::{MK_LBUTTON, MODIFIERKEYS_FLAGS};
use windows::Win32::UI::WindowsAndMessaging::{
    CreateWindowExW, DispatchMessageW, GetMessageW, MSG, WINDOW_STYLE, WM_LBUTTONDOWN, WS_EX_TOPMOST, WS_POPUP,
    WS_VISIBLE,
};
use windows::core::{BOOL, HRESULT, Ref, Result, implement, w};

/// Style of a text that notices the mouse (`SS_NOTIFY`).
const NOTICES_MOUSE: WINDOW_STYLE = WINDOW_STYLE(0x100);
/// Width and height of the window in pixels.
const SIZE: (i32, i32) = (120, 60);

/// Opens the window, and drags the file whenever the mouse is pressed in it; does not return.
pub fn offer(file: &OsStr, (left, top): (i32, i32)) -> Result<()> {
    let style = WS_POPUP | WS_VISIBLE | NOTICES_MOUSE;
    // SAFETY: the texts are constant, and everything else is left out.
    let window = unsafe {
        OleInitialize(None)?;
        let (class, title) = (w!("STATIC"), w!("drag from here"));
        CreateWindowExW(WS_EX_TOPMOST, class, title, style, left, top, SIZE.0, SIZE.1, None, None, None, None)?
    };
    // SAFETY: a message consists of numbers, for which zero is a value.
    let mut message: MSG = unsafe { zeroed() };
    // SAFETY: a message to write.
    while unsafe { GetMessageW(&mut message, None, 0, 0) }.as_bool() {
        if message.hwnd == window && message.message == WM_LBUTTONDOWN {
            drag(file);
        }
        // SAFETY: a message that was written above.
        unsafe { DispatchMessageW(&message) };
    }
    Ok(())
}

/// Drags the file until the button is released, and prints what came of it.
fn drag(file: &OsStr) {
    let list: IDataObject = FileList(file.encode_wide().collect()).into();
    let source: IDropSource = Source.into();
    let mut effect = DROPEFFECT_NONE;
    // SAFETY: live objects and an effect to write, on a thread with OLE.
    let result = unsafe { DoDragDrop(&list, &source, DROPEFFECT_COPY, &mut effect) };
    let is_taken = result == DRAGDROP_S_DROP && effect == DROPEFFECT_COPY;
    println!("{}", if is_taken { "taken" } else { "refused" });
}

/// Ends the drag with the button, and calls it off with Escape.
#[implement(IDropSource)]
struct Source;

impl IDropSource_Impl for Source_Impl {
    fn QueryContinueDrag(&self, escape: BOOL, keys: MODIFIERKEYS_FLAGS) -> HRESULT {
        match (escape.as_bool(), keys.contains(MK_LBUTTON)) {
            (true, _) => DRAGDROP_S_CANCEL,
            (false, true) => S_OK,
            (false, false) => DRAGDROP_S_DROP,
        }
    }

    fn GiveFeedback(&self, _effect: DROPEFFECT) -> HRESULT {
        DRAGDROP_S_USEDEFAULTCURSORS
    }
}

/// One file as the shell lists it (`CF_HDROP`); its path in UTF-16.
#[implement(IDataObject)]
struct FileList(Vec<u16>);

impl FileList {
    /// The list in memory of Windows': a header (`DROPFILES`), the path, a zero, and one more at the end of the list.
    fn memory(&self) -> Result<HGLOBAL> {
        /// Bytes of the header, which holds four numbers between its first and its last: the header's length, and that
        /// characters are wide.
        const HEADER: usize = 20;
        let length = HEADER + size_of::<u16>() * (self.0.len() + 2);
        // SAFETY: a length in bytes.
        let memory = unsafe { GlobalAlloc(GMEM_MOVEABLE | GMEM_ZEROINIT, length)? };
        let path = self.0.iter().flat_map(|unit| unit.to_le_bytes());
        // SAFETY: as many bytes as were allocated, which start out as zeros, and which nobody else has yet.
        unsafe {
            let bytes = std::slice::from_raw_parts_mut(GlobalLock(memory).cast::<u8>(), length);
            bytes[0] = HEADER as u8;
            bytes[HEADER - 4] = 1;
            bytes[HEADER..].iter_mut().zip(path).for_each(|(to, from)| *to = from);
            // Reports an error where none is, since no lock is left.
            let _ = GlobalUnlock(memory);
        }
        Ok(memory)
    }
}

impl IDataObject_Impl for FileList_Impl {
    fn GetData(&self, format: *const FORMATETC) -> Result<STGMEDIUM> {
        if self.QueryGetData(format) != S_OK {
            return Err(DV_E_FORMATETC.into());
        }
        let u = STGMEDIUM_0 { hGlobal: self.memory()? };
        Ok(STGMEDIUM { tymed: TYMED_HGLOBAL.0 as u32, u, pUnkForRelease: ManuallyDrop::new(None) })
    }

    fn GetDataHere(&self, _format: *const FORMATETC, _medium: *mut STGMEDIUM) -> Result<()> {
        Err(E_NOTIMPL.into())
    }

    fn QueryGetData(&self, format: *const FORMATETC) -> HRESULT {
        // SAFETY: Windows passes a format, or null.
        match unsafe { format.as_ref() } {
            Some(format) if format.cfFormat == CF_HDROP.0 && format.tymed & TYMED_HGLOBAL.0 as u32 != 0 => S_OK,
            _ => DV_E_FORMATETC,
        }
    }

    fn GetCanonicalFormatEtc(&self, _format: *const FORMATETC, _canonical: *mut FORMATETC) -> HRESULT {
        E_NOTIMPL
    }

    fn SetData(&self, _format: *const FORMATETC, _medium: *const STGMEDIUM, _release: BOOL) -> Result<()> {
        Err(E_NOTIMPL.into())
    }

    fn EnumFormatEtc(&self, _direction: u32) -> Result<IEnumFORMATETC> {
        Err(E_NOTIMPL.into())
    }

    fn DAdvise(&self, _format: *const FORMATETC, _flags: u32, _sink: Ref<'_, IAdviseSink>) -> Result<u32> {
        Err(OLE_E_ADVISENOTSUPPORTED.into())
    }

    fn DUnadvise(&self, _connection: u32) -> Result<()> {
        Err(OLE_E_ADVISENOTSUPPORTED.into())
    }

    fn EnumDAdvise(&self) -> Result<IEnumSTATDATA> {
        Err(OLE_E_ADVISENOTSUPPORTED.into())
    }
}
