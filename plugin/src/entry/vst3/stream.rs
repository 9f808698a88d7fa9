//! States as bytes, and streams as VST3 has them.

use std::cell::{Cell, RefCell};
use std::ffi::c_void;

use vst3::Steinberg::IBStream_::IStreamSeekMode_::{kIBSeekCur, kIBSeekEnd, kIBSeekSet};
use vst3::Steinberg::{IBStream, IBStreamTrait, int32, int64, kInvalidArgument, kResultFalse, kResultOk, tresult};
use vst3::{Class, ComRef, ComWrapper};

/// Longest state accepted: an embedded recording, with a margin.
const MAX_BYTES: usize = 1 << 30;
/// Bytes read at once.
const PIECE: usize = 1 << 16;

/// A stream in memory, used only by the thread that created it.
pub struct MemoryStream {
    bytes: RefCell<Vec<u8>>,
    position: Cell<usize>,
}

impl MemoryStream {
    /// A stream over these bytes, from the first.
    pub fn new(bytes: Vec<u8>) -> ComWrapper<Self> {
        ComWrapper::new(Self { bytes: RefCell::new(bytes), position: Cell::new(0) })
    }

    /// The bytes so far.
    pub fn take_bytes(&self) -> Vec<u8> {
        self.bytes.take()
    }
}

/// The stream as the framework wants it; valid as long as `stream` is.
pub fn pointer(stream: &ComWrapper<MemoryStream>) -> *mut IBStream {
    stream.as_com_ref::<IBStream>().map_or(std::ptr::null_mut(), |stream| stream.as_ptr())
}

/// The rest of a host's stream. Some hosts return fewer bytes than requested, some return an error at the end: only the
/// number of bytes counts.
///
/// # Safety
/// `stream` is null or a live stream.
pub unsafe fn read_all(stream: *mut IBStream) -> Option<Vec<u8>> {
    // SAFETY: guaranteed by the caller.
    let stream = unsafe { ComRef::from_raw(stream) }?;
    let mut bytes = Vec::new();
    loop {
        let start = bytes.len();
        bytes.resize(start + PIECE, 0);
        let mut done: int32 = 0;
        // SAFETY: room for a piece, and a writable location.
        unsafe { stream.read(bytes[start..].as_mut_ptr().cast(), PIECE as int32, &mut done) };
        let done = usize::try_from(done).unwrap_or(0).min(PIECE);
        bytes.truncate(start + done);
        if done == 0 {
            return Some(bytes);
        }
        if bytes.len() > MAX_BYTES {
            return None;
        }
    }
}

/// Writes all bytes; returns false if the host did not accept them.
///
/// # Safety
/// `stream` is null or a live stream.
pub unsafe fn write_all(stream: *mut IBStream, mut bytes: &[u8]) -> bool {
    // SAFETY: guaranteed by the caller.
    let Some(stream) = (unsafe { ComRef::from_raw(stream) }) else { return false };
    while !bytes.is_empty() {
        let count = bytes.len().min(PIECE);
        let mut done: int32 = 0;
        // SAFETY: `count` readable bytes, which a stream does not change, and a writable location.
        let result = unsafe { stream.write(bytes.as_ptr().cast_mut().cast(), count as int32, &mut done) };
        // Some hosts do not report the number of bytes written.
        let done = if done <= 0 && result == kResultOk { count } else { usize::try_from(done).unwrap_or(0).min(count) };
        if result != kResultOk || done == 0 {
            return false;
        }
        bytes = &bytes[done..];
    }
    true
}

impl Class for MemoryStream {
    type Interfaces = (IBStream,);
}

/// # Safety
/// `place` is null or valid for a write.
unsafe fn write_if_wanted<T>(place: *mut T, value: T) {
    if !place.is_null() {
        // SAFETY: guaranteed by the caller.
        unsafe { place.write(value) };
    }
}

impl IBStreamTrait for MemoryStream {
    unsafe fn read(&self, buffer: *mut c_void, count: int32, done: *mut int32) -> tresult {
        let bytes = self.bytes.borrow();
        let rest = bytes.get(self.position.get()..).unwrap_or_default();
        let length = rest.len().min(usize::try_from(count).unwrap_or(0));
        // SAFETY: the caller gives room for `count` bytes, and `done` is null or writable.
        unsafe {
            buffer.cast::<u8>().copy_from_nonoverlapping(rest.as_ptr(), length);
            write_if_wanted(done, length as int32);
        }
        self.position.set(self.position.get() + length);
        kResultOk
    }

    unsafe fn write(&self, buffer: *mut c_void, count: int32, done: *mut int32) -> tresult {
        let Ok(length) = usize::try_from(count) else { return kInvalidArgument };
        let (start, end) = (self.position.get(), self.position.get() + length);
        let mut bytes = self.bytes.borrow_mut();
        if bytes.len() < end {
            bytes.resize(end, 0);
        }
        // SAFETY: the caller gives `count` bytes, and `done` is null or writable.
        unsafe {
            bytes[start..end].as_mut_ptr().copy_from_nonoverlapping(buffer.cast::<u8>(), length);
            write_if_wanted(done, count);
        }
        self.position.set(end);
        kResultOk
    }

    unsafe fn seek(&self, offset: int64, mode: int32, result: *mut int64) -> tresult {
        let from = match mode {
            mode if mode == kIBSeekSet as int32 => 0,
            mode if mode == kIBSeekCur as int32 => self.position.get(),
            mode if mode == kIBSeekEnd as int32 => self.bytes.borrow().len(),
            _ => return kInvalidArgument,
        };
        let Some(position) = from.checked_add_signed(offset as isize) else { return kResultFalse };
        self.position.set(position);
        // SAFETY: `result` is null or writable.
        unsafe { write_if_wanted(result, position as int64) };
        kResultOk
    }

    unsafe fn tell(&self, position: *mut int64) -> tresult {
        // SAFETY: `position` is null or writable.
        unsafe { write_if_wanted(position, self.position.get() as int64) };
        kResultOk
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stream_reads_back_all_bytes_written() {
        let bytes: Vec<u8> = (0..3 * PIECE + 7).map(|index| index as u8).collect();
        let to = MemoryStream::new(Vec::new());
        // SAFETY: a live stream.
        assert!(unsafe { write_all(pointer(&to), &bytes) });
        let from = MemoryStream::new(to.take_bytes());
        // SAFETY: a live stream.
        assert_eq!(unsafe { read_all(pointer(&from)) }, Some(bytes));
        // SAFETY: null is no stream.
        assert_eq!(unsafe { read_all(std::ptr::null_mut()) }, None);
    }
}
