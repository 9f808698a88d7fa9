//! Large arrays written and read in their memory layout.
//!
//! A dictionary of two minutes of stereo has some 380 MB of numbers: decoding them one by one takes longer than making
//! the sound that they are for. Small data goes through `bitcode`, which skips fields that are [`Bulk`]; those follow
//! as plain bytes, each array after its length, in the order in which [`Bulk`] lists them.

use std::io::{Error, ErrorKind, Read, Result, Write};

use bitcode::{DecodeOwned, Encode};
use bytemuck::{Pod, allocation::try_zeroed_vec, cast_slice, cast_slice_mut};

/// An array of plain numbers.
pub(crate) trait Array {
    /// The array as bytes.
    fn bytes(&self) -> &[u8];
    /// Resizes the array to zero bytes, to be overwritten. Fails if they are not a whole number of elements, or if
    /// memory is too small.
    fn become_zeroed(&mut self, len_bytes: usize) -> Result<&mut [u8]>;
}

impl<T: Pod> Array for Vec<T> {
    fn bytes(&self) -> &[u8] {
        cast_slice(self)
    }

    fn become_zeroed(&mut self, len_bytes: usize) -> Result<&mut [u8]> {
        if !len_bytes.is_multiple_of(size_of::<T>()) {
            return Err(Error::new(ErrorKind::InvalidData, "an array ends within an element"));
        }
        *self = try_zeroed_vec(len_bytes / size_of::<T>()).map_err(|()| Error::from(ErrorKind::OutOfMemory))?;
        let bytes = cast_slice_mut(self);
        provide(bytes);
        Ok(bytes)
    }
}

/// Makes the system provide an array's memory at once. Page by page, as each page is first touched, it costs more than
/// everything else in reading a dictionary; large pages cost still more if memory is fragmented. Nothing depends on the
/// result: systems that do not support this advice reject it.
#[cfg(target_os = "linux")]
fn provide(bytes: &mut [u8]) {
    /// A smaller array has too few pages for this to save time.
    const LEAST_BYTES: usize = 1 << 20;
    const PAGE_BYTES: usize = 4096;
    if bytes.len() < LEAST_BYTES {
        return;
    }
    let offset = bytes.as_ptr().align_offset(PAGE_BYTES);
    let inner = &mut bytes[offset..];
    // SAFETY: the range consists of whole pages inside an array that is borrowed mutably, and the advice changes no
    // byte of it.
    unsafe { libc::madvise(inner.as_mut_ptr().cast(), inner.len() & !(PAGE_BYTES - 1), libc::MADV_POPULATE_WRITE) };
}

#[cfg(not(target_os = "linux"))]
fn provide(_: &mut [u8]) {}

/// A container of large arrays, or such an array itself.
pub(crate) trait Bulk {
    /// The arrays, always in the same order.
    fn arrays(&self) -> Vec<&dyn Array>;
    /// The same arrays, to be read into.
    fn arrays_mut(&mut self) -> Vec<&mut dyn Array>;
}

impl<T: Pod> Bulk for Vec<T> {
    fn arrays(&self) -> Vec<&dyn Array> {
        vec![self]
    }

    fn arrays_mut(&mut self) -> Vec<&mut dyn Array> {
        vec![self]
    }
}

impl<T: Bulk> Bulk for Option<T> {
    fn arrays(&self) -> Vec<&dyn Array> {
        self.as_ref().map_or_else(Vec::new, Bulk::arrays)
    }

    fn arrays_mut(&mut self) -> Vec<&mut dyn Array> {
        self.as_mut().map_or_else(Vec::new, Bulk::arrays_mut)
    }
}

impl<T: Bulk> Bulk for [T] {
    fn arrays(&self) -> Vec<&dyn Array> {
        self.iter().flat_map(Bulk::arrays).collect()
    }

    fn arrays_mut(&mut self) -> Vec<&mut dyn Array> {
        self.iter_mut().flat_map(Bulk::arrays_mut).collect()
    }
}

