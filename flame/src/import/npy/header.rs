//! An array's header, and the numbers after it.

use std::io::Read;

use half::f16;

use super::literal;
use crate::import::error::{FormatFault, damaged, shown};

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// Longest header; a longer one describes records.
const MOST_HEADER_BYTES: usize = 1 << 16;

/// Axes of an array.
const MOST_AXES: usize = 8;

/// Size in bytes of the pieces in which values are read; a multiple of every type's size.
const PIECE_BYTES: usize = 1 << 16;

/// Storage of one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Number {
    Bool,
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

/// Header of an array.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    number: Number,
    big_endian: bool,
    descr: String,
    /// True if the first index runs fastest, instead of the last.
    pub fortran_order: bool,
    /// Lengths along the axes; empty for a single number.
    pub shape: Vec<usize>,
    /// Bytes before the data.
    pub header_bytes: u64,
}

impl Header {
    /// Reads everything up to the data.
    ///
    /// # Errors
    /// If the bytes end early, are not those of an array, or describe an unsupported one.
    pub fn read(reader: &mut impl Read) -> Result<Self, FormatFault> {
        let mut start = [0; 8];
        fill(reader, &mut start)?;
        let [magic @ .., major, _] = start;
        if magic != *MAGIC {
            return damaged("an array lacks the .npy signature");
        }
        let (length, length_bytes) = match major {
            1 => {
                let mut length = [0; 2];
                fill(reader, &mut length)?;
                (usize::from(u16::from_le_bytes(length)), 2)
            }
            2 | 3 => {
                let mut length = [0; 4];
                fill(reader, &mut length)?;
                (u32::from_le_bytes(length) as usize, 4)
            }
            _ => return unsupported(format!(".npy version {major}")),
        };
        if length > MOST_HEADER_BYTES {
            return damaged(format!("an array header of {length} bytes, at most {MOST_HEADER_BYTES} are allowed"));
        }
        let mut text = vec![0; length];
        fill(reader, &mut text)?;
        let literal = literal::parse(&text)?;
        let (number, big_endian) = number(&literal.descr)?;
        if literal.shape.len() > MOST_AXES {
            return unsupported(format!("an array of {} axes", literal.shape.len()));
        }
        let header = Self {
            number,
            big_endian,
            descr: literal.descr,
            fortran_order: literal.fortran_order,
            shape: literal.shape,
            header_bytes: (start.len() + length_bytes + length) as u64,
        };
        header.data_bytes()?;
        Ok(header)
    }

    /// Number of values in the array.
    ///
    /// # Errors
    /// If the product of the lengths overflows.
    pub fn count(&self) -> Result<u64, FormatFault> {
        let product = self.shape.iter().try_fold(1u64, |product, length| product.checked_mul(*length as u64));
        product.map_or_else(|| damaged(format!("an array of shape {:?}", self.shape)), Ok)
    }

    /// Number of bytes after the header.
    ///
    /// # Errors
    /// If the number of bytes overflows.
    pub fn data_bytes(&self) -> Result<u64, FormatFault> {
        let bytes = self.count()?.checked_mul(self.number.bytes() as u64);
        bytes.map_or_else(|| damaged(format!("an array of shape {:?}", self.shape)), Ok)
    }

    /// Checks the size of the whole file, header included.
    ///
    /// # Errors
    /// [`FormatFault::Damaged`] unless it is exactly `found` bytes.
    pub fn check_size(&self, found: u64) -> Result<(), FormatFault> {
        if self.header_bytes.checked_add(self.data_bytes()?) == Some(found) {
            return Ok(());
        }
        damaged(format!("an array of shape {:?} and type {} in {found} bytes", self.shape, self.descr))
    }

