//! NumPy's `.npy` arrays of numbers.
//!
//! ```text
//! "\x93NUMPY" | u8 major, u8 minor | u16 or (from 2.0) u32 length | {'descr': '<f4', 'fortran_order': False, 'shape': (3,)} | data
//! ```

mod array;
mod file;
mod header;
mod literal;

pub(super) use self::array::{components, grid};
pub use self::file::Npy;
pub use self::header::Header;
pub(super) use self::header::{fault_of, header_bytes};
