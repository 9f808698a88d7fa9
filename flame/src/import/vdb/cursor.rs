//! Sequential reading of bytes, never past their end.

use crate::import::error::{FormatFault, damaged};

/// Longest text accepted.
const LONGEST_TEXT: usize = 1 << 16;

/// A position in a file, or in a part of it that ends earlier. Positions count from the file's first byte.
#[derive(Debug, Clone)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    /// A cursor from `start` to `end`; fails unless both lie in the file, in this order.
    pub fn within(bytes: &'a [u8], start: usize, end: usize) -> Result<Self, FormatFault> {
        match bytes.get(..end) {
            Some(bytes) if start <= end => Ok(Self { bytes, at: start }),
            _ => damaged(format!("a part from byte {start} to {end} in {} bytes", bytes.len())),
        }
    }

    /// Another cursor over the same bytes, from `start` to `end`.
    pub fn part(&self, start: usize, end: usize) -> Result<Self, FormatFault> {
        Self::within(self.bytes, start, end)
    }

    /// Moves to a later position.
    pub fn forward_to(&mut self, position: usize) -> Result<(), FormatFault> {
        match position.checked_sub(self.at) {
            Some(count) => self.read_bytes(count).map(|_| ()),
            None => damaged(format!("byte {position} before byte {}", self.at)),
        }
    }

    /// The position after the last byte.
    pub fn end(&self) -> usize {
        self.bytes.len()
    }

    /// The position of the next byte.
    pub fn offset(&self) -> usize {
        self.at
    }

    /// Number of bytes left.
    pub fn left(&self) -> usize {
        self.bytes.len().saturating_sub(self.at)
    }

    /// The next `count` bytes.
    pub fn read_bytes(&mut self, count: usize) -> Result<&'a [u8], FormatFault> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        match rest.get(..count) {
            Some(taken) => {
                self.at += count;
                Ok(taken)
            }
            None => damaged(format!(
                "it ends early: {count} bytes are expected at byte {}, but only {} are left",
                self.at,
                rest.len()
            )),
        }
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], FormatFault> {
        let mut array = [0; N];
        array.copy_from_slice(self.read_bytes(N)?);
        Ok(array)
    }

    pub fn u8(&mut self) -> Result<u8, FormatFault> {
        Ok(u8::from_le_bytes(self.array()?))
    }

    pub fn u32(&mut self) -> Result<u32, FormatFault> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    pub fn i32(&mut self) -> Result<i32, FormatFault> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    pub fn i64(&mut self) -> Result<i64, FormatFault> {
        Ok(i64::from_le_bytes(self.array()?))
    }

    pub fn f64s<const N: usize>(&mut self) -> Result<[f64; N], FormatFault> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = f64::from_le_bytes(self.array()?);
        }
        Ok(numbers)
    }

    pub fn position(&mut self) -> Result<[i32; 3], FormatFault> {
        Ok([self.i32()?, self.i32()?, self.i32()?])
    }

    /// A length-prefixed text; invalid UTF-8 is replaced.
    pub fn text(&mut self) -> Result<String, FormatFault> {
        let length = self.u32()? as usize;
        if length > LONGEST_TEXT {
            return damaged(format!("a name of {length} bytes, at most {LONGEST_TEXT} are allowed"));
        }
        Ok(String::from_utf8_lossy(self.read_bytes(length)?).into_owned())
    }

    /// Fails unless the remaining bytes can hold `count` items of at least `bytes_each`.
    pub fn check_room(&self, what: &str, count: usize, bytes_each: usize) -> Result<(), FormatFault> {
        if count.checked_mul(bytes_each).is_some_and(|bytes| bytes <= self.left()) {
            return Ok(());
        }
        damaged(format!("{count} {what} in the {} bytes that are left", self.left()))
    }
}
