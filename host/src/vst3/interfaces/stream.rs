//! Streams for states.

use std::cell::{Cell, RefCell};
use std::ffi::c_void;

use ::vst3::Class;
use ::vst3::Steinberg::IBStream_::IStreamSeekMode_::{kIBSeekCur, kIBSeekEnd, kIBSeekSet};
use ::vst3::Steinberg::{IBStream, IBStreamTrait, int32, int64, kInvalidArgument, kResultFalse, kResultOk, tresult};

use super::out::write_if_wanted;

/// A stream in memory, for states, used only by the thread that created it.
pub struct MemoryStream {
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