    /// Passes all numbers to `each`, in storage order; `reader` is just after the header.
    ///
    /// # Errors
    /// If there are fewer or more.
    pub fn values(&self, reader: &mut impl Read, each: impl FnMut(f64)) -> Result<(), FormatFault> {
        let bytes = self.data_bytes()?;
        match self.number {
            Number::Bool => self.pieces(reader, bytes, each, |[byte]| f64::from(u8::from(byte != 0))),
            Number::Signed(1) => self.pieces(reader, bytes, each, |x| f64::from(i8::from_le_bytes(x))),
            Number::Signed(2) => self.pieces(reader, bytes, each, |x| f64::from(i16::from_le_bytes(x))),
            Number::Signed(4) => self.pieces(reader, bytes, each, |x| f64::from(i32::from_le_bytes(x))),
            Number::Signed(_) => self.pieces(reader, bytes, each, |x| i64::from_le_bytes(x) as f64),
            Number::Unsigned(1) => self.pieces(reader, bytes, each, |x| f64::from(u8::from_le_bytes(x))),
            Number::Unsigned(2) => self.pieces(reader, bytes, each, |x| f64::from(u16::from_le_bytes(x))),
            Number::Unsigned(4) => self.pieces(reader, bytes, each, |x| f64::from(u32::from_le_bytes(x))),
            Number::Unsigned(_) => self.pieces(reader, bytes, each, |x| u64::from_le_bytes(x) as f64),
            Number::Float(2) => self.pieces(reader, bytes, each, |x| f16::from_le_bytes(x).to_f64()),
            Number::Float(4) => self.pieces(reader, bytes, each, |x| f64::from(f32::from_le_bytes(x))),
            Number::Float(_) => self.pieces(reader, bytes, each, f64::from_le_bytes),
        }
    }

    fn pieces<const BYTES: usize>(
        &self,
        reader: &mut impl Read,
        mut left: u64,
        mut each: impl FnMut(f64),
        convert: impl Fn([u8; BYTES]) -> f64,
    ) -> Result<(), FormatFault> {
        let mut buffer = vec![0; left.min(PIECE_BYTES as u64) as usize];
        while left > 0 {
            let length = left.min(buffer.len() as u64) as usize;
            let piece = buffer.get_mut(..length).unwrap_or_default();
            fill(reader, piece)?;
            left -= length as u64;
            for number in piece.as_chunks::<BYTES>().0 {
                let mut number = *number;
                if self.big_endian {
                    number.reverse();
                }
                each(convert(number));
            }
        }
        // Reading to the end also makes a zip member verify its checksum.
        match reader.read(&mut [0]) {
            Ok(0) => Ok(()),
            Ok(_) => damaged(format!("more data than an array of shape {:?} holds", self.shape)),
            Err(error) => Err(fault_of(&error)),
        }
    }

    /// Type and shape, for messages.
    pub fn kind(&self) -> String {
        let lengths: Vec<String> = self.shape.iter().map(usize::to_string).collect();
        format!("{} ({})", self.descr, lengths.join(", "))
    }
}

impl Number {
    fn bytes(self) -> usize {
        match self {
            Self::Bool => 1,
            Self::Signed(bytes) | Self::Unsigned(bytes) | Self::Float(bytes) => bytes,
        }
    }
}

/// Parses `<f4` and the like: the number, and whether its highest byte comes first.
fn number(descr: &str) -> Result<(Number, bool), FormatFault> {
    let (big_endian, code) = match descr.split_at_checked(1) {
        Some((">", code)) => (true, code),
        Some(("<" | "=" | "|", code)) => (false, code),
        _ => (false, descr),
    };
    let number = match code {
        "b1" | "?" => Number::Bool,
        "i1" => Number::Signed(1),
        "i2" => Number::Signed(2),
        "i4" => Number::Signed(4),
        "i8" => Number::Signed(8),
        "u1" => Number::Unsigned(1),
        "u2" => Number::Unsigned(2),
        "u4" => Number::Unsigned(4),
        "u8" => Number::Unsigned(8),
        "f2" => Number::Float(2),
        "f4" => Number::Float(4),
        "f8" => Number::Float(8),
        _ => return unsupported(format!("an array of type \"{}\"", shown(descr))),
    };
    Ok((number, big_endian))
}

fn unsupported<T>(found: String) -> Result<T, FormatFault> {
    Err(FormatFault::Unsupported { found, advice: "save an array of plain numbers such as float32" })
}

/// Reads until `bytes` is full.
fn fill(reader: &mut impl Read, bytes: &mut [u8]) -> Result<(), FormatFault> {
    reader.read_exact(bytes).map_err(|error| fault_of(&error))
}

/// The fault that a failed read indicates.
pub(in crate::import) fn fault_of(error: &std::io::Error) -> FormatFault {
    match error.kind() {
        std::io::ErrorKind::UnexpectedEof => FormatFault::Damaged("an array ends early".into()),
        std::io::ErrorKind::InvalidData | std::io::ErrorKind::InvalidInput | std::io::ErrorKind::Other => {
            FormatFault::Damaged(shown(&error.to_string()))
        }
        kind => FormatFault::Unreadable(kind.to_string()),
    }
}

