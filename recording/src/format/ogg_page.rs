//! Pages of Ogg, and their checksums.

/// First bytes of a page.
const MARK: &[u8; 4] = b"OggS";

/// Bytes of a page's header before its table of pieces.
const HEADER_BYTES: usize = 27;

/// Offset of the checksum.
const CRC_AT: std::ops::Range<usize> = 22..26;

/// One page.
pub(super) struct Page<'a> {
    pub is_continued: bool,
    pub is_first: bool,
    pub is_last: bool,
    /// The position after the last packet that ends here; none if none ends.
    pub position: Option<i64>,
    pub serial: u32,
    pub number: u32,
    sizes: &'a [u8],
    pub body: &'a [u8],
}

/// A page that cannot be used.
pub(super) struct PageFault {
    /// Offset of its first byte.
    pub at: usize,
    /// True if no other page follows.
    pub is_at_end: bool,
}

/// The pages of a file. Bytes between them are skipped: whatever they are, no page is lost unless its number is
/// missing.
pub(super) fn pages(bytes: &[u8]) -> impl Iterator<Item = Result<Page<'_>, PageFault>> {
    let mut from = 0;
    std::iter::from_fn(move || {
        let at = find(bytes, from)?;
        match page(&bytes[at..]) {
            Some((page, length)) => {
                from = at + length;
                Some(Ok(page))
            }
            None => {
                from = at + MARK.len();
                Some(Err(PageFault { at, is_at_end: find(bytes, from).is_none() }))
            }
        }
    })
}

fn find(bytes: &[u8], from: usize) -> Option<usize> {
    bytes.get(from..)?.windows(MARK.len()).position(|window| window == MARK).map(|offset| from + offset)
}

fn page(bytes: &[u8]) -> Option<(Page<'_>, usize)> {
    let header = bytes.first_chunk::<HEADER_BYTES>()?;
    let sizes = bytes.get(HEADER_BYTES..HEADER_BYTES + usize::from(header[26]))?;
    let body_at = HEADER_BYTES + sizes.len();
    let length = body_at + sizes.iter().map(|size| usize::from(*size)).sum::<usize>();
    let body = bytes.get(body_at..length)?;
    let u32_at = |at: usize| header[at..].first_chunk().map(|four| u32::from_le_bytes(*four));
    if header[4] != 0 || u32_at(CRC_AT.start)? != crc32(&bytes[..length]) {
        return None;
    }
    let position = i64::from_le_bytes(*header[6..].first_chunk()?);
    let page = Page {
        is_continued: header[5] & 1 != 0,
        is_first: header[5] & 2 != 0,
        is_last: header[5] & 4 != 0,
        position: Some(position).filter(|position| *position >= 0),
        serial: u32_at(14)?,
        number: u32_at(18)?,
        sizes,
        body,
    };
    Some((page, length))
}

impl<'a> Page<'a> {
    /// The pieces of packets on this page, each with true if it ends its packet.
    pub fn pieces(&self) -> impl Iterator<Item = (&'a [u8], bool)> {
        let (mut sizes, mut body) = (self.sizes, self.body);
        std::iter::from_fn(move || {
            if sizes.is_empty() {
                return None;
            }
            // A size below 255 ends a packet.
            let last = sizes.iter().position(|size| *size < 255);
            let (own, rest) = sizes.split_at(last.map_or(sizes.len(), |last| last + 1));
            let (piece, left) = body.split_at(own.iter().map(|size| usize::from(*size)).sum());
            (sizes, body) = (rest, left);
            Some((piece, last.is_some()))
        })
    }
}

const CRC32: [u32; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let (mut crc, mut bit) = ((byte as u32) << 24, 0);
        while bit < 8 {
            crc = if crc & 0x8000_0000 != 0 { crc << 1 ^ 0x04c1_1db7 } else { crc << 1 };
            bit += 1;
        }
        table[byte] = crc;
        byte += 1;
    }
    table
};

/// A page's checksum, computed with zeros in its own field.
fn crc32(page: &[u8]) -> u32 {
    page.iter().enumerate().fold(0, |crc: u32, (at, byte)| {
        let byte = if CRC_AT.contains(&at) { 0 } else { *byte };
        crc << 8 ^ CRC32[usize::from((crc >> 24) as u8 ^ byte)]
    })
}