/// Names the fields of a type that are [`Bulk`].
macro_rules! bulk_fields {
    ($type:ty: $($field:ident),+) => {
        impl $crate::bulk::Bulk for $type {
            fn arrays(&self) -> Vec<&dyn $crate::bulk::Array> {
                let mut all = Vec::new();
                $(all.extend(self.$field.arrays());)+
                all
            }

            fn arrays_mut(&mut self) -> Vec<&mut dyn $crate::bulk::Array> {
                let mut all = Vec::new();
                $(all.extend(self.$field.arrays_mut());)+
                all
            }
        }
    };
}
pub(crate) use bulk_fields;

/// Writes an array after its length in bytes.
fn write_array(bytes: &[u8], out: &mut dyn Write) -> Result<()> {
    out.write_all(&(bytes.len() as u64).to_le_bytes())?;
    out.write_all(bytes)
}

/// Reads the output of [`write_array`]. `left` is the largest number of bytes allowed, and is reduced by those read: a
/// damaged length must not take all memory.
fn read_array(array: &mut dyn Array, left: &mut u64, from: &mut dyn Read) -> Result<()> {
    let mut len = [0; 8];
    from.read_exact(&mut len)?;
    let len = u64::from_le_bytes(len);
    *left = left.checked_sub(8).and_then(|left| left.checked_sub(len)).ok_or(ErrorKind::UnexpectedEof)?;
    let len = usize::try_from(len).map_err(|_| ErrorKind::OutOfMemory)?;
    from.read_exact(array.become_zeroed(len)?)
}

/// Writes a value: what `bitcode` encodes of it, and then its arrays.
pub(crate) fn write_value<T: Bulk + Encode>(value: &T, out: &mut dyn Write) -> Result<()> {
    write_array(&bitcode::encode(value), out)?;
    value.arrays().into_iter().try_for_each(|array| write_array(array.bytes(), out))
}

/// Reads the output of [`write_value`]; `left` as in [`read_array`].
pub(crate) fn read_value<T: Bulk + DecodeOwned>(from: &mut dyn Read, left: &mut u64) -> Result<T> {
    let mut small = Vec::<u8>::new();
    read_array(&mut small, left, from)?;
    let invalid = |error: bitcode::Error| Error::new(ErrorKind::InvalidData, error.to_string());
    let mut value: T = bitcode::decode(&small).map_err(invalid)?;
    value.arrays_mut().into_iter().try_for_each(|array| read_array(array, left, from))?;
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_read_back_as_written() {
        let (mut numbers, mut lanes) = (vec![1.5f64, -0.0, f64::NAN], vec![[3u8; 16]; 2]);
        let mut file = Vec::new();
        for bytes in [numbers.bytes(), lanes.bytes(), &[]] {
            write_array(bytes, &mut file).unwrap();
        }
        let expected = (numbers.bytes().to_vec(), lanes.clone());
        let (mut left, mut from) = (file.len() as u64, file.as_slice());
        let mut empty = vec![1u32];
        for array in [&mut numbers as &mut dyn Array, &mut lanes, &mut empty] {
            array.become_zeroed(0).unwrap();
            read_array(array, &mut left, &mut from).unwrap();
        }
        assert_eq!((numbers.bytes().to_vec(), lanes), expected);
        assert!(empty.is_empty() && left == 0);
    }

    #[test]
    fn wrong_lengths_are_refused_before_memory_is_taken() {
        let mut numbers: Vec<f64> = Vec::new();
        for (len, bytes) in [(u64::MAX, 8), (1 << 40, 8), (16, 8), (12, 12)] {
            let mut file = len.to_le_bytes().to_vec();
            file.resize(8 + bytes, 0);
            let mut left = file.len() as u64;
            assert!(read_array(&mut numbers, &mut left, &mut file.as_slice()).is_err(), "{len}");
        }
        assert!(read_array(&mut numbers, &mut 100, &mut [0u8; 3].as_slice()).is_err());
    }
}