/// The bytes before the data of an array of little-endian `descr` in C order, padded so that the data start at a
/// multiple of 64 bytes.
pub(in crate::import) fn header_bytes(descr: &str, shape: &[usize]) -> Vec<u8> {
    const ALIGNMENT: usize = 64;
    // Signature, version and the length of the text.
    const PREFIX: usize = 10;
    let lengths: String = shape.iter().map(|length| format!("{length}, ")).collect();
    let lengths = if shape.len() > 1 { lengths.trim_end_matches(", ") } else { lengths.trim_end() };
    let mut text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({lengths}), }}");
    while !(PREFIX + text.len() + 1).is_multiple_of(ALIGNMENT) {
        text.push(' ');
    }
    text.push('\n');
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_header(text: &str) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((text.len() as u16).to_le_bytes());
        bytes.extend(text.bytes());
        bytes
    }

    #[test]
    fn written_header_equals_numpys() {
        let bytes = header_bytes("<f4", &[2, 3]);
        let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
        let expected = [b"\x93NUMPY\x01\x00v\x00", text.as_bytes(), &[b' '; 58], b"\n"].concat();
        assert_eq!(bytes.len(), 128);
        assert_eq!(bytes, expected);
        for shape in [&[][..], &[7], &[1, 2, 3, 4]] {
            let bytes = header_bytes("<f8", shape);
            assert_eq!(bytes.len() % 64, 0);
            assert_eq!(Header::read(&mut bytes.as_slice()).unwrap().shape, shape);
        }
    }

    #[test]
    fn numbers_of_every_type_and_order() {
        let cases: [(&str, &[u8], &[f64]); 14] = [
            ("|b1", &[0, 1, 2], &[0.0, 1.0, 1.0]),
            ("|i1", &[0xFF, 0x7F, 0], &[-1.0, 127.0, 0.0]),
            ("|u1", &[0xFF, 0x7F, 0], &[255.0, 127.0, 0.0]),
            ("<i2", &[0xFE, 0xFF], &[-2.0]),
            (">i2", &[0xFF, 0xFE], &[-2.0]),
            (">u2", &[0xFF, 0xFE], &[65534.0]),
            ("<i4", &[0xFD, 0xFF, 0xFF, 0xFF], &[-3.0]),
            (">u4", &[0, 0, 1, 0], &[256.0]),
            ("<i8", &[0xFC, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF], &[-4.0]),
            (">u8", &[0, 0, 0, 0, 0, 1, 0, 0], &[65536.0]),
            (">f2", &[0x3C, 0, 0xC0, 0, 0, 1], &[1.0, -2.0, 5.960_464_477_539_063e-8]),
            ("<f4", &[0, 0, 0xC0, 0x3F], &[1.5]),
            (">f8", &[0xBF, 0xE0, 0, 0, 0, 0, 0, 0], &[-0.5]),
            ("=f4", &[0, 0, 0x80, 0x3F], &[1.0]),
        ];
        for (descr, data, expected) in cases {
            let shape = expected.len();
            let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({shape},), }}\n");
            let bytes = [with_header(&text), data.to_vec()].concat();
            let mut reader = bytes.as_slice();
            let header = Header::read(&mut reader).unwrap();
            header.check_size(bytes.len() as u64).unwrap();
            let mut found = vec![];
            header.values(&mut reader, |value| found.push(value)).unwrap();
            assert_eq!(found, expected, "{descr}");
            assert!(header.values(&mut &data[1..], |_| ()).is_err(), "{descr}, cut");
            assert!(header.values(&mut [data, &[0]].concat().as_slice(), |_| ()).is_err(), "{descr}, longer");
        }
    }

    #[test]
    fn unsupported_arrays_are_refused() {
        for text in [
            "{'descr': '|O', 'fortran_order': False, 'shape': (1,), }",
            "{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (1,), }",
            "{'descr': '<c8', 'fortran_order': False, 'shape': (1,), }",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (-1,), }",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (4294967296, 4294967296), }",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (4611686018427387904,), }",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999,), }",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (1,1,1,1,1,1,1,1,1), }",
        ] {
            assert!(Header::read(&mut with_header(text).as_slice()).is_err(), "{text}");
        }
        let mut long = b"\x93NUMPY\x02\x00".to_vec();
        long.extend(u32::MAX.to_le_bytes());
        assert!(Header::read(&mut long.as_slice()).is_err());
        assert!(Header::read(&mut b"\x93NUMPY\x04\x00\x00\x00".as_slice()).is_err());
        assert!(Header::read(&mut b"PK\x03\x04\x00\x00\x00\x00".as_slice()).is_err());
    }
}
