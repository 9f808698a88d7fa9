//! The values of a node: flags, masks of the inactive slots, and the compressed array.

use flate2::{Decompress, FlushDecompress, Status};

use super::blosc;
use super::cursor::Cursor;
use super::kind::{GridKind, Number};
use crate::import::error::{FormatFault, damaged};

/// Bits of a grid's compression.
pub(super) const ZIP: u32 = 1;
pub(super) const ACTIVE_MASK: u32 = 2;
pub(super) const BLOSC: u32 = 4;

/// First version in which nodes begin with a flag and grids have their own compression.
pub(super) const FLAGGED_VERSION: u32 = 222;

/// Node flags: values of the inactive slots, unless these are stored with the rest.
const BACKGROUND: u8 = 0;
const NEGATIVE: u8 = 1;
const ONE_VALUE: u8 = 2;
const NEGATIVE_OR_BACKGROUND: u8 = 3;
const VALUE_OR_BACKGROUND: u8 = 4;
const TWO_VALUES: u8 = 5;
const ALL_STORED: u8 = 6;

/// Storage of a tree's values.
#[derive(Debug, Clone, Copy)]
pub(super) struct ValueLayout {
    pub version: u32,
    pub compression: u32,
    pub kind: GridKind,
    /// True if arrays are stored as binary16.
    pub half: bool,
}

/// Reader of one tree's arrays, with its working memory.
pub(super) struct Values {
    layout: ValueLayout,
    background: Vec<f32>,
    unpacked: Vec<u8>,
    shuffled: Vec<u8>,
    stored: Vec<f32>,
    all: Vec<f32>,
    inflate: Decompress,
}

impl Values {
    /// `background`: one value, as many numbers as the tree's type has.
    pub fn new(layout: ValueLayout, background: Vec<f32>) -> Self {
        let inflate = Decompress::new(true);
        Self { layout, background, unpacked: vec![], shuffled: vec![], stored: vec![], all: vec![], inflate }
    }

    /// One value in full width.
    pub fn single(cursor: &mut Cursor, kind: GridKind) -> Result<Vec<f32>, FormatFault> {
        let mut numbers = Vec::with_capacity(kind.components);
        kind.number.decode(cursor.read_bytes(kind.bytes())?, &mut numbers);
        Ok(numbers)
    }

    /// The numbers of a node of `slots` slots, of which those in `mask` are active.
    pub fn read(&mut self, cursor: &mut Cursor, slots: usize, mask: &[u8]) -> Result<&[f32], FormatFault> {
        let inactive = Inactive::read(cursor, &self.layout, &self.background, mask.len())?;
        let count = inactive.stored_count(&self.layout, slots, mask);
        self.array(cursor, count)?;
        if count == slots {
            return Ok(&self.stored);
        }
        let components = self.layout.kind.components;
        self.all.clear();
        let mut stored = self.stored.chunks_exact(components);
        for index in 0..slots {
            let value = if bit(mask, index) { stored.next() } else { Some(inactive.value(index)) };
            self.all.extend(value.unwrap_or_default());
        }
        Ok(&self.all)
    }

    /// Skips the bytes that [`read`](Self::read) would read.
    pub fn skip(&mut self, cursor: &mut Cursor, slots: usize, mask: &[u8]) -> Result<(), FormatFault> {
        let inactive = Inactive::read(cursor, &self.layout, &self.background, mask.len())?;
        let count = inactive.stored_count(&self.layout, slots, mask);
        if let Some((_, bytes)) = self.stored_form(count) {
            if self.layout.compression & (ZIP | BLOSC) == 0 {
                cursor.read_bytes(bytes)?;
            } else {
                chunk(cursor, bytes)?;
            }
        }
        Ok(())
    }

    /// Storage of `count` values in the file, and their number of bytes before compression; none if nothing is stored.
    fn stored_form(&self, count: usize) -> Option<(Number, usize)> {
        let GridKind { number, components, .. } = self.layout.kind;
        let number = if self.layout.half { Number::Half } else { number };
        // An empty array of halves lacks even a size; an empty one of full values has one.
        (count > 0 || !self.layout.half).then_some((number, count * components * number.bytes()))
    }

