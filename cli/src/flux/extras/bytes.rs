//! Numbers and texts as little-endian bytes.

/// Writer into a byte buffer.
#[derive(Default)]
pub struct Writer {
    /// Bytes written so far.
    pub bytes: Vec<u8>,
}

impl Writer {
    pub fn raw(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    pub fn i64(&mut self, number: i64) {
        self.raw(&number.to_le_bytes());
    }

    pub fn f64(&mut self, number: f64) {
        self.raw(&number.to_le_bytes());
    }

    pub fn count(&mut self, count: u64) {
        self.raw(&count.to_le_bytes());
    }

    pub fn text(&mut self, text: &str) {
        self.count(text.len() as u64);
        self.raw(text.as_bytes());
    }

    /// Writes a presence flag, then the value if there is one.
    pub fn optional<T: ?Sized>(&mut self, value: Option<&T>, write: impl FnOnce(&mut Self, &T)) {
        self.raw(&[u8::from(value.is_some())]);
        if let Some(value) = value {
            write(self, value);
        }
    }
}

/// Reader of bytes; its methods return `None` at an early end or a nonsensical value.
pub struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    pub fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (array, rest) = self.bytes.split_first_chunk()?;
        self.bytes = rest;
        Some(*array)
    }

    pub fn i64(&mut self) -> Option<i64> {
        self.array().map(i64::from_le_bytes)
    }

    pub fn f64(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes)
    }

    pub fn position(&mut self) -> Option<[f64; 3]> {
        Some([self.f64()?, self.f64()?, self.f64()?])
    }

    pub fn count(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// A count of items of `size` bytes each, checked against the bytes left.
    pub fn count_of(&mut self, size: usize) -> Option<usize> {
        let count = usize::try_from(self.count()?).ok()?;
        (count.checked_mul(size)? <= self.bytes.len()).then_some(count)
    }

    pub fn text(&mut self) -> Option<String> {
        let count = self.count_of(1)?;
        let (text, rest) = self.bytes.split_at_checked(count)?;
        self.bytes = rest;
        String::from_utf8(text.to_vec()).ok()
    }

    /// The outer `None` is a failure, the inner one an absent value.
    pub fn optional<T>(&mut self, read: impl FnOnce(&mut Self) -> Option<T>) -> Option<Option<T>> {
        match self.array()? {
            [0] => Some(None),
            [1] => read(self).map(Some),
            _ => None,
        }
    }

    pub fn is_at_end(&self) -> bool {
        self.bytes.is_empty()
    }
}