    /// Reads `count` values into `stored`.
    fn array(&mut self, cursor: &mut Cursor, count: usize) -> Result<(), FormatFault> {
        self.stored.clear();
        let Some((number, expected)) = self.stored_form(count) else { return Ok(()) };
        if self.layout.compression & (ZIP | BLOSC) == 0 {
            number.decode(cursor.read_bytes(expected)?, &mut self.stored);
            return Ok(());
        }
        let (bytes, packed) = chunk(cursor, expected)?;
        if !packed {
            number.decode(bytes, &mut self.stored);
            return Ok(());
        }
        self.unpacked.clear();
        if self.layout.compression & BLOSC != 0 {
            self.unpacked.resize(expected, 0);
            blosc::unpack(bytes, &mut self.unpacked, &mut self.shuffled)?;
        } else {
            self.inflate_exactly(bytes, expected)?;
        }
        number.decode(&self.unpacked, &mut self.stored);
        Ok(())
    }

    fn inflate_exactly(&mut self, bytes: &[u8], expected: usize) -> Result<(), FormatFault> {
        // One spare byte reveals data that is too long.
        self.unpacked.resize(expected + 1, 0);
        self.inflate.reset(true);
        let status = self.inflate.decompress(bytes, &mut self.unpacked, FlushDecompress::Finish);
        if !matches!(status, Ok(Status::StreamEnd)) || self.inflate.total_out() != expected as u64 {
            return damaged(format!("a zlib stream that does not decompress to its {expected} bytes"));
        }
        self.unpacked.truncate(expected);
        Ok(())
    }
}

/// The bytes of an array after their size, and whether they are compressed.
fn chunk<'a>(cursor: &mut Cursor<'a>, expected: usize) -> Result<(&'a [u8], bool), FormatFault> {
    let size = cursor.i64()?;
    let length = usize::try_from(size.unsigned_abs()).unwrap_or(usize::MAX);
    if size <= 0 && length != expected {
        return damaged(format!("a stored array of {length} bytes where {expected} are expected"));
    }
    Ok((cursor.read_bytes(length)?, size > 0))
}

/// Values of inactive slots that are not stored.
struct Inactive<'a> {
    flag: u8,
    /// Value if the selection's bit is off, and if it is on.
    values: [Vec<f32>; 2],
    selection: &'a [u8],
}

impl<'a> Inactive<'a> {
    fn read(
        cursor: &mut Cursor<'a>,
        layout: &ValueLayout,
        background: &[f32],
        mask_bytes: usize,
    ) -> Result<Self, FormatFault> {
        let flag = if layout.version >= FLAGGED_VERSION { cursor.u8()? } else { ALL_STORED };
        let background = || background.to_vec();
        let negative = || background().into_iter().map(|number| layout.kind.number.negative(number)).collect();
        let values = match flag {
            BACKGROUND => [background(), vec![]],
            NEGATIVE => [negative(), vec![]],
            ONE_VALUE => [Values::single(cursor, layout.kind)?, vec![]],
            NEGATIVE_OR_BACKGROUND => [negative(), background()],
            VALUE_OR_BACKGROUND => [Values::single(cursor, layout.kind)?, background()],
            TWO_VALUES => [Values::single(cursor, layout.kind)?, Values::single(cursor, layout.kind)?],
            ALL_STORED => [vec![], vec![]],
            _ => return damaged(format!("node flag {flag}, at most {ALL_STORED} is known")),
        };
        let selects = matches!(flag, NEGATIVE_OR_BACKGROUND | VALUE_OR_BACKGROUND | TWO_VALUES);
        let selection = if selects { cursor.read_bytes(mask_bytes)? } else { &[] };
        Ok(Self { flag, values, selection })
    }

    fn stored_count(&self, layout: &ValueLayout, slots: usize, mask: &[u8]) -> usize {
        if layout.compression & ACTIVE_MASK != 0 && self.flag != ALL_STORED { ones(mask) } else { slots }
    }

    fn value(&self, index: usize) -> &[f32] {
        &self.values[usize::from(bit(self.selection, index))]
    }
}

/// True if a bit of a mask is on; bits beyond its end are off.
pub(super) fn bit(mask: &[u8], index: usize) -> bool {
    mask.get(index >> 3).is_some_and(|byte| byte >> (index & 7) & 1 == 1)
}

/// Number of bits that are on in a mask.
pub(super) fn ones(mask: &[u8]) -> usize {
    mask.iter().map(|byte| byte.count_ones() as usize).sum()
}
